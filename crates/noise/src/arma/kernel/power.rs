//! Powers summed over a rational spectrum.

use super::{
    LANES, Row,
    vector::{Task, total, vectorised},
};

/// Powers at frequencies, sixteen to a row.
#[derive(Default)]
pub(crate) struct PowerSum {
    count: usize,
    /// cos ω, sin ω and the power.
    rows: Vec<[Row; 3]>,
}

impl PowerSum {
    /// Adds a frequency [rad/sample].
    pub(crate) fn push(&mut self, omega: f64, power: f64) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.rows.push([[1.0; LANES], [0.0; LANES], [0.0; LANES]]);
        }
        if let Some(row) = self.rows.last_mut() {
            (row[1][lane], row[0][lane]) = omega.sin_cos();
            row[2][lane] = power;
        }
        self.count += 1;
    }

    /// Σ power |φ|²/|θ|², and |θ|²/|φ|² at the frequency `at`.
    pub(crate) fn over(&self, phi: &[f64], theta: &[f64], at: f64) -> (f64, f64) {
        let sum = vectorised(Sum {
            phi,
            theta,
            rows: &self.rows,
        });
        (total(sum), Self::gain(phi, theta, at))
    }

    /// |θ|²/|φ|² at a frequency [rad/sample].
    pub(crate) fn gain(phi: &[f64], theta: &[f64], at: f64) -> f64 {
        let (sin, cos) = at.sin_cos();
        let one = |c: &[f64]| squared::<false, 1>(c, &[cos], &[sin])[0];
        one(theta) / one(phi)
    }
}

struct Sum<'a> {
    phi: &'a [f64],
    theta: &'a [f64],
    rows: &'a [[Row; 3]],
}

impl Task for Sum<'_> {
    type Output = Row;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Row {
        let mut sum = [0.0; LANES];
        for [cos, sin, power] in self.rows {
            let above = squared::<FUSED, LANES>(self.phi, cos, sin);
            let below = squared::<FUSED, LANES>(self.theta, cos, sin);
            for l in 0..LANES {
                sum[l] += power[l] * (above[l] / below[l]);
            }
        }
        sum
    }
}

/// |1 − c1 w − … − cn wⁿ|² at w = cos − i sin, by Horner's rule.
#[inline(always)]
fn squared<const FUSED: bool, const L: usize>(
    c: &[f64],
    cos: &[f64; L],
    sin: &[f64; L],
) -> [f64; L] {
    let (mut re, mut im) = ([0.0; L], [0.0; L]);
    for c in c.iter().rev() {
        for l in 0..L {
            let a = re[l] - c;
            let b = im[l];
            if FUSED {
                re[l] = a.mul_add(cos[l], b * sin[l]);
                im[l] = b.mul_add(cos[l], -(a * sin[l]));
            } else {
                re[l] = a * cos[l] + b * sin[l];
                im[l] = b * cos[l] - a * sin[l];
            }
        }
    }
    let mut out = [0.0; L];
    for l in 0..L {
        let a = 1.0 + re[l];
        out[l] = a * a + im[l] * im[l];
    }
    out
}
