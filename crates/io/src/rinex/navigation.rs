//! Navigation files: broadcast ephemerides.

use undrift_observables::{Ephemerides, Ephemeris, System};

use super::{Header, day_and_second, failure, part, system};
use crate::ReadError;
use crate::number;
use crate::table::lines::Lines;
use crate::time::DAY;

/// Numbers of a record up to the last that is needed: three of the clock, six lines of four.
const NEEDED: usize = 27;
/// Accuracy of a GPS satellite without a prediction \[m\], code 15.
const NO_ACCURACY: f64 = 6144.0;

/// A record as it is being read.
struct Record {
    system: System,
    number: u8,
    /// Second of the week.
    toc: f64,
    numbers: Vec<f64>,
}

/// Adds the ephemerides of a file behind its first line; how many.
pub(super) fn read(
    mut lines: Lines,
    header: &Header,
    ephemerides: &mut Ephemerides,
) -> Result<u64, ReadError> {
    let old = header.version < 3.0;
    let (mut inside, mut wanted) = (false, true);
    let mut count = 0;
    let mut record: Option<Record> = None;
    let mut finish = |record: Option<Record>| {
        if let Some((number, ephemeris)) = record.and_then(|record| ephemeris(&record)) {
            ephemerides.insert(number, ephemeris);
            count += 1;
        }
    };
    while let Some(line) = lines.next_line() {
        if !inside {
            inside = part(line, 60, 20) == b"END OF HEADER";
            continue;
        }
        if line.starts_with(b">") {
            // Version 4: the kind of the next record.
            finish(record.take());
            wanted = line.starts_with(b"> EPH") && matches!(part(line, 10, 4), b"LNAV" | b"INAV");
            continue;
        }
        let begins = match old {
            true => part(line, 0, 2).last().is_some_and(u8::is_ascii_digit),
            false => line.first().is_some_and(u8::is_ascii_alphabetic),
        };
        if begins {
            finish(record.take());
            record = begin(line, header, old).filter(|_| wanted);
        } else if let Some(record) = &mut record {
            let first = if old { 3 } else { 4 };
            record.numbers.extend(numbers(line, first, 4));
        }
    }
    finish(record);
    failure(&lines).map_or(Ok(count), Err)
}

/// The first line of a record; `None` of other systems.
fn begin(line: &[u8], header: &Header, old: bool) -> Option<Record> {
    let (letter, number, first) = match old {
        // A file of GPS has no letter.
        true => (header.system, part(line, 0, 2), 22),
        false => (*line.first()?, part(line, 1, 2), 23),
    };
    let system = match (old, letter) {
        (true, b'E') => System::Galileo,
        (true, _) => System::Gps,
        (false, letter) => system(letter)?,
    };
    let (day, second) = day_and_second(part(line, first - 19, 19))?;
    Some(Record {
        system,
        number: u8::try_from(crate::time::whole(number)?).ok()?,
        toc: day.rem_euclid(7) as f64 * DAY + second,
        numbers: numbers(line, first, 3).collect(),
    })
}

/// Numbers of nineteen columns each; NaN of a text that is no number, 0 of blanks.
fn numbers(line: &[u8], first: usize, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| {
        let text = part(line, first + 19 * k, 19);
        if text.is_empty() {
            return 0.0;
        }
        // Fortran's exponent.
        let byte = |byte: &u8| {
            if matches!(byte, b'D' | b'd') {
                b'E'
            } else {
                *byte
            }
        };
        let text: Vec<u8> = text.iter().map(byte).collect();
        number::parse_finite(&text).unwrap_or(f64::NAN)
    })
}

fn ephemeris(record: &Record) -> Option<(u8, Ephemeris)> {
    let numbers = record.numbers.first_chunk::<NEEDED>()?;
    if numbers.iter().any(|number| number.is_nan()) {
        return None;
    }
    let [
        af0,
        af1,
        af2, //
        issue,
        crs,
        delta_n,
        m0, //
        cuc,
        e,
        cus,
        sqrt_a, //
        toe,
        cic,
        omega0,
        cis, //
        i0,
        crc,
        omega,
        omega_dot, //
        i_dot,
        codes,
        _,
        _, //
        accuracy,
        health,
        tgd,
        tgd_e5b,
    ] = *numbers;
    let (healthy, serves_for, group_delay) = match record.system {
        System::Gps => {
            let longer = record.numbers.get(28).is_some_and(|hours| *hours > 4.0);
            let healthy = health == 0.0 && accuracy < NO_ACCURACY;
            (healthy, if longer { 3.0 } else { 2.0 }, tgd)
        }
        System::Galileo => {
            // Data sources: bit 1 is F/NAV, whose clock is another signal's. Health: bit 0 and 1, 2 are validity and health on E1-B.
            if codes as u32 & 0b10 != 0 {
                return None;
            }
            let healthy = health as u32 & 0b111 == 0 && accuracy >= 0.0;
            (healthy, 4.0, tgd_e5b)
        }
    };
    let ephemeris = Ephemeris {
        system: record.system,
        issue: issue as u16,
        healthy,
        serves_for: serves_for * 3600.0,
        toe,
        toc: record.toc,
        af: [af0, af1, af2],
        group_delay,
        sqrt_a,
        e,
        m0,
        delta_n,
        omega,
        omega0,
        omega_dot,
        i0,
        i_dot,
        cu: [cuc, cus],
        cr: [crc, crs],
        ci: [cic, cis],
    };
    Some((record.number, ephemeris))
}
