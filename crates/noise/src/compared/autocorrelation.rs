//! White noise and first-order Gauss-Markov process from the autocorrelation of the averaged record.
//!
//! `R(τ) = σ² e^{−|τ|/τc}` (Brown & Hwang, Introduction to Random Signals and Applied Kalman Filtering, 1997, section 2.10): practice
//! takes short-time noise out first, by averaging or wavelets, and reads σ² and τc, where R has fallen to σ²/e, from the autocorrelation of what
//! is left (Nassar, thesis, Calgary 2003; Quinchia, Falco, Falletti, Dovis & Ferrer, Sensors 13(8), 2013, section 4).
//!
//! Here: averages over 1, 2, 4 … s, those whose neighbours are correlated most; the autocovariances from the first lag on, which have no
//! white noise in them, down to 1/e of the first; a straight line through their logarithms by least squares. Its slope is τc, its value at lag 0 σ², each
//! as averages of the process show it; what the variance of the averages over 1 s has above that is white noise.
//!
//! The autocovariance about the mean of a record of length L is low by about the variance of that mean, `2σ²τc/L`, and it scatters with few
//! e-foldings in the record: τc comes out short, and longer records are asked for than there are (Brown & Hwang, section 2.15). A walk
//! has no autocorrelation to be fitted; what is found of one depends on the length of the record.

use super::Unfit;
use crate::composite::{CompositeTerms, GaussMarkov, average_in_blocks};
use crate::correlation::{autocorrelation, autocovariance, white_bound};

/// Length of the shortest averages \[s\].
const AVERAGED_S: f64 = 1.0;
/// Averages of a record that is too short for so many of a second.
const AVERAGES: usize = 200;
/// Fewest averages whose autocorrelation is fitted.
const FEWEST: usize = 50;
/// Share of the record up to which lags are estimated (Box, Jenkins & Reinsel, section 2.1.5).
const LONGEST: usize = 4;

/// White noise N [unit·√s] and Gauss-Markov process (σ \[unit\], τ \[s\]) of a record without missing samples at
/// `rate_hz` \[Hz\].
///
/// # Errors
/// A record that is constant, not finite or too short; one whose averages are white; an autocorrelation that does
/// not fall to 1/e within a quarter of the record; one that leaves nothing to white noise.
pub fn fit(record: &[f64], rate_hz: f64) -> Result<CompositeTerms, Unfit> {
    let second = (AVERAGED_S * rate_hz).round().max(1.0) as usize;
    let shortest = second.min(record.len() / AVERAGES).max(1);
    let mut averages = average_in_blocks(record, shortest)?;
    let mut interval = shortest as f64 / rate_hz;
    if averages.len() < FEWEST {
        return Err(Unfit::TooFew {
            what: "averages",
            got: averages.len(),
            needed: FEWEST,
        });
    }
    let (variance, over) = (autocovariance(&averages, 0)?[0], interval);
    let mut best = (f64::NEG_INFINITY, Vec::new(), 0.0);
    while averages.len() >= FEWEST {
        let neighbours = autocorrelation(&averages, 1)?[1];
        let halved = average_in_blocks(&averages, 2)?;
        if neighbours > best.0 {
            best = (neighbours, averages, interval);
        }
        (averages, interval) = (halved, 2.0 * interval);
    }
    let (_, averages, interval) = best;
    let covariances = autocovariance(&averages, averages.len() / LONGEST)?;
    let process = process(&covariances, averages.len(), interval)?;
    Ok(CompositeTerms {
        white: white(variance, over, &process)?,
        gauss_markov: [process, GaussMarkov::default()],
        ..CompositeTerms::default()
    })
}

/// The process of autocovariances \[unit²\] at lags 0, 1, … of so many averages, each over `interval` \[s\]; that at lag 0,
/// which has the white noise, is only compared with.
///
/// # Errors
/// As [`fit`].
///
/// ```
/// use undrift_noise::compared::autocorrelation::process;
/// // Averages over 2 s of a process of σ = 3 and τc = 20 s, white noise on top at lag 0.
/// let x = 2.0_f64 / 20.0;
/// let at = |k: i32| 9.0 * (-x * f64::from(k)).exp() * 2.0 * (x.cosh() - 1.0) / (x * x);
/// let covariances: Vec<f64> = std::iter::once(50.0).chain((1..40).map(at)).collect();
/// let found = process(&covariances, 10_000, 2.0)?;
/// assert!((found.sigma - 3.0).abs() < 1e-9 && (found.tau_s - 20.0).abs() < 1e-9);
/// # Ok::<(), undrift_noise::compared::Unfit>(())
/// ```
pub fn process(covariances: &[f64], averages: usize, interval: f64) -> Result<GaussMarkov, Unfit> {
    let [variance, first, ..] = *covariances else {
        return Err(Unfit::White);
    };
    if first <= white_bound(averages) * variance {
        return Err(Unfit::White);
    }
    let below = |value: &f64| *value < first / std::f64::consts::E;
    let after = covariances.iter().skip(1).position(below);
    let after = after.ok_or(Unfit::NotFalling {
        longest_s: (covariances.len() - 1) as f64 * interval,
    })?;
    // Lags 1 … after; a single one has no slope.
    let (slope, at_zero) = line(&covariances[1..=after]).ok_or(Unfit::White)?;
    if slope >= 0.0 {
        return Err(Unfit::White);
    }
    // x = T/τc. Averages over T of a process have the covariance σ² e^{−kx} 2(cosh x − 1)/x² at lag k.
    let x = -slope;
    let square = at_zero.exp() * x * x / (2.0 * (x.cosh() - 1.0));
    Ok(GaussMarkov {
        sigma: square.sqrt(),
        tau_s: interval / x,
    })
}

/// Density N [unit·√s] of the white noise beside a process in averages over `interval` \[s\] of this variance \[unit²\]: less
/// the process's σ² 2(x − 1 + e^{−x})/x², x = T/τc.
///
/// # Errors
/// The process has all of the variance.
///
/// ```
/// use undrift_noise::{GaussMarkov, compared::autocorrelation::white};
/// // A process far slower than the averages adds all of its variance σ² to theirs: N² = (5 − 4) · 1 s.
/// let slow = GaussMarkov { sigma: 2.0, tau_s: 1e6 };
/// assert!((white(5.0, 1.0, &slow)? - 1.0).abs() < 1e-4);
/// assert!(white(3.0, 1.0, &slow).is_err());
/// # Ok::<(), undrift_noise::compared::Unfit>(())
/// ```
pub fn white(variance: f64, interval: f64, process: &GaussMarkov) -> Result<f64, Unfit> {
    let x = interval / process.tau_s;
    let share = 2.0 * (x + (-x).exp_m1()) / (x * x);
    let white = (variance - process.sigma * process.sigma * share) * interval;
    match white > 0.0 {
        true => Ok(white.sqrt()),
        false => Err(Unfit::NoWhite),
    }
}

/// Slope a lag and value at lag 0 of the straight line through the logarithms of values at lags 1, 2, …; none of
/// fewer than two.
fn line(values: &[f64]) -> Option<(f64, f64)> {
    let count = values.len() as f64;
    if values.len() < 2 {
        return None;
    }
    let centre = 0.5 * (count + 1.0);
    let mean = values.iter().map(|v| v.ln()).sum::<f64>() / count;
    let (mut up, mut across) = (0.0, 0.0);
    for (lag, value) in (1..).map(f64::from).zip(values) {
        up += (lag - centre) * (value.ln() - mean);
        across += (lag - centre) * (lag - centre);
    }
    let slope = up / across;
    Some((slope, mean - slope * centre))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Autocovariances of averages over T of a process: σ² e^(−kx) 2(cosh x − 1)/x², x = T/τc; at lag 0 σ² 2(x − 1 + e^(−x))/x².
    fn exact(sigma: f64, tau_s: f64, interval: f64, lags: u32) -> Vec<f64> {
        let x = interval / tau_s;
        let square = 2.0 * sigma * sigma / (x * x);
        let at = |k: u32| match k {
            0 => square * (x - 1.0 + (-x).exp()),
            k => square * (x.cosh() - 1.0) * (-x * f64::from(k)).exp(),
        };
        (0..=lags).map(at).collect()
    }

    #[test]
    fn the_autocovariances_of_a_process_give_it_back() {
        for (sigma, tau_s, interval) in [(0.3, 20.0, 1.0), (2.0, 5.0, 2.0), (1e-4, 300.0, 8.0)] {
            let covariances = exact(sigma, tau_s, interval, 200);
            let found = process(&covariances, 1000, interval).unwrap();
            assert!((found.sigma / sigma - 1.0).abs() < 1e-9, "{found:?}");
            assert!((found.tau_s / tau_s - 1.0).abs() < 1e-9, "{found:?}");
            // White noise in averages over a shorter time is N²/T of their variance.
            let over = 0.5 * interval;
            let variance = exact(sigma, tau_s, over, 0)[0] + 0.07 * 0.07 * sigma * sigma / over;
            assert!((white(variance, over, &found).unwrap() / (0.07 * sigma) - 1.0).abs() < 1e-6);
            let none = exact(sigma, tau_s, over, 0)[0] * (1.0 - 1e-6);
            assert_eq!(white(none, over, &found), Err(Unfit::NoWhite));
        }
    }

    #[test]
    fn neighbours_within_the_bound_of_white_noise_are_white() {
        // 1.96/√100 of the variance.
        let of = |first: f64| {
            process(
                &[1.0, first, 0.6 * first, 0.3 * first, 0.1 * first],
                100,
                1.0,
            )
        };
        assert_eq!(of(0.1959), Err(Unfit::White));
        assert!(of(0.1961).is_ok());
        assert_eq!(process(&[1.0], 100, 1.0), Err(Unfit::White));
        // A single lag above 1/e has no slope, and an autocovariance that rises is not a process's.
        assert_eq!(process(&[1.0, 0.5, 0.1], 100, 1.0), Err(Unfit::White));
        assert_eq!(process(&[1.0, 0.5, 0.9, 0.1], 100, 1.0), Err(Unfit::White));
        let flat = process(&[1.0, 0.5, 0.4, 0.2], 100, 3.0);
        assert_eq!(flat, Err(Unfit::NotFalling { longest_s: 9.0 }));
        // The first below 1/e ends the line.
        assert!(process(&[1.0, 0.5, 0.4, 0.18], 100, 1.0).is_ok());
    }

    #[test]
    fn a_line_through_logarithms_is_that_of_least_squares() {
        let (slope, at_zero) = line(&[2.0, 2.0 / 3.0, 2.0 / 9.0]).unwrap();
        assert!((slope + 3f64.ln()).abs() < 1e-12 && (at_zero - 6f64.ln()).abs() < 1e-12);
        // Logarithms 0, 0, 3 at 1, 2, 3: slope 3/2, mean 1 at 2.
        let (slope, at_zero) = line(&[1.0, 1.0, 3f64.exp()]).unwrap();
        assert!((slope - 1.5).abs() < 1e-12 && (at_zero + 2.0).abs() < 1e-12);
        assert_eq!(line(&[1.0]), None);
    }
}
