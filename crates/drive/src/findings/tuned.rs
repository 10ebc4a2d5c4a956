//! Findings of a drive whose noise model was identified from drives.

use super::Finding;
use undrift_noise::{
    ImuModel,
    model_file::{AXES, AxisModel},
};

/// How a model that was identified from drives says so in its source.
pub const IN_VEHICLE: &str = "by composite likelihood";

/// Whether a noise model was identified from drives.
pub fn is_tuned(model: &ImuModel) -> bool {
    model.source.contains(IN_VEHICLE)
}

/// The findings of a drive with this noise model: what was tuned on drives needs no tuning.
pub fn of_model(mut found: Vec<Finding>, model: Option<&ImuModel>) -> Vec<Finding> {
    let is_tuned = model.is_some_and(is_tuned);
    for of in &mut found {
        if let Finding::OptimisticModel { tuned, .. }
        | Finding::CorrelatedInnovations { tuned, .. }
        | Finding::OptimisticDrift { tuned, .. } = of
        {
            *tuned = is_tuned;
        }
    }
    found.extend(model.and_then(of_sign));
    found
}

/// An autoregressive coefficient beyond which a model of one and one is a slow bias, and the moving average that belongs to it is as near
/// to 1 under white noise.
const SLOW: f64 = 0.95;
/// A moving average below this has the sign of programs that add it.
const ADDED: f64 = -0.3;

/// Axes of a model that nothing here identified whose moving average seems to have the other sign.
fn of_sign(model: &ImuModel) -> Option<Finding> {
    let axes = AXES.into_iter().zip(model.gyro.iter().chain(&model.accel));
    let has_other_sign = |axis: &AxisModel| {
        let arma = axis.arma.as_ref().map(|arma| (&arma.ar[..], &arma.ma[..]));
        axis.identification.is_empty()
            && matches!(arma, Some((&[ar], &[ma])) if ar > SLOW && ma < ADDED)
    };
    let axes = axes.filter(|(_, axis)| has_other_sign(axis));
    let axes = Vec::from_iter(axes.map(|(name, _)| name.to_owned()));
    (!axes.is_empty()).then_some(Finding::MovingAverageSign { axes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_noise::model_file::Arma;

    #[test]
    fn findings_of_a_tuned_model_say_so() {
        let model = ImuModel::default();
        assert!(!is_tuned(&model));
        let drift = Finding::OptimisticDrift {
            model: "arma".into(),
            inside: 0.5,
            outside: 1,
            outages: 20,
            tuned: false,
        };
        let found = vec![drift, Finding::Late { delay: 1.0 }];
        assert_eq!(of_model(found.clone(), None), found);
        assert_eq!(of_model(found.clone(), Some(&model)), found);
    }

    #[test]
    fn a_moving_average_that_other_programs_add_is_asked_about() {
        let with = |ar: &[f64], ma: &[f64]| {
            let mut model = ImuModel::default();
            model.gyro[2].arma = Some(Arma {
                ar: ar.to_vec(),
                ma: ma.to_vec(),
                sigma: 1e-3,
                rate_hz: 100.0,
            });
            model
        };
        let found = |model: &ImuModel| of_model(Vec::new(), Some(model));
        let axes = vec!["gyro_z".to_owned()];
        let expected = [Finding::MovingAverageSign { axes }];
        assert_eq!(found(&with(&[0.995], &[-0.95])), expected);
        for (ar, ma) in [
            (&[0.995][..], &[0.95][..]),
            (&[0.95], &[-0.95]),
            (&[0.995], &[-0.3]),
            (&[0.995, 0.001], &[-0.95]),
        ] {
            assert_eq!(found(&with(ar, ma)), [], "{ar:?} {ma:?}");
        }
        // What was identified here has the sign of here.
        let mut identified = with(&[0.995], &[-0.95]);
        let chosen = ("chosen".to_owned(), toml::Value::from("ARMA(1,1)"));
        identified.gyro[2].identification.extend([chosen]);
        assert_eq!(found(&identified), []);
    }
}
