//! Static records: six axes, or one, from a table; six from a log that says itself what it holds, or that a drive
//! file describes.

mod columns;
mod guess;
mod parts;
mod rates;
mod repeats;
mod topics;

use crate::{
    drive::{self, DriveError, Logs},
    findings::of_timing,
    temperature,
};
use columns::{RecordColumns, find};
pub use rates::own_values;
use rates::{Mixed, mixed};
pub use repeats::Repeated;
use std::{
    path::{Path, PathBuf},
    slice,
};
use undrift_io::{
    Key, Opened, ReadError,
    format::Format,
    imu::{ImuFormat, ImuReader, ImuSource},
    layouts,
    skipped::{SkipKind, Skipped},
    source::BytesRead,
    table::Column,
};
use undrift_nav::Matrix3;
use undrift_noise::{
    model_file::AXES,
    screening::{Timing, timing},
};
pub use undrift_results::recording::{Slower, Uneven};

/// Columns, axes and units of a record, as far as they are stated. The default reads them from the header's names.
#[derive(Clone, Debug, Default)]
pub struct RecordFormat {
    /// Columns in the order of [`AXES`], or one; empty to use the header's names.
    pub columns: Vec<Column>,
    /// The axis of a single column, such as "gyro_z".
    pub axis: Option<String>,
    /// Units of gyro and accelerometer columns, such as "deg/s" and "g"; `None` to use the
    /// header's names.
    pub units: Option<(String, String)>,
    /// The column of times, and its unit; `None` to use the header's name, and as a unit what the steps show.
    pub time: Option<(Column, Option<String>)>,
    /// Whether the record must have a temperature; it is read wherever there is one.
    pub temperature: bool,
    /// The stream of a log that has several of inertial samples.
    pub topic: Option<String>,
}

/// A record in SI units.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{Record, identify};
///
/// // 20 s at 50 Hz, rows of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²]: level and at rest.
/// let rows: Vec<[f64; 6]> = (0..1000)
///     .map(|k| f64::from(k % 7 - 3) * 1e-3)
///     .map(|noise| [noise, noise, -noise, noise, noise, noise - 9.81])
///     .collect();
/// let record = Record::from_samples(&rows).within((5.0, 15.0), 50.0);
/// assert_eq!((record.axes[5], record.length()), ("accel_z", 500));
/// assert_eq!(identify::not_static(&record, 50.0), None);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Name of the record in messages and results.
    pub name: PathBuf,
    /// The regular file that it is read from; `None` of pipes and columns in memory.
    pub file: Option<PathBuf>,
    /// Names of the axes, of [`AXES`].
    pub axes: Vec<&'static str>,
    /// Samples of each axis [rad/s] or [m/s²].
    pub samples: Vec<Vec<f64>>,
    /// Temperature of each sample [°C], NaN where it is missing; `None` of a record without one.
    pub temperature: Option<Vec<f64>>,
    /// Whether its axes are those of a body in which the sensor's are turned.
    pub body_axes: bool,
    /// Time stamps \[s\], where there are any; else empty.
    pub stamps: Vec<f64>,
    /// Rate, jitter and gaps of the stamps.
    pub timing: Option<Timing>,
    /// Units of gyro and accelerometer columns; `None` of a log that is in SI units.
    pub units: Option<(String, String)>,
    /// Columns and units that neither an option nor a name states, guessed from the numbers: each with the option that would state it.
    pub guessed: Vec<(&'static str, String)>,
    /// Rows that were skipped, and why.
    pub skipped: Skipped,
    /// Sensors whose samples a logger repeated, which [`crate::identify::prepare`] takes out.
    pub repeated: Vec<Repeated>,
}

impl Record {
    /// A record of rows in memory: gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²], evenly spaced, NaN where a value
    /// is missing.
    pub fn from_samples(samples: &[[f64; 6]]) -> Self {
        let column = |axis: usize| samples.iter().map(|row| row[axis]).collect();
        Self {
            name: PathBuf::from("<record>"),
            axes: AXES.to_vec(),
            samples: (0..AXES.len()).map(column).collect(),
            units: Some(("rad/s".into(), "m/s^2".into())),
            ..Self::default()
        }
    }

    /// This record without the axes that have no value at all.
    pub fn with_values(mut self) -> Self {
        let has = |samples: &[f64]| samples.iter().any(|x| !x.is_nan());
        let axes = self.axes.iter().copied().zip(self.samples);
        (self.axes, self.samples) = axes.filter(|(_, samples)| has(samples)).unzip();
        self
    }

    /// Number of samples of an axis.
    pub fn length(&self) -> usize {
        self.samples.first().map_or(0, Vec::len)
    }

    /// Units of raw counts that are a guess: at rest nothing shows a gyro's range.
    pub fn guessed_range(&self) -> Option<String> {
        let mut guessed = self.guessed.iter();
        let (_, units) =
            guessed.find(|(option, units)| *option == "--units" && units.starts_with("LSB/"))?;
        Some(units.clone())
    }

    /// How its stamps are uneven, if they are.
    pub fn uneven(&self) -> Option<Uneven<'_>> {
        let timing = self.timing.as_ref();
        Some(Uneven {
            finding: of_timing(timing)?,
            // Evenly spaced without stamps.
            filled: self.stamps.is_empty(),
            timing: timing?,
        })
    }

    /// The sensor that has fewer samples than the record, or none, where there is one.
    pub fn slower(&self) -> Option<Slower> {
        let timing = self.timing.as_ref()?;
        let has = |sensor: &str| self.axes.iter().any(|axis| axis.starts_with(sensor));
        if self.axes.len() == 3 && has("gyro") != has("accel") {
            let (gyro, rate_hz) = (!has("gyro"), 0.0);
            return Some(Slower { gyro, rate_hz });
        }
        let mut axes = self.axes.iter().zip(&self.samples);
        axes.find_map(|(axis, samples)| {
            let (.., every) = own_values(samples)?;
            Some(Slower {
                gyro: axis.starts_with("gyro"),
                rate_hz: timing.rate_hz / every,
            })
        })
    }
}

/// Rows that units and columns are guessed from.
const BEGINNING: usize = 4000;

/// Reads a record from a log in one pass.
///
/// # Errors
/// A file that cannot be read; columns or units that neither the format nor the header states.
pub fn read(opened: Opened, format: &RecordFormat) -> Result<Record, ReadError> {
    let record = Record {
        name: opened.name().to_path_buf(),
        file: opened.file().map(Path::to_path_buf),
        ..Record::default()
    };
    let known = match opened.format() {
        _ if !format.columns.is_empty() || opened.has_rows() => None,
        Format::KfGins => Some(layouts::kf_gins_imu()),
        Format::Euroc => Some(layouts::euroc_imu()),
        log if log.is_log() => {
            let topic = format.topic.clone();
            Some(ImuFormat::log(log, topic))
        }
        _ => None,
    };
    let record = match known {
        Some(imu) => read_log(opened, imu, record).map_err(|error| match error.key {
            Some(Key::Topic(_)) => error.key("--topic"),
            _ => error,
        }),
        None => read_table(opened, format, record),
    }?;
    with_temperature(record, format.temperature)
}

/// Reads a record from a log that says what it holds; of one with several topics those that `inspect` chooses.
fn read_log(opened: Opened, format: ImuFormat, record: Record) -> Result<Record, ReadError> {
    let logs = Logs::default();
    let path = opened.file().map(Path::to_path_buf);
    if let (Some(path), Some(apart)) = (&path, topics::apart(&format)) {
        return topics::read(path, &logs, &apart, record);
    }
    let several = |error: &ReadError| matches!(error.key, Some(Key::Topic(_)));
    match (read_samples(opened, format.clone(), record.clone()), path) {
        (Err(error), Some(path)) if several(&error) => {
            let ImuSource::Log(log, None) = format.source else {
                return Err(error);
            };
            let chosen = topics::chosen(&path, &logs, log).ok_or(error)?;
            let format = ImuFormat::log(log, Some(chosen.clone()));
            let mut record = match topics::apart(&format) {
                Some(apart) => topics::read(&path, &logs, &apart, record)?,
                None => read_samples(Opened::open(&path)?, format, record)?,
            };
            record.guessed.push(("--topic", chosen));
            Ok(record)
        }
        (read, _) => read,
    }
}

/// A record that has a temperature, if it `must`.
fn with_temperature(record: Record, must: bool) -> Result<Record, ReadError> {
    match record.temperature {
        None if must => Err(ReadError::new(&record.name, NO_TEMPERATURE)),
        _ => Ok(record),
    }
}

const NO_TEMPERATURE: &str =
    "no temperature column: the header needs \"temp\", \"temperature\" or a name ending in \"_C\"";

/// Reason why forces between samples are no record of their noise.
const INTERPOLATED: &str = "specific forces that are interpolated to the times of the gyroscopes have less noise than the sensor";

/// Reads a record whose columns and units are known.
fn read_samples(
    mut opened: Opened,
    format: ImuFormat,
    record: Record,
) -> Result<Record, ReadError> {
    let temperature = temperature::column(&mut opened, &format)?;
    let format = ImuFormat {
        temperature,
        ..format
    };
    of_samples(ImuReader::new(opened, &format)?, record)
}

/// Reads the record that the table `[imu]` of the drive file `path` describes, its `[span]` alone; axes are the body's. With `temperature`
/// it must have one.
///
/// # Errors
/// If the drive file or the log cannot be read, or a key has a wrong value.
pub fn read_drive(path: &Path, temperature: bool) -> Result<Record, DriveError> {
    let imu = drive::load_imu(path)?;
    if imu.format.apart {
        let error = ReadError::new(&imu.path, INTERPOLATED).key("imu.blanks");
        let table = imu.path.display();
        return Err(error
            .mend(format!("give the table itself: undrift identify {table}"))
            .into());
    }
    let opened = imu.logs.open(&imu.path, &BytesRead::default())?;
    let record = Record {
        name: imu.path.clone(),
        file: opened.file().map(Path::to_path_buf),
        units: imu.units,
        body_axes: imu.format.rotation != Matrix3::identity(),
        ..Record::default()
    };
    let record = match topics::apart(&imu.format) {
        Some(apart) => topics::read(&imu.path, &imu.logs, &apart, record)?,
        None => read_samples(opened, imu.format, record)?,
    };
    Ok(with_temperature(record, temperature)?)
}

fn of_samples(mut reader: ImuReader, mut record: Record) -> Result<Record, ReadError> {
    record.axes = AXES.to_vec();
    record.samples = vec![Vec::new(); AXES.len()];
    let mut temperature = Vec::new();
    while let Some(sample) = reader.next() {
        let sample = sample?;
        let (gyro, accel) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        let values = gyro.iter().chain(&accel);
        let room = push(&mut record.samples, values.copied());
        let room = room.and_then(|()| push(slice::from_mut(&mut record.stamps), [sample.time]));
        let warmth = [reader.temperature_c()];
        let room = room.and_then(|()| push(slice::from_mut(&mut temperature), warmth));
        room.map_err(|problem| problem.in_log(&record.name))?;
    }
    room_to_work(&record)?;
    // A topic of gyroscopes alone has zeros in the place of forces, and the other way round.
    let zeros = |axes: &[Vec<f64>]| axes.iter().flatten().all(|x| *x == 0.0);
    let (gyros, accels) = record.samples.split_at(3);
    let there = match (zeros(gyros), zeros(accels)) {
        (false, true) => 0..3,
        (true, false) => 3..6,
        _ => 0..6,
    };
    record.axes = record.axes.get(there.clone()).unwrap_or_default().to_vec();
    record.samples = record.samples.drain(there).collect();
    let known = temperature.iter().any(|t| t.is_finite());
    record.temperature = known.then_some(temperature);
    record.timing = timing(&record.stamps).ok();
    record.skipped = reader.skipped().clone();
    Ok(record)
}

/// Reads a record from a table's columns.
fn read_table(
    mut opened: Opened,
    format: &RecordFormat,
    mut record: Record,
) -> Result<Record, ReadError> {
    let beginning = opened.preview(BEGINNING)?;
    let found = find(&beginning, format);
    let RecordColumns {
        axes,
        time,
        zero,
        mut wanted,
        guessed,
    } = found.map_err(|problem| ReadError::new(&record.name, problem))?;
    let mut row = vec![0.0; wanted.columns.len()];
    let indices: Vec<usize> = axes.iter().map(|axis| axis.index).collect();
    let mut mixed = mixed(&beginning, &wanted, &indices);
    wanted.keep_not_finite = mixed.is_some();
    let mut table = opened.table(&wanted)?;
    let mut temperature = zero.map(|_| Vec::new());
    record.samples = vec![Vec::new(); axes.len()];
    let mut incomplete = Skipped::default();
    let mut row_of = |row: &[f64]| {
        let values = row.iter().zip(&axes);
        push(
            &mut record.samples,
            values.map(|(value, axis)| value * axis.scale),
        )?;
        let warmth = row.get(axes.len()).zip(zero);
        push(temperature.as_mut_slice(), warmth.map(|(t, zero)| t - zero))?;
        let time = time.zip(row.last()).map(|(scale, time)| time * scale);
        push(slice::from_mut(&mut record.stamps), time)
    };
    while let Some(line) = table.next_row(&mut row)? {
        if let Some(mixed) = &mut mixed {
            match mixed.take(&mut row) {
                Mixed::Row => {}
                Mixed::Waits => continue,
                Mixed::Nothing => {
                    incomplete.add(SkipKind::MissingField, line, "no sensor has all its axes");
                    continue;
                }
            }
        }
        row_of(&row).map_err(|problem| problem.in_log(&record.name))?;
    }
    room_to_work(&record)?;
    let unit = |gyro: bool| {
        let mut units = axes.iter().filter(|axis| (axis.index < 3) == gyro);
        units.find_map(|axis| axis.unit.clone()).unwrap_or_default()
    };
    record.units = Some((unit(true), unit(false)));
    record.guessed = guessed;
    record.axes = axes.iter().map(|axis| AXES[axis.index]).collect();
    record.temperature = temperature;
    record.timing = timing(&record.stamps).ok();
    record.skipped = table.skipped().clone();
    record.skipped.merge(&incomplete);
    Ok(record)
}

/// Samples of a record at most: a day and a half at 400 Hz, hours of work.
const MOST: usize = 50_000_000;

/// Adds a value to each column.
fn push(columns: &mut [Vec<f64>], values: impl IntoIterator<Item = f64>) -> Result<(), ReadError> {
    for (column, value) in columns.iter_mut().zip(values) {
        if column.len() >= MOST {
            return Err(too_large(format!(
                "has more than {} million samples",
                MOST / 1_000_000
            )));
        }
        let room = column.try_reserve(1);
        room.map_err(|_| too_large("does not fit into memory".to_owned()))?;
        column.push(value);
    }
    Ok(())
}

/// Refuses a record that leaves no memory for copies of all axes, which its identification makes.
fn room_to_work(record: &Record) -> Result<(), ReadError> {
    let samples = record.samples.iter().map(Vec::len).sum::<usize>();
    let room = Vec::<f64>::new().try_reserve_exact(2 * samples);
    room.map_err(|_| too_large("does not fit into memory".to_owned()).in_log(&record.name))
}

fn too_large(problem: String) -> ReadError {
    ReadError::new(Path::new(""), problem).mend("cut the file, or average it to a lower rate")
}

#[cfg(test)]
mod tests {
    use super::{columns::as_axis, *};
    use crate::columns::meaning;
    use undrift_io::table::Preview;

    #[test]
    fn names_and_units_of_columns() {
        assert_eq!(as_axis(meaning("gx_dps")), Some((0, Some("deg/s".into()))));
        assert_eq!(as_axis(meaning("AZ_g")), Some((5, Some("g".into()))));
        assert_eq!(as_axis(meaning("gyro_y")), Some((1, None)));
        assert_eq!(as_axis(meaning("t_s")), None);
        let zero = |name: &str, value| {
            let beginning = Preview {
                header: vec!["t_s".into(), name.into()],
                rows: vec![vec![0.0, f64::NAN], vec![0.0, value]],
                ..Preview::default()
            };
            temperature::of_beginning(&beginning).map(|column| column.zero)
        };
        for name in ["temp", "Temperature", "board_C", "T_degC"] {
            assert_eq!(zero(name, 25.0), Some(0.0), "{name}");
        }
        assert_eq!(zero("temp", 298.0), Some(273.15));
        assert_eq!(zero("t_kelvin", 2.0), Some(273.15));
        assert_eq!((zero("t_s", 1.0), zero("gx_dps", 1.0)), (None, None));
    }

    /// Gyros at 100 Hz that alternate, forces in every fourth row or between the rows.
    #[test]
    fn each_sensor_is_identified_from_its_own_rows() {
        for own_rows in [false, true] {
            let mut text = String::from("t_s,gx_dps,gy_dps,gz_dps,ax_mps2,ay_mps2,az_mps2\n");
            for k in 0..4000 {
                let (t, w) = (0.01 * f64::from(k), f64::from(k % 7 - 3));
                let force = format!("{w},0.5,-9.81");
                match (k % 4 == 0, own_rows) {
                    (true, false) => text += &format!("{t:.3},{w},1,2,{force}\n"),
                    (true, true) => {
                        text += &format!("{:.3},,,,{force}\n{t:.3},{w},1,2,,,\n", t - 0.003);
                    }
                    _ => text += &format!("{t:.3},{w},1,2,,,\n"),
                }
            }
            let stream = std::io::Cursor::new(text.into_bytes());
            let opened = Opened::stream(Path::new("imu.csv"), stream).unwrap();
            let record = read(opened, &RecordFormat::default()).unwrap();
            assert!(record.skipped.is_empty(), "{}", record.skipped);
            assert_eq!((record.length(), record.samples[5].len()), (4000, 4000));
            assert!((record.timing.as_ref().unwrap().rate_hz - 100.0).abs() < 1e-6);
            let (values, _, every) = own_values(&record.samples[3]).unwrap();
            assert_eq!((values.len(), every), (1000, 4.0));
            let slower = record.slower().unwrap();
            assert!(!slower.gyro && (slower.rate_hz - 25.0).abs() < 1e-6);
        }
    }
    /// A receiver's sentences once a second between the samples change nothing of these.
    #[test]
    fn rows_between_sentences_are_a_record() {
        let of = |sentences: bool| {
            let mut text = String::new();
            for k in 0..2000 {
                let (t, w) = (0.01 * f64::from(k), 1e-3 * f64::from(k % 7 - 3));
                if sentences && k % 100 == 0 {
                    text +=
                        "$GPRMC,100000.00,A,4717.11399,N,00833.91590,E,0.004,77.52,091202,,,A*5E\n";
                }
                text += &format!("IMU,{t:.3},{w},0.01,0.02,0.1,{w},-9.81\n");
            }
            let stream = std::io::Cursor::new(text.into_bytes());
            let opened = Opened::stream(Path::new("log.txt"), stream).unwrap();
            read(opened, &RecordFormat::default()).unwrap()
        };
        let (alone, between) = (of(false), of(true));
        assert_eq!(alone.length(), 2000);
        assert_eq!(alone.samples, between.samples);
    }
}
