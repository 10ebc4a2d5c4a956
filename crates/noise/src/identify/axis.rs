//! What is found of one axis, and the candidates for its model.

use super::{Detrend, FitRemark, RecordRemark, Residuals};
use crate::{
    allan::{Curve, GaussMarkovFit, Interval, Terms},
    arma::{ArmaFit, Selection},
    compared::{Method, Unfit},
    composite::{CompositeFit, ParameterInterval},
    drift_score::{HorizonScore, Reason},
    model_file::{self, AxisModel},
    normality::Normality,
    pandit_wu::PanditWu,
    scales::Scales,
    screening::{Hanging, Motion, Outlier, Saturation},
    spectrum::{Density, Line},
    stationarity::{Adf, Kpss, PhillipsPerron, Verdict},
    temperature::Estimate,
    whiteness::Portmanteau,
};
use undrift_base::number::rounded;

/// One candidate model.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name, such as "ARMA(1,1)" or "white + random walk".
    pub name: String,
    /// A method of the literature or an order chosen by F tests or AIC, scored for comparison and never recommended.
    pub compared: bool,
    /// The model of the axis in the terms of the model file.
    pub model: AxisModel,
    /// States of its shaping filter, the turn-on constant's included.
    pub states: usize,
    /// Parameters fitted.
    pub parameters: usize,
    /// The fit it comes from.
    pub origin: Origin,
    /// Ljung-Box p of its residuals at 20 lags, for ARMA and AR models.
    pub ljung_box_p: Option<f64>,
    /// Akaike's criterion of block averages of the record: comparable among all candidates.
    pub aic: f64,
    /// RMS prediction error of the integrated signal at each horizon: fitted on one half of the record, scored on the
    /// other, both ways.
    pub score: Vec<HorizonScore>,
    /// What should be said with it.
    pub remarks: Vec<FitRemark>,
}

/// Where the parameters of a candidate come from.
#[derive(Clone, Debug)]
pub enum Origin {
    /// The terms of the Allan deviation.
    Allan,
    /// Maximum likelihood of an ARMA.
    Arma(Box<ArmaFit>),
    /// Burg's method.
    Burg,
    /// Maximum likelihood of a sum of terms, with the wavelet moments it started from.
    Composite(Box<CompositeFit>),
    /// As others fit it.
    Compared(Method),
    /// Mean spectrum of the sums of terms that the record does not tell apart, by Akaike weight.
    Average,
}

/// A method of the literature that gave no model of the record.
///
/// Reported beside the candidates, so that a method which is missing from a table is not taken for forgotten.
#[derive(Clone, Debug, PartialEq)]
pub struct NotFitted {
    /// Name that its candidate would have.
    pub name: String,
    /// Why.
    pub reason: Unfit,
}

/// Everything found of one axis. SI units.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Samples of the record.
    pub samples: usize,
    /// Mean removed \[unit\].
    pub mean: f64,
    /// What was removed beside it.
    pub removed: Detrend,
    /// How the bias goes with temperature, where the record has one that changes; removed where it is determined.
    pub temperature: Option<Estimate>,
    /// Samples replaced for being outliers.
    pub outliers: Vec<Outlier>,
    /// Whether the sensor moved.
    pub motion: Option<Motion>,
    /// Ends of the range where samples pile up.
    pub saturation: Vec<Saturation>,
    /// Stretches of a thousand equal samples or more.
    pub hanging: Vec<Hanging>,
    /// Where the mean stays amid a step larger than the noise, the share of the noise at another mean that shows.
    pub noise_shown: Option<f64>,
    /// Augmented Dickey-Fuller, constant, 20 lags.
    pub adf: Adf,
    /// The same with the lags, up to 20, that a rule chooses: name of the rule and test.
    pub adf_chosen: Vec<(&'static str, Adf)>,
    /// KPSS about a level.
    pub kpss: Kpss,
    /// Phillips-Perron, constant.
    pub phillips_perron: PhillipsPerron,
    /// The three weighed.
    pub stationarity: Verdict,
    /// Moments, Jarque-Bera, Kolmogorov-Smirnov, Lilliefors, quantisation step.
    pub normality: Normality,
    /// Autocorrelation at lags 0…[`super::LAGS`].
    pub acf: Vec<f64>,
    /// Partial autocorrelation at lags 0…[`super::LAGS`].
    pub pacf: Vec<f64>,
    /// Ljung-Box of the record at 20 lags.
    pub whiteness: Portmanteau,
    /// Welch power spectral density, lines included.
    pub psd: Density,
    /// Lines and narrow resonances, which were taken out for everything below and for the tests above.
    pub lines: Vec<Line>,
    /// Overlapping Allan deviation at octaves.
    pub allan: Curve,
    /// Its 68 % intervals.
    pub allan_intervals: Vec<Interval>,
    /// Terms fitted to it.
    pub allan_terms: Terms,
    /// White noise and Gauss-Markov process fitted to it.
    pub allan_gauss_markov: Option<GaussMarkovFit>,
    /// The paper's procedure on at most [`super::SEARCH_SAMPLES`] samples, the search at reduced effort.
    pub pandit_wu: Option<PanditWu>,
    /// A grid of orders by information criteria, p, q ≤ [`super::GRID_ORDER`], on at most
    /// [`super::SEARCH_SAMPLES`] samples, at low effort.
    pub box_jenkins: Option<Selection>,
    /// What is left by the model that the paper's procedure chose, and by the recommended one where
    /// that is another ARMA.
    pub residuals: Vec<Residuals>,
    /// The fits of block averages: whether the slow part is the same at every scale.
    pub scales: Option<Scales>,
    /// Candidates with their scores, in the order tried.
    pub candidates: Vec<Candidate>,
    /// Methods of the literature that have no model of the record.
    pub not_fitted: Vec<NotFitted>,
    /// 95 % intervals of the recommended candidate's parameters, if it is a sum of terms.
    pub intervals: Vec<ParameterInterval>,
    /// Index of the recommended candidate.
    pub chosen: usize,
    /// Why.
    pub reason: Reason,
    /// What should be said with the record; those on the models are with each of them.
    pub remarks: Vec<RecordRemark>,
}

impl Axis {
    /// The recommended candidate.
    pub fn recommended(&self) -> &Candidate {
        &self.candidates[self.chosen]
    }

    /// Positions of the candidates by growing drift at the longest horizon.
    /// A candidate without a score is last. The recommended one need not be first: see [`Reason`].
    pub fn ranking(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.candidates.len()).collect();
        let drift = |i: &usize| self.candidates[*i].last_rms();
        order.sort_by(|a, b| drift(a).total_cmp(&drift(b)));
        order
    }

    /// The model to store: the recommended one, with the runner-up and the scores beside it.
    ///
    /// ```
    /// use undrift_noise::{ImuModel, composite::CompositeTerms, identify::{Options, identify}, synthesis::NoiseGenerator};
    /// let noise = CompositeTerms { white: 1e-3, ..CompositeTerms::default() }.to_shaping(0.1)?;
    /// let record: Vec<f64> = NoiseGenerator::new(&noise, 1).take(2000).map(|x| x + 0.05).collect();
    /// let gyro = identify(&record, false, &Options::at(10.0))?.model();
    /// assert!((gyro.turn_on - 0.05).abs() < 1e-3, "the mean of a gyro at rest is its turn-on constant");
    /// // Stored and read again: the model and what identification found out.
    /// let stored = ImuModel::new("bench gyro", gyro, Default::default()).to_toml();
    /// let read = ImuModel::from_toml(&stored, "imu.toml")?;
    /// assert!(read.gyro[0].identification.contains_key("drift_scores"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn model(&self) -> AxisModel {
        let chosen = self.recommended();
        let list = |of: fn(&HorizonScore) -> f64, scores: &[HorizonScore]| -> toml::Value {
            let scores = scores.iter().map(of).map(|score| rounded(score, DIGITS));
            scores.collect::<Vec<f64>>().into()
        };
        let scores = self.candidates.iter();
        let scores: toml::Table = scores
            .map(|candidate| (candidate.name.clone(), list(|s| s.rms, &candidate.score)))
            .collect();
        let note: [(&str, toml::Value); 4] = [
            ("model", chosen.name.as_str().into()),
            ("reason", model_file::reason(&self.reason).into()),
            ("horizons_s", list(|s| s.horizon_s, &chosen.score)),
            ("drift_scores", scores.into()),
        ];
        let others = |i: &usize| *i != self.chosen && !self.candidates[*i].compared;
        let runner_up = self.ranking().into_iter().find(others);
        let runner_up = runner_up.map(|i| ("runner_up", self.candidates[i].name.as_str().into()));
        let note = note.into_iter().chain(runner_up);
        AxisModel {
            lines: self.lines.iter().map(in_model).collect(),
            temperature: self.temperature.as_ref().and_then(Estimate::in_model),
            identification: note.map(|(key, value)| (key.to_owned(), value)).collect(),
            ..chosen.model.clone()
        }
    }
}

/// A line in the form of the model file.
fn in_model(line: &Line) -> model_file::Line {
    model_file::Line {
        frequency_hz: line.frequency_hz,
        amplitude: line.amplitude,
        width_hz: line.width_hz,
    }
}

/// Digits of a score: more than its sampling error supports.
const DIGITS: usize = 4;

impl Candidate {
    /// The ARMA fit it comes from, if it does.
    pub fn arma(&self) -> Option<&ArmaFit> {
        match &self.origin {
            Origin::Arma(fit) => Some(fit),
            _ => None,
        }
    }

    /// The composite fit it comes from, if it does.
    pub fn composite(&self) -> Option<&CompositeFit> {
        match &self.origin {
            Origin::Composite(fit) => Some(fit),
            _ => None,
        }
    }

    /// Score at the longest horizon [unit·s]; infinite without one.
    fn last_rms(&self) -> f64 {
        self.score.last().map_or(f64::INFINITY, |s| s.rms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drift_score::Choice;

    fn candidate(name: &str, rms: f64, compared: bool) -> Candidate {
        Candidate {
            name: name.to_owned(),
            compared,
            model: AxisModel {
                white: Some(rms),
                ..AxisModel::default()
            },
            states: 1,
            parameters: 1,
            origin: Origin::Burg,
            ljung_box_p: None,
            aic: 0.0,
            score: [1.0, 10.0]
                .map(|horizon_s| HorizonScore {
                    horizon_s,
                    rms: rms * horizon_s,
                    standard_error: 0.0,
                    predicted_rms: 0.0,
                    origins: 1,
                    windows: 1.0,
                    batches: Vec::new(),
                })
                .to_vec(),
            remarks: Vec::new(),
        }
    }

    /// White noise and a line, with candidates of its own.
    fn axis() -> Axis {
        let mut record = vec![0.0; 2000];
        let white = undrift_nav::shaping::ShapingFilter::white(0.1, 0.1).unwrap();
        crate::synthesis::NoiseGenerator::new(&white, 3).fill(&mut record);
        let options = super::super::Options {
            n_max: 1,
            ..super::super::Options::at(10.0)
        };
        let found = super::super::identify(&record, false, &options).unwrap();
        Axis {
            candidates: vec![
                candidate("third", 3.0, false),
                candidate("first", 1.0, true),
                candidate("second", 2.0, false),
            ],
            chosen: 0,
            reason: Reason {
                name: "third".to_owned(),
                states: 1,
                parameters: 2,
                horizons_s: vec![1.0, 10.0],
                choice: Choice::LeastDrift,
            },
            lines: vec![Line {
                frequency_hz: 3.0,
                amplitude: 0.5,
                width_hz: 0.1,
                ..Line::default()
            }],
            ..found
        }
    }

    #[test]
    fn candidates_rank_by_drift_and_the_runner_up_is_none_of_the_literature() {
        let axis = axis();
        assert_eq!(axis.ranking(), [1, 2, 0]);
        assert_eq!(axis.recommended().name, "third");
        let model = axis.model();
        assert_eq!(model.white, Some(3.0));
        let note = |key: &str| model.identification[key].clone();
        let text = |key| note(key).as_str().unwrap().to_owned();
        assert_eq!(
            (text("model").as_str(), text("reason").as_str()),
            (
                "third",
                "third (1 state, 2 parameters) drifts least at 1, 10 s, and no simpler candidate is as likely."
            )
        );
        assert_eq!(text("runner_up"), "second");
        assert_eq!(note("horizons_s"), vec![1.0, 10.0].into());
        assert_eq!(note("drift_scores")["second"], vec![2.0, 20.0].into());
        let [line] = &model.lines[..] else { panic!() };
        assert_eq!(
            (line.frequency_hz, line.amplitude, line.width_hz),
            (3.0, 0.5, 0.1)
        );
        // The best of its own methods needs no other.
        let axis = Axis { chosen: 2, ..axis };
        let runner_up = axis.model().identification["runner_up"].clone();
        assert_eq!(runner_up.as_str(), Some("third"));
        let without = Candidate {
            score: Vec::new(),
            ..axis.candidates[0].clone()
        };
        assert_eq!(without.last_rms(), f64::INFINITY);
        assert!(without.arma().is_none() && without.composite().is_none());
    }
}
