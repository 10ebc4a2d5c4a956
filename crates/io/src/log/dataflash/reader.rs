//! Reads one stream of a DataFlash log.

use std::collections::VecDeque;

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};

use super::formats::{MessageKind, Values, time};
use super::link::Link;
use super::messages::{Messages, Next};
use crate::entry::{FieldReading, Fix, ImuReading, What};
use crate::epoch::{ClockSource, Epoch};
use crate::fix::{finite, independent, on_earth};
use crate::log::receiver::Ready;
use crate::skipped::{SkipKind, Unfit};
use crate::time::WeekClock;

/// What ArduPilot logs of compasses \[T\].
const MILLIGAUSS: f64 = 1e-7;
/// Gyro samples that wait for an accelerometer sample at most.
const WAITING: usize = 4096;

/// The entries of one stream.
pub(super) struct Reader {
    messages: Messages,
    kind: MessageKind,
    instance: u8,
    weeks: WeekClock,
    link: Option<Link>,
    /// The fix that waits for its accuracies: number of its message and fields.
    fix: Option<(u64, Values)>,
    /// Gyro samples that wait for the accelerometer: number, time \[s\], rate.
    gyro: VecDeque<(u64, f64, Vector3)>,
    /// Time \[s\] and specific force of the last accelerometer sample.
    accel: Option<(f64, Vector3)>,
}

impl Reader {
    pub(super) fn new(
        messages: Messages,
        kind: MessageKind,
        instance: u8,
        (weeks, link): (WeekClock, Option<Link>),
    ) -> Self {
        Self {
            messages,
            kind,
            instance,
            weeks,
            link,
            fix: None,
            gyro: VecDeque::new(),
            accel: None,
        }
    }

    /// Reads the next message; false at the end.
    pub(super) fn step(&mut self, ready: &mut Ready) -> bool {
        let next = self.messages.next();
        let at = self.messages.number().max(1);
        match next {
            Next::Message(kind, instance, values) if instance == self.instance => {
                match (self.kind, kind) {
                    (MessageKind::Imu, MessageKind::Imu) => {
                        let reading = self.reading(&values);
                        ready.push(at, What::from_read(reading.map(What::Imu)));
                    }
                    (MessageKind::Mag, MessageKind::Mag) => {
                        let reading = self.field(&values);
                        ready.push(at, What::from_read(reading.map(What::Field)));
                    }
                    (MessageKind::Gyro, MessageKind::Gyro) => self.add_gyro(at, &values, ready),
                    (MessageKind::Gyro, MessageKind::Accel) => self.add_accel(at, &values, ready),
                    (MessageKind::Gps, MessageKind::Gps) => {
                        self.end_fix(None, ready);
                        self.fix = Some((at, values));
                    }
                    (MessageKind::Gps, MessageKind::Accuracy) => self.end_fix(Some(&values), ready),
                    _ => {}
                }
            }
            Next::Message(..) | Next::Other(_) => {}
            Next::Damaged(detail) => ready.skip(at, SkipKind::Damaged, detail),
            Next::End(why) => {
                self.end_fix(None, ready);
                for (at, ..) in self.gyro.drain(..) {
                    ready.skip(at, SkipKind::MissingField, "no accelerometer sample");
                }
                ready.ends_early(at, why);
                return false;
            }
        }
        true
    }

    /// What the times count from, where there are fixes.
    pub(super) fn epoch(&self) -> Option<Epoch> {
        let is_gps = self.kind == MessageKind::Gps || self.link.is_some();
        self.weeks.epoch(ClockSource::Gnss).filter(|_| is_gps)
    }

    /// GPS time of the autopilot's, or that itself \[s\].
    fn time(&self, own: f64) -> f64 {
        self.link.map_or(own, |link| link.gps(own))
    }

    fn reading(&self, values: &Values) -> Result<ImuReading, Unfit> {
        let [_, _, _, gx, gy, gz, ax, ay, az, temperature_c, ..] = *values;
        if time(values).is_nan() {
            return Err((SkipKind::MissingField, "no TimeUS".to_owned()));
        }
        Ok(ImuReading {
            time: self.time(time(values)),
            gyro: finite(Vector3::new(gx, gy, gz))?,
            accel: finite(Vector3::new(ax, ay, az))?,
            temperature_c,
        })
    }

    fn field(&self, values: &Values) -> Result<FieldReading, Unfit> {
        let [_, _, _, x, y, z, ..] = *values;
        if time(values).is_nan() {
            return Err((SkipKind::MissingField, "no TimeUS".to_owned()));
        }
        Ok(FieldReading {
            time: self.time(time(values)),
            field: finite(Vector3::new(x, y, z))? * MILLIGAUSS,
        })
    }

    fn add_gyro(&mut self, at: u64, values: &Values, ready: &mut Ready) {
        let Some((time, rate)) = ready.usable(at, sample(values)) else {
            return;
        };
        // Here already if the accelerometer's is logged first.
        if let Some((_, force)) = self.accel.filter(|(there, _)| *there == time) {
            self.give(at, time, rate, force, ready);
            return;
        }
        self.gyro.push_back((at, time, rate));
        if self.gyro.len() > WAITING
            && let Some((at, ..)) = self.gyro.pop_front()
        {
            ready.skip(at, SkipKind::MissingField, "no accelerometer sample");
        }
    }

    /// Gives the gyro samples up to an accelerometer sample, with specific forces on the line from the one before.
    fn add_accel(&mut self, at: u64, values: &Values, ready: &mut Ready) {
        let Some((to, force)) = ready.usable(at, sample(values)) else {
            return;
        };
        let before = self.accel.replace((to, force));
        while let Some(&(at, time, rate)) = self.gyro.front().filter(|gyro| gyro.1 <= to) {
            self.gyro.pop_front();
            match before {
                Some((from, before)) if from <= time && from < to => {
                    let part = (time - from) / (to - from);
                    let force = before + (force - before) * part;
                    self.give(at, time, rate, force, ready);
                }
                _ if time == to => self.give(at, time, rate, force, ready),
                _ => ready.skip(at, SkipKind::MissingField, "no accelerometer sample"),
            }
        }
    }

    fn give(&self, at: u64, time: f64, gyro: Vector3, accel: Vector3, ready: &mut Ready) {
        let time = self.time(time);
        ready.push(at, What::Imu(ImuReading::new(time, gyro, accel)));
    }

    /// Makes a fix of the message that waits, with the accuracies if they are of it.
    fn end_fix(&mut self, accuracy: Option<&Values>, ready: &mut Ready) {
        let Some((at, values)) = self.fix.take() else {
            return;
        };
        let accuracy = accuracy.filter(|accuracy| time(accuracy) == time(&values));
        let fix = fix(&values, accuracy, &mut self.weeks);
        if let Some(fix) = ready.usable(at, fix) {
            ready.fix(at, fix);
        }
    }
}

/// Time at which a raw sample was taken \[s\], and its three values.
fn sample(values: &Values) -> Result<(f64, Vector3), Unfit> {
    let [_, _, _, x, y, z, sampled, ..] = *values;
    if sampled.is_nan() {
        return Err((SkipKind::MissingField, "no SampleUS".to_owned()));
    }
    Ok((sampled / 1e6, finite(Vector3::new(x, y, z))?))
}

/// GPS time of a fix \[s\]; `None` without a fix, or where the receiver does not know the time.
pub(super) fn fix_time(values: &Values, weeks: &mut WeekClock) -> Option<f64> {
    let [_, _, _, status, millis, week, old_millis, old_week, ..] = *values;
    let or = |value: f64, old: f64| if value.is_nan() { old } else { value };
    let (millis, week) = (or(millis, old_millis), or(week, old_week));
    // Receivers that do not know the week say 0 or one of decades ago.
    let known = (1000.0..10_000.0).contains(&week) && (0.0..604_800_000.0).contains(&millis);
    (status >= 3.0 && known).then(|| weeks.gps(week as i64 * 7, millis / 1e3))
}

fn fix(values: &Values, accuracy: Option<&Values>, weeks: &mut WeekClock) -> Result<Fix, Unfit> {
    let [
        _,
        _,
        _,
        status,
        _,
        week,
        _,
        old_week,
        lat,
        lon,
        height,
        speed,
        course,
        down,
    ] = *values;
    let quality = match status {
        3.0 => FixQuality::Single,
        4.0 => FixQuality::Differential,
        5.0 => FixQuality::Float,
        6.0 => FixQuality::Fixed,
        _ => return Err((SkipKind::NoFix, format!("status {status}"))),
    };
    let time = fix_time(values, weeks).ok_or_else(|| {
        let week = if week.is_nan() { old_week } else { week };
        (SkipKind::OutOfRange, format!("a fix of GPS week {week}"))
    })?;
    let [h_acc, v_acc, s_acc, vertical, undulation] = match accuracy {
        Some([_, _, _, h, v, s, vertical, undulation, ..]) => [*h, *v, *s, *vertical, *undulation],
        None => [f64::NAN; 5],
    };
    let undulation = if undulation.is_finite() {
        undulation
    } else {
        0.0
    };
    let place = finite(Vector3::new(lat, lon, height))?;
    let place = on_earth(Geodetic::from_degrees(lat, lon, place.z - undulation))?;
    let (sin, cos) = course.to_radians().sin_cos();
    let velocity = finite(Vector3::new(speed * cos, speed * sin, down)).ok();
    // 0: the receiver gives none downwards.
    let velocity = velocity.filter(|_| vertical != 0.0);
    Ok(Fix {
        mean_velocity: None,
        time,
        position: Some((
            Position::Geodetic(place),
            independent(&Vector3::new(h_acc, h_acc, v_acc)),
        )),
        velocity: velocity.map(|velocity| (velocity, independent(&Vector3::repeat(s_acc)))),
        quality,
    })
}
