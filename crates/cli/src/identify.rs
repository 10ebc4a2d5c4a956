//! `undrift identify`: a static record into a noise model.

use crate::{
    details,
    output::{self, Files},
    plot,
    progress::Bar,
    report::ResultOutput,
    style,
    terminal::{self, Invalid, detail, note, say, stage, warn},
};
use anyhow::{Context, Result, bail};
use clap::{
    Args,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};
use std::path::{Path, PathBuf};
use undrift::{
    identify::{self, Identified, Prepared, RecordingError, Settings, Trend},
    inspect,
    io::{Opened, table::Column},
    nav::units::{Quantity, unit_factor},
    noise::ImuModel,
    record::{self, Record, RecordFormat},
    results,
};
use undrift_report::{say as sentences, sentence, text, usable};

/// The trends by their names.
fn trends() -> impl TypedValueParser<Value = Trend> {
    let helps = [
        "The mean",
        "A straight line",
        "The mean and what follows the temperature, a column named temp, temperature or *_C",
    ];
    let names = Trend::ALL.iter().zip(helps);
    PossibleValuesParser::new(
        names.map(|(trend, help)| PossibleValue::new(trend.name()).help(help)),
    )
    .map(|name| Trend::named(&name).unwrap_or_default())
}

/// Identify the errors of a sensor from a static recording, and write the model file.
///
/// A record that moves, or whose numbers are not in the units stated, is refused. The noise of every axis is tested, its Allan deviation taken, and models of it are fitted on each
/// half of the record; the one that is recommended leaves the least drift on the other half
/// (docs/identify.md).
#[derive(Args)]
#[command(after_help = "Examples:
  undrift identify static.csv.gz --rate 100 --units \"deg/s,g\" -o imu.toml
  undrift identify drive.toml --span 0,38 -o imu.toml
  undrift identify out/figure1-record.csv --units \"rad/s,m/s^2\" --plot
  undrift identify monday.csv tuesday.csv wednesday.csv thursday.csv -o imu.toml
  undrift identify gyro.csv --columns 2 --axis gyro_z --rate 200 --base adis16465 -o imu.toml

The third takes the recording that \"undrift demo --out out\" writes.")]
pub struct Arguments {
    /// Static recording: a table of one axis or six, a log in any format that `inspect` knows, or a drive file, of
    /// which the log of [imu] is used. Several recordings of one sensor or type, a switch-on each, make one model
    #[arg(value_name = "RECORD", required = true)]
    records: Vec<PathBuf>,
    /// Sample rate [Hz]. Default: from the time column
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Columns by name or number: gyro x,y,z, accelerometer x,y,z, or a single one. Default: from the
    /// header, else guessed
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    columns: Vec<String>,
    /// Column of times by name or number, and its unit where that is not shown, for instance "ticks,LSB/32768 s". Default: from the
    /// header, else guessed
    #[arg(long, value_name = "NAME[,UNIT]")]
    time: Option<String>,
    /// Axis of a single column, gyro_x to accel_z
    #[arg(long, value_name = "AXIS")]
    axis: Option<String>,
    /// Units of gyro and accelerometer columns, for instance "deg/s,g" or "LSB/131 deg/s,LSB/16384 g" for raw counts.
    /// Default: from the header, else guessed
    #[arg(long, value_name = "GYRO,ACCEL")]
    units: Option<String>,
    /// Stream of a log that has several of inertial samples
    #[arg(long, value_name = "NAME")]
    topic: Option<String>,
    /// The part of the recording to use, in seconds after its first sample
    #[arg(long, value_name = "START,END", value_parser = span)]
    span: Option<(f64, f64)>,
    /// Identify a recording although it moves or has implausible units; the model file records this
    #[arg(long)]
    force: bool,
    /// What is removed from each axis before its noise is identified. Default: temperature where the recording has one, else
    /// constant
    #[arg(long, value_name = "TREND", value_parser = trends())]
    detrend: Option<Trend>,
    /// The sensor's data sheet, a preset or a file: the σ of its bias at turn-on, and the axes that the
    /// recording does not have
    #[arg(long, value_name = "PRESET|FILE")]
    base: Option<String>,
    /// The Allan deviations alone, in a second: no tests, no models
    #[arg(long, conflicts_with_all = ["output", "base"])]
    allan: bool,
    /// Write the model file; without --base it has the recording's axes only
    #[arg(short, long, value_name = "imu.toml", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Plot the Allan deviations in the terminal
    #[arg(long, help_heading = "Output")]
    plot: bool,
    #[command(flatten)]
    result: ResultOutput,
}

/// A span by its ends \[s\].
fn span(text: &str) -> Result<(f64, f64), String> {
    let ends = text
        .split_once(',')
        .and_then(|(start, end)| Some((start.trim().parse().ok()?, end.trim().parse().ok()?)));
    let wanted = |(start, end): &(f64, f64)| *start >= 0.0 && end > start && end.is_finite();
    ends.filter(wanted)
        .ok_or_else(|| "write two times in seconds after the first sample, such as 120,480".into())
}

/// What the record's columns are.
fn format(arguments: &Arguments) -> Result<RecordFormat> {
    let known = |unit: &str, quantity| {
        let factor = unit_factor(unit, quantity);
        factor.map_err(|error| Invalid(format!("--units \"{unit}\": {error}")))
    };
    let units = |text: &String| {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        match parts[..] {
            [one] if arguments.axis.is_some() => Ok((one.to_owned(), one.to_owned())),
            [gyro, accel] => {
                known(gyro, Quantity::AngularRate)?;
                known(accel, Quantity::Acceleration)?;
                Ok((gyro.to_owned(), accel.to_owned()))
            }
            _ => bail!(Invalid(
                "--units takes the gyros' and the accelerometers' unit, for instance \"deg/s,g\""
                    .into()
            )),
        }
    };
    let column = |text: &String| {
        let number = text.parse().map(Column::Number);
        number.unwrap_or_else(|_| Column::Name(text.clone()))
    };
    let time = |text: &String| {
        let (name, unit) = match text.split_once(',') {
            Some((name, unit)) => (name.trim().to_owned(), Some(unit.trim().to_owned())),
            None => (text.clone(), None),
        };
        let factor = unit.as_ref().map(|unit| unit_factor(unit, Quantity::Time));
        if let Some(Err(error)) = factor {
            bail!(Invalid(format!("--time \"{text}\": {error}")));
        }
        Ok((column(&name), unit))
    };
    Ok(RecordFormat {
        time: arguments.time.as_ref().map(time).transpose()?,
        columns: arguments.columns.iter().map(column).collect(),
        axis: arguments.axis.clone(),
        units: arguments.units.as_ref().map(units).transpose()?,
        temperature: arguments.detrend == Some(Trend::Temperature),
        topic: arguments.topic.clone(),
    })
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let outputs = arguments.result.files().chain(arguments.output.as_deref());
    let mut files = Files::claim(arguments.records.iter().map(PathBuf::as_path), outputs)?;
    let format = format(arguments)?;
    let settings = Settings {
        rate_hz: arguments.rate,
        span: arguments.span,
        trend: arguments.detrend.unwrap_or_default(),
        ..Settings::default()
    };
    let base = arguments.base.as_ref();
    let base = base
        .map(|name| ImuModel::resolve(name, Path::new("")))
        .transpose()?;
    // Gyroscopes and accelerometers in files of their own are one recording.
    let records = match arguments.records.as_slice() {
        [one, other] if one != other => match inspect::of_two(one, other) {
            Some(joined) => vec![joined],
            None => arguments.records.clone(),
        },
        all => all.to_vec(),
    };
    let mut recordings = Vec::with_capacity(records.len());
    for (at, path) in records.iter().enumerate() {
        if records[..at].contains(path) {
            bail!(Invalid(format!(
                "{} is given twice: each recording counts as a switch-on of its own",
                path.display()
            )));
        }
        let record = stage("reading", || read(path, &format))?;
        files = files.and_read(record.file.as_deref());
        recordings.push(prepare(record, &settings, arguments.force)?);
    }
    name_apart(&mut recordings);
    if let ([one], true) = (&recordings[..], arguments.allan) {
        let result = identify::allan_deviations(one, &settings);
        return show(arguments, &files, &result);
    }
    let names: Vec<&str> = recordings.iter().map(|one| one.name.as_str()).collect();
    let name = results::names(&names);
    let identified = identify(&recordings, &settings)?;
    let result = identified.result(&name, &sentence);
    show(arguments, &files, &result)?;
    let differ = result.pool.as_ref().is_some_and(|pool| !pool.homogeneous);
    if differ {
        warn("the recordings are not of one sensor: identify those that differ on their own");
    }
    let Some(file) = &arguments.output else {
        return Ok(());
    };
    if differ && terminal::is_strict() {
        warn(format!("{} is not written (--strict)", file.display()));
        return Ok(());
    }
    let provenance = identify::provenance(&recordings, &name, identified.rate_hz)?;
    let mut model = identified.model(base.as_ref(), &name, provenance)?;
    for one in &recordings {
        if let Some(problem) = &one.not_static {
            let of = match recordings.len() {
                1 => String::new(),
                _ => format!("{}: ", one.name),
            };
            model.source += &format!("; identified with --force although {of}{problem}");
        }
    }
    files.write(file, &model.to_toml())?;
    terminal::say(format!("model: {}", output::shown(file)))?;
    warn_of_unknown(file, &model, &identified.without_turn_on(base.as_ref()));
    Ok(())
}

/// Writes and prints what was found, and warns of axes that could not be identified.
fn show(arguments: &Arguments, files: &Files, result: &results::Identify) -> Result<()> {
    if !usable::identify(result) {
        terminal::doubt();
    }
    let shown =
        arguments.result.is_wanted() && arguments.result.write(files, &results::text(result))?;
    if !shown {
        let details = terminal::is_verbose();
        say(text::identify(result, details, style::heading).trim_end())?;
        if arguments.plot {
            say(plot::allan(result))?;
        }
    }
    let errors = Vec::from_iter(result.in_order().map(|(_, axis)| axis.error.as_ref()));
    if let Some(Some(error)) = errors.first()
        && errors.iter().all(|other| *other == Some(error))
    {
        bail!("{}: {error}", result.record);
    }
    for (name, axis) in result.in_order() {
        if let Some(error) = &axis.error {
            warn(format!("{name}: {error}"));
        }
    }
    if result.axes.values().all(|axis| axis.error.is_some()) {
        bail!(RecordingError::NoAxis);
    }
    Ok(())
}

/// Makes a record ready; one that is not static is refused, or warned of with --force.
fn prepare(record: Record, settings: &Settings, force: bool) -> Result<Prepared> {
    let name = record.name.display().to_string();
    for kind in record.skipped.to_string().lines() {
        warn(format!("{name}: {kind}"));
    }
    let prepared = identify::prepare(record, settings).with_context(|| name.clone())?;
    let record = &prepared.record;
    sentences::stamps(record.uneven())
        .into_iter()
        .for_each(warn);
    sentences::repeated(&record.repeated)
        .into_iter()
        .for_each(note);
    match &prepared.not_static {
        Some(problem) if !force => {
            bail!("{name}: {}", sentences::refused(&record.guessed, problem))
        }
        Some(problem) => {
            terminal::doubt();
            warn(format!("{name}: {problem}"));
        }
        None => {}
    }
    print_settings(&prepared, settings);
    Ok(prepared)
}

/// Records of one name, in different folders, by their paths.
fn name_apart(recordings: &mut [Prepared]) {
    let names: Vec<String> = recordings.iter().map(|one| one.name.clone()).collect();
    for one in recordings {
        if names.iter().filter(|name| **name == one.name).count() > 1 {
            one.name = one.record.name.display().to_string();
        }
    }
}

/// What the recordings show together.
fn identify(recordings: &[Prepared], settings: &Settings) -> Result<Identified> {
    let axes = recordings.first().map_or(0, |one| one.record.axes.len());
    stage("identification", || {
        let bar = Bar::new("identified", axes as u64, "axes");
        Ok(identify::recordings(recordings, settings, || bar.add(1))?)
    })
}

/// Reads the record: of a drive file the log of its `[imu]`.
fn read(path: &Path, format: &RecordFormat) -> Result<Record> {
    if path.extension().is_some_and(|ending| ending == "toml") {
        let stated = [
            ("--columns", !format.columns.is_empty()),
            ("--time", format.time.is_some()),
            ("--units", format.units.is_some()),
            ("--axis", format.axis.is_some()),
            ("--topic", format.topic.is_some()),
        ];
        if let Some((option, _)) = stated.iter().find(|(_, stated)| *stated) {
            bail!(Invalid(format!(
                "{}: {option} is for a log; of a drive file change [imu]",
                path.display()
            )));
        }
        return Ok(record::read_drive(path, format.temperature)?);
    }
    let opened = Opened::open(path)?;
    details::opened("record", &opened);
    let record = record::read(opened, format)?;
    let notes = [
        sentences::guessed(&record.guessed),
        sentences::slower(record.slower()),
    ];
    notes.into_iter().flatten().for_each(note);
    Ok(record)
}

fn print_settings(prepared: &Prepared, settings: &Settings) {
    let Prepared {
        record, rate_hz, ..
    } = prepared;
    detail(1, || {
        format!(
            "record: {} axes of {} samples at {rate_hz} Hz ({}), {}",
            record.axes.len(),
            record.length(),
            match settings.rate_hz {
                Some(_) => "as stated",
                None => "from its time stamps",
            },
            record.axes.join(" ")
        )
    });
    detail(1, || {
        format!(
            "settings: ARMA(2n, 2n-1) for n up to {}, {} removed",
            settings.n_max,
            match settings.trend {
                Trend::Temperature if record.temperature.is_none() => "the mean",
                Trend::Constant => "the mean",
                Trend::Linear => "a straight line",
                Trend::Temperature => "the part that follows the temperature",
            }
        )
    });
}

/// What a run would miss in a model file, and what one record does not say.
fn warn_of_unknown(file: &Path, model: &ImuModel, bounded: &[&str]) {
    let file = file.display();
    let axes = model.axes();
    let unknown = axes.iter().filter(|(_, axis)| !axis.is_known());
    let unknown: Vec<&str> = unknown.map(|(name, _)| *name).collect();
    if !unknown.is_empty() {
        let unknown = unknown.join(", ");
        warn(format!(
            "{file} has no {unknown}: a run needs all six axes; add the others with --base PRESET or FILE"
        ));
    }
    if !bounded.is_empty() {
        let bounded = bounded.join(", ");
        warn(format!(
            "{file}: one recording gives only a lower bound of the turn-on σ of {bounded}; the file has the largest that the means \
             do not contradict (95 %): set the data sheet's with --base PRESET or FILE"
        ));
    }
}
