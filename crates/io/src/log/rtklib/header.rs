//! What the header line of a solution file says.

use crate::number;
use crate::time::{TimeSystem, WeekClock};

/// What the position columns are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axes {
    /// Latitude and longitude \[deg\], height \[m\]; the rest north, east, up.
    Geodetic,
    /// The same in degrees, minutes, seconds.
    GeodeticDms,
    /// Earth-centred Earth-fixed x, y, z \[m\].
    Ecef,
    /// East, north, up of the base station \[m\].
    Baseline,
}

/// Places of standard deviations in the file's axes 1, 2, 3, and of the signed roots of the
/// covariances 12, 23, 31.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Components {
    pub(super) std: [usize; 3],
    pub(super) cross: Option<[usize; 3]>,
}

/// Places of the columns, counted in fields after the two of the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) system: TimeSystem,
    pub(super) axes: Axes,
    /// First field and number of fields of each coordinate.
    pub(super) position: [(usize, usize); 3],
    pub(super) position_sd: Option<Components>,
    pub(super) velocity: Option<[usize; 3]>,
    pub(super) velocity_sd: Option<Components>,
    pub(super) quality: Option<usize>,
}

/// The columns of a solution in degrees, as RTKLIB orders them; behind them stand those of velocities, if it has any.
const COLUMNS: &str = "latitude longitude height Q ns sdn sde sdu sdne sdeu sdun age ratio";
const ECEF_COLUMNS: &str = "x-ecef y-ecef z-ecef Q ns sdx sdy sdz sdxy sdyz sdzx age ratio";
const BASELINE_COLUMNS: &str =
    "e-baseline n-baseline u-baseline Q ns sde sdn sdu sden sdnu sdue age ratio";
const VELOCITY_COLUMNS: &str = "vn ve vu sdvn sdve sdvu sdvne sdveu sdvun";
const ECEF_VELOCITY_COLUMNS: &str = "vx vy vz sdvx sdvy sdvz sdvxy sdvyz sdvzx";
/// Fields of a row behind its time, without and with velocities.
const WIDTHS: [usize; 2] = [13, 22];
/// Decimals of a coordinate: at least so many of degrees, at most so many of metres.
const DECIMALS_DEG: usize = 7;
const DECIMALS_M: usize = 6;
/// Distances from the Earth's centre \[m\].
const RADII: std::ops::Range<f64> = 6.3e6..6.5e6;

impl Layout {
    /// Of a row without a header above it, which has RTKLIB's columns in their order; the time system is taken to be
    /// GPST, RTKLIB's own. `None` of any other line.
    pub(super) fn of_row(line: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(line).ok()?;
        let words = text.split([' ', '\t', ',', ';']);
        let mut words = words.filter(|word| !word.is_empty());
        let (first, second) = (words.next()?, words.next()?);
        let times = (first.as_bytes(), second.as_bytes());
        WeekClock::default().seconds(times.0, times.1, TimeSystem::Gps)?;
        let words: Vec<&str> = words.collect();
        let numbers = words
            .iter()
            .map(|word| number::parse_finite(word.as_bytes()));
        let numbers = numbers.collect::<Option<Vec<f64>>>()?;
        let [x, y, z, quality, satellites, stds @ ..] = numbers.as_slice() else {
            return None;
        };
        let plausible = WIDTHS.contains(&numbers.len())
            && (1.0..=7.0).contains(quality)
            && (0.0..100.0).contains(satellites)
            && quality.fract() + satellites.fract() == 0.0
            && stds.iter().take(3).all(|std| *std >= 0.0);
        let decimals = |word: &str| word.split_once('.').map_or(0, |(_, behind)| behind.len());
        let geodetic = decimals(words[0]).min(decimals(words[1])) >= DECIMALS_DEG
            && x.abs() <= 90.0
            && y.abs() <= 180.0;
        let in_metres = decimals(words[0]).max(decimals(words[1])) <= DECIMALS_M;
        let (columns, velocity) = match RADII.contains(&(x * x + y * y + z * z).sqrt()) {
            _ if !plausible => return None,
            true => (ECEF_COLUMNS, ECEF_VELOCITY_COLUMNS),
            false if geodetic => (COLUMNS, VELOCITY_COLUMNS),
            false if in_metres => (BASELINE_COLUMNS, VELOCITY_COLUMNS),
            false => return None,
        };
        let velocity = if numbers.len() == WIDTHS[1] {
            velocity
        } else {
            ""
        };
        Self::from_line(format!("% GPST {columns} {velocity}").as_bytes())
    }

    /// From a line that starts with `%`, a time system and the names of the columns; `None` for
    /// any other line.
    pub(super) fn from_line(line: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(line.strip_prefix(b"%")?).ok()?;
        let mut words = text
            .split([' ', '\t', ',', ';'])
            .filter(|word| !word.is_empty());
        let system = TimeSystem::named(words.next()?)?;
        let mut places: Vec<(String, usize, usize)> = Vec::new();
        let mut at = 0;
        for word in words {
            let fields = if word.contains("(d'") { 3 } else { 1 };
            let name = word.split('(').next().unwrap_or(word);
            places.push((name.to_ascii_lowercase(), at, fields));
            at += fields;
        }
        let find = |name: &str| {
            let place = places.iter().find(|(present, ..)| present == name)?;
            Some((place.1, place.2))
        };
        let all = |names: [&str; 3]| {
            let [a, b, c] = names.map(find);
            Some([a?, b?, c?])
        };
        let first = |places: [(usize, usize); 3]| places.map(|(from, _)| from);

        let (axes, letters, position) = if let Some(at) = all(["latitude", "longitude", "height"]) {
            let dms = at.iter().any(|(_, fields)| *fields == 3);
            let axes = if dms {
                Axes::GeodeticDms
            } else {
                Axes::Geodetic
            };
            (axes, ["n", "e", "u"], at)
        } else if let Some(at) = all(["x-ecef", "y-ecef", "z-ecef"]) {
            (Axes::Ecef, ["x", "y", "z"], at)
        } else {
            let at = all(["e-baseline", "n-baseline", "u-baseline"])?;
            (Axes::Baseline, ["e", "n", "u"], at)
        };
        let [a, b, c] = letters;
        let components = |prefix: &str| {
            let named = |suffix: &str| find(&format!("{prefix}{suffix}")).map(|place| place.0);
            let pair =
                |i: &str, j: &str| named(&format!("{i}{j}")).or_else(|| named(&format!("{j}{i}")));
            let std = [named(a)?, named(b)?, named(c)?];
            let cross = match (pair(a, b), pair(b, c), pair(c, a)) {
                (Some(ab), Some(bc), Some(ca)) => Some([ab, bc, ca]),
                _ => None,
            };
            Some(Components { std, cross })
        };
        let velocity = letters.map(|letter| format!("v{letter}"));
        Some(Self {
            system,
            axes,
            position,
            position_sd: components("sd"),
            velocity: all(velocity.each_ref().map(String::as_str)).map(first),
            velocity_sd: components("sdv"),
            quality: find("q").map(|place| place.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts() {
        let layout = Layout::from_line(
            b"%  GPST , latitude(deg) , longitude(deg), height(m), Q, ns, sdn(m), sde(m), sdu(m), \
              sdne(m), sdeu(m), sdun(m), age(s), ratio, vn(m/s), ve(m/s), vu(m/s), sdvn, sdve, sdvu",
        )
        .unwrap();
        assert_eq!(layout.axes, Axes::Geodetic);
        assert_eq!(layout.position, [(0, 1), (1, 1), (2, 1)]);
        assert_eq!(layout.quality, Some(3));
        let sd = layout.position_sd.unwrap();
        assert_eq!((sd.std, sd.cross), ([5, 6, 7], Some([8, 9, 10])));
        assert_eq!(layout.velocity, Some([13, 14, 15]));
        assert_eq!(layout.velocity_sd.unwrap().cross, None);

        let dms = Layout::from_line(b"% UTC latitude(d'\") longitude(d'\") height(m) Q").unwrap();
        assert_eq!((dms.axes, dms.system), (Axes::GeodeticDms, TimeSystem::Utc));
        assert_eq!(dms.position, [(0, 3), (3, 3), (6, 1)]);
        assert_eq!((dms.quality, dms.position_sd), (Some(7), None));
    }

    #[test]
    fn rows_without_a_header_have_the_columns_of_rtklib() {
        let rest = "2 12 0.01 0.01 0.02 0.001 0.001 0.001 0.50 5.0";
        let axes = |row: String| Layout::of_row(row.as_bytes()).map(|layout| layout.axes);
        let time = "2024/02/07 12:00:01.000";
        for (place, expected) in [
            ("50.123456789 4.123456789 120.1234", Some(Axes::Geodetic)),
            ("4027881.1234 306998.1234 4919499.1234", Some(Axes::Ecef)),
            ("12.1234 -7.1234 0.1234", Some(Axes::Baseline)),
            ("91.123456789 4.123456789 120.1234", None),
        ] {
            assert_eq!(axes(format!("{time} {place} {rest}")), expected, "{place}");
            assert_eq!(axes(format!("2300,302401.000,{place},{rest}")), expected);
        }
        let place = "50.123456789 4.123456789 120.1234";
        let row = format!("{time} {place} {rest} 1 2 3 0.1 0.1 0.1 0 0 0");
        let velocity = Layout::of_row(row.as_bytes()).unwrap().velocity;
        assert_eq!(velocity, Some([13, 14, 15]));
        // No kind of solution, too few columns, no time.
        for row in [
            format!("{time} {place} 2.5 12 0.01 0.01 0.02 0 0 0 0 0"),
            format!("{time} {place} 2 12 0.01 0.01 0.02"),
            format!("12.5 13.5 {place} {rest}"),
        ] {
            assert_eq!(Layout::of_row(row.as_bytes()), None, "{row}");
        }
    }

    #[test]
    fn other_comments_are_no_header() {
        for line in [
            "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float)",
            "% obs start : 2025/07/08 19:34:18.0 GPST",
            "% GPST",
            "GPST latitude(deg) longitude(deg) height(m)",
            "",
        ] {
            assert_eq!(Layout::from_line(line.as_bytes()), None, "{line}");
        }
    }
}
