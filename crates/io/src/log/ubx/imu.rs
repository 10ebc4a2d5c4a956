//! Inertial samples of ESF-RAW and ESF-MEAS.
//!
//! A measurement is a word: 24 bits of a signed number, above them 6 bits that say of what (the
//! interface descriptions' table of ESF measurement data): rates in 2⁻¹² °/s, specific forces in
//! 2⁻¹⁰ m/s². ESF-RAW has a time tag with each measurement, of a counter of nominally 39.0625 µs
//! with 24 bits; ESF-MEAS has one for all, in milliseconds with 32 bits, and may have the
//! receiver's milliseconds since startup behind the measurements.

use undrift_nav::Vector3;

use super::bytes::{u2, u4};

pub(super) const RAW: [u8; 2] = [0x10, 0x03];
pub(super) const MEAS: [u8; 2] = [0x10, 0x02];

/// What a tag of ESF-RAW counts \[s\], nominally.
const RAW_TICK: f64 = 39.0625e-6;
/// What a tag of ESF-MEAS counts \[s\].
const MEAS_TICK: f64 = 1e-3;
/// Rates and specific forces of one sample may be tagged this far apart \[s\]: in ESF-MEAS they come
/// in two messages, some 5 ms apart at 10 Hz.
const APART: f64 = 10e-3;

/// A sample without its time.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Number of the message.
    pub(super) at: u64,
    /// Angular rate [rad/s].
    pub(super) gyro: Vector3,
    /// Specific force [m/s²].
    pub(super) accel: Vector3,
}

/// The parts of a triad that have come, and their counter \[s\].
#[derive(Default)]
struct Triad {
    counter: f64,
    axes: [Option<f64>; 3],
}

impl Triad {
    /// Takes in an axis; whether parts of another sample had to be dropped for it.
    fn put(&mut self, axis: usize, counter: f64, value: f64) -> bool {
        let apart = self.counter != counter || self.axes.get(axis).is_some_and(Option::is_some);
        let dropped = apart && self.axes.iter().any(Option::is_some);
        if apart {
            *self = Self {
                counter,
                ..Self::default()
            };
        }
        if let Some(place) = self.axes.get_mut(axis) {
            *place = Some(value);
        }
        dropped
    }

    fn whole(&self) -> Option<Vector3> {
        let [Some(x), Some(y), Some(z)] = self.axes else {
            return None;
        };
        Some(Vector3::new(x, y, z))
    }
}

/// Puts the measurements of one kind of message together to samples.
#[derive(Default)]
pub(super) struct Sensors {
    gyro: Triad,
    accel: Triad,
    /// The last tag as it is, and counted on over its wraps.
    tag: Option<(u32, u64)>,
    counter: Option<f64>,
    /// Whether the tags are the receiver's milliseconds since startup.
    calibrated: bool,
    /// Of the last ESF-RAW: the counter of its first measurement \[s\], and the word before that.
    begun: Option<(f64, u32)>,
}

impl Sensors {
    /// The counter \[s\] at a time since startup \[ms\] of about the last message, where the messages
    /// tell.
    pub(super) fn at_startup(&self, startup: u32) -> Option<f64> {
        if self.calibrated {
            return Some(f64::from(startup) * MEAS_TICK);
        }
        let (counter, begun) = self.begun?;
        let since = (f64::from(startup) - f64::from(begun)) * 1e-3;
        (since.abs() < 1.0).then_some(counter + since)
    }

    /// Whether a message has another counter than those before it; starts again with it if so.
    pub(super) fn changes(&mut self, kind: [u8; 2], payload: &[u8]) -> bool {
        let calibrated = kind == MEAS && is_calibrated(payload);
        let changes = calibrated != self.calibrated;
        if changes {
            *self = Self {
                calibrated,
                ..Self::default()
            };
        }
        changes
    }

    /// The last counter that came \[s\].
    pub(super) fn counter(&self) -> Option<f64> {
        self.counter
    }

    /// Takes in a message: `give` gets samples and their counters \[s\]; the number of incomplete
    /// samples that were dropped.
    pub(super) fn message(
        &mut self,
        at: u64,
        kind: [u8; 2],
        payload: &[u8],
        mut give: impl FnMut(f64, Sample),
    ) -> u64 {
        let mut dropped = 0;
        let mut first = true;
        for (word, tag) in measurements(kind, payload) {
            let Some((is_gyro, axis, value)) = inertial(word) else {
                continue;
            };
            let counter = self.count(kind, tag) as f64 * tick(kind);
            self.counter = Some(counter);
            if std::mem::take(&mut first) && kind == RAW {
                self.begun = u4(payload, 0).map(|startup| (counter, startup));
            }
            let triad = if is_gyro {
                &mut self.gyro
            } else {
                &mut self.accel
            };
            dropped += u64::from(triad.put(axis, counter, value));
            let (Some(gyro), Some(accel)) = (self.gyro.whole(), self.accel.whole()) else {
                continue;
            };
            // The older half of two that do not belong together waits for nothing more.
            if (self.gyro.counter - self.accel.counter).abs() > APART {
                dropped += 1;
                let old = if is_gyro {
                    &mut self.accel
                } else {
                    &mut self.gyro
                };
                *old = Triad::default();
                continue;
            }
            let middle = 0.5 * (self.gyro.counter + self.accel.counter);
            (self.gyro, self.accel) = Default::default();
            give(middle, Sample { at, gyro, accel });
        }
        dropped
    }

    /// A tag counted on over its wraps. One that goes back without a wrap starts again where the
    /// last was.
    fn count(&mut self, kind: [u8; 2], tag: u32) -> u64 {
        if self.calibrated {
            return u64::from(tag);
        }
        let (last, ticks) = self.tag.unwrap_or((tag, u64::from(tag)));
        let wrap = if kind == RAW && last < 1 << 24 && tag < 1 << 24 {
            1 << 24
        } else {
            1u64 << 32
        };
        let forward = (u64::from(tag) + wrap - u64::from(last)) % wrap;
        let ticks = if forward < wrap / 2 {
            ticks + forward
        } else {
            ticks
        };
        self.tag = Some((tag, ticks));
        ticks
    }
}

fn tick(kind: [u8; 2]) -> f64 {
    if kind == RAW { RAW_TICK } else { MEAS_TICK }
}

/// The counter of an ESF-MEAS is calibrated to the receiver's milliseconds since startup.
fn is_calibrated(payload: &[u8]) -> bool {
    u2(payload, 4).is_some_and(|flags| flags & 8 != 0)
}

/// Whether a message has any inertial measurement; there are some with wheel ticks only.
pub(super) fn has_inertial(kind: [u8; 2], payload: &[u8]) -> bool {
    measurements(kind, payload).any(|(word, _)| inertial(word).is_some())
}

/// Words and their tags.
fn measurements(kind: [u8; 2], payload: &[u8]) -> impl Iterator<Item = (u32, u32)> + '_ {
    let (from, stride, count) = if kind == RAW {
        (4, 8, payload.len().saturating_sub(4) / 8)
    } else {
        let calibrated = usize::from(is_calibrated(payload));
        let room = (payload.len().saturating_sub(8) / 4).saturating_sub(calibrated);
        let said = usize::from(u2(payload, 4).unwrap_or(0) >> 11);
        (8, 4, if said == 0 { room } else { said.min(room) })
    };
    let of_all = match kind {
        RAW => None,
        _ if is_calibrated(payload) => u4(payload, 8 + 4 * count),
        _ => u4(payload, 0),
    };
    (0..count).map_while(move |k| {
        let word_at = from + stride * k;
        let tag = if kind == RAW {
            u4(payload, word_at + 4)
        } else {
            of_all
        };
        Some((u4(payload, word_at)?, tag?))
    })
}

/// Whether a rate, along which axis, and its value [rad/s] or [m/s²]; `None` for anything else.
fn inertial(word: u32) -> Option<(bool, usize, f64)> {
    let (is_gyro, axis) = match (word >> 24) & 0x3f {
        14 => (true, 0),
        13 => (true, 1),
        5 => (true, 2),
        of @ 16..=18 => (false, of as usize - 16),
        _ => return None,
    };
    // The 24 bits to the top and back: their sign goes with them.
    let number = f64::from((word << 8).cast_signed() >> 8);
    let unit = if is_gyro {
        (0.5f64.powi(12)).to_radians()
    } else {
        0.5f64.powi(10)
    };
    Some((is_gyro, axis, number * unit))
}
