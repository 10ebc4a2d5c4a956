//! The solution in the formats of others, read back; `testdata/golden/formats/written/check.py` reads
//! the same bytes with the fields' own readers.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use quick_xml::events::Event;
use undrift_io::Opened;
use undrift_io::epoch::{ClockSource, Epoch};
use undrift_io::table::Column;
use undrift_io::truth::{TruthFormat, TruthReader};
use undrift_io::write::solution::SolutionRow;
use undrift_io::write::{SolutionFile, SolutionFormat, SolutionOptions};
use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;

const NAME: &str = "Harbour <1> & \"back\"";
/// GPS week 2374; it ends during the track.
const WEEK: u32 = 2374;
const START: f64 = 604_794.0;
const STEP: f64 = 0.05;
const ROWS: u32 = 241;

fn time(k: u32) -> f64 {
    START + STEP * f64::from(k)
}

fn outage(k: u32) -> bool {
    (80..160).contains(&k)
}

fn row(k: u32) -> SolutionRow {
    let x = f64::from(k);
    let angle = |degrees: f64| degrees.to_radians();
    SolutionRow {
        time: time(k),
        position: Geodetic::from_degrees(-33.86 + 1e-6 * x, 151.2 - 2e-6 * x, 25.0 + 0.01 * x),
        v_n: Vector3::new(2.0, -3.5, 0.25),
        rpy: Vector3::new(angle(1.5), angle(-2.25), angle(-60.0)),
        nav_std: [0.5, 0.75, 1.25, 0.1, 0.1, 0.1, 0.01, 0.01, 0.02],
        ..SolutionRow::at(0.0, Geodetic::from_degrees(0.0, 0.0, 0.0))
    }
}

fn options() -> SolutionOptions {
    SolutionOptions {
        epoch: Some(Epoch::of_week(WEEK, ClockSource::Gnss)),
        name: NAME.into(),
        every: None,
        frame: None,
    }
}

fn text_of(
    rows: impl Iterator<Item = (SolutionRow, bool)>,
    format: SolutionFormat,
    options: &SolutionOptions,
) -> String {
    let mut file = SolutionFile::new(Cursor::new(Vec::new()), format, options).unwrap();
    for (row, outage) in rows {
        file.write(&row, outage).unwrap();
    }
    String::from_utf8(file.into_inner().unwrap().into_inner()).unwrap()
}

fn track() -> impl Iterator<Item = (SolutionRow, bool)> {
    (0..ROWS).map(|k| (row(k), outage(k)))
}

fn written(format: SolutionFormat) -> String {
    text_of(track(), format, &options())
}

const TEXTS: [(SolutionFormat, &str); 5] = [
    (SolutionFormat::KfGins, "track.nav"),
    (SolutionFormat::Nmea, "track.nmea"),
    (SolutionFormat::Kml, "track.kml"),
    (SolutionFormat::GeoJson, "track.geojson"),
    (SolutionFormat::Gpx, "track.gpx"),
];

fn golden(name: &str) -> PathBuf {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../testdata/golden/formats/written"
    );
    Path::new(folder).join(name)
}

/// The bytes that `check.py` has read. `UNDRIFT_BLESS=1` writes them; then run `check.py`.
#[test]
fn equal_to_what_was_checked() {
    for (format, name) in TEXTS {
        let text = written(format);
        if std::env::var_os("UNDRIFT_BLESS").is_some() {
            std::fs::write(golden(name), &text).unwrap();
        }
        let checked = std::fs::read_to_string(golden(name)).unwrap();
        assert!(text == checked, "{name} is written differently");
    }
}

#[test]
fn kf_gins_reads_back() {
    // Without a week, the time goes on past the end of the week.
    let mut options = options();
    options.epoch = None;
    let text = text_of(track(), SolutionFormat::KfGins, &options);
    let group = |from: usize| [0, 1, 2].map(|k| Column::Number(from + k));
    let format = TruthFormat {
        velocity: Some(group(6)),
        attitude: Some(group(9)),
        ..TruthFormat::degrees(Column::Number(2), group(3))
    };
    let source = Box::new(Cursor::new(text.into_bytes()));
    let opened = Opened::stream(Path::new("track.nav"), source).unwrap();
    let reader = TruthReader::new(opened, &format.into()).unwrap();
    let samples: Vec<_> = reader.map(Result::unwrap).collect();
    assert_eq!(samples.len(), ROWS as usize);
    for (sample, k) in samples.iter().zip(0..) {
        let (row, back) = (row(k), &sample.position);
        // Half the last digit written, and the rounding of six digits before the point.
        assert!((sample.time - row.time).abs() < 6e-7);
        assert!((back.lat - row.position.lat).to_degrees().abs() < 1e-11);
        assert!((back.lon - row.position.lon).to_degrees().abs() < 1e-10);
        assert!((back.height - row.position.height).abs() < 6e-5);
        assert!((sample.v_n.unwrap() - row.v_n).norm() < 1e-5);
        let turned = row.rpy + Vector3::new(0.0, 0.0, std::f64::consts::TAU);
        assert!((sample.rpy.unwrap() - turned).norm().to_degrees() < 1e-8);
    }
    let text = written(SolutionFormat::KfGins);
    assert!(text.starts_with("2374 604794.000000 -33.86000000000 151.20000000000 25.0000 "));
    assert!(text.lines().nth(120).unwrap().starts_with("2375 0.000000 "));
    assert!(text.lines().all(|line| line.split(' ').count() == 11));
}

#[test]
fn sentences_have_their_checksums() {
    let text = written(SolutionFormat::Nmea);
    assert!(text.ends_with("\r\n"));
    let mut kinds = [0; 4];
    for line in text.trim_end().split("\r\n") {
        let (body, sum) = line.strip_prefix('$').unwrap().split_once('*').unwrap();
        let expected = body.bytes().fold(0, |sum, byte| sum ^ byte);
        assert_eq!(u8::from_str_radix(sum, 16).unwrap(), expected, "{line}");
        assert!(line.len() <= 80, "NMEA 0183: 82 characters with CR LF");
        let kind = ["RMC", "GGA", "GST", "HDT"].map(|kind| body.starts_with(&format!("GN{kind},")));
        kinds[kind.iter().position(|is| *is).unwrap()] += 1;
    }
    // Ten a second of twelve seconds, and the end.
    assert_eq!(kinds, [121; 4]);
    // GPS second 604794 of the week is Saturday 23:59:54, less 18 s; 2 m/s north and −3.5 east.
    let first = text.lines().next().unwrap();
    let expected = "$GNRMC,235936.000,A,3351.6000000,S,15112.0000000,E,7.836,299.74,120725,,,A*";
    assert!(first.starts_with(expected), "{first}");
    assert!(text.contains(",6,00,,25.800,M,0.0,M,,*") && text.contains(",1,04,,"));
    assert!(text.contains("$GNHDT,300.000,T*"));
    assert!(text.contains("$GNGST,235936.000,,,,,0.500,0.750,1.250*"));
    // A clock without a date, and an arc that rounds up to the next degree.
    let place = Geodetic::from_degrees(9.999_999_999_9, -0.000_000_000_1, 0.0);
    let rows = [(SolutionRow::at(3661.0, place), false)].into_iter();
    let text = text_of(rows, SolutionFormat::Nmea, &SolutionOptions::default());
    let rmc = "$GNRMC,010101.000,A,1000.0000000,N,00000.0000000,W,,,,,,A*";
    assert!(text.starts_with(rmc), "{text}");
    assert_eq!(text.lines().count(), 2);
}

/// Texts of the elements of that name.
fn elements(xml: &str, name: &str) -> Vec<String> {
    let mut reader = quick_xml::Reader::from_str(xml);
    let (mut all, mut inside) = (Vec::new(), false);
    loop {
        match reader.read_event().unwrap() {
            Event::Start(tag) if tag.name().as_ref() == name => {
                inside = true;
                all.push(String::new());
            }
            Event::End(tag) if tag.name().as_ref() == name => inside = false,
            Event::Text(text) if inside => {
                let last = all.last_mut().unwrap();
                *last += &text;
            }
            Event::GeneralRef(entity) if inside => {
                let last = all.last_mut().unwrap();
                *last += &format!("&{};", &*entity);
            }
            Event::Eof => return all,
            _ => {}
        }
    }
}

fn numbers(text: &str) -> Vec<f64> {
    text.split([',', ' ', '\n'])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect()
}

#[test]
fn kml_has_a_line_for_each_span() {
    let mut options = options();
    options.epoch = None;
    let text = text_of(track(), SolutionFormat::Kml, &options);
    let names = elements(&text, "name");
    assert_eq!(names[0], "Harbour &lt;1&gt; &amp; &quot;back&quot;");
    assert_eq!(names[4], "Without GNSS from 604798.0 s");
    // A line, and an ellipse at each of its ends.
    let styles = ["#gnss", "#no-gnss", "#gnss"].map(|style| vec![style.to_owned(); 3]);
    assert_eq!(elements(&text, "styleUrl"), styles.concat());
    let lines: Vec<Vec<f64>> = elements(&text, "coordinates")
        .iter()
        .step_by(3)
        .map(|line| numbers(line))
        .collect();
    // Every other row; the ends of the spans are both theirs.
    assert_eq!(
        lines.iter().map(Vec::len).collect::<Vec<_>>(),
        [123, 123, 123]
    );
    assert_eq!(lines[0][..3], [151.2, -33.86, 25.0]);
    assert_eq!(lines[0][120..], lines[1][..3]);
    assert_eq!(lines[1][120..], lines[2][..3]);
    assert_eq!(lines[1][..3], [151.199_84, -33.859_92, 25.8]);
    assert!(elements(&text, "when").is_empty());
}

#[test]
fn kml_has_instants_where_the_date_is_known() {
    let text = written(SolutionFormat::Kml);
    let (instants, places) = (elements(&text, "when"), elements(&text, "gx:coord"));
    assert_eq!((instants.len(), places.len()), (123, 123));
    // As GPX: GPS second 604794 of the week is Saturday 23:59:54, less 18 s.
    assert_eq!(instants[0], "2025-07-12T23:59:36.000Z");
    assert_eq!(instants[122], "2025-07-12T23:59:48.000Z");
    assert_eq!(numbers(&places[0].replace(' ', ",")), [151.2, -33.86, 25.0]);
    // Tracks have so many points, and all of them are there.
    let rows = (0..2500).map(|k| (row(k), false));
    let every = SolutionOptions {
        every: Some(0.0),
        ..options()
    };
    let text = text_of(rows, SolutionFormat::Kml, &every);
    assert_eq!(text.matches("<gx:Track>").count(), 3);
    assert_eq!(elements(&text, "when").len(), 2500);
    assert_eq!(elements(&text, "gx:coord").len(), 2500);
}

#[test]
fn geojson_has_a_line_for_each_span() {
    let json: serde_json::Value = serde_json::from_str(&written(SolutionFormat::GeoJson)).unwrap();
    assert_eq!(json["type"], "FeatureCollection");
    assert_eq!(json["name"], NAME);
    let features = json["features"].as_array().unwrap();
    let is_line = |f: &&serde_json::Value| f["geometry"]["type"] == "LineString";
    let (features, ellipses): (Vec<_>, Vec<_>) = features.iter().partition(is_line);
    let times = ellipses.iter().map(|f| f["properties"]["time_s"].as_f64());
    let ends = [
        604_794.0, 604_798.0, 604_798.0, 604_802.0, 604_802.0, 604_806.0,
    ];
    assert_eq!(Vec::from_iter(times.flatten()), ends);
    let gnss: Vec<_> = features.iter().map(|f| &f["properties"]["gnss"]).collect();
    assert_eq!(gnss, [true, false, true]);
    assert_eq!(features[1]["properties"]["start_s"], 604_798.0);
    assert_eq!(features[1]["properties"]["end_s"], 604_802.0);
    let line = features[1]["geometry"]["coordinates"].as_array().unwrap();
    assert_eq!(line.len(), 41);
    assert_eq!(line[0], serde_json::json!([151.199_84, -33.859_92, 25.8]));
    // Nothing, and a single row, are collections without lines.
    for rows in [0, 1] {
        let text = text_of(track().take(rows), SolutionFormat::GeoJson, &options());
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["features"].as_array().unwrap().len(), 0);
    }
}

#[test]
fn gpx_has_times_where_the_date_is_known() {
    let text = written(SolutionFormat::Gpx);
    let times = elements(&text, "time");
    assert_eq!(times.len(), 121);
    assert_eq!(times[0], "2025-07-12T23:59:36.000Z");
    assert_eq!(times[120], "2025-07-12T23:59:48.000Z");
    let fixes = elements(&text, "fix");
    assert_eq!(fixes.iter().filter(|fix| *fix == "none").count(), 40);
    let mut options = options();
    options.epoch = None;
    let text = text_of(track(), SolutionFormat::Gpx, &options);
    assert!(elements(&text, "time").is_empty());
}

/// Coordinates of the lines of a GeoJSON.
fn lines(rows: &[(SolutionRow, bool)], every: Option<f64>) -> Vec<Vec<[f64; 3]>> {
    let options = SolutionOptions { every, ..options() };
    let text = text_of(rows.iter().copied(), SolutionFormat::GeoJson, &options);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let features = json["features"].as_array().unwrap();
    let lines = features.iter().map(|f| &f["geometry"]);
    let lines = lines.filter(|geometry| geometry["type"] == "LineString");
    lines
        .map(|geometry| serde_json::from_value(geometry["coordinates"].clone()).unwrap())
        .collect()
}

#[test]
fn every_line_has_two_points_or_more() {
    // All ways to lose and regain GNSS over six rows, thinned and not.
    for flags in 0..64u32 {
        let rows: Vec<_> = (0..6).map(|k| (row(k), flags >> k & 1 == 1)).collect();
        for every in [0.0, 0.1, 100.0] {
            let lines = lines(&rows, Some(every));
            assert!(lines.iter().all(|line| line.len() >= 2), "{flags:b}");
            let last = lines.last().unwrap().last().unwrap();
            assert!((last[1] - (-33.86 + 5e-6)).abs() < 1e-9, "{flags:b}");
            for pair in lines.windows(2) {
                assert_eq!(pair[0].last(), pair[1].first());
            }
        }
    }
}

#[test]
fn a_line_ends_at_the_antimeridian() {
    let at = |time, lon| SolutionRow::at(time, Geodetic::from_degrees(1.0, lon, 0.0));
    let rows = [179.8, 179.9, 180.0, -179.9, -179.8];
    let rows: Vec<_> = (0..5)
        .zip(rows)
        .map(|(k, lon)| (at(f64::from(k), lon), false))
        .collect();
    let lines = lines(&rows, None);
    assert_eq!(lines.len(), 2);
    assert_eq!((lines[0].len(), lines[1].len()), (2, 3));
    // 180° is −180° where longitudes end before it.
    assert_eq!(lines[1][0][0], -180.0);
}

#[test]
fn rows_that_are_none_are_left_out() {
    let mut rows: Vec<_> = track().collect();
    for k in [0, 7, 100, 240] {
        rows[k].0.position.lat = f64::NAN;
        rows[k + usize::from(k < 240)].0.time = f64::INFINITY;
    }
    for (format, name) in TEXTS {
        let text = text_of(rows.iter().copied(), format, &options());
        assert!(!text.contains("nan") && !text.contains("inf"), "{name}");
        assert!(text.len() > 1000, "{name}");
    }
}

#[test]
fn formats_by_name_and_extension() {
    let of = |path: &str| SolutionFormat::from_path(Path::new(path)).map(SolutionFormat::name);
    assert_eq!(of("out/a.b.NAV"), Some("kf-gins"));
    assert_eq!(of("a.json"), Some("geojson"));
    assert_eq!(of("a.txt"), None);
    assert_eq!(of(".csv"), None);
    for name in [
        "csv", "kf-gins", "nmea", "kml", "geojson", "gpx", "mcap", "parquet",
    ] {
        assert_eq!(name.parse().map(SolutionFormat::name), Ok(name));
    }
    assert!("kmz".parse::<SolutionFormat>().is_err());
    for every in [-1.0, f64::NAN, f64::INFINITY] {
        let options = SolutionOptions {
            every: Some(every),
            ..options()
        };
        assert!(SolutionFile::new(Cursor::new(Vec::new()), SolutionFormat::Kml, &options).is_err());
    }
}
