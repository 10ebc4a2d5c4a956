//! Velocities by the carrier phase on real logs, which are not part of the project.

use crate::public::find;
use undrift_io::format::Format;
use undrift_io::gnss::{GnssLog, GnssReader, GnssSource};
use undrift_nav::sample::{FixQuality, GnssFix, Position};
use undrift_nav::{Vector3, earth::Geodetic};

/// All fixes of a UBX log with mean velocities by its carrier phases.
fn fixes(file: &str) -> Option<Vec<GnssFix>> {
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

/// Root mean squares of carrier less RTK over `steps` fixes, each axis \[m\], and how many there are.
fn against_rtk(fixes: &[GnssFix], steps: usize) -> (Vector3, usize) {
    let (mut sum, mut count) = (Vector3::zeros(), 0);
    for span in fixes.windows(steps + 1) {
        let fixed = |fix: &GnssFix| fix.quality == FixQuality::Fixed;
        let way = |sum: Option<Vector3>, fix: &GnssFix| {
            let mean = fix.mean_velocity?;
            Some(sum? + mean.v_n * mean.over)
        };
        let by_carrier = span[1..].iter().fold(Some(Vector3::zeros()), way);
        if let (Some(by_carrier), true) = (by_carrier, span.iter().all(fixed)) {
            let by_rtk = place(&span[0]).offset_to(&place(&span[steps]));
            let off = by_carrier - by_rtk;
            if steps == 1 {
                let m = span[1].mean_velocity.unwrap();
                println!(
                    "D {:.3} off {:?} sd {:?} pvt {:?}",
                    span[1].time,
                    off.map(|x| (x * 1e3).round()).as_slice(),
                    m.covariance
                        .diagonal()
                        .map(|x| (x.sqrt() * m.over * 1e3).round())
                        .as_slice(),
                    ((span[0].velocity.unwrap().0 + span[1].velocity.unwrap().0) * 0.5 * m.over
                        - by_rtk)
                        .map(|x| (x * 1e3).round())
                        .as_slice()
                );
            }
            sum += off.component_mul(&off);
            count += 1;
        }
    }
    ((sum / count as f64).map(f64::sqrt), count)
}

#[test]
fn a_walk_by_the_carrier_is_that_of_rtk() {
    let Some(fixes) = fixes("walk0827-ubx-raw/gnss_1730.ubx") else {
        return;
    };
    let with = fixes.iter().filter_map(|fix| fix.mean_velocity);
    let with: Vec<_> = with.collect();
    let std = with.iter().map(|mean| mean.covariance.diagonal());
    println!(
        "{} of {} fixes, σ {:?}",
        with.len(),
        fixes.len(),
        (std.sum::<Vector3>() / with.len() as f64).map(f64::sqrt)
    );
    for steps in [1, 4, 20] {
        let (rms, count) = against_rtk(&fixes, steps);
        println!("{steps} steps: {rms:?} m of {count}");
    }
    let (rms, count) = against_rtk(&fixes, 20);
    assert!(count > 50 && rms.amax() < 0.02, "{rms} m of {count}");
}

#[test]
fn at_rest() {
    let Some(fixes) = fixes("ubx-raw-only/nhm.ubx") else {
        return;
    };
    for fix in &fixes {
        println!(
            "{} {:?} {:?} {:?}",
            fix.time,
            fix.quality,
            fix.velocity.map(|v| (v.0, v.1[(0, 0)].sqrt())),
            fix.mean_velocity
                .map(|m| (m.v_n, m.covariance.diagonal().map(f64::sqrt)))
        );
    }
}
