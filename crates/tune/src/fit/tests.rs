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

/// Half of the prior's standard deviation.
#[test]
fn a_parameter_is_determined_by_an_interval_that_has_shrunk_by_half() {
    let settings = Settings::new([ShapingFilter::white(0.0, 0.01).unwrap(); AXES]);
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let prior = Prior::new(&RestNoise::from_model(&model, 0.01).unwrap(), &[&settings]);
    let noise = Noise::new(&prior.centre);
    let fit = |share: f64| Fit {
        noise,
        std: std::array::from_fn(|i| share * prior.std(i, noise.ln()[i])),
        likelihood: 0.0,
        windows: 1,
        evaluations: 1,
        converged: true,
    };
    for i in 0..COUNT {
        assert!(fit(0.49).determines(&prior, i) && !fit(0.51).determines(&prior, i));
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
/// As few spans as are at most 45 s long.
#[test]
fn blocks_are_spans_of_one_length_that_add_up_to_the_drive() {
    use undrift_simulate::{GnssNoise, Trajectory, simulate};
    let interval = 0.02;
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let start = RestNoise::from_model(&model, interval).unwrap();
    let plain = || Settings {
        parameters: undrift_nav::parameters::Parameters::none(),
        ..Settings::new([ShapingFilter::white(0.0, interval).unwrap(); AXES])
    };
    let prior = Prior::new(&start, &[&plain()]);
    let noise = Noise::new(&prior.centre);
    let settings = under(&plain(), &noise, &start).unwrap();
    let receiver = GnssNoise {
        rate_hz: 1.0,
        start: 0.2,
        ..GnssNoise::default()
    };
    let car = Trajectory::car(240.0, 3);
    let log = simulate(&car, 50.0, Some(&settings.sensors), &receiver, 3).unwrap();
    let fixes: Vec<Measurement> = log.gnss.iter().copied().map(Measurement::Gnss).collect();
    let logs = [FitLog {
        imu: &log.imu,
        aiding: &fixes,
        settings: plain(),
        until: f64::INFINITY,
    }];
    let linear = Linear::<24>::new(&logs, noise, &start).unwrap();
    let z = prior.centre;
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
    let logs = [&log, &log].map(|log| FitLog {
        imu: &log.imu,
        aiding: &fixes,
        settings: plain(),
        until: f64::INFINITY,
    });
    let twice = Linear::<24>::new(&logs, noise, &start).unwrap();
    assert_eq!(twice.by_block(&z).len(), 2 * blocks.len());
}
