//! Distribution of the Kolmogorov-Smirnov distance: of a known distribution, and of a fitted normal.
//!
//! D is the largest distance between the empirical distribution of n samples and the one they are compared
//! with. Against a distribution known beforehand its law depends on n alone (Kolmogorov 1933); with mean and
//! deviation taken from the same samples D is smaller by about a third, and Lilliefors' law holds (J. American
//! Statistical Association 62, 1967). Both assume independent samples.

/// Samples up to which p of the plain test is exact.
const EXACT: usize = 500;

/// 5 % critical distance of the plain test for n samples, asymptotic: 1.3581 / √n.
/// The source paper compares with it although mean and deviation are fitted.
///
/// ```
/// use undrift_noise::normality::plain_critical_5;
/// assert!((plain_critical_5(100) - 0.1358).abs() < 1e-4);
/// ```
pub fn plain_critical_5(samples: usize) -> f64 {
    1.358_098_638 / (samples.max(1) as f64).sqrt()
}

/// Probability of a larger `distance` of `samples` samples of a known distribution: the plain two-sided test. Exact up to 500 samples
/// (Marsaglia, Tsang & Wang, J. Statistical Software 8(18), 2003) as long as it is above 1e-6; otherwise Kolmogorov's limit at
/// z + 1/(6√n) + (z − 1)/(4n), z = √n D, good to order n^{−3/2} (Vrbik, Pioneer J. Theoretical and
/// Applied Statistics 15, 2018).
///
/// ```
/// use undrift_noise::normality::{lilliefors_p, plain_critical_5, plain_p};
/// assert!((plain_p(plain_critical_5(1000), 1000) - 0.05).abs() < 2e-3);
/// // The same distance is far less likely where mean and deviation are fitted.
/// assert!(lilliefors_p(plain_critical_5(1000), 1000) < 1e-3);
/// ```
pub fn plain_p(distance: f64, samples: usize) -> f64 {
    let squared = distance * distance * samples as f64;
    if samples > 0 && samples <= EXACT && squared < 7.24 {
        return (1.0 - exact_probability(distance, samples)).clamp(0.0, 1.0);
    }
    let (z, count) = (squared.sqrt(), samples.max(1) as f64);
    limit_p(z + 1.0 / (6.0 * count.sqrt()) + (z - 1.0) / (4.0 * count))
}

/// Kolmogorov's limit, P(√n D > z): its two series.
fn limit_p(z: f64) -> f64 {
    if z <= 0.0 {
        return 1.0;
    }
    if z < 1.0 {
        // 1 − √(2π)/z Σ exp(−(2k−1)² π²/8z²)
        let base = -(std::f64::consts::PI.powi(2)) / (8.0 * z * z);
        let sum: f64 = (1..=10)
            .map(|k| (base * f64::from((2 * k - 1) * (2 * k - 1))).exp())
            .sum();
        return 1.0 - (2.0 * std::f64::consts::PI).sqrt() / z * sum;
    }
    // 2 Σ (−1)^{k−1} exp(−2 k² z²)
    (1..=10)
        .map(|k| if k % 2 == 1 { 2.0 } else { -2.0 } * (-2.0 * f64::from(k * k) * z * z).exp())
        .sum()
}

/// P(D_n < distance): the centre element of the n-th power of a matrix of factorials, times n!/nⁿ.
/// Powers are rescaled by 10^±140 as they grow.
///
/// With nD = k − h, 0 ≤ h < 1, the matrix is of order 2k − 1: ones on and below the first superdiagonal, less
/// the powers of h in the first column and last row, each entry over a factorial. Marsaglia, Tsang & Wang 2003,
/// procedure `K`.
fn exact_probability(distance: f64, samples: usize) -> f64 {
    let scaled = distance * samples as f64;
    let k = scaled.floor() as usize + 1;
    let h = k as f64 - scaled;
    let m = 2 * k - 1;
    let mut matrix =
        nalgebra::DMatrix::<f64>::from_fn(m, m, |i, j| f64::from(u8::from(i + 1 >= j)));
    for i in 0..m {
        let power = h.powi(i as i32 + 1);
        matrix[(i, 0)] -= power;
        matrix[(m - 1, m - 1 - i)] -= power;
    }
    if 2.0 * h > 1.0 {
        matrix[(m - 1, 0)] += (2.0 * h - 1.0).powi(m as i32);
    }
    for i in 0..m {
        for j in 0..m {
            for g in 1..=(i + 1).saturating_sub(j) {
                matrix[(i, j)] /= g as f64;
            }
        }
    }
    let centre = k - 1;
    let (mut result, mut exponent) = (nalgebra::DMatrix::<f64>::identity(m, m), 0i32);
    let (mut base, mut base_exponent) = (matrix, 0i32);
    let mut rest = samples;
    while rest > 0 {
        if rest % 2 == 1 {
            result = &result * &base;
            exponent += base_exponent;
        }
        base = &base * &base;
        base_exponent *= 2;
        for (matrix, exponent) in [
            (&mut base, &mut base_exponent),
            (&mut result, &mut exponent),
        ] {
            if matrix[(centre, centre)] > 1e140 {
                *matrix *= 1e-140;
                *exponent += 140;
            }
        }
        rest /= 2;
    }
    let mut probability = result[(centre, centre)];
    for i in 1..=samples {
        probability *= i as f64 / samples as f64;
        if probability < 1e-140 {
            probability *= 1e140;
            exponent -= 140;
        }
    }
    probability * 10f64.powi(exponent)
}

/// 5 % critical distance of Lilliefors' test for n ≥ 4 samples: 0.895 / ((0.83 + n)/√n − 0.01)
/// (Molin & Abdi 1998, as in Abdi & Molin, Encyclopedia of Measurement and Statistics, 2007).
///
/// ```
/// use undrift_noise::normality::{lilliefors_critical_5, lilliefors_p, plain_critical_5};
/// // The critical distance is that of p = 5 %, and two thirds of the plain test's.
/// assert!((lilliefors_p(lilliefors_critical_5(100), 100) - 0.05).abs() < 0.005);
/// assert!((lilliefors_critical_5(100) / plain_critical_5(100) - 2.0 / 3.0).abs() < 0.02);
/// ```
pub fn lilliefors_critical_5(samples: usize) -> f64 {
    let count = samples.max(1) as f64;
    0.895 / ((0.83 + count) / count.sqrt() - 0.01)
}

/// Probability of a larger `distance` of `samples` normal samples whose mean and deviation are fitted (Lilliefors' test): Dallal &
/// Wilkinson (American Statistician 40, 1986) where it is below 0.1, above it the modified distance
/// of Stephens (J. American Statistical Association 69, 1974) by the polynomials of R's nortest.
pub fn lilliefors_p(distance: f64, samples: usize) -> f64 {
    let count = samples.max(1) as f64;
    let (scaled, size) = if count > 100.0 {
        (distance * (count / 100.0).powf(0.49), 100.0)
    } else {
        (distance, count)
    };
    let shifted: f64 = size + 2.78019;
    let exponent = -7.01256 * scaled * scaled * shifted + 2.99587 * scaled * shifted.sqrt()
        - 0.122119
        + 0.974598 / size.sqrt()
        + 1.67997 / size;
    let p = exponent.exp();
    if p <= 0.1 {
        return p;
    }
    let modified = (count.sqrt() - 0.01 + 0.85 / count.sqrt()) * distance;
    let coefficients = if modified <= 0.302 {
        return 1.0;
    } else if modified <= 0.5 {
        [2.76773, -19.828315, 80.709644, -138.55152, 81.218052]
    } else if modified <= 0.9 {
        [-4.901232, 40.662806, -97.490286, 94.029866, -32.355711]
    } else if modified <= 1.31 {
        [6.198765, -19.558097, 23.186922, -12.234627, 2.423045]
    } else {
        return 0.0;
    };
    coefficients
        .iter()
        .rev()
        .fold(0.0, |sum, c| sum * modified + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The p of Dallal & Wilkinson at the 5 % distance of Molin & Abdi, who drew their own samples.
    #[test]
    fn lilliefors_p_is_five_percent_at_the_critical_distance() {
        for samples in [7, 10, 15, 20, 30, 50, 100, 101, 200] {
            let p = lilliefors_p(lilliefors_critical_5(samples), samples);
            assert!((p - 0.05).abs() < 0.0013, "{samples}: {p}");
        }
    }

    #[test]
    fn small_p_of_lilliefors_is_the_exponential_of_dallal_and_wilkinson() {
        // Their formula, worked out apart; R's nortest gives the same.
        for (distance, samples, p) in [
            (0.25, 25, 0.000_307_183_748_801_1),
            (0.3, 10, 0.011_121_472_456_178_6),
            (0.12, 100, 0.001_180_265_386_540_69),
            (0.06, 400, 0.001_490_887_684_529_79),
            (0.18, 25, 0.035_807_516_882_761_2),
        ] {
            let found = lilliefors_p(distance, samples);
            assert!(
                (found / p - 1.0).abs() < 1e-9,
                "{distance} {samples}: {found}"
            );
        }
        // More than 100 samples count as 100 with a distance that is longer.
        let long = 0.06 * 4f64.powf(0.49);
        assert_eq!(lilliefors_p(0.06, 400), lilliefors_p(long, 100));
    }

    #[test]
    fn large_p_of_lilliefors_is_the_polynomial_of_its_modified_distance() {
        let count = 50.0f64;
        let distance = |modified: f64| modified / (count.sqrt() - 0.01 + 0.85 / count.sqrt());
        let p = |modified: f64| lilliefors_p(distance(modified), 50);
        for (x, exact) in [
            (
                0.4f64,
                2.76773 - 19.828315 * 0.4 + 80.709644 * 0.16 - 138.55152 * 0.064
                    + 81.218052 * 0.0256,
            ),
            (
                0.7,
                -4.901232 + 40.662806 * 0.7 - 97.490286 * 0.49 + 94.029866 * 0.343
                    - 32.355711 * 0.2401,
            ),
        ] {
            assert!((p(x) - exact).abs() < 1e-9, "{x}: {}", p(x));
        }
        assert_eq!(p(0.302), 1.0);
        assert_eq!(p(0.1), 1.0);
        // The pieces meet, and fall.
        for edge in [0.302, 0.5] {
            assert!((p(edge + 1e-9) - p(edge - 1e-9)).abs() < 0.005, "{edge}");
        }
        let all: Vec<f64> = (30..90).map(|k| p(f64::from(k) / 100.0)).collect();
        assert!(all.windows(2).all(|pair| pair[1] <= pair[0]), "{all:?}");
    }

    #[test]
    fn critical_distances_are_their_formulas() {
        assert!((lilliefors_critical_5(25) - 0.895 / (25.83 / 5.0 - 0.01)).abs() < 1e-12);
        assert!((plain_critical_5(100) - 0.135_809_863_8).abs() < 1e-12);
        // 5 % at the limit's own critical value.
        assert!((limit_p(1.358_098_638) - 0.05).abs() < 1e-9);
    }

    /// Both series are the same function, each where it converges fast.
    #[test]
    fn the_limits_two_series_are_one_function() {
        assert!((limit_p(1.0 - 1e-12) - limit_p(1.0)).abs() < 1e-11);
        // The theta function of z = 0.8 by the other series.
        let other = |z: f64| -> f64 {
            let term =
                |k: i32| f64::from(1 - 2 * (k % 2)) * (-2.0 * f64::from(k * k) * z * z).exp();
            -2.0 * (1..40).map(term).sum::<f64>()
        };
        for z in [0.3, 0.5, 0.8] {
            assert!(
                (limit_p(z) - other(z)).abs() < 1e-9,
                "{z}: {} {}",
                limit_p(z),
                other(z)
            );
        }
        assert_eq!((limit_p(0.0), limit_p(-1.0)), (1.0, 1.0));
    }

    /// P(D₁ ≥ d) = 2 (1 − d) above one half; of two samples 1 − (2d − ½)² · 2 up to one half… and 2 (1 − d)² above it.
    #[test]
    fn few_samples_have_the_distances_that_can_be_worked_out_by_hand() {
        for d in [0.5f64, 0.6, 0.9, 1.0] {
            assert!((plain_p(d, 1) - 2.0 * (1.0 - d)).abs() < 1e-12, "{d}");
            assert!(
                (plain_p(d, 2) - 2.0 * (1.0 - d).powi(2)).abs() < 1e-12,
                "{d}"
            );
        }
        for d in [0.3f64, 0.4, 0.5] {
            assert!(
                (plain_p(d, 2) - (1.0 - 2.0 * (2.0 * d - 0.5).powi(2))).abs() < 1e-12,
                "{d}"
            );
        }
    }
}
