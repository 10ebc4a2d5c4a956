//! Simulated noise against the theory of its shaping filter.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::synthesis::NoiseGenerator;

const T: f64 = 0.01;

fn record(filter: &ShapingFilter, seed: u64, samples: usize) -> Vec<f64> {
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(filter, seed).fill(&mut record);
    record
}

#[test]
fn sample_autocovariance_is_the_theory() {
    const N: usize = 400_000;
    const LAGS: usize = 12;
    for (seed, filter) in [
        (1, ShapingFilter::arma(&[0.9], &[0.5], 2.0, T).unwrap()),
        (
            2,
            ShapingFilter::arma(&[1.2, -0.5, 0.1], &[0.3, -0.4], 1.0, T).unwrap(),
        ),
        (3, ShapingFilter::ar(&[-0.6], 1.0, T).unwrap()),
        (
            4,
            ShapingFilter::white(0.1, T)
                .unwrap()
                .plus(&ShapingFilter::gauss_markov(1.0, 0.2, T).unwrap())
                .unwrap(),
        ),
        (
            5,
            ShapingFilter::arma(&[0.9], &[0.5], 2.0, T)
                .unwrap()
                .at_interval(0.7 * T)
                .unwrap(),
        ),
    ] {
        let mut theory = [0.0; 400];
        filter.autocovariance(&mut theory);
        let at = |lag: i64| {
            theory
                .get(lag.unsigned_abs() as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let x = record(&filter, seed, N);
        for lag in 0..LAGS {
            let found: f64 = (0..N - lag).map(|k| x[k] * x[k + lag]).sum::<f64>() / N as f64;
            // Bartlett: N var = Σ_m γ_m² + γ_{m+lag} γ_{m−lag}.
            let lag = lag as i64;
            let variance: f64 = (-399..400)
                .map(|m| at(m) * at(m) + at(m + lag) * at(m - lag))
                .sum::<f64>()
                / N as f64;
            // 60 checks: four and a half standard errors are passed by chance once in 2400 runs.
            assert!(
                (found - at(lag)).abs() < 4.5 * variance.sqrt(),
                "seed {seed} lag {lag}: {found} {}",
                at(lag)
            );
        }
    }
}

#[test]
fn block_means_follow_white_noise_and_gauss_markov() {
    let (density, sigma, tau) = (0.02, 0.1, 3.0);
    let white = ShapingFilter::white(density, T).unwrap();
    let filter = white
        .plus(&ShapingFilter::gauss_markov(sigma, tau, T).unwrap())
        .unwrap();
    let x = record(&filter, 7, 2_000_000);
    for block in [10, 100, 1000, 4000] {
        let means: Vec<f64> = x
            .chunks_exact(block)
            .map(|c| c.iter().sum::<f64>() / block as f64)
            .collect();
        let pairs = means.len() - 1;
        let allan =
            means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (2 * pairs) as f64;
        // IEEE Std 952, C.1.1 and C.1.6, for a process of variance σ².
        let t = block as f64 * T;
        let a = t / tau;
        let markov =
            2.0 * sigma * sigma / (a * a) * (a - 1.5 + 2.0 * (-a).exp() - 0.5 * (-2.0 * a).exp());
        let theory = density * density / t + markov;
        // About 2/3 of the pairs are worth a degree of freedom; sums against the integral of the
        // formula differ by T/(3τ) = 0.1 %.
        let tolerance = 4.0 * (2.0 / (0.67 * pairs as f64)).sqrt() + 2e-3;
        assert!(
            (allan / theory - 1.0).abs() < tolerance,
            "{block}: {allan} {theory}"
        );
    }
}

#[test]
fn the_first_sample_is_spread_as_p0() {
    let filter = ShapingFilter::constant(3.0, T).unwrap();
    let starts: Vec<f64> = (0..4000)
        .map(|seed| NoiseGenerator::new(&filter, seed).sample())
        .collect();
    let variance = starts.iter().map(|x| x * x).sum::<f64>() / 4000.0;
    // Standard error of a variance: √(2/4000) = 2.2 %.
    assert!((variance / 9.0 - 1.0).abs() < 0.09, "{variance}");
    let mut generator = NoiseGenerator::new(&filter, 1);
    let first = generator.sample();
    assert!(generator.take(100).all(|x| x == first));
}

#[test]
fn the_bias_is_what_the_sample_holds_beside_its_own_noise() {
    let filter = ShapingFilter::gauss_markov(1.0, 10.0, T).unwrap();
    let mut generator = NoiseGenerator::new(&filter, 1);
    for _ in 0..10 {
        let bias = generator.bias();
        assert_eq!(generator.sample(), bias);
    }
}

#[test]
fn a_seed_means_the_same_everywhere() {
    let filter = ShapingFilter::arma(&[0.9], &[0.5], 1.0, T).unwrap();
    let golden = [
        0.250_732_774_048_568_64,
        0.947_595_821_942_595_1,
        0.894_724_365_485_459_7,
        1.082_647_540_635_636_4,
        1.578_754_002_612_83,
        2.968_890_954_225_195_8,
    ];
    let x = record(&filter, 42, golden.len());
    for (ours, golden) in x.iter().zip(golden) {
        // The libm of a machine may differ in the last place of a filter's constants.
        assert!((ours - golden).abs() < 1e-13, "{x:?}");
    }
    assert_eq!(record(&filter, 42, 100), record(&filter, 42, 100));
    assert_ne!(record(&filter, 42, 100), record(&filter, 43, 100));
}
