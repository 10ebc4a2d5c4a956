#![no_main]

use undrift::io::gnss::{FixOptions, GnssFormat, GnssReader, PositionColumns, VelocityAxes};
use undrift::io::layouts;
use undrift::io::table::Column;
use undrift::nav::earth::Geodetic;
use undrift_fuzz::logs::gnss;
use undrift_fuzz::with_file;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let number = |from: usize| [from, from + 1, from + 2].map(Column::Number);
    let name = |name: &str| Column::Name(name.to_owned());
    let named = GnssFormat {
        time: name("t"),
        date: None,
        place: Some(PositionColumns::Geodetic {
            columns: ["lat", "lon", "height"].map(name),
            angle_scale: 1f64.to_radians(),
            degrees_minutes: false,
            height_scale: 1.0,
            height: None,
        }),
        quality: Some(name("q")),
        fixes: FixOptions {
            position_std: Some([5.0, 5.0, 10.0]),
            position_std_factor: 2.0,
            ..FixOptions::default()
        },
        ..layouts::kf_gins_gnss(7)
    };
    let baseline = GnssFormat {
        place: Some(PositionColumns::Baseline {
            ned: number(2),
            base: Geodetic::from_degrees(40.0, -105.0, 1600.0),
        }),
        velocity: Some(number(8)),
        velocity_axes: VelocityAxes::Up,
        quality: Some(Column::Number(11)),
        fixes: FixOptions {
            velocity_std: Some([0.1, 0.1, 0.2]),
            ..FixOptions::default()
        },
        ..layouts::kf_gins_gnss(7)
    };
    let formats = [
        layouts::kf_gins_gnss(7),
        layouts::kf_gins_gnss(layouts::KF_GINS_WITH_VELOCITY),
        named,
        baseline,
    ];
    with_file(data, |path| {
        for format in &formats {
            gnss(GnssReader::open(path, &format.clone().into()));
        }
    });
});
