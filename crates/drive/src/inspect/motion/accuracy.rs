//! How accurate positions are that do not say so, by how well the solution predicts withheld ones.

use super::{At, Inspection, Line, Motion, Wheels, beginning, drive_of};
use crate::{
    align::Heading,
    drive::{Drive, Logs as Files},
    inspect::{POSITION_STD, Part},
    navigate::{Hindsight, settings},
    outages::{Logs, ModelOutcome, OutageErrors, Schedule, run},
    replay::{Measurement, Settings},
    vehicle::Profile,
};
use std::path::Path;
use undrift_base::parallel;
use undrift_noise::BiasModel;
use undrift_results::inspect::Known;

/// Shares of the guessed standard deviation that are tried, the guess first: 3 m, 1 m, 0.3 m, 0.1 m.
const SHARES: [f64; 4] = [1.0, 1.0 / 3.0, 0.1, 1.0 / 30.0];
/// Withheld spans: the first so long after the first fix in each of two runs, from one to the next, and length \[s\].
const STARTS: [f64; 2] = [20.0, 26.0];
const EVERY: f64 = 12.0;
const LENGTH: f64 = 10.0;
/// Spans that are needed, and part of a log that is looked at \[s\].
const LEAST: usize = 6;
const LONGEST: f64 = 900.0;
/// Degrees of freedom of Student's distribution: a fix that is wrong counts little.
const TAILS: f64 = 4.0;
/// Logarithm of the likelihood that a smaller standard deviation has to gain, in all and for each span: a third of what errors
/// a third as large gain on two axes. Where it gains less, other errors than those of the fixes decide.
const GAIN: (f64, f64) = (4.0, 0.7);
/// Share of the errors inside three standard deviations that it has to have, and how much larger the errors may be by chance.
const INSIDE: f64 = 0.95;
const WORSE: f64 = 1.1;
/// Share of the spans with the guess that another accuracy has to have.
const KEPT: f64 = 0.8;

/// Puts the accuracy that withheld positions show in place of a guessed one.
pub(super) fn write(inspections: &mut [Inspection], places: [At; 2], logs: Files, motion: Motion) {
    let [_, (file, part)] = places;
    let guessed =
        |line: &Line| line.key == "position_std" && line.value.as_str() == Some(POSITION_STD);
    if !inspections[file].parts[part].lines.iter().any(guessed) {
        return;
    }
    let drive = so_far(inspections, places, logs, motion);
    let Some((share, spans)) = drive.and_then(|drive| likeliest(&drive)) else {
        return;
    };
    let mut lines = inspections[file].parts[part].lines.iter_mut();
    if let Some(line) = lines.find(|line| guessed(line)) {
        let [across, up] = [3.0, 6.0].map(|guess: f64| (10.0 * share * guess).round() / 10.0);
        *line = Line::new(
            "position_std",
            format!("{across}, {across}, {up} m"),
            Known::Withheld { spans },
        );
    }
}

/// The beginning of the drive of an IMU and fixes, as far as its file is known by their motion.
pub(super) fn so_far(
    inspections: &[Inspection],
    places: [At; 2],
    logs: Files,
    motion: Motion,
) -> Option<Drive> {
    let of = |(file, part): At| -> (&Path, &Part) {
        (&inspections[file].file, &inspections[file].parts[part])
    };
    let mut drive = drive_of(&places.map(of), logs, None).ok()?;
    if motion.heading {
        drive.align.heading = Heading::Auto;
    }
    if motion.wheels == Wheels::Shown {
        drive = drive.with_vehicle(Profile::Car);
    }
    beginning(drive, LONGEST)
}

/// The share of the guessed standard deviations with which the solution drifts least, of those under which the withheld positions are
/// likelier than with the guess, and the number of spans that say so.
fn likeliest(drive: &Drive) -> Option<(f64, usize)> {
    let logs = Logs::load(drive, Hindsight::Causal).ok()?;
    let settings = settings(&logs.drive, BiasModel::Arma).ok()?;
    let withheld = STARTS.map(|start| withheld(&logs, &settings, [start, EVERY, LENGTH]));
    let models: Vec<_> = withheld.into_iter().collect::<Option<_>>()?;
    let runs: Vec<Vec<OutageErrors>> = parallel::map(SHARES.len(), |k| {
        let aiding = logs.aiding.iter().map(|one| scaled(*one, SHARES[k]));
        let aiding: Vec<_> = aiding.collect();
        errors(run(&logs.imu, &aiding, &[], &models, &|_| ()))
    });
    let judged = judged(&runs);
    let (guess, _) = judged.first().filter(|(guess, _)| guess.spans >= LEAST)?;
    let better = judged.iter().filter(|(one, _)| one.is_better_than(guess));
    let (best, tried) = better.min_by(|(a, _), (b, _)| a.drift.total_cmp(&b.drift))?;
    Some((SHARES[*tried], best.spans))
}

/// The settings with spans of the fixes withheld: the first so long after the first fix, from one to the next, and length \[s\]. `None`
/// where there is no room for one.
pub(super) fn withheld(
    logs: &Logs,
    settings: &Settings,
    [start, every, length]: [f64; 3],
) -> Option<(String, Settings)> {
    let plan = Schedule::Every {
        start,
        every,
        count: None,
    };
    let outages = logs.plan(&plan, length).ok()?;
    let settings = Settings {
        outages,
        ..settings.clone()
    };
    Some((String::new(), settings))
}

/// The outages of runs that ended.
pub(super) fn errors(ended: Vec<ModelOutcome>) -> Vec<OutageErrors> {
    let runs = ended.into_iter().filter_map(|(_, run)| run.ok());
    runs.flat_map(|run| run.errors.per_outage).collect()
}

/// What was tried, the first without anything, by its place: how likely the withheld fixes are in the spans that all end.
pub(super) fn judged(runs: &[Vec<OutageErrors>]) -> Vec<(Judged, usize)> {
    // A span without a fix near its end shows nothing, nor does what hardly navigates a drive.
    let ends = |one: &OutageErrors| one.end.0[0].is_finite() && one.end.0[1].is_finite();
    let ended = |run: &[OutageErrors]| run.iter().filter(|one| ends(one)).count();
    let enough = KEPT * ended(&runs[0]) as f64;
    let tried = runs.iter().zip(0..);
    let tried: Vec<_> = tried
        .filter(|(run, _)| ended(run) as f64 >= enough)
        .collect();
    let in_all = |one: &&OutageErrors| {
        let same = |other: &OutageErrors| other.start_s == one.start_s && ends(other);
        tried.iter().all(|(run, _)| run.iter().any(same))
    };
    let judged = tried
        .iter()
        .map(|(run, at)| (Judged::new(run.iter().filter(in_all)), *at));
    judged.collect()
}

/// The measurement with the standard deviations of a position multiplied.
fn scaled(mut measurement: Measurement, factor: f64) -> Measurement {
    if let Measurement::Gnss(fix) = &mut measurement
        && let Some((_, covariance)) = &mut fix.position
    {
        *covariance *= factor * factor;
    }
    measurement
}

/// Horizontal errors at the ends of the spans.
pub(super) struct Judged {
    pub(super) spans: usize,
    /// Logarithm of the likelihood under the predicted standard deviations, but for a constant.
    pub(super) likelihood: f64,
    /// Sum of squares \[m²\].
    pub(super) drift: f64,
    /// Sum of the sizes \[m\], in which one span weighs less.
    sizes: f64,
    /// Share inside three standard deviations.
    inside: f64,
}

impl Judged {
    /// Whether the fixes are likelier than with the guess, within the standard deviations, and the drift is not larger but by chance.
    fn is_better_than(&self, guess: &Self) -> bool {
        self.likelihood - guess.likelihood > GAIN.0.max(GAIN.1 * guess.spans as f64)
            && self.inside >= INSIDE
            && self.sizes < WORSE * guess.sizes
    }

    fn new<'a>(ends: impl Iterator<Item = &'a OutageErrors>) -> Self {
        let mut judged = Self {
            spans: 0,
            likelihood: 0.0,
            drift: 0.0,
            sizes: 0.0,
            inside: 0.0,
        };
        for end in ends {
            judged.spans += 1;
            for axis in [0, 1] {
                let (error, sigma) = (end.end.0[axis], end.sigma.0[axis]);
                let square = (error / sigma).powi(2);
                judged.likelihood -= 0.5 * (TAILS + 1.0) * (square / TAILS).ln_1p() + sigma.ln();
                judged.drift += error * error;
                judged.sizes += error.abs();
                judged.inside += f64::from(u8::from(square < 9.0));
            }
        }
        judged.inside /= 2.0 * judged.spans as f64;
        judged
    }
}
