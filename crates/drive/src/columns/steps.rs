//! The unit of time stamps by their steps.

use super::letters;
use undrift_base::order_statistics::upper_median;

/// Clocks whose ticks are no usual unit of time: the letters of their names and the ticks that there are, the longest
/// first, with their factor to seconds. Xsens counts 0.1 ms in an MTi and microseconds in a DOT.
const TICKS: [(&str, [(&str, f64); 2]); 1] =
    [("sampletimefine", [("0.1 ms/LSB", 1e-4), ("us", 1e-6)])];

/// Ticks of 0.1 µs from 1601 and from the year 1 to years from 1980 to 2200, as Windows and .NET count time.
const TICKS_OF_WINDOWS: [std::ops::Range<f64>; 2] = [1.19e17..1.89e17, 6.24e17..6.94e17];

/// Longest ordinary step of an inertial log \[s\].
pub const IMU_STEP: f64 = 0.25;
/// Longest ordinary step of a log of fixes \[s\].
pub const FIX_STEP: f64 = 30.0;

/// Day, as spreadsheets and MATLAB count times \[s\].
const DAY: f64 = 86_400.0;
/// No log has a shorter ordinary step \[s\].
const SHORTEST_STEP: f64 = 2e-5;

/// The unit of time stamps, and its factor to seconds: days where their mean step would be too short in seconds, else the
/// longest one that makes their ordinary step no longer than `longest` \[s\]; `None` if there are too few stamps or none fits.
pub fn time_unit(stamps: &[f64], longest: f64) -> Option<(&'static str, f64)> {
    if are_days(stamps, longest) {
        return Some(("d", DAY));
    }
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    longest_unit(&units, stamps, longest)
}

/// The unit of a column with a name, whose ticks may be others than those of [`time_unit`].
pub fn time_unit_of(column: &str, stamps: &[f64], longest: f64) -> Option<(&'static str, f64)> {
    let name = letters(column);
    let first = stamps.first().copied().unwrap_or_default();
    if TICKS_OF_WINDOWS.iter().any(|since| since.contains(&first)) {
        return Some(("0.1 us/LSB", 1e-7));
    }
    match TICKS.iter().find(|(clock, _)| *clock == name) {
        Some((_, ticks)) => longest_unit(ticks, stamps, longest),
        None if is_tick_clock(&name) => {
            let step = ordinary_step(stamps)?;
            let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
            let usual = if longest > IMU_STEP {
                USUAL_FIX_STEPS
            } else {
                USUAL_STEPS
            };
            let is_usual = |(_, factor): &(&str, f64)| usual.contains(&(step * factor));
            units.into_iter().find(is_usual)
        }
        None => time_unit(stamps, longest),
    }
}

/// Words for a clock whose ticks may be of any length, and the steps of samples \[s\] that show a usual unit: a tick of 0.1 ms
/// or of a crystal of 32768 Hz leaves them.
const TICK_CLOCKS: [&str; 9] = [
    "tick",
    "ticks",
    "systick",
    "tickcount",
    "counts",
    "clock",
    "clockticks",
    "cycles",
    "timer",
];
const USUAL_STEPS: std::ops::RangeInclusive<f64> = 0.9e-3..=0.041;
/// The same of fixes.
const USUAL_FIX_STEPS: std::ops::RangeInclusive<f64> = 0.04..=10.0;

/// Whether a column counts ticks of a clock by its name, in small letters: it is no time where their length is unknown.
pub fn is_tick_clock(letters: &str) -> bool {
    TICK_CLOCKS.contains(&letters)
}

/// Whether stamps count days. The mean step shows it: rows that are read in bursts are as close in seconds.
fn are_days(stamps: &[f64], longest: f64) -> bool {
    let (first, last) = stamps.iter().fold((f64::MAX, f64::MIN), |(l, h), stamp| {
        (l.min(*stamp), h.max(*stamp))
    });
    let mean = (last - first) / stamps.len().saturating_sub(1).max(1) as f64;
    (SHORTEST_STEP / DAY..=SHORTEST_STEP.max(longest / DAY)).contains(&mean)
}

fn longest_unit(
    units: &[(&'static str, f64)],
    stamps: &[f64],
    longest: f64,
) -> Option<(&'static str, f64)> {
    let step = ordinary_step(stamps)?;
    let mut units = units.iter().copied();
    units.find(|(_, factor)| step * factor <= longest)
}

/// Median of the steps forward of time stamps, in their unit; `None` without such steps.
pub fn ordinary_step(stamps: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.retain(|step| *step > 0.0);
    (!steps.is_empty()).then(|| upper_median(&mut steps))
}
