//! Mean velocities between fixes by the carrier phases of RXM-RAWX, with the ephemerides of RXM-SFRBX.
//!
//! Of GPS on L1 C/A and Galileo on E1. Each fix gets that over the time since the fix before, if both have their raw measurements: those of the same instant
//! but for the receiver's clock, which may be some milliseconds off.

use std::collections::VecDeque;

use undrift_nav::Vector3;
use undrift_nav::sample::{MeanVelocity, Position};
use undrift_observables::{Ephemerides, Epoch, Observation, Satellite, System, displacement};

use super::bytes::{r4, r8, u1, u2, u4};
use crate::entry::Fix;
use crate::time::WEEK;

pub(super) const SFRBX: [u8; 2] = [0x02, 0x13];
pub(super) const RAWX: [u8; 2] = [0x02, 0x15];
/// The stream that is named for velocities by the carrier.
pub(super) const NAME: &str = "RXM-RAWX";

/// Numbers of the systems.
const GPS: u8 = 0;
const GALILEO: u8 = 2;
/// Clocks of receivers are off by less than this \[s\].
const CLOCK: f64 = 0.02;
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
    /// Raw measurements of the last fix.
    before: Option<Epoch>,
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
        let same = |epoch: &Epoch| {
            let off = epoch.time - fix.time;
            (off - WEEK * (off / WEEK).round()).abs() < CLOCK
        };
        let now = self.epochs.iter().position(same);
        let now = now.and_then(|at| self.epochs.drain(..=at).next_back());
        let before = std::mem::replace(&mut self.before, now);
        let (before, now) = (before?, self.before.as_ref()?);
        let Some((Position::Geodetic(place), _)) = fix.position else {
            return None;
        };
        let v_n = fix.velocity.map_or_else(Vector3::zeros, |(v_n, _)| v_n);
        let way = displacement(&self.ephemerides, &before, now, &place, &v_n)?;
        Some(MeanVelocity {
            over: way.over,
            v_n: way.ned / way.over,
            covariance: way.covariance / (way.over * way.over),
        })
    }
}
