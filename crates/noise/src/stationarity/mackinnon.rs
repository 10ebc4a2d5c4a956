//! Distribution of the Dickey-Fuller statistics: response surfaces of critical values (MacKinnon,
//! "Critical values for cointegration tests", Queen's Economics Department working paper 1227, 2010,
//! table 2, N = 1) and p of τ (MacKinnon, J. Business & Economic Statistics 12, 1994, tables 3 and 4).
//!
//! The distributions are functionals of Brownian motion without a closed form; both tables are fits
//! to simulations. Critical values hold for finite samples and normal errors; p values are
//! asymptotic: with a constant and 50 rows p is 0.043 at the critical value of 5 %.

use super::{Critical, Deterministic};
use libm::erfc;

/// β∞, β1, β2, β3 of the critical value at 1, 5 and 10 %.
fn surface(deterministic: Deterministic) -> [[f64; 4]; 3] {
    match deterministic {
        Deterministic::None => [
            [-2.56574, -2.2358, -3.627, 0.0],
            [-1.94100, -0.2686, -3.365, 31.223],
            [-1.61682, 0.2656, -2.714, 25.364],
        ],
        Deterministic::Constant => [
            [-3.43035, -6.5393, -16.786, -79.433],
            [-2.86154, -2.8903, -4.234, -40.040],
            [-2.56677, -1.5384, -2.809, 0.0],
        ],
        Deterministic::Trend => [
            [-3.95877, -9.0531, -28.428, -134.155],
            [-3.41049, -4.3904, -9.036, -45.374],
            [-3.12705, -2.5856, -3.925, -22.380],
        ],
    }
}

/// Critical values of the Dickey-Fuller τ for a regression of `rows` rows: `β∞ + β1/n + β2/n² + β3/n³`.
///
/// ```
/// use undrift_noise::stationarity::{Deterministic, mackinnon::{critical_tau, p_tau}};
/// let five = critical_tau(Deterministic::Constant, 100_000).five;
/// assert!((five + 2.8615).abs() < 1e-3);
/// assert!((p_tau(five, Deterministic::Constant) - 0.05).abs() < 1e-3);
/// ```
///
/// More negative is more significant: `one` < `five` < `ten`.
pub fn critical_tau(deterministic: Deterministic, rows: usize) -> Critical {
    let inverse = 1.0 / rows.max(1) as f64;
    let [one, five, ten] =
        surface(deterministic).map(|b| b[0] + inverse * (b[1] + inverse * (b[2] + inverse * b[3])));
    Critical { one, five, ten }
}

/// Probability of a smaller Dickey-Fuller τ under a unit root, asymptotic; 0 and 1 beyond the range of the approximation.
/// The normal distribution function of a polynomial in τ: of the second degree below a switch, of the third above it.
///
/// ```
/// use undrift_noise::stationarity::{Deterministic, mackinnon::p_tau};
/// let p = |tau| p_tau(tau, Deterministic::Constant);
/// assert!(p(-6.0) < p(-2.86) && p(-2.86) < p(0.0)); // Small τ speaks against the unit root.
/// assert_eq!((p(-20.0), p(3.0)), (0.0, 1.0));
/// ```
pub fn p_tau(tau: f64, deterministic: Deterministic) -> f64 {
    // Range, switch between the two polynomials, and their coefficients.
    let (least, switch, most, small, large) = match deterministic {
        Deterministic::None => (
            -19.04,
            -1.04,
            f64::INFINITY,
            [0.6344, 1.2378, 3.2496e-2],
            [0.4797, 0.93557, -0.06999, 0.033066],
        ),
        Deterministic::Constant => (
            -18.83,
            -1.61,
            2.74,
            [2.1659, 1.4412, 3.8269e-2],
            [1.7339, 0.93202, -0.12745, -0.010368],
        ),
        Deterministic::Trend => (
            -16.18,
            -2.89,
            0.7,
            [3.2512, 1.6047, 4.9588e-2],
            [2.5261, 0.61654, -0.37956, -0.060285],
        ),
    };
    if tau > most {
        return 1.0;
    }
    if tau < least {
        return 0.0;
    }
    let z = if tau <= switch {
        small[0] + tau * (small[1] + tau * small[2])
    } else {
        large[0] + tau * (large[1] + tau * (large[2] + tau * large[3]))
    };
    normal_cdf(z)
}

/// Distribution function Φ of the standard normal.
pub(crate) fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z / std::f64::consts::SQRT_2)
}
