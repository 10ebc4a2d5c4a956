#![no_main]

use undrift::noise::{BiasModel, ImuModel, ModelFormat};

libfuzzer_sys::fuzz_target!(|text: &str| {
    match ImuModel::from_toml(text, "IMU.toml") {
        Ok(model) => check(&model),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});

/// Its numbers are finite, it can be written and read back, and every use of it ends.
fn check(model: &ImuModel) {
    for (name, axis) in model.axes() {
        let walks = axis
            .instability
            .iter()
            .flat_map(|part| [part.sigma, part.tau_s]);
        let terms = [axis.white, axis.quantisation].into_iter().flatten();
        let mut numbers = walks.chain(terms).chain([axis.turn_on]);
        assert!(
            numbers.all(|x| x.is_finite() && x >= 0.0),
            "{name}: {axis:?}"
        );
    }
    let text = model.to_toml();
    let again = ImuModel::from_toml(&text, "again.toml");
    assert!(again.is_ok(), "{again:?} of\n{text}");
    for bias in BiasModel::ALL {
        let _ = model.shaping(bias, 0.01);
    }
    for format in ModelFormat::ALL {
        let _ = model.export(format, None);
    }
}
