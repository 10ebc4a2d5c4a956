//! Smoothed best estimate of trajectory (SBET), as Applanix POSPac and others write it: records of 17
//! doubles, the lowest byte first, without a header.
//!
//! Time \[s\], latitude, longitude \[rad\], height \[m\], three velocities, roll, pitch, platform heading and
//! wander angle \[rad\], three body accelerations and three rates. The heading is that of the platform less the
//! wander angle. The velocities are left: programs disagree on their axes (of the wander frame, or of the
//! vehicle with z up).

use undrift_nav::Vector3;
use undrift_nav::earth::{Geodetic, wrap_pi};
use undrift_nav::sample::TruthSample;

use super::bytes::{self, ByteFields};
use super::receiver::{by_steps, check, one_stream};
use crate::ReadError;
use crate::entry::{Entries, Stream, StreamKind, Wanted, What};
use crate::skipped::SkipKind;
use crate::source::Source;

const STREAM: &str = "SBET";
/// Of a record \[bytes\].
const RECORD: usize = 17 * 8;
/// Longest step from one record to the next by which such a file is known \[s\].
const STEP: f64 = 10.0;

/// Whether the first bytes of a file are records of plausible states whose times go forward: there is
/// no other mark.
pub(crate) fn detect(start: &[u8]) -> bool {
    let records: Vec<Option<TruthSample>> = start.chunks_exact(RECORD).take(50).map(pose).collect();
    let goes_on = |pair: &[Option<TruthSample>]| match pair {
        [Some(a), Some(b)] => b.time > a.time && b.time - a.time < STEP,
        _ => false,
    };
    records.len() > 1 && records.windows(2).all(goes_on)
}

pub(super) fn entries(mut source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(wanted, "SBET", [&[], &[STREAM], &[]])?;
    if !matches!(wanted, Wanted::Poses(_)) {
        let problem = "SBET is a solution, not a log of fixes";
        return Err(ReadError::nameless(problem).mend("use it in [truth]"));
    }
    let (mut at, mut record) = (0, Vec::new());
    Ok(by_steps(wanted, move |ready| {
        let read = bytes::read(&mut source, RECORD as u64, &mut record);
        if record.is_empty() && read.is_err() && bytes::at_end(&mut source) {
            return Ok((false, None));
        }
        at += 1;
        match (read, pose(&record)) {
            (Err(why), _) => {
                ready.skip(at, SkipKind::EndsEarly, why);
                return Ok((false, None));
            }
            (Ok(()), Some(pose)) => ready.push(at, What::Pose(pose)),
            (Ok(()), None) => ready.skip(at, SkipKind::Damaged, "no state of a vehicle"),
        }
        Ok((true, None))
    }))
}

pub(super) fn streams(mut source: Source) -> Result<Vec<Stream>, ReadError> {
    let (mut messages, mut record) = (0, Vec::new());
    while bytes::read(&mut source, RECORD as u64, &mut record).is_ok() {
        messages += 1;
    }
    let about = "position and attitude";
    Ok(one_stream(STREAM, StreamKind::Poses, about, messages))
}

/// The state of a record; `None` if it cannot be one.
fn pose(record: &[u8]) -> Option<TruthSample> {
    let all = ByteFields::packed(record).array::<17>()?;
    let [
        time,
        lat,
        lon,
        height,
        _,
        _,
        _,
        roll,
        pitch,
        platform,
        wander,
        ..,
    ] = all;
    let position = Geodetic { lat, lon, height };
    let turn = std::f64::consts::TAU;
    let angles = [roll, pitch, platform, wander]
        .iter()
        .all(|angle| angle.abs() <= turn);
    let plausible = all.iter().all(|value| value.is_finite())
        && angles
        && (0.0..1e10).contains(&time)
        && position.is_valid()
        && !(lat == 0.0 && lon == 0.0);
    plausible.then(|| TruthSample {
        time,
        position,
        v_n: None,
        rpy: Some(Vector3::new(roll, pitch, wrap_pi(platform - wander))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::receiver::testing::{all, source_of, try_all};

    fn record(k: u32, wander: f64) -> Vec<u8> {
        let x = f64::from(k);
        let mut values = [0.0; 17];
        values[..4].copy_from_slice(&[345_600.0 + 0.005 * x, 0.75, -1.25 + 1e-7 * x, 120.5]);
        values[4..7].copy_from_slice(&[1.0, 2.0, 3.0]);
        values[7..11].copy_from_slice(&[0.01, -0.02, 1.5 + wander, wander]);
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    }

    #[test]
    fn records_are_states() {
        let bytes: Vec<u8> = (0..20).flat_map(|k| record(k, 0.25)).collect();
        assert!(detect(&bytes));
        let (found, skipped) = all(entries, &bytes, &Wanted::Poses(None));
        assert_eq!((found.len(), skipped.total()), (20, 0));
        let What::Pose(pose) = found[3].what else {
            panic!("{found:?}");
        };
        assert_eq!(pose.time, 345_600.0 + 0.005 * 3.0);
        assert_eq!(pose.position.lon, -1.25 + 1e-7 * 3.0);
        assert!((pose.rpy.unwrap() - Vector3::new(0.01, -0.02, 1.5)).amax() < 1e-15);
        assert!(pose.v_n.is_none());
        assert_eq!(streams(source_of(&bytes)).unwrap()[0].messages, 20);
    }

    #[test]
    fn damage_of_any_kind() {
        let bytes: Vec<u8> = (0..20).flat_map(|k| record(k, 0.0)).collect();
        for length in (0..bytes.len()).step_by(7) {
            let (found, skipped) = all(entries, &bytes[..length], &Wanted::Poses(None));
            assert_eq!(found.len(), length / RECORD);
            let broken = u64::from(!length.is_multiple_of(RECORD));
            assert_eq!(skipped.count(SkipKind::EndsEarly), broken);
        }
        for k in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[k] ^= 1 << (k % 8);
            let (found, _, _) = try_all(entries, source_of(&flipped), &Wanted::Poses(None));
            assert!(found.len() >= 19 && found.iter().all(|entry| entry.what.is_finite()));
        }
        for other in [
            &bytes[4..],
            b"",
            &[0; 1000],
            &[b' '; 1000],
            b"1 2 3\n4 5 6\n",
        ] {
            assert!(!detect(other));
        }
    }
}
