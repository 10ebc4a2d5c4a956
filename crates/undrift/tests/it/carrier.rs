//! Velocities by the carrier phase on a simulated car: what they are worth in an outage, and whether the filter is honest about them.

use super::streams::cheap_imu;
use crate::sky::Sky;
use undrift::{
    Navigator,
    align::{AlignSettings, Heading},
    nav::{
        Vector3,
        sample::{GnssFix, MeanVelocity, Position},
        shaping::ShapingFilter,
    },
    outages::{self, ModelRun},
    reference::HORIZONTAL,
    replay::{Aid, Measurement, Outage, Settings},
    simulate::{GnssNoise, Simulation, Trajectory, simulate},
};
use undrift_observables::{Epoch, Observation, displacement};

const RATE: f64 = 100.0;

/// 0.7 deg/√h and 0.06 m/s/√h, biases of 0.3 deg/s and 10 mg that walk slowly.
fn sensors() -> [ShapingFilter; 6] {
    cheap_imu([2e-4, 5e-3, 1e-5], [1e-3, 0.1, 1e-4], RATE)
}

/// A car whose receiver has positions of metres and velocities of 5 cm/s.
fn drive(seed: u64, rate_hz: f64) -> Simulation {
    let gnss = GnssNoise {
        position_std: [1.5, 1.5, 3.0],
        velocity_std: [0.05; 3],
        rate_hz,
        ..GnssNoise::default()
    };
    simulate(
        &Trajectory::car(400.0, seed),
        RATE,
        Some(&sensors()),
        &gnss,
        seed,
    )
    .unwrap()
}

/// The fixes with mean velocities by the code and carrier that the antenna saw.
fn with_carrier(log: &Simulation, seed: u64) -> Vec<GnssFix> {
    let start = 302_400.0;
    let mut sky = Sky::new(start, seed);
    let mut before: Option<Epoch> = None;
    let mut truth = log.truth.iter();
    let with = |fix: &GnssFix| {
        let at = truth.find(|row| row.time > fix.time - 1e-6).unwrap();
        assert!((at.time - fix.time).abs() < 1e-6);
        let v_n = at.v_n.unwrap();
        let clock = 1e-4 + 1e-7 * fix.time;
        let now = sky.epoch(start + fix.time, &at.position, &v_n, clock);
        let (Some((Position::Geodetic(place), _)), Some((about, _))) = (fix.position, fix.velocity)
        else {
            panic!("{fix:?}");
        };
        let way = before
            .take()
            .and_then(|before| displacement(&sky.ephemerides, &before, &now, &place, &about));
        before = Some(now);
        GnssFix {
            mean_velocity: way.map(|way| MeanVelocity {
                over: way.over,
                v_n: way.ned / way.over,
                covariance: way.covariance / (way.over * way.over),
                place,
                by_place: way.by_place / way.over,
            }),
            ..*fix
        }
    };
    log.gnss.iter().map(with).collect()
}

/// GNSS cut for `length` \[s\] every 40 s.
fn run(log: &Simulation, fixes: &[GnssFix], length: f64) -> ModelRun {
    let heading = log.truth[0].rpy.unwrap().z;
    let start = |k: i32| 100.0 + 40.0 * f64::from(k);
    let cut = |k| Outage {
        start: start(k),
        end: start(k) + length,
    };
    let settings = Settings {
        outages: (0..7).filter(|_| length > 0.0).map(cut).collect(),
        align: AlignSettings {
            heading: Heading::Given(heading, 0.02),
            ..AlignSettings::default()
        },
        ..Settings::new(sensors())
    };
    let aiding = Measurement::from_fixes(fixes);
    let models = [("test".to_owned(), settings)];
    let runs = outages::run(&log.imu, &aiding, &log.truth, &models, &|_| {});
    runs.into_iter().next().unwrap().1.unwrap()
}

/// Horizontal drift with the carrier in parts of that without, over these drives.
fn ratio(seeds: std::ops::Range<u64>, rate_hz: f64, length: f64) -> f64 {
    let mut squares = [0.0; 2];
    for seed in seeds {
        let log = drive(seed, rate_hz);
        let by_carrier = with_carrier(&log, seed);
        for (sum, fixes) in squares.iter_mut().zip([&log.gnss, &by_carrier]) {
            let rms = run(&log, fixes, length).errors.rms.0[HORIZONTAL];
            *sum += rms * rms;
        }
    }
    let ratio = (squares[1] / squares[0]).sqrt();
    println!(
        "{rate_hz} Hz, {length} s: {ratio:.3} of {:.2} m",
        squares[0].sqrt()
    );
    ratio
}

#[test]
fn once_a_second_the_carrier_halves_the_drift() {
    assert!(ratio(1..4, 1.0, 10.0) < 0.65);
    assert!(ratio(1..4, 1.0, 30.0) < 0.8);
}

/// Five velocities a second are averaged by the filter: less is left to gain.
#[test]
fn five_times_a_second_it_gains_a_tenth() {
    assert!(ratio(1..4, 5.0, 10.0) < 0.95);
    assert!(ratio(1..4, 5.0, 30.0) < 0.95);
}

#[test]
fn the_filter_is_honest_with_it() {
    let (mut nis, mut count) = (0.0, 0);
    for seed in 21..25 {
        let log = drive(seed, 1.0);
        let run = run(&log, &with_carrier(&log, seed), 0.0);
        let velocity = run.summary.innovations[Aid::Velocity];
        assert_eq!(velocity.rejected, 0);
        nis += velocity.nis_sum;
        count += velocity.dof_sum;
    }
    let nis = nis / count as f64;
    // The stated noise is that of a phase near trees, above the simulated one.
    println!("NIS {nis:.3} of {count}");
    assert!((0.25..1.1).contains(&nis), "{nis}");
}

/// Errors at the ends of outages of `length` \[s\], of a receiver that sees so many satellites then and has no fix.
struct FewSatellites {
    /// Root mean square of the horizontal error \[m\].
    rms: f64,
    /// Its standard error \[m\].
    error: f64,
    /// Horizontal NEES per degree of freedom.
    nees: f64,
    /// Outages, and those inside 3σ each way.
    ends: usize,
    inside: usize,
}

fn few_satellites(seeds: std::ops::Range<u64>, length: f64, few: usize) -> FewSatellites {
    let (mut squares, mut fourth, mut nees, mut ends, mut inside) = (0.0, 0.0, 0.0, 0, 0);
    let start = |time: f64| 100.0 + 100.0 * ((time - 100.0) / 100.0).floor();
    let is_out =
        |time: f64| time > 100.0 && time - start(time) < length && time - start(time) > 0.0;
    for seed in seeds {
        let log = drive(seed, 1.0);
        let sky_start = 302_400.0;
        let mut sky = Sky::new(sky_start, seed);
        let (mut before, mut place): (Option<Epoch>, _) = (None, None);
        let mut navigator = Navigator::new(Settings {
            align: AlignSettings {
                heading: Heading::Given(log.truth[0].rpy.unwrap().z, 0.02),
                ..AlignSettings::default()
            },
            ..Settings::new(sensors())
        });
        let mut fixes = log.gnss.iter().peekable();
        let mut truth = log.truth.iter();
        for sample in &log.imu {
            navigator.imu(*sample).unwrap();
            let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + 1e-6) else {
                continue;
            };
            let at = truth.find(|row| row.time > fix.time - 1e-6).unwrap();
            let out = is_out(fix.time);
            if let Some(Position::Geodetic(known)) = fix.position.map(|p| p.0).filter(|_| !out) {
                place = Some(known);
            }
            let clock = 1e-4 + 1e-7 * fix.time;
            let time = sky_start + fix.time;
            let mut now = sky.epoch(time, &at.position, &at.v_n.unwrap(), clock);
            if out {
                // Above 20°, whichever these are at the start.
                let high = |seen: &Observation| {
                    let orbit = sky.ephemerides.of(seen.satellite, time).unwrap();
                    let line = orbit.at(start(fix.time) + sky_start).0 - at.position.to_ecef();
                    let up = -(at.position.ned_from_ecef() * line).z / line.norm();
                    up > 0.35
                };
                now.observations.retain(high);
                let seen = now.observations.len();
                now.observations
                    .rotate_left((start(fix.time) as usize / 100) % seen);
                now.observations.truncate(few);
            }
            let way = before.take().zip(place).and_then(|(before, place)| {
                let way = displacement(&sky.ephemerides, &before, &now, &place, &Vector3::zeros())?;
                Some((way, place))
            });
            before = Some(now);
            let mean_velocity = way.filter(|_| out).map(|(way, place)| MeanVelocity {
                over: way.over,
                v_n: way.ned / way.over,
                covariance: way.covariance / (way.over * way.over),
                place,
                by_place: way.by_place / way.over,
            });
            let seen = match out {
                false => *fix,
                true => GnssFix {
                    position: None,
                    velocity: None,
                    mean_velocity,
                    ..*fix
                },
            };
            if !out || few > 0 {
                navigator.fix(seen).unwrap();
            }
            if out && !is_out(fix.time + 1.0) {
                let filter = navigator.filter().unwrap();
                let off = at.position.offset_to(&filter.nav().position).xy();
                let std = filter.nav_std();
                squares += off.norm_squared();
                fourth += off.norm_squared().powi(2);
                let ratio = [off.x / std[0], off.y / std[1]];
                nees += 0.5 * (ratio[0] * ratio[0] + ratio[1] * ratio[1]);
                ends += 1;
                inside += usize::from(ratio.iter().all(|ratio| ratio.abs() < 3.0));
            }
        }
    }
    let mean = squares / ends as f64;
    let scatter = (fourth / ends as f64 - mean * mean) / ends as f64;
    FewSatellites {
        rms: mean.sqrt(),
        error: 0.5 * (scatter / mean).sqrt(),
        nees: nees / ends as f64,
        ends,
        inside,
    }
}

#[test]
fn fewer_satellites_than_a_fix_needs_slow_the_drift() {
    let [none, two, three] = [0, 2, 3].map(|few| few_satellites(21..24, 30.0, few));
    assert!(two.rms < 0.8 * none.rms && three.rms < 0.7 * none.rms);
    for found in [two, three] {
        assert!(found.nees < 2.0 && found.inside + 1 >= found.ends);
    }
}

/// The table of docs/lab/carrier.md.
#[test]
#[ignore = "a minute"]
fn drift_with_few_satellites() {
    for length in [30.0, 60.0] {
        for few in [0, 2, 3, 4, 24] {
            let found = few_satellites(1..9, length, few);
            println!(
                "{length} s, {few} satellites: {:.2} m ± {:.2}, NEES {:.2}, inside {} of {}",
                found.rms, found.error, found.nees, found.inside, found.ends
            );
            assert!(found.nees < 2.0 && found.inside + 2 >= found.ends);
        }
    }
}
