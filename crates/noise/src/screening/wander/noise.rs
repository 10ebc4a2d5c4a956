//! Noises under which averages of a level are looked at, and columns that they whiten.

/// The noise under which averages are looked at: white noise of variance 1 and a slow part.
///
/// The slow part is an AR(1) of averages, a walk where its memory is infinite, with a scalar Kalman filter's
/// gains computed once: they depend on what is missing, not on values.
pub(super) struct Noise {
    /// Part of the slow noise that is left after an average.
    left: f64,
    /// 1/√F of each innovation, 0 where the average is missing, and the gain.
    pub(super) weights: Vec<(f64, f64)>,
    pub(super) log_determinant: f64,
}

impl Noise {
    /// The noise of a drive and a correlation time in averages.
    pub(super) fn new(drive: f64, memory: f64, present: &[bool]) -> Self {
        let left = (-1.0 / memory).exp();
        // An average of a walk is later than its end by a third of its steps: as much negative white noise.
        let white = 1.0 - drive / 6.0;
        let mut variance = match left < 1.0 {
            true => drive / (1.0 - left * left),
            false => 0.5 * drive,
        };
        let mut log_determinant = 0.0;
        let weights = present.iter().map(|is_present| {
            let (mut weight, mut gain) = (0.0, 0.0);
            if *is_present {
                let innovation = variance + white;
                log_determinant += innovation.ln();
                (weight, gain) = (innovation.sqrt().recip(), left * variance / innovation);
                variance -= variance * variance / innovation;
            }
            variance = left * left * variance + drive;
            (weight, gain)
        });
        Self {
            left,
            weights: weights.collect(),
            log_determinant,
        }
    }

    /// The innovations of a series over their standard deviations.
    ///
    /// 0 where the average is missing.
    pub(super) fn whitened(&self, series: &[f64]) -> Vec<f64> {
        let mut state = 0.0;
        let whitened_value = |(value, &(weight, gain)): (&f64, &(f64, f64))| {
            let error = if weight > 0.0 { value - state } else { 0.0 };
            state = self.left * state + gain * error;
            weight * error
        };
        series
            .iter()
            .zip(&self.weights)
            .map(whitened_value)
            .collect()
    }

    /// The products of a whitened series with whitened steps at every place.
    ///
    /// One backward recursion gives all places: a step from k on is the sum of what starts there and what a
    /// step from k + 1 on is.
    pub(super) fn with_steps(&self, whitened: &[f64]) -> Vec<f64> {
        let (mut carried, mut sum) = (0.0, 0.0);
        let product = |(value, &(weight, gain)): (&f64, &(f64, f64))| {
            let error = if weight > 0.0 {
                weight * value + gain * carried
            } else {
                0.0
            };
            carried = self.left * carried - error;
            sum += error;
            sum
        };
        let back = whitened.iter().zip(&self.weights).rev();
        let mut products: Vec<f64> = back.map(product).collect();
        products.reverse();
        products
    }

    /// The sums of squares of whitened steps at every place.
    pub(super) fn squares_of_steps(&self) -> Vec<f64> {
        // Of an error u at a place, what follows is a u² + 2 b u + c.
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        let returned = 1.0 - self.left;
        let square = |&(weight, gain): &(f64, f64)| {
            let kept = self.left - gain;
            c += returned * (a * returned + 2.0 * b);
            b = kept * (a * returned + b);
            a = weight * weight + kept * kept * a;
            a + 2.0 * b + c
        };
        let mut squares: Vec<f64> = self.weights.iter().rev().map(square).collect();
        squares.reverse();
        squares
    }
}

/// Scalar product.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Takes the part along orthonormal columns out of one.
pub(super) fn orthogonal(mut column: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    for other in basis {
        let along = dot(&column, other);
        column
            .iter_mut()
            .zip(other)
            .for_each(|(x, b)| *x -= along * b);
    }
    column
}

/// A column's orthogonal part over its length; nothing where it hardly has one.
pub(super) fn normalised(column: Vec<f64>, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
    let before = dot(&column, &column);
    let column = orthogonal(column, basis);
    let squares = dot(&column, &column);
    let length = squares.sqrt();
    (squares > 1e-9 * before).then(|| column.iter().map(|x| x / length).collect())
}
