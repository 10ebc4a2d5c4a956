//! What fixes are wrong by, as they show it themselves: no inertial sensor is asked.
//!
//! A receiver measures position and velocity in different ways. What its positions move by less what its velocities
//! integrate to, `e(t + L) − e(t)`, has half the mean square
//!
//! ```text
//! γ(L) = σ_w² + σ_c² (1 − exp(−L/τ)) + what the velocities are wrong by
//! ```
//!
//! the structure function of a white and a Gauss-Markov part (IEEE Std 1293 annex; Papoulis 1991, section 10). Over one
//! interval it is the white part, over long spans it grows to the whole. Medians stand for the means, so that outliers
//! and jumps do not count. The velocities' own error grows with L, so γ never says more of the whole than the fixes do:
//! white and correlated part together have the stated variance, unless the white part alone is larger.
//!
//! Positions alone show their white part in their third differences (`derived::white_variance`). What else they state lasts, and
//! for how long they cannot show.
//!
//! What follows for the filter is [`FixErrors`]: a factor on the stated standard deviation, a
//! time-correlated share with its correlation time, the step of rounded coordinates, jitter of the
//! stamps, a bias of the velocity. Limits: 80 fixes with velocities, 20 without; errors that
//! position and velocity share do not show, since differences of the two are all that is looked at.

mod track;
mod watch;

use track::{Seen, Track};
pub(crate) use watch::FixWatch;

use crate::{
    derived::white_variance,
    measurement::Repeats,
    median::median,
    settings::fix_errors::{Correlated, FixErrors, FromFixes},
};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters},
    sample::GnssFix,
};

/// Findings on the fixes of a log from the fixes alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct FixStudy {
    /// Median interval of the fixes that repeat none before \[s\].
    pub interval: f64,
    /// Number of fixes that repeat the one before.
    pub repeated: u64,
    /// Time by which the velocity is later than the position \[s\], with its standard error \[s\]; `None` where it does not show.
    pub velocity_late: Option<(f64, f64)>,
    /// Errors of the fixes beyond what they state.
    pub errors: FixErrors,
}

impl FixStudy {
    /// The errors that a filter with these parameters uses: those found, with what is `stated` in place of them. Velocities that are late
    /// are not taken to be better than they state unless the filter estimates their delay.
    pub fn errors(&self, stated: &FromFixes, parameters: &Parameters) -> FixErrors {
        let mut errors = self.errors;
        // Velocities are as good as the positions show them to be only where their latency is estimated.
        let is_late = self.velocity_late.is_some();
        if is_late && parameters.prior(Parameter::VelocityTimeOffset).is_none() {
            errors.velocity_factor = errors.velocity_factor.map(|factor| factor.max(1.0));
            errors.velocity_correlated = None;
        }
        errors.under(stated)
    }
}

impl FixStudy {
    /// Of these errors those that a few fixes show: a scatter beyond what they state. `None` without.
    fn of_scatter(self) -> Option<Self> {
        let FixErrors {
            position_factor,
            height_factor,
            ..
        } = self.errors;
        let errors = FixErrors {
            position_factor,
            height_factor,
            ..FixErrors::default()
        };
        (errors != FixErrors::default()).then_some(Self { errors, ..self })
    }
}

/// Median of χ² with one degree of freedom.
const MEDIAN: f64 = 0.455;
/// Ratio of the standard deviation to the median absolute deviation of normal values.
const MAD: f64 = 1.4826;

/// Fixes that a study looks at: an hour and a half at 4 Hz.
const MOST: usize = 20_000;
/// Fixes that a study needs: fewer carry no information.
const LEAST: usize = 80;
/// Positions alone that a study needs.
const LEAST_POSITIONS: usize = 20;
/// Pairs of fixes for a mean square to be worth something.
const LEAST_PAIRS: usize = 40;
/// White noise this many times the stated one is reported to the filter.
const FACTOR: f64 = 2.0;
/// Velocities that the positions show to be better than this share of their stated standard deviations are taken as
/// that good.
const MODEST: f64 = 0.5;
/// Motion faster than [`MOVES`] that it takes to show it \[s\]: what a receiver gets wrong in motion does not show at rest.
const MOVING: f64 = 60.0;
/// Least share of their stated standard deviations that velocities are taken to have.
const LEAST_VELOCITY: f64 = 0.1;
/// Share of the variance of such velocities that lasts, as in a receiver that smooths.
const VELOCITY_SHARE: f64 = 0.6;
/// Correlation time of that part \[s\].
const VELOCITY_TIME: f64 = 3.0;
/// White variance below this share of the stated one: the rest of the error lasts.
const WHITE_SHARE: f64 = 0.8;
/// The white part has at least what is left of this share: receivers smooth, inertial sensors are not perfect.
const MOST_SHARE: f64 = 0.99;
/// Differences that grow to the whole sooner are the velocities' error, or white \[s\].
const SHORTEST: f64 = 5.0;
/// The velocities' own error makes the differences grow sooner, by about this factor.
const SOONER: f64 = 2.0;
/// Correlation time of the rest of the error of positions that have no velocities beside them \[s\]: minutes, as of multipath,
/// atmosphere and orbits (Groves 2013, section 9.3).
const UNSEEN_TIME: f64 = 100.0;
/// Longest correlation time that fixes are taken to have \[s\]: longer ones are treated as equal.
pub const LONGEST_CORRELATION: f64 = 1000.0;
/// Standard errors by which the positions contradict a velocity that is wrong.
const BIAS_ERRORS: f64 = 5.0;
/// Stated standard deviations of a velocity by which they contradict it.
const BIAS_SIGMAS: f64 = 0.5;
/// Least error of a velocity that is wrong \[m/s\].
const LEAST_BIAS: f64 = 0.15;
/// Speed above which there is an along and an across \[m/s\].
const MOVES: f64 = 3.0;
/// Along-track differences this many times the cross-track ones are errors of the stamps.
const ALONG: f64 = 2.0;
/// Steps whose variance is below this share of the stated one are how numbers are written.
const STEP_SHARE: f64 = 0.25;

/// Studies the first 20 000 fixes of a log, in order of time, as the module describes; `None` where there are too few: 80 with a velocity,
/// 20 of positions alone.
///
/// ```
/// use undrift_engine::fixes::study;
/// use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// let mut log = simulate(&Trajectory::car(600.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
/// // A receiver that states a third of its error.
/// for fix in &mut log.gnss {
///     if let Some((_, covariance)) = &mut fix.position {
///         *covariance /= 9.0;
///     }
/// }
/// let shown = study(log.gnss).expect("enough fixes");
/// assert!((2.0..4.0).contains(&shown.errors.position_factor), "{shown:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn study(fixes: impl IntoIterator<Item = GnssFix>) -> Option<FixStudy> {
    let mut repeats = Repeats::default();
    let own = fixes.into_iter().filter(|fix| !repeats.is(fix));
    let seen: Vec<Seen> = own
        .filter_map(|fix| Seen::from_fix(&fix))
        .take(MOST)
        .collect();
    let study = study_track(&Track::from_fixes(seen.iter()))?;
    Some(FixStudy {
        repeated: repeats.count(),
        ..study
    })
}

/// Does [`study`] on fixes that repeat none before.
///
/// `None` of too few fixes, or of stamps that do not increase.
fn study_track(track: &Track) -> Option<FixStudy> {
    let n = track.time.len();
    let alone = track.velocity.is_empty();
    if n < if alone { LEAST_POSITIONS } else { LEAST } {
        return None;
    }
    let steps: Vec<f64> = track.time.windows(2).map(|t| t[1] - t[0]).collect();
    let interval = median(&steps);
    if interval <= 0.0 || interval.is_nan() {
        return None;
    }
    if alone {
        return study_positions(track, interval);
    }
    let stated =
        Vector3::from_fn(|i, _| median(&track.stated.iter().map(|r| r[i]).collect::<Vec<_>>()));
    let step = Vector3::from_fn(|i, _| {
        let step = grid(&track.written, i) * track.metres[i];
        let matters = step * step / 12.0 > STEP_SHARE * stated[i];
        if matters { step } else { 0.0 }
    });
    let rounding = step.map(|step| step * step / 12.0);
    let mut differences = Differences {
        interval,
        variance: track.stated.iter().map(|r| r + rounding).collect(),
        error: track.less_velocity(interval),
        time: &track.time,
    };
    let velocity_late = differences.remove_latency(&track.velocity);
    let jitter = differences.jitter(&track.velocity);
    let axes = differences.gammas(1)?;
    let (axis, one) = median_or_least(&axes, jitter > 0.0);
    // By the trapezoidal rule γ has a quarter of a velocity's variance times dt², over the variance of a position.
    let from_velocities = Vector3::from_fn(|i, _| {
        let pairs = track.stated_velocity.iter().zip(&differences.variance);
        let ratios: Vec<f64> = pairs.map(|(v, r)| v[i] / r[i]).collect();
        0.25 * interval * interval * median(&ratios)
    });
    let mut errors = FixErrors {
        step,
        jitter,
        velocity_bias: differences.velocity_bias(&track.stated_velocity),
        known: true,
        ..FixErrors::default()
    };
    // Were all of it the velocities' white noise; the vertical one is measured in another way.
    let level = (axes[0] + axes[1]) / (from_velocities.x + from_velocities.y);
    let level = if jitter > 0.0 {
        one / from_velocities[axis]
    } else {
        level
    };
    let down = axes[2] / from_velocities.z;
    let bound = Vector3::new(level, level, down).map(f64::sqrt);
    let moving = track.velocity.iter().filter(|v| v.norm() > MOVES).count() as f64;
    if bound.min() < MODEST && moving * interval > MOVING {
        errors.velocity_factor = bound.map(|bound| match bound < MODEST {
            true => bound.max(LEAST_VELOCITY),
            false => 1.0,
        });
        errors.velocity_correlated = Some(Correlated {
            share: VELOCITY_SHARE,
            time: VELOCITY_TIME,
        });
    }
    let white = (one - from_velocities[axis]).max(0.0);
    let of_position = white.max(1.0).sqrt();
    let of_height = (axes[2] - from_velocities.z).max(0.0).sqrt() / of_position;
    if of_height > FACTOR {
        errors.height_factor = of_height;
    }
    if white > FACTOR * FACTOR {
        errors.position_factor = of_position;
    } else if one < WHITE_SHARE {
        errors.correlated = differences.correlated(one, jitter > 0.0);
    }
    Some(FixStudy {
        interval,
        repeated: 0,
        velocity_late,
        errors,
    })
}

/// Does [`study_track`] on positions alone.
///
/// Correlation time 100 s by assumption: positions alone do not show it.
fn study_positions(track: &Track, interval: f64) -> Option<FixStudy> {
    let places = track.time.iter().copied().zip(track.place.iter().copied());
    let places: Vec<(f64, Vector3)> = places.collect();
    let stated = track.stated.iter().sum::<Vector3>() / track.stated.len() as f64;
    let white = white_variance(&places)?.component_div(&stated);
    let (_, white) = median_or_least(&white.into(), false);
    let mut errors = FixErrors {
        known: true,
        ..FixErrors::default()
    };
    if white < WHITE_SHARE {
        errors.correlated = Some(Correlated {
            share: (1.0 - white).min(MOST_SHARE),
            time: UNSEEN_TIME,
        });
    }
    Some(FixStudy {
        interval,
        repeated: 0,
        velocity_late: None,
        errors,
    })
}

/// The axis with the median of the values, or the least, and its value.
///
/// `least` where the stamps are wrong: their errors are along the track, and the axis with the
/// least has the least of them.
fn median_or_least(values: &[f64; 3], least: bool) -> (usize, f64) {
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let axis = axes[usize::from(!least)];
    (axis, values[axis])
}

/// The step that coordinate `i` is a multiple of, in its unit; 0 without a visible step.
///
/// A step counts where 98 % of the movements, at least 20 of them, are whole multiples of the
/// smallest.
fn grid(written: &[Vector3], i: usize) -> f64 {
    let moves = written.windows(2).map(|w| (w[1][i] - w[0][i]).abs());
    // Below a millionth of a metre, or what a double resolves of an angle.
    let moves: Vec<f64> = moves.filter(|m| *m > 1e-12).collect();
    let least = moves.iter().copied().fold(f64::INFINITY, f64::min);
    let whole = |m: &&f64| {
        let times = **m / least;
        (times - times.round()).abs() < 0.02 * times.sqrt()
    };
    if moves.len() >= 20 && moves.iter().filter(whole).count() * 50 >= moves.len() * 49 {
        least
    } else {
        0.0
    }
}

/// Movement of the positions less that of the velocities.
///
/// The series e(t) of the module's text, axis by axis.
struct Differences<'a> {
    /// Usual interval \[s\].
    interval: f64,
    time: &'a [f64],
    /// Position less integrated velocity \[m\].
    error: Vec<Vector3>,
    /// Stated variances, rounding included \[m²\].
    variance: Vec<Vector3>,
}

impl Differences<'_> {
    /// Pairs of fixes `lag` intervals apart, gaps left out.
    fn pairs(&self, lag: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let span = lag as f64 * self.interval;
        let slack = 0.3 * self.interval * (1.0 + (lag as f64).sqrt());
        (lag..self.time.len())
            .map(move |k| (k - lag, k))
            .filter(move |(a, b)| (self.time[*b] - self.time[*a] - span).abs() < slack)
    }

    /// Median over the axes of [`Differences::gammas`], or the least of them.
    fn gamma(&self, lag: usize, least: bool) -> Option<f64> {
        Some(median_or_least(&self.gammas(lag)?, least).1)
    }

    /// Half the mean square of the differences over the stated variance, north, east, down.
    ///
    /// γ(L) over the stated variance [–], L = `lag` intervals; from the median of squares over that
    /// of χ²(1). `None` with fewer than 40 pairs.
    fn gammas(&self, lag: usize) -> Option<[f64; 3]> {
        let mut axes: [Vec<f64>; 3] = Default::default();
        for (a, b) in self.pairs(lag) {
            let moved = self.error[b] - self.error[a];
            let variance = (self.variance[a] + self.variance[b]) * 0.5;
            for i in 0..3 {
                axes[i].push(moved[i] * moved[i] / variance[i]);
            }
        }
        if axes[0].len() < LEAST_PAIRS {
            return None;
        }
        Some(axes.map(|axis| 0.5 * median(&axis) / MEDIAN))
    }

    /// A velocity that lags `δ` behind the position makes `δ Δv` of a difference; removed where it shows.
    ///
    /// Regression of differences over a second on the change of velocity, ten rounds of Huber's
    /// weights at two standard deviations. Positive where velocities lag behind positions \[s\]; it
    /// counts from three standard errors on.
    fn remove_latency(&mut self, velocity: &[Vector3]) -> Option<(f64, f64)> {
        let lag = (1.0 / self.interval).round().max(1.0) as usize;
        let mut pairs = Vec::new();
        for (a, b) in self.pairs(lag) {
            let (e, dv) = (self.error[b] - self.error[a], velocity[b] - velocity[a]);
            pairs.extend((0..2).map(|i| (dv[i], e[i])));
        }
        if pairs.len() < LEAST_PAIRS {
            return None;
        }
        let (mut late, mut error) = (0.0, f64::INFINITY);
        // Huber's weights.
        for _ in 0..10 {
            let rest: Vec<f64> = pairs.iter().map(|(x, y)| (y - late * x).abs()).collect();
            let spread = MAD * median(&rest);
            let weight = |rest: f64| (2.0 * spread / rest.max(1e-12)).min(1.0);
            let (mut xy, mut xx) = (0.0, 0.0);
            for ((x, y), rest) in pairs.iter().zip(&rest) {
                xy += weight(*rest) * x * y;
                xx += weight(*rest) * x * x;
            }
            if xx <= 0.0 {
                return None;
            }
            // Differences overlap, each second `lag` of them.
            (late, error) = (xy / xx, spread * (lag as f64 / xx).sqrt());
        }
        if late.abs() < 3.0 * error {
            return None;
        }
        for (e, v) in self.error.iter_mut().zip(velocity) {
            *e -= v * late;
        }
        Some((late, error))
    }

    /// Standard deviation of the stamps \[s\]: they move positions along the track and not across.
    ///
    /// Along the track a stamp that is wrong by δ moves a position by v δ: σ² = ½ (along² −
    /// across²)/v². 0 where the two differ by less than a factor of two, or below 3 m/s.
    fn jitter(&self, velocity: &[Vector3]) -> f64 {
        let (mut along, mut across, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        for (a, b) in self.pairs(1) {
            let v = (velocity[a] + velocity[b]).xy() * 0.5;
            let speed = v.norm();
            if speed < MOVES {
                continue;
            }
            let moved = (self.error[b] - self.error[a]).xy();
            along.push((moved.dot(&v) / speed).powi(2));
            across.push((moved.perp(&v) / speed).powi(2));
            speeds.push(speed * speed);
        }
        if along.len() < LEAST_PAIRS {
            return 0.0;
        }
        let [along, across] = [along, across].map(|squares| median(&squares) / MEDIAN);
        if along < ALONG * ALONG * across {
            return 0.0;
        }
        let speed = speeds.iter().sum::<f64>() / speeds.len() as f64;
        (0.5 * (along - across) / speed).sqrt()
    }

    /// What the velocities read too much for the positions, where that is beyond doubt [m/s].
    ///
    /// Median of the slopes over ten seconds, north, east, down; 0 where below five of its standard
    /// errors, half the stated standard deviation, or 0.15 m/s.
    fn velocity_bias(&self, stated: &[Vector3]) -> Vector3 {
        let lag = (10.0 / self.interval).round().max(1.0) as usize;
        let pairs: Vec<_> = self.pairs(lag).collect();
        if pairs.len() < LEAST_PAIRS.max(3 * lag) {
            return Vector3::zeros();
        }
        Vector3::from_fn(|i, _| {
            let span = |&(a, b): &(usize, usize)| self.time[b] - self.time[a];
            let slope = |p: &(usize, usize)| (self.error[p.0][i] - self.error[p.1][i]) / span(p);
            let slopes: Vec<f64> = pairs.iter().map(slope).collect();
            let bias = median(&slopes);
            let apart: Vec<f64> = slopes.iter().map(|s| (s - bias).abs()).collect();
            let error = MAD * median(&apart) * (lag as f64 / slopes.len() as f64).sqrt();
            let stated = median(&stated.iter().map(|r| r[i].sqrt()).collect::<Vec<_>>());
            let limit = (BIAS_ERRORS * error).max(BIAS_SIGMAS * stated);
            if bias.abs() > limit.max(LEAST_BIAS) {
                bias
            } else {
                0.0
            }
        })
    }

    /// The correlated part, of fixes whose differences over one interval are `one` of what they state.
    ///
    /// γ at lags 2, 4, 8, … until 63 % of the rest has come; interpolated in the logarithm. Without
    /// an end within a quarter of the log the time is extrapolated, at most
    /// [`LONGEST_CORRELATION`].
    fn correlated(&self, one: f64, least: bool) -> Option<Correlated> {
        // One correlation time on, this much of the rest has come.
        let part = 1.0 - (-1f64).exp();
        let grown = one + part * (1.0 - one);
        let (mut lag, mut before) = (2, (self.interval, one));
        let time = loop {
            let span = lag as f64 * self.interval;
            let Some(gamma) = self.gamma(lag, least).filter(|_| 4 * lag < self.time.len()) else {
                // Not grown to the whole within the log.
                let (span, gamma) = before;
                let come = ((gamma - one) / (1.0 - one)).clamp(1e-3, part);
                break span / -(1.0 - come).ln();
            };
            if gamma >= grown {
                let (last, low) = before;
                let part = (grown / low).ln() / (gamma / low).ln();
                break last * (span / last).powf(part.clamp(0.0, 1.0));
            }
            before = (span, gamma);
            lag *= 2;
        };
        (time > SHORTEST).then(|| Correlated {
            share: (1.0 - one).min(MOST_SHARE),
            time: (SOONER * time).min(LONGEST_CORRELATION),
        })
    }
}

#[cfg(test)]
mod tests;
