//! The autopilot's clock in GPS time.
//!
//! A fix is logged some time after its validity: the receiver computes and sends it, the autopilot reads it when it
//! comes to that. The shortest of these delays in each ten seconds vary little, so a straight line through them
//! ties the clocks, drift included. What the shortest delay itself is, some 0.1 s, the log does not tell: the
//! autopilot's times are that much too early, which is what `time_offset` is for.

/// Ties are collected over so long \[s\].
const BUCKET: f64 = 10.0;
/// Ties that are kept at most: of 50 days.
const MAX_TIES: usize = 1 << 19;
/// Over less time, drift is not distinguished from the scatter of delays \[s\].
const SPAN: f64 = 120.0;
/// No clock is off by more …
const MAX_DRIFT: f64 = 2e-4;
/// … and no tie is, from the middle one, but in logs of days \[s\].
const MAX_SCATTER: f64 = 5.0;

/// The shortest delays of a receiver.
#[derive(Debug, Default)]
pub(super) struct Ties {
    /// Time of the autopilot's clock, and how much later it reads than GPS time \[s\].
    shortest: Vec<(f64, f64)>,
    /// The ten seconds that the last of them is of.
    bucket: f64,
}

impl Ties {
    /// Takes in that a fix of a GPS time was logged at a time of the autopilot's clock \[s\].
    pub(super) fn add(&mut self, own: f64, gps: f64) {
        let delay = own - gps;
        if !delay.is_finite() || delay.abs() > 1e9 {
            return;
        }
        let bucket = (own / BUCKET).floor();
        let has_room = self.shortest.len() < MAX_TIES;
        match self.shortest.last_mut().filter(|_| bucket == self.bucket) {
            Some(last) => *last = if delay < last.1 { (own, delay) } else { *last },
            None if has_room => {
                self.shortest.push((own, delay));
                self.bucket = bucket;
            }
            None => {}
        }
    }

    /// The line through them; `None` without a tie.
    pub(super) fn link(&self) -> Option<Link> {
        let mut delays: Vec<f64> = self.shortest.iter().map(|tie| tie.1).collect();
        delays.sort_by(f64::total_cmp);
        let middle = *delays.get(delays.len() / 2)?;
        let near = |tie: &&(f64, f64)| (tie.1 - middle).abs() < MAX_SCATTER;
        let ties: Vec<(f64, f64)> = self.shortest.iter().filter(near).copied().collect();
        let n = ties.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| ties.iter().map(of).sum::<f64>() / n;
        let (at, delay) = (mean(|tie| tie.0), mean(|tie| tie.1));
        let (mut product, mut square) = (0.0, 0.0);
        for (own, behind) in &ties {
            product += (own - at) * (behind - delay);
            square += (own - at) * (own - at);
        }
        let span = ties.last()?.0 - ties.first()?.0;
        let drift = Some(product / square).filter(|d| span >= SPAN && d.abs() <= MAX_DRIFT);
        Some(Link {
            at,
            delay,
            drift: drift.unwrap_or(0.0),
        })
    }
}

/// Autopilot's clock → GPS time \[s\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    at: f64,
    delay: f64,
    drift: f64,
}

impl Link {
    pub(super) fn gps(&self, own: f64) -> f64 {
        own - self.delay - self.drift * (own - self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that is 30 ppm fast, fixes at 5 Hz that take 0.1 s and more, and one of the wrong week.
    #[test]
    fn the_line_follows_the_shortest_delays() {
        let own = |gps: f64| 77.0 + (gps - 345_000.0) * (1.0 + 30e-6);
        let mut ties = Ties::default();
        ties.add(70.0, 345_000.0 - 604_800.0);
        for k in 0..5000_u32 {
            let gps = 345_000.0 + 0.2 * f64::from(k);
            // The remainders of a multiple: 0 to 50 ms in no order, among 50 of them each once.
            let late = 1e-3 * f64::from(k * 17 % 51);
            ties.add(own(gps + 0.1 + late), gps);
        }
        let link = ties.link().unwrap();
        for gps in [345_000.0, 345_500.0, 346_000.0] {
            let found = link.gps(own(gps)) - (gps - 0.1);
            // Each bucket of 50 misses at most one of 51 delays, so its shortest is within 1 ms.
            assert!(found.abs() < 1.1e-3, "{found}");
        }
        assert!(Ties::default().link().is_none());
    }

    #[test]
    fn short_logs_have_no_drift_and_absurd_times_no_tie() {
        let mut ties = Ties::default();
        ties.add(f64::NAN, 1.0);
        ties.add(1e300, 1.0);
        assert!(ties.link().is_none());
        ties.add(10.0, 110.5);
        ties.add(10.2, 110.6);
        assert_eq!(ties.link().unwrap().gps(20.0), 120.5);
    }
}
