//! `undrift outages`: cut the GNSS of a drive and compare bias models.

use crate::{
    navigate,
    output::JsonOutput,
    print,
    progress::Bar,
    report::Reporting,
    terminal::{note, say, stage},
};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    figure,
    io::write::{SolutionFile, SolutionFormat, SolutionOptions, solution::SolutionRow},
    nav::sample::TruthSample,
    navigate::scalars,
    noise::BiasModel,
    outages::{self, Experiment, Schedule},
    remarks,
    replay::{Measurement, Outage, STAMP_ROUNDING, merge},
    results,
};

/// Longest span between two nodes of the smoother [s]: the errors are taken at nodes.
const OUTAGE_NODE_SPAN: f64 = 0.2;

/// Cut GNSS again and again on a drive and measure how far each bias model drifts.
///
/// Every bias model navigates the drive with GNSS withheld during the outages. The errors inside them,
/// against the truth or else against the fixes withheld, are told as maximum, RMS and median over the
/// outages.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift outages examples/rtk-drive.toml --data logs --length 10 --every 30 --start 40
  undrift outages examples/navego-adis16405.toml --data logs --every 24 --count 15 --out out
  undrift outages examples/drive30.toml --data target/drive30/seed1 --count 10 --bias-models white,arma

tools/make-drive30 makes target/drive30/seed1.")]
pub struct Arguments {
    /// The drive file
    #[arg(value_name = "DRIVE.toml")]
    drive: PathBuf,
    #[command(flatten)]
    common: navigate::Common,
    /// Bias models to compare
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_values = ["white", "paper", "gauss-markov", "random-walk", "ar", "arma"])]
    bias_models: Vec<BiasModel>,
    /// Length of an outage [s]
    #[arg(
        long,
        value_name = "S",
        default_value_t = 10.0,
        help_heading = "Outages"
    )]
    length: f64,
    /// Number of outages; evenly spread unless --every is given
    #[arg(long, value_name = "N", help_heading = "Outages")]
    count: Option<usize>,
    /// From the start of one outage to the start of the next [s]
    #[arg(long, value_name = "S", help_heading = "Outages")]
    every: Option<f64>,
    /// Start of the first outage [s], counted from the first fix
    #[arg(
        long,
        value_name = "S",
        default_value_t = 60.0,
        help_heading = "Outages"
    )]
    start: f64,
    /// Starts of the outages in the GNSS file's own time base [s], instead of --start, --count and --every
    #[arg(long, value_name = "T1,T2,…", value_delimiter = ',', conflicts_with_all = ["count", "every", "start"], help_heading = "Outages")]
    at: Option<Vec<f64>>,
    /// Smooth: measure the errors that are left when the fixes after an outage are known too
    #[arg(long)]
    smooth: bool,
    #[command(flatten)]
    json: JsonOutput,
    /// Write outages.json and outages.svg into this folder
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Draw the truth, or the fixes, with the outages in another colour: kml, geojson or gpx by extension
    #[arg(long, value_name = "track.kml")]
    track: Option<PathBuf>,
    #[command(flatten)]
    reporting: Reporting,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    arguments.json.ready()?;
    arguments.reporting.ready()?;
    if let Some(path) = &arguments.track {
        track_format(path)?;
    }
    let drive = navigate::load(&arguments.drive, &arguments.common)?;
    let (drive, mounting) = undrift::mounting::resolve(&drive)?;
    if let Some(mounting) = mounting {
        note(format!("mounting estimated: {mounting}"));
    }
    let mut imu_reader = drive.open_imu()?;
    let imu = imu_reader.by_ref().collect::<Result<Vec<_>, _>>()?;
    let mut gnss_reader = drive.open_gnss()?;
    let gnss = gnss_reader.by_ref().collect::<Result<Vec<_>, _>>()?;
    let (mut odometer, mut barometer) = (drive.open_odometer()?, drive.open_barometer()?);
    let aiding = merge(
        gnss.iter().copied().map(Measurement::Gnss).map(Ok),
        merge(
            scalars(&mut odometer, Measurement::Odometer),
            scalars(&mut barometer, Measurement::Barometer),
        ),
    )
    .collect::<Result<Vec<_>, _>>()?;
    let mut truth_reader = drive.open_truth()?;
    let truth = match &mut truth_reader {
        Some(reader) => reader.collect::<Result<Vec<_>, _>>()?,
        None => Vec::new(),
    };
    let (Some(first), Some(last)) = (gnss.first(), gnss.last()) else {
        bail!("{} holds no usable fix", drive.gnss.0.display());
    };
    let plan = match (&arguments.at, arguments.every, arguments.count) {
        (Some(times), ..) => Schedule::At(times.clone()),
        (None, Some(every), count) => Schedule::Every {
            start: arguments.start,
            every,
            count,
        },
        (None, None, Some(count)) => Schedule::Count {
            start: arguments.start,
            count,
        },
        (None, None, None) => {
            bail!("say how many outages: --count N, --every SECONDS, or --at T1,T2,…")
        }
    };
    let cuts = outages::schedule(&plan, arguments.length, first.time, last.time)
        .map_err(anyhow::Error::msg)?;
    if !truth.is_empty() {
        let covered = |t: f64| truth[0].time <= t && t <= truth[truth.len() - 1].time;
        if let Some(cut) = cuts.iter().find(|c| !covered(c.start) || !covered(c.end)) {
            bail!(
                "the truth covers {:.3} to {:.3} s, not the outage from {:.3} to {:.3} s; compare the time columns, or leave the truth out to measure against the withheld fixes",
                truth[0].time,
                truth[truth.len() - 1].time,
                cut.start,
                cut.end
            );
        }
    }
    let models = arguments
        .bias_models
        .iter()
        .map(|kind| {
            let mut settings = undrift::navigate::settings(&drive, *kind)?;
            settings.outages = cuts.clone();
            settings.nodes = arguments.smooth.then_some(OUTAGE_NODE_SPAN);
            Ok((kind.name().to_owned(), settings))
        })
        .collect::<Result<Vec<_>>>()?;

    let outcomes = stage("navigation", || {
        let total = imu.len() * models.len();
        let bar = Bar::new("navigated", total as u64, "samples");
        outages::run_told(&imu, &aiding, &truth, &models, |more| bar.add(more))
    });
    let (runs, failed) = print::split(&outcomes);
    let mut said = Vec::new();
    if let Some(run) = runs.first() {
        said.extend(remarks::of_health(&run.summary));
        // Among several, what one model disagrees with says nothing of the log.
        if runs.len() == 1 {
            print::judge(&run.summary);
            said.extend(remarks::of_disagreement(&run.summary));
        }
        for (name, reader, used) in [
            ("odometer", &odometer, &run.summary.odometer),
            ("barometer", &barometer, &run.summary.barometer),
        ] {
            let reader = reader.iter();
            said.extend(
                reader.flat_map(|r| remarks::of_scalar(name, r.skipped(), &r.gaps(), used)),
            );
        }
    }
    let mut logs = vec![
        ("IMU", imu_reader.skipped()),
        ("GNSS", gnss_reader.skipped()),
    ];
    logs.extend(truth_reader.as_ref().map(|r| ("truth", r.skipped())));
    said.extend(remarks::of_skipped(&logs));
    let track = outages::track(&truth, &gnss);
    let experiment = Experiment {
        drive: results::drive(&arguments.drive, &drive),
        outages: &cuts,
        results: &outcomes,
        reference: if truth.is_empty() { "gnss" } else { "truth" },
        track: &track,
        smooth: arguments.smooth,
        warnings: said.clone(),
    };
    let json = results::text(&experiment.json());
    arguments.reporting.write(&json)?;
    if !arguments.json.write(&json)? {
        say(format!(
            "{} outages of {} s, reference: {}. Errors inside the outages:\n",
            cuts.len(),
            arguments.length,
            if truth.is_empty() {
                "the withheld fixes"
            } else {
                "the truth"
            }
        ))?;
        say(print::shown(&runs))?;
    }
    print::print_failed(&failed);
    print::print_warnings(&runs);
    print::print_remarks(said);
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make {}", folder.display()))?;
        print::write_whole(&folder.join("outages.json"), &json)?;
        let curves: Vec<_> = runs.iter().map(|r| figure::drift_curve(r)).collect();
        figure::experiment(&folder.join("outages.svg"), &track, &cuts, &curves)
            .map_err(anyhow::Error::msg)?;
    }
    if let Some(path) = &arguments.track {
        write_track(path, &track, &cuts, &arguments.drive)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    if runs.is_empty() {
        bail!("no model could be run");
    }
    Ok(())
}

/// The format of the track, known before anything is run.
fn track_format(path: &Path) -> Result<SolutionFormat> {
    SolutionFormat::from_path(path)
        .filter(|format| format.is_map())
        .with_context(|| {
            format!(
                "--track {}: a track is .kml, .geojson or .gpx",
                path.display()
            )
        })
}

fn write_track(path: &Path, track: &[TruthSample], cuts: &[Outage], drive: &Path) -> Result<()> {
    let options = SolutionOptions {
        name: navigate::stem(drive),
        ..SolutionOptions::default()
    };
    let mut file = SolutionFile::create(path, track_format(path)?, &options)?;
    for sample in track {
        let next = cuts.partition_point(|cut| cut.end + STAMP_ROUNDING < sample.time);
        let outage = cuts.get(next).is_some_and(|cut| cut.contains(sample.time));
        file.write(&SolutionRow::at(sample.time, sample.position), outage)?;
    }
    Ok(file.finish()?)
}
