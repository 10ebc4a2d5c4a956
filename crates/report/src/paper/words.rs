//! What agrees with the source paper and what does not.

use super::TABLE_4;
use crate::numbers::{get, short};
use undrift_results::{
    Axis, Demo, Paper,
    demo::{PAPER, PAPER_EXACT, WHITE},
};

/// What is set side by side.
pub(super) const INTRODUCTION: &str = "Wang, Lyu & Wu, J. National University of Defense Technology 38(6), 2016, 64-69: the same quantities, units and rows as they print, beside ours. Their record and drive are not public, so equal numbers are not to be expected; what can agree is the size of each, the order chosen, and which filter drifts less.";

/// What agrees and what does not, in paragraphs.
pub(super) fn agreement(demo: &Demo, axis: &Axis, paper: &Paper) -> Vec<String> {
    let mut words = Vec::new();
    let adf = axis.adf.fixed.statistic < axis.adf.fixed.critical.five;
    let kpss = axis.kpss.statistic > axis.kpss.critical.five;
    let normal = axis.jarque_bera.statistic < axis.jarque_bera.critical_5;
    words.push(format!(
        "Tests: ADF {} a unit root, as in the paper, and KPSS {} stationarity: with a moving-average root near 1 ADF rejects far too often, so its verdict says little. Jarque-Bera {} normality{}. The paper's Kolmogorov-Smirnov value 0.4918 is the distance of samples of 0.0061 rad/s from N(0, 1) and says nothing of their normality.",
        if adf { "rejects" } else { "does not reject" },
        if kpss { "rejects" } else { "does not reject" },
        if normal { "does not reject" } else { "rejects" },
        if normal {
            " where the paper's record does: the simulated noise is normal"
        } else {
            ", as in the paper"
        },
    ));
    words.extend(orders(demo, paper));
    let one_one = paper.one_one.iter();
    for fit in one_one.filter(|fit| !fit.unit_root) {
        let away = (1.0 - fit.phi.0).abs();
        words.push(if away < 0.01 {
            format!(
                "Equation 2: the likeliest ARMA(1,1) has φ = {:.5} and θ = {:.5}: a slow bias under white noise, as the paper's 1.0000 and 0.9994.",
                fit.phi.0, fit.theta.0
            )
        } else {
            format!(
                "Equation 2 does not hold on this record: at the full rate the likeliest ARMA(1,1) has φ = {:.3} and θ = {:.3}, the sensor's short memory (filter taps, resonance), with no slow bias in it. With φ held at 1 the bias appears, at a lower likelihood.",
                fit.phi.0, fit.theta.0
            )
        });
    }
    words.extend(paper.residuals.as_ref().map(|of| {
        let lags = of.acf.len().saturating_sub(1);
        let beyond = of.acf.iter().skip(1).filter(|r| r.0.abs() > of.bound.0);
        format!(
            "Figure 3: of {lags} autocorrelations of what ARMA(1,1) leaves {} lie beyond the 95 % bounds, where white noise has {:.0}; the paper's lie inside.",
            beyond.count(),
            0.05 * lags as f64
        )
    }));
    words.extend(errors(demo, paper));
    words
}

/// How the orders compare.
fn orders(demo: &Demo, paper: &Paper) -> Option<String> {
    let (first, last) = paper.orders.first().zip(paper.orders.last())?;
    let known = paper.orders.iter();
    let known = known.filter(|row| row.aic_per_sample.get().is_some());
    let best = known.min_by(|a, b| a.aic_per_sample.0.total_cmp(&b.aic_per_sample.0))?;
    let one_one = paper.adequacy.first()?;
    let adequate = match one_one.f.0 <= one_one.f_critical.0 {
        true => "adequate, as in the paper",
        false => "not adequate",
    };
    let truth = match demo.recorded {
        true => "",
        false => {
            " The simulated noise is an ARMA(1,1) exactly: that F goes beyond its critical value at larger orders shows that it is not F-distributed where poles and zeros cancel."
        }
    };
    let search = match paper.orders.iter().any(|row| row.f.0 < -1.0) {
        true => "",
        false => " Exact likelihood with several starts leaves no such values here.",
    };
    Some(format!(
        "Orders: (1,1) against (2,1) is {adequate}, F = {} where {} is critical. AIC per sample falls by {:.4} from (1,1) to (8,7), the paper's by 0.0028; least at {}.{truth} F in the paper's Table 3 is 2888 between (1,1) and (2,1) and −10.19 between the same orders in its test of adequacy; both cannot hold, and an F far below 0 means that the larger fit did not reach its optimum.{search}",
        short(one_one.f.0),
        short(one_one.f_critical.0),
        first.aic_per_sample.0 - last.aic_per_sample.0,
        best.order
    ))
}

/// How the ratios of Table 4 compare.
fn errors(demo: &Demo, paper: &Paper) -> Option<String> {
    let horizontal = |errors: &[f64; 9]| errors[0].hypot(errors[1]);
    let theirs = horizontal(&TABLE_4[0].1) / horizontal(&TABLE_4[1].1);
    let largest = |name: &str| {
        let errors = paper.largest.get(name)?;
        Some(get(errors, "north_m").hypot(get(errors, "east_m")))
    };
    let ours = largest(WHITE)? / largest(PAPER_EXACT)?;
    let ten = demo.lengths.first()?;
    let pooled = ten.models.get(PAPER_EXACT)?.less_than_white;
    let literal = ten.models.get(PAPER)?.less_than_white;
    Some(format!(
        "Outages: the paper's ARMA(1,1) leaves {} times less than white noise (north and east of its Table 4 together), ours on the first drive {} times, over all {} outages of 10 s {} times (95 %: {} to {}). The direction agrees, the size does not. In 10 s the white noise rules the error, in the outage and in the attitude at its start, and no model of the bias takes it away. The paper's 16 to 19 m and 3 to 4° in 10 s are more than the noise of this sensor at rest makes; constants left in the samples would do it, or the vibration of the car. Its equations to the letter leave {} times more than white noise here.",
        short(theirs),
        short(ours),
        ten.cuts,
        short(pooled.value.0),
        short(pooled.interval[0].0),
        short(pooled.interval[1].0),
        short(1.0 / literal.value.0),
    ))
}

/// Why the literal equations fail.
pub(super) fn literal(paper: &Paper) -> Option<String> {
    let points = paper.scan.iter().filter(|p| p.horizontal_m.get().is_some());
    let best = points.min_by(|a, b| a.horizontal_m.0.total_cmp(&b.horizontal_m.0))?;
    let theta = paper.one_one.iter().find(|fit| fit.unit_root)?.theta.0;
    let innovation = (1.0 + theta * theta) / (1.0 - theta).powi(2);
    Some(format!(
        "Why equations (3)-(9) taken literally fail: they take a_t − θ a_{{t−1}} for white noise of variance (1 + θ²) σ² that drives the bias. But its two terms cancel but for a part of 1 − θ: the slow bias of an ARMA(1,1) with φ = 1 is driven by (1 − θ)² σ² a sample, and what is left, θ σ², is white noise of the measurement, for which the equations have no place. With θ = {theta:.5} the bias is driven {} times too hard in variance, so that in an outage the filter carries on a bias that is noise. The noise a_t also drives attitude and bias at once; their covariance, −C D Gᵀ T, is left out. A smaller σ only trades one for the other: of those tried the best is {} times the white noise of a sample, {} m. The innovations form, one state for each axis, needs none of this: {PAPER_EXACT}.",
        short(innovation),
        short(best.scale.0),
        short(best.horizontal_m.0)
    ))
}
