//! What is asked of a fleet, answered in sentences: which unit, which sensor, is it the temperature?

use super::{NAMES, many};
use crate::{
    numbers::{probability, short},
    parts::first_few,
};
use undrift::results::{Effect, FleetGroup as Group, FleetMeasure as Measure, Slope};

/// A factor with its interval.
pub(super) fn factor(effect: &Effect) -> String {
    let [times, low, high] = [effect.times, effect.low, effect.high].map(|v| short(v.0));
    format!("{times} ({low} to {high})")
}

/// The answers for a measure, the units first; none where nothing could be compared.
pub(super) fn of(measure: &Measure) -> Vec<String> {
    let Some(model) = &measure.effects else {
        return Vec::new();
    };
    let name = measure.name.replace('_', " ");
    let groups = [("unit", &measure.by_unit), ("sensor", &measure.by_sensor)];
    let groups = groups.map(|(what, groups)| of_groups(&name, what, groups));
    let temperature = model.temperature.as_ref();
    let temperature = temperature.map(|slope| of_temperature(&name, slope));
    groups.into_iter().flatten().chain(temperature).collect()
}

fn of_groups(name: &str, what: &str, groups: &[Group]) -> Option<String> {
    let compared = groups.iter().filter_map(|g| Some((g, g.effect.as_ref()?)));
    let compared: Vec<(&Group, &Effect)> = compared.collect();
    if compared.is_empty() {
        return None;
    }
    let mut found: Vec<&(&Group, &Effect)> = compared.iter().filter(|(_, e)| e.found).collect();
    found.sort_by(|a, b| a.1.p.0.total_cmp(&b.1.p.0));
    let of_all = many(compared.len() as u64, what);
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
    use undrift::results::FleetEffects;

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
            of(&measure),
            [
                "One stands out of 2 units in drift: SN0007 3.00 times the others (95 %: 2.00 to 4.50; p < 0.0001).",
                "Temperature matters: drift grows with it, by 1.00 %/K (95 %: 0.800 to 1.20)."
            ]
        );
        measure.by_unit.pop();
        assert_eq!(of(&measure)[0], "None of 1 unit stands out in drift.");
        measure.effects = None;
        assert!(of(&measure).is_empty());
    }
}
