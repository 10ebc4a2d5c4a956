//! Velocities by the carrier phase on real logs, which are not part of the project.

use crate::public::find;
use undrift_io::format::Format;
use undrift_io::gnss::{GnssLog, GnssReader, GnssSource};
use undrift_nav::sample::{FixQuality, GnssFix, Position};
use undrift_nav::{Vector3, earth::Geodetic};

/// All fixes of a UBX log with mean velocities by its carrier phases.
pub(crate) fn fixes(file: &str) -> Option<Vec<GnssFix>> {
    let log = GnssLog {
        velocity: Some("RXM-RAWX".into()),
        ..GnssLog::new(Format::Ubx)
    };
    let reader = GnssReader::open(&find(file)?, &GnssSource::Log(log)).unwrap();
    Some(reader.map(Result::unwrap).collect())
}

fn place(fix: &GnssFix) -> Geodetic {
    match fix.position {
        Some((Position::Geodetic(place), _)) => place,
        _ => panic!("{fix:?}"),
    }
}

/// Root mean squares over `steps` fixes of the way by the carrier and by the receiver's velocities, both less RTK's \[m\], each axis; and of
/// how many.
pub(crate) fn against_rtk(fixes: &[GnssFix], steps: usize) -> ([Vector3; 2], usize) {
    let (mut sums, mut count) = ([Vector3::zeros(); 2], 0);
    for span in fixes.windows(steps + 1) {
        let by_rtk = place(&span[0]).offset_to(&place(&span[steps]));
        let mut off = [-by_rtk; 2];
        let mut whole = span.iter().all(|fix| fix.quality == FixQuality::Fixed);
        for pair in span.windows(2) {
            let Some(mean) = pair[1].mean_velocity else {
                whole = false;
                break;
            };
            let own = |fix: &GnssFix| fix.velocity.unwrap().0;
            off[0] += mean.v_n * mean.over;
            off[1] += (own(&pair[0]) + own(&pair[1])) * (0.5 * mean.over);
        }
        if whole {
            for (sum, off) in sums.iter_mut().zip(off) {
                *sum += off.component_mul(&off);
            }
            count += 1;
        }
    }
    (sums.map(|sum| (sum / count as f64).map(f64::sqrt)), count)
}

#[test]
fn a_walk_by_the_carrier_is_that_of_rtk() {
    let Some(fixes) = fixes("walk0827-ubx-raw/gnss_1730.ubx") else {
        return;
    };
    let with = fixes.iter().filter(|fix| fix.mean_velocity.is_some());
    assert!(with.count() > 400);
    // 1 cm is the resolution of the receiver's positions.
    for (steps, level, down) in [(1, 0.03, 0.2), (20, 0.04, 0.25)] {
        let ([carrier, own], count) = against_rtk(&fixes, steps);
        println!("{steps} steps, {count}: {carrier} {own} m");
        assert!(count > 100 && carrier.xy().amax() < level && carrier.z < down);
        if steps == 20 {
            assert!(carrier.xy().norm() < 0.4 * own.xy().norm());
        }
    }
}

#[test]
fn a_receiver_that_is_put_down_stands_still() {
    let Some(fixes) = fixes("ubx-raw-only/nhm.ubx") else {
        return;
    };
    // Of the last seven seconds, 1 Hz.
    let last = fixes.iter().rev().take(7);
    let speeds: Vec<f64> = last
        .map(|fix| fix.mean_velocity.unwrap().v_n.norm())
        .collect();
    assert!(speeds.iter().all(|speed| *speed < 0.06), "{speeds:?} m/s");
    let with = fixes.iter().filter(|fix| fix.mean_velocity.is_some());
    assert!(with.count() > 70);
}
