//! Coarse starts for a window of positions that is too long for a search from all headings: gyros just switched on may turn it
//! by many times what such a search can undo.
//!
//! Two things are found one after the other. First level and the gyros' biases across gravity: the mean specific force of a few seconds is
//! gravity but for what the velocity changed by, and a bias turns it away from block to block. Then heading and the bias
//! about gravity: the positions are, as complex numbers over ground, a linear function of a start, a velocity, the
//! sensors' own path turned by the heading, and of what is wrong with level and biases, so that for each bias
//! about gravity the best heading has a closed form, and its cost. A turn that fits does not stretch the path:
//! that the factor's size is 1 counts as a measurement. The minima over the bias are the starts;
//! [`super::wahba`] improves them, and they are judged by its costs alone.

use super::{
    segments::Segment,
    wahba::{Guess, Minimum, Problem, minima},
};
use alloc::vec::Vec;
use nalgebra::{Complex, SMatrix, SVector};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, skew},
};

/// Length of the means of specific force \[s\]: several steps of a walker, waves of a boat.
const BLOCK: f64 = 5.0;
/// Standard deviation of such a mean from gravity beside what the velocity changed by \[m/s²\].
const FORCE: f64 = 0.1;
/// Turn of the body over a window, net, one standard deviation \[rad\]: what is known of a bias about gravity before the scan.
const NET_TURN: f64 = core::f64::consts::PI;
/// Improvements of the level.
const ROUNDS: usize = 6;
/// Step of the scan, as the angle that it turns the window by \[rad\], and its range in standard deviations of the bias.
const STEP: f64 = 0.5;
const RANGE: f64 = 2.5;
/// What level and biases may still be wrong by, one standard deviation: specific force over ground \[m/s²\] in the axes of n …
const TILT: f64 = 0.5;
/// … in those of the body, beside the accelerometers' own biases …
const LEAN: f64 = 0.3;
/// … and its growth there \[m/s³\].
const DRIFT: f64 = 0.1;

/// Starts about a level that is hardly known, and about a solution, at most.
const FIRST: usize = 8;
const MOST: usize = 32;
/// Starts whose linear fit costs this many times what sets a rival apart above the best may become the best.
const RIVALS: f64 = 4.0;

type C = Complex<f64>;
/// Start, velocity, tilt in n, factor of the sensors' own path, specific force in body axes, its growth.
const UNKNOWNS: usize = 6;
const FACTOR: usize = 3;

/// The minima of a window of positions from coarse starts, best first: those about the level that the specific force shows, and all
/// that may rival the best of them, whose squared residuals have to be less by `rival`.
///
/// `segments_about` has the window's segments linear about a gyro bias [rad/s]. Empty where
/// nothing moves, or too many are rivals.
pub(super) fn solve(
    segments_about: impl Fn(&Vector3) -> Vec<Segment>,
    problem: &Problem,
    rival: f64,
) -> Vec<Minimum> {
    let scan = |guess: &Guess| {
        let accel = problem.accel.1.max();
        scan(guess, &segments_about(&guess.gyro), &problem.gyro, accel)
    };
    let refined = |(_, guess): (f64, Guess)| {
        let segments = segments_about(&guess.gyro);
        let problem = Problem {
            segments: &segments,
            reference: guess.gyro,
            ..*problem
        };
        problem.refine(&guess)
    };
    let Some(level) = levelled(&segments_about, &problem.gyro) else {
        return Vec::new();
    };
    let first = minima(scan(&level).into_iter().take(FIRST).map(refined));
    let Some(best) = first.first() else {
        return Vec::new();
    };
    let again = scan(&best.guess);
    let least = again.first().map_or(0.0, |(cost, _)| *cost);
    let rivals = again
        .iter()
        .take_while(|(cost, _)| *cost < least + RIVALS * rival);
    let rivals = rivals.count();
    if rivals > MOST {
        return Vec::new();
    }
    minima(again.into_iter().take(rivals).map(refined).chain(first))
}

/// Guesses at the start of a window of positions about one of them, those first whose positions fit best: other headings, and other
/// gyro biases about gravity, each with the cost of its linear fit.
///
/// `segments` are linear about the guess's gyro bias; `gyro` is its prior, mean and variances [rad/s], `accel` the
/// variance of the accelerometers' biases \[m²/s⁴\].
fn scan(
    about: &Guess,
    segments: &[Segment],
    gyro: &(Vector3, Vector3),
    accel: f64,
) -> Vec<(f64, Guess)> {
    let path = Path::new(about, segments);
    // A bias that reads too much about down makes the path turn too little.
    let along = gyro.1.component_mul(&path.down).dot(&path.down);
    let middle = (about.gyro - gyro.0).dot(&path.down);
    let step = STEP / path.length;
    let count = (RANGE * along.sqrt() / step).ceil() as i32;
    let fits = (-count..=count).filter_map(|k| {
        let rate = middle + step * f64::from(k);
        let (cost, heading) = path.fit(rate, accel)?;
        Some((cost + (middle - rate).powi(2) / along, heading, rate))
    });
    let fits: Vec<(f64, f64, f64)> = fits.collect();
    let cost = |k: usize| fits.get(k).map_or(f64::INFINITY, |(cost, ..)| *cost);
    let is_least = |k: &usize| cost(*k) < cost(k.wrapping_sub(1)) && cost(*k) <= cost(k + 1);
    let mut best: Vec<_> = (0..fits.len()).filter(is_least).map(|k| fits[k]).collect();
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let guess = |(cost, heading, rate): (f64, f64, f64)| {
        let turn = from_rotation_vector(&(Vector3::z() * heading));
        let guess = Guess {
            q_nb: turn * about.q_nb,
            gyro: about.gyro - path.down * rate,
            accel: about.accel,
        };
        (cost, guess)
    };
    best.into_iter().map(guess).collect()
}

/// Level of a window's start, of arbitrary azimuth, and the gyro bias across gravity, by the mean specific force.
///
/// `segments_about` has the window's segments linear about a gyro bias; `gyro` is its prior, mean and variances [rad/s].
/// `None` without motion or samples.
fn levelled(
    segments_about: impl Fn(&Vector3) -> Vec<Segment>,
    gyro: &(Vector3, Vector3),
) -> Option<Guess> {
    let segments = segments_about(&gyro.0);
    let length: f64 = segments.iter().map(|s| s.motion.dt).sum();
    let turned = segments.iter().map(|s| s.motion.turn.scaled_axis());
    // But for a net turn.
    let mean = gyro.0 + turned.sum::<Vector3>() / length;
    let net = (NET_TURN / length).powi(2);
    let mut bias = mean;
    let mut up = Vector3::zeros();
    for _ in 0..ROUNDS {
        let segments = segments_about(&bias);
        let mut information = SMatrix::<f64, 6, 6>::zeros();
        let mut gradient = SVector::<f64, 6>::zeros();
        let blocks = blocks(&segments);
        let force = blocks.iter().map(|block| block.force).sum::<Vector3>();
        let force = force / (blocks.len() as f64);
        for block in &blocks {
            let by_bias = skew(&force) * block.by_bias;
            let mut row = SMatrix::<f64, 3, 6>::zeros();
            row.fixed_view_mut::<3, 3>(0, 0)
                .copy_from(&Matrix3::identity());
            row.fixed_view_mut::<3, 3>(0, 3).copy_from(&by_bias);
            information += row.transpose() * row / block.variance;
            gradient += row.transpose() * block.force / block.variance;
        }
        for i in 0..3 {
            let known = 1.0 / net + 1.0 / gyro.1[i];
            information[(3 + i, 3 + i)] += known;
            let (by_turn, by_prior) =
                ((mean[i] - bias[i]) / net, (gyro.0[i] - bias[i]) / gyro.1[i]);
            gradient[3 + i] += by_turn + by_prior;
        }
        let found = information.cholesky()?.solve(&gradient);
        up = found.fixed_rows::<3>(0).into();
        bias += found.fixed_rows::<3>(3);
    }
    let level = Quaternion::rotation_between(&up, &-Vector3::z())
        .unwrap_or_else(|| from_rotation_vector(&(Vector3::x() * core::f64::consts::PI)));
    Some(Guess {
        q_nb: level,
        gyro: bias,
        accel: Vector3::zeros(),
    })
}

/// Mean specific force of some seconds in the axes of the window's start \[m/s²\], its variance as a measurement of gravity, and
/// the rotation vector of its axes by the gyro bias \[s\].
struct Block {
    force: Vector3,
    variance: f64,
    by_bias: Matrix3,
}

fn blocks(segments: &[Segment]) -> Vec<Block> {
    let mut blocks = Vec::new();
    let (mut turn, mut by_bias) = (Quaternion::identity(), Matrix3::zeros());
    let (mut force, mut weighed, mut span) = (Vector3::zeros(), Matrix3::zeros(), 0.0);
    let mut before = segments.first().map_or_else(Vector3::zeros, |s| s.fix.v_n);
    for s in segments {
        let dt = s.motion.dt;
        force += turn * s.motion.dvel;
        weighed += by_bias * (0.5 * dt);
        turn *= s.motion.turn;
        by_bias += turn.to_rotation_matrix().into_inner() * s.motion.turn_by_g;
        weighed += by_bias * (0.5 * dt);
        span += dt;
        if span >= BLOCK {
            let change = (s.fix.v_n - before).xy().norm() / span;
            blocks.push(Block {
                force: force / span,
                variance: FORCE * FORCE + change * change,
                by_bias: weighed / span,
            });
            before = s.fix.v_n;
            (force, weighed, span) = (Vector3::zeros(), Matrix3::zeros(), 0.0);
        }
    }
    blocks
}

/// What the sensors and the positions say over ground, as complex numbers north + i east in a level frame.
struct Path {
    /// Length of the window \[s\].
    length: f64,
    /// Down in body axes, by the mean specific force.
    down: Vector3,
    steps: Vec<Step>,
}

/// A segment over ground, before it is turned.
struct Step {
    dt: f64,
    /// Change of velocity \[m/s\] and of place \[m\] by specific force.
    dvel: C,
    dpos: C,
    /// Turn of the body about down.
    axis: C,
    /// Position at its end \[m\], and one over its variance \[1/m²\].
    place: C,
    weight: f64,
}

impl Path {
    fn new(about: &Guess, segments: &[Segment]) -> Self {
        let over_ground = |v: &Vector3| C::new(v.x, v.y);
        let (mut q, mut length, mut force) = (about.q_nb, 0.0, Vector3::zeros());
        // A body axis that lies level at the start.
        let across = q.inverse() * Vector3::x();
        let mut steps = Vec::new();
        for s in segments {
            let motion = &s.motion;
            let next = q * motion.turn;
            let axis = over_ground(&(q * across + next * across));
            steps.push(Step {
                dt: motion.dt,
                dvel: over_ground(&(q * (motion.dvel + motion.dvel_by_a * about.accel))),
                dpos: over_ground(&(q * (motion.dpos + motion.dpos_by_a * about.accel))),
                axis: axis / axis.norm_sqr().sqrt().max(1e-9),
                place: over_ground(&s.fix.place),
                weight: 2.0 / s.fix.variance.xy().sum(),
            });
            force += motion.dvel;
            length += motion.dt;
            q = next;
        }
        Self {
            length,
            down: -force.try_normalize(1e-9).unwrap_or(-Vector3::z()),
            steps,
        }
    }

    /// Cost and heading of the best fit with a body that turns about down by `rate` \[rad/s\] faster than the steps do.
    fn fit(&self, rate: f64, accel: f64) -> Option<(f64, f64)> {
        type Row = SVector<C, UNKNOWNS>;
        let real = |value: f64| C::new(value, 0.0);
        let mut information = SMatrix::<C, UNKNOWNS, UNKNOWNS>::zeros();
        let stds = [TILT, LEAN.hypot(accel.sqrt()), DRIFT];
        for (at, std) in [2, 4, 5].into_iter().zip(stds) {
            information[(at, at)] = real(1.0 / (std * std));
        }
        let mut gradient = Row::zeros();
        let mut power = 0.0;
        let mut t = 0.0;
        // Place and velocity by path, body force, and its growth with what it has grown to.
        let mut places = [C::default(); 3];
        let mut velocities = [C::default(); 3];
        let mut grown = C::default();
        for step in &self.steps {
            let dt = step.dt;
            let angle = rate * (t + 0.5 * dt);
            let turn = C::new(angle.cos(), angle.sin());
            let axis = step.axis * turn;
            let forces = [axis, grown + axis * (0.5 * dt)];
            let pushes = [
                (step.dvel * turn, step.dpos * turn),
                (forces[0] * dt, forces[0] * (0.5 * dt * dt)),
                (forces[1] * dt, forces[1] * (0.5 * dt * dt)),
            ];
            for (i, (dvel, dpos)) in pushes.into_iter().enumerate() {
                places[i] += velocities[i] * dt + dpos;
                velocities[i] += dvel;
            }
            grown += axis * dt;
            t += dt;
            let row = Row::from([
                real(1.0),
                real(t),
                real(0.5 * t * t),
                places[0],
                places[1],
                places[2],
            ]);
            let weighed = row.map(|of| of.conj() * step.weight);
            information += weighed * row.transpose();
            gradient += weighed * step.place;
            power += step.weight * step.place.norm_sqr();
        }
        let factors = information.cholesky()?;
        let found = factors.solve(&gradient);
        let mut unit = Row::zeros();
        unit[FACTOR] = real(1.0);
        let variance = factors.solve(&unit)[FACTOR].re;
        let factor = found[FACTOR];
        let stretched = (factor.norm_sqr().sqrt() - 1.0).powi(2) / variance;
        let cost = power - gradient.dotc(&found).re + stretched;
        cost.is_finite()
            .then_some((cost, factor.im.atan2(factor.re)))
    }
}
