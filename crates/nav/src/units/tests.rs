use super::Quantity::*;
use super::*;
use crate::earth::STANDARD_GRAVITY;
use core::f64::consts::PI;
use std::{format, string::ToString};

/// A few roundings of the factor.
const RELATIVE: f64 = 1e-15;

#[test]
fn spellings_of_the_field() {
    let d = PI / 180.0;
    let g = STANDARD_GRAVITY;
    for (text, quantity, si) in [
        ("2 deg/sqrt(h)", AngleRandomWalk, 2.0 * d / 60.0),
        ("2.0deg/√h", AngleRandomWalk, 2.0 * d / 60.0),
        ("2 °/√hr", AngleRandomWalk, 2.0 * d / 60.0),
        ("2 deg/rt-hr", AngleRandomWalk, 2.0 * d / 60.0),
        ("2 deg h^-0.5", AngleRandomWalk, 2.0 * d / 60.0),
        ("0.05 deg/s/sqrt(Hz)", AngleRandomWalk, 0.05 * d),
        ("0.05 deg/s / √Hz", AngleRandomWalk, 0.05 * d),
        ("0.05 (deg/s)/sqrt(Hz)", AngleRandomWalk, 0.05 * d),
        ("4 dps/rtHz", AngleRandomWalk, 4.0 * d),
        ("4 mdps/√Hz", AngleRandomWalk, 4e-3 * d),
        ("120 deg/h/sqrt(Hz)", AngleRandomWalk, 120.0 * d / 3600.0),
        ("1e-4 rad/sqrt(s)", AngleRandomWalk, 1e-4),
        ("1e-4 rad/s/Hz^(1/2)", AngleRandomWalk, 1e-4),
        ("0.2 m/s/sqrt(h)", VelocityRandomWalk, 0.2 / 60.0),
        ("100 ug/sqrt(Hz)", VelocityRandomWalk, 1e-4 * g),
        ("100 µg/√Hz", VelocityRandomWalk, 1e-4 * g),
        ("0.1 mg/rt(Hz)", VelocityRandomWalk, 1e-4 * g),
        ("0.01 m/s^2/sqrt(Hz)", VelocityRandomWalk, 0.01),
        ("0.01 m/s²/√Hz", VelocityRandomWalk, 0.01),
        ("6 deg/h/sqrt(h)", RateRandomWalk, 6.0 * d / 3600.0 / 60.0),
        ("6 deg/h^(3/2)", RateRandomWalk, 6.0 * d / 3600.0 / 60.0),
        ("6 deg/h^1.5", RateRandomWalk, 6.0 * d / 3600.0 / 60.0),
        ("1e-6 rad/s/sqrt(s)", RateRandomWalk, 1e-6),
        ("1e-6 rad/s^2/sqrt(Hz)", RateRandomWalk, 1e-6),
        ("0.1 deg/s/sqrt(s)", RateRandomWalk, 0.1 * d),
        ("1 mg/sqrt(h)", AccelerationRandomWalk, 1e-3 * g / 60.0),
        ("1 m/s^2/sqrt(s)", AccelerationRandomWalk, 1.0),
        ("1 m/s^3/sqrt(Hz)", AccelerationRandomWalk, 1.0),
        ("25 deg/h", AngularRate, 25.0 * d / 3600.0),
        ("25 dph", AngularRate, 25.0 * d / 3600.0),
        ("1e-3 rad/s", AngularRate, 1e-3),
        ("3 rad s⁻¹", AngularRate, 3.0),
        ("0.2 mg", Acceleration, 2e-4 * g),
        ("200 mGal", Acceleration, 2e-3),
        ("36 deg/h/K", RatePerKelvin, 0.01 * d),
        ("-0.01 °/s/°C", RatePerKelvin, -0.01 * d),
        ("1 deg/s/K²", RatePerKelvin2, d),
        ("20 ug/degC", AccelerationPerKelvin, 2e-5 * g),
        ("1 mg/K^2", AccelerationPerKelvin2, 1e-3 * g),
        ("9.8 m*s^-2", Acceleration, 9.8),
        ("9.8 m/s2", Acceleration, 9.8),
        ("9.8 m s-2", Acceleration, 9.8),
        ("2 m3 m-2", Length, 2.0),
        ("3 rad s-1", AngularRate, 3.0),
        ("1 m/s3/sqrt(Hz)", AccelerationRandomWalk, 1.0),
        ("\u{2212}5.5 deg", Angle, -5.5 * d),
        ("-5.5 deg", Angle, -5.5 * d),
        ("36 arcsec", Angle, 0.01 * d),
        ("30 cm", Length, 0.3),
        ("10 ms", Time, 0.01),
        ("1.5 h", Time, 5400.0),
        ("100 Hz", Frequency, 100.0),
        ("50 1/s", Frequency, 50.0),
        ("36 km/h", Velocity, 10.0),
        ("129.6 km/h^2", Acceleration, 0.01),
        ("129.6 km h^-2", Acceleration, 0.01),
        ("4 cm³/mm²", Length, 4.0),
        ("3600 kn", Velocity, 1852.0),
        ("0.7", Dimensionless, 0.7),
        ("5 %", Dimensionless, 0.05),
        ("1e2m", Length, 100.0),
    ] {
        let value = parse(text, quantity).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert!(
            (value - si).abs() <= RELATIVE * si.abs() * 2.0,
            "{text}: {value} {si}"
        );
    }
}

#[test]
fn raw_counts_are_a_unit_of_columns() {
    let (d, g) = (PI / 180.0, STANDARD_GRAVITY);
    for (unit, quantity, si) in [
        ("LSB/131 deg/s", AngularRate, d / 131.0),
        ("131 LSB/(deg/s)", AngularRate, d / 131.0),
        ("131 LSB/dps", AngularRate, d / 131.0),
        ("16.4 LSB/(°/s)", AngularRate, d / 16.4),
        ("8.75 mdps/LSB", AngularRate, 8.75e-3 * d),
        ("LSB/16384 g", Acceleration, g / 16384.0),
        ("16384 LSB/g", Acceleration, g / 16384.0),
        ("0.061 mg/LSB", Acceleration, 6.1e-5 * g),
        ("250/32768 deg/s/LSB", AngularRate, 250.0 * d / 32768.0),
        ("LSB/1e6 rad", Angle, 1e-6),
        ("LSB/100 m/s", Velocity, 0.01),
        ("0.1 ms/LSB", Time, 1e-4),
        ("mm/LSB", Length, 1e-3),
        ("mpu6050/250dps", AngularRate, 250.0 * d / 32768.0),
        ("MPU6050/16 g", Acceleration, 16.0 * g / 32768.0),
        ("lsm6dso/2000 deg/s", AngularRate, 0.07 * d),
    ] {
        let factor = unit_factor(unit, quantity).unwrap_or_else(|e| panic!("{unit}: {e}"));
        assert!((factor / si - 1.0).abs() < 1e-14, "{unit}: {factor} {si}");
    }
    for (unit, quantity, message) in [
        ("LSB", AngularRate, "a number without unit"),
        ("LSB/131", AngularRate, "a number without unit"),
        ("LSB/16384 g", AngularRate, "the unit of an acceleration"),
        ("131 LSB/deg/s", AngularRate, "wrong dimension"),
        ("LSB^2/131 deg/s", AngularRate, "wrong dimension"),
        ("LSB/0 deg/s", AngularRate, "cannot be read"),
        ("LSB/1000 Hz", Frequency, "columns of samples only"),
        ("131 deg/s", AngularRate, "cannot be read at \"131 deg/s\""),
        ("m/s 2", Acceleration, "cannot be read at \"2\""),
        ("m/s22", Acceleration, "cannot be read at \"22\""),
        ("m-4 s", Length, "cannot be read at \"-4 s\""),
        ("mpu6050/250", AngularRate, "the unit is missing"),
        ("mpu6050/250 g", AngularRate, "the unit of an acceleration"),
    ] {
        let error = unit_factor(unit, quantity).unwrap_err().to_string();
        assert!(error.contains(message), "{unit}: {error}");
    }
    // Is 131 the number or part of the unit?
    for text in ["131 LSB/(deg/s)", "5 LSB/131 deg/s", "2 mpu6050/250dps"] {
        assert!(parse(text, AngularRate).is_err(), "{text}");
    }
}

/// Names of units and their definition in SI: Le Système international d'unités, 9th edition (BIPM 2019), where nothing
/// else is said.
const DEFINITIONS: [(&str, Quantity, f64); 50] = [
    ("s sec secs second seconds", Time, 1.0),
    ("ms msec", Time, 1e-3),
    ("us \u{b5}s \u{3bc}s usec", Time, 1e-6),
    ("ns nsec", Time, 1e-9),
    ("min minute minutes", Time, 60.0),
    ("h hr hrs hour hours", Time, 60.0 * 60.0),
    ("d day days", Time, 24.0 * 60.0 * 60.0),
    ("Hz hz", Frequency, 1.0),
    ("mHz", Frequency, 1e-3),
    ("kHz khz", Frequency, 1e3),
    ("MHz", Frequency, 1e6),
    ("m metre metres meter meters", Length, 1.0),
    ("mm", Length, 1e-3),
    ("cm", Length, 1e-2),
    ("km", Length, 1e3),
    // The international foot of 1959.
    ("ft feet", Length, 0.3048),
    ("rad radian radians", Angle, 1.0),
    ("mrad", Angle, 1e-3),
    ("urad \u{b5}rad \u{3bc}rad", Angle, 1e-6),
    ("deg degs degree degrees \u{b0} \u{ba}", Angle, PI / 180.0),
    ("mdeg", Angle, 1e-3 * PI / 180.0),
    ("arcmin", Angle, PI / 180.0 / 60.0),
    ("arcsec asec", Angle, PI / 180.0 / 3600.0),
    ("rev turn", Angle, 2.0 * PI),
    ("dps", AngularRate, PI / 180.0),
    ("mdps", AngularRate, 1e-3 * PI / 180.0),
    ("udps \u{b5}dps \u{3bc}dps", AngularRate, 1e-6 * PI / 180.0),
    ("dph", AngularRate, PI / 180.0 / 3600.0),
    ("rpm", AngularRate, 2.0 * PI / 60.0),
    // Standard gravity of the third General Conference on Weights and Measures, 1901.
    ("g", Acceleration, 9.806_65),
    ("mg", Acceleration, 9.806_65e-3),
    ("ug \u{b5}g \u{3bc}g", Acceleration, 9.806_65e-6),
    ("ng", Acceleration, 9.806_65e-9),
    // The gal, a centimetre a second squared.
    ("Gal", Acceleration, 1e-2),
    ("mGal", Acceleration, 1e-5),
    ("uGal \u{b5}Gal \u{3bc}Gal", Acceleration, 1e-8),
    ("mps", Velocity, 1.0),
    ("kmh kph", Velocity, 1000.0 / 3600.0),
    // The statute mile of 5280 international feet.
    ("mph", Velocity, 5280.0 * 0.3048 / 3600.0),
    // The international nautical mile of 1929.
    ("kn kt kts knot knots", Velocity, 1852.0 / 3600.0),
    ("T tesla", MagneticField, 1.0),
    ("mT", MagneticField, 1e-3),
    ("uT \u{b5}T \u{3bc}T", MagneticField, 1e-6),
    ("nT", MagneticField, 1e-9),
    ("G Gs gauss Gauss", MagneticField, 1e-4),
    ("mG mGs mgauss mGauss", MagneticField, 1e-7),
    ("%", Dimensionless, 1e-2),
    ("ppm", Dimensionless, 1e-6),
    // Of these the change with temperature of an angular rate.
    ("K kelvin degC \u{b0}C celsius", RatePerKelvin, 1.0),
    ("mK", RatePerKelvin, 1e-3),
];

#[test]
fn every_name_of_a_unit_is_its_definition() {
    let names = DEFINITIONS.iter().flat_map(|row| row.0.split(' '));
    for name in expression::SYMBOLS.iter().flat_map(|row| row.0) {
        assert!(
            names.clone().any(|known| known == *name),
            "{name}: what is it?"
        );
    }
    for (names, quantity, si) in DEFINITIONS {
        for name in names.split(' ') {
            let factor = match quantity {
                RatePerKelvin => {
                    unit_factor(&std::format!("rad/s/{name}"), quantity).map(|f| 1.0 / f)
                }
                _ => unit_factor(name, quantity),
            };
            let factor = factor.unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(
                (factor - si).abs() <= RELATIVE * si,
                "{name}: {factor} {si}"
            );
        }
    }
}

/// Eight levels of parentheses or roots, and no more: the parser calls itself at each.
#[test]
fn parentheses_and_roots_nest_eight_deep() {
    let inside = |open: &str, depth: usize| {
        let unit = format!("{}m{}", open.repeat(depth), ")".repeat(depth));
        unit_factor(&unit, Length)
    };
    assert_eq!(inside("(", 8), Ok(1.0));
    assert!(inside("(", 9).is_err());
    // The root of m⁸ three times over is m.
    assert_eq!(unit_factor("sqrt(sqrt(sqrt(m^8)))", Length), Ok(1.0));
    assert!(unit_factor(&"√".repeat(1_000_000), Length).is_err());
}

#[test]
fn messages_say_what_was_expected() {
    let message = |text, quantity| parse(text, quantity).unwrap_err().to_string();
    assert_eq!(
        message("3 m/s", AngularRate),
        "that is the unit of a velocity; expected an angular rate such as \"deg/s\" or \"rad/s\""
    );
    assert!(
        message("3 deg/h/sqrt(h)", AngleRandomWalk)
            .starts_with("that is the unit of a rate random walk")
    );
    assert!(message("3 1/s", AngularRate).starts_with("that is the unit of a frequency"));
    assert!(message("3 m^7", Length).starts_with("the unit has a wrong dimension"));
    assert!(message("3 furlong", Length).starts_with("unknown unit \"furlong\""));
    assert!(message("3", Time).starts_with("the unit is missing"));
    assert!(message("s", Time).starts_with("does not start with a finite number"));
    assert!(message("1e999 s", Time).starts_with("does not start with a finite number"));
    assert!(message("1,5 s", Time).starts_with("the unit cannot be read at \",5 s\""));
    assert!(message("3 deg/", AngularRate).starts_with("the unit is incomplete"));
    assert!(message("3 s", Dimensionless).contains("a number without unit"));
}

#[test]
fn hostile_text_is_refused_without_panic() {
    let deep = "(".repeat(10_000);
    let long = "√".repeat(10_000);
    let many = "m*".repeat(10_000);
    let short = "| |√|sqrt|rt|1 |1 ^|1 m^|1 m^(|1 m^(1/0)|1 m^99999999999|1 m^0.3|1 sqrt(sqrt(m))|\u{2212}|1 m)|1 ()|nan m|inf m|+-1 m|1e|1e+|.|1 \0|1 ëëëëëëëëëëëëëëëëëëëëëëëëëë";
    for text in short.split('|').chain([&deep[..], &long, &many]) {
        assert!(parse(text, Length).is_err(), "{text:.20}");
        assert!(unit_factor(text, Length).is_err(), "{text:.20}");
    }
}

proptest::proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "[-+0-9.e ]{0,6}[ a-zA-Z0-9°√/*^().²µ%-]{0,24}") {
        for (quantity, ..) in QUANTITIES {
            if let Ok(value) = parse(&text, quantity) {
                proptest::prop_assert!(value.is_finite());
            }
        }
    }
}

#[test]
fn a_root_of_a_root_and_an_absurd_power_are_refused() {
    // They would cancel: what is refused is the quarter, or the power, on the way.
    for text in [
        "m √(√s) / √(√s)",
        "m √(s^0.5) / √(s^0.5)",
        "m (s^8)^5 / (s^8)^5",
    ] {
        assert!(unit_factor(text, Length).is_err(), "{text}");
    }
    for text in [
        "m √(√(s^2)) / √s",
        "m (s^8)^2 / (s^8)^2",
        "m (s^4)^4 / s^8 / s^8",
    ] {
        let factor = unit_factor(text, Length).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(factor, 1.0, "{text}");
    }
}
