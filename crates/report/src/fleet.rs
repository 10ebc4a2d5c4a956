//! The report of many logs: what they show by bias model, unit, sensor and temperature, and which stand out.

mod answers;
mod density;
mod measure;

use super::{
    Section, Table,
    numbers::count,
    parts::{Run, first_few, prefixed, text, warnings},
    plain::{self, Mark},
};
use std::collections::BTreeMap;
use undrift_results::{Fleet, Trouble};

/// Rows that a table shows of a longer list.
const ROWS: usize = 200;
/// Names of a longer list that a sentence has.
const NAMES: usize = 12;

/// What the comparisons are not.
const ONE_AT_A_TIME: &str = "Unit, sensor, labels and temperature are compared one at a time. Causes that go together, such as \
     a unit that was always warm, are not separated: undrift.fleet.effects in Python estimates them together.";

/// The sections.
pub fn sections(runs: &[Run<'_, Fleet>]) -> Vec<Section> {
    runs.iter()
        .flat_map(|(name, run)| sections_of_run(name, run))
        .collect()
}

fn sections_of_run(name: &str, run: &Fleet) -> Vec<Section> {
    let measures = run.measures.iter().enumerate();
    let findings = measures.map(|(k, m)| text(measure::findings(m, k == 0)));
    // What was asked comes first.
    let first = run.measures.first().map(answers::sentences).and_then(text);
    let alone = run
        .measures
        .iter()
        .any(|measure| !answers::sentences(measure).is_empty());
    let alone = text(alone.then(|| ONE_AT_A_TIME.to_owned()));
    let blocks = [
        first,
        alone,
        warnings(&alarms(run)),
        text([what_was_done(run)]),
    ];
    let blocks = blocks.into_iter().chain(findings).flatten();
    let mut sections = Vec::from_iter(Section::new("The fleet", blocks));
    let measures = run.measures.iter();
    sections.extend(measures.filter_map(|measure| measure::section(run, measure)));
    sections.extend(troubles(run));
    for section in &mut sections {
        section.title = prefixed(name, &section.title);
    }
    sections
}

/// The measures for a terminal.
pub fn plain(run: &Fleet, mark: Mark) -> String {
    let measures = run.measures.iter().flat_map(|measure| {
        let table = measure::overview(run, measure);
        [
            text(answers::sentences(measure)),
            table.captioned(&measure.what),
            text(measure::of_outliers(measure)),
        ]
    });
    plain::plain(measures, mark)
}

/// A count and a noun in its number, the digits in groups.
fn many(n: u64, one: &str) -> String {
    let ending = if n == 1 { "" } else { "s" };
    format!("{} {one}{ending}", count(n))
}

fn what_was_done(run: &Fleet) -> String {
    let task = |(task, n): (&String, &u64)| {
        let verb = match task.as_str() {
            "outages" => "run with GNSS outages",
            "navigate" => "navigated",
            "tune" => "tuned",
            _ => "identified from a static recording",
        };
        format!("{} {verb}", many(*n, "log"))
    };
    let tasks: Vec<String> = run.tasks.iter().map(task).collect();
    let failed = match run.failed.len() as u64 {
        0 => "All succeeded.".into(),
        n => format!("{} failed; the last section lists the reasons.", count(n)),
    };
    format!("{}. {failed}", tasks.join(", "))
}

fn alarms(run: &Fleet) -> Vec<String> {
    let alarm = |troubles: &[Trouble], what: &str, happened: &str| {
        let mut names: Vec<String> = troubles.iter().map(|t| t.log.clone()).collect();
        names.dedup();
        // Of many the causes say more than the names.
        let (list, most) = if names.len() > NAMES {
            let of = |cause: Cause| format!("{} × {}", count(cause.logs), cause.why);
            let causes = causes_of(troubles).into_iter().map(of);
            (causes.collect(), EXAMPLES)
        } else {
            (names, NAMES)
        };
        let n = many(troubles.len() as u64, what);
        (!list.is_empty()).then(|| format!("{n} {happened}: {}", first_few(&list, most)))
    };
    let untrusted = "of single logs, models or axes failed or are not usable";
    let alarms = [
        alarm(&run.failed, "log", "failed"),
        alarm(&run.untrusted, "result", untrusted),
    ];
    alarms.into_iter().flatten().collect()
}

/// Logs that share a cause.
struct Cause {
    why: String,
    part: String,
    logs: u64,
    first: Vec<String>,
}

/// Examples of a cause, and causes of a warning.
const EXAMPLES: usize = 3;

/// One line for each cause, the most frequent first. Numbers in it differ from log to log: they are not part of it.
fn causes<'a>(all: impl Iterator<Item = (&'a str, &'a str, String)>) -> Vec<Cause> {
    let mut causes: BTreeMap<(String, String), Cause> = BTreeMap::new();
    for (log, part, why) in all {
        let alike = why
            .split(|c: char| c.is_ascii_digit())
            .filter(|s| *s != ".");
        let key = (alike.collect::<Vec<_>>().concat(), part.to_owned());
        let cause = causes.entry(key).or_insert_with(|| Cause {
            why,
            part: part.to_owned(),
            logs: 0,
            first: Vec::new(),
        });
        cause.logs += 1;
        if cause.first.len() < EXAMPLES {
            cause.first.push(log.to_owned());
        }
    }
    let mut causes: Vec<Cause> = causes.into_values().collect();
    causes.sort_by_key(|cause| std::cmp::Reverse(cause.logs));
    causes
}

/// The causes of troubles.
fn causes_of(troubles: &[Trouble]) -> Vec<Cause> {
    causes(troubles.iter().map(|t| {
        let part = t.part.as_deref().unwrap_or("all");
        (t.log.as_str(), part, t.why.replace(&t.log, "…"))
    }))
}

/// What failed, what cannot be trusted, and what should be known of the logs.
fn troubles(run: &Fleet) -> Option<Section> {
    let folded = |name, caption, causes: Vec<Cause>| {
        Table::from_rows(
            name,
            &shortened(caption, causes.len()),
            causes.into_iter().take(ROWS),
            &[
                ("cause, as in the first log", &|c| (&c.why).into()),
                ("of", &|c| (&c.part).into()),
                ("logs", &|c| c.logs.into()),
                ("such as", &|c| c.first.join(", ").into()),
            ],
        )
    };
    let warned = run.warned.iter().flat_map(|w| {
        let sentences = w.warnings.iter();
        sentences.map(|text| (w.log.as_str(), "all", text.replace(&w.log, "…")))
    });
    let untrusted = "Logs, models and axes that failed or are not usable.";
    let tables = [
        folded("failed", "Logs that failed.", causes_of(&run.failed)),
        folded("untrusted", untrusted, causes_of(&run.untrusted)),
        folded("warned", "Warnings about logs.", causes(warned)),
    ];
    Section::new(
        "Failures and warnings",
        tables.into_iter().filter_map(Table::block),
    )
}

/// A caption that says how much of a list is shown.
fn shortened(caption: &str, all: usize) -> String {
    if all > ROWS {
        format!("{caption} The first {ROWS} of {}.", count(all as u64))
    } else {
        caption.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_failures_are_folded_into_causes() {
        let trouble = |k: usize| Trouble {
            log: format!("{k:03}/drive.toml"),
            why: match k % 4 {
                0 => format!("{k:03}/drive.toml: imu.csv: No such file or directory"),
                _ => format!("gnss.csv line {k}: no column \"lon_deg\""),
            },
            ..Trouble::default()
        };
        let mut run = Fleet {
            failed: (0..2000).map(trouble).collect(),
            ..Fleet::default()
        };
        assert_eq!(
            alarms(&run),
            [
                "2\u{202f}000 logs failed: 1\u{202f}500 × gnss.csv line 1: no column \"lon_deg\", \
              500 × …: imu.csv: No such file or directory"
            ]
        );
        run.failed.truncate(2);
        assert_eq!(
            alarms(&run),
            ["2 logs failed: 000/drive.toml, 001/drive.toml"]
        );
    }
    #[test]
    fn what_was_done_names_the_verbs_and_the_failures() {
        let tasks = ["identify", "navigate", "outages", "tune"];
        let mut run = Fleet {
            tasks: (1..).zip(tasks).map(|(n, task)| (task.into(), n)).collect(),
            ..Fleet::default()
        };
        assert_eq!(
            what_was_done(&run),
            "1 log identified from a static recording, 2 logs navigated, 3 logs run with GNSS outages, 4 logs tuned. All succeeded."
        );
        run.failed = vec![Trouble::default()];
        assert!(what_was_done(&run).ends_with(". 1 failed; the last section lists the reasons."));
    }

    #[test]
    fn a_dozen_names_are_listed_and_one_of_a_log_once() {
        let trouble = |k: usize| Trouble {
            log: format!("{k}"),
            part: Some("arma".into()),
            why: "diverged".into(),
            ..Trouble::default()
        };
        let mut run = Fleet {
            untrusted: (1..=12).flat_map(|k| [trouble(k), trouble(k)]).collect(),
            ..Fleet::default()
        };
        assert_eq!(
            alarms(&run),
            [
                "24 results of single logs, models or axes failed or are not usable: 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12"
            ]
        );
        run.untrusted.push(trouble(13));
        assert_eq!(
            alarms(&run),
            ["25 results of single logs, models or axes failed or are not usable: 25 × diverged"]
        );
        // The causes with the logs they are of.
        let section = troubles(&run).unwrap();
        assert_eq!(crate::tests::names(&section), ["untrusted"]);
        let crate::Block::Table(table) = &section.blocks[0] else {
            panic!("no table");
        };
        assert_eq!(
            crate::tests::cells(table),
            [["diverged", "arma", "25", "1, 1, 2"]]
        );
        assert_eq!(shortened("All.", ROWS), "All.");
        assert_eq!(shortened("All.", ROWS + 1), "All. The first 200 of 201.");
    }

    #[test]
    fn numbers_make_no_cause_of_their_own_but_parts_do() {
        let all = [
            ("a", "x", "0.5 s late"),
            ("b", "x", "12 s late"),
            ("c", "y", "3 s late"),
            ("d", "x", "early"),
        ];
        let found = causes(
            all.into_iter()
                .map(|(log, part, why)| (log, part, why.to_owned())),
        );
        let found: Vec<(&str, &str, u64)> = found
            .iter()
            .map(|cause| (&*cause.why, &*cause.part, cause.logs))
            .collect();
        assert_eq!(found[0], ("0.5 s late", "x", 2));
        assert!(found.contains(&("3 s late", "y", 1)) && found.contains(&("early", "x", 1)));
        assert_eq!(found.len(), 3);
    }

    #[test]
    fn the_sections_are_the_answers_the_measures_and_the_troubles() {
        let measure = |name: &str| undrift_results::FleetMeasure {
            name: name.into(),
            what: "drift".into(),
            ..undrift_results::FleetMeasure::default()
        };
        let run = Fleet {
            tasks: [("tune".to_owned(), 1)].into(),
            measures: vec![measure("drift"), measure("error")],
            warned: vec![undrift_results::Warned {
                log: "a.toml".into(),
                warnings: vec!["a.toml: late".into()],
                ..undrift_results::Warned::default()
            }],
            ..Fleet::default()
        };
        let sections = sections(&[("f".to_owned(), &run)]);
        let titles: Vec<&str> = sections.iter().map(|section| &*section.title).collect();
        assert_eq!(
            titles,
            [
                "f: The fleet",
                "f: Drift",
                "f: Error",
                "f: Failures and warnings"
            ]
        );
        // Nothing is compared.
        assert!(!crate::tests::sentences(&sections[0]).contains(&ONE_AT_A_TIME));
        let mut compared = run.clone();
        compared.measures[1].effects = Some(undrift_results::FleetEffects {
            temperature: Some(undrift_results::Slope::default()),
            ..undrift_results::FleetEffects::default()
        });
        let first = &super::sections_of_run("f", &compared)[0];
        assert_eq!(crate::tests::sentences(first)[0], ONE_AT_A_TIME);
        let crate::Block::Table(table) = &sections[3].blocks[0] else {
            panic!("no table");
        };
        assert_eq!(
            crate::tests::cells(table),
            [["…: late", "all", "1", "a.toml"]]
        );
    }
}
