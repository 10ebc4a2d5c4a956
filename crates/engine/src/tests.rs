//! Drives of at most a minute with known truth, for the tests of what watches a solution.

mod figures_of_eight;
mod flights;
mod headings;
mod loose;
mod magnetometers;
mod poses;
mod rtk;
mod smoothing;
mod starts;

use crate::{
    Measurement, Navigator, Observer, ScalarLog, Summary,
    estimator::{Estimator, STAMP_ROUNDING, build},
    settings::{Outage, Settings},
};
use alloc::{boxed::Box, vec::Vec};
use undrift_nav::{
    Vector3,
    attitude::from_rpy,
    covariance::{AXES, NAV},
    earth::Geodetic,
    filter::InitialStd,
    mechanisation::NavState,
    parameters::Parameters,
    sample::{GnssFix, MagneticField, Scalar, TruthSample},
    shaping::ShapingFilter,
};
use undrift_simulate::{GnssNoise, Simulation, Trajectory, simulate};

/// Half a minute at rest, then two and a half of driving with turns.
fn rest_then_turns(seed: u64) -> Trajectory {
    let mut motion = Trajectory::rest(180.0);
    motion.course = seed as f64;
    motion.speed.step_to(30.0, 8.0, 12.0);
    for k in 0..6 {
        let start = 45.0 + 22.0 * f64::from(k);
        motion.turn_rate.step_to(start, 2.0, 0.15);
        motion.turn_rate.step_to(start + 8.0, 2.0, 0.0);
    }
    motion
}

/// Rate of the inertial samples \[Hz\].
pub(super) const RATE: f64 = 50.0;
/// What is known of the attitude at the start about each axis \[rad\].
pub(super) const START: f64 = 0.5 * DEG;
/// One degree \[rad\].
pub(super) const DEG: f64 = core::f64::consts::PI / 180.0;

/// An IMU of 0.3 deg/√h whose turn-on constants have been taken out to 0.01 deg/s and 1 mg.
pub(super) fn sensors() -> [ShapingFilter; AXES] {
    imu([5e-3 * DEG, 1e-2 * DEG], [1e-3, 1e-2])
}

/// Gyros and accelerometers of this white noise [rad/√s, m/s/√s] and these turn-on constants [rad/s, m/s²].
pub(super) fn imu(gyro: [f64; 2], accel: [f64; 2]) -> [ShapingFilter; AXES] {
    let axis = |[white, turn_on]: [f64; 2], walk: f64| {
        let dt = 1.0 / RATE;
        let white = ShapingFilter::white(white, dt).unwrap();
        let walk = ShapingFilter::random_walk(walk, dt).unwrap();
        let turn_on = ShapingFilter::constant(turn_on, dt).unwrap();
        white.plus(&walk).unwrap().plus(&turn_on).unwrap()
    };
    let gyro = axis(gyro, 5e-4 * DEG);
    let accel = axis(accel, 1e-4);
    [gyro, gyro, gyro, accel, accel, accel]
}

/// A receiver with five fixes a second that is as good as it says.
pub(super) fn receiver() -> GnssNoise {
    GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05; 3],
        rate_hz: 5.0,
        start: 0.2,
        ..GnssNoise::default()
    }
}

/// Level, facing north, at this speed \[m/s\]; the attitude known to [`START`].
pub(super) fn driving_north(speed: f64) -> Box<dyn Estimator> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(speed, 0.0, 0.0),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(0.5),
        velocity: Vector3::repeat(0.05),
        attitude: Vector3::repeat(START),
    };
    build(nav, &std, &sensors(), Parameters::none()).unwrap()
}

/// A simulated drive and how it is navigated. What is wrong with it is done to `log` and `settings`.
pub(super) struct Scenario {
    pub(super) log: Simulation,
    pub(super) headings: Vec<Scalar>,
    pub(super) fields: Vec<MagneticField>,
    pub(super) settings: Settings,
}

impl Scenario {
    /// The first attitude is given, right to [`START`].
    pub(super) fn new(motion: &Trajectory, gnss: &GnssNoise, seed: u64) -> Self {
        Self::of(sensors(), motion, gnss, seed)
    }

    /// With other sensors.
    pub(super) fn of(
        sensors: [ShapingFilter; AXES],
        motion: &Trajectory,
        gnss: &GnssNoise,
        seed: u64,
    ) -> Self {
        let log = simulate(motion, RATE, Some(&sensors), gnss, seed).unwrap();
        let mut settings = Settings::new(sensors);
        let first = at(&log.truth, log.gnss[0].time).rpy.unwrap();
        settings.align.attitude = Some((first, Vector3::repeat(START)));
        Self {
            log,
            headings: Vec::new(),
            fields: Vec::new(),
            settings,
        }
    }

    /// The gyro about z reads too much by this rate \[rad/s\] from `start` \[s\] on.
    pub(super) fn gyro_off(mut self, start: f64, rate: f64) -> Self {
        for sample in self.log.imu.iter_mut().filter(|s| s.time > start) {
            sample.dtheta.z += rate * sample.dt;
        }
        self
    }

    /// Changes the fixes after `start` up to `end` \[s\].
    pub(super) fn alter(mut self, start: f64, end: f64, change: impl Fn(&mut GnssFix)) -> Self {
        let within = |fix: &&mut GnssFix| fix.time > start + 1e-6 && fix.time < end + 1e-6;
        self.log.gnss.iter_mut().filter(within).for_each(change);
        self
    }

    /// Withholds the fixes after `start` up to `end` \[s\].
    pub(super) fn withhold(mut self, start: f64, end: f64) -> Self {
        self.settings.outages.push(Outage { start, end });
        self
    }

    pub(super) fn navigate(&self) -> Navigated {
        self.try_navigate().unwrap()
    }

    /// The same; `None` where nothing aligns it.
    pub(super) fn try_navigate(&self) -> Option<Navigated> {
        let mut track = Track {
            truth: &self.log.truth,
            epochs: Vec::new(),
            rests: Vec::new(),
        };
        let mut navigator = Navigator::new(self.settings.clone());
        let mut fixes = self.log.gnss.iter().copied().peekable();
        let mut headings = self.headings.iter().copied().peekable();
        let mut fields = self.fields.iter().copied().peekable();
        for sample in &self.log.imu {
            let until = sample.time + navigator.ahead() + STAMP_ROUNDING;
            while let Some(fix) = fixes.next_if(|fix| fix.time <= until) {
                assert!(navigator.measure(Measurement::Gnss(fix)).unwrap());
            }
            while let Some(heading) = headings.next_if(|heading| heading.time <= until) {
                assert!(navigator.scalar(ScalarLog::Heading, heading).unwrap());
            }
            while let Some(field) = fields.next_if(|field| field.time <= until) {
                assert!(navigator.magnetometer(field).unwrap());
            }
            navigator.imu_watched(*sample, &mut track).unwrap();
        }
        let summary = navigator.end(core::iter::empty(), &mut track).ok()?;
        Some(Navigated {
            epochs: track.epochs,
            rests: track.rests,
            summary,
        })
    }
}

fn at(truth: &[TruthSample], time: f64) -> &TruthSample {
    &truth[(time * RATE).round() as usize]
}

/// What a filter is wrong by at the end of a sample, and what it says of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Epoch {
    pub(super) time: f64,
    /// Errors of position \[m\], velocity [m/s] and attitude \[rad\], north, east, down.
    pub(super) error: [f64; NAV],
    /// Their standard deviations.
    pub(super) std: [f64; NAV],
    /// Standard deviations of the vehicle's attitude, north, east, down \[rad\].
    pub(super) vehicle_std: [f64; 3],
    /// Standard deviation of the error of gyro z [rad/s].
    pub(super) gyro_std: f64,
}

impl Epoch {
    /// The error furthest outside of its standard deviation, in standard deviations.
    pub(super) fn worst(&self) -> f64 {
        let ratio = |(error, std): (f64, f64)| error.abs() / std;
        let ratios = self.error.into_iter().zip(self.std).map(ratio);
        ratios.fold(0.0, f64::max)
    }

    /// Error of the heading \[rad\], and its standard deviation.
    pub(super) fn heading(&self) -> (f64, f64) {
        (self.error[8].abs(), self.std[8])
    }

    /// Horizontal distance from the truth \[m\].
    pub(super) fn distance(&self) -> f64 {
        self.error[0].hypot(self.error[1])
    }
}

pub(super) struct Navigated {
    pub(super) summary: Summary,
    pub(super) epochs: Vec<Epoch>,
    /// Ends of the blocks judged \[s\], the true speed there [m/s], and whether they were taken for rest.
    pub(super) rests: Vec<(f64, f64, bool)>,
}

impl Navigated {
    /// At the end of the sample that ends at `time` \[s\].
    pub(super) fn at(&self, time: f64) -> &Epoch {
        let mut epochs = self.epochs.iter();
        epochs.find(|epoch| epoch.time > time - 1e-6).unwrap()
    }

    pub(super) fn last(&self) -> &Epoch {
        &self.epochs[self.epochs.len() - 1]
    }

    /// Largest of a number of the epochs after `start` up to `end` \[s\].
    pub(super) fn most(&self, start: f64, end: f64, number: impl Fn(&Epoch) -> f64) -> f64 {
        let within = |epoch: &&Epoch| epoch.time > start + 1e-6 && epoch.time < end + 1e-6;
        let numbers = self.epochs.iter().filter(within).map(number);
        numbers.fold(f64::NEG_INFINITY, f64::max)
    }
}

struct Track<'a> {
    truth: &'a [TruthSample],
    epochs: Vec<Epoch>,
    rests: Vec<(f64, f64, bool)>,
}

impl Observer for Track<'_> {
    fn sample(&mut self, filter: &dyn Estimator) {
        let nav = filter.nav();
        let truth = at(self.truth, nav.time);
        let position = truth.position.offset_to(&nav.position);
        let velocity = nav.v_n - truth.v_n.unwrap();
        let turn = from_rpy(&truth.rpy.unwrap()) * nav.q_nb.inverse();
        let mut error = [0.0; NAV];
        for (i, part) in [position, velocity, turn.scaled_axis()]
            .into_iter()
            .enumerate()
        {
            error[3 * i..3 * i + 3].copy_from_slice(part.as_slice());
        }
        self.epochs.push(Epoch {
            time: nav.time,
            error,
            std: filter.nav_std(),
            vehicle_std: filter.vehicle_attitude().1,
            gyro_std: filter.sensor_error_std()[2],
        });
    }

    fn judged(&mut self, filter: &dyn Estimator, rest: bool) {
        let time = filter.nav().time;
        let speed = at(self.truth, time).v_n.unwrap().norm();
        self.rests.push((time, speed, rest));
    }
}

/// What all the tests of this folder rest on: with nothing wrong the errors are those that are stated, and nothing is
/// reported.
#[test]
fn a_sound_drive_is_honest_and_uneventful() {
    for seed in 1..=3 {
        let motion = Trajectory::constant_turn(10.0, 0.1, 60.0);
        let seen = Scenario::new(&motion, &receiver(), seed).navigate();
        // Nine components, a minute: beyond four standard deviations once in a thousand drives.
        let worst = seen.most(0.0, 60.0, Epoch::worst);
        assert!(worst < 4.0, "seed {seed}: {worst}");
        let summary = &seen.summary;
        assert_eq!(summary.fixes, 299, "seed {seed}");
        assert!(summary.contradictions.is_empty() && summary.doubts.is_empty());
        assert!(summary.heading_off.is_empty() && summary.leans.is_empty());
        assert!(summary.restarts.is_empty() && summary.suspect.is_none());
    }
}
