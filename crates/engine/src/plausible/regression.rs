//! Regressions of what fixes show on what sensors measure, and how much of it is enough to judge by.

use core::ops::Range;
use nalgebra::Matrix3;
use undrift_nav::Vector3;

/// Sum of squares of the turns that is enough to judge by \[rad²\]: one right-angle bend.
pub(super) const ENOUGH_TURN: f64 = 0.25;
/// Multiples of the gyros' turns that the course may turn by: a bank makes 1/cos of it.
pub(super) const TURN_SCALE: Range<f64> = 0.6..1.7;
/// Sum of squares of the accelerations that is enough to judge by \[m²/s⁴\]: some ten seconds of 0.5 m/s².
pub(super) const ENOUGH_PUSH: f64 = 2.5;

/// Sums of a regression of y on x with means.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Regression {
    /// Pairs so far.
    pub(super) n: f64,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) xx: f64,
    pub(super) xy: f64,
    pub(super) yy: f64,
}

impl Regression {
    /// Sums are of raw values: windows are short, so that their means are small against their
    /// scatter.
    pub(super) fn add(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// Takes in the pairs of another.
    pub(super) fn join(&mut self, other: &Self) {
        self.n += other.n;
        self.x += other.x;
        self.y += other.y;
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
    }

    /// Sum of squares of y that the regression leaves.
    pub(super) fn left(&self) -> f64 {
        self.power() * (1.0 - self.fit().1)
    }

    /// Sum of squares of y about its mean.
    pub(super) fn power(&self) -> f64 {
        self.yy - self.y * self.y / self.n.max(1.0)
    }

    /// Slope and coefficient of determination; zeros where x does not vary.
    ///
    /// By sums about the means: a bias of the gyros and a drift of the course do not count.
    pub(super) fn fit(&self) -> (f64, f64) {
        let n = self.n.max(1.0);
        let (xx, xy) = (self.xx - self.x * self.x / n, self.xy - self.x * self.y / n);
        let yy = self.power();
        if xx > 1e-12 && yy > 1e-12 {
            (xy / xx, xy * xy / (xx * yy))
        } else {
            (0.0, 0.0)
        }
    }

    /// Number of pairs, and the coefficient of determination.
    pub(super) fn determined(&self) -> (f64, f64) {
        (self.n.max(1.0), self.fit().1)
    }
}

/// Sums of a regression of y on three x with means.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct OnForce {
    n: f64,
    x: Vector3,
    y: f64,
    xx: Matrix3<f64>,
    xy: Vector3,
    yy: f64,
}

impl OnForce {
    pub(super) fn add(&mut self, x: &Vector3, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x.transpose();
        self.xy += x * y;
        self.yy += y * y;
    }

    /// Sum of squares of y about its mean.
    pub(super) fn power(&self) -> f64 {
        self.yy - self.y * self.y / self.count()
    }

    /// Number of pairs, and the coefficient of determination.
    pub(super) fn determined(&self) -> (f64, f64) {
        let (n, power) = (self.count(), self.power());
        let xx = self.xx - self.x * self.x.transpose() / n;
        let xy = self.xy - self.x * (self.y / n);
        let explained = xx
            .try_inverse()
            .map_or(0.0, |inverse| xy.dot(&(inverse * xy)));
        match power > 1e-12 {
            true => (n, explained / power),
            false => (n, 0.0),
        }
    }

    fn count(&self) -> f64 {
        self.n.max(1.0)
    }
}
