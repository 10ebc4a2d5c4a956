//! Gyroscopes and accelerometers in files of their own, as one table.

use super::{Inspection, Known, Line, first, inspect};
use std::path::{Path, PathBuf};
use undrift_io::table::halves;

/// The table that two recordings are together, where neither is an inertial log and both together are.
pub fn of_two(one: &Path, other: &Path) -> Option<PathBuf> {
    let mut files = [inspect(one).ok()?, inspect(other).ok()?];
    join(&mut files);
    let joined = halves::name(one, other);
    (files[0].file == joined).then_some(joined)
}

/// Joins two tables of which neither has a part of a drive, or the names of the files are those of two sensors, where both together have
/// an IMU by the names of their columns: gyroscopes and accelerometers in files of their own.
pub(super) fn join(files: &mut [Inspection]) {
    let is_sensor = |file: &Inspection| {
        let name = file.file.file_stem().unwrap_or_default();
        let name = name.to_string_lossy().to_lowercase();
        ["gyr", "acc"].iter().any(|sensor| name.contains(sensor))
    };
    // Columns x, y and z get their sensor from the name of the file.
    let is_guess = |file: &Inspection| {
        let of_numbers = |line: &Line| matches!(line.known, Known::Numbers { several: true });
        let mut parts = file.parts.iter();
        parts.all(|part| part.lines.iter().any(of_numbers)) && is_sensor(file)
    };
    let known = files.iter().filter(|file| !is_guess(file));
    if known
        .flat_map(|file| &file.parts)
        .any(|part| part.table == "imu")
    {
        return;
    }
    let is_half =
        |file: &&Inspection| (file.parts.is_empty() || is_guess(file)) && file.held.is_none();
    let halves = Vec::from_iter(files.iter().filter(is_half).map(|half| half.file.clone()));
    let pairs = halves.iter().enumerate();
    let mut pairs =
        pairs.flat_map(|(k, one)| halves.iter().skip(k + 1).map(move |other| (one, other)));
    let joined = pairs.find_map(|(one, other)| {
        let joined = inspect(&halves::name(one, other)).ok()?;
        let (_, imu) = first(std::slice::from_ref(&joined), "imu")?;
        let named = |line: &Line| line.key == "gyro" && matches!(line.known, Known::Name { .. });
        let alone = files
            .iter()
            .filter(|file| [one, other].contains(&&file.file));
        let is_new = alone.clone().all(|file| file.parts.is_empty());
        (is_new || imu.lines.iter().any(named)).then_some((one, other, joined))
    });
    let Some((one, other, joined)) = joined else {
        return;
    };
    for file in files {
        if file.file == *one {
            *file = joined.clone();
        } else if file.file == *other {
            file.file.clone_from(&joined.file);
            file.found.clear();
            file.parts.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files of columns x, y and z, named by their sensor, with more columns that could be samples.
    #[test]
    fn the_names_of_files_are_those_of_sensors() {
        let folder = std::env::temp_dir().join(format!("undrift-joined-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let [gyro, accel] = ["RawGyro.csv", "RawAccel.csv"].map(|name| folder.join(name));
        let write = |file: &Path, [x, y, z]: [f64; 3]| {
            let row = |k: u32| {
                let wave = 0.01 * f64::from(k % 7);
                let time = 10_000 * k + 112_000_000;
                format!("{time},{},{y},{z},35.2,78.4,0.002,12,{k},5,9\n", x + wave)
            };
            let names = "Timestamp,x,y,z,temperature,range,scaling,x_raw,y_raw,z_raw,t_raw\n";
            std::fs::write(
                file,
                names.to_owned() + &(0..300).map(row).collect::<String>(),
            )
        };
        write(&gyro, [0.0, 0.002, 0.003]).unwrap();
        write(&accel, [0.1, 0.2, 9.8]).unwrap();
        let joined = of_two(&gyro, &accel);
        assert_eq!(joined, Some(halves::name(&gyro, &accel)));
        let mut files = [inspect(&gyro).unwrap(), inspect(&accel).unwrap()];
        join(&mut files);
        let (_, imu) = first(&files, "imu").unwrap();
        let line = imu.lines.iter().find(|line| line.key == "gyro").unwrap();
        assert_eq!(
            line.value.to_string(),
            "[\"RawGyro.x\", \"RawGyro.y\", \"RawGyro.z\"]"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
