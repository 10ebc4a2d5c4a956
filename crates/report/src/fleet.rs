//! The report of many logs: what they show by bias model, unit, sensor and temperature, and which stand out.

mod measure;

use super::{
    Block, Cell, Section,
    parts::{count, table, text, warnings},
};
use undrift::results::{Fleet, Trouble};

/// Rows that a table shows of a longer list.
const ROWS: usize = 200;
/// Names that a sentence tells of a longer list.
const TOLD: usize = 12;

/// A fleet with its name; the name of a single one is empty.
pub type Run<'a> = (String, &'a Fleet);

/// The sections.
pub fn sections(runs: &[Run<'_>]) -> Vec<Section> {
    runs.iter().flat_map(|(name, run)| of(name, run)).collect()
}

fn of(name: &str, run: &Fleet) -> Vec<Section> {
    let mut blocks = Vec::from_iter(warnings(&alarms(run)));
    blocks.extend(text(&[what_was_done(run)]));
    for measure in &run.measures {
        blocks.extend(text(&measure::findings(measure)));
    }
    let mut sections = vec![Section {
        title: "The fleet".into(),
        blocks,
    }];
    let measures = run.measures.iter();
    sections.extend(measures.map(|measure| measure::section(run, measure)));
    sections.extend(troubles(run));
    if !name.is_empty() {
        for section in &mut sections {
            section.title = format!("{name}: {}", section.title);
        }
    }
    sections
}

/// So many of them, with the right ending.
fn many(n: u64, one: &str) -> String {
    let ending = if n == 1 { "" } else { "s" };
    format!("{} {one}{ending}", count(n))
}

fn what_was_done(run: &Fleet) -> String {
    let verb = |task: &str| match task {
        "outages" => "driven with GNSS cut",
        "navigate" => "navigated",
        _ => "identified from a record at rest",
    };
    let tasks = run.tasks.iter();
    let tasks: Vec<String> = tasks
        .map(|(task, n)| format!("{} {}", many(*n, "log"), verb(task)))
        .collect();
    let failed = match run.failed.len() {
        0 => "Something came of all of them.".into(),
        n => format!(
            "Nothing came of {}; the last section says why.",
            count(n as u64)
        ),
    };
    format!("{}. {failed}", tasks.join(", "))
}

fn alarms(run: &Fleet) -> Vec<String> {
    let names = |troubles: &[Trouble]| {
        let mut names: Vec<&str> = troubles.iter().map(|t| t.log.as_str()).collect();
        names.dedup();
        let more = names.len().saturating_sub(TOLD);
        names.truncate(TOLD);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        names.join(", ") + &more
    };
    let mut alarms = Vec::new();
    if !run.failed.is_empty() {
        let logs = many(run.failed.len() as u64, "log");
        alarms.push(format!("{logs} failed: {}", names(&run.failed)));
    }
    if !run.untrusted.is_empty() {
        let results = many(run.untrusted.len() as u64, "result");
        alarms.push(format!(
            "{results} of single models or axes failed or cannot be trusted: {}",
            names(&run.untrusted)
        ));
    }
    alarms
}

/// What failed, what cannot be trusted, and what should be said of the logs.
fn troubles(run: &Fleet) -> Option<Section> {
    let mut blocks = Vec::new();
    let unit = |unit: &Option<String>| Cell::from(unit.clone().unwrap_or_else(|| "–".into()));
    for (name, caption, list) in [
        ("failed", "Logs that nothing came of.", &run.failed),
        (
            "untrusted",
            "Models and axes that failed or cannot be trusted.",
            &run.untrusted,
        ),
    ] {
        let mut rows = table(
            name,
            &shortened(caption, list.len()),
            &["log", "unit", "of", "why"],
        );
        rows.rows = list
            .iter()
            .take(ROWS)
            .map(|t| {
                let part = t.part.clone().unwrap_or_else(|| "all".into());
                vec![
                    t.log.clone().into(),
                    unit(&t.unit),
                    part.into(),
                    t.why.clone().into(),
                ]
            })
            .collect();
        if !rows.rows.is_empty() {
            blocks.push(Block::Table(rows));
        }
    }
    let caption = "What was unusual about logs.";
    let mut rows = table(
        "warned",
        &shortened(caption, run.warned.len()),
        &["log", "unit", "warnings"],
    );
    rows.rows = run
        .warned
        .iter()
        .take(ROWS)
        .map(|w| {
            vec![
                w.log.clone().into(),
                unit(&w.unit),
                w.warnings.join("; ").into(),
            ]
        })
        .collect();
    if !rows.rows.is_empty() {
        blocks.push(Block::Table(rows));
    }
    (!blocks.is_empty()).then(|| Section {
        title: "Failures and warnings".into(),
        blocks,
    })
}

/// A caption that says how much of a list is shown.
fn shortened(caption: &str, all: usize) -> String {
    if all > ROWS {
        format!("{caption} The first {ROWS} of {}.", count(all as u64))
    } else {
        caption.to_owned()
    }
}
