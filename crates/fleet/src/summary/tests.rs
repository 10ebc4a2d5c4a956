//! Labels of logs from their outcomes to the result.

use super::*;

/// The outages of a log with one model.
fn outcome(log: &str, drift: f64) -> FleetOutcome {
    FleetOutcome {
        log: log.into(),
        unit: Some("SN0".into()),
        sensor: Some("one".into()),
        labels: BTreeMap::new(),
        temperature_c: None,
        task: "outages".into(),
        failed: None,
        failed_parts: BTreeMap::new(),
        findings: Vec::new(),
        warnings: Vec::new(),
        columns: vec!["max_horizontal_m".into()],
        rows: vec![OutcomeRow {
            part: "white".into(),
            outage: Some(1),
            note: None,
            finding: None,
            values: vec![Some(drift)],
        }],
    }
}

/// Sixty logs, six of each of ten units; the drift of those in the truck is 1.8 times the others', of which each
/// differs a little; that of log 13 is 20 times as large.
fn fleet() -> Fleet {
    let mut summary = Tally::default();
    for k in 0..60_u32 {
        let label = |name: &str, value: String| (name.to_owned(), value);
        let scatter = 1.0 + 0.01 * f64::from(k * 7 % 13) + 0.03 * f64::from(k / 6 * 3 % 7);
        let drift = scatter * if k % 3 == 2 { 1.8 } else { 1.0 };
        let drift = if k == 13 { 20.0 * drift } else { drift };
        summary.add(&FleetOutcome {
            unit: Some(format!("SN{}", k / 6)),
            labels: [
                label("campaign", "spring".into()),
                label("vehicle", ["van", "car", "truck"][k as usize % 3].into()),
                label("report", format!("{k}.html")),
            ]
            .into(),
            ..outcome(&format!("{k:02}"), drift)
        });
    }
    summary.result()
}

#[test]
fn labels_are_factors_or_left_out_with_the_reason() {
    let fleet = fleet();
    let by_label = &fleet.measures[0].by_label;
    let left_out = by_label.iter().map(|l| (l.label.as_str(), l.left_out));
    assert_eq!(
        left_out.collect::<Vec<_>>(),
        [
            ("campaign", Some(LeftOut::Constant)),
            ("report", Some(LeftOut::Unique)),
            ("vehicle", None)
        ]
    );
    assert!(by_label[0].by_value.is_empty() && by_label[1].by_value.is_empty());
    let effects = by_label[2].by_value.iter();
    let effects = effects.map(|group| (group.name.as_str(), group.logs, group.effect.unwrap()));
    let effects: Vec<_> = effects.collect();
    let names = effects.iter().map(|(name, logs, _)| (*name, *logs));
    assert_eq!(
        names.collect::<Vec<_>>(),
        [("car", 20), ("truck", 20), ("van", 20)]
    );
    let truck = effects[1].2;
    assert!(
        truck.found && truck.low.0 < 1.8 && 1.8 < truck.high.0,
        "{truck:?}"
    );
}

#[test]
fn a_log_that_stands_out_has_its_report() {
    let [outlier] = fleet().measures.remove(0).outliers.try_into().unwrap();
    assert_eq!(outlier.log, "13");
    assert_eq!(outlier.report.as_deref(), Some("13.html"));
}

#[test]
fn a_log_with_remarks_is_listed_with_them() {
    let mut summary = Tally::default();
    let warnings = vec!["late".to_owned(), "short".to_owned()];
    summary.add(&outcome("silent", 1.0));
    summary.add(&FleetOutcome {
        warnings: warnings.clone(),
        ..outcome("noted", 2.0)
    });
    let fleet = summary.result();
    let noted = Warned {
        log: "noted".into(),
        unit: Some("SN0".into()),
        warnings,
    };
    assert_eq!(fleet.warned, [noted]);
    // A remark is no failure, and both logs count.
    assert!(fleet.failed.is_empty() && fleet.untrusted.is_empty());
    assert_eq!(fleet.logs.len(), 2);
}

#[test]
fn every_measure_has_its_column() {
    for measure in &MEASURES {
        let columns = crate::outcome::columns(measure.of.0);
        assert!(columns.iter().any(|name| name == measure.column.0));
    }
}
