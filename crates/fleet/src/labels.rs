//! Which labels of logs are [compared](super::ratios): those whose values differ, and repeat.

use super::ratios::MOST_LEVELS;
use std::collections::BTreeMap;
use undrift_results::LeftOut;

/// Labels of a log by name.
pub type Labels = BTreeMap<String, String>;

/// Logs of a value, on average, of a label that is compared.
const LOGS_OF_A_VALUE: usize = 3;

/// The logs of a value.
struct Value<'a> {
    logs: usize,
    unit: Option<&'a str>,
    /// Whether they are all of one unit.
    of_one_unit: bool,
}

/// The labels of logs, each with its unit, and why one is left out.
pub fn chosen<'a>(
    logs: &[(Option<&'a str>, &'a Labels)],
) -> impl Iterator<Item = (&'a str, Option<LeftOut>)> {
    let most = MOST_LEVELS.min(logs.len() / LOGS_OF_A_VALUE);
    let mut labels: BTreeMap<&str, BTreeMap<&str, Value<'_>>> = BTreeMap::new();
    for (unit, of_log) in logs {
        for (label, value) in of_log.iter().filter(|(_, value)| !value.is_empty()) {
            let values = labels.entry(label).or_default();
            let value = values.entry(value).or_insert(Value {
                logs: 0,
                unit: *unit,
                of_one_unit: unit.is_some(),
            });
            value.logs += 1;
            value.of_one_unit &= value.unit == *unit;
        }
    }
    let labels = labels.into_iter();
    labels.map(move |(label, values)| (label, left_out(&values, most)))
}

fn left_out(values: &BTreeMap<&str, Value<'_>>, most: usize) -> Option<LeftOut> {
    let count = |is: fn(&Value<'_>) -> bool| values.values().filter(|v| is(v)).count();
    let all = values.len();
    if all < 2 {
        Some(LeftOut::Constant)
    } else if count(|value| value.logs == 1) == all {
        Some(LeftOut::Unique)
    } else if 2 * count(|value| value.of_one_unit) > all {
        // A comparison of single units.
        Some(LeftOut::Unit)
    } else if all > most {
        Some(LeftOut::Many)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels of 60 logs, six of each of ten units.
    fn of(label: impl Fn(usize) -> String) -> Option<LeftOut> {
        let units: Vec<String> = (0..60).map(|k| format!("SN{}", k / 6)).collect();
        let labels = |k| Labels::from([("label".to_owned(), label(k))]);
        let labels: Vec<Labels> = (0..60).map(labels).collect();
        let logs = units.iter().map(String::as_str).map(Some).zip(&labels);
        let found: Vec<_> = chosen(&logs.collect::<Vec<_>>()).collect();
        assert!(found.iter().all(|(name, _)| *name == "label"));
        found.first().and_then(|(_, why)| *why)
    }

    #[test]
    fn labels_that_differ_and_repeat_are_factors() {
        assert_eq!(of(|k| format!("van {}", k % 3)), None);
        assert_eq!(of(|k| format!("box {}", k / 30)), None);
        assert_eq!(of(|_| "one".into()), Some(LeftOut::Constant));
        // An empty text is no value.
        let half = |k: usize| ["one", ""][k % 2].to_owned();
        assert_eq!(of(half), Some(LeftOut::Constant));
        assert_eq!(of(|k| k.to_string()), Some(LeftOut::Unique));
        assert_eq!(of(|k| format!("car of {}", k / 6)), Some(LeftOut::Unit));
        assert_eq!(of(|k| format!("{}", k % 30)), Some(LeftOut::Many));
    }
}
