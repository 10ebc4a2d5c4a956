//! The order of an ARMA: the source paper's Table 3 and its tests of adequacy, with what the paper prints.

use super::units;
use crate::{Cell, Table, numbers::exact};
use undrift_results::{Axis, Order, OrderRow, OrderTest};

/// p and q.
type Pq = (u64, u64);
/// An order with two numbers that are printed of it.
type Printed = (Pq, f64, f64);

/// The paper's axis.
const PAPER_AXIS: &str = "gyro_z";
/// The paper's Table 3: order, AIC, and F in the row of the larger model, where the paper puts it in that of the smaller.
const PAPER: [Printed; 5] = [
    ((1, 1), -10.1943, f64::NAN),
    ((2, 1), -10.1971, 2887.9970),
    ((4, 3), -10.1971, 0.5050),
    ((6, 5), -10.1971, 13.9407),
    ((8, 7), -10.1971, -10.7150),
];
/// The paper's adequacy: order, larger order, F.
const PAPER_ADEQUACY: [(Pq, Pq, f64); 2] = [((1, 1), (2, 1), -10.1905), ((2, 1), (3, 2), -19.5435)];

fn is(order: Order, of: Pq) -> bool {
    (order.p, order.q) == of
}

/// Table 3.
pub(crate) fn pandit_wu(name: &str, axis: &Axis) -> Table {
    let squares = format!("sum of squares [{}]", units(name).squares);
    let paper = |row: &OrderRow| PAPER.iter().find(|of| is(row.order, of.0));
    let of_paper = name == PAPER_AXIS;
    let mut caption = "Pandit and Wu's procedure, as in the source paper's Table 3. F tests each order against the previous one: above its 5 % critical value the larger order is better. AIC per sample is ln(A/N) + 2r/N, A the sum of squares, N samples, r parameters. The smallest AIC and BIC are highlighted.".to_owned();
    if of_paper {
        caption += " The paper's values are of its own record; its F is printed one row higher. An F far below 0 means that the fit of the larger order did not reach its optimum.";
    }
    let f = |row: &&OrderRow| Cell::number(row.f.0, 2).strong_if(row.f.0 > row.f_critical.0);
    let mut rows = Table::from_rows(
        &format!("pandit-wu-{name}"),
        &caption,
        &axis.pandit_wu,
        &[
            ("model", &|row| format!("ARMA{}", row.order).into()),
            (&squares, &|row| exact(row.rss.0).into()),
            ("AIC", &|row| Cell::number(row.aic.0, 1)),
            ("BIC", &|row| Cell::number(row.bic.0, 1)),
            ("AIC per sample", &|row| {
                Cell::number(row.aic_per_sample.0, 4)
            }),
            ("F", &f),
            ("5 % critical value", &|row| {
                Cell::number(row.f_critical.0, 2)
            }),
            ("paper's critical value", &|row| {
                Cell::number(row.f_paper.0, 2)
            }),
        ],
    );
    if of_paper {
        let of = |value: fn(&Printed) -> f64| {
            let values = axis
                .pandit_wu
                .iter()
                .map(move |row| paper(row).map_or(f64::NAN, value));
            values.map(|value| Cell::number(value, 4))
        };
        rows.add("paper's AIC".into(), of(|row| row.1));
        rows.add("paper's F".into(), of(|row| row.2));
    }
    for (column, of) in [(2, (|r| r.aic.0) as fn(&OrderRow) -> f64), (3, |r| r.bic.0)] {
        let orders = axis.pandit_wu.iter().map(of).enumerate();
        let finite = orders.filter(|(_, v)| v.is_finite());
        if let Some((least, _)) = finite.min_by(|a, b| a.1.total_cmp(&b.1)) {
            rows.rows[least][column].strong = true;
        }
    }
    rows
}

/// The tests by which the source paper finds (1,1) adequate.
pub(crate) fn adequacy(name: &str, axis: &Axis) -> Table {
    let of_paper = name == PAPER_AXIS;
    let mut caption = "Adequacy, as in section 1.3 of the source paper: F of a larger order against a smaller one, whose 5 % critical value it exceeds where the smaller does not suffice.".to_owned();
    if of_paper {
        caption += " The paper's F of (2,1) against (1,1), −10.19, is not the 2888 of its Table 3 for the same two orders.";
    }
    let f = |test: &&OrderTest| Cell::number(test.f.0, 2).strong_if(test.f.0 > test.f_critical.0);
    let mut rows = Table::from_rows(
        &format!("adequacy-{name}"),
        &caption,
        &axis.adequacy,
        &[
            ("model", &|test| format!("ARMA{}", test.smaller).into()),
            ("against", &|test| format!("ARMA{}", test.larger).into()),
            ("F", &f),
            ("5 % critical value", &|test| {
                Cell::number(test.f_critical.0, 2)
            }),
        ],
    );
    if of_paper {
        let paper = |test: &OrderTest| {
            let same = |of: &&((u64, u64), (u64, u64), f64)| {
                is(test.smaller, of.0) && is(test.larger, of.1)
            };
            PAPER_ADEQUACY.iter().find(same).map_or(f64::NAN, |of| of.2)
        };
        let values = axis
            .adequacy
            .iter()
            .map(|test| Cell::number(paper(test), 4));
        rows.add("paper's F".into(), values);
    }
    rows
}

/// The adequacy of (1,1) in a line for a terminal; nothing where it was not tested.
pub(crate) fn adequacy_line(axis: &Axis) -> Option<String> {
    let tests = axis.adequacy.iter().filter(|test| is(test.smaller, (1, 1)));
    let tests: Vec<&OrderTest> = tests.collect();
    let is_adequate = tests.iter().all(|test| test.f.0 <= test.f_critical.0);
    let each = tests.iter().map(|test| {
        format!(
            "F {:.2} against {} (5 %: {:.2})",
            test.f.0, test.larger, test.f_critical.0
        )
    });
    let each = Vec::from_iter(each).join(", ");
    let verdict = if is_adequate {
        "adequate"
    } else {
        "not adequate"
    };
    (!tests.is_empty()).then(|| format!("ARMA(1,1) is {verdict}: {each}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order((p, q): (u64, u64)) -> Order {
        Order { p, q }
    }

    fn axis() -> Axis {
        let row = |of, f: f64, aic: f64| OrderRow {
            order: order(of),
            aic_per_sample: aic.into(),
            f: f.into(),
            f_critical: 3.0.into(),
            ..OrderRow::default()
        };
        let test = |smaller, larger, f: f64| OrderTest {
            smaller: order(smaller),
            larger: order(larger),
            f: f.into(),
            f_critical: 3.0.into(),
            p_value: 0.5.into(),
        };
        Axis {
            pandit_wu: vec![row((1, 1), f64::NAN, -9.5), row((2, 1), 0.7, -9.51)],
            adequacy: vec![
                test((1, 1), (2, 1), 0.7),
                test((2, 1), (3, 2), 1.5),
                test((1, 1), (3, 2), 1.2),
            ],
            ..Axis::default()
        }
    }

    fn texts(table: &Table, row: usize) -> Vec<&str> {
        table.rows[row].iter().map(|cell| &*cell.text).collect()
    }

    #[test]
    fn the_papers_values_stand_beside_ours_on_its_axis_alone() {
        let ours = pandit_wu("gyro_z", &axis());
        assert_eq!(ours.head[8..], ["paper's AIC", "paper's F"]);
        assert_eq!(
            texts(&ours, 0)[4..],
            ["-9.5000", "–", "3.00", "–", "-10.1943", "–"]
        );
        // Of (2,1) against (1,1), in the row of (2,1).
        assert_eq!(
            texts(&ours, 1)[4..],
            ["-9.5100", "0.70", "3.00", "–", "-10.1971", "2887.9970"]
        );
        assert_eq!(pandit_wu("accel_x", &axis()).head.len(), 8);
        let tests = adequacy("gyro_z", &axis());
        assert_eq!(
            texts(&tests, 0),
            ["ARMA(1,1)", "ARMA(2,1)", "0.70", "3.00", "-10.1905"]
        );
        assert_eq!(texts(&tests, 2)[4], "–");
    }

    #[test]
    fn a_line_states_whether_one_one_is_adequate() {
        let mut axis = axis();
        assert_eq!(
            adequacy_line(&axis).as_deref(),
            Some(
                "ARMA(1,1) is adequate: F 0.70 against (2,1) (5 %: 3.00), F 1.20 against (3,2) (5 %: 3.00)"
            )
        );
        axis.adequacy[2].f = 4.0.into();
        let line = adequacy_line(&axis).unwrap();
        assert!(line.starts_with("ARMA(1,1) is not adequate"), "{line}");
        axis.adequacy.clear();
        assert_eq!(adequacy_line(&axis), None);
    }
}
