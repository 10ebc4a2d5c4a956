//! Positions: `.vbo` of Racelogic's VBOX, IGC flights, `gx:Track` of KML. Those with times of day alone are moved to the day of the IMU.

use super::{below, lines};
use crate::table::cells::of_day;

pub(super) fn is_vbo(start: &[u8]) -> bool {
    let has = |line: &str| lines(start).any(|other| other.eq_ignore_ascii_case(line));
    has("[column names]") && (has("[header]") || has("[data]"))
}

/// Latitudes and longitudes are in minutes of arc, the longitudes positive to the west; velocities in km/h.
pub(super) fn of_vbo(text: &[u8]) -> Option<String> {
    let mut all = lines(text).skip_while(|line| !line.eq_ignore_ascii_case("[column names]"));
    let names = Vec::from_iter(all.nth(1)?.split_whitespace());
    let place = |name: &str| names.iter().position(|other| *other == name);
    let [time, lat, lon] = ["time", "lat", "long"].map(place);
    let (time, lat, lon) = (time?, lat?, lon?);
    let others = ["height", "velocity", "heading"].map(place);
    let rows = all
        .skip_while(|line| !line.eq_ignore_ascii_case("[data]"))
        .skip(1);
    let row = |line: &str| {
        let fields = Vec::from_iter(line.split_whitespace());
        let minutes = |place: usize| fields.get(place)?.parse::<f64>().ok();
        let (lat, lon) = (minutes(lat)? / 60.0, -minutes(lon)? / 60.0);
        let time = of_day(fields.get(time)?)?;
        let other = |place: &Option<usize>| {
            let field = place.and_then(|place| fields.get(place));
            field.copied().unwrap_or_default().to_owned()
        };
        let others = others.each_ref().map(other).join(",");
        Some(format!("{time},{lat:.9},{lon:.9},{others}"))
    };
    below(
        "time,lat,lon,height_m,speed_kmh,course",
        rows.filter_map(row),
    )
}

pub(super) fn is_igc(start: &[u8]) -> bool {
    let is_header = |line: &str| line.starts_with("HFDTE") || line.starts_with("HFDTM");
    start.first() == Some(&b'A') && lines(start).take(50).any(is_header)
}

/// Records B of valid fixes: time of day, degrees with minutes in thousandths, the pressure's height, that of the satellites.
pub(super) fn of_igc(text: &[u8]) -> Option<String> {
    let row = |line: &str| {
        let at = |range| line.get(range);
        let angle = |from: usize, degrees: usize| {
            let whole: f64 = line.get(from..from + degrees)?.parse().ok()?;
            let minutes: f64 = line.get(from + degrees..from + degrees + 5)?.parse().ok()?;
            let sign = match line.get(from + degrees + 5..from + degrees + 6)? {
                "S" | "W" => -1.0,
                _ => 1.0,
            };
            Some(sign * (whole + minutes / 60_000.0))
        };
        let is_fix = line.starts_with('B') && at(24..25)? == "A";
        let (lat, lon) = (angle(7, 2)?, angle(15, 3)?);
        let (time, height) = (of_day(at(1..7)?)?, at(30..35)?);
        is_fix.then(|| format!("{time},{lat:.7},{lon:.7},{height}"))
    };
    below("time,lat,lon,height_m", lines(text).filter_map(row))
}

pub(super) fn is_kml(start: &[u8]) -> bool {
    let has = |word: &[u8]| start.windows(word.len()).any(|part| part == word);
    has(b"<kml") && has(b":Track>")
}

/// What is between such tags.
fn inside<'a>(text: &'a str, tag: &str) -> impl Iterator<Item = &'a str> {
    let behind = text.split(tag).skip(1);
    behind.filter_map(|rest| Some(rest.split_once('<')?.0.trim()))
}

/// Times, and as many longitudes, latitudes and heights.
pub(super) fn of_kml(text: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(text).ok()?;
    let row = |(time, place): (&str, &str)| {
        let mut numbers = place.split_whitespace();
        let (lon, lat) = (numbers.next()?, numbers.next()?);
        Some(format!(
            "{time},{lat},{lon},{}",
            numbers.next().unwrap_or("")
        ))
    };
    let both = inside(text, "<when>").zip(inside(text, "gx:coord>").step_by(2));
    below("time,lat,lon,height_m", both.filter_map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_of_arc_to_the_west_become_degrees() {
        let text = b"File created on 06/05/2024\n[header]\nsatellites\n\n[column names]\nsats time lat long velocity heading height\n\n[data]\n012 125322.50 +02888.2200 -00694.5000 036.000 040.10 +0519.58\n";
        assert!(is_vbo(text));
        let table = of_vbo(text).unwrap();
        let row = table.lines().nth(1).unwrap();
        assert_eq!(
            row,
            "12:53:22.50,48.137000000,11.575000000,+0519.58,036.000,040.10"
        );
        assert!(!is_vbo(b"t,a\n1,2\n"));
    }

    #[test]
    fn valid_fixes_of_a_flight() {
        let text = b"AXCT001\nHFDTE060524\nB1253224808220N01134500WA0047300520\nB1253234808220N01134500WV0047300520\nB1253244808280S01134500EA0047300521\n";
        assert!(is_igc(text));
        assert_eq!(
            of_igc(text).unwrap(),
            "time,lat,lon,height_m\n12:53:22,48.1370000,-11.5750000,00520\n12:53:24,-48.1380000,11.5750000,00521\n"
        );
    }

    #[test]
    fn a_track_has_its_times_before_its_places() {
        let text = b"<kml xmlns:gx=\"g\"><gx:Track><when>2024-05-06T12:53:22Z</when>\n<when>2024-05-06T12:53:23Z</when><gx:coord>11.5 48.1 520</gx:coord><gx:coord>11.6 48.2 521</gx:coord></gx:Track></kml>";
        assert!(is_kml(text));
        assert_eq!(
            of_kml(text).unwrap(),
            "time,lat,lon,height_m\n2024-05-06T12:53:22Z,48.1,11.5,520\n2024-05-06T12:53:23Z,48.2,11.6,521\n"
        );
    }
}
