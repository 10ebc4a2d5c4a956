//! What a noise buys: drift on spans without fixes that the fit has not seen.

use super::fit::FitLog;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_base::{order_statistics::quantile, parallel};
use undrift_drive::{
    outages::{OutageErrors, Reference, Rejected, run_against, withheld},
    reference::{Coverage, HORIZONTAL},
    replay::Outage,
};
use undrift_engine::settings::Settings;
use undrift_nav::sample::TruthSample;

/// Lengths of the outages \[s\].
const LENGTHS: [f64; 3] = [10.0, 30.0, 60.0];
/// The same of poses, which come many times a second.
const POSED: [f64; 3] = [1.0, 3.0, 10.0];
/// The one that counts most \[s\], and that of poses.
const REPORTED: [f64; 2] = [30.0, 10.0];
/// Seed of the bootstrap.
const SEED: u64 = 1;
/// They follow each other in so many runs, so that none begins before the filter has recovered.
const RUNS: usize = 3;
/// Outages of poses begin at so many places within their length, so that the few long ones are some dozens …
const STAGGERED: usize = 3;
/// … where they are so long \[s\].
const LONG: f64 = 2.0;
/// Resamples of the bootstrap.
const RESAMPLES: usize = 2000;
/// After the last fix that the fit has seen \[s\].
const APART: f64 = 5.0;

/// Drift over outages of one length.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Length \[s\].
    pub length: f64,
    /// Largest horizontal error of each outage, before and after \[m\].
    pub drift: Vec<[f64; 2]>,
    /// Which of them overlap: those of one number are no more than one for the intervals.
    pub overlap: Vec<usize>,
    /// Normalised error squared per degree of freedom of position and attitude at the end of each, before and after; not a number where
    /// the reference has no attitude.
    pub nees: Vec<[[f64; 2]; 2]>,
    /// Shares of the position's errors inside one, two and three standard deviations, before and after.
    pub within: [[f64; 3]; 2],
}

impl Judged {
    /// Root mean squares before and after \[m\].
    pub fn rms(&self) -> [f64; 2] {
        rms(self.drift.iter().copied())
    }

    /// After over before with its 95 % interval.
    pub fn ratio(&self) -> [f64; 3] {
        self.with_interval(&|drawn| {
            let [before, after] = rms(drawn.iter().map(|k| self.drift[*k]));
            after / before
        })
    }

    /// Mean of the normalised errors squared per degree of freedom, before or after, of position or attitude, with its 95 % interval; 1 where
    /// covariances are right. `None` without.
    pub fn nees(&self, after: usize, group: usize) -> Option<[f64; 3]> {
        let mean = |drawn: &[usize]| {
            let all = drawn.iter().map(|k| self.nees[*k][after][group]);
            all.sum::<f64>() / drawn.len() as f64
        };
        Some(self.with_interval(&mean)).filter(|found| found.iter().all(|n| n.is_finite()))
    }

    /// A statistic of the outages by their places with its 95 % interval, by the bootstrap over those that do not overlap (Efron & Tibshirani
    /// 1993, chapter 13).
    fn with_interval(&self, of: &dyn Fn(&[usize]) -> f64) -> [f64; 3] {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(SEED);
        let n = self.overlap.iter().max().map_or(0, |most| most + 1);
        let mut together = vec![Vec::new(); n];
        for (k, at) in self.overlap.iter().enumerate() {
            together[*at].push(k);
        }
        let mut draw = |_| {
            let drawn = (0..n).flat_map(|_| &together[random.random_range(0..n)]);
            of(&Vec::from_iter(drawn.copied()))
        };
        let drawn: Vec<f64> = (0..RESAMPLES).map(&mut draw).collect();
        let all = Vec::from_iter(0..self.drift.len());
        [of(&all), quantile(&drawn, 0.025), quantile(&drawn, 0.975)]
    }
}

fn rms(drift: impl ExactSizeIterator<Item = [f64; 2]> + Clone) -> [f64; 2] {
    let n = drift.len() as f64;
    [0, 1].map(|k| (drift.clone().map(|pair| pair[k] * pair[k]).sum::<f64>() / n).sqrt())
}

/// A drive to judge on.
pub struct Unseen<'a> {
    /// The drive.
    pub log: &'a FitLog<'a>,
    /// The reference; empty for the withheld fixes.
    pub truth: &'a [TruthSample],
    /// Settings before, and after with one density of white noise and, where that was tried, with white noise that follows
    /// the vibration.
    pub settings: Vec<Settings>,
    /// Fixes from the first to the last of these are not seen by the fit \[s\].
    pub span: (f64, f64),
}

/// What it changes if the filter's white noise follows the vibration (`imu.vibration`), with the factors found, in place of
/// one density for the whole drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Length of the outages \[s\].
    pub length: f64,
    /// Drift with it over drift without, and the 95 % interval.
    pub ratio: [f64; 3],
    /// By how much the log-likelihood of the fixes at the end of withheld spans is larger with it.
    pub gain: f64,
    /// Whether the fixes at the end of withheld spans are likelier with it.
    pub kept: bool,
}

/// What was measured on what the fit has not seen.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Drift before and after, by length.
    pub judged: Vec<Judged>,
    /// What it changes if the white noise follows the vibration, where it was tried.
    pub following: Option<Following>,
    /// Positions of the spans, and how many of them every run without outages rejects: they are no reference. None of both
    /// where there is a truth.
    pub withheld: [u64; 2],
}

impl Unseen<'_> {
    /// What the runs without outages under all of the settings reject, so that no noise chooses what it is judged by.
    fn rejected(&self) -> Rejected {
        if !self.truth.is_empty() {
            return Rejected::default();
        }
        let runs = parallel::map(self.settings.len(), |k| {
            Rejected::by_run(self.log.imu, self.log.aiding, &self.settings[k]).unwrap_or_default()
        });
        let all = runs.into_iter().reduce(|a, b| a.by_both(&b));
        all.unwrap_or_default()
    }

    /// Positions of the span, and how many of them are rejected.
    fn withheld(&self, rejected: &Rejected) -> [u64; 2] {
        let (from, to) = self.span;
        let is_reference = self.truth.is_empty();
        withheld(self.log.aiding, rejected, |time| {
            is_reference && from < time && time <= to
        })
    }
}

/// Runs outages of every length, back to back over the spans that the fit has not seen: drift before and after, where
/// `after` follows the vibration if the log-likelihood gains by it, and what following it changes, where there is a `gain`
/// to tell. A length that fits fewer than twice is omitted.
pub fn judge(drives: &[Unseen], gain: Option<f64>) -> Judgement {
    let rejected: Vec<Rejected> = drives.iter().map(Unseen::rejected).collect();
    let mut withheld = [0; 2];
    for (drive, rejected) in drives.iter().zip(&rejected) {
        let counts = drive.withheld(rejected);
        withheld = [withheld[0] + counts[0], withheld[1] + counts[1]];
    }
    let kept = gain.is_some_and(|gain| gain >= 0.0);
    let (mut judged, mut gains) = (Vec::new(), Vec::new());
    let posed = drives
        .iter()
        .any(|drive| drive.log.settings.marker.is_some());
    let lengths = if posed { POSED } else { LENGTHS };
    let reported = REPORTED[usize::from(posed)];
    for length in lengths {
        let [before, steady, following] = run_all(drives, &rejected, length, gain.is_some());
        let after = if kept { &following } else { &steady };
        judged.extend(compared(length, &before, after));
        gains.extend(compared(length, &steady, &following));
    }
    let reported = gains.iter().find(|judged| judged.length == reported);
    let following = reported
        .or(gains.last())
        .zip(gain)
        .map(|(reported, gain)| Following {
            length: reported.length,
            ratio: reported.ratio(),
            gain,
            kept,
        });
    Judgement {
        judged,
        following,
        withheld,
    }
}

/// The outages of a pass over a drive, and from when on there are any in it \[s\].
struct Pass {
    from: f64,
    errors: Vec<OutageErrors>,
}

/// Each pass over the drives; `None` for a pass without a solution.
type Passes = Vec<Option<Pass>>;

/// Of a quotient of times.
const ROUNDING: f64 = 1e-6;

/// Runs the outages of one length under each of the settings.
fn run_all(drives: &[Unseen], rejected: &[Rejected], length: f64, follows: bool) -> [Passes; 3] {
    let mut all: [Passes; 3] = Default::default();
    for (drive, rejected) in drives.iter().zip(rejected) {
        let (from, to) = (drive.span.0 + APART, drive.span.1);
        let posed = drive.log.settings.marker.is_some();
        let places = if posed && length > LONG { STAGGERED } else { 1 };
        let mut of_each = Vec::new();
        for place in 0..places {
            let from = from + length * place as f64 / places as f64;
            let count = ((to - from) / length).floor().max(0.0) as usize;
            let outage = |k: usize| Outage {
                start: from + k as f64 * length,
                end: from + (k + 1) as f64 * length,
            };
            of_each.extend((0..RUNS.min(count)).map(|offset| {
                let outages = (offset..count).step_by(RUNS).map(outage);
                Vec::from_iter(outages)
            }));
        }
        let passes = of_each.len();
        let mut runs = Vec::new();
        for settings in &drive.settings[..if follows { 3 } else { 2 }] {
            for outages in &of_each {
                let settings = Settings {
                    outages: outages.clone(),
                    ..settings.clone()
                };
                runs.push((String::new(), settings));
            }
        }
        let reference = Reference {
            truth: drive.truth,
            rejected,
        };
        let done = run_against(drive.log.imu, drive.log.aiding, reference, &runs, &|_| ());
        for (at, (_, ran)) in done.into_iter().enumerate() {
            all[at / passes].push(ran.ok().map(|ran| Pass {
                from,
                errors: ran.errors.per_outage,
            }));
        }
    }
    all
}

/// Drift over the outages that have one under both settings; `None` of fewer than two.
fn compared(length: f64, before: &Passes, after: &Passes) -> Option<Judged> {
    let mut drift = Vec::new();
    let (mut overlap, mut seen) = (Vec::new(), Vec::new());
    let mut nees = Vec::new();
    let mut covered = [Coverage::default(), Coverage::default()];
    for pair in before.iter().zip(after) {
        let (Some(before), Some(after)) = pair else {
            continue;
        };
        for (a, b) in before.errors.iter().zip(&after.errors) {
            let pair = [a.max.0[HORIZONTAL], b.max.0[HORIZONTAL]];
            if pair.iter().all(|drift| drift.is_finite()) {
                drift.push(pair);
                // Of one drive, and begun within one length.
                let at = ((a.start_s - before.from) / length + ROUNDING).floor();
                let at = (before.from.to_bits(), at as i64);
                let place = seen.iter().position(|other| *other == at);
                overlap.push(place.unwrap_or(seen.len()));
                if place.is_none() {
                    seen.push(at);
                }
                nees.push([a, b].map(|of| [of.nees[0], of.nees[2]]));
                covered[0].add(&a.end, &a.sigma);
                covered[1].add(&b.end, &b.sigma);
            }
        }
    }
    let within = covered.map(|covered| covered.shares(0).unwrap_or([f64::NAN; 3]));
    (seen.len() > 1).then_some(Judged {
        length,
        drift,
        overlap,
        nees,
        within,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_drive::{reference::Errors, replay::Measurement};
    use undrift_nav::{Vector3, sample::Position, shaping::ShapingFilter};
    use undrift_simulate::{GnssNoise, Trajectory, simulate};

    /// Two fixes of a half minute that are 10 m off, for the same noise before and after: the drift is that of right fixes,
    /// and they are counted.
    #[test]
    fn fixes_that_are_rejected_under_every_noise_are_no_reference() {
        let white = |density: f64| ShapingFilter::white(density, 0.04).unwrap();
        let (gyro, accel) = (white(1e-4), white(1e-3));
        let sensors = [gyro, gyro, gyro, accel, accel, accel];
        let receiver = GnssNoise {
            position_std: [0.5, 0.5, 1.0],
            velocity_std: [0.05; 3],
            ..GnssNoise::default()
        };
        let car = Trajectory::car(160.0, 2);
        let log = simulate(&car, 25.0, Some(&sensors), &receiver, 2).unwrap();
        let judged = |every: Option<usize>| {
            let fixes = log.gnss.iter().enumerate().map(|(k, fix)| {
                let mut fix = *fix;
                if let Some((Position::Geodetic(at), _)) = &mut fix.position
                    && every.is_some_and(|every| k % every == 0)
                {
                    *at = at.displaced(&Vector3::new(8.0, 6.0, 0.0));
                }
                Measurement::Gnss(fix)
            });
            let fixes: Vec<Measurement> = fixes.collect();
            let settings = Settings::new(sensors);
            let log = FitLog {
                imu: &log.imu,
                aiding: &fixes,
                settings: settings.clone(),
                until: 80.0,
            };
            let unseen = Unseen {
                log: &log,
                truth: &[],
                settings: vec![settings.clone(), settings],
                span: (80.0, 160.0),
            };
            judge(&[unseen], None)
        };
        let (right, wrong) = (judged(None), judged(Some(16)));
        assert_eq!((right.withheld, wrong.withheld[1]), ([80, 0], 5));
        for (right, wrong) in right.judged.iter().zip(&wrong.judged) {
            assert_eq!(right.length, wrong.length);
            let [right, wrong] = [right.rms()[0], wrong.rms()[0]];
            // As references they would make it 9 m in 10 s; the filter has five fixes fewer.
            assert!(wrong < 2.0 * right + 2.0, "{wrong} {right}");
        }
    }

    /// An outage with its largest horizontal error and a north error at its end, of a standard deviation of 1 m.
    fn outage(largest: f64, end: f64) -> OutageErrors {
        let mut errors = OutageErrors {
            start_s: 0.0,
            max: Errors::UNKNOWN,
            end: Errors::UNKNOWN,
            sigma: Errors([1.0; 10]),
            nees: [f64::NAN; 3],
            covered: Coverage::default(),
            drift: Vec::new(),
            way: Vec::new(),
        };
        errors.max.0[HORIZONTAL] = largest;
        errors.end.0[0] = end;
        errors
    }

    /// Pairs of the same outage before and after: largest errors as drift, errors at the end against σ.
    #[test]
    fn drift_is_of_the_largest_errors_and_coverage_of_those_at_the_end() {
        // Begun 10 s apart, in the order of the passes.
        let pass = |errors: &[OutageErrors], first: f64| {
            let begun = errors.iter().enumerate().map(|(k, of)| OutageErrors {
                start_s: 100.0 + first + 90.0 * k as f64,
                ..of.clone()
            });
            let errors = begun.collect();
            Some(Pass {
                from: 100.0,
                errors,
            })
        };
        let mut before = vec![
            pass(
                &[outage(6.0, 0.5), outage(8.0, 1.5), outage(f64::NAN, 0.0)],
                0.0,
            ),
            None,
            pass(&[outage(10.0, 2.5)], 60.0),
        ];
        let after = vec![
            pass(&[outage(3.0, 0.1), outage(4.0, 0.2), outage(1.0, 0.3)], 0.0),
            pass(&[outage(9.0, 9.0)], 30.0),
            pass(&[outage(5.0, 3.5)], 60.0),
        ];
        let mut judged = compared(30.0, &before, &after).unwrap();
        assert_eq!(judged.drift, [[6.0, 3.0], [8.0, 4.0], [10.0, 5.0]]);
        let third = 1.0 / 3.0;
        assert_eq!(judged.within, [[third, 2.0 * third, 1.0], [2.0 * third; 3]]);
        let [rms_before, rms_after] = judged.rms();
        assert!((rms_before - (200f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((rms_after - (50f64 / 3.0).sqrt()).abs() < 1e-12);
        // Half in every outage is half in every draw.
        assert!(
            judged
                .ratio()
                .iter()
                .all(|ratio| (ratio - 0.5).abs() < 1e-12)
        );
        assert_eq!(judged.overlap, [0, 1, 2]);
        // The last two overlap where outages last 60 s: NEES 1 and 7 are one draw, beside 4.
        judged.overlap = vec![0, 1, 1];
        judged.nees = [4.0, 1.0, 7.0].map(|nees| [[nees, f64::NAN]; 2]).to_vec();
        assert_eq!(judged.nees(1, 0), Some([4.0; 3]));
        assert_eq!(judged.nees(1, 1), None);
        before.drain(..2);
        assert!(compared(30.0, &before, &after[2..].iter().map(|_| None).collect()).is_none());
    }
}
