#![no_main]

use std::path::Path;

use undrift::drive::Drive;

/// Where a drive file finds logs of every format.
const LOGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../testdata/golden/formats");

libfuzzer_sys::fuzz_target!(|text: &str| {
    let logs = Path::new(LOGS);
    match Drive::from_toml(text, "DRIVE.toml", logs, logs) {
        Ok(drive) => check(&drive),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});

fn check(drive: &Drive) {
    let imu = &drive.imu.1;
    assert!(
        imu.time_scale.is_finite() && imu.time_scale > 0.0,
        "{imu:?}"
    );
    let scales = imu.gyro_scale.iter().chain(&imu.accel_scale);
    for scale in scales {
        assert!(scale.is_finite() && *scale != 0.0, "{imu:?}");
    }
    assert!(
        imu.rate_hz
            .is_none_or(|rate| rate.is_finite() && rate > 0.0)
    );
    assert!(imu.time_offset.is_finite());
    let vectors = [&imu.gyro_offset, &imu.accel_offset, &drive.lever_arm];
    assert!(vectors.iter().all(|v| v.iter().all(|x| x.is_finite())));
    // To rounding of the angles' sines.
    assert!((imu.rotation.determinant() - 1.0).abs() < 1e-9, "{imu:?}");
}
