//! What feeds a session: sources, or logs as if they came.

use super::ros2;
use crate::terminal::warn;
use anyhow::Result;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};
use undrift::{
    drive::{Drive, Logs},
    io::{Memory, ReadError, source},
};
use undrift_live::{
    Arrival, Source, Sources, plan, replay,
    source::{Happened, WITHOUT_ROS2},
};

/// A source that gives nothing for so long [s] is said to be silent.
const SILENT: f64 = 3.0;
/// How long nothing may happen before a look at whether the run is to end [s].
const LOOK: f64 = 0.1;

/// `replay:FILE?pace=1`: the file and its pace; `None` of anything else.
pub fn replayed(text: &str) -> Option<Result<(PathBuf, f64), String>> {
    let rest = text.strip_prefix("replay:")?;
    let (file, options) = rest.split_once('?').unwrap_or((rest, ""));
    let pace = match options.split_once('=') {
        None if options.is_empty() => Some(1.0),
        Some(("pace", value)) => value.parse().ok(),
        _ => None,
    };
    let pace = pace.filter(|pace: &f64| pace.is_finite() && *pace >= 0.0);
    Some(match pace {
        Some(pace) => Ok((file.into(), pace)),
        None => Err(format!(
            "{text}: pace is a number such as 1, their own, or 0, as fast as it goes"
        )),
    })
}

/// The sources that are asked for.
pub struct Asked {
    /// Their names.
    pub names: Vec<String>,
    /// The tables of the drive file with the numbers of their sources.
    pub logs: Vec<(String, usize)>,
    /// Whether the drive's own logs are files that can be read; sources and pipes are not to be read before the run.
    pub files_at_hand: bool,
    how: How,
}

enum How {
    Sources(Vec<Source>),
    /// Files, the folder that the drive file's names are relative to, and a pace.
    Replay(Vec<PathBuf>, PathBuf, f64),
}

impl Asked {
    /// The sources of a drive file: those asked for, else what it names. An error is a sentence for the user.
    pub fn new(
        text: &str,
        folder: &Path,
        asked: &[(&str, &str)],
        pace: Option<f64>,
    ) -> Result<Self, String> {
        let named = plan::files(text);
        let mut tables: Vec<&str> = named.iter().map(|(table, _)| *table).collect();
        for (table, _) in asked {
            if !tables.contains(table) {
                return Err(format!(
                    "the drive file has no [{table}], which describes the log of that source"
                ));
            }
        }
        let posed = tables.contains(&"poses");
        for table in ["imu", if posed { "poses" } else { "gnss" }] {
            if !tables.contains(&table) {
                tables.push(table);
            }
        }
        let (mut names, mut logs): (Vec<String>, _) = (Vec::new(), Vec::new());
        for table in tables {
            let file = named
                .iter()
                .find(|(of, _)| *of == table)
                .map(|(_, file)| file);
            let asked = asked
                .iter()
                .find(|(of, _)| *of == table)
                .map(|(_, source)| *source);
            let name = match (asked, file, pace) {
                (Some(source), ..) => source.to_owned(),
                (None, Some(file), Some(pace)) => {
                    format!("replay:{}?pace={pace}", folder.join(file).display())
                }
                (None, Some(file), None) if is_source(file) => file.display().to_string(),
                _ => {
                    return Err(format!(
                        "no source of [{table}]: specify --{table} SOURCE, or --replay 1 for the logs of the drive file"
                    ));
                }
            };
            let number = names
                .iter()
                .position(|other| *other == name)
                .unwrap_or(names.len());
            if number == names.len() {
                names.push(name);
            }
            logs.push((table.to_owned(), number));
        }
        let replays = names
            .iter()
            .filter_map(|name| replayed(name))
            .collect::<Result<Vec<_>, _>>()?;
        let how = match replays.first() {
            Some((_, pace)) if replays.len() == names.len() => {
                let pace = *pace;
                How::Replay(replays.into_iter().map(|(file, _)| file).collect(), folder.to_path_buf(), pace)
            }
            Some(_) => return Err("either all sources are replay:FILE or none is: the times of a log are not those of this machine".into()),
            None => {
                let sources = names.iter().map(|name| name.parse::<Source>().map_err(|error| error.to_string()));
                let sources = sources.collect::<Result<Vec<_>, _>>()?;
                let of_ros = |source: &Source| matches!(source, Source::Ros2(_));
                if ros2::OPEN.is_none() && sources.iter().any(of_ros) {
                    return Err(WITHOUT_ROS2.into());
                }
                How::Sources(sources)
            }
        };
        let files_at_hand = named.iter().all(|(_, file)| folder.join(file).is_file());
        Ok(Self {
            names,
            logs,
            files_at_hand,
            how,
        })
    }

    /// Opens them; the drive file says how logs are read.
    pub fn open(self, text: &str, name: &str) -> Result<Feed> {
        match self.how {
            How::Sources(sources) => Ok(Feed::sources(sources)),
            How::Replay(files, folder, pace) => {
                let named = plan::files(text);
                let bytes = files.iter().map(|file| Ok(source::bytes(file)?.into()));
                let bytes: Vec<Arc<[u8]>> = bytes.collect::<Result<_, ReadError>>()?;
                let mut memory = BTreeMap::new();
                for (table, number) in &self.logs {
                    let file = named.iter().find(|(of, _)| of == table);
                    if let (Some((_, file)), Some(bytes)) = (file, bytes.get(*number)) {
                        memory.insert(folder.join(file), Memory::Bytes(bytes.clone()));
                    }
                }
                let logs = Logs {
                    folder,
                    memory,
                    ..Logs::default()
                };
                let drive = Drive::with_logs(text, name, Path::new(""), logs)?;
                let arrivals = replay::arrivals(&drive, &bytes, &self.logs)?;
                Ok(Feed::paced(arrivals.into_iter().map(Ok), pace))
            }
        }
    }
}

/// Whether a drive file's name of a log is that of a source.
fn is_source(file: &Path) -> bool {
    let text = file.to_string_lossy();
    text == "-"
        || ["serial:", "tcp://", "udp://", "gpsd://", "ros2:", "replay:"]
            .iter()
            .any(|scheme| text.starts_with(scheme))
}

/// What happens next.
pub enum Next {
    Arrival(Arrival),
    /// What the user should know of a source.
    Notice(String),
    Nothing,
    End,
}

/// Gives what arrives.
pub enum Feed {
    Paced(Box<dyn Iterator<Item = Result<Arrival, ReadError>>>),
    Sources(Watched),
}

/// Sources, and when each gave something last.
pub struct Watched {
    sources: Sources,
    names: Vec<Source>,
    heard: Vec<(Instant, bool)>,
}

impl Feed {
    /// Arrivals of a log at a pace.
    pub fn paced(
        arrivals: impl Iterator<Item = Result<Arrival, ReadError>> + 'static,
        pace: f64,
    ) -> Self {
        Self::Paced(Box::new(replay::Paced::new(arrivals, pace)))
    }

    fn sources(names: Vec<Source>) -> Self {
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        Self::Sources(Watched {
            sources: Sources::open(&names, now.as_nanos() as u64, ros2::OPEN),
            heard: vec![(Instant::now(), true); names.len()],
            names,
        })
    }

    /// What happens next, within a tenth of a second.
    pub fn next(&mut self) -> Result<Next> {
        match self {
            Self::Paced(arrivals) => Ok(match arrivals.next().transpose()? {
                Some(arrival) => Next::Arrival(arrival),
                None => Next::End,
            }),
            Self::Sources(watched) => Ok(watched.next()),
        }
    }
}

impl Watched {
    fn name(&self, number: usize) -> String {
        self.names
            .get(number)
            .map(ToString::to_string)
            .unwrap_or_default()
    }

    fn next(&mut self) -> Next {
        let Ok(happened) = self.sources.next(Duration::from_secs_f64(LOOK)) else {
            return Next::End;
        };
        if let Some(Happened::Bytes(arrival)) = happened {
            if let Some(heard) = self.heard.get_mut(arrival.source) {
                let was_heard = heard.1;
                *heard = (Instant::now(), true);
                if !was_heard {
                    // With what comes next.
                    warn(format!("{} gives data again", self.name(arrival.source)));
                }
            }
            return Next::Arrival(arrival);
        }
        match happened {
            Some(Happened::Lost(number, why)) => {
                return Next::Notice(format!("{}: {why}; it is tried again", self.name(number)));
            }
            Some(Happened::Ended(number)) => {
                return Next::Notice(format!("{} has ended", self.name(number)));
            }
            Some(Happened::Open(_) | Happened::Bytes(_)) | None => {}
        }
        let silent =
            |(last, heard): &(Instant, bool)| *heard && last.elapsed().as_secs_f64() > SILENT;
        match self.heard.iter().position(silent) {
            Some(number) => {
                if let Some(heard) = self.heard.get_mut(number) {
                    heard.1 = false;
                }
                Next::Notice(format!(
                    "{} gives nothing for {SILENT:.0} s",
                    self.name(number)
                ))
            }
            None => Next::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[imu]\nfile = \"imu.csv\"\n[gnss]\nfile = \"udp://:5000\"\n[truth]\nfile = \"truth.csv\"\n";

    fn asked(sources: &[(&str, &str)], pace: Option<f64>) -> Result<Asked, String> {
        Asked::new(TEXT, Path::new("logs"), sources, pace)
    }

    #[cfg(not(feature = "ros2"))]
    #[test]
    fn without_its_feature_ros_2_is_refused_at_once() {
        let error = asked(&[("imu", "ros2:/imu")], None).err().unwrap();
        assert!(error.contains("--features ros2"), "{error}");
        let error = "ros2:/undrift".parse::<super::super::outputs::Asked>();
        assert!(error.unwrap_err().to_string().contains("--features ros2"));
    }

    #[test]
    fn each_log_has_a_source() {
        let found = asked(&[("imu", "-")], None).unwrap();
        assert_eq!(found.names, ["-", "udp://:5000"]);
        assert_eq!(found.logs, [("imu".to_owned(), 0), ("gnss".to_owned(), 1)]);
        let found = asked(&[("imu", "udp://:5000")], None).unwrap();
        assert_eq!((found.names.len(), found.logs[1].1), (1, 0));
        let found = asked(&[], Some(20.0)).unwrap();
        assert_eq!(found.names[0], "replay:logs/imu.csv?pace=20");
        for (sources, words) in [
            (
                &[] as &[(&str, &str)],
                "no source of [imu]: specify --imu SOURCE",
            ),
            (&[("imu", "-"), ("odometer", "-")], "has no [odometer]"),
            (
                &[("imu", "replay:imu.csv")],
                "either all sources are replay:FILE",
            ),
            (&[("imu", "replay:imu.csv?speed=2")], "pace is a number"),
            (&[("imu", "tcp://x")], "host:port"),
        ] {
            let error = asked(sources, None).err().unwrap();
            assert!(error.contains(words), "{error}");
        }
    }
}
