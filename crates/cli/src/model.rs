//! `undrift model`: a noise model as other programs read it.

use crate::{
    output::{Files, JsonOutput},
    presets,
    terminal::{self, Invalid},
};
use anyhow::{Context, Result};
use clap::Args;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use undrift::{
    Drive,
    drive::{self, Logs, Section},
    noise::{ImuModel, ModelError, ModelFormat},
    results,
};

/// Write the noise model of an IMU for Kalibr, PX4, ROS, VINS, GTSAM, Gazebo and others.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift model adis16465 --to kalibr --rate 200 -o imu.yaml
  undrift model mpu6050 --to px4 --outage 10s
  undrift model tuned.toml --to kalibr
  undrift model icm20602 --json -
  undrift model --list")]
pub struct Arguments {
    /// A model file, a preset, or a drive file with a model as `undrift tune` writes it
    #[arg(value_name = "IMU.toml", required_unless_present = "list")]
    model: Option<String>,
    /// List the presets with their values; with --json, as model files
    #[arg(long, conflicts_with_all = ["model", "to", "rate", "outage"])]
    list: bool,
    /// Format: kalibr, kf-gins, ros, px4, matlab, vins, openvins, basalt, gtsam, ardupilot, gazebo, or undrift for the model file with every value in it
    #[arg(long, value_name = "NAME", required_unless_present_any = ["json", "list"])]
    to: Option<ModelFormat>,
    /// Sample rate [Hz]; for px4 and ardupilot, that of the filter's predictions. Default: that of the identified recording
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Length of an outage [s]: where the program's bias is a random walk, it is the best one for this
    #[arg(long, value_name = "S", default_value = "30")]
    outage: Seconds,
    /// Write into this file instead of standard output
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonOutput,
}

/// A length of time: "30", "30s" or "30 s".
#[derive(Clone, Copy)]
struct Seconds(f64);

impl std::str::FromStr for Seconds {
    type Err = std::num::ParseFloatError;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        let number = text.strip_suffix('s').unwrap_or(text);
        number.trim().parse().map(Self)
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let json = arguments.json.file().into_iter();
    let outputs = json.chain(arguments.output.as_deref());
    let Some(name) = &arguments.model else {
        return list(arguments, &Files::claim([], outputs)?);
    };
    let files = Files::claim([Path::new(name)], outputs)?;
    let (model, rate) = match of_drive(Path::new(name))? {
        Some(of_drive) => of_drive,
        None => (ImuModel::resolve(name, Path::new(""))?, None),
    };
    if arguments.json.is_wanted() {
        let json = results::text(&keys(&model)?);
        arguments.json.write(&files, &json)?;
    }
    let Some(format) = arguments.to else {
        return Ok(());
    };
    let exported = model.export_for(format, arguments.rate.or(rate), arguments.outage.0);
    let exported = exported.map_err(|error| match error {
        ModelError::BadRate(_) | ModelError::BadOutage(_) => Invalid(error.to_string()).into(),
        _ => anyhow::Error::from(error),
    });
    write(arguments, &files, &exported?)
}

/// The model that a drive file has, as `undrift tune` writes it, and the rate of its inertial log \[Hz\] where that can be read; `None` of what
/// is no drive file.
fn of_drive(file: &Path) -> Result<Option<(ImuModel, Option<f64>)>> {
    let Ok((text, name)) = drive::read_text(file) else {
        return Ok(None);
    };
    let Ok(table) = drive::parse(&text, &name) else {
        return Ok(None);
    };
    let top = Section::top(table.get_ref(), &text, &name);
    if top.get("imu").is_none() {
        return Ok(None);
    }
    let home = file.parent().unwrap_or(Path::new(""));
    let logs = Logs {
        folder: home.to_owned(),
        ..Logs::default()
    };
    let (model, interval) = match Drive::from_tables(&top, home, logs) {
        Ok(mut drive) => (drive.model.take(), drive.sample_interval().ok()),
        Err(_) => (drive::model(&top, "model", home)?, None),
    };
    let rate = interval.map(|interval| (1e3 / interval).round() / 1e3);
    let model = model.map(|model| (model, rate));
    model.map(Some).with_context(|| {
        let file = file.display();
        format!(
            "{file} is a drive file without a model: `undrift tune {file} -o tuned.toml` writes one"
        )
    })
}

/// The presets as a table, as JSON, or both.
fn list(arguments: &Arguments, files: &Files) -> Result<()> {
    let presets: Vec<_> = ImuModel::preset_names()
        .iter()
        .filter_map(|name| Some((*name, ImuModel::preset(name)?)))
        .collect();
    if arguments.json.is_wanted() {
        let all: BTreeMap<_, _> = presets
            .iter()
            .map(|(name, model)| Ok((*name, keys(model)?)))
            .collect::<Result<_>>()?;
        let json = results::text(&all);
        if arguments.json.write(files, &json)? && arguments.output.is_none() {
            return Ok(());
        }
    }
    write(arguments, files, &presets::table(&presets))
}

/// The model file's own keys and values, which have a schema of their own.
fn keys(model: &ImuModel) -> Result<toml::Table> {
    Ok(toml::from_str(&model.to_toml())?)
}

fn write(arguments: &Arguments, files: &Files, text: &str) -> Result<()> {
    match &arguments.output {
        Some(file) => files.write(file, text),
        None => terminal::result(text.trim_end()),
    }
}
