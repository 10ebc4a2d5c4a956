//! A starter `DRIVE.toml`.

use super::{Inspection, Known, Model, Motion, Part, first};
use crate::vehicle::Profile;
use std::path::Path;
use toml::Value;
use undrift_io::visible;

/// The drive file that reads the first IMU, the first fixes and the first reference of the files.
/// `home` is the folder where it will lie: files below it are named relative to it. `vehicle` is its profile where that is
/// known; where its `motion` is that of wheels the car's is proposed. `say` makes the comment of how a value is known.
pub fn drive_file(
    model: &Model,
    inspections: &[Inspection],
    home: &Path,
    vehicle: Option<Profile>,
    motion: Motion,
    say: &dyn Fn(&Known) -> String,
) -> String {
    let mut text = String::from(
        "# A starter drive file. Check what is marked \"guessed\".\n\
         # All keys: docs/drive-file.md\n\n\
         # Noise model of the IMU at rest: a preset, or better the file that `undrift identify` writes\n\
         # from a static recording of the sensor. `undrift tune` estimates the noise in the vehicle\n\
         # from this drive.\n",
    );
    text += &format!("model = {model} # {}\n", say(&model.known));
    for (table, needed) in [("imu", true), ("gnss", true), ("truth", false)] {
        match first(inspections, table) {
            Some((file, part)) => write_part(&mut text, file, part, home, say),
            None if needed => {
                text += &format!(
                    "\n# Missing: a file with the {table} data.\n# [{table}]\n# file = \"\"\n"
                );
            }
            None => {}
        }
    }
    if motion.heading {
        text += "\n[initial]\nheading = \"auto\" # from changes of velocity, which suffice in this drive\n";
    }
    match vehicle {
        Some(profile) => {
            text += &format!("\n[vehicle]\nprofile = {}\n", Value::from(profile.name()));
        }
        None if motion.wheels => {
            text += "\n# The motion is that of a wheeled vehicle: these lines greatly reduce the drift without GNSS.\n\
                     # [vehicle]\n# profile = \"car\"\n";
        }
        None => {}
    }
    text
}

fn write_part(
    text: &mut String,
    inspection: &Inspection,
    part: &Part,
    home: &Path,
    say: &dyn Fn(&Known) -> String,
) {
    let file = Value::from(relative(&inspection.file, home));
    *text += &format!(
        "\n[{}]\nfile = {file} # {}\n",
        part.table, inspection.description
    );
    for line in &part.lines {
        // One line, whatever a column or stream is called.
        let why = say(&line.known);
        let entry = format!("{} = {} # {}", line.key, line.value, visible(&why));
        *text += entry.trim_end_matches(" # ");
        text.push('\n');
    }
    if part.table == "gnss" {
        *text += "# lever_arm = \"0, 0, 0 m\" # from the IMU to the antenna: forward, right, down; measured beats estimated\n";
    }
    for line in part.problem.iter().flat_map(|problem| problem.lines()) {
        *text += &format!("# {}\n", visible(line));
    }
}

/// The file as seen from the folder: relative if it is below it, else whole.
fn relative(file: &Path, home: &Path) -> String {
    let found = match (
        file.canonicalize(),
        Path::new(".").join(home).canonicalize(),
    ) {
        (Ok(file), Ok(home)) => file.strip_prefix(&home).unwrap_or(&file).to_path_buf(),
        _ => file.to_path_buf(),
    };
    found.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::{super::Line, *};

    #[test]
    fn names_and_problems_with_control_characters_stay_toml() {
        let odd = "gps\u{7f}\u{1b}\r_\"0\"";
        let topic = Line::new("topic", odd, Known::FirstOf(vec![odd.into()]));
        let part = Part {
            problem: Some(format!("the log has: {odd}\nand {odd}")),
            ..Part::new("imu", vec![topic])
        };
        let inspection = Inspection {
            file: odd.into(),
            format: "ulog",
            description: "PX4 ULog",
            streams: Vec::new(),
            parts: vec![part],
            found: Vec::new(),
            held: None,
        };
        let model = Model {
            preset: "adis16405",
            known: Known::SensorName,
        };
        let say = |known: &Known| match known {
            Known::FirstOf(others) => format!("the others are {}", others.join(", ")),
            _ => String::new(),
        };
        let home = Path::new("");
        let text = drive_file(&model, &[inspection], home, None, Motion::default(), &say);
        assert!(text.contains("# the others are gps"), "{text}");
        let table: toml::Table = text.parse().unwrap();
        let keys = |key: &str| table["imu"].get(key).and_then(|value| value.as_str());
        assert_eq!((keys("file"), keys("topic")), (Some(odd), Some(odd)));
    }
}
