//! What the verbs share in telling their results.

use crate::{style, terminal, terminal::warn};
use anyhow::{Context, Result};
use serde_json::json;
use std::path::Path;
use undrift::{
    io::{imu::GapSummary, skipped::Skipped},
    nav::sample::{GnssFix, Position, TruthSample},
    outages::ModelRun,
    replay::{Innovations, Outage, Part, ReplayError, Summary},
    table::outage_table,
};

type Outcome = (String, Result<ModelRun, ReplayError>);

/// The runs that ended with a result, and the others' names and errors.
pub fn split(results: &[Outcome]) -> (Vec<&ModelRun>, Vec<(&str, &ReplayError)>) {
    let mut runs = Vec::new();
    let mut failed = Vec::new();
    for (name, result) in results {
        match result {
            Ok(run) => runs.push(run),
            Err(error) => failed.push((name.as_str(), error)),
        }
    }
    (runs, failed)
}

/// The table of the runs for the terminal.
pub fn shown(runs: &[&ModelRun]) -> String {
    style::tables(&table(runs), ERRORS)
}

/// Columns of the table.
const ERRORS: usize = 9;

/// The table of the runs.
pub fn table(runs: &[&ModelRun]) -> String {
    let rows: Vec<_> = runs.iter().map(|r| (r.name.clone(), &r.errors)).collect();
    outage_table(&rows)
}

/// The result as JSON.
pub fn json(outages: &[Outage], runs: &[&ModelRun], reference: &str) -> String {
    let outages: Vec<_> = outages
        .iter()
        .map(|o| json!({"start_s": o.start, "length_s": o.end - o.start}))
        .collect();
    let models: serde_json::Map<_, _> = runs
        .iter()
        .map(|r| (r.name.clone(), json!(r.errors)))
        .collect();
    let result = json!({"outages": outages, "models": models, "reference": reference});
    format!("{result:#}")
}

/// Tells which models could not be run.
pub fn print_failed(failed: &[(&str, &ReplayError)]) {
    for (name, error) in failed {
        terminal::doubt();
        warn(format!("{name}: {error}"));
    }
}

/// Tells which results cannot be trusted.
pub fn print_warnings(runs: &[&ModelRun]) {
    for run in runs {
        if let Some(warning) = &run.errors.warning {
            terminal::doubt();
            warn(format!("{}: {warning}", run.name));
        }
    }
}

/// Tells what was unusual about the log.
pub fn print_health(summary: &Summary) {
    if summary.bridged > 0 {
        warn(format!(
            "short gaps between samples, bridged: {}",
            summary.bridged
        ));
    }
    if let Some((count, first, longest)) = summary.long_gaps {
        warn(format!(
            "long gaps between samples: {count}, the first at {first:.3} s, the longest {longest:.3} s; the covariance was grown over each"
        ));
    }
    let (from, length) = summary.longest_without_gnss;
    if length > 5.0 {
        warn(format!(
            "longest span without a usable fix: {length:.1} s from {from:.3} s"
        ));
    }
    if summary.bad_fixes > 0 {
        warn(format!(
            "fixes whose covariance is none: {}",
            summary.bad_fixes
        ));
    }
}

/// Notes whether a solution can be trusted.
pub fn judge(summary: &Summary) {
    if summary.diverged.is_some()
        || summary.suspect.is_some()
        || !summary.restarts.is_empty()
        || summary.wrong_signs().next().is_some()
    {
        terminal::doubt();
    }
}

/// Tells where the solution and the fixes disagreed: the receiver's fault or the model's.
pub fn print_disagreement(summary: &Summary) {
    judge(summary);
    for restart in &summary.restarts {
        let then = match restart.resumed {
            Some(time) => format!("aligned anew at {time:.3} s"),
            None => "no new alignment was found".into(),
        };
        warn(format!(
            "divergence at {:.3} s: {}; {then}",
            restart.time, restart.why
        ));
    }
    print_contradictions(summary);
    for lean in &summary.leans {
        let (part, unit) = of(lean.part);
        let [north, east, down] = lean.mean;
        warn(format!(
            "from {:.1} s to {:.1} s the {part} differs from the solution to one side, by up to {:.2}, {:.2}, {:.2} {unit} north, east, down on the average: a slow drift of the fixes (multipath, spoofing), or of the sensors",
            lean.start, lean.end, -north, -east, -down
        ));
    }
    for axis in summary.wrong_signs() {
        warn(format!(
            "the velocity {} seems to have the wrong sign: its innovations are minus twice its value; check gnss.velocity and gnss.velocity_axes",
            ["north", "east", "down"][axis]
        ));
    }
    if let Some(time) = summary.suspect {
        warn(format!(
            "the innovations from {time:.1} s on are far beyond their predicted size: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
        ));
    }
}

/// Tells what was unusual about a log of one number, and how it was used.
pub fn print_scalar(name: &str, skipped: &Skipped, gaps: &GapSummary, used: &Innovations) {
    if !skipped.is_empty() {
        warn(format!("{name} log: {skipped}"));
    }
    if let (count, Some(longest)) = (gaps.count, gaps.longest) {
        warn(format!(
            "{name} log: {count} gaps, the longest {:.3} s from {:.3} s",
            longest.length, longest.start
        ));
    }
    if used.updates == 0 {
        warn(format!(
            "{name} log: nothing of it was used; compare its times with the IMU's, {name}.time_offset moves them"
        ));
    }
    if used.rejected + used.weakened > 0 {
        warn(format!(
            "{name}: {} measurements left out and {} given less weight, far from what was predicted",
            used.rejected, used.weakened
        ));
    }
}

/// Runs of fixes left out that are told one by one.
const TOLD: usize = 12;

fn of(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Position => ("position", "m"),
        Part::Velocity => ("velocity", "m/s"),
    }
}

/// Tells which fixes were left out.
fn print_contradictions(summary: &Summary) {
    let all = &summary.contradictions;
    for c in all.iter().take(TOLD) {
        let (part, unit) = of(c.part);
        let size = if c.fixes == 1 {
            format!("{:.2} {unit} off", c.largest)
        } else {
            format!(
                "{:.2} {unit} off at first, {:.2} {unit} at last ({:+.2} {unit} a second), {:.2} {unit} at most",
                c.first, c.last, c.growth, c.largest
            )
        };
        let what = if c.frozen {
            "the receiver repeated itself while the solution moved"
        } else {
            "jump"
        };
        let end = if c.gave_way {
            "; the solution gave way to it"
        } else {
            ""
        };
        warn(format!(
            "{part} left out, {what}: {:.3} s to {:.3} s, {} {}, {size}{end}",
            c.start,
            c.end,
            c.fixes,
            if c.fixes == 1 { "fix" } else { "fixes" }
        ));
    }
    let more = all.len() - all.len().min(TOLD);
    if more > 0 {
        let gave_way = all.iter().skip(TOLD).filter(|c| c.gave_way).count();
        warn(format!(
            "and {} more such spans, in {gave_way} of which the solution gave way; --json has {}",
            more as u64 + summary.more_contradictions,
            if summary.more_contradictions > 0 {
                "the first 1000"
            } else {
                "all"
            }
        ));
    }
}

pub use crate::terminal::say;

/// Writes a file whole or not at all.
pub fn write_whole(path: &Path, text: &str) -> Result<()> {
    let write = || {
        let beside = path.with_extension("partial");
        std::fs::write(&beside, text)?;
        std::fs::rename(&beside, path)
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

/// What to draw as the trajectory: the truth, or the fixes where there is none.
pub fn track(truth: &[TruthSample], gnss: &[GnssFix]) -> Vec<TruthSample> {
    if !truth.is_empty() {
        return truth.to_vec();
    }
    gnss.iter()
        .filter_map(|fix| match fix.position {
            Some((Position::Geodetic(position), _)) => Some(TruthSample {
                time: fix.time,
                position,
                v_n: None,
                rpy: None,
            }),
            _ => None,
        })
        .collect()
}
