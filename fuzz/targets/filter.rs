#![no_main]
//! Arbitrary samples and measurements, to the filter itself and through a replay: nothing panics, and a
//! solution that is given out is finite, with a covariance that can be one.

use libfuzzer_sys::fuzz_target;
use undrift::estimator::Estimator;
use undrift::nav::attitude::from_rpy;
use undrift::nav::earth::Geodetic;
use undrift::nav::filter::{Filter, Gate, InitialStd};
use undrift::nav::mechanisation::NavState;
use undrift::nav::parameters::{Parameter, Parameters, Prior};
use undrift::nav::sample::{FixQuality, GnssFix, ImuSample, MagneticField, Position, Scalar};
use undrift::nav::{Matrix3, Vector3};
use undrift::noise::{BiasModel, ImuModel};
use undrift::replay::{Measurement, Observer, ReplayError, Settings, replay};

/// Most states of the filters that are tried.
const STATES: usize = 33;
/// Bytes of an event: a kind, a magnitude, five numbers.
const EVENT: usize = 12;

fuzz_target!(|data: &[u8]| {
    let Some((&first, events)) = data.split_first() else {
        return;
    };
    let kind = BiasModel::ALL[usize::from(first & 0x0f) % BiasModel::ALL.len()];
    let events: Vec<Event> = events.chunks_exact(EVENT).map(Event::from_bytes).collect();
    step_by_step(kind, first & 0x10 != 0, &events);
    replayed(kind, first, &events);
});

/// One event of an input.
struct Event {
    kind: u8,
    /// Up to 1 times ten to a power from −8 to 7.
    numbers: [f64; 5],
}

impl Event {
    fn from_bytes(bytes: &[u8]) -> Self {
        let power = i32::from(bytes[1] & 0x0f) - 8;
        let number = |k: usize| {
            let short = i16::from_le_bytes([bytes[2 + 2 * k], bytes[3 + 2 * k]]);
            f64::from(short) / 32768.0 * 10f64.powi(power)
        };
        Self {
            kind: bytes[0],
            numbers: std::array::from_fn(number),
        }
    }

    fn vector(&self) -> Vector3 {
        Vector3::new(self.numbers[0], self.numbers[1], self.numbers[2])
    }

    /// A standard deviation, above zero.
    fn std(&self) -> f64 {
        self.numbers[3].abs().max(1e-4)
    }
}

fn start() -> NavState {
    NavState {
        time: 0.0,
        position: HOME,
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::new(0.01, -0.02, 1.0)),
    }
}

const HOME: Geodetic = Geodetic {
    lat: 0.9,
    lon: 0.2,
    height: 100.0,
};

/// A place near the start, or anywhere.
fn place(event: &Event) -> Position {
    let [a, b, c, ..] = event.numbers;
    let place = if event.kind & 0x40 == 0 {
        Geodetic {
            lat: HOME.lat + a * 1e-6,
            lon: HOME.lon + b * 1e-6,
            height: HOME.height + c,
        }
    } else {
        Geodetic {
            lat: a,
            lon: b,
            height: c,
        }
    };
    Position::Geodetic(place)
}

/// The filter by hand, with numbers that no reader would let through too.
fn step_by_step(kind: BiasModel, parameters: bool, events: &[Event]) {
    let Some(Ok(sensors)) = ImuModel::preset("adis16405").map(|model| model.shaping(kind, 0.01))
    else {
        return;
    };
    let std = InitialStd {
        position: Vector3::repeat(5.0),
        velocity: Vector3::repeat(0.5),
        attitude: Vector3::new(0.02, 0.02, 0.3),
    };
    let mut estimated = Parameters::none();
    if parameters {
        let prior = Prior {
            std: 0.1,
            walk: 1e-3,
            ..Prior::default()
        };
        estimated = estimated
            .with(Parameter::LeverArm, prior)
            .with(Parameter::TimeOffset, prior);
    }
    let Ok(mut filter) = Filter::<STATES>::new(start(), &std, sensors, estimated) else {
        return;
    };
    for event in events {
        let v = event.vector();
        let time = filter.nav().time + 0.01;
        let lever = Vector3::new(1.0, 0.5, -1.0);
        let noise = Matrix3::identity() * event.std().powi(2);
        match event.kind & 0x07 {
            0 | 1 => filter.predict(&ImuSample {
                time,
                dt: 0.01,
                dtheta: v * 0.01,
                dvel: Vector3::new(event.numbers[3], event.numbers[4], -9.81) * 0.01,
            }),
            2 => filter.predict(&ImuSample {
                time: filter.nav().time + event.numbers[4],
                dt: event.numbers[4],
                dtheta: v,
                dvel: v.yzx(),
            }),
            3 => {
                filter.begin(&ImuSample {
                    time,
                    dt: 0.01,
                    dtheta: v * 0.01,
                    dvel: Vector3::new(0.0, 0.0, -0.0981),
                });
                filter.advance(event.numbers[4]);
            }
            4 => {
                let observed = filter.observe_position(&place(event), &lever);
                let _ = filter.update(&observed, &noise, &Gate::OPEN);
            }
            5 => {
                let observed = filter.observe_velocity(&v, &lever);
                let _ = filter.update(&observed, &noise, &Gate::OPEN);
            }
            6 => filter.inflate_over_gap(event.numbers[4], v.x, v.y),
            _ => {
                let observed = filter.observe_velocity(&(v * f64::INFINITY), &lever);
                let _ = filter.update(&observed, &(noise * v.x), &Gate::OPEN);
            }
        }
        if filter.check().is_err() {
            return;
        }
        let p = filter.covariance();
        let std = filter.nav_std();
        sound(
            filter.nav(),
            &std,
            &filter.sensor_error(),
            STATES,
            |i, j| p[(i, j)],
        );
        assert!(filter.sensor_error_std().iter().all(|s| s.is_finite()));
    }
}

/// What holds for a filter that calls itself sound.
fn sound(
    nav: &NavState,
    std: &[f64],
    error: &[f64],
    states: usize,
    p: impl Fn(usize, usize) -> f64,
) {
    assert!(nav.v_n.iter().all(|v| v.is_finite()));
    assert!(nav.q_nb.coords.iter().all(|v| v.is_finite()));
    assert!((nav.q_nb.coords.norm() - 1.0).abs() < 1e-6, "{nav:?}");
    assert!(nav.position.lat.is_finite() && nav.position.lon.is_finite());
    assert!(std.iter().chain(error).all(|s| s.is_finite()));
    for i in 0..states {
        assert!(p(i, i) >= 0.0);
        for j in 0..i {
            assert!(p(i, j).is_finite());
            assert_eq!(p(i, j), p(j, i), "not symmetric at {i}, {j}");
        }
    }
}

/// As the readers would give it out: finite numbers, times that go forward, covariances that are some.
fn replayed(kind: BiasModel, first: u8, events: &[Event]) {
    let Some(Ok(sensors)) = ImuModel::preset("adis16405").map(|model| model.shaping(kind, 0.01))
    else {
        return;
    };
    let mut settings = Settings::new(sensors);
    settings.gating = first & 0x20 != 0;
    settings.adapt = first & 0x40 != 0;
    if first & 0x80 != 0 {
        settings.align.attitude = Some((Vector3::new(0.0, 0.0, 1.0), Vector3::repeat(0.05)));
        settings.align.velocity = Some((Vector3::zeros(), Vector3::repeat(0.5)));
    }
    let (mut imu, mut aiding) = (Vec::new(), Vec::new());
    let mut time = 0.0;
    // Every interval of a gap up to a minute costs a step: of those there are so many seconds at most.
    let mut bridged = 120.0;
    for event in events {
        let v = event.vector();
        let noise = Matrix3::identity() * event.std().powi(2);
        match event.kind & 0x07 {
            0..=3 => {
                // A gap before it now and then.
                let mut gap = match event.kind & 0x80 {
                    0 => 0.0,
                    _ => event.numbers[4].abs().min(1e4),
                };
                if gap <= 60.0 {
                    gap = gap.min(bridged);
                    bridged -= gap;
                }
                // One event is a quarter of a second at 100 Hz.
                for k in 0..25 {
                    let dt = if k == 0 { gap + 0.01 } else { 0.01 };
                    time += dt;
                    imu.push(ImuSample {
                        time,
                        dt,
                        dtheta: v * dt,
                        dvel: Vector3::new(event.numbers[3], event.numbers[4], -9.81) * dt,
                    });
                }
            }
            4 | 5 => {
                let whole = Geodetic {
                    lat: HOME.lat + v.x.clamp(-0.5, 0.5),
                    lon: HOME.lon + v.y.clamp(-3.0, 2.9),
                    height: v.z,
                };
                let place = match place(event) {
                    Position::Geodetic(near) if event.kind & 0x40 == 0 => near,
                    _ => whole,
                };
                aiding.push(Measurement::Gnss(GnssFix {
                    attitude: None,
                    mean_velocity: None,
                    time: later(&aiding, time + event.numbers[4].clamp(0.0, 1.0)),
                    position: (event.kind & 0x08 == 0)
                        .then_some((Position::Geodetic(place), noise)),
                    velocity: (event.kind & 0x10 == 0).then_some((v, noise)),
                    quality: FixQuality::Unknown,
                }));
            }
            more => {
                let scalar = Scalar {
                    time: later(&aiding, time),
                    value: v.x,
                    std: event.std(),
                };
                aiding.push(match more {
                    6 => Measurement::Odometer(scalar),
                    _ if event.kind & 0x20 != 0 => Measurement::Magnetometer(MagneticField {
                        time: scalar.time,
                        field: v * 1e-6,
                        std: event.std() * 1e-6,
                    }),
                    _ if event.kind & 0x10 == 0 => Measurement::Barometer(scalar),
                    _ => Measurement::Heading(scalar),
                });
            }
        }
    }
    let outcome = replay(
        &mut imu.into_iter().map(Ok),
        &mut aiding.into_iter().map(Ok),
        &settings,
        &mut Watch,
    );
    match outcome {
        Ok(summary) => assert!(summary.ended.is_finite()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A stamp after those before it.
fn later(before: &[Measurement], time: f64) -> f64 {
    match before.last() {
        Some(last) if last.time() >= time => last.time() + 1e-3,
        _ => time,
    }
}

struct Watch;

impl Observer for Watch {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let p = filter.covariance();
        let (std, error) = (filter.nav_std(), filter.sensor_error());
        sound(filter.nav(), &std, &error, filter.states(), |i, j| {
            p[(i, j)]
        });
        assert!(filter.sensor_error_std().iter().all(|s| s.is_finite()));
        Ok(())
    }
}
