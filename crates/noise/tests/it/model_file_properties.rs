//! Any model file, written, read and written again, is the same text and the same model.

use crate::common::generators::{seeded, stable};
use proptest::prelude::*;
use undrift_noise::model_file::MAX_PROCESSES;
use undrift_noise::{Arma, AxisModel, GaussMarkov, ImuModel, Provenance};

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
    fn axis()(
        turn_on in level(),
        white in level(),
        quantisation in prop::option::of(level()),
        instability in prop::collection::vec((level(), positive()), 0..=MAX_PROCESSES),
        random_walk in prop::option::of(level()),
        arma in prop::option::of(arma()),
        paper_sigma in prop::option::of(level()),
        identification in prop::collection::hash_map(text(), value(), 0..4),
        whether in any::<bool>(),
    ) -> AxisModel {
        AxisModel {
            turn_on,
            // An axis has white noise or an ARMA, or it is none.
            white: (whether || arma.is_none()).then_some(white),
            quantisation,
            instability: instability.into_iter().map(|(sigma, tau_s)| GaussMarkov { sigma, tau_s }).collect(),
            random_walk,
            arma,
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
        model.provenance = Provenance { record, rate_hz, samples, sha256: None, program };
        let [_, gy, gz, ax, ay, az] = axes;
        model.gyro = [first.clone(), gy.unwrap_or_default(), gz.unwrap_or_default()];
        if alike {
            model.gyro = [first.clone(), first.clone(), first];
        }
        model.accel = [ax, ay, az].map(Option::unwrap_or_default);
        model
    }
}

/// Whether two numbers are the same to the last places of a text.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-15 * a.abs()
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
                prop_assert_eq!((&a.ar, &a.ma), (&b.ar, &b.ma));
                prop_assert!(same(a.sigma, b.sigma) && same(a.rate_hz, b.rate_hz));
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

#[test]
fn a_number_of_sixteen_digits_is_written_again_as_it_was_read() {
    // 302.8450364210773 mg, whose fifteen digits are 1e-15 away.
    let mut model = with_one_axis(AxisModel::default());
    model.accel[0] = AxisModel {
        white: Some(0.0),
        instability: vec![GaussMarkov {
            sigma: 2.9698952764187583,
            tau_s: 1.0,
        }],
        ..AxisModel::default()
    };
    let text = model.to_toml();
    let read = ImuModel::from_toml(&text, "text").unwrap();
    assert_eq!(read.accel[0].instability, model.accel[0].instability);
    assert_eq!(read.to_toml(), text);
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
