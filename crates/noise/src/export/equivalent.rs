//! What a model is in the terms that every program knows: white noise, a slow process, a constant.
//!
//! | model has | becomes |
//! |---|---|
//! | processes and random walk | as they are; a process faster than a second is white noise of `N² = 2σ²τ` |
//! | an ARMA(1,1) alone | its exact sum of white noise and one process ([`Arma::split`]) |
//! | a longer ARMA alone | its slow poles; white noise is the density at low frequencies of all others |
//! | several processes | for a simulator the one whose Allan deviation is nearest ([`nearest`]) |
//! | no bias at all | for programs that divide by it, the largest walk that the record could hide |
//!
//! What a format cannot take becomes a [`Remark`], a comment in the file.
//!
//! Why a walk "that the record could hide": Kalibr and its relatives weigh bias steps by 1/K², and
//! K = 0 stops them. A record of length L \[s\] cannot exclude K < √3 N/(0.1 L), so that this is the
//! honest number for "no bias seen".
//!
//! Units of the result are SI: rad/s and m/s² with √s; the formats convert. The order of axes is x,
//! y, z of the sensor.

use super::ModelFormat;
use super::nearest::{factor, nearest};
use super::outage::WalkFilter;
use super::poles;
use crate::bias_model::{SLOW, Slow, UNIT_ROOT_TAU};
use crate::composite::GaussMarkov;
use crate::model_file::{AXES, Arma, AxisModel, ImuModel, ModelError};

/// A density below this share of the innovations' is rounding: a bias alone has none.
const ROUNDING: f64 = 1e-9;

/// A model in terms of white noise and slow processes.
pub(super) struct Equivalent {
    /// Name of the sensor.
    pub name: String,
    /// Where its numbers come from.
    pub source: String,
    /// Gyros [rad/s].
    pub gyro: [EquivalentAxis; 3],
    /// Accelerometers [m/s²].
    pub accel: [EquivalentAxis; 3],
    /// What was derived or left out, of an axis or the sensor of this name.
    pub remarks: Vec<(&'static str, Remark)>,
}

/// How many times the outage later a walk's σ is stated, too.
const LATER: f64 = 10.0;

/// What was derived or left out.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Remark {
    /// No slow bias was detected: the random walk is the largest that could go undetected.
    Undetected {
        /// Length of the recording \[s\].
        length: f64,
    },
    /// Biases of less than [`SLOW`] of these correlation times \[s\] count as white noise.
    FastBias(Vec<f64>),
    /// Its random walk is the best one for an outage.
    WalkAlone {
        /// Length of the outage \[s\].
        outage_s: f64,
        /// Standard deviation that the filter states over the error that it has, at the end and ten times later.
        factors: [f64; 2],
    },
    /// Its bias is simulated by a process, beside a walk where the program has one, whose Allan deviation is within this factor.
    Nearest {
        /// Over or under the model's, at worst.
        factor: f64,
    },
    /// Its Gauss-Markov processes but the slowest count as a random walk.
    JoinedBias,
    /// Its quantisation is omitted.
    Quantisation,
    /// Its bias over temperature is omitted.
    Temperature,
    /// Lines and narrow resonances of these frequencies \[Hz\] are omitted.
    Lines(Vec<f64>),
    /// The terms are exactly its ARMA(1,1).
    ExactSum,
    /// The bias is the slow poles of its ARMA, white noise the density at low frequencies of all others.
    SlowPoles,
    /// Complex poles of these frequencies \[Hz\] are no bias.
    ComplexPoles(Vec<f64>),
    /// Poles of less than [`SLOW`] of these correlation times \[s\] are no bias.
    FastPoles(Vec<f64>),
    /// The slow poles are no sum of Gauss-Markov processes: a random walk over short times.
    JoinedPoles,
    /// Without its bias its ARMA has no noise at low frequencies: its innovations serve as white noise.
    Innovations,
}

/// An axis in terms of white noise and slow processes; "unit" as in [`AxisModel`].
#[derive(Default)]
pub(super) struct EquivalentAxis {
    /// White density N [unit·√s].
    pub white: f64,
    /// Standard deviation of the turn-on constant \[unit\].
    pub turn_on: f64,
    /// Gauss-Markov processes and random walk.
    pub slow: Slow,
    /// Random walk [unit/√s] that is best for a filter which knows no other bias; 0 for formats that know others.
    pub walk: f64,
}

impl Equivalent {
    /// The equivalent of each axis, with the random walk for an outage of `outage_s` \[s\] where `format` knows
    /// no other bias.
    ///
    /// # Errors
    /// [`ModelError::NoAxis`]; [`ModelError::Missing`] where the format needs a bias that moves, the model has
    /// none, and how long its record was is not known.
    pub fn new(model: &ImuModel, format: ModelFormat, outage_s: f64) -> Result<Self, ModelError> {
        let mut remarks = Vec::new();
        let mut axes: [EquivalentAxis; 6] = Default::default();
        for ((name, axis), slot) in model.known_axes()?.into_iter().zip(&mut axes) {
            *slot = equivalent(name, axis, format, &mut remarks);
        }
        let [gx, gy, gz, ax, ay, az] = axes;
        let (mut gyro, mut accel) = ([gx, gy, gz], [ax, ay, az]);
        if must_walk(format) {
            let record = length(model);
            // What a number is of, the first axis of it, and all of them.
            let groups: Vec<(_, _, &mut [EquivalentAxis])> = match format {
                ModelFormat::Basalt | ModelFormat::Gtsam => AXES
                    .into_iter()
                    .zip(gyro.iter_mut().chain(&mut accel))
                    .map(|(name, axis)| (name, name, std::slice::from_mut(axis)))
                    .collect(),
                _ => vec![
                    ("gyros", "gyro_x", &mut gyro),
                    ("accelerometers", "accel_x", &mut accel),
                ],
            };
            for (group, axis, axes) in groups {
                if axes.iter().any(|axis| axis.slow.drive() > 0.0) {
                    continue;
                }
                let Some(length) = record else {
                    return Err(ModelError::Missing {
                        axis: Some(axis),
                        model: format.name(),
                        needs: "a bias that moves: bias_instability with correlation_time, or random_walk",
                    });
                };
                for axis in axes.iter_mut() {
                    axis.slow.walk = Some(unseen_walk(axis.white, length));
                }
                remarks.push((group, Remark::Undetected { length }));
            }
        }
        if is_simulator(format) {
            for (names, axes) in [&AXES[..3], &AXES[3..]]
                .into_iter()
                .zip([&mut gyro, &mut accel])
            {
                let found = simulate(axes, format);
                let named = names.iter().zip(found);
                remarks.extend(named.filter_map(|(name, of)| Some((*name, of?))));
            }
        }
        if has_only_a_walk(format) {
            let named = AXES.into_iter().zip(gyro.iter_mut().chain(&mut accel));
            for (name, axis) in named {
                let filter = WalkFilter::new(axis.white, &axis.slow);
                axis.walk = filter.best(outage_s);
                if axis.slow.processes.is_empty() {
                    continue;
                }
                let factor = |length: f64| {
                    let drift = filter.drift(axis.walk, length);
                    drift.expected / drift.real
                };
                let factors = [outage_s, LATER * outage_s].map(factor);
                remarks.push((name, Remark::WalkAlone { outage_s, factors }));
            }
        }
        Ok(Self {
            name: model.name.clone(),
            source: model.source.clone(),
            gyro,
            accel,
            remarks,
        })
    }
}

/// Whether a program draws noise, from one Gauss-Markov process for each axis: MATLAB's has a walk beside it, and one correlation time for
/// the axes of a sensor.
fn is_simulator(format: ModelFormat) -> bool {
    matches!(format, ModelFormat::Gazebo | ModelFormat::Matlab)
}

/// Puts what a simulator can draw in place of the biases of a sensor's axes that are more; a walk alone is one in both.
fn simulate(axes: &mut [EquivalentAxis; 3], format: ModelFormat) -> [Option<Remark>; 3] {
    let has_walk = format == ModelFormat::Matlab;
    let find = |axis: &EquivalentAxis, tau_s| nearest(axis.white, &axis.slow, has_walk, tau_s);
    let fits = |slow: &Slow| match slow.processes.len() {
        0 => true,
        1 => has_walk || slow.walk.unwrap_or(0.0) == 0.0,
        _ => false,
    };
    let mut found = axes.each_ref().map(|axis| match fits(&axis.slow) {
        true => axis.slow.clone(),
        false => find(axis, None).unwrap_or_else(|| axis.slow.clone()),
    });
    if has_walk {
        let taus = found.iter().filter_map(Slow::slowest).map(|of| of.tau_s);
        let taus = Vec::from_iter(taus);
        if taus.iter().any(|tau_s| *tau_s != taus[0]) {
            let logarithms = taus.iter().map(|tau_s| tau_s.ln()).sum::<f64>();
            let shared = (logarithms / taus.len() as f64).exp();
            for (axis, slow) in axes.iter().zip(&mut found) {
                if !slow.processes.is_empty() {
                    *slow = find(axis, Some(shared)).unwrap_or_default();
                }
            }
        }
    }
    let mut at = found.into_iter();
    axes.each_mut().map(|axis| {
        let slow = at.next().filter(|slow| *slow != axis.slow)?;
        let factor = factor(axis.white, &slow, &axis.slow);
        axis.slow = slow;
        Some(Remark::Nearest { factor })
    })
}

/// Whether a format's bias is a random walk and nothing else.
fn has_only_a_walk(format: ModelFormat) -> bool {
    use ModelFormat::{ArduPilot, Px4};
    matches!(format, Px4 | ArduPilot) || must_walk(format)
}

/// Whether a program divides by the variance of a bias's step, so that its random walk must not be 0.
fn must_walk(format: ModelFormat) -> bool {
    use ModelFormat::{Basalt, Gtsam, Kalibr, OpenVins, Vins};
    matches!(format, Kalibr | Vins | OpenVins | Basalt | Gtsam)
}

/// Length of the record that a model was identified from \[s\].
fn length(model: &ImuModel) -> Option<f64> {
    let (samples, rate) = (model.provenance.samples?, model.provenance.rate_hz?);
    let length = samples as f64 / rate;
    (length.is_finite() && length > 0.0).then_some(length)
}

/// The random walk [unit/√s] whose Allan variance K²τ/3 reaches that of the white noise, N²/τ, at
/// a tenth of the record's length \[s\] (IEEE Std 952-1997, C.1.1 and C.1.4): the longest averaging
/// time with the ten means that such a doubling of the variance takes to be seen.
/// `√3 N/(0.1 L)`.
fn unseen_walk(white: f64, length: f64) -> f64 {
    3f64.sqrt() * white / (0.1 * length)
}

/// Remarks on it are added to `remarks` under its `name`.
///
/// Densities of independent parts add in squares. Terms win over an ARMA where the model has both:
/// they are the longer view, since an ARMA of the full rate describes short memory first.
fn equivalent(
    name: &'static str,
    axis: &AxisModel,
    format: ModelFormat,
    remarks: &mut Vec<(&'static str, Remark)>,
) -> EquivalentAxis {
    let mut found = Vec::new();
    let has_terms = !axis.instability.is_empty() || axis.random_walk.is_some();
    let arma = axis.arma.as_ref().filter(|_| !has_terms);
    let (of_arma, slow) = arma.map(|arma| of_arma(arma, &mut found)).unzip();
    let white = axis
        .white
        .or(of_arma)
        .unwrap_or_else(|| axis.white_density());
    let mut slow = slow.unwrap_or_else(|| Slow {
        processes: axis.instability.clone(),
        walk: axis.random_walk,
    });
    // White noise over all times that matter: 2σ²τ is its density at frequency 0.
    let (slow_ones, fast): (Vec<_>, Vec<_>) =
        slow.processes.into_iter().partition(|of| of.tau_s >= SLOW);
    slow.processes = slow_ones;
    let density = |of: &GaussMarkov| 2.0 * of.sigma * of.sigma * of.tau_s;
    let white = fast
        .iter()
        .map(density)
        .fold(white * white, |sum, of| sum + of)
        .sqrt();
    if !fast.is_empty() {
        let times = fast.iter().map(|of| of.tau_s);
        found.push(Remark::FastBias(times.collect()));
    }
    if slow.processes.len() > 1 && !has_only_a_walk(format) && !is_simulator(format) {
        found.push(Remark::JoinedBias);
    }
    if axis.quantisation.is_some() {
        found.push(Remark::Quantisation);
    }
    if axis.temperature.is_some() {
        found.push(Remark::Temperature);
    }
    if !axis.lines.is_empty() {
        let lines = axis.lines.iter().map(|line| line.frequency_hz);
        found.push(Remark::Lines(lines.collect()));
    }
    remarks.extend(found.into_iter().map(|remark| (name, remark)));
    EquivalentAxis {
        white,
        turn_on: axis.turn_on,
        slow,
        walk: 0.0,
    }
}

/// White density [unit·√s] and bias of an ARMA, and what of it is in neither.
///
/// Three cases: white (all coefficients 0), an ARMA(1,1) that splits exactly, anything else by its
/// poles.
fn of_arma(arma: &Arma, remarks: &mut Vec<Remark>) -> (f64, Slow) {
    let innovations = arma.sigma / arma.rate_hz.sqrt();
    if arma.is_white() {
        return (innovations, Slow::default());
    }
    if let Some(split) = arma.split() {
        remarks.push(Remark::ExactSum);
        return split;
    }
    let parts = poles::parts(arma);
    remarks.push(Remark::SlowPoles);
    if !parts.pairs.is_empty() {
        remarks.push(Remark::ComplexPoles(parts.pairs));
    }
    if !parts.fast.is_empty() {
        remarks.push(Remark::FastPoles(parts.fast));
    }
    if parts.is_joined {
        remarks.push(Remark::JoinedPoles);
    }
    if parts.white > ROUNDING * innovations * innovations {
        return (parts.white.sqrt(), parts.slow);
    }
    remarks.push(Remark::Innovations);
    (innovations, parts.slow)
}

/// Root mean square over the three axes.
///
/// Preserves the mean variance of the axes.
pub(super) fn rms(axes: &[EquivalentAxis; 3], of: impl Fn(&EquivalentAxis) -> f64) -> f64 {
    (axes.iter().map(|axis| of(axis).powi(2)).sum::<f64>() / 3.0).sqrt()
}

/// One correlation time \[s\] for several axes: the longest, a random walk counting as one hour.
/// `None` where nothing moves.
pub(super) fn common_tau<'a>(axes: impl Iterator<Item = &'a EquivalentAxis>) -> Option<f64> {
    axes.filter_map(|axis| match (axis.slow.slowest(), axis.slow.walk) {
        (Some(of), None) => Some(of.tau_s),
        (of, Some(_)) => Some(of.map_or(UNIT_ROOT_TAU, |of| of.tau_s.max(UNIT_ROOT_TAU))),
        (None, None) => None,
    })
    .max_by(f64::total_cmp)
}

/// Standard deviation \[unit\] of the Gauss-Markov process of correlation time `tau` \[s\] that a random
/// walk of density `drive` [unit/√s] drives: σ = K √(τ/2).
///
/// Over times short against `tau` the two are the same.
pub(super) fn driven(drive: f64, tau: f64) -> f64 {
    drive * (0.5 * tau).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(processes: &[(f64, f64)], walk: Option<f64>) -> EquivalentAxis {
        let process = |&(sigma, tau_s): &(f64, f64)| GaussMarkov { sigma, tau_s };
        EquivalentAxis {
            slow: Slow {
                processes: processes.iter().map(process).collect(),
                walk,
            },
            ..EquivalentAxis::default()
        }
    }

    #[test]
    fn a_walk_that_is_not_seen_reaches_the_white_noise_at_a_tenth_of_the_record() {
        let (white, length) = (0.03, 5000.0);
        let walk = unseen_walk(white, length);
        // Allan variances: K² τ/3 and N²/τ.
        let tau = 0.1 * length;
        let ratio = (walk * walk * tau / 3.0) / (white * white / tau);
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_driven_process_moves_as_its_walk_at_short_times() {
        let (walk, tau_s) = (0.2, 300.0);
        let sigma = driven(walk, tau_s);
        assert!((GaussMarkov { sigma, tau_s }.drive() / walk - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_common_time_is_the_longest_and_a_walk_is_an_hour() {
        let common = |axes: &[EquivalentAxis]| common_tau(axes.iter());
        let still = || axis(&[], None);
        assert_eq!(common(&[still(), still()]), None);
        assert_eq!(
            common(&[
                axis(&[(1.0, 50.0)], None),
                still(),
                axis(&[(1.0, 200.0)], None)
            ]),
            Some(200.0)
        );
        assert_eq!(
            common(&[axis(&[(1.0, 50.0)], Some(0.1)), still()]),
            Some(UNIT_ROOT_TAU)
        );
        assert_eq!(common(&[axis(&[], Some(0.1))]), Some(UNIT_ROOT_TAU));
        assert_eq!(common(&[axis(&[(1.0, 9000.0)], Some(0.1))]), Some(9000.0));
    }

    #[test]
    fn the_three_axes_have_the_root_of_their_mean_square() {
        let mut axes: [EquivalentAxis; 3] = Default::default();
        for (axis, white) in axes.iter_mut().zip([1.0, 2.0, 4.0]) {
            axis.white = white;
        }
        assert!((rms(&axes, |axis| axis.white) - 7f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_short_correlation_time_is_white_noise_of_its_density() {
        let process = |sigma, tau_s| GaussMarkov { sigma, tau_s };
        let model = AxisModel {
            white: Some(0.3),
            turn_on: 7.0,
            instability: vec![process(0.5, 0.5 * SLOW), process(0.2, SLOW)],
            ..AxisModel::default()
        };
        let mut remarks = Vec::new();
        let found = equivalent("gyro_x", &model, ModelFormat::KfGins, &mut remarks);
        let density = 0.09 + 2.0 * 0.25 * 0.5 * SLOW;
        assert!((found.white * found.white / density - 1.0).abs() < 1e-14);
        assert_eq!(found.slow.processes, [process(0.2, SLOW)]);
        assert_eq!(found.turn_on, 7.0);
        assert_eq!(remarks, [("gyro_x", Remark::FastBias(vec![0.5 * SLOW]))]);
        // A second slow one, and nothing that is fast.
        let model = AxisModel {
            instability: vec![process(0.5, 9.0 * SLOW), process(0.2, SLOW)],
            ..model
        };
        let mut remarks = Vec::new();
        let found = equivalent("gyro_x", &model, ModelFormat::KfGins, &mut remarks);
        assert_eq!((found.white, found.slow.processes.len()), (0.3, 2));
        assert_eq!(remarks, [("gyro_x", Remark::JoinedBias)]);
    }
}
