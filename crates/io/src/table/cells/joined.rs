//! One latitude, longitude or time in several columns: degrees, minutes and seconds; year to second; seconds and
//! nanoseconds; and dates and times of day as one number, `20240213140000.5`, `140000.50`.

use super::Beginning;
use crate::number;
use crate::time;

/// Columns that are one value.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    kind: Kind,
    /// The columns, the largest unit first.
    places: Vec<usize>,
    /// The name of the column behind the last; without one the value is put in the first of the places.
    name: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Degrees, minutes and, where there are three, seconds, and with one more the hemisphere.
    Angle {
        hemisphere: bool,
    },
    /// From the year or from the hour to the second, and where there is one more its thousandths.
    Calendar {
        date: bool,
    },
    /// Seconds, and a part of them in so many decimals.
    Fraction {
        decimals: usize,
    },
    /// `yyyymmddhhmmss.s`, `hhmmss.s`, `yyyymmdd` and `ddmmyy`.
    DateTime,
    TimeOfDay,
    Date {
        year_first: bool,
    },
}

const DEGREES: [&str; 7] = ["", "d", "deg", "degs", "degree", "degrees", "dd"];
const MINUTES: [&str; 7] = ["m", "min", "mins", "minute", "minutes", "mm", "arcmin"];
const SECONDS: [&str; 7] = ["s", "sec", "secs", "second", "seconds", "ss", "arcsec"];
/// Year, month, day, hour, minute, second and thousandths of it.
const CALENDAR: [&[&str]; 7] = [
    &["year", "yyyy", "yr", "utcyear", "years"],
    &["month", "mon", "mo", "utcmonth", "months"],
    &["day", "dd", "dom", "utcday", "days", "dayofmonth"],
    &["hour", "hours", "hh", "hr", "h", "utchour"],
    &[
        "minute",
        "minutes",
        "min",
        "mins",
        "m",
        "utcminute",
        "utcmin",
    ],
    &[
        "second",
        "seconds",
        "sec",
        "secs",
        "ss",
        "s",
        "utcsecond",
        "utcsec",
    ],
    &["millisecond", "milliseconds", "msec", "ms", "millis"],
];
/// Parts of a second and their decimals.
const PARTS: [(&str, usize); 12] = [
    ("nsecs", 9),
    ("nsec", 9),
    ("nanosecs", 9),
    ("nanosec", 9),
    ("nanoseconds", 9),
    ("nanos", 9),
    ("usecs", 6),
    ("usec", 6),
    ("microseconds", 6),
    ("msecs", 3),
    ("msec", 3),
    ("milliseconds", 3),
];
const WHOLES: [&str; 4] = ["seconds", "secs", "sec", "s"];

impl Joined {
    pub(super) fn detect(table: &Beginning) -> Vec<Self> {
        let letters = Vec::from_iter(table.names.iter().map(|name| letters(name)));
        let angles = ["lat", "lon"].map(|angle| of_angle(table, &letters, angle));
        let times = calendar(table, &letters).or_else(|| fraction(table, &letters));
        let angles = angles.into_iter().flatten();
        let mut all: Vec<Self> = angles.chain(times).collect();
        if !all.iter().any(|joined| joined.name.is_some()) {
            all.extend(compact(table, &letters));
        }
        all
    }

    /// The name of the column behind the last.
    pub(super) fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Puts the value in the first of its places, unless it has a column of its own.
    pub(super) fn put(&self, cells: &mut [Vec<u8>]) {
        if self.name.is_none()
            && let Some(value) = self.value(cells)
            && let Some(cell) = self.places.first().and_then(|place| cells.get_mut(*place))
        {
            *cell = value;
        }
    }

    /// The cell behind the last, empty where its parts are no time.
    pub(super) fn time(&self, cells: &[Vec<u8>]) -> Option<Vec<u8>> {
        self.name.as_ref()?;
        Some(self.value(cells).unwrap_or_default())
    }

    fn value(&self, cells: &[Vec<u8>]) -> Option<Vec<u8>> {
        let cells = self.places.iter().map(|place| cells.get(*place));
        let cells: Vec<&Vec<u8>> = cells.collect::<Option<_>>()?;
        let texts: Vec<&str> = cells
            .iter()
            .map(|cell| std::str::from_utf8(cell).ok())
            .collect::<Option<_>>()?;
        let whole = |text: &str| {
            let number = number::parse_finite(text.as_bytes())?;
            (number.fract() == 0.0).then_some(number as i64)
        };
        let text = match (self.kind, texts.as_slice()) {
            (Kind::Angle { hemisphere }, [degrees, parts @ ..]) => {
                let sign = if degrees.starts_with('-') { "-" } else { "" };
                let mut text = format!("{sign}{}d", whole(degrees)?.abs());
                let count = parts.len() - usize::from(hemisphere);
                let (parts, behind) = parts.split_at_checked(count)?;
                for (part, mark) in parts.iter().zip(["m", "s"]) {
                    text += &format!("{}{mark}", part.trim_start_matches('-'));
                }
                text + behind.first().copied().unwrap_or_default()
            }
            (Kind::Calendar { date: true }, [year, month, day, time @ ..]) => {
                let date = [whole(year)?, whole(month)?, whole(day)?];
                let [year, month, day] = date;
                let year = if year < 100 { year + 2000 } else { year };
                format!("{year:04}-{month:02}-{day:02}T{}", time_of(time)?)
            }
            (Kind::Calendar { date: false }, time) => time_of(time)?,
            (Kind::Fraction { decimals }, [seconds, part]) => {
                let (seconds, part) = (whole(seconds)?, whole(part)?);
                format!("{seconds}.{part:0decimals$}")
            }
            (Kind::DateTime, [text]) => {
                let (date, time) = text.split_at_checked(8)?;
                format!("{}T{}", dashed(date, true)?, of_day(time)?)
            }
            (Kind::TimeOfDay, [text]) => of_day(text)?,
            (Kind::Date { year_first }, [text]) => dashed(text, year_first)?,
            _ => return None,
        };
        Some(text.into_bytes())
    }
}

/// Hour, minute, second and thousandths as `hh:mm:ss.sss`.
fn time_of(parts: &[&str]) -> Option<String> {
    let number = |text: &&str| number::parse_finite(text.as_bytes());
    let numbers: Vec<f64> = parts.iter().map(number).collect::<Option<_>>()?;
    let (hour, minute, second) = match *numbers.as_slice() {
        [hour, minute, second] => (hour, minute, second),
        [hour, minute, second, thousandths] => (hour, minute, second + thousandths / 1000.0),
        _ => return None,
    };
    let whole = hour.fract() == 0.0 && minute.fract() == 0.0;
    whole.then(|| format!("{hour:02}:{minute:02}:{second:09.6}"))
}

/// `hhmmss.s` as a time of day.
fn of_day(text: &str) -> Option<String> {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    // Leading zeros that a spreadsheet took away.
    let padded = format!("{}{text}", "0".repeat(6_usize.checked_sub(digits)?));
    let at = |range| padded.get(range);
    let time = format!("{}:{}:{}", at(0..2)?, at(2..4)?, padded.get(4..)?);
    time::time_of_day(time.as_bytes()).map(|_| time)
}

/// `yyyymmdd`, or with the year last `ddmmyy`, as a date.
fn dashed(text: &str, year_first: bool) -> Option<String> {
    let date = match year_first {
        true => format!("{}-{}-{}", text.get(..4)?, text.get(4..6)?, text.get(6..8)?),
        false => {
            let padded = format!("{text:0>6}");
            let at = |range| padded.get(range);
            format!("20{}-{}-{}", at(4..6)?, at(2..4)?, at(0..2)?)
        }
    };
    time::date(date.as_bytes(), b'-').map(|_| date)
}

/// The letters of a name, small.
fn letters(name: &str) -> String {
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    letters.map(|c| c.to_ascii_lowercase()).collect()
}

/// Whether all numbers are whole, and within these limits.
fn whole_within(numbers: &[f64], range: std::ops::Range<f64>) -> bool {
    let is = |x: &f64| x.fract() == 0.0 && range.contains(x);
    !numbers.is_empty() && numbers.iter().all(is)
}

/// Degrees, minutes and seconds of a latitude or longitude by their names, where the degrees are whole numbers.
fn of_angle(table: &Beginning, letters: &[String], angle: &str) -> Option<Joined> {
    let rest = |name: &String| -> Option<String> {
        let words = match angle {
            "lat" => ["latitude", "lat", "breite"],
            _ => ["longitude", "lon", "lng"],
        };
        let found = words.iter().find(|word| name.contains(*word))?;
        Some(name.replacen(*found, "", 1))
    };
    let named = |words: &[&str], from: usize| {
        (from..letters.len()).find(|place| {
            let rest = letters.get(*place).and_then(rest);
            rest.is_some_and(|rest| words.contains(&rest.as_str()))
        })
    };
    let degrees = named(&DEGREES, 0)?;
    let minutes = named(&MINUTES, degrees + 1)?;
    let seconds = named(&SECONDS, minutes + 1);
    let within = |place: usize| {
        let numbers = table.numbers(place)?;
        let sixty = numbers.iter().all(|x| (0.0..60.0).contains(&x.abs()));
        sixty.then_some(numbers)
    };
    let whole = whole_within(&table.numbers(degrees)?, -180.0..181.0);
    let minutes_of = within(minutes)?;
    let all = match seconds {
        Some(seconds) => within(seconds).is_some() && whole_within(&minutes_of, -60.0..60.0),
        None => true,
    };
    if !whole || !all {
        return None;
    }
    let mut places = vec![degrees, minutes];
    places.extend(seconds);
    let behind = places.last().map(|last| last + 1)?;
    let mut letters_behind = table.column(behind);
    let is_letter = |cell: &[u8]| crate::angle::hemisphere(cell).is_some();
    let hemisphere = letters_behind.next().is_some_and(is_letter);
    places.extend(hemisphere.then_some(behind));
    Some(Joined {
        kind: Kind::Angle { hemisphere },
        places,
        name: None,
    })
}

/// Year, month, day, hour, minute and second, or the last three alone, by their names and numbers.
fn calendar(table: &Beginning, letters: &[String]) -> Option<Joined> {
    let ranges = [
        0.0..3000.0,
        1.0..13.0,
        1.0..32.0,
        0.0..24.0,
        0.0..60.0,
        0.0..61.0,
        0.0..1000.0,
    ];
    let place = |k: usize| {
        let words = CALENDAR.get(k)?;
        let place = letters
            .iter()
            .position(|name| words.contains(&name.as_str()))?;
        let numbers = table.numbers(place)?;
        let range = ranges.get(k)?.clone();
        let fits = match k {
            5 | 6 => !numbers.is_empty() && numbers.iter().all(|x| range.contains(x)),
            _ => whole_within(&numbers, range),
        };
        fits.then_some(place)
    };
    let time: Vec<usize> = (3..6).map(place).collect::<Option<_>>()?;
    let date: Option<Vec<usize>> = (0..3).map(place).collect();
    let whole = table
        .numbers(*time.last()?)
        .is_some_and(|seconds| whole_within(&seconds, 0.0..61.0));
    let thousandths = place(6).filter(|_| whole);
    let kind = Kind::Calendar {
        date: date.is_some(),
    };
    let mut places = date.unwrap_or_default();
    places.extend(time);
    places.extend(thousandths);
    let named = |place: &usize| table.names.get(*place).map(|name| name.trim());
    let names: Vec<&str> = places.iter().map(named).collect::<Option<_>>()?;
    Some(Joined {
        kind,
        name: Some(names.join(" + ")),
        places,
    })
}

/// Whole seconds and a part of them, by names that differ in these words alone.
fn fraction(table: &Beginning, letters: &[String]) -> Option<Joined> {
    let of_part = |(part, name): (usize, &String)| {
        let known = PARTS.iter().find(|(word, _)| name.ends_with(word));
        let (word, decimals) = known?;
        let stem = name.strip_suffix(word)?;
        let is_whole = |other: &String| {
            let rest = other.strip_prefix(stem);
            rest.is_some_and(|rest| WHOLES.contains(&rest))
        };
        let seconds = letters.iter().position(is_whole)?;
        let fits = whole_within(&table.numbers(seconds)?, 0.0..1e11)
            && whole_within(&table.numbers(part)?, 0.0..10_f64.powi(*decimals as i32));
        let name = |place: usize| table.names.get(place).map(|name| name.trim());
        let name = format!("{} + {}", name(seconds)?, name(part)?);
        fits.then(|| Joined {
            kind: Kind::Fraction {
                decimals: *decimals,
            },
            places: vec![seconds, part],
            name: Some(name),
        })
    };
    letters.iter().enumerate().find_map(of_part)
}

/// Dates and times of day that are one number each, by their names and digits.
fn compact(table: &Beginning, letters: &[String]) -> Vec<Joined> {
    let all = |place: usize, is: &dyn Fn(&str) -> bool| {
        let mut cells = table.column(place);
        cells.clone().next().is_some() && cells.all(|cell| std::str::from_utf8(cell).is_ok_and(is))
    };
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let joined = |kind: Kind, place: usize| Joined {
        kind,
        places: vec![place],
        name: None,
    };
    let date_time = |text: &str| {
        let parts = text.split_at_checked(8);
        let is_both = |(date, time): (&str, &str)| {
            digits(time) == 6 && dashed(date, true).is_some() && of_day(time).is_some()
        };
        digits(text) == 14 && parts.is_some_and(is_both)
    };
    let times = |place: usize| -> Option<Joined> {
        let name = letters.get(place).map_or("", String::as_str);
        let is_utc = name.contains("utc") && !name.contains("date") || name.contains("hhmmss");
        if all(place, &date_time) {
            return Some(joined(Kind::DateTime, place));
        }
        // Seconds of the day have no leading zero, and end at 86400.
        let is_time = |text: &str| of_day(text).is_some();
        let shows = |text: &str| digits(text) == 6 && (text.starts_with('0') || text >= "086400");
        let shows = table
            .column(place)
            .any(|cell| std::str::from_utf8(cell).is_ok_and(shows));
        let is = (is_utc && shows || name.contains("hhmmss")) && all(place, &is_time);
        is.then(|| joined(Kind::TimeOfDay, place))
    };
    let width = table.rows.first().map_or(0, Vec::len);
    let time = (0..width).find_map(times);
    let date = (0..letters.len()).find_map(|place| {
        let name = letters.get(place).filter(|name| name.contains("date"))?;
        let year_first = |text: &str| digits(text) == 8 && dashed(text, true).is_some();
        let year_last = |text: &str| digits(text) == text.len() && dashed(text, false).is_some();
        let beside = time
            .as_ref()
            .is_some_and(|time| time.kind == Kind::TimeOfDay);
        let kind = if all(place, &year_first) {
            Some(Kind::Date { year_first: true })
        } else if (beside || name.contains("ddmmyy")) && all(place, &year_last) {
            Some(Kind::Date { year_first: false })
        } else {
            None
        };
        kind.map(|kind| joined(kind, place))
    });
    time.into_iter().chain(date).collect()
}
