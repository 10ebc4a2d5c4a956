//! RINEX files beside a log of fixes give what the receiver's raw messages give.

use crate::{carrier::against_rtk, carrier::fixes, public::find};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use undrift_io::Memory;
use undrift_io::format::Format;
use undrift_io::gnss::{GnssLog, GnssReader, GnssSource};
use undrift_nav::sample::GnssFix;
use undrift_observables::{Ephemerides, Ephemeris, Satellite, System};

/// Messages of a UBX log with their class and number.
pub(crate) fn messages(log: &[u8]) -> Vec<([u8; 2], &[u8])> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(head) = log.get(at..at + 6) {
        let length = usize::from(u16::from_le_bytes([head[4], head[5]]));
        match log.get(at + 6..at + 6 + length) {
            Some(payload) if head.starts_with(&[0xb5, 0x62]) => {
                found.push(([head[2], head[3]], payload));
                at += length + 8;
            }
            _ => at += 1,
        }
    }
    found
}

fn eight(payload: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(payload[at..at + 8].try_into().unwrap())
}

/// Calendar of a second of GPS week 2381, whose Thursday is 28 August 2025.
fn calendar(second: f64) -> String {
    let (day, of_day) = ((second / 86_400.0).floor(), second.rem_euclid(86_400.0));
    let (hour, minute) = ((of_day / 3600.0).floor(), (of_day / 60.0).floor() % 60.0);
    let seconds = of_day % 60.0;
    format!(
        "2025 08 {:02} {hour:02} {minute:02} {seconds:10.7}",
        day + 24.0
    )
}

/// Observations of GPS and Galileo on L1 of RXM-RAWX.
fn observations(log: &[u8]) -> String {
    let mut text = format!(
        "{:>9}{:11}{:40}RINEX VERSION / TYPE\n",
        "3.04", "", "OBSERVATION DATA    M"
    );
    for system in ["G", "E"] {
        let types = format!("{system}    4 C1C L1C D1C S1C");
        writeln!(text, "{types:60}SYS / # / OBS TYPES").unwrap();
    }
    writeln!(text, "{:60}END OF HEADER", "").unwrap();
    let mut tracked = BTreeMap::new();
    for (_, payload) in messages(log)
        .iter()
        .filter(|(kind, _)| *kind == [0x02, 0x15])
    {
        let mut rows = Vec::new();
        for row in payload[16..].chunks_exact(32) {
            let letter = match (row[20], row[22]) {
                (0, 0) => 'G',
                (2, 0) => 'E',
                _ => continue,
            };
            let (lock, status) = (u16::from_le_bytes([row[24], row[25]]), row[30]);
            if status & 1 == 0 {
                continue;
            }
            let half = status & 0b1000;
            let before = tracked.insert((letter, row[21]), (lock, half));
            let slipped = before.is_none_or(|(last, was)| lock < last.min(250) || half != was);
            let vouched = status & 0b110 == 0b110 && row[28] & 15 != 15;
            let lost = u8::from(slipped) | u8::from(!vouched) << 1;
            let doppler = f32::from_le_bytes(row[16..20].try_into().unwrap());
            rows.push(format!(
                "{letter}{:02}{:14.3}  {:14.3}{lost} {doppler:14.3}  {:14.3}  \n",
                row[21],
                eight(row, 0),
                eight(row, 8),
                f64::from(row[26]),
            ));
        }
        let time = calendar(eight(payload, 0)).replace("  ", " 0");
        writeln!(text, "> {time}  0{:3}", rows.len()).unwrap();
        text.extend(rows);
    }
    text
}

/// Ephemerides of RXM-SFRBX.
fn navigation(log: &[u8]) -> String {
    let mut known = Ephemerides::default();
    let mut written = BTreeMap::new();
    let mut text = format!(
        "{:>9}{:11}{:40}RINEX VERSION / TYPE\n",
        "3.04", "", "N: GNSS NAV DATA    M"
    );
    writeln!(text, "{:60}END OF HEADER", "").unwrap();
    for (_, payload) in messages(log)
        .iter()
        .filter(|(kind, _)| *kind == [0x02, 0x13])
    {
        let word =
            |k: usize| u32::from_le_bytes(payload[8 + 4 * k..12 + 4 * k].try_into().unwrap());
        let words: Vec<u32> = (0..usize::from(payload[4])).map(word).collect();
        let (system, letter) = match (payload[0], payload[2]) {
            (0, 0) => (System::Gps, 'G'),
            (2, 1 | 5) => (System::Galileo, 'E'),
            _ => continue,
        };
        let number = payload[1];
        match system {
            System::Gps => known.gps_subframe(number, words.first_chunk().unwrap()),
            System::Galileo => known.galileo_page(number, words.first_chunk().unwrap()),
        }
        let satellite = Satellite { system, number };
        if let Some(one) = known.of(satellite, 408_700.0)
            && written.insert((letter, number), one.toe) != Some(one.toe)
        {
            write!(
                text,
                "{letter}{number:02} {}",
                calendar(one.toc).split('.').next().unwrap()
            )
            .unwrap();
            record(&mut text, one);
        }
    }
    text
}

/// The numbers of an ephemeris, those that are not read are 0.
fn record(text: &mut String, one: &Ephemeris) {
    let galileo = one.system == System::Galileo;
    let delays = [one.group_delay, if galileo { one.group_delay } else { 0.0 }];
    let numbers = [
        [one.af[0], one.af[1], one.af[2], f64::from(one.issue)],
        [one.cr[1], one.delta_n, one.m0, one.cu[0]],
        [one.e, one.cu[1], one.sqrt_a, one.toe],
        [one.ci[0], one.omega0, one.ci[1], one.i0],
        [one.cr[0], one.omega, one.omega_dot, one.i_dot],
        [if galileo { 517.0 } else { 1.0 }, 2381.0, 0.0, 2.0],
        [0.0, delays[0], delays[1], 0.0],
    ];
    for (k, number) in numbers.as_flattened().iter().enumerate() {
        if k >= 3 && (k - 3) % 4 == 0 {
            text.push_str("\n    ");
        }
        // Fortran's: two digits of an exponent with its sign, a D before.
        let [mantissa, exponent] = [0, 1].map(|part| {
            format!("{number:.12e}")
                .split('e')
                .nth(part)
                .unwrap()
                .to_owned()
        });
        let exponent: i32 = exponent.parse().unwrap();
        write!(text, "{mantissa:>15}D{exponent:+03}").unwrap();
    }
    text.push('\n');
}

fn beside(log: &Path, files: &[(&str, String)]) -> GnssReader {
    let mut source = GnssLog::new(Format::Ubx);
    let held = |(name, text): &(&str, String)| {
        let bytes = Memory::Bytes(text.as_bytes().into());
        (PathBuf::from(name), Some(bytes))
    };
    source.fixes.observations = files.iter().map(held).collect();
    GnssReader::open(log, &GnssSource::Log(source)).unwrap()
}

#[test]
fn rinex_files_give_what_the_raw_log_gives() {
    let name = "walk0827-ubx-raw/gnss_1730.ubx";
    let (Some(log), Some(raw)) = (find(name), fixes(name)) else {
        return;
    };
    let bytes = std::fs::read(&log).unwrap();
    let files = [
        ("rover.obs", observations(&bytes)),
        ("rover.nav", navigation(&bytes)),
    ];
    let by_rinex: Vec<GnssFix> = beside(&log, &files).map(Result::unwrap).collect();
    assert_eq!(by_rinex.len(), raw.len());
    let (mut off, mut only) = (Vec::new(), 0);
    // Later, the raw log has all ephemerides that the file has from the start.
    for (rinex, raw) in by_rinex.iter().zip(&raw).skip(400) {
        match (rinex.mean_velocity, raw.mean_velocity) {
            (Some(rinex), Some(raw)) => off.push((rinex.v_n - raw.v_n).norm() * raw.over),
            (None, None) => {}
            _ => only += 1,
        }
    }
    off.sort_by(f64::total_cmp);
    let [median, nine] = [off.len() / 2, off.len() * 9 / 10].map(|at| off[at]);
    println!(
        "{} both, {only} by one; off by {median:.4} m, 90 % {nine:.4} m",
        off.len()
    );
    // Apart but for how certain a phase is: there by the loop's own figure, here by the strength of the signal.
    assert!(off.len() > 130 && only < 3 && median < 0.001 && nine < 0.015);
    let ([carrier, _], count) = against_rtk(&by_rinex, 20);
    println!("against RTK over 5 s: {carrier} m of {count}");
    assert!(count > 300 && carrier.xy().amax() < 0.035 && carrier.z < 0.1);
}
