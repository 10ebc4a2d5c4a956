//! WGS-84: radii, normal gravity, Earth and transport rate, geodetic ↔ ECEF ↔ NED.
//!
//! Sources: NIMA TR8350.2, 3rd edition (constants, eq. 4-1 and 4-3); Groves 2013, chapter 2.

use crate::{Matrix3, Vector3};
use libm::{atan2, cos, sin, sqrt};

/// Semi-major axis a \[m\].
pub const SEMI_MAJOR: f64 = 6_378_137.0;
/// Flattening f.
/// Of WGS-84, as are the ellipsoid's other constants here.
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// First eccentricity squared e².
pub const ECCENTRICITY_SQ: f64 = FLATTENING * (2.0 - FLATTENING);
/// Semi-minor axis b \[m\].
pub const SEMI_MINOR: f64 = SEMI_MAJOR * (1.0 - FLATTENING);
/// Earth rotation rate ω_ie [rad/s].
/// Against inertial space: a turn in a sidereal day, not in 24 h.
pub const EARTH_RATE: f64 = 7.292_115_146_7e-5;
/// Gravitational constant of the Earth's mass, atmosphere included [m³/s²].
pub const GM: f64 = 3.986_004_418e14;
/// Normal gravity at the equator [m/s²].
pub const GRAVITY_EQUATOR: f64 = 9.780_325_335_9;
/// Normal gravity at the pole [m/s²].
pub const GRAVITY_POLE: f64 = 9.832_184_937_8;
/// Standard gravity, the `g` of data sheets [m/s²].
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Height above mean sea level \[m\] at which the standard atmosphere has this `pressure` \[Pa\], below
/// 11 km; not a number for a pressure below zero. U.S. Standard Atmosphere 1976, eq. 33a and 18:
/// geopotential height from 288.15 K, 101 325 Pa and 6.5 K/km, then geometric.
///
/// ```
/// use undrift_nav::earth::standard_height;
/// assert!(standard_height(101_325.0).abs() < 1e-9);
/// assert!((standard_height(89_875.0) - 1000.0).abs() < 1.0); // The standard's table at 1000 m.
/// ```
pub fn standard_height(pressure: f64) -> f64 {
    const RADIUS: f64 = 6_356_766.0;
    // R* L / (g0 M0)
    const EXPONENT: f64 = 8.314_32 * 0.0065 / (STANDARD_GRAVITY * 0.028_964_4);
    let geopotential = 288.15 / 0.0065 * (1.0 - libm::pow(pressure / 101_325.0, EXPONENT));
    RADIUS * geopotential / (RADIUS - geopotential)
}

/// A point by geodetic latitude, longitude and height above the WGS-84 ellipsoid.
///
/// ```
/// use undrift_nav::{Vector3, earth::Geodetic};
/// let zurich = Geodetic::from_degrees(47.3769, 8.5417, 408.0);
/// let moved = zurich.displaced(&Vector3::new(100.0, 0.0, -5.0)); // 100 m north, 5 m up.
/// assert!((moved.height - 413.0).abs() < 1e-9);
/// assert!((zurich.offset_to(&moved) - Vector3::new(100.0, 0.0, -5.0)).norm() < 1e-6);
/// assert!((Geodetic::from_ecef(&zurich.to_ecef()).lat - zurich.lat).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Geodetic {
    /// Geodetic latitude \[rad\], north positive: the angle of the ellipsoid's normal, not that of the line to the Earth's centre.
    pub lat: f64,
    /// Longitude \[rad\], east positive; any multiple of a turn means the same place.
    pub lon: f64,
    /// Height above the ellipsoid \[m\]; above mean sea level it is smaller or larger by the geoid's undulation, −107 to +85 m.
    pub height: f64,
}

/// Radii of curvature at latitude `lat` \[rad\]: meridian `rm` and transverse (prime vertical) `rn` \[m\], in that order. Groves
/// eq. 2.105-2.106.
///
/// ```
/// use undrift_nav::earth::{ECCENTRICITY_SQ, SEMI_MAJOR, SEMI_MINOR, radii};
/// let (rm, rn) = radii(0.0); // At the equator: a (1 − e²) along the meridian, a across.
/// assert!((rm - SEMI_MAJOR * (1.0 - ECCENTRICITY_SQ)).abs() < 1e-6 && rn == SEMI_MAJOR);
/// let (rm, rn) = radii(std::f64::consts::FRAC_PI_2); // At the pole both are a²/b.
/// assert!((rm - rn).abs() < 1e-6 && (rn - SEMI_MAJOR * SEMI_MAJOR / SEMI_MINOR).abs() < 1e-6);
/// ```
#[inline]
pub fn radii(lat: f64) -> (f64, f64) {
    let s = sin(lat);
    radii_of_sin(s)
}

fn radii_of_sin(s: f64) -> (f64, f64) {
    let w2 = 1.0 - ECCENTRICITY_SQ * s * s;
    let rn = SEMI_MAJOR / sqrt(w2);
    (rn * (1.0 - ECCENTRICITY_SQ) / w2, rn)
}

/// Normal gravity at latitude `lat` \[rad\] and ellipsoidal `height` \[m\], along down [m/s²], the Earth's rotation included: Somigliana with
/// the second-order height term, NIMA TR8350.2 eq. 4-1 and 4-3. True gravity differs from it by some 0.3 mm/s² (30 mGal), in
/// mountains by several times that.
///
/// ```
/// use undrift_nav::earth::gravity;
/// assert!((gravity(45f64.to_radians(), 0.0) - 9.8062).abs() < 1e-4);
/// assert!((gravity(0.0, 0.0) - gravity(0.0, 1000.0) - 3.09e-3).abs() < 1e-5); // 0.31 mGal a metre.
/// ```
#[inline]
pub fn gravity(lat: f64, height: f64) -> f64 {
    let s = sin(lat);
    gravity_of_sin(s, height)
}

fn gravity_of_sin(s: f64, height: f64) -> f64 {
    const K: f64 = SEMI_MINOR * GRAVITY_POLE / (SEMI_MAJOR * GRAVITY_EQUATOR) - 1.0;
    const M: f64 = EARTH_RATE * EARTH_RATE * SEMI_MAJOR * SEMI_MAJOR * SEMI_MINOR / GM;
    let s2 = s * s;
    let surface = GRAVITY_EQUATOR * (1.0 + K * s2) / sqrt(1.0 - ECCENTRICITY_SQ * s2);
    let slope = 2.0 / SEMI_MAJOR * (1.0 + FLATTENING + M - 2.0 * FLATTENING * s2);
    surface * (1.0 - slope * height + 3.0 * height * height / (SEMI_MAJOR * SEMI_MAJOR))
}

/// Earth rotation rate in the navigation frame ω_ie^n [rad/s] at latitude `lat` \[rad\]: `(ω cos φ, 0, −ω sin φ)`.
#[inline]
pub fn earth_rate_n(lat: f64) -> Vector3 {
    Vector3::new(EARTH_RATE * cos(lat), 0.0, -EARTH_RATE * sin(lat))
}

/// Radii, gravity and latitude's sine and cosine at a place: everything local that one navigation step needs.
#[derive(Clone, Copy, Debug)]
pub struct LocalEarth {
    /// Meridian radius plus height \[m\].
    pub rm_h: f64,
    /// Transverse radius plus height \[m\].
    pub rn_h: f64,
    /// Normal gravity, down [m/s²].
    pub gravity: f64,
    /// Sine of the latitude.
    pub sin_lat: f64,
    /// Cosine of the latitude.
    pub cos_lat: f64,
    /// Rate of the Earth's rotation [rad/s]: [`EARTH_RATE`], or 0 in a local frame whose heading is not known.
    pub rate: f64,
}

impl LocalEarth {
    /// Radii, gravity, sine and cosine at `position`; one sine and one cosine are computed.
    #[inline]
    pub fn at(position: &Geodetic) -> Self {
        let (sin_lat, cos_lat) = (sin(position.lat), cos(position.lat));
        let (rm, rn) = radii_of_sin(sin_lat);
        Self {
            rm_h: rm + position.height,
            rn_h: rn + position.height,
            gravity: gravity_of_sin(sin_lat, position.height),
            sin_lat,
            cos_lat,
            rate: EARTH_RATE,
        }
    }

    /// Earth rotation rate ω_ie^n [rad/s].
    #[inline]
    pub fn earth_rate(&self) -> Vector3 {
        Vector3::new(self.rate * self.cos_lat, 0.0, -self.rate * self.sin_lat)
    }

    /// Transport rate ω_en^n [rad/s] at velocity `v_n` [m/s]. Groves eq. 5.44.
    /// The turn of the north-east-down frame against the Earth as it moves over it; it grows without bound towards the poles.
    ///
    /// ```
    /// use undrift_nav::{Vector3, earth::{Geodetic, LocalEarth, SEMI_MAJOR}};
    /// // Eastwards along the equator at 300 m/s the level turns about north by v/a.
    /// let equator = LocalEarth::at(&Geodetic::from_degrees(0.0, 0.0, 0.0));
    /// let rate = equator.transport_rate(&Vector3::new(0.0, 300.0, 0.0));
    /// assert!((rate - Vector3::new(300.0 / SEMI_MAJOR, 0.0, 0.0)).norm() < 1e-18);
    /// ```
    #[inline]
    pub fn transport_rate(&self, v_n: &Vector3) -> Vector3 {
        let e = v_n.y / self.rn_h;
        Vector3::new(e, -v_n.x / self.rm_h, -e * self.sin_lat / self.cos_lat)
    }
}

impl Geodetic {
    /// A point from latitude and longitude in degrees and ellipsoidal height in metres; nothing is checked, see [`Geodetic::is_valid`].
    pub fn from_degrees(lat_deg: f64, lon_deg: f64, height: f64) -> Self {
        Self {
            lat: lat_deg.to_radians(),
            lon: lon_deg.to_radians(),
            height,
        }
    }

    /// Earth-centred Earth-fixed coordinates \[m\]. Groves eq. 2.112.
    /// x through longitude 0, z through the north pole.
    ///
    /// ```
    /// use undrift_nav::earth::{Geodetic, SEMI_MAJOR, SEMI_MINOR};
    /// let [equator, pole] = [Geodetic::from_degrees(0.0, 90.0, 100.0), Geodetic::from_degrees(90.0, 0.0, 100.0)].map(|place| place.to_ecef());
    /// assert!((equator.y - SEMI_MAJOR - 100.0).abs() < 1e-6 && (pole.z - SEMI_MINOR - 100.0).abs() < 1e-6);
    /// ```
    pub fn to_ecef(&self) -> Vector3 {
        let (_, rn) = radii(self.lat);
        let horizontal = (rn + self.height) * cos(self.lat);
        Vector3::new(
            horizontal * cos(self.lon),
            horizontal * sin(self.lon),
            ((1.0 - ECCENTRICITY_SQ) * rn + self.height) * sin(self.lat),
        )
    }

    /// The point at Earth-centred Earth-fixed coordinates \[m\]: Bowring's start and Newton steps on the reduced latitude, good to rounding
    /// from the Earth's core up. Longitude in (−π, π]. Groves section 2.4.3.
    pub fn from_ecef(ecef: &Vector3) -> Self {
        let p = sqrt(ecef.x * ecef.x + ecef.y * ecef.y);
        let lon = atan2(ecef.y, ecef.x);
        let second_eccentricity_sq = ECCENTRICITY_SQ / (1.0 - ECCENTRICITY_SQ);
        let mut beta = atan2(ecef.z * SEMI_MAJOR, p * SEMI_MINOR);
        let mut lat = 0.0;
        for _ in 0..5 {
            let (sb, cb) = (sin(beta), cos(beta));
            lat = atan2(
                ecef.z + second_eccentricity_sq * SEMI_MINOR * sb * sb * sb,
                p - ECCENTRICITY_SQ * SEMI_MAJOR * cb * cb * cb,
            );
            beta = atan2((1.0 - FLATTENING) * sin(lat), cos(lat));
        }
        let (s, c) = (sin(lat), cos(lat));
        let (_, rn) = radii(lat);
        // p·cos + z·sin is the distance along the normal, regular at the poles.
        let height = p * c + ecef.z * s - rn * (1.0 - ECCENTRICITY_SQ * s * s);
        Self { lat, lon, height }
    }

    /// Rotation matrix C_e^n from Earth-fixed axes to north, east, down at this point. Groves eq. 2.150.
    pub fn ned_from_ecef(&self) -> Matrix3 {
        let (sl, cl) = (sin(self.lat), cos(self.lat));
        let (so, co) = (sin(self.lon), cos(self.lon));
        Matrix3::new(
            -sl * co,
            -sl * so,
            cl,
            -so,
            co,
            0.0,
            -cl * co,
            -cl * so,
            -sl,
        )
    }

    /// Vector from `self` to `other` in the north-east-down frame at `self` \[m\], exact: a straight line, so that a point far away lies
    /// below the horizon. A baseline of RTK is this vector from the base.
    ///
    /// ```
    /// use undrift_nav::{Vector3, earth::Geodetic};
    /// let base = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// let rover = base.displaced(&Vector3::new(10_000.0, 0.0, 0.0));
    /// let baseline = base.ned_to(&rover);
    /// assert!((baseline.x - 10_000.0).abs() < 1.0 && (baseline.z - 7.8).abs() < 0.1); // 8 m below the horizon.
    /// ```
    pub fn ned_to(&self, other: &Geodetic) -> Vector3 {
        self.ned_from_ecef() * (other.to_ecef() - self.to_ecef())
    }

    /// The point at a small north-east-down offset \[m\] along the local radii: what an error state
    /// of metres means. For offsets of kilometres use ECEF.
    #[inline]
    pub fn displaced(&self, ned: &Vector3) -> Self {
        let (rm, rn) = radii(self.lat);
        Self {
            lat: self.lat + ned.x / (rm + self.height),
            lon: self.lon + ned.y / ((rn + self.height) * cos(self.lat)),
            height: self.height - ned.z,
        }
    }

    /// The small north-east-down offset \[m\] along the local radii from `self` to `other`; the
    /// inverse of [`Geodetic::displaced`]. Longitudes are compared the short way round.
    #[inline]
    pub fn offset_to(&self, other: &Geodetic) -> Vector3 {
        let (rm, rn) = radii(self.lat);
        Vector3::new(
            (other.lat - self.lat) * (rm + self.height),
            wrap_pi(other.lon - self.lon) * (rn + self.height) * cos(self.lat),
            self.height - other.height,
        )
    }

    /// Whether the numbers are a place: finite, |lat| ≤ 90°, |lon| ≤ 360°, height from −20 to 100 km.
    #[inline]
    pub fn is_valid(&self) -> bool {
        use core::f64::consts::{FRAC_PI_2, TAU};
        self.lat.abs() <= FRAC_PI_2
            && self.lon.abs() <= TAU
            && (-20_000.0..100_000.0).contains(&self.height)
    }
}

/// An angle \[rad\] wrapped to (−π, π].
///
/// ```
/// use undrift_nav::earth::wrap_pi;
/// // From a heading of 350° to one of 10° it is 20° to the right.
/// let turn = wrap_pi(10f64.to_radians() - 350f64.to_radians());
/// assert!((turn.to_degrees() - 20.0).abs() < 1e-9);
/// ```
#[inline]
pub fn wrap_pi(angle: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    let wrapped = angle - TAU * libm::floor((angle + PI) / TAU);
    if wrapped <= -PI {
        wrapped + TAU
    } else {
        wrapped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One rounding of a coordinate of 6.4e6 m is 9e-10 m; a few of them add up.
    const ECEF_TOLERANCE_M: f64 = 5e-9;

    #[test]
    fn ecef_round_trip_everywhere() {
        for lat_deg in [-90.0, -89.999_999, -45.0, -1e-9, 0.0, 30.5, 89.9, 90.0] {
            for lon_deg in [-180.0, -68.8, 0.0, 114.47, 179.999_999] {
                for height in [-400.0, 0.0, 20.9, 30_000.0] {
                    let there = Geodetic::from_degrees(lat_deg, lon_deg, height);
                    let back = Geodetic::from_ecef(&there.to_ecef());
                    let miss = (back.to_ecef() - there.to_ecef()).norm();
                    assert!(miss < ECEF_TOLERANCE_M, "{there:?} {miss}");
                    assert!((back.height - height).abs() < ECEF_TOLERANCE_M);
                }
            }
        }
    }

    #[test]
    fn gravity_at_equator_and_pole_is_the_published_constant() {
        assert!((gravity(0.0, 0.0) - GRAVITY_EQUATOR).abs() < 1e-12);
        let pole = gravity(core::f64::consts::FRAC_PI_2, 0.0);
        // The constants are published to ten decimals.
        assert!((pole - GRAVITY_POLE).abs() < 1e-9, "{pole}");
    }

    /// The second-order free-air correction of GRS80 as geodesy publishes it: Hinze et al. 2005, Geophysics 70(4), eq. 5,
    /// −(0.308 769 1 − 0.000 439 8 sin²φ) h + 7.2125e-8 h² mGal.
    #[test]
    fn gravity_falls_with_height_as_published() {
        for lat_deg in [0.0f64, 30.0, 45.0, 60.0, 90.0] {
            let lat = lat_deg.to_radians();
            let s2 = lat.sin() * lat.sin();
            for height in [-400.0, 1000.0, 5000.0] {
                let published =
                    -(0.308_769_1 - 0.000_439_8 * s2) * height + 7.2125e-8 * height * height;
                let ours = (gravity(lat, height) - gravity(lat, 0.0)) / 1e-5;
                // The published slope is a straight line in sin²φ, and of GRS80: 2e-5 of it.
                assert!((ours / published - 1.0).abs() < 1e-4, "{ours} {published}");
            }
        }
    }

    #[test]
    fn radii_are_the_curvature_of_the_ellipsoid() {
        let here = Geodetic::from_degrees(-32.83, -68.79, 700.0);
        for d in [
            Vector3::new(1.0, 0.0, 0.0),
            Vector3::new(0.0, 1.0, 0.0),
            Vector3::new(0.0, 0.0, 1.0),
        ] {
            // One metre along the local radii is one metre in ECEF up to curvature, 1 m / 6.4e6 m.
            let moved = here.ned_to(&here.displaced(&d));
            assert!((moved - d).norm() < 3e-7, "{moved}");
            assert!((here.offset_to(&here.displaced(&d)) - d).norm() < 1e-8);
        }
    }

    #[test]
    fn wrap() {
        use core::f64::consts::PI;
        assert_eq!(wrap_pi(PI), PI);
        assert_eq!(wrap_pi(-PI), PI);
        assert!((wrap_pi(3.0 * PI + 0.1) - (0.1 - PI)).abs() < 1e-12);
    }
}
