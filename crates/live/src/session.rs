//! Arrivals in, a solution out.

mod head;
mod log;
mod setup;

pub use log::Record;
pub(crate) use log::records;

use crate::{
    Arrival,
    clocks::ClockChange,
    seconds,
    state::{State, StateError},
};
use log::LogStream;
use std::path::{Path, PathBuf};
use undrift_drive::{
    drive::{Drive, DriveError},
    navigate::{Clock, FRESH, NavigateError, Rows, settings},
};
use undrift_engine::{Event, Navigator, PushError, settings::Settings};
use undrift_io::write::solution::SolutionRow;
use undrift_nav::sample::ImuSample;
use undrift_noise::BiasModel;

/// How late a receiver gives its fixes, where their times do not show it \[s\].
const LATENCY: f64 = 0.1;
/// From one look for events to the next \[s\].
const EVENTS: f64 = 1.0;
/// Bytes that the logs of one source are given by turns: some records.
const PIECE: usize = 256;
/// Longest gap between two processes that a solution goes on over \[s\]: beyond, the navigator aligns again anyway.
const MOST_GAP: f64 = 60.0;

/// How a session navigates.
#[derive(Clone, Debug)]
pub struct Options {
    /// By how much a measurement may come late \[s\].
    pub horizon: f64,
    /// The bias model of the filter.
    pub bias_model: BiasModel,
    /// Whose times the solution has.
    pub clock: Clock,
    /// Interval of the samples \[s\], where that is known from a log of the same sensor; else it is that of the first ones.
    pub interval: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            horizon: 2.0,
            bias_model: BiasModel::Arma,
            clock: Clock::default(),
            interval: None,
        }
    }
}

/// Why a session ends.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The drive file cannot be used.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// There are no settings of a filter.
    #[error(transparent)]
    Navigate(#[from] NavigateError),
    /// The filter cannot be built.
    #[error(transparent)]
    Push(PushError),
    /// The first bytes do not make a drive.
    #[error("the first {0} MB make no drive: {1}")]
    NotReady(usize, String),
    /// A log has no source.
    #[error("no source of [{0}]")]
    NoSource(String),
}

/// Something that the user of a session should know.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// Navigation cannot begin yet, and why.
    Waiting(String),
    /// The logs are understood: samples of so many \[Hz\].
    Ready(f64),
    /// The clock of a log is another one than that of the samples: this is added to its times \[s\].
    ClockApart(String, f64),
    /// The clock of a log was set: this is added to its times from here on \[s\].
    ClockSet(String, f64),
    /// A reader of a log began again, and why.
    ReadAgain(String, String),
    /// The solution goes on from a checkpoint of this time \[s\].
    Resumed(f64),
    /// It does not, and why.
    NotResumed(StateError),
    /// Something happened in the navigation.
    Navigation(Event),
    /// The navigation ended and begins again.
    Begins,
}

/// Whether a solution is without GNSS whose newest fix is so much older \[s\].
pub fn is_without_gnss(since_fix: Option<f64>) -> bool {
    since_fix.is_none_or(|since| since > FRESH)
}

/// Takes what a session gives.
pub trait Sink {
    /// The logs are understood: what of them the outputs need is known. Rows follow.
    fn ready(&mut self, drive: &Drive);
    /// The solution at the newest sample, and how much older the newest fix is \[s\]; `None` before the first.
    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>);
    /// A notice, at a time of the solution \[s\] where it has one.
    fn notice(&mut self, time: Option<f64>, notice: Notice);
}

/// Makes a solution of arrivals.
pub struct Session {
    file: DriveFile,
    options: Options,
    /// Tables of the drive file that have a log, each with the number of its source.
    logs: Vec<(String, usize)>,
    state: Option<State>,
    phase: Phase,
}

/// A drive file.
struct DriveFile {
    text: String,
    name: String,
    home: PathBuf,
}

enum Phase {
    /// The first bytes are collected until they show what the logs are.
    Collecting(setup::Collected),
    /// Boxed: it holds a filter.
    Running(Box<Running>),
}

/// A navigator and what feeds it.
struct Running {
    drive: Drive,
    settings: Settings,
    navigator: Navigator,
    horizon: f64,
    logs: Vec<LogStream>,
    rows: Rows,
    /// Time of the newest sample, and when it came \[s\].
    newest: Option<(f64, f64)>,
    /// Whether the next sample does not follow the one before by its own stamps: the clock was set, or the reader begins again.
    breaks: bool,
    /// Newest time of a fix \[s\].
    last_fix: Option<f64>,
    /// When events are looked for next \[s\].
    next_events: f64,
    /// Of the last arrival \[ns\].
    at: u64,
}

impl Session {
    /// A session of the text of a drive file, called `name`, whose model file lies in `home`; `logs` are the tables that have
    /// a source, each with the number of its source in the arrivals.
    ///
    /// # Errors
    /// If the text is no drive file, or one of its logs has no source.
    pub fn new(
        text: &str,
        name: &str,
        home: &Path,
        logs: Vec<(String, usize)>,
        options: Options,
    ) -> Result<Self, SessionError> {
        let text = setup::without_reference(text, name)?;
        setup::check(&text, &logs)?;
        Ok(Self {
            file: DriveFile {
                text,
                name: name.to_owned(),
                home: home.to_path_buf(),
            },
            options,
            logs,
            state: None,
            phase: Phase::Collecting(setup::Collected::default()),
        })
    }

    /// Goes on from a checkpoint where that is possible.
    #[must_use]
    pub fn resume(mut self, state: Option<State>) -> Self {
        self.state = state;
        self
    }

    /// The drive, once its logs are understood.
    pub fn drive(&self) -> Option<&Drive> {
        match &self.phase {
            Phase::Collecting(_) => None,
            Phase::Running(running) => Some(&running.drive),
        }
    }

    /// The navigator, once it runs.
    pub fn navigator(&self) -> Option<&Navigator> {
        match &self.phase {
            Phase::Collecting(_) => None,
            Phase::Running(running) => Some(&running.navigator),
        }
    }

    /// What is needed to go on in another process; `None` before there is a navigator.
    pub fn state(&self) -> Option<State> {
        let Phase::Running(running) = &self.phase else {
            return None;
        };
        Some(State {
            at: running.at,
            interval: running.drive.sample_interval().ok()?,
            unix_zero: running.drive.epoch.map(|epoch| epoch.unix(0.0)),
            clocks: running
                .logs
                .iter()
                .filter_map(|log| Some((log.table.clone(), log.clock.kept()?)))
                .collect(),
            navigator: running.navigator.checkpoint(),
        })
    }

    /// Takes what arrived. Arrivals are in order of time.
    ///
    /// # Errors
    /// If there can be no solution.
    pub fn take(&mut self, arrival: &Arrival, sink: &mut dyn Sink) -> Result<(), SessionError> {
        let collected = match &mut self.phase {
            Phase::Running(running) => return running.take(arrival, sink),
            Phase::Collecting(collected) => collected,
        };
        collected.add(arrival);
        let drive =
            match collected.drive(&self.file, &self.logs, &self.options, self.state.as_ref()) {
                setup::Outcome::NotYet => return Ok(()),
                setup::Outcome::Waiting(why) => {
                    sink.notice(None, Notice::Waiting(why));
                    return Ok(());
                }
                setup::Outcome::Failed(error) => return Err(error),
                setup::Outcome::Ready(drive) => *drive,
            };
        let arrivals = collected.take();
        let mut running = Box::new(Running::new(drive, &self.logs, &arrivals, &self.options)?);
        sink.ready(&running.drive);
        sink.notice(
            None,
            Notice::Ready(1.0 / running.drive.sample_interval().map_err(DriveError::from)?),
        );
        if let Some(state) = self.state.take() {
            running.resume(state, arrivals.first().map_or(0, |first| first.at), sink);
        }
        let taken = arrivals
            .iter()
            .try_for_each(|arrival| running.take(arrival, sink));
        self.phase = Phase::Running(running);
        taken
    }
}

impl Running {
    fn new(
        drive: Drive,
        logs: &[(String, usize)],
        begun: &[Arrival],
        options: &Options,
    ) -> Result<Self, SessionError> {
        let settings = settings(&drive, options.bias_model)?;
        let logs = logs.iter().map(|(table, source)| {
            LogStream::new(table, *source, setup::bytes_of(begun, *source), &drive)
        });
        Ok(Self {
            logs: logs.collect(),
            navigator: navigator(&settings, options.horizon),
            horizon: options.horizon,
            settings,
            rows: Rows::new(options.clock),
            newest: None,
            breaks: false,
            last_fix: None,
            next_events: f64::NEG_INFINITY,
            at: 0,
            drive,
        })
    }

    /// Goes on from a checkpoint; the first arrival of this process is at `first` \[ns\].
    fn resume(&mut self, state: State, first: u64, sink: &mut dyn Sink) {
        let gap = seconds(first) - seconds(state.at);
        let zero = self.drive.epoch.map(|epoch| epoch.unix(0.0));
        let restored = if !(0.0..=MOST_GAP).contains(&gap) {
            Err(StateError::Old(gap))
        } else if zero != state.unix_zero {
            Err(StateError::OtherTimes)
        } else {
            Navigator::restore(self.settings.clone(), &state.navigator)
                .map_err(|error| StateError::Navigator(error.to_string()))
        };
        match restored {
            Ok(navigator) => {
                let time = navigator.filter().map(|filter| filter.nav().time);
                self.navigator = navigator;
                for log in &mut self.logs {
                    if let Some((_, kept)) =
                        state.clocks.iter().find(|(table, _)| *table == log.table)
                    {
                        log.clock.resume(*kept, time.map(|last| (last, MOST_GAP)));
                    }
                }
                sink.notice(time, Notice::Resumed(time.unwrap_or(f64::NAN)));
            }
            Err(why) => sink.notice(None, Notice::NotResumed(why)),
        }
    }

    fn take(&mut self, arrival: &Arrival, sink: &mut dyn Sink) -> Result<(), SessionError> {
        self.at = arrival.at;
        let of_source = self.logs.iter().filter(|log| log.source == arrival.source);
        // Of a line that was held up, the samples of seconds would otherwise come before their fixes.
        let most = match of_source.count() {
            0 | 1 => arrival.bytes.len().max(1),
            _ => PIECE,
        };
        let mut pieces = arrival.bytes.chunks(most);
        pieces.try_for_each(|bytes| self.take_piece(arrival.source, bytes, sink))
    }

    fn take_piece(
        &mut self,
        source: usize,
        bytes: &[u8],
        sink: &mut dyn Sink,
    ) -> Result<(), SessionError> {
        let at = seconds(self.at);
        // While what they gave is pushed, the logs are apart.
        let mut logs = std::mem::take(&mut self.logs);
        let of_source = logs.iter_mut().filter(|log| log.source == source);
        let mut taken = Ok(());
        for log in of_source {
            let records = self.read(log, bytes, sink);
            let now = self.now(log, at);
            let now = match log.ends_with_the_next {
                true => std::mem::replace(&mut log.before, now).or(now),
                false => now,
            };
            let (mut ready, mut changes) = (Vec::new(), Vec::new());
            for record in records {
                let Some(now) = now else {
                    // Before the first sample nothing shows how late it is.
                    ready.push(record);
                    continue;
                };
                let give = &mut |time, record: Record| ready.push(record.at(time));
                changes.extend(log.clock.take(now, record.time(), record, give));
            }
            self.breaks |= log.table == log::IMU && !changes.is_empty();
            for change in changes {
                let notice = match change {
                    ClockChange::Apart(by) => Notice::ClockApart(log.table.clone(), by),
                    ClockChange::Set(by) => Notice::ClockSet(log.table.clone(), by),
                };
                sink.notice(self.time(), notice);
            }
            taken = ready
                .into_iter()
                .try_for_each(|record| self.push(record, sink));
            if taken.is_err() {
                break;
            }
        }
        self.logs = logs;
        taken
    }

    /// The records that bytes complete.
    fn read(&mut self, log: &mut LogStream, bytes: &[u8], sink: &mut dyn Sink) -> Vec<Record> {
        let mut records = Vec::new();
        let ended = log.feed(bytes, &self.drive, &mut |record| {
            records.push(record);
        });
        if let Some(why) = ended {
            self.breaks |= log.table == log::IMU;
            let why = why.map_or_else(String::new, |error| error.to_string());
            sink.notice(self.time(), Notice::ReadAgain(log.table.clone(), why));
        }
        records
    }

    /// When a record of a log comes that comes at `at` \[s\]: of samples just that; of what aids, the time of the newest sample and
    /// what has passed since it came, so that how late it is does not depend on the machine's clock.
    fn now(&self, log: &mut LogStream, at: f64) -> Option<f64> {
        if log.table == log::IMU {
            return Some(at);
        }
        if log.clock.is_new() {
            log.clock.compare(LATENCY);
        }
        let (time, came) = self.newest?;
        Some(time + (at - came))
    }

    /// Time of the solution \[s\].
    fn time(&self) -> Option<f64> {
        Some(self.navigator.filter()?.nav().time)
    }

    fn push(&mut self, record: Record, sink: &mut dyn Sink) -> Result<(), SessionError> {
        let record = match (record, self.newest) {
            (Record::Sample(sample), Some((newest, _))) if self.breaks => {
                self.breaks = false;
                Record::Sample(after(sample, newest))
            }
            _ => record,
        };
        let pushed = match record {
            Record::Sample(sample) => self.navigator.imu(sample),
            Record::Measured(measurement) => {
                if let undrift_engine::Measurement::Gnss(fix) = &measurement {
                    let newest = self.last_fix.map_or(fix.time, |last| last.max(fix.time));
                    self.last_fix = Some(newest);
                }
                self.navigator.measure(measurement).map(drop)
            }
        };
        match pushed {
            Ok(()) => {}
            // What is not in order, or no number, is left out: the next one may be.
            Err(PushError::NotFinite { .. } | PushError::NotInOrder { .. }) => return Ok(()),
            Err(error) => return Err(SessionError::Push(error)),
        }
        let Record::Sample(sample) = record else {
            self.events(sink);
            return Ok(());
        };
        self.newest = Some((sample.time, seconds(self.at)));
        if let Some(row) = self
            .navigator
            .filter()
            .and_then(|filter| self.rows.row(filter))
        {
            sink.row(&row, self.last_fix.map(|last| row.time - last));
        }
        if sample.time >= self.next_events {
            self.next_events = sample.time + EVENTS;
            self.events(sink);
        }
        if self.navigator.has_ended() {
            self.events(sink);
            self.navigator = navigator(&self.settings, self.horizon);
            sink.notice(Some(sample.time), Notice::Begins);
        }
        Ok(())
    }

    fn events(&mut self, sink: &mut dyn Sink) {
        for event in self.navigator.events() {
            sink.notice(Some(event.time()), Notice::Navigation(event));
        }
    }
}

/// A sample that follows the one at `newest` \[s\], over whatever was between: its length is that of its stamps, which a step of its clock is in,
/// or the usual one.
fn after(sample: ImuSample, newest: f64) -> ImuSample {
    let since = sample.time - newest;
    if since <= 0.0 {
        return sample;
    }
    let part = since / sample.dt;
    ImuSample {
        dt: since,
        dtheta: sample.dtheta * part,
        dvel: sample.dvel * part,
        ..sample
    }
}

/// A navigator that takes measurements up to `horizon` \[s\] late, also those whose stamps are late.
fn navigator(settings: &Settings, horizon: f64) -> Navigator {
    let navigator = Navigator::new(settings.clone());
    let ahead = navigator.ahead();
    match horizon > 0.0 {
        true => navigator.with_horizon(horizon + ahead),
        false => navigator,
    }
}

#[cfg(test)]
mod tests;
