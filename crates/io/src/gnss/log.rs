//! Fixes of a log that says itself what it holds.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{GnssFix, MeanVelocity, Position};
use undrift_nav::{Matrix3, Vector3};

use super::options::FixOptions;
use crate::entry::Fix;
use crate::fix::{is_covariance, on_earth, shown};
use crate::format::Format;
use crate::skipped::{SkipKind, Skipped};
use crate::{Key, ReadError};

/// Which fixes of a log, and how certain they are.
#[derive(Clone, Debug)]
pub struct GnssLog {
    /// Format of the file.
    pub format: Format,
    /// Stream of positions, or of positions with velocities; `None` for the only one.
    pub position: Option<String>,
    /// Stream of velocities, where they are apart; `None` for the only one.
    pub velocity: Option<String>,
    /// The base station of baselines.
    pub base: Option<Geodetic>,
    /// How certain they are, and which are given out; a velocity of unknown uncertainty is skipped.
    pub fixes: FixOptions,
}

impl GnssLog {
    /// All fixes with the log's own uncertainty.
    pub fn new(format: Format) -> Self {
        Self {
            format,
            position: None,
            velocity: None,
            base: None,
            fixes: FixOptions::default(),
        }
    }
}

/// What is made of the fixes of a log.
pub(super) struct LogFixes {
    options: FixOptions,
    positions: u64,
    /// Place of the first position of unknown uncertainty.
    unknown: Option<u64>,
    /// Velocities left out because nobody says how certain they are.
    pub(super) untold_velocities: u64,
}

impl LogFixes {
    pub(super) fn new(log: &GnssLog) -> Self {
        Self {
            options: log.fixes.clone(),
            positions: 0,
            unknown: None,
            untold_velocities: 0,
        }
    }

    /// Whether the positions of a log could be used.
    pub(super) fn end(&self) -> Result<(), ReadError> {
        match self.unknown {
            Some(at) if self.positions == 0 => Err(ReadError::nameless(
                "the log does not report the accuracy of its positions",
            )
            .at(at)
            .key(Key::PositionStd)
            .mend("set position_std = \"1, 1, 2 m\"")),
            _ => Ok(()),
        }
    }

    pub(super) fn fix(&mut self, at: u64, fix: &Fix, skipped: &mut Skipped) -> GnssFix {
        let place = fix.position.filter(|(position, _)| match position {
            Position::Geodetic(place) => on_earth(*place).is_ok(),
            Position::Baseline { .. } => true,
        });
        if let (None, Some((position, _))) = (&place, &fix.position) {
            skipped.add(SkipKind::OutOfRange, at, shown(position));
        }
        let options = &self.options;
        let mut certain =
            |own: Option<Matrix3>, stated: Option<[f64; 3]>, factor: f64, key: &str| {
                let stated =
                    stated.map(|std| Matrix3::from_diagonal(&Vector3::from(std).map(|s| s * s)));
                let covariance = stated.or(own).map(|p| p * (factor * factor));
                if covariance.is_none() {
                    skipped.add(SkipKind::NoUncertainty, at, format_args!("set {key}"));
                }
                covariance
            };
        let position = place.and_then(|(position, own)| {
            let factor = options.position_std_factor;
            let covariance = certain(own, options.position_std, factor, "gnss.position_std");
            Some((position, covariance?))
        });
        let velocity = fix.velocity.and_then(|(velocity, own)| {
            let factor = options.velocity_std_factor;
            let covariance = certain(own, options.velocity_std, factor, "gnss.velocity_std");
            Some((velocity, covariance?))
        });
        let factor = options.velocity_std_factor;
        let mean_velocity = fix.mean_velocity.map(|mean| MeanVelocity {
            covariance: mean.covariance * (factor * factor),
            ..mean
        });
        self.untold_velocities += u64::from(fix.velocity.is_some() && velocity.is_none());
        if place.is_some() && position.is_none() {
            self.unknown.get_or_insert(at);
        }
        let position = position.filter(|(_, p)| sound(p, at, skipped));
        self.positions += u64::from(position.is_some());
        GnssFix {
            attitude: None,
            mean_velocity,
            time: fix.time + options.time_offset,
            position,
            velocity: velocity.filter(|(_, p)| sound(p, at, skipped)),
            quality: fix.quality,
        }
    }
}

/// Whether a covariance is one; counted where not.
fn sound(covariance: &Matrix3, at: u64, skipped: &mut Skipped) -> bool {
    let sound = is_covariance(covariance);
    if !sound {
        let [n, e, d] = [0, 1, 2].map(|i| covariance[(i, i)]);
        let detail = format_args!("variances {n}, {e}, {d}");
        skipped.add(SkipKind::Uncertainty, at, detail);
    }
    sound
}
