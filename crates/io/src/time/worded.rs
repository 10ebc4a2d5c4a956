//! Dates with the name of the month: `Tue Feb 13 14:00:00.5 2024`, `Tue, 13 Feb 2024 14:00:00 GMT`, `Feb 13, 2024 2:00:00 PM`.

use super::{day_of, time_of_day, whole};

const MONTHS: [&str; 12] = [
    "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
];

/// The number of a month by its name or the first three letters of it, in English.
pub(super) fn month(name: &[u8]) -> Option<i64> {
    let letters = name.iter().all(u8::is_ascii_alphabetic);
    let start = name.get(..3).filter(|_| letters && name.len() <= 9)?;
    let found = MONTHS
        .iter()
        .position(|month| start.eq_ignore_ascii_case(month.as_bytes()));
    found.map(|place| place as i64 + 1)
}

/// The day, from the GPS epoch, the time of day \[s\] and the offset of the zone \[s\] of a date with the name of a month.
pub(super) fn date_time(text: &[u8]) -> Option<(i64, f64, f64)> {
    let words = text.split(|byte| matches!(byte, b' ' | b',' | b'\t'));
    let (mut month_of, mut numbers, mut time) = (None, Vec::new(), None);
    let (mut half, mut offset) = (None, 0.0);
    for word in words.filter(|word| !word.is_empty()) {
        if word.contains(&b':') {
            time = Some(word);
        } else if let Some(number) = whole(word) {
            numbers.push(number);
        } else if matches!(word, b"AM" | b"am" | b"PM" | b"pm") {
            half = Some(word);
        } else if let [b'+' | b'-', zone @ ..] = word {
            let (hours, minutes) = zone.split_at_checked(2)?;
            let minutes = minutes.strip_prefix(b":").unwrap_or(minutes);
            let size = (whole(hours)? * 3600 + whole(minutes)? * 60) as f64;
            offset = if word.starts_with(b"-") { -size } else { size };
        } else if let Some(number) = month(word) {
            month_of.get_or_insert(number);
        }
    }
    let (day, year) = match *numbers.as_slice() {
        [day, year] if year > 31 => (day, year),
        [year, day] if year > 31 => (day, year),
        _ => return None,
    };
    let mut time = time?.to_vec();
    time.extend(half.unwrap_or_default());
    Some((day_of(year, month_of?, day)?, time_of_day(&time)?, offset))
}

#[cfg(test)]
mod tests {
    use super::super::WeekClock;

    #[test]
    fn months_may_be_names() {
        // 8 July 2025, 19:34:00 UTC.
        for text in [
            "Tue Jul  8 19:34:00 2025",
            "Tue Jul 08 19:34:00 UTC 2025",
            "Tue, 08 Jul 2025 19:34:00 GMT",
            "Tue, 8 July 2025 20:34:00 +0100",
            "Jul 8, 2025 7:34:00 PM",
            "8-Jul-2025 19:34:00",
            "08/Jul/2025 19:34:00",
            "2025-Jul-08 19:34:00",
        ] {
            let found = WeekClock::default().date_time(text.as_bytes());
            assert_eq!(found, Some(243_258.0), "{text}");
        }
        for text in [
            "Tue Jul 32 19:34:00 2025",
            "Tue Jux 8 19:34:00 2025",
            "Tue Jul 8 2025",
            "8 9 10 19:34:00",
            "Jul 8 19:34:00",
        ] {
            assert_eq!(
                WeekClock::default().date_time(text.as_bytes()),
                None,
                "{text}"
            );
        }
    }
}
