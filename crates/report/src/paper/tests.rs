use super::*;

#[test]
fn the_papers_ratios_are_those_it_prints() {
    // Its Table 4, last row: 4.5, 2.9, 3.5, 6.5, 3.4, 4.4, 6.6, 11.4, 1.4.
    let printed = [4.5, 2.9, 3.5, 6.5, 3.4, 4.4, 6.6, 11.4, 1.4];
    let table = table_4(&Demo::default(), &Paper::default());
    for (cell, printed) in table.rows[2][1..].iter().zip(printed) {
        let ratio: f64 = cell.text.parse().unwrap();
        assert!((ratio - printed).abs() < 0.051, "{ratio} {printed}");
    }
}
