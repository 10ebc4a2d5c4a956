use super::*;
use crate::tests::{DEG, Scenario, driving_north, receiver};
use alloc::{boxed::Box, vec::Vec};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::from_rpy,
    sample::{FixQuality, ImuSample},
};
use undrift_simulate::Trajectory;

/// Usual difference of course and heading in these tests \[deg\].
const CRAB: f64 = 2.0;

/// A filter that heads north, and the courses that a receiver reports.
struct Drive {
    filter: Box<dyn Estimator>,
    watch: CourseWatch,
    summary: Summary,
    time: f64,
}

impl Drive {
    /// After a minute of the usual difference; the heading is known to this \[deg\].
    fn new(heading_std: f64) -> Self {
        let mut drive = Self {
            filter: heading_known_to(heading_std),
            watch: CourseWatch::new(),
            summary: Summary::default(),
            time: 0.0,
        };
        drive.courses(60, CRAB);
        assert!(drive.summary.heading_off.is_empty());
        drive
    }

    /// A fix `span` \[s\] after the one before: speed [m/s], course \[deg\], accuracy [m/s].
    fn fix(&mut self, span: f64, speed: f64, course: f64, std: f64) {
        self.time += span;
        let (sin, cos) = (course * DEG).sin_cos();
        let fix = GnssFix {
            attitude: None,
            mean_velocity: None,
            time: self.time,
            position: None,
            velocity: Some((
                Vector3::new(speed * cos, speed * sin, 0.0),
                Matrix3::identity() * (std * std),
            )),
            quality: FixQuality::Unknown,
        };
        self.watch.fix(&mut *self.filter, &fix, &mut self.summary);
    }

    /// A second later, of a good receiver at a good speed.
    fn course(&mut self, course: f64) {
        self.fix(1.0, 10.0, course, 0.05);
    }

    fn courses(&mut self, count: usize, course: f64) {
        for _ in 0..count {
            self.course(course);
        }
    }

    /// Spans in which the heading was in doubt: start, end \[s\], angle \[deg\].
    fn seen(&self) -> Vec<(f64, f64, f64)> {
        let found = self.summary.heading_off.iter();
        found.map(|h| (h.start, h.end, h.angle / DEG)).collect()
    }
}

fn heading_known_to(std: f64) -> Box<dyn Estimator> {
    let mut filter = driving_north(10.0);
    let known = filter.nav_std()[8];
    filter.inflate_heading(((std * DEG).powi(2) - known * known).sqrt(), 0.0);
    filter
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
}

#[test]
fn the_heading_is_doubted_by_what_the_course_shows_and_the_gyro_by_what_brought_it_there() {
    for way in [1.0, -1.0] {
        let mut drive = Drive::new(1.0);
        let gyro = drive.filter.sensor_error_std()[2];
        // The middle of the last eight: four of them are not yet enough.
        drive.courses(4, CRAB + way * 4.0);
        assert_eq!(drive.seen(), []);
        drive.course(CRAB + way * 4.0);
        let [(start, end, angle)] = drive.seen()[..] else {
            panic!("{:?}", drive.seen());
        };
        assert_eq!((start, end), (65.0, 65.0));
        assert_near(angle, way * 4.0);
        // σ grows to what is seen; over the eight seconds in which it came about the gyro was wrong by an eighth of it a
        // second.
        assert_near(drive.filter.nav_std()[8] / DEG, 4.0);
        let lacking = (4.0f64 * 4.0 - 1.0).sqrt();
        let grown = (drive.filter.sensor_error_std()[2].powi(2) - gyro * gyro).sqrt();
        assert_near(grown / DEG, lacking / 8.0);
    }
}

#[test]
fn a_difference_that_was_always_there_is_a_crab_angle() {
    let mut drive = Drive::new(1.0);
    drive.courses(300, CRAB);
    assert_eq!(drive.seen(), []);
    // Wind that turns slowly, by six degrees in five minutes.
    for k in 0..300 {
        drive.course(CRAB + 0.02 * f64::from(k));
    }
    assert_eq!(drive.seen(), []);
}

#[test]
fn a_change_within_the_spread_or_the_heading_s_own_uncertainty_is_no_contradiction() {
    // Four of the least spread of 0.57° are 2.3°.
    for (heading_std, shift, acts) in [
        (0.5, 2.1, false),
        (0.5, 2.5, true),
        (2.5, 4.8, false),
        (2.5, 5.2, true),
    ] {
        let mut drive = Drive::new(heading_std);
        drive.courses(8, CRAB + shift);
        assert_eq!(!drive.seen().is_empty(), acts, "{heading_std} {shift}");
    }
    // Courses that scatter evenly over ±3°: half of them within 1.5° or 1.8° of the middle, which is 1/1.4826 of the
    // spread of a normal law. Four spreads are at most 10.7°.
    for (shift, acts) in [(5.0, false), (13.0, true)] {
        let mut drive = Drive::new(0.5);
        let scattered = |k: usize| CRAB + 0.6 * ((7 * k) % 11) as f64 - 3.0;
        for k in 0..120 {
            drive.course(scattered(k));
        }
        for k in 0..8 {
            drive.course(scattered(k) + shift);
        }
        assert_eq!(!drive.seen().is_empty(), acts, "{shift}");
    }
}

#[test]
fn single_wild_courses_say_nothing() {
    let mut drive = Drive::new(1.0);
    for _ in 0..20 {
        drive.courses(3, CRAB + 60.0);
        drive.courses(5, CRAB);
    }
    assert_eq!(drive.seen(), []);
}

#[test]
fn where_there_is_no_course_it_contradicts_nothing() {
    let wrong = CRAB + 20.0;
    // Slowly; or of a receiver that knows it to 6.3° only.
    for (speed, std) in [(3.9, 0.05), (10.0, 1.1)] {
        let mut drive = Drive::new(1.0);
        for _ in 0..20 {
            drive.fix(1.0, speed, wrong, std);
        }
        assert_eq!(drive.seen(), [], "{speed} {std}");
    }
    for (speed, std) in [(4.1, 0.05), (10.0, 0.9)] {
        let mut drive = Drive::new(1.0);
        for _ in 0..20 {
            drive.fix(1.0, speed, wrong, std);
        }
        assert!(!drive.seen().is_empty(), "{speed} {std}");
    }
    // In a turn there is side slip.
    for (rate, acts) in [(0.11, false), (0.09, true)] {
        let mut drive = Drive::new(1.0);
        let sample = ImuSample {
            time: 0.02,
            dt: 0.02,
            dtheta: Vector3::new(0.0, 0.0, rate * 0.02),
            dvel: Vector3::zeros(),
        };
        drive.filter.begin(&sample);
        drive.courses(20, wrong);
        assert_eq!(!drive.seen().is_empty(), acts, "{rate}");
    }
    // Climbing steeply there is no heading; an IMU that sits upside down, on its side or nose up has one.
    for (roll, pitch, acts) in [
        (0.0, 22.0, false),
        (0.0, 18.0, true),
        (180.0, 18.0, true),
        (90.0, 0.0, true),
        (45.0, 0.0, false),
        (0.0, 90.0, true),
    ] {
        let mut drive = Drive::new(1.0);
        let q_nb: Quaternion = from_rpy(&Vector3::new(roll * DEG, pitch * DEG, 0.0));
        let nav = *drive.filter.nav();
        drive
            .filter
            .set_nav(undrift_nav::mechanisation::NavState { q_nb, ..nav });
        drive.courses(20, wrong);
        assert_eq!(!drive.seen().is_empty(), acts, "{roll} {pitch}");
    }
}

#[test]
fn what_is_usual_is_learned_first_and_from_a_heading_that_is_known() {
    // Seven courses fill the window of eight, thirty after them are learned, four odd ones among them: the fifth is judged.
    for (learned, acts) in [(32, false), (33, true)] {
        let mut drive = Drive::new(1.0);
        drive.watch = CourseWatch::new();
        drive.courses(learned, CRAB);
        drive.courses(5, CRAB + 20.0);
        assert_eq!(!drive.seen().is_empty(), acts, "{learned}");
    }
    // Of a heading that is known to 3° only nothing is learned, hence nothing is usual.
    let mut drive = Drive::new(3.0);
    drive.courses(100, CRAB);
    drive.courses(8, CRAB + 60.0);
    assert_eq!(drive.seen(), []);
}

#[test]
fn one_course_a_second_counts_and_none_from_before_a_pause() {
    let mut drive = Drive::new(1.0);
    for _ in 0..24 {
        drive.fix(0.2, 10.0, CRAB + 4.0, 0.05);
    }
    assert_eq!(drive.seen(), [], "4.8 s are four courses");
    drive.fix(0.2, 10.0, CRAB + 4.0, 0.05);
    assert_eq!(drive.seen().len(), 1);

    let mut drive = Drive::new(1.0);
    drive.courses(4, CRAB + 4.0);
    drive.fix(31.0, 10.0, CRAB + 4.0, 0.05);
    drive.courses(6, CRAB + 4.0);
    assert_eq!(drive.seen(), [], "seven since the pause");
    drive.course(CRAB + 4.0);
    assert_eq!(drive.seen().len(), 1);
}

#[test]
fn a_contradiction_that_goes_on_is_one_event_and_the_next_is_another() {
    let mut drive = Drive::new(1.0);
    drive.courses(5, CRAB + 4.0);
    // The difference that is in doubt does not become the usual one, though the heading is known well enough to learn from,
    // and not so well that it is contradicted: a filter that is sure again is.
    drive.filter = heading_known_to(2.2);
    drive.courses(150, CRAB + 4.0);
    drive.filter = heading_known_to(1.0);
    drive.course(CRAB + 4.0);
    let [(start, end, _)] = drive.seen()[..] else {
        panic!("{:?}", drive.seen());
    };
    assert_eq!((start, end), (65.0, 216.0));
    drive.courses(10, CRAB);
    drive.filter = heading_known_to(1.0);
    drive.courses(5, CRAB + 4.4);
    let [first, (start, _, angle)] = drive.seen()[..] else {
        panic!("{:?}", drive.seen());
    };
    assert_eq!((first.1, start), (216.0, 231.0));
    assert_near(angle, 4.4);
}

/// A minute straight ahead, on which nothing but the course shows the heading; from 45 s on the gyro about z reads a
/// degree a second too much, or it does not.
#[test]
fn a_gyro_that_changes_on_a_straight_road_is_seen_by_the_course() {
    let motion = Trajectory::straight(10.0, 0.3, 60.0);
    for seed in 1..=3 {
        let sound = Scenario::new(&motion, &receiver(), seed).navigate();
        assert!(sound.summary.heading_off.is_empty(), "seed {seed}");

        let faulty = Scenario::new(&motion, &receiver(), seed).gyro_off(45.0, DEG);
        let seen = faulty.navigate();
        let off = seen.summary.heading_off[0];
        // Four spreads of 0.57° take 2.3 s to come about, and half of eight courses to be seen.
        assert!((47.0..53.0).contains(&off.start), "seed {seed}: {off:?}");
        let (error, std) = seen.last().heading();
        assert!(
            error > 10.0 * DEG && error < 3.0 * std,
            "seed {seed}: {error} {std}"
        );
        let gyro = seen.last().gyro_std;
        assert!(gyro > 0.3 * DEG, "seed {seed}: {gyro}");

        // Without the watch the heading is wrong by more than ten of its standard deviations.
        let mut unwatched = faulty;
        unwatched.settings.gating = false;
        let (error, std) = unwatched.navigate().last().heading();
        assert!(error > 10.0 * std, "seed {seed}: {error} {std}");
    }
}
