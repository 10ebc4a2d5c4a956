#![no_main]

use undrift::io::scalar::{Reading, ScalarFormat, ScalarReader, ScalarStd};
use undrift::io::table::Column;
use undrift_fuzz::{check_counts, exhaust, opened, scalar, with_file};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let speed = ScalarFormat {
        table: "odometer",
        time: Column::Number(1),
        date: None,
        time_scale: 1.0,
        time_offset: 0.0,
        value: ("speed", Column::Number(2)),
        reading: Reading::Scaled(1.0 / 3.6),
        std: ("speed_std", ScalarStd::Constant(0.1)),
        range: (-150.0, 150.0),
        delimiter: None,
        span: None,
    };
    let ticks = ScalarFormat {
        reading: Reading::Count(0.02),
        std: (
            "speed_std_column",
            ScalarStd::Column(Column::Number(3), 1.0),
        ),
        ..speed.clone()
    };
    let pressure = ScalarFormat {
        table: "barometer",
        time: Column::Name("t".into()),
        value: ("pressure", Column::Name("p".into())),
        reading: Reading::Pressure(100.0),
        range: (-1000.0, 11_000.0),
        ..speed.clone()
    };
    with_file(data, |path| {
        for format in [speed, ticks, pressure] {
            if let Ok(mut reader) = opened(ScalarReader::open(path, &format)) {
                exhaust(&mut reader, |scalar| scalar.time, scalar);
                check_counts(reader.skipped(), Some(reader.gaps()));
            }
        }
    });
});
