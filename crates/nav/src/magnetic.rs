//! The Earth's main magnetic field: the World Magnetic Model 2025.
//!
//! The field of the core by spherical harmonics of degree 12, with their change from year to year; made by NOAA and the British
//! Geological Survey, in the public domain. It lacks what rocks, buildings and currents in the ionosphere add, some 0.15 µT outdoors
//! ([`UNMODELLED`]), and is made for 2025 to 2030: before and after it is extrapolated ([`uncertainty`]).
//!
//! Chulliat et al. 2025, The US/UK World Magnetic Model for 2025-2030, section 1.2: eq. 7 and 8 (geocentric), 10 to 12 (sums), 17 (axes).
//!
//! ```
//! use undrift_nav::{earth::Geodetic, magnetic};
//! let zurich = Geodetic::from_degrees(47.4, 8.5, 500.0);
//! let field = magnetic::field(&zurich, 2026.0); // North, east, down [T].
//! let declination = field.y.atan2(field.x).to_degrees();
//! assert!((3.0..4.5).contains(&declination) && (field.norm() * 1e6 - 48.7).abs() < 0.5); // [µT]
//! ```

use crate::{Vector3, earth::Geodetic};
use libm::{pow, sincos, sqrt};

/// Year that the coefficients are of.
pub const EPOCH: f64 = 2025.0;
/// Standard deviation of what the model leaves out, each axis \[T\].
pub const UNMODELLED: f64 = 0.15e-6;
/// Change of the field's rate of change that an extrapolation misses, each axis \[T\] a year.
const EXTRAPOLATED: f64 = 0.03e-6;
/// Mean radius of the Earth that the coefficients are for \[m\].
const RADIUS: f64 = 6_371_200.0;
/// Degree of the harmonics.
const DEGREE: usize = 12;
/// g, h [0.1 nT] and their change \[0.1 nT a year\], of degree 1 to 12 and order 0 to the degree.
#[rustfmt::skip]
const COEFFICIENTS: [[i32; 4]; 90] = [
    // 1
    [-293518, 0, 120, 0], [-14108, 45454, 97, -215],
    // 2
    [-25566, 0, -116, 0], [29511, -31336, -52, -277], [16493, -8151, -80, -121],
    // 3
    [13610, 0, -13, 0], [-24041, -566, -42, 40], [12438, 2375, 4, -3], [4536, -5495, -156, -41],
    // 4
    [8950, 0, -16, 0], [7995, 2786, -24, -11], [557, -1339, -60, 41], [-2811, 2120, 56, 16], [121, -3756, -70, -44],
    // 5
    [-2332, 0, 6, 0], [3689, 454, 14, -5], [1872, 2202, 0, 22], [-1387, -1229, 6, 4], [-1420, 430, 22, 17],
    [209, 1061, 9, 19],
    // 6
    [644, 0, -2, 0], [638, -184, -4, 3], [769, 168, 9, -16], [-1157, 488, 12, -4], [-409, -598, -9, 9],
    [149, 109, 3, 7], [-607, 727, 9, 9],
    // 7
    [795, 0, 0, 0], [-770, -489, -1, 6], [-88, -144, -1, 5], [593, -10, 5, -8], [158, 234, -1, 0], [25, -74, -8, -10],
    [-111, -251, -8, 6], [142, -23, 8, -2],
    // 8
    [232, 0, -1, 0], [108, 71, 2, -2], [-175, -126, 0, 5], [20, 114, 5, -4], [-217, -97, -1, 4], [169, 127, 3, -5],
    [150, 7, 2, -6], [-168, -52, 0, 3], [9, 39, 2, 2],
    // 9
    [46, 0, 0, 0], [78, -248, -1, -3], [30, 122, 1, 3], [-2, 83, 3, -3], [-25, -33, -3, 3], [-131, -52, 0, 2],
    [24, 72, 3, -1], [86, -6, -1, -2], [-87, 8, 1, 4], [-129, 100, -1, 1],
    // 10
    [-13, 0, 1, 0], [-64, 33, 0, 0], [2, 0, 1, 0], [20, 24, 1, -2], [-10, 53, 0, 1], [-6, -91, -3, -1], [-9, 4, 0, 1],
    [15, -42, -1, 0], [9, -38, -1, -1], [-27, 9, 0, 2], [-39, -91, 0, 0],
    // 11
    [29, 0, 0, 0], [-15, 0, 0, 0], [-25, 29, 0, 1], [24, -6, 0, 0], [-6, 2, 0, 1], [-1, 5, -1, 0], [-6, -3, 0, 0],
    [-1, -12, 0, 1], [11, -17, -1, 0], [-10, -29, -1, 0], [-2, -18, -1, 0], [26, -23, -1, 0],
    // 12
    [-20, 0, 0, 0], [-2, -13, 0, 0], [3, 7, 0, 0], [12, 10, 0, -1], [-13, -14, 0, 1], [6, 0, 0, 0], [6, 6, 1, 0],
    [5, -1, 0, 0], [-1, 8, 0, 0], [-4, 1, 0, 0], [-2, -10, -1, 0], [-13, 1, 0, 0], [-7, 2, -1, -1],
];

/// The field north, east, down \[T\] at a place, in a `year` with its fraction.
pub fn field(place: &Geodetic, year: f64) -> Vector3 {
    let r = place.to_ecef();
    let (distance, level) = (r.norm(), sqrt(r.x * r.x + r.y * r.y));
    // Sine and cosine of the geocentric latitude; at the poles there is no east.
    let (sin, cos) = (r.z / distance, (level / distance).max(1e-9));
    let years = year - EPOCH;
    let (mut north, mut east, mut down) = (0.0, 0.0, 0.0);
    // Schmidt's functions P of one order after the other, with their derivatives by the latitude.
    let (mut diagonal, mut slope_of_diagonal) = (1.0, 0.0);
    for order in 0..=DEGREE {
        let m = order as f64;
        if order > 0 {
            let factor = match order {
                1 => 1.0,
                _ => sqrt(1.0 - 0.5 / m),
            };
            slope_of_diagonal = factor * (cos * slope_of_diagonal - sin * diagonal);
            diagonal *= factor * cos;
        }
        let (sin_m, cos_m) = sincos(m * place.lon);
        let (mut p, mut slope) = ([0.0, diagonal], [0.0, slope_of_diagonal]);
        for degree in order..=DEGREE {
            let n = degree as f64;
            if degree > order {
                let [before, last] = p;
                let [slope_before, slope_last] = slope;
                let (all, less) = (sqrt(n * n - m * m), sqrt((n - 1.0) * (n - 1.0) - m * m));
                let next = |by: f64, before: f64| ((2.0 * n - 1.0) * by - less * before) / all;
                p = [last, next(sin * last, before)];
                slope = [
                    slope_last,
                    next(sin * slope_last + cos * last, slope_before),
                ];
            }
            if degree == 0 {
                continue;
            }
            // The first row of a degree is behind those of all lower ones.
            let [g, h, g_rate, h_rate] =
                COEFFICIENTS[degree * (degree + 1) / 2 - 1 + order].map(f64::from);
            let (g, h) = (g + g_rate * years, h + h_rate * years);
            let near = pow(RADIUS / distance, n + 2.0);
            let along = near * (g * cos_m + h * sin_m);
            north -= along * slope[1];
            east += near * m * (g * sin_m - h * cos_m) * p[1] / cos;
            down -= (n + 1.0) * along * p[1];
        }
    }
    // From the axes of the sphere to those of the ellipsoid.
    let (sin_lat, cos_lat) = sincos(place.lat);
    let (sin_turn, cos_turn) = (sin * cos_lat - cos * sin_lat, cos * cos_lat + sin * sin_lat);
    Vector3::new(
        north * cos_turn - down * sin_turn,
        east,
        north * sin_turn + down * cos_turn,
    ) * 1e-10
}

/// Standard deviation of [`field`], each axis \[T\]: what it leaves out, and beyond the five years that it is made for what it
/// extrapolates.
pub fn uncertainty(year: f64) -> f64 {
    let beyond = (EPOCH - year).max(year - EPOCH - 5.0).max(0.0);
    libm::hypot(UNMODELLED, EXTRAPOLATED * beyond)
}
