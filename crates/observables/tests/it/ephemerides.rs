use undrift_nav::Vector3;
use undrift_observables::{Ephemerides, Satellite, System};

const GOLDEN: &str = include_str!("../../../../testdata/golden/ephemerides.csv");

/// Three subframes.
type Words = [[u32; 10]; 3];

/// Rows of the golden file: words, then numbers.
fn rows() -> Vec<(Words, Vec<f64>)> {
    let row = |line: &str| {
        let (words, numbers) = line.split_once(',').unwrap();
        let words: Vec<u32> = words
            .split(' ')
            .map(|word| u32::from_str_radix(word, 16).unwrap())
            .collect();
        let frame = |k: usize| *words[10 * k..].first_chunk().unwrap();
        let numbers = numbers.split(',').map(|number| number.parse().unwrap());
        ([0, 1, 2].map(frame), numbers.collect())
    };
    GOLDEN.lines().skip(1).map(row).collect()
}

const PRN: Satellite = Satellite {
    system: System::Gps,
    number: 7,
};

fn taken(words: &Words, order: [usize; 3]) -> Ephemerides {
    let mut known = Ephemerides::default();
    for k in order {
        known.gps_subframe(7, &words[k]);
    }
    known
}

#[test]
fn satellites_are_where_rtklib_has_them() {
    let rows = rows();
    assert_eq!(rows.len(), 60);
    for (words, numbers) in rows {
        let [time, x, y, z, clock, tgd] = *numbers.first_chunk().unwrap();
        let known = taken(&words, [0, 1, 2]);
        let (place, own) = known.of(PRN, time).unwrap().at(time);
        // The file has 1e-5 m; its iteration for the anomaly ends at 1e-13 rad, 3 µm.
        assert!((place - Vector3::new(x, y, z)).amax() < 2e-5, "{place}");
        assert!((own + tgd - clock).abs() < 1e-15, "{own} {clock}");
    }
}

#[test]
fn an_ephemeris_is_of_one_issue_whole_healthy_and_of_its_time() {
    let rows = rows();
    let (words, time) = (rows[0].0, rows[0].1[0]);
    let other = rows[5].0;
    assert!(taken(&words, [2, 0, 1]).of(PRN, time).is_some());
    // Parts of different issues, or not all of them.
    let mixed = taken(&[words[0], words[1], other[2]], [0, 1, 2]);
    let mixed_clock = taken(&[other[0], words[1], words[2]], [0, 1, 2]);
    let two = taken(&words, [0, 1, 1]);
    for none in [mixed, mixed_clock, two] {
        assert!(none.of(PRN, time).is_none());
    }
    // Another issue afterwards keeps the one before until it is whole.
    let mut known = taken(&words, [0, 1, 2]);
    let before = *known.of(PRN, time).unwrap();
    known.gps_subframe(7, &other[0]);
    assert_eq!(known.of(PRN, time), Some(&before));
    // Beyond two hours from its time, of no satellite.
    assert!(known.of(PRN, before.toe + 7201.0).is_none());
    assert!(known.of(PRN, before.toe - 7199.0).is_some());
    for number in [0, 8, 255] {
        let satellite = Satellite { number, ..PRN };
        known.gps_subframe(number, &words[0]);
        assert!(known.of(satellite, time).is_none());
    }
    // A bit of the health, the preamble, the number of the subframe.
    let with = |frame: usize, word: usize, bit: u32| {
        let mut words = words;
        words[frame][word] ^= 1 << bit;
        taken(&words, [0, 1, 2])
    };
    for (frame, word, bit) in [(0, 2, 13), (0, 0, 29), (1, 1, 8), (2, 9, 29)] {
        assert!(with(frame, word, bit).of(PRN, time).is_none());
    }
}
