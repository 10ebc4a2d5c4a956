//! Universal transverse Mercator coordinates on the ellipsoid of WGS 84.
//!
//! Krüger's series in the third flattening up to its fourth power, as in C. F. F. Karney, "Transverse Mercator with an accuracy of a few
//! nanometers", J. Geodesy 85, 2011, equations 11 and 36: to less than 0.01 mm within a zone and its neighbours.

use undrift_nav::earth::{FLATTENING, Geodetic, SEMI_MAJOR, wrap_pi};

/// Scale on the central meridian.
const SCALE: f64 = 0.9996;
/// Easting of the central meridian, and northing of the equator in the southern hemisphere \[m\].
const FALSE_EASTING: f64 = 500_000.0;
const FALSE_NORTHING: f64 = 10_000_000.0;

/// Eastings are at most so far from the central meridian \[m\]: two zones.
const WIDE: f64 = 1_000_000.0;

/// A zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UtmZone {
    /// 1 to 60, from 180° west to the east.
    pub number: u8,
    /// Whether northings count from 10 000 km south of the equator.
    pub south: bool,
}

impl UtmZone {
    /// A zone as "32N" or "56S": the hemisphere, not the letter of a latitude band.
    ///
    /// ```
    /// use undrift_io::utm::UtmZone;
    /// assert_eq!(UtmZone::parse("56 S"), Some(UtmZone { number: 56, south: true }));
    /// assert_eq!(UtmZone::parse("61N"), None);
    /// ```
    pub fn parse(text: &str) -> Option<Self> {
        let letters = text.trim_start_matches(|c: char| c.is_ascii_digit());
        let number = text.strip_suffix(letters)?.parse().ok()?;
        let south = match letters.trim() {
            "N" | "n" => false,
            "S" | "s" => true,
            _ => return None,
        };
        (1..=60).contains(&number).then_some(Self { number, south })
    }

    /// The place of an easting and northing \[m\], with its height \[m\]; `None` where they are too far outside of the zone to be of it.
    pub fn place(self, easting: f64, northing: f64, height: f64) -> Option<Geodetic> {
        let is_near = (easting - FALSE_EASTING).abs() < WIDE;
        if !is_near || !(0.0..FALSE_NORTHING).contains(&northing) {
            return None;
        }
        let n = FLATTENING / (2.0 - FLATTENING);
        let [n2, n3, n4] = [n.powi(2), n.powi(3), n.powi(4)];
        let beta = [
            n / 2.0 - 2.0 * n2 / 3.0 + 37.0 * n3 / 96.0 - n4 / 360.0,
            n2 / 48.0 + n3 / 15.0 - 437.0 * n4 / 1440.0,
            17.0 * n3 / 480.0 - 37.0 * n4 / 840.0,
            4397.0 * n4 / 161_280.0,
        ];
        // Of the latitude from the conformal one.
        let delta = [
            2.0 * n - 2.0 * n2 / 3.0 - 2.0 * n3 + 116.0 * n4 / 45.0,
            7.0 * n2 / 3.0 - 8.0 * n3 / 5.0 - 227.0 * n4 / 45.0,
            56.0 * n3 / 15.0 - 136.0 * n4 / 35.0,
            4279.0 * n4 / 630.0,
        ];
        let radius = SCALE * SEMI_MAJOR / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0);
        let origin = if self.south { FALSE_NORTHING } else { 0.0 };
        let xi = (northing - origin) / radius;
        let eta = (easting - FALSE_EASTING) / radius;
        let (mut xi_0, mut eta_0) = (xi, eta);
        for (beta, twice) in beta.iter().zip([2.0, 4.0, 6.0, 8.0]) {
            xi_0 -= beta * (twice * xi).sin() * (twice * eta).cosh();
            eta_0 -= beta * (twice * xi).cos() * (twice * eta).sinh();
        }
        let conformal = (xi_0.sin() / eta_0.cosh()).asin();
        let terms = delta.iter().zip([2.0, 4.0, 6.0, 8.0]);
        let more: f64 = terms
            .map(|(delta, twice)| delta * (twice * conformal).sin())
            .sum();
        let meridian = (6.0 * f64::from(self.number) - 183.0).to_radians();
        Some(Geodetic {
            lat: conformal + more,
            lon: wrap_pi(meridian + eta_0.sinh().atan2(xi_0.cos())),
            height,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By PROJ, `pyproj.Transformer.from_crs(4326, 32600 + zone, always_xy=True)`, 32700 in the south: to 0.1 mm.
    #[test]
    fn places_are_those_of_proj() {
        for (lat, lon, zone, easting, northing) in [
            (48.1372, 11.5756, "32N", 691_611.215_5, 5_334_758.052_8),
            (-33.8568, 151.2153, "56S", 334_900.569_7, 6_252_288.752_9),
            (30.44, 114.47, "50N", 257_032.278_6, 3_370_261.430_8),
            (0.5, -78.2, "17N", 811_683.014_9, 55_331.537_5),
            (69.65, 18.96, "34N", 420_838.901_1, 7_728_164.293_4),
            (83.9, 2.9, "31N", 498_813.614_8, 9_316_931.183_5),
        ] {
            let zone = UtmZone::parse(zone).unwrap();
            let expected = Geodetic::from_degrees(lat, lon, 120.0);
            let found = zone.place(easting, northing, 120.0).unwrap();
            let apart = (found.to_ecef() - expected.to_ecef()).norm();
            // What the digits of the coordinates leave, each way.
            assert!(apart < 1e-4, "{lat} {lon}: {apart} m");
        }
        let zone = UtmZone::parse("32N").unwrap();
        for (easting, northing) in [(1e9, 5e6), (5e5, -1.0), (f64::NAN, 5e6)] {
            assert_eq!(zone.place(easting, northing, 0.0), None);
        }
    }
}
