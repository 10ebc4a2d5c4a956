//! What headings by two antennas agree on, where nothing else shows which of them are wrong.

#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{earth::wrap_pi, sample::Scalar};

/// Least standard deviation of a heading \[rad\]: phase centres, cables.
pub(crate) const FLOOR: f64 = 1e-3;
/// Errors by reflections last so long \[s\].
pub(crate) const LASTS: f64 = 1.0;
/// Headings that are kept, at most one in [`APART`].
const RECENT: usize = 24;
const APART: f64 = 0.2;
/// Headings older than this say nothing \[s\].
const OLD: f64 = 10.0;
/// Least number of headings, and least span of them \[s\], that can agree.
const LEAST: usize = 4;
const LEAST_SPAN: f64 = 2.0;
/// Headings agree within this \[rad\] and three of their standard deviations.
pub(crate) const AGREE: f64 = 0.02;

#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Seen {
    time: f64,
    measured: f64,
    /// Measured against what it is compared with.
    angle: f64,
    std: f64,
}

/// The last headings against a frame that turns with the body or the solution.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Recent {
    seen: [Seen; RECENT],
    count: usize,
}

impl Recent {
    fn kept(&mut self) -> &mut [Seen] {
        &mut self.seen[..self.count.min(RECENT)]
    }

    /// Keeps a heading that is `angle` \[rad\] off.
    pub(crate) fn add(&mut self, measured: &Scalar, angle: f64) {
        let last = self.count.checked_sub(1).map(|k| self.seen[k % RECENT]);
        if last.is_none_or(|last| measured.time - last.time >= APART) {
            self.seen[self.count % RECENT] = Seen {
                time: measured.time,
                measured: measured.value,
                angle,
                std: measured.std.max(FLOOR),
            };
            self.count += 1;
        }
    }

    /// What it is compared with turned by so much \[rad\].
    pub(crate) fn turn(&mut self, by: f64) {
        self.kept().iter_mut().for_each(|seen| seen.angle += by);
    }

    /// From `since` to `until` \[s\] the body did not turn: what it is compared with was `azimuth` \[rad\].
    pub(crate) fn at_rest(&mut self, since: f64, until: f64, azimuth: f64) {
        let rest = since..=until;
        let held = self.kept().iter_mut();
        let held = held.filter(|seen| rest.contains(&seen.time));
        held.for_each(|seen| seen.angle = wrap_pi(seen.measured - azimuth));
    }

    /// The angle that more than half of them agree on at `time`, their mean with its standard deviation \[rad\].
    pub(crate) fn agreed(&mut self, time: f64) -> Option<(f64, f64)> {
        let recent = |seen: &&Seen| time - seen.time <= OLD;
        let kept = &*self.kept();
        let count = kept.iter().filter(recent).count();
        let agree = |a: &Seen, b: &Seen| {
            wrap_pi(a.angle - b.angle).abs() < AGREE + 3.0 * a.std.hypot(b.std)
        };
        let with = |a: &Seen| kept.iter().filter(recent).filter(|b| agree(a, b)).count();
        let middle = kept.iter().filter(recent).max_by_key(|a| with(a))?;
        let (mut n, mut off, mut variance) = (0.0_f64, 0.0, 0.0);
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for seen in kept.iter().filter(recent).filter(|b| agree(middle, b)) {
            n += 1.0;
            off += wrap_pi(seen.angle - middle.angle);
            variance += seen.std * seen.std;
            (first, last) = (seen.time.min(first), seen.time.max(last));
        }
        let enough = count >= LEAST && 2 * with(middle) > count && last - first >= LEAST_SPAN;
        // Errors last: no more of them count than there are seconds.
        let independent = n.min(1.0 + (last - first) / LASTS);
        enough.then(|| {
            (
                wrap_pi(middle.angle + off / n),
                (variance / n / independent).sqrt(),
            )
        })
    }
}
