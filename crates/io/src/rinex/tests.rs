//! Against georinex's readings of the same files: `testdata/golden/rinex.py`.

use super::*;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::Position;
use undrift_observables::{Observation, Satellite};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/rinex/");

fn text(name: &str) -> String {
    std::fs::read_to_string(format!("{FOLDER}{name}")).unwrap()
}

fn held(name: &str, text: &str) -> RinexFile {
    (name.into(), Some(Memory::Bytes(text.as_bytes().into())))
}

fn opened(files: &[(&str, String)]) -> Result<Rinex, ReadError> {
    let files: Vec<RinexFile> = files.iter().map(|(name, text)| held(name, text)).collect();
    Rinex::open(&files)
}

/// The files of a version as they are.
fn of(version: &str) -> Rinex {
    let [obs, nav] = ["obs", "nav"].map(|kind| format!("{version}.{kind}"));
    opened(&[(&obs, text(&obs)), (&nav, text(&nav))]).unwrap()
}

fn epochs(rinex: &mut Rinex) -> Vec<Epoch> {
    std::iter::from_fn(|| rinex.read().unwrap()).collect()
}

fn satellite(name: &str) -> Satellite {
    let (letter, number) = name.split_at(1);
    Satellite {
        system: system(letter.as_bytes()[0]).unwrap(),
        number: number.parse().unwrap(),
    }
}

fn seen(epoch: &Epoch, name: &str) -> Observation {
    let wanted = satellite(name);
    let mut all = epoch.observations.iter();
    *all.find(|one| one.satellite == wanted).unwrap()
}

#[test]
fn observations_are_those_that_georinex_reads() {
    let files = ["two", "three"].map(|version| (version, epochs(&mut of(version))));
    let mut count = 0;
    for line in text("observations.csv").lines() {
        let fields: Vec<&str> = line.split(',').collect();
        let numbers: Vec<f64> = fields[2..]
            .iter()
            .map(|field| field.parse().unwrap())
            .collect();
        let [time, code, phase, doppler, strength] = numbers[..] else {
            panic!("{line}");
        };
        let (_, epochs) = &files[usize::from(fields[0] == "three.obs")];
        let mut all = epochs.iter();
        let epoch = all.find(|epoch| (epoch.time - time).abs() < 1e-6).unwrap();
        let one = seen(epoch, fields[1]);
        assert_eq!((one.pseudorange, one.doppler), (code, doppler), "{line}");
        // A phase with half-cycle ambiguity is not used.
        let open = fields[1] == "G18" && time > 408_641.0;
        let expected = Some(phase).filter(|phase| phase.is_finite() && !open);
        assert_eq!(one.phase, expected, "{line}");
        let noise = (20.0 / 10f64.powf(0.1 * strength)).sqrt() / std::f64::consts::TAU;
        assert!((one.phase_std / noise - 1.0).abs() < 1e-9, "{line}");
        count += 1;
    }
    // Three epochs of ten GPS and two Galileo satellites, no other, twice.
    assert_eq!(count, 72);
    for (_, epochs) in &files {
        assert_eq!(epochs.len(), 3);
        assert!(epochs.iter().all(|epoch| epoch.observations.len() == 12));
        // Tracked from the first on; lost at the second.
        let locks = |name| [0, 1, 2].map(|k| seen(&epochs[k], name).lock);
        assert_eq!(locks("G01"), [0.0, 1.0, 2.0]);
        assert_eq!(locks("G10"), [0.0, 0.0, 1.0]);
        assert_eq!(locks("G08")[1..], [0.0, 0.0]);
    }
}

#[test]
fn ephemerides_are_those_that_georinex_reads() {
    // Version 4 has a line before each record, and records of other kinds.
    let four: String = text("three.nav")
        .replacen("3.04", "4.00", 1)
        .lines()
        .map(|line| match line.get(..3) {
            Some("E05") => format!("> EPH E05 INAV\n{line}\n"),
            Some("G03") => format!("> STO G    UTC\n  2025 08 28 00 00 00 x\n> EPH G03 CNAV\n{line}\n> EPH G03 LNAV\n{line}\n"),
            Some("G31") => format!("> EPH G31 LNAV\n{line}\n"),
            Some("R07") => format!("> EPH R07 FDMA\n{line}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let four = opened(&[("three.obs", text("three.obs")), ("four.nav", four)]).unwrap();
    let [two, three] = ["two", "three"].map(of);
    for line in text("ephemerides.csv").lines() {
        let fields: Vec<&str> = line.split(',').collect();
        let files: &[&Rinex] = match fields[0] {
            "two.nav" => &[&two],
            _ => &[&three, &four],
        };
        let expected: Vec<f64> = fields[2..]
            .iter()
            .map(|field| field.parse().unwrap())
            .collect();
        for file in files {
            let one = file
                .ephemerides
                .of(satellite(fields[1]), 408_700.0)
                .unwrap();
            let read = [
                one.toc,
                one.af[0],
                one.sqrt_a,
                one.toe,
                one.omega_dot,
                one.i_dot,
                one.group_delay,
            ];
            assert_eq!(read[..], expected[..], "{line}");
        }
    }
    assert!(two.ephemerides.of(satellite("E05"), 408_700.0).is_none());
    assert!(
        three
            .ephemerides
            .of(satellite("G03"), 408_700.0 + 7200.0 * 1.5)
            .is_none()
    );
}

#[test]
fn an_unhealthy_satellite_and_another_message_are_passed_over() {
    let of = |from: &str, to: &str| {
        let nav = text("three.nav").replace(from, to);
        let rinex = opened(&[("three.obs", text("three.obs")), ("three.nav", nav)]).unwrap();
        ["G31", "E05"].map(|name| rinex.ephemerides.of(satellite(name), 408_700.0).is_some())
    };
    assert_eq!(of("x", "x"), [true, true]);
    // F/NAV; no accuracy of Galileo; GPS's health.
    assert_eq!(
        of("5.170000000000D+02", "2.580000000000D+02"),
        [true, false]
    );
    assert_eq!(
        of("3.120000000000D+00", "-1.00000000000D+00"),
        [true, false]
    );
    let ill = of(
        "2.000000000000D+00 0.000000000000D+00",
        "2.000000000000D+00 1.000000000000D+00",
    );
    assert_eq!(ill, [false, true]);
}

#[test]
fn events_and_damage_lose_an_epoch_at_most() {
    let two = text("two.obs");
    let at = two.match_indices("\n 25 08 28").nth(1).unwrap().0 + 1;
    // A comment between; a power failure; a torn line.
    let event = format!(
        "{}{:28}4  1\n{:60}COMMENT\n{}",
        &two[..at],
        "",
        "",
        &two[at..]
    );
    let failure = two.replace("40.7480000  0 14", "40.7480000  1 14");
    let torn = two.replace("40.7480000  0 14", "40.74?0000  0 14");
    for (changed, count, lock) in [(event, 3, 1.0), (failure, 3, 0.0), (torn, 2, 2.0)] {
        let files = [("two.obs", changed), ("two.nav", text("two.nav"))];
        let read = epochs(&mut opened(&files).unwrap());
        assert_eq!(read.len(), count);
        assert_eq!(seen(&read[1], "G01").lock, lock);
    }
    // Cut anywhere, nothing but the end is lost.
    let three = text("three.obs");
    for length in (1000..three.len()).step_by(37) {
        let files = [
            ("three.obs", three[..length].to_owned()),
            ("three.nav", text("three.nav")),
        ];
        if let Ok(mut rinex) = opened(&files) {
            let _ = epochs(&mut rinex);
        }
    }
}

#[test]
fn what_is_missing_is_said_with_the_mend() {
    let refused = |files: &[(&str, String)]| opened(files).err().unwrap().to_string();
    let (obs, nav) = (("a.obs", text("three.obs")), ("a.nav", text("three.nav")));
    assert!(refused(std::slice::from_ref(&obs)).contains("no navigation file"));
    assert!(refused(std::slice::from_ref(&nav)).contains("no RINEX observation file"));
    let other = ("a.nmea", "$GPGGA,1,2\n".to_owned());
    assert!(refused(&[other, nav.clone()]).contains("is no RINEX file"));
    let packed = obs
        .1
        .replacen("RINEX VERSION / TYPE", "CRINEX VERS   / TYPE", 1);
    assert!(refused(&[("a.crx", packed), nav.clone()]).contains("CRX2RNX"));
    let utc = obs.1.replacen(
        "     GPS         TIME OF FIRST",
        "     UTC         TIME OF FIRST",
        1,
    );
    assert!(refused(&[("a.obs", utc), nav.clone()]).contains("UTC"));
    let l2 = obs.1.replace(" L1C", " L5X");
    assert!(refused(&[("a.obs", l2), nav]).contains("no code and carrier phase on L1"));
}

fn fix(time: f64) -> GnssFix {
    GnssFix {
        time,
        position: Some((
            Position::Geodetic(Geodetic::from_degrees(40.1, -105.1, 1600.0)),
            Matrix3::identity(),
        )),
        velocity: None,
        mean_velocity: None,
        attitude: None,
        quality: Default::default(),
    }
}

#[test]
fn fixes_meet_the_epochs_of_their_times() {
    let mut rinex = of("three");
    // A week later or not, the second of the week is what counts; the second epoch is passed over, the last is 11 ms off.
    let week = 604_800.0;
    for (time, matched) in [
        (408_639.0, 0),
        (408_639.75 + week, 1),
        (408_640.2, 1),
        (408_641.759, 2),
        (408_643.0, 2),
    ] {
        rinex.add(&mut fix(time), time).unwrap();
        assert_eq!(rinex.matched, matched, "{time}");
    }
    assert!(
        rinex
            .end()
            .unwrap_err()
            .to_string()
            .contains("no velocity by the carrier")
    );
    let mut rinex = of("three");
    rinex.add(&mut fix(408_639.3), 408_639.3).unwrap();
    let error = rinex.end().unwrap_err().to_string();
    assert!(error.contains("0.45 s off"), "{error}");
}
