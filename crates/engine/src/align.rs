//! Initial alignment: the first position, velocity and attitude, and what is known of them.
//!
//! Position and velocity come from the first fixes. The attitude is given, or is found in one of two
//! ways. After a rest (`align/rest.rs`): level and gyro bias from the mean of a span without acceleration
//! (Groves 2013, section 5.6.2), then heading, given or from the GNSS course once the vehicle moves.
//! In motion (`align/motion.rs`), without rest or for axes that are no vehicle's: all of it together from
//! the changes of velocity that accelerometers, gyros and GNSS saw. `docs/alignment.md`. Streamed: sums
//! and a bounded window are kept.
//!
//! What is configured is [`AlignSettings`]; how it ended, an [`Alignment`] or an [`AlignmentFailure`] that says what
//! was missing:
//!
//! ```
//! use undrift_engine::{Navigator, align::{AttitudeSource, HeadingSource}, settings::Settings};
//! # use undrift_nav::shaping::ShapingFilter;
//! # use undrift_simulate::{GnssNoise, Trajectory, simulate};
//! # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
//! # let sensors = [gyro, gyro, gyro, accel, accel, accel];
//! # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
//! let mut navigator = Navigator::new(Settings::new(sensors));
//! for fix in log.gnss {
//!     navigator.fix(fix)?;
//! }
//! for sample in log.imu {
//!     navigator.imu(sample)?;
//! }
//! // A minute at rest levels the IMU, the first metres give the heading.
//! let alignment = navigator.summary().alignment.expect("aligned");
//! let AttitudeSource::Rest { duration, heading } = alignment.source else { panic!("{alignment:?}") };
//! assert!(duration > 30.0 && heading == HeadingSource::Course);
//! assert!(alignment.level_std < 0.01 && alignment.heading_std < 0.1, "[rad]");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod antennas;
mod basis;
mod clocks;
mod field;
mod motion;
mod rest;
mod result;
mod seen;
mod segments;
mod sightings;
mod slow;
mod wahba;

pub use crate::settings::align::{AlignSettings, Heading};
pub(crate) use clocks::compare;
pub use clocks::{ClockFault, Stamps, rounded};
pub use result::{
    Alignment, AlignmentFailure, AttitudeSource, HeadingSource, MotionFailure, RestFailure,
};

use crate::{
    consensus::Recent,
    derived::Positions,
    estimator::{self, Aiding, Estimator},
    settings::Settings,
};
use alloc::boxed::Box;
use basis::{force_excess, noise_of_mean, walk, with_accel_scale, with_constants};
use motion::MotionAligner;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use rest::Rest;
use seen::{Seen, over_ground};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, from_rpy, skew},
    earth::{Geodetic, LocalEarth},
    filter::{FilterError, Gate, InitialStd},
    mechanisation::NavState,
    parameters::Parameter,
    sample::{GnssFix, ImuSample},
};

/// Speed of the last fix above which nothing counts as rest \[m/s\].
const REST_SPEED: f64 = 0.5;
/// A first fix after a rest that is faster than this plus [`START_ACCELERATION`] times the time since shows that it was
/// steady motion \[m/s\].
const START_SPEED: f64 = 2.0;
/// What a vehicle gains at most since a rest \[m/s²\].
const START_ACCELERATION: f64 = 5.0;
/// What disturbs the mean specific force of a vehicle at rest (engine, wind, people) \[m/s²\].
const LEVEL_FLOOR: f64 = 0.02;
/// What disturbs the mean rate of a vehicle at rest \[rad/s\].
const RATE_FLOOR: f64 = 1e-4;
/// Tilt before levelling, one standard deviation \[rad\].
const TILT_BEFORE: f64 = 0.5;
/// Side slip of a vehicle and error of a course, one standard deviation \[rad\].
const COURSE_FLOOR: f64 = 0.035;
/// A course with a larger standard deviation does not serve as heading \[rad\].
const COURSE_WORST: f64 = 0.52;
/// A speed from positions is motion where it is so many times what their noise alone makes: one in 270 000 is so by chance,
/// and the first is taken.
const MOVES: f64 = 5.0;
/// With less than so many times that noise it may be rest.
const MAY_REST: f64 = 2.0;
/// Half of what a hand or a copter accelerates by, one standard deviation \[m/s²\]: a marker's velocity changes by it within two poses.
const HAND: f64 = 5.0;
/// Fixes further apart than this are not a pair \[s\].
const PAIR_SPAN: f64 = 2.5;

/// A filter ready to run, and how it was aligned.
pub(crate) struct Aligned {
    /// The filter, at the time of the fix that completed the alignment.
    pub filter: Box<dyn Estimator>,
    /// How it was found.
    pub how: Alignment,
}

/// A rest: attitude against a frame of arbitrary azimuth, mean specific force \[m/s²\], length and end \[s\].
type Rested = (Quaternion, Vector3, f64, f64);

/// The state of an alignment.
///
/// Samples and fixes go to the rest and to the motion at once; whichever gives an attitude first ends the alignment.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Aligner {
    settings: AlignSettings,
    time: Option<f64>,
    rest: Rest,
    /// Attitude against a frame of arbitrary azimuth, level once there was rest.
    level: Quaternion,
    /// Headings by two antennas against that frame.
    antennas: Recent,
    /// Readings of a magnetometer since a rest began, their mean over the last rest, and whether they are ignored.
    field_so_far: field::AtRest,
    field_at_rest: Option<field::FieldAtRest>,
    ignores_field: bool,
    /// The last rest.
    rested: Option<Rested>,
    /// Whether GNSS ever agreed that the vehicle stood.
    stood: bool,
    motion: MotionAligner,
    /// Stamp of the sample that `motion` had last \[s\].
    given: Option<f64>,
    omega_b: Vector3,
    last_fix: Option<(f64, Geodetic)>,
    positions: Positions,
    speed: f64,
    /// [`Seen::noise`] of the last fix.
    noise: f64,
    fastest: f64,
    slow: slow::Slow,
    fixes: u64,
}

impl Aligner {
    /// An alignment that has seen nothing, for these settings.
    pub fn new(settings: &Settings) -> Self {
        let (gyro, accel) = settings.sensors.split_at(3);
        Self {
            settings: settings.align.clone(),
            rest: Rest::new(gyro, accel),
            motion: MotionAligner::new(settings),
            ..Self::default()
        }
    }

    /// Moves to `until` \[s\] within `sample`.
    ///
    /// Before [`Self::fix`] of a fix within the sample, and again to the sample's end. The part of
    /// the sample up to `until` enters the sums of a rest in proportion; the window of motion takes
    /// each sample once, whole.
    pub fn advance(&mut self, sample: &ImuSample, until: f64) {
        if self.settings.attitude.is_none() && self.given != Some(sample.time) {
            self.given = Some(sample.time);
            self.motion.sample(sample);
        }
        let from = self.time.unwrap_or(sample.time - sample.dt);
        let span = until.min(sample.time) - from.max(sample.time - sample.dt);
        self.time = Some(until);
        if span <= 0.0 {
            return;
        }
        let part = span / sample.dt;
        let (dtheta, dvel) = (sample.dtheta * part, sample.dvel * part);
        self.omega_b = sample.dtheta / sample.dt - self.rest.bias;
        self.level *= from_rotation_vector(&(dtheta - self.rest.bias * span));
        if !self.rest.add(span, &dtheta, &dvel) {
            return;
        }
        let at_rest_by_gnss = match self.last_fix {
            Some((fixed, _)) if until - fixed <= PAIR_SPAN => match self.speed {
                speed if speed < REST_SPEED => Some(true),
                speed if speed < REST_SPEED + MAY_REST * self.noise => None,
                _ => Some(false),
            },
            _ => None,
        };
        if self.rest.holds(at_rest_by_gnss) {
            self.rest.take_bias();
            self.stood |= at_rest_by_gnss == Some(true);
            // The smallest turn that makes the mean specific force point up: the azimuth stays.
            let up = self.level * self.rest.mean_force;
            let tilt = Quaternion::rotation_between(&up, &-Vector3::z())
                .unwrap_or_else(|| from_rotation_vector(&(Vector3::x() * core::f64::consts::PI)));
            self.level = tilt * self.level;
            self.level.renormalize();
            self.rested = Some((self.level, self.rest.mean_force, self.rest.span(), until));
            self.field_at_rest = self.field_so_far.mean();
        }
    }

    /// Takes a fix; the filter, if it completes the alignment.
    ///
    /// # Errors
    /// Where the alignment is complete and the filter cannot be built.
    /// A fix without a position is passed over, and so is one whose velocity is neither measured nor to be had
    /// from two positions.
    pub fn fix(
        &mut self,
        fix: &GnssFix,
        settings: &Settings,
    ) -> Result<Option<Aligned>, FilterError> {
        let Some(seen) = self.see(fix) else {
            return Ok(None);
        };
        self.note_speed(&seen);
        if let Some((q_nb, std, source)) = self.known_attitude(fix, settings) {
            let mut seen = seen;
            if source == AttitudeSource::Pose {
                self.doubt_pose(&mut seen, &q_nb, settings);
            }
            let std = InitialStd {
                position: Vector3::repeat(1.0),
                velocity: Vector3::repeat(1.0),
                attitude: std,
            };
            let start = self.start(&seen, q_nb, settings);
            let parameters = settings.worthwhile(&seen.position.1);
            let mut filter = estimator::build(start, &std, &settings.sensors, parameters)?;
            let correlated = settings
                .fix_errors
                .correlated_std(&seen.position.1, &seen.velocity.1);
            filter.set_position_velocity_covariance(
                &seen.position.1,
                &seen.velocity.1,
                &correlated,
            );
            return Ok(Some(aligned(filter, source, None)));
        }
        let bias_variance =
            noise_of_mean(&settings.sensors[..3], self.rest.bias_span()) + RATE_FLOOR * RATE_FLOOR;
        if let (Some(rested), Some(heading)) = (self.rested, self.heading(&seen, settings)) {
            let aligned = self.after_rest(&seen, rested, heading, bias_variance, settings);
            return aligned.map(Some);
        }
        let at_rest = self.rested.map(|(.., end)| {
            let walked = walk(&settings.sensors[..3], fix.time - end);
            (self.rest.bias, bias_variance + walked)
        });
        let found = self.motion.fix(fix, settings, at_rest);
        Ok(found.map(|found| {
            let source = AttitudeSource::Motion {
                duration: found.duration,
                bias_at_rest: at_rest.is_some(),
            };
            aligned(found.filter, source, None)
        }))
    }

    /// The attitude `q_nb` that is given, or that the fix has as a pose, and its standard deviations about north, east, down \[rad\]. Marker
    /// and frame are as certain as their priors.
    ///
    /// What the fix's time may be off by turns a rotating marker: the prior of the time offset times the
    /// angular rate is added.
    fn known_attitude(
        &self,
        fix: &GnssFix,
        settings: &Settings,
    ) -> Option<(Quaternion, Vector3, AttitudeSource)> {
        if let Some((rpy, std)) = self.settings.attitude {
            return Some((from_rpy(&rpy), std, AttitudeSource::Given));
        }
        let (q_rk, covariance) = fix.attitude?;
        let q_nb = q_rk * settings.marker.unwrap_or_default().inverse();
        let prior = |kind| prior_std(settings, kind);
        let turned = prior(Parameter::MarkerRotation);
        let tilted = prior(Parameter::FrameTilt);
        let late = q_nb * self.omega_b * prior(Parameter::TimeOffset);
        let variance = covariance.diagonal().add_scalar(turned * turned);
        let tilt = Vector3::new(tilted, tilted, 0.0);
        let variance = variance + tilt.component_mul(&tilt) + late.component_mul(&late);
        let std = variance.map(|variance| variance.sqrt());
        Some((q_nb, std, AttitudeSource::Pose))
    }

    /// Adds to position and velocity of a pose what the IMU's may differ by: a lever arm and a clock that are as certain as their priors,
    /// and far less than poses are.
    fn doubt_pose(&self, seen: &mut Seen, q_nb: &Quaternion, settings: &Settings) {
        let lever = prior_std(settings, Parameter::LeverArm);
        let late = prior_std(settings, Parameter::TimeOffset);
        let (velocity, omega_n) = (seen.velocity.0, q_nb * self.omega_b);
        let identity = Matrix3::identity();
        seen.position.1 += identity * (lever * lever);
        seen.position.1 += velocity * velocity.transpose() * (late * late);
        let swung = skew(&omega_n) * lever;
        seen.velocity.1 += swung * swung.transpose();
        seen.velocity.1 += identity * (HAND * late).powi(2);
    }

    /// What the speed says of the rest.
    fn note_speed(&mut self, seen: &Seen) {
        let speed = seen.velocity.0.xy().norm();
        (self.speed, self.noise) = (speed, seen.noise);
        if speed >= MOVES * seen.noise {
            self.fastest = self.fastest.max(speed);
        }
        let fast = self.settings.min_speed;
        self.slow.add(seen.time, speed, [slow::certain(seen), fast]);
        if speed >= REST_SPEED + MAY_REST * seen.noise {
            // Steady braking has steady readings too: rest begins after it.
            self.rest.interrupt();
        }
        if let Some((.., end)) = self.rested
            && !self.stood
            && speed > START_SPEED + START_ACCELERATION * (seen.time - end) + MOVES * seen.noise
        {
            // Steady motion that looked like rest while there was no fix.
            self.rested = None;
            self.rest.forget();
        }
    }

    /// The navigation state at a fix with an attitude.
    ///
    /// The IMU's position and velocity from the antenna's: r − q l, v − q (ω × l), l the lever arm
    /// in body axes.
    fn start(&self, seen: &Seen, q_nb: Quaternion, settings: &Settings) -> NavState {
        let lever_n = q_nb * settings.lever_arm;
        NavState {
            time: seen.time,
            position: seen.position.0.displaced(&-lever_n),
            v_n: seen.velocity.0 - q_nb * self.omega_b.cross(&settings.lever_arm),
            q_nb,
        }
    }

    /// The heading with its standard deviation \[rad\], where it is given or the course, two antennas or a magnetometer say it.
    ///
    /// The variance of a course is that of the velocity across it over the speed squared, and that of a side
    /// slip of 2°.
    fn heading(&mut self, seen: &Seen, settings: &Settings) -> Option<(f64, f64, HeadingSource)> {
        let (velocity, covariance) = &seen.velocity;
        let speed = self.speed;
        match self.settings.heading {
            Heading::Given(heading, std) => Some((heading, std, HeadingSource::Given)),
            Heading::Course if speed >= self.settings.min_speed.max(MOVES * seen.noise) => {
                let course = velocity.y.atan2(velocity.x);
                let std = (over_ground(covariance) / speed).hypot(COURSE_FLOOR);
                (std < COURSE_WORST).then_some((course, std, HeadingSource::Course))
            }
            _ => (self.heading_by_antennas(seen.time, settings))
                .or_else(|| self.heading_by_field(seen, settings))
                .or_else(|| self.course_of_slow(seen)),
        }
    }

    /// The filter with what the last rest says of level and bias, at the attitude that it had.
    ///
    /// The filter begins at the attitude of the rest, wide in tilt and as wide in heading as that is known, and
    /// is updated with the mean specific force (level) and the mean rate (the Earth's and the gyros' errors):
    /// tilt and accelerometer constants come out as correlated as they are. Only then it is put to the attitude
    /// of the fix.
    ///
    /// # Errors
    /// The filter cannot be built, or refuses the update.
    fn after_rest(
        &self,
        seen: &Seen,
        (level_at_rest, force_at_rest, duration, _): Rested,
        (heading, std, from): (f64, f64, HeadingSource),
        bias_variance: f64,
        settings: &Settings,
    ) -> Result<Aligned, FilterError> {
        let forward = self.level * Vector3::x();
        let turn = heading - forward.y.atan2(forward.x);
        let spin = from_rotation_vector(&Vector3::new(0.0, 0.0, turn));
        let now = self.start(seen, spin * self.level, settings);
        let wide = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: match from {
                HeadingSource::Antennas | HeadingSource::Magnetometer => {
                    Vector3::new(TILT_BEFORE, TILT_BEFORE, antennas::wide(std))
                }
                _ => Vector3::new(TILT_BEFORE, TILT_BEFORE, std),
            },
        };
        let at_rest = NavState {
            q_nb: spin * level_at_rest,
            ..now
        };
        let parameters = settings.worthwhile(&seen.position.1);
        let gravity = LocalEarth::at(&now.position).gravity;
        let force_excess = force_excess(&settings.sensors[3..], &force_at_rest, gravity, duration);
        let (sensors, parameters) = match force_excess {
            None => (settings.sensors, parameters),
            Some(excess) => (
                with_constants(&settings.sensors, excess),
                with_accel_scale(parameters, excess / gravity),
            ),
        };
        let mut filter = estimator::build(at_rest, &wide, &sensors, parameters)?;
        let variance = noise_of_mean(&settings.sensors[3..], duration) + LEVEL_FLOOR * LEVEL_FLOOR;
        let level = Aiding::Level(force_at_rest);
        filter.update(&level, &(Matrix3::identity() * variance), &Gate::OPEN)?;
        if settings.sensors[..3].iter().all(|s| s.order > 0) {
            let rate = Aiding::EarthRate(self.rest.bias);
            let noise = Matrix3::identity() * bias_variance;
            filter.update(&rate, &noise, &Gate::OPEN)?;
        }
        if from == HeadingSource::Magnetometer {
            self.take_field_in(&mut *filter, settings)?;
        }
        filter.set_nav(now);
        if from == HeadingSource::Antennas {
            antennas::take_in(&mut *filter, std, settings)?;
        }
        let correlated = settings
            .fix_errors
            .correlated_std(&seen.position.1, &seen.velocity.1);
        filter.set_position_velocity_covariance(&seen.position.1, &seen.velocity.1, &correlated);
        let source = AttitudeSource::Rest {
            duration,
            heading: from,
        };
        Ok(aligned(filter, source, force_excess))
    }

    /// Why there was no alignment; so many fixes fell within the inertial log.
    /// What was missing of a rest, and beside it how far motion came.
    pub fn failure(&self, fixes_within: u64) -> AlignmentFailure {
        if self.fixes == 0 {
            return match fixes_within {
                0 => AlignmentFailure::NoOverlap,
                _ => AlignmentFailure::NoPosition,
            };
        }
        if self.settings.attitude.is_some() {
            return AlignmentFailure::NoVelocity;
        }
        let (min_speed, fastest) = (self.settings.min_speed, self.fastest);
        let rest = match self.settings.heading {
            _ if self.rested.is_none() => RestFailure::NoRest,
            Heading::Course if fastest >= min_speed => RestFailure::NoFastFix { min_speed },
            Heading::Course if fastest < REST_SPEED => RestFailure::NeverMoved { fastest },
            Heading::Course => RestFailure::TooSlow { min_speed, fastest },
            _ => RestFailure::NoHeading,
        };
        AlignmentFailure::NoAttitude(rest, self.motion.failure())
    }
}

/// A filter with how its attitude was found.
///
/// Level is the larger of the standard deviations about north and east, heading that about down
/// \[rad\].
fn aligned(
    filter: Box<dyn Estimator>,
    source: AttitudeSource,
    force_excess: Option<f64>,
) -> Aligned {
    let (std, bias) = (filter.nav_std(), filter.sensor_error_std());
    Aligned {
        filter,
        how: Alignment {
            source,
            level_std: std[6].max(std[7]),
            heading_std: std[8],
            gyro_bias_std: bias[0].max(bias[1]).max(bias[2]),
            force_excess,
        },
    }
}

/// Standard deviation of a parameter before the log; 0 where it is not estimated.
fn prior_std(settings: &Settings, kind: Parameter) -> f64 {
    let prior = settings.parameters.prior(kind);
    prior.map_or(0.0, |prior| prior.std)
}

/// Matrix with the squares of standard deviations on its diagonal.
fn diagonal(std: &Vector3) -> Matrix3 {
    Matrix3::from_diagonal(&std.component_mul(std))
}

#[cfg(test)]
mod tests;
