#![no_main]

use undrift::io::Opened;
use undrift::io::format::Format;
use undrift::io::gnss::{FixOptions, GnssLog, GnssReader};
use undrift::nav::earth::Geodetic;
use undrift_fuzz::logs::gnss;
use undrift_fuzz::with_file;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let stated = GnssLog {
        fixes: FixOptions {
            position_std: Some([1.0, 1.0, 2.0]),
            velocity_std: Some([0.1, 0.1, 0.2]),
            ..FixOptions::default()
        },
        base: Some(Geodetic::from_degrees(40.0, -105.0, 1600.0)),
        ..GnssLog::new(Format::Rtklib)
    };
    with_file(data, |path| {
        let _ = Opened::open(path).map(|opened| opened.format());
        for options in [GnssLog::new(Format::Rtklib), stated] {
            gnss(GnssReader::open(path, &options.into()));
        }
    });
});
