//! Attitude and biases from velocity changes: what Wahba's problem becomes when the gyros that carry the
//! attitude have an unknown bias.
//!
//! GNSS gives the velocity changes in `n`, the sensors the same changes in the axes of the window's
//! start (`Segment`): the attitude between them is found (optimisation-based alignment, Wu & Pan
//! 2013). A turn-on bias of degrees a second turns the window about, so attitude at the start,
//! gyro bias and accelerometer bias are one nonlinear least-squares problem, solved by
//! Levenberg-Marquardt from many headings; a second minimum as good as the first means wait.
//!
//! The sensors' white noise makes velocity and attitude wander on the way. Both are states of a Kalman
//! filter that whitens the residuals, and the parameters' effect runs through it beside the
//! data: generalised least squares (Rosenberg 1973; de Jong 1991). Where fixes have no velocity, the position and the
//! time by which it is late are states of that filter, too. All is linear about one trajectory, so
//! nothing becomes certain by moving the point of linearisation, as in an extended filter that starts
//! with a wide heading.
//!
//! Unknowns, nine in this order: attitude error at the start in body axes \[rad\], gyro bias
//! [rad/s], accelerometer bias [m/s²]. Residuals: three a fix, whitened. Cost of one linearisation
//! O(segments · S²), S = 6 or 13 states. It fails, with more than one minimum or none, where the
//! window has too little change of velocity: a straight drive at constant speed fits any heading.
//!
//! Used by [`super::motion`] alone. It holds no state between calls: the same window gives the same
//! result.

mod whitening;

use super::segments::Segment;
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::SMatrix;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, skew},
    earth::{Geodetic, LocalEarth},
};
use whitening::{
    ARM, BY_POSITION, BY_VELOCITY, Information, LATE, Linearised, PLACE, Transition, Unknowns, add,
};

/// Attitude at the start of the window and constant biases in it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Guess {
    /// Body to navigation.
    pub(super) q_nb: Quaternion,
    /// What the gyros read too much [rad/s].
    pub(super) gyro: Vector3,
    /// What the accelerometers read too much [m/s²].
    pub(super) accel: Vector3,
}

/// Iterations of one solution, at most.
const ITERATIONS: usize = 20;
/// Headings that the search starts from.
const HEADINGS: usize = 12;
/// What is known of the first velocity before the positions show it, one standard deviation \[m/s\].
const UNKNOWN_VELOCITY: f64 = 300.0;
/// What is known of the first place against that of the first fix, one standard deviation \[m\].
const UNKNOWN_PLACE: f64 = 1000.0;
/// Attitudes within this angle are the same minimum \[rad\].
const SAME: f64 = 0.15;
/// Two searches whose attitudes are within this angle, at the start and at the end of a part of the window, have reached the same
/// minimum of it \[rad\].
const REACHED: f64 = 0.02;

/// A guess that has been improved, and what it costs.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Minimum {
    pub(super) guess: Guess,
    /// Attitude at the end of the window.
    pub(super) end: Quaternion,
    /// Sum of squared whitened residuals, prior included.
    pub(super) cost: f64,
}

/// Everything but the guess.
///
/// Valid for windows of a minute or so: gravity and the Earth's rate are taken at one place, the
/// biases as constant.
pub(super) struct Problem<'a> {
    /// Segments in order of time; the first one is the start.
    pub(super) segments: &'a [Segment],
    /// Gyro bias about which they are linear [rad/s].
    pub(super) reference: Vector3,
    /// Approximate place, for gravity and the Earth's rate.
    pub(super) place: Geodetic,
    /// IMU → antenna, body axes \[m\].
    pub(super) lever_arm: Vector3,
    /// Prior means and variances of gyro and accelerometer bias.
    pub(super) gyro: (Vector3, Vector3),
    pub(super) accel: (Vector3, Vector3),
    /// Squared densities of the sensors' white noise [rad²/s], [m²/s³].
    pub(super) gyro_noise: f64,
    pub(super) accel_noise: f64,
    /// Whether the segments have positions in place of velocities.
    pub(super) by_position: bool,
    /// Time by which fixes hold later than the segments have it, and its variance \[s, s²\].
    pub(super) late: (f64, f64),
    /// By positions: variance of each component of the lever arm \[m²\].
    pub(super) arm: f64,
}

/// The end of a window.
///
/// The covariance is of all that the filter takes over; it has not been scaled by the fit of the
/// residuals yet.
pub(super) struct End {
    /// Body to navigation.
    pub(super) q_nb: Quaternion,
    /// Velocity of the IMU \[m/s\].
    pub(super) v_n: Vector3,
    /// Where the segments have positions: that of the IMU against their origin \[m\].
    pub(super) place: Option<Vector3>,
    /// By how much fixes hold later than the segments have it \[s\].
    pub(super) late: f64,
    /// In the order velocity, attitude, gyro bias, accelerometer bias, delay of the fixes.
    pub(super) covariance: EndCovariance,
}

/// Truth less estimate of velocity in `n` [m/s], attitude in body axes \[rad\], gyro bias [rad/s],
/// accelerometer bias [m/s²] and delay of the fixes \[s\] at the end of the window: its covariance.
pub(super) type EndCovariance = SMatrix<f64, 13, 13>;
/// Place of the delay in it.
pub(super) const DELAY: usize = 12;

impl Problem<'_> {
    /// A guess at the start of the window, with the priors of the biases; `gyro` is the mean of the gyro prior.
    ///
    /// The priors of the biases are residuals like the others; the attitude has none.
    ///
    /// `effect` begins as the identity between attitude parameters and attitude states.
    fn start<const S: usize>(&self, guess: &Guess, gyro: &Vector3) -> Linearised<S> {
        let mut at = Linearised {
            cost: 0.0,
            information: Information::zeros(),
            gradient: Unknowns::zeros(),
            q_nb: guess.q_nb,
            state: [0.0; S],
            wander: [[0.0; S]; S],
            effect: [[0.0; S]; 9],
        };
        for i in 0..3 {
            at.effect[i][3 + i] = 1.0;
            for (at_bias, value, mean, variance) in [
                (3 + i, guess.gyro[i], gyro[i], self.gyro.1[i]),
                (6 + i, guess.accel[i], self.accel.0[i], self.accel.1[i]),
            ] {
                let miss = mean - value;
                at.cost += miss * miss / variance;
                at.information[(at_bias, at_bias)] += 1.0 / variance;
                at.gradient[at_bias] += miss / variance;
            }
        }
        at
    }

    /// The guess put through the first `count` segments; `gyro` is the mean of the gyro prior.
    ///
    /// Between two fixes velocity (and position) go on by the preintegrated motion at the guess's biases,
    /// gravity, and the turn of the frame; the wander that white noise adds to velocity and attitude is carried
    /// beside, with the derivatives by attitude and biases.
    fn linearise<const S: usize>(
        &self,
        guess: &Guess,
        count: usize,
        gyro: &Vector3,
    ) -> Linearised<S> {
        let earth = LocalEarth::at(&self.place);
        let gravity = Vector3::new(0.0, 0.0, earth.gravity);
        let by_gyro = guess.gyro - self.reference;
        let mut at = self.start::<S>(guess, gyro);
        for (k, s) in self.segments.iter().take(count).enumerate() {
            let (motion, dt) = (&s.motion, s.motion.dt);
            let c = at.q_nb.to_rotation_matrix().into_inner();
            let dvel = motion.dvel + motion.dvel_by_g * by_gyro + motion.dvel_by_a * guess.accel;
            let frame = earth.earth_rate() + earth.transport_rate(&s.fix.v_n);
            let turn = motion.turn * from_rotation_vector(&(motion.turn_by_g * by_gyro));
            let mut transition = Transition {
                dt,
                lean: [-c * skew(&dvel), Matrix3::zeros()],
                back: turn.to_rotation_matrix().transpose().into_inner(),
            };
            let (v_n, turned) = (at.v_n(), at.turned());
            let falls = gravity - (frame + earth.earth_rate()).cross(&s.fix.v_n);
            if S == BY_POSITION {
                let dpos =
                    motion.dpos + motion.dpos_by_g * by_gyro + motion.dpos_by_a * guess.accel;
                transition.lean[1] = -c * skew(&dpos);
                let moved =
                    v_n * dt + c * dpos + transition.lean[1] * turned + falls * (0.5 * dt * dt);
                add(&mut at.state, PLACE, &moved.into());
            }
            let gained = c * dvel + transition.lean[0] * turned + falls * dt;
            add(&mut at.state, 0, &gained.into());
            at.state[3..6].copy_from_slice((transition.back * turned).as_slice());
            at.carry(motion, &c, &transition);
            for i in 0..3 {
                at.wander[i][i] += self.accel_noise * dt;
                at.wander[3 + i][3 + i] += self.gyro_noise * dt;
                if S == BY_POSITION {
                    let together = self.accel_noise * dt * dt / 2.0;
                    at.wander[i][PLACE + i] += together;
                    at.wander[PLACE + i][i] += together;
                    at.wander[PLACE + i][PLACE + i] += together * dt * (2.0 / 3.0);
                }
            }
            at.q_nb = from_rotation_vector(&(-frame * dt)) * at.q_nb * turn;
            self.fix(&mut at, k == 0, s, &(s.omega_b - by_gyro));
        }
        at.q_nb *= from_rotation_vector(&at.turned());
        at
    }

    /// Takes the fix at the end of a segment, the first one as it is; turning at `omega_b` \[rad/s\].
    #[inline(always)]
    fn fix<const S: usize>(
        &self,
        at: &mut Linearised<S>,
        first: bool,
        s: &Segment,
        omega_b: &Vector3,
    ) {
        let v_n = s.fix.v_n - at.q_nb * omega_b.cross(&self.lever_arm);
        if first {
            at.state[..3].copy_from_slice(v_n.as_slice());
            (at.state[LATE], at.wander[LATE][LATE]) = self.late;
            for i in 0..3 {
                at.wander[i][i] = UNKNOWN_VELOCITY * UNKNOWN_VELOCITY;
            }
        }
        if S == BY_VELOCITY {
            for i in 0..3 {
                let weighed = [(i, 1.0), (LATE, s.fix.accel[i])];
                at.update(weighed, v_n[i], s.fix.variance[i]);
            }
            return;
        }
        let place = s.fix.place - at.q_nb * self.lever_arm;
        if first {
            for i in 0..3 {
                at.wander[PLACE + i][PLACE + i] = UNKNOWN_PLACE * UNKNOWN_PLACE;
                at.wander[ARM + i][ARM + i] = self.arm;
            }
        }
        let (moving, c) = (at.v_n(), at.q_nb.to_rotation_matrix().into_inner());
        for i in 0..3 {
            let arm = [0, 1, 2].map(|j| (ARM + j, c[(i, j)]));
            let weighed = [(PLACE + i, 1.0), (LATE, moving[i]), arm[0], arm[1], arm[2]];
            at.update(weighed, place[i], s.fix.variance[i]);
        }
    }

    /// The end of the window after [`Problem::refine`]; `None` where something is not determined at all.
    pub(super) fn end(&self, guess: &Guess) -> Option<End> {
        match self.by_position {
            true => self.end_of::<BY_POSITION>(guess),
            false => self.end_of::<BY_VELOCITY>(guess),
        }
    }

    /// The end of the window by the whitening filter of `S` states, with positions or with velocities.
    ///
    /// The covariance has two parts: what the parameters are uncertain by, through their effect on the end, and
    /// what has wandered since.
    ///
    /// `None` where the information matrix is singular.
    fn end_of<const S: usize>(&self, guess: &Guess) -> Option<End> {
        let linear = self.linearise::<S>(guess, self.segments.len(), &self.gyro.0);
        let parameters = linear.information.try_inverse()?;
        // Place of a state among those of the end.
        let place_of = |state: usize| if state == LATE { DELAY } else { state };
        let mut effect = SMatrix::<f64, 13, 9>::zeros();
        for j in 0..9 {
            for state in 0..=LATE {
                effect[(place_of(state), j)] = linear.effect[j][state];
            }
            if j >= 3 {
                effect[(3 + j, j)] = 1.0;
            }
        }
        let mut covariance = effect * parameters * effect.transpose();
        for i in 0..=LATE {
            for j in 0..=LATE {
                covariance[(place_of(i), place_of(j))] += linear.wander[i][j];
            }
        }
        let state = &linear.state;
        let place = (S == BY_POSITION)
            .then(|| Vector3::new(state[PLACE], state[PLACE + 1], state[PLACE + 2]));
        Some(End {
            q_nb: linear.q_nb,
            v_n: linear.v_n(),
            place,
            late: state[LATE],
            covariance,
        })
    }

    /// Improves a guess on the first `count` segments.
    fn improve(&self, guess: &Guess, count: usize, gyro: &Vector3) -> Minimum {
        match self.by_position {
            true => self.improve_by::<BY_POSITION>(guess, count, gyro),
            false => self.improve_by::<BY_VELOCITY>(guess, count, gyro),
        }
    }

    /// Levenberg-Marquardt; Nocedal & Wright, section 10.3.
    ///
    /// It ends where a whole step promises less than 1e-4 of the cost, whose unit is one standard deviation squared.
    fn improve_by<const S: usize>(&self, guess: &Guess, count: usize, gyro: &Vector3) -> Minimum {
        let mut best = *guess;
        let mut linear = self.linearise::<S>(&best, count, gyro);
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            let mut matrix = linear.information;
            for i in 0..9 {
                matrix[(i, i)] *= 1.0 + damping;
            }
            // The attitude has no prior: without motion its heading is held by this.
            for i in 0..3 {
                matrix[(i, i)] += 1e-6;
            }
            let Some(factor) = nalgebra::Cholesky::new(matrix) else {
                break;
            };
            let step = factor.solve(&linear.gradient);
            let part = |at: usize| Vector3::new(step[at], step[at + 1], step[at + 2]);
            let next = Guess {
                q_nb: best.q_nb * from_rotation_vector(&part(0)),
                gyro: best.gyro + part(3),
                accel: best.accel + part(6),
            };
            let tried = self.linearise::<S>(&next, count, gyro);
            if tried.cost <= linear.cost {
                // What a whole step promises: small next to one standard deviation's, 1.
                let promised = linear.gradient.dot(&step);
                (best, linear) = (next, tried);
                if promised < 1e-4 && damping < 1e-9 {
                    break;
                }
                damping *= 0.03;
            } else {
                damping *= 10.0;
                if damping > 1e6 {
                    break;
                }
            }
        }
        Minimum {
            guess: best,
            end: linear.q_nb,
            cost: linear.cost,
        }
    }

    /// A solution improved on the whole window.
    ///
    /// From the guess given: local, a few linearisations.
    pub(super) fn refine(&self, guess: &Guess) -> Minimum {
        self.improve(guess, self.segments.len(), &self.gyro.0)
    }

    /// The minima found from all headings, best first.
    ///
    /// The first two seconds level every start: what is left to try is the turn about the specific force, at
    /// twelve headings, and where the window could turn by it three gyro biases about the vertical. Each start
    /// is improved on a quarter of the window, then on half, then on all of it; those that have reached the
    /// same minimum go on as one.
    ///
    /// Empty where the specific force of the first two seconds vanishes. `cost` of the first two
    /// show how far ahead the best is: [`super::motion`] asks for 25.
    pub(super) fn solve(&self) -> Vec<Minimum> {
        let n = self.segments.len();
        // The first two seconds' mean specific force in `n` and in body axes: all but the turn about it.
        let (mut t, mut early) = (0.0, 1);
        while early + 1 < n && t < 2.0 {
            t += self.segments[early].motion.dt;
            early += 1;
        }
        let (mut body, mut turn, mut span) = (Vector3::zeros(), Quaternion::identity(), 0.0);
        for s in &self.segments[..early] {
            body += turn * s.motion.dvel;
            turn *= s.motion.turn;
            span += s.motion.dt;
        }
        let gravity = Vector3::new(0.0, 0.0, LocalEarth::at(&self.place).gravity);
        let change = self.segments[early - 1].fix.v_n - self.segments[0].fix.v_n;
        let force = change - gravity * span;
        let (Some(up), Some(level)) = (
            force.try_normalize(1e-9),
            Quaternion::rotation_between(&body, &force).or_else(|| {
                let across = body.cross(&Vector3::x()).try_normalize(1e-9)?;
                Some(from_rotation_vector(&(across * core::f64::consts::PI)))
            }),
        ) else {
            return Vec::new();
        };

        // A gyro bias about the vertical shows last of all: several are tried where the window could turn by it.
        let duration: f64 = self.segments.iter().map(|s| s.motion.dt).sum();
        let turn_on = self.gyro.1.max().sqrt();
        let drifts: &[f64] = if turn_on * duration > 0.5 {
            &[0.0, -1.3, 1.3]
        } else {
            &[0.0]
        };
        let mut starts = Vec::new();
        for heading in 0..HEADINGS {
            let angle = core::f64::consts::TAU * heading as f64 / HEADINGS as f64;
            let q_nb = from_rotation_vector(&(up * angle)) * level;
            for drift in drifts {
                let gyro = self.gyro.0 + q_nb.inverse() * Vector3::z() * (drift * turn_on);
                let accel = self.accel.0;
                starts.push((Guess { q_nb, gyro, accel }, gyro));
            }
        }
        // From a short part of the window to all of it: the sensors' axes must not have turned away. Most headings lead to
        // a few minima on the way, and each of those goes on once.
        for part in [n / 4, n / 2].into_iter().filter(|part| *part >= 4) {
            let mut reached: Vec<(Minimum, Vector3)> = Vec::new();
            for (guess, mean) in starts {
                let solution = self.improve(&guess, part, &mean);
                if !reached
                    .iter()
                    .any(|(other, _)| other.is_near(&solution, REACHED))
                {
                    reached.push((solution, mean));
                }
            }
            let guesses = reached
                .into_iter()
                .map(|(solution, mean)| (solution.guess, mean));
            starts = guesses.collect();
        }
        let mut found: Vec<Minimum> = Vec::new();
        for (guess, _) in &starts {
            let solution = self.refine(guess);
            if !solution.cost.is_finite() {
                continue;
            }
            match found
                .iter_mut()
                .find(|other| other.is_near(&solution, SAME))
            {
                Some(same) if same.cost <= solution.cost => {}
                Some(same) => *same = solution,
                None => found.push(solution),
            }
        }
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found
    }
}

impl Minimum {
    /// Whether another one is the same minimum, at the start and at the end of the window.
    fn is_near(&self, other: &Self, same: f64) -> bool {
        self.guess.q_nb.angle_to(&other.guess.q_nb) < same && self.end.angle_to(&other.end) < same
    }
}

#[cfg(test)]
mod tests;
