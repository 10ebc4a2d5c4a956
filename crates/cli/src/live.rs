//! `undrift live`: the solution while the vehicle drives.

mod again;
mod feed;
mod outputs;
mod ros2;
mod say;

pub use again::Recorded;

use crate::{
    signals,
    terminal::{Invalid, note, take_standard_output, warn},
};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use feed::Feed;
use std::{
    fs::File,
    io::BufWriter,
    path::{Path, PathBuf},
    sync::Arc,
};
use undrift::{
    SolutionRow,
    drive::{Drive, read_text},
    io::write::{SolutionOptions, recording::RecordingWriter},
    navigate::Clock,
    noise::{BiasModel, ImuModel},
};
use undrift_live::{
    Arrival, Notice, Session, Sink,
    output::{Complain, Outlet, Place, Target},
    page::Page,
    plan::{self, Plan},
    session::Options,
    state::State,
};

/// Navigate while the vehicle drives: sources in place of the files of a drive.
///
/// The drive file is the one that `undrift inspect` and `undrift tune` write. Its logs come from sources: serial:/dev/ttyACM0?baud=115200,
/// tcp://host:port, udp://:port, gpsd://host:2947, ros2:/topic, - (standard input) or a FIFO; replay:FILE?pace=1 gives a log at its own pace.
/// The solution is that of `undrift navigate` on the same bytes (docs/live.md). It ends with Ctrl-C.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift live drive.toml --imu serial:/dev/ttyUSB0 --gnss serial:/dev/ttyACM0?baud=9600 --page 127.0.0.1:8080
  undrift live drive.toml --replay 1 --page 127.0.0.1:8080
  undrift live drive.toml --imu udp://:5000 --gnss gpsd://localhost --record run.mcap --state run.state -o tcp://:2000?format=nmea
  undrift live replay:run.mcap?pace=0 -o nav.csv")]
pub struct Arguments {
    /// The drive file; or replay:FILE.mcap, a recording of --record
    #[arg(value_name = "DRIVE.toml")]
    drive: PathBuf,
    /// Source of the inertial samples; default: what imu.file names, if that is a source
    #[arg(long, value_name = "SOURCE")]
    imu: Option<String>,
    /// Source of the fixes
    #[arg(long, value_name = "SOURCE")]
    gnss: Option<String>,
    /// Source of the poses of a drive file with [poses]
    #[arg(long, value_name = "SOURCE", conflicts_with = "gnss")]
    poses: Option<String>,
    /// Source of another log of the drive file, such as odometer=udp://:5001; repeatable
    #[arg(long, value_name = "TABLE=SOURCE")]
    sensor: Vec<String>,
    /// Replay the drive's own logs: 1 at their own pace, 20 twenty times as fast, 0 as fast as it goes
    #[arg(long, value_name = "PACE", conflicts_with_all = ["imu", "gnss", "poses", "sensor"])]
    replay: Option<f64>,
    /// Folder of the log files. Default: that of the drive file
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Noise model of the IMU: a model file or a preset (`undrift model --list`)
    #[arg(long, value_name = "IMU.toml")]
    model: Option<String>,
    /// Bias model of the filter, as that of `undrift navigate`
    #[arg(long, value_name = "NAME", default_value = "arma")]
    bias_model: BiasModel,
    /// Take measurements that come up to so late as if they had come in time [s]
    #[arg(long, value_name = "S", default_value = "2")]
    horizon: String,
    /// Whose times the solution has: imu or gnss. Default: imu, and where the two differ the standard deviations contain it
    #[arg(long, value_name = "NAME")]
    clock: Option<Clock>,
    /// Write the solution: a file, - or serial:/dev/… as csv, jsonl, nmea, mavlink, tum or kf-gins, tcp://:port (a server), udp://host:port,
    /// each with ?format=NAME behind it; foxglove://:8765 (a server for Foxglove), ros2:/undrift (topics); repeatable
    #[arg(short, long, value_name = "OUTPUT", help_heading = "Output")]
    output: Vec<outputs::Asked>,
    /// Minimum time between rows of the solution [s]; 0: every sample. Default: 0, but 0.1 for nmea and foxglove
    #[arg(long, value_name = "S", help_heading = "Output")]
    every: Option<f64>,
    /// Show the solution in a browser at this address
    #[arg(long, value_name = "HOST:PORT", help_heading = "Output")]
    page: Option<String>,
    /// Record all that arrives; `undrift navigate FILE.mcap` gives the same solution again
    #[arg(long, value_name = "FILE.mcap", help_heading = "Output")]
    record: Option<PathBuf>,
    /// Keep a checkpoint here each second, and go on from it at the next start
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    state: Option<PathBuf>,
}

impl Arguments {
    /// The sources that are asked for, by their tables.
    fn sources(&self) -> Result<Vec<(&str, &str)>> {
        let named = [
            ("imu", &self.imu),
            ("gnss", &self.gnss),
            ("poses", &self.poses),
        ];
        let named = named
            .into_iter()
            .filter_map(|(table, source)| Some((table, source.as_deref()?)));
        let mut sources = Vec::from_iter(named);
        for sensor in &self.sensor {
            let wrong = || {
                Invalid(format!(
                    "--sensor {sensor}: write TABLE=SOURCE, such as odometer=udp://:5001"
                ))
            };
            sources.push(sensor.split_once('=').ok_or_else(wrong)?);
        }
        Ok(sources)
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let rows = |output: &outputs::Asked| matches!(output, outputs::Asked::Rows(rows) if rows.target == Target::Stdout);
    if arguments.output.iter().any(rows) {
        take_standard_output();
    }
    signals::end_the_run();
    let (plan, mut feed) = prepare(arguments)?;
    let mut session = plan.session()?;
    let mut run = Run::open(arguments, &plan)?;
    while !signals::is_asked_to_end() {
        match feed.next()? {
            feed::Next::Arrival(arrival) => run.take(&mut session, &arrival)?,
            feed::Next::Notice(sentence) => run.tell(None, &sentence, true),
            feed::Next::Nothing => {}
            feed::Next::End => break,
        }
    }
    run.finish(&session)
}

/// What is to be run, and what feeds it.
fn prepare(arguments: &Arguments) -> Result<(Plan, Feed)> {
    let drive = arguments.drive.to_string_lossy();
    if let Some(recording) = feed::replayed(&drive) {
        let (path, pace) = recording.map_err(Invalid)?;
        let opened = plan::recorded(&path)?;
        let (plan, recording) = opened.ok_or_else(|| {
            anyhow!(
                "{}: not a recording of undrift live --record; specify a drive file with --replay",
                path.display()
            )
        })?;
        return Ok((plan, Feed::paced(recording, pace)));
    }
    let (text, name) = read_text(&arguments.drive)?;
    let home = arguments.drive.parent().unwrap_or(Path::new(""));
    let model = arguments
        .model
        .as_deref()
        .map(|name| ImuModel::resolve(name, Path::new("")))
        .transpose()?;
    let text = plan::with_model(&text, &name, home, model.as_ref())?;
    let folder = arguments.data.as_deref().unwrap_or(home);
    let asked = feed::Asked::new(&text, folder, &arguments.sources()?, arguments.replay)
        .map_err(|why| anyhow!(Invalid(why)))?;
    // Of logs of the same sensor, the interval of the samples is known from the beginning.
    let interval = asked.files_at_hand.then(|| {
        let drive = Drive::load(&arguments.drive, arguments.data.as_deref());
        drive.ok()?.sample_interval().ok()
    });
    let state = match arguments.state.as_deref().map(State::read).transpose() {
        Ok(state) => state.flatten(),
        Err(why) => {
            warn(format!("{why}; navigation begins without it"));
            None
        }
    };
    let plan = Plan {
        text,
        name,
        home: home.to_path_buf(),
        sources: asked.names.clone(),
        logs: asked.logs.clone(),
        options: Options {
            horizon: horizon(&arguments.horizon)?,
            bias_model: arguments.bias_model,
            clock: arguments.clock.unwrap_or_default(),
            interval: interval.flatten(),
        },
        state,
    };
    let feed = asked.open(&plan.text, &plan.name)?;
    Ok((plan, feed))
}

/// `2` or `2s`.
fn horizon(text: &str) -> Result<f64> {
    let seconds = text.trim_end_matches('s').trim().parse::<f64>().ok();
    let known = seconds.filter(|seconds| (0.0..=60.0).contains(seconds));
    known.ok_or_else(|| anyhow!(Invalid(format!("--horizon {text}: must be 0 to 60 s"))))
}

/// A recording that is written.
struct Recorder {
    writer: RecordingWriter<BufWriter<File>>,
    path: PathBuf,
    /// When it is handed over next [ns].
    next: u64,
}

/// Where everything goes.
struct Run {
    /// Outputs that are open but have no rows before the date of the times is known, and those that have.
    places: Vec<Place>,
    outlets: Vec<Outlet>,
    failed: Option<anyhow::Error>,
    views: Vec<outputs::Named>,
    recorder: Option<Recorder>,
    state: Option<PathBuf>,
    next_state: u64,
    every: Option<f64>,
    complain: Complain,
    seen: Seen,
}

/// What a run has given.
#[derive(Default)]
struct Seen {
    rows: u64,
    first: Option<f64>,
    last: Option<SolutionRow>,
}

/// From one handing over of what is kept in files to the next [ns].
const SECOND: u64 = 1_000_000_000;

impl Run {
    fn open(arguments: &Arguments, plan: &Plan) -> Result<Self> {
        let mut views = outputs::views(&arguments.output, arguments.every)?;
        if let Some(address) = &arguments.page {
            let page = Page::serve(address);
            let page = page.with_context(|| format!("cannot serve the page at {address}"))?;
            let name = format!("http://{}", page.address());
            note(format!("page: {name}"));
            views.push((name, Box::new(page)));
        }
        let recorder = arguments
            .record
            .as_ref()
            .map(|path| record(path, plan))
            .transpose()?;
        Ok(Self {
            places: arguments
                .output
                .iter()
                .filter_map(place)
                .collect::<Result<_>>()?,
            outlets: Vec::new(),
            failed: None,
            views,
            recorder,
            state: arguments.state.clone(),
            next_state: 0,
            every: arguments.every,
            complain: Arc::new(|name, why| warn(format!("{name}: {why}"))),
            seen: Seen::default(),
        })
    }

    fn take(&mut self, session: &mut Session, arrival: &Arrival) -> Result<()> {
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.take(arrival)
        {
            warn(format!(
                "{}: {error}; the recording ends here, the solution goes on",
                recorder.path.display()
            ));
            self.recorder = None;
        }
        session.take(arrival, self)?;
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        if arrival.at >= self.next_state
            && let Some(path) = &self.state
            && let Some(state) = session.state()
        {
            self.next_state = arrival.at + SECOND;
            if let Err(error) = state.write(path) {
                warn(format!(
                    "{}: {error}; no checkpoint is kept",
                    path.display()
                ));
                self.state = None;
            }
        }
        Ok(())
    }

    /// Says a sentence in the terminal and wherever else the solution is shown.
    fn tell(&mut self, time: Option<f64>, sentence: &str, is_warning: bool) {
        for (_, view) in &mut self.views {
            view.notice(time, sentence, is_warning);
        }
        say::print(time, sentence, is_warning);
    }

    fn finish(self, session: &Session) -> Result<()> {
        if let Some(recorder) = self.recorder {
            let path = recorder.path.display().to_string();
            let finished = recorder.writer.finish().map(drop);
            finished.with_context(|| format!("cannot end the recording {path}"))?;
        }
        if let Some(path) = &self.state
            && let Some(state) = session.state()
            && let Err(error) = state.write(path)
        {
            warn(format!("{}: {error}", path.display()));
        }
        let views = self
            .views
            .iter()
            .map(|(name, view)| (&**name, view.dropped()));
        let outlets = self.outlets.iter().map(Outlet::dropped);
        for (name, dropped) in outlets.chain(views).filter(|(_, dropped)| *dropped > 0) {
            warn(format!(
                "{name}: {dropped} rows were not read in time and are dropped"
            ));
        }
        for outlet in self.outlets {
            outlet.finish();
        }
        let late = session
            .navigator()
            .map_or(0, |navigator| navigator.too_late());
        match (self.seen.first, self.seen.last) {
            (Some(first), Some(last)) => {
                let [north, east, down, ..] = last.nav_std;
                note(format!(
                    "solution: {} rows, {first:.1} to {:.1} s; σ at the end {north:.2}, {east:.2}, {down:.2} m north, east, down; {late} measurements too late",
                    self.seen.rows, last.time
                ));
                Ok(())
            }
            _ => bail!("no solution: {}", say::without_solution(session)),
        }
    }
}

/// Starts a recording.
fn record(path: &Path, plan: &Plan) -> Result<Recorder> {
    let texts = plan.texts();
    let texts: Vec<(&str, &str)> = texts
        .iter()
        .map(|(name, text)| (*name, text.as_str()))
        .collect();
    let sources: Vec<&str> = plan.sources.iter().map(String::as_str).collect();
    let file = File::create(path)
        .and_then(|file| RecordingWriter::new(BufWriter::new(file), &texts, &sources));
    Ok(Recorder {
        writer: file.with_context(|| format!("cannot write {}", path.display()))?,
        path: path.to_path_buf(),
        next: 0,
    })
}

impl Recorder {
    fn take(&mut self, arrival: &Arrival) -> std::io::Result<()> {
        self.writer
            .write(arrival.source, arrival.at, &arrival.bytes)?;
        if arrival.at >= self.next {
            self.next = arrival.at + SECOND;
            self.writer.flush()?;
        }
        Ok(())
    }
}

/// Opens the place of an output of rows.
fn place(output: &outputs::Asked) -> Option<Result<Place>> {
    let outputs::Asked::Rows(output) = output else {
        return None;
    };
    let opened = Place::open(output);
    Some(opened.with_context(|| format!("cannot open the output {}", output.name())))
}

impl Sink for Run {
    fn ready(&mut self, drive: &Drive) {
        let options = SolutionOptions {
            epoch: drive.epoch,
            name: "undrift live".into(),
            every: self.every,
            frame: drive.pose_frame(),
        };
        for (_, view) in &mut self.views {
            view.ready(drive.epoch);
        }
        for place in std::mem::take(&mut self.places) {
            let name = place.name().to_owned();
            match place.start(&options, &self.complain) {
                Ok(outlet) => self.outlets.push(outlet),
                Err(error) => {
                    let error = anyhow!(error).context(format!("cannot open the output {name}"));
                    self.failed = Some(error);
                }
            }
        }
    }

    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        self.seen.rows += 1;
        self.seen.first.get_or_insert(row.time);
        self.seen.last = Some(*row);
        for outlet in &mut self.outlets {
            outlet.row(row, since_fix);
        }
        for (_, view) in &mut self.views {
            view.row(row, since_fix);
        }
    }

    fn notice(&mut self, time: Option<f64>, notice: Notice) {
        if say::is_worth_a_word(&notice) {
            let sentence = say::notice(&notice);
            self.tell(time, &sentence, say::is_warning(&notice));
        }
    }
}
