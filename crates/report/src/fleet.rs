//! The report of many logs: what they show by bias model, unit, sensor and temperature, and which stand out.

mod measure;

use super::{
    Section, Table,
    numbers::count,
    parts::{Run, first_few, prefixed, text, warnings},
    plain::{Mark, plain_table},
};
use undrift::results::{Fleet, Trouble};

/// Rows that a table shows of a longer list.
const ROWS: usize = 200;
/// Names that a sentence tells of a longer list.
const NAMES: usize = 12;

/// The sections.
pub fn sections(runs: &[Run<'_, Fleet>]) -> Vec<Section> {
    runs.iter().flat_map(|(name, run)| of(name, run)).collect()
}

fn of(name: &str, run: &Fleet) -> Vec<Section> {
    let findings = run.measures.iter().map(|m| text(measure::findings(m)));
    let blocks = [warnings(&alarms(run)), text([what_was_done(run)])];
    let blocks = blocks.into_iter().chain(findings).flatten();
    let mut sections = Vec::from_iter(Section::of("The fleet", blocks));
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
    let measures = run.measures.iter().map(|measure| {
        let table = plain_table(&measure::overview(run, measure), mark);
        let outliers = measure::of_outliers(measure).map_or(String::new(), |text| text + "\n");
        format!("{}\n{table}{outliers}", measure.what)
    });
    Vec::from_iter(measures).join("\n")
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
        let n = many(troubles.len() as u64, what);
        (!names.is_empty()).then(|| format!("{n} {happened}: {}", first_few(&names, NAMES)))
    };
    let untrusted = "of single models or axes failed or cannot be trusted";
    let alarms = [
        alarm(&run.failed, "log", "failed"),
        alarm(&run.untrusted, "result", untrusted),
    ];
    alarms.into_iter().flatten().collect()
}

/// What failed, what cannot be trusted, and what should be said of the logs.
fn troubles(run: &Fleet) -> Option<Section> {
    let troubles = |name, caption, list: &[Trouble]| {
        Table::of(
            name,
            &shortened(caption, list.len()),
            list.iter().take(ROWS),
            &[
                ("log", &|t| (&t.log).into()),
                ("unit", &|t| (&t.unit).into()),
                ("of", &|t| t.part.as_deref().unwrap_or("all").into()),
                ("why", &|t| (&t.why).into()),
            ],
        )
    };
    let warned = Table::of(
        "warned",
        &shortened("Warnings about logs.", run.warned.len()),
        run.warned.iter().take(ROWS),
        &[
            ("log", &|w| (&w.log).into()),
            ("unit", &|w| (&w.unit).into()),
            ("warnings", &|w| w.warnings.join("; ").into()),
        ],
    );
    let untrusted = "Models and axes that failed or cannot be trusted.";
    let tables = [
        troubles("failed", "Logs that failed.", &run.failed),
        troubles("untrusted", untrusted, &run.untrusted),
        warned,
    ];
    Section::of(
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
