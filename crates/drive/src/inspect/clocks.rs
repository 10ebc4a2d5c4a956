//! By how much the clocks of two logs differ: where the turns that the gyros see are those of the course.

use undrift_engine::derived::antenna;
use undrift_io::epoch::{ClockSource, Epoch};
use undrift_nav::{
    Vector3,
    earth::Geodetic,
    sample::{GnssFix, ImuSample},
};
use undrift_results::inspect::Known;

/// Interval at which the turned angle is kept \[s\].
const GRID: f64 = 0.1;
/// Longest log \[s\].
const LONGEST: f64 = 2e5;
/// Steps of the offset, coarse and fine \[s\].
const STEPS: [f64; 2] = [0.5, 0.05];
/// Turns of the course are taken over at least and at most so long \[s\].
const SPAN: std::ops::Range<f64> = 0.9..3.1;
/// Least speed of which the course is taken [m/s].
const MIN_SPEED: f64 = 0.7;
/// Turns that are compared, at least and at most.
const TURNS: [usize; 2] = [25, 1500];
/// Least scatter of the turns [rad/s].
const TURNING: f64 = 0.03;
/// Correlation of clocks that agree, and of those that are found to differ.
const ALIKE: [f64; 2] = [0.6, 0.85];
/// By so much the best correlation exceeds that of offsets which are further from it than `APART` \[s\].
const CLEAR: f64 = 0.12;
const APART: f64 = 6.0;
/// Logs of one drive begin so soon after each other \[s\], and correlate there by at most so much less than at best.
const TOGETHER: f64 = 3.0;
const LESS: f64 = 0.03;
/// An offset so near to a whole one is that \[s\].
const NEAR: f64 = 0.6;
/// GPS time less UTC \[s\].
pub(super) const LEAP: f64 = 18.0;
const DAY: f64 = 86_400.0;
const HOUR: f64 = 3600.0;
/// Time zones and days.
const MOST_HOURS: f64 = 24.0;

/// What is to be added to the times of the fixes \[s\], where the turns show another offset than none; samples in sensor axes.
pub(super) fn offset(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<(f64, Known)> {
    let clocks = Clocks::new(imu, fixes)?;
    let now = clocks.correlation(0.0).unwrap_or(0.0);
    // Against each other, it is a sign that is wrong.
    if now.abs() > ALIKE[0] {
        return None;
    }
    let [coarse, fine] = STEPS;
    let (from, to) = clocks.range();
    let offsets = |from: f64, to: f64, step: f64| {
        let count = ((to - from) / step) as usize + 1;
        (0..count).map(move |k| from + step * k as f64)
    };
    let scored = |from, to, step| -> Vec<(f64, f64)> {
        let all = offsets(from, to, step);
        all.filter_map(|at| Some((at, clocks.correlation(at)?)))
            .collect()
    };
    let best = |of: &[(f64, f64)]| of.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    let all = scored(from, to, coarse);
    let (mut about, most) = best(&all)?;
    // Both may begin at the same moment, where a course that repeats itself shows several offsets.
    let together = clocks.start - fixes.first()?.time;
    let near = all
        .iter()
        .copied()
        .filter(|(at, _)| (at - together).abs() < TOGETHER);
    let begins = best(&Vec::from_iter(near)).filter(|(_, near)| *near > most - LESS);
    about = begins.map_or(about, |(at, _)| at);
    let (found, correlation) = best(&scored(about - coarse, about + coarse, fine))?;
    let elsewhere = all.iter().filter(|(at, _)| (at - found).abs() > APART);
    let other = elsewhere.map(|(_, c)| *c).fold(now, f64::max);
    let clear = begins.is_some() || correlation > other + CLEAR;
    if correlation < ALIKE[1] || !clear {
        return None;
    }
    let (offset, hours, leap) = whole(found).unwrap_or((found, 0.0, false));
    let known = Known::Clocks {
        correlation,
        hours,
        leap,
    };
    Some(((offset * 100.0).round() / 100.0, known))
}

/// What is to be added to the times of the fixes, of which the first and last are `fixes` \[s\], where one log counts GPS seconds since
/// 1980 and the other, from the first to the last of `imu` \[s\], Unix time of the same hours.
pub(super) fn gps_epoch(imu: (f64, f64), fixes: (f64, f64)) -> Option<f64> {
    let gps = imu.0.min(fixes.0);
    let apart = (Epoch::of_week(0, ClockSource::Gnss).unix(gps) - gps).round();
    let offset = apart * (imu.0 - fixes.0).signum();
    let overlap = imu.1.min(fixes.1 + offset) - imu.0.max(fixes.0 + offset);
    (overlap > 0.0 && (imu.0 - fixes.0).abs() > apart / 2.0).then_some(offset)
}

/// What is to be added to times of day, of which the first and last are `fixes` \[s\], for them to be of the same clock as those of `imu`:
/// whole days, and `leap` seconds where that clock is GPS time. `None` where the logs then have not half of the shorter in common.
pub(super) fn days(imu: (f64, f64), fixes: (f64, f64), leap: f64) -> Option<f64> {
    let is_of_day = fixes.0 >= 0.0 && fixes.0 < DAY && fixes.1 - fixes.0 < DAY;
    let whole = ((imu.0 - fixes.0) / DAY).round();
    let shorter = (imu.1 - imu.0).min(fixes.1 - fixes.0);
    [whole, whole - 1.0, whole + 1.0]
        .into_iter()
        .map(|days| DAY * days + leap)
        .find(|offset| {
            let overlap = imu.1.min(fixes.1 + offset) - imu.0.max(fixes.0 + offset);
            is_of_day && *offset > DAY / 2.0 && 2.0 * overlap > shorter
        })
}

/// The whole hours and leap seconds that an offset is.
fn whole(offset: f64) -> Option<(f64, f64, bool)> {
    let candidates = [0.0, LEAP, -LEAP].into_iter().map(|leap| {
        let hours = ((offset - leap) / HOUR).round();
        (hours * HOUR + leap, hours, leap != 0.0)
    });
    let mut near = candidates.filter(|(whole, hours, _)| {
        (whole - offset).abs() < NEAR && hours.abs() <= MOST_HOURS && whole.abs() > NEAR
    });
    near.next()
}

/// The velocities of fixes; of positions alone, those from one to the next.
fn velocities(fixes: &[GnssFix]) -> Vec<(f64, Vector3)> {
    let stated = fixes
        .iter()
        .filter_map(|fix| Some((fix.time, fix.velocity?.0)));
    let stated = Vec::from_iter(stated);
    if !stated.is_empty() {
        return stated;
    }
    let mut before: Option<(f64, Geodetic)> = None;
    let mut derived = Vec::new();
    for (now, place) in fixes
        .iter()
        .filter_map(|fix| Some((fix.time, antenna(fix)?)))
    {
        let length = before.map_or(f64::INFINITY, |(time, _)| now - time);
        if length < SPAN.start {
            continue;
        }
        if let Some((time, from)) = before.filter(|_| length < SPAN.end) {
            derived.push(((time + now) / 2.0, from.ned_to(&place) / length));
        }
        before = Some((now, place));
    }
    derived
}

/// The turns of two logs.
struct Clocks {
    /// Time of the first angle \[s\], and the angle turned about down since then, every [`GRID`] \[rad\].
    start: f64,
    angles: Vec<f64>,
    /// Start, end \[s\] and turn \[rad\] of the course.
    turns: Vec<(f64, f64, f64)>,
}

impl Clocks {
    fn new(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<Self> {
        let (first, last) = (imu.first()?, imu.last()?);
        if last.time - first.time > LONGEST {
            return None;
        }
        let force: Vector3 = imu.iter().map(|sample| sample.dvel).sum();
        let down = -force.try_normalize(1e-9)?;
        let mut angle = 0.0;
        let mut angles = Vec::new();
        for sample in imu {
            let place = ((sample.time - first.time) / GRID) as usize;
            angles.resize(angles.len().max(place), angle);
            angle += sample.dtheta.dot(&down);
            if angles.len() == place {
                angles.push(angle);
            }
        }
        let mut turns = Vec::new();
        let mut before: Option<(f64, Vector3)> = None;
        for (now, velocity) in velocities(fixes) {
            if let Some((time, last)) = before {
                let length = now - time;
                if length < SPAN.start {
                    continue;
                }
                let slow = velocity.xy().norm().min(last.xy().norm());
                if SPAN.contains(&length) && slow > MIN_SPEED {
                    let (along, across) = (
                        last.xy().dot(&velocity.xy()),
                        last.xy().perp(&velocity.xy()),
                    );
                    turns.push((time, now, across.atan2(along)));
                }
            }
            before = Some((now, velocity));
        }
        let every = turns.len() / TURNS[1] + 1;
        let turns = Vec::from_iter(turns.into_iter().step_by(every));
        let rates = turns.iter().map(|(from, to, turn)| turn / (to - from));
        let turning = rates.map(|rate| rate * rate).sum::<f64>() / turns.len().max(1) as f64;
        (turns.len() >= TURNS[0] && turning.sqrt() > TURNING).then_some(Self {
            start: first.time,
            angles,
            turns,
        })
    }

    /// The least and the largest offset at which the logs overlap by half of the shorter.
    fn range(&self) -> (f64, f64) {
        let (first, last) = (self.turns.first(), self.turns.last());
        let (first, last) = (first.map_or(0.0, |t| t.0), last.map_or(0.0, |t| t.1));
        let end = self.start + GRID * self.angles.len() as f64;
        let half = 0.5 * (last - first).min(end - self.start);
        (self.start + half - last, end - half - first)
    }

    /// The angle turned until a time \[rad\].
    fn angle(&self, time: f64) -> Option<f64> {
        let place = (time - self.start) / GRID;
        let (low, share) = (place.floor(), place.fract());
        if low < 0.0 {
            return None;
        }
        let pair = self.angles.get(low as usize..low as usize + 2)?;
        Some(pair[0] + share * (pair[1] - pair[0]))
    }

    /// The correlation of the turn rates with the fixes so much later \[s\]; `None` of too few.
    fn correlation(&self, offset: f64) -> Option<f64> {
        let rates = self.turns.iter().filter_map(|(from, to, turn)| {
            let turned = self.angle(to + offset)? - self.angle(from + offset)?;
            Some([turn / (to - from), turned / (to - from)])
        });
        let (mut count, mut sums, mut squares) = (0.0, [0.0; 2], [0.0; 3]);
        for [course, gyro] in rates {
            count += 1.0;
            sums = [sums[0] + course, sums[1] + gyro];
            squares[0] += course * course;
            squares[1] += gyro * gyro;
            squares[2] += course * gyro;
        }
        if count < TURNS[0] as f64 || 3.0 * count < self.turns.len() as f64 {
            return None;
        }
        let about = |square: f64, a: usize, b: usize| square - sums[a] * sums[b] / count;
        let spread = about(squares[0], 0, 0) * about(squares[1], 1, 1);
        (spread > 0.0).then(|| about(squares[2], 0, 1) / spread.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_simulate::{GnssNoise, Trajectory, simulate};

    /// Of a flight at noon of 14 November 2023, and one in 2016 with 17 leap seconds; logs of other days stay apart.
    #[test]
    fn gps_seconds_and_unix_time_differ_by_their_size() {
        for (unix, leap) in [(1_700_000_000.0, 18.0), (1_470_000_000.0, 17.0)] {
            let gps = unix - 315_964_800.0 + leap;
            let (imu, fixes) = ((unix, unix + 400.0), (gps + 1.0, gps + 390.0));
            assert_eq!(gps_epoch(imu, fixes), Some(315_964_800.0 - leap));
            assert_eq!(gps_epoch(fixes, imu), Some(leap - 315_964_800.0));
            assert_eq!(gps_epoch(imu, imu), None);
            assert_eq!(gps_epoch(imu, (gps + 500.0, gps + 600.0)), None);
            assert_eq!(gps_epoch(imu, (0.0, 400.0)), None);
        }
    }

    #[test]
    fn times_of_day_differ_by_whole_days() {
        let fixes = (36_001.0, 36_300.0);
        let days = |first: f64, leap: f64| days((first, first + 280.0), fixes, leap);
        // Unix time, and the seconds of a GPS week.
        let unix = 1_714_953_600.0;
        assert_eq!(days(unix + 36_005.0, 0.0), Some(unix));
        assert_eq!(days(86_400.0 + 36_023.0, 18.0), Some(86_418.0));
        // The first day of the week, and another hour.
        assert_eq!(days(36_005.0, 0.0), None);
        assert_eq!(days(unix + 39_600.0, 0.0), None);
    }

    #[test]
    fn an_offset_is_found_by_the_turns() {
        let log = simulate(
            &Trajectory::car(400.0, 3),
            50.0,
            None,
            &GnssNoise::default(),
            3,
        )
        .unwrap();
        assert_eq!(offset(&log.imu, &log.gnss), None);
        for (late, hours, leap) in [
            (18.0, 0.0, true),
            (-18.0, 0.0, true),
            (3600.0, -1.0, false),
            (7218.0, -2.0, true),
            (408_639.75, 0.0, false),
        ] {
            let mut fixes = log.gnss.clone();
            for fix in &mut fixes {
                fix.time += late;
            }
            let (found, known) = offset(&log.imu, &fixes).unwrap();
            assert!((found + late).abs() < 0.2, "{late}: {found}");
            // By the positions alone, too.
            fixes.iter_mut().for_each(|fix| fix.velocity = None);
            let (found, _) = offset(&log.imu, &fixes).unwrap();
            assert!((found + late).abs() < 0.3, "{late}: {found}");
            let Known::Clocks {
                hours: h, leap: l, ..
            } = known
            else {
                panic!("{known:?}");
            };
            assert_eq!((h, l), (hours, leap), "{late}");
        }
        // The gyros of another drive.
        let other = Trajectory::car(400.0, 4);
        let other = simulate(&other, 50.0, None, &GnssNoise::default(), 4).unwrap();
        assert_eq!(offset(&other.imu, &log.gnss), None);
    }

    /// Logs that do not begin together, so that turns alone show the offset.
    #[test]
    fn an_offset_is_found_where_it_is_the_only_one() {
        let car = Trajectory::car(400.0, 3);
        let log = simulate(&car, 50.0, None, &GnssNoise::default(), 3).unwrap();
        let mut fixes = log.gnss;
        fixes.retain(|fix| fix.time > 100.0);
        for fix in &mut fixes {
            fix.time += 18.0;
        }
        let (found, _) = offset(&log.imu, &fixes).unwrap();
        assert!((found + 18.0).abs() < 0.2, "{found}");
        // The gyros of two rounds of the same course: it may have been either.
        let again = log.imu.iter().map(|sample| ImuSample {
            time: sample.time + 400.0,
            ..*sample
        });
        let twice: Vec<ImuSample> = log.imu.iter().copied().chain(again).collect();
        assert_eq!(offset(&twice, &fixes), None);
    }
}
