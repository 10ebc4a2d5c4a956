//! Fixes of a log that says itself what it holds.

use std::path::Path;

use undrift_nav::sample::{GnssFix, Position};
use undrift_nav::{Matrix3, Vector3};

use super::is_a_fix;
use crate::ReadError;
use crate::format::Format;
use crate::log::{Fix, Log, Wanted, What};
use crate::skipped::{SkipKind, Skipped};

/// Which fixes of a log, and how certain they are.
#[derive(Clone, Debug)]
pub struct GnssLog {
    /// Format of the file.
    pub format: Format,
    /// Stream of positions, or of positions with velocities; `None` for the only one.
    pub position: Option<String>,
    /// Stream of velocities, where they are apart; `None` for the only one.
    pub velocity: Option<String>,
    /// Added to the times [s].
    pub time_offset: f64,
    /// Standard deviations north, east, down [m] instead of the file's; needed where it has none.
    pub position_std: Option<[f64; 3]>,
    /// Standard deviations north, east, down [m/s] instead of the file's; needed where it has none,
    /// but for NMEA, whose velocities are left out without.
    pub velocity_std: Option<[f64; 3]>,
    /// Factor on the standard deviations of position.
    pub position_std_factor: f64,
    /// Factor on the standard deviations of velocity.
    pub velocity_std_factor: f64,
    /// First and last time [s] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

impl GnssLog {
    /// All fixes with the log's own uncertainty.
    pub fn new(format: Format) -> Self {
        Self {
            format,
            position: None,
            velocity: None,
            time_offset: 0.0,
            position_std: None,
            velocity_std: None,
            position_std_factor: 1.0,
            velocity_std_factor: 1.0,
            span: None,
        }
    }
}

pub(super) struct LogRows {
    log: Log,
    options: GnssLog,
}

impl LogRows {
    pub(super) fn new(path: &Path, options: &GnssLog) -> Result<Self, ReadError> {
        let wanted = Wanted::Fixes {
            position: options.position.clone(),
            velocity: options.velocity.clone(),
        };
        Ok(Self {
            log: Log::open(path, options.format, &wanted)?,
            options: options.clone(),
        })
    }

    pub(super) fn skipped(&self) -> &Skipped {
        self.log.skipped()
    }

    pub(super) fn skipped_mut(&mut self) -> &mut Skipped {
        self.log.skipped_mut()
    }

    pub(super) fn path(&self) -> &Path {
        self.log.path()
    }

    /// The next fix of which something can be used, and where it stands.
    pub(super) fn next_row(&mut self) -> Result<Option<(u64, GnssFix)>, ReadError> {
        while let Some(entry) = self.log.next()? {
            let What::Fix(fix) = entry.what else {
                continue;
            };
            let usable = self.fix(entry.at, &fix)?;
            if usable.position.is_some() || usable.velocity.is_some() {
                return Ok(Some((entry.at, usable)));
            }
        }
        Ok(None)
    }

    fn fix(&mut self, at: u64, fix: &Fix) -> Result<GnssFix, ReadError> {
        let options = &self.options;
        let place = fix.position.filter(|(position, _)| match position {
            Position::Geodetic(place) => is_a_fix(place),
            Position::Baseline { .. } => true,
        });
        if place.is_none() && fix.position.is_some() {
            let detail = format!("{:?}", fix.position);
            self.log.skipped_mut().add(SkipKind::OutOfRange, at, detail);
        }
        let position = match place {
            None => None,
            Some((position, own)) => {
                let stated = options.position_std;
                let factor = options.position_std_factor;
                let covariance = certain(own, stated, factor).ok_or_else(|| {
                    self.unknown(at, "position", "gnss.position_std", "1, 1, 2 m")
                })?;
                Some((position, covariance))
            }
        };
        let velocity = match fix.velocity {
            None => None,
            // NMEA never tells, and half of the velocity is missing.
            Some(_) if options.format == Format::Nmea && options.velocity_std.is_none() => None,
            Some((velocity, own)) => {
                let stated = options.velocity_std;
                let factor = options.velocity_std_factor;
                let covariance = certain(own, stated, factor).ok_or_else(|| {
                    self.unknown(at, "velocity", "gnss.velocity_std", "0.1, 0.1, 0.2 m/s")
                })?;
                Some((velocity, covariance))
            }
        };
        let mut usable = GnssFix {
            time: fix.time + options.time_offset,
            position,
            velocity,
            quality: fix.quality,
        };
        let skipped = self.log.skipped_mut();
        usable.position = usable.position.filter(|(_, p)| sound(p, at, skipped));
        usable.velocity = usable.velocity.filter(|(_, p)| sound(p, at, skipped));
        Ok(usable)
    }

    fn unknown(&self, at: u64, what: &str, key: &str, example: &str) -> ReadError {
        let problem = format!("the log does not tell how certain its {what} is");
        ReadError::new(self.log.path(), problem)
            .at(at)
            .key(key)
            .mend(format!(
                "give it: {} = \"{example}\"",
                &key["gnss.".len()..]
            ))
    }
}

/// The stated standard deviations before the log's own covariance, times a factor.
fn certain(own: Option<Matrix3>, stated: Option<[f64; 3]>, factor: f64) -> Option<Matrix3> {
    let stated = stated.map(|std| {
        let std = Vector3::from(std);
        Matrix3::from_diagonal(&std.component_mul(&std))
    });
    Some(stated.or(own)? * (factor * factor))
}

/// Whether a covariance is one; counted where not.
fn sound(covariance: &Matrix3, at: u64, skipped: &mut Skipped) -> bool {
    let sound = covariance.iter().all(|x| x.is_finite()) && covariance.cholesky().is_some();
    if !sound {
        let [n, e, d] = [0, 1, 2].map(|i| covariance[(i, i)]);
        let detail = format_args!("variances {n}, {e}, {d}");
        skipped.add(SkipKind::Uncertainty, at, detail);
    }
    sound
}
