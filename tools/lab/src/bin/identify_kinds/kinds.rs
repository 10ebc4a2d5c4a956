//! Sensors of known truth: what their noise is, and what else is in their records.

use crate::judge::System;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::{PI, TAU};
use undrift_noise::composite::Parameter;

/// White noise density of all kinds [rad/√s], 0.005 °/s/√Hz; amplitudes below are in multiples of it.
pub const WHITE: f64 = 8.727e-5;

/// A part of the noise, its amplitudes over [`WHITE`].
#[derive(Clone, Copy)]
pub enum Part {
    White(f64),
    /// White noise behind a Butterworth filter of second order of this frequency [Hz], and a hundredth of it beside.
    LowPass(f64),
    Walk(f64),
    /// σ, τ [s].
    Process(f64, f64),
    /// Power density B²/(2πf) from 10 Hz down to 10⁻⁵ Hz.
    Flicker(f64),
    /// Power density like f^−1.5, at 1/(2π 100 s) that of flicker noise of this coefficient.
    Steeper(f64),
    /// Two values ± this, held for so long on the average [s].
    Telegraph(f64, f64),
    /// A line that wanders: frequency [Hz], its width [Hz], standard deviation.
    Line(f64, f64, f64),
}

/// What is in the record and not in the noise that a filter meets afterwards; times as shares of the record.
#[derive(Clone, Copy)]
pub enum Disturbance {
    Nothing,
    /// A exp(−t/τ).
    WarmUp(f64, f64),
    /// The level is higher from here on.
    Step(f64, f64),
    /// Other levels up to this one, each for this share of the record.
    Rezero(f64, f64),
    /// A sine of this period.
    Cycle(f64, f64),
    /// A swing of so many seconds at the start or end.
    Bump(f64, f64, bool),
    /// Vibration of 23 Hz, on in every other tenth.
    Engine(f64),
}

pub struct Kind {
    pub name: String,
    pub rate_hz: f64,
    pub seconds: f64,
    pub parts: Vec<Part>,
    pub disturbance: Disturbance,
    /// Rate of the logger, which repeats samples [Hz].
    pub logger_hz: Option<f64>,
}

/// Half a decade apart: coefficients and times of processes whose sum has a power density like 1/f (or f^−1.5).
fn ladder(b: f64, steeper: bool) -> Vec<(f64, f64)> {
    let rho = 10f64.sqrt();
    (0..15)
        .map(|k| {
            let tau = 0.016 * rho.powi(k);
            let sigma = b * (rho.ln() / PI).sqrt();
            let grown = if steeper {
                (tau / 100.0).powf(0.25)
            } else {
                1.0
            };
            (sigma * grown, tau)
        })
        .collect()
}

/// φ and gain of a Butterworth filter of second order.
fn butterworth(frequency: f64, rate_hz: f64) -> ([f64; 2], f64) {
    let w = (PI * frequency / rate_hz).tan();
    let norm = 1.0 / (1.0 + 2f64.sqrt() * w + w * w);
    let a1 = 2.0 * (w * w - 1.0) * norm;
    let a2 = (1.0 - 2f64.sqrt() * w + w * w) * norm;
    ([-a1, -a2], w * w * norm)
}

/// φ of a resonance, and the deviation of its innovations for a variance of 1.
fn resonance(frequency: f64, width: f64, rate_hz: f64) -> ([f64; 2], f64) {
    let radius = (-PI * width / rate_hz).exp();
    let phi = [
        2.0 * radius * (TAU * frequency / rate_hz).cos(),
        -radius * radius,
    ];
    let ratio = (1.0 - phi[1]) / (1.0 + phi[1]) / ((1.0 - phi[1]).powi(2) - phi[0] * phi[0]);
    (phi, ratio.sqrt().recip())
}

impl Part {
    /// The part as a linear system of its second moments, at a rate [Hz].
    fn system(self, rate_hz: f64) -> System {
        let t = 1.0 / rate_hz;
        match self {
            Self::White(n) => System::white(n * WHITE, t),
            Self::LowPass(frequency) => {
                let (phi, gain) = butterworth(frequency, rate_hz);
                let sigma = gain * WHITE / t.sqrt();
                System::arma(&phi, &[-2.0, -1.0], sigma).plus(&System::white(0.01 * WHITE, t))
            }
            Self::Walk(k) => System::walk(k * WHITE, t),
            Self::Process(sigma, tau) => System::gauss_markov(sigma * WHITE, tau, t),
            Self::Flicker(b) | Self::Steeper(b) => {
                let steps = ladder(b, matches!(self, Self::Steeper(_)));
                let of = |(sigma, tau): &(f64, f64)| System::gauss_markov(sigma * WHITE, *tau, t);
                steps
                    .iter()
                    .fold(System::white(0.0, t), |sum, step| sum.plus(&of(step)))
            }
            Self::Telegraph(size, hold) => System::gauss_markov(size * WHITE, 0.5 * hold, t),
            Self::Line(frequency, width, sigma) => {
                let (phi, scale) = resonance(frequency, width, rate_hz);
                System::arma(&phi, &[], scale * sigma * WHITE)
            }
        }
    }

    fn add_to(self, series: &mut [f64], rate_hz: f64, rng: &mut Xoshiro256PlusPlus) {
        let t = 1.0 / rate_hz;
        let (mut a, mut b) = (0.0, 0.0);
        match self {
            Self::White(n) => {
                let sigma = n * WHITE / t.sqrt();
                series.iter_mut().for_each(|x| *x += sigma * normal(rng));
            }
            Self::LowPass(frequency) => {
                let (phi, gain) = butterworth(frequency, rate_hz);
                let sigma = gain * WHITE / t.sqrt();
                let (mut w1, mut w2) = (0.0, 0.0);
                let mut settling = [0.0; 4000];
                for x in settling.iter_mut().chain(series) {
                    let w = sigma * normal(rng);
                    let y = phi[0] * a + phi[1] * b + w + 2.0 * w1 + w2;
                    (a, b, w1, w2) = (y, a, w, w1);
                    *x += y + 0.01 * WHITE / t.sqrt() * normal(rng);
                }
            }
            Self::Walk(k) => {
                let step = k * WHITE * t.sqrt();
                for x in series {
                    *x += a;
                    a += step * normal(rng);
                }
            }
            Self::Process(sigma, tau) => process(series, sigma * WHITE, tau, t, rng),
            Self::Flicker(size) | Self::Steeper(size) => {
                for (sigma, tau) in ladder(size, matches!(self, Self::Steeper(_))) {
                    process(series, sigma * WHITE, tau, t, rng);
                }
            }
            Self::Telegraph(size, hold) => {
                let mut value = if rng.random::<bool>() { size } else { -size } * WHITE;
                let switch = -(-t / hold).exp_m1();
                for x in series {
                    *x += value;
                    if rng.random::<f64>() < switch {
                        value = -value;
                    }
                }
            }
            Self::Line(frequency, width, sigma) => {
                let (phi, scale) = resonance(frequency, width, rate_hz);
                let warm = (10.0 * rate_hz / width) as usize;
                let mut next = || {
                    let y = phi[0] * a + phi[1] * b + scale * sigma * WHITE * normal(rng);
                    (a, b) = (y, a);
                    y
                };
                let mut settling = vec![0.0; warm.min(1_000_000)];
                settling.iter_mut().chain(series).for_each(|x| *x += next());
            }
        }
    }
}

fn process(series: &mut [f64], sigma: f64, tau: f64, t: f64, rng: &mut Xoshiro256PlusPlus) {
    let phi = (-t / tau).exp();
    let drive = sigma * (-(-2.0 * t / tau).exp_m1()).sqrt();
    let mut state = sigma * normal(rng);
    for x in series {
        *x += state;
        state = phi * state + drive * normal(rng);
    }
}

/// Box and Muller.
fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
}

impl Kind {
    /// The noise that a filter meets, as a linear system of its second moments.
    pub fn system(&self) -> System {
        let parts = self.parts.iter().map(|part| part.system(self.rate_hz));
        let engine = match self.disturbance {
            // On half of the time.
            Disturbance::Engine(sigma) => {
                Some(Part::Line(23.0, 2.0, sigma * 0.5f64.sqrt()).system(self.rate_hz))
            }
            _ => None,
        };
        let none = System::white(0.0, 1.0 / self.rate_hz);
        parts.chain(engine).fold(none, |sum, part| sum.plus(&part))
    }

    /// Fresh noise of so many seconds, at the sensor's rate.
    pub fn fresh(&self, seconds: f64, seed: u64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut series = vec![0.0; (seconds * self.rate_hz).round() as usize];
        for part in &self.parts {
            part.add_to(&mut series, self.rate_hz, &mut rng);
        }
        if let Disturbance::Engine(_) = self.disturbance {
            self.disturb(&mut series, &mut rng);
        }
        series
    }

    fn disturb(&self, series: &mut [f64], rng: &mut Xoshiro256PlusPlus) {
        let count = series.len() as f64;
        let rate = self.rate_hz;
        let mut engine = vec![0.0; series.len()];
        if let Disturbance::Engine(sigma) = self.disturbance {
            Part::Line(23.0, 2.0, sigma).add_to(&mut engine, rate, rng);
        }
        for (k, x) in series.iter_mut().enumerate() {
            let share = k as f64 / count;
            *x += WHITE
                * match self.disturbance {
                    Disturbance::Nothing => 0.0,
                    Disturbance::WarmUp(size, tau) => size * (-share / tau).exp(),
                    Disturbance::Step(size, at) => f64::from(u8::from(share > at)) * size,
                    Disturbance::Rezero(size, each) => {
                        size * [0.0, 1.0, -0.4, 0.5][(share / each) as usize % 4]
                    }
                    Disturbance::Cycle(size, period) => size * (TAU * share / period).sin(),
                    Disturbance::Bump(size, seconds, at_end) => {
                        let time = k as f64 / rate;
                        let since = if at_end { count / rate - time } else { time };
                        let swing = (TAU * 0.7 * time).sin();
                        f64::from(u8::from(since < seconds)) * size * swing
                    }
                    Disturbance::Engine(_) => {
                        let is_on = (10.0 * share) as usize % 2 == 1;
                        f64::from(u8::from(is_on)) * engine[k] / WHITE
                    }
                };
        }
    }

    /// The recommended model's name where it is of the true kind, and the true parameters, of kinds that have one.
    pub fn truth(&self) -> Option<(&'static str, Vec<(Parameter, f64)>)> {
        let known = |part: &Part| match part {
            Part::White(n) => Some(vec![(Parameter::White, n * WHITE)]),
            Part::LowPass(_) => Some(vec![(Parameter::White, WHITE)]),
            Part::Walk(k) => Some(vec![(Parameter::RandomWalk, k * WHITE)]),
            Part::Flicker(b) => Some(vec![(Parameter::Flicker, b * WHITE)]),
            Part::Process(sigma, tau) => Some(vec![
                (Parameter::Sigma(0), sigma * WHITE),
                (Parameter::Tau(0), *tau),
            ]),
            _ => None,
        };
        let name = match self.parts[..] {
            [Part::White(_) | Part::LowPass(_)] => "white",
            [_, Part::Walk(_)] => "white + random walk",
            [_, Part::Flicker(_)] => "white + flicker",
            [_, Part::Process(..)] => "white + Gauss-Markov",
            _ => return None,
        };
        let parameters = self.parts.iter().map(known).collect::<Option<Vec<_>>>()?;
        Some((name, parameters.concat()))
    }

    /// The record of a seed, as it is logged, and its rate [Hz].
    pub fn record(&self, seed: u64) -> (Vec<f64>, f64) {
        let mut series = self.fresh(self.seconds, seed);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed + 500_000_000);
        if !matches!(self.disturbance, Disturbance::Engine(_)) {
            self.disturb(&mut series, &mut rng);
        }
        let Some(logger) = self.logger_hz else {
            return (series, self.rate_hz);
        };
        let held = (0..(self.seconds * logger) as usize)
            .map(|k| series[((k as f64 / logger * self.rate_hz) as usize).min(series.len() - 1)]);
        (held.collect(), logger)
    }
}

/// All kinds; `-a@b` is behind a filter of a Hz, b samples a second.
pub fn kinds() -> Vec<Kind> {
    use Disturbance::{Bump, Cycle, Engine, Nothing, Rezero, Step, WarmUp};
    use Part::{Flicker, Line, LowPass, Process, Steeper, Telegraph, Walk, White};
    let mut all = Vec::new();
    let mut add = |name: &str, rate_hz: f64, minutes: f64, parts: &[Part], disturbance| {
        all.push(Kind {
            name: name.to_owned(),
            rate_hz,
            seconds: 60.0 * minutes,
            parts: parts.to_vec(),
            disturbance,
            logger_hz: None,
        });
    };
    let (white, walk) = (White(1.0), Walk(1.0 / 30.0));
    let (gm100, flicker) = (Process(0.3873, 100.0), Flicker(0.15));
    add("white", 100.0, 20.0, &[white], Nothing);
    add("white-10min", 100.0, 10.0, &[white], Nothing);
    add("walk", 100.0, 20.0, &[white, walk], Nothing);
    add("walk-10min", 100.0, 10.0, &[white, walk], Nothing);
    add("white-60min", 100.0, 60.0, &[white], Nothing);
    add("walk-60min", 100.0, 60.0, &[white, walk], Nothing);
    add("gm100", 100.0, 20.0, &[white, gm100], Nothing);
    add("gm100-60min", 100.0, 60.0, &[white, gm100], Nothing);
    add("flicker", 100.0, 20.0, &[white, flicker], Nothing);
    add("flicker-60min", 100.0, 60.0, &[white, flicker], Nothing);
    add(
        "flicker-strong",
        100.0,
        20.0,
        &[white, Flicker(0.6)],
        Nothing,
    );
    add(
        "flicker+walk",
        100.0,
        20.0,
        &[white, Flicker(0.3), walk],
        Nothing,
    );
    add(
        "gm1+walk",
        100.0,
        20.0,
        &[white, Process(1.0, 1.0), walk],
        Nothing,
    );
    add(
        "gm0.3+walk",
        100.0,
        20.0,
        &[white, Process(1.0, 0.3), walk],
        Nothing,
    );
    add("f^-1.5", 100.0, 20.0, &[white, Steeper(0.3)], Nothing);
    add(
        "telegraph",
        100.0,
        20.0,
        &[white, Telegraph(0.3, 60.0)],
        Nothing,
    );
    // White noise and a walk behind every filter that the rate lets pass.
    for filter in [5.0, 10.0, 20.0, 42.0, 98.0] {
        for rate in [100.0, 200.0, 400.0, 1000.0] {
            for minutes in [10.0, 20.0, 60.0] {
                if 2.0 * filter < rate {
                    let name = format!("walk-{filter}@{rate}-{minutes}min");
                    add(&name, rate, minutes, &[LowPass(filter), walk], Nothing);
                }
            }
        }
    }
    add("white-20@100", 100.0, 20.0, &[LowPass(20.0)], Nothing);
    add(
        "gm100-10@100",
        100.0,
        20.0,
        &[LowPass(10.0), gm100],
        Nothing,
    );
    add(
        "flicker-20@100",
        100.0,
        20.0,
        &[LowPass(20.0), flicker],
        Nothing,
    );
    add(
        "line3Hz",
        100.0,
        20.0,
        &[white, walk, Line(3.1, 0.3, 10.0)],
        Nothing,
    );
    add(
        "line0.3Hz",
        100.0,
        20.0,
        &[white, walk, Line(0.3, 0.05, 1.0)],
        Nothing,
    );
    add("warm-up", 100.0, 20.0, &[white], WarmUp(3.0, 0.15));
    add(
        "warm-up-gm",
        100.0,
        20.0,
        &[white, gm100],
        WarmUp(8.0, 0.25),
    );
    add("step", 100.0, 20.0, &[white], Step(1.0, 0.4));
    add("re-zero", 100.0, 20.0, &[white], Rezero(1.5, 0.27));
    add("cycle", 100.0, 20.0, &[white], Cycle(0.5, 0.3));
    add(
        "bump-start",
        100.0,
        20.0,
        &[white, walk],
        Bump(300.0, 8.0, false),
    );
    add(
        "bump-end",
        100.0,
        20.0,
        &[white, walk],
        Bump(300.0, 8.0, true),
    );
    add("engine", 100.0, 20.0, &[white, walk], Engine(30.0));
    for (name, sensor, logger) in [
        ("held40@100", 40.0, 100.0),
        ("held2", 50.0, 100.0),
        ("held3", 50.0, 150.0),
    ] {
        all.push(Kind {
            name: name.to_owned(),
            rate_hz: sensor,
            seconds: 1200.0,
            parts: vec![white, walk],
            disturbance: Nothing,
            logger_hz: Some(logger),
        });
    }
    all
}
