//! A Kalman filter of its own for models of one axis: the linear system that a model file or a known process is, and how far its
//! predictions of the integrated signal are off, as in the textbooks, sample by sample, with nothing of the product.

use undrift_noise::AxisModel;

/// x⁺ = F x + w, y = H x + v, with the covariances Q of w, S of w with v, R of v, and P0 of the first x.
#[derive(Clone)]
pub struct System {
    pub f: Vec<Vec<f64>>,
    pub h: Vec<f64>,
    pub q: Vec<Vec<f64>>,
    pub s: Vec<f64>,
    pub r: f64,
    pub p0: Vec<Vec<f64>>,
}

/// RMS of the errors at a horizon, and what the filter expects of it [unit·s].
#[derive(Clone, Copy, Default)]
pub struct Drift {
    pub real: f64,
    pub predicted: f64,
}

impl System {
    /// No states, white noise of a density N at an interval [s].
    pub fn white(density: f64, interval: f64) -> Self {
        Self {
            f: vec![],
            h: vec![],
            q: vec![],
            s: vec![],
            r: density * density / interval,
            p0: vec![],
        }
    }

    /// One state.
    fn one(f: f64, q: f64, s: f64, r: f64, p0: f64) -> Self {
        Self {
            f: vec![vec![f]],
            h: vec![1.0],
            q: vec![vec![q]],
            s: vec![s],
            r,
            p0: vec![vec![p0]],
        }
    }

    pub fn gauss_markov(sigma: f64, tau_s: f64, interval: f64) -> Self {
        let f = (-interval / tau_s).exp();
        let variance = sigma * sigma;
        Self::one(
            f,
            -variance * (-2.0 * interval / tau_s).exp_m1(),
            0.0,
            0.0,
            variance,
        )
    }

    pub fn walk(k: f64, interval: f64) -> Self {
        Self::one(1.0, k * k * interval, 0.0, 0.0, 0.0)
    }

    /// A constant that nothing is known of.
    pub fn constant(sigma: f64) -> Self {
        Self::one(1.0, 0.0, 0.0, 0.0, sigma * sigma)
    }

    /// y_t − Σ ar y = σ (a_t − Σ ma a), stationary; one with a unit root starts at 0.
    pub fn arma(ar: &[f64], ma: &[f64], sigma: f64) -> Self {
        let n = ar.len().max(ma.len());
        let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(0.0);
        let g: Vec<f64> = (0..n).map(|i| (at(ar, i) - at(ma, i)) * sigma).collect();
        let mut f = vec![vec![0.0; n]; n];
        for i in 0..n {
            f[i][0] = at(ar, i);
            if i + 1 < n {
                f[i][i + 1] = 1.0;
            }
        }
        let q: Vec<Vec<f64>> = g
            .iter()
            .map(|a| g.iter().map(|b| a * b).collect())
            .collect();
        let p0 = stationary(&f, &q);
        let mut h = vec![0.0; n];
        h[0] = 1.0;
        Self {
            s: g.iter().map(|a| a * sigma).collect(),
            f,
            h,
            q,
            r: sigma * sigma,
            p0,
        }
    }

    /// What an axis of a model file says, at an interval [s]; its turn-on constant is not in it.
    pub fn from_file(axis: &AxisModel, interval: f64) -> Self {
        if let Some(arma) = &axis.arma {
            return Self::arma(&arma.ar, &arma.ma, arma.sigma);
        }
        let mut sum = Self::white(axis.white.unwrap_or(0.0), interval);
        for of in &axis.instability {
            sum = sum.plus(&Self::gauss_markov(of.sigma, of.tau_s, interval));
        }
        if let Some(k) = axis.random_walk {
            sum = sum.plus(&Self::walk(k, interval));
        }
        if let Some(q) = axis.quantisation {
            let variance = (q / interval).powi(2);
            sum = sum.plus(&Self::one(0.0, variance, -variance, variance, variance));
        }
        sum
    }

    /// Both, independent of each other.
    pub fn plus(&self, other: &Self) -> Self {
        let (a, b) = (self.h.len(), other.h.len());
        let join = |x: &[Vec<f64>], y: &[Vec<f64>]| {
            let top = x.iter().map(|row| [row.clone(), vec![0.0; b]].concat());
            let low = y.iter().map(|row| [vec![0.0; a], row.clone()].concat());
            top.chain(low).collect()
        };
        Self {
            f: join(&self.f, &other.f),
            h: [&self.h[..], &other.h].concat(),
            q: join(&self.q, &other.q),
            s: [&self.s[..], &other.s].concat(),
            r: self.r + other.r,
            p0: join(&self.p0, &other.p0),
        }
    }

    /// Of k samples to come: the row that takes the state to their sum, and the variance of the sum beside it.
    fn ahead(&self, k: usize) -> (Vec<f64>, f64) {
        let n = self.h.len();
        let (mut row, mut variance) = (vec![0.0; n], 0.0);
        for _ in 0..k {
            variance += self.r;
            for i in 0..n {
                variance += 2.0 * row[i] * self.s[i];
                for j in 0..n {
                    variance += row[i] * self.q[i][j] * row[j];
                }
            }
            let through = |j: usize| (0..n).map(|i| row[i] * self.f[i][j]).sum::<f64>();
            row = (0..n).map(|j| self.h[j] + through(j)).collect();
        }
        (row, variance)
    }

    /// The drift over each horizon [s] on series that start alike, from the sample `first` on.
    pub fn drift(
        &self,
        series: &[Vec<f64>],
        interval: f64,
        first: usize,
        horizons: &[f64],
    ) -> Vec<Drift> {
        let n = self.h.len();
        let length = series[0].len();
        let steps: Vec<usize> = horizons
            .iter()
            .map(|h| (h / interval).round() as usize)
            .collect();
        let ahead: Vec<(Vec<f64>, f64)> = steps.iter().map(|k| self.ahead(*k)).collect();
        let sums: Vec<Vec<f64>> = series.iter().map(|of| running(of)).collect();
        let every = ((2.0 / interval).round() as usize).max(1);
        let is_diagonal = (0..n).all(|i| (0..n).all(|j| i == j || self.f[i][j] == 0.0));
        let mut p = self.p0.clone();
        let mut x = vec![vec![0.0; n]; series.len()];
        let mut out = vec![(0.0, 0.0, 0.0); horizons.len()];
        let (mut ph, mut gain) = (vec![0.0; n], vec![0.0; n]);
        let mut carried = vec![vec![0.0; n]; n];
        for t in 0..length {
            if t >= first && t % every == 0 {
                for (h, (row, own)) in ahead.iter().enumerate() {
                    if t + steps[h] > length {
                        continue;
                    }
                    let mut variance = *own;
                    for i in 0..n {
                        for j in 0..n {
                            variance += row[i] * p[i][j] * row[j];
                        }
                    }
                    for (state, sum) in x.iter().zip(&sums) {
                        let found: f64 = row.iter().zip(state).map(|(a, b)| a * b).sum();
                        let error = sum[t + steps[h]] - sum[t] - found;
                        out[h].0 += error * error;
                        out[h].1 += variance;
                        out[h].2 += 1.0;
                    }
                }
            }
            for i in 0..n {
                ph[i] = (0..n).map(|j| p[i][j] * self.h[j]).sum();
            }
            let v = self.r + (0..n).map(|i| self.h[i] * ph[i]).sum::<f64>();
            for i in 0..n {
                let fp = if is_diagonal {
                    self.f[i][i] * ph[i]
                } else {
                    (0..n).map(|j| self.f[i][j] * ph[j]).sum()
                };
                gain[i] = (fp + self.s[i]) / v;
            }
            for (state, of) in x.iter_mut().zip(series) {
                let error = of[t] - (0..n).map(|i| self.h[i] * state[i]).sum::<f64>();
                let next: Vec<f64> = (0..n)
                    .map(|i| {
                        let moved = if is_diagonal {
                            self.f[i][i] * state[i]
                        } else {
                            (0..n).map(|j| self.f[i][j] * state[j]).sum()
                        };
                        moved + gain[i] * error
                    })
                    .collect();
                *state = next;
            }
            if is_diagonal {
                for i in 0..n {
                    for j in 0..=i {
                        let value = self.f[i][i] * p[i][j] * self.f[j][j] + self.q[i][j]
                            - v * gain[i] * gain[j];
                        p[i][j] = value;
                        p[j][i] = value;
                    }
                }
            } else {
                for i in 0..n {
                    for j in 0..n {
                        carried[i][j] = (0..n).map(|k| self.f[i][k] * p[k][j]).sum();
                    }
                }
                for i in 0..n {
                    for j in 0..n {
                        let moved: f64 = (0..n).map(|k| carried[i][k] * self.f[j][k]).sum();
                        p[i][j] = moved + self.q[i][j] - v * gain[i] * gain[j];
                    }
                }
            }
        }
        let drift = |(squares, variances, count): (f64, f64, f64)| Drift {
            real: interval * (squares / count).sqrt(),
            predicted: interval * (variances / count).sqrt(),
        };
        out.into_iter().map(drift).collect()
    }
}

/// Sums of all samples before each.
fn running(series: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut sums = vec![0.0];
    sums.extend(series.iter().map(|x| {
        sum += x;
        sum
    }));
    sums
}

/// P = F P Fᵀ + Q by doubling; 0 where there is no such P.
fn stationary(f: &[Vec<f64>], q: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = f.len();
    let product = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let of = |i: usize, j: usize| (0..n).map(|k| a[i][k] * b[k][j]).sum();
        (0..n).map(|i| (0..n).map(|j| of(i, j)).collect()).collect()
    };
    let (mut f, mut p) = (f.to_vec(), q.to_vec());
    for _ in 0..50 {
        let turned: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f[j][i]).collect()).collect();
        let more = product(&product(&f, &p), &turned);
        for i in 0..n {
            for j in 0..n {
                p[i][j] += more[i][j];
            }
        }
        f = product(&f, &f);
    }
    let settled = f.iter().flatten().all(|x| x.abs() < 1e-6);
    if settled { p } else { vec![vec![0.0; n]; n] }
}
