#![no_main]

use undrift::io::gnss::VelocityAxes;
use undrift::io::layouts;
use undrift::io::table::Column;
use undrift::io::truth::{TruthFormat, TruthReader};
use undrift_fuzz::logs::poses;
use undrift_fuzz::with_file;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let name = |name: &str| Column::Name(name.to_owned());
    let named = TruthFormat {
        time_scale: 1e-3,
        time_offset: -18.0,
        velocity: Some(["vn", "ve", "vu"].map(name)),
        velocity_axes: VelocityAxes::Up,
        span: Some((0.0, 1e6)),
        ..TruthFormat::degrees(name("t"), ["lat", "lon", "height"].map(name))
    };
    with_file(data, |path| {
        for format in [layouts::kf_gins_truth(), named] {
            poses(TruthReader::open(path, &format.into()));
        }
    });
});
