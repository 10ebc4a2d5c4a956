//! What the axes of the IMU show without any model, as findings.

use undrift_io::{axis_faults::AxisFaults, held::Held};
use undrift_nav::Matrix3;
use undrift_results::findings::{Finding, WrappedAxis};

/// Share of the vertical in the axis of the gyro that is nearest to it.
const VERTICAL: f64 = 0.7;

/// What the axes of the IMU show without any model, where `rotation` is from the sensor's axes to the body's.
pub fn of_axes(faults: &AxisFaults, rotation: &Matrix3) -> Vec<Finding> {
    let copied = faults
        .copied
        .iter()
        .map(|axes| Finding::Copied { axes: *axes });
    let wrapped = faults.wrapped.iter().map(|of| {
        Finding::Wrapped(WrappedAxis {
            axis: of.axis,
            limit: of.limit,
            start: of.start,
            jumps: of.jumps,
        })
    });
    let held = of_held(&faults.held, rotation);
    copied.chain(wrapped).chain(held).collect()
}

/// Axes of the IMU that held a value, where `rotation` is from the sensor's axes to the body's; a frozen log is one finding.
fn of_held(held: &[Held], rotation: &Matrix3) -> Vec<Finding> {
    match held {
        [first, _, _, _, _, _]
            if held
                .iter()
                .all(|of| of.start == first.start && !of.saturated) =>
        {
            vec![Finding::Frozen {
                start: first.start,
                length: first.length,
                samples: first.samples,
            }]
        }
        _ => held
            .iter()
            .map(|of| match of.constant {
                true => Finding::Constant {
                    axis: of.axis,
                    value: of.value,
                    samples: of.samples,
                    vertical: of.axis < 3 && rotation[(2, of.axis)].abs() > VERTICAL,
                },
                false => Finding::Held {
                    axis: of.axis,
                    value: of.value,
                    start: of.start,
                    length: of.length,
                    samples: of.samples,
                    saturated: of.saturated,
                },
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_results::findings::Severity;

    #[test]
    fn a_constant_axis_is_not_one_that_held_its_value_for_a_while() {
        let held = |constant| Held {
            axis: 2,
            value: 0.5,
            start: 1.0,
            length: 9.0,
            samples: 900,
            saturated: false,
            constant,
        };
        let constant = |vertical| Finding::Constant {
            axis: 2,
            value: 0.5,
            samples: 900,
            vertical,
        };
        assert_eq!(constant(true).severity(), Severity::Unusable);
        assert_eq!(constant(false).severity(), Severity::Warning);
        let level = Matrix3::identity();
        assert_eq!(of_held(&[held(true)], &level), [constant(true)]);
        let upright = Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0);
        assert_eq!(of_held(&[held(true)], &upright), [constant(false)]);
        assert!(matches!(
            of_held(&[held(false)], &level)[..],
            [Finding::Held { .. }]
        ));
    }
}
