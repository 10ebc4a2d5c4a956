//! How the biases go with temperature.

use super::{Named, units};
use crate::{Table, numbers::short};
use undrift_results::{AxisTemperature, Number};

/// Of all axes whose recording has a temperature that changes.
pub(crate) fn temperatures<'a>(axes: impl Iterator<Item = Named<'a>>) -> Table {
    let each = axes.filter_map(|of| Some((of.label, of.name, of.axis.temperature.as_ref()?)));
    let each: Vec<_> = each.collect();
    Table::from_rows(
        "temperature",
        "Bias over temperature, with 95 % intervals beside correlated noise. What is determined was taken out before the tests and the fits, is in the model file, and is taken out of a drive's samples; the rest is not used.",
        &each,
        &[
            ("axis", &|(label, ..)| label.into()),
            ("slope", &|(_, name, of)| {
                let text = per_kelvin(name, of.slope, of.slope_interval, "K");
                match of.determined {
                    true => text.into(),
                    false => format!("not determined: {text}").into(),
                }
            }),
            ("quadratic", &|(_, name, of)| quadratic(name, of).into()),
            ("about [°C]", &|(_, _, of)| {
                format!("{:.1}", of.reference_c.0).into()
            }),
            ("recorded [°C]", &|(_, _, of)| {
                let [low, high] = of.range_c;
                format!("{:.1} to {:.1}", low.0, high.0).into()
            }),
            ("beside", &|(_, _, of)| (&of.noise).into()),
        ],
    )
}

fn quadratic(name: &str, of: &AxisTemperature) -> String {
    match (of.quadratic, of.quadratic_interval) {
        (Some(value), Some(interval)) => per_kelvin(name, value, interval, "K²"),
        _ => "–".into(),
    }
}

/// A coefficient and its interval by kelvin: °/h of a gyro, mg of an accelerometer.
fn per_kelvin(name: &str, value: Number, [low, high]: [Number; 2], kelvin: &str) -> String {
    let (unit, factor) = units(name).bias;
    let [value, low, high] = [value, low, high].map(|number| short(number.0 * factor));
    format!("{value} {unit}/{kelvin} ({low} to {high})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::identified;
    use undrift_results::{Axis, Identify};

    #[test]
    fn a_slope_has_its_interval_and_one_that_is_not_determined_says_so() {
        let per_hour = |x: f64| Number((x / 3600.0).to_radians());
        let gyro = AxisTemperature {
            determined: true,
            reference_c: Number(30.0),
            range_c: [Number(20.0), Number(40.0)],
            slope: per_hour(12.0),
            slope_interval: [per_hour(11.0), per_hour(13.0)],
            quadratic: None,
            quadratic_interval: None,
            noise: "white + random walk".into(),
            explained: Number(0.5),
        };
        let ug = |x: f64| Number(x * 9.80665e-6);
        let accel = AxisTemperature {
            determined: false,
            slope: ug(20.0),
            slope_interval: [ug(-10.0), ug(50.0)],
            ..gyro.clone()
        };
        let mut result = Identify::default();
        for (name, found) in [("gyro_x", gyro), ("accel_x", accel)] {
            let axis = Axis {
                temperature: Some(found),
                ..Axis::default()
            };
            result.axes.insert(name.into(), axis);
        }
        let table = temperatures(identified("", &result));
        let texts =
            |row: usize| -> Vec<&str> { table.rows[row].iter().map(|cell| &*cell.text).collect() };
        assert_eq!(texts(0)[1], "12.0 °/h/K (11.0 to 13.0)");
        assert_eq!(texts(0)[3..5], ["30.0", "20.0 to 40.0"]);
        assert_eq!(
            texts(1)[1],
            "not determined: 0.0200 mg/K (-0.0100 to 0.0500)"
        );
    }
}
