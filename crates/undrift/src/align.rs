//! Initial alignment: the first position, velocity and attitude, and what is known of them.
//!
//! Position and velocity come from the first fixes. The attitude is given, or is found in two
//! steps: level and gyro bias from the mean of a span without acceleration (Groves 2013, section
//! 5.6.2), then heading, given, from the GNSS course once the vehicle moves, or, where the
//! sensor's own forward axis is not the vehicle's, from the changes of velocity that the
//! accelerometers and the GNSS both saw. Streamed: only sums are kept.

use crate::replay::{ReplayError, Settings};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, from_rpy},
    covariance::AXES,
    earth::{self, Geodetic},
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    sample::{GnssFix, ImuSample, Position},
    shaping::ShapingFilter,
};

/// Where the heading comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heading {
    /// Known [rad] with a standard deviation [rad].
    Given(f64, f64),
    /// The GNSS course, once the speed is above `min_speed`: for body axes that are the vehicle's.
    Course,
    /// Matching of velocity changes: for sensor axes of unknown mounting.
    VelocityMatching,
}

/// What is told about the start.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignSettings {
    /// Roll, pitch, yaw at the first fix used, with standard deviations [rad].
    pub attitude: Option<(Vector3, Vector3)>,
    /// Velocity at the first fix used, north-east-down, with standard deviations [m/s].
    pub velocity: Option<(Vector3, Vector3)>,
    /// Where the heading comes from when the attitude is not given.
    pub heading: Heading,
    /// Speed above which the course is the heading [m/s].
    pub min_speed: f64,
}

impl Default for AlignSettings {
    fn default() -> Self {
        Self {
            attitude: None,
            velocity: None,
            heading: Heading::Course,
            min_speed: 3.0,
        }
    }
}

/// A filter ready to run, and how it was aligned.
pub struct Aligned<const N: usize> {
    /// At the time of the fix that completed the alignment.
    pub filter: Filter<N>,
    /// In words.
    pub how: String,
}

/// Length of the blocks that are compared to tell rest [s].
const BLOCK: f64 = 0.5;
/// Blocks on end that agree before they count as rest.
const REST_BLOCKS: u32 = 2;
/// Blocks on end, GNSS at rest, before they count as rest with another gyro bias than before.
const NEW_BIAS_BLOCKS: u32 = 10;
/// A block belongs to the rest while its means are this many standard deviations of their white
/// noise from the rest's, and this far beyond [rad/s, m/s²].
const REST_SIGMAS: f64 = 5.0;
const REST_RATE: f64 = 0.003;
const REST_FORCE: f64 = 0.05;
/// Speed of the last fix above which nothing counts as rest [m/s].
const REST_SPEED: f64 = 0.5;
/// What disturbs the mean specific force and rate of a vehicle at rest (engine, wind, people) [m/s², rad/s].
const LEVEL_FLOOR: f64 = 0.02;
const RATE_FLOOR: f64 = 1e-4;
/// Tilt before levelling [rad].
const TILT_BEFORE: f64 = 0.5;
/// Side slip of a vehicle and error of a course [rad].
const COURSE_FLOOR: f64 = 0.035;
/// Velocity matching is done when its heading is this certain [rad] after this many pairs of fixes.
const MATCHED_STD: f64 = 0.05;
const MATCHED_PAIRS: u32 = 10;
/// Fixes further apart than this [s] are not a pair.
const PAIR_SPAN: f64 = 2.5;

/// The state of an alignment.
pub struct Aligner {
    settings: AlignSettings,
    time: Option<f64>,
    rest: Rest,
    /// Attitude against a frame of arbitrary azimuth, level once there was rest.
    level: Quaternion,
    /// The last rest: attitude in that frame, mean specific force [m/s²] and length [s].
    rested: Option<(Quaternion, Vector3, f64)>,
    /// Velocity change since the last fix in that frame [m/s].
    dv_level: Vector3,
    omega_b: Vector3,
    last_fix: Option<(f64, Option<Vector3>, Geodetic)>,
    matching: Matching,
    speed: f64,
    fastest: f64,
    fixes: u64,
}

/// Tells rest by comparing block means, and keeps what it says.
struct Rest {
    /// Tolerances of a block's means [rad/s, m/s²].
    rate_tolerance: f64,
    force_tolerance: f64,
    /// Sums of the present block.
    duration: f64,
    dtheta: Vector3,
    dvel: Vector3,
    /// Blocks of the present span and their means.
    blocks: u32,
    mean_rate: Vector3,
    mean_force: Vector3,
    /// Mean rate over all rest, what is called the gyro bias, and its blocks.
    bias: Vector3,
    bias_blocks: u32,
}

/// Sums of velocity matching over pairs of fixes.
#[derive(Default)]
struct Matching {
    pairs: u32,
    dot: f64,
    cross: f64,
    ours: f64,
    theirs: f64,
}

impl Aligner {
    /// For the given settings.
    pub fn new(settings: &Settings) -> Self {
        let (gyro, accel) = settings.sensors.split_at(3);
        Self {
            settings: settings.align.clone(),
            time: None,
            rest: Rest {
                rate_tolerance: REST_RATE + REST_SIGMAS * noise_of_mean(gyro, BLOCK).sqrt(),
                force_tolerance: REST_FORCE + REST_SIGMAS * noise_of_mean(accel, BLOCK).sqrt(),
                duration: 0.0,
                dtheta: Vector3::zeros(),
                dvel: Vector3::zeros(),
                blocks: 0,
                mean_rate: Vector3::zeros(),
                mean_force: Vector3::zeros(),
                bias: Vector3::zeros(),
                bias_blocks: 0,
            },
            level: Quaternion::identity(),
            rested: None,
            dv_level: Vector3::zeros(),
            omega_b: Vector3::zeros(),
            last_fix: None,
            matching: Matching::default(),
            speed: 0.0,
            fastest: 0.0,
            fixes: 0,
        }
    }

    /// Moves to `until` [s] within `sample`.
    pub fn advance(&mut self, sample: &ImuSample, until: f64) {
        let from = self.time.unwrap_or(sample.time - sample.dt);
        let span = until.min(sample.time) - from.max(sample.time - sample.dt);
        self.time = Some(until);
        if span <= 0.0 {
            return;
        }
        let part = span / sample.dt;
        let (dtheta, dvel) = (sample.dtheta * part, sample.dvel * part);
        self.omega_b = sample.dtheta / sample.dt - self.rest.bias;
        // Gravity at 45°: 0.3 % from the true one, and vertical only.
        self.dv_level += self.level * dvel + Vector3::new(0.0, 0.0, earth::STANDARD_GRAVITY * span);
        self.level *= from_rotation_vector(&(dtheta - self.rest.bias * span));
        if self.rest.add(span, &dtheta, &dvel) && self.is_rest(until) {
            self.rest.take_bias();
            // The smallest turn that makes the mean specific force point up: the azimuth stays.
            let up = self.level * self.rest.mean_force;
            let tilt = Quaternion::rotation_between(&up, &-Vector3::z())
                .unwrap_or_else(|| from_rotation_vector(&(Vector3::x() * std::f64::consts::PI)));
            self.level = tilt * self.level;
            self.level.renormalize();
            self.rested = Some((self.level, self.rest.mean_force, self.rest.span()));
        }
    }

    /// Whether the present span is rest. A steady turn has steady readings too, so the rate must be
    /// that of the rest before, unless GNSS has said for a while that the vehicle stands.
    fn is_rest(&self, time: f64) -> bool {
        let stands = match self.last_fix {
            Some((fixed, ..)) if time - fixed <= PAIR_SPAN => Some(self.speed < REST_SPEED),
            _ => None,
        };
        // A vehicle that pulls away steadily has steady readings too, and a fix may be old.
        let same_force = self.rested.is_none_or(|(_, force, _)| {
            (self.rest.mean_force - force).norm() < self.rest.force_tolerance
        });
        let steady = self.rest.bias_blocks == 0 || (self.rest.is_steady() && same_force);
        let needed = match (stands, steady) {
            (Some(false), _) => return false,
            (_, true) => REST_BLOCKS,
            (Some(true), false) => NEW_BIAS_BLOCKS,
            (None, false) => return false,
        };
        self.rest.blocks >= needed
    }

    /// Takes a fix; the filter, if it completes the alignment.
    pub fn fix<const N: usize>(
        &mut self,
        fix: &GnssFix,
        settings: &Settings,
    ) -> Result<Option<Aligned<N>>, ReplayError> {
        let Some((position, position_covariance)) = &fix.position else {
            return Ok(None);
        };
        self.fixes += 1;
        let antenna = match position {
            Position::Geodetic(geodetic) => *geodetic,
            Position::Baseline { base, ned } => {
                Geodetic::from_ecef(&(base.to_ecef() + base.ned_from_ecef().transpose() * ned))
            }
        };
        let before = self
            .last_fix
            .replace((fix.time, fix.velocity.map(|v| v.0), antenna));
        let dv_level = std::mem::replace(&mut self.dv_level, Vector3::zeros());
        let before = before.filter(|(time, _, _)| fix.time - time <= PAIR_SPAN && fix.time > *time);

        // Velocity: told, measured, or from two positions.
        let told = self.settings.velocity.map(|(v, std)| (v, diagonal(&std)));
        let Some((velocity, velocity_covariance)) = told.or(fix.velocity).or_else(|| {
            let (time, _, place) = before?;
            let span = fix.time - time;
            let v = place.offset_to(&antenna) / span;
            // Two positions' errors, and half the span at a vehicle's acceleration.
            let covariance = position_covariance * (2.0 / (span * span));
            Some((v, covariance + Matrix3::identity() * span * span))
        }) else {
            return Ok(None);
        };
        let speed = velocity.xy().norm();
        self.speed = speed;
        self.fastest = self.fastest.max(speed);

        let start = |q_nb: Quaternion| {
            let lever_n = q_nb * settings.lever_arm;
            NavState {
                time: fix.time,
                position: antenna.displaced(&-lever_n),
                v_n: velocity - q_nb * self.omega_b.cross(&settings.lever_arm),
                q_nb,
            }
        };
        if let Some((rpy, std)) = self.settings.attitude {
            let std = InitialStd {
                position: Vector3::repeat(1.0),
                velocity: Vector3::repeat(1.0),
                attitude: std,
            };
            let mut filter = Filter::new(start(from_rpy(&rpy)), &std, settings.sensors)?;
            filter.set_position_velocity_covariance(position_covariance, &velocity_covariance);
            return Ok(Some(Aligned {
                filter,
                how: "attitude as given".into(),
            }));
        }

        let Some((level_at_rest, force_at_rest, duration)) = self.rested else {
            return Ok(None);
        };
        let level = self.level;
        let forward = level * Vector3::x();
        let azimuth = forward.y.atan2(forward.x);
        let (turn, std, how) = match self.settings.heading {
            Heading::Given(heading, std) => (
                heading - azimuth,
                std,
                "level at rest, heading as given".to_string(),
            ),
            Heading::Course => {
                if speed < self.settings.min_speed {
                    return Ok(None);
                }
                let course = velocity.y.atan2(velocity.x);
                let noise = velocity_covariance.fixed_view::<2, 2>(0, 0).trace() / 2.0;
                let std = (noise / (speed * speed) + COURSE_FLOOR * COURSE_FLOOR).sqrt();
                (
                    course - azimuth,
                    std,
                    "level at rest, heading from the course".to_string(),
                )
            }
            Heading::VelocityMatching => {
                if let (Some((_, Some(v_before), _)), Some((v_now, _))) = (before, fix.velocity) {
                    self.matching.add(&dv_level, &(v_now - v_before));
                }
                let Some((turn, std)) = self.matching.heading() else {
                    return Ok(None);
                };
                let pairs = self.matching.pairs;
                (
                    turn,
                    std,
                    format!("level at rest, heading from {pairs} velocity changes"),
                )
            }
        };

        // What rest says of level and bias, at the attitude it had.
        let spin = from_rotation_vector(&Vector3::new(0.0, 0.0, turn));
        let (rest_attitude, now) = (spin * level_at_rest, spin * level);
        let wide = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: Vector3::new(TILT_BEFORE, TILT_BEFORE, std),
        };
        let mut at_rest = start(now);
        at_rest.q_nb = rest_attitude;
        let mut filter = Filter::new(at_rest, &wide, settings.sensors)?;
        let (z, h) = filter.observe_level(&force_at_rest);
        let variance = noise_of_mean(&settings.sensors[3..], duration) + LEVEL_FLOOR * LEVEL_FLOOR;
        filter.update(&z, &h, &(nalgebra::Matrix2::identity() * variance))?;
        if settings.sensors[..3].iter().all(|s| s.order > 0) {
            let observed = filter.observe_earth_rate(&self.rest.bias);
            let variance = noise_of_mean(&settings.sensors[..3], self.rest.bias_span())
                + RATE_FLOOR * RATE_FLOOR;
            filter.update_with(&observed, &(Matrix3::identity() * variance))?;
        }
        filter.set_nav(start(now));
        filter.set_position_velocity_covariance(position_covariance, &velocity_covariance);
        Ok(Some(Aligned {
            filter,
            how: format!("{how}; {duration:.1} s of rest"),
        }))
    }

    /// Why there was no alignment, for the user.
    pub fn why_not(&self) -> String {
        let reason = if self.fixes == 0 {
            "no usable GNSS position fell within the inertial log; compare the two time columns"
                .to_string()
        } else if self.settings.attitude.is_some() || self.rested.is_some() {
            match self.settings.heading {
                Heading::Course if self.settings.attitude.is_none() => format!(
                    "the speed never reached {:.1} m/s (fastest {:.1} m/s), so the course gives no heading; \
                     set initial.min_speed, initial.heading or initial.attitude",
                    self.settings.min_speed, self.fastest
                ),
                Heading::VelocityMatching if self.settings.attitude.is_none() => format!(
                    "the velocity changed too little for a heading ({} pairs of fixes); \
                     set initial.heading or initial.attitude",
                    self.matching.pairs
                ),
                _ => "the fixes carry no velocity and no two are close enough to make one; set initial.velocity".to_string(),
            }
        } else {
            "no span of 1 s without acceleration to level on; set initial.attitude".to_string()
        };
        format!("the log could not be aligned: {reason}")
    }
}

impl Rest {
    /// Adds to the present block; true when it is complete and was compared.
    fn add(&mut self, span: f64, dtheta: &Vector3, dvel: &Vector3) -> bool {
        self.duration += span;
        self.dtheta += dtheta;
        self.dvel += dvel;
        if self.duration < BLOCK - 1e-9 {
            return false;
        }
        let (rate, force) = (self.dtheta / self.duration, self.dvel / self.duration);
        let agrees = (rate - self.mean_rate).norm() < self.rate_tolerance
            && (force - self.mean_force).norm() < self.force_tolerance;
        if !agrees {
            self.blocks = 0;
        }
        self.blocks += 1;
        let weight = 1.0 / f64::from(self.blocks);
        self.mean_rate += (rate - self.mean_rate) * weight;
        self.mean_force += (force - self.mean_force) * weight;
        self.duration = 0.0;
        self.dtheta = Vector3::zeros();
        self.dvel = Vector3::zeros();
        true
    }

    /// Whether the present span turns no faster than the rest before it did.
    fn is_steady(&self) -> bool {
        (self.mean_rate - self.bias).norm() < self.rate_tolerance
    }

    /// Takes the latest blocks of the present span into the bias; where they say another one (a
    /// sensor warming up, or calibrating itself), only the present span counts.
    fn take_bias(&mut self) {
        if !self.is_steady() {
            self.bias_blocks = 0;
        }
        let fresh = if self.bias_blocks == 0 || self.blocks <= REST_BLOCKS {
            self.blocks
        } else {
            1
        };
        self.bias_blocks += fresh;
        self.bias +=
            (self.mean_rate - self.bias) * (f64::from(fresh) / f64::from(self.bias_blocks));
    }

    /// Length of the present span [s].
    fn span(&self) -> f64 {
        f64::from(self.blocks) * BLOCK
    }

    /// Length of all rest [s].
    fn bias_span(&self) -> f64 {
        f64::from(self.bias_blocks.max(1)) * BLOCK
    }
}

impl Matching {
    fn add(&mut self, ours: &Vector3, theirs: &Vector3) {
        self.pairs += 1;
        self.dot += ours.x * theirs.x + ours.y * theirs.y;
        self.cross += ours.x * theirs.y - ours.y * theirs.x;
        self.ours += ours.xy().norm_squared();
        self.theirs += theirs.xy().norm_squared();
    }

    /// The turn about down that best takes our velocity changes to theirs, and its standard
    /// deviation from the residuals [rad]; `None` while uncertain.
    fn heading(&self) -> Option<(f64, f64)> {
        if self.pairs < MATCHED_PAIRS {
            return None;
        }
        let aligned = self.dot.hypot(self.cross);
        let residual = (self.ours + self.theirs - 2.0 * aligned).max(0.0);
        let per_component = residual / f64::from(2 * self.pairs - 1);
        let std = (per_component / self.ours).sqrt();
        (std < MATCHED_STD).then(|| (self.cross.atan2(self.dot), std.max(COURSE_FLOOR / 2.0)))
    }
}

/// Variance of the mean of white noise over `duration` [s], the largest of the axes.
fn noise_of_mean(axes: &[ShapingFilter], duration: f64) -> f64 {
    debug_assert!(axes.len() <= AXES);
    axes.iter().map(|a| a.r * a.interval).fold(0.0, f64::max) / duration
}

fn diagonal(std: &Vector3) -> Matrix3 {
    Matrix3::from_diagonal(&std.component_mul(std))
}
