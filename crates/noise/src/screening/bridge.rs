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
