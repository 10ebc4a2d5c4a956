use undrift_nav::earth::Geodetic;
use undrift_nav::sample::Position;

use super::{detect, entries, streams};
use crate::entry::{Fix, Wanted, What};
use crate::log::receiver::testing::{
    all, cut_at_every_byte, fixes, golden, source_of, table, try_all, whatever_the_source,
};
use crate::skipped::SkipKind;

/// Some roundings of degrees, metres and seconds of a week.
const ROUNDING: f64 = 1e-10;
/// Beginning of GPS week 2374 \[s\] after the GPS epoch.
const WEEK_2374: f64 = 2374.0 * 604_800.0;

fn place(fix: &Fix) -> Geodetic {
    match fix.position.unwrap() {
        (Position::Geodetic(place), None) => place,
        other => panic!("{other:?}"),
    }
}

#[test]
fn points_of_tracks_are_those_that_gpxpy_reads() {
    let expected = table("gpx/points.csv");
    let usable: Vec<_> = expected
        .iter()
        .filter(|row| row["gps_s"].is_some() && row["elevation_m"].is_some())
        .collect();
    for file in ["gpx/track.gpx", "gpx/track10.gpx"] {
        let (fixes, skipped) = fixes(entries, &golden(file));
        assert_eq!(fixes.len(), usable.len());
        assert_eq!(
            skipped.count(SkipKind::MissingField),
            (expected.len() - usable.len()) as u64
        );
        assert_eq!(skipped.total(), skipped.count(SkipKind::MissingField));
        for (fix, row) in fixes.iter().zip(&usable) {
            let get = |name: &str| row[name].unwrap();
            assert!(
                (fix.time + WEEK_2374 - get("gps_s")).abs() < 1e-6,
                "{}",
                fix.time
            );
            let place = place(fix);
            assert!((place.lat.to_degrees() - get("lat_deg")).abs() < ROUNDING);
            assert!((place.lon.to_degrees() - get("lon_deg")).abs() < ROUNDING);
            let height = get("elevation_m") + row["geoid_m"].unwrap_or(0.0);
            assert!((place.height - height).abs() < ROUNDING);
            assert!(fix.velocity.is_none());
        }
        let (poses, _) = all(entries, &golden(file), &Wanted::Poses(Some("track".into())));
        let What::Pose(pose) = poses[7].what else {
            panic!()
        };
        assert_eq!(
            (pose.time, pose.position),
            (fixes[7].time, place(&fixes[7]))
        );
        assert!(pose.v_n.is_none() && pose.rpy.is_none());
        let found = streams(source_of(&golden(file))).unwrap();
        assert_eq!((found[0].name.as_str(), found[0].messages), ("track", 60));
        assert_eq!(found[0].about, "points of tracks, 56 with a time");
    }
    let (entries, _) = all(entries, &golden("gpx/track.gpx"), &Wanted::Poses(None));
    assert_eq!(
        entries[..2]
            .iter()
            .map(|entry| entry.at)
            .collect::<Vec<_>>(),
        [19, 24]
    );
}

fn track(points: &str) -> String {
    format!(
        "<?xml version='1.0'?>\n<gpx version=\"1.1\"><trk><trkseg>{points}</trkseg></trk></gpx>"
    )
}

#[test]
fn ways_of_writing() {
    let same = [
        "<trkpt lat='1.5' lon='2.5'><ele>3</ele><time>2025-07-08T19:34:00Z</time></trkpt>",
        "<trkpt lon = ' 2.5 ' lat=\"&#49;.5\"><time> 2025-07-08T19:34:00 </time>\n<ele>\n3.0</ele></trkpt>",
        "<trkpt lat='1.5' lon='2.5'><ele><![CDATA[3]]></ele><time>2025-07-08T21:34:00.000+02:00</time></trkpt>",
        "<trkpt lat='1.5' lon='2.5'><ele><!-- 9 -->&#51;</ele><time>2025-07-08T10:04:00-09:30</time></trkpt>",
        "<trkpt lat='1.5' lon='2.5'><extensions><time>1999-01-01T00:00:00Z</time><ele>9</ele><q><ele>8</ele></q></extensions>\
         <ele>3</ele><time>2025-07-08T19:34:00Z</time><name>Z\u{fc}rich &lt;&unknown;</name></trkpt>",
        "<g:trkpt xmlns:g='x' lat='1.5' lon='2.5'><g:ele>3</g:ele><g:time>2025-07-08T19:34:00Z</g:time></g:trkpt>",
        "<trkpt lat='1.5' lon='2.5'><ele>-44.5</ele><geoidheight>47.5</geoidheight><time>2025-07-08T19:34:00Z</time></trkpt>",
    ];
    for point in same {
        let (found, skipped) = fixes(entries, track(point).as_bytes());
        assert!(skipped.is_empty(), "{point}: {skipped}");
        assert_eq!(found[0].time, 243_258.0, "{point}");
        assert_eq!(
            place(&found[0]),
            Geodetic::from_degrees(1.5, 2.5, 3.0),
            "{point}"
        );
    }
    // A byte order mark, and names in another encoding.
    let point = same[0].as_bytes();
    let bytes = [b"\xef\xbb\xbf<gpx><name>Z\xfcrich</name>", point, b"</gpx>"].concat();
    assert_eq!(fixes(entries, &bytes).0.len(), 1);
    assert!(detect(&bytes));
}

#[test]
fn what_cannot_be_used_is_counted() {
    let with = |time: &str, ele: &str, attributes: &str| {
        track(&format!(
            "<trkpt {attributes}><ele>{ele}</ele><time>{time}</time></trkpt>"
        ))
    };
    let (time, place) = ("2025-07-08T19:34:00Z", "lat='1' lon='2'");
    for (text, kind) in [
        (with("", "3", place), SkipKind::MissingField),
        (with(time, "", place), SkipKind::MissingField),
        (track("<trkpt lat='1' lon='2'/>"), SkipKind::MissingField),
        (with(time, "3", "lat='1'"), SkipKind::Text),
        (with(time, "3", "lat='nan' lon='2'"), SkipKind::Text),
        (with(time, "&three;", place), SkipKind::Text),
        (with(time, "3", "lat='91' lon='2'"), SkipKind::OutOfRange),
        (with(time, "3", "lat='0' lon='0'"), SkipKind::OutOfRange),
        (with(time, "1e9", place), SkipKind::OutOfRange),
        (with("2025-07-08_19:34:00Z", "3", place), SkipKind::Text),
        (with("2025-07-08T19:34:00+2", "3", place), SkipKind::Text),
        (with("2025-07-08T19:34:00Zulu", "3", place), SkipKind::Text),
        (with("2025-13-08T19:34:00Z", "3", place), SkipKind::Text),
        (with("2025-07-08-01T19:34:00Z", "3", place), SkipKind::Text),
        (with("T", "3", place), SkipKind::Text),
    ] {
        let (found, skipped) = fixes(entries, text.as_bytes());
        assert!(found.is_empty(), "{text}");
        assert_eq!(
            (skipped.count(kind), skipped.total()),
            (1, 1),
            "{text}: {skipped}"
        );
    }
}

#[test]
fn hostile_xml() {
    let good = "<trkpt lat='1' lon='2'><ele>3</ele><time>2025-07-08T19:34:00Z</time></trkpt>";
    let laughs = "<!DOCTYPE gpx [<!ENTITY a '3'><!ENTITY b '&a;&a;&a;'>]>";
    let entities = format!("{laughs}<gpx>{}{good}</gpx>", good.replace('3', "&b;"));
    let deep = format!("<gpx>{good}{}", "<x>".repeat(100_000));
    let long = format!(
        "<gpx>{good}<name>{}</name>{good}</gpx>",
        "x".repeat(4 << 20)
    );
    let tag = format!(
        "<gpx>{good}<trkpt lat='{}'/>{good}</gpx>",
        "1".repeat(4 << 20)
    );
    let unclosed = format!("<gpx>{good}</trk>{good}</gpx>");
    // Entities are not looked up; the others end the file where it turns bad.
    for (text, kind) in [
        (entities, SkipKind::Text),
        (deep, SkipKind::EndsEarly),
        (long, SkipKind::EndsEarly),
        (tag, SkipKind::EndsEarly),
        (unclosed, SkipKind::EndsEarly),
    ] {
        let (found, skipped) = fixes(entries, text.as_bytes());
        assert_eq!(
            (found.len(), skipped.count(kind)),
            (1, 1),
            "{:.60} {skipped}",
            text
        );
    }
    for text in [
        "",
        "   ",
        "<",
        "t,gx\n1,2\n",
        "<kml></kml>",
        "<trkpt lat='1' lon='2'/>",
        "\u{feff}",
    ] {
        let (_, _, error) = try_all(
            entries,
            source_of(text.as_bytes()),
            &super::super::receiver::testing::FIXES,
        );
        assert!(error.unwrap().to_string().contains("is not GPX"), "{text}");
        assert!(!detect(text.as_bytes()));
    }
}

#[test]
fn damage_of_any_kind() {
    let bytes = golden("gpx/track.gpx");
    cut_at_every_byte(entries, &bytes[..4000]);
    whatever_the_source(entries, &bytes);
    // XML has no checksums: a wrong bit may change a value, but nothing worse.
    let mut flipped = bytes.clone();
    for k in 0..bytes.len() {
        flipped[k] ^= 1 << (k % 8);
        let (found, _, _) = try_all(entries, source_of(&flipped), &Wanted::Poses(None));
        for entry in found {
            let What::Pose(pose) = entry.what else {
                panic!()
            };
            assert!(pose.time.is_finite() && pose.position.is_valid());
        }
        flipped[k] = bytes[k];
    }
    assert!(detect(&bytes[..400]) && !detect(&golden("nmea/drive.nmea")));
}
