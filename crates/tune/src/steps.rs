//! A drive condensed for identification: what a replay's filter did, update by update.
//!
//! Between two updates the error of the replay's solution, estimate less truth, moves by a transition that does not
//! depend on the noise, and at an update a known correction is taken out of it. With both, the measurements and the
//! places where noise comes in, the filter can be run again under other noise, as a linear one for the error of that
//! solution: some ten times cheaper than a replay, and differentiable ([`super::objective`]).

use undrift_engine::estimator::{Channel, Logged, LoggedUpdate};
use undrift_nav::{
    Matrix3, Vector3,
    covariance::{AXES, NAV},
};

/// Components of the largest measurement.
pub const MOST: usize = 3;

/// The way from one update to the next, and that update. `N` is the most states there are room for.
#[derive(Clone, Debug)]
pub struct LinearStep<const N: usize> {
    /// Time of the update \[s\].
    pub time: f64,
    /// Since the update before \[s\].
    pub span: f64,
    /// Rows of the transition that lead to the navigation errors.
    pub nav: [[f64; N]; NAV],
    /// Taken out of the error before the update, of what was taken out of the solution on the way.
    pub shift: [f64; N],
    /// Diagonal of the others: sensor states and parameters act on themselves only.
    pub left: [f64; N],
    /// Where noise comes in.
    pub inputs: [Input; AXES],
    /// What the square of each axis's white noise is multiplied by over the step.
    pub shape: [f64; AXES],
    /// What is measured.
    pub channel: Channel,
    /// Number of its components.
    pub size: usize,
    /// Measurement matrix.
    pub h: [[f64; N]; MOST],
    /// Predicted by the solution of the replay less measured.
    pub innovation: [f64; MOST],
    /// Its covariance in the replay, before weakening.
    pub noise: [[f64; MOST]; MOST],
    /// What the replay's gate multiplied that by.
    pub weakened: f64,
    /// Taken out of the solution of the replay after the update.
    pub correction: [f64; N],
}

/// What the error of a sensor's axis drives, per unit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Input {
    /// The misalignment, of a gyro.
    pub attitude: Vector3,
    /// The velocity: of an accelerometer at once, of a gyro by way of the misalignment.
    pub velocity: Vector3,
}

/// What follows one alignment.
#[derive(Clone, Debug)]
pub struct LinearSegment<const N: usize> {
    /// When navigation began \[s\].
    pub start: f64,
    /// Covariance then.
    pub covariance: Box<[[f64; N]; N]>,
    /// Update by update.
    pub steps: Vec<LinearStep<N>>,
    /// For a span without fixes: from a step on, all up to another one as a single step, and that one's place.
    pub without_fixes: Vec<Option<(usize, Box<LinearStep<N>>)>>,
}

/// White noise that follows the vibration: what it is estimated from in the log of a replay.
#[derive(Clone, Copy, Debug)]
pub struct Followed {
    /// Variance of the white noise of a sample by the model \[unit²\].
    pub white: [f64; AXES],
    /// Interval of a sample \[s\].
    pub interval: f64,
    /// Factors on the standard deviation beyond it in the replay.
    pub factors: [f64; AXES],
}

impl Followed {
    /// Density beyond the model's that the samples show [unit²·s].
    fn beyond(&self, variance: &[f64; AXES]) -> [f64; AXES] {
        std::array::from_fn(|i| {
            let beyond = (variance[i] - self.white[i]).max(0.0) * self.interval;
            beyond / (self.factors[i] * self.factors[i])
        })
    }
}

/// Condenses what a replay logged, with what its white noise follows.
pub fn condense<const N: usize>(
    logged: impl IntoIterator<Item = Logged>,
    followed: Option<&Followed>,
) -> Vec<LinearSegment<N>> {
    let mut segments: Vec<LinearSegment<N>> = Vec::new();
    for entry in logged {
        match (entry, segments.last_mut()) {
            (Logged::Start(start, p), _) => {
                let mut covariance = Box::new([[0.0; N]; N]);
                for (i, row) in covariance.iter_mut().enumerate().take(p.nrows()) {
                    for (j, value) in row.iter_mut().enumerate().take(p.ncols()) {
                        *value = p[(i, j)];
                    }
                }
                segments.push(LinearSegment {
                    start,
                    covariance,
                    steps: Vec::new(),
                    without_fixes: Vec::new(),
                });
            }
            (Logged::Update(update), Some(segment)) => {
                let before = segment.steps.last().map_or(segment.start, |step| step.time);
                segment
                    .steps
                    .push(LinearStep::new(&update, before, followed));
            }
            (Logged::Update(_), None) => {}
        }
    }
    for segment in &mut segments {
        segment.without_fixes = without_fixes(&segment.steps);
    }
    segments
}

/// Whether a step ends with a fix.
pub fn is_fix(channel: Channel) -> bool {
    matches!(
        channel,
        Channel::Position | Channel::Velocity | Channel::Attitude
    )
}

/// Longest step that several are made into \[s\].
const LONGEST: f64 = 0.25;

/// Steps that end with fixes joined with the one after them.
fn without_fixes<const N: usize>(
    steps: &[LinearStep<N>],
) -> Vec<Option<(usize, Box<LinearStep<N>>)>> {
    let mut joined: Vec<_> = steps.iter().map(|_| None).collect();
    let mut first = 0;
    while first < steps.len() {
        let mut last = first;
        let mut sum: Option<LinearStep<N>> = None;
        while is_fix(steps[last].channel) && last + 1 < steps.len() {
            let so_far = sum.as_ref().unwrap_or(&steps[first]);
            if so_far.span + steps[last + 1].span > LONGEST {
                break;
            }
            sum = Some(so_far.then(&steps[last + 1]));
            last += 1;
        }
        if let Some(sum) = sum {
            joined[first] = Some((last, Box::new(sum)));
        }
        first = last + 1;
    }
    joined
}

/// Where noise comes in over a step: the means of what the sensors' errors drive, from the transition itself.
fn inputs<const N: usize>(nav: &[[f64; N]; NAV], span: f64) -> [Input; AXES] {
    let column = |at: usize, j: usize| Vector3::from_fn(|i, _| nav[at + i][j] / span);
    // The mean specific force, by which misalignment becomes velocity.
    let force = Matrix3::from_fn(|i, j| nav[3 + i][6 + j] / span);
    std::array::from_fn(|axis| match axis {
        _ if span <= 0.0 => Input::default(),
        0..3 => {
            let attitude = column(6, NAV + axis);
            Input {
                attitude,
                velocity: force * attitude,
            }
        }
        _ => Input {
            attitude: Vector3::zeros(),
            velocity: column(3, NAV + axis),
        },
    })
}

impl<const N: usize> LinearStep<N> {
    /// This one without its update, and the one after it.
    fn then(&self, next: &Self) -> Self {
        let span = self.span + next.span;
        let mut nav = [[0.0; N]; NAV];
        let mut shift = [0.0; N];
        let taken: [f64; N] = std::array::from_fn(|i| self.shift[i] + self.correction[i]);
        for (i, row) in nav.iter_mut().enumerate() {
            for (factor, first) in next.nav[i].iter().zip(&self.nav) {
                for (value, first) in row.iter_mut().zip(first) {
                    *value += factor * first;
                }
            }
            for j in NAV..N {
                row[j] += next.nav[i][j] * self.left[j];
            }
            shift[i] = next.nav[i].iter().zip(&taken).map(|(a, b)| a * b).sum();
        }
        for i in NAV..N {
            shift[i] = next.left[i] * taken[i];
        }
        Self {
            span,
            inputs: inputs(&nav, span),
            shape: std::array::from_fn(|i| {
                let sum = self.shape[i] * self.span + next.shape[i] * next.span;
                sum / span.max(f64::MIN_POSITIVE)
            }),
            nav,
            shift,
            left: std::array::from_fn(|i| self.left[i] * next.left[i]),
            ..next.clone()
        }
    }

    fn new(update: &LoggedUpdate, before: f64, followed: Option<&Followed>) -> Self {
        let n = update.transition.nrows();
        let size = update.innovation.len();
        let span = (update.time - before).max(0.0);
        let t = &update.transition;
        let row = |i: usize| std::array::from_fn(|j| if j < n { t[(i, j)] } else { 0.0 });
        let nav = std::array::from_fn(row);
        Self {
            time: update.time,
            span,
            nav,
            shift: [0.0; N],
            left: std::array::from_fn(|i| if i < n { t[(i, i)] } else { 0.0 }),
            inputs: inputs(&nav, span),
            shape: followed.map_or([1.0; AXES], |followed| followed.beyond(&update.white)),
            channel: update.channel,
            size,
            h: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    if i < size && j < n {
                        update.h[(i, j)]
                    } else {
                        0.0
                    }
                })
            }),
            innovation: std::array::from_fn(|i| update.innovation.get(i).copied().unwrap_or(0.0)),
            noise: std::array::from_fn(|i| {
                std::array::from_fn(|j| match () {
                    () if i < size && j < size => update.noise[(i, j)],
                    () => f64::from(u8::from(i == j)),
                })
            }),
            weakened: update.weakened,
            correction: std::array::from_fn(|i| update.correction.get(i).copied().unwrap_or(0.0)),
        }
    }
}

#[cfg(test)]
mod tests;
