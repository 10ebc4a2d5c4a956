//! RINEX: observations and navigation messages beside a log of fixes, for mean velocities by the carrier phase.
//!
//! Observation files of versions 2, 3 and 4, GPS on L1 and Galileo on E1; navigation files of the same versions, GPS LNAV and Galileo
//! I/NAV (RINEX 2.11, 3.05 and 4.00). Times are GPS time. Phases are as a receiver's: a loss-of-lock indicator of 1 begins a new arc, of one of 2
//! (half-cycle ambiguity) the phase is not used. What cannot be read is passed over; a satellite without an ephemeris gives nothing.

mod navigation;
mod observations;

use std::collections::VecDeque;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use undrift_nav::sample::{GnssFix, MeanVelocity};
use undrift_nav::{Matrix3, Vector3};
use undrift_observables::{Ephemerides, Epoch, System, since};

use crate::carrier::{CLOCK, Way};
use crate::opened::Memory;
use crate::source::{self, BytesRead};
use crate::table::lines::Lines;
use crate::{Key, ReadError};
use observations::Observations;

/// Acceleration that a velocity is uncertain by where only its mean is known [m/s²].
const ACCELERATION: f64 = 2.0;

/// A RINEX file by its path, and its bytes where it is in memory.
pub type RinexFile = (PathBuf, Option<Memory>);

/// A version and kind of file, from its first line.
struct Header {
    version: f64,
    kind: u8,
    system: u8,
}

/// What a log of fixes has beside it.
pub(crate) struct Rinex {
    ephemerides: Ephemerides,
    files: VecDeque<(PathBuf, Observations)>,
    /// The next epoch, that of a later fix.
    next: Option<Epoch>,
    way: Way,
    /// Fixes at the time of an epoch, and those with a mean velocity.
    matched: u64,
    given: u64,
    /// From a fix to the epoch nearest of all \[s\].
    nearest: Option<f64>,
}

impl Rinex {
    /// Opens observation files, in the order of time, and reads navigation files.
    ///
    /// # Errors
    /// If a file cannot be read or is no RINEX file, or one of the two kinds is missing.
    pub(crate) fn open(files: &[RinexFile]) -> Result<Self, ReadError> {
        let mut all = Self {
            ephemerides: Ephemerides::default(),
            files: VecDeque::new(),
            next: None,
            way: Way::default(),
            matched: 0,
            given: 0,
            nearest: None,
        };
        let mut orbits = 0;
        for (path, held) in files {
            let named = |error: ReadError| error.in_log(path);
            let mut lines = Lines::new(source(path, held.as_ref())?);
            let header = header(&mut lines).map_err(named)?;
            match header.kind {
                b'O' => {
                    let read = Observations::new(lines, header.version).map_err(named)?;
                    all.files.push_back((path.clone(), read));
                }
                _ => {
                    let read = navigation::read(lines, &header, &mut all.ephemerides);
                    orbits += read.map_err(named)?;
                }
            }
        }
        let lacks = if all.files.is_empty() {
            "has no RINEX observation file (rover.obs)"
        } else if orbits == 0 {
            "has no navigation file with ephemerides of GPS or Galileo (rover.nav)"
        } else {
            return Ok(all);
        };
        Err(refused(lacks).mend("list both, as [\"rover.obs\", \"rover.nav\"]"))
    }

    /// Gives a fix the mean velocity since the one before; `time` is the fix's by the receiver \[s of a GPS week\].
    ///
    /// # Errors
    /// If the observations break off.
    pub(crate) fn add(&mut self, fix: &mut GnssFix, time: f64) -> Result<(), ReadError> {
        let now = self.at(time)?;
        self.matched += u64::from(now.is_some());
        let place = fix.position.as_ref().map(|(position, _)| position);
        let v_n = fix.velocity.map(|(v_n, _)| v_n);
        let mean = (self.way).mean_velocity(&self.ephemerides, now, place, v_n);
        self.given += u64::from(mean.is_some());
        fix.mean_velocity = mean;
        if let (None, Some(mean)) = (fix.velocity, mean) {
            fix.velocity = Some(at_the_end(&mean));
        }
        Ok(())
    }

    /// The epoch of a time; earlier ones are passed over.
    fn at(&mut self, time: f64) -> Result<Option<Epoch>, ReadError> {
        loop {
            if self.next.is_none() {
                self.next = self.read()?;
            }
            let Some(next) = &self.next else {
                return Ok(None);
            };
            let off = since(next.time, time);
            if self.nearest.is_none_or(|nearest| off.abs() < nearest.abs()) {
                self.nearest = Some(off);
            }
            if off >= CLOCK {
                return Ok(None);
            }
            let epoch = self.next.take();
            if off > -CLOCK {
                return Ok(epoch);
            }
        }
    }

    fn read(&mut self) -> Result<Option<Epoch>, ReadError> {
        while let Some((path, file)) = self.files.front_mut() {
            let epoch = file.next_epoch().map_err(|error| error.in_log(path))?;
            if epoch.is_some() {
                return Ok(epoch);
            }
            self.files.pop_front();
        }
        Ok(None)
    }

    /// What is wrong after the last fix.
    ///
    /// # Errors
    /// If no fix got a velocity.
    pub(crate) fn end(&self) -> Result<(), ReadError> {
        let nearest = self.nearest.unwrap_or(f64::NAN);
        match (self.given, self.matched) {
            (1.., _) => Ok(()),
            (_, 0 | 1) => Err(refused(format!(
                "no observations at the times of the fixes: the nearest are {nearest:.2} s off"
            ))
            .mend("give those of the same receiver and day; times of fixes are GPS seconds of the week, an epoch for each")),
            _ => Err(refused("no velocity by the carrier phase").mend(
                "give the navigation file of the same hours; five satellites of GPS and Galileo with phases are needed",
            )),
        }
    }
}

/// What ended a file before its end.
fn failure(lines: &Lines) -> Option<ReadError> {
    let why = lines.failure()?;
    Some(ReadError::nameless(format!("breaks off: {why}")))
}

fn refused(problem: impl Into<String>) -> ReadError {
    ReadError::nameless(problem).key(Key::from("gnss.observations"))
}

/// The velocity at the end of a mean, to within an acceleration over half of its time.
fn at_the_end(mean: &MeanVelocity) -> (Vector3, Matrix3) {
    let change = 0.5 * ACCELERATION * mean.over;
    let unknown = Matrix3::identity() * (change * change);
    (mean.v_n, mean.covariance + unknown)
}

fn source(path: &Path, held: Option<&Memory>) -> Result<source::Source, ReadError> {
    match held {
        Some(Memory::Bytes(bytes)) => {
            let bytes = Cursor::new(bytes.clone());
            Ok(source::decompressed(path, bytes, &BytesRead::default())?.0)
        }
        _ => source::open(path),
    }
}

/// The first line.
fn header(lines: &mut Lines) -> Result<Header, ReadError> {
    let line = lines.next_line().unwrap_or_default();
    let label = line.get(60..).unwrap_or_default().trim_ascii();
    if label.starts_with(b"CRINEX") {
        return Err(refused("is compressed by Hatanaka's method").mend("expand it with CRX2RNX"));
    }
    let version = crate::number::parse_finite(part(line, 0, 9));
    let byte = |at: usize| line.get(at).copied().unwrap_or(b' ');
    // Version 2 has Galileo's navigation messages in files of their own.
    let (kind, system) = match (byte(20), byte(40)) {
        (b'L' | b'E', _) => (b'N', b'E'),
        known => known,
    };
    match version {
        Some(version) if label == b"RINEX VERSION / TYPE" => {
            if !(2.0..5.0).contains(&version) || !matches!(kind, b'O' | b'N') {
                let problem = "is neither observations nor navigation messages of RINEX 2, 3 or 4";
                return Err(refused(problem).mend("convert it, with RTKLIB's CONVBIN or another program"));
            }
            Ok(Header {
                version,
                kind,
                system,
            })
        }
        _ => Err(refused("is no RINEX file").mend(
            "list RINEX files here, as [\"rover.obs\", \"rover.nav\"]; the log with the positions is gnss.file",
        )),
    }
}

/// A part of a line of fixed columns without blanks around; empty beyond its end.
fn part(line: &[u8], from: usize, length: usize) -> &[u8] {
    let to = line.len().min(from + length);
    line.get(from..to).unwrap_or_default().trim_ascii()
}

/// The system of a letter; a blank is GPS.
fn system(letter: u8) -> Option<System> {
    match letter {
        b'G' | b' ' => Some(System::Gps),
        b'E' => Some(System::Galileo),
        _ => None,
    }
}

/// Day from the GPS epoch and second of the day of the numbers of a calendar, GPS time; years of two digits in version 2.
fn day_and_second(calendar: &[u8]) -> Option<(i64, f64)> {
    let mut fields = calendar
        .split(u8::is_ascii_whitespace)
        .filter(|field| !field.is_empty());
    let mut whole = || crate::time::whole(fields.next()?);
    let (year, month, day) = (whole()?, whole()?, whole()?);
    let year = match year {
        0..100 => crate::time::full_year(year),
        year => year,
    };
    let (hour, minute, second) = (fields.next()?, fields.next()?, fields.next()?);
    let second = crate::time::of_day(hour, minute, second)?;
    Some((crate::time::day_of(year, month, day)?, second))
}

#[cfg(test)]
mod tests;
