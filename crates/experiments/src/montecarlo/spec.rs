//! `SPEC.toml` of a Monte Carlo. All keys are in `docs/lab/montecarlo-command.md`.

use std::path::Path;
use undrift_drive::{
    drive::{self, ConfigError, DriveError, Section, parse, read_initial, read_text},
    replay::Settings,
};
use undrift_engine::{
    align::AlignSettings,
    settings::fix_errors::{Correlated, FixErrors},
};
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters, Prior},
    shaping::ShapingFilter,
    units::Quantity,
};
use undrift_noise::{BiasModel, ImuModel, ModelError, presets::LISTED};
use undrift_simulate::{GnssNoise, REST_BEFORE, Trajectory};

/// Most samples of a drive: all runs share its noise-free samples, 64 bytes each.
const MAX_SAMPLES: f64 = 20e6;

/// Most runs times epochs.
pub const MAX_RUN_EPOCHS: usize = 50_000_000;

/// What is simulated, and what the filter knows of it.
#[derive(Clone, Debug)]
pub struct Spec {
    /// The motion, the same in every run.
    pub trajectory: Trajectory,
    /// Rate of the inertial samples \[Hz\].
    pub rate_hz: f64,
    /// The sensors' true model.
    pub model: ImuModel,
    /// The form in which their errors are drawn.
    pub bias_model: BiasModel,
    /// The model that the filter uses.
    pub filter_model: ImuModel,
    /// The forms in which the filter runs it, one after the other.
    pub bias_models: Vec<BiasModel>,
    /// The receiver.
    pub gnss: GnssNoise,
    /// The part of the position's error that is correlated in time; the filter knows it.
    pub correlated: Option<Correlated>,
    /// Standard deviation of the gyros' scale factors, 0 for none; drawn in every run, and estimated.
    pub scale_factor: f64,
    /// Standard deviation of the time offsets of position and velocity \[s\], 0 for none; drawn and estimated.
    pub time_offset: f64,
    /// How the filter starts.
    pub align: AlignSettings,
    /// Instead: at the first fix, at the true attitude turned by a draw of these standard
    /// deviations about north, east, down \[rad\], which the filter gets as its initial uncertainty.
    pub truth_std: Option<Vector3>,
    /// Spacing of the epochs at which the errors are looked at \[s\].
    pub every: f64,
    /// Beginning of the navigation left out of averages and shares \[s\].
    pub settle: f64,
}

impl Spec {
    /// Reads a `SPEC.toml`; model files in it are relative to its own folder.
    ///
    /// # Errors
    /// If the file cannot be read, or as [`Spec::from_toml`].
    pub fn load(path: &Path) -> Result<Self, DriveError> {
        let (text, file) = read_text(path)?;
        Self::from_toml(&text, &file, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads the text of a `SPEC.toml`; `file` is what messages call it, `home` where model files lie.
    ///
    /// # Errors
    /// [`DriveError::Config`] where the text is no TOML, or a key is missing, unknown or has a wrong value, with
    /// its line; [`DriveError::Model`] for a model file.
    pub fn from_toml(text: &str, file: &str, home: &Path) -> Result<Self, DriveError> {
        let table = parse(text, file)?;
        let top = Section::top(table.get_ref(), text, file);
        if table.get_ref().contains_key("imu") {
            let message = "is a drive file; montecarlo needs a specification of a simulated drive (docs/lab/montecarlo-command.md)";
            return Err(ConfigError {
                file: file.to_owned(),
                line: None,
                key: String::new(),
                message: message.to_owned(),
            }
            .into());
        }
        top.only(&[
            "model",
            "bias_model",
            "filter",
            "drive",
            "gnss",
            "initial",
            "epochs",
            "states",
        ])?;
        let names = BiasModel::ALL.map(|kind| (kind.name(), kind));
        let model = drive::model(&top, "model", home)?.ok_or_else(|| {
            let what = "the sensors' noise model, a preset, a file, or a table";
            top.missing("model", format_args!("{what}; {LISTED}"))
        })?;
        let bias_model = top.word("bias_model", &names)?.unwrap_or(BiasModel::Arma);

        let filter = top.section("filter")?;
        let filter_model = drive::model(&filter, "model", home)?.unwrap_or_else(|| model.clone());
        let bias_models = filter
            .words("bias_models", &names)?
            .unwrap_or_else(|| vec![bias_model]);
        filter.only_known()?;

        let drive = top.section("drive")?;
        let (trajectory, rate_hz) = read_drive(&drive)?;
        let duration = trajectory.duration;
        let (gnss, correlated) = read_gnss(&top.section("gnss")?, duration)?;

        let [scale_factor, time_offset] = read_states(&top.section("states")?)?;
        let (align, truth_std) = read_start(&top.section("initial")?)?;
        let (every, settle) = read_epochs(&top.section("epochs")?, rate_hz, duration)?;
        Ok(Self {
            trajectory,
            rate_hz,
            model,
            bias_model,
            filter_model,
            bias_models,
            gnss,
            correlated,
            scale_factor,
            time_offset,
            align,
            truth_std,
            every,
            settle,
        })
    }

    /// The shaping filters that the sensors' errors are drawn from.
    pub(super) fn sensors(&self) -> Result<[ShapingFilter; 6], ModelError> {
        self.model.shaping(self.bias_model, 1.0 / self.rate_hz)
    }

    /// The filter's settings under each bias model, by name.
    pub(super) fn settings(&self) -> Result<Vec<(String, Settings)>, ModelError> {
        let mut parameters = Parameters::none();
        for (kind, std) in [
            (Parameter::GyroScale, self.scale_factor),
            (Parameter::TimeOffset, self.time_offset),
            (Parameter::VelocityTimeOffset, self.time_offset),
        ] {
            if std > 0.0 {
                parameters = parameters.with(kind, Prior::constant(std));
            }
        }
        let fix_errors = FixErrors {
            correlated: self.correlated,
            ..FixErrors::default()
        };
        let parameters = fix_errors.with_states(parameters);
        let settings = |kind: &BiasModel| {
            let settings = Settings {
                parameters,
                fix_errors,
                lever_arm: self.gnss.lever_arm,
                align: self.align.clone(),
                ..Settings::new(self.filter_model.shaping(*kind, 1.0 / self.rate_hz)?)
            };
            Ok((kind.name().to_owned(), settings))
        };
        self.bias_models.iter().map(settings).collect()
    }
}

fn read_drive(section: &Section) -> Result<(Trajectory, f64), ConfigError> {
    type Scenario = fn(f64, u64) -> Trajectory;
    let kinds: [(&str, Scenario); 2] = [("car", Trajectory::car), ("flight", Trajectory::flight)];
    let scenario = section
        .word("kind", &kinds)?
        .ok_or_else(|| section.missing("kind", "\"car\" or \"flight\""))?;
    let duration = section
        .quantity("duration", Quantity::Time)?
        .unwrap_or(600.0);
    let least = 2.0 * REST_BEFORE;
    if !(least..=undrift_simulate::MAX_DURATION).contains(&duration) {
        return Err(section.error(
            "duration",
            format!("must be {least} s, of which {REST_BEFORE} s are at rest, to ten days"),
        ));
    }
    let rate_hz = section
        .quantity("rate", Quantity::Frequency)?
        .unwrap_or(100.0);
    if !(rate_hz > 0.0 && rate_hz * duration <= MAX_SAMPLES) {
        return Err(section.error(
            "rate",
            format!("must be above 0 Hz and make at most {MAX_SAMPLES} samples of the drive"),
        ));
    }
    let seed = section.whole("seed")?.unwrap_or(1);
    section.only_known()?;
    Ok((scenario(duration, seed), rate_hz))
}

fn read_gnss(
    section: &Section,
    duration: f64,
) -> Result<(GnssNoise, Option<Correlated>), ConfigError> {
    let mut gnss = GnssNoise::default();
    let std = |key, quantity, default: [f64; 3]| match section.vector(key, quantity)? {
        Some(v) if v.iter().any(|s| *s <= 0.0) => {
            Err(section.error(key, "standard deviations must be positive"))
        }
        Some(v) => Ok([v.x, v.y, v.z]),
        None => Ok(default),
    };
    gnss.position_std = std("position_std", Quantity::Length, gnss.position_std)?;
    gnss.velocity_std = std("velocity_std", Quantity::Velocity, gnss.velocity_std)?;
    if let Some(rate) = section.quantity("rate", Quantity::Frequency)? {
        gnss.rate_hz = rate;
    }
    if let Some(start) = section.quantity("start", Quantity::Time)? {
        gnss.start = start;
    }
    if let Some(arm) = section.vector("lever_arm", Quantity::Length)? {
        gnss.lever_arm = arm;
    }
    if let Some(scale) = section.factor("noise_scale")? {
        gnss.noise_scale = scale;
    }
    if !(gnss.rate_hz > 0.0 && gnss.rate_hz * duration <= MAX_SAMPLES) {
        return Err(section.error(
            "rate",
            format!("must be above 0 Hz and make at most {MAX_SAMPLES} fixes of the drive"),
        ));
    }
    if !(gnss.start >= 0.0 && gnss.start < duration) {
        return Err(section.error("start", "must lie within the drive"));
    }
    let time = section.quantity("correlation_time", Quantity::Time)?;
    let share = section.factor("correlated_share")?.unwrap_or(0.95);
    if time.is_some_and(|time| time <= 0.0) || !(0.0..=1.0).contains(&share) {
        return Err(section.error(
            "correlation_time",
            "must be above 0 s, with a correlated_share of 0 to 1",
        ));
    }
    section.only_known()?;
    Ok((gnss, time.map(|time| Correlated { share, time })))
}

/// Standard deviations of the gyros' scale factors and of the time offsets \[s\].
fn read_states(section: &Section) -> Result<[f64; 2], ConfigError> {
    let std = |key, quantity| match section.quantity(key, quantity)? {
        Some(std) if std < 0.0 => {
            Err(section.error(key, "standard deviations must not be negative"))
        }
        std => Ok(std.unwrap_or(0.0)),
    };
    let scale_factor = std("scale_factor", Quantity::Dimensionless)?;
    let time_offset = std("time_offset", Quantity::Time)?;
    section.only_known()?;
    Ok([scale_factor, time_offset])
}

/// How the filter starts, and [`Spec::truth_std`].
fn read_start(section: &Section) -> Result<(AlignSettings, Option<Vector3>), ConfigError> {
    let truth_std = section.vector("truth_std", Quantity::Angle)?;
    if truth_std.is_some_and(|std| std.iter().any(|s| *s <= 0.0)) {
        return Err(section.error("truth_std", "standard deviations must be positive"));
    }
    if truth_std.is_some() && section.get("attitude").is_some() {
        return Err(section.error("attitude", "set truth_std or attitude, not both"));
    }
    Ok((read_initial(section)?, truth_std))
}

/// Spacing of the epochs, and the time at the start that is not evaluated \[s\].
fn read_epochs(section: &Section, rate_hz: f64, duration: f64) -> Result<(f64, f64), ConfigError> {
    let every = section.quantity("every", Quantity::Time)?.unwrap_or(1.0);
    let samples = every * rate_hz;
    if !(samples > 0.5 && (samples - samples.round()).abs() < 1e-6 * samples) {
        let apart = 1.0 / rate_hz;
        return Err(section.error(
            "every",
            format!("must be a whole number of samples, which are {apart} s apart"),
        ));
    }
    let settle = section.quantity("settle", Quantity::Time)?.unwrap_or(60.0);
    if !(settle >= 0.0 && settle + every <= duration) {
        return Err(section.error(
            "settle",
            format!("must be shorter than the drive of {duration} s"),
        ));
    }
    section.only_known()?;
    Ok((every, settle))
}

#[cfg(test)]
mod tests;
