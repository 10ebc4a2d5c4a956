//! The source paper's Tables 1 to 4 and Figures 1 to 5, and ours beside them.

mod figures;
mod words;

use super::{
    Block, Cell, Section, Table,
    identify::{adequacy, pandit_wu, units},
    numbers::{get, short},
    parts::{COMPONENTS, text},
    plain::{self, Mark},
};
use undrift_nav::earth::STANDARD_GRAVITY;
use undrift_results::{
    Axis, Demo, Numbers, Paper, Usability,
    demo::{PAPER_EXACT, WHITE},
};
use words::{agreement, literal};

/// The paper's axis.
const AXIS: &str = "gyro_z";
/// Two models of the paper's Table 4, in the order of its columns.
const TABLE_4: [(&str, [f64; 9]); 2] = [
    (
        "its white noise",
        [16.54, 19.25, 4.37, 4.33, 4.06, 0.75, 3.38, 3.89, 0.57],
    ),
    (
        "its ARMA(1,1)",
        [3.65, 6.61, 1.24, 0.67, 1.19, 0.17, 0.51, 0.34, 0.40],
    ),
];
/// Its columns among [`COMPONENTS`]: all but the horizontal error.
fn columns() -> impl Iterator<Item = (&'static str, &'static str)> {
    COMPONENTS
        .into_iter()
        .filter(|(key, _)| *key != "horizontal_m")
}

/// A table of errors by component.
pub(crate) fn components<'a>(
    name: &str,
    caption: &str,
    rows: impl Iterator<Item = (&'a str, Option<&'a Numbers>)>,
) -> Table {
    let rows: Vec<(&str, Option<&Numbers>)> = rows.collect();
    let models = rows.iter().map(|(model, _)| *model);
    let mut table = Table::from_rows(
        name,
        caption,
        models,
        &[("model", &|model| (*model).into())],
    );
    for (key, head) in COMPONENTS {
        let cells = rows.iter().map(|(_, errors)| -> Cell {
            errors.map_or("–".into(), |errors| short(get(errors, key)).into())
        });
        table.add(head.into(), cells);
    }
    table
}

/// All of it.
pub(crate) fn section(demo: &Demo) -> Option<Section> {
    let paper = demo.paper.as_ref()?;
    let axis = demo.identification.axes.get(AXIS)?;
    let [table_1, table_2, table_3, adequacy, equation, table_4] = tables(demo, axis, paper);
    let blocks = [
        text([words::INTRODUCTION.to_owned()]),
        table_1.block(),
        figures::figure_1(axis),
        table_2.block(),
        table_3.block(),
        adequacy.block(),
        equation.block(),
        figures::figure_3(paper),
        figures::figure_4(demo, paper),
        figures::figure_5(demo, paper),
        table_4.block(),
        figures::scan(paper),
    ];
    let words = agreement(demo, axis, paper).into_iter();
    let words = words.chain(literal(paper)).map(|part| text([part]));
    let blocks = blocks.into_iter().chain(words).flatten();
    Section::new("The source paper beside ours", blocks)
}

/// The same for a terminal, but for the figures.
pub fn plain(demo: &Demo, mark: Mark) -> String {
    let found = demo.paper.as_ref().zip(demo.identification.axes.get(AXIS));
    let Some((paper, axis)) = found else {
        return String::new();
    };
    let tables = tables(demo, axis, paper).map(|table| {
        let caption = table.caption.split(". ").next().unwrap_or_default();
        let caption = caption.trim_end_matches('.').to_owned();
        table.captioned(&caption)
    });
    let words = agreement(demo, axis, paper).into_iter();
    let words = words.chain(literal(paper)).map(|part| text([part]));
    let conclusion = Block::Verdict(Usability::Usable, demo.conclusion.clone());
    let blocks = [Some(conclusion)].into_iter().chain(tables);
    plain::plain(blocks.chain(words), mark)
}

fn tables(demo: &Demo, axis: &Axis, paper: &Paper) -> [Table; 6] {
    // The table of orders goes on to (8,7), whatever was searched.
    let searched = Axis {
        pandit_wu: paper.orders.clone(),
        adequacy: paper.adequacy.clone(),
        ..Axis::default()
    };
    let named = |caption: &str, table: Table| Table {
        caption: format!("{caption}. {}", table.caption),
        ..table
    };
    [
        table_1(demo),
        table_2(axis),
        named(
            "The source paper's Table 3, z gyro, first 50 000 samples",
            pandit_wu(AXIS, &searched),
        ),
        named("Its adequacy of (1,1)", adequacy(AXIS, &searched)),
        equation_2(paper),
        table_4(demo, paper),
    ]
}

/// A quantity, what the paper prints of it, and ours.
type Row = (&'static str, &'static str, f64);

/// Data of the sensor.
fn table_1(demo: &Demo) -> Table {
    let axis = |name: &str| demo.identification.axes.get(name);
    let value = |name: &str, of: fn(&Axis) -> f64| axis(name).map_or(f64::NAN, of);
    let (gyro, mg) = (units(AXIS).scale, 1e3 / STANDARD_GRAVITY);
    let beyond_gravity = |axis: &Axis| (axis.mean.0.abs() - STANDARD_GRAVITY).abs();
    let white = |axis: &Axis| axis.allan_terms.white.value * 60.0;
    let floor = |axis: &Axis| {
        let least = axis.allan.adev.iter().map(|d| d.0);
        least.fold(f64::INFINITY, f64::min) / crate::identify::FLAT
    };
    let rows: [Row; 6] = [
        (
            "gyro bias [°/s]",
            "3.0",
            gyro * value(AXIS, |a| a.mean.0.abs()),
        ),
        (
            "gyro bias instability [°/s]",
            "0.007",
            gyro * value(AXIS, floor),
        ),
        ("gyro random walk [°/√h]", "2.0", gyro * value(AXIS, white)),
        (
            "accelerometer bias [mg]",
            "50",
            mg * value("accel_z", beyond_gravity),
        ),
        (
            "accelerometer bias instability [mg]",
            "0.2",
            mg * value("accel_z", floor),
        ),
        (
            "accelerometer random walk [m/s/√h]",
            "0.2",
            value("accel_z", white),
        ),
    ];
    Table::from_rows(
        "paper-1",
        "The source paper's Table 1, data of the ADIS16405; beside it the static recording's z axes. Bias: its mean; bias instability: its least Allan deviation over 0.664; random walk: the white noise of its Allan deviation.",
        rows,
        &[
            ("quantity", &|row| row.0.into()),
            ("paper", &|row| row.1.into()),
            ("ours", &|row| short(row.2).into()),
        ],
    )
}

/// Tests of the z gyro.
fn table_2(axis: &Axis) -> Table {
    type Tested = (&'static str, [&'static str; 2], [f64; 2]);
    let adf = &axis.adf.fixed;
    let (jb, ks, lilliefors) = (&axis.jarque_bera, &axis.ks, &axis.lilliefors);
    let kpss = &axis.kpss;
    let rows: [Tested; 5] = [
        (
            "ADF",
            ["-110.1753", "below those of 1 to 10 %"],
            [adf.statistic, adf.critical.five],
        ),
        ("KPSS", ["–", "–"], [kpss.statistic, kpss.critical.five]),
        (
            "Jarque-Bera",
            ["11.4461", "5.9915"],
            [jb.statistic, jb.critical_5],
        ),
        (
            "Kolmogorov-Smirnov",
            ["0.4918", "9.4984e-4"],
            [ks.statistic, ks.critical_5],
        ),
        (
            "Lilliefors",
            ["–", "–"],
            [lilliefors.statistic, lilliefors.critical_5],
        ),
    ];
    let number = |value: f64| -> Cell { short(value).into() };
    Table::from_rows(
        "paper-2",
        "The source paper's Table 2, z gyro, with its stationarity test. Its Kolmogorov-Smirnov value is that of unscaled samples against N(0, 1), ours of samples scaled to their mean and standard deviation, for which Lilliefors' critical value holds.",
        rows,
        &[
            ("test", &|row| row.0.into()),
            ("paper", &|row| row.1[0].into()),
            ("its 5 % critical value", &|row| row.1[1].into()),
            ("ours", &|row| number(row.2[0])),
            ("5 % critical value", &|row| number(row.2[1])),
        ],
    )
}

/// The ARMA(1,1).
fn equation_2(paper: &Paper) -> Table {
    let ours = paper.one_one.iter().map(|fit| {
        let name = match fit.unit_root {
            true => "ours, φ held at 1",
            false => "ours, likeliest at the full rate",
        };
        let digits = |value: f64| Cell::number(value, 5);
        let sigma = short(fit.sigma.0).into();
        vec![name.into(), digits(fit.phi.0), digits(fit.theta.0), sigma]
    });
    let theirs = ["paper", "1.0000", "0.9994", "0.0061 by its AIC"];
    let theirs: Vec<Cell> = theirs.into_iter().map(Into::into).collect();
    Table {
        name: "paper-equation-2".into(),
        caption: "The source paper's equation 2, x_t − φ x_{t−1} = a_t − θ a_{t−1}, z gyro. Its rate is not stated; θ depends on it.".into(),
        head: ["", "φ", "θ", "σ of a [rad/s]"].map(Into::into).into(),
        rows: std::iter::once(theirs).chain(ours).collect(),
    }
}

/// Largest errors in the outages.
fn table_4(demo: &Demo, paper: &Paper) -> Table {
    let cells = |name: &str, values: Vec<f64>| -> Vec<Cell> {
        let values = values.into_iter().map(|v| short(v).into());
        std::iter::once(name.into()).chain(values).collect()
    };
    let ratio = |above: &[f64], below: &[f64]| -> Vec<f64> {
        above.iter().zip(below).map(|(a, b)| a / b).collect()
    };
    let [(white, theirs), (arma, its_arma)] = TABLE_4;
    let mut rows = vec![
        cells(white, theirs.into()),
        cells(arma, its_arma.into()),
        cells("its ratio", ratio(&theirs, &its_arma)),
    ];
    let of = |name: &str| -> Option<Vec<f64>> {
        let errors = paper.largest.get(name)?;
        Some(columns().map(|(key, _)| get(errors, key)).collect())
    };
    let models = demo.models.iter();
    let known = models.filter_map(|m| Some((m.name.as_str(), of(&m.name)?)));
    rows.extend(known.map(|(name, values)| cells(name, values)));
    if let (Some(white), Some(arma)) = (of(WHITE), of(PAPER_EXACT)) {
        let name = format!("{WHITE} / {PAPER_EXACT}");
        rows.push(cells(&name, ratio(&white, &arma)));
    }
    let heads = columns().map(|(_, head)| head.to_owned());
    Table {
        name: "paper-4".into(),
        caption: "The source paper's Table 4: largest error inside 15 outages of 10 s, its car and receiver above, the first simulated drive below. Rows by the method of each fit; largest errors of 15 outages differ by tens of percent from drive to drive.".into(),
        head: std::iter::once("model".to_owned()).chain(heads).collect(),
        rows,
    }
}

#[cfg(test)]
mod tests;
