use super::*;
use alloc::vec::Vec;

/// A number between −√3 and √3 of the variance 1, by a scrambled counter.
fn random(k: u32) -> f64 {
    let scrambled = k
        .wrapping_mul(2_654_435_761)
        .rotate_left(13)
        .wrapping_mul(0x85EB_CA6B);
    (f64::from(scrambled >> 8) / f64::from(1u32 << 24) - 0.5) * 12f64.sqrt()
}

/// Walks [s/√s] that are found from the 200th to the 800th of fixes at 5 Hz with these delays.
fn walks(delay: impl Fn(u32) -> f64) -> Vec<f64> {
    let mut stamps = Stamps::default();
    let found = (0..800).map(|k| stamps.next(100.0 + 0.2 * f64::from(k) + delay(k)));
    found
        .skip(200)
        .map(|change| change / 0.2f64.sqrt())
        .collect()
}

fn mean(walks: &[f64]) -> f64 {
    walks.iter().sum::<f64>() / walks.len() as f64
}

#[test]
fn a_delay_that_adds_up_is_a_random_walk() {
    for walk in [0.005, 0.02] {
        let mut delay = 0.0;
        let delays: Vec<f64> = (0..800)
            .map(|k| {
                delay += walk * 0.2f64.sqrt() * random(k);
                delay
            })
            .collect();
        let found = mean(&walks(|k| delays[k as usize]));
        assert!((0.7..1.3).contains(&(found / walk)), "{walk}: {found}");
    }
}

#[test]
fn even_stamps_a_clock_of_another_rate_and_white_jitter_are_none() {
    let largest = |walks: Vec<f64>| walks.into_iter().fold(0.0, f64::max);
    assert!(largest(walks(|_| 0.0)) < 1e-6);
    assert!(largest(walks(|k| 1e-5 * f64::from(k))) < 1e-6);
    // 10 ms each; by chance some of it adds up.
    assert!(mean(&walks(|k| 0.01 * random(k))) < 0.004);
}

#[test]
fn a_gap_is_no_delay_and_a_wild_one_is_bounded() {
    let gap = |k: u32| if k < 400 { 0.0 } else { 0.2 };
    assert!(walks(gap).into_iter().all(|walk| walk < 1e-6));
    let wild = walks(|k| 0.05 * f64::from(k % 100 / 50));
    assert!(wild.into_iter().fold(0.0, f64::max) <= 1.2 * MOST);
}
