use super::*;
use crate::{
    tests::{RATE, Scenario, receiver, sensors},
    vehicle::Profile,
};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_simulate::{Trajectory, Wave};

const GRAVITY: f64 = 9.8;
/// What GNSS says of the speed, least and greatest \[m/s\].
const STANDS: Option<(f64, f64)> = Some((0.0, 0.1));
const MOVES: Option<(f64, f64)> = Some((4.9, 5.1));

/// A detector on a table that is shaken.
struct Bench {
    detector: RestDetector,
    generator: Xoshiro256PlusPlus,
}

/// What the sensors read in a block.
#[derive(Clone, Copy, Default)]
struct Read {
    /// Angular rate about down [rad/s].
    rate: f64,
    /// Specific force forward [m/s²], and how much it has grown by the end.
    force: f64,
    growth: f64,
    /// Noise, in standard deviations of the sensor's own.
    noise: f64,
}

const QUIET: Read = Read {
    rate: 0.0,
    force: 0.0,
    growth: 0.0,
    noise: 1.0,
};
/// Nine times the variance of rest.
const ROAD: Read = Read {
    noise: 3.0,
    ..QUIET
};

impl Bench {
    fn new() -> Self {
        Self {
            detector: RestDetector::new(&sensors()),
            generator: Xoshiro256PlusPlus::seed_from_u64(1),
        }
    }

    /// One that has stood and driven with GNSS: it knows both.
    fn experienced() -> Self {
        let mut bench = Self::new();
        for _ in 0..20 {
            assert!(bench.block(QUIET, STANDS).rest);
        }
        for _ in 0..20 {
            assert!(!bench.block(ROAD, MOVES).rest);
        }
        bench
    }

    /// Samples up to the end of a block.
    fn block(&mut self, read: Read, speed: Option<(f64, f64)>) -> RestBlock {
        let dt = 1.0 / RATE;
        let std = self
            .detector
            .noise
            .map(|variance| read.noise * variance.sqrt());
        let expected = (Vector3::zeros(), Vector3::new(0.0, 0.0, -GRAVITY));
        for k in 0..100 {
            let mut noise = || -> f64 { StandardNormal.sample(&mut self.generator) };
            let rate =
                Vector3::new(0.0, 0.0, read.rate) + Vector3::from_fn(|i, _| std[i] * noise());
            let force = read.force + read.growth * f64::from(k) / 25.0;
            let force =
                Vector3::new(force, 0.0, -GRAVITY) + Vector3::from_fn(|i, _| std[3 + i] * noise());
            let sample = ImuSample {
                time: 0.0,
                dt,
                dtheta: rate * dt,
                dvel: force * dt,
            };
            if let Some(block) = self.detector.add(&sample, &expected, speed) {
                assert!((k == 24 || k == 25) && (block.duration - 0.5).abs() < 1.5 * dt);
                return block;
            }
        }
        panic!("a block has half a second");
    }

    /// How many of fifty blocks are taken for rest.
    fn rests(&mut self, read: Read, speed: Option<(f64, f64)>) -> usize {
        (0..50).filter(|_| self.block(read, speed).rest).count()
    }
}

#[test]
fn a_vehicle_that_stands_is_seen_with_gnss_and_without() {
    let mut bench = Bench::experienced();
    let block = bench.block(
        Read {
            rate: 0.002,
            ..QUIET
        },
        STANDS,
    );
    assert!(block.rest && block.confirmed);
    // The mean of 25 samples, to four of its standard deviations.
    let std = (bench.detector.noise[2] / 25.0).sqrt();
    assert!((block.rate.z - 0.002).abs() < 4.0 * std && block.rate.x.abs() < 4.0 * std);
    assert_eq!(bench.rests(QUIET, None), 50);
    assert!(!bench.block(QUIET, None).confirmed);
    // GNSS that does not know whether it creeps.
    let unsure = bench.block(QUIET, Some((0.3, 0.9)));
    assert!(unsure.rest && !unsure.confirmed);
}

#[test]
fn a_vehicle_that_moves_by_gnss_does_not_stand_however_smoothly_it_goes() {
    let mut bench = Bench::experienced();
    assert_eq!(bench.rests(QUIET, Some((0.51, 0.9))), 0);
    assert_eq!(bench.rests(QUIET, MOVES), 0);
    // And once such a smooth motion was seen, smoothness without GNSS is no proof.
    assert_eq!(bench.rests(QUIET, None), 0);
    assert_eq!(bench.rests(QUIET, STANDS), 50);
}

#[test]
fn a_road_that_shakes_is_not_rest_without_gnss() {
    let mut bench = Bench::experienced();
    assert_eq!(bench.rests(ROAD, None), 0);
    // Three times the variance of rest is the limit, 1.73 standard deviations; of 150 numbers a block the mean scatters by
    // 12 %.
    let louder = |noise| Read { noise, ..QUIET };
    assert!(bench.rests(louder(1.4), None) >= 49);
    assert!(bench.rests(louder(2.2), None) <= 1);
}

#[test]
fn before_any_rest_was_seen_the_sensor_s_own_noise_is_the_measure() {
    // Without GNSS from the start: rest up to twice the variance.
    let louder = |noise| Read { noise, ..QUIET };
    let mut bench = Bench::new();
    assert_eq!(bench.rests(louder(1.1), None), 50);
    assert_eq!(bench.rests(louder(1.8), None), 0);
    // An engine idles at twice the noise while GNSS shows rest: the level is learned, …
    for _ in 0..40 {
        bench.block(louder(2.0), STANDS);
    }
    // … but what motion looks like was never seen.
    assert_eq!(bench.rests(louder(2.0), None), 0);
    bench.block(louder(8.0), MOVES);
    assert_eq!(bench.rests(louder(2.0), None), 50);
}

#[test]
fn only_rest_teaches_what_rest_is() {
    let mut bench = Bench::experienced();
    // Driving, and creeping at a speed that GNSS cannot call either.
    bench.rests(ROAD, MOVES);
    bench.rests(ROAD, Some((0.2, 0.9)));
    // Pulling away while the last fix still shows rest.
    let start = Read {
        growth: 1.5,
        noise: 3.0,
        ..QUIET
    };
    bench.rests(start, STANDS);
    assert!(
        bench.rests(
            Read {
                noise: 2.2,
                ..QUIET
            },
            None
        ) <= 1
    );
}

#[test]
fn a_steady_turn_or_acceleration_is_not_rest() {
    // 4 mrad/s and 0.5 m/s² beyond four standard deviations of the mean, 0.5 mrad/s and 6 mm/s².
    let turn = |rate| Read { rate, ..QUIET };
    let push = |force| Read { force, ..QUIET };
    for (read, rests) in [
        (turn(0.003), true),
        (turn(-0.006), false),
        (push(0.45), true),
        (push(-0.55), false),
    ] {
        let expected = if rests { 50 } else { 0 };
        let mut bench = Bench::experienced();
        assert_eq!(
            bench.rests(read, None),
            expected,
            "{} {}",
            read.rate,
            read.force
        );
    }
    // Where GNSS shows rest, the solution's own biases and level may be wrong by five times that.
    for (read, rests) in [
        (turn(0.018), true),
        (turn(0.022), false),
        (push(2.4), true),
        (push(-2.6), false),
    ] {
        let expected = if rests { 50 } else { 0 };
        let mut bench = Bench::experienced();
        assert_eq!(
            bench.rests(read, STANDS),
            expected,
            "{} {}",
            read.rate,
            read.force
        );
    }
}

#[test]
fn a_vehicle_that_pulls_away_is_not_at_rest_while_its_last_fix_stands_still() {
    // The mean over the second half of a block is half of the growth above that over the first: 0.06 m/s² and some noise.
    for (growth, rest) in [(0.06, true), (0.3, false), (-0.3, false)] {
        for speed in [STANDS, None] {
            let mut bench = Bench::experienced();
            for _ in 0..2 {
                let read = Read { growth, ..QUIET };
                assert_eq!(bench.block(read, speed).rest, rest, "{growth} {speed:?}");
            }
        }
    }
}

/// Twenty seconds at rest, ten of driving, twenty at rest, then off again; without GNSS from the middle of the stop on.
#[test]
fn a_stop_is_found_and_its_end_too_without_gnss() {
    let mut motion = Trajectory::rest(60.0);
    let up = motion.speed.ramp_to(15.0, 2.0, 1.0, 8.0);
    motion.speed.ramp_to(up + 4.0, 2.0, 1.0, 0.0);
    motion.speed.ramp_to(52.0, 1.0, 1.0, 6.0);
    // The road shakes with the speed: 0.3° at 4 and 7 Hz.
    motion.roll.waves = [0.25, 0.14]
        .map(|period| Wave {
            amplitude: 5e-3,
            period,
            phase: 0.0,
        })
        .to_vec();
    for seed in 1..=3 {
        let mut drive = Scenario::new(&motion, &receiver(), seed).withhold(38.0, 60.0);
        drive.settings.constraints = Profile::Pedestrian.constraints();
        let seen = drive.navigate();
        let (mut stood, mut found) = (0, 0);
        for (time, speed, rest) in &seen.rests {
            // A block is half a second, and begins where the one before ended.
            assert!(
                !(*rest && *speed > 0.5),
                "seed {seed}: rest at {time} s, {speed} m/s"
            );
            if *speed == 0.0 {
                stood += 1;
                found += usize::from(*rest);
            }
        }
        std::println!("seed {seed}: {found} of {stood}");
        assert!(10 * found > 9 * stood, "seed {seed}: {found} of {stood}");
        let worst = seen.most(0.0, 60.0, crate::tests::Epoch::worst);
        assert!(worst < 4.0, "seed {seed}: {worst}");
        // Fourteen seconds of rest without GNSS cost no more than the drift of a second or two.
        assert!(seen.at(51.0).distance() < 1.0, "seed {seed}");
    }
}
