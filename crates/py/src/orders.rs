//! The order of an ARMA model: grids and Pandit and Wu's tests.

use crate::arma::{Fit, options};
use crate::array::{Record, samples};
use crate::{error::error, work};
use pyo3::prelude::*;
use undrift::noise::arma::{self, Selection};
use undrift::noise::pandit_wu::{self, OrderTest, PAPER_CRITICAL, PanditWuOptions};

#[derive(IntoPyObject)]
pub struct Orders {
    fits: Vec<Fit>,
    index_aic: usize,
    index_aicc: usize,
    index_bic: usize,
}

#[pyfunction]
pub fn arma_select(
    py: Python<'_>,
    x: Record<'_>,
    max_order: (usize, usize),
    mean: Option<f64>,
    unit_root: bool,
    effort: f64,
) -> PyResult<Orders> {
    let x = samples(&x)?;
    let options = options(mean, unit_root, effort);
    let found: Selection =
        work::run(py, || arma::select(x, max_order.0, max_order.1, &options))?.map_err(error)?;
    Ok(Orders {
        fits: found.fits.into_iter().map(Fit::from).collect(),
        index_aic: found.by_aic,
        index_aicc: found.by_aicc,
        index_bic: found.by_bic,
    })
}

#[derive(IntoPyObject)]
pub struct Test {
    smaller: (usize, usize),
    larger: (usize, usize),
    sum_smaller: f64,
    sum_larger: f64,
    f: f64,
    added: usize,
    remaining: usize,
    critical: f64,
    p_value: f64,
    significant: bool,
    significant_in_paper: bool,
}

impl From<OrderTest> for Test {
    fn from(test: OrderTest) -> Self {
        Self {
            smaller: test.smaller,
            larger: test.larger,
            sum_smaller: test.sum_smaller,
            sum_larger: test.sum_larger,
            f: test.f,
            added: test.added,
            remaining: test.remaining,
            critical: test.critical,
            p_value: test.p_value,
            significant: test.significant,
            significant_in_paper: test.significant_in_paper,
        }
    }
}

#[derive(IntoPyObject)]
pub struct Row {
    n: usize,
    order: (usize, usize),
    test: Option<Test>,
}

#[derive(IntoPyObject)]
pub struct PanditWu {
    rows: Vec<Row>,
    n: usize,
    adequate: bool,
    step_down: Vec<Test>,
    neighbours: Vec<Test>,
    fits: Vec<Fit>,
    by_f: (usize, usize),
    by_bic_step_down: (usize, usize),
    by_aic: (usize, usize),
    by_bic: (usize, usize),
    paper_critical: f64,
}

#[pyfunction]
pub fn arma_pandit_wu(
    py: Python<'_>,
    x: Record<'_>,
    n_max: usize,
    level: f64,
    mean: Option<f64>,
    unit_root: bool,
    effort: f64,
) -> PyResult<PanditWu> {
    let x = samples(&x)?;
    let options = PanditWuOptions {
        n_max,
        level,
        fit: options(mean, unit_root, effort),
        ..PanditWuOptions::default()
    };
    let table = work::run(py, || pandit_wu::pandit_wu(x, &options))?.map_err(error)?;
    let row = |row: &pandit_wu::OrderRow| Row {
        n: row.n,
        order: row.order(),
        test: row.test.map(Test::from),
    };
    Ok(PanditWu {
        rows: table.rows.iter().map(row).collect(),
        n: table.n,
        adequate: table.adequate,
        step_down: table.step_down.into_iter().map(Test::from).collect(),
        neighbours: table.neighbours.into_iter().map(Test::from).collect(),
        fits: table.fits.into_iter().map(Fit::from).collect(),
        by_f: table.by_f,
        by_bic_step_down: table.by_bic_step_down,
        by_aic: table.by_aic,
        by_bic: table.by_bic,
        paper_critical: PAPER_CRITICAL,
    })
}
