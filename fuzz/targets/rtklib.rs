#![no_main]

use undrift::io::gnss::{FixOptions, GnssReader};
use undrift::io::rtklib::{self, RtklibOptions};
use undrift::nav::earth::Geodetic;
use undrift_fuzz::logs::gnss;
use undrift_fuzz::with_file;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let stated = RtklibOptions {
        fixes: FixOptions {
            position_std: Some([1.0, 1.0, 2.0]),
            velocity_std: Some([0.1, 0.1, 0.2]),
            ..FixOptions::default()
        },
        base: Some(Geodetic::from_degrees(40.0, -105.0, 1600.0)),
    };
    with_file(data, |path| {
        let _ = rtklib::detect(path);
        for options in [RtklibOptions::default(), stated] {
            gnss(GnssReader::open_rtklib(path, &options));
        }
    });
});
