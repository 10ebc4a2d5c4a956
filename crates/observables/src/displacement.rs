//! The way of the antenna between two epochs by the carrier phase, differenced in time.
//!
//! A phase is `λφ = ρ + c dt_r − c dt_s + λN + T − I`: in its change from one epoch to the next the whole number N cancels while the
//! phase is tracked. With the satellite's places s₀, s₁ and the antenna's p₀ = p₁ − Δr, p₁ being a fix of the receiver,
//!
//! `λΔφ + c Δdt_s − ΔT = |s₁ − p₁| − |s₀ − p₁ + Δr| + c Δdt_r`
//!
//! for each satellite: exact in the geometry of both epochs, with four unknowns, by weighted least squares. A fix wrong by 10 m makes it
//! wrong by 2 mm a second, as the line of sight turns. The dry and wet troposphere is a standard one; what the ionosphere changes is
//! in the standard deviations.
//!
//! A slip is what the receiver says (time of lock, half cycles), and what the residuals say: a sum of squares that chance exceeds once in
//! a thousand epochs. Then the satellite without which the sum is least goes, while two satellites too many are left. The range's
//! change of a satellite that slipped is that of its Doppler shift, with a standard deviation to match. What is left of the sum scales the
//! covariance.
//!
//! Of two to four satellites nothing can be checked, and of two or three a part of the way is open: the differences of the equations, which do
//! without the receiver's clock, give one or two directions. The others get the way that was expected, to 100 m/s.

use crate::{Ephemerides, Epoch, L1_WAVELENGTH, Observation, SPEED_OF_LIGHT, ephemeris::Ephemeris};
use nalgebra::{Matrix4, Matrix4x3, Vector4};
use undrift_nav::{
    Matrix3, Vector3,
    earth::{EARTH_RATE, Geodetic},
};

/// Elevation mask \[rad\].
const LOWEST: f64 = 10.0 / 180.0 * std::f64::consts::PI;
/// Multipath of a phase at the zenith \[m\], of an antenna that is carried under trees; lower it grows by 1/sin of the elevation.
const MULTIPATH: f64 = 0.003;
/// Factor on the standard deviation of what is found: multipath that satellites share, and slips that chance explains.
const SHARED: f64 = 1.4;
/// The same of what nothing checks.
const UNCHECKED: f64 = 2.0;
/// Residuals by which the stated noise counts against those that are there.
const PRIOR: f64 = 4.0;
/// Standard deviation of a direction that no satellite shows [m/s].
const OPEN: f64 = 100.0;
/// What is left of the change of troposphere and ionosphere at the zenith, in the same way [m/s].
const ATMOSPHERE: f64 = 0.001;
/// Standard deviation of a change of range by the Doppler shifts at both ends [m/s]: 0.15 from one to the next, but a receiver's loop lags, so that errors last.
const DOPPLER: f64 = 0.5;
/// Epochs further apart than this are not differenced \[s\].
const LONGEST: f64 = 2.0;
/// Epochs closer than this are one \[s\].
const SHORTEST: f64 = 0.02;
/// Standard normal deviate that chance exceeds once in a thousand times.
const CHANCE: f64 = 3.09;
/// Satellites that may slip unnoticed by the receiver at once.
const MOST_SLIPS: usize = 3;

/// Way of the antenna between two epochs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// Time between the epochs \[s\].
    pub over: f64,
    /// From the first to the second epoch, north, east, down at the second \[m\].
    pub ned: Vector3,
    /// Its covariance \[m²\].
    pub covariance: Matrix3,
    /// Change of the receiver's clock \[m\].
    pub clock: f64,
    /// Satellites by their phase.
    pub satellites: usize,
    /// Satellites by their Doppler shift, since the phase slipped.
    pub by_doppler: usize,
    /// By how much the way changes with the place that it was found for, north, east, down of both \[m/m\]: some 1e-4 a second.
    pub by_place: Matrix3,
}

impl Displacement {
    /// Whether there were satellites enough to check one by the others: five.
    pub fn is_checked(&self) -> bool {
        self.satellites + self.by_doppler > UNKNOWNS
    }
}

/// The way and the clock.
const UNKNOWNS: usize = 4;

/// One satellite's equation.
#[derive(Clone, Copy)]
struct Row {
    /// Its places at both epochs \[m\], axes of the Earth when the signal arrived.
    places: [Vector3; 2],
    /// Change of the range and of the receiver's clock \[m\], by phase or Doppler shift, without satellite clock and troposphere.
    change: f64,
    /// Standard deviation \[m\].
    std: f64,
    by_doppler: bool,
}

/// Way of the antenna from epoch `before` to `after`, by satellites of which `ephemerides` knows the orbit. `place` is the antenna's at
/// `after` to some metres, `v_n` its velocity to some [m/s], north, east, down.
///
/// `None` where it cannot be had: epochs further apart than 2 s, fewer than two satellites, residuals that contradict each other.
pub fn displacement(
    ephemerides: &Ephemerides,
    before: &Epoch,
    after: &Epoch,
    place: &Geodetic,
    v_n: &Vector3,
) -> Option<Displacement> {
    let over = after.time - before.time;
    if !(SHORTEST..=LONGEST).contains(&over) || !place.is_valid() {
        return None;
    }
    let ned_from_ecef = place.ned_from_ecef();
    let here = place.to_ecef();
    let about = ned_from_ecef.tr_mul(&(v_n * over));
    let row = |now: &Observation| {
        let mut earlier = before.observations.iter();
        let then = earlier.find(|then| then.satellite == now.satellite)?;
        let orbit = ephemerides.of(now.satellite, after.time)?;
        row(
            orbit,
            [(before.time, then), (after.time, now)],
            &here,
            &about,
            &ned_from_ecef,
        )
    };
    let mut rows: Vec<Row> = after.observations.iter().filter_map(row).collect();
    let open = OPEN * over;
    for _ in 0..=MOST_SLIPS {
        let found = solve(&rows, &here, &about, open)?;
        let freedom = rows.len().saturating_sub(UNKNOWNS);
        if freedom == 0 || found.squares <= exceeded_by_chance(freedom) {
            let by_doppler = rows.iter().filter(|row| row.by_doppler).count();
            let scale = match freedom {
                0 => UNCHECKED * UNCHECKED,
                _ => SHARED * SHARED * (PRIOR + found.squares) / (PRIOR + freedom as f64),
            };
            let covariance = found.covariance.fixed_view::<3, 3>(0, 0) * scale;
            return Some(Displacement {
                over,
                ned: ned_from_ecef * found.way,
                covariance: ned_from_ecef * covariance * ned_from_ecef.transpose(),
                clock: found.clock,
                satellites: rows.len() - by_doppler,
                by_doppler,
                by_place: ned_from_ecef * found.by_place * ned_from_ecef.transpose(),
            });
        }
        let worst = without_worst(&rows, &here, &about, open)?;
        rows.remove(worst);
    }
    None
}

/// The equation of a satellite; `None` of one that is low, or seen by neither phase nor Doppler shift.
fn row(
    orbit: &Ephemeris,
    [then, now]: [(f64, &Observation); 2],
    here: &Vector3,
    about: &Vector3,
    ned_from_ecef: &Matrix3,
) -> Option<Row> {
    let at = |(time, seen): (f64, &Observation), antenna: Vector3| {
        // The satellite's own clock when the signal left: no matter what the receiver's is.
        let (place, clock) = orbit.at(time - seen.pseudorange / SPEED_OF_LIGHT);
        // The Earth turned while the signal came.
        let turn = EARTH_RATE * (place - antenna).norm() / SPEED_OF_LIGHT;
        let (sin, cos) = turn.sin_cos();
        let turned = Vector3::new(
            cos * place.x + sin * place.y,
            cos * place.y - sin * place.x,
            place.z,
        );
        let line = turned - antenna;
        let sin_elevation = -(ned_from_ecef * line).z / line.norm();
        (turned, SPEED_OF_LIGHT * clock, sin_elevation)
    };
    let (from, clock_then, sin_then) = at(then, here - about);
    let (to, clock_now, sin_now) = at(now, *here);
    let over = now.0 - then.0;
    if sin_now < LOWEST.sin() || !(from - to).norm().is_finite() {
        return None;
    }
    let (then, now) = (then.1, now.1);
    let tracked = now.lock >= then.lock.min(over)
        && now.lock > 0.0
        && now.half_subtracted == then.half_subtracted;
    let phases = then.phase.zip(now.phase).filter(|_| tracked);
    let lower = 1.0 / sin_now;
    let rest = ATMOSPHERE * over * lower;
    let (change, std) = match phases {
        Some((then_cycles, now_cycles)) => {
            let receiver = L1_WAVELENGTH * then.phase_std.hypot(now.phase_std);
            let multipath = std::f64::consts::SQRT_2 * MULTIPATH * lower;
            let std = receiver.hypot(multipath).hypot(rest);
            (L1_WAVELENGTH * (now_cycles - then_cycles), std)
        }
        None => {
            let rate = -L1_WAVELENGTH * 0.5 * (then.doppler + now.doppler);
            (rate * over, DOPPLER * over)
        }
    };
    let change = change + clock_now - clock_then - (troposphere(sin_now) - troposphere(sin_then));
    (change.is_finite() && std.is_finite() && std > 0.0).then_some(Row {
        places: [from, to],
        change,
        std,
        by_doppler: phases.is_none(),
    })
}

/// Delay by the troposphere \[m\]: 2.4 m at the zenith, lower by the mapping of Black and Eisner (RTCA DO-229D, A.4.2.4).
fn troposphere(sin_elevation: f64) -> f64 {
    2.4 * 1.001 / (0.002_001 + sin_elevation * sin_elevation).sqrt()
}

/// What least squares found.
struct Solved {
    way: Vector3,
    clock: f64,
    covariance: Matrix4<f64>,
    /// How the way changes with the place \[m/m\].
    by_place: Matrix3,
    /// Sum of the squared residuals in standard deviations.
    squares: f64,
}

/// Least squares of at least two rows, with the way `about`, known to `open` \[m\].
fn solve(rows: &[Row], here: &Vector3, about: &Vector3, open: f64) -> Option<Solved> {
    if rows.len() < 2 {
        return None;
    }
    let known = Vector4::new(1.0, 1.0, 1.0, 0.0) / (open * open);
    let (mut way, mut clock) = (*about, 0.0);
    // Linear but for the curvature of the ranges: the second step changes it by less than a micrometre.
    for _ in 0..3 {
        let mut normal = Matrix4::from_diagonal(&known);
        let mut right = known.component_mul(&(about - way).push(0.0));
        let mut turned = Matrix4x3::zeros();
        let mut squares = 0.0;
        for row in rows {
            let line = row.places[0] - here + way;
            let change = (row.places[1] - here).norm() - line.norm() + clock;
            let residual = (row.change - change) / row.std;
            let toward = -line / line.norm();
            let h = Vector4::new(toward.x, toward.y, toward.z, 1.0) / row.std;
            normal += h * h.transpose();
            right += h * residual;
            let later = row.places[1] - here;
            turned += h * (later / later.norm() + toward).transpose() / row.std;
            squares += residual * residual;
        }
        let covariance = normal.cholesky()?.inverse();
        let step = covariance * right;
        way += step.xyz();
        clock += step.w;
        squares -= right.dot(&step);
        if step.xyz().norm() < 1e-6 {
            let squares = squares.max(0.0);
            return Some(Solved {
                way,
                clock,
                covariance,
                by_place: (covariance * turned).fixed_view::<3, 3>(0, 0).into_owned(),
                squares,
            });
        }
    }
    None
}

/// The row without which the sum of squares is least, where two too many leave that to be known.
fn without_worst(rows: &[Row], here: &Vector3, about: &Vector3, open: f64) -> Option<usize> {
    if rows.len() < UNKNOWNS + 2 {
        return None;
    }
    let squares = |at: usize| {
        let mut others = rows.to_vec();
        others.remove(at);
        solve(&others, here, about, open).map_or(f64::INFINITY, |found| found.squares)
    };
    let all: Vec<f64> = (0..rows.len()).map(squares).collect();
    (0..rows.len()).min_by(|a, b| all[*a].total_cmp(&all[*b]))
}

/// The sum of squares of so many degrees of freedom that chance exceeds once in a thousand times, after Wilson and Hilferty (1931).
fn exceeded_by_chance(freedom: usize) -> f64 {
    let n = freedom as f64;
    let spread = 2.0 / (9.0 * n);
    n * (1.0 - spread + CHANCE * spread.sqrt()).powi(3)
}
