//! What a filter refuses leaves it as it was.

use super::doubts::at_rest;
use undrift_nav::{
    Matrix3, Vector3,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, FilterError, Gate, InitialStd, StepError},
    parameters::Parameters,
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

const T: f64 = 0.01;

fn filter() -> Filter<15> {
    let (nav, std) = at_rest();
    let std = InitialStd {
        velocity: Vector3::repeat(0.1),
        ..std
    };
    let sensor = ShapingFilter::constant(1e-3, T).unwrap();
    Filter::new(nav, &std, [sensor; AXES], Parameters::none()).unwrap()
}

fn sample(time: f64, dt: f64, dvel: f64) -> ImuSample {
    ImuSample {
        time,
        dt,
        dtheta: Vector3::new(1e-4, 0.0, 0.0),
        dvel: Vector3::new(dvel, 0.0, -9.8 * dt),
    }
}

#[test]
fn a_measurement_that_throws_the_solution_off_the_earth() {
    let mut filter = filter();
    filter.predict(&sample(T, T, 0.0));
    let before = filter.clone();
    // Degrees where radians belong: 44 rad further north.
    let place = Position::Geodetic(Geodetic {
        lat: 45.0,
        lon: 7.0,
        height: 300.0,
    });
    let far = filter.observe_position(&place, &Vector3::zeros());
    let fast = filter.observe_velocity(&Vector3::new(1e9, 0.0, 0.0), &Vector3::zeros());
    for observed in [far, fast] {
        let refused = filter.update(&observed, &Matrix3::identity(), &Gate::OPEN);
        assert_eq!(refused, Err(FilterError::Implausible));
    }
    let mut none = filter.observe_zero_velocity();
    none.innovation.x = f64::NAN;
    let refused = filter.update(&none, &Matrix3::identity(), &Gate::OPEN);
    assert_eq!(refused, Err(FilterError::BadMeasurement));
    assert_eq!(filter.nav(), before.nav());
    assert_eq!(filter.covariance(), before.covariance());
    assert_eq!(filter.estimates(), before.estimates());
    // It goes on.
    let rest = filter.observe_zero_velocity();
    filter
        .update(&rest, &Matrix3::identity(), &Gate::OPEN)
        .unwrap();
}

#[test]
fn a_sample_that_cannot_be_the_next() {
    let mut filter = filter();
    assert_eq!(filter.accepts_step(&sample(T, T, 0.01)), Ok(()));
    for (time, dt) in [
        (T, 0.0),
        (T, -T),
        (T, f64::NAN),
        (11.0, 11.0),
        (f64::INFINITY, T),
    ] {
        let refused = filter.step(&sample(time, dt, 0.0));
        assert!(
            matches!(refused, Err(StepError::Invalid { .. })),
            "{refused:?}"
        );
    }
    let gap = |time, dt| StepError::Gap {
        reached: 0.0,
        time,
        dt,
    };
    for (problem, sample) in [
        (StepError::OutOfRange, sample(T, T, 1e5)),
        (StepError::NotFinite, sample(T, T, f64::NAN)),
        (gap(3.1 * T, 2.0 * T), sample(3.1 * T, 2.0 * T, 0.0)),
        // One too many: it comes twice, or of a clock set back.
        (gap(0.0, T), sample(0.0, T, 0.0)),
    ] {
        assert_eq!(filter.step(&sample), Err(problem));
    }
    assert_eq!(filter.sample_end(), None);
    assert_eq!(filter.nav().time, 0.0);
    // Half of a sample more or less is the stamps' jitter.
    filter.step(&sample(1.4 * T, T, 0.0)).unwrap();
    assert_eq!((filter.nav().time, filter.reached()), (1.4 * T, 1.4 * T));
}

#[test]
fn a_step_in_parts_is_the_step() {
    let (mut whole, mut parts) = (filter(), filter());
    for k in 1..10 {
        let sample = sample(k as f64 * T, T, 0.01);
        whole.step(&sample).unwrap();
        // The next one ends the one before.
        parts.begin_step(&sample).unwrap();
        assert_eq!(parts.sample_end(), Some(sample.time));
    }
    parts.advance(1.0);
    assert_eq!(parts.sample_end(), None);
    assert_eq!(whole.nav(), parts.nav());
    assert_eq!(whole.covariance(), parts.covariance());
}
