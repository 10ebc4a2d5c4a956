use super::*;
use alloc::vec::Vec;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const STEP: f64 = 0.01;
const WHITE: f64 = 1e-3;

fn sensors() -> [ShapingFilter; AXES] {
    let white = ShapingFilter::white(WHITE, STEP).unwrap();
    let slow = ShapingFilter::gauss_markov(1e-3, 100.0, STEP).unwrap();
    [white.plus(&slow).unwrap(); AXES]
}

/// Half a minute of samples whose axes read this beside white noise of a density: what the noise is taken for, as a
/// density.
fn seen(density: f64, rest: impl Fn(f64) -> f64) -> [f64; AXES] {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
    let mut raised = false;
    for k in 0..30_000 {
        let time = STEP * k as f64;
        let mut value = || {
            let noise: f64 = StandardNormal.sample(&mut random);
            (density / STEP.sqrt() * noise + rest(time)) * STEP
        };
        let sample = ImuSample {
            time,
            dt: STEP,
            dtheta: undrift_nav::Vector3::from_fn(|_, _| value()),
            dvel: undrift_nav::Vector3::from_fn(|_, _| value()),
        };
        let now = vibration.next(&sample);
        if now.is_some() {
            vibration.count();
        }
        raised |= now.is_some_and(|now| now != vibration.white);
    }
    let louder = vibration.louder();
    assert_eq!(louder.is_some(), raised);
    louder.map_or([WHITE; AXES], |louder| louder.map(|times| times * WHITE))
}

#[test]
fn noise_beyond_the_model_is_found() {
    // Some 450 independent values of 13 frequencies each: 2 % of the density.
    for density in seen(5.0 * WHITE, |_| 0.0) {
        assert!((density / (5.0 * WHITE) - 1.0).abs() < 0.06, "{density}");
    }
}

#[test]
fn noise_of_the_model_is_not_touched() {
    assert_eq!(seen(WHITE, |_| 0.0), [WHITE; AXES]);
}

#[test]
fn lines_and_motion_are_no_noise() {
    let line = |t: f64| 0.1 * (2.0 * PI * 31.3 * t).sin();
    let motion = |t: f64| 3.0 * (2.0 * PI * 0.3 * t).sin() + 0.5 * (2.0 * PI * 2.0 * t).sin();
    for density in seen(WHITE, |t| line(t) + motion(t)) {
        // Ten times the noise of a sample, 70 times the density where it lies; with four of thirteen frequencies
        // taken the median is the upper third of the others.
        assert!(density < 1.5 * WHITE, "{density}");
    }
}

#[test]
fn a_slow_log_shows_nothing() {
    let slow = [ShapingFilter::white(WHITE, 0.1).unwrap(); AXES];
    let mut vibration = Vibration::new(&slow, &[1.0; AXES]);
    for k in 0..1000 {
        let sample = ImuSample {
            time: 0.1 * k as f64,
            dt: 0.1,
            dtheta: undrift_nav::Vector3::repeat(f64::from(k % 2)),
            dvel: undrift_nav::Vector3::zeros(),
        };
        assert_eq!(vibration.next(&sample), None);
    }
}

#[test]
fn spectrum_of_a_model() {
    // σ² T (1 − φ²) / |z − φ|², and the white noise.
    let (phi, sigma) = (0.9, 0.2);
    let white = ShapingFilter::white(0.05, STEP).unwrap();
    let lasting = ShapingFilter::ar(&[phi], sigma, STEP).unwrap();
    let model = white.plus(&lasting).unwrap();
    for hertz in [1.0, 10.0, 37.0] {
        let away = (Complex::cis(2.0 * PI * hertz * STEP) - phi).norm_sqr();
        let expected = 0.05 * 0.05 + sigma * sigma * STEP / away;
        let density = spectrum(&model, hertz);
        assert!(
            (density / expected - 1.0).abs() < 1e-12,
            "{density} {expected}"
        );
    }
}

#[test]
fn what_the_model_has_in_the_band_is_not_added_again() {
    let factor = 1.5;
    let mut vibration = Vibration::new(&sensors(), &[factor; AXES]);
    // Nine times the model's density: eight are beyond it, times the factor's square.
    vibration.level = vibration.model.map(|model| 9.0 * model);
    vibration.known = MEMORY;
    // In the band the Gauss-Markov process of the model is nothing: its density is that of the white noise.
    let expected = (1.0 + factor * factor * 8.0) * WHITE * WHITE / STEP;
    for variance in vibration.variances() {
        assert!((variance / expected - 1.0).abs() < 1e-4, "{variance}");
    }
    vibration.count();
    let louder = (1.0 + factor * factor * 8.0).sqrt();
    for times in vibration.louder().unwrap() {
        assert!((times / louder - 1.0).abs() < 1e-12, "{times}");
    }
}

/// Samples at 100 Hz whose axes read white noise of `times` the model's density, seed 3.
fn noisy(times: [f64; AXES], count: usize) -> Vec<ImuSample> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let sample = |k: usize| {
        let mut value = |axis: usize| {
            let noise: f64 = StandardNormal.sample(&mut random);
            times[axis] * WHITE / STEP.sqrt() * noise * STEP
        };
        ImuSample {
            time: STEP * (k + 1) as f64,
            dt: STEP,
            dtheta: undrift_nav::Vector3::from_fn(|i, _| value(i)),
            dvel: undrift_nav::Vector3::from_fn(|i, _| value(3 + i)),
        }
    };
    (0..count).map(sample).collect()
}

#[test]
fn each_axis_shows_its_own_density() {
    let times = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let settings = Settings::new(sensors());
    let imu = noisy(times, 30_000);
    for (found, times) in densities(&imu, &settings).unwrap().into_iter().zip(times) {
        // Some 450 independent values of 13 frequencies each: 2 % of the density.
        assert!(
            (found / (times * WHITE) - 1.0).abs() < 0.06,
            "{found} {times}"
        );
    }
    // A log too short for a block, or too slow.
    assert_eq!(densities(&imu[..20], &settings), None);
    let slow = Settings::new([ShapingFilter::white(WHITE, 0.1).unwrap(); AXES]);
    assert_eq!(densities(&imu, &slow), None);
}

#[test]
fn a_gap_begins_the_block_again_and_a_sample_a_bit_longer_does_not() {
    let blocks = |at: usize, dt: f64| {
        let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
        let mut ends = Vec::new();
        for (k, mut sample) in noisy([1.0; AXES], 2000).into_iter().enumerate() {
            if k == at {
                sample.dt = dt;
            }
            if vibration.next(&sample).is_some() {
                ends.push(k + 1);
            }
        }
        ends
    };
    let usual = blocks(0, STEP);
    let length = usual[0];
    assert!(
        usual
            .iter()
            .enumerate()
            .all(|(k, end)| *end == (k + 1) * length)
    );
    let at = length + length / 2;
    assert_eq!(blocks(at, 1.49 * STEP), usual);
    // The sample after the gap belongs to neither block.
    let gap = blocks(at, 1.51 * STEP);
    assert_eq!(gap[..2], [length, at + 1 + length]);
}

#[test]
fn variances_of_turned_axes_are_sums_over_the_squares_of_their_parts() {
    let variances = [1.0, 2.0, 4.0, 10.0, 20.0, 40.0];
    // North to east about down: x reads what y read, y what x read.
    let quarter = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    assert_eq!(
        turned_variances(&quarter, &variances),
        [2.0, 1.0, 4.0, 20.0, 10.0, 40.0]
    );
    let half = core::f64::consts::FRAC_1_SQRT_2;
    let eighth = Matrix3::new(half, half, 0.0, -half, half, 0.0, 0.0, 0.0, 1.0);
    for (found, exact) in turned_variances(&eighth, &variances)
        .into_iter()
        .zip([1.5, 1.5, 4.0, 15.0, 15.0, 40.0])
    {
        assert!((found - exact).abs() < 1e-12);
    }
    let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
    (vibration.level, vibration.beyond) = (variances, variances.map(|v| 3.0 * v));
    (vibration.count, vibration.means, vibration.sum) = (1, 3, [1.0; AXES]);
    vibration.turn(&quarter);
    assert_eq!(
        (vibration.count, vibration.means, vibration.sum),
        (0, 0, [0.0; AXES])
    );
    assert_eq!((vibration.level[0], vibration.beyond[0]), (2.0, 6.0));
}

#[test]
fn what_samples_change_can_be_kept_and_put_back() {
    let imu = noisy([5.0; AXES], 3000);
    let mut first = Vibration::new(&sensors(), &[1.5; AXES]);
    for sample in &imu[..1777] {
        if first.next(sample).is_some() {
            first.count();
        }
    }
    let mut kept = Vec::new();
    first.numbers(&mut |number: &mut f64| kept.push(*number));
    let mut second = Vibration::new(&sensors(), &[1.5; AXES]);
    let mut put = kept.iter();
    second.numbers(&mut |number: &mut f64| *number = *put.next().unwrap());
    assert_eq!(put.next(), None);
    for sample in &imu[1777..] {
        assert_eq!(first.next(sample), second.next(sample));
        if sample.time > 25.0 {
            first.count();
            second.count();
        }
    }
    assert_eq!(first.variances(), second.variances());
    assert!(first.louder().is_some() && first.louder() == second.louder());
    assert_eq!(
        (first.factors(), first.white_noise()),
        ([1.5; AXES], first.white)
    );
}

#[test]
fn noise_counts_after_three_seconds_and_beyond_twice_the_density_and_a_quarter() {
    let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
    let of = |vibration: &Vibration| {
        vibration
            .variances()
            .map(|v| v > WHITE * WHITE / STEP * 1.001)
    };
    vibration.known = MEMORY;
    vibration.level = vibration.model.map(|model| 2.24 * model);
    assert_eq!(of(&vibration), [false; AXES]);
    vibration.level = vibration.model.map(|model| 2.26 * model);
    assert_eq!(of(&vibration), [true; AXES]);
    vibration.known = 0.99 * MEMORY;
    assert_eq!(of(&vibration), [false; AXES]);
    assert_eq!(vibration.louder(), None);
}

/// A rise of the noise by a density N changes the biases by 1 √Hz · N, once; while it lasts they wander.
#[test]
fn biases_change_as_vibration_begins_and_wander_in_it() {
    let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
    vibration.known = MEMORY;
    assert_eq!(vibration.rectified(), [0.0; AXES]);
    let beyond = 9e-6;
    vibration.level[1] = vibration.model[1] + beyond;
    let wanders = beyond * (0.05f64).powi(2) * 64.0 * STEP;
    for expected in [beyond + wanders, wanders] {
        let found = vibration.rectified();
        assert!((found[1] / expected - 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found[0], 0.0);
    }
}
