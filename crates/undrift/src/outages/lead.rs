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

    #[test]
    fn a_clear_lead_is_rarer_than_chance() {
        // Binomial(15, ½): P(≥ 12) = 1.76 %, both sides 3.5 %; P(≥ 11) = 5.9 %.
        assert!(is_clear_lead(12, 15) && !is_clear_lead(11, 15) && !is_clear_lead(3, 15));
        assert!(!is_clear_lead(0, 0));
    }
}
