//! What is refused, and what must not be.

use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const RATE: f64 = 100.0;
const DEG: f64 = std::f64::consts::PI / 180.0;

/// Ten minutes of six axes at rest [rad/s, m/s²] with the noise of a cheap sensor, seed 1, to which `add` adds what
/// it likes at a time \[s\].
fn record(add: impl Fn(usize, f64) -> f64) -> Record {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let constants = [0.02, -0.05, 0.01, 0.1, -0.2, -9.7];
    let mut samples = vec![Vec::new(); 6];
    for k in 0..60_000 {
        for (axis, constant) in constants.iter().enumerate() {
            let sigma = if axis < 3 { 0.15 * DEG } else { 0.04 };
            let noise: f64 = StandardNormal.sample(&mut random);
            samples[axis].push(constant + sigma * noise + add(axis, f64::from(k) / RATE));
        }
    }
    Record {
        axes: undrift_noise::model_file::AXES.to_vec(),
        samples,
        units: Some(("rad/s".into(), "m/s^2".into())),
        ..Record::default()
    }
}

/// The record in another unit than it says.
fn called(units: (&str, &str), factors: (f64, f64)) -> Record {
    let mut record = record(|_, _| 0.0);
    for (axis, samples) in record.samples.iter_mut().enumerate() {
        let factor = if axis < 3 { factors.0 } else { factors.1 };
        samples.iter_mut().for_each(|x| *x *= factor);
    }
    record.units = Some((units.0.into(), units.1.into()));
    record
}

fn problem(record: &Record) -> String {
    not_static(record, RATE).map_or(String::new(), |problem| problem.to_string())
}

#[test]
fn what_happens_to_a_sensor_at_rest_is_no_motion() {
    let quantised = |step: [f64; 2]| {
        let mut record = record(|_, _| 0.0);
        for (axis, samples) in record.samples.iter_mut().enumerate() {
            let step = step[usize::from(axis > 2)];
            samples
                .iter_mut()
                .for_each(|x| *x = (*x / step).round() * step);
        }
        record
    };
    let cases: [(&str, Record); 8] = [
        ("nothing", record(|_, _| 0.0)),
        // 1 deg/s and 50 mg while it warms up, 3 min.
        (
            "warming up",
            record(|axis, t| (if axis < 3 { DEG } else { 0.5 }) * (-t / 180.0).exp()),
        ),
        (
            "an outlier",
            record(|axis, t| {
                if t == 100.0 {
                    [5.0, 80.0][axis / 3]
                } else {
                    0.0
                }
            }),
        ),
        (
            "two knocks",
            record(|axis, t| {
                let since = |start: f64| {
                    if t >= start {
                        (-(t - start) / 0.5).exp()
                    } else {
                        0.0
                    }
                };
                [1.0, 10.0][axis / 3] * (since(50.0) + since(400.3)) * (60.0 * t).sin()
            }),
        ),
        (
            "an engine",
            record(|axis, t| [0.02, 0.5][axis / 3] * (24.7 * std::f64::consts::TAU * t).sin()),
        ),
        (
            "an engine that stops",
            record(|axis, t| {
                [0.05, 1.0][axis / 3]
                    * (24.7 * std::f64::consts::TAU * t).sin()
                    * f64::from(u8::from(t < 300.0))
            }),
        ),
        ("coarse steps", quantised([0.5 * DEG, 0.2])),
        ("steps beyond the noise", quantised([2.0 * DEG, 0.5])),
    ];
    for (what, record) in cases {
        assert_eq!(problem(&record), "", "{what}");
    }
    // One axis, three of a kind, too few samples: nothing is asked for that is not there.
    for axes in [0..1, 3..4, 0..3, 5..6] {
        let mut part = record(|_, _| 0.0);
        part.axes = part.axes[axes.clone()].to_vec();
        part.samples = part.samples[axes].to_vec();
        assert_eq!(problem(&part), "");
        part.samples.iter_mut().for_each(|axis| axis.truncate(2));
        assert_eq!(problem(&part), "");
        part.samples.iter_mut().for_each(Vec::clear);
        assert_eq!(problem(&part), "");
    }
}

#[test]
fn a_moving_record_names_its_longest_rest() {
    // A drive: bends and stops from 100 s on, parked again from 400 s to the end.
    let drives = |t: f64| (20.0..60.0).contains(&t) || (100.0..400.0).contains(&t);
    let drive = record(|axis, t| match axis {
        _ if !drives(t) => 0.0,
        2 => 0.3 * (t / 5.0).sin(),
        3 => 1.5 * (t / 7.0).sin(),
        _ => 0.1 * (300.0 * t).sin(),
    });
    let Some(NotStatic::Moving { rest, .. }) = not_static(&drive, RATE) else {
        panic!("not refused");
    };
    let (start, end) = rest.unwrap();
    // A second is a window, and one is cut off.
    assert!(
        (400.0..=403.0).contains(&start) && end == 600.0,
        "{start} {end}"
    );
    // The same of its gyros or its accelerometers alone.
    for axes in [0..3, 3..6] {
        let mut part = drive.clone();
        part.axes = part.axes[axes.clone()].to_vec();
        part.samples = part.samples[axes].to_vec();
        assert!(
            problem(&part).contains("the IMU moves"),
            "{}",
            problem(&part)
        );
    }
    let always = record(|axis, t| {
        if axis == 2 {
            0.3 * (t / 5.0).sin()
        } else {
            0.0
        }
    });
    let found = not_static(&always, RATE);
    assert!(matches!(found, Some(NotStatic::Moving { .. })), "{found:?}");
    let turning = record(|axis, _| if axis == 2 { DEG * 57.0 } else { 0.0 });
    assert!(
        problem(&turning).contains("gyro_z reads 57"),
        "{}",
        problem(&turning)
    );
}

#[test]
fn sensors_that_are_exchanged_are_named() {
    let mut exchanged = record(|_, _| 0.0);
    exchanged.samples.rotate_left(3);
    let Some(NotStatic::Force { likely, .. }) = not_static(&exchanged, RATE) else {
        panic!();
    };
    assert_eq!(likely, Likely::Exchanged);
}

#[test]
fn a_wrong_size_of_gravity_names_the_unit() {
    let g = STANDARD_GRAVITY;
    for (unit, factor, expected) in [
        ("m/s^2", 1.0 / g, Likely::Unit("g")),
        ("m/s^2", 1000.0 / g, Likely::Unit("mg")),
        ("m/s^2", 16384.0 / g, Likely::Unit("LSB/16384 g")),
        ("g", g, Likely::Unit("m/s^2")),
        ("g", 4096.0, Likely::Unit("LSB/4096 g")),
        ("m/s^2", 0.01, Likely::Increments),
        ("m/s^2", 0.003, Likely::GravityRemoved),
        ("m/s^2", 3.0, Likely::Unknown),
    ] {
        // What the record says, and what its numbers are in SI.
        let found = not_static(&called(("rad/s", unit), (1.0, factor)), RATE);
        let Some(NotStatic::Force { likely, .. }) = found else {
            panic!("{unit} {factor}: {found:?}");
        };
        assert_eq!(likely, expected, "{unit} {factor}");
    }
    assert!(problem(&called(("deg/s", "mg"), (1.0, 1.0))).is_empty());
}

#[test]
fn whole_numbers_called_degrees_are_counts() {
    // 131 counts are 1 deg/s, and called a degree a second each.
    let mut counts = record(|_, _| 0.0);
    for samples in &mut counts.samples[..3] {
        samples
            .iter_mut()
            .for_each(|x| *x = (*x / DEG * 131.0).round() * DEG);
    }
    for unit in ["deg/s", "rad/s"] {
        let mut counts = counts.clone();
        if unit == "rad/s" {
            counts.samples[..3]
                .iter_mut()
                .flatten()
                .for_each(|x| *x /= DEG);
        }
        counts.units = Some((unit.into(), "g".into()));
        let said = problem(&counts);
        assert!(
            said.contains("gyro_x has whole numbers alone") && said.contains(unit),
            "{said}"
        );
    }
    // Whole thousandths of a degree a second are a step like another.
    counts.samples[..3]
        .iter_mut()
        .flatten()
        .for_each(|x| *x /= 131.0);
    counts.units = Some(("LSB/131 deg/s".into(), "m/s^2".into()));
    assert_eq!(problem(&counts), "");
}

/// Gravity is the median of samples from the whole record: how it begins does not matter.
#[test]
fn a_first_sample_of_another_size_is_no_wrong_unit() {
    for first in [0.0, f64::NAN, 1e3] {
        let mut record = record(|_, _| 0.0);
        for axis in 3..6 {
            record.samples[axis][0] = first;
        }
        assert_eq!(problem(&record), "", "{first}");
    }
    // A tenth of the samples, wherever they are.
    let part = |from: f64| {
        record(move |axis, time| {
            if axis == 5 && (from..from + 60.0).contains(&time) {
                9.0
            } else {
                0.0
            }
        })
    };
    for from in [0.0, 300.0, 540.0] {
        let force = problem(&part(from));
        assert!(!force.contains("specific force"), "{force}");
    }
}

/// The noise of 0.15 deg/s is 0.15 rad/s where the numbers are called so.
#[test]
fn degrees_called_radians_scatter_more_than_any_sensor() {
    let found = not_static(&called(("rad/s", "m/s^2"), (1.0 / DEG, 1.0)), RATE);
    let Some(NotStatic::Scattering { scatter, .. }) = found else {
        panic!("{found:?}");
    };
    // The quietest of two hundred stretches of fifty.
    assert!((0.08..0.15).contains(&scatter), "{scatter}");
    // What is called deg/s may scatter.
    let mut degrees = called(("deg/s", "m/s^2"), (50.0, 1.0));
    assert!(!problem(&degrees).contains("scatters by"));
    degrees.units = Some(("rad/s".into(), "m/s^2".into()));
    assert!(problem(&degrees).contains("scatters by"));
}
