//! Reading of model files: a tree of entries that know their line, then the model.

use super::entries::{Entry, Place, find, line_at, line_of, plain_entries, spanned_entries};
use super::{
    AXES, Arma, AxisModel, FORMAT, ImuModel, Instability, ModelError, Provenance, VERSION,
};
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
const AXIS_KEYS: [&str; 8] = [
    "white_noise",
    "bias_instability",
    "correlation_time",
    "random_walk",
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
        let group = axis.split('_').next().unwrap_or(axis);
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
        if merged.is_empty() {
            return Err(place.error(
                None,
                axis,
                format!("no noise model; give [{group}] for all three axes, or [{axis}]"),
            ));
        }
        // Errors of a merged axis are told under the table that gives the axis something.
        let named = if find(entries, axis).is_some() {
            axis
        } else {
            group
        };
        *slot = axis_model(&merged, group == "gyro", &format!("{named}."), place)?;
    }
    let [gx, gy, gz, ax, ay, az] = axes;
    Ok(ImuModel {
        name: place.text(entries, "name", "")?.unwrap_or(base.name),
        source: place.text(entries, "source", "")?.unwrap_or(base.source),
        provenance: provenance(entries, place)?,
        gyro: [gx, gy, gz],
        accel: [ax, ay, az],
    })
}

fn provenance(entries: &[Entry], place: &Place<'_>) -> Result<Provenance, ModelError> {
    let Some(entry) = find(entries, "provenance") else {
        return Ok(Provenance::default());
    };
    let inside = place.table(entry, "provenance")?;
    let prefix = "provenance.";
    place.known(inside, &PROVENANCE_KEYS, prefix)?;
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
    let (level, noise, walk) = if gyro {
        (
            Quantity::AngularRate,
            Quantity::AngleRandomWalk,
            Quantity::RateRandomWalk,
        )
    } else {
        (
            Quantity::Acceleration,
            Quantity::VelocityRandomWalk,
            Quantity::AccelerationRandomWalk,
        )
    };
    let sigma = place.measure(entries, "bias_instability", prefix, level)?;
    let tau = place.positive(entries, "correlation_time", prefix, Quantity::Time)?;
    let instability = match (sigma, tau) {
        (Some(sigma), Some(tau)) => Some(Instability { sigma, tau }),
        (None, None) => None,
        (Some(_), None) => {
            return Err(place.error(
                line_of(entries, "bias_instability"),
                &format!("{prefix}bias_instability"),
                "is the standard deviation of a Gauss-Markov process and needs a correlation_time beside it, such as \"100 s\"; for a bias that wanders without limit give random_walk instead",
            ));
        }
        (None, Some(_)) => {
            return Err(place.error(
                line_of(entries, "correlation_time"),
                &format!("{prefix}correlation_time"),
                "belongs to bias_instability, which is missing",
            ));
        }
    };
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
        instability,
        random_walk: place.measure(entries, "random_walk", prefix, walk)?,
        arma,
        paper_sigma: place.measure(entries, "paper_sigma", prefix, level)?,
        identification,
    })
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
