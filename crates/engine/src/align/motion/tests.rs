//! When a window is searched, and what of it is kept.

use super::*;
use undrift_nav::shaping::ShapingFilter;
use undrift_simulate::{GnssNoise, Trajectory, simulate};

const RATE: f64 = 50.0;

/// Windows of ten seconds, searched quickly; `change` alters that.
fn settings(change: impl Fn(&mut AlignmentMotionSettings)) -> Settings {
    let sensor = ShapingFilter::white(1e-3, 1.0 / RATE).unwrap();
    let mut settings = Settings::new([sensor; AXES]);
    let set = &mut settings.engine.alignment_motion;
    (set.longest, set.shortest) = (10.0, 10.0);
    (set.headings, set.iterations) = (1, 1);
    change(set);
    settings
}

/// Calls `seen` after each fix of a bend.
fn drive(
    settings: &Settings,
    seconds: f64,
    mut seen: impl FnMut(f64, &MotionAligner, Option<AlignedInMotion>),
) {
    let gnss = GnssNoise {
        rate_hz: 5.0,
        start: 0.2,
        ..GnssNoise::default()
    };
    let bend = Trajectory::constant_turn(10.0, 0.2, seconds);
    let log = simulate(&bend, RATE, None, &gnss, 1).unwrap();
    let mut aligner = MotionAligner::new(settings);
    let mut fixes = log.gnss.iter().peekable();
    for sample in &log.imu {
        aligner.sample(sample);
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + 1e-6) {
            let found = aligner.fix(fix, settings, None);
            seen(fix.time, &aligner, found);
        }
    }
}

/// No fit is good enough: each search of the whole window finds nothing. After two of them the pause doubles each time,
/// up to a second of each of the window's.
#[test]
fn searches_that_keep_failing_become_rarer() {
    let settings = settings(|set| {
        set.fit = 0.0;
        (set.patience, set.growth, set.longest_pause) = (2, 2.0, 1.0);
    });
    let mut failures = Vec::new();
    let mut last = (0, 0.0);
    drive(&settings, 60.0, |time, aligner, found| {
        assert!(found.is_none());
        if aligner.failed > last.0 {
            assert_eq!(aligner.failed, last.0 + 1);
            last = (aligner.failed, time);
            failures.push((time, aligner.pause));
        }
        // The window is never longer than ten seconds, and a sample.
        let first = aligner.fixes.front().unwrap().time;
        assert!(time - first < 10.0 + 1.5 / RATE, "{time} {first}");
        let oldest = aligner.samples.front().unwrap();
        assert!(oldest.time >= first);
    });
    let pauses: Vec<f64> = failures.iter().map(|(_, pause)| *pause).collect();
    assert_eq!(pauses[..6], [0.1, 0.1, 0.2, 0.4, 0.8, 1.0]);
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
    let few = settings(|set| set.fewest = 1000);
    drive(&few, 5.0, |_, aligner, found| {
        assert!(found.is_none());
        assert!(matches!(aligner.failure(), MotionFailure::TooFew));
    });
    let steady = settings(|set| (set.fewest, set.spread) = (2, 1e9));
    let mut last = MotionFailure::NoVelocity;
    drive(&steady, 12.0, |_, aligner, found| {
        assert!(found.is_none());
        last = aligner.failure();
    });
    // 0.2 rad/s for ten seconds is more than half a turn: 20 m/s across and 10 (1 + cos 2) … along, and noise.
    let MotionFailure::TooSteady { change, within } = last else {
        panic!("{last:?}");
    };
    assert_eq!(within, 10.0);
    assert!((10.0..30.0).contains(&change), "{change}");
}

#[test]
fn a_window_is_as_long_as_the_gyro_bias_allows() {
    let set = AlignmentMotionSettings::default();
    // 1.2 rad at 0.04 rad/s; from 20 to 60 s.
    assert!((longest(&set, 0.04 * 0.04) - 30.0).abs() < 1e-9);
    assert_eq!(longest(&set, 1.0), 20.0);
    assert_eq!(longest(&set, 1e-8), 60.0);
}

/// The diagonal of the box that holds the velocities over ground.
#[test]
fn velocities_are_apart_by_their_extremes() {
    let mut aligner = MotionAligner::new(&settings(|_| {}));
    for (north, east, down) in [(1.0, 2.0, 50.0), (4.0, -1.0, 0.0), (2.0, 3.0, -9.0)] {
        aligner.fixes.push_back(GnssFix {
            time: 1.0,
            position: None,
            velocity: Some((Vector3::new(north, east, down), Matrix3::identity())),
            quality: undrift_nav::sample::FixQuality::Unknown,
        });
    }
    assert_eq!(aligner.spread_now(), 5.0);
}

#[test]
fn a_long_sample_ends_the_window() {
    let settings = settings(|set| set.fewest = 1000);
    let mut aligner = MotionAligner::new(&settings);
    let sample = |time: f64, dt: f64| ImuSample {
        time,
        dt,
        dtheta: Vector3::zeros(),
        dvel: Vector3::zeros(),
    };
    let longest = settings.engine.alignment_motion.longest_sample;
    aligner.sample(&sample(1.0, longest));
    assert_eq!(aligner.samples.len(), 1);
    aligner.sample(&sample(2.0, 1.01 * longest));
    assert!(aligner.samples.is_empty());
}
