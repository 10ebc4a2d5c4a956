//! Gravity in the poses' frame, the lever arm, the noise and the unit of the positions, by least squares on double differences
//! of positions; the equation is in [`super`].

use super::path::Path;
use super::{
    breaks::{Row as Change, step},
    turns::Motion,
};
use nalgebra::{SMatrix, SVector};
use undrift_base::order_statistics::quantile;
use undrift_io::poses::LocalPose;
use undrift_nav::{Matrix3, Quaternion, Vector3, earth::STANDARD_GRAVITY, sample::ImuSample};
use undrift_results::inspect::PoseFault;

/// What accelerations show.
#[derive(Clone, Debug)]
pub(super) struct Forces {
    /// In the frame of the poses [m/s²].
    pub gravity: Vector3,
    /// IMU → marker, body axes \[m\].
    pub lever_arm: Vector3,
    pub lever_arm_std: f64,
    /// Of the positions, each way \[m\].
    pub position_std: f64,
    /// When the lever arm changes \[s\], on the clock of the samples.
    pub step: Option<f64>,
    /// Where the positions jump, and stay so, while the accelerometers measure nothing of it.
    pub shift: Option<Shift>,
    /// The unit, if it is not the metre.
    pub fault: Option<PoseFault>,
}

/// A frame of poses that moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shift {
    /// On the clock of the samples \[s\].
    pub time: f64,
    /// By how much \[m\].
    pub distance: f64,
}

/// A frame that moves by less is the same \[m\], and one by less than so many standard deviations of a double difference.
const SHIFT: (f64, f64) = (0.03, 8.0);
/// A frame that moves more often is a position with a noise of its own.
const SHIFTS: usize = 5;

/// Times between the three poses of a double difference \[s\]: long for accelerations, short for the positions' own noise.
const LONG: f64 = 0.4;
const SHORT: f64 = 0.1;
/// Three poses whose whole span is more than this many times the wanted one are not used.
const EVEN: f64 = 1.3;
/// Double differences that it takes.
const LEAST: usize = 60;
/// What differs from gravity by more than this share is not gravity.
const GRAVITY: f64 = 0.05;
/// Units of positions in metres that people use.
const UNITS: [(&str, f64); 4] = [("mm", 1e-3), ("cm", 1e-2), ("ft", 0.3048), ("in", 0.0254)];
/// How near a unit has to be.
const NEAR: f64 = 0.1;
/// What is left of the scatter in other axes, at most.
const BETTER: f64 = 0.6;
/// A lever arm that changes by less is the same \[m\].
pub(super) const STEP: f64 = 3e-3;
/// Median of the absolute value of a normal variable, inverse.
const MAD: f64 = 1.4826;
/// Rounds of weights by the residuals (Huber 1981).
const ROUNDS: usize = 6;

/// Gravity, lever arm, bias, scale of the positions.
const UNKNOWN: usize = 10;
const SCALE: usize = 9;

/// One double difference: of the specific force, and what it is of each unknown.
struct Row {
    force: Vector3,
    by: SMatrix<f64, 3, UNKNOWN>,
    /// Mean of both spans \[s\].
    span: f64,
    /// Of the middle pose \[s\], on the clock of the samples.
    time: f64,
}

impl Row {
    /// What the unknowns leave of the force.
    fn left(&self, x: &SVector<f64, UNKNOWN>) -> Vector3 {
        self.force - self.by * x
    }

    /// Takes the scale of the positions as known.
    fn take_scale(&mut self, scale: f64) {
        let positions: Vector3 = self.by.column(SCALE).into_owned();
        self.force -= positions * scale;
        self.by.column_mut(SCALE).fill(0.0);
    }
}

/// A pose: time on the clock of the samples \[s\], position, attitude `q_wb`.
type Whole = (f64, Vector3, Quaternion);

impl Forces {
    /// Compares accelerations.
    ///
    /// # Errors
    /// Where there are too few positions, one of the frames is left-handed, or what is found is not gravity.
    pub(super) fn find(
        samples: &[ImuSample],
        poses: &[LocalPose],
        motion: &Motion,
        marker: &Quaternion,
    ) -> Result<Self, PoseFault> {
        let whole = whole(poses, motion, marker);
        let mut long = rows(samples, motion, &whole, LONG);
        let moves = poses
            .windows(2)
            .any(|two| two[0].position != two[1].position);
        if long.len() < LEAST || !moves {
            return Err(PoseFault::NoPositions);
        }
        let (scale, scatter) = scaled(&long);
        let mut fault = None;
        if scale < 0.0 && (scale + 1.0).abs() < 0.5 {
            return Err(PoseFault::Mirrored);
        }
        if (scale - 1.0).abs() > NEAR
            && let Some(axes) = other_axes(&long, scatter)
        {
            return Err(PoseFault::PositionAxes(axes));
        }
        // Noise of the positions and little motion make it small: a unit is far from both.
        let unit = UNITS
            .iter()
            .find(|(_, unit)| (scale / unit - 1.0).abs() < NEAR);
        let mut factor = 1.0;
        if let Some((name, unit)) = unit {
            (fault, factor) = (Some(PoseFault::Unit((*name).into())), *unit);
        }
        // Known from here on.
        let of_unit = |row: &mut Row| row.take_scale(factor);
        long.iter_mut().for_each(of_unit);
        let (x, covariance, scatter) = solve(&long, false);
        let gravity: Vector3 = x.fixed_rows::<3>(0).into_owned();
        if (gravity.norm() / STANDARD_GRAVITY - 1.0).abs() > GRAVITY {
            return Err(PoseFault::NoGravity {
                found: gravity.norm(),
            });
        }
        let mut short = rows(samples, motion, &whole, SHORT);
        short.iter_mut().for_each(of_unit);
        let at = &x;
        let noise = |row: &Row| {
            // Of three positions that err, 1, −2 and 1 over the span.
            (row.left(at) * row.span / 6f64.sqrt()).map(f64::abs).data.0[0]
        };
        let noise: Vec<f64> = short.iter().flat_map(noise).collect();
        let position_std = MAD * quantile(&noise, 0.5);
        let lever = covariance.fixed_view::<3, 3>(3, 3).diagonal();
        let changes = long.iter().map(|row| Change {
            left: row.left(&x),
            by: row.by.fixed_view::<3, 3>(0, 3).into_owned(),
        });
        let step = step(&Vec::from_iter(changes), scatter, LEAST, STEP);
        let jumps = Jumps {
            samples,
            motion,
            whole: &whole,
            found: &x,
            factor,
        };
        Ok(Self {
            gravity,
            lever_arm: x.fixed_rows::<3>(3).into_owned(),
            lever_arm_std: lever.max().max(0.0).sqrt(),
            position_std,
            step: step.map(|at| long[at].time),
            shift: jumps.shift(&short, position_std),
            fault,
        })
    }
}

/// What jumps of the positions are sought in.
struct Jumps<'a> {
    samples: &'a [ImuSample],
    motion: &'a Motion<'a>,
    whole: &'a [Whole],
    found: &'a SVector<f64, UNKNOWN>,
    /// Of the unit of the positions.
    factor: f64,
}

impl Jumps<'_> {
    /// The largest jump that stays, of few; `short` are the double differences over [`SHORT`].
    fn shift(&self, short: &[Row], position_std: f64) -> Option<Shift> {
        let least = SHIFT.0.max(SHIFT.1 * 6f64.sqrt() * position_std);
        let far = short
            .iter()
            .filter(|row| row.left(self.found).norm() * row.span > least);
        let mut events: Vec<(f64, f64)> = Vec::new();
        for row in far {
            match events.last_mut() {
                Some(event) if row.time - event.1 < 2.5 * SHORT => event.1 = row.time,
                _ => events.push((row.time, row.time)),
            }
        }
        let shifts = events.iter().filter_map(|event| self.over(event, least));
        let shifts = Vec::from_iter(shifts.filter(|shift| !self.is_turned(shift.time)));
        let largest = shifts
            .iter()
            .max_by(|a, b| a.distance.total_cmp(&b.distance));
        largest.filter(|_| shifts.len() <= SHIFTS).copied()
    }

    /// By how much the positions have jumped from before an event to after it, if that is more than `least` \[m\].
    fn over(&self, &(from, to): &(f64, f64), least: f64) -> Option<Shift> {
        let at = |time: f64| self.whole.partition_point(|pose| pose.0 < time);
        let before = at(from - EVEN * SHORT).checked_sub(1)?;
        let first = at(from - EVEN * SHORT - LONG).checked_sub(1)?;
        let three = [first, before, at(to + EVEN * SHORT)];
        let [Some(first), Some(before), Some(after)] = three.map(|k| self.whole.get(k)) else {
            return None;
        };
        let mut row = row(&self.motion.path, self.samples, [first, before, after])?;
        row.take_scale(self.factor);
        let distance = row.left(self.found).norm() * (after.0 - before.0);
        (distance > least).then_some(Shift {
            time: 0.5 * (from + to),
            distance,
        })
    }

    /// Whether the attitudes jump there, too: then it is more than the frame's place.
    fn is_turned(&self, time: f64) -> bool {
        let clock = self.motion.clock;
        let near = |from: f64, to: f64| from + clock - 1.0 < time && time < to + clock + 1.0;
        let mut turns = self.motion.turns.iter();
        turns.any(|turn| !turn.used && near(turn.from, turn.to))
    }
}

/// The poses that have both position and attitude.
fn whole(poses: &[LocalPose], motion: &Motion, marker: &Quaternion) -> Vec<Whole> {
    let whole = poses.iter().filter_map(|pose| {
        let q_wb = pose.attitude? * marker.inverse();
        Some((pose.time + motion.clock, pose.position?, q_wb))
    });
    whole.collect()
}

/// The double differences over spans of about `span` \[s\].
fn rows(samples: &[ImuSample], motion: &Motion, whole: &[Whole], span: f64) -> Vec<Row> {
    let after = |time: f64| whole.partition_point(|pose| pose.0 < time - 1e-6);
    let mut rows = Vec::new();
    let mut from = 0;
    while let Some(first) = whole.get(from) {
        let next = after(first.0 + span);
        let last = whole.get(next).map(|middle| after(middle.0 + span));
        if let Some((middle, last)) = whole.get(next).zip(last.and_then(|at| whole.get(at)))
            && last.0 - first.0 < 2.0 * EVEN * span
        {
            rows.extend(row(&motion.path, samples, [first, middle, last]));
        }
        // Half of each span is new.
        from = after(first.0 + 0.5 * span).max(from + 1);
    }
    rows
}

/// A double difference over three poses.
fn row(path: &Path, samples: &[ImuSample], three: [&Whole; 3]) -> Option<Row> {
    let [t0, t1, t2] = three.map(|pose| pose.0);
    let (h1, h2) = (t1 - t0, t2 - t1);
    let double = |of: [Vector3; 3]| (of[2] - of[1]) / h2 - (of[1] - of[0]) / h1;
    let mut by = SMatrix::<f64, 3, UNKNOWN>::zeros();
    let (mut force, mut through) = (Vector3::zeros(), Matrix3::zeros());
    let middle = path.at(t1)?;
    let mut covered = 0.0;
    for sample in &samples[path.sample_at(t0)..] {
        let (begin, end) = ((sample.time - sample.dt).max(t0), sample.time.min(t2));
        if begin >= t2 {
            break;
        }
        if end <= begin {
            continue;
        }
        let time = 0.5 * (begin + end);
        let weight = if time < t1 {
            (time - t0) / h1
        } else {
            (t2 - time) / h2
        } * (end - begin);
        let c_wb = (three[1].2 * middle.inverse() * path.at(time)?)
            .to_rotation_matrix()
            .into_inner();
        force += c_wb * sample.dvel * (weight / sample.dt);
        through += c_wb * weight;
        covered += weight;
    }
    let whole = 0.5 * (h1 + h2);
    if (covered / whole - 1.0).abs() > 0.02 {
        return None;
    }
    // Of the force: scale · D(p) − g ∫w − D(R) l + ∫w R b.
    by.fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(Matrix3::identity() * -whole));
    for axis in 0..3 {
        let arm = Vector3::ith(axis, 1.0);
        by.column_mut(3 + axis)
            .copy_from(&-double(three.map(|pose| pose.2 * arm)));
    }
    by.fixed_view_mut::<3, 3>(0, 6).copy_from(&through);
    by.column_mut(SCALE)
        .copy_from(&double(three.map(|pose| pose.1)));
    Some(Row {
        force,
        by,
        span: 2.0 / (1.0 / h1 + 1.0 / h2),
        time: t1,
    })
}

/// Scale of the positions, and the scatter then [m/s].
fn scaled(rows: &[Row]) -> (f64, f64) {
    let (x, _, scatter) = solve(rows, true);
    (x[SCALE], scatter)
}

/// The axes of the positions in which they fit far better than as they are, with a scatter of `scatter` [m/s]: 1 to 3, negative if reversed.
fn other_axes(rows: &[Row], scatter: f64) -> Option<[i8; 3]> {
    const ORDERS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ];
    let tried = ORDERS.iter().flat_map(|order| {
        (0..8).map(move |bits: u8| {
            let sign = |row: usize| if bits >> row & 1 == 0 { 1.0 } else { -1.0 };
            let turned = rows.iter().map(|row| {
                let was = row.by.column(SCALE).into_owned();
                let mut by = row.by;
                by.set_column(SCALE, &Vector3::from_fn(|k, _| sign(k) * was[order[k]]));
                Row { by, ..*row }
            });
            let (scale, scatter) = scaled(&Vec::from_iter(turned));
            let axes = [0, 1, 2].map(|k| sign(k) as i8 * (order[k] as i8 + 1));
            (axes, scale, scatter)
        })
    });
    let fits = tried.filter(|(_, scale, _)| (scale - 1.0).abs() < NEAR);
    let best = fits.min_by(|a, b| a.2.total_cmp(&b.2))?;
    (best.2 < BETTER * scatter).then_some(best.0)
}

/// Least squares with weights by the residuals: unknowns, their covariance, and the scatter. `scaled`: the scale of the positions is among the
/// unknowns.
fn solve(
    rows: &[Row],
    scaled: bool,
) -> (SVector<f64, UNKNOWN>, SMatrix<f64, UNKNOWN, UNKNOWN>, f64) {
    // Accelerometers are good to some tenths of m/s², lever arms to a metre.
    let mut prior = SMatrix::<f64, UNKNOWN, UNKNOWN>::zeros();
    let mut x = SVector::<f64, UNKNOWN>::zeros();
    let (mut scatter, mut covariance) = (f64::INFINITY, prior);
    for _ in 0..ROUNDS {
        let (mut a, mut b) = (prior, SVector::<f64, UNKNOWN>::zeros());
        let mut sizes = Vec::with_capacity(3 * rows.len());
        for row in rows {
            let left = row.left(&x);
            sizes.extend(left.iter().map(|of| of.abs()));
            let size = left.norm();
            let weight = if size > 2.0 * scatter {
                2.0 * scatter / size
            } else {
                1.0
            };
            a += row.by.transpose() * row.by * weight;
            b += row.by.transpose() * row.force * weight;
        }
        if !scaled {
            a[(SCALE, SCALE)] = 1.0;
        }
        scatter = match scatter.is_finite() {
            true => MAD * quantile(&sizes, 0.5),
            // Of nothing known yet all are alike.
            false => 1e9,
        };
        let Some(inverse) = a.try_inverse() else {
            break;
        };
        x = inverse * b;
        covariance = inverse * (scatter * scatter);
        for i in 0..3 {
            prior[(3 + i, 3 + i)] = scatter.min(1.0).powi(2);
            prior[(6 + i, 6 + i)] = (scatter.min(1.0) / 0.3).powi(2);
        }
    }
    (x, covariance, scatter)
}
