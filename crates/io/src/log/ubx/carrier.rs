//! Mean velocities between fixes by the carrier phases of RXM-RAWX, with the ephemerides of RXM-SFRBX.
//!
//! Of GPS on L1 C/A and Galileo on E1. Each fix gets that over the time since the fix before, if both have their raw measurements: those of the same instant
//! but for the receiver's clock, which may be some milliseconds off.

use std::collections::VecDeque;

use undrift_nav::sample::MeanVelocity;
use undrift_observables::{Ephemerides, Epoch, Observation, Satellite, System, since};

use super::bytes::{r4, r8, u1, u2, u4};
use crate::carrier::{CLOCK, Way};
use crate::entry::Fix;
use crate::time::WEEK;

pub(super) const SFRBX: [u8; 2] = [0x02, 0x13];
pub(super) const RAWX: [u8; 2] = [0x02, 0x15];
/// The stream that is named for velocities by the carrier.
pub(super) const NAME: &str = "RXM-RAWX";

/// Numbers of the systems.
const GPS: u8 = 0;
const GALILEO: u8 = 2;
/// Raw epochs that wait for their fix.
const KEPT: usize = 4;
/// Code of a phase of unknown standard deviation.
const NO_STD: u8 = 15;

#[derive(Default)]
pub(super) struct Carrier {
    ephemerides: Ephemerides,
    /// GPS week from whose beginning the times count.
    week: Option<u16>,
    epochs: VecDeque<Epoch>,
    way: Way,
}

impl Carrier {
    /// Takes in a message; `None` if it is too short.
    pub(super) fn message(&mut self, kind: [u8; 2], payload: &[u8]) -> Option<()> {
        match kind {
            SFRBX => self.subframe(payload),
            RAWX => {
                let epoch = self.epoch(payload)?;
                self.epochs.push_back(epoch);
                if self.epochs.len() > KEPT {
                    self.epochs.pop_front();
                }
                Some(())
            }
            _ => Some(()),
        }
    }

    fn subframe(&mut self, payload: &[u8]) -> Option<()> {
        let words: Vec<u32> = (0..usize::from(u1(payload, 4)?))
            .map(|k| u4(payload, 8 + 4 * k))
            .collect::<Option<_>>()?;
        let (number, signal) = (u1(payload, 1)?, u1(payload, 2)?);
        match (u1(payload, 0)?, signal) {
            // L1 C/A.
            (GPS, 0) => {
                if let Some(words) = words.first_chunk() {
                    self.ephemerides.gps_subframe(number, words);
                }
            }
            // E1-B, E5b-I.
            (GALILEO, 1 | 5) => {
                if let Some(words) = words.first_chunk() {
                    self.ephemerides.galileo_page(number, words);
                }
            }
            _ => {}
        }
        Some(())
    }

    fn epoch(&mut self, payload: &[u8]) -> Option<Epoch> {
        let (time_of_week, week) = (r8(payload, 0)?, u2(payload, 8)?);
        let first = *self.week.get_or_insert(week);
        let later = f64::from(week) - f64::from(first);
        let mut observations = Vec::new();
        for k in 0..usize::from(u1(payload, 11)?) {
            let at = 16 + 32 * k;
            let [system, satellite, signal] = [20, 21, 22].map(|field| u1(payload, at + field));
            let (status, std) = (u1(payload, at + 30)?, u1(payload, at + 28)? & 15);
            let system = match (system?, signal?) {
                (GPS, 0) => System::Gps,
                (GALILEO, 0) => System::Galileo,
                _ => continue,
            };
            // A valid pseudorange.
            if status & 1 == 0 {
                continue;
            }
            let number = satellite?;
            let vouched = status & 0b110 == 0b110 && std != NO_STD;
            observations.push(Observation {
                satellite: Satellite { system, number },
                pseudorange: r8(payload, at)?,
                phase: vouched.then_some(r8(payload, at + 8)?),
                phase_std: f64::from(std) * 0.004,
                doppler: f64::from(r4(payload, at + 16)?),
                lock: f64::from(u2(payload, at + 24)?) * 1e-3,
                half_subtracted: status & 0b1000 != 0,
            });
        }
        let time = time_of_week + WEEK * later;
        time.is_finite().then_some(Epoch { time, observations })
    }

    /// Mean velocity since the last fix that was asked for, up to this one, where the raw measurements of both are there and give it.
    pub(super) fn mean_velocity(&mut self, fix: &Fix) -> Option<MeanVelocity> {
        let same = |epoch: &Epoch| since(epoch.time, fix.time).abs() < CLOCK;
        let now = self.epochs.iter().position(same);
        let now = now.and_then(|at| self.epochs.drain(..=at).next_back());
        let place = fix.position.map(|(position, _)| position);
        let v_n = fix.velocity.map(|(v_n, _)| v_n);
        (self.way).mean_velocity(&self.ephemerides, now, place.as_ref(), v_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::earth::Geodetic;
    use undrift_nav::sample::{FixQuality, Position};

    /// RXM-RAWX with a row a signal: system, satellite, signal, status, code of the phase's standard deviation.
    fn rawx(time_of_week: f64, week: u16, rows: &[[u8; 5]]) -> Vec<u8> {
        let mut payload = time_of_week.to_le_bytes().to_vec();
        payload.extend(week.to_le_bytes());
        payload.extend([18, rows.len() as u8, 0, 1, 0, 0]);
        for (k, [system, satellite, signal, status, std]) in rows.iter().enumerate() {
            let k = k as f64;
            payload.extend((2e7 + k).to_le_bytes());
            payload.extend((1e8 + k).to_le_bytes());
            payload.extend((-1500.5f32).to_le_bytes());
            payload.extend([*system, *satellite, *signal, 0]);
            payload.extend(2500u16.to_le_bytes());
            payload.extend([45, 3, *std, 5, *status, 0]);
        }
        payload
    }

    #[test]
    fn observations_are_of_gps_and_galileo_with_what_is_vouched_for() {
        let rows = [
            [0, 10, 0, 0b0111, 2],
            [0, 10, 3, 0b0111, 2],
            [2, 7, 0, 0b1111, 1],
            [6, 8, 0, 0b0111, 1],
            [0, 11, 0, 0b0011, 1],
            [0, 12, 0, 0b0111, 15],
            [0, 13, 0, 0b0110, 1],
        ];
        let mut carrier = Carrier::default();
        let payload = rawx(604_799.9, 2381, &rows);
        let epoch = carrier.epoch(&payload).unwrap();
        let seen: Vec<_> = epoch.observations.iter().collect();
        let numbers: Vec<u8> = seen.iter().map(|seen| seen.satellite.number).collect();
        assert_eq!(numbers, [10, 7, 11, 12]);
        assert_eq!(seen[1].satellite.system, System::Galileo);
        assert_eq!(
            (seen[1].pseudorange, seen[1].phase),
            (2e7 + 2.0, Some(1e8 + 2.0))
        );
        assert_eq!(
            (seen[0].doppler, seen[0].lock, seen[0].phase_std),
            (-1500.5, 2.5, 0.008)
        );
        assert!(seen[1].half_subtracted && !seen[0].half_subtracted);
        assert!(seen[2].phase.is_none() && seen[3].phase.is_none());
        // On past the week's end; cut short at any byte.
        let next = carrier.epoch(&rawx(0.1, 2382, &rows)).unwrap();
        assert!((next.time - 604_800.1).abs() < 1e-9);
        // All but the last byte, which is reserved.
        for length in 0..payload.len() - 1 {
            assert!(carrier.message(RAWX, &payload[..length]).is_none());
        }
    }

    #[test]
    fn a_fix_has_the_raw_measurements_of_its_instant() {
        let fix = |time| Fix {
            time,
            position: Some((
                Position::Geodetic(Geodetic::from_degrees(47.0, 8.0, 400.0)),
                None,
            )),
            velocity: None,
            mean_velocity: None,
            quality: FixQuality::Single,
        };
        let mut carrier = Carrier::default();
        for k in 0..7 {
            let payload = rawx(100.0 + 0.25 * f64::from(k), 2381, &[]);
            carrier.message(RAWX, &payload).unwrap();
        }
        assert_eq!(carrier.epochs.len(), KEPT);
        // The clock of the receiver is 5 ms slow; no ephemeris, so no velocity.
        assert!(carrier.mean_velocity(&fix(101.005)).is_none());
        assert_eq!(
            carrier.way.before.as_ref().map(|epoch| epoch.time),
            Some(101.0)
        );
        assert_eq!(carrier.epochs.len(), 2);
        assert!(carrier.mean_velocity(&fix(101.1)).is_none());
        assert!(carrier.way.before.is_none());
    }
}
