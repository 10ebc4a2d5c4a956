//! The data of the source paper's figures.

use std::fmt::Write as _;
use undrift::{
    demo::Demo,
    outages::{ModelRun, drift_curve},
    record::Record,
};

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
