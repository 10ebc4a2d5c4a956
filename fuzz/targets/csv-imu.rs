#![no_main]

use undrift::io::imu::{ImuFormat, ImuReader};
use undrift::io::layouts;
use undrift::io::table::Column;
use undrift_fuzz::{imu, with_file};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let name = |name: &str| Column::Name(name.to_owned());
    let gyro = ["gx", "gy", "gz"].map(name);
    let accel = ["fx", "fy", "fz"].map(name);
    let named = ImuFormat::new(Some(name("t")), gyro.clone(), accel.clone());
    let stated = ImuFormat {
        rate_hz: Some(100.0),
        ..layouts::kf_gins_imu()
    };
    let without_times = ImuFormat {
        rate_hz: Some(50.0),
        ..ImuFormat::new(None, gyro, accel)
    };
    let formats = [
        layouts::kf_gins_imu(),
        layouts::euroc_imu(),
        layouts::euroc_imu().delimited_by(Some(b';')),
        named,
        stated,
        without_times,
    ];
    with_file(data, |path| {
        for format in &formats {
            imu(ImuReader::open(path, format));
        }
    });
});
