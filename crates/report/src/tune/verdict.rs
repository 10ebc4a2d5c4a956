//! Whether to use what was tuned, and why: one line.

use crate::{
    numbers::{short, span},
    say::{say, usable},
};
use undrift_results::{
    Tune, TunedDrift,
    findings::{self, Severity},
    usability::Usability,
};

/// What to navigate with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// The noise found.
    Tuned,
    /// The drives as they are.
    AsBefore,
}

/// Share of the errors inside two standard deviations from which on these are right.
const HONEST: f64 = 0.9;
/// The same at the lengths that do not decide, of fewer outages.
const NEARLY: f64 = 0.8;
/// The length that decides where the others do not differ \[s\]; drives by poses have no outages of that length: their longest decide.
const DECIDES: f64 = 30.0;

/// What to use and why, in a line: the first of what is printed of it.
pub fn verdict(tune: &Tune) -> String {
    let (severity, what, why) = judgement(tune);
    format!("{}: use {}, {why}", usable(severity), named(tune, what))
}

/// Whether the noise found can be used.
pub fn usability(tune: &Tune) -> Usability {
    judgement(tune).0.into()
}

/// Whether the verdict is `usable`.
pub fn is_usable(tune: &Tune) -> bool {
    judgement(tune).0 == Severity::Note
}

/// Whether what was found is worse than what was there before.
pub fn is_worse(tune: &Tune) -> bool {
    judgement(tune).0 == Severity::Unusable
}

fn named(tune: &Tune, what: Use) -> String {
    match (what, tune.drives.as_slice()) {
        (Use::Tuned, _) => tune.tuned.clone().unwrap_or("the noise found".into()),
        (Use::AsBefore, [drive]) => drive.file.clone().unwrap_or("the drive as it is".into()),
        (Use::AsBefore, _) => "the drive files as they are".into(),
    }
}

pub(super) fn judgement(tune: &Tune) -> (Severity, Use, String) {
    let (severity, what, why) = of_drift(tune);
    // Whatever is found is of poses that do not go with the samples.
    match findings::verdict(&tune.pose_faults) {
        (Severity::Unusable, Some(cause)) => (Severity::Unusable, Use::AsBefore, say(cause)),
        (found, Some(cause)) if found > severity => (found, what, say(cause)),
        _ => (severity, what, why),
    }
}

fn of_drift(tune: &Tune) -> (Severity, Use, String) {
    use Severity::{Note, Unusable, Warning};
    if let [first, ..] = tune.unaligned.as_slice() {
        let why = format!(
            "{first} cannot be aligned with the noise found. Set `attitude` under [initial], or tune on a \
             longer drive with more turns and changes of speed"
        );
        return (Unusable, Use::AsBefore, why);
    }
    if tune.stopped {
        let why = "as the fit was stopped early and not tested";
        return (Warning, Use::AsBefore, why.into());
    }
    let judged = |length: f64| tune.drift.iter().find(|d| d.length_s.0 == length);
    let Some(main) = judged(DECIDES).or_else(|| tune.drift.last()) else {
        let why = "not tested, because the drives are too short to hold out outages; tune on longer drives";
        return (Warning, Use::AsBefore, why.into());
    };
    // The length that decides first, so that it is spoken of where it differs.
    let all = || std::iter::once(main).chain(tune.drift.iter().filter(|d| *d != main));
    let worse = all().find(|d| d.ratio_low.0 > 1.0);
    let better = all().find(|d| d.ratio_high.0 < 1.0);
    let holds = |within: [f64; 2]| within[0] >= HONEST && within[1] >= NEARLY;
    let least = |of: fn(&TunedDrift) -> f64| tune.drift.iter().map(of).fold(1.0, f64::min);
    let was_honest = holds([main.before_within[1].0, least(|d| d.before_within[1].0)]);
    let is_honest = holds([main.after_within[1].0, least(|d| d.after_within[1].0)]);
    let at = |drift: &TunedDrift| span(drift.length_s.0);
    let (severity, what, found, of) = match (worse, better) {
        (Some(worse), None) => (
            Unusable,
            Use::AsBefore,
            "more drift when tuned".into(),
            worse,
        ),
        (Some(worse), Some(better)) => {
            let found = format!(
                "more drift in {} when tuned, if less in {}",
                at(worse),
                at(better)
            );
            (Unusable, Use::AsBefore, found, worse)
        }
        (None, Some(better)) if !tune.converged => {
            let found = "less drift, but the fit has not converged";
            (Warning, Use::Tuned, found.into(), better)
        }
        (None, None) if !tune.converged => {
            let found = "nothing gained, and the fit has not converged";
            (Warning, Use::AsBefore, found.into(), main)
        }
        (None, Some(better)) if is_honest => (Note, Use::Tuned, "less drift".into(), better),
        (None, Some(better)) => {
            let found = "less drift, but the solution is optimistic";
            (Warning, Use::Tuned, found.into(), better)
        }
        (None, None) if is_honest && !was_honest => {
            let found = "the same drift within chance, and σ that holds it";
            (Note, Use::Tuned, found.into(), main)
        }
        (None, None) if is_honest => {
            let found = "nothing to gain: no significant change of drift";
            (Note, Use::AsBefore, found.into(), main)
        }
        (None, None) => {
            let found =
                "nothing to gain: no significant change of drift, and the solution is optimistic";
            (Warning, Use::AsBefore, found.into(), main)
        }
    };
    let posed = tune.parameters.iter().any(|p| p.name.starts_with("poses."));
    let fixes = if posed { "poses" } else { "GNSS" };
    let why = format!(
        "{found}. {} without {fixes}: {} m; before: {} m (ratio {}, 95 % interval {} to {}), over {} held-out outages",
        at(of),
        short(of.after_m.0),
        short(of.before_m.0),
        short(of.ratio.0),
        short(of.ratio_low.0),
        short(of.ratio_high.0),
        of.outages
    );
    (severity, what, why)
}

#[cfg(test)]
mod tests {
    use super::{super::tests::of_length, *};
    use undrift_results::Drive;

    fn tune(ratios: [[f64; 3]; 2]) -> Tune {
        Tune {
            drives: vec![Drive {
                file: Some("drive.toml".into()),
                ..Drive::default()
            }],
            tuned: Some("tuned.toml".into()),
            converged: true,
            drift: vec![of_length(10.0, ratios[0]), of_length(30.0, ratios[1])],
            ..Tune::default()
        }
    }

    const SAME: [f64; 3] = [1.0, 0.9, 1.1];
    const LESS: [f64; 3] = [0.5, 0.4, 0.6];
    const MORE: [f64; 3] = [2.0, 1.1, 3.0];

    #[test]
    fn the_line_names_the_file_to_use_and_why() {
        assert_eq!(
            verdict(&tune([SAME, LESS])),
            "usable: use tuned.toml, less drift. 30 s without GNSS: 4.00 m; before: 8.00 m (ratio 0.500, 95 % interval 0.400 to 0.600), over 24 held-out outages"
        );
        let mut open = tune([SAME, LESS]);
        open.tuned = None;
        assert!(verdict(&open).starts_with("usable: use the noise found, less drift. "));
        open.drift[1] = of_length(30.0, MORE);
        assert!(
            verdict(&open).starts_with("not usable: use drive.toml, more drift when tuned. 30 s")
        );
        open.drives = vec![Drive::default(); 2];
        assert!(verdict(&open).starts_with("not usable: use the drive files as they are, more"));
    }

    /// No line says otherwise than a row of the table: whatever is worse at any length beyond chance is no improvement.
    #[test]
    fn every_length_counts() {
        use Severity::{Note, Unusable, Warning};
        for (ratios, severity, what, why) in [
            ([SAME, LESS], Note, Use::Tuned, "less drift. 30 s"),
            ([LESS, SAME], Note, Use::Tuned, "less drift. 10 s"),
            ([LESS, LESS], Note, Use::Tuned, "less drift. 30 s"),
            (
                [MORE, SAME],
                Unusable,
                Use::AsBefore,
                "more drift when tuned. 10 s",
            ),
            (
                [SAME, MORE],
                Unusable,
                Use::AsBefore,
                "more drift when tuned. 30 s",
            ),
            (
                [MORE, LESS],
                Unusable,
                Use::AsBefore,
                "more drift in 10 s when tuned, if less in 30 s. 10 s",
            ),
            // σ was too small before, and is not any more.
            (
                [SAME, SAME],
                Note,
                Use::Tuned,
                "the same drift within chance, and σ that holds it. 30 s",
            ),
        ] {
            let of = tune(ratios);
            let found = judgement(&of);
            assert_eq!((found.0, found.1), (severity, what), "{ratios:?}");
            assert!(found.2.starts_with(why), "{}", found.2);
            assert_eq!(is_usable(&of), severity == Note);
            assert_eq!(is_worse(&of), severity == Unusable);
            let mut unfinished = of.clone();
            unfinished.converged = false;
            assert_eq!(judgement(&unfinished).0, severity.max(Warning));
        }
        // The interval has to leave out 1.
        for ratio in [[1.0, 0.9, 1.0], [1.0, 1.0, 1.1]] {
            let found = judgement(&tune([SAME, ratio]));
            assert!(found.2.starts_with("the same drift"), "{}", found.2);
        }
    }

    #[test]
    fn where_nothing_changes_there_is_nothing_to_gain() {
        let within = |before: f64, after: [f64; 2]| {
            let mut tune = tune([SAME, SAME]);
            for (drift, after) in tune.drift.iter_mut().zip(after) {
                drift.before_within[1] = before.into();
                drift.after_within[1] = after.into();
            }
            let (severity, what, why) = judgement(&tune);
            (
                severity,
                what,
                why.split(". ").next().unwrap_or_default().to_owned(),
            )
        };
        let nothing = "nothing to gain: no significant change of drift";
        assert_eq!(
            within(0.95, [0.95; 2]),
            (Severity::Note, Use::AsBefore, nothing.into())
        );
        // The length that decides needs nine tenths inside two sigmas, the others eight.
        for after in [[0.95, 0.89], [0.79, 0.95]] {
            let optimistic = format!("{nothing}, and the solution is optimistic");
            assert_eq!(
                within(0.95, after),
                (Severity::Warning, Use::AsBefore, optimistic)
            );
        }
        assert_eq!(within(0.95, [0.81, 0.9]).0, Severity::Note);
    }

    #[test]
    fn what_is_not_tested_is_not_recommended() {
        let changed = |change: fn(&mut Tune)| {
            let mut tune = tune([SAME, LESS]);
            change(&mut tune);
            judgement(&tune)
        };
        let untested = changed(|tune| tune.drift.clear());
        assert_eq!((untested.0, untested.1), (Severity::Warning, Use::AsBefore));
        assert!(untested.2.starts_with("not tested"));
        let stopped = changed(|tune| tune.stopped = true);
        assert_eq!((stopped.0, stopped.1), (Severity::Warning, Use::AsBefore));
        let unaligned = changed(|tune| tune.unaligned = vec!["a.toml".into()]);
        assert_eq!(
            (unaligned.0, unaligned.1),
            (Severity::Unusable, Use::AsBefore)
        );
        assert!(unaligned.2.starts_with("a.toml cannot be aligned"));
        // Without outages of 30 s the longest decide.
        let shorter = changed(|tune| tune.drift.truncate(1));
        assert!(
            shorter.2.contains(". 10 s without GNSS: 8.00 m"),
            "{}",
            shorter.2
        );
    }
}
