//! What is said of a recording before it is identified.

use undrift_results::recording::{Likely, NotStatic, Repeated, Slower, Uneven};

/// What nobody stated and no name says of a record, as the options that would state it.
pub fn guessed(guessed: &[(&str, String)]) -> Option<String> {
    let options = guessed.iter();
    let options = options.map(|(option, value)| format!(" {option} \"{value}\""));
    let options: String = options.collect();
    (!options.is_empty()).then(|| format!("guessed from the values:{options}"))
}

/// That a sensor of a record has fewer samples than the other, or none.
pub fn slower(slower: Option<Slower>) -> Option<String> {
    let Slower { gyro, rate_hz } = slower?;
    let sensor = if gyro { "gyroscopes" } else { "accelerometers" };
    Some(match rate_hz > 0.0 {
        true => format!(
            "{sensor} have values at {rate_hz:.1} Hz alone, and are identified at that rate"
        ),
        false => format!("no {sensor}: identified without them"),
    })
}

/// That a logger repeated samples, which were taken out.
pub fn repeated(repeated: &[Repeated]) -> Option<String> {
    let sensors = repeated.iter().map(|Repeated { gyro, times }| {
        let sensor = if *gyro { "gyroscope" } else { "accelerometer" };
        format!("each {sensor} sample is logged {times:.1} times")
    });
    let sensors = Vec::from_iter(sensors).join(", ");
    (!sensors.is_empty()).then(|| {
        format!("{sensors}: repeated samples were taken out, and the rate is the sensor's own")
    })
}

/// What the time stamps say of a recording that is ready to be identified: lost samples, or an uneven rate.
pub fn stamps(uneven: Option<Uneven>) -> Option<String> {
    let Uneven {
        timing,
        filled,
        finding,
    } = uneven?;
    Some(match filled {
        true => {
            let missing: usize = timing.gaps.iter().map(|gap| gap.missing).sum();
            let gaps = match timing.gaps.len() {
                1 => "1 gap".to_owned(),
                n => format!("{n} gaps"),
            };
            format!(
                "the time stamps have {gaps}: {missing} lost samples, which the models account for"
            )
        }
        false => super::say(&finding),
    })
}

/// Why a record that is no static recording is refused, and what to do.
pub fn refused(guessed: &[(&str, String)], problem: &NotStatic) -> String {
    match guessed.iter().any(|(option, _)| *option == "--columns") {
        true => "the column names do not show which are gyros and accelerometers; specify them with --columns and --units".into(),
        false => format!("{problem}; {}, or use --force to identify it anyway", mend(problem)),
    }
}

fn mend(problem: &NotStatic) -> String {
    match problem {
        NotStatic::Force {
            likely, gyro_unit, ..
        } => force(*likely, gyro_unit),
        NotStatic::Counts { accel_unit, .. } => {
            let accel = stated(accel_unit, "LSB/16384 g");
            format!(
                "give the sensitivity of the data sheet, for instance --units \"LSB/131 deg/s,{accel}\" (gyro_unit of a drive file)"
            )
        }
        NotStatic::Scattering { accel_unit, .. } => {
            let accel = stated(accel_unit, "m/s^2");
            format!(
                "the numbers look like deg/s: --units \"deg/s,{accel}\" (gyro_unit = \"deg/s\" in a drive file)"
            )
        }
        NotStatic::Turning { .. } => {
            "it turns, or the unit of the gyros is wrong (--units, gyro_unit of a drive file)"
                .into()
        }
        NotStatic::Moving {
            rest: Some((start, end)),
            ..
        } => format!("use its longest rest, --span {start},{end}"),
        NotStatic::Moving { rest: None, .. } => {
            "it has no rest that is long enough: record it lying still".into()
        }
    }
}

/// A unit as stated, or this one where none is.
fn stated<'a>(unit: &'a str, otherwise: &'a str) -> &'a str {
    if unit.is_empty() { otherwise } else { unit }
}

fn force(likely: Likely, gyro: &str) -> String {
    match likely {
        Likely::Unit(unit) if gyro.is_empty() => format!("the unit is likely {unit}"),
        Likely::Unit(unit) => format!(
            "the unit is likely {unit}: --units \"{gyro},{unit}\" (accel_unit = \"{unit}\" in a drive file)"
        ),
        Likely::GravityRemoved => {
            "gravity was removed from the samples: record the accelerometers' own output".into()
        }
        Likely::Exchanged => {
            "the gyros measure gravity in their place: exchange them, --columns with the accelerometers' three columns first".into()
        }
        Likely::Increments => "the columns are velocity increments: describe them in a drive file, with data = \"increments\" \
             in [imu], and use that instead"
            .into(),
        Likely::Unknown => {
            "correct the unit (--units) or the order of the columns (--columns)".into()
        }
    }
}
