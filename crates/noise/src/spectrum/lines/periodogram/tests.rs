use super::*;
use std::f64::consts::{PI, TAU};

fn sine(samples: usize, cycles: f64, amplitude: f64) -> Vec<f64> {
    let sample = |k: usize| amplitude * (TAU * cycles * k as f64 / samples as f64 + 1.0).cos();
    (0..samples).map(sample).collect()
}

#[test]
fn a_sine_of_whole_cycles_has_a_sixth_of_its_square_a_sample_and_a_quarter_of_that_beside() {
    // Hann's window: half of the amplitude in its bin, a quarter in the next, of Σw² = 3n/8.
    for samples in [2000, 2001] {
        for bin in [30, 700, 998] {
            let periodogram = Periodogram::new(&sine(samples, bin as f64, 3.0));
            assert_eq!(periodogram.power.len(), samples / 2 + 1);
            let exact = 9.0 / 6.0 * samples as f64;
            for (off, share) in [(0usize, 1.0), (1, 0.25), (2, 0.0)] {
                for k in [bin - off, bin + off] {
                    // The straight line from end to end: a trend of 3/n a sample at most.
                    let miss = periodogram.power[k] / exact - share;
                    // The bin at half the sample rate has the power of both sides.
                    let at_end = 2 * k + 1 >= samples;
                    assert!(miss.abs() < 1e-3 || at_end, "{samples} {bin} {off}: {miss}");
                }
            }
        }
    }
}

#[test]
fn white_noise_has_its_variance_in_every_bin_and_a_line_from_end_to_end_has_none() {
    let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let states = std::iter::successors(Some(7), next);
    let uniform = states.map(|x: u32| f64::from(x) / f64::from(u32::MAX) - 0.5);
    let noise: Vec<f64> = uniform.take(20_000).collect();
    let periodogram = Periodogram::new(&noise);
    let mean = periodogram.power[2..9999].iter().sum::<f64>() / 9997.0;
    // Correlated neighbours: √(35/18/10 000) = 0.014; four of these.
    assert!((12.0 * mean - 1.0).abs() < 0.056, "{mean}");
    let drifting: Vec<f64> = (0..)
        .zip(&noise)
        .map(|(k, x)| x + 7.0 - 0.01 * f64::from(k))
        .collect();
    let drifting = Periodogram::new(&drifting);
    for (a, b) in periodogram.power[2..].iter().zip(&drifting.power[2..]) {
        // The line goes in and out again, 200 units high; what is left of the mean is in bins 0 and 1.
        assert!((a - b).abs() < 1e-6 * (1.0 + a), "{a} {b}");
    }
    let median = upper_median(&mut periodogram.power[2..9999].to_vec());
    assert!((median / mean - 2f64.ln()).abs() < 0.05);
    for bin in [1, 77, 9000] {
        let frequency = periodogram.frequency(bin as f64);
        assert!((frequency - bin as f64 / 20_000.0).abs() < 1e-15);
        assert_eq!(periodogram.bin(frequency + 0.4 / 20_000.0), bin);
    }
}

#[test]
fn between_two_bins_a_sine_is_where_the_parabola_says() {
    for off in [-0.4, -0.2, 0.0, 0.3] {
        let periodogram = Periodogram::new(&sine(4000, 900.0 + off, 1.0));
        // Known of the parabola through a Hann window's logarithms: a sixtieth of a bin.
        assert!(
            (periodogram.offset(900) - off).abs() < 0.02,
            "{off}: {}",
            periodogram.offset(900)
        );
    }
}

#[test]
fn a_lobe_is_the_most_that_a_sine_has_there() {
    // |sin(πd)/(πd(1 − d²))|² of the window, against the peak's bin.
    let power = |d: f64| match d == 0.0 {
        true => 1.0,
        false => ((PI * d).sin() / (PI * d * (1.0 - d * d))).powi(2),
    };
    for distance in [6, 9, 20] {
        let shares = (-50..=50).map(|k| f64::from(k) / 100.0).map(|off| {
            let away = f64::from(distance) - off;
            power(away) / power(off) / lobe(1.0, away)
        });
        let most = shares.fold(0.0, f64::max);
        assert!((0.9..1.05).contains(&most), "{distance}: {most}");
    }
    assert!((lobe(5.0, 7.0) / lobe(1.0, 7.0) - 5.0).abs() < 1e-12);
}

#[test]
fn it_is_the_transform_of_the_windowed_record_up_to_half_the_sample_rate() {
    for n in [64usize, 65] {
        let x: Vec<f64> = (0..n)
            .map(|k| ((k * k * 7 % 31) as f64).sqrt() + 0.1 * k as f64)
            .collect();
        // The line through the means of a tenth at either end.
        let (first, last) = (mean(&x[..6]), mean(&x[n - 6..]));
        let slope = (last - first) / (n - 6) as f64;
        let periodogram = Periodogram::new(&x);
        assert_eq!(periodogram.power.len(), n / 2 + 1);
        for (k, power) in periodogram.power.iter().enumerate().skip(1) {
            let (mut re, mut im) = (0.0, 0.0);
            for (t, x) in x.iter().enumerate() {
                let turn = TAU * t as f64 / n as f64;
                let value = (x - first - slope * t as f64) * (0.5 - 0.5 * turn.cos());
                re += value * (turn * k as f64).cos();
                im += value * (turn * k as f64).sin();
            }
            let exact = (re * re + im * im) / (0.375 * n as f64);
            assert!((power - exact).abs() < 1e-10, "{n} {k}: {power} {exact}");
        }
    }
}

/// Flat power of 1, 999 bins of which have peaks looked for.
fn flat() -> Periodogram {
    Periodogram {
        power: vec![1.0; 1001],
        samples: 2000,
    }
}

/// Probability of more than f of two degrees of freedom over 2 m: (1 + f/m)^−m.
fn height_at(level: f64, neighbours: f64) -> f64 {
    let independent = neighbours * MEDIAN_OF_BINS / CORRELATED;
    // Median of two degrees of freedom by Wilson & Hilferty, 8/9 cubed.
    let background = (9.0f64 / 8.0).powi(3);
    background * independent * (level.powf(-1.0 / independent) - 1.0)
}

#[test]
fn a_bin_is_a_peak_beyond_the_level_of_its_f() {
    let level = 1e-6;
    let with = |at: usize, height: f64| {
        let mut periodogram = flat();
        periodogram.power[at + 1] = height;
        periodogram.peak(&periodogram.bands(1), 1, at, level)
    };
    // A fifth of the frequency on either side, 64 bins at most, three beside the peak left out; near the end one side.
    for (at, neighbours) in [
        (45, 12.0),
        (100, 34.0),
        (335, 128.0),
        (500, 128.0),
        (960, 64.0 + 35.0),
        (989, 64.0 + 6.0),
        (990, 64.0),
        (997, 64.0),
    ] {
        let height = height_at(level, neighbours);
        assert!(with(at, 0.999 * height).is_none(), "{at}");
        let peak = with(at, 1.001 * height).unwrap();
        assert_eq!(peak.power, 1.001 * height);
        assert!((peak.background - (9.0f64 / 8.0).powi(3)).abs() < 1e-12);
        assert!((peak.frequency - (at + 1) as f64 / 2000.0).abs() < 1e-15);
        assert_eq!((peak.width, peak.is_broad), (1.0 / 2000.0, false));
    }
    // Too few neighbours below, none above.
    assert!(with(44, 1e9).is_none() && with(998, 1e9).is_none() && with(0, 1e9).is_none());
}

#[test]
fn a_peak_is_above_both_neighbours_the_first_of_equals_and_over_the_higher_side() {
    let at = 500;
    let peaks = |set: &[(usize, f64)]| {
        let mut peaks = flat();
        for (bin, power) in set {
            peaks.power[*bin] = *power;
        }
        peaks.peak(&peaks.bands(1), 1, at, 1e-6)
    };
    assert!(peaks(&[(501, 100.0), (500, 100.0)]).is_none());
    assert!(peaks(&[(501, 100.0), (502, 100.0)]).is_some());
    assert!(peaks(&[(501, 100.0), (502, 101.0)]).is_none());
    // The neighbours of one side are twice as high.
    for side in [434..498, 505..569] {
        let mut step: Vec<(usize, f64)> = side.map(|bin| (bin, 2.0)).collect();
        step.push((501, 1e4));
        let found = peaks(&step).unwrap();
        assert!((found.background - 2.0 * (9.0f64 / 8.0).powi(3)).abs() < 1e-12);
    }
    // On a broad foot it is broad: 3.2 bins beside it have this much above its own lobes.
    for (foot, is_broad) in [(8.0, true), (3.0, false)] {
        let sides = (487..=496).chain(506..=515).map(|bin| (bin, foot));
        let set: Vec<_> = sides.chain([(501, 1e4)]).collect();
        assert_eq!(peaks(&set).unwrap().is_broad, is_broad, "{foot}");
    }
}

#[test]
fn a_band_is_prominent_at_twice_its_background() {
    let bins = 64;
    let with = |height: f64| {
        let mut power = vec![1.0; 200];
        power[100] = height;
        Periodogram {
            power: vec![1.0; 20_000],
            samples: 40_000,
        }
        .peak(&power, bins, 100, 1e-3)
    };
    let freedom = 128.0 / CORRELATED;
    let background = (1.0 - 2.0 / (9.0 * freedom)).powi(-3);
    assert!(with(2.0 * background * 0.999).is_none());
    let peak = with(2.0 * background * 1.001).unwrap();
    assert!((peak.background - background).abs() < 1e-12);
    // The band of bins 6401 to 6464.
    assert!((peak.frequency * 40_000.0 - 6432.5).abs() < 1e-9);
    assert!((peak.width * 40_000.0 - 64.0).abs() < 1e-9 && peak.is_broad);
    // Bands of four bins of a spectrum, from bin 1 on.
    let periodogram = Periodogram {
        power: (0..=10).map(f64::from).collect(),
        samples: 20,
    };
    assert_eq!(periodogram.bands(4), [2.5, 6.5]);
    assert_eq!(periodogram.bands(1).len(), 9);
    let odd = Periodogram {
        samples: 21,
        ..periodogram
    };
    assert_eq!(odd.bands(1).len(), 10);
}

#[test]
fn chance_is_shared_by_all_bins_and_bands_and_lines_go_before_humps() {
    // 999 bins, 249 bands of four, 62, 15 and 3.
    let height = height_at(0.01 / 1328.0, 128.0);
    let with = |height: f64, hump: f64| {
        let mut periodogram = flat();
        periodogram.power[601..605].fill(hump);
        periodogram.power[501] = height;
        periodogram.peaks(0.01)
    };
    assert!(with(0.999 * height, 1.0).is_empty());
    assert_eq!(with(1.001 * height, 1.0).len(), 1);
    // A band of four, none of whose bins is enough.
    let humps = with(1.0, 14.0);
    assert!(!humps.is_empty() && humps.iter().all(|peak| peak.width > 1.5 / 2000.0));
    let line = with(100.0 * height, 14.0);
    assert!(line.len() == 1 && line[0].width < 1.5 / 2000.0);
    // Two lines, the stronger first.
    let mut two = flat();
    (two.power[300], two.power[800]) = (100.0, 1000.0);
    let found = two.peaks(0.01);
    assert_eq!(found.len(), 2);
    assert!(found[0].power == 1000.0 && found[1].power == 100.0);
}

#[test]
fn a_lobe_of_a_stronger_peak_is_none_of_its_own() {
    let peak = |bin: f64, power: f64| Peak {
        frequency: bin / 2000.0,
        power,
        background: 1.0,
        width: 1.0 / 2000.0,
        is_broad: false,
    };
    let kept = |weak: Peak| flat().without_lobes(vec![peak(500.0, 1e9), weak]).len() == 2;
    for away in [20.0, -20.0] {
        // 0.15/d⁶ of the peak, four times.
        let most = 4.0 * 0.15e9 / 20f64.powi(6);
        assert!(!kept(peak(500.0 + away, 0.999 * most)));
        assert!(kept(peak(500.0 + away, 1.001 * most)));
    }
    let beside = super::super::BESIDE;
    assert!(kept(peak(500.0 + beside + 0.01, 1e8)));
    assert!(!kept(peak(500.0 + beside - 0.01, 1e8)));
}

#[test]
fn a_parabola_without_a_top_has_its_peak_in_the_bin() {
    let of = |around: [f64; 3]| {
        let mut periodogram = flat();
        periodogram.power[10..13].copy_from_slice(&around);
        periodogram.offset(11)
    };
    assert_eq!(of([1.0, 1.0, 1.0]), 0.0);
    assert_eq!(of([1.0, 2.0, 100.0]), 0.0);
    assert_eq!((of([1.0, 50.0, 60.0]), of([60.0, 50.0, 1.0])), (0.5, -0.5));
    // Logarithms 0, 2 and 1: the top is half of (0 − 1)/(0 − 4 + 1) beside.
    let found = of([1.0, 2f64.exp(), 1f64.exp()]);
    assert!((found - 1.0 / 6.0).abs() < 1e-12, "{found}");
}
