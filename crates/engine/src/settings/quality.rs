//! Standard deviations by the kind of GNSS solution.

use undrift_nav::sample::{FixQuality, GnssFix};

/// Typical horizontal standard deviations of fixed, float, differential and single solutions under an open sky \[m\]
/// (Teunissen & Montenbruck 2017, chapters 21 and 26).
const TYPICAL: [f64; 4] = [0.0, 0.3, 0.7, 2.5];
/// Vertical ones are this many times as large.
const VERTICAL: f64 = 1.5;

/// Rule for the standard deviation of a position by the kind of solution. Velocities are left as they are, and so are fixes
/// of unknown kind.
///
/// ```
/// use undrift_engine::settings::quality::QualityStd;
/// use undrift_nav::{earth::Geodetic, sample::{FixQuality, GnssFix}};
/// let fix = GnssFix::at(0.0, Geodetic::from_degrees(45.0, 7.0, 300.0), [0.02, 0.02, 0.04]);
/// let single = GnssFix { quality: FixQuality::Single, ..fix };
/// let north = |fix: GnssFix| fix.position.map_or(f64::NAN, |(_, covariance)| covariance[(0, 0)].sqrt());
/// assert_eq!(north(QualityStd::Typical.apply(&single)), 2.5); // [m]
/// assert_eq!(north(QualityStd::Typical.apply(&fix)), 0.02);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum QualityStd {
    /// The fixes' own, whatever the kind.
    #[default]
    AsStated,
    /// At least what is typical of the kind under an open sky, horizontally 0.3 m of float, 0.7 m of differential, 2.5 m of
    /// single solutions, vertically 1.5 times that; fixed ones as stated. For one standard deviation stated for a whole log.
    Typical,
    /// The stated ones times the kind's factor [–]: fixed, float, differential, single.
    Factors([f64; 4]),
}

impl QualityStd {
    /// `fix` with the standard deviations of its kind.
    pub fn apply(&self, fix: &GnssFix) -> GnssFix {
        let mut fix = *fix;
        let kind = match fix.quality {
            FixQuality::Unknown => return fix,
            FixQuality::Fixed => 0,
            FixQuality::Float => 1,
            FixQuality::Differential => 2,
            FixQuality::Single => 3,
        };
        if let Some((_, covariance)) = &mut fix.position {
            match self {
                Self::AsStated => {}
                Self::Factors(factors) => *covariance *= factors[kind] * factors[kind],
                Self::Typical => {
                    let std = TYPICAL[kind];
                    for (i, std) in [std, std, VERTICAL * std].into_iter().enumerate() {
                        covariance[(i, i)] = covariance[(i, i)].max(std * std);
                    }
                }
            }
        }
        fix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::{Matrix3, earth::Geodetic, sample::Position};

    #[test]
    fn by_kind() {
        let place = Position::Geodetic(Geodetic::from_degrees(40.0, -105.0, 1600.0));
        let std = |rule: QualityStd, quality, stated: f64| {
            let fix = GnssFix {
                attitude: None,
                mean_velocity: None,
                time: 0.0,
                position: Some((place, Matrix3::identity() * (stated * stated))),
                velocity: None,
                quality,
            };
            rule.apply(&fix).position.unwrap().1[(0, 0)].sqrt()
        };
        use FixQuality::{Fixed, Float, Single, Unknown};
        assert_eq!(std(QualityStd::Typical, Fixed, 0.02), 0.02);
        assert_eq!(std(QualityStd::Typical, Float, 0.02), 0.3);
        assert_eq!(std(QualityStd::Typical, Single, 5.0), 5.0);
        assert_eq!(std(QualityStd::Typical, Unknown, 0.02), 0.02);
        let factors = QualityStd::Factors([1.0, 10.0, 30.0, 100.0]);
        assert!((std(factors, Single, 0.02) - 2.0).abs() < 1e-12);
        assert_eq!(std(QualityStd::AsStated, Single, 0.02), 0.02);
    }
}
