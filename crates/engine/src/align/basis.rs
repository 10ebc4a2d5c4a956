//! The sensors' noise, as all kinds of alignment start from it.

use undrift_nav::{Vector3, shaping::ShapingFilter};

/// Variance of the mean of white noise over `duration` \[s\], the largest of the axes.
pub(super) fn noise_of_mean(axes: &[ShapingFilter], duration: f64) -> f64 {
    axes.iter().map(|a| a.r * a.interval).fold(0.0, f64::max) / duration
}

/// Variance that the biases gather in `duration` \[s\] at most, the largest of the axes.
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

/// Variances of the biases before the first sample \[unit²\], no less than a floor [unit].
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
