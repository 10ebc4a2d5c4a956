//! What a model is in the terms that every program knows: white noise, a slow process, a constant.

use super::ModelFormat;
use crate::bias_model::{Slow, UNIT_ROOT_TAU};
use crate::composite::GaussMarkov;
use crate::model_file::{Arma, AxisModel, ImuModel, ModelError};
use undrift_nav::shaping::{ShapingError, ShapingFilter};

/// Sum of φ this close to one is a unit root, as for [`ShapingFilter::arma`].
const UNIT_ROOT: f64 = 1e-13;

/// A model in terms of white noise and slow processes.
pub(super) struct Equivalent {
    /// Name of the sensor.
    pub name: String,
    /// Where its numbers come from.
    pub source: String,
    /// Gyros [rad/s].
    pub gyro: [Axis; 3],
    /// Accelerometers [m/s²].
    pub accel: [Axis; 3],
    /// What was derived or left out, a sentence each.
    pub remarks: Vec<String>,
}

/// An axis in terms of white noise and slow processes; "unit" as in [`AxisModel`].
#[derive(Default)]
pub(super) struct Axis {
    /// White density N [unit·√s].
    pub white: f64,
    /// Standard deviation of the turn-on constant [unit].
    pub turn_on: f64,
    /// Gauss-Markov processes and random walk.
    pub slow: Slow,
}

impl Equivalent {
    pub fn of(model: &ImuModel, format: ModelFormat) -> Result<Self, ModelError> {
        let mut remarks = Vec::new();
        let mut axes: [Axis; 6] = Default::default();
        for ((name, axis), slot) in model.known_axes()?.into_iter().zip(&mut axes) {
            *slot = equivalent(name, axis, &mut remarks).map_err(|error| ModelError::Shaping {
                axis: Some(name),
                model: "arma",
                error,
            })?;
        }
        let [gx, gy, gz, ax, ay, az] = axes;
        let (mut gyro, mut accel) = ([gx, gy, gz], [ax, ay, az]);
        if format == ModelFormat::Kalibr {
            let record = length(model);
            for (sensor, axis, axes) in [
                ("gyros", "gyro_x", &mut gyro),
                ("accelerometers", "accel_x", &mut accel),
            ] {
                if rms(axes, |axis| axis.slow.drive()) > 0.0 {
                    continue;
                }
                let Some(length) = record else {
                    return Err(ModelError::Missing {
                        axis: Some(axis),
                        model: "kalibr",
                        needs: "a bias that moves: bias_instability with correlation_time, or random_walk",
                    });
                };
                for axis in axes.iter_mut() {
                    axis.slow.walk = Some(unseen_walk(axis.white, length));
                }
                remarks.push(format!(
                    "{sensor}: no slow bias was detected in {length:.0} s of recording. The random walk is the largest that could go undetected, 10 √3 N / T: an upper bound, which a longer recording lowers."
                ));
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

/// Length of the record that a model was identified from \[s\].
fn length(model: &ImuModel) -> Option<f64> {
    let (samples, rate) = (model.provenance.samples?, model.provenance.rate_hz?);
    let length = samples as f64 / rate;
    (length.is_finite() && length > 0.0).then_some(length)
}

/// The random walk [unit/√s] whose Allan variance K²τ/3 reaches that of the white noise, N²/τ, at
/// a tenth of the record's length \[s\] (IEEE Std 952-1997, C.1.1 and C.1.4): the longest averaging
/// time with the ten means that such a doubling of the variance takes to be seen.
fn unseen_walk(white: f64, length: f64) -> f64 {
    3f64.sqrt() * white / (0.1 * length)
}

fn equivalent(
    name: &str,
    axis: &AxisModel,
    remarks: &mut Vec<String>,
) -> Result<Axis, ShapingError> {
    let white = axis.white_density();
    let slow = if !axis.instability.is_empty() || axis.random_walk.is_some() {
        Slow {
            processes: axis.instability.clone(),
            walk: axis.random_walk,
        }
    } else {
        match axis.arma.as_ref().filter(|arma| !arma.is_white()) {
            None => Slow::default(),
            Some(arma) => match arma.split() {
                Some((_, slow)) => {
                    remarks.push(format!(
                        "{name}: the terms whose sum is exactly its ARMA(1,1)."
                    ));
                    slow
                }
                None => {
                    remarks.push(format!(
                        "{name}: approximates an ARMA that is not a sum of such terms: same variance and same spectrum at long times, with its innovations as white noise."
                    ));
                    slow_of(arma)?
                }
            },
        }
    };
    if slow.processes.len() + usize::from(slow.walk.is_some()) > 1 {
        remarks.push(format!(
            "{name}: of several slow terms, the slowest Gauss-Markov process and the random walk are used."
        ));
    }
    if axis.quantisation.is_some() {
        remarks.push(format!("{name}: its quantisation is omitted."));
    }
    Ok(Axis {
        white,
        turn_on: axis.turn_on,
        slow,
    })
}

/// The slow process with the variance of the predictable part of an ARMA and its spectral density
/// at frequency zero beyond that of the innovations, σ²T ((θ(1)/φ(1))² − 1) = 2 σ_b² τ; with a unit
/// root φ(z) = (1 − z) c(z), the random walk of the same spectrum at low frequencies,
/// K² T = σ² (θ(1)/c(1))². Anti-persistent noise has none.
fn slow_of(arma: &Arma) -> Result<Slow, ShapingError> {
    let interval = 1.0 / arma.rate_hz;
    let theta: f64 = 1.0 - arma.ma.iter().sum::<f64>();
    let phi: f64 = 1.0 - arma.ar.iter().sum::<f64>();
    if phi.abs() < UNIT_ROOT {
        // −φ'(1), the sum of i φ_i.
        let c: f64 = (1..).zip(&arma.ar).map(|(i, ar)| f64::from(i) * ar).sum();
        return Ok(Slow {
            walk: Some((arma.sigma * theta / c).abs() * arma.rate_hz.sqrt()),
            ..Slow::default()
        });
    }
    let filter = ShapingFilter::arma(&arma.ar, &arma.ma, arma.sigma, interval)?;
    // H = [1 0 …]: the predictable part's variance.
    let variance = filter.p0[0][0];
    let excess = arma.sigma * arma.sigma * interval * ((theta / phi).powi(2) - 1.0);
    let persistent = variance > 0.0 && excess > 0.0;
    Ok(Slow {
        processes: persistent
            .then(|| GaussMarkov {
                sigma: variance.sqrt(),
                tau_s: 0.5 * excess / variance,
            })
            .into_iter()
            .collect(),
        walk: None,
    })
}

/// Root mean square over the three axes.
pub(super) fn rms(axes: &[Axis; 3], of: impl Fn(&Axis) -> f64) -> f64 {
    (axes.iter().map(|axis| of(axis).powi(2)).sum::<f64>() / 3.0).sqrt()
}

/// One correlation time \[s\] for several axes: the longest, a random walk counting as one hour.
/// `None` where nothing moves.
pub(super) fn common_tau<'a>(axes: impl Iterator<Item = &'a Axis>) -> Option<f64> {
    axes.filter_map(|axis| match (axis.slow.slowest(), axis.slow.walk) {
        (Some(of), None) => Some(of.tau_s),
        (of, Some(_)) => Some(of.map_or(UNIT_ROOT_TAU, |of| of.tau_s.max(UNIT_ROOT_TAU))),
        (None, None) => None,
    })
    .max_by(f64::total_cmp)
}

/// Standard deviation [unit] of the Gauss-Markov process of correlation time `tau` \[s\] that a random
/// walk of density `drive` [unit/√s] drives: σ = K √(τ/2).
pub(super) fn driven(drive: f64, tau: f64) -> f64 {
    drive * (0.5 * tau).sqrt()
}
