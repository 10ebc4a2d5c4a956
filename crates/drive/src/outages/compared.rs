//! Models that are compared in the outages of a drive: bias models of one noise model, or noise models of one bias model.

use super::Logs;
use crate::{drive::Drive, navigate::NavigateError, temperature};
use std::{borrow::Cow, collections::HashSet};
use undrift_nav::sample::ImuSample;
use undrift_noise::{BiasModel, ImuModel};

/// One row of the tables: a bias model of the drive's noise model, or a noise model of its own.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{BiasModel, ImuModel, outages::ComparedModel};
/// let arma = ComparedModel::from(BiasModel::Arma);
/// assert!(arma.name == "arma" && arma.model.is_none());
/// // Two noise models, each as a Gauss-Markov bias.
/// let sensors = ["adis16465", "bmi088"].map(|name| (name.to_owned(), ImuModel::preset(name).expect("a preset")));
/// let compared = ComparedModel::each(sensors, BiasModel::GaussMarkov);
/// assert_eq!(compared[1].name, "bmi088");
/// ```
#[derive(Clone, Debug)]
pub struct ComparedModel {
    /// Its name in the tables.
    pub name: String,
    /// Bias model of the filter.
    pub kind: BiasModel,
    /// Noise model; the drive's where absent.
    pub model: Option<ImuModel>,
}

impl From<BiasModel> for ComparedModel {
    /// A bias model of the drive's noise model, under its own name.
    fn from(kind: BiasModel) -> Self {
        Self {
            name: kind.name().into(),
            kind,
            model: None,
        }
    }
}

impl ComparedModel {
    /// Noise models under their names, each run as `kind`. A second one of a name becomes NAME-2.
    pub fn each(
        models: impl IntoIterator<Item = (String, ImuModel)>,
        kind: BiasModel,
    ) -> Vec<Self> {
        let mut taken = HashSet::new();
        let unique = |(name, model): (String, ImuModel)| {
            let more = (2..).map(|nth| format!("{name}-{nth}"));
            let mut names = std::iter::once(name.clone()).chain(more);
            let name = names.find(|name| taken.insert(name.clone()));
            Self {
                name: name.unwrap_or_default(),
                kind,
                model: Some(model),
            }
        };
        models.into_iter().map(unique).collect()
    }

    /// The drive with its noise model.
    pub(super) fn with_model<'a>(&self, drive: &'a Drive) -> Cow<'a, Drive> {
        match &self.model {
            None => Cow::Borrowed(drive),
            Some(model) => Cow::Owned(Drive {
                model: Some(model.clone()),
                ..drive.clone()
            }),
        }
    }
}

impl Logs {
    /// The inertial samples under the noise model of `drive`, which is that of the logs but for the model: they are read again
    /// where a model has an effect of temperature.
    pub(super) fn samples_of(&self, drive: &Drive) -> Result<Cow<'_, [ImuSample]>, NavigateError> {
        let [own, other] = [&self.drive, drive].map(|of| of.model.as_ref());
        let [own, other] = [own, other].map(|model| model.and_then(temperature::of_model));
        if own == other {
            return Ok(Cow::Borrowed(&self.imu));
        }
        let samples: Result<Vec<_>, _> = drive.open_imu()?.collect();
        Ok(Cow::Owned(samples?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let model = ImuModel::preset("adis16405").unwrap();
        let names = ["imu", "imu-2", "imu", "tuned", "imu"];
        let models = names.map(|name| (name.to_owned(), model.clone()));
        let compared = ComparedModel::each(models, BiasModel::Ar);
        let names: Vec<&str> = compared.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["imu", "imu-2", "imu-3", "tuned", "imu-4"]);
        assert!(compared.iter().all(|one| one.kind == BiasModel::Ar));
    }
}
