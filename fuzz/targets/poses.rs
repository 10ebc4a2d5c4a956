#![no_main]

use undrift::io::Opened;
use undrift::io::poses::{AttitudeColumns, PoseFormat, PoseReader, detect};
use undrift::io::table::Column;
use undrift_fuzz::logs::local_poses;
use undrift_fuzz::{opened, with_file};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let columns = |first: usize| [0, 1, 2].map(|k| Column::Number(first + k));
    let euler = AttitudeColumns::Euler {
        columns: columns(5),
        scale: 1f64.to_radians(),
    };
    let numbered = PoseFormat {
        time_scale: 1e-3,
        week: Some(Column::Number(1)),
        position_scale: 1e-3,
        position_std: Some(columns(2)),
        attitude_std: Some(columns(3)),
        span: Some((0.0, 1e6)),
        ..PoseFormat::new(Column::Number(1), Some(columns(2)), Some(euler))
    };
    let matrix = std::array::from_fn(|k| Column::Number(2 + k));
    let matrix = PoseFormat::new(
        Column::Number(1),
        None,
        Some(AttitudeColumns::Matrix(matrix)),
    );
    with_file(data, |path| {
        for body in [None, Some("body")] {
            let found = opened(Opened::open(path).and_then(|mut log| detect(&mut log, body)));
            if let Ok(Some(source)) = found {
                local_poses(PoseReader::open(path, &source));
            }
        }
        for format in [&numbered, &matrix] {
            local_poses(PoseReader::open(path, &format.clone().into()));
        }
    });
});
