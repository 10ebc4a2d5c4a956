//! The bias instability of a data sheet: the floor of the Allan deviation.

use crate::numbers::short;
use undrift_results::Axis;

/// Flat of the Allan deviation of flicker noise of B = 1: √(2 ln 2/π).
pub(crate) const FLAT: f64 = 0.664;
/// Upper end of the 68 % interval of a deviation over it, beyond which it says nothing of a floor.
const KNOWN: f64 = 1.5;

/// The bias instability B, the least Allan deviation over 0.664, times a factor; "<" before it where the deviation still falls there.
pub(crate) fn floor(axis: &Axis, factor: f64) -> String {
    let of = &axis.allan;
    let points = of.adev.iter().map(|deviation| deviation.0);
    let upper = of.upper.iter().map(|upper| upper.0);
    let upper = upper.chain(std::iter::repeat(f64::NAN));
    let known = points.zip(upper).take_while(|(deviation, upper)| {
        let is_poor = *upper > KNOWN * deviation;
        !is_poor
    });
    let known: Vec<f64> = known.map(|(deviation, _)| deviation).collect();
    let least = known.iter().copied().filter(|deviation| *deviation > 0.0);
    let Some(least) = least.min_by(f64::total_cmp) else {
        return "–".to_owned();
    };
    let still_falls = known.last() == Some(&least);
    let sign = if still_falls { "<" } else { "" };
    format!("{sign}{}", short(least / FLAT * factor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::numbers;

    fn of(adev: &[f64], upper: &[f64]) -> String {
        let mut axis = Axis::default();
        axis.allan.adev = numbers(adev);
        axis.allan.upper = numbers(upper);
        floor(&axis, 10.0)
    }

    #[test]
    fn the_bias_instability_is_the_least_deviation_over_0_664() {
        assert_eq!(of(&[], &[]), "–");
        let adev = [2.0, 1.0, 0.664, 0.9];
        assert_eq!(of(&adev, &[2.1, 1.1, 0.7, 1.1]), "10.0");
        assert_eq!(of(&adev, &[]), "10.0");
        // It still falls, or nobody knows.
        assert_eq!(of(&adev[..3], &[2.1, 1.1, 0.7]), "<10.0");
        assert_eq!(of(&adev, &[2.1, 1.1, 0.7, 1.4]), "<10.0");
        assert_eq!(of(&adev, &[2.1, 1.1, 1.4, 1.8]), "<15.1");
    }
}
