//! What wrong fixes do to a solution: gross outliers, jumps, spoofing, wrong accuracies, a frozen
//! receiver, wrong times and lever arms. Figures as in docs/faults.md. Tests on the public drive are
//! skipped, and say so, where the data is missing.
//!
//! Random numbers are xoshiro256++ from the seeds given.

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::{Path, PathBuf};
use undrift::{
    drive::Drive,
    io::ReadError,
    nav::{
        Vector3,
        filter::Filter,
        mechanisation::NavState,
        parameters::{Parameter, Parameters, Prior},
        sample::{GnssFix, ImuSample, Position},
        shaping::ShapingFilter,
    },
    navigate::settings,
    noise::BiasModel,
    outages::{self, Schedule},
    reference::HORIZONTAL,
    replay::{GnssUse, Measurement, Observer, ReplayError, Settings, Summary, replay},
    simulate::{GnssNoise, Trajectory, simulate},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A log in memory with its settings.
struct Log {
    imu: Vec<ImuSample>,
    gnss: Vec<GnssFix>,
    settings: Settings,
}

/// The real drive, if it is there.
fn rtk_drive() -> Option<Log> {
    let folder = root().join("../shared/data/rtk-drive");
    if !folder.is_dir() {
        println!("skipped: {} is missing", folder.display());
        return None;
    }
    let drive = Drive::load(&root().join("examples/rtk-drive.toml"), Some(&folder)).unwrap();
    let imu: Result<Vec<_>, ReadError> = drive.open_imu().unwrap().collect();
    let gnss: Result<Vec<_>, ReadError> = drive.open_gnss().unwrap().collect();
    Some(Log {
        imu: imu.unwrap(),
        gnss: gnss.unwrap(),
        settings: settings(&drive, BiasModel::Arma).unwrap(),
    })
}

#[derive(Default)]
struct Track(Vec<NavState>);

impl Observer for Track {
    fn sample<const N: usize>(&mut self, filter: &Filter<N>) -> Result<(), ReplayError> {
        self.0.push(*filter.nav());
        Ok(())
    }

    fn fix<const N: usize>(&mut self, _: &Filter<N>, _: &GnssFix, _: bool) {}
}

fn navigate(log: &Log, gnss: &[GnssFix]) -> (Vec<NavState>, Summary) {
    navigate_with(log, gnss, &log.settings)
}

fn navigate_with(log: &Log, gnss: &[GnssFix], settings: &Settings) -> (Vec<NavState>, Summary) {
    let mut track = Track::default();
    let imu = log.imu.iter().copied().map(Ok);
    let aiding = gnss.iter().copied().map(Measurement::Gnss).map(Ok);
    let summary = replay(imu, aiding, settings, &mut track).unwrap();
    (track.0, summary)
}

/// RMS over 10 s outages, every 30 s from `start` seconds after the first fix, of the largest horizontal error
/// against the fixes of `reference`, the filter being shown `gnss`.
fn drift_from(
    start: f64,
    log: &Log,
    gnss: &[GnssFix],
    settings: &Settings,
    reference: &[GnssFix],
) -> f64 {
    let plan = Schedule::Every {
        start,
        every: 30.0,
        count: Some(16),
    };
    let (first, last) = (reference[0].time, reference[reference.len() - 1].time);
    let cuts = outages::schedule(&plan, 10.0, first, last).unwrap();
    // What is withheld serves as the reference, so it is to be the clean one.
    let shown: Vec<GnssFix> = gnss
        .iter()
        .zip(reference)
        .map(|(shown, clean)| {
            let withheld = cuts.iter().any(|cut| cut.contains(clean.time));
            if withheld { *clean } else { *shown }
        })
        .collect();
    let settings = Settings {
        outages: cuts,
        ..settings.clone()
    };
    let results = outages::run(&log.imu, &shown, &[], &[("arma".into(), settings)]);
    results[0].1.as_ref().unwrap().errors.rms.0[HORIZONTAL]
}

/// As the project's figures for the real drive: from 40 s on.
fn drift(log: &Log, gnss: &[GnssFix], settings: &Settings, reference: &[GnssFix]) -> f64 {
    drift_from(40.0, log, gnss, settings, reference)
}

/// Largest horizontal distance [m] and angle of roll, pitch, yaw [deg] between two tracks, at the
/// instants both have from `from` on, and the root mean square of the distance.
fn apart(a: &[NavState], b: &[NavState], from: f64) -> (f64, f64, f64) {
    let (mut distance, mut angle, mut square, mut n) = (0.0f64, 0.0f64, 0.0, 0.0);
    let mut others = b.iter().peekable();
    for x in a.iter().filter(|x| x.time >= from) {
        while others.next_if(|y| y.time < x.time - 1e-6).is_some() {}
        let Some(y) = others.peek().filter(|y| y.time < x.time + 1e-6) else {
            continue;
        };
        let d = x.position.offset_to(&y.position).xy().norm();
        distance = distance.max(d);
        angle = angle.max((x.q_nb.inverse() * y.q_nb).angle().to_degrees());
        square += d * d;
        n += 1.0;
    }
    (distance, angle, f64::sqrt(square / n))
}

fn moved(fix: &GnssFix, by: Vector3) -> GnssFix {
    let mut fix = *fix;
    if let Some((position, _)) = &mut fix.position {
        *position = match position {
            Position::Geodetic(place) => Position::Geodetic(place.displaced(&by)),
            Position::Baseline { base, ned } => Position::Baseline {
                base: *base,
                ned: *ned + by,
            },
        };
    }
    fix
}

fn hurried(fix: &GnssFix, by: Vector3) -> GnssFix {
    let mut fix = *fix;
    if let Some((velocity, _)) = &mut fix.velocity {
        *velocity += by;
    }
    fix
}

fn uniform(dice: &mut Xoshiro256PlusPlus) -> f64 {
    (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// Of any direction, uniform on the sphere.
fn direction(dice: &mut Xoshiro256PlusPlus) -> Vector3 {
    let z = 2.0 * uniform(dice) - 1.0;
    let azimuth = std::f64::consts::TAU * uniform(dice);
    let level = (1.0 - z * z).sqrt();
    Vector3::new(level * azimuth.cos(), level * azimuth.sin(), z)
}

/// Index of the first fix at or after `time` seconds from the first.
fn at(gnss: &[GnssFix], time: f64) -> usize {
    let start = gnss[0].time;
    gnss.iter().position(|f| f.time >= start + time).unwrap()
}

/// Right of the direction of travel, as a horizontal unit vector.
fn sideways(fix: &GnssFix) -> Vector3 {
    let v = fix.velocity.unwrap().0;
    Vector3::new(-v.y, v.x, 0.0).normalize()
}

#[test]
fn gross_outliers() {
    let Some(log) = rtk_drive() else { return };
    let (clean, summary) = navigate(&log, &log.gnss);
    let nominal = drift(&log, &log.gnss, &log.settings, &log.gnss);
    println!(
        "clean: drift {nominal:.3} m; left out {}",
        summary.position.rejected + summary.velocity.rejected
    );
    for seed in 1..=5 {
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut count = 0;
        let shown: Vec<GnssFix> = log
            .gnss
            .iter()
            .map(|fix| {
                let (hit, size) = (uniform(&mut dice) < 0.02, 20.0 + 480.0 * uniform(&mut dice));
                let way = direction(&mut dice);
                count += u32::from(hit);
                if hit { moved(fix, way * size) } else { *fix }
            })
            .collect();
        let (track, summary) = navigate(&log, &shown);
        let (distance, angle, rms) = apart(&track, &clean, summary.started.unwrap());
        let drift = drift(&log, &shown, &log.settings, &log.gnss);
        println!(
            "seed {seed}: {count} outliers, {} positions left out; drift {drift:.3} m; from the clean solution at most {distance:.3} m, {angle:.3} deg, RMS {rms:.4} m",
            summary.position.rejected
        );
        assert!((drift / nominal - 1.0).abs() < 0.1, "{drift} {nominal}");
        assert!(rms < 0.02 && distance < 0.5, "{rms} {distance}");
    }
}

#[test]
fn single_jump() {
    let Some(log) = rtk_drive() else { return };
    let (clean, _) = navigate(&log, &log.gnss);
    for (time, way) in [
        (100.0, Vector3::x()),
        (250.0, Vector3::y()),
        (400.0, -Vector3::x()),
    ] {
        let mut shown = log.gnss.clone();
        let k = at(&shown, time);
        shown[k] = moved(&shown[k], way * 50.0);
        let (track, summary) = navigate(&log, &shown);
        let (distance, angle, _) = apart(&track, &clean, shown[k].time);
        let jump = summary
            .contradictions
            .iter()
            .find(|c| c.start == shown[k].time)
            .unwrap();
        println!(
            "50 m at {time} s: moved by {distance:.4} m, {angle:.4} deg; reported {:.1} m, {} fix",
            jump.largest, jump.fixes
        );
        assert!(distance < 0.3 && angle < 0.1);
        assert!((jump.largest - 50.0).abs() < 1.0 && jump.fixes == 1);
    }
}

#[test]
fn several_jumps_in_sequence() {
    let Some(log) = rtk_drive() else { return };
    let (clean, _) = navigate(&log, &log.gnss);
    let mut dice = Xoshiro256PlusPlus::seed_from_u64(11);
    // Eight fixes, two seconds, wherever.
    let mut shown = log.gnss.clone();
    let k = at(&shown, 200.0);
    for fix in &mut shown[k..k + 8] {
        let way = direction(&mut dice) * (20.0 + 100.0 * uniform(&mut dice));
        *fix = moved(fix, way);
    }
    let (track, summary) = navigate(&log, &shown);
    let (distance, angle, _) = apart(&track, &clean, shown[k].time);
    println!(
        "eight wild fixes: moved by {distance:.3} m, {angle:.3} deg; {:?}",
        summary.contradictions
    );
    assert!(distance < 0.3 && angle < 0.5);

    // Five seconds 30 m to the north-east: multipath, or a wrong ambiguity.
    let mut shown = log.gnss.clone();
    for fix in &mut shown[k..k + 20] {
        *fix = moved(fix, Vector3::new(20.0, 20.0, 10.0));
    }
    let (track, summary) = navigate(&log, &shown);
    let (distance, angle, _) = apart(&track, &clean, shown[k].time);
    println!(
        "5 s at 30 m: moved by {distance:.3} m, {angle:.3} deg; {:?}",
        summary.contradictions
    );
    assert!(distance < 0.5 && angle < 0.5);
    assert!(
        summary
            .contradictions
            .iter()
            .any(|c| c.fixes == 20 && !c.gave_way)
    );
}

#[test]
fn outliers_of_velocity() {
    let Some(log) = rtk_drive() else { return };
    let (clean, _) = navigate(&log, &log.gnss);
    let nominal = drift(&log, &log.gnss, &log.settings, &log.gnss);
    let mut dice = Xoshiro256PlusPlus::seed_from_u64(3);
    let shown: Vec<GnssFix> = log
        .gnss
        .iter()
        .map(|fix| {
            let (hit, size) = (uniform(&mut dice) < 0.02, 2.0 + 28.0 * uniform(&mut dice));
            let way = direction(&mut dice);
            if hit { hurried(fix, way * size) } else { *fix }
        })
        .collect();
    let (track, summary) = navigate(&log, &shown);
    let (distance, angle, rms) = apart(&track, &clean, summary.started.unwrap());
    let drift = drift(&log, &shown, &log.settings, &log.gnss);
    println!(
        "velocity outliers: {} left out; drift {drift:.3} m; at most {distance:.3} m, {angle:.3} deg, RMS {rms:.4} m",
        summary.velocity.rejected
    );
    assert!((drift / nominal - 1.0).abs() < 0.1, "{drift} {nominal}");
    assert!(rms < 0.02);
}

#[test]
fn outlier_as_the_first_fix_after_an_outage() {
    let Some(log) = rtk_drive() else { return };
    for (length, size) in [(10.0, 50.0), (10.0, 20.0), (30.0, 100.0), (30.0, 20.0)] {
        let (mut clean, mut shown) = (log.gnss.clone(), log.gnss.clone());
        let (from, to) = (at(&clean, 200.0), at(&clean, 200.0 + length));
        shown[to] = moved(&shown[to], Vector3::new(size, 0.0, 0.0));
        clean.drain(from..to);
        shown.drain(from..to);
        let end = clean[from].time;
        let (reference, _) = navigate(&log, &clean);
        let (track, summary) = navigate(&log, &shown);
        let (distance, _, _) = apart(&track, &reference, end);
        let (later, angle, _) = apart(&track, &reference, end + 5.0);
        println!(
            "{size} m after {length} s without: at most {distance:.2} m apart, {later:.3} m and {angle:.3} deg after 5 s; {:?}",
            summary.contradictions
        );
        assert!(later < 0.3 && angle < 1.0);
    }
}

#[test]
fn outlier_during_alignment() {
    let Some(log) = rtk_drive() else { return };
    let (clean, summary) = navigate(&log, &log.gnss);
    let started = summary.started.unwrap();
    // The fix that completes the alignment, and one before it.
    let last = log
        .gnss
        .iter()
        .position(|f| f.time >= started - 1e-6)
        .unwrap();
    for k in [last, last - 1, last - 20] {
        let mut shown = log.gnss.clone();
        shown[k] = moved(&shown[k], Vector3::new(30.0, 40.0, 0.0));
        let (track, summary) = navigate(&log, &shown);
        let (later, angle, _) = apart(&track, &clean, started + 10.0);
        println!(
            "50 m off at fix {} of {last}: after 10 s {later:.3} m, {angle:.3} deg; {:?}",
            k, summary.contradictions
        );
        assert!(later < 0.3 && angle < 2.0);
    }
}

/// A minute in which the position is pulled away sideways at 0.5 m/s, then left there.
fn spoofed(gnss: &[GnssFix], velocity_follows: bool, smooth: f64) -> Vec<GnssFix> {
    let k = at(gnss, 200.0);
    let (start, way) = (gnss[k].time, sideways(&gnss[k]));
    gnss.iter()
        .map(|fix| {
            let since = fix.time - start;
            let ramp = |t: f64| {
                let t = t.clamp(0.0, 60.0);
                if smooth > 0.0 && t < smooth {
                    (0.5 * 0.5 * t * t / smooth, 0.5 * t / smooth)
                } else {
                    (0.5 * (t - 0.5 * smooth), 0.5)
                }
            };
            let (offset, speed) = ramp(since);
            let fix = moved(fix, way * if since > 0.0 { offset } else { 0.0 });
            if velocity_follows && since > 0.0 && since < 60.0 {
                hurried(&fix, way * speed)
            } else {
                fix
            }
        })
        .collect()
}

#[test]
fn slow_spoofing_is_reported() {
    let Some(log) = rtk_drive() else { return };
    for (velocity_follows, smooth) in [(false, 0.0), (true, 0.0), (false, 10.0), (true, 10.0)] {
        let shown = spoofed(&log.gnss, velocity_follows, smooth);
        let (_, summary) = navigate(&log, &shown);
        println!("velocity follows: {velocity_follows}, smooth over {smooth} s:");
        for c in &summary.contradictions {
            println!("  {c:?}");
        }
        for c in &summary.leans {
            println!("  {c:?}");
        }
        let start = shown[at(&shown, 200.0)].time;
        let during = |from: f64, to: f64| to > start && from < start + 60.0;
        let left_out = summary
            .contradictions
            .iter()
            .find(|c| during(c.start, c.end));
        let lean = summary.leans.iter().find(|c| during(c.start, c.end));
        match (velocity_follows, smooth > 0.0) {
            // At once, with its speed.
            (false, false) => assert!(left_out.is_some_and(|c| (c.growth - 0.5).abs() < 0.1)),
            // The step of the velocity at its beginning, at once.
            (true, false) => assert!(left_out.is_some_and(|c| c.start < start + 1.0)),
            // Each fix passes, all of them to one side.
            (false, true) => assert!(lean.is_some()),
            // 0.05 m/s² is within what the accelerometers may err: only its sudden end shows.
            (true, true) => {
                assert!(
                    summary
                        .contradictions
                        .iter()
                        .any(|c| c.start > start + 59.0)
                );
            }
        }
    }
}

/// The fixes with standard deviations multiplied by `factor`.
fn stated(gnss: &[GnssFix], factor: f64) -> Vec<GnssFix> {
    let variance = factor * factor;
    gnss.iter()
        .map(|fix| GnssFix {
            position: fix.position.map(|(p, r)| (p, r * variance)),
            velocity: fix.velocity.map(|(v, r)| (v, r * variance)),
            ..*fix
        })
        .collect()
}

#[test]
fn wrong_accuracies_are_found() {
    let Some(log) = rtk_drive() else { return };
    let adaptive = Settings {
        adapt: true,
        ..log.settings.clone()
    };
    let nominal = drift(&log, &log.gnss, &log.settings, &log.gnss);
    let (_, summary) = navigate_with(&log, &log.gnss, &adaptive);
    let own = summary.adapted.map(Option::unwrap);
    println!("as stated: drift {nominal:.3} m; factors found {own:.3?}");
    for factor in [0.15, 1.0, 7.0] {
        let shown = stated(&log.gnss, factor);
        let (_, plain) = navigate(&log, &shown);
        let (_, summary) = navigate_with(&log, &shown, &adaptive);
        let found = summary.adapted.map(Option::unwrap);
        let (before, after) = (
            drift(&log, &shown, &log.settings, &log.gnss),
            drift(&log, &shown, &adaptive, &log.gnss),
        );
        let nis = |s: &Summary| [s.position.per_dof().unwrap(), s.velocity.per_dof().unwrap()];
        println!(
            "stated times {factor}: NIS {:.3?}, adapted {:.3?}; factors found {found:.3?}; drift {before:.3} m, adapted {after:.3} m",
            nis(&plain),
            nis(&summary),
        );
        for (found, own) in found.into_iter().zip(own) {
            let ratio = found * factor / own;
            assert!((1.0 / 1.3..1.3).contains(&ratio), "{ratio}");
            assert!((1.0 / 1.3..1.3).contains(&(found * factor)), "{found}");
        }
        assert!((after / nominal - 1.0).abs() < 0.1, "{after} {nominal}");
        assert!(nis(&summary).iter().all(|r| (0.8..1.25).contains(r)));
    }
}

#[test]
fn a_frozen_receiver_is_not_believed() {
    let Some(log) = rtk_drive() else { return };
    let (clean, _) = navigate(&log, &log.gnss);
    // In motion; and standing at a light, where the start is at first no more than an odd acceleration.
    for (when, keeps_velocity) in [(120.0, false), (120.0, true), (200.0, false)] {
        let mut shown = log.gnss.clone();
        let (from, to) = (at(&shown, when), at(&shown, when + 20.0));
        let held = shown[from];
        for fix in &mut shown[from..to] {
            fix.position = held.position;
            fix.velocity = held
                .velocity
                .map(|(v, r)| (if keeps_velocity { v } else { Vector3::zeros() }, r));
        }
        let (track, summary) = navigate(&log, &shown);
        let (distance, _, _) = apart(&track, &clean, held.time);
        let (later, angle, _) = apart(&track, &clean, shown[to].time + 10.0);
        println!(
            "frozen for 20 s at {when} s, {:.1} m/s, velocity {}: at most {distance:.1} m apart, {later:.3} m, {angle:.3} deg 10 s after; {:?} {:?}",
            held.velocity.unwrap().0.norm(),
            if keeps_velocity { "held" } else { "zero" },
            summary.contradictions,
            summary.leans
        );
        assert!(summary.contradictions.iter().any(|c| c.frozen) || when > 150.0);
        assert!(!summary.contradictions.is_empty());
        assert!(later < 0.3 && angle < 2.0);
    }
}

#[test]
fn a_wrong_sign_is_named() {
    let Some(log) = rtk_drive() else { return };
    let (_, summary) = navigate(&log, &log.gnss);
    assert_eq!(summary.wrong_signs().count(), 0);
    let mut shown = log.gnss.clone();
    for fix in &mut shown {
        if let Some((v, _)) = &mut fix.velocity {
            v.z = -v.z;
        }
    }
    let (_, summary) = navigate(&log, &shown);
    let wrong: Vec<usize> = summary.wrong_signs().collect();
    println!(
        "velocity down reversed: named {wrong:?}; NIS {:?} {:?}, left out {} {}; leans {}, suspect {:?}, restarts {:?}",
        summary.position.per_dof(),
        summary.velocity.per_dof(),
        summary.position.rejected,
        summary.velocity.rejected,
        summary.leans.len(),
        summary.suspect,
        summary.restarts
    );
    assert_eq!(wrong, [2]);
}

#[test]
fn a_diverged_solution_begins_anew() {
    let Some(mut log) = rtk_drive() else { return };
    let (clean, _) = navigate(&log, &log.gnss);
    let start = log.gnss[0].time;
    // A sample that is no motion.
    let k = log.imu.iter().position(|s| s.time > start + 200.0).unwrap();
    let sample = log.imu[k];
    log.imu[k].dvel.x = 1e6;
    let (track, summary) = navigate(&log, &log.gnss);
    let restart = &summary.restarts[0];
    println!("one absurd sample: {:?}", summary.restarts);
    assert!(restart.time < start + 201.0);
    if let Some(resumed) = restart.resumed {
        let (distance, angle, _) = apart(&track, &clean, resumed + 60.0);
        println!("a minute after that: {distance:.3} m, {angle:.3} deg");
        assert!(distance < 1.0);
    }
    // A gyro that reads 30 deg/s too much for twenty seconds.
    log.imu[k] = sample;
    for sample in &mut log.imu[k..k + 2000] {
        sample.dtheta.z += 0.5 * sample.dt;
    }
    let (track, summary) = navigate(&log, &log.gnss);
    let end = log.gnss[log.gnss.len() - 1].time;
    let (distance, angle, _) = apart(&track, &clean, end - 30.0);
    println!(
        "a gyro gone wild: {:?}; suspect {:?}; {} spans left out; at the end {distance:.3} m, {angle:.3} deg",
        summary.restarts,
        summary.suspect,
        summary.contradictions.len()
    );
    assert!(!summary.restarts.is_empty() || summary.suspect.is_some());
    assert!(distance < 5.0);
}

/// A sensor of the class of the real drive's.
fn sensors(interval: f64) -> [ShapingFilter; 6] {
    let sensor = |white: f64, walk: f64, turn_on: f64| {
        ShapingFilter::white(white, interval)
            .and_then(|f| f.plus(&ShapingFilter::random_walk(walk, interval)?))
            .and_then(|f| f.plus(&ShapingFilter::constant(turn_on, interval)?))
            .unwrap()
    };
    let gyro = sensor(
        0.01f64.to_radians(),
        0.0005f64.to_radians(),
        0.3f64.to_radians(),
    );
    let accel = sensor(1e-3, 1e-4, 0.1);
    [gyro, gyro, gyro, accel, accel, accel]
}

/// Ten minutes of a simulated car with an antenna at (0.8, -0.4, -1.2) m.
fn simulated(seed: u64) -> Log {
    let lever_arm = Vector3::new(0.8, -0.4, -1.2);
    let noise = GnssNoise {
        position_std: [0.01, 0.01, 0.02],
        velocity_std: [0.05; 3],
        rate_hz: 5.0,
        start: 1.037,
        lever_arm,
        ..GnssNoise::default()
    };
    let car = Trajectory::car(600.0, seed);
    let log = simulate(&car, 100.0, Some(&sensors(0.01)), &noise, seed).unwrap();
    let settings = Settings {
        lever_arm,
        ..Settings::new(sensors(0.01))
    };
    Log {
        imu: log.imu,
        gnss: log.gnss,
        settings,
    }
}

fn estimate(summary: &Summary, kind: Parameter) -> (Vec<f64>, Vec<f64>) {
    let (_, value, std) = summary.parameters.iter().find(|p| p.0 == kind).unwrap();
    (value.clone(), std.clone())
}

#[test]
fn a_time_offset_is_estimated() {
    for seed in 1..=3 {
        let mut log = simulated(seed);
        log.settings.parameters = Parameters::none().with(
            Parameter::TimeOffset,
            Prior {
                std: 0.2,
                walk: 0.0,
            },
        );
        for offset in [-0.2, 0.0, 0.2] {
            let mut shown = log.gnss.clone();
            for fix in &mut shown {
                fix.time -= offset;
            }
            let (_, summary) = navigate(&log, &shown);
            let (value, std) = estimate(&summary, Parameter::TimeOffset);
            println!(
                "seed {seed}, offset {offset}: {:.4} ± {:.4} s; NIS {:.3} {:.3}; left out {} {}",
                value[0],
                std[0],
                summary.position.per_dof().unwrap(),
                summary.velocity.per_dof().unwrap(),
                summary.position.rejected,
                summary.velocity.rejected
            );
            assert!((value[0] - offset).abs() < 0.005, "{}", value[0]);
            let nis = summary.position.per_dof().unwrap();
            assert!((nis - 1.0).abs() < 0.15, "{nis}");
        }
    }
}

#[test]
fn a_time_offset_is_estimated_on_the_real_drive() {
    let Some(mut log) = rtk_drive() else { return };
    // Its velocities hold 0.15 s before its positions do, so that both together have no one offset.
    log.settings.gnss_use = GnssUse::Position;
    log.settings.parameters = Parameters::none().with(
        Parameter::TimeOffset,
        Prior {
            std: 0.2,
            walk: 0.0,
        },
    );
    let mut found = Vec::new();
    for offset in [-0.2, 0.0, 0.2] {
        let mut shown = log.gnss.clone();
        for fix in &mut shown {
            fix.time -= offset;
        }
        let (_, summary) = navigate(&log, &shown);
        let (value, std) = estimate(&summary, Parameter::TimeOffset);
        println!(
            "offset {offset}: {:.4} ± {:.4} s; NIS {:.3}; left out {}",
            value[0],
            std[0],
            summary.position.per_dof().unwrap(),
            summary.position.rejected
        );
        found.push(value[0] - offset);
    }
    // What the log has of its own is in all three.
    assert!(
        (found[0] - found[1]).abs() < 0.005 && (found[2] - found[1]).abs() < 0.005,
        "{found:?}"
    );
}

#[test]
fn a_time_offset_survives_outages() {
    let mut log = simulated(4);
    log.settings.parameters = Parameters::none().with(
        Parameter::TimeOffset,
        Prior {
            std: 0.2,
            walk: 0.0,
        },
    );
    let nominal = drift_from(110.0, &log, &log.gnss, &log.settings, &log.gnss);
    for offset in [-0.2, 0.2] {
        let mut shown = log.gnss.clone();
        for fix in &mut shown {
            fix.time -= offset;
        }
        let drift = drift_from(110.0, &log, &shown, &log.settings, &shown);
        println!("offset {offset}: drift {drift:.3} m, without offset {nominal:.3} m");
        assert!((drift / nominal - 1.0).abs() < 0.15, "{drift} {nominal}");
    }
}

#[test]
fn a_wrong_lever_arm_is_estimated() {
    for (seed, wrong) in [
        (1, Vector3::new(0.5, 0.0, 0.0)),
        (2, Vector3::new(0.3, -0.4, 0.0)),
        (3, Vector3::new(-0.3, 0.3, 0.27)),
    ] {
        let mut log = simulated(seed);
        log.settings.lever_arm += wrong;
        log.settings.parameters = Parameters::none().with(
            Parameter::LeverArm,
            Prior {
                std: 0.5,
                walk: 0.0,
            },
        );
        let (_, summary) = navigate(&log, &log.gnss);
        let (value, std) = estimate(&summary, Parameter::LeverArm);
        let miss: Vec<f64> = (0..3).map(|i| value[i] + wrong[i]).collect();
        println!(
            "seed {seed}, wrong by {:?}: missed by {miss:.3?} ± {std:.3?} m; NIS {:.3}; left out {}",
            wrong.as_slice(),
            summary.position.per_dof().unwrap(),
            summary.position.rejected
        );
        assert!(miss[0].abs() < 0.05 && miss[1].abs() < 0.05, "{miss:?}");
        assert!(
            miss[2].abs() < 4.0 * std[2] && miss[2].abs() < 0.3,
            "{miss:?}"
        );
    }
}
