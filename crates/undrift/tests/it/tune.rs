//! Identification from drives: simulated ones of known noise, and the drive file that is written.

use undrift::{
    drive::Drive,
    estimator::{LogTo, Logged},
    nav::{
        covariance::AXES,
        parameters::{Parameter, Parameters},
        shaping::ShapingFilter,
    },
    noise::ImuModel,
    replay::{Measurement, Settings, replay},
    settings::fix_errors::{Correlated, FixErrors, StdFactors},
    simulate::{GnssNoise, Simulation, Trajectory, simulate},
    tune::{
        Axes, Tuned, file,
        filter::Fixed,
        fit::{Fit, FitLog, fit, under},
        noise::{COUNT, FIX, LASTING, Noise, RULE, Vector, WALK},
        objective::{Layout, Objective},
        prior::Prior,
        rest_noise::RestNoise,
        steps::{Followed, condense},
    },
    vehicle::{NonHolonomic, Profile},
};

const RATE: f64 = 50.0;

fn start() -> RestNoise {
    let model = ImuModel::preset("mpu6050").unwrap();
    let start = RestNoise::from_model(&model, 1.0 / RATE).unwrap();
    RestNoise {
        turn_on: [8.7e-3, 8.7e-3, 8.7e-3, 0.3, 0.3, 0.3],
        ..start
    }
}

/// Louder than the preset by another factor on each axis.
fn truth(start: &RestNoise) -> Noise {
    let louder = [4.0, 12.0, 3.0, 8.0, 3.0, 6.0];
    Noise {
        white: std::array::from_fn(|i| start.white[i] * louder[i]),
        walk: [2e-5, 1e-5, 1.5e-5, 1e-3, 2e-3, 1e-3],
        factors: StdFactors::ONE,
        rule: [0.2, 0.4, 0.15],
    }
}

fn plain() -> Settings {
    Settings {
        parameters: Parameters::none(),
        ..Settings::new([ShapingFilter::white(0.0, 1.0 / RATE).unwrap(); 6])
    }
}

fn drive(settings: &Settings, seconds: f64, seed: u64) -> (Simulation, Vec<Measurement>) {
    let receiver = GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05; 3],
        rate_hz: 1.0,
        start: 0.2,
        ..GnssNoise::default()
    };
    let trajectory = Trajectory::car(seconds, seed);
    let log = simulate(&trajectory, RATE, Some(&settings.sensors), &receiver, seed).unwrap();
    let fixes = log.gnss.iter().copied().map(Measurement::Gnss).collect();
    (log, fixes)
}

/// Of every parameter, with correlated fixes and a car's constraint: central differences of the value.
#[test]
fn the_gradient_is_that_of_the_value() {
    let start = start();
    gradient_is_that_of_the_value(&start, truth(&start), None);
}

/// The same of white noise that follows the vibration.
#[test]
fn the_gradient_of_factors_on_the_vibration_is_that_of_the_value() {
    let start = start();
    let factors = Noise {
        white: [0.5, 0.6, 0.7, 0.8, 0.9, 1.0],
        ..truth(&start)
    };
    gradient_is_that_of_the_value(&start, factors, Some(factors.white));
}

fn gradient_is_that_of_the_value(start: &RestNoise, about: Noise, factors: Option<[f64; AXES]>) {
    let truth = truth(start);
    let mut settings = plain();
    settings.constraints = Profile::Car.constraints();
    let lasting = Some(Correlated {
        share: 0.6,
        time: 20.0,
    });
    settings.fix_errors = FixErrors {
        correlated: lasting,
        velocity_correlated: lasting,
        ..FixErrors::default()
    };
    settings.parameters = settings.fix_errors.with_states(settings.parameters);
    let (log, fixes) = drive(&under(&settings, &truth, start).unwrap(), 240.0, 3);
    settings.vibration = factors;
    let settings = under(&settings, &about, start).unwrap();
    let (sender, receiver) = std::sync::mpsc::channel::<Logged>();
    let logged = Settings {
        log: Some(LogTo::new(move |logged| drop(sender.send(logged)))),
        ..settings.clone()
    };
    let (imu, aiding) = (log.imu.iter().copied(), fixes.iter().copied());
    replay(&mut imu.map(Ok), &mut aiding.map(Ok), &logged, &mut ()).unwrap();
    drop(logged);
    let fixed = Fixed {
        lasting: [Some(15), Some(18)],
        scale: None,
        rule: settings.constraints.non_holonomic.unwrap(),
        white: factors.map_or([0.0; AXES], |_| start.white.map(|white| white * white)),
    };
    let followed = factors.map(|factors| Followed {
        white: settings.sensors.map(|sensor| sensor.r),
        interval: settings.sensors[0].interval,
        factors,
    });
    let segments = condense(receiver, followed.as_ref());
    let objective = Objective::<24>::new(segments, fixed, Layout::default());
    assert!(objective.windows() > 50, "{}", objective.windows());
    // Away from the noise of the replay.
    let z: Vector = std::array::from_fn(|i| {
        about.ln()[i] * f64::from(u8::from(!(FIX..RULE).contains(&i))) + 0.1
    });
    let score = objective.score(&Noise::new(&z));
    for i in 0..COUNT {
        let moved = |by: f64| {
            let mut z = z;
            z[i] += by;
            objective.score(&Noise::new(&z)).value
        };
        let difference = (moved(1e-4) - moved(-1e-4)) / 2e-4;
        let error = (score.gradient[i] - difference).abs();
        assert!(
            error < 1e-5 * (1.0 + difference.abs()),
            "{i}: {} against {difference}",
            score.gradient[i]
        );
        assert!(difference != 0.0, "{i} does nothing");
    }
    // What the spans say adds up.
    let (first, last) = objective.span().unwrap();
    let middle = 0.5 * (first + last);
    let noise = Noise::new(&z);
    let halves = [
        objective.score_between(&noise, f64::NEG_INFINITY, middle),
        objective.score_between(&noise, middle, f64::INFINITY),
    ];
    for i in 0..COUNT {
        let sum = halves[0].gradient[i] + halves[1].gradient[i];
        assert!((sum - score.gradient[i]).abs() < 1e-6 * (1.0 + sum.abs()));
    }
}

/// Two drives of 15 minutes: what is said to be determined lies within twice its interval: four standard deviations.
#[test]
fn the_noise_of_a_simulated_drive_is_found() {
    let start = start();
    let truth = truth(&start);
    let settings = under(&plain(), &truth, &start).unwrap();
    for seed in [11, 12] {
        let (log, fixes) = drive(&settings, 900.0, seed);
        let prior = Prior::new(&start, &[&plain()]);
        let logs = [FitLog {
            imu: &log.imu,
            aiding: &fixes,
            settings: plain(),
            until: f64::INFINITY,
        }];
        let from = Noise::new(&prior.centre);
        let found = fit(&logs, &start, &prior, from, true, &|_| true).unwrap();
        assert!(found.converged && found.windows > 300, "{found:?}");
        assert!(!prior.used[LASTING] && !prior.used[RULE]);
        let (z, at) = (found.noise.ln(), truth.ln());
        let determined = |i: &usize| found.determines(&prior, *i);
        let known: Vec<usize> = (0..COUNT).filter(determined).collect();
        for i in &known {
            let ((low, high), off) = (found.interval[*i], at[*i] - z[*i]);
            let inside = 2.0 * (low - z[*i]) < off && off < 2.0 * (high - z[*i]);
            assert!(
                inside,
                "seed {seed}, parameter {i}: {off} of {low} to {high}"
            );
        }
        // White noise of half of the axes is seen, and by no more than a factor of two off.
        let white = known.iter().filter(|i| **i < WALK);
        assert!(white.clone().count() >= 3, "{known:?}");
        for i in white {
            assert!((z[*i] - at[*i]).abs() < 0.7, "seed {seed}, axis {i}");
        }
    }
}

/// The drive file: its own text where nothing is changed, readable, with the values found.
#[test]
fn the_drive_file_is_written() {
    let text = "# Mine.\nmodel = \"mpu6050\"\n\n[imu]\nfile = \"imu.csv\" # the log\ntime = \"t\"\n\
        gyro = [\"gx\", \"gy\", \"gz\"]\ngyro_unit = \"deg/s\"\naccel = [\"ax\", \"ay\", \"az\"]\naccel_unit = \"g\"\n\
        rate = \"100 Hz\"\n\n[gnss]\nfile = \"gnss.csv\"\ntime = \"t\"\nposition = [\"lat\", \"lon\", \"h\"]\n\
        position_std = \"1 m\"\n\n[vehicle]\nprofile = \"car\"\n";
    let start = start();
    let mut noise = truth(&start);
    noise.factors.white = [0.8, 1.2];
    noise.rule = [0.05, 0.15, 0.08];
    let mut settings = plain();
    settings.constraints.non_holonomic = Some(NonHolonomic::CAR);
    let found = Tuned {
        pose_faults: Vec::new(),
        posed: false,
        prior: Prior::new(&start, &[&settings]),
        start,
        fit: Fit {
            noise,
            interval: noise.ln().map(|z| (z - 0.2, z + 0.2)),
            likelihood: 0.0,
            windows: 1,
            evaluations: 1,
            converged: true,
        },
        unseen: 0.5,
        held_out: false,
        judged: Vec::new(),
        axes: None,
        following: None,
        withheld: [0; 2],
        follows: false,
        aligns: vec![true],
        stopped: false,
    };
    let model = found.model(&["drive.toml"]);
    let folder = std::env::temp_dir();
    let written = file::tuned(text, &found, &model, Some(&folder)).unwrap();
    assert!(
        written.starts_with("# Mine.") || written.contains("# the log"),
        "{written}"
    );
    let drive = Drive::from_toml(&written, "tuned.toml", &folder, &folder).unwrap();
    assert_eq!(drive.imu.0, folder.join("imu.csv"));
    let rule = drive.constraints.non_holonomic.unwrap();
    assert_eq!([rule.right, rule.down, rule.slip], noise.rule);
    assert_eq!(drive.std_factors.white, [0.8, 1.2]);
    assert_eq!(drive.std_factors.correlated, [1.0, 1.0]);
    let read = drive.model.unwrap();
    for (i, (name, axis)) in read.axes().into_iter().enumerate() {
        // Six digits are written: half of the last of 1.00000.
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 5.1e-6;
        assert!(near(axis.white.unwrap(), noise.white[i]), "{name}");
        assert!(near(axis.random_walk.unwrap(), noise.walk[i]), "{name}");
        assert!(near(axis.turn_on, found.start.turn_on[i]), "{name}");
    }
    assert!(read.source.contains("drive.toml"));
    let kept = file::unchanged(text, Some(&folder)).unwrap();
    let as_before = text.replace("\"imu.csv\"", "").replace("\"gnss.csv\"", "");
    let [imu, gnss] = ["imu.csv", "gnss.csv"].map(|log| format!("{:?}", folder.join(log)));
    let (head, rest) = kept.split_once('\n').unwrap();
    assert!(head.starts_with("# As it was"), "{head}");
    assert_eq!(rest.replace(&imu, "").replace(&gnss, ""), as_before);
    // Once more: the same.
    let again = file::tuned(&written, &found, &model, None).unwrap();
    assert_eq!(again, written);
    assert_eq!(drive.vibration, None);

    // White noise that follows the vibration: that at rest, and the factors.
    let mut found = found;
    found.follows = true;
    found.fit.noise.white = [0.5, 0.25, 0.75, 1.5, 1.0, 0.125];
    found.start.vibrating = Some(found.start.white.map(|white| 3.0 * white));
    settings.vibration = Some([1.0; AXES]);
    found.prior = Prior::new(&found.start, &[&settings]);
    let model = found.model(&["drive.toml"]);
    let written = file::tuned(&written, &found, &model, None).unwrap();
    let drive = Drive::from_toml(&written, "tuned.toml", &folder, &folder).unwrap();
    assert_eq!(drive.vibration, Some(found.fit.noise.white));
    let steady = found.steady_model(&["drive.toml"]);
    let of_both = drive.model.unwrap();
    for (i, (_, axis)) in of_both.axes().into_iter().enumerate() {
        let rest = found.start.white[i];
        assert!((axis.white.unwrap() / rest - 1.0).abs() < 5.1e-6);
        // √(1 + f² (3² − 1)) times that at rest.
        let beyond = 8.0 * found.fit.noise.white[i].powi(2);
        let density = steady.axes()[i].1.white.unwrap();
        assert!((density / (rest * (1.0 + beyond).sqrt()) - 1.0).abs() < 1e-12);
    }
    // And back.
    found.follows = false;
    let again = file::tuned(&written, &found, &found.model(&["drive.toml"]), None).unwrap();
    assert!(again.contains("vibration = \"off\"") && !again.contains("vibration_factors"));

    // Errors of the axes are states only where they are kept.
    let std = |scale_factors: bool, kept: bool| {
        let mut found = found.clone();
        found.axes = Some(Axes {
            scale_factors,
            gain: 40.0,
            kept,
        });
        let written = file::tuned(&again, &found, &found.model(&["drive.toml"]), None).unwrap();
        let drive = Drive::from_toml(&written, "tuned.toml", &folder, &folder).unwrap();
        let std = |of| drive.parameters.prior(of).map(|prior| prior.std);
        [Parameter::AccelMisalignment, Parameter::AccelScale].map(std)
    };
    assert_eq!(std(true, false), [None; 2]);
    assert_eq!(std(false, true), [Some(0.6f64.to_radians()), None]);
    assert_eq!(std(true, true), [Some(0.6f64.to_radians()), Some(0.01)]);
}
