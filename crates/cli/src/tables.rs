//! The data of the source paper's figures.

use std::fmt::Write as _;
use undrift::{demo::Demo, record::Record, results};

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

/// Figure 4: the first drive, ten points a second, and where GNSS was cut for 10 s.
pub fn trajectory_csv(demo: &Demo) -> String {
    let mut text = String::from("time_s,north_m,east_m,outage\n");
    let (truth, cuts) = &demo.first;
    if let (Some(first), Some(cuts)) = (truth.first(), cuts.first()) {
        for sample in truth {
            let ned = first.position.ned_to(&sample.position);
            let (time, cut) = (sample.time, cuts.iter().any(|o| o.contains(sample.time)));
            let cut = u8::from(cut);
            let _ = writeln!(text, "{time:.3},{:.3},{:.3},{cut}", ned.x, ned.y);
        }
    }
    text
}

/// Figure 5: RMS horizontal error over the outages of each length against time since the cut.
pub fn drift_csv(demo: &results::Demo) -> String {
    let mut text = String::from("model,outage_s,since_cut_s,horizontal_rms_m\n");
    for of in &demo.lengths {
        for (name, errors) in &of.models {
            let drift = &errors.drift;
            for (time, error) in drift.since_cut_s.iter().zip(&drift.horizontal_rms_m) {
                let (length, time, error) = (of.length_s.0, time.0, error.0);
                let name = name.replace(',', ";");
                let _ = writeln!(text, "{name},{length},{time:.3},{error:.5}");
            }
        }
    }
    text
}
