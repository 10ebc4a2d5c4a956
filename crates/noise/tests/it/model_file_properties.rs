//! Any model file, written, read and written again, is the same text and to its digits the same model.

use crate::common::generators::{seeded, stable};
use proptest::prelude::*;
use undrift_noise::model_file::{Line, MAX_PROCESSES};
use undrift_noise::temperature::Temperature;
use undrift_noise::{Arma, AxisModel, BiasModel, GaussMarkov, ImuModel, Provenance};

/// A positive number of any usual size.
fn positive() -> impl Strategy<Value = f64> {
    (-12.0..4.0f64).prop_map(|exponent| 10f64.powf(exponent))
}

/// Nothing, zero, or a number of any usual size.
fn level() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), positive()]
}

/// Text with all that TOML has to escape.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![any::<String>(), r#"[a-z"'\\\n\t#=\[\]°\u{1}\u{7f}]{0,12}"#]
}

fn value() -> impl Strategy<Value = toml::Value> {
    let leaf = prop_oneof![
        text().prop_map(toml::Value::String),
        any::<i64>().prop_map(toml::Value::Integer),
        // NaN is not equal to itself.
        prop_oneof![
            prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
            Just(f64::INFINITY),
            Just(f64::NEG_INFINITY),
        ]
        .prop_map(toml::Value::Float),
        any::<bool>().prop_map(toml::Value::Boolean),
    ];
    leaf.prop_recursive(3, 12, 4, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(toml::Value::Array),
            prop::collection::hash_map(text(), inner, 0..4)
                .prop_map(|map| toml::Value::Table(map.into_iter().collect())),
        ]
    })
}

prop_compose! {
    fn arma()(ar in stable(4), ma in stable(4), sigma in positive(), rate_hz in 1.0..2000.0f64) -> Arma {
        Arma { ar, ma, sigma, rate_hz }
    }
}

prop_compose! {
    fn line()(frequency_hz in positive(), amplitude in positive(), width_hz in level()) -> Line {
        Line { frequency_hz, amplitude, width_hz }
    }
}

prop_compose! {
    fn temperature()(
        lowest in -40.0..20.0f64, reference in 25.0..40.0f64, highest in 45.0..85.0f64,
        slope in prop_oneof![level(), level().prop_map(|x| -x)], slope_sigma in level(),
        quadratic in level().prop_map(|x| -x), quadratic_sigma in level(), body_axes in any::<bool>(),
    ) -> Temperature {
        let range_c = [lowest, highest];
        Temperature { reference_c: reference, range_c, slope, slope_sigma, quadratic, quadratic_sigma, body_axes }
    }
}

prop_compose! {
    fn axis()(
        turn_on in level(),
        white in level(),
        quantisation in prop::option::of(level()),
        instability in prop::collection::vec((level(), positive()), 0..=MAX_PROCESSES),
        random_walk in prop::option::of(level()),
        arma in prop::option::of(arma()),
        lines in prop::collection::vec(line(), 0..3),
        temperature in prop::option::of(temperature()),
        paper_sigma in prop::option::of(level()),
        identification in prop::collection::hash_map(text(), value(), 0..4),
        whether in any::<bool>(),
    ) -> AxisModel {
        AxisModel {
            turn_on,
            // An axis has white noise or an ARMA, or is absent.
            white: (whether || arma.is_none()).then_some(white),
            quantisation,
            instability: instability.into_iter().map(|(sigma, tau_s)| GaussMarkov { sigma, tau_s }).collect(),
            random_walk,
            arma,
            lines,
            temperature,
            paper_sigma,
            identification: identification.into_iter().collect(),
        }
    }
}

prop_compose! {
    fn model()(
        name in text(), source in text(),
        record in prop::option::of(text()), rate_hz in prop::option::of(positive()),
        samples in prop::option::of(0..u64::try_from(i64::MAX).unwrap()), program in prop::option::of(text()),
        axes in prop::array::uniform6(prop::option::of(axis())), first in axis(), alike in any::<bool>(),
    ) -> ImuModel {
        let mut model = ImuModel::default();
        (model.name, model.source) = (name, source);
        model.provenance = Provenance { record, rate_hz, samples, program, ..Provenance::default() };
        let [_, gy, gz, ax, ay, az] = axes;
        model.gyro = [first.clone(), gy.unwrap_or_default(), gz.unwrap_or_default()];
        if alike {
            model.gyro = [first.clone(), first.clone(), first];
        }
        model.accel = [ax, ay, az].map(Option::unwrap_or_default);
        model
    }
}

/// Whether two numbers are the same to six digits: half of the last of 1.00000, and the rounding of the unit.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 5.000_001e-6 * a.abs()
}

fn options_same(a: Option<f64>, b: Option<f64>) -> bool {
    a.is_some() == b.is_some() && same(a.unwrap_or(0.0), b.unwrap_or(0.0))
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn a_model_written_and_read_is_the_same_and_written_again_the_same_text(model in model()) {
        let text = model.to_toml();
        let read = ImuModel::from_toml(&text, "text").map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!((&read.name, &read.source), (&model.name, &model.source));
        prop_assert_eq!((&read.provenance.record, &read.provenance.program), (&model.provenance.record, &model.provenance.program));
        prop_assert_eq!(read.provenance.samples, model.provenance.samples);
        prop_assert!(options_same(read.provenance.rate_hz, model.provenance.rate_hz));
        for ((name, a), (_, b)) in model.axes().into_iter().zip(read.axes()) {
            prop_assert!(same(a.turn_on, b.turn_on), "{name}");
            for (a, b) in [
                (a.white, b.white), (a.quantisation, b.quantisation),
                (a.random_walk, b.random_walk), (a.paper_sigma, b.paper_sigma),
            ] {
                prop_assert!(options_same(a, b), "{name}: {a:?} {b:?}\n{text}");
            }
            prop_assert_eq!(a.instability.len(), b.instability.len());
            for (a, b) in a.instability.iter().zip(&b.instability) {
                prop_assert!(same(a.sigma, b.sigma) && same(a.tau_s, b.tau_s), "{name}: {a:?} {b:?}");
            }
            prop_assert_eq!(a.arma.is_some(), b.arma.is_some());
            if let (Some(a), Some(b)) = (&a.arma, &b.arma) {
                let (a_all, b_all) = (a.ar.iter().chain(&a.ma), b.ar.iter().chain(&b.ma));
                prop_assert_eq!((a.ar.len(), a.ma.len()), (b.ar.len(), b.ma.len()));
                prop_assert!(a_all.zip(b_all).all(|(a, b)| same(*a, *b)));
                prop_assert!(same(a.sigma, b.sigma) && same(a.rate_hz, b.rate_hz));
            }
            let numbers = |t: &Temperature| [
                t.reference_c, t.range_c[0], t.range_c[1], t.slope, t.slope_sigma, t.quadratic, t.quadratic_sigma,
            ];
            prop_assert_eq!(a.temperature.is_some(), b.temperature.is_some());
            if let (Some(a), Some(b)) = (&a.temperature, &b.temperature) {
                prop_assert!(numbers(a).iter().zip(numbers(b)).all(|(a, b)| same(*a, b)), "{a:?} {b:?}");
                prop_assert_eq!(a.body_axes, b.body_axes);
            }
            prop_assert_eq!(&a.identification, &b.identification);
        }
        prop_assert_eq!(read.to_toml(), text);
    }
}

fn with_one_axis(axis: AxisModel) -> ImuModel {
    let mut model = ImuModel::default();
    model.gyro[0] = axis;
    model
}

#[test]
fn a_key_with_an_apostrophe_and_a_backslash_is_written_so_that_it_reads() {
    let mut axis = AxisModel {
        white: Some(1e-4),
        ..AxisModel::default()
    };
    for key in ["'\\", "", "a b", "\"", "\n\u{1}\u{85}°"] {
        axis.identification.insert(key.into(), 1.into());
    }
    let model = with_one_axis(axis);
    let read = ImuModel::from_toml(&model.to_toml(), "text").unwrap();
    assert_eq!(read.gyro[0].identification, model.gyro[0].identification);
}

/// Variance of the sum of `samples` samples, the drift [unit²], by the autocovariance.
fn drift(axis: &AxisModel, model: BiasModel, samples: usize) -> f64 {
    let mut lags = vec![0.0; samples];
    let filter = axis.shaping(model, 0.01).unwrap();
    filter.autocovariance(&mut lags);
    let pairs = |k: usize| if k == 0 { samples } else { 2 * (samples - k) } as f64;
    lags.iter().enumerate().map(|(k, lag)| pairs(k) * lag).sum()
}

/// Power spectrum of an ARMA over its innovations' at a frequency [rad/sample], by complex powers.
fn spectrum(arma: &Arma, frequency: f64) -> f64 {
    let squared = |coefficients: &[f64]| {
        let lags = coefficients
            .iter()
            .enumerate()
            .map(|(k, c)| (c, frequency * (k + 1) as f64));
        let (re, im) = lags.fold((1.0, 0.0), |(re, im), (c, angle)| {
            (re - c * angle.cos(), im + c * angle.sin())
        });
        re * re + im * im
    };
    squared(&arma.ma) / squared(&arma.ar)
}

/// `1 − c1 B − …` of its inverse roots, real or pairs of (radius, angle).
fn of_roots(real: &[f64], pairs: &[(f64, f64)]) -> Vec<f64> {
    let factors = real.iter().map(|r| vec![1.0, -r]);
    let pairs = pairs
        .iter()
        .map(|(r, angle)| vec![1.0, -2.0 * r * angle.cos(), r * r]);
    let product = factors.chain(pairs).fold(vec![1.0], |a: Vec<f64>, b| {
        let mut out = vec![0.0; a.len() + b.len() - 1];
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                out[i + j] += x * y;
            }
        }
        out
    });
    product[1..].iter().map(|c| -c).collect()
}

#[test]
fn a_model_that_was_written_drifts_as_before() {
    // 5e-6 of each of a few terms, twice in a variance: far below what is allowed.
    let close = |a: f64, b: f64, what: &str| assert!((a / b - 1.0).abs() < 1e-4, "{what}: {a} {b}");
    let terms = AxisModel {
        white: Some(1.234_567_891e-4),
        instability: vec![
            GaussMarkov {
                sigma: 3.141_592_653_5e-5,
                tau_s: 23.456_789_123,
            },
            GaussMarkov {
                sigma: 2.718_281_828_4e-5,
                tau_s: 1_234.567_891_23,
            },
        ],
        quantisation: Some(1.0 / 3e7),
        ..AxisModel::default()
    };
    let read = ImuModel::from_toml(&with_one_axis(terms.clone()).to_toml(), "text").unwrap();
    for samples in [100, 1000, 6000] {
        let of = |axis: &AxisModel| drift(axis, BiasModel::Arma, samples);
        close(of(&read.gyro[0]), of(&terms), "terms");
    }
    // Roots of correlation times of a second to 3 h, and a resonance, at 100 Hz; θ as close as noise leaves it.
    let third = 1.0 / 3.0;
    for (what, ar, ma) in [
        (
            "ARMA(1,1)",
            of_roots(&[1.0 - 1e-5 * third], &[]),
            of_roots(&[0.999_4 + 1e-5 * third], &[]),
        ),
        (
            "3 h",
            of_roots(&[1.0 - 1e-6 * third], &[]),
            of_roots(&[0.997 + 1e-4 * third], &[]),
        ),
        (
            "two slow roots",
            of_roots(&[1.0 - 2e-5 * third, 0.99 + 1e-3 * third], &[]),
            of_roots(&[0.999 + 1e-4 * third, 0.9], &[]),
        ),
        (
            "ARMA(4,3)",
            of_roots(
                &[1.0 - 1e-4 * third, third],
                &[(0.998 + 1e-4 * third, 1.234_5)],
            ),
            of_roots(&[0.999 + 1e-4 * third], &[(0.99, 1.2)]),
        ),
        (
            "unit root",
            vec![1.0],
            of_roots(&[0.999_4 + 1e-5 * third], &[]),
        ),
    ] {
        let stationary = what != "unit root";
        let arma = Arma {
            ar,
            ma,
            sigma: 0.008 * third,
            rate_hz: 100.0,
        };
        let axis = AxisModel {
            arma: Some(arma.clone()),
            ..AxisModel::default()
        };
        let text = with_one_axis(axis.clone()).to_toml();
        let read = ImuModel::from_toml(&text, "text").unwrap();
        let back = read.gyro[0].arma.as_ref().unwrap();
        // Lowest: a tenth of a radian in a record of a million samples.
        for k in 0..500 {
            let frequency = 1e-6 * 3.1e6f64.powf(f64::from(k) / 499.0);
            close(spectrum(back, frequency), spectrum(&arma, frequency), what);
        }
        for samples in [100, 1000, 6000] {
            let of = |axis: &AxisModel| drift(axis, BiasModel::Arma, samples);
            if stationary {
                close(of(&read.gyro[0]), of(&axis), what);
            }
        }
        let digits = |c: &f64| format!("{c:e}").bytes().filter(u8::is_ascii_digit).count();
        let longest = back.ar.iter().chain(&back.ma).map(digits).max();
        // Twelve, and one or two of the exponent.
        // Two slow roots leave 1 − Σφ of 1e-8, which twelve digits do not hold: they are written in full.
        let in_full = what == "two slow roots";
        assert!(in_full || longest <= Some(14), "{what}: {text}");
    }
}

#[test]
fn no_line_of_a_written_model_is_long() {
    let mut axis = AxisModel {
        white: Some(1.0 / 3e4),
        ..AxisModel::default()
    };
    let reason = "the simplest within the sampling error of the best; ".repeat(9);
    let scores: toml::Table = (0..15)
        .map(|k| {
            (
                format!("candidate {k}"),
                toml::Value::from(vec![0.1, 1.5, 2.0]),
            )
        })
        .collect();
    axis.identification.insert("a_reason".into(), reason.into());
    axis.identification
        .insert("drift_scores".into(), scores.into());
    axis.identification
        .insert("runner_up".into(), "white".into());
    let mut model = with_one_axis(axis);
    model.source = "turn_on of gyro_x is the largest that the means allow; ".repeat(20);
    let text = model.to_toml();
    let longest = text.lines().map(|line| line.chars().count()).max();
    assert!(longest <= Some(100), "{text}");
    let read = ImuModel::from_toml(&text, "text").unwrap();
    assert_eq!(read.gyro[0].identification, model.gyro[0].identification);
    assert_eq!(read.source, model.source);
}

#[test]
fn whole_numbers_in_every_spelling_of_toml_are_read() {
    let text = "format = \"undrift-imu\"\nversion = 1\n[gyro]\nwhite_noise = \"0.1 deg/sqrt(h)\"\n[provenance]\nsamples = 1_000_000\n[gyro.identification]\na = +5\nb = -1_0\nc = 0xff_ff\nd = 1_0.5e+1\n";
    let read = ImuModel::from_toml(text, "text").unwrap();
    assert_eq!(read.provenance.samples, Some(1_000_000));
    let found = &read.gyro[0].identification;
    for (key, value) in [("a", 5), ("b", -10), ("c", 0xffff)] {
        assert_eq!(found[key].as_integer(), Some(value), "{key}");
    }
    assert_eq!(found["d"].as_float(), Some(105.0));
}
