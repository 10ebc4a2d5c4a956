//! Samples in place of missing ones.
//!
//! Samples in place of a short gap (up to 0.2 s) let the mechanisation go through the turn that rates on both
//! sides suggest. Of a longer one they keep the time going, and the covariance grows by what a vehicle may have
//! done meanwhile ([`crate::solution`]).
//!
//! A log may lose single samples (a busy logger) or a second (a full buffer). The sample after the
//! gap has the whole gap as its interval; its mean rates are taken for those at the end, and as
//! many samples are made as are missing.

#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Vector3, sample::ImuSample};

/// The samples missing before one, made one by one: rates on a line from the last sample's to this one's.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Bridge {
    /// End of the gap \[s\].
    end: f64,
    /// Interval of the samples made \[s\].
    dt: f64,
    /// Samples to make, at least two.
    steps: u64,
    made: u64,
    /// Angular rate [rad/s] and specific force [m/s²] before and after the gap.
    from: (Vector3, Vector3),
    to: (Vector3, Vector3),
    /// In a gap too long to interpolate over: since when the covariance has yet to grow \[s\].
    pub(super) unknown_since: Option<f64>,
}

impl Bridge {
    /// Over the interval of `sample`, after the sample `before`; a gap longer than `longest` \[s\] is not
    /// interpolated over.
    ///
    /// Without `before` the rates after the gap hold throughout.
    pub(super) fn new(
        sample: &ImuSample,
        before: Option<&ImuSample>,
        interval: f64,
        longest: f64,
    ) -> Self {
        let steps = (sample.dt / interval).round().clamp(2.0, 1e6);
        let rate = |s: &ImuSample| (s.dtheta / s.dt, s.dvel / s.dt);
        let to = rate(sample);
        Self {
            end: sample.time,
            dt: sample.dt / steps,
            steps: steps as u64,
            made: 0,
            from: before.map_or(to, rate),
            to,
            unknown_since: (sample.dt > longest).then_some(sample.time - sample.dt),
        }
    }

    /// End of the last sample made \[s\].
    pub(super) fn reached(&self) -> f64 {
        self.end - (self.steps - self.made) as f64 * self.dt
    }

    /// The next sample of the gap, the last of them the one that was given; `None` when all were made.
    pub(super) fn next(&mut self) -> Option<ImuSample> {
        if self.made == self.steps {
            return None;
        }
        self.made += 1;
        let weight = self.made as f64 / self.steps as f64;
        Some(ImuSample {
            time: self.reached(),
            dt: self.dt,
            dtheta: (self.from.0 * (1.0 - weight) + self.to.0 * weight) * self.dt,
            dvel: (self.from.1 * (1.0 - weight) + self.to.1 * weight) * self.dt,
        })
    }
}

#[cfg(test)]
mod tests;
