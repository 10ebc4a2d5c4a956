//! The clock and the marker's rotation, by the turns that poses and gyros have in common.

use super::{INTERVAL, path::Path};
use nalgebra::{Matrix3, SymmetricEigen};
use std::ops::{Range, RangeInclusive};
use undrift_base::order_statistics::quantile;
use undrift_io::poses::LocalPose;
use undrift_nav::{Quaternion, Vector3, sample::ImuSample};
use undrift_results::inspect::PoseFault;

/// The clock of poses, and the turns that they and the gyros have in common.
pub(super) struct Motion<'a> {
    /// The turn of the gyros without their bias.
    pub path: Path<'a>,
    /// What is to be added to the times of the poses \[s\].
    pub clock: f64,
    pub turns: Vec<Turn>,
}

/// A turn between two poses.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    /// From when to when, on the clock of the poses \[s\].
    pub from: f64,
    pub to: f64,
    /// Attitudes of the marker at both.
    pub before: Quaternion,
    pub after: Quaternion,
    /// In the marker's axes \[rad\].
    pub turn: Vector3,
    /// Whether it is one of both, as far as it is known.
    pub used: bool,
}

impl Turn {
    /// Mean angular speed [rad/s].
    fn speed(&self) -> f64 {
        self.turn.norm() / (self.to - self.from)
    }
}

/// Turns longer than this are not looked at \[s\].
const LONGEST: f64 = 1.5;
/// Turns that it takes to tell anything, a second at most each.
pub(super) const LEAST: usize = 50;
/// Turns so many times faster than nine of ten are looked at later.
const FAST: f64 = 3.0;
/// Interval of the angular speeds that clocks are compared by \[s\].
const STEP: f64 = 0.05;
/// Clocks that agree on this much by their stamps \[s\] are looked at first.
const NEAR: f64 = 2.0;
/// Part of the angular speeds by which a rate of clocks is found, in steps.
const WINDOW: usize = 240;
/// Part of the poses' angular speeds that is looked for in all of the samples \[s\].
const PIECE: f64 = 120.0;
/// Correlation of angular speeds that is no chance [–].
const COMMON: f64 = 0.7;
/// Least angular speed of a marker whose rotation shows, root mean square [rad/s].
const LEAST_SPEED: f64 = 0.05;
/// Least share of the turns about the second axis [–].
const LEAST_SHARE: f64 = 0.003;
/// Gyros whose turns are so many times another size are in another unit.
const OTHER_UNIT: f64 = 2.0;
/// Rounds in which marker and bias are found.
const ROUNDS: usize = 12;
/// Turns err more the faster they are: this quantile of the misfits has those in motion where half of the log is rest, and leaves out what is
/// no noise.
const MOST: f64 = 0.9;
/// That quantile of the absolute value of a normal variable.
const OF_NORMAL: f64 = 1.645;

impl<'a> Motion<'a> {
    /// Compares samples and poses.
    ///
    /// # Errors
    /// Where they are too few, show too little turning, or nothing in common.
    pub(super) fn find(samples: &'a [ImuSample], poses: &[LocalPose]) -> Result<Self, PoseFault> {
        let mut turns = turns(poses);
        if turns.len() < LEAST || samples.len() < LEAST {
            let duration_s = turns.iter().map(|turn| turn.to - turn.from).sum();
            return Err(PoseFault::TooShort { duration_s });
        }
        let speeds = Vec::from_iter(turns.iter().map(Turn::speed));
        let fastest = FAST * quantile(&speeds, 0.9);
        for turn in &mut turns {
            turn.used = turn.speed() <= fastest;
        }
        let squares = turns.iter().filter(|turn| turn.used);
        let squares = Vec::from_iter(squares.map(|turn| turn.speed().powi(2)));
        let speed = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        if speed < LEAST_SPEED {
            return Err(PoseFault::Still {
                rate_deg: speed.to_degrees(),
            });
        }
        if second_axis(&turns) < LEAST_SHARE {
            return Err(PoseFault::OneAxis);
        }
        let clock = clock(samples, &turns).ok_or(PoseFault::NoFit { correlation: 0.0 })?;
        let mut motion = Self {
            path: Path::new(samples, Vector3::zeros()),
            clock,
            turns,
        };
        let fit = motion.refine();
        if (fit.ratio.ln()).abs() > OTHER_UNIT.ln() {
            return Err(PoseFault::GyroUnit { ratio: fit.ratio });
        }
        // Marker and bias in turn, as each shows the other: where turns go one way on average, slowly. Then the clock again.
        let mut bias = fit.bias;
        for _ in 0..ROUNDS {
            motion.path = Path::new(samples, bias);
            bias += motion.fit(0..motion.turns.len()).bias;
        }
        motion.path = Path::new(samples, bias);
        motion.refine();
        Ok(motion)
    }

    /// Finds the offset of the clocks at which the turns fit best, to a part of a millisecond, and how they fit there.
    fn refine(&mut self) -> Fit {
        let all = 0..self.turns.len();
        // Of ever finer steps, then the parabola over the last.
        for step in [0.02, 0.005, 0.001] {
            let fits = (-6..=6).map(|k| self.clock + step * f64::from(k));
            let fits = fits.map(|clock| (clock, self.fit_at(all.clone(), clock).correlation));
            let found = fits.max_by(|a, b| a.1.total_cmp(&b.1));
            self.clock = found.map_or(self.clock, |(clock, _)| clock);
        }
        let step = 0.002;
        let [low, middle, high] =
            [-step, 0.0, step].map(|off| self.fit_at(all.clone(), self.clock + off).correlation);
        let bend = low - 2.0 * middle + high;
        if bend < 0.0 {
            self.clock += (0.5 * step * (low - high) / bend).clamp(-step, step);
        }
        self.fit(all)
    }

    /// The rotation that these turns show.
    pub(super) fn fit(&self, of: Range<usize>) -> Fit {
        self.fit_at(of, self.clock)
    }

    /// Of a turn, that of the body \[rad\]; `None` where samples are missing.
    pub(super) fn of_body(&self, turn: &Turn, clock: f64) -> Option<Vector3> {
        self.path.turn(turn.from + clock, turn.to + clock)
    }

    /// The rotation by the turns of both, `Σ δ_b δ_kᵀ` (Wahba; Markley 1988).
    fn fit_at(&self, of: Range<usize>, clock: f64) -> Fit {
        let used = self.turns[of].iter().filter(|turn| turn.used);
        let both = used.filter_map(|turn| {
            let body = self.of_body(turn, clock)?;
            Some((turn.to - turn.from, body, turn.turn))
        });
        fit(&Vec::from_iter(both))
    }
}

/// The offset of clocks by which the turns go together at first, and at last, of which the rate of the clocks follows: seconds of the
/// poses in one of the samples'.
pub(super) fn rate(samples: &[ImuSample], poses: &[LocalPose]) -> Option<f64> {
    let (body, marker, apart) = both_speeds(samples, &turns(poses));
    let mut known: Option<isize> = None;
    let mut lags = Vec::new();
    for (k, piece) in marker.chunks_exact(WINDOW).enumerate() {
        let at = (k * WINDOW) as isize;
        let reach = (WINDOW / 8) as isize;
        let lag = match known {
            Some(known) => in_common(&body, piece, about(at + known, reach)),
            None => in_common(&body, piece, by_stamps(apart, at))
                .or_else(|| in_common(&body, piece, 0..=body.len() as isize)),
        };
        if let Some(lag) = lag {
            known = Some(lag - at);
            lags.push((at as f64, (lag - at) as f64));
        }
    }
    let (first, last) = (lags.first()?, lags.last()?);
    let slope = (last.1 - first.1) / (last.0 - first.0);
    let is_line = |of: &(f64, f64)| (of.1 - first.1 - slope * (of.0 - first.0)).abs() < 4.0;
    (lags.len() > 3 && lags.iter().all(is_line) && slope != 0.0).then(|| 1.0 / (1.0 + slope))
}

/// The turns between poses that are [`INTERVAL`] apart, or more where there are fewer.
fn turns(poses: &[LocalPose]) -> Vec<Turn> {
    let mut turns = Vec::new();
    let mut last: Option<(f64, Quaternion)> = None;
    for pose in poses {
        let Some(after) = pose.attitude else {
            continue;
        };
        match last {
            Some((time, _)) if pose.time < time + 0.98 * INTERVAL && pose.time >= time => {}
            Some((from, before)) => {
                if (0.0..LONGEST).contains(&(pose.time - from)) {
                    turns.push(Turn {
                        from,
                        to: pose.time,
                        before,
                        after,
                        turn: (before.inverse() * after).scaled_axis(),
                        used: true,
                    });
                }
                last = Some((pose.time, after));
            }
            None => last = Some((pose.time, after)),
        }
    }
    turns
}

/// Share of the second axis in turns [–]: 0 of a turntable.
fn second_axis(turns: &[Turn]) -> f64 {
    let used = turns.iter().filter(|turn| turn.used).map(|turn| turn.turn);
    let all: Matrix3<f64> = used.map(|m| m * m.transpose()).sum();
    let mut axes: [f64; 3] = SymmetricEigen::new(all).eigenvalues.into();
    axes.sort_by(f64::total_cmp);
    axes[1] / all.trace()
}

/// Angular speeds every [`STEP`] from the first time on; NaN where nothing was measured.
fn speeds(of: impl Iterator<Item = (f64, f64, f64)>) -> (f64, Vec<f64>) {
    let (mut first, mut sums): (Option<f64>, Vec<(f64, f64)>) = (None, Vec::new());
    for (from, to, speed) in of {
        let begin = *first.get_or_insert(from);
        let cells = (
            ((from - begin) / STEP) as usize,
            ((to - begin) / STEP).ceil() as usize,
        );
        for cell in cells.0..cells.1.max(cells.0 + 1) {
            if cell >= sums.len() {
                sums.resize(cell + 1, (0.0, 0.0));
            }
            sums[cell].0 += speed;
            sums[cell].1 += 1.0;
        }
    }
    let mean = sums.into_iter().map(|(sum, n)| sum / n).collect();
    (first.unwrap_or(0.0), mean)
}

/// Angular speeds of the samples and of the turns, and by how much the former begin later \[s\].
fn both_speeds(samples: &[ImuSample], turns: &[Turn]) -> (Vec<f64>, Vec<f64>, f64) {
    let of_sample = |s: &ImuSample| (s.time - s.dt, s.time, s.dtheta.norm() / s.dt);
    let (body_from, body) = speeds(samples.iter().map(of_sample));
    let used = turns.iter().filter(|turn| turn.used);
    let (marker_from, marker) = speeds(used.map(|turn| (turn.from, turn.to, turn.speed())));
    (body, marker, body_from - marker_from)
}

/// What is to be added to the times of the turns for their angular speeds to be those of the samples \[s\], to a few hundredths.
fn clock(samples: &[ImuSample], turns: &[Turn]) -> Option<f64> {
    let (body, marker, apart) = both_speeds(samples, turns);
    // By the stamps first; else wherever a piece of it is found.
    let lag = in_common(&body, &marker, by_stamps(apart, 0)).or_else(|| {
        let piece = &marker[..marker.len().min((PIECE / STEP) as usize)];
        let half = piece.len() as isize / 2;
        in_common(&body, piece, -half..=body.len() as isize - half)
    });
    Some(apart + lag? as f64 * STEP)
}

/// Lags about one, so far to each side.
fn about(lag: isize, reach: isize) -> RangeInclusive<isize> {
    lag - reach..=lag + reach
}

/// Lags at which the stamps nearly agree, of a part that begins at this place.
fn by_stamps(apart: f64, at: isize) -> RangeInclusive<isize> {
    about(
        at + (-apart / STEP).round() as isize,
        (NEAR / STEP) as isize,
    )
}

/// The best lag among these, where the speeds are alike beyond chance.
fn in_common(body: &[f64], marker: &[f64], lags: RangeInclusive<isize>) -> Option<isize> {
    let (lag, correlation) = best_lag(body, marker, lags)?;
    (correlation > COMMON).then_some(lag)
}

/// The lag among these at which the second series, begun so much later, is most alike the first, and the correlation then.
fn best_lag(body: &[f64], marker: &[f64], lags: RangeInclusive<isize>) -> Option<(isize, f64)> {
    let correlation = |lag: isize| {
        let pairs = marker.iter().enumerate().filter_map(|(k, b)| {
            let a = body.get(usize::try_from(k as isize + lag).ok()?)?;
            (a.is_finite() && b.is_finite()).then_some((*a, *b))
        });
        let mut sums = [0.0; 6];
        for (a, b) in pairs {
            for (sum, add) in sums.iter_mut().zip([1.0, a, b, a * a, b * b, a * b]) {
                *sum += add;
            }
        }
        let [n, a, b, aa, bb, ab] = sums;
        let enough = n >= (marker.len() as f64 / 3.0).max(LEAST as f64);
        let (va, vb) = (aa - a * a / n, bb - b * b / n);
        (enough && va > 0.0 && vb > 0.0).then(|| (ab - a * b / n) / (va * vb).sqrt())
    };
    let of = lags.filter_map(|lag| Some((lag, correlation(lag)?)));
    of.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// What turns show at one offset of the clocks.
#[derive(Clone, Copy)]
pub(super) struct Fit {
    /// Axes of the marker in the body, `q_bk`.
    pub marker: Quaternion,
    /// Their standard deviation, each way \[rad\].
    pub std: f64,
    /// What is left of the gyros' bias [rad/s].
    bias: Vector3,
    /// Standard deviation of a component of what does not fit \[rad\].
    pub scatter: f64,
    /// Correlation of the turns, and that if one of the frames were left-handed [–].
    pub correlation: f64,
    pub mirrored: f64,
    /// Size of the marker's turns over the body's [–].
    ratio: f64,
}

/// The rotation by turns: how long \[s\], of the body and of the marker \[rad\].
fn fit(both: &[(f64, Vector3, Vector3)]) -> Fit {
    let b: Matrix3<f64> = both
        .iter()
        .map(|(_, body, marker)| body * marker.transpose())
        .sum();
    let own: Matrix3<f64> = both.iter().map(|(_, _, m)| m * m.transpose()).sum();
    let size = |of: fn(&(f64, Vector3, Vector3)) -> f64| both.iter().map(of).sum::<f64>();
    let [of_body, of_marker] = [size(|t| t.1.norm_squared()), size(|t| t.2.norm_squared())];
    let sizes = (of_body * of_marker).sqrt();
    let svd = b.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Fit::NOTHING;
    };
    let det = u.determinant() * v_t.determinant();
    let s = svd.singular_values;
    let proper = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, det.signum()));
    let c_bk = u * proper * v_t;
    let (correlation, mirrored) = (
        (s[0] + s[1] + det.signum() * s[2]) / sizes,
        (s[0] + s[1] - det.signum() * s[2]) / sizes,
    );
    let left: Vec<(f64, Vector3)> = both
        .iter()
        .map(|(dt, body, m)| (*dt, body - c_bk * m))
        .collect();
    let time: f64 = left.iter().map(|(dt, _)| dt).sum();
    let bias: Vector3 = left.iter().map(|(_, left)| left).sum::<Vector3>() / time;
    let off = left
        .iter()
        .flat_map(|(dt, left)| (left - bias * *dt).map(f64::abs).data.0[0]);
    let scatter = quantile(&Vec::from_iter(off), MOST) / OF_NORMAL;
    // How well the turns show each axis of the rotation.
    let shown = SymmetricEigen::new(Matrix3::identity() * own.trace() - own);
    Fit {
        marker: Quaternion::from_matrix(&c_bk),
        std: scatter / shown.eigenvalues.min().max(f64::MIN_POSITIVE).sqrt(),
        bias,
        scatter,
        correlation,
        mirrored,
        ratio: (of_marker / of_body).sqrt(),
    }
}

impl Fit {
    /// Of turns that are no numbers.
    const NOTHING: Self = Self {
        marker: Quaternion::new_unchecked(nalgebra::Quaternion::from_vector(
            nalgebra::Vector4::new(0.0, 0.0, 0.0, 1.0),
        )),
        std: f64::INFINITY,
        bias: Vector3::new(0.0, 0.0, 0.0),
        scatter: f64::INFINITY,
        correlation: 0.0,
        mirrored: 0.0,
        ratio: 1.0,
    };
}
