//! The source paper's Tables 2 and 3, and the data of its figures.

use std::fmt::Write as _;
use undrift::{
    demo::Demo, identify::Identified, noise::pandit_wu::PAPER_CRITICAL, outages::ModelRun,
    outages::drift_curve, record::Record,
};

/// Table 2: the tests of stationarity and normality, axis by axis.
pub fn normality(identified: &Identified) -> String {
    let mut text = format!(
        "Table 2{:9} {:>9} {:>8} {:>9} {:>8} {:>9} {:>9} {:>9}\n",
        "", "ADF", "5 %", "JB", "5 %", "KS", "5 %", "Lillief."
    );
    for (name, found) in &identified.axes {
        let Ok(axis) = found else { continue };
        let n = &axis.normality;
        let _ = writeln!(
            text,
            "{name:16} {:9.2} {:8.2} {:9.3} {:8.3} {:9.6} {:9.6} {:9.6}",
            axis.adf.statistic,
            axis.adf.critical.five,
            n.jarque_bera,
            undrift::noise::normality::JARQUE_BERA_CRITICAL_5,
            n.distance,
            n.plain_critical_5,
            n.lilliefors_critical_5
        );
    }
    text
}

/// Table 3: Pandit and Wu's procedure on one axis.
pub fn pandit_wu(identified: &Identified, name: &str) -> String {
    let table = identified
        .axes
        .iter()
        .find(|(n, _)| *n == name)
        .and_then(|(_, found)| found.as_ref().ok()?.pandit_wu.as_ref());
    let Some(table) = table else {
        return String::new();
    };
    let mut text = format!(
        "Table 3, {name:9} {:>14} {:>14} {:>14} {:>9} {:>9}\n",
        "sum of squares", "AIC", "BIC", "F", "5 %"
    );
    for row in &table.rows {
        let (p, q) = row.order();
        let (f, critical) = row.test.map_or(("–".into(), "–".into()), |t| {
            (format!("{:.3}", t.f), format!("{:.4}", t.critical))
        });
        let _ = writeln!(
            text,
            "{:18} {:14.6e} {:14.1} {:14.1} {f:>9} {critical:>9}",
            format!("ARMA({p},{q})"),
            row.fit.residual_sum_of_squares,
            row.fit.aic,
            row.fit.bic
        );
    }
    let order = |(p, q)| format!("({p},{q})");
    let _ = writeln!(
        text,
        "chosen by F, stepping down, {}; by AIC {}; by BIC {}; the paper compares F with {PAPER_CRITICAL:.4}",
        order(table.by_f),
        order(table.by_aic),
        order(table.by_bic)
    );
    text
}

/// The recommended model of each axis.
pub fn recommended(identified: &Identified) -> String {
    let mut text = String::from(
        "Recommended by the drift after 1, 10, 60 s on the half that was not fitted:\n",
    );
    for (name, found) in &identified.axes {
        let _ = match found {
            Ok(axis) => writeln!(text, "{name:16} {}", axis.recommended().name),
            Err(error) => writeln!(text, "{name:16} {error}"),
        };
    }
    text
}

/// Figure 1: the static record, every hundredth sample.
pub fn record_csv(record: &Record, rate_hz: f64) -> String {
    let mut text = format!("time_s,{}\n", record.axes.join(","));
    let length = record.samples.first().map_or(0, Vec::len);
    for k in (0..length).step_by(100) {
        let _ = write!(text, "{}", k as f64 / rate_hz);
        for axis in &record.samples {
            let _ = write!(text, ",{:.9e}", axis[k]);
        }
        text.push('\n');
    }
    text
}

/// Figure 3: autocorrelation and partial autocorrelation of an axis.
pub fn correlation_csv(identified: &Identified, name: &str) -> String {
    let mut text = String::from("lag,acf,pacf,bound\n");
    if let Some((_, Ok(axis))) = identified.axes.iter().find(|(n, _)| *n == name) {
        let bound = undrift::noise::correlation::white_bound(axis.samples);
        for (lag, (acf, pacf)) in axis.acf.iter().zip(&axis.pacf).enumerate() {
            let _ = writeln!(text, "{lag},{acf:.6},{pacf:.6},{bound:.6}");
        }
    }
    text
}

/// Figure 4: the trajectory, ten points a second, and where GNSS was cut.
pub fn trajectory_csv(demo: &Demo) -> String {
    let mut text = String::from("time_s,north_m,east_m,outage\n");
    if let Some(first) = demo.simulation.truth.first() {
        for sample in demo.simulation.truth.iter().step_by(20) {
            let ned = first.position.ned_to(&sample.position);
            let cut = demo.outages.iter().any(|o| o.contains(sample.time));
            let _ = writeln!(
                text,
                "{:.3},{:.3},{:.3},{}",
                sample.time,
                ned.x,
                ned.y,
                u8::from(cut)
            );
        }
    }
    text
}

/// Figure 5: RMS horizontal error over the outages against time since the cut.
pub fn drift_csv(runs: &[&ModelRun]) -> String {
    let mut text = String::from("model,since_cut_s,horizontal_rms_m\n");
    for run in runs {
        for (time, error) in drift_curve(run).points {
            let _ = writeln!(text, "{},{time:.3},{error:.5}", run.name.replace(',', ";"));
        }
    }
    text
}
