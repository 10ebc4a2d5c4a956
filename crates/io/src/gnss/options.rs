use crate::rinex::RinexFile;
use crate::{Key, ReadError};

/// How certain the fixes of a file are, and which of them are given out.
#[derive(Clone, Debug)]
pub struct FixOptions {
    /// Added to the file's times \[s\].
    pub time_offset: f64,
    /// Standard deviations north, east, down \[m\] instead of the file's; needed where it has none.
    pub position_std: Option<[f64; 3]>,
    /// Standard deviations north, east, down [m/s] instead of the file's; needed where it has velocities
    /// without any.
    pub velocity_std: Option<[f64; 3]>,
    /// Factor on the standard deviations of position.
    pub position_std_factor: f64,
    /// Factor on the standard deviations of velocity.
    pub velocity_std_factor: f64,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
    /// RINEX files of the same receiver, observations and navigation messages: each fix at the time of an epoch gets the mean velocity by the
    /// carrier phase since the fix before. The times of the fixes are GPS seconds of a week, without the offset.
    pub observations: Vec<RinexFile>,
}

impl Default for FixOptions {
    fn default() -> Self {
        Self {
            time_offset: 0.0,
            position_std: None,
            velocity_std: None,
            position_std_factor: 1.0,
            velocity_std_factor: 1.0,
            span: None,
            observations: Vec::new(),
        }
    }
}

impl FixOptions {
    /// Whether all standard deviations and factors can be such.
    pub(crate) fn check(&self) -> Result<(), ReadError> {
        let positive = |value: &f64| value.is_finite() && *value > 0.0;
        let (position, velocity) = (self.position_std, self.velocity_std);
        for (key, constants, factor) in [
            (Key::PositionStd, position, self.position_std_factor),
            (Key::VelocityStd, velocity, self.velocity_std_factor),
        ] {
            let mut all = constants.into_iter().flatten().chain([factor]);
            if let Some(bad) = all.find(|value| !positive(value)) {
                let problem = format!("invalid standard deviation or factor: {bad}");
                return Err(ReadError::nameless(problem).key(key));
            }
        }
        Ok(())
    }
}
