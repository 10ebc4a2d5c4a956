//! NovAtel OEM: fixes of BESTPOS, BESTVEL and similar, headings of HEADING2 and similar, raw inertial samples, and the inertial
//! system's own solutions as reference, from ASCII or binary messages, mixed or not.
//!
//! Follows NovAtel's documentation of OEM7 and OEM6. Messages with the same time make one fix; what is
//! between the messages is passed over. Times are GPS seconds of the week in which the file starts.
//! CORRIMUDATA and similar are not read as inertial samples: the receiver has taken gravity and the Earth's rate
//! out of them.

mod fields;
mod fixes;
mod frames;
mod imu;
mod messages;

use super::frames::any;
use super::receiver::{Ready, by_messages, check, check_name};
use crate::entry::{Entries, Heading, ImuReading, Stream, Wanted, What};
use crate::epoch::ClockSource;
use crate::skipped::SkipKind;
use crate::source::Source;
use crate::time::WeekClock;
use crate::{Key, ReadError};
use fields::Fields;
use fixes::Fixes;
use frames::{Head, LAYOUT};
use imu::{Rates, Raw, Type};
use messages::{Content, Known};

/// What separates a raw stream from the type of its IMU in a name, as `RAWIMUS:ADIS16488`.
const OF_TYPE: char = ':';
const POSES: [Content; 2] = [Content::Solution, Content::Extended];

/// Whether the first bytes of a file hold a message that is read here.
pub(crate) fn detect(start: &[u8]) -> bool {
    any(start, &LAYOUT, |Head { kind, .. }| {
        messages::find(kind).is_some_and(|known| known.content != Content::Other)
    })
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    let (wanted, of_type) = with_type(wanted)?;
    let raw = messages::names(&[Content::Raw, Content::RawExtended]);
    let solutions = messages::names(&POSES);
    let mut positions = messages::names(&[Content::Position]);
    positions.extend(&solutions);
    let mut velocities = messages::names(&[Content::Velocity]);
    velocities.extend(&solutions);
    check(&wanted, "a NovAtel log", [&raw, &positions, &velocities])?;
    if let Wanted::Headings(name) = &wanted {
        let known = messages::names(&[Content::Heading]);
        check_name(name, "a NovAtel log", &known, "stream of headings")?;
    }
    let reader = Reader {
        weeks: WeekClock::default(),
        purpose: purpose(&wanted, of_type),
    };
    Ok(by_messages(
        &wanted,
        source,
        &LAYOUT,
        reader,
        Reader::message,
        Reader::end,
        |reader| reader.weeks.epoch(ClockSource::Gnss),
    ))
}

/// What is wanted, with the type of the IMU taken from the stream's name.
fn with_type(wanted: &Wanted) -> Result<(Wanted, Option<&'static Type>), ReadError> {
    let Wanted::Imu(Some(topic)) = wanted else {
        return Ok((wanted.clone(), None));
    };
    let Some((name, of_type)) = topic.split_once(OF_TYPE) else {
        return Ok((wanted.clone(), None));
    };
    let Some(known) = imu::by_name(of_type) else {
        let names: Vec<&str> = imu::TYPES.iter().map(|known| known.name).collect();
        let problem = format!("no IMU type \"{of_type}\" whose scale factors are public");
        let error = ReadError::nameless(problem).key(Key::Topic("imu"));
        return Err(error.mend(format!("known types: {}", names.join(", "))));
    };
    Ok((Wanted::Imu(Some(name.to_owned())), Some(known)))
}

fn purpose(wanted: &Wanted, of_type: Option<&'static Type>) -> Purpose {
    let pick = |names: Vec<&'static str>, asked: &Option<String>| Pick {
        asked: asked.clone(),
        names,
        best: usize::MAX,
    };
    let is_solution = |name: &Option<String>| {
        let known = messages::names(&POSES);
        name.as_deref().is_some_and(|name| known.contains(&name))
    };
    match wanted {
        Wanted::Imu(name) => Purpose::Imu(Box::new(Imu {
            only: Only {
                what: "streams of raw inertial messages",
                table: "imu",
                asked: name.clone(),
                found: None,
            },
            of_type,
            stated: of_type.is_some(),
            untyped: None,
            given: false,
            rates: Rates::default(),
        })),
        Wanted::Headings(name) => Purpose::Headings(Only {
            what: "streams of headings",
            table: "heading",
            asked: name.clone(),
            found: None,
        }),
        Wanted::Poses(name) if name.is_none() || is_solution(name) => Purpose::Poses(
            Only {
                what: "solutions",
                table: "truth",
                asked: name.clone(),
                found: None,
            },
            None,
        ),
        Wanted::Poses(name) | Wanted::LocalPoses(name) | Wanted::Fields(name) => {
            Purpose::Fixes(Box::new(Receiver {
                position: pick(messages::names(&[Content::Position]), name),
                velocity: pick(messages::names(&[Content::Velocity]), &None),
                solution: None,
                fixes: Fixes::default(),
            }))
        }
        Wanted::Fixes {
            position, velocity, ..
        } => Purpose::Fixes(Box::new(Receiver {
            position: pick(messages::names(&[Content::Position]), position),
            velocity: pick(messages::names(&[Content::Velocity]), velocity),
            solution: position.clone().filter(|_| is_solution(position)),
            fixes: Fixes::default(),
        })),
    }
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let described = |head: &Head| (messages::name(&head.kind), messages::described(&head.kind));
    let name = |head: &Head| messages::name(&head.kind);
    Ok(super::frames::streams(source, &LAYOUT, name, described))
}

struct Reader {
    weeks: WeekClock,
    purpose: Purpose,
}

/// What is made of the messages.
enum Purpose {
    Imu(Box<Imu>),
    /// Solutions, and the first message of positions that could serve in their place.
    Poses(Only, Option<&'static str>),
    Fixes(Box<Receiver>),
    Headings(Only),
}

/// The only stream of its kind, or the one that is asked for.
struct Only {
    what: &'static str,
    table: &'static str,
    asked: Option<String>,
    found: Option<&'static str>,
}

impl Only {
    /// Whether messages with this name are meant.
    fn is(&mut self, name: &'static str) -> Result<bool, ReadError> {
        if let Some(asked) = &self.asked {
            return Ok(asked == name);
        }
        let found = *self.found.get_or_insert(name);
        if found == name {
            return Ok(true);
        }
        let problem = format!("two {}: {found} and {name}", self.what);
        Err(ReadError::nameless(problem)
            .key(Key::Topic(self.table))
            .mend("choose one with topic"))
    }
}

/// The message that is asked for, or the best that has been there so far.
struct Pick {
    asked: Option<String>,
    names: Vec<&'static str>,
    best: usize,
}

impl Pick {
    fn is(&mut self, name: &str) -> bool {
        if let Some(asked) = &self.asked {
            return asked == name;
        }
        let rank = self.names.iter().position(|known| *known == name);
        let is = rank.is_some_and(|rank| rank <= self.best);
        if is {
            self.best = rank.unwrap_or(self.best);
        }
        is
    }
}

/// What is made of positions and velocities.
struct Receiver {
    position: Pick,
    velocity: Pick,
    /// A solution of the inertial system that is asked for in their place.
    solution: Option<String>,
    fixes: Fixes,
}

struct Imu {
    only: Only,
    of_type: Option<&'static Type>,
    /// Whether the user states the type.
    stated: bool,
    /// The first message whose type was unknown.
    untyped: Option<u64>,
    given: bool,
    rates: Rates,
}

impl Reader {
    fn end(&mut self, ready: &mut Ready) -> Result<(), ReadError> {
        match &mut self.purpose {
            Purpose::Imu(imu) => imu.end()?,
            Purpose::Poses(
                Only {
                    asked: None,
                    found: None,
                    ..
                },
                Some(name),
            ) => {
                let problem = "no INSPVA, INSPVAS or INSPVAX in this log";
                let mend =
                    format!("topic = \"{name}\" takes the receiver's positions, without attitude");
                return Err(ReadError::nameless(problem)
                    .key(Key::Topic("truth"))
                    .mend(mend));
            }
            Purpose::Poses(..) | Purpose::Headings(_) => {}
            Purpose::Fixes(receiver) => receiver.fixes.end(ready),
        }
        Ok(())
    }

    fn message(
        &mut self,
        at: u64,
        head: Head,
        body: &[u8],
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        let Some(known) = messages::find(&head.kind) else {
            return Ok(());
        };
        let fields = Fields::new(body, head.text);
        let weeks = &mut self.weeks;
        let mut time = |of_body: Option<(f64, f64)>| {
            let of_head = (f64::from(head.week), f64::from(head.milli) * 1e-3);
            let (week, seconds) = of_body.unwrap_or(of_head);
            let plausible = (1.0..65536.0).contains(&week) && (0.0..1e6).contains(&seconds);
            plausible.then(|| weeks.gps(week as i64 * 7, seconds))
        };
        let read = match &mut self.purpose {
            Purpose::Imu(imu) => imu.message(at, known, fields, &mut time, ready)?,
            Purpose::Fixes(receiver) => receiver.message(at, known, fields, &mut time, ready),
            Purpose::Headings(only) => {
                if known.content != Content::Heading || !only.is(known.name)? {
                    return Ok(());
                }
                messages::heading(fields).map(|heading| {
                    let heading = heading.and_then(|heading| Some((time(None)?, heading)));
                    heading.map(|(time, heading)| {
                        ready.push(at, What::Heading(Heading { time, ..heading }));
                    })
                })
            }
            Purpose::Poses(only, positions) => {
                if known.content == Content::Position {
                    positions.get_or_insert(known.name);
                }
                if !POSES.contains(&known.content) || !only.is(known.name)? {
                    return Ok(());
                }
                let solution = match known.content {
                    Content::Solution => messages::solution(fields),
                    _ => messages::extended(fields),
                };
                solution.map(|solution| {
                    let solution = solution.and_then(|found| Some((time(found.time)?, found)));
                    solution.map(|(time, found)| {
                        let mut pose = found.pose;
                        pose.time = time;
                        ready.push(at, What::Pose(pose));
                    })
                })
            }
        };
        match read {
            Some(Some(())) => {}
            Some(None) => ready.skip(at, SkipKind::NoFix, known.name),
            None => ready.skip(at, SkipKind::MissingField, known.name),
        }
        Ok(())
    }
}

/// Whether a message could be read, and whether it had something.
type Had = Option<Option<()>>;
/// The time of a message by a week and second of its body, else of its header \[s\]; `None` before the
/// receiver knows it.
type TimeOf<'a> = &'a mut dyn FnMut(Option<(f64, f64)>) -> Option<f64>;

impl Receiver {
    fn message(
        &mut self,
        at: u64,
        known: &Known,
        fields: Fields,
        time: TimeOf,
        ready: &mut Ready,
    ) -> Had {
        let fixes = &mut self.fixes;
        match known.content {
            Content::Position if self.position.is(known.name) => {
                let place = messages::place(fields)?;
                Some(place.and_then(|place| {
                    fixes.position(at, time(None)?, &place, ready);
                    Some(())
                }))
            }
            Content::Velocity if self.solution.is_none() && self.velocity.is(known.name) => {
                let motion = messages::motion(fields)?;
                Some(motion.and_then(|motion| {
                    fixes.velocity(at, time(None)?, &motion, ready);
                    Some(())
                }))
            }
            Content::Solution | Content::Extended
                if self.solution.as_deref() == Some(known.name) =>
            {
                let solution = match known.content {
                    Content::Solution => messages::solution(fields),
                    _ => messages::extended(fields),
                }?;
                Some(solution.and_then(|solution| {
                    fixes.both(at, time(solution.time)?, &solution, ready);
                    Some(())
                }))
            }
            _ => Some(Some(())),
        }
    }
}

impl Imu {
    fn message(
        &mut self,
        at: u64,
        known: &Known,
        mut fields: Fields,
        time: TimeOf,
        ready: &mut Ready,
    ) -> Result<Had, ReadError> {
        if known.content == Content::Setup && !self.stated {
            let names: Vec<(u32, &str)> = imu::TYPES.iter().map(|of| (of.code, of.name)).collect();
            let code = fields.code(&names).flatten();
            self.of_type = code.and_then(imu::by_code).or(self.of_type);
        }
        if !matches!(known.content, Content::Raw | Content::RawExtended)
            || !self.only.is(known.name)?
        {
            return Ok(Some(Some(())));
        }
        let Some(raw) = Raw::read(fields, known.content == Content::RawExtended) else {
            return Ok(None);
        };
        let of_type = match raw.code {
            Some(code) if !self.stated => Some(imu::by_code(code).ok_or_else(|| {
                let problem = format!("IMU of type {code}: unknown scale factors");
                ReadError::nameless(problem)
                    .at(at)
                    .key(Key::Topic("imu"))
                    .mend(format!(
                        "if its counts are those of a known type, set topic = \"{}{OF_TYPE}{}\"",
                        known.name,
                        imu::TYPES[0].name
                    ))
            })?),
            _ => self.of_type,
        };
        if raw.fault {
            ready.skip(
                at,
                SkipKind::Damaged,
                "the receiver reports a fault of the IMU",
            );
            return Ok(Some(Some(())));
        }
        let Some(of_type) = of_type else {
            self.untyped.get_or_insert(at);
            ready.skip(
                at,
                SkipKind::MissingField,
                "the type of the IMU is not known yet",
            );
            return Ok(Some(Some(())));
        };
        let Some(time) = time(Some((raw.week, raw.seconds))) else {
            return Ok(Some(None));
        };
        self.given = true;
        self.rates
            .add(at, time, &raw, of_type, |at, time, gyro, accel| {
                ready.push(at, What::Imu(ImuReading::new(time, gyro, accel)));
            });
        Ok(Some(Some(())))
    }

    /// Fails where samples came and their type never became known.
    fn end(&self) -> Result<(), ReadError> {
        match (self.untyped, self.given) {
            (Some(at), false) => Err(ReadError::nameless(
                "the log does not have the type of the IMU, so its scale factors are unknown",
            )
            .at(at)
            .key(Key::Topic("imu"))
            .mend("log RAWIMUSX or INSCONFIG, or set the type: topic = \"RAWIMUS:ADIS16488\"")),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
