#![no_main]

use std::path::Path;

use undrift::inspect::{Inspection, Motion, drive_file, inspect, model};
use undrift_fuzz::with_file;
use undrift_report::inspect::comment;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    with_file(data, |path| {
        if let Ok(inspection) = undrift_fuzz::opened(inspect(path)) {
            check(&inspection);
        }
    });
});

/// The numbers are finite, and the starter drive file is TOML whatever the columns are called.
fn check(inspection: &Inspection) {
    for measured in inspection
        .parts
        .iter()
        .filter_map(|part| part.measured.as_ref())
    {
        let gap = measured.longest_gap_s.unwrap_or_default();
        let numbers = [
            measured.first_s,
            measured.last_s,
            measured.rate_hz,
            gap.0,
            gap.1,
        ];
        assert!(numbers.iter().all(|x| x.is_finite()), "{measured:?}");
    }
    let inspections = std::slice::from_ref(inspection);
    let text = drive_file(
        &model(inspections),
        inspections,
        Path::new("/"),
        None,
        Motion::default(),
        &comment,
    );
    let drive = text.parse::<toml::Table>();
    assert!(drive.is_ok(), "{drive:?} of\n{text}");
}
