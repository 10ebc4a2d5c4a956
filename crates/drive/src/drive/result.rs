//! A drive as results describe it.

use super::{Drive, ScalarLog};
use std::path::Path;
use undrift_results::{self as results, Keyed, Number, Start, name, parts_used, series::to_digits};

impl Drive {
    /// What results say of it; `file` names it.
    pub fn result(&self, file: &Path) -> results::Drive {
        let interval = self.sample_interval().ok();
        results::Drive {
            simulated: None,
            file: Some(name(file)),
            imu: Some(name(&self.imu.0)),
            gnss: Some(name(&self.gnss.0)),
            posed: self.poses.is_some(),
            truth: self.truth.as_ref().map(|(path, _)| name(path)),
            scalars: Keyed::new(|log: ScalarLog| {
                self.scalars[log].as_ref().map(|(path, _)| name(path))
            }),
            magnetometer: (self.magnetometer.as_ref()).map(|(path, _)| name(path)),
            start: self.start(),
            rate_hz: interval.map(|interval| to_digits(1.0 / interval)).into(),
            model: self.model.as_ref().map(|model| model.name.clone()),
            lever_arm_m: Some(<[f64; 3]>::from(self.lever_arm).map(Number)),
            gnss_use: Some(parts_used(self.gnss_use).into()),
            gating: Some(self.gating),
            adapt: Some(self.adapt),
        }
    }

    /// When it starts, where its logs have a date.
    fn start(&self) -> Option<Start> {
        let (epoch, time) = (self.epoch?, self.beginning.time?);
        Some(Start {
            time_s: Number(time),
            utc: epoch.iso(time),
            unix_s: Number(epoch.unix(time)),
            clock: epoch.clock.name().into(),
        })
    }
}
