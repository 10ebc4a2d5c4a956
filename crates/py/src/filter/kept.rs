//! A filter as numbers, for pickles.

use super::Held;
use undrift::{
    estimator::{self, Estimator},
    nav::{
        Vector3,
        attitude::from_rpy,
        covariance::AXES,
        earth::Geodetic,
        filter::{Each, InitialStd},
        mechanisation::NavState,
        parameters::{Parameter, Parameters, Prior},
        shaping::{MAX_ORDER, ShapingFilter},
    },
    replay::Vibration,
    settings::fix_errors::{Correlated, FixErrors},
};

/// What a filter is made of.
struct Made {
    sensors: [ShapingFilter; AXES],
    priors: [Prior; Parameter::ALL.len()],
    fix_errors: FixErrors,
    begun: f64,
    /// 1 where the noise follows the samples, and the white noise of the models and the factors then.
    follows: f64,
    white: [f64; AXES],
    factors: [f64; AXES],
}

impl Made {
    /// Calls `each` with every number, always in the same order.
    fn numbers(&mut self, each: &mut Each) {
        for sensor in &mut self.sensors {
            sensor.numbers(each);
        }
        for Prior { std, walk, time } in &mut self.priors {
            [std, walk, time].into_iter().for_each(&mut *each);
        }
        let errors = &mut self.fix_errors;
        each(&mut errors.position_factor);
        each(&mut errors.height_factor);
        for part in [&mut errors.correlated, &mut errors.velocity_correlated] {
            // A share of 0 switches it off.
            let nothing = Correlated {
                share: 0.0,
                time: 0.0,
            };
            let mut found = part.unwrap_or(nothing);
            each(&mut found.share);
            each(&mut found.time);
            *part = (found.share != 0.0).then_some(found);
        }
        let vectors = [
            &mut errors.velocity_factor,
            &mut errors.step,
            &mut errors.velocity_bias,
        ];
        vectors.into_iter().flatten().for_each(&mut *each);
        each(&mut errors.jitter);
        each(&mut self.begun);
        each(&mut self.follows);
        let axes = [&mut self.white, &mut self.factors];
        axes.into_iter().flatten().for_each(&mut *each);
    }
}

/// The numbers of a filter.
pub(super) fn numbers(held: &Held) -> Vec<f64> {
    let filter = &held.estimator;
    let none = Prior {
        std: 0.0,
        ..Prior::default()
    };
    let mut made = Made {
        sensors: std::array::from_fn(|axis| *filter.sensors().axis(axis)),
        priors: Parameter::ALL.map(|kind| filter.parameters().prior(kind).unwrap_or(none)),
        fix_errors: held.fix_errors,
        begun: f64::from(u8::from(held.begun)),
        follows: f64::from(u8::from(held.vibration.is_some())),
        white: held
            .vibration
            .as_ref()
            .map_or([0.0; AXES], Vibration::white_noise),
        factors: held
            .vibration
            .as_ref()
            .map_or([1.0; AXES], Vibration::factors),
    };
    let mut numbers = Vec::new();
    let mut keep = |number: &mut f64| numbers.push(*number);
    made.numbers(&mut keep);
    filter.boxed().numbers(&mut keep);
    if let Some(mut vibration) = held.vibration.clone() {
        vibration.numbers(&mut keep);
    }
    numbers
}

/// The filter of such numbers.
pub(super) fn held(numbers: Vec<f64>) -> Result<Held, String> {
    let mut all = numbers.into_iter();
    let mut missing = false;
    let mut put = |number: &mut f64| match all.next() {
        Some(kept) => *number = kept,
        None => missing = true,
    };
    let empty = ShapingFilter::none(1.0).map_err(|problem| problem.to_string())?;
    let mut made = Made {
        sensors: [empty; AXES],
        priors: [Prior::default(); Parameter::ALL.len()],
        fix_errors: FixErrors::default(),
        begun: 0.0,
        follows: 0.0,
        white: [0.0; AXES],
        factors: [1.0; AXES],
    };
    made.numbers(&mut put);
    if made.sensors.iter().any(|axis| axis.order > MAX_ORDER) {
        return Err("not the numbers of a filter".into());
    }
    let mut parameters = Parameters::none();
    for (kind, prior) in Parameter::ALL.into_iter().zip(made.priors) {
        if prior.std > 0.0 {
            parameters = parameters.with(kind, prior);
        }
    }
    // Anywhere: its numbers follow.
    let nav = NavState {
        time: 0.0,
        position: Geodetic {
            lat: 0.0,
            lon: 0.0,
            height: 0.0,
        },
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let one = Vector3::repeat(1.0);
    let std = InitialStd {
        position: one,
        velocity: one,
        attitude: one,
    };
    let filter = estimator::build(nav, &std, &made.sensors, parameters);
    let mut filter: Box<dyn Estimator> = filter.map_err(|problem| problem.to_string())?;
    filter.numbers(&mut put);
    let mut models = made.sensors;
    for (model, white) in models.iter_mut().zip(made.white) {
        model.r = white;
    }
    let mut vibration = (made.follows != 0.0).then(|| Vibration::new(&models, &made.factors));
    if let Some(vibration) = &mut vibration {
        vibration.numbers(&mut put);
    }
    if missing || all.next().is_some() || filter.check().is_err() {
        return Err("not the numbers of a filter".into());
    }
    Ok(Held {
        estimator: filter,
        begun: made.begun != 0.0,
        fix_errors: made.fix_errors,
        vibration,
    })
}
