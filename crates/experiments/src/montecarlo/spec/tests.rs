use super::*;

fn read(text: &str) -> Result<Spec, DriveError> {
    Spec::from_toml(text, "spec.toml", Path::new(""))
}

fn spec(more: &str) -> Result<Spec, DriveError> {
    read(&format!(
        "model = \"mpu6050\"\n[drive]\nkind = \"car\"\n{more}"
    ))
}

/// The key that a specification with these lines more is refused for, if it is.
fn refused(more: &str) -> Option<String> {
    match spec(more) {
        Err(DriveError::Config(error)) => Some(error.key),
        Ok(_) => None,
        Err(other) => panic!("{more}: {other}"),
    }
}

#[test]
fn a_specification_of_a_model_and_a_vehicle_has_the_usual_rest() {
    let found = spec("").unwrap();
    assert_eq!((found.trajectory.duration, found.rate_hz), (600.0, 100.0));
    assert_eq!((found.every, found.settle), (1.0, 60.0));
    assert_eq!((found.scale_factor, found.time_offset), (0.0, 0.0));
    assert_eq!((found.correlated, found.truth_std), (None, None));
    assert_eq!(found.bias_models, [BiasModel::Arma]);
    assert_eq!(found.filter_model, found.model);
    let receiver = GnssNoise::default();
    assert_eq!(found.gnss.position_std, receiver.position_std);
    assert_eq!(
        (found.gnss.rate_hz, found.gnss.start),
        (receiver.rate_hz, receiver.start)
    );
}

#[test]
fn every_key_has_its_place() {
    let found = spec(
        "duration = \"200 s\"\nrate = \"50 Hz\"\n\
         [filter]\nmodel = \"adis16405\"\nbias_models = [\"white\", \"arma\"]\n\
         [gnss]\nposition_std = \"1 m\"\nvelocity_std = \"0.2 m/s\"\nrate = \"5 Hz\"\nstart = \"3 s\"\n\
         lever_arm = \"1, 2, 3 m\"\nnoise_scale = 0.5\ncorrelation_time = \"90 s\"\ncorrelated_share = 0.7\n\
         [states]\nscale_factor = \"1 %\"\ntime_offset = \"20 ms\"\n\
         [initial]\ntruth_std = \"1, 2, 3 deg\"\n\
         [epochs]\nevery = \"0.5 s\"\nsettle = \"10 s\"\n",
    )
    .unwrap();
    assert_eq!((found.trajectory.duration, found.rate_hz), (200.0, 50.0));
    assert!(found.filter_model != found.model);
    assert_eq!(found.bias_models, [BiasModel::White, BiasModel::Arma]);
    assert_eq!(
        (found.gnss.position_std, found.gnss.velocity_std),
        ([1.0; 3], [0.2; 3])
    );
    assert_eq!(
        (found.gnss.rate_hz, found.gnss.start, found.gnss.noise_scale),
        (5.0, 3.0, 0.5)
    );
    assert_eq!(found.gnss.lever_arm, Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(
        found.correlated,
        Some(Correlated {
            share: 0.7,
            time: 90.0
        })
    );
    assert_eq!((found.scale_factor, found.time_offset), (0.01, 0.02));
    assert_eq!(
        found.truth_std,
        Some(Vector3::new(1.0, 2.0, 3.0).map(f64::to_radians))
    );
    assert_eq!((found.every, found.settle), (0.5, 10.0));
    // The filter under each form, with the states that are drawn.
    let settings = found.settings().unwrap();
    let names: Vec<&str> = settings.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["white", "arma"]);
    for (_, settings) in &settings {
        let std = |kind| settings.parameters.prior(kind).map(|prior| prior.std);
        assert_eq!(std(Parameter::GyroScale), Some(0.01));
        assert_eq!(std(Parameter::TimeOffset), Some(0.02));
        assert_eq!(std(Parameter::VelocityTimeOffset), Some(0.02));
        assert_eq!(settings.lever_arm, found.gnss.lever_arm);
        assert_eq!(settings.fix_errors.correlated, found.correlated);
        assert_eq!(settings.sensors[0].interval, 0.02);
    }
    assert!(settings[0].1.sensors[0].order < settings[1].1.sensors[0].order);
    let plain = spec("").unwrap().settings().unwrap();
    assert!(plain[0].1.parameters.prior(Parameter::GyroScale).is_none());
    assert!(plain[0].1.parameters.prior(Parameter::TimeOffset).is_none());
}

#[test]
fn values_have_their_bounds() {
    let least = 2.0 * REST_BEFORE;
    for (more, key) in [
        (
            format!("duration = \"{least} s\"\n[epochs]\nsettle = \"0 s\""),
            None,
        ),
        (
            format!(
                "duration = \"{} s\"\n[epochs]\nsettle = \"0 s\"",
                least - 0.1
            ),
            Some("duration"),
        ),
        ("duration = \"1000000 s\"".to_owned(), Some("duration")),
        (
            "duration = \"1000 s\"\nrate = \"20000 Hz\"".to_owned(),
            None,
        ),
        (
            "duration = \"1000 s\"\nrate = \"20001 Hz\"".to_owned(),
            Some("rate"),
        ),
        ("rate = \"0 Hz\"".to_owned(), Some("rate")),
        ("rate = \"-1 Hz\"".to_owned(), Some("rate")),
        (
            "[gnss]\nposition_std = \"1, 0, 1 m\"".to_owned(),
            Some("position_std"),
        ),
        (
            "[gnss]\nvelocity_std = \"0 m/s\"".to_owned(),
            Some("velocity_std"),
        ),
        ("[gnss]\nrate = \"0 Hz\"".to_owned(), Some("rate")),
        ("[gnss]\nrate = \"100000 Hz\"".to_owned(), Some("rate")),
        ("[gnss]\nstart = \"599 s\"".to_owned(), None),
        ("[gnss]\nstart = \"600 s\"".to_owned(), Some("start")),
        ("[gnss]\nstart = \"-1 s\"".to_owned(), Some("start")),
        (
            "[gnss]\ncorrelation_time = \"0 s\"".to_owned(),
            Some("correlation_time"),
        ),
        (
            "[gnss]\ncorrelation_time = \"1 s\"\ncorrelated_share = 1.0".to_owned(),
            None,
        ),
        (
            "[gnss]\ncorrelation_time = \"1 s\"\ncorrelated_share = 1.1".to_owned(),
            Some("correlation_time"),
        ),
        ("[states]\nscale_factor = \"0 %\"".to_owned(), None),
        (
            "[states]\nscale_factor = \"-10 %\"".to_owned(),
            Some("scale_factor"),
        ),
        (
            "[states]\ntime_offset = \"-1 ms\"".to_owned(),
            Some("time_offset"),
        ),
        (
            "[initial]\ntruth_std = \"1, 0, 1 deg\"".to_owned(),
            Some("truth_std"),
        ),
        ("[epochs]\nevery = \"0.01 s\"".to_owned(), None),
        ("[epochs]\nevery = \"0.015 s\"".to_owned(), Some("every")),
        ("[epochs]\nevery = \"0 s\"".to_owned(), Some("every")),
        // A rate with so many digits: off by a hundred millionth, and by a hundred thousandth.
        (
            "rate = \"33.333333 Hz\"\n[epochs]\nevery = \"3 s\"".to_owned(),
            None,
        ),
        (
            "rate = \"33.333 Hz\"\n[epochs]\nevery = \"3 s\"".to_owned(),
            Some("every"),
        ),
        ("[epochs]\nsettle = \"599 s\"".to_owned(), None),
        ("[epochs]\nsettle = \"599.5 s\"".to_owned(), Some("settle")),
        ("[epochs]\nsettle = \"-1 s\"".to_owned(), Some("settle")),
    ] {
        let found = refused(&more);
        assert_eq!(
            found.as_deref().map(|of| of.rsplit('.').next().unwrap()),
            key,
            "{more}"
        );
    }
}

#[test]
fn what_is_no_specification_is_said_to_be_none() {
    let key = |text: &str| match read(text) {
        Err(DriveError::Config(error)) => (error.key, error.message),
        other => panic!("{other:?}"),
    };
    assert!(
        key("[imu]\nfile = \"a.csv\"")
            .1
            .starts_with("is a drive file")
    );
    let (of, message) = key("[drive]\nkind = \"car\"");
    assert!(
        of == "model" && message.starts_with("missing: the sensors' noise model"),
        "{message}"
    );
    assert!(
        key("model = \"mpu6050\"\n[drive]\nduration = \"100 s\"")
            .1
            .starts_with("missing: \"car\"")
    );
    let both = "model = \"mpu6050\"\n[drive]\nkind = \"car\"\n[initial]\ntruth_std = \"1 deg\"\nattitude = \"0, 0, 0 deg\"";
    assert!(key(both).1.contains("not both"));
}
