//! What goes on slowly in a part of a record that rests and is no noise of its sensor: small steps, a warm-up, cycles.

use super::{
    pieces::{beyond, longest_piece, within},
    steps::Step,
    windows::{STEPS, Windows},
};
use std::ops::Range;
use undrift_noise::{
    identify::SHORTEST,
    screening::{Disturbance, Shape, disturbances},
};
use undrift_results::{Omission, Omitted};

/// Shares of a part that are cut off for a warm-up, the least that is enough; beyond the last it is subtracted.
const CUTS: [f64; 7] = [0.0, 1.0 / 32.0, 0.0625, 0.125, 0.25, 0.375, 0.5];

/// A part without what goes on slowly.
pub(super) struct Steady {
    /// Windows that are kept.
    pub(super) kept: Range<usize>,
    /// What is left out for it, or subtracted.
    pub(super) left_out: Vec<Omitted>,
    /// What is subtracted.
    pub(super) subtracted: Vec<Subtracted>,
}

/// A disturbance that is subtracted from the samples of an axis in the part that is used.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Subtracted {
    axis: usize,
    width: usize,
    of: Disturbance,
}

impl Subtracted {
    /// Subtracts it from the samples of its axis, of the part that is used.
    pub(super) fn subtract_from(&self, samples: &mut [Vec<f64>]) {
        let width = self.width as f64;
        for samples in samples.iter_mut().skip(self.axis).take(1) {
            for (k, sample) in samples.iter_mut().enumerate() {
                *sample -= self.of.value((k as f64 + 0.5) / width);
            }
        }
    }
}

/// The windows of a part, some of which are disturbed, without the shorter sides of small steps and without a warm-up; and what
/// is subtracted from them.
pub(super) fn without_slow(
    windows: &Windows,
    part: &Range<usize>,
    disturbed: &[bool],
    rate_hz: f64,
) -> Steady {
    let seconds = |window: usize| (window * windows.width) as f64 / rate_hz;
    let find = |range: &Range<usize>| in_axes(windows, range, part, disturbed);
    let mut steady = Steady {
        kept: part.clone(),
        left_out: Vec::new(),
        subtracted: Vec::new(),
    };
    let mut found = find(part);
    let steps = steps_of(windows, part, &found);
    let piece = longest_piece(part, &steps);
    if !steps.is_empty() && piece.len() * windows.width >= SHORTEST {
        let omitted = |(step, range): (&Step, Range<usize>)| Omitted {
            why: Omission::Step,
            start_s: seconds(range.start).into(),
            end_s: seconds(range.end).into(),
            axis: Some(step.axis.to_owned()),
            step: step.size.into(),
            ..Omitted::default()
        };
        let omitted = beyond(&steps, part, &piece).map(omitted);
        steady.left_out.extend(omitted);
        found = find(&piece);
        steady.kept = piece;
    }
    let whole = steady.kept.clone();
    // The axis that drifts most beyond its noise says why.
    let warmest = warm_ups(&found).max_by(|a, b| a.1.fall.total_cmp(&b.1.fall));
    let warmest = warmest.and_then(|(axis, _)| Some((axis, WarmUp::find(&found[axis])?)));
    let warming: Vec<(usize, Disturbance)> =
        warm_ups(&found).map(|(axis, of)| (axis, *of)).collect();
    for share in CUTS {
        let start = whole.start + (share * whole.len() as f64).round() as usize;
        if warm_ups(&found).next().is_none() || (whole.end - start) * windows.width < SHORTEST {
            break;
        }
        steady.kept = start..whole.end;
        if share > 0.0 {
            found = find(&steady.kept);
        }
    }
    // The tail of what was found is there where it does not show by itself, too.
    let shown: Vec<bool> = found.iter().map(|of| WarmUp::find(of).is_some()).collect();
    let cut = (steady.kept.start - whole.start) as f64;
    for (axis, of) in warming.into_iter().filter(|(axis, _)| !shown[*axis]) {
        found[axis].push(Disturbance {
            coefficients: [of.value(cut), 0.0],
            ..of
        });
    }
    let mut leave_out = |why, range: &Range<usize>, axis: usize, size: f64, time: f64| {
        steady.left_out.push(Omitted {
            why,
            start_s: seconds(range.start).into(),
            end_s: seconds(range.end).into(),
            axis: Some(windows.axes[axis].0.to_owned()),
            step: size.into(),
            time_s: (time * seconds(1)).into(),
        });
    };
    for cut in within(&whole, &steady.kept) {
        if let Some((axis, of)) = &warmest {
            leave_out(Omission::WarmUp, &cut, *axis, of.drift(cut.len()), of.tau);
        }
    }
    for (axis, of_axis) in found.iter().enumerate() {
        let kept = &steady.kept;
        if let Some(of) = WarmUp::find(of_axis) {
            leave_out(
                Omission::WarmUpRest,
                kept,
                axis,
                of.drift(kept.len()),
                of.tau,
            );
        }
        for one in of_axis {
            match one.shape {
                Shape::Step { .. } => continue,
                Shape::WarmUp(_) => {}
                Shape::Cycle(period) => {
                    leave_out(Omission::Cycle, kept, axis, one.size(), period);
                }
            }
            steady.subtracted.push(Subtracted {
                axis,
                width: windows.width,
                of: *one,
            });
        }
    }
    steady
}

/// The disturbances of each axis in a range of a part, of which some windows are disturbed otherwise.
fn in_axes(
    windows: &Windows,
    range: &Range<usize>,
    part: &Range<usize>,
    disturbed: &[bool],
) -> Vec<Vec<Disturbance>> {
    // Slope and square of the temperature, about its middle.
    let known = windows.temperature.as_ref().map(|means| {
        let means = &means[range.clone()];
        let centre = means.iter().sum::<f64>() / means.len().max(1) as f64;
        [1, 2].map(|power| Vec::from_iter(means.iter().map(|t| (t - centre).powi(power))))
    });
    let known = known.as_ref().map_or(&[][..], |known| known);
    let of = |levels: &super::windows::Levels| {
        let means = range.clone().map(|k| match disturbed[k - part.start] {
            true => f64::NAN,
            false => levels.means[k],
        });
        let mut found = disturbances(&Vec::from_iter(means), known);
        // Rounded samples step as their mean crosses from one value to the next.
        found.retain(|one| {
            !matches!(one.shape, Shape::Step { .. }) || one.size().abs() > STEPS * levels.step
        });
        found
    };
    windows.axes.iter().map(|(_, levels)| of(levels)).collect()
}

fn all(found: &[Vec<Disturbance>]) -> impl Iterator<Item = (usize, &Disturbance)> {
    let axes = found.iter().enumerate();
    axes.flat_map(|(axis, of_axis)| of_axis.iter().map(move |one| (axis, one)))
}

fn warm_ups(found: &[Vec<Disturbance>]) -> impl Iterator<Item = (usize, &Disturbance)> {
    all(found).filter(|(_, one)| matches!(one.shape, Shape::WarmUp(_)))
}

/// The warm-up of an axis, of which several exponentials may be parts.
struct WarmUp {
    parts: Vec<Disturbance>,
    /// Time constant of the clearest \[windows\].
    tau: f64,
}

impl WarmUp {
    fn find(of_axis: &[Disturbance]) -> Option<Self> {
        let parts = of_axis.iter().copied();
        let parts = Vec::from_iter(parts.filter(|one| matches!(one.shape, Shape::WarmUp(_))));
        let clearest = parts.iter().max_by(|a, b| a.fall.total_cmp(&b.fall))?;
        let Shape::WarmUp(tau) = clearest.shape else {
            return None;
        };
        Some(Self { parts, tau })
    }

    /// How far it drifts in so many windows \[unit\].
    fn drift(&self, windows: usize) -> f64 {
        let drift = |one: &Disturbance| one.value(windows as f64) - one.value(0.0);
        self.parts.iter().map(drift).sum()
    }
}

/// The steps among disturbances of a part, in order; of those that are near each other the clearest.
fn steps_of(windows: &Windows, part: &Range<usize>, found: &[Vec<Disturbance>]) -> Vec<Step> {
    let steps = all(found).filter_map(|(axis, one)| match one.shape {
        Shape::Step { from, to } => Some((
            one.fall,
            Step {
                axis: windows.axes[axis].0,
                size: one.size(),
                at: part.start + from..part.start + to,
            },
        )),
        _ => None,
    });
    let mut steps = Vec::from_iter(steps);
    steps.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut clearest: Vec<Step> = Vec::new();
    for (_, step) in steps {
        let apart = |other: &Step| other.at.end <= step.at.start || step.at.end <= other.at.start;
        if clearest.iter().all(apart) {
            clearest.push(step);
        }
    }
    clearest.sort_by_key(|step| step.at.start);
    clearest
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::record::Record;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn found(shape: Shape, size: f64, fall: f64) -> Disturbance {
        Disturbance {
            shape,
            coefficients: [size, 0.0],
            fall,
        }
    }

    /// Two axes in 4000 windows of 20 samples at 10 Hz: white noise, seed 1, to which `add` adds at a time in windows.
    fn windows(add: impl Fn(usize, f64) -> f64) -> Windows {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut of = |axis: usize| -> Vec<f64> {
            let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
            (0..80_000)
                .map(|k| 0.03 * noise() + add(axis, f64::from(k) / 20.0))
                .collect()
        };
        let record = Record {
            axes: vec!["gyro_x", "accel_y"],
            samples: vec![of(0), of(1)],
            ..Record::default()
        };
        Windows::new(&record, 10.0)
    }

    #[test]
    fn of_steps_near_each_other_the_clearest_is_one() {
        let windows = windows(|_, _| 0.0);
        assert_eq!((windows.width, windows.count), (20, 4000));
        let at = |from, to, size, fall| found(Shape::Step { from, to }, size, fall);
        let other = found(Shape::WarmUp(30.0), 9.0, 500.0);
        let of = [
            vec![at(40, 44, 1.0, 50.0), other, at(10, 14, 2.0, 40.0)],
            vec![at(42, 46, 3.0, 60.0), at(14, 18, 4.0, 35.0)],
        ];
        let steps = steps_of(&windows, &(100..200), &of);
        // 42..46 hides 40..44 of another axis; 14..18 begins where 10..14 ends.
        let exact = |axis, size, at| Step { axis, size, at };
        assert_eq!(
            steps,
            [
                exact("gyro_x", 2.0, 110..114),
                exact("accel_y", 4.0, 114..118),
                exact("accel_y", 3.0, 142..146),
            ]
        );
    }

    #[test]
    fn a_warm_up_is_all_its_parts_and_has_the_time_of_the_clearest() {
        let of = [
            found(Shape::WarmUp(30.0), 2.0, 90.0),
            found(Shape::Cycle(50.0), 7.0, 400.0),
            found(Shape::WarmUp(200.0), -1.0, 60.0),
        ];
        let warm_up = WarmUp::find(&of).unwrap();
        assert_eq!((warm_up.tau, warm_up.parts.len()), (30.0, 2));
        let exact = 2.0 * (-2f64).exp() - 2.0 - (-0.3f64).exp() + 1.0;
        assert!((warm_up.drift(60) - exact).abs() < 1e-12);
        assert!(WarmUp::find(&of[1..2]).is_none());
    }

    #[test]
    fn a_disturbance_is_subtracted_from_its_axis_at_the_time_of_each_sample() {
        let one = Subtracted {
            axis: 1,
            width: 4,
            of: found(Shape::WarmUp(3.0), 2.0, 90.0),
        };
        let mut samples = vec![vec![1.0; 8]; 3];
        one.subtract_from(&mut samples);
        assert!(samples[0] == [1.0; 8] && samples[2] == [1.0; 8]);
        for (k, sample) in samples[1].iter().enumerate() {
            // Windows of four samples, from the middle of a sample.
            let exact = 1.0 - 2.0 * (-(k as f64 + 0.5) / 4.0 / 3.0).exp();
            assert!((sample - exact).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn a_small_step_leaves_the_longer_side_and_a_rounded_one_is_none() {
        let step = |axis: usize, t: f64| if axis == 1 && t >= 1000.0 { 0.05 } else { 0.0 };
        let windows = windows(step);
        let part = 200..3800;
        let found = without_slow(&windows, &part, &vec![false; 3600], 10.0);
        assert_eq!((found.kept.end, found.subtracted.len()), (3800, 0));
        assert!(
            (1000..=1024).contains(&found.kept.start),
            "{:?}",
            found.kept
        );
        let [one] = &found.left_out[..] else {
            panic!("{:?}", found.left_out)
        };
        assert_eq!(
            (one.why, one.axis.as_deref()),
            (Omission::Step, Some("accel_y"))
        );
        // Two seconds a window.
        assert_eq!(
            (one.start_s.0, one.end_s.0),
            (400.0, 2.0 * found.kept.start as f64)
        );
        assert!((one.step.0 / 0.05 - 1.0).abs() < 0.05, "{one:?}");
        // Where the windows around it are disturbed otherwise it shows all the same.
        let mut disturbed = vec![false; 3600];
        disturbed[790..810].fill(true);
        let found = without_slow(&windows, &part, &disturbed, 10.0);
        assert!(
            (1000..=1048).contains(&found.kept.start),
            "{:?}",
            found.kept
        );
    }

    #[test]
    fn a_warm_up_is_cut_off_and_its_tail_subtracted() {
        let warm = windows(|axis, t| {
            if axis == 0 {
                -2.0 * (-t / 60.0).exp()
            } else {
                0.0
            }
        });
        let part = 0..4000;
        let disturbed = vec![false; 4000];
        let found = without_slow(&warm, &part, &disturbed, 10.0);
        // Beneath the noise of averages after some eight of its times.
        assert!(
            [125, 250, 500, 1000].contains(&found.kept.start),
            "{:?}",
            found.kept
        );
        assert_eq!(found.kept.end, 4000);
        let one = &found.left_out[0];
        assert_eq!(
            (one.why, one.axis.as_deref()),
            (Omission::WarmUp, Some("gyro_x"))
        );
        assert_eq!(
            (one.start_s.0, one.end_s.0),
            (0.0, 2.0 * found.kept.start as f64)
        );
        // It rises by 2 in that time, with a time constant of 120 s.
        let cut = found.kept.start as f64;
        let drift = 2.0 * (1.0 - (-cut / 60.0).exp());
        assert!((one.step.0 / drift - 1.0).abs() < 0.1, "{one:?}");
        assert!((one.time_s.0 / 120.0 - 1.0).abs() < 0.2, "{one:?}");
        // Its tail is subtracted, in as many parts as it is found in.
        let tails = || found.subtracted.iter();
        assert!(tails().all(|tail| (tail.axis, tail.width) == (0, 20)));
        let sum: f64 = tails().map(|tail| tail.of.value(0.0)).sum();
        let exact = -2.0 * (-cut / 60.0).exp();
        assert!(sum < 0.0 && (sum - exact).abs() < 1e-3, "{sum} {exact}");
    }
}
