//! Real FFTs of one length with the room that they need.
//!
//! A block of L samples is transformed in 2L, zeros after it, so that of a circular correlation the first L
//! outputs are those of the linear one. Lengths are even; the inverse is not normalised, and `add_samples`
//! divides.
//!
//! Used for autocorrelations ([`crate::correlation`]) and for Allan deviations at every averaging
//! factor: sums Σ x_t y_{t+k} for all lags k of a block cost O(L log L) instead of O(L²). Memory is
//! that of one block whatever the length of the record; each thread needs a [`Room`] of its own.

use realfft::num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// 0 + 0i.
pub(crate) const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// The transforms of one block length.
pub(crate) struct Transform {
    /// L, the samples of a block.
    pub(crate) block: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Room for one transform.
pub(crate) struct Room {
    time: Vec<f64>,
    scratch: Vec<Complex64>,
}

impl Transform {
    /// `planner` caches the plans, so that transforms of one length share their tables.
    pub(crate) fn new(block: usize, planner: &mut RealFftPlanner<f64>) -> Self {
        Self {
            block,
            forward: planner.plan_fft_forward(2 * block),
            inverse: planner.plan_fft_inverse(2 * block),
        }
    }

    /// One for each thread; a transform changes nothing but its room.
    pub(crate) fn room(&self) -> Room {
        let scratch = self.forward.get_scratch_len();
        Room {
            time: vec![0.0; 2 * self.block],
            scratch: vec![ZERO; scratch.max(self.inverse.get_scratch_len())],
        }
    }

    /// A spectrum of L + 1 zeros, to be filled or added to.
    pub(crate) fn empty(&self) -> Vec<Complex64> {
        vec![ZERO; self.block + 1]
    }

    /// Spectrum of at most two blocks of samples, zeros after them.
    ///
    /// `spectrum` has L + 1 elements, those of frequencies 0 to half the sample rate.
    pub(crate) fn spectrum(&self, part: &[f64], room: &mut Room, spectrum: &mut [Complex64]) {
        let (filled, rest) = room.time.split_at_mut(part.len());
        filled.copy_from_slice(part);
        rest.fill(0.0);
        // The buffers have the plan's own sizes: this cannot fail.
        let time = &mut room.time;
        let _ = (self.forward).process_with_scratch(time, spectrum, &mut room.scratch);
    }

    /// Adds the first block of a spectrum's samples to `out`.
    ///
    /// `spectrum` is used as working space: its contents are lost.
    pub(crate) fn add_samples(&self, spectrum: &mut [Complex64], room: &mut Room, out: &mut [f64]) {
        // Rounding leaves a trace of an imaginary part where there can be none.
        (spectrum[0].im, spectrum[self.block].im) = (0.0, 0.0);
        let time = &mut room.time;
        let _ = (self.inverse).process_with_scratch(spectrum, time, &mut room.scratch);
        let scale = 0.5 / self.block as f64;
        for (slot, value) in out.iter_mut().zip(&room.time[..self.block]) {
            *slot += value * scale;
        }
    }
}

/// Adds the spectrum of the correlation of two series to `sum`.
///
/// `sum += a* b`; its inverse transform is Σ_t a_t b_{t+k}.
pub(crate) fn add_product(sum: &mut [Complex64], a: &[Complex64], b: &[Complex64]) {
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum += a.conj() * b;
    }
}
