//! What must hold for any numbers: their text, tables of them, and tracks in the formats of others.

use std::io::Cursor;
use std::path::Path;

use proptest::prelude::*;
use undrift_io::Opened;
use undrift_io::epoch::{ClockSource, Epoch};
use undrift_io::format::Format;
use undrift_io::gnss::{GnssLog, GnssReader};
use undrift_io::number;
use undrift_io::table::{Column, TableOptions};
use undrift_io::write::solution::SolutionRow;
use undrift_io::write::{SolutionFile, SolutionFormat, SolutionOptions};
use undrift_nav::Vector3;
use undrift_nav::earth::{Geodetic, wrap_pi};
use undrift_nav::sample::{GnssFix, Position};

/// The same cases at every run; PROPTEST_CASES asks for more of them.
fn seeded() -> ProptestConfig {
    ProptestConfig {
        rng_seed: prop::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// A finite number as people and programs write it.
fn written() -> impl Strategy<Value = String> {
    let finite = prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO;
    prop_oneof![
        (finite).prop_map(|x| format!("{x}")),
        (finite).prop_map(|x| format!("{x:e}")),
        (-1e9..1e9f64, 0usize..18).prop_map(|(x, decimals)| format!("{x:.decimals$}")),
        (-1e9..1e9f64, 0usize..18).prop_map(|(x, decimals)| format!("{x:+.decimals$E}")),
        "[+-]?[0-9]{1,22}\\.?[0-9]{0,22}([eE][+-]?[0-9]{1,2})?",
        "[+-]?\\.[0-9]{1,22}",
    ]
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn a_number_is_read_as_the_standard_library_reads_it(text in written(), behind in "[,; \tx]?") {
        let exact: f64 = text.parse().unwrap();
        prop_assert_eq!(number::parse(text.as_bytes()).map(f64::to_bits), Some(exact.to_bits()), "{}", text);
        let (value, length) = number::parse_prefix(format!("{text}{behind}").as_bytes()).unwrap();
        prop_assert_eq!((value.to_bits(), length), (exact.to_bits(), text.len()));
    }

    #[test]
    fn what_is_no_number_to_the_standard_library_is_none_here(text in "[-+.eE0-9 naif_x]{0,8}|\\PC{0,6}") {
        let expected = text.parse::<f64>().ok();
        let found = number::parse(text.as_bytes());
        prop_assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits), "{:?}", text);
    }

    #[test]
    fn a_table_in_any_dress_has_the_same_numbers(
        rows in prop::collection::vec(prop::collection::vec(written(), 4), 1..20),
        delimiter in prop::sample::select(vec![",", ";", "\t", " ", ", ", "   "]),
        end in prop::sample::select(vec!["\n", "\r\n"]), last_end in any::<bool>(),
        header in any::<bool>(), blank_lines in any::<bool>(), quoted in any::<bool>(),
        order in Just([1usize, 2, 3, 4]).prop_shuffle(),
    ) {
        let quote = if quoted && !delimiter.starts_with(' ') { "\"" } else { "" };
        let mut text = String::new();
        if header {
            text += &["a", "b", "c", "d"].join(delimiter);
            text += end;
        }
        for row in &rows {
            let fields: Vec<String> = row.iter().map(|field| format!("{quote}{field}{quote}")).collect();
            text += &fields.join(delimiter);
            text += end;
            if blank_lines { text += end; }
        }
        if !last_end { text.truncate(text.trim_end().len()); }
        let column = |number: usize| match header {
            true => Column::Name(["a", "b", "c", "d"][number - 1].into()),
            false => Column::Number(number),
        };
        let options = TableOptions {
            columns: order.iter().map(|number| ("key".into(), column(*number))).collect(),
            ..TableOptions::default()
        };
        let mut table = Opened::stream(Path::new("text"), Cursor::new(text.clone()))
            .and_then(|opened| opened.table(&options))
            .map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        let mut found = [0.0; 4];
        let finite = |row: &&Vec<String>| order.iter().all(|n| row[n - 1].parse::<f64>().unwrap().is_finite());
        prop_assume!(rows.iter().any(|row| finite(&row)));
        for row in rows.iter().filter(finite) {
            let line = table.next_row(&mut found).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
            prop_assert!(line.is_some(), "{text}");
            for (value, number) in found.iter().zip(&order) {
                prop_assert_eq!(value.to_bits(), row[number - 1].parse::<f64>().unwrap().to_bits(), "{}", text);
            }
        }
        prop_assert_eq!(table.next_row(&mut found).unwrap(), None);
    }
}

/// An angle [deg] up to `most`, often at a whole degree or minute or next to one.
fn angle(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        -most..most,
        (-1.0..1.0f64, -1e-9..1e-9f64).prop_map(move |(part, off)| (part * most).trunc() + off),
        (-1.0..1.0f64, -1e-9..1e-9f64)
            .prop_map(move |(part, off)| (part * most * 60.0).trunc() / 60.0 + off),
    ]
}

prop_compose! {
    fn track()(
        week in 100u32..5000, start in 0.0..604_700.0f64,
        rows in prop::collection::vec(
            (0.01..30.0f64, angle(89.9), angle(180.0), -400.0..20_000.0f64, prop::array::uniform3(0.01..90.0f64)),
            1..12,
        ),
    ) -> (u32, Vec<SolutionRow>) {
        let mut time = start;
        let row = |(step, lat, lon, height, std): (f64, f64, f64, f64, [f64; 3])| {
            time += step;
            let mut row = SolutionRow::at(time, Geodetic::from_degrees(lat, lon, height));
            row.v_n = Vector3::new(1.0, -2.0, 0.0);
            row.nav_std[..3].copy_from_slice(&std);
            row
        };
        (week, rows.into_iter().map(row).collect())
    }
}

fn read_back(format: SolutionFormat, log: Format, week: u32, rows: &[SolutionRow]) -> Vec<GnssFix> {
    let options = SolutionOptions {
        epoch: Some(Epoch::of_week(week, ClockSource::Gnss)),
        name: "a <track> & more".into(),
        every: Some(0.0),
        frame: None,
    };
    let mut file = SolutionFile::new(Cursor::new(Vec::new()), format, &options).unwrap();
    for row in rows {
        file.write(row, false).unwrap();
    }
    let path = std::env::temp_dir().join(format!(
        "undrift-io-properties-{}-{}",
        std::process::id(),
        format.name()
    ));
    std::fs::write(&path, file.into_inner().unwrap().into_inner()).unwrap();
    let mut options = GnssLog::new(log);
    options.fixes.position_std = (log == Format::Gpx).then_some([1.0; 3]);
    let fixes = GnssReader::open(&path, &options.into())
        .unwrap()
        .map(Result::unwrap)
        .collect();
    std::fs::remove_file(&path).unwrap();
    fixes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..seeded() })]

    #[test]
    fn a_track_anywhere_at_any_date_comes_back_from_the_formats_of_others((week, rows) in track()) {
        for (format, log, angle) in [
            // A unit of the last decimal: 1e-7 of a minute, 1e-9 of a degree.
            (SolutionFormat::Nmea, Format::Nmea, (1e-7 / 60.0f64).to_radians()),
            (SolutionFormat::Gpx, Format::Gpx, 1e-9f64.to_radians()),
        ] {
            let fixes = read_back(format, log, week, &rows);
            prop_assert_eq!(fixes.len(), rows.len());
            for (fix, row) in fixes.iter().zip(&rows) {
                // Milliseconds.
                prop_assert!((fix.time - row.time).abs() < 6e-4, "{} {}", fix.time, row.time);
                let Some((Position::Geodetic(place), covariance)) = fix.position else {
                    return Err(TestCaseError::fail("no position"));
                };
                prop_assert!((place.lat - row.position.lat).abs() < angle, "{place:?} {row:?}");
                prop_assert!(wrap_pi(place.lon - row.position.lon).abs() < angle, "{place:?} {row:?}");
                prop_assert!((place.height - row.position.height).abs() < 6e-4);
                for axis in (0..3).filter(|_| log == Format::Nmea) {
                    prop_assert!((covariance[(axis, axis)].sqrt() - row.nav_std[axis]).abs() < 6e-4);
                }
            }
        }
    }
}
