//! Lines and narrow resonances of the spectrum.

use super::{Named, units};
use crate::{Table, numbers::short};
use std::f64::consts::TAU;

/// Those of all axes, with the error that each makes in the integral.
pub(crate) fn lines<'a>(axes: impl Iterator<Item = Named<'a>>) -> Table {
    let each = axes.flat_map(|of| {
        let label = of.label;
        let lines = of.axis.lines.iter();
        lines.map(move |line| (label.clone(), units(of.name), line))
    });
    let each: Vec<_> = each.collect();
    Table::from_rows(
        "lines",
        "Spectral lines and narrow resonances, taken out before the tests and the fits; a record without any shows one in 1 of 1000 axes. No filter has states for them: each makes an error of the integral that does not grow.",
        &each,
        &[
            ("axis", &|(label, _, _)| label.into()),
            ("frequency [Hz]", &|(_, _, line)| {
                digits(line.frequency_hz, line.frequency_error_hz).into()
            }),
            ("amplitude", &|(_, unit, line)| {
                format!("{} {}", short(line.amplitude * unit.scale), unit.sample).into()
            }),
            ("width [Hz]", &|(_, _, line)| match line.width_hz {
                0.0 => "–".into(),
                width => short(width).into(),
            }),
            ("error of the integral", &|(_, unit, line)| {
                let error = line.amplitude / (TAU * line.frequency_hz);
                format!("{} {}", short(error * unit.scale), unit.drift).into()
            }),
        ],
    )
}

/// A frequency to the digits that its standard error supports, at most six decimals.
fn digits(frequency: f64, error: Option<f64>) -> String {
    let decimals = error.map_or(2.0, |error| -error.log10().floor());
    format!("{frequency:.*}", decimals.clamp(1.0, 6.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::identified;
    use undrift_noise::spectrum::Line;
    use undrift_results::{Axis, Identify};

    #[test]
    fn frequency_amplitude_and_the_error_of_the_integral_are_listed() {
        let line = Line {
            frequency_hz: 7.3,
            amplitude: 0.2f64.to_radians(),
            frequency_error_hz: Some(2e-5),
            ..Line::default()
        };
        let resonance = Line {
            frequency_hz: 30.0,
            width_hz: 0.5,
            frequency_error_hz: None,
            ..line
        };
        let mut result = Identify::default();
        let axis = Axis {
            lines: vec![line, resonance],
            ..Axis::default()
        };
        result.axes.insert("gyro_x".into(), axis);
        let table = lines(identified("", &result));
        let texts =
            |row: usize| -> Vec<&str> { table.rows[row].iter().map(|cell| &*cell.text).collect() };
        // 0.2°/s over 2π 7.3 Hz.
        assert_eq!(
            texts(0),
            ["gyro x", "7.30000", "0.200 °/s", "–", "0.00436 °"]
        );
        assert_eq!(texts(1)[1..4], ["30.00", "0.200 °/s", "0.500"]);
    }
}
