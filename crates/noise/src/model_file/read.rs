//! Reading of model files.
//!
//! Text to [`DeTable`], whose keys know their place, to [`Section`], several layers of which lie one over the
//! other: the axis' own table, then that of its group, then both of the preset. A key is looked for from the
//! top, so that an axis may override one number of its group and a file one number of its preset. Numbers come
//! with their units and leave in SI; nothing is guessed from a bare number.
//!
//! Refused with file, line and key: a key that is not known (with the nearest that is), a value without unit,
//! of another quantity or out of its range, an ARMA that makes no filter, and what is recognisably another
//! file, a log or a drive file.
//!
//! Layers. For `gyro_x` of a file with `preset = "…"` four tables are laid over each other, the
//! first that has a key wins:
//!
//! 1. `[gyro_x]` of the file,
//! 2. `[gyro]` of the file,
//! 3. `[gyro_x]` of the preset,
//! 4. `[gyro]` of the preset.
//!
//! So a file may correct one number of one axis of a data sheet and keep the rest. A table inside
//! an axis (`arma`, `temperature`) and a list of tables (`line`) are not merged: they come whole
//! from the first layer that has one.
//!
//! Units. Every dimensional value is a string with its unit; the [`Quantity`] asked for decides
//! which units are accepted and gives the factor to SI: rad/s, m/s², s, Hz, and for densities
//! rad/√s, m/s/√s. Temperatures are read in °C or K and kept in °C.
//!
//! Called by [`ImuModel::from_toml`], [`ImuModel::load`], the presets, and the reader of drive
//! files, which hands its own `[model]` table to [`model`]. It checks form and range only: whether
//! a filter can be made of an axis is decided by [`ImuModel::shaping`].

use super::{
    AXES, Arma, AxisModel, FORMAT, ImuModel, Line, MAX_PROCESSES, ModelError, Provenance,
    Recording, VERSION, group, kalibr,
};
use crate::composite::GaussMarkov;
use crate::presets;
use crate::temperature::{Temperature, celsius};
use toml::Spanned;
use toml::de::DeTable;
use undrift_config::{ConfigError, Section, Table, Value, is_log};
use undrift_nav::shaping::ShapingFilter;
use undrift_nav::units::Quantity;

/// Keys of the top level. Any other key is an error with the nearest of these as a suggestion.
const TOP_KEYS: [&str; 14] = [
    "format",
    "version",
    "name",
    "source",
    "preset",
    "provenance",
    "gyro",
    "accel",
    "gyro_x",
    "gyro_y",
    "gyro_z",
    "accel_x",
    "accel_y",
    "accel_z",
];
/// Keys of a table of one axis (`[gyro_x]`) or of three (`[gyro]`).
const AXIS_KEYS: [&str; 11] = [
    "white_noise",
    "bias_instability",
    "correlation_time",
    "random_walk",
    "quantisation",
    "turn_on",
    "paper_sigma",
    "arma",
    "line",
    "temperature",
    "identification",
];
/// Keys of `[[gyro_x.line]]`, a spectral line or narrow resonance.
const LINE_KEYS: [&str; 3] = ["frequency", "amplitude", "width"];
/// Keys of `[gyro_x.temperature]`: a polynomial of second order about `reference`, valid from
/// `lowest` to `highest`.
const TEMPERATURE_KEYS: [&str; 8] = [
    "reference",
    "lowest",
    "highest",
    "slope",
    "slope_sigma",
    "quadratic",
    "quadratic_sigma",
    "axes",
];
/// Keys of `[gyro_x.arma]`. `rate` and `sigma` are required, `ar` and `ma` default to no
/// coefficients.
const ARMA_KEYS: [&str; 4] = ["rate", "ar", "ma", "sigma"];
/// Keys of `[provenance]`; all are optional.
const PROVENANCE_KEYS: [&str; 6] = [
    "record",
    "rate",
    "samples",
    "sha256",
    "program",
    "recording",
];
/// Keys of `[[provenance.recording]]`, one table for each of several records; `record` is required.
const RECORDING_KEYS: [&str; 3] = ["record", "samples", "sha256"];

/// The tables of a model file's text.
///
/// Errors are [`ModelError::Syntax`] with the line of the place that TOML's parser gives.
fn parse<'a>(text: &'a str, file: &str) -> Result<Spanned<DeTable<'a>>, ModelError> {
    let expected = format!("expected {A_MODEL}");
    undrift_config::parse(text, file, &expected).map_err(|error| ModelError::Syntax {
        file: error.file,
        line: error.line.unwrap_or(1),
        message: error.message,
    })
}

/// What is expected of a file that is no model.
const A_MODEL: &str = "a model file (`undrift identify` writes one) or a preset";

/// The error of a file that is something else.
fn not_a_model(what: &str, file: &str) -> ModelError {
    ModelError::Entry {
        file: file.to_owned(),
        line: None,
        key: String::new(),
        message: format!("is {what}, not a model; give {A_MODEL}"),
    }
}

/// Reads the text of a model file, which must state format and version.
/// A log or a drive file is recognised, since it is given by mistake most often; Kalibr's `imu.yaml` is read.
///
/// `file` is the name that messages put before the line; nothing is read from the disk here.
///
/// # Errors
/// [`ModelError`] with file and line: text that is not TOML, a log or a drive file, `format` or
/// `version` missing or of another program, and all that [`model`] refuses.
pub(super) fn from_text(text: &str, file: &str) -> Result<ImuModel, ModelError> {
    if let Some(model) = kalibr::as_model(text, file)? {
        return from_text(&model, file);
    }
    if is_log(text) {
        return Err(not_a_model("a log", file));
    }
    let table = parse(text, file)?;
    let top = Section::top(table.get_ref(), text, file);
    if top.get("imu").is_some() {
        return Err(not_a_model("a drive file", file));
    }
    for (key, example) in [
        ("format", format!("\"{FORMAT}\"")),
        ("version", VERSION.to_string()),
    ] {
        if top.get(key).is_none() {
            let message = format!("missing; a model file starts with {key} = {example}");
            return Err(top.error(key, message).into());
        }
    }
    model(&top)
}

/// Reads a model from its tables: a preset beneath, the axes over the groups.
///
/// At least one axis must have a noise model; the axes that have none are left at [`AxisModel::default`] and
/// are an error only where a filter is asked of them.
///
/// `top` may be the whole file or the `[model]` table of a drive file; `format` and `version` are
/// checked where they are given. Axes are returned in the order gyro x, y, z, accelerometer x, y,
/// z, in the sensor's own axes.
///
/// # Errors
/// An unknown key; another `format` or `version`; an unknown preset; a value without a unit, of
/// another quantity or out of range; no axis with a noise model.
pub(super) fn model(top: &Section) -> Result<ImuModel, ModelError> {
    top.only(&TOP_KEYS)?;
    if let Some(format) = top.text("format")?
        && format != FORMAT
    {
        let message = format!("{format:?} is not a noise model; expected \"{FORMAT}\"");
        return Err(top.error("format", message).into());
    }
    let said = match top.get("version") {
        None => VERSION.to_string(),
        Some(Value::Whole(number)) => number.into_owned(),
        Some(other) => other.kind().into(),
    };
    if said != VERSION.to_string() {
        let message = format!(
            "this program reads version {VERSION} of the format, the file has version {said}"
        );
        return Err(top.error("version", message).into());
    }
    let mut base = ImuModel::default();
    let parsed;
    let mut sources = vec![top.clone()];
    if let Some(name) = top.text("preset")? {
        let text = presets::text(name).ok_or_else(|| {
            let suggestion = presets::suggestion(name);
            top.error("preset", format!("no preset {name:?}; {suggestion}"))
        })?;
        base = from_text(text, name)?;
        parsed = parse(text, name)?;
        let table = Table::Parsed(parsed.get_ref(), None);
        sources.push(Section::values(table, top.file).under(&top.path));
    }
    let mut axes: [AxisModel; 6] = Default::default();
    for (axis, slot) in AXES.iter().zip(&mut axes) {
        let group = group(axis);
        // The axis' own table over that of all three, the file over its preset.
        let mut tables = Vec::new();
        for (source, key) in sources.iter().flat_map(|of| [(of, *axis), (of, group)]) {
            let table = source.section(key)?;
            if table.exists() {
                table.only(&AXIS_KEYS)?;
                tables.push(table);
            }
        }
        // Errors are named after the first table. Without any, ImuModel::shaping says so where the axis is needed.
        if let Some(table) = tables.into_iter().reduce(Section::over) {
            *slot = axis_model(&table, group == "gyro")?;
        }
    }
    if !axes.iter().any(AxisModel::is_known) {
        let message =
            "no axis has a noise model; give [gyro] and [accel], or [gyro_x] to [accel_z]";
        return Err(top.error("", message).into());
    }
    let [gx, gy, gz, ax, ay, az] = axes;
    let mut read_from = format!("{}: ", top.file);
    if !top.path.is_empty() {
        read_from += &format!("{}.", top.path);
    }
    Ok(ImuModel {
        name: top.text("name")?.map_or(base.name, str::to_owned),
        source: top.text("source")?.map_or(base.source, str::to_owned),
        provenance: provenance(top)?,
        gyro: [gx, gy, gz],
        accel: [ax, ay, az],
        read_from,
    })
}

/// Reads `[provenance]`.
///
/// Informative only: no value of it changes a filter. `rate` \[Hz\] and `samples` are those of the
/// record that the model was identified from, not of the drive it is used on.
fn provenance(top: &Section) -> Result<Provenance, ConfigError> {
    let table = top.section("provenance")?;
    table.only(&PROVENANCE_KEYS)?;
    Ok(Provenance {
        record: text(&table, "record")?,
        rate_hz: table.positive("rate", Quantity::Frequency)?,
        samples: table.whole("samples")?,
        sha256: text(&table, "sha256")?,
        program: text(&table, "program")?,
        recordings: recordings(&table)?,
    })
}

/// A string of a table, owned; `None` where the key is missing.
fn text(table: &Section, key: &str) -> Result<Option<String>, ConfigError> {
    Ok(table.text(key)?.map(str::to_owned))
}

/// Reads `[[provenance.recording]]`.
///
/// An empty list where the model comes from one record, or from a data sheet.
fn recordings(provenance: &Section) -> Result<Vec<Recording>, ConfigError> {
    let tables = provenance.sections("recording")?;
    let recording = |table: &Section| {
        table.only(&RECORDING_KEYS)?;
        let missing = || table.error("record", "missing; a recording needs its name");
        Ok(Recording {
            record: text(table, "record")?.ok_or_else(missing)?,
            samples: table.whole("samples")?,
            sha256: text(table, "sha256")?,
        })
    };
    tables.iter().map(recording).collect()
}

/// Reads one axis, its group's keys beneath its own.
///
/// `gyro` chooses the quantities: angle and angular rate, or velocity and acceleration.
///
/// | key | gyro | accelerometer | SI |
/// |---|---|---|---|
/// | `white_noise` | angle random walk N | velocity random walk N | rad/√s, m/s/√s |
/// | `random_walk` | rate random walk K | acceleration random walk K | rad/s/√s, m/s²/√s |
/// | `bias_instability`, `turn_on`, `paper_sigma` | angular rate | acceleration | rad/s, m/s² |
/// | `quantisation` | angle | velocity | rad, m/s |
///
/// # Errors
/// Neither `white_noise` nor an `arma` table: a filter without white noise would trust a single
/// sample.
fn axis_model(table: &Section, gyro: bool) -> Result<AxisModel, ConfigError> {
    let (rounding, level, noise, walk) = if gyro {
        (
            Quantity::Angle,
            Quantity::AngularRate,
            Quantity::AngleRandomWalk,
            Quantity::RateRandomWalk,
        )
    } else {
        (
            Quantity::Velocity,
            Quantity::Acceleration,
            Quantity::VelocityRandomWalk,
            Quantity::AccelerationRandomWalk,
        )
    };
    let instability = processes(table, level)?;
    let white = table.measure("white_noise", noise)?;
    let arma = table.section("arma")?;
    let arma = arma.exists().then(|| arma_of(&arma, level)).transpose()?;
    let lines = table.sections("line")?;
    let lines = lines.iter().map(|inside| line_of(inside, level));
    let lines = lines.collect::<Result<_, _>>()?;
    let temperature = table.section("temperature")?;
    let temperature = temperature
        .exists()
        .then(|| temperature_of(&temperature, gyro));
    if white.is_none() && arma.is_none() {
        let example = noise.examples();
        let message =
            format!("missing; an axis needs white_noise such as {example}, or an arma table");
        return Err(table.error("white_noise", message));
    }
    Ok(AxisModel {
        turn_on: table.measure("turn_on", level)?.unwrap_or(0.0),
        white,
        quantisation: table.measure("quantisation", rounding)?,
        instability,
        random_walk: table.measure("random_walk", walk)?,
        arma,
        lines,
        temperature: temperature.transpose()?,
        paper_sigma: table.measure("paper_sigma", level)?,
        identification: table.free("identification")?,
    })
}

/// The Gauss-Markov processes: as many standard deviations as correlation times.
///
/// One process may be written as two strings, several as two lists of equal length. A process is x′
/// = −x/τ + √(2σ²/τ) w with σ in the unit of the axis and τ > 0 \[s\]; the limit on their number is
/// that of the states of an axis ([`MAX_PROCESSES`]).
///
/// # Errors
/// A correlation time of zero, lists of different length, one key without the other, too many
/// processes.
fn processes(table: &Section, level: Quantity) -> Result<Vec<GaussMarkov>, ConfigError> {
    let (sigma_key, tau_key) = ("bias_instability", "correlation_time");
    let sigmas = table.measures(sigma_key, level)?;
    let taus = table.measures(tau_key, Quantity::Time)?;
    let fail = |key: &str, message: &str| Err(table.error(key, message));
    if taus.contains(&0.0) {
        return fail(tau_key, "must be greater than zero");
    }
    match (sigmas.len(), taus.len()) {
        (s, t) if s == t && s > MAX_PROCESSES => {
            let most = format!("at most {MAX_PROCESSES} fit the states of an axis");
            fail(sigma_key, &format!("has {s} processes, {most}"))
        }
        (s, t) if s == t => {
            let pairs = sigmas.into_iter().zip(taus);
            Ok(pairs
                .map(|(sigma, tau_s)| GaussMarkov { sigma, tau_s })
                .collect())
        }
        (_, 0) => fail(
            sigma_key,
            "is the standard deviation of a Gauss-Markov process and needs a correlation_time beside it, such as \"100 s\"; for a bias that wanders without limit give random_walk instead",
        ),
        (0, _) => fail(tau_key, "belongs to bias_instability, which is missing"),
        (s, t) => {
            let counts = format!("there are {s} of bias_instability and {t} of correlation_time");
            fail(
                tau_key,
                &format!("{counts}; give one correlation time for each process"),
            )
        }
    }
}

/// Reads one `[[…line]]`.
///
/// `frequency` > 0 \[Hz\] and `amplitude` > 0 are required; `width` \[Hz\] is 0 for a sine.
fn line_of(table: &Section, level: Quantity) -> Result<Line, ConfigError> {
    table.only(&LINE_KEYS)?;
    Ok(Line {
        frequency_hz: needed(table, "frequency", Quantity::Frequency, "a line")?,
        amplitude: needed(table, "amplitude", level, "a line")?,
        width_hz: table.measure("width", Quantity::Frequency)?.unwrap_or(0.0),
    })
}

/// Reads `[….temperature]`.
///
/// The range of the record is required beside the slope: beyond it the effect is an extrapolation.
///
/// The bias changes by `slope·(T − reference) + quadratic·(T − reference)²`, T in °C; the slope is
/// in rad/s/K or m/s²/K, the quadratic in rad/s/K² or m/s²/K². The two `_sigma` are standard
/// errors, 0 where unknown. `axes` says whether the axis is the sensor's or the body's.
///
/// # Errors
/// `reference`, `lowest`, `highest` or `slope` missing; `reference` outside of the range; an empty
/// range.
fn temperature_of(table: &Section, gyro: bool) -> Result<Temperature, ConfigError> {
    table.only(&TEMPERATURE_KEYS)?;
    let (slope, quadratic) = match gyro {
        true => (Quantity::RatePerKelvin, Quantity::RatePerKelvin2),
        false => (
            Quantity::AccelerationPerKelvin,
            Quantity::AccelerationPerKelvin2,
        ),
    };
    let missing = |key: &str, example: &str| {
        let message = format!("missing; a temperature table needs {key}, such as {example}");
        table.error(key, message)
    };
    let temperature = |key| {
        let text = table.text(key)?;
        let text = text.ok_or_else(|| missing(key, "\"25 degC\""))?;
        celsius(text).ok_or_else(|| {
            let message = format!("\"{text}\": must be such as \"25 degC\" or \"298 K\"");
            table.error(key, message)
        })
    };
    let (reference_c, range_c) = (
        temperature("reference")?,
        [temperature("lowest")?, temperature("highest")?],
    );
    let [lowest, highest] = range_c;
    if !(lowest < highest && (lowest..=highest).contains(&reference_c)) {
        let message = "must be above lowest, and reference between them";
        return Err(table.error("highest", message));
    }
    let body_axes = match table.text("axes")? {
        None | Some("sensor") => false,
        Some("body") => true,
        Some(_) => return Err(table.error("axes", "must be \"sensor\" or \"body\"")),
    };
    let found = table.quantity("slope", slope)?;
    Ok(Temperature {
        reference_c,
        range_c,
        slope: found.ok_or_else(|| missing("slope", slope.examples()))?,
        slope_sigma: table.measure("slope_sigma", slope)?.unwrap_or(0.0),
        quadratic: table.quantity("quadratic", quadratic)?.unwrap_or(0.0),
        quadratic_sigma: table.measure("quadratic_sigma", quadratic)?.unwrap_or(0.0),
        body_axes,
    })
}

/// A number above zero that `whose` table cannot do without.
fn needed(table: &Section, key: &str, quantity: Quantity, whose: &str) -> Result<f64, ConfigError> {
    table.positive(key, quantity)?.ok_or_else(|| {
        let (name, example) = (quantity.name(), quantity.examples());
        let message = format!("missing; {whose} needs {name} such as {example}");
        table.error(key, message)
    })
}

/// Reads `[….arma]`.
///
/// The filter is built once to check it: a φ that is not stationary (one root at 1 aside) or more
/// coefficients than an axis has states are errors here, with the line of the table, and not during
/// a run.
fn arma_of(table: &Section, level: Quantity) -> Result<Arma, ConfigError> {
    table.only(&ARMA_KEYS)?;
    let arma = Arma {
        rate_hz: needed(table, "rate", Quantity::Frequency, "an arma table")?,
        sigma: needed(table, "sigma", level, "an arma table")?,
        ar: table.numbers("ar")?,
        ma: table.numbers("ma")?,
    };
    ShapingFilter::arma(&arma.ar, &arma.ma, arma.sigma, 1.0 / arma.rate_hz)
        .map_err(|error| table.error("", error.to_string()))?;
    Ok(arma)
}
