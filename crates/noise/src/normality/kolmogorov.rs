//! Distribution of the Kolmogorov-Smirnov distance: of a known distribution, and of a fitted normal.

/// Samples up to which p of the plain test is exact.
const EXACT: usize = 500;

/// 5 % critical distance of the plain test for n samples, asymptotic: 1.3581 / √n.
pub fn plain_critical_5(samples: usize) -> f64 {
    1.358_098_638 / (samples.max(1) as f64).sqrt()
}

/// p of the plain two-sided test. Exact up to 500 samples (Marsaglia, Tsang & Wang, J. Statistical
/// Software 8(18), 2003) as long as p is above 1e-6; otherwise Kolmogorov's limit at
/// z + 1/(6√n) + (z − 1)/(4n), z = √n D, good to order n^{−3/2} (Vrbik, Pioneer J. Theoretical and
/// Applied Statistics 15, 2018).
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
pub fn lilliefors_critical_5(samples: usize) -> f64 {
    let count = samples.max(1) as f64;
    0.895 / ((0.83 + count) / count.sqrt() - 0.01)
}

/// p of Lilliefors' test for a normal distribution with fitted mean and deviation: Dallal &
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
}
