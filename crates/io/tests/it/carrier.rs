//! Velocities by the carrier phase on real logs, which are not part of the project.

use crate::{public::find, rinex::messages};
use std::path::Path;
use undrift_io::Opened;
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

/// The log of a receiver without a fix from one second of the week to another.
fn without_fixes(log: &[u8], (from, to): (f64, f64)) -> Vec<u8> {
    let mut text = Vec::new();
    for (kind, payload) in messages(log) {
        let mut payload = payload.to_vec();
        if kind == [0x01, 0x07] {
            let time = f64::from(u32::from_le_bytes(payload[..4].try_into().unwrap())) * 1e-3;
            if time > from && time < to {
                payload[20] = 0;
                payload[21] = 0;
            }
        }
        let mut body = kind.to_vec();
        body.extend((payload.len() as u16).to_le_bytes());
        body.extend(payload);
        let sums = body.iter().fold([0u8; 2], |[a, b], byte| {
            let a = a.wrapping_add(*byte);
            [a, b.wrapping_add(a)]
        });
        text.extend([0xb5, 0x62]);
        text.extend(body);
        text.extend(sums);
    }
    text
}

#[test]
fn an_epoch_without_fix_has_the_way_by_its_phases() {
    let name = "walk0827-ubx-raw/gnss_1730.ubx";
    let (Some(log), Some(whole)) = (find(name), fixes(name)) else {
        return;
    };
    let out = (408_720.0, 408_730.0);
    let bytes = without_fixes(&std::fs::read(log).unwrap(), out);
    let source = GnssLog {
        velocity: Some("RXM-RAWX".into()),
        ..GnssLog::new(Format::Ubx)
    };
    let opened = Opened::stream(Path::new("cut.ubx"), std::io::Cursor::new(bytes)).unwrap();
    let reader = GnssReader::new(opened, &GnssSource::Log(source)).unwrap();
    let cut: Vec<GnssFix> = reader.map(Result::unwrap).collect();
    let (mut count, mut off) = (0, Vec::new());
    for fix in cut
        .iter()
        .filter(|fix| fix.time > out.0 + 0.1 && fix.time < out.1 - 0.1)
    {
        assert!(fix.position.is_none() && fix.velocity.is_none());
        let (mean, same) = (
            fix.mean_velocity.unwrap(),
            whole.iter().find(|one| one.time == fix.time),
        );
        if let Some(with) = same.and_then(|one| one.mean_velocity) {
            // The place is the last known one, metres away.
            let stale = mean.v_n + mean.by_place * mean.place.offset_to(&with.place);
            off.push((stale - with.v_n).norm() * mean.over);
            count += 1;
        }
    }
    off.sort_by(f64::total_cmp);
    println!(
        "{count} without fix, off by {:.5} m at the median",
        off[count / 2]
    );
    assert!(count > 30 && off[count / 2] < 1e-4);
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
