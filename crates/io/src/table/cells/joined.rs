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
    Date(Order),
    /// An acceleration without gravity, and gravity.
    Sum,
}

/// Where the year is in a date without separators, `yyyymmdd`, `yymmdd` or `ddmmyy`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    Year,
    ShortYear,
    Day,
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
/// The same of whole seconds directly before their part.
const BEFORE: [&str; 7] = ["t", "time", "timestamp", "unix", "unixtime", "epoch", "utc"];

impl Joined {
    pub(super) fn detect(table: &Beginning) -> Vec<Self> {
        let letters = Vec::from_iter(table.names.iter().map(|name| letters(name)));
        let angles = ["lat", "lon"].map(|angle| of_angle(table, &letters, angle));
        let times = calendar(table, &letters).or_else(|| fraction(table, &letters));
        let times = times.or_else(|| fraction_beside(table, &letters));
        let angles = angles.into_iter().flatten();
        let mut all: Vec<Self> = angles.chain(times).collect();
        if !all.iter().any(|joined| joined.name.is_some()) {
            all.extend(compact(table, &letters));
        }
        all.extend(sums(table, &letters));
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
                format!("{}T{}", dashed(date, Order::Year)?, of_day(time)?)
            }
            (Kind::TimeOfDay, [text]) => of_day(text)?,
            (Kind::Date(order), [text]) => dashed(text, order)?,
            (Kind::Sum, [one, other]) => {
                let number = |text: &&str| number::parse_finite(text.as_bytes());
                format!("{:.9}", number(one)? + number(other)?)
            }
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

/// `hhmmss.s`, or without the point `hhmmsscc` with hundredths of a second, as a time of day.
pub(crate) fn of_day(text: &str) -> Option<String> {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    let hundredths = matches!(digits, 7 | 8) && digits == text.len();
    // Leading zeros that a spreadsheet took away.
    let whole = if hundredths { 8 } else { 6 };
    let padded = format!("{}{text}", "0".repeat(usize::checked_sub(whole, digits)?));
    let at = |range| padded.get(range);
    let mut time = format!("{}:{}:{}", at(0..2)?, at(2..4)?, padded.get(4..)?);
    if hundredths {
        time.insert(time.len() - 2, '.');
    }
    time::time_of_day(time.as_bytes()).map(|_| time)
}

/// `yyyymmdd`, `yymmdd` or `ddmmyy` as a date.
fn dashed(text: &str, order: Order) -> Option<String> {
    let padded = format!("{text:0>6}");
    let [long, short] = [text, padded.as_str()].map(|text| move |range| text.get(range));
    let date = match order {
        Order::Year => format!("{}-{}-{}", long(0..4)?, long(4..6)?, long(6..8)?),
        Order::ShortYear => format!("20{}-{}-{}", short(0..2)?, short(2..4)?, short(4..6)?),
        Order::Day => format!("20{}-{}-{}", short(4..6)?, short(2..4)?, short(0..2)?),
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
            digits(time) == 6 && dashed(date, Order::Year).is_some() && of_day(time).is_some()
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
        // With a date of digits beside it.
        let beside = name == "time" && letters.iter().any(|other| other == "date");
        let dated = |place: usize| {
            let orders = [Order::Year, Order::ShortYear, Order::Day];
            orders
                .iter()
                .any(|order| all(place, &|text| is_date(text, *order)))
        };
        let dated =
            beside && (0..letters.len()).any(|place| letters[place] == "date" && dated(place));
        let is = (is_utc && shows || name.contains("hhmmss") || dated) && all(place, &is_time);
        is.then(|| joined(Kind::TimeOfDay, place))
    };
    let width = table.rows.first().map_or(0, Vec::len);
    let time = (0..width).find_map(times);
    let date = (0..letters.len()).find_map(|place| {
        let name = letters.get(place).filter(|name| name.contains("date"))?;
        let beside = time
            .as_ref()
            .is_some_and(|time| time.kind == Kind::TimeOfDay);
        let is = |order| all(place, &|text| is_date(text, order));
        // Of this century's receivers.
        let recent = |order| {
            let mut cells = table.column(place);
            cells.all(|cell| {
                let date = std::str::from_utf8(cell)
                    .ok()
                    .and_then(|text| dashed(text, order));
                date.is_some_and(|date| ("2010".."2045").contains(&&date[..4]))
            })
        };
        let short = [Order::Day, Order::ShortYear]
            .into_iter()
            .filter(|order| is(*order));
        let short = Vec::from_iter(short);
        let order = match is(Order::Year) {
            true => Some(Order::Year),
            false if beside || name.contains("ddmmyy") => {
                let likely = short.iter().find(|order| recent(**order));
                likely.or(short.first()).copied()
            }
            false => None,
        };
        let kind = order.map(Kind::Date);
        kind.map(|kind| joined(kind, place))
    });
    time.into_iter().chain(date).collect()
}

/// Whether a text is a date of digits alone.
fn is_date(text: &str, order: Order) -> bool {
    let digits = text.bytes().all(|byte| byte.is_ascii_digit());
    let length = match order {
        Order::Year => text.len() == 8,
        Order::ShortYear => text.len() == 6,
        Order::Day => (1..=6).contains(&text.len()),
    };
    digits && length && dashed(text, order).is_some()
}

/// Whole seconds, and in the next column the fraction of a second, which wraps when the seconds increase.
fn fraction_beside(table: &Beginning, letters: &[String]) -> Option<Joined> {
    let of_part = |part: usize| {
        let seconds = part.checked_sub(1)?;
        let (whole, name) = (letters.get(seconds)?, letters.get(part)?);
        let words = PARTS.iter().chain(&[("us", 6), ("ns", 9), ("ms", 3)]);
        let (_, decimals) = words.clone().find(|(word, _)| word == name)?;
        let (wholes, parts) = (table.numbers(seconds)?, table.numbers(part)?);
        let fits = whole_within(&wholes, 0.0..1e11)
            && whole_within(&parts, 0.0..10_f64.powi(*decimals as i32));
        let steps = wholes.windows(2).zip(parts.windows(2));
        let mut restarts = steps.clone().filter(|(_, part)| part[1] < part[0]);
        let restarts =
            restarts.clone().next().is_some() && restarts.all(|(whole, _)| whole[1] > whole[0]);
        let name = |place: usize| table.names.get(place).map(|name| name.trim());
        let name = format!("{} + {}", name(seconds)?, name(part)?);
        (BEFORE.contains(&whole.as_str()) && fits && restarts).then(|| Joined {
            kind: Kind::Fraction {
                decimals: *decimals,
            },
            places: vec![seconds, part],
            name: Some(name),
        })
    };
    (1..letters.len()).find_map(of_part)
}

/// Accelerations of a phone in two parts, that of the user and gravity, as their sum, where the whole is in no column.
fn sums(table: &Beginning, letters: &[String]) -> Vec<Joined> {
    let whole = |name: &String| name.starts_with("acc") || name.contains("accelerometer");
    if letters.iter().any(whole) {
        return Vec::new();
    }
    let of_axis = |axis: char| {
        let place = |words: [&str; 2]| {
            let is = |name: &String| {
                let mut ends = words.iter().filter_map(|word| name.split_once(*word));
                ends.any(|(_, end)| end.starts_with(axis))
            };
            letters.iter().position(is)
        };
        let own = place(["useracceleration", "useracc"])?;
        let gravity = place(["gravity", "grav"])?;
        let name = table.names.get(own)?;
        let unit = name.find(['(', '[']).and_then(|at| name.get(at..));
        table.numbers(own).and(table.numbers(gravity))?;
        Some(Joined {
            kind: Kind::Sum,
            places: vec![own, gravity],
            name: Some(format!("acceleration_{axis} {}", unit.unwrap_or_default())),
        })
    };
    let all: Option<Vec<Joined>> = ['x', 'y', 'z'].into_iter().map(of_axis).collect();
    all.unwrap_or_default()
}
