//! Whether a record is one of a sensor at rest, in the units that it is said to be in.

use crate::{
    inspect::about_gravity,
    record::{Record, own_values},
};
use std::ops::Range;
use undrift_nav::{
    earth::STANDARD_GRAVITY,
    units::{Quantity, unit_factor},
};
use undrift_noise::{identify::SHORTEST, number::rounded, order_statistics::upper_median};

/// Least samples of a window, which is a second else.
const WINDOW: usize = 20;
const LONGEST: usize = 1_000_000;
/// Windows in a block and its neighbours give the level that a window is compared with: a drift over minutes is
/// no motion.
const BLOCK: usize = 60;
/// A window moves whose mean is so far from that level: slower than a vehicle turns [rad/s], and less than it
/// accelerates or tilts [m/s²]; more than quiet noise and rounding explain.
const TURN: f64 = 0.017_453;
const FORCE: f64 = 0.2;
const NOISE: f64 = 8.0;
const STEPS: f64 = 1.5;
/// Windows that may move, as a knock or two do; and their share.
const KNOCKS: usize = 5;
const SHARE: f64 = 0.02;
/// A window rests that is no noisier than so many times the quietest tenth.
const QUIET: f64 = 3.0;
/// Shortest rest that is worth identifying \[s\].
const LEAST_REST: f64 = 12.0;
/// Rate beyond any turn-on constant [rad/s]: 20 deg/s of the cheapest sensors.
const TURNING: f64 = 0.5;
/// Whole numbers in more levels than this, called deg/s or rad/s, are counts.
const LEVELS: usize = 4;
/// Samples that a size is taken from.
const PROBE: usize = 10_000;

/// What the accelerometers' numbers are, more likely than what they are said to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likely {
    /// Specific forces in this unit.
    Unit(&'static str),
    /// Accelerations without gravity.
    GravityRemoved,
    /// Velocity increments.
    Increments,
    /// None of those.
    Unknown,
}

/// Why a record is no static recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotStatic {
    /// Gravity has a wrong size.
    #[error("the specific force is {} m/s², not 9.81", rounded(*force, 4))]
    Force {
        /// Median magnitude [m/s²].
        force: f64,
        /// What the numbers are instead.
        likely: Likely,
        /// Unit of the gyros as stated, if they have one.
        gyro_unit: String,
    },
    /// Raw counts called a unit.
    #[error("{axis} has whole numbers alone, from {} to {}, which are raw counts and not {unit}", range[0], range[1])]
    Counts {
        /// The axis.
        axis: &'static str,
        /// Unit as stated.
        unit: String,
        /// Unit of the accelerometers as stated.
        accel_unit: String,
        /// Least and largest number.
        range: [f64; 2],
    },
    /// An axis turns faster than a constant of the sensor explains.
    #[error("{axis} reads {} deg/s on average, more than any sensor at rest", rounded(rate.to_degrees(), 4))]
    Turning {
        /// The axis.
        axis: &'static str,
        /// Mean rate [rad/s].
        rate: f64,
    },
    /// The sensor moves.
    #[error("the IMU moves in {moving_s:.0} of {length_s:.0} s")]
    Moving {
        /// Time in motion \[s\].
        moving_s: f64,
        /// Length of the record \[s\].
        length_s: f64,
        /// Longest rest, from its start to its end after the record's first sample \[s\].
        rest: Option<(f64, f64)>,
    },
}

/// Why a record at a rate \[Hz\] is no static recording, if it is none. Of the axes that there are, those that
/// tell are looked at: gravity takes three accelerometers.
pub fn not_static(record: &Record, rate_hz: f64) -> Option<NotStatic> {
    // Of a sensor that is slower than the record its own samples.
    let own = record.samples.iter().map(|samples| own_values(samples));
    let own: Vec<_> = own.collect();
    let named = |sensor: &str| -> (Vec<(&'static str, &[f64])>, f64) {
        let axes = record.axes.iter().zip(record.samples.iter().zip(&own));
        let axes = axes.filter(|(name, _)| name.starts_with(sensor));
        let mut own_hz = rate_hz;
        let axes = axes.map(|(name, (samples, own))| match own {
            Some((values, _, every)) => {
                own_hz = rate_hz / every;
                (*name, values.as_slice())
            }
            None => (*name, samples.as_slice()),
        });
        let axes = axes.collect();
        (axes, own_hz)
    };
    let ((gyros, gyro_hz), (accels, accel_hz)) = (named("gyro"), named("accel"));
    let (gyro_unit, accel_unit) = record.units.clone().unwrap_or_default();
    force(&accels, &accel_unit, &gyro_unit, accel_hz)
        .or_else(|| counts(&gyros, &gyro_unit, &accel_unit))
        .or_else(|| turning(&gyros))
        .or_else(|| motion(&gyros, &accels, [gyro_hz, accel_hz]))
}

fn force(
    accels: &[(&'static str, &[f64])],
    unit: &str,
    gyro_unit: &str,
    rate_hz: f64,
) -> Option<NotStatic> {
    let [(_, x), (_, y), (_, z)] = accels else {
        return None;
    };
    let stride = (x.len() / PROBE).max(1);
    let triples = x.iter().zip(*y).zip(*z).step_by(stride);
    let mut sizes: Vec<f64> = triples
        .map(|((x, y), z)| (x * x + y * y + z * z).sqrt())
        .filter(|size| size.is_finite())
        .collect();
    if sizes.is_empty() {
        return None;
    }
    let force = upper_median(&mut sizes);
    if about_gravity([0.0, 0.0, force]) {
        return None;
    }
    let number = force / unit_factor(unit, Quantity::Acceleration).unwrap_or(1.0);
    let near = |value: f64| (0.85..1.15).contains(&(number / value));
    const SIZES: [(&str, f64); 9] = [
        ("m/s^2", STANDARD_GRAVITY),
        ("g", 1.0),
        ("mg", 1e3),
        ("ug", 1e6),
        ("LSB/16384 g", 16384.0),
        ("LSB/8192 g", 8192.0),
        ("LSB/4096 g", 4096.0),
        ("LSB/2048 g", 2048.0),
        ("LSB/256 g", 256.0),
    ];
    let likely = match SIZES.iter().find(|(_, gravity)| near(*gravity)) {
        Some((unit, _)) => Likely::Unit(unit),
        None if near(STANDARD_GRAVITY / rate_hz) => Likely::Increments,
        None if force < 0.1 * STANDARD_GRAVITY => Likely::GravityRemoved,
        None => Likely::Unknown,
    };
    Some(NotStatic::Force {
        force,
        likely,
        gyro_unit: gyro_unit.to_owned(),
    })
}

/// Gyros of whole numbers: a step of 1 deg/s is coarser than any has.
fn counts(gyros: &[(&'static str, &[f64])], unit: &str, accel_unit: &str) -> Option<NotStatic> {
    let factor = unit_factor(unit, Quantity::AngularRate).ok()?;
    if factor < 1f64.to_radians() * (1.0 - 1e-9) {
        return None;
    }
    gyros.iter().find_map(|(axis, samples)| {
        let numbers = samples.iter().map(|x| x / factor);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for number in numbers {
            // Turned from the unit into SI and back.
            if (number - number.round()).abs() > 1e-9 * number.abs().max(1.0) {
                return None;
            }
            range = [range[0].min(number.round()), range[1].max(number.round())];
        }
        (range[1] - range[0] >= LEVELS as f64).then(|| NotStatic::Counts {
            axis,
            unit: unit.to_owned(),
            accel_unit: accel_unit.to_owned(),
            range,
        })
    })
}

fn turning(gyros: &[(&'static str, &[f64])]) -> Option<NotStatic> {
    gyros.iter().find_map(|(axis, samples)| {
        let rate = samples.iter().sum::<f64>() / samples.len() as f64;
        (rate.abs() > TURNING).then_some(NotStatic::Turning { axis, rate })
    })
}

/// An axis in windows.
struct Levels {
    means: Vec<f64>,
    deviations: Vec<f64>,
    /// How far a mean may be off at rest.
    limit: f64,
    /// Deviation of a window up to which it is quiet.
    quiet: f64,
}

impl Levels {
    fn of(samples: &[f64], width: usize, least: f64) -> Self {
        let window = |window: &[f64]| {
            let mean = window.iter().sum::<f64>() / width as f64;
            let squares = window.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            (mean, (squares / (width - 1) as f64).sqrt())
        };
        let (means, deviations): (Vec<f64>, Vec<f64>) =
            samples.chunks_exact(width).map(window).unzip();
        let mut sorted = deviations.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
        let step = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let step = step
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min);
        let step = if step.is_finite() { step } else { 0.0 };
        Self {
            limit: least
                .max(NOISE * at(0.25) / (width as f64).sqrt())
                .max(STEPS * step),
            quiet: QUIET * at(0.1) + step,
            means,
            deviations,
        }
    }

    /// Whether each window's mean is off the median of the minutes around it.
    fn moving(&self) -> impl Iterator<Item = bool> {
        let count = self.means.len();
        let blocks = count.div_ceil(BLOCK);
        let level = |block: usize| {
            let from = (block * BLOCK).saturating_sub(BLOCK);
            let to = ((block + 2) * BLOCK).min(count);
            upper_median(&mut self.means[from..to].to_vec())
        };
        let levels: Vec<f64> = (0..blocks).map(level).collect();
        let means = self.means.iter().enumerate();
        means.map(move |(k, mean)| (mean - levels[k / BLOCK]).abs() > self.limit)
    }

    fn rests(&self, window: usize) -> bool {
        let before = self.means[window.saturating_sub(1)];
        self.deviations[window] <= self.quiet && (self.means[window] - before).abs() <= self.limit
    }
}

fn motion(
    gyros: &[(&'static str, &[f64])],
    accels: &[(&'static str, &[f64])],
    [rate_hz, accel_hz]: [f64; 2],
) -> Option<NotStatic> {
    let width = |rate_hz: f64| (rate_hz.round() as usize).clamp(WINDOW, LONGEST);
    let levels = |axes: &[(&'static str, &[f64])], least: f64, width: usize| -> Vec<Levels> {
        let axes = axes
            .iter()
            .filter(|(_, samples)| samples.len() >= 3 * width);
        axes.map(|(_, samples)| Levels::of(samples, width, least))
            .collect()
    };
    let mut all = levels(gyros, TURN, width(rate_hz));
    all.extend(levels(accels, FORCE, width(accel_hz)));
    let width = width(rate_hz);
    let windows = all.iter().map(|axis| axis.means.len()).min()?;
    let mut moving = vec![false; windows];
    for axis in &all {
        for (moving, moves) in moving.iter_mut().zip(axis.moving()) {
            *moving |= moves;
        }
    }
    let count = moving.iter().filter(|moves| **moves).count();
    if count <= KNOCKS || count as f64 <= SHARE * windows as f64 {
        return None;
    }
    let seconds = |windows: usize| (windows * width) as f64 / rate_hz;
    Some(NotStatic::Moving {
        moving_s: seconds(count),
        length_s: seconds(windows),
        rest: longest(windows, |window| all.iter().all(|axis| axis.rests(window)))
            .map(|rest| (seconds(rest.start).ceil(), seconds(rest.end).floor()))
            .filter(|(start, end)| {
                end - start >= LEAST_REST && (end - start) * rate_hz >= SHORTEST as f64
            }),
    })
}

/// The longest run of windows that rest, without the first and last where the record goes on.
fn longest(windows: usize, rests: impl Fn(usize) -> bool) -> Option<Range<usize>> {
    let (mut best, mut start) = (0..0, 0);
    for window in 0..=windows {
        if window < windows && rests(window) {
            continue;
        }
        let from = if start == 0 { 0 } else { start + 1 };
        let to = if window == windows {
            windows
        } else {
            window.saturating_sub(1)
        };
        if to.saturating_sub(from) > best.len() {
            best = from..to;
        }
        start = window + 1;
    }
    (!best.is_empty()).then_some(best)
}

#[cfg(test)]
mod tests;
