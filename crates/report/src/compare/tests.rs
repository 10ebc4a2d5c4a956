use super::*;
use undrift_results::{Drive, Identify, Navigate, Outages, Tune};

fn identified(record: &str) -> Results {
    Results::Identify(Identify {
        undrift: "1.2.3".into(),
        record: record.into(),
        ..Identify::default()
    })
}

fn drive(file: &str) -> Drive {
    Drive {
        file: Some(file.into()),
        ..Drive::default()
    }
}

fn navigated(file: &str) -> Results {
    Results::Navigate(Box::new(Navigate {
        undrift: "1.2.4".into(),
        drive: drive(file),
        ..Navigate::default()
    }))
}

fn at(path: &str, result: Results) -> (PathBuf, Results) {
    (path.into(), result)
}

#[test]
fn a_single_result_has_its_log_in_the_title() {
    let title = |result: Results| document(&[at("a.json", result)]).title;
    assert_eq!(title(identified("rest.csv")), "Sensor noise: rest.csv");
    assert_eq!(title(identified("")), "Sensor noise");
    assert_eq!(title(navigated("drive.toml")), "Navigation: drive.toml");
    let cut = Outages {
        drive: drive("drive.toml"),
        ..Outages::default()
    };
    assert_eq!(
        title(Results::Outages(Box::new(cut))),
        "GNSS outages: drive.toml"
    );
    let tuned = Tune {
        drives: vec![drive("a.toml"), drive("b.toml")],
        ..Tune::default()
    };
    assert_eq!(title(Results::Tune(tuned)), "Noise in the vehicle: a.toml");
}

#[test]
fn several_results_are_compared_or_stand_in_chapters() {
    let one_kind = document(&[at("a.json", navigated("x")), at("b.json", navigated("y"))]);
    assert_eq!(one_kind.title, "Navigation, 2 results compared");
    assert_eq!(one_kind.subtitle, "undrift 1.2.4");
    let two = document(&[at("a.json", navigated("x")), at("b.json", identified("y"))]);
    assert_eq!(two.title, "Sensor noise, Navigation");
    assert_eq!(two.subtitle, "undrift 1.2.4, 1.2.3");
    let titles: Vec<&str> = two.sections.iter().map(|section| &*section.title).collect();
    assert_eq!(titles[0], "Identification: Allan deviation");
    assert!(
        titles[1..]
            .iter()
            .all(|title| title.starts_with("Navigation: ")),
        "{titles:?}"
    );
}

#[test]
fn results_go_by_their_files_with_folders_where_those_are_the_same() {
    let paths = ["x/a.json", "b.json", "y/a.json", "y/a.json", "c.tar.json"];
    let results = paths.map(|path| at(path, identified("")));
    assert_eq!(
        names(&results),
        ["x/a.json", "b", "y/a.json (3)", "y/a.json (4)", "c.tar"]
    );
}
