//! Gyroscopes and accelerometers in files of their own, as one table.

use super::{Inspection, Known, Line, Part, first, inspect};
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
    let mut pairs = pairs.flat_map(|(k, one)| {
        halves
            .iter()
            .skip(k + 1)
            .map(move |other| (&**one, &**other))
    });
    let named = |line: &Line| line.key == "gyro" && matches!(line.known, Known::Name { .. });
    let mut join = |(one, other): (&Path, &Path)| {
        let joined = inspect(&halves::name(one, other)).ok()?;
        let (_, imu) = first(std::slice::from_ref(&joined), "imu")?;
        let alone = files
            .iter()
            .filter(|file| [one, other].contains(&&*file.file));
        let is_new = alone.clone().all(|file| file.parts.is_empty());
        let found = is_new || imu.lines.iter().any(named);
        found.then(|| ([one, other].map(Path::to_path_buf), joined))
    };
    let Some(mut found) = pairs.find_map(&mut join) else {
        return;
    };
    // An app writes accelerations without gravity, and in a file of their own those with it.
    let imu_of =
        |joined: &Inspection| first(std::slice::from_ref(joined), "imu").map(|of| of.1.clone());
    let lacks = |part: &Part| super::gravity::removed_gravity(part).is_some();
    if imu_of(&found.1).is_some_and(|part| lacks(&part)) {
        let is_whole = |part: Part| part.lines.iter().any(named) && !lacks(&part);
        let whole = pairs
            .filter_map(join)
            .find(|(_, joined)| imu_of(joined).is_some_and(is_whole));
        found = whole.unwrap_or(found);
    }
    let ([one, other], joined) = found;
    for file in files {
        if file.file == one {
            *file = joined.clone();
        } else if file.file == other {
            file.file.clone_from(&joined.file);
            file.found.clear();
            file.parts.clear();
        }
    }
}

/// Takes away what was taken for fixes by its numbers and cannot be read, where another file has fixes.
pub(super) fn forget_guesses(inspections: &mut [Inspection]) {
    let mut parts = inspections.iter().flat_map(|file| &file.parts);
    if !parts.any(|part| part.table == "gnss" && part.problem.is_none()) {
        return;
    }
    let of_numbers = |line: &Line| matches!(line.known, Known::Numbers { several: true });
    for file in inspections {
        file.parts.retain(|part| {
            let wrong = part.table == "gnss" && part.problem.is_some();
            !(wrong && part.lines.iter().any(of_numbers))
        });
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

    /// `Accelerometer` without gravity, `TotalAcceleration` with it, `Gravity` that could be places by its numbers.
    #[test]
    fn of_accelerations_in_several_files_those_with_gravity_are_joined() {
        let folder = std::env::temp_dir().join(format!("undrift-whole-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, of: [f64; 3], header: &str| {
            let row = |k: u32| {
                let wave = 0.4 * f64::from(k % 7);
                let [x, y, z] = of.map(|x| x + wave);
                format!("{},{z},{y},{x}\n", 0.02 * f64::from(k))
            };
            let rows = (0..300).map(row).collect::<String>();
            let file = folder.join(name);
            std::fs::write(&file, format!("{header}\n{rows}")).unwrap();
            file
        };
        let names = "seconds_elapsed,z,y,x";
        let files = [
            write("Accelerometer.csv", [0.1, 0.2, -0.9], names),
            write("Gyroscope.csv", [0.0, 0.002, 0.003], names),
            write("TotalAcceleration.csv", [0.1, 0.2, 8.6], names),
        ];
        let mut found = files.each_ref().map(|file| inspect(file).unwrap());
        join(&mut found);
        let (_, imu) = first(&found, "imu").unwrap();
        let line = imu.lines.iter().find(|line| line.key == "accel").unwrap();
        assert_eq!(
            line.value.to_string(),
            "[\"TotalAcceleration.x\", \"TotalAcceleration.y\", \"TotalAcceleration.z\"]"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_cannot_be_read_as_fixes_is_forgotten_beside_what_can() {
        let file = |known: Known, problem: Option<&str>| Inspection {
            file: "log.csv".into(),
            format: "csv",
            description: "delimited text",
            streams: Vec::new(),
            parts: vec![Part {
                problem: problem.map(str::to_owned),
                ..Part::new("gnss", vec![Line::new("position", "p", known)])
            }],
            found: Vec::new(),
            held: None,
        };
        let parts = |other: Known, problem: Option<&str>| {
            let named = Known::Name { several: true };
            let mut both = [file(other, Some("not on Earth")), file(named, problem)];
            forget_guesses(&mut both);
            both.map(|file| file.parts.len())
        };
        let guess = Known::Numbers { several: true };
        assert_eq!(parts(guess.clone(), None), [0, 1]);
        assert_eq!(parts(guess, Some("late")), [1, 1]);
        assert_eq!(parts(Known::Name { several: true }, None), [1, 1]);
    }
}
