use super::*;

/// Drives whose likelihood is normal about another value with a quarter of the prior's variance weigh four times as
/// much as the prior: the best lies at four fifths of the way to it.
#[test]
fn the_prior_weighs_as_much_as_its_variance_says() {
    let settings = Settings::new([ShapingFilter::white(0.0, 0.01).unwrap(); AXES]);
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let prior = Prior::new(&RestNoise::from_model(&model, 0.01).unwrap(), &[&settings]);
    let best = |side: f64| -> Vector {
        std::array::from_fn(|i| prior.centre[i] + 0.8 * side * prior.std(i, prior.centre[i] + side))
    };
    for side in [-1.0, 1.0] {
        let z = best(side);
        let (mut value, mut gradient) = (0.0, [0.0; COUNT]);
        for i in 0..COUNT {
            let std = prior.std(i, z[i]);
            let off = z[i] - (prior.centre[i] + side * std);
            value -= 0.5 * 4.0 * (off / std).powi(2);
            gradient[i] = -4.0 * off / (std * std);
        }
        let (least, slope) = cost(&Score { value, gradient }, &prior, &z);
        // Σ ½ (0.8² + 4 · 0.2²).
        assert!((least - 0.4 * COUNT as f64).abs() < 1e-9, "{least}");
        assert!(slope.amax() < 1e-9, "{slope}");
    }
}

#[test]
fn a_noise_is_at_rest_when_no_logarithm_moves_by_a_tenth() {
    let before: Vector = std::array::from_fn(|i| i as f64 - 9.0);
    assert!(is_at_rest(&before, &before));
    for i in 0..COUNT {
        for side in [-1.0, 1.0] {
            let moved = |by: f64| {
                let mut now = before;
                now[i] += side * by;
                is_at_rest(&before, &now)
            };
            assert!(moved(0.99 * SETTLED) && !moved(1.01 * SETTLED), "{i}");
        }
    }
    // As far as that, to the last bit, is not at rest.
    assert!(!is_at_rest(&[0.0; COUNT], &[SETTLED; COUNT]));
}

/// The whole way first, then 1/2, 1/4 … of it; not further than asked for, nor beyond what is good.
#[test]
fn what_is_worse_there_is_looked_for_half_as_far() {
    let (z, found) = ([1.0; COUNT], [9.0; COUNT]);
    let at_most = |most: f64, halvings| {
        first_towards(&z, &found, halvings, |there| {
            (there[3] <= most).then_some(there[3])
        })
    };
    assert_eq!(
        [9.0, 8.9, 2.9, 1.6].map(|most| at_most(most, 4)),
        [9.0, 5.0, 2.0, 1.5].map(Some)
    );
    assert_eq!((at_most(1.4, 4), at_most(8.9, 0)), (None, None));
}

/// Half of the prior's interval, and not down to a third of what was found.
#[test]
fn a_parameter_is_determined_by_an_interval_that_has_shrunk_by_half_and_excludes_next_to_nothing() {
    let settings = Settings::new([ShapingFilter::white(0.0, 0.01).unwrap(); AXES]);
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let prior = Prior::new(&RestNoise::from_model(&model, 0.01).unwrap(), &[&settings]);
    let noise = Noise::new(&prior.centre);
    let fit = |below: f64, above: f64| Fit {
        noise,
        interval: noise.ln().map(|z| (z - below, z + above)),
        likelihood: 0.0,
        windows: 1,
        evaluations: 1,
        converged: true,
    };
    for i in 0..COUNT {
        let (low, high) = prior.interval(i);
        let half = 0.5 * (high - low);
        let below = 0.1 * half;
        assert!(fit(below, 0.99 * half - below).determines(&prior, i));
        assert!(!fit(below, 1.01 * half - below).determines(&prior, i));
        let (third, little) = (3f64.ln(), 0.01);
        let wide = 1.02 * third < half;
        assert_eq!(fit(0.99 * third, little).determines(&prior, i), wide);
        assert!(!fit(1.01 * third, little).determines(&prior, i));
    }
}

/// White noise by its density, a random walk beside it, a turn-on constant at the start.
#[test]
fn a_replay_under_a_noise_has_its_sensors_and_its_rule() {
    let interval = 0.01;
    let mut settings = Settings::new([ShapingFilter::white(0.0, interval).unwrap(); AXES]);
    settings.constraints.non_holonomic = Some(NonHolonomic::CAR);
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let start = RestNoise::from_model(&model, interval).unwrap();
    let noise = Noise::new(&std::array::from_fn(|i| 0.1 * i as f64 - 5.0));
    let made = under(&settings, &noise, &start).unwrap();
    for axis in 0..AXES {
        let sensor = &made.sensors[axis];
        let known = ShapingFilter::white(noise.white[axis], interval).unwrap();
        assert_eq!(
            (sensor.interval, sensor.r, sensor.order),
            (interval, known.r, 1)
        );
        assert_eq!(sensor.p0[0][0], start.turn_on[axis].powi(2));
        let walk = ShapingFilter::random_walk(noise.walk[axis], interval).unwrap();
        assert_eq!(sensor.q[0][0], walk.q[0][0]);
    }
    let rule = made.constraints.non_holonomic.unwrap();
    assert_eq!([rule.right, rule.down, rule.slip], noise.rule);
    // Where the white noise follows the vibration the noise is the factor on it.
    settings.vibration = Some([1.0; AXES]);
    let made = under(&settings, &noise, &start).unwrap();
    assert_eq!(made.vibration, Some(noise.white));
    for axis in 0..AXES {
        let known = ShapingFilter::white(start.white[axis], interval).unwrap();
        assert_eq!(made.sensors[axis].r, known.r);
    }
    let odd = Noise {
        walk: [f64::NAN; AXES],
        ..noise
    };
    assert!(under(&settings, &odd, &start).is_err());
}
/// A simulated drive of four minutes whose noise is the centre of the prior.
struct Simulated {
    imu: Vec<ImuSample>,
    fixes: Vec<Measurement>,
    start: RestNoise,
    prior: Prior,
}

const INTERVAL: f64 = 0.02;

fn plain() -> Settings {
    Settings {
        parameters: undrift_nav::parameters::Parameters::none(),
        ..Settings::new([ShapingFilter::white(0.0, INTERVAL).unwrap(); AXES])
    }
}

impl Simulated {
    fn new() -> Self {
        use undrift_simulate::{GnssNoise, Trajectory, simulate};
        let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
        let start = RestNoise::from_model(&model, INTERVAL).unwrap();
        let prior = Prior::new(&start, &[&plain()]);
        let settings = under(&plain(), &Noise::new(&prior.centre), &start).unwrap();
        let receiver = GnssNoise {
            rate_hz: 1.0,
            start: 0.2,
            ..GnssNoise::default()
        };
        let car = Trajectory::car(240.0, 3);
        let log = simulate(&car, 50.0, Some(&settings.sensors), &receiver, 3).unwrap();
        let fixes = log.gnss.iter().copied().map(Measurement::Gnss);
        Self {
            imu: log.imu,
            fixes: fixes.collect(),
            start,
            prior,
        }
    }

    fn log(&self) -> FitLog<'_> {
        FitLog {
            imu: &self.imu,
            aiding: &self.fixes,
            settings: plain(),
            until: f64::INFINITY,
        }
    }

    /// So many times the same drive.
    fn linear(&self, drives: usize) -> Linear<24> {
        let logs = Vec::from_iter((0..drives).map(|_| self.log()));
        Linear::new(&logs, Noise::new(&self.prior.centre), &self.start).unwrap()
    }
}

/// As few spans as are at most 45 s long.
#[test]
fn blocks_are_spans_of_one_length_that_add_up_to_the_drive() {
    let drive = Simulated::new();
    let (linear, z) = (drive.linear(1), drive.prior.centre);
    let blocks = linear.by_block(&z);
    let (first, last) = linear.drives[0].span().unwrap();
    let count = blocks.len() as f64;
    assert!((last - first) / count <= 45.0 && (last - first) / (count - 1.0) > 45.0);
    let whole = linear.score(&z).gradient;
    for i in 0..COUNT {
        let sum: f64 = blocks.iter().map(|block| block[i]).sum();
        assert!(
            (sum - whole[i]).abs() < 1e-6 * (1.0 + whole[i].abs()),
            "{i}: {sum} {}",
            whole[i]
        );
    }
    for block in &blocks {
        assert!(block.iter().any(|slope| slope.abs() > 1e-3), "{block:?}");
    }
    // Two drives have the blocks of both.
    assert_eq!(drive.linear(2).by_block(&z).len(), 2 * blocks.len());
}

/// The slope of a likelihood scatters about 0 where what is seen is drawn under its noise.
#[test]
fn drawn_innovations_are_those_of_the_noise() {
    const DRAWS: usize = 16;
    let drive = Simulated::new();
    let (mut linear, z) = (drive.linear(1), drive.prior.centre);
    let measured = linear.score(&z).value;
    let mut one = crate::objective::normal();
    let mut slopes = || -> Vector {
        let blocks = linear.drawn(&z, &mut one);
        std::array::from_fn(|i| blocks.iter().map(|block| block[i]).sum())
    };
    let drawn = Vec::from_iter((0..DRAWS).map(|_| slopes()));
    for i in (0..COUNT).filter(|i| drive.prior.used[*i]) {
        let mean = drawn.iter().map(|slope| slope[i]).sum::<f64>() / DRAWS as f64;
        let square = drawn.iter().map(|slope| (slope[i] - mean).powi(2));
        let std = (square.sum::<f64>() / (DRAWS * (DRAWS - 1)) as f64).sqrt();
        // Student's t with 15 degrees of freedom: once in 1500.
        assert!(mean.abs() < 4.3 * std, "{i}: {mean} ± {std}");
    }
    // What was measured is back.
    assert_eq!(linear.score(&z).value, measured);
}
