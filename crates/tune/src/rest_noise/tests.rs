use super::*;
use undrift_nav::{Vector3, sample::GnssFix};

const DT: f64 = 0.125;

/// Samples with rates of an axis \[unit\] at each time.
fn samples(count: usize, rate: impl Fn(usize, usize) -> f64) -> Vec<ImuSample> {
    let sample = |k: usize| ImuSample {
        time: DT * (k + 1) as f64,
        dt: DT,
        dtheta: Vector3::from_fn(|i, _| DT * rate(k, i)),
        dvel: Vector3::from_fn(|i, _| DT * rate(k, 3 + i)),
    };
    (0..count).map(sample).collect()
}

fn fixes(speeds: &[(f64, f64)]) -> Vec<Measurement> {
    let fix = |(time, speed): &(f64, f64)| {
        Measurement::Gnss(GnssFix {
            attitude: None,
            mean_velocity: None,
            time: *time,
            position: None,
            velocity: Some((
                Vector3::new(0.6 * speed, 0.0, 0.8 * speed),
                Default::default(),
            )),
            quality: Default::default(),
        })
    };
    speeds.iter().map(fix).collect()
}

/// Of axis i the seconds alternate by i + 1, and within one the samples by much more.
fn seconds(k: usize, i: usize) -> f64 {
    let sign = |odd: usize| if odd.is_multiple_of(2) { 1.0 } else { -1.0 };
    0.5 * (i + 1) as f64 * sign((k + 1) / 8) + 100.0 * sign(k)
}

#[test]
fn a_standing_vehicle_s_noise_is_that_of_the_differences_of_its_seconds() {
    let imu = samples(8 * 40, seconds);
    let standing: Vec<_> = (0..=40).map(|k| (f64::from(k), 0.1)).collect();
    let found = idle(&imu, &fixes(&standing)).unwrap();
    for (i, density) in found.iter().enumerate() {
        // All differences are i + 1: half of their square over the median of χ² with one degree of freedom.
        let exact = (i + 1) as f64 * (0.5f64 / 0.4549).sqrt();
        assert!((density / exact - 1.0).abs() < 1e-9, "{i}: {density}");
    }
    // Without the first and the last, eleven whole seconds make ten differences.
    let for_seconds = |last: i32| {
        let fast = (0..=40).map(|k| (f64::from(k), if k <= last { 0.1 } else { 5.0 }));
        idle(&imu, &fixes(&Vec::from_iter(fast)))
    };
    assert!(for_seconds(13).is_some());
    assert!(for_seconds(12).is_none());
}

#[test]
fn spans_between_standing_fixes_count_one_by_one() {
    let imu = samples(8 * 60, seconds);
    let of = |last: usize, speed: &dyn Fn(usize) -> f64| {
        let speeds = (0..=last).map(|k| (k as f64, speed(k)));
        idle(&imu, &fixes(&Vec::from_iter(speeds)))
    };
    assert!(of(60, &|_| 0.149).is_some());
    assert!(of(60, &|_| 0.151).is_none());
    // One fast fix in six leaves spans of four seconds, with one difference each: ten of them are enough.
    let one_in_six = |k: usize| f64::from(u8::from(k % 6 == 5));
    assert!(of(59, &one_in_six).is_some());
    assert!(of(53, &one_in_six).is_none());
    // Spans of three seconds have none.
    assert!(of(60, &|k| f64::from(u8::from(k % 5 == 4))).is_none());
    assert!(idle(&imu, &[]).is_none());
}

#[test]
fn the_quietest_stretches_of_a_drive_show_the_noise_at_rest() {
    // Differences of 2(i + 1) throughout: their half mean square is 2(i + 1)².
    let alternating =
        |k: usize, i: usize| (i + 1) as f64 * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let found = RestNoise::from_samples(&samples(800, alternating)).unwrap();
    for (i, white) in found.white.iter().enumerate() {
        let exact = (i + 1) as f64 * 2f64.sqrt() * DT.sqrt();
        assert!((white / exact - 1.0).abs() < 1e-9, "{i}: {white}");
    }
    assert!(found.guessed && found.walk == [0.0; 6] && found.idle.is_none());
    assert_eq!(found.turn_on, [8.7e-3, 8.7e-3, 8.7e-3, 0.3, 0.3, 0.3]);
    // Of a hundred stretches of eight samples that grow louder the third is the one at 2 %; one of repeated values has
    // no noise at all.
    let louder = |k: usize, i: usize| ((k / 8) as f64) * alternating(k, i);
    let found = RestNoise::from_samples(&samples(800, louder)).unwrap();
    // Of 99 with noise the one at place 1: the second.
    let exact = 2.0 * 2f64.sqrt() * DT.sqrt();
    assert!(
        (found.white[0] / exact - 1.0).abs() < 1e-9,
        "{:?}",
        found.white
    );
    assert_eq!(RestNoise::from_samples(&[]), None);
    assert_eq!(RestNoise::from_samples(&samples(7, alternating)), None);
    assert!(RestNoise::from_samples(&samples(8, alternating)).is_some());
}

#[test]
fn an_axis_shakes_from_half_as_much_again_of_its_noise_on() {
    let mut start =
        RestNoise::from_samples(&samples(80, |k, i| (k * k * (i + 1) % 11) as f64)).unwrap();
    start.white = [2.0; 6];
    assert!(!start.shakes(0));
    start.vibrating = Some([2.99, 3.01, 0.0, 0.0, 0.0, 3.01]);
    let shaking: Vec<bool> = (0..6).map(|axis| start.shakes(axis)).collect();
    assert_eq!(shaking, [false, true, false, false, false, true]);
}

#[test]
fn a_model_under_other_densities_has_them_axis_by_axis_and_comes_back() {
    let mut start =
        RestNoise::from_samples(&samples(80, |k, i| (k * k * (i + 1) % 11) as f64)).unwrap();
    start.turn_on = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let (white, walk) = (
        [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        [0.01, 0.02, 0.03, 0.04, 0.05, 0.06],
    );
    let model = start.model(&white, &walk);
    for (i, (_, axis)) in model.axes().into_iter().enumerate() {
        assert_eq!(
            (axis.white, axis.random_walk, axis.turn_on),
            (Some(white[i]), Some(walk[i]), start.turn_on[i])
        );
    }
    let again = RestNoise::from_model(&model, 0.01).unwrap();
    assert!(!again.guessed && again.name == start.name);
    for i in 0..6 {
        assert!((again.white[i] / white[i] - 1.0).abs() < 1e-9);
        assert!(
            (again.walk[i] / walk[i] - 1.0).abs() < 1e-9,
            "{:?}",
            again.walk
        );
    }
    assert_eq!(again.turn_on, start.turn_on);
    // Where a turn-on is not known it is a consumer's.
    start.turn_on = [0.0; 6];
    let again = RestNoise::from_model(&start.model(&white, &walk), 0.01).unwrap();
    assert_eq!(again.turn_on, [8.7e-3, 8.7e-3, 8.7e-3, 0.3, 0.3, 0.3]);
}
