//! The source paper's Tables 2 and 3, and what is recommended, as text.

use std::fmt::Write as _;
use undrift::results::Identify;

/// Table 2: the tests of stationarity and normality, axis by axis.
pub fn normality(identified: &Identify) -> String {
    let mut text = format!(
        "Table 2{:9} {:>9} {:>8} {:>9} {:>8} {:>9} {:>9} {:>9}\n",
        "", "ADF", "5 %", "JB", "5 %", "KS", "5 %", "Lillief."
    );
    for (name, axis) in identified
        .in_order()
        .filter(|(_, axis)| axis.error.is_none())
    {
        let _ = writeln!(
            text,
            "{name:16} {:9.2} {:8.2} {:9.3} {:8.3} {:9.6} {:9.6} {:9.6}",
            axis.adf.fixed.statistic,
            axis.adf.fixed.critical.five,
            axis.jarque_bera.statistic,
            axis.jarque_bera.critical_5,
            axis.ks.statistic,
            axis.ks.critical_5,
            axis.lilliefors.critical_5
        );
    }
    text
}

/// Table 3: Pandit and Wu's procedure on one axis.
pub fn pandit_wu(identified: &Identify, name: &str) -> String {
    let axis = identified.axes.get(name);
    let found = axis.and_then(|axis| Some((axis.pandit_wu_orders?, axis.pandit_wu.last()?, axis)));
    let Some((orders, last, axis)) = found else {
        return String::new();
    };
    let mut text = format!(
        "Table 3, {name:9} {:>14} {:>14} {:>14} {:>9} {:>9}\n",
        "sum of squares", "AIC", "BIC", "F", "5 %"
    );
    for row in &axis.pandit_wu {
        let or_dash = |text: Option<String>| text.unwrap_or_else(|| "–".into());
        let f = or_dash(row.f.get().map(|f| format!("{f:.3}")));
        let critical = or_dash(row.f_critical.get().map(|f| format!("{f:.4}")));
        let _ = writeln!(
            text,
            "{:18} {:14.6e} {:14.1} {:14.1} {f:>9} {critical:>9}",
            format!("ARMA{}", row.order),
            row.rss.0,
            row.aic.0,
            row.bic.0
        );
    }
    let _ = writeln!(
        text,
        "chosen by F, stepping down, {}; by AIC {}; by BIC {}; the paper compares F with {:.4}",
        orders.by_f, orders.by_aic, orders.by_bic, last.f_paper.0
    );
    text
}

/// The recommended model of each axis.
pub fn recommended(identified: &Identify) -> String {
    let mut text = String::from(
        "Recommended by the drift after 1, 10, 60 s on the half that was not fitted:\n",
    );
    for (name, axis) in identified.in_order() {
        let recommended = axis.error.as_ref().unwrap_or(&axis.chosen.name);
        let _ = writeln!(text, "{name:16} {recommended}");
    }
    text
}

/// Figure 3: autocorrelation and partial autocorrelation of an axis.
pub fn correlation_csv(identified: &Identify, name: &str) -> String {
    let mut text = String::from("lag,acf,pacf,bound\n");
    if let Some(axis) = identified.axes.get(name) {
        let bound = axis.series.correlation_bound.0;
        for (lag, (acf, pacf)) in axis.acf.iter().zip(&axis.pacf).enumerate() {
            let _ = writeln!(text, "{lag},{:.6},{:.6},{bound:.6}", acf.0, pacf.0);
        }
    }
    text
}
