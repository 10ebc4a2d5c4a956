#![no_main]

use undrift::io::gnss::{GnssFormat, GnssReader, Place, PositionFormat, Std, VelocityFormat};
use undrift::io::layouts;
use undrift::io::table::Column;
use undrift::nav::earth::Geodetic;
use undrift_fuzz::logs::gnss;
use undrift_fuzz::with_file;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let number = |from: usize| [from, from + 1, from + 2].map(Column::Number);
    let name = |name: &str| Column::Name(name.to_owned());
    let [lat, lon, height] = ["lat", "lon", "height"].map(name);
    let named = GnssFormat {
        time: name("t"),
        position: Some(PositionFormat {
            place: Place::Geodetic {
                lat,
                lon,
                height,
                angle_scale: 1f64.to_radians(),
            },
            std: Std::Constant([5.0, 5.0, 10.0]),
            std_factor: 2.0,
        }),
        quality: Some(name("q")),
        ..layouts::kf_gins_gnss(7)
    };
    let baseline = GnssFormat {
        position: Some(PositionFormat {
            place: Place::Baseline {
                ned: number(2),
                base: Geodetic::from_degrees(40.0, -105.0, 1600.0),
            },
            std: Std::Columns(number(5)),
            std_factor: 1.0,
        }),
        velocity: Some(VelocityFormat {
            columns: number(8),
            up: true,
            std: Std::Constant([0.1, 0.1, 0.2]),
            std_factor: 1.0,
        }),
        quality: Some(Column::Number(11)),
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
