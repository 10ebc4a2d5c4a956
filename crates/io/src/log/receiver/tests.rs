//! Headings by two antennas, against what other libraries read (testdata/golden/formats/headings/make.py).

use super::testing::{Open, golden, headings, table};
use crate::entry::Heading;
use crate::log::{nmea, novatel, sbf, ubx};
use crate::skipped::SkipKind;
use crate::time::WEEK;

fn degrees(heading: &Heading) -> (f64, Option<f64>) {
    let std = heading.std.map(f64::to_degrees);
    (heading.heading.to_degrees(), std)
}

/// As in the table, `kept` of them, and so many that the receiver does not vouch for.
fn as_in_table(open: Open, name: &str, values: &str, kept: usize, doubted: u64) {
    let (found, skipped) = headings(open, &golden(&format!("headings/{name}")), None);
    let expected = table(&format!("headings/{values}.csv"));
    assert_eq!((found.len(), expected.len()), (kept, kept), "{name}");
    assert_eq!(skipped.count(SkipKind::NoFix), doubted, "{name}");
    for (found, row) in found.iter().zip(&expected) {
        let (heading, std) = degrees(found);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
        assert!(
            (found.time - row["time"].unwrap()).abs() < 1e-6,
            "{found:?}"
        );
        assert!(near(heading, row["heading"].unwrap()), "{name} {row:?}");
        let same = std.zip(row["std"]).is_none_or(|(a, b)| near(a, b));
        assert!(same && std.is_some() == row["std"].is_some(), "{row:?}");
    }
}

#[test]
fn of_a_moving_base() {
    as_in_table(ubx::entries, "moving.ubx", "moving", 21, 4);
    as_in_table(ubx::entries, "first.ubx", "first", 22, 3);
}

#[test]
fn of_euler_angles_with_their_covariances() {
    as_in_table(sbf::entries, "attitude.sbf", "attitude", 26, 4);
}

#[test]
fn of_sentences() {
    as_in_table(nmea::entries, "hdt.nmea", "hdt", 18, 2);
    as_in_table(nmea::entries, "ths.nmea", "ths", 18, 2);
    as_in_table(nmea::entries, "pashr.nmea", "pashr", 18, 2);
    as_in_table(nmea::entries, "avr.nmea", "avr", 18, 2);
    // A log with two kinds: the one that comes first, or the one that is asked for.
    let both = [golden("headings/hdt.nmea"), golden("headings/pashr.nmea")].concat();
    let count = |name| headings(nmea::entries, &both, name).0.len();
    assert_eq!([None, Some("HDT"), Some("PASHR")].map(count), [18; 3]);
    let drive = golden("nmea/drive.nmea");
    assert!(
        headings(nmea::entries, &drive, None).0.is_empty(),
        "a course is no heading"
    );
}

#[test]
fn of_the_example_of_the_documentation() {
    for name in ["heading2.asc", "heading2.bin"] {
        let bytes = golden(&format!("headings/{name}"));
        let (found, skipped) = headings(novatel::entries, &bytes, None);
        let [only] = &found[..] else {
            panic!("{found:?}")
        };
        let (heading, std) = degrees(only);
        assert!((only.time % WEEK - 422_892.2).abs() < 1e-6);
        assert!((heading - 178.347_869_873).abs() < 1e-5);
        assert!((std.unwrap() - 0.261_901_051).abs() < 1e-6);
        // The other is of no whole wavelengths.
        assert_eq!(skipped.count(SkipKind::NoFix), 1);
    }
}
