//! What goes on slowly in a part of a record that rests and is no noise of its sensor: small steps, a warm-up, cycles.

use super::{
    pieces::{beyond, longest_piece, within},
    steps::Step,
    windows::{STEPS, Windows},
};
use crate::results::{Omission, Omitted};
use std::ops::Range;
use undrift_noise::{
    identify::SHORTEST,
    screening::{Disturbance, Shape, disturbances},
};

/// Shares of a part that are cut off for a warm-up, the least that is enough; beyond the last it is subtracted.
const CUTS: [f64; 7] = [0.0, 1.0 / 32.0, 0.0625, 0.125, 0.25, 0.375, 0.5];

/// A part without what goes on slowly.
pub(super) struct Steady {
    /// Its windows.
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
    let warmest = warmest.and_then(|(axis, _)| Some((axis, WarmUp::of(&found[axis])?)));
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
    let shown: Vec<bool> = found.iter().map(|of| WarmUp::of(of).is_some()).collect();
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
        if let Some(of) = WarmUp::of(of_axis) {
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
    fn of(of_axis: &[Disturbance]) -> Option<Self> {
        let parts = of_axis.iter().copied();
        let parts = Vec::from_iter(parts.filter(|one| matches!(one.shape, Shape::WarmUp(_))));
        let clearest = parts.iter().max_by(|a, b| a.fall.total_cmp(&b.fall))?;
        let Shape::WarmUp(tau) = clearest.shape else {
            return None;
        };
        Some(Self { parts, tau })
    }

    /// How far it drifts in so many windows [unit].
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
