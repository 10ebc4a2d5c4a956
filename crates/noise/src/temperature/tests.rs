use super::*;

#[test]
fn a_temperature_is_read_with_its_unit() {
    for (text, expected) in [
        ("25 degC", Some(25.0)),
        ("25degC", Some(25.0)),
        (" 25 °C ", Some(25.0)),
        ("25 celsius", Some(25.0)),
        ("-5 C", Some(-5.0)),
        ("\u{2212}5C", Some(-5.0)),
        ("300.15 K", Some(27.0)),
        ("0 K", Some(-273.15)),
        ("-273.15 C", Some(-273.15)),
        ("-273.16 C", None),
        ("-0.01 K", None),
        ("inf C", None),
        ("warm C", None),
        ("25", None),
        ("25 F", None),
    ] {
        let found = celsius(text);
        assert_eq!(found.is_some(), expected.is_some(), "{text}");
        let miss = found.zip(expected).map_or(0.0, |(a, b)| a - b);
        assert!(miss.abs() < 1e-12, "{text}: {found:?}");
    }
}

#[test]
fn a_missing_temperature_is_the_last_and_a_tenth_may_be_missing() {
    let nan = f64::NAN;
    let temperature = [nan, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
    assert_eq!(
        held(&temperature),
        Ok(vec![1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    );
    assert_eq!(held(&temperature[..9]), Err(TemperatureError::Missing));
    let mut two = [temperature, temperature].concat();
    two[0] = 7.0;
    two[19] = f64::INFINITY;
    let found = held(&two).unwrap();
    assert_eq!(
        (found[0], found[9], found[10], found[19]),
        (7.0, 9.0, 9.0, 8.0)
    );
}

/// Temperatures about 20 °C, of which the squares of one and two steps are orthogonal.
fn steps() -> Vec<f64> {
    (0..900).map(|k| 20.0 + f64::from(k % 3) - 1.0).collect()
}

#[test]
fn an_effect_without_noise_is_found_as_it_is() {
    let temperature = steps();
    let bias = |t: &f64| 7.0 + 0.3 * (t - 20.0) - 0.2 * (t - 20.0).powi(2);
    let record: Vec<f64> = temperature.iter().map(bias).collect();
    let regressors = Regressors::new(&record, &temperature, 0.5).unwrap();
    let found = regressors.plain().unwrap();
    assert!((found.slope - 0.3).abs() < 1e-9 && (found.quadratic + 0.2).abs() < 1e-9);
    assert!((found.reference_c - 20.0).abs() < 1e-9);
    assert_eq!((found.range_c, found.body_axes), ([19.0, 21.0], false));
    // White noise of density 1 at 2 Hz: 2 over Σt² of 600, and for the squares over Σ(t² − 2/3)² of 200.
    assert!((found.slope_sigma - (2.0f64 / 600.0).sqrt()).abs() < 1e-9);
    assert!((found.quadratic_sigma - (2.0f64 / 200.0).sqrt()).abs() < 1e-9);
    for (t, bias) in [(20.0, 0.0), (22.0, -0.2), (19.0, -0.5)] {
        assert!((found.bias(t) - bias).abs() < 1e-9, "{t}");
    }
    let explained =
        |coefficients: &[f64]| regressors.explained(&DVector::from_row_slice(coefficients));
    // In units of the standard deviation √(2/3): the slope and the quadratic have 0.09 · 2/3 and 0.04 · 2/9 of variance.
    let (slope, quadratic) = (0.3 * (2.0f64 / 3.0).sqrt(), -0.2 * 2.0 / 3.0);
    let (a, b) = (0.06, 0.04 * 2.0 / 9.0);
    assert!((explained(&[7.0, slope, quadratic]) - 1.0).abs() < 1e-9);
    assert!((explained(&[0.0, slope]) - a / (a + b)).abs() < 1e-9);
    assert!(explained(&[3.0]) < 1e-12);
}

#[test]
fn a_record_is_averaged_to_a_thousand_blocks_and_the_temperature_has_to_change() {
    let ramp = |n: usize, change: f64| -> Vec<f64> {
        (0..n)
            .map(|k| 20.0 + change * k as f64 / (n - 1) as f64)
            .collect()
    };
    let regressors = |n: usize, change: f64| Regressors::new(&vec![1.0; n], &ramp(n, change), 0.1);
    for (n, block) in [(900, 1), (1000, 1), (1001, 2), (3500, 4)] {
        let found = regressors(n, 10.0).unwrap().averages;
        assert_eq!((found.block, found.rows.len()), (block, n / block), "{n}");
        assert_eq!(found.interval, 0.1);
    }
    assert!(regressors(500, 0.5 + 1e-9).is_ok());
    let Err(TemperatureError::Steady { change_k }) = regressors(500, 0.49) else {
        panic!()
    };
    assert!((change_k - 0.49).abs() < 1e-9);
    // Averages of 0 and 1 over pairs: rows are the record, one, and the temperature's powers of unit variance.
    let rows = Regressors::new(&[4.0, 8.0], &[10.0, 14.0], 0.1).unwrap();
    assert_eq!(
        rows.averages.rows,
        [[4.0, 1.0, -1.0, 0.0], [8.0, 1.0, 1.0, 0.0]]
    );
    assert_eq!((rows.scale, rows.reference_c), (2.0, 12.0));
}

#[test]
fn a_quadratic_is_integrated_out_where_it_is_in_the_effect() {
    let temperature = steps();
    let record: Vec<f64> = (0..900).map(|k| f64::from(k * 37 % 19)).collect();
    let regressors = Regressors::new(&record, &temperature, 0.5).unwrap();
    let white = ShapingFilter::white(3.0, 0.5).unwrap();
    for (with_quadratic, count) in [(false, 1), (true, 2)] {
        let found = regressors.restriction(&white, with_quadratic);
        assert_eq!(
            found,
            regressors.averages.restriction(&white, count).unwrap()
        );
    }
    assert!(regressors.restriction(&white, false) != regressors.restriction(&white, true));
}

#[test]
fn an_effect_is_determined_by_its_standard_errors_and_the_fall_of_the_criterion() {
    let temperature: Vec<f64> = (0..900)
        .map(|k| 20.0 + (f64::from(k) / 40.0).sin())
        .collect();
    let of = |slope: f64, quadratic: f64| {
        let mut record = vec![0.0; 900];
        let white = ShapingFilter::white(0.3, 1.0).unwrap();
        crate::synthesis::NoiseGenerator::new(&white, 5).fill(&mut record);
        for (x, t) in record.iter_mut().zip(&temperature) {
            *x += slope * (t - 20.0) + quadratic * (t - 20.0).powi(2);
        }
        Regressors::new(&record, &temperature, 1.0)
            .unwrap()
            .estimate()
            .unwrap()
    };
    // Noise of 0.3, Σ(t − 20)² of 450: a slope is known to 0.014, a quadratic to 0.027.
    let none = of(0.0, 0.0);
    assert!(!none.determined && none.effect.quadratic == 0.0 && none.explained < 0.02);
    assert!((0.01..0.03).contains(&none.effect.slope_sigma), "{none:?}");
    assert_eq!(none.in_model(), None);
    let slope = of(0.3, 0.0);
    assert!(
        slope.determined && slope.effect.quadratic == 0.0,
        "{slope:?}"
    );
    assert!((slope.effect.slope - 0.3).abs() < 0.06);
    assert_eq!(slope.in_model(), Some(slope.effect));
    let both = of(0.3, 0.5);
    assert!(
        both.determined && (both.effect.quadratic - 0.5).abs() < 0.12,
        "{both:?}"
    );
    // A quadratic alone: the slope says nothing, the effect is determined all the same.
    let bent = of(0.0, 0.5);
    assert!(
        bent.determined && (bent.effect.quadratic - 0.5).abs() < 0.12,
        "{bent:?}"
    );
}
