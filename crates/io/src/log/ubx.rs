//! u-blox UBX: fixes of the navigation messages, headings of a moving base, inertial samples of a receiver with sensors.
//!
//! By the interface descriptions of the receivers (u-blox M8: UBX-13003221; F9: UBX-22008968 and
//! its like). The messages with the same time of week make one fix ([`epoch`]); what is between the
//! messages, NMEA or anything else, is passed over. Times are GPS seconds of the week in which the
//! file starts; those of the inertial samples are made of the sensors' own counter ([`clock`]).

mod bytes;
mod carrier;
mod clock;
mod epoch;
mod frames;
mod imu;

use undrift_nav::sample::FixQuality;

use super::frames::any;
use super::receiver::{Ready, by_messages, check, check_name};
use crate::ReadError;
use crate::entry::{Entries, Fix, Heading, ImuReading, Stream, StreamKind, Wanted, What};
use crate::skipped::SkipKind;
use crate::source::Source;
use carrier::Carrier;
use clock::SensorClock;
use epoch::{Epoch, HEADINGS, POSITIONS, VELOCITIES, Weeks};
use frames::LAYOUT;
use imu::{Sample, Sensors};

/// End of a navigation epoch.
const NAV_EOE: [u8; 2] = [0x01, 0x61];
/// Streams of inertial samples.
const INERTIAL: [&str; 2] = ["ESF-RAW", "ESF-MEAS"];

/// Messages that logs often have.
const NAMES: [([u8; 2], &str); 22] = [
    (epoch::PVT, "NAV-PVT"),
    (epoch::HPPOSLLH, "NAV-HPPOSLLH"),
    (epoch::POSLLH, "NAV-POSLLH"),
    (epoch::VELNED, "NAV-VELNED"),
    (epoch::COV, "NAV-COV"),
    (epoch::STATUS, "NAV-STATUS"),
    (epoch::SOL, "NAV-SOL"),
    (imu::RAW, "ESF-RAW"),
    (imu::MEAS, "ESF-MEAS"),
    (NAV_EOE, "NAV-EOE"),
    ([0x01, 0x04], "NAV-DOP"),
    ([0x01, 0x05], "NAV-ATT"),
    (epoch::TIMEGPS, "NAV-TIMEGPS"),
    ([0x01, 0x21], "NAV-TIMEUTC"),
    ([0x01, 0x35], "NAV-SAT"),
    (epoch::RELPOSNED, "NAV-RELPOSNED"),
    ([0x01, 0x43], "NAV-SIG"),
    (carrier::SFRBX, "RXM-SFRBX"),
    (carrier::RAWX, carrier::NAME),
    ([0x10, 0x10], "ESF-STATUS"),
    ([0x10, 0x14], "ESF-ALG"),
    ([0x10, 0x15], "ESF-INS"),
];

/// Whether the first bytes of a file hold a UBX message. Ask first for formats that begin with
/// bytes of their own, since a recording may hold UBX messages, and for NMEA, which may have some
/// in between.
pub(crate) fn detect(start: &[u8]) -> bool {
    any(start, &LAYOUT, |_| true)
}

/// Whether the first bytes of a file hold a UBX message that is read here; a log of NMEA may have
/// others in between, answers to commands.
pub(super) fn has_data(start: &[u8]) -> bool {
    any(start, &LAYOUT, |&kind| {
        imu_stream(kind).is_some() || matches!(kind, epoch::PVT | epoch::HPPOSLLH | epoch::POSLLH)
    })
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    let velocities = [&VELOCITIES[..], &[carrier::NAME]].concat();
    check(wanted, "UBX", [&INERTIAL, &POSITIONS, &velocities])?;
    if let Wanted::Headings(name) = wanted {
        check_name(name, "UBX", &HEADINGS, "stream of headings")?;
    }
    let purpose = match wanted.clone() {
        Wanted::Imu(name) => Purpose::Imu(Box::new(Imu {
            stream: INERTIAL
                .into_iter()
                .find(|known| name.as_deref() == Some(known)),
            named: name.is_some(),
            sensors: Sensors::default(),
            clock: SensorClock::default(),
        })),
        Wanted::Fixes {
            position, velocity, ..
        } => {
            // The receiver's own velocity is at an instant: it stays beside the carrier's.
            let by_carrier = velocity.as_deref() == Some(carrier::NAME);
            let velocity = velocity.filter(|_| !by_carrier);
            Purpose::Fixes([position, velocity], by_carrier.then(Box::default))
        }
        Wanted::Poses(name) | Wanted::LocalPoses(name) | Wanted::Fields(name) => {
            Purpose::Fixes([name, None], None)
        }
        Wanted::Headings(_) => Purpose::Headings,
    };
    let reader = Reader {
        weeks: Weeks::default(),
        epoch: None,
        purpose,
    };
    Ok(by_messages(
        wanted,
        source,
        &LAYOUT,
        reader,
        Reader::message,
        Reader::end,
        |reader| reader.weeks.epoch(),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let described = |kind: &[u8; 2]| (name(*kind), described(&name(*kind)));
    Ok(super::frames::streams(
        source,
        &LAYOUT,
        |kind| *kind,
        described,
    ))
}

/// What messages hold, by their name.
fn described(name: &str) -> (StreamKind, &'static str) {
    match name {
        "ESF-RAW" | "ESF-MEAS" => (
            StreamKind::Imu,
            "rates and specific forces of the receiver's sensors",
        ),
        "NAV-PVT" => (StreamKind::Fixes, "position and velocity"),
        "NAV-HPPOSLLH" | "NAV-POSLLH" => (StreamKind::Fixes, "position"),
        "NAV-VELNED" => (StreamKind::Velocity, "velocity"),
        "NAV-RELPOSNED" => (
            StreamKind::Headings,
            "second antenna as seen from the first",
        ),
        carrier::NAME => (
            StreamKind::Observations,
            "code, carrier phase and Doppler shift of each satellite",
        ),
        "RXM-SFRBX" => (StreamKind::Other, "messages of the satellites"),
        "NAV-COV" => (StreamKind::Other, "covariances of position and velocity"),
        _ => (StreamKind::Other, ""),
    }
}

fn name(kind: [u8; 2]) -> String {
    let known = NAMES.iter().find(|(known, _)| *known == kind);
    let [class, id] = kind;
    known.map_or_else(
        || format!("UBX-{class:02X}-{id:02X}"),
        |(_, name)| (*name).to_owned(),
    )
}

struct Reader {
    weeks: Weeks,
    epoch: Option<Epoch>,
    purpose: Purpose,
}

/// What is made of the messages.
enum Purpose {
    Imu(Box<Imu>),
    /// Fixes by the messages with these names of positions and velocities, with mean velocities by the carrier.
    Fixes([Option<String>; 2], Option<Box<Carrier>>),
    Headings,
}

struct Imu {
    /// The messages that the samples are taken from, as soon as that is known.
    stream: Option<&'static str>,
    named: bool,
    sensors: Sensors,
    clock: SensorClock,
}

impl Reader {
    fn end(&mut self, ready: &mut Ready) -> Result<(), ReadError> {
        self.end_epoch(ready)?;
        if let Purpose::Imu(imu) = &mut self.purpose {
            imu.clock.end(&mut give(ready));
        }
        Ok(())
    }

    fn message(
        &mut self,
        at: u64,
        kind: [u8; 2],
        payload: &[u8],
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        if let Purpose::Fixes(_, Some(carrier)) = &mut self.purpose
            && carrier.message(kind, payload).is_none()
        {
            too_short(at, kind, payload, ready);
            return Ok(());
        }
        let tow = epoch::time_of_week(kind, payload);
        let tow =
            tow.filter(|_| kind != epoch::RELPOSNED || matches!(self.purpose, Purpose::Headings));
        let current = self.epoch.as_ref().map(|epoch| epoch.time_of_week);
        if kind == NAV_EOE || (tow.is_some() && tow != current) {
            self.end_epoch(ready)?;
        }
        let imu = match &mut self.purpose {
            Purpose::Imu(imu) => Some(imu),
            Purpose::Fixes(..) | Purpose::Headings => None,
        };
        if let (Some(stream), Some(imu)) = (imu_stream(kind), imu) {
            return imu.message(at, stream, kind, payload, ready);
        }
        let Some(tow) = tow else { return Ok(()) };
        let epoch = self.epoch.get_or_insert_with(|| Epoch::new(at, tow));
        let whole = epoch.add(kind, payload).is_some();
        match &self.purpose {
            Purpose::Imu(imu) => {
                epoch.counter = epoch.counter.or(imu.sensors.counter());
                let startup = epoch::startup(kind, payload);
                epoch.exact = startup
                    .and_then(|startup| imu.sensors.at_startup(startup))
                    .or(epoch.exact);
            }
            Purpose::Fixes(..) | Purpose::Headings if !whole => too_short(at, kind, payload, ready),
            Purpose::Fixes(..) | Purpose::Headings => {}
        }
        Ok(())
    }

    /// Makes of the epoch's messages what is wanted.
    fn end_epoch(&mut self, ready: &mut Ready) -> Result<(), ReadError> {
        let Some(epoch) = self.epoch.take() else {
            return Ok(());
        };
        let dated = epoch.has_fix() || epoch.heading.is_some();
        let time = dated.then(|| self.weeks.seconds(&epoch));
        match (&mut self.purpose, time) {
            (Purpose::Imu(imu), Some(time)) => imu.tie(&epoch, time, ready)?,
            (Purpose::Fixes(names, carrier), Some(time)) => {
                if let Some(mut fix) = epoch.fix(time, names, ready) {
                    let carrier = carrier.as_mut();
                    fix.mean_velocity = carrier.and_then(|carrier| carrier.mean_velocity(&fix));
                    ready.fix(epoch.at, fix);
                }
            }
            (Purpose::Headings, Some(time)) => match epoch.heading {
                Some(Some(heading)) => {
                    ready.push(epoch.at, What::Heading(Heading { time, ..heading }))
                }
                Some(None) => ready.skip(epoch.at, SkipKind::NoFix, HEADINGS[0]),
                None => {}
            },
            (Purpose::Headings, None) => {}
            (Purpose::Fixes(_, carrier), None) => {
                epoch.skip(ready);
                if let Some(carrier) = carrier
                    && epoch.lacks_fix()
                {
                    let mut fix = Fix {
                        time: self.weeks.seconds(&epoch),
                        position: None,
                        velocity: None,
                        mean_velocity: None,
                        quality: FixQuality::Unknown,
                    };
                    fix.mean_velocity = carrier.mean_velocity(&fix);
                    if fix.mean_velocity.is_some() {
                        ready.fix(epoch.at, fix);
                    }
                }
            }
            (Purpose::Imu(_), None) => {}
        }
        Ok(())
    }
}

impl Imu {
    fn message(
        &mut self,
        at: u64,
        stream: &'static str,
        kind: [u8; 2],
        payload: &[u8],
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        if !imu::has_inertial(kind, payload) {
            return Ok(());
        }
        let chosen = *self.stream.get_or_insert(stream);
        if chosen != stream {
            if self.named {
                return Ok(());
            }
            let problem = format!("two streams of inertial samples: {}", INERTIAL.join(", "));
            return Err(ReadError::nameless(problem).mend("choose one with topic"));
        }
        if self.sensors.changes(kind, payload) {
            for _ in 0..self.clock.restart() {
                let detail = "samples before their time tags were calibrated";
                ready.skip(at, SkipKind::MissingField, detail);
            }
        }
        let clock = &mut self.clock;
        let dropped = self.sensors.message(at, kind, payload, |counter, reading| {
            clock.sample(counter, reading, &mut give(ready));
        });
        for _ in 0..dropped {
            ready.skip(at, SkipKind::MissingField, "a sample without all six axes");
        }
        Ok(())
    }

    fn tie(&mut self, epoch: &Epoch, time: f64, ready: &mut Ready) -> Result<(), ReadError> {
        let exact = epoch.exact.is_some();
        let Some(counter) = epoch.exact.or(epoch.counter) else {
            return Ok(());
        };
        let tied = self.clock.tie(counter, time, exact, &mut give(ready));
        tied.map_err(|clock::TooLate| {
            ReadError::nameless("the first fix comes after ten minutes of inertial samples")
                .at(epoch.at)
                .mend("remove the samples before it: their GPS time is unknown")
        })
    }
}

/// Counts a message that is too short for what it holds.
fn too_short(at: u64, kind: [u8; 2], payload: &[u8], ready: &mut Ready) {
    let detail = format!("{} of {} bytes", name(kind), payload.len());
    ready.skip(at, SkipKind::MissingField, detail);
}

fn imu_stream(kind: [u8; 2]) -> Option<&'static str> {
    match kind {
        imu::RAW => Some("ESF-RAW"),
        imu::MEAS => Some("ESF-MEAS"),
        _ => None,
    }
}

/// Puts samples among what is ready.
fn give(ready: &mut Ready) -> impl FnMut(f64, Sample) + '_ {
    |time, reading| {
        let Sample { at, gyro, accel } = reading;
        ready.push(at, What::Imu(ImuReading::new(time, gyro, accel)));
    }
}

#[cfg(test)]
mod tests;
