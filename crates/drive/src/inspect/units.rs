//! Units by the size of the numbers.

use undrift_base::order_statistics::upper_median;
use undrift_nav::{
    earth::STANDARD_GRAVITY,
    units::{Quantity, unit_factor},
};
use undrift_results::inspect::{Known, Part};

/// A unit and why.
pub(super) type Guess = (&'static str, Known);

/// What the accelerometers' numbers are.
pub(super) enum Force {
    /// Specific forces in a unit.
    Rates(Guess),
    /// Velocity increments.
    Increments(Guess),
    /// Neither.
    Unknown(Known),
}

/// Units of specific forces, which gravity shows.
const FORCES: [&str; 5] = ["m/s^2", "g", "mg", "ft/s^2", "ug"];

/// The unit of accelerometer samples by their median magnitude, which gravity makes; `interval` \[s\] is
/// between samples.
pub(super) fn force(samples: &[[f64; 3]], interval: Option<f64>) -> Force {
    let mut sizes: Vec<f64> = samples.iter().map(size).filter(|s| s.is_finite()).collect();
    if sizes.is_empty() {
        return Force::Unknown(Known::NoNumbers);
    }
    let median = upper_median(&mut sizes);
    let near = |value: f64| (0.8..1.25).contains(&(median / value));
    let known = Known::Gravity(median);
    let found = FORCES.into_iter().find(|unit| {
        let factor = unit_factor(unit, Quantity::Acceleration);
        factor.is_ok_and(|factor| near(STANDARD_GRAVITY / factor))
    });
    if let Some(unit) = found {
        return Force::Rates((unit, known));
    }
    match interval {
        Some(interval) if near(STANDARD_GRAVITY * interval) => Force::Increments(("m/s", known)),
        _ => Force::Unknown(Known::NotGravity(median)),
    }
}

/// The units of raw counts of an accelerometer of 16 bits, by its range of ±2, 4, 8 or 16 g.
const COUNTS_OF_G: [(&str, f64); 4] = [
    ("LSB/16384 g", 16384.0),
    ("LSB/8192 g", 8192.0),
    ("LSB/4096 g", 4096.0),
    ("LSB/2048 g", 2048.0),
];
/// The same of a gyro, by its range of ±250, 500, 1000 or 2000 deg/s.
pub(super) const COUNTS_OF_RATE: [&str; 4] = [
    "LSB/131 deg/s",
    "LSB/65.5 deg/s",
    "LSB/32.8 deg/s",
    "LSB/16.4 deg/s",
];

/// The unit of accelerometer samples that are whole numbers, by their median magnitude.
pub(super) fn counts(samples: &[[f64; 3]]) -> Option<Guess> {
    let whole = samples.iter().flatten().all(|x| x.fract() == 0.0);
    let mut sizes: Vec<f64> = samples.iter().map(size).filter(|s| s.is_finite()).collect();
    if !whole || sizes.is_empty() {
        return None;
    }
    let median = upper_median(&mut sizes);
    let near = |(_, gravity): &&(&str, f64)| (0.8..1.25).contains(&(median / gravity));
    let (unit, _) = COUNTS_OF_G.iter().find(near)?;
    Some((unit, Known::Gravity(median)))
}

fn size(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Samples of a stretch over which the scatter is taken.
const STRETCH: usize = 50;
/// Between the scatter of a MEMS gyro at rest in rad/s and in deg/s: 0.54 deg/s is much for one, and
/// 0.0095 deg/s little.
const BETWEEN: f64 = 0.0095;

/// The unit of gyro samples, rates: by the scatter of the quietest stretch, or by their largest.
pub(crate) fn rate(samples: &[[f64; 3]]) -> Guess {
    let quietest = samples
        .chunks_exact(STRETCH)
        .map(scatter)
        .filter(|s| s.is_finite() && *s > 0.0)
        .fold(f64::INFINITY, f64::min);
    let largest = samples.iter().map(size).fold(0.0, f64::max);
    // Faster than any such sensor measures.
    if largest > 80.0 {
        return ("deg/s", Known::LargestRate(largest));
    }
    if !quietest.is_finite() {
        ("rad/s", Known::TooFew)
    } else if quietest > BETWEEN {
        ("deg/s", Known::LargeScatter(quietest))
    } else {
        ("rad/s", Known::SmallScatter(quietest))
    }
}

/// Root mean square of the differences from one sample to the next over √2: motion that is slow
/// against the sample rate is not in it.
fn scatter(samples: &[[f64; 3]]) -> f64 {
    let mut sum = 0.0;
    for pair in samples.windows(2) {
        for axis in 0..3 {
            sum += (pair[1][axis] - pair[0][axis]).powi(2);
        }
    }
    (sum / (6 * (samples.len() - 1)) as f64).sqrt()
}

/// The unit in which the median strength of three columns is that of the Earth's field, give or take a hard iron, and that strength \[µT\].
pub(super) fn field(rows: &[[f64; 3]]) -> Option<(&'static str, f64)> {
    const UNITS: [&str; 6] = ["uT", "mG", "nT", "G", "mT", "T"];
    let mut strengths: Vec<f64> = rows
        .iter()
        .map(|row| row.iter().map(|x| x * x).sum::<f64>().sqrt())
        .filter(|strength| *strength > 0.0)
        .collect();
    strengths.sort_by(f64::total_cmp);
    let median = strengths.get(strengths.len() / 2)?;
    let known = UNITS.into_iter().filter_map(|unit| {
        let factor = unit_factor(unit, Quantity::MagneticField).ok()?;
        Some((unit, median * factor * 1e6))
    });
    let away = |strength: f64| (strength / EARTHS).ln().abs();
    let nearest = known.min_by(|a, b| away(a.1).total_cmp(&away(b.1)))?;
    (away(nearest.1) < MOST_AWAY).then_some(nearest)
}

/// Usual strength of the Earth's field \[µT\], and the logarithm of the factor that one with hard iron may have.
const EARTHS: f64 = 45.0;
const MOST_AWAY: f64 = 1.25;

/// Gives the fixes the unit that the steps of the samples show of the same column of times: rows that hold a fix are no steps of it.
pub(super) fn share_unit_of_time(parts: &mut [Part]) {
    let [imu, rest @ ..] = parts else { return };
    let line = |part: &Part, key| part.lines.iter().find(|line| line.key == key).cloned();
    let unit = line(imu, "time_unit").filter(|unit| unit.known == Known::StampStep);
    let (Some(time), Some(unit)) = (line(imu, "time"), unit) else {
        return;
    };
    for part in rest.iter_mut().filter(|_| imu.table == "imu") {
        let same = line(part, "time").is_some_and(|of| of.value == time.value);
        if same && line(part, "date").is_none() && line(part, "time_unit").is_none() {
            part.lines.insert(1, unit.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_results::inspect::Line;

    #[test]
    fn gravity_tells_the_unit() {
        let unit = |z: f64, interval: Option<f64>| match force(&[[0.01 * z, 0.0, z]; 9], interval) {
            Force::Rates((unit, _)) => unit,
            Force::Increments((unit, _)) => unit,
            Force::Unknown(_) => "",
        };
        assert_eq!(unit(-9.79, None), "m/s^2");
        assert_eq!(unit(1.01, None), "g");
        assert_eq!(unit(-998.0, Some(0.01)), "mg");
        assert_eq!(unit(31.9, Some(0.01)), "ft/s^2");
        assert_eq!(unit(-978_400.0, Some(0.01)), "ug");
        assert_eq!(unit(-0.0489, Some(0.005)), "m/s");
        assert_eq!(unit(16384.0, Some(0.01)), "");
        assert!(matches!(force(&[], None), Force::Unknown(_)));
    }

    #[test]
    fn whole_numbers_are_counts_of_the_usual_ranges() {
        let unit = |z: f64| counts(&[[3.0, -4.0, z]; 9]).map(|(unit, _)| unit);
        for (range, lsb) in [(2.0, 16384.0), (4.0, 8192.0), (8.0, 4096.0), (16.0, 2048.0)] {
            assert_eq!(32768.0 / range, lsb);
            assert_eq!(
                unit(f64::round(1.02 * lsb)),
                Some(format!("LSB/{lsb} g")).as_deref()
            );
        }
        assert_eq!(unit(1000.5), None);
        assert_eq!(unit(300.0), None);
        assert_eq!(counts(&[]), None);
    }

    #[test]
    fn gravity_is_looked_for_from_four_fifths_to_five_quarters() {
        let is_g = |z: f64| matches!(force(&[[0.0, 0.0, z]], None), Force::Rates(("g", _)));
        assert!(is_g(0.8) && is_g(1.249) && !is_g(0.799) && !is_g(1.25));
        // The magnitude, whatever the axis, and its upper median.
        assert!(is_g(-1.0));
        let two = [[0.6, 0.8, 0.0], [2.0, 0.0, 0.0]];
        assert!(matches!(force(&two, None), Force::Unknown(Known::NotGravity(m)) if m == 2.0));
        let three = [[0.6, 0.8, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.1]];
        assert!(matches!(force(&three, None), Force::Rates(("g", Known::Gravity(m))) if m == 1.0));
    }

    /// An error of ±a about a constant: differences of 2a over √2.
    #[test]
    fn scatter_is_that_of_the_differences() {
        let samples = |a: f64| -> Vec<[f64; 3]> {
            (0..100)
                .map(|k| [3.0 + a * f64::from(k % 2 * 2 - 1); 3])
                .collect()
        };
        let root = 2f64.sqrt();
        for a in [0.001, BETWEEN / root * 0.999] {
            let (unit, Known::SmallScatter(found)) = rate(&samples(a)) else {
                panic!("{a}");
            };
            assert!(unit == "rad/s" && (found / (root * a) - 1.0).abs() < 1e-9);
        }
        for a in [BETWEEN / root * 1.001, 0.2] {
            let (unit, Known::LargeScatter(found)) = rate(&samples(a)) else {
                panic!("{a}");
            };
            assert!(unit == "deg/s" && (found / (root * a) - 1.0).abs() < 1e-9);
        }
        // The quieter half counts; a stretch is fifty samples.
        let mut both = samples(0.2);
        both.extend(samples(0.001));
        assert_eq!(rate(&both).0, "rad/s");
        assert_eq!(rate(&samples(0.2)[..49]).1, Known::TooFew);
        // 80 rad/s is faster than any sensor: beyond it, not at it.
        assert_eq!(rate(&[[80.0, 0.0, 0.0]]).1, Known::TooFew);
        assert_eq!(rate(&[[0.0, 48.0, -64.1]; 2]).0, "deg/s");
    }

    #[test]
    fn the_quietest_stretch_tells_the_unit_of_rates() {
        // A ramp with an alternating error of ±a scatters by √2 a.
        let samples = |a: f64| -> Vec<[f64; 3]> {
            (0..200)
                .map(|k| [1e-4 * f64::from(k) + a * f64::from(k % 2 * 2 - 1); 3])
                .collect()
        };
        assert_eq!(rate(&samples(0.05)).0, "deg/s");
        assert_eq!(rate(&samples(0.0005)).0, "rad/s");
        assert_eq!(rate(&[[120.0, 0.0, 0.0]; 3]).0, "deg/s");
        assert_eq!(rate(&[[0.0; 3]; 100]).1, Known::TooFew);
    }

    /// Rows that hold a fix of a second ago are every 20 ms: as seconds of fixes they would be 20 s apart.
    #[test]
    fn fixes_have_the_unit_of_the_samples_times() {
        let line = |key, value: &str, known| Line::new(key, value, known);
        let part = |table, time: &str| {
            let name = Known::Name { several: false };
            Part::new(
                table,
                vec![
                    line("time", time, name.clone()),
                    line("position", "p", name),
                ],
            )
        };
        let unit_of = |known: Known, time: &str| {
            let mut parts = [part("imu", "T"), part("gnss", time)];
            parts[0].lines.push(line("time_unit", "ms", known));
            share_unit_of_time(&mut parts);
            let mut lines = parts[1].lines.iter();
            lines.any(|line| line.key == "time_unit")
        };
        assert!(unit_of(Known::StampStep, "T"));
        assert!(!unit_of(Known::StampStep, "T2") && !unit_of(Known::Guessed, "T"));
    }
}
