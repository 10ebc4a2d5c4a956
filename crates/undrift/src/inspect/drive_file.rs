//! A first `DRIVE.toml` from what files are.

use super::{Inspection, Part, quoted};
use std::{fmt::Write as _, path::Path};

/// The drive file that reads the first IMU, the first fixes and the first reference of the files.
/// `home` is the folder where it will lie: files below it are named relative to it.
pub fn drive_file(inspections: &[Inspection], home: &Path) -> String {
    let first = |table: &str| {
        inspections.iter().find_map(|file| {
            let part = file.parts.iter().find(|part| part.table == table)?;
            Some((file, part))
        })
    };
    let mut text = String::from(
        "# A first drive file. What is marked \"guessed\" should be checked.\n\
         # All keys: docs/drive-file.md\n\n\
         # Noise model of the IMU: a preset, or better the file that `undrift identify` writes\n\
         # from a record of the sensor at rest.\n\
         model = \"mpu6050\"\n",
    );
    for (table, needed) in [("imu", true), ("gnss", true), ("truth", false)] {
        match first(table) {
            Some((file, part)) => write_part(&mut text, file, part, home),
            None if needed => {
                let _ = write!(
                    text,
                    "\n# Missing: a file with the {table} data.\n# [{table}]\n# file = \"\"\n"
                );
            }
            None => {}
        }
    }
    text
}

fn write_part(text: &mut String, inspection: &Inspection, part: &Part, home: &Path) {
    let _ = write!(
        text,
        "\n[{}]\nfile = {} # {}\n",
        part.table,
        quoted(&relative(&inspection.file, home)),
        inspection.description
    );
    for line in &part.lines {
        let _ = write!(text, "{} = {}", line.key, line.value);
        if !line.why.is_empty() {
            let _ = write!(text, " # {}", comment(&line.why));
        }
        text.push('\n');
    }
    if part.table == "gnss" {
        text.push_str("lever_arm = \"0, 0, 0 m\" # from the IMU to the antenna: forward, right, down; measure it\n");
    }
    if let Some(problem) = &part.problem {
        for line in problem.lines() {
            let _ = writeln!(text, "# {}", comment(line));
        }
    }
}

/// A text as the comment of one line, whatever a column or stream is called.
fn comment(text: &str) -> String {
    let one = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(one).collect()
}

/// The file as seen from the folder: relative if it is below it, else whole.
fn relative(file: &Path, home: &Path) -> String {
    let whole = |path: &Path| std::fs::canonicalize(path);
    let home = if home.as_os_str().is_empty() {
        Path::new(".")
    } else {
        home
    };
    let found = match (whole(file), whole(home)) {
        (Ok(file), Ok(home)) => file
            .strip_prefix(&home)
            .map_or(file.clone(), Path::to_path_buf),
        _ => file.to_path_buf(),
    };
    found.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::Line;
    use super::*;

    #[test]
    fn names_and_problems_with_control_characters_stay_toml() {
        let odd = "gps\u{7f}\u{1b}\r_\"0\"";
        let inspection = Inspection {
            file: odd.into(),
            format: "ulog",
            description: "PX4 ULog",
            streams: Vec::new(),
            parts: vec![Part {
                problem: Some(format!("the log has: {odd}\nand {odd}")),
                ..Part::new("imu", vec![Line::text("topic", odd, odd)])
            }],
            notes: Vec::new(),
        };
        let text = drive_file(&[inspection], Path::new(""));
        let table: toml::Table = text.parse().unwrap();
        let keys = |key: &str| table["imu"].get(key).and_then(|value| value.as_str());
        assert_eq!((keys("file"), keys("topic")), (Some(odd), Some(odd)));
    }
}
