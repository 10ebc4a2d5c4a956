//! What should be said of a log and of how it was navigated, in sentences.

use crate::replay::{Innovations, Part, Summary};
use undrift_io::{imu::GapSummary, skipped::Skipped};

/// What was unusual about the log.
pub fn of_health(summary: &Summary) -> Vec<String> {
    let mut remarks = Vec::new();
    if summary.bridged > 0 {
        remarks.push(format!(
            "short gaps between samples, bridged: {}",
            summary.bridged
        ));
    }
    if let Some((count, first, longest)) = summary.long_gaps {
        remarks.push(format!(
            "long gaps between samples: {count}, the first at {first:.3} s, the longest {longest:.3} s; the covariance was grown over each"
        ));
    }
    let (from, length) = summary.longest_without_gnss;
    if length > WITHOUT_GNSS {
        remarks.push(format!(
            "longest span without a usable fix: {length:.1} s from {from:.3} s"
        ));
    }
    if summary.bad_fixes > 0 {
        remarks.push(format!(
            "fixes whose covariance is none: {}",
            summary.bad_fixes
        ));
    }
    remarks
}

/// Spans without a usable fix longer than this are told [s].
pub const WITHOUT_GNSS: f64 = 5.0;

/// Where the solution and the fixes disagreed: the receiver's fault or the model's.
pub fn of_disagreement(summary: &Summary) -> Vec<String> {
    let mut remarks = Vec::new();
    for restart in &summary.restarts {
        let then = match restart.resumed {
            Some(time) => format!("aligned anew at {time:.3} s"),
            None => "no new alignment was found".into(),
        };
        remarks.push(format!(
            "divergence at {:.3} s: {}; {then}",
            restart.time, restart.why
        ));
    }
    remarks.extend(of_contradictions(summary));
    for lean in &summary.leans {
        let (part, unit) = of(lean.part);
        let [north, east, down] = lean.mean;
        remarks.push(format!(
            "from {:.1} s to {:.1} s the {part} differs from the solution to one side, by up to {:.2}, {:.2}, {:.2} {unit} north, east, down on the average: a slow drift of the fixes (multipath, spoofing), or of the sensors",
            lean.start, lean.end, -north, -east, -down
        ));
    }
    for axis in summary.wrong_signs() {
        remarks.push(format!(
            "the velocity {} seems to have the wrong sign: its innovations are minus twice its value; check gnss.velocity and gnss.velocity_axes",
            ["north", "east", "down"][axis]
        ));
    }
    if let Some(time) = summary.suspect {
        remarks.push(format!(
            "the innovations from {time:.1} s on are far beyond their predicted size: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
        ));
    }
    remarks
}

/// What was unusual about a log of one number, and how it was used.
pub fn of_scalar(
    name: &str,
    skipped: &Skipped,
    gaps: &GapSummary,
    used: &Innovations,
) -> Vec<String> {
    let mut remarks = Vec::new();
    if !skipped.is_empty() {
        remarks.push(format!("{name} log: {skipped}"));
    }
    if let (count, Some(longest)) = (gaps.count, gaps.longest) {
        remarks.push(format!(
            "{name} log: {count} gaps, the longest {:.3} s from {:.3} s",
            longest.length, longest.start
        ));
    }
    if used.updates == 0 {
        remarks.push(format!(
            "{name} log: nothing of it was used; compare its times with the IMU's, {name}.time_offset moves them"
        ));
    }
    if used.rejected + used.weakened > 0 {
        remarks.push(format!(
            "{name}: {} measurements left out and {} given less weight, far from what was predicted",
            used.rejected, used.weakened
        ));
    }
    remarks
}

/// What was left out of each log.
pub fn of_skipped(logs: &[(&str, &Skipped)]) -> Vec<String> {
    let any = logs.iter().filter(|(_, skipped)| !skipped.is_empty());
    any.map(|(log, skipped)| format!("{log} log: {skipped}"))
        .collect()
}

/// Autocorrelation of innovations above which it is not the accuracy of the fixes that is wrong.
const COLOURED: f64 = 0.5;

/// What a stated accuracy of a part of the fixes is, that is wrong by a factor.
pub fn of_accuracy(part: &str, factor: f64, summary: &Summary) -> String {
    let (times, direction) = if factor > 1.0 {
        (factor, "small")
    } else {
        (1.0 / factor, "large")
    };
    let mut text = format!(
        "the stated standard deviations of the {part} are about {times:.1} times too {direction} for the innovations"
    );
    let goes_on = [&summary.position, &summary.velocity]
        .iter()
        .any(|sums| sums.autocorrelation().is_some_and(|(c, _)| c > COLOURED));
    if summary.adapted.iter().any(Option::is_some) {
        text += "; they were adapted";
    } else {
        text += &format!(
            ": set gnss.{part}_std_factor to {factor:.2} times what it is, or gnss.adapt = true"
        );
        if goes_on && factor > 1.0 {
            text += "; but the innovations go on from fix to fix, so that the noise model, the mounting, the lever arm or the times may be wrong rather than the accuracy";
        }
    }
    text
}

/// Runs of fixes left out that are told one by one.
const TOLD: usize = 12;

fn of(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Position => ("position", "m"),
        Part::Velocity => ("velocity", "m/s"),
    }
}

/// Which fixes were left out.
fn of_contradictions(summary: &Summary) -> Vec<String> {
    let mut remarks = Vec::new();
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
        remarks.push(format!(
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
        remarks.push(format!(
            "and {} more such spans, in {gave_way} of which the solution gave way; --json has {}",
            more as u64 + summary.more_contradictions,
            if summary.more_contradictions > 0 {
                "the first 1000"
            } else {
                "all"
            }
        ));
    }
    remarks
}
