use crate::sky::Sky;
use undrift_nav::{Matrix3, Vector3, earth::Geodetic};
use undrift_observables::{Displacement, Epoch, displacement};

const START: f64 = 302_400.0;

fn home() -> Geodetic {
    Geodetic::from_degrees(47.0, 8.0, 400.0)
}

/// A receiver whose clock is off by up to a millisecond and drifts.
fn clock(time: f64) -> f64 {
    4e-4 + 1e-7 * (time - START)
}

/// Two epochs `over` \[s\] apart of an antenna that moves by `v_n` from home on.
fn pair(sky: &mut Sky, time: f64, over: f64, v_n: &Vector3) -> ([Epoch; 2], [Geodetic; 2]) {
    let from = home();
    let to = from.displaced(&(v_n * over));
    let before = sky.epoch(time, &from, v_n, clock(time));
    let after = sky.epoch(time + over, &to, v_n, clock(time + over));
    ([before, after], [from, to])
}

fn by(sky: &Sky, [before, after]: &[Epoch; 2], place: &Geodetic, v_n: &Vector3) -> Displacement {
    displacement(&sky.ephemerides, before, after, place, v_n).unwrap()
}

#[test]
fn without_noise_the_way_is_exact_but_for_air_and_place() {
    let mut sky = Sky::new(START, 1);
    sky.noise = 0.0;
    let v_n = Vector3::new(25.0, -14.0, 3.0);
    for over in [0.1, 1.0, 1.9] {
        let (epochs, [_, to]) = pair(&mut sky, START + 1000.0, over, &v_n);
        let way = by(&sky, &epochs, &to, &Vector3::zeros());
        // Another mapping of the troposphere: 0.2 mm/s; clock's drift times the interval's length, 3 µm.
        assert!((way.ned - v_n * over).amax() < 5e-4 * over, "{way:?}");
        assert!((way.clock - 1e-7 * over * 299_792_458.0).abs() < 5e-4 * over);
        assert_eq!(way.by_doppler, 0);
        assert!((way.over - over).abs() < 1e-6);
        // A place that is wrong by 10 m: what the module states.
        let off = to.displaced(&Vector3::new(6.0, -6.0, 5.0));
        let wrong = by(&sky, &epochs, &off, &v_n);
        let error = (wrong.ned - way.ned).norm();
        assert!(error > 2e-5 * over && error < 4e-3 * over, "{error}");
    }
}

#[test]
fn errors_are_as_the_covariance_says() {
    let mut sky = Sky::new(START, 2);
    sky.noise = 0.006;
    let v_n = Vector3::new(12.0, 5.0, -1.0);
    let (mut sum, mut spread) = (0.0, Matrix3::zeros());
    let runs = 300;
    for k in 0..runs {
        let (epochs, [_, to]) = pair(&mut sky, START + 10.0 * f64::from(k), 0.2, &v_n);
        let way = by(&sky, &epochs, &to, &v_n);
        let off = way.ned - v_n * 0.2;
        sum += (way.covariance.try_inverse().unwrap() * off).dot(&off);
        spread += off * off.transpose();
    }
    // Of 300 draws of three components the mean is good to 5 %; the noise is what the stated one and multipath are, twice.
    let nees = sum / f64::from(3 * runs);
    assert!((0.7..1.25).contains(&nees), "{nees}");
    let rms = (spread / f64::from(runs)).diagonal().map(f64::sqrt);
    assert!(rms.amax() < 0.024, "{rms} m");
}

#[test]
fn a_slip_that_nobody_reports_is_found() {
    let v_n = Vector3::new(12.0, 5.0, -1.0);
    for seed in 0..20 {
        let mut sky = Sky::new(START, seed);
        let before = sky.epoch(START, &home(), &v_n, 0.0);
        let seen = before.observations.len();
        let number = before.observations[seed as usize % seen].satellite.number;
        sky.slipped[usize::from(number)] = if seed % 2 == 0 { 1.0 } else { -0.5 };
        let to = home().displaced(&(v_n * 0.2));
        let after = sky.epoch(START + 0.2, &to, &v_n, 0.0);
        let way = by(&sky, &[before, after], &to, &v_n);
        assert!((way.ned - v_n * 0.2).norm() < 0.05, "{seed}: {way:?}");
    }
}

#[test]
fn a_reported_slip_leaves_the_doppler_shift() {
    let v_n = Vector3::new(12.0, 5.0, -1.0);
    let mut sky = Sky::new(START, 5);
    let ([before, after], [_, to]) = pair(&mut sky, START, 0.2, &v_n);
    let whole = by(&sky, &[before.clone(), after.clone()], &to, &v_n);
    type Spoil = fn(&mut undrift_observables::Observation);
    let ways: [Spoil; 3] = [
        |seen| seen.lock = 0.1,
        |seen| seen.phase = None,
        |seen| seen.half_subtracted = true,
    ];
    for spoil in ways {
        let mut slipped = after.clone();
        slipped.observations.iter_mut().take(3).for_each(spoil);
        let way = by(&sky, &[before.clone(), slipped], &to, &v_n);
        assert_eq!(way.by_doppler + way.satellites, whole.satellites);
        assert!(way.by_doppler > 0 && way.by_doppler <= 3);
        assert!(way.covariance.trace() > whole.covariance.trace());
        assert!((way.ned - v_n * 0.2).norm() < 0.05, "{way:?}");
    }
    // All by their Doppler shifts: a velocity to some cm/s.
    let mut slipped = after.clone();
    slipped
        .observations
        .iter_mut()
        .for_each(|seen| seen.phase = None);
    let way = by(&sky, &[before.clone(), slipped], &to, &v_n);
    let off = (way.ned / 0.2 - v_n).norm();
    assert!(way.satellites == 0 && off > 0.01 && off < 0.3, "{off}");
    let std = way.covariance.trace().sqrt() / 0.2;
    assert!(std > 0.3 && std < 1.5, "{std}");
}

#[test]
fn nothing_is_said_where_it_cannot_be_had() {
    let v_n = Vector3::zeros();
    let mut sky = Sky::new(START, 6);
    let ([before, mut after], [_, to]) = pair(&mut sky, START, 0.2, &v_n);
    let none = |before: &Epoch, after: &Epoch| {
        displacement(&sky.ephemerides, before, after, &to, &v_n).is_none()
    };
    assert!(!none(&before, &after));
    // Backwards, of one instant, too far apart.
    assert!(none(&after, &before) && none(&before, &before));
    let late = Epoch {
        time: before.time + 2.5,
        ..after.clone()
    };
    assert!(none(&before, &late));
    // Phases that contradict each other.
    let mut torn = after.clone();
    for (k, seen) in torn.observations.iter_mut().enumerate() {
        seen.phase = seen.phase.map(|phase| phase + (k * k % 7) as f64);
    }
    assert!(none(&before, &torn));
    // One satellite.
    after.observations.truncate(1);
    assert!(none(&before, &after));
}

/// Two and three satellites: the differences of their ranges are those of the way, what is across is open; the covariance says which.
#[test]
fn few_satellites_give_the_directions_that_they_show() {
    let v_n = Vector3::new(12.0, 5.0, -1.0);
    for few in [2, 3, 4] {
        let (mut within, mut runs) = (0.0, 0);
        for k in 0..100 {
            let mut sky = Sky::new(START, 100 + k);
            let ([before, mut after], [_, to]) = pair(&mut sky, START + 20.0 * k as f64, 1.0, &v_n);
            after.observations.rotate_left(k as usize % 6);
            after.observations.truncate(few);
            let Some(way) = displacement(&sky.ephemerides, &before, &after, &to, &Vector3::zeros())
            else {
                continue;
            };
            assert!(!way.is_checked());
            let split = way.covariance.symmetric_eigen();
            let known = split.eigenvalues.iter().filter(|one| **one < 1.0);
            if known.count() != few - 1 {
                continue; // Satellites below the elevation mask.
            }
            let off = split.eigenvectors.tr_mul(&(way.ned - v_n));
            for (off, variance) in off.iter().zip(&split.eigenvalues) {
                if *variance < 1.0 {
                    within += off * off / variance;
                    runs += 1;
                }
            }
        }
        // Noise of 3 mm, stated as 4.4 mm twice.
        let nees = within / f64::from(runs);
        println!("{few}: NEES {nees} of {runs}");
        assert!(
            runs > 60 && (0.02..0.2).contains(&nees),
            "{few}: {nees} {runs}"
        );
    }
}

/// A place that is wrong changes the way as stated: where no satellite is taken for one that slipped.
#[test]
fn the_way_changes_with_the_place_as_stated() {
    let mut sky = Sky::new(START, 8);
    sky.noise = 0.0;
    let v_n = Vector3::new(12.0, 5.0, -1.0);
    let (epochs, [_, to]) = pair(&mut sky, START + 500.0, 1.0, &v_n);
    let way = by(&sky, &epochs, &to, &v_n);
    let off = Vector3::new(30.0, -25.0, 4.0);
    let moved = by(&sky, &epochs, &to.displaced(&off), &v_n);
    let (made, said) = (moved.ned - way.ned, way.by_place * off);
    assert!(
        said.norm() > 5e-3 && (made - said).norm() < 3e-4,
        "{made} {said}"
    );
}
