//! Energies of the second differences at m = 1, 2, 4, … in one pass over the record.
//!
//! With `e_m(t)` the sum of the m deviations from t on, the second difference of the prefix sums is
//! `e_m(t + m) − e_m(t)`, and `e_2m(t) = e_m(t + m) + e_m(t)`: the octave below gives both from the
//! same two numbers. Sums of pairs also keep more digits than differences of prefix sums.
//!
//! All octaves live in one array. Each follows the one below at a distance of m, just behind what
//! that one has finished, and overwrites it: the octaves up to m = 1024 stay in the first cache,
//! those up to 65 536 in the second.
//!
//! O(N) additions an octave, but one way through memory for all of them. The Allan variance at τ =
//! m T is the energy over 2 m² (N − 2m + 1).

use pulp::{Arch, Simd, WithSimd};

/// Samples that enter before each octave moves up to the one below.
const STRETCH: usize = 1024;

/// Independent sums in a vector's flight: an addition takes four cycles.
const FLIGHT: usize = 4;

/// Samples spread over the record whose mean is taken off: it only guards the digits of a record far
/// from zero.
const GLANCE: usize = 4096;

/// Σ_t (e_m(t + m) − e_m(t))² over the whole record for m = 2^0 … 2^(octaves − 1), all of them with
/// 2m ≤ samples. Not finite at m = 1 where a sample is not finite.
///
/// `octaves` energies \[unit²\], one for each m.
pub(super) fn energies(rates: &[f64], octaves: usize) -> Vec<f64> {
    let glance = rates.iter().step_by((rates.len() / GLANCE).max(1));
    let centre = glance.clone().sum::<f64>() / glance.len() as f64;
    Arch::new().dispatch(Octaves {
        rates,
        centre,
        octaves,
    })
}

/// The pass over a record, for the width of the processor's vectors.
struct Octaves<'a> {
    rates: &'a [f64],
    /// Taken off every sample.
    centre: f64,
    octaves: usize,
}

impl WithSimd for Octaves<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let mut energies = vec![0.0; self.octaves];
        // How far each octave has come: behind it the array holds the sums of the octave above.
        let mut done = vec![0; self.octaves];
        let mut sums = Vec::with_capacity(self.rates.len());
        for stretch in self.rates.chunks(STRETCH) {
            sums.extend(stretch.iter().map(|rate| rate - self.centre));
            let mut ready = sums.len();
            for (octave, (energy, done)) in energies.iter_mut().zip(&mut done).enumerate() {
                let m = 1 << octave;
                if ready < *done + m {
                    break;
                }
                *energy += climb(simd, &mut sums[*done..ready], m);
                ready -= m;
                *done = ready;
            }
        }
        energies
    }
}

/// Replaces `e_m(t)` by `e_2m(t)` in all of `sums` but the last m, and gives the energy of the
/// differences.
#[inline(always)]
fn climb<S: Simd>(simd: S, sums: &mut [f64], m: usize) -> f64 {
    let group = FLIGHT * S::F64_LANES;
    let count = sums.len() - m;
    let whole = count / group * group;
    let mut flight = [simd.splat_f64s(0.0); FLIGHT];
    for start in (0..whole).step_by(group) {
        // Both are read before either is written: they overlap where m is small.
        let near = vectors::<S>(&sums[start..start + group]);
        let far = vectors::<S>(&sums[start + m..start + m + group]);
        let (above, _) = S::as_mut_simd_f64s(&mut sums[start..start + group]);
        for k in 0..FLIGHT {
            let difference = simd.sub_f64s(far[k], near[k]);
            flight[k] = simd.mul_add_e_f64s(difference, difference, flight[k]);
            above[k] = simd.add_f64s(far[k], near[k]);
        }
    }
    let mut energy: f64 = flight.iter().map(|&v| simd.reduce_sum_f64s(v)).sum();
    for t in whole..count {
        let (near, far) = (sums[t], sums[t + m]);
        energy += (far - near) * (far - near);
        sums[t] = far + near;
    }
    energy
}

/// The vectors of one group of sums.
#[inline(always)]
fn vectors<S: Simd>(sums: &[f64]) -> [S::f64s; FLIGHT] {
    let (vectors, _) = S::as_simd_f64s(sums);
    std::array::from_fn(|k| vectors[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_length_and_every_vector_width_follow_the_definition() {
        for length in [
            2usize, 3, 4, 31, 32, 33, 100, 1023, 1024, 1025, 3072, 5000, 9001,
        ] {
            let rates: Vec<f64> = (0..length).map(|k| (k * 7919 % 1013) as f64).collect();
            let mut sums = vec![0.0];
            for rate in &rates {
                sums.push(sums[sums.len() - 1] + rate);
            }
            let octaves = length.ilog2() as usize;
            let scalar = Octaves {
                rates: &rates,
                centre: 500.0,
                octaves,
            }
            .with_simd(pulp::Scalar);
            let widest = energies(&rates, octaves);
            assert_eq!((scalar.len(), widest.len()), (octaves, octaves));
            for octave in 0..octaves {
                let m = 1 << octave;
                let second = |t: usize| sums[t + 2 * m] - 2.0 * sums[t + m] + sums[t];
                // Whole numbers: exact.
                let energy: f64 = (0..=length - 2 * m).map(|t| second(t).powi(2)).sum();
                for value in [scalar[octave], widest[octave]] {
                    assert!((value - energy).abs() <= 1e-13 * energy, "{length}, {m}");
                }
            }
        }
    }

    #[test]
    fn one_bad_sample_shows_at_the_first_octave() {
        for place in [0, 1, 500, 1023, 1024, 1999] {
            let mut rates = vec![1.0; 2000];
            rates[place] = f64::NAN;
            assert!(!energies(&rates, 1)[0].is_finite());
            rates[place] = f64::INFINITY;
            assert!(!energies(&rates, 5)[0].is_finite());
        }
    }
}
