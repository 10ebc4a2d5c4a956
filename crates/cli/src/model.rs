//! `undrift model`: a noise model as other programs read it.

use crate::{
    output::{Files, JsonOutput},
    terminal,
};
use anyhow::Result;
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::noise::{ImuModel, ModelFormat};

/// Write the noise model of an IMU as Kalibr, KF-GINS, ROS, PX4 or MATLAB read it.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift model adis16465 --to kalibr --rate 200 -o imu.yaml
  undrift model mpu6050 --to px4
  undrift model icm20602 --json -")]
pub struct Arguments {
    /// A model file or a preset (adis16405, adis16465, adis16488, icm20602, mpu6050)
    #[arg(value_name = "IMU.toml")]
    model: String,
    /// Format: kalibr, kf-gins, ros, px4, matlab, or undrift for the model file with every value in it
    #[arg(long, value_name = "NAME", required_unless_present = "json")]
    to: Option<ModelFormat>,
    /// Rate of the samples [Hz], of EKF2's predictions for px4; if not that of the identified record
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Write into this file instead of to standard output
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let outputs = arguments
        .json
        .file()
        .into_iter()
        .chain(arguments.output.as_deref());
    let files = Files::claim([Path::new(&arguments.model)], outputs)?;
    let model = ImuModel::resolve(&arguments.model, Path::new(""))?;
    if arguments.json.is_wanted() {
        // The model file's own keys and values.
        let keys: toml::Table = toml::from_str(&model.to_toml())?;
        let json = serde_json::to_string_pretty(&keys)?;
        arguments.json.write(&files, &json)?;
    }
    let Some(format) = arguments.to else {
        return Ok(());
    };
    let text = model.export(format, arguments.rate)?;
    match &arguments.output {
        Some(file) => files.write(file, &text),
        None => terminal::result(text.trim_end()),
    }
}
