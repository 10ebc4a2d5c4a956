//! Times summary and report of a fleet whose logs are drawn: 2 000 units of 50 logs, four types, three vehicles,
//! five firmwares, seven outages and three bias models a log; some logs failed, some have warnings, a few do not belong.
//! `cargo run --release -p undrift-lab --bin fleet_speed -- DIR [LOGS]` writes fleet.json and
//! fleet.html into DIR and prints the time of the CPU, all threads.

#[path = "../../../../benches/peers/process.rs"]
mod process;

use process::{Failure, measured};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::{collections::BTreeMap, path::PathBuf};
use undrift::{
    fleet::{FleetOutcome, Gathering, OutcomeRow},
    results,
};

const OF_A_UNIT: usize = 50;
const OUTAGES: u32 = 7;
const MODELS: [(&str, f64); 3] = [("white", 1.3), ("gauss-markov", 1.1), ("arma", 1.0)];

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("give a folder to write to")?);
    let logs: usize = arguments.next().map_or(Ok(100_000), |text| text.parse())?;
    std::fs::create_dir_all(&folder)?;
    let texts: Vec<String> = (0..logs).map(|log| drawn(log).to_json()).collect();
    let mut gathering = Gathering::start(&folder)?;
    let ((), rows) = measured(1, || {
        for (log, text) in texts.iter().enumerate() {
            gathering.add(&format!("{log:064x}"), text)?;
        }
        Ok(())
    })?;
    let mut gathering = Some(gathering);
    let finish = || Ok(gathering.take().ok_or("once")?.finish()?);
    let (fleet, summary) = measured(1, finish)?;
    let json = results::text(&fleet);
    let (html, report) = measured(1, || {
        let document = undrift_report::of_results(&[(PathBuf::new(), json.clone())])?;
        Ok(undrift_report::html::render(&document))
    })?;
    std::fs::write(folder.join("fleet.html"), &html)?;
    println!(
        "{logs} logs: {:.1} s to read, {:.1} s for the summary, {:.1} s for the report; \
         fleet.json {:.1} MB, fleet.html {:.2} MB, peak {} MiB",
        rows.cpu_s,
        summary.cpu_s,
        report.cpu_s,
        json.len() as f64 / 1e6,
        html.len() as f64 / 1e6,
        report.peak_kib / 1024
    );
    Ok(())
}

fn drawn(log: usize) -> FleetOutcome {
    let unit = log / OF_A_UNIT;
    let mut of_unit = Xoshiro256PlusPlus::seed_from_u64(unit as u64 + 1_000_000);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(log as u64);
    let temperature = rng.random_range(-20.0..60.0);
    let mut scale = 3.0 * (0.15 * normal(&mut of_unit) + 0.2 * normal(&mut rng)).exp();
    scale *= (0.01_f64 * (temperature - 25.0)).exp();
    scale *= if unit % 500 == 42 { 4.0 } else { 1.0 };
    scale *= if log % 20_000 == 11 { 12.0 } else { 1.0 };
    scale *= if log % 3 == 2 { 1.2 } else { 1.0 };
    let mut rows = Vec::new();
    for outage in 1..=OUTAGES {
        let common = [normal(&mut rng), normal(&mut rng)];
        for (part, factor) in MODELS {
            let error = common.map(|common| factor * scale * (common + 0.3 * normal(&mut rng)));
            rows.push(OutcomeRow {
                part: part.into(),
                outage: Some(outage),
                note: None,
                finding: None,
                values: vec![Some(error[0].hypot(error[1]))],
            });
        }
    }
    let name = format!(
        "campaign-{}/SN{unit:04}/{:04}/drive.toml",
        2020 + log % 6,
        log % OF_A_UNIT
    );
    let failed = (log % 97 == 5).then(|| match log % 5 {
        0 => format!("gnss.csv line {}: no column \"lon_deg\"", log % 1000),
        1 => format!("{name}: imu.csv: No such file or directory"),
        _ => format!(
            "the logs do not overlap in time: imu.csv ends at {}.5 s",
            log % 7919
        ),
    });
    let diverged = log % 211 == 3 && failed.is_none();
    let label = |name: &str, value: String| (name.to_owned(), value);
    FleetOutcome {
        unit: Some(format!("SN{unit:04}")),
        sensor: Some(format!("type {}", ["A", "B", "C", "D"][unit % 4])),
        labels: [
            label("vehicle", ["van", "car", "truck"][log % 3].into()),
            label("firmware", format!("v{}", log / 7 % 5)),
            label("campaign", "all".into()),
            label("report", format!("reports/{log}.html")),
        ]
        .into(),
        temperature_c: (!log.is_multiple_of(31)).then_some(temperature),
        task: "outages".into(),
        failed_parts: if diverged {
            BTreeMap::from([("arma".into(), format!("diverged at {} s", log % 500))])
        } else {
            BTreeMap::new()
        },
        findings: Vec::new(),
        warnings: if log.is_multiple_of(53) {
            vec![format!(
                "the inertial log ends {} s before the fixes",
                log % 300
            )]
        } else {
            Vec::new()
        },
        columns: vec!["max_horizontal_m".into()],
        rows: if failed.is_some() { Vec::new() } else { rows },
        failed,
        log: name,
    }
}

/// A standard normal number, by Box and Muller.
fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    let (u, v): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}
