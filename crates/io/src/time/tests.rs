use super::*;

fn seconds(first: &str, second: &str, system: TimeSystem) -> Option<f64> {
    WeekClock::default().seconds(first.as_bytes(), second.as_bytes(), system)
}

/// One rounding of a number of 6e5 s is 6e-11 s.
const ROUNDING_S: f64 = 2e-10;

#[test]
fn known_dates() {
    // 8 July 2025 is a Tuesday of GPS week 2374.
    let tuesday = seconds("2025/07/08", "19:34:18.499", TimeSystem::Gps).unwrap();
    assert!((tuesday - 243_258.499).abs() < ROUNDING_S, "{tuesday}");
    assert_eq!(date(b"2025/07/08", b'/').unwrap().div_euclid(7), 2374);
    assert_eq!(date(b"1980/01/06", b'/'), Some(0));
    assert_eq!(
        date(b"2000/03/01", b'/').unwrap() - date(b"2000/02/28", b'/').unwrap(),
        2
    );
    assert_eq!(
        seconds("2374", "243258.5", TimeSystem::Gps),
        Some(243_258.5)
    );
    let utc = seconds("2025/07/08", "19:34:00", TimeSystem::Utc).unwrap();
    assert_eq!(utc, 243_258.0);
    assert_eq!(
        seconds("2025/07/09", "04:34:00", TimeSystem::Jst),
        Some(utc)
    );
    assert_eq!(
        (
            leap_seconds(0),
            leap_seconds(date(b"2016/12/31", b'/').unwrap())
        ),
        (0.0, 17.0)
    );
}

#[test]
fn counts_on_past_the_end_of_the_week() {
    let mut weeks = WeekClock::default();
    let mut at =
        |date: &str, time: &str| weeks.seconds(date.as_bytes(), time.as_bytes(), TimeSystem::Gps);
    assert_eq!(at("2025/07/12", "23:59:59.5"), Some(604_799.5));
    assert_eq!(at("2025/07/13", "00:00:00.5"), Some(604_800.5));
    assert_eq!(at("2375", "1"), Some(604_801.0));
    // UTC late on a Saturday is GPS time of the next week.
    let late = seconds("2025/07/12", "23:59:50", TimeSystem::Utc);
    assert_eq!(late, Some(8.0));
}

#[test]
fn utc_dates_and_unix_times_agree() {
    let mut weeks = WeekClock::default();
    // 8 July 2025 19:34:00 UTC, by `date -u -d 2025-07-08T19:34:00 +%s`.
    assert_eq!(weeks.unix(1_752_003_240, 500_000_000), 243_258.5);
    assert_eq!(weeks.utc(2025, 7, 8, 70_440.5), Some(243_258.5));
    assert_eq!(weeks.utc(2025, 7, 32, 0.0), None);
    assert_eq!(weeks.unix(12, 250_000_000), 12.25);
}

#[test]
fn dates_go_both_ways() {
    for day in 0..80_000 {
        let [year, month, of_month] = Utc { day, milli: 0 }.date();
        assert_eq!(day_of(year, month, of_month), Some(day));
    }
    for (year, month, day) in [(2025, 2, 29), (2100, 2, 29), (2025, 2, 31), (2025, 4, 31)] {
        assert_eq!(day_of(year, month, day), None, "{year}-{month}-{day}");
    }
    assert!(day_of(2024, 2, 29).is_some() && day_of(2000, 2, 29).is_some());
}

#[test]
fn dates_that_end_with_the_year() {
    let times = |texts: &[&str]| -> Vec<Option<f64>> {
        let mut weeks = WeekClock::default();
        let all = texts.iter().map(|text| weeks.date_time(text.as_bytes()));
        all.collect()
    };
    // 8 July 2025, 19:34:00 UTC.
    let expected = Some(243_258.0);
    for text in [
        "08.07.2025 19:34:00",
        "8.7.2025 19:34:00",
        "08/07/2025 19:34:00",
        "08-07-2025T19:34:00Z",
        "8/7/2025, 19:34:00",
        "7/8/2025, 7:34:00 PM",
        "07/08/2025 07:34:00 pm",
    ] {
        assert_eq!(times(&[text]), [expected], "{text}");
    }
    // ISO 8601 allows the comma.
    for text in [
        "2025-07-08T19:34:00,75Z",
        "8.7.2025 19:34:00,75",
        "7/8/2025, 7:34:00,75 PM",
    ] {
        let found = times(&[text])[0].unwrap();
        assert!((found - 243_258.75).abs() < ROUNDING_S, "{text}: {found}");
    }
    // A day beyond 12 settles it, for those behind it too.
    let friday = times(&["07/13/2025 00:00:00", "07/08/2025 00:00:00"]);
    assert_eq!(friday[0].unwrap() - friday[1].unwrap(), 5.0 * DAY);
    let friday = times(&["13/07/2025 12:00:00 AM", "08/07/2025 12:00:00 AM"]);
    assert_eq!(friday[0].unwrap() - friday[1].unwrap(), 5.0 * DAY);
    for wrong in [
        "13.13.2025 00:00:00",
        "1.2.25 00:00:00",
        "07/08/2025 13:00:00 PM",
    ] {
        assert_eq!(times(&[wrong]), [None], "{wrong}");
    }
    assert_eq!(time_of_day(b"12:00:01 AM"), Some(1.0));
    assert_eq!(time_of_day(b"12:00:01 PM"), Some(43_201.0));
    assert_eq!(time_of_day(b"0:00:01 PM"), None);
    assert_eq!(time_of_day(b"19:34:18:250"), Some(70_458.25));
    assert_eq!(time_of_day(b"75:18.25"), Some(4518.25));
    assert_eq!(time_of_digits(123_456.5), Some(45_296.5));
    assert_eq!(time_of_digits(12_345_650.0), Some(45_296.5));
    assert_eq!(time_of_digits(126_000.0), None);
    assert_eq!(day_of_digits(141_123.0), date(b"2023/11/14", b'/'));
    assert_eq!(day_of_digits(20_231_114.0), day_of_digits(141_123.0));
    assert_eq!(
        (day_of_digits(20_231_314.0), day_of_digits(141_323.0)),
        (None, None)
    );
    let compact = WeekClock::default().date_time(b"20231114T221320.5Z");
    assert_eq!(
        compact,
        WeekClock::default().date_time(b"2023-11-14T22:13:20.5Z")
    );
    assert!(compact.is_some());
    for wrong in ["19:34", "19:34:18:25", "19:34:18:250:1", "1:61.5"] {
        assert_eq!(time_of_day(wrong.as_bytes()), None, "{wrong}");
    }
    assert_eq!(times(&["2025-07-08T20:34:00.0 +0100"]), [expected]);
}

#[test]
fn what_is_no_time() {
    for (first, second) in [
        ("2025/13/08", "00:00:00"),
        ("2025/07", "00:00:00"),
        ("2025/07/08/1", "00:00:00"),
        ("2025/07/08", "24:00:00"),
        ("2025/07/08", "00:61:00"),
        ("2025/07/08", "00:00:nan"),
        ("2025/07/08", ""),
        ("2374.5", "1"),
        ("-1", "1"),
        ("2374", "inf"),
        ("", ""),
    ] {
        assert_eq!(
            seconds(first, second, TimeSystem::Gps),
            None,
            "{first} {second}"
        );
    }
}
