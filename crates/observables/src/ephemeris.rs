//! Place and clock of a satellite by its broadcast ephemeris.

use undrift_nav::{Vector3, earth::EARTH_RATE};

/// \[m/s\]
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// A GPS week \[s\].
const WEEK: f64 = 604_800.0;

/// A satellite system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum System {
    /// On L1 C/A.
    #[default]
    Gps,
    /// On E1.
    Galileo,
}

impl System {
    /// The Earth's gravitational constant by which its orbits are stated \[m³/s²\]: IS-GPS-200 table 20-IV, Galileo OS SIS ICD table 60.
    fn gm(self) -> f64 {
        match self {
            Self::Gps => 3.986_005e14,
            Self::Galileo => 3.986_004_418e14,
        }
    }
}

/// Broadcast ephemeris and clock of a satellite, names as in IS-GPS-200 tables 20-I and 20-II.
///
/// ```
/// use undrift_observables::Ephemeris;
/// // A circular orbit of the nominal radius: the satellite is 26 560 km from the Earth's centre.
/// let orbit = Ephemeris { sqrt_a: 5153.7, ..Ephemeris::default() };
/// let (place, clock) = orbit.at(900.0);
/// assert!((place.norm() - 5153.7_f64.powi(2)).abs() < 1e-6);
/// assert_eq!(clock, 0.0); // [s]
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ephemeris {
    /// Whose orbit it is.
    pub system: System,
    /// Issue of data.
    pub issue: u16,
    /// Whether the satellite calls itself healthy, and of a stated accuracy.
    pub healthy: bool,
    /// Time before and after `toe` for which it serves \[s\].
    pub serves_for: f64,
    /// Time of ephemeris \[s of the week\].
    pub toe: f64,
    /// Time of clock \[s of the week\].
    pub toc: f64,
    /// Clock: offset \[s\], drift, change of drift [1/s].
    pub af: [f64; 3],
    /// Group delay of the frequency \[s\].
    pub group_delay: f64,
    /// Square root of the semi-major axis [√m].
    pub sqrt_a: f64,
    /// Eccentricity.
    pub e: f64,
    /// Mean anomaly at `toe` \[rad\].
    pub m0: f64,
    /// Mean motion less the computed one [rad/s].
    pub delta_n: f64,
    /// Argument of perigee \[rad\].
    pub omega: f64,
    /// Longitude of the ascending node at the start of the week \[rad\].
    pub omega0: f64,
    /// Its rate [rad/s].
    pub omega_dot: f64,
    /// Inclination at `toe` \[rad\].
    pub i0: f64,
    /// Its rate [rad/s].
    pub i_dot: f64,
    /// Cosine and sine corrections of the argument of latitude \[rad\].
    pub cu: [f64; 2],
    /// Of the radius \[m\].
    pub cr: [f64; 2],
    /// Of the inclination \[rad\].
    pub ci: [f64; 2],
}

/// Time from one second of the week to another \[s\], the shorter way around the week.
pub fn since(time: f64, reference: f64) -> f64 {
    let span = time - reference;
    span - WEEK * (span / WEEK).round()
}

impl Ephemeris {
    /// Whether it serves at `time` \[s of the week\].
    pub fn serves(&self, time: f64) -> bool {
        self.healthy && since(time, self.toe).abs() <= self.serves_for
    }

    /// Whether its numbers are those of an orbit that does not touch the Earth, and its times within a week.
    pub(crate) fn is_possible(&self) -> bool {
        self.sqrt_a > 2530.0 && self.e < 0.1 && self.toe < WEEK && self.toc < WEEK
    }

    /// Place of the antenna \[m\], axes of the Earth at `time`, and offset of the clock \[s\] with relativity and the group delay,
    /// at `time` \[s of the week\] by the satellite's own clock.
    pub fn at(&self, time: f64) -> (Vector3, f64) {
        let by_clock = |time: f64| {
            let t = since(time, self.toc);
            self.af[0] + t * (self.af[1] + t * self.af[2])
        };
        let time = time - by_clock(time);
        let t = since(time, self.toe);
        let gm = self.system.gm();
        let a = self.sqrt_a * self.sqrt_a;
        let anomaly = self.m0 + t * ((gm / (a * a * a)).sqrt() + self.delta_n);
        // Kepler's equation by Newton's method: six steps reach rounding below an eccentricity of 0.1.
        let mut eccentric = anomaly;
        for _ in 0..6 {
            let off = eccentric - self.e * eccentric.sin() - anomaly;
            eccentric -= off / (1.0 - self.e * eccentric.cos());
        }
        let (sin_e, cos_e) = eccentric.sin_cos();
        let across = (1.0 - self.e * self.e).max(0.0).sqrt();
        let latitude = (across * sin_e).atan2(cos_e - self.e) + self.omega;
        let (sin2, cos2) = (2.0 * latitude).sin_cos();
        let harmonic = |[cosine, sine]: [f64; 2]| cosine * cos2 + sine * sin2;
        let (sin_u, cos_u) = (latitude + harmonic(self.cu)).sin_cos();
        let radius = a * (1.0 - self.e * cos_e) + harmonic(self.cr);
        let (sin_i, cos_i) = (self.i0 + self.i_dot * t + harmonic(self.ci)).sin_cos();
        let node = self.omega0 + (self.omega_dot - EARTH_RATE) * t - EARTH_RATE * self.toe;
        let (sin_n, cos_n) = node.sin_cos();
        let (x, y) = (radius * cos_u, radius * sin_u);
        let place = Vector3::new(
            x * cos_n - y * cos_i * sin_n,
            x * sin_n + y * cos_i * cos_n,
            y * sin_i,
        );
        // Relativity on an eccentric orbit.
        let light = SPEED_OF_LIGHT * SPEED_OF_LIGHT;
        let relativity = -2.0 * (gm * a).sqrt() / light * self.e * sin_e;
        let clock = by_clock(time) + relativity - self.group_delay;
        (place, clock)
    }
}
