//! Planted effects are found, and nothing where there is nothing.

use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal, Uniform};
use rand_xoshiro::Xoshiro256PlusPlus;

/// What is planted in a fleet of 30 units with ten logs each.
#[derive(Clone, Copy, Default)]
struct Planted {
    /// Factor on the drift of SN0007.
    unit: f64,
    /// Factor of units with an odd number, of another type.
    kind: f64,
    /// Growth by a kelvin.
    slope: f64,
    /// Standard deviation of the logarithm between all units.
    spread: f64,
}

const NOTHING: Planted = Planted {
    unit: 1.0,
    kind: 1.0,
    slope: 0.0,
    spread: 0.15,
};
const UNITS: usize = 30;
const LOGS: usize = 10;
/// Outages of a log.
const OUTAGES: usize = 7;

#[derive(Clone)]
struct Drawn {
    unit: String,
    kind: &'static str,
    temperature: f64,
    values: Vec<(usize, f64)>,
}

/// Drifts as outages make them: the error of each is Rayleigh's, a log has the root mean square of seven, three bias
/// models see mostly the same noise, and routes differ.
fn fleet(seed: u64, planted: Planted) -> Vec<Drawn> {
    fleet_of(UNITS, LOGS, seed, planted)
}

fn fleet_of(units: usize, of_unit: usize, seed: u64, planted: Planted) -> Vec<Drawn> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let standard = Normal::new(0.0, 1.0).unwrap();
    let temperatures = Uniform::new(-10.0, 60.0).unwrap();
    let mut logs = Vec::new();
    for unit in 1..=units {
        let natural: f64 = planted.spread * standard.sample(&mut rng);
        for _ in 0..of_unit {
            let temperature = temperatures.sample(&mut rng);
            let mut scale = 3.0 * (natural + 0.2 * standard.sample(&mut rng)).exp();
            scale *= (planted.slope * (temperature - 25.0)).exp();
            scale *= if unit == 7 { planted.unit } else { 1.0 };
            scale *= if unit % 2 == 1 { planted.kind } else { 1.0 };
            let mut squares = [0.0; 3];
            for _ in 0..OUTAGES {
                let common: [f64; 2] = [standard.sample(&mut rng), standard.sample(&mut rng)];
                for (square, factor) in squares.iter_mut().zip([1.3, 1.1, 1.0]) {
                    for common in common {
                        let own: f64 = standard.sample(&mut rng);
                        *square += (factor * scale * (common + 0.3 * own)).powi(2);
                    }
                }
            }
            let rms = |square: f64| (square / OUTAGES as f64).sqrt();
            logs.push(Drawn {
                unit: format!("SN{unit:04}"),
                kind: if unit % 2 == 1 { "odd" } else { "even" },
                temperature,
                values: squares.map(rms).into_iter().enumerate().collect(),
            });
        }
    }
    logs
}

fn of(logs: &[Drawn]) -> Effects {
    let sample = |log: &'_ Drawn| -> Sample<'static> {
        Sample {
            values: log.values.clone(),
            unit: Some(String::leak(log.unit.clone())),
            levels: vec![Some(log.kind)],
            temperature_c: Some(log.temperature),
        }
    };
    let samples: Vec<Sample<'_>> = logs.iter().map(sample).collect();
    effects(&samples, 3).unwrap()
}

/// Units, types and slope that are found.
fn found(effects: &Effects) -> (Vec<&str>, bool, bool) {
    let units = effects.units.iter().filter(|(_, effect)| effect.found);
    let kinds = effects.factors[0].values().any(|effect| effect.found);
    let slope = effects.model.temperature.unwrap().found;
    (units.map(|(name, _)| name.as_str()).collect(), kinds, slope)
}

/// The fleet in which thresholds at five robust deviations found neither: a unit with four times the error, and 1 %
/// a kelvin.
#[test]
fn a_unit_of_four_times_and_a_percent_a_kelvin() {
    let planted = Planted {
        unit: 4.0,
        slope: 0.01,
        ..NOTHING
    };
    let effects = of(&fleet(1, planted));
    assert_eq!(found(&effects), (vec!["SN0007"], false, true));
    let unit = &effects.units["SN0007"];
    assert!(
        unit.low.0 < 4.0 && 4.0 < unit.high.0 && unit.low.0 > 2.0,
        "{unit:?}"
    );
    let slope = effects.model.temperature.unwrap();
    let true_slope = 100.0 * 0.01_f64.exp_m1();
    assert!(
        slope.low.0 < true_slope && true_slope < slope.high.0,
        "{slope:?}"
    );
    assert!(slope.high.0 - slope.low.0 < 1.0, "{slope:?}");
}

#[test]
fn nothing_is_found_where_there_is_nothing() {
    let effects = of(&fleet(2, NOTHING));
    assert_eq!(found(&effects), (vec![], false, false));
    assert!(effects.logs.is_empty());
}

/// A vehicle of which all units have logs is found beside the type and the unit; a label that says the same as the
/// type is not determined.
#[test]
fn a_vehicle_is_told_from_the_units_and_the_type() {
    let planted = Planted {
        unit: 4.0,
        ..NOTHING
    };
    let mut logs = fleet(6, planted);
    let vehicle = |k: usize| ["van", "car", "truck"][k % 3];
    for (k, log) in logs.iter_mut().enumerate() {
        if vehicle(k) == "truck" {
            log.values.iter_mut().for_each(|(_, value)| *value *= 1.5);
        }
    }
    let samples = logs.iter().enumerate().map(|(k, log)| Sample {
        values: log.values.clone(),
        unit: Some(&log.unit),
        levels: vec![
            Some(log.kind),
            (k % 7 > 0).then(|| vehicle(k)),
            Some(if log.kind == "odd" { "v1" } else { "v2" }),
        ],
        temperature_c: (k % 7 > 0).then_some(log.temperature),
    });
    let effects = effects(&samples.collect::<Vec<_>>(), 3).unwrap();
    assert_eq!(found(&effects), (vec!["SN0007"], false, false));
    let [_, vehicles, aliased] = effects.factors.as_slice() else {
        panic!("{:?}", effects.factors);
    };
    assert!(aliased.is_empty(), "{aliased:?}");
    assert_eq!(vehicles.len(), 3);
    let truck = vehicles["truck"];
    assert!(truck.found && truck.low.0 < 1.5 && 1.5 < truck.high.0);
    // By eight logs of ten in each unit: the interval is that of the scatter within units.
    assert!(truck.high.0 / truck.low.0 < 1.3, "{truck:?}");
}

/// Three units hide each other from a test that leaves out one at a time.
#[test]
fn several_units_do_not_hide_each_other() {
    let mut logs = fleet(3, NOTHING);
    for log in &mut logs {
        if ["SN0003", "SN0004", "SN0021", "SN0028"].contains(&log.unit.as_str()) {
            log.values.iter_mut().for_each(|(_, value)| *value *= 3.5);
        }
    }
    let effects = of(&logs);
    assert_eq!(found(&effects).0, ["SN0003", "SN0004", "SN0021", "SN0028"]);
}

#[test]
fn a_log_that_does_not_belong_is_found_in_its_unit() {
    let mut logs = fleet(4, NOTHING);
    logs[123]
        .values
        .iter_mut()
        .for_each(|(_, value)| *value *= 12.0);
    let effects = of(&logs);
    assert_eq!(effects.logs.len(), 1);
    assert_eq!(effects.logs[0].0, 123);
    let effect = effects.logs[0].1;
    assert!(effect.low.0 < 12.0 && 12.0 < effect.high.0, "{effect:?}");
    assert_eq!(found(&effects).0, Vec::<&str>::new());
}

/// Temperatures and units that are not known, a part that some logs lack, values that are none.
#[test]
fn gaps_are_left_out() {
    let mut logs = fleet(
        5,
        Planted {
            unit: 4.0,
            ..NOTHING
        },
    );
    for (k, log) in logs.iter_mut().enumerate() {
        if k % 7 == 0 {
            log.temperature = f64::NAN;
        }
        if k % 5 == 0 {
            log.values.pop();
        }
        if k % 11 == 0 {
            log.values[0].1 = [0.0, f64::INFINITY, -1.0][k % 3];
        }
    }
    assert_eq!(found(&of(&logs)).0, ["SN0007"]);
    // No unit, one type, no temperature: there is nothing to ask, and a level all the same.
    let samples = logs.iter().map(|log| Sample {
        values: log.values.clone(),
        levels: vec![Some("one")],
        ..Sample::default()
    });
    let effects = effects(&samples.collect::<Vec<_>>(), 3).unwrap();
    assert!(effects.units.is_empty() && effects.factors[0].is_empty());
    assert_eq!(effects.model.temperature, None);
    assert!(effects.levels.iter().all(Option::is_some));
    assert!(super::effects(&[], 3).is_none());
}

#[test]
fn one_family_is_adjusted_as_holm() {
    let some = |p: &[f64]| p.iter().copied().map(Some).collect::<Vec<_>>();
    // From statsmodels.stats.multitest.multipletests(…, method="holm"), 0.15.0.
    assert_eq!(holm(&some(&[0.01, 0.04, 0.03])), some(&[0.03, 0.06, 0.06]));
    let family = of_one_family(vec![some(&[0.01, 0.6]), some(&[0.001]), Vec::new()]);
    assert_eq!(family, [some(&[0.01, 0.6]), some(&[0.002]), Vec::new()]);
}

/// Counts over fleets of 300 logs: the table of docs/fleet.md. Each effect is to be found in 18 of 20, and nothing
/// else in 19 of 20. Seeds up to 200 served for building.
#[test]
#[ignore = "slow: 1100 fleets"]
fn planted_effects_are_found_in_18_of_20() {
    let all = Planted {
        unit: 4.0,
        kind: 1.5,
        slope: 0.01,
        ..NOTHING
    };
    let cases = [
        (
            "a unit of 4 times",
            Planted {
                unit: 4.0,
                ..NOTHING
            },
            [1, 0, 0],
        ),
        (
            "a type of 1.5 times",
            Planted {
                kind: 1.5,
                ..NOTHING
            },
            [0, 1, 0],
        ),
        (
            "1 %/K",
            Planted {
                slope: 0.01,
                ..NOTHING
            },
            [0, 0, 1],
        ),
        ("all three", all, [1, 1, 1]),
        ("nothing", NOTHING, [0, 0, 0]),
        (
            "nothing, equal units",
            Planted {
                spread: 0.0,
                ..NOTHING
            },
            [0, 0, 0],
        ),
    ];
    let mut missed = Vec::new();
    for (name, planted, expected) in cases {
        let few = counted(planted, expected, 201..221);
        println!(
            "| {name} | {} | {} | {} | {} | {} |",
            few[0], few[1], few[2], few[3], few[4]
        );
        let found = few.iter().zip(expected);
        let all = found
            .into_iter()
            .all(|(n, expected)| expected == 0 || *n >= 18);
        if !all || few[3] > 1 {
            missed.push((name, few));
        }
    }
    // The share of fleets in which anything is found is held: 1 % of 500 and three standard deviations.
    for spread in [0.15, 0.0] {
        let many = counted(Planted { spread, ..NOTHING }, [0, 0, 0], 1001..1501);
        println!("spread {spread}: of 500 fleets, found {many:?}");
        if many[3] > 11 {
            missed.push(("500", many));
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// Fleets in which the unit, the type and the slope are found, anything that is not there, and any single log.
fn counted(planted: Planted, expected: [usize; 3], seeds: std::ops::Range<u64>) -> [usize; 5] {
    let mut counts = [0; 5];
    for seed in seeds {
        let effects = of(&fleet(seed, planted));
        let (units, kind, slope) = found(&effects);
        let found = [units.contains(&"SN0007"), kind, slope];
        for (count, found) in counts.iter_mut().zip(found) {
            *count += usize::from(found);
        }
        let other = units.iter().any(|unit| *unit != "SN0007");
        let wrong = found.iter().zip(expected).any(|(f, e)| *f && e == 0);
        counts[3] += usize::from(other || wrong);
        counts[4] += usize::from(!effects.logs.is_empty());
    }
    counts
}

/// 100 000 logs with a type of four, a vehicle of three and a firmware of five, with and without gaps: what was planted
/// is found among so many, and no factor.
#[test]
#[ignore = "slow: prints times"]
fn a_hundred_thousand_logs() {
    let planted = Planted {
        unit: 4.0,
        slope: 0.01,
        ..NOTHING
    };
    for (name, units, of_unit, gaps) in [
        ("complete", 2000, 50, false),
        ("with gaps", 2000, 50, true),
        ("many units", 20_000, 5, true),
        ("few units", 30, 3334, true),
        ("no unit twice", 100_000, 1, true),
    ] {
        let mut logs = fleet_of(units, of_unit, 7, planted);
        if gaps {
            for (k, log) in logs.iter_mut().enumerate() {
                log.values
                    .truncate(3 - usize::from(k % 5 == 0) - usize::from(k % 35 == 0));
            }
        }
        // One log in 20 000 does not belong.
        let strange: Vec<usize> = (11..logs.len()).step_by(20_000).collect();
        for at in &strange {
            let values = logs[*at].values.iter_mut();
            values.for_each(|(_, value)| *value *= 12.0);
        }
        let number = |k: usize| String::leak(k.to_string());
        let levels = |k: usize| [k / of_unit % 4, k % 3, k / 7 % 5].map(|n| Some(&*number(n)));
        let samples = logs.iter().enumerate().map(|(k, log)| Sample {
            values: log.values.clone(),
            unit: Some(&log.unit),
            levels: levels(k).to_vec(),
            temperature_c: Some(log.temperature),
        });
        let samples: Vec<Sample<'_>> = samples.collect();
        let start = std::time::Instant::now();
        let effects = effects(&samples, 3).unwrap();
        let elapsed = start.elapsed().as_secs_f64();
        println!("{name}: {} logs, {units} units: {elapsed:.2} s", logs.len());
        let units = effects.units.iter().filter(|(_, effect)| effect.found);
        let units: Vec<&str> = units.map(|(name, _)| name.as_str()).collect();
        let mut logs: Vec<usize> = effects.logs.iter().map(|(at, _)| *at).collect();
        logs.sort_unstable();
        let factors = effects.factors.iter().flatten();
        let factors = factors.filter(|(_, effect)| effect.found).count();
        let slope = effects.model.temperature.unwrap();
        let true_slope = 100.0 * 0.01_f64.exp_m1();
        assert!(
            slope.found && slope.low.0 < true_slope && true_slope < slope.high.0,
            "{name}: {slope:?}"
        );
        // A unit with a single log cannot be known from it: there it is the unit that does not belong.
        let (mut expected, mut expected_logs) = (vec!["SN0007".to_owned()], strange);
        if of_unit == 1 {
            let strange = expected_logs.drain(..);
            expected.extend(strange.map(|at| format!("SN{:04}", at + 1)));
        }
        assert_eq!(units, expected, "{name}");
        assert_eq!((logs, factors), (expected_logs, 0), "{name}");
    }
}
