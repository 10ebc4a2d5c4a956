//! Observation files.

use undrift_observables::{Epoch, Observation, Satellite, System};

use super::{day_and_second, failure, part, refused, system};
use crate::ReadError;
use crate::number;
use crate::table::lines::Lines;
use crate::time::WeekClock;

/// Columns of an observation: value, loss-of-lock indicator, signal strength.
const WIDTH: usize = 16;
/// Observations in a line of version 2.
const IN_LINE: usize = 5;
/// Satellites in a line of version 2.
const SATELLITES_IN_LINE: usize = 12;
/// Most satellites of an epoch.
const MOST: i64 = 200;
/// Carrier to noise density where the file has none [dB-Hz].
const STRENGTH: f64 = 40.0;
/// Bandwidth of the loop that tracks a phase \[Hz\].
const LOOP: f64 = 20.0;

/// Where a satellite's observations on L1 are in its row, from 0.
#[derive(Clone, Copy)]
struct Places {
    code: usize,
    phase: usize,
    doppler: Option<usize>,
    strength: Option<usize>,
}

/// Since when a satellite's phase has been tracked, and when it was seen last \[s\].
struct Tracked {
    satellite: Satellite,
    since: f64,
    last: f64,
}

pub(super) struct Observations {
    lines: Lines,
    old: bool,
    /// Types of observations in a row of version 2.
    types: usize,
    /// Of GPS, of Galileo.
    places: [Option<Places>; 2],
    weeks: WeekClock,
    tracked: Vec<Tracked>,
    /// Time of the epoch before \[s\].
    before: f64,
}

impl Observations {
    /// Reads the header behind the first line.
    ///
    /// # Errors
    /// If it has no carrier phases on L1, or times that are not GPS time.
    pub(super) fn new(mut lines: Lines, version: f64) -> Result<Self, ReadError> {
        let old = version < 3.0;
        let mut types: [Vec<Vec<u8>>; 2] = Default::default();
        let mut of = None;
        loop {
            let Some(line) = lines.next_line() else {
                return Err(refused("has no end of its header").mend("convert it again"));
            };
            match part(line, 60, 20) {
                b"END OF HEADER" => break,
                b"SYS / # / OBS TYPES" => {
                    match line.first() {
                        Some(b' ') | None => {}
                        Some(letter) => of = system(*letter),
                    }
                    if let Some(system) = of {
                        types[index(system)].extend(listed(line, 7, [13, 4, 3]));
                    }
                }
                b"# / TYPES OF OBSERV" => {
                    types[0].extend(listed(line, 10, [9, 6, 2]));
                }
                b"TIME OF FIRST OBS" => match part(line, 48, 3) {
                    b"GPS" | b"GAL" | b"QZS" | b"" => {}
                    other => {
                        let other = String::from_utf8_lossy(other);
                        let problem = format!("has times in {other} time");
                        return Err(refused(problem).mend("convert it with GPS time"));
                    }
                },
                _ => {}
            }
        }
        if old {
            types[1] = types[0].clone();
        }
        let places = [&types[0], &types[1]].map(|types| places(types));
        if places.iter().all(Option::is_none) {
            let problem = "has no code and carrier phase on L1 of GPS or E1 of Galileo";
            return Err(refused(problem).mend("convert it with these observations"));
        }
        Ok(Self {
            lines,
            old,
            types: types[0].len(),
            places,
            weeks: WeekClock::default(),
            tracked: Vec::new(),
            before: f64::NAN,
        })
    }

    /// The next epoch with observations.
    ///
    /// # Errors
    /// If the file breaks off.
    pub(super) fn next_epoch(&mut self) -> Result<Option<Epoch>, ReadError> {
        loop {
            let Some(line) = self.lines.next_line() else {
                return failure(&self.lines).map_or(Ok(None), Err);
            };
            let line = line.to_vec();
            let Some((day, second, flag, count)) = begin(&line, self.old) else {
                continue;
            };
            match flag {
                0 | 1 => {}
                // Cycle slips are in the indicators as well, all else is lines of a header.
                6 if self.old => {
                    let each = self.types.div_ceil(IN_LINE);
                    let further = (count - 1).max(0) as usize / SATELLITES_IN_LINE;
                    self.pass(count as usize * each + further);
                    continue;
                }
                _ => {
                    self.pass(count as usize);
                    continue;
                }
            }
            let time = self.weeks.gps(day, second);
            if flag == 1 {
                self.tracked.clear();
            }
            let observations = match self.old {
                true => self.old_rows(&line, count as usize, time),
                false => self.rows(count as usize, time),
            };
            self.before = time;
            return Ok(Some(Epoch { time, observations }));
        }
    }

    fn pass(&mut self, lines: usize) {
        for _ in 0..lines {
            self.lines.next_line();
        }
    }

    /// A line for each satellite.
    fn rows(&mut self, count: usize, time: f64) -> Vec<Observation> {
        let mut observations = Vec::new();
        for _ in 0..count {
            let Some(line) = self.lines.next_line() else {
                break;
            };
            let row = line.get(3..).unwrap_or_default().to_vec();
            let satellite = satellite(part(line, 0, 3));
            observations.extend(satellite.and_then(|known| self.observation(known, &row, time)));
        }
        observations
    }

    /// Satellites behind the time, twelve a line, then five observations a line.
    fn old_rows(&mut self, first: &[u8], count: usize, time: f64) -> Vec<Observation> {
        let mut satellites = Vec::new();
        let mut line = first.to_vec();
        while satellites.len() < count {
            if satellites.len().is_multiple_of(SATELLITES_IN_LINE) && !satellites.is_empty() {
                match self.lines.next_line() {
                    Some(next) => line = next.to_vec(),
                    None => break,
                }
            }
            let at = 32 + 3 * (satellites.len() % SATELLITES_IN_LINE);
            let to = line.len().min(at + 3);
            satellites.push(satellite(line.get(at..to).unwrap_or_default()));
        }
        let mut observations = Vec::new();
        for known in satellites {
            let mut row = Vec::new();
            for _ in 0..self.types.div_ceil(IN_LINE) {
                let mut line = self.lines.next_line().unwrap_or_default().to_vec();
                line.resize(WIDTH * IN_LINE, b' ');
                row.extend(line);
            }
            observations.extend(known.and_then(|known| self.observation(known, &row, time)));
        }
        observations
    }

    /// What a row says of a satellite; `None` without a code.
    fn observation(&mut self, satellite: Satellite, row: &[u8], time: f64) -> Option<Observation> {
        let places = self.places[index(satellite.system)]?;
        // Version 2 has zeros where nothing was measured.
        let value = |at: usize| {
            let value = number::parse_finite(part(row, WIDTH * at, 14))?;
            (value != 0.0).then_some(value)
        };
        let pseudorange = value(places.code)?;
        let digit = |at: usize| match row.get(WIDTH * places.phase + at) {
            Some(byte @ b'0'..=b'9') => byte - b'0',
            _ => 0,
        };
        let (lost, strength) = (digit(14), digit(15));
        let phase = value(places.phase).filter(|_| lost & 0b10 == 0);
        let strength = match (places.strength.and_then(value), strength) {
            (Some(strength), _) => strength,
            (None, 0) => STRENGTH,
            // Six dB-Hz each, 5 is 30 to 35.
            (None, digit) => 3.0 + 6.0 * f64::from(digit),
        };
        let seen = self.before;
        let held = self
            .tracked
            .iter()
            .position(|one| one.satellite == satellite);
        let held = match held {
            Some(at) => self.tracked.get_mut(at)?,
            None => {
                self.tracked.push(Tracked {
                    satellite,
                    since: time,
                    last: seen,
                });
                self.tracked.last_mut()?
            }
        };
        if lost & 1 == 1 || phase.is_none() || held.last != seen {
            held.since = time;
        }
        held.last = time;
        Some(Observation {
            satellite,
            pseudorange,
            phase,
            phase_std: phase_std(strength),
            doppler: places.doppler.and_then(value).unwrap_or(f64::NAN),
            lock: time - held.since,
            half_subtracted: false,
        })
    }
}

/// Standard deviation of a phase \[cycles\] by thermal noise in a loop, of a carrier to noise density [dB-Hz].
fn phase_std(strength: f64) -> f64 {
    (LOOP / 10f64.powf(0.1 * strength)).sqrt() / std::f64::consts::TAU
}

/// Types of observations in a line of the header: at most `most`, one every `step` columns, of `width` columns.
fn listed(
    line: &[u8],
    first: usize,
    [most, step, width]: [usize; 3],
) -> impl Iterator<Item = Vec<u8>> {
    let types = (0..most).map(move |k| part(line, first + step * k, width).to_vec());
    types.filter(|one| !one.is_empty())
}

fn index(system: System) -> usize {
    usize::from(system == System::Galileo)
}

fn satellite(name: &[u8]) -> Option<Satellite> {
    let (letter, number) = name.split_first()?;
    let number = crate::time::whole(number.trim_ascii())?;
    Some(Satellite {
        system: system(*letter)?,
        number: u8::try_from(number).ok()?,
    })
}

/// Where the observations of one signal on L1 are: the first that has a phase and a code.
fn places(types: &[Vec<u8>]) -> Option<Places> {
    let at = |kind: u8, signal: &[u8]| {
        let wanted = [&[kind], signal].concat();
        types.iter().position(|one| *one == wanted)
    };
    let mut phases = types.iter().filter_map(|one| match one.as_slice() {
        [b'L', signal @ ..] if signal.starts_with(b"1") => Some(signal),
        _ => None,
    });
    phases.find_map(|signal| {
        Some(Places {
            code: at(b'C', signal).or_else(|| at(b'P', signal))?,
            phase: at(b'L', signal)?,
            doppler: at(b'D', signal),
            strength: at(b'S', signal),
        })
    })
}

/// Day, second, flag and number of satellites or lines of the line that begins an epoch.
fn begin(line: &[u8], old: bool) -> Option<(i64, f64, u8, i64)> {
    let (calendar, flag, count) = match old {
        true => (part(line, 0, 26), line.get(28), part(line, 29, 3)),
        false => (
            part(line.strip_prefix(b">")?, 0, 28),
            line.get(31),
            part(line, 32, 3),
        ),
    };
    let flag = flag?.checked_sub(b'0').filter(|flag| *flag <= 6)?;
    let count = crate::time::whole(count).filter(|count| *count <= MOST)?;
    match day_and_second(calendar) {
        Some((day, second)) => Some((day, second, flag, count)),
        // Events may have no time.
        None if flag > 1 && calendar.is_empty() => Some((0, 0.0, flag, count)),
        None => None,
    }
}
