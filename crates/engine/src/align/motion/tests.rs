//! When a window is searched, and what of it is kept.

use super::*;
use undrift_nav::shaping::ShapingFilter;
use undrift_nav::{Matrix3, covariance::AXES};
use undrift_simulate::{GnssNoise, Trajectory, simulate};

const RATE: f64 = 50.0;

fn settings() -> Settings {
    let sensor = ShapingFilter::white(1e-3, 1.0 / RATE).unwrap();
    Settings::new([sensor; AXES])
}

/// Calls `seen` after each fix of a bend at this speed \[m/s\], with windows of ten seconds. Accelerometers that are
/// `wild` read what no motion explains.
fn drive(
    speed: f64,
    seconds: f64,
    wild: bool,
    mut seen: impl FnMut(f64, &mut MotionAligner, Option<AlignedInMotion>),
) {
    let settings = settings();
    let gnss = GnssNoise {
        rate_hz: 5.0,
        start: 0.2,
        ..GnssNoise::default()
    };
    let bend = Trajectory::constant_turn(speed, 0.2, seconds);
    let mut log = simulate(&bend, RATE, None, &gnss, 1).unwrap();
    let mut aligner = MotionAligner::new(&settings);
    aligner.longest = 10.0;
    let mut fixes = log.gnss.iter().peekable();
    for (k, sample) in log.imu.iter_mut().enumerate() {
        if wild {
            sample.dvel.x += 20.0 / RATE * (0.1 * (k * k) as f64).sin().signum();
        }
        aligner.sample(sample);
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + 1e-6) {
            let found = aligner.fix(fix, &settings, None);
            seen(fix.time, &mut aligner, found);
        }
    }
}

/// Nothing fits: each search of the whole window finds nothing. After five of them the pause grows by half each time, up to
/// five windows.
#[test]
fn searches_that_keep_failing_become_rarer() {
    let mut failures = Vec::new();
    let mut last = (0, 0.0);
    drive(10.0, 80.0, true, |time, aligner, found| {
        assert!(found.is_none());
        if aligner.failed > last.0 {
            assert_eq!(aligner.failed, last.0 + 1);
            last = (aligner.failed, time);
            if aligner.failed == 8 {
                aligner.pause = 4.0;
            }
            failures.push((time, aligner.pause));
        }
        // The window is never longer than ten seconds, and a sample.
        let first = aligner.fixes.front().unwrap().time;
        assert!(time - first < 10.0 + 1.5 / RATE, "{time} {first}");
        let oldest = aligner.samples.front().unwrap();
        assert!(oldest.time >= first);
    });
    let pauses: Vec<f64> = failures.iter().map(|(_, pause)| *pause).collect();
    assert_eq!(pauses[..5], [0.1; 5]);
    for (pause, expected) in pauses[5..7].iter().zip([0.15, 0.225]) {
        assert!((pause - expected).abs() < 1e-12, "{pauses:?}");
    }
    assert_eq!(pauses[7..], [4.0, 5.0]);
    // Where one more pause would go beyond the window.
    assert!(failures[0].0 > 0.2 + 10.0 / 1.1 && failures[0].0 < 11.0);
    // Of a window of ten seconds a share of it, to the next fix.
    for ((from, pause), (to, _)) in failures.iter().zip(&failures[1..]) {
        let wait = (to - from) / (10.0 * pause).max(1.0);
        assert!((0.95..1.25).contains(&wait), "{from} {to}");
    }
}

#[test]
fn a_search_needs_fixes_and_changes_of_velocity() {
    // Searched at 0.2, 1.2 and 2.2 s, when there are five velocities at least 0.45 s apart.
    drive(10.0, 2.9, false, |_, aligner, found| {
        assert!(found.is_none());
        assert!(matches!(aligner.failure(), MotionFailure::TooFew));
    });
    let mut last = MotionFailure::TooFew;
    drive(0.2, 12.0, false, |_, aligner, found| {
        assert!(found.is_none());
        last = aligner.failure();
    });
    // 0.2 rad/s for ten seconds is more than a quarter of a turn: 0.2 m/s across and 0.2 (1 − cos 2) along, and noise.
    let MotionFailure::TooSteady { change, within } = last else {
        panic!("{last:?}");
    };
    assert_eq!(within, 10.0);
    assert!((0.3..1.0).contains(&change), "{change}");
}

#[test]
fn a_window_is_as_long_as_the_gyro_bias_allows() {
    // 1.2 rad at 0.04 rad/s; from 20 to 60 s.
    assert!((longest(0.04 * 0.04) - 30.0).abs() < 1e-9);
    assert_eq!(longest(1.0), 20.0);
    assert_eq!(longest(1e-8), 60.0);
}

/// The diagonal of the box that holds the velocities over ground.
#[test]
fn velocities_are_apart_by_their_extremes() {
    let mut aligner = MotionAligner::new(&settings());
    for (north, east, down) in [(1.0, 2.0, 50.0), (4.0, -1.0, 0.0), (2.0, 3.0, -9.0)] {
        aligner.fixes.push_back(GnssFix {
            attitude: None,
            mean_velocity: None,
            time: 1.0,
            position: None,
            velocity: Some((Vector3::new(north, east, down), Matrix3::identity())),
            quality: undrift_nav::sample::FixQuality::Unknown,
        });
    }
    assert_eq!(spread(&sightings(&aligner.fixes, false, 1.0)), 5.0);
}

#[test]
fn a_long_sample_ends_the_window() {
    let mut aligner = MotionAligner::new(&settings());
    let sample = |time: f64, dt: f64| ImuSample {
        time,
        dt,
        dtheta: Vector3::zeros(),
        dvel: Vector3::zeros(),
    };
    aligner.sample(&sample(1.0, 0.2));
    assert_eq!(aligner.samples.len(), 1);
    aligner.sample(&sample(2.0, 0.202));
    assert!(aligner.samples.is_empty());
}
