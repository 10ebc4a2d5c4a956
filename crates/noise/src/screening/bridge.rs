//! Records without missing samples.

/// Missing samples replaced by the straight line between their neighbours, at either end by the record's `mean`.
pub(crate) fn bridge(cleaned: &[f64], mean: f64) -> Vec<f64> {
    let mut whole = cleaned.to_vec();
    let mut last: Option<usize> = None;
    let mut at = 0;
    while at < whole.len() {
        if whole[at].is_nan() {
            at += 1;
            continue;
        }
        if let Some(from) = last
            && at - from > 1
        {
            let (a, b) = (whole[from], whole[at]);
            for k in from + 1..at {
                whole[k] = a + (b - a) * (k - from) as f64 / (at - from) as f64;
            }
        }
        last = Some(at);
        at += 1;
    }
    for value in whole.iter_mut().filter(|v| v.is_nan()) {
        *value = mean;
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_lies_on_the_line_between_its_neighbours_and_at_the_mean_outside() {
        let nan = f64::NAN;
        let found = bridge(
            &[nan, nan, 1.0, nan, nan, nan, 9.0, 8.0, nan, 6.0, nan],
            4.5,
        );
        assert_eq!(
            found,
            [4.5, 4.5, 1.0, 3.0, 5.0, 7.0, 9.0, 8.0, 7.0, 6.0, 4.5]
        );
        assert_eq!(bridge(&[nan, nan], 2.0), [2.0, 2.0]);
        assert!(bridge(&[], 2.0).is_empty());
    }
}
