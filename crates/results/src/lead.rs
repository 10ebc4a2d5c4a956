//! Whether one model drifts less than another beyond chance.

use statrs::distribution::{Binomial, DiscreteCDF};

/// Whether so many wins of so many are rarer than 5 % by chance: sign test, both sides.
pub fn is_clear_lead(wins: usize, of: usize) -> bool {
    let Ok(chance) = Binomial::new(0.5, of as u64) else {
        return false;
    };
    let fewer = wins.min(of - wins.min(of)) as u64;
    2.0 * chance.cdf(fewer) < 0.05 && 2 * wins > of
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Binomial tails counted by hand, both sides.
    #[test]
    fn a_lead_is_clear_below_five_percent() {
        for (wins, of, chance) in [
            (6, 6, 2.0 / 64.0),
            (5, 5, 2.0 / 32.0),
            (7, 8, 2.0 * 9.0 / 256.0),
            (8, 9, 2.0 * 10.0 / 512.0),
            (10, 13, 2.0 * (1.0 + 13.0 + 78.0 + 286.0) / 8192.0),
            (12, 15, 2.0 * (1.0 + 15.0 + 105.0 + 455.0) / 32_768.0),
            (
                11,
                15,
                2.0 * (1.0 + 15.0 + 105.0 + 455.0 + 1365.0) / 32_768.0,
            ),
        ] {
            assert_eq!(
                is_clear_lead(wins, of),
                chance < 0.05,
                "{wins} of {of}: {chance}"
            );
        }
        // As rare, but behind; and nothing to lead in.
        assert!(!is_clear_lead(3, 15) && !is_clear_lead(0, 0));
    }
}
