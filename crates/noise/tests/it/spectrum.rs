//! Power spectral densities against scipy, peaks against sines that were put in.

use crate::common::{self, close, near, number, numbers, reference, series, white_noise};
use std::f64::consts::TAU;
use undrift_noise::spectrum::{peaks, welch};

#[test]
fn densities_are_those_of_scipy() {
    let text = include_str!("../../../../testdata/golden/welch.json");
    let golden: serde_json::Value = serde_json::from_str(text).unwrap();
    let mut state = 1_234_567_890u64;
    let mut x = Vec::new();
    for _ in 0..1000 {
        x.push(state as f64 / 2_147_483_647.0);
        state = state * 16_807 % 2_147_483_647;
    }
    for case in golden["cases"].as_array().unwrap() {
        let segment = case["segment"].as_u64().unwrap() as usize;
        let ours = welch(&x, number(&golden["rate_hz"]), segment).unwrap();
        let (frequency, density) = (numbers(&case["frequency_hz"]), numbers(&case["density"]));
        let largest = density.iter().copied().fold(0.0, f64::max);
        assert_eq!(ours.density.len(), density.len());
        for k in 0..density.len() {
            near(ours.frequency_hz[k], frequency[k], 1e-12, "frequency");
            // Bins emptied by taking the mean out are rounding.
            near(
                ours.density[k],
                density[k],
                1e-8 * density[k] + 1e-15 * largest,
                &format!("{segment} {k}"),
            );
        }
    }
    let Some(reference) = reference() else { return };
    let expected = &reference["z100k"]["scipy.welch_nperseg8192_hann"];
    let ours = welch(&series(&reference, "z100k"), 100.0, 8192).unwrap();
    for (k, value) in numbers(&expected["pxx"]).iter().enumerate() {
        close(ours.density[k], *value, 1e-8, "z100k");
        near(
            ours.frequency_hz[k],
            number(&expected["f"][k]),
            1e-12,
            "z100k",
        );
    }
    close(
        ours.density.iter().sum(),
        number(&expected["pxx_sum"]),
        1e-8,
        "z100k sum",
    );
}

#[test]
fn the_density_integrates_to_the_variance() {
    let x = white_noise(1, 200_000);
    let density = welch(&x, 100.0, 1000).unwrap();
    let integral: f64 = density.density.iter().sum::<f64>() * density.resolution_hz();
    // Sampling error of the variance is 0.3 %.
    close(integral, 1.0, 0.01, "variance");
    // White noise of unit variance at 100 Hz: N² = 1/100, one-sided density 2 N².
    close(
        density.density[100..400].iter().sum::<f64>() / 300.0,
        0.02,
        0.02,
        "density",
    );
}

#[test]
fn sines_are_found_with_frequency_and_amplitude() {
    let wanted = [(0.5617, 0.2), (20.03, 0.3), (33.4, 0.15)];
    let mut x = white_noise(2, 300_000);
    for (k, value) in x.iter_mut().enumerate() {
        for (frequency, amplitude) in wanted {
            *value += amplitude * (TAU * frequency * k as f64 / 100.0 + frequency).sin();
        }
    }
    let density = welch(&x, 100.0, 16_384).unwrap();
    let mut found = peaks(&density, 8.0);
    assert_eq!(found.len(), 3, "{found:?}");
    found.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    for (line, (frequency, amplitude)) in found.iter().zip(wanted) {
        // A fifth of a bin; the window's side lobes beyond two bins hold 0.3 % of the power.
        near(
            line.frequency_hz,
            frequency,
            0.2 * density.resolution_hz(),
            "frequency",
        );
        close(line.amplitude, amplitude, 0.05, "amplitude");
    }
    assert!(
        peaks(
            &welch(&white_noise(4, 300_000), 100.0, 16_384).unwrap(),
            8.0
        )
        .is_empty()
    );
}

#[test]
fn the_accelerometers_of_the_real_record_have_their_line() {
    let Some(axes) = common::record("adis16405-static/run1.csv.gz") else {
        return;
    };
    let found = peaks(&welch(&axes[3], 100.0, 16_384).unwrap(), 8.0);
    assert!(
        found.iter().any(|l| (l.frequency_hz - 0.56).abs() < 0.02),
        "{found:?}"
    );
}

#[test]
fn bad_records_are_errors() {
    assert!(welch(&[1.0; 3], 1.0, 4).is_err() && welch(&[1.0; 9], 1.0, 3).is_err());
    assert!(welch(&[1.0; 9], -1.0, 4).is_err() && welch(&[f64::NAN; 9], 1.0, 4).is_err());
    for count in 4..40 {
        for segment in 4..50 {
            let density = welch(&white_noise(1, count), 1.0, segment).unwrap();
            assert!(density.segments >= 1);
            let _ = peaks(&density, 1.0);
        }
    }
    // A constant has no power and no lines.
    assert!(peaks(&welch(&[0.1; 100], 1.0, 16).unwrap(), 5.0).is_empty());
}
