//! What is asked of a fleet, answered in sentences: which unit, which sensor, which of their labels, is it the
//! temperature?

use super::{NAMES, many};
use crate::{
    numbers::{probability, short},
    parts::first_few,
};
use undrift_results::{
    Effect, FleetGroup as Group, FleetLabel as Label, FleetMeasure as Measure, LeftOut, Slope,
};

/// A factor with its interval.
pub(super) fn factor(effect: &Effect) -> String {
    let [times, low, high] = [effect.times, effect.low, effect.high].map(|v| short(v.0));
    format!("{times} ({low} to {high})")
}

/// The answers for a measure, the units first; none where nothing could be compared.
pub(super) fn sentences(measure: &Measure) -> Vec<String> {
    let Some(effects) = &measure.effects else {
        return Vec::new();
    };
    let name = measure.name.replace('_', " ");
    let groups = [("unit", &measure.by_unit), ("sensor", &measure.by_sensor)];
    let groups = groups.map(|(what, groups)| of_groups(&name, groups, |n| many(n, what)));
    let labels = measure.by_label.iter().filter_map(|label| {
        let values = |n| format!("{} of {}", many(n, "value"), label.label);
        of_groups(&name, &label.by_value, values)
    });
    let temperature = effects.temperature.as_ref();
    let temperature = temperature.map(|slope| of_temperature(&name, slope));
    let groups = groups.into_iter().flatten().chain(labels);
    groups.chain(temperature).collect()
}

/// The labels that are not compared, and why.
pub(super) fn left_out(measure: &Measure) -> Option<String> {
    let one = |label: &Label| {
        let why = match label.left_out? {
            LeftOut::Constant => "the same in all logs",
            LeftOut::Unique => "different in each log",
            LeftOut::Unit => "most values of one unit only",
            LeftOut::Many => "too many values",
        };
        Some(format!("{} ({why})", label.label))
    };
    let names: Vec<String> = measure.by_label.iter().filter_map(one).collect();
    (!names.is_empty()).then(|| format!("Labels not compared: {}.", names.join(", ")))
}

/// What stands out of groups; `all` is their number with what they are.
fn of_groups(name: &str, groups: &[Group], all: impl Fn(u64) -> String) -> Option<String> {
    let compared = groups.iter().filter_map(|g| Some((g, g.effect.as_ref()?)));
    let compared: Vec<(&Group, &Effect)> = compared.collect();
    if compared.is_empty() {
        return None;
    }
    let mut found: Vec<&(&Group, &Effect)> = compared.iter().filter(|(_, e)| e.found).collect();
    found.sort_by(|a, b| a.1.p.0.total_cmp(&b.1.p.0));
    let of_all = all(compared.len() as u64);
    if found.is_empty() {
        return Some(format!("None of {of_all} stands out in {name}."));
    }
    let one = |(group, effect): &&(&Group, &Effect)| {
        let (times, p) = (short(effect.times.0), probability(effect.p.0));
        let [low, high] = [effect.low, effect.high].map(|v| short(v.0));
        let p = if p.starts_with('<') {
            p
        } else {
            format!("= {p}")
        };
        format!(
            "{} {times} times the others (95 %: {low} to {high}; p {p})",
            group.name
        )
    };
    let names: Vec<String> = found.iter().map(one).collect();
    Some(format!(
        "{} of {of_all} in {name}: {}.",
        if found.len() == 1 {
            "One stands out"
        } else {
            "Some stand out"
        },
        first_few(&names, NAMES)
    ))
}

fn of_temperature(name: &str, slope: &Slope) -> String {
    let [value, low, high] = [slope.percent_per_k, slope.low, slope.high].map(|v| short(v.0));
    let interval = format!("{value} %/K (95 %: {low} to {high})");
    if slope.found {
        let word = if slope.percent_per_k.0 > 0.0 {
            "grows"
        } else {
            "falls"
        };
        format!("Temperature matters: {name} {word} with it, by {interval}.")
    } else {
        format!("No effect of temperature is shown: {interval}.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_results::FleetEffects;

    fn effect(times: f64, p: f64) -> Option<Effect> {
        Some(Effect {
            times: times.into(),
            low: (times / 1.5).into(),
            high: (times * 1.5).into(),
            freedom: 27.0.into(),
            p: p.into(),
            found: p < 0.01,
        })
    }

    #[test]
    fn the_first_sentence_answers() {
        let group = |name: &str, effect| Group {
            name: name.into(),
            effect,
            ..Group::default()
        };
        let slope = Slope {
            percent_per_k: 1.0.into(),
            low: 0.8.into(),
            high: 1.2.into(),
            found: true,
            ..Slope::default()
        };
        let mut measure = Measure {
            name: "drift".into(),
            effects: Some(FleetEffects {
                temperature: Some(slope),
                ..FleetEffects::default()
            }),
            by_unit: vec![
                group("SN0001", effect(1.1, 1.0)),
                group("SN0007", effect(3.0, 1e-6)),
            ],
            ..Measure::default()
        };
        assert_eq!(
            sentences(&measure),
            [
                "One stands out of 2 units in drift: SN0007 3.00 times the others (95 %: 2.00 to 4.50; p < 0.0001).",
                "Temperature matters: drift grows with it, by 1.00 %/K (95 %: 0.800 to 1.20)."
            ]
        );
        let label = |name: &str, left_out, by_value| Label {
            label: name.into(),
            left_out,
            by_value,
        };
        measure.by_label = vec![
            label("campaign", Some(LeftOut::Constant), Vec::new()),
            label(
                "firmware",
                None,
                vec![
                    group("v1", effect(0.5, 0.001)),
                    group("v2", effect(2.0, 0.02)),
                ],
            ),
        ];
        assert_eq!(
            sentences(&measure)[1],
            "One stands out of 2 values of firmware in drift: v1 0.500 times the others (95 %: 0.333 to 0.750; p = 0.00100)."
        );
        assert_eq!(
            left_out(&measure).unwrap(),
            "Labels not compared: campaign (the same in all logs)."
        );
        measure.by_unit.pop();
        assert_eq!(
            sentences(&measure)[0],
            "None of 1 unit stands out in drift."
        );
        measure.effects = None;
        assert!(sentences(&measure).is_empty());
    }
    #[test]
    fn an_effect_of_temperature_is_one_that_is_found() {
        let slope = |percent: f64, found| Slope {
            percent_per_k: percent.into(),
            low: (-3.0).into(),
            high: 2.5.into(),
            found,
            ..Slope::default()
        };
        assert_eq!(
            of_temperature("drift", &slope(-1.0, true)),
            "Temperature matters: drift falls with it, by -1.00 %/K (95 %: -3.00 to 2.50)."
        );
        assert_eq!(
            of_temperature("drift", &slope(1.0, false)),
            "No effect of temperature is shown: 1.00 %/K (95 %: -3.00 to 2.50)."
        );
    }

    #[test]
    fn several_that_stand_out_are_listed_the_surest_first() {
        let group = |name: &str, effect| Group {
            name: name.into(),
            effect,
            ..Group::default()
        };
        // One that could not be compared does not count.
        let groups = [
            group("a", effect(2.0, 0.005)),
            group("b", effect(0.5, 0.5)),
            group("c", effect(3.0, 0.001)),
            group("d", None),
        ];
        let text = of_groups("drift", &groups, |n| many(n, "unit")).unwrap();
        assert_eq!(
            text,
            "Some stand out of 3 units in drift: c 3.00 times the others (95 %: 2.00 to 4.50; p = 0.00100), a 2.00 times the others (95 %: 1.33 to 3.00; p = 0.00500)."
        );
        assert_eq!(of_groups("drift", &groups[3..], |n| many(n, "unit")), None);
    }

    #[test]
    fn each_reason_not_to_compare_a_label_has_its_words() {
        let label = |name: &str, left_out| Label {
            label: name.into(),
            left_out,
            by_value: Vec::new(),
        };
        let measure = Measure {
            by_label: vec![
                label("a", Some(LeftOut::Unit)),
                label("b", None),
                label("c", Some(LeftOut::Many)),
                label("d", Some(LeftOut::Unique)),
            ],
            ..Measure::default()
        };
        assert_eq!(
            left_out(&measure).unwrap(),
            "Labels not compared: a (most values of one unit only), c (too many values), d (different in each log)."
        );
        assert_eq!(left_out(&Measure::default()), None);
    }
}
