//! The sensors' noise, as all kinds of alignment start from it.
//!
//! Gyros and accelerometers of an alignment are as good as their models say: what a mean of white noise
//! scatters by, what a bias has gathered since a rest, and how large it may be before anything is known of it.
//!
//! "Axes" are shaping filters: r the variance of a sample's white noise \[unit²\], q of the drive
//! of the states, p0 the covariance before the first sample, h the output row. Three gyros or three
//! accelerometers are given as a slice.

#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    covariance::AXES,
    parameters::{Parameter, Parameters, Prior},
    shaping::ShapingFilter,
};

/// Constant error of an accelerometer that any model is taken to allow for \[m/s²\].
const CONSTANT: f64 = 0.02;
/// Standard deviations that the specific force at rest differs from gravity by where its model does not explain it.
const UNEXPLAINED: f64 = 3.0;
/// A state that lasts for less than this cannot hold a constant \[s\].
const LASTS: f64 = 60.0;

/// Variance of the mean of white noise over `duration` \[s\], the largest of the axes.
/// `r T` is the squared density N² \[unit²·s\], so it is N² over the duration.
///
/// \[unit²\]; the duration is in seconds and above 0.
pub(super) fn noise_of_mean(axes: &[ShapingFilter], duration: f64) -> f64 {
    axes.iter().map(|a| a.r * a.interval).fold(0.0, f64::max) / duration
}

/// Variance that the biases gather in `duration` \[s\] at most, the largest of the axes.
/// The variance of the driving noise `H q Hᵀ` of a step over its interval, times the duration: as if nothing
/// were forgotten.
pub(super) fn walk(axes: &[ShapingFilter], duration: f64) -> f64 {
    let step = |a: &ShapingFilter| {
        let mut q = 0.0;
        for i in 0..a.order {
            for j in 0..a.order {
                q += a.h[i] * a.q[i][j] * a.h[j];
            }
        }
        q / a.interval
    };
    axes.iter().map(step).fold(0.0, f64::max) * duration.max(0.0)
}

/// Variances of the biases before the first sample \[unit²\], no less than a floor \[unit\].
///
/// H P₀ Hᵀ, the turn-on constant and a stationary process among it.
pub(super) fn bias_variances(axes: &[ShapingFilter], floor: f64) -> Vector3 {
    Vector3::from_fn(|axis, _| {
        let filter = &axes[axis];
        let mut variance = floor * floor;
        for i in 0..filter.order {
            for j in 0..filter.order {
                variance += filter.h[i] * filter.p0[i][j] * filter.h[j];
            }
        }
        variance
    })
}

/// Excess of the mean specific force of a rest of `duration` \[s\] over gravity \[m/s²\], where that is more than the
/// accelerometers' model has.
///
/// \[m/s²\], with its sign; the limit is three standard deviations of constants (at least 0.02
/// m/s²) and white noise.
pub(super) fn force_excess(
    accel: &[ShapingFilter],
    force: &Vector3,
    gravity: f64,
    duration: f64,
) -> Option<f64> {
    let variance = bias_variances(accel, CONSTANT).max() + noise_of_mean(accel, duration);
    let excess = force.norm() - gravity;
    (excess.abs() > UNEXPLAINED * variance.sqrt()).then_some(excess)
}

/// The sensors with accelerometers whose constant errors have this standard deviation beside their own \[m/s²\]: what rest shows of
/// one axis, along gravity, is taken to be as likely of the others. Of models without a state that lasts nothing changes.
pub(super) fn with_constants(sensors: &[ShapingFilter; AXES], std: f64) -> [ShapingFilter; AXES] {
    let mut sensors = *sensors;
    for axis in &mut sensors[3..] {
        let lasts = |i: &usize| {
            let slow = (1.0 - axis.f[*i][*i]) * LASTS < axis.interval;
            slow && axis.h[*i] != 0.0
        };
        let slowest = (0..axis.order)
            .filter(lasts)
            .max_by(|i, j| axis.f[*i][*i].total_cmp(&axis.f[*j][*j]));
        if let Some(i) = slowest {
            axis.p0[i][i] += (std / axis.h[i]).powi(2);
        }
    }
    sensors
}

/// Beside scale factors of the gyros those of the accelerometers, too, with this standard deviation: an accelerometer that reads
/// gravity wrong may as well have a wrong scale. Where no scale factors are wanted it is as before.
pub(super) fn with_accel_scale(parameters: Parameters, std: f64) -> Parameters {
    let wanted = parameters.prior(Parameter::GyroScale).is_some();
    match parameters.prior(Parameter::AccelScale) {
        None if wanted => parameters.with(Parameter::AccelScale, Prior::constant(std.abs())),
        _ => parameters,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.01;

    #[test]
    fn force_at_rest_shows_constant_errors_beyond_the_model() {
        let small = [ShapingFilter::gauss_markov(1e-3, 3600.0, DT).unwrap(); 3];
        let large = [ShapingFilter::gauss_markov(0.1, 3600.0, DT).unwrap(); 3];
        let force = |size: f64| Vector3::new(0.0, 0.1, -1.0).normalize() * size;
        let excess = |axes: &[ShapingFilter], size| force_excess(axes, &force(size), 9.8, 30.0);
        for size in [10.0, 9.6] {
            assert!((excess(&small, size).unwrap() - (size - 9.8)).abs() < 1e-12);
            assert_eq!(excess(&large, size), None);
        }
        // Three times two hundredths.
        assert_eq!(excess(&small, 9.8 + 0.059), None);
        assert!(excess(&small, 9.8 + 0.061).is_some());
    }

    #[test]
    fn scale_factors_of_the_accelerometers_come_beside_those_of_the_gyros() {
        let gyros = Parameters::none().with(Parameter::GyroScale, Prior::constant(0.01));
        let both = with_accel_scale(gyros, -0.02);
        let found = both.prior(Parameter::AccelScale);
        assert_eq!(found, Some(Prior::constant(0.02)));
        assert_eq!(with_accel_scale(both, 0.5), both);
        assert_eq!(
            with_accel_scale(Parameters::none(), 0.02),
            Parameters::none()
        );
    }

    #[test]
    fn constants_go_to_the_state_that_lasts() {
        let slow = ShapingFilter::gauss_markov(1e-3, 3600.0, DT).unwrap();
        let white = ShapingFilter::white(1e-3, DT).unwrap();
        let fast = ShapingFilter::arma(&[0.9], &[], 1e-3, DT).unwrap();
        let sensors = [slow, slow, slow, slow, white, fast];
        let wide = with_constants(&sensors, -0.2);
        assert_eq!(wide[..3], sensors[..3]);
        assert_eq!(wide[4..], sensors[4..]);
        let mut expected = bias_variances(&sensors[3..], 0.0);
        expected.x += 0.04;
        assert!((bias_variances(&wide[3..], 0.0) - expected).norm() < 1e-12);
    }
}
