//! A record through the filter.

use crate::record::{Fix, Record};
use core::fmt;
use undrift_nav::{
    Matrix3, Vector3, attitude,
    filter::{Filter, FilterError, Gate},
    parameters::Parameters,
    sample::Position,
    shaping::{ShapingError, ShapingFilter},
};

/// A fix this near to a sample's end [s] is taken at it.
pub const ROUNDING: f64 = 1e-6;
/// Weakened where a measurement of three components would lie beyond it once in a thousand, left out
/// once in a billion: chi-squared with three degrees of freedom.
pub const GATE: Gate = Gate {
    weaken: 16.27,
    reject: 44.8,
};
/// Numbers of a line of [`states`].
pub const NUMBERS: usize = 31;

/// Why there is no result.
#[derive(Clone, Copy, Debug)]
pub enum Failure {
    /// The bytes are no record.
    NoRecord,
    /// The noise model cannot be.
    Model(ShapingError),
    /// The filter refused.
    Filter(FilterError),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRecord => f.write_str("the record is damaged"),
            Self::Model(error) => error.fmt(f),
            Self::Filter(error) => error.fmt(f),
        }
    }
}

/// The filter at the record's start.
///
/// # Errors
/// More states than `N`, or a start that is no place.
pub fn begin<const N: usize>(
    record: &Record,
    sensors: [ShapingFilter; 6],
) -> Result<Filter<N>, Failure> {
    Filter::new(record.start, &record.std, sensors, Parameters::none()).map_err(Failure::Filter)
}

/// Carries `filter` through the whole record and calls `each_second` after every full second.
///
/// # Errors
/// A fix that is no measurement, or a solution that diverged.
pub fn navigate<const N: usize>(
    record: &Record,
    filter: &mut Filter<N>,
    mut each_second: impl FnMut(&Filter<N>),
) -> Result<(), Failure> {
    let mut fixes = record.fixes().peekable();
    let mut second = 1.0;
    for sample in record.samples() {
        filter.begin(&sample);
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + ROUNDING) {
            filter.advance_to(fix.time, ROUNDING);
            position(filter, &fix, &record.lever_arm)?;
            velocity(filter, &fix, &record.lever_arm)?;
        }
        filter.advance(1.0);
        if sample.time > second - 0.5 * record.interval {
            filter.check().map_err(Failure::Filter)?;
            each_second(filter);
            second += 1.0;
        }
    }
    Ok(())
}

/// Updates with the position of a fix.
///
/// # Errors
/// An invalid covariance.
pub fn position<const N: usize>(
    filter: &mut Filter<N>,
    fix: &Fix,
    lever_arm: &Vector3,
) -> Result<(), Failure> {
    let observed = filter.observe_position(&Position::Geodetic(fix.position), lever_arm);
    let r = Matrix3::from_diagonal(&fix.position_std.component_mul(&fix.position_std));
    filter
        .update(&observed, &r, &GATE)
        .map_err(Failure::Filter)?;
    Ok(())
}

/// Updates with the velocity of a fix.
///
/// # Errors
/// An invalid covariance.
pub fn velocity<const N: usize>(
    filter: &mut Filter<N>,
    fix: &Fix,
    lever_arm: &Vector3,
) -> Result<(), Failure> {
    let observed = filter.observe_velocity(&fix.v_n, lever_arm);
    let r = Matrix3::from_diagonal(&fix.velocity_std.component_mul(&fix.velocity_std));
    filter
        .update(&observed, &r, &GATE)
        .map_err(Failure::Filter)?;
    Ok(())
}

/// Time [s], latitude, longitude [rad], height [m], velocity [m/s], roll, pitch, yaw [rad], errors of
/// gyros [rad/s] and accelerometers [m/s²], then the standard deviations of all but the time.
pub fn states<const N: usize>(filter: &Filter<N>) -> [f64; NUMBERS] {
    let nav = filter.nav();
    let place = nav.position;
    let rpy = attitude::to_rpy(&nav.q_nb);
    let mut numbers = [0.0; NUMBERS];
    let values = [nav.time, place.lat, place.lon, place.height]
        .into_iter()
        .chain(nav.v_n.iter().copied())
        .chain(rpy.iter().copied())
        .chain(filter.sensor_error())
        .chain(filter.nav_std())
        .chain(filter.sensor_error_std());
    for (slot, value) in numbers.iter_mut().zip(values) {
        *slot = value;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MINUTE, models};

    /// Normalised squared error of position, velocity and attitude at the minute's end.
    fn nees<const N: usize>(sensors: models::Sensors) -> f64 {
        let record = Record::new(MINUTE).unwrap();
        let mut filter = begin::<N>(&record, sensors).unwrap();
        let mut lines = 0;
        navigate(&record, &mut filter, |_| lines += 1).unwrap();
        assert_eq!(lines, 60);
        let (nav, end) = (filter.nav(), &record.end);
        assert!((nav.time - end.time).abs() < 1e-9);
        // Estimate less truth: ψ turns the estimate to the truth.
        let psi = (end.q_nb * nav.q_nb.inverse()).scaled_axis();
        let dr = end.position.offset_to(&nav.position);
        let dv = nav.v_n - end.v_n;
        let error = [dr.x, dr.y, dr.z, dv.x, dv.y, dv.z, psi.x, psi.y, psi.z];
        let p = filter.covariance().fixed_view::<9, 9>(0, 0).into_owned();
        let inverse = p.try_inverse().unwrap();
        (0..9)
            .flat_map(|i| (0..9).map(move |j| (i, j)))
            .map(|(i, j)| error[i] * inverse[(i, j)] * error[j])
            .sum()
    }

    #[test]
    fn the_minute_ends_where_it_should() {
        let interval = Record::new(MINUTE).unwrap().interval;
        // Chi-squared with nine degrees of freedom is above 27.9 once in a thousand.
        let arma = nees::<{ models::ARMA_STATES }>(models::arma(interval).unwrap());
        assert!(arma < 27.9, "{arma}");
        let walk = nees::<{ models::RANDOM_WALK_STATES }>(models::random_walk(interval).unwrap());
        assert!(walk < 27.9, "{walk}");
    }

    #[test]
    fn damaged_records_are_refused() {
        assert!(Record::new(&[]).is_none());
        assert!(Record::new(&MINUTE[..MINUTE.len() - 1]).is_none());
        let mut bytes = MINUTE.to_vec();
        bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(Record::new(&bytes).is_none());
        bytes[0] = 0;
        assert!(Record::new(&bytes).is_none());
    }
}
