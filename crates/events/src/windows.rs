//! How well solution and fixes agree, window by window: a span in which they do not is a few in a thousand of the fixes of a
//! long log, and all that matters to one who uses the solution there.
//!
//! A window is at least 30 s long; at more than 256 windows each becomes twice as long. Solution and fixes disagree where at least
//! 10 innovations of a part fell into a window and less than 80 % of them are inside three standard deviations.

use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::filter::Update;

use crate::events::Part;

/// Least length of a window \[s\].
const LENGTH: f64 = 30.0;
/// Windows that are kept; where there are more, each becomes twice as long.
const MOST: usize = 256;
/// Normalised innovations squared that 0.9973 of them stay below, as many as lie inside three standard deviations: of one, two
/// and three degrees of freedom.
const INSIDE: [f64; 3] = [9.0, 11.829, 14.156];
/// Innovations that a window needs to be judged.
const LEAST: u64 = 10;
/// Share of them inside three standard deviations below which solution and fixes disagree.
const AGREE: f64 = 0.8;

/// Agreement of the solution with a part of the fixes, from their innovations, rejected ones too.
///
/// ```
/// use undrift_events::Agreement;
/// // Of twenty innovations four beyond three standard deviations; on the average twice as large as they should be.
/// let window = Agreement { innovations: 20, inside: 16, squares: 80.0 };
/// assert_eq!((window.share(), window.rms()), (Some(0.8), 2.0));
/// assert_eq!(Agreement { innovations: 9, ..window }.share(), None); // Too few to say.
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Agreement {
    /// Number of innovations.
    pub innovations: u64,
    /// Number of those inside three standard deviations.
    pub inside: u64,
    /// Sum of their normalised squares per degree of freedom: as large as their number when the model is right.
    pub squares: f64,
}

impl Agreement {
    /// Counts independent standard normal numbers, one to three.
    fn add(&mut self, whitened: &[f64]) {
        let nis: f64 = whitened.iter().map(|w| w * w).sum();
        let Some(limit) = whitened.len().checked_sub(1).and_then(|i| INSIDE.get(i)) else {
            return;
        };
        self.innovations += 1;
        self.inside += u64::from(nis < *limit);
        self.squares += nis / whitened.len() as f64;
    }

    /// Adds the innovations of another span.
    fn join(&mut self, other: &Self) {
        self.innovations += other.innovations;
        self.inside += other.inside;
        self.squares += other.squares;
    }

    /// Share inside three standard deviations [–], 0.997 when the model is right; `None` of fewer than 10 innovations.
    pub fn share(&self) -> Option<f64> {
        (self.innovations >= LEAST).then(|| self.inside as f64 / self.innovations as f64)
    }

    /// Root mean square of the innovations in standard deviations [–]: 1 when the model is right.
    pub fn rms(&self) -> f64 {
        (self.squares / self.innovations as f64).sqrt()
    }

    /// Whether fewer innovations lie inside three standard deviations than 80 %.
    fn disagrees(&self) -> bool {
        self.share().is_some_and(|share| share < AGREE)
    }
}

/// Agreement of the solution with each part of the fixes from `start` to `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Window {
    /// Time of the first fix in it \[s\].
    pub start: f64,
    /// Time of the last fix in it \[s\].
    pub end: f64,
    /// Agreement of the horizontal position.
    pub position: Agreement,
    /// Agreement of the height, given the horizontal position.
    pub height: Agreement,
    /// Agreement of the velocity.
    pub velocity: Agreement,
}

impl Window {
    fn at(time: f64) -> Self {
        Self {
            start: time,
            end: time,
            position: Agreement::default(),
            height: Agreement::default(),
            velocity: Agreement::default(),
        }
    }

    /// Agreement of one part.
    pub fn agreement(&self, part: WindowPart) -> &Agreement {
        match part {
            WindowPart::Position => &self.position,
            WindowPart::Height => &self.height,
            WindowPart::Velocity => &self.velocity,
        }
    }

    /// Whether any part of the fixes disagrees with the solution.
    fn disagrees(&self) -> bool {
        WindowPart::ALL
            .iter()
            .any(|part| self.agreement(*part).disagrees())
    }

    /// Adds the window behind it.
    fn join(&mut self, other: &Self) {
        self.end = other.end;
        self.position.join(&other.position);
        self.height.join(&other.height);
        self.velocity.join(&other.velocity);
    }
}

/// A part of the fixes that windows judge by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum WindowPart {
    /// Horizontal position.
    Position,
    /// Height.
    Height,
    /// Velocity.
    Velocity,
}

impl WindowPart {
    /// Every part, in the order in which they are reported.
    pub const ALL: [Self; 3] = [Self::Position, Self::Height, Self::Velocity];
}

/// A span in which the solution and a part of the fixes disagree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Part that disagrees.
    pub part: WindowPart,
    /// Time of the first fix of the span \[s\].
    pub start: f64,
    /// Time of the last fix of the span \[s\].
    pub end: f64,
    /// Agreement over the whole span.
    pub agreement: Agreement,
}

/// The windows of a run, in the summary of the navigator.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Windows {
    length: f64,
    windows: Vec<Window>,
}

impl Default for Windows {
    fn default() -> Self {
        Self {
            length: LENGTH,
            windows: Vec::new(),
        }
    }
}

impl Windows {
    /// Counts the update of the filter with a part of a fix at `time` \[s\]; in order of time. For tools that run a filter by themselves.
    pub fn add(&mut self, part: Part, time: f64, update: &Update) {
        let is_over = |window: &Window| time >= window.start + self.length;
        if self.windows.last().is_none_or(is_over) {
            if self.windows.len() == MOST {
                self.thin();
            }
            self.windows.push(Window::at(time));
        }
        let Some(window) = self.windows.last_mut() else {
            return;
        };
        window.end = time;
        let whitened = &update.whitened[..update.dof.min(3)];
        match (part, whitened) {
            (Part::Position, [north, east, down]) => {
                window.position.add(&[*north, *east]);
                window.height.add(&[*down]);
            }
            (Part::Position, _) => window.position.add(whitened),
            (Part::Velocity, _) => window.velocity.add(whitened),
        }
    }

    /// Joins windows in pairs: half as many, each twice as long.
    fn thin(&mut self) {
        self.length *= 2.0;
        let pairs = self.windows.chunks(2).map(|pair| {
            let mut joined = pair[0];
            pair[1..].iter().for_each(|other| joined.join(other));
            joined
        });
        self.windows = pairs.collect();
    }

    /// The windows in order of time.
    pub fn iter(&self) -> core::slice::Iter<'_, Window> {
        self.windows.iter()
    }

    /// Agreement of a part over all windows together.
    ///
    /// ```
    /// use undrift_events::{Part, WindowPart, Windows};
    /// use undrift_nav::filter::{Outcome, Update};
    /// let update = |whitened: [f64; 3]| Update {
    ///     nis: whitened.iter().map(|x| x * x).sum(),
    ///     dof: 3,
    ///     whitened,
    ///     score: 0.0,
    ///     information: 1.0,
    ///     outcome: Outcome::Used,
    /// };
    /// let mut windows = Windows::default();
    /// for k in 0..20 {
    ///     let error = if k < 5 { 6.0 } else { 0.5 }; // A quarter lies far outside.
    ///     windows.add(Part::Position, f64::from(k), &update([error, 0.0, 0.0]));
    /// }
    /// let position = windows.overall(WindowPart::Position);
    /// assert_eq!((position.innovations, position.inside, position.share()), (20, 15, Some(0.75)));
    /// assert_eq!(windows.disagreements(WindowPart::Position).count(), 1); // Less than 80 %.
    /// ```
    pub fn overall(&self, part: WindowPart) -> Agreement {
        let mut all = Agreement::default();
        self.iter()
            .for_each(|window| all.join(window.agreement(part)));
        all
    }

    /// Spans of one or more windows in a row in which the solution and any part of the fixes disagree: start and end \[s\].
    pub fn spans(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let groups = self.windows.chunk_by(|a, b| a.disagrees() == b.disagrees());
        groups.filter_map(|group| {
            let (first, last) = (group.first()?, group.last()?);
            first.disagrees().then_some((first.start, last.end))
        })
    }

    /// Spans of one or more windows in a row in which the solution and a part of the fixes disagree.
    pub fn disagreements(&self, part: WindowPart) -> impl Iterator<Item = Disagreement> + '_ {
        let groups = self
            .windows
            .chunk_by(move |a, b| a.agreement(part).disagrees() == b.agreement(part).disagrees());
        groups.filter_map(move |group| {
            let (first, last) = (group.first()?, group.last()?);
            let mut agreement = Agreement::default();
            group
                .iter()
                .for_each(|window| agreement.join(window.agreement(part)));
            first.agreement(part).disagrees().then_some(Disagreement {
                part,
                start: first.start,
                end: last.end,
                agreement,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::filter::Outcome;

    fn update(whitened: [f64; 3], dof: usize) -> Update {
        Update {
            nis: whitened.iter().map(|w| w * w).sum(),
            dof,
            whitened,
            score: 0.0,
            information: 1.0,
            outcome: Outcome::Used,
        }
    }

    /// A fix a second for ten minutes, from 200 to 260 s with heights that are 5 standard deviations off.
    #[test]
    fn a_minute_of_wrong_heights_is_a_span_of_heights() {
        let mut windows = Windows::default();
        for k in 0..600 {
            let time = f64::from(k);
            let down = if (210..270).contains(&k) { 5.0 } else { 0.5 };
            windows.add(Part::Position, time, &update([1.0, -1.0, down], 3));
            windows.add(Part::Velocity, time, &update([1.0, 1.0, 1.0], 3));
        }
        assert_eq!(windows.iter().count(), 20);
        let spans = |part| Vec::from_iter(windows.disagreements(part));
        assert!(spans(WindowPart::Position).is_empty() && spans(WindowPart::Velocity).is_empty());
        let [height] = spans(WindowPart::Height)[..] else {
            panic!("{:?}", spans(WindowPart::Height));
        };
        assert_eq!((height.start, height.end), (210.0, 269.0));
        assert_eq!(Vec::from_iter(windows.spans()), [(210.0, 269.0)]);
        assert_eq!(height.agreement.inside, 0);
        assert!((height.agreement.rms() - 5.0).abs() < 1e-12);
        let all = windows.overall(WindowPart::Height);
        assert_eq!((all.innovations, all.inside), (600, 540));
        assert_eq!(all.share(), Some(0.9));
    }

    /// One in five of a window may lie outside, and nine innovations are too few.
    #[test]
    fn a_window_disagrees_below_four_fifths_of_ten_or_more() {
        let spans = |outside: usize, of: usize| {
            let mut windows = Windows::default();
            for k in 0..of {
                let north = if k < outside { 4.0 } else { 0.0 };
                windows.add(Part::Position, k as f64, &update([north, 0.0, 0.0], 2));
            }
            windows.disagreements(WindowPart::Position).count()
        };
        assert_eq!(spans(2, 10), 0);
        assert_eq!(spans(3, 10), 1);
        assert_eq!(spans(9, 9), 0);
    }

    /// Three standard deviations of one number are 9, of two 11.829, of three 14.156: 0.9973 of the chi-squared distributions.
    #[test]
    fn three_standard_deviations_of_one_to_three_numbers() {
        for (dof, limit) in [(1, 9.0), (2, 11.829), (3, 14.156)] {
            for (nis, inside) in [(limit - 0.01, 1), (limit + 0.01, 0)] {
                let mut agreement = Agreement::default();
                agreement.add(&[f64::sqrt(nis / dof as f64); 3][..dof]);
                assert_eq!(agreement.inside, inside, "{dof} {nis}");
            }
        }
    }

    /// Eleven hours of fixes: as many in all, in windows of four minutes.
    #[test]
    fn a_long_log_has_longer_windows() {
        let mut windows = Windows::default();
        for k in 0..40_000 {
            windows.add(Part::Velocity, f64::from(k), &update([0.1, 0.2, 0.3], 3));
        }
        assert!((MOST / 2..=MOST).contains(&windows.iter().count()));
        assert_eq!(windows.overall(WindowPart::Velocity).innovations, 40_000);
        let lengths = windows.iter().map(|window| window.end - window.start);
        assert_eq!(lengths.take(50).fold(0.0, f64::max), 239.0);
    }
}
