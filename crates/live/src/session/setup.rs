//! What the logs are, from their first bytes: they are read as a file with these bytes would be.

use super::{DriveFile, Options, SessionError, log};
use crate::{Arrival, keys::without, seconds, state::State};
use std::{collections::BTreeMap, path::PathBuf};
use undrift_drive::drive::{ConfigError, Drive, DriveError, Logs, files_named, parse};
use undrift_io::Memory;

/// From one look to the next \[s\].
const LOOKS: f64 = 0.5;
/// Samples whose mean interval is that of the sensor, as of a file; and how many do after [`LONG`].
const SAMPLES: usize = 2000;
const FEW: usize = 100;
/// \[s\]
const LONG: f64 = 20.0;
/// Bytes that are collected at most.
const MOST: usize = 64 << 20;

/// The drive file without what a vehicle that drives does not have: a reference solution, a span of time.
pub(super) fn without_reference(text: &str, name: &str) -> Result<String, SessionError> {
    // Its mistakes are said as those of any drive file.
    let tables = parse(text, name).map_err(DriveError::from)?;
    Ok(without(text, tables.get_ref(), &["truth", "span"]))
}

/// Whether each log has a source.
pub(super) fn check(text: &str, logs: &[(String, usize)]) -> Result<(), SessionError> {
    let named = files_named(text).into_iter().map(|(table, _)| table);
    let named = Vec::from_iter(named.filter(|table| *table != "model"));
    let fixes = match named.contains(&log::POSES) {
        true => log::POSES,
        false => log::GNSS,
    };
    let needed = [log::IMU, fixes].into_iter().chain(named);
    for table in needed {
        if !logs.iter().any(|(log, _)| log == table) {
            return Err(SessionError::NoSource(table.to_owned()));
        }
    }
    Ok(())
}

/// What came before the logs were understood.
#[derive(Default)]
pub(super) struct Collected {
    arrivals: Vec<Arrival>,
    bytes: usize,
    next: Option<f64>,
    said: Option<String>,
}

/// What a look at it gives.
pub(super) enum Outcome {
    NotYet,
    Waiting(String),
    Failed(SessionError),
    Ready(Box<Drive>),
}

impl Collected {
    pub(super) fn add(&mut self, arrival: &Arrival) {
        self.bytes += arrival.bytes.len();
        self.arrivals.push(arrival.clone());
    }

    /// All of it.
    pub(super) fn take(&mut self) -> Vec<Arrival> {
        std::mem::take(&mut self.arrivals)
    }

    /// The drive, if what came shows enough of it.
    pub(super) fn drive(
        &mut self,
        file: &DriveFile,
        logs: &[(String, usize)],
        options: &Options,
        state: Option<&State>,
    ) -> Outcome {
        let (Some(first), Some(last)) = (self.arrivals.first(), self.arrivals.last()) else {
            return Outcome::NotYet;
        };
        let (first, last) = (seconds(first.at), seconds(last.at));
        if last < *self.next.get_or_insert(last + LOOKS) {
            return Outcome::NotYet;
        }
        self.next = Some(last + LOOKS);
        let interval = options.interval.or(state.map(|state| state.interval));
        match self.look(file, logs, interval, last - first) {
            Ok(drive) => Outcome::Ready(Box::new(drive)),
            Err(Look::Failed(error)) => Outcome::Failed(error),
            Err(Look::Waiting(why)) if self.bytes > MOST => {
                Outcome::Failed(SessionError::NotReady(MOST >> 20, why))
            }
            Err(Look::Waiting(why)) => {
                let new = self.said.as_ref() != Some(&why);
                self.said = Some(why.clone());
                if new {
                    Outcome::Waiting(why)
                } else {
                    Outcome::NotYet
                }
            }
        }
    }

    fn look(
        &self,
        file: &DriveFile,
        logs: &[(String, usize)],
        interval: Option<f64>,
        waited: f64,
    ) -> Result<Drive, Look> {
        for (table, source) in logs {
            if !self
                .arrivals
                .iter()
                .any(|arrival| arrival.source == *source)
            {
                return Err(Look::Waiting(format!(
                    "nothing has come from the source of [{table}]"
                )));
            }
        }
        let memory = self.memory(file, logs);
        let of_drive = Logs {
            folder: file.home.clone(),
            memory,
            ..Logs::default()
        };
        let mut drive = match Drive::with_logs(&file.text, &file.name, &file.home, of_drive) {
            Ok(drive) => drive,
            Err(error @ DriveError::Config(_)) => return Err(Look::Failed(error.into())),
            Err(error) => return Err(Look::Waiting(error.to_string())),
        };
        if drive.model.is_none() {
            return Err(Look::Failed(
                undrift_drive::navigate::NavigateError::NoModel.into(),
            ));
        }
        let waiting = |error: undrift_io::ReadError| Look::Waiting(error.to_string());
        let samples = drive
            .open_imu()
            .map_err(waiting)?
            .map_while(Result::ok)
            .take(SAMPLES)
            .count();
        let enough = match interval {
            Some(_) => samples >= 2,
            None => samples >= SAMPLES || (samples >= FEW && waited >= LONG),
        };
        if !enough {
            return Err(Look::Waiting(
                "the interval of the samples is measured".into(),
            ));
        }
        drive.gnss.1.clear_beside();
        match drive.open_gnss().map_err(waiting)?.next() {
            Some(Ok(_)) => {}
            _ if drive.poses.is_some() => return Err(Look::Waiting("no pose has come yet".into())),
            _ => return Err(Look::Waiting("the receiver has no fix yet".into())),
        }
        if interval.is_some() {
            drive.beginning.interval = interval;
        }
        drive.sample_interval().map_err(waiting)?;
        // From here on what comes is read.
        drive.logs.memory.clear();
        Ok(drive)
    }

    /// The bytes of each log in the place of its file.
    fn memory(&self, file: &DriveFile, logs: &[(String, usize)]) -> BTreeMap<PathBuf, Memory> {
        let named = files_named(&file.text);
        let mut memory = BTreeMap::new();
        for (table, source) in logs {
            let name = named.iter().find(|(of, _)| of == table);
            let Some((_, name)) = name else { continue };
            let path = match name.as_str() {
                "-" => PathBuf::from("-"),
                name => file.home.join(name),
            };
            memory
                .entry(path)
                .or_insert_with(|| Memory::Bytes(bytes_of(&self.arrivals, *source).into()));
        }
        memory
    }
}

/// What came from a source.
pub(super) fn bytes_of(arrivals: &[Arrival], source: usize) -> Vec<u8> {
    let pieces = arrivals.iter().filter(|arrival| arrival.source == source);
    pieces
        .flat_map(|arrival| arrival.bytes.iter().copied())
        .collect()
}

/// Why a look gives no drive.
enum Look {
    Waiting(String),
    Failed(SessionError),
}

impl From<ConfigError> for SessionError {
    fn from(error: ConfigError) -> Self {
        Self::Drive(error.into())
    }
}
