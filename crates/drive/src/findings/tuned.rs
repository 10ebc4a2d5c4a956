//! Findings of a drive whose noise model was identified from drives.

use super::Finding;
use undrift_noise::ImuModel;

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
    found
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
