//! What the header line of a solution file says.

use crate::time::TimeSystem;

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

impl Layout {
    /// From a line that starts with `%`, a time system and the names of the columns; `None` for
    /// any other line.
    pub(super) fn of(line: &[u8]) -> Option<Self> {
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
        let layout = Layout::of(
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

        let dms = Layout::of(b"% UTC latitude(d'\") longitude(d'\") height(m) Q").unwrap();
        assert_eq!((dms.axes, dms.system), (Axes::GeodeticDms, TimeSystem::Utc));
        assert_eq!(dms.position, [(0, 3), (3, 3), (6, 1)]);
        assert_eq!((dms.quality, dms.position_sd), (Some(7), None));
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
            assert_eq!(Layout::of(line.as_bytes()), None, "{line}");
        }
    }
}
