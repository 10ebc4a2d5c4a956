//! Reading of model files: a tree of entries that know their line, then the model.

use super::entries::{Entry, Place, find, line_at, line_of, plain_entries, spanned_entries};
use super::{
    AXES, Arma, AxisModel, FORMAT, ImuModel, MAX_PROCESSES, ModelError, Provenance, VERSION, group,
};
use crate::composite::GaussMarkov;
use crate::presets;
use toml::de::DeTable;
use undrift_nav::shaping::ShapingFilter;
use undrift_nav::units::Quantity;

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
const AXIS_KEYS: [&str; 9] = [
    "white_noise",
    "bias_instability",
    "correlation_time",
    "random_walk",
    "quantisation",
    "turn_on",
    "paper_sigma",
    "arma",
    "identification",
];
const ARMA_KEYS: [&str; 4] = ["rate", "ar", "ma", "sigma"];
const PROVENANCE_KEYS: [&str; 5] = ["record", "rate", "samples", "sha256", "program"];

pub(super) fn from_text(text: &str, file: &str) -> Result<ImuModel, ModelError> {
    let table = DeTable::parse(text).map_err(|error| ModelError::Syntax {
        file: file.to_owned(),
        line: error.span().map_or(1, |span| line_at(text, span.start)),
        message: error.message().to_owned(),
    })?;
    let entries = spanned_entries(table.get_ref(), text);
    let place = Place { file, path: "" };
    for (key, example) in [
        ("format", format!("\"{FORMAT}\"")),
        ("version", VERSION.to_string()),
    ] {
        if find(&entries, key).is_none() {
            let message = format!("missing; a model file starts with {key} = {example}");
            return Err(place.error(None, key, message));
        }
    }
    model(&entries, &place)
}

pub(super) fn from_spanned(
    table: &DeTable<'_>,
    text: &str,
    file: &str,
    path: &str,
) -> Result<ImuModel, ModelError> {
    model(&spanned_entries(table, text), &Place { file, path })
}

pub(super) fn from_plain(
    table: &toml::Table,
    file: &str,
    path: &str,
) -> Result<ImuModel, ModelError> {
    model(&plain_entries(table), &Place { file, path })
}

fn model(entries: &[Entry], place: &Place<'_>) -> Result<ImuModel, ModelError> {
    place.known(entries, &TOP_KEYS, "")?;
    if let Some(format) = place.text(entries, "format", "")?
        && format != FORMAT
    {
        return Err(place.error(
            line_of(entries, "format"),
            "format",
            format!("{format:?} is no noise model; expected \"{FORMAT}\""),
        ));
    }
    if let Some(entry) = find(entries, "version")
        && entry.value.as_integer() != Some(VERSION)
    {
        let message = format!(
            "this program reads version {VERSION} of the format, the file says {}",
            entry.value
        );
        return Err(place.error(entry.line, "version", message));
    }
    let mut layers = Vec::new();
    let mut base = ImuModel::default();
    if let Some(name) = place.text(entries, "preset", "")? {
        let unknown = || {
            let message = format!(
                "no preset {name:?}; there are {}",
                presets::NAMES.join(", ")
            );
            place.error(line_of(entries, "preset"), "preset", message)
        };
        let text = presets::text(&name).ok_or_else(unknown)?;
        base = from_text(text, &name)?;
        let table = DeTable::parse(text).map_err(|_| unknown())?;
        layers = spanned_entries(table.get_ref(), text);
    }
    let mut axes: [AxisModel; 6] = Default::default();
    for (axis, slot) in AXES.iter().zip(&mut axes) {
        let group = group(axis);
        let mut merged: Vec<Entry> = Vec::new();
        for (source, own) in [(&layers[..], false), (entries, true)] {
            for key in [group, axis] {
                let Some(entry) = find(source, key) else {
                    continue;
                };
                let inside = place.table(entry, key)?;
                if own {
                    place.known(inside, &AXIS_KEYS, &format!("{key}."))?;
                }
                for item in inside {
                    merged.retain(|e| e.key != item.key);
                    merged.push(item.clone());
                }
            }
        }
        // Left out: ImuModel::shaping says so where the axis is needed.
        if merged.is_empty() {
            continue;
        }
        // Errors of a merged axis are told under the table that gives the axis something.
        let named = if find(entries, axis).is_some() {
            axis
        } else {
            group
        };
        *slot = axis_model(&merged, group == "gyro", &format!("{named}."), place)?;
    }
    if !axes.iter().any(AxisModel::is_known) {
        let message =
            "no axis has a noise model; give [gyro] and [accel], or [gyro_x] to [accel_z]";
        return Err(place.error(None, "", message));
    }
    let [gx, gy, gz, ax, ay, az] = axes;
    let mut prefix = format!("{}: ", place.file);
    if !place.path.is_empty() {
        prefix += &format!("{}.", place.path);
    }
    Ok(ImuModel {
        name: place.text(entries, "name", "")?.unwrap_or(base.name),
        source: place.text(entries, "source", "")?.unwrap_or(base.source),
        provenance: provenance(entries, place)?,
        gyro: [gx, gy, gz],
        accel: [ax, ay, az],
        prefix,
    })
}

fn provenance(entries: &[Entry], place: &Place<'_>) -> Result<Provenance, ModelError> {
    let Some(entry) = find(entries, "provenance") else {
        return Ok(Provenance::default());
    };
    let inside = place.table(entry, "provenance")?;
    let prefix = "provenance.";
    place.known(inside, &PROVENANCE_KEYS, prefix)?;
    #[cfg(test)]
    super::entries::note(prefix, "samples", super::entries::page::Takes::Whole);
    let samples = match find(inside, "samples") {
        None => None,
        Some(entry) => match entry.value.as_integer().and_then(|i| u64::try_from(i).ok()) {
            Some(count) => Some(count),
            None => {
                return Err(place.error(
                    entry.line,
                    "provenance.samples",
                    "must be a whole number",
                ));
            }
        },
    };
    Ok(Provenance {
        record: place.text(inside, "record", prefix)?,
        rate_hz: place.positive(inside, "rate", prefix, Quantity::Frequency)?,
        samples,
        sha256: place.text(inside, "sha256", prefix)?,
        program: place.text(inside, "program", prefix)?,
    })
}

fn axis_model(
    entries: &[Entry],
    gyro: bool,
    prefix: &str,
    place: &Place<'_>,
) -> Result<AxisModel, ModelError> {
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
    let instability = processes(entries, level, prefix, place)?;
    let white = place.measure(entries, "white_noise", prefix, noise)?;
    let arma = match find(entries, "arma") {
        Some(entry) => Some(arma(entry, level, &format!("{prefix}arma"), place)?),
        None => None,
    };
    if white.is_none() && arma.is_none() {
        let first = entries.iter().filter_map(|e| e.line).min();
        let message = format!(
            "missing; an axis needs white_noise such as {}, or an arma table",
            noise.examples()
        );
        return Err(place.error(first, &format!("{prefix}white_noise"), message));
    }
    let identification = match find(entries, "identification") {
        Some(entry) => {
            place.table(entry, &format!("{prefix}identification"))?;
            entry.value.as_table().cloned().unwrap_or_default()
        }
        None => toml::Table::new(),
    };
    Ok(AxisModel {
        turn_on: place
            .measure(entries, "turn_on", prefix, level)?
            .unwrap_or(0.0),
        white,
        quantisation: place.measure(entries, "quantisation", prefix, rounding)?,
        instability,
        random_walk: place.measure(entries, "random_walk", prefix, walk)?,
        arma,
        paper_sigma: place.measure(entries, "paper_sigma", prefix, level)?,
        identification,
    })
}

/// The Gauss-Markov processes: as many standard deviations as correlation times.
fn processes(
    entries: &[Entry],
    level: Quantity,
    prefix: &str,
    place: &Place<'_>,
) -> Result<Vec<GaussMarkov>, ModelError> {
    let sigmas = place.measures(entries, "bias_instability", prefix, level)?;
    let taus = place.measures(entries, "correlation_time", prefix, Quantity::Time)?;
    let fail = |key: &str, message: String| {
        Err(place.error(line_of(entries, key), &format!("{prefix}{key}"), message))
    };
    if taus.contains(&0.0) {
        return fail("correlation_time", "must be greater than zero".into());
    }
    match (sigmas.len(), taus.len()) {
        (s, t) if s == t && s > MAX_PROCESSES => fail(
            "bias_instability",
            format!("has {s} processes, at most {MAX_PROCESSES} fit the states of an axis"),
        ),
        (s, t) if s == t => Ok(sigmas
            .into_iter()
            .zip(taus)
            .map(|(sigma, tau_s)| GaussMarkov { sigma, tau_s })
            .collect()),
        (_, 0) => fail(
            "bias_instability",
            "is the standard deviation of a Gauss-Markov process and needs a correlation_time beside it, such as \"100 s\"; for a bias that wanders without limit give random_walk instead".into(),
        ),
        (0, _) => fail(
            "correlation_time",
            "belongs to bias_instability, which is missing".into(),
        ),
        (s, t) => fail(
            "correlation_time",
            format!("there are {s} of bias_instability and {t} of correlation_time; give one correlation time for each process"),
        ),
    }
}

fn arma(entry: &Entry, level: Quantity, path: &str, place: &Place<'_>) -> Result<Arma, ModelError> {
    let inside = place.table(entry, path)?;
    let prefix = format!("{path}.");
    place.known(inside, &ARMA_KEYS, &prefix)?;
    let missing = |key: &str, quantity: Quantity| {
        let message = format!(
            "missing; an arma table needs {} such as {}",
            quantity.name(),
            quantity.examples()
        );
        place.error(entry.line, &format!("{prefix}{key}"), message)
    };
    let rate = place.positive(inside, "rate", &prefix, Quantity::Frequency)?;
    let sigma = place.positive(inside, "sigma", &prefix, level)?;
    let arma = Arma {
        ar: place.numbers(inside, "ar", &prefix)?,
        ma: place.numbers(inside, "ma", &prefix)?,
        sigma: sigma.ok_or_else(|| missing("sigma", level))?,
        rate_hz: rate.ok_or_else(|| missing("rate", Quantity::Frequency))?,
    };
    ShapingFilter::arma(&arma.ar, &arma.ma, arma.sigma, 1.0 / arma.rate_hz)
        .map_err(|error| place.error(entry.line, path, error.to_string()))?;
    Ok(arma)
}
