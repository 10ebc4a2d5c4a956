//! The objective: what fixes say of the noise at the end of spans without any.
//!
//! The innovations of a filter that has all fixes see what drifts within one interval of them, which is little beside
//! what the fixes are wrong by. So the drive is cut into windows of several lengths, the fixes inside withheld, and
//! the log-likelihood of those at the end taken: `Σ_h w_h Σ_i −½ (log det S_i + ρ(ν_iᵀ S_i⁻¹ ν_i))`, a composite
//! likelihood (Varin, Reid & Firth 2011). ρ is Huber's loss: a fix that is wrong does not decide. The gradient is
//! exact, by the reverse mode of every window and of the filter that all begin from.

mod drawn;

pub use drawn::{Innovations, normal};

use super::{
    filter::{Done, Fixed, State},
    noise::{COUNT, Noise, Vector},
    steps::{LinearSegment, LinearStep, is_fix},
};
use std::{iter::Sum, ops::AddAssign};
use undrift_base::{interrupt, parallel};
use undrift_engine::estimator::Channel;
use undrift_nav::covariance::four_lanes;

/// How the objective is laid out.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Lengths of the windows \[s\]. All count as much: a window of each length every [`Layout::every`] would.
    pub lengths: [f64; 4],
    /// From start to start of the windows of one length, as a share of it, but not less than [`Layout::least`] \[s\].
    pub stagger: f64,
    /// See [`Layout::stagger`].
    pub least: f64,
    /// For every so many seconds each length counts as one window \[s\].
    pub every: f64,
    /// What the innovations of the filter that has all fixes count, of what windows of one length do.
    pub innovations: f64,
    /// Windows begin so long after the alignment \[s\].
    pub settled: f64,
    /// Square root of the NIS per measurement of three components beyond which a fix counts for less.
    pub huber: f64,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            lengths: [1.0, 3.0, 10.0, 30.0],
            stagger: 1.0 / 3.0,
            least: 3.0,
            every: 10.0,
            innovations: 0.5,
            settled: 30.0,
            huber: 4.0,
        }
    }
}

impl Layout {
    /// Of poses, which come often and show the white noise of gyros within tenths of a second, that of accelerometers within
    /// seconds, and whose solution settles at once.
    pub const OF_POSES: Self = Self {
        lengths: [0.3, 1.0, 3.0, 10.0],
        stagger: 1.0 / 3.0,
        least: 0.3,
        every: 3.0,
        innovations: 0.5,
        settled: 10.0,
        huber: 4.0,
    };
}

/// A span without fixes.
#[derive(Clone, Copy, Debug)]
struct Window {
    segment: usize,
    /// The update that it begins after.
    from: usize,
    /// When it ends \[s\]: the first fix then or later is scored.
    until: f64,
    weight: f64,
}

/// A condensed drive and the windows on it.
pub struct Objective<const N: usize> {
    segments: Vec<LinearSegment<N>>,
    fixed: Fixed,
    plan: Layout,
    windows: Vec<Window>,
    /// Weight of each fix in the filter that has all.
    every_fix: f64,
}

/// Value and gradient.
#[derive(Clone, Debug)]
pub struct Score {
    /// The objective: larger is better.
    pub value: f64,
    /// Its derivative by the logarithms.
    pub gradient: Vector,
}

impl Score {
    /// Of nothing.
    pub const ZERO: Self = Self {
        value: 0.0,
        gradient: [0.0; COUNT],
    };
}

impl AddAssign<&Score> for Score {
    fn add_assign(&mut self, other: &Score) {
        self.value += other.value;
        for (sum, part) in self.gradient.iter_mut().zip(other.gradient) {
            *sum += part;
        }
    }
}

impl Sum for Score {
    fn sum<I: Iterator<Item = Self>>(scores: I) -> Self {
        scores.fold(Self::ZERO, |mut sum, score| {
            sum += &score;
            sum
        })
    }
}

/// Where a step of a window is: among all, or among those that are joined.
enum WindowStep {
    Own(usize),
    Joined(usize),
}

/// An update, and where it is scored its weight and the derivative of its loss.
type Scored<const N: usize> = (Done<N>, Option<(f64, f64)>);

/// Times closer than this are the same \[s\].
const ROUNDING: f64 = 1e-6;

/// What a window brings to the filter that it begins from.
struct Seed<const N: usize> {
    from: usize,
    state: State<N>,
}

impl<const N: usize> Objective<N> {
    /// Of condensed replays.
    pub fn new(segments: Vec<LinearSegment<N>>, fixed: Fixed, plan: Layout) -> Self {
        let mut windows = Vec::new();
        let (mut fixes, mut span) = (0_u32, 0.0);
        for (index, segment) in segments.iter().enumerate() {
            let settled = segment.start + plan.settled;
            let last = segment.steps.iter().rfind(|step| is_fix(step.channel));
            let end = last.map_or(f64::NEG_INFINITY, |step| step.time);
            span += (end - settled).max(0.0);
            let scored = |step: &&LinearStep<N>| is_fix(step.channel) && step.time >= settled;
            fixes += segment.steps.iter().filter(scored).count() as u32;
            for length in plan.lengths {
                let every = (plan.stagger * length).max(plan.least);
                let mut next = settled;
                for (from, step) in segment.steps.iter().enumerate() {
                    let until = step.time + length;
                    if step.channel == Channel::Position && step.time >= next && until <= end {
                        let attitude = segment.steps.get(from + 1).is_some_and(|other| {
                            other.channel == Channel::Attitude && other.time - step.time < ROUNDING
                        });
                        windows.push(Window {
                            segment: index,
                            // The whole pose is known where the cut begins.
                            from: from + usize::from(attitude),
                            until,
                            weight: every / plan.every,
                        });
                        next = step.time + every;
                    }
                }
            }
        }
        let every_fix = plan.innovations * span / plan.every / f64::from(fixes.max(1));
        Self {
            segments,
            fixed,
            plan,
            windows,
            every_fix,
        }
    }

    /// Number of windows.
    pub fn windows(&self) -> usize {
        self.windows.len()
    }

    /// Value and gradient under a noise.
    pub fn score(&self, noise: &Noise) -> Score {
        self.score_between(noise, f64::NEG_INFINITY, f64::INFINITY)
    }

    /// First and last time that anything is scored at or begins from \[s\].
    pub fn span(&self) -> Option<(f64, f64)> {
        let times = |segment: &LinearSegment<N>| {
            let last = segment.steps.last()?.time;
            Some((segment.start + self.plan.settled, last))
        };
        let spans = self.segments.iter().filter_map(times);
        spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Of the windows that begin, and the fixes, from one time to before another \[s\].
    pub fn score_between(&self, noise: &Noise, from: f64, to: f64) -> Score {
        let parts = parallel::map(self.segments.len(), |index| {
            interrupt::check();
            four_lanes(
                #[inline(always)]
                || self.segment(index, noise, (from, to)),
            )
        });
        parts.into_iter().sum()
    }

    #[inline(always)]
    fn segment(&self, index: usize, noise: &Noise, (from, to): (f64, f64)) -> Score {
        let segment = &self.segments[index];
        let settled = segment.start + self.plan.settled;
        let within = |time: f64| time >= from && time < to;
        let is_scored = |step: &LinearStep<N>| {
            is_fix(step.channel) && step.time >= settled && within(step.time)
        };
        let mut score = Score::ZERO;
        let mut state = State {
            x: [0.0; N],
            p: *segment.covariance,
        };
        let mut done: Vec<Option<Done<N>>> = Vec::with_capacity(segment.steps.len());
        let mut windows = self
            .windows
            .iter()
            .filter(|w| w.segment == index && within(segment.steps[w.from].time))
            .collect::<Vec<_>>();
        windows.sort_by_key(|w| w.from);
        let mut starts = Vec::with_capacity(windows.len());
        let mut next = 0;
        for (k, step) in segment.steps.iter().enumerate() {
            state.predict(step, noise, &self.fixed);
            let update = state.update(step, noise, &self.fixed);
            if is_scored(step) {
                let (loss, _) = update.as_ref().map_or((0.0, 0.0), |u| self.loss(u, step));
                score.value += self.every_fix * loss;
            }
            if update.is_none() {
                state.skip(step);
                // The covariance has lost its definiteness: the search must turn back.
                score.value = f64::NEG_INFINITY;
            }
            done.push(update);
            while next < windows.len() && windows[next].from == k {
                starts.push((windows[next], state.clone()));
                next += 1;
            }
        }
        let mut seeds = parallel::map(starts.len(), |k| {
            let (window, state) = &starts[k];
            four_lanes(
                #[inline(always)]
                || self.window(segment, window, state.clone(), noise),
            )
        });
        for (own, _) in &seeds {
            score += own;
        }
        // Back through the filter that all begin from.
        let mut bar = State {
            x: [0.0; N],
            p: [[0.0; N]; N],
        };
        for (k, step) in segment.steps.iter().enumerate().rev() {
            while seeds.last().is_some_and(|(_, seed)| seed.from == k) {
                if let Some((_, seed)) = seeds.pop() {
                    bar.add(&seed.state);
                }
            }
            if let Some(update) = &done[k] {
                let scored = is_scored(step).then(|| (self.every_fix, self.loss(update, step).1));
                let gradient = &mut score.gradient;
                bar.back_update(step, update, scored, noise, &self.fixed, gradient);
            }
            bar.back_predict(step, noise, &self.fixed, &mut score.gradient);
        }
        score
    }

    /// A window: its value, its gradient, and what it brings to where it begins.
    #[inline(always)]
    fn window(
        &self,
        segment: &LinearSegment<N>,
        window: &Window,
        mut state: State<N>,
        noise: &Noise,
    ) -> (Score, Seed<N>) {
        let mut score = Score::ZERO;
        let mut done: Vec<(WindowStep, Option<Scored<N>>)> = Vec::new();
        let mut scored = [false; 3];
        let mut next = window.from + 1;
        while next < segment.steps.len() {
            let mut k = next;
            let mut step = &segment.steps[k];
            let mut joined = false;
            if let Some((last, sum)) = &segment.without_fixes[k]
                && sum.time < window.until - ROUNDING
            {
                (k, step, joined) = (*last, &**sum, true);
            }
            let place = if joined {
                WindowStep::Joined(next)
            } else {
                WindowStep::Own(k)
            };
            next = k + 1;
            state.predict(step, noise, &self.fixed);
            let which = match step.channel {
                Channel::Velocity => 1,
                Channel::Attitude => 2,
                _ => 0,
            };
            let ends = is_fix(step.channel) && step.time >= window.until - ROUNDING;
            // The other part of the same fix, or of the next; not for ever.
            let over = ends && scored[which];
            if is_fix(step.channel) && !ends || over {
                state.skip(step);
                done.push((place, None));
                if over {
                    break;
                }
                continue;
            }
            let Some(update) = state.update(step, noise, &self.fixed) else {
                state.skip(step);
                done.push((place, None));
                score.value = f64::NEG_INFINITY;
                continue;
            };
            let mut own = None;
            if ends {
                let (loss, c) = self.loss(&update, step);
                score.value += window.weight * loss;
                own = Some((window.weight, c));
                scored[which] = true;
            }
            done.push((place, Some((update, own))));
            if scored[..2] == [true; 2] {
                break;
            }
        }
        let mut bar = State {
            x: [0.0; N],
            p: [[0.0; N]; N],
        };
        for (place, update) in done.iter().rev() {
            let step = match place {
                WindowStep::Own(k) => &segment.steps[*k],
                WindowStep::Joined(k) => match &segment.without_fixes[*k] {
                    Some((_, sum)) => &**sum,
                    None => continue,
                },
            };
            if let Some((update, scored)) = update {
                let gradient = &mut score.gradient;
                bar.back_update(step, update, *scored, noise, &self.fixed, gradient);
            }
            bar.back_predict(step, noise, &self.fixed, &mut score.gradient);
        }
        let seed = Seed {
            from: window.from,
            state: bar,
        };
        (score, seed)
    }

    /// Log-likelihood of a measurement, and the derivative of its loss.
    fn loss(&self, done: &Done<N>, step: &LinearStep<N>) -> (f64, f64) {
        // The same share of right measurements lies beyond it, whatever the number of components.
        let limit = self.plan.huber * self.plan.huber * step.size as f64 / 3.0;
        let (rho, c) = if done.nis <= limit {
            (done.nis, 1.0)
        } else {
            let root = (done.nis * limit).sqrt();
            (2.0 * root - limit, (limit / done.nis).sqrt())
        };
        (-0.5 * (done.ln_det + rho), c)
    }
}

impl<const N: usize> State<N> {
    fn add(&mut self, other: &Self) {
        for (sum, part) in self.x.iter_mut().zip(&other.x) {
            *sum += part;
        }
        for (sum, part) in self
            .p
            .as_flattened_mut()
            .iter_mut()
            .zip(other.p.as_flattened())
        {
            *sum += part;
        }
    }
}
