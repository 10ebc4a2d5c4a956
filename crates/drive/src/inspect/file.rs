//! A starter `DRIVE.toml`.

use super::{Comment, Flight, Inspection, Model, Motion, Part, Wheels, first, fixes_table};
use crate::vehicle::Profile;
use std::path::{Path, PathBuf};
use toml::Value;
use undrift_io::{table::halves, visible};
use undrift_results::inspect::pose_piece;

/// What is left away beside a break of poses \[s\].
const APART: f64 = 0.3;

/// Makes the text of a comment.
type Say<'a> = &'a dyn Fn(Comment) -> String;

/// The drive file that reads the first IMU, the first fixes and the first reference of the files.
/// `home` is the folder where it will lie: files below it are named relative to it. `vehicle` is its profile where that is
/// known; where its `motion` is that of wheels it is the car's, and where it may be, that is proposed. `say` makes the comments.
pub fn drive_file(
    model: &Model,
    inspections: &[Inspection],
    home: &Path,
    vehicle: Option<Profile>,
    motion: Motion,
    say: Say,
) -> String {
    let above = |of| commented(&say(of));
    let mut text = above(Comment::Top) + "\n" + &above(Comment::Model);
    text += &format!("model = {model} # {}\n", say(Comment::Known(&model.known)));
    let fixes = fixes_table(inspections);
    for (table, needed) in [
        ("imu", true),
        (fixes, true),
        ("heading", false),
        ("magnetometer", false),
        ("truth", false),
    ] {
        match first(inspections, table) {
            Some((file, part)) => write_part(&mut text, file, part, home, say),
            None if needed => {
                let missing = above(Comment::Missing(table));
                text += &format!("\n{missing}# [{table}]\n# file = \"\"\n");
            }
            None => {}
        }
    }
    if let Some([start, end]) = pose_piece(inspections) {
        let why = say(Comment::Piece);
        // Beside the break nothing is sure.
        let (start, end) = (start + APART, end - APART);
        text += &format!("\n[span] # {why}\nstart = \"{start:.1} s\"\nend = \"{end:.1} s\"\n");
    }
    if motion.heading {
        let why = say(Comment::Heading);
        text += &format!("\n[initial]\nheading = \"auto\" # {why}\n");
    }
    let profile = |of: Profile| format!("profile = {}", Value::from(of.name()));
    let car = profile(Profile::Car);
    text += &match (vehicle, motion.flight, motion.wheels) {
        (Some(given), ..) => format!("\n[vehicle]\n{}\n", profile(given)),
        (None, _, Wheels::Shown) => {
            let why = say(Comment::Wheels(motion.wheels));
            format!("\n[vehicle]\n{car} # {why}\n")
        }
        (None, Some(flight), _) => {
            let flies = profile(match flight {
                Flight::Copter => Profile::Copter,
                Flight::Aircraft => Profile::Aircraft,
            });
            let why = say(Comment::Flight(flight));
            format!("\n[vehicle]\n{flies} # {why}\n")
        }
        (None, None, Wheels::Likely) => {
            let why = above(Comment::Wheels(motion.wheels));
            format!("\n{why}# [vehicle]\n# {car}\n")
        }
        (None, None, Wheels::No) => String::new(),
    };
    text
}

/// The text of a drive file with this noise model, a preset or a file, in place of its own; `home` as for [`drive_file`].
pub fn with_model(text: &str, name: &str, home: &Path) -> String {
    let value = match undrift_noise::ImuModel::preset(name) {
        Some(_) => Value::from(name),
        None => Value::from(relative(Path::new(name), home)),
    };
    let line = |line: &str| match line.starts_with("model = ") {
        true => format!("model = {value}\n"),
        false => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

fn write_part(text: &mut String, inspection: &Inspection, part: &Part, home: &Path, say: Say) {
    let file = Value::from(relative(&inspection.file, home));
    *text += &format!(
        "\n[{}]\nfile = {file} # {}\n",
        part.table, inspection.description
    );
    for line in &part.lines {
        // One line, whatever a column or stream is called.
        let why = say(Comment::Known(&line.known));
        let entry = format!("{} = {} # {}", line.key, line.value, visible(&why));
        *text += entry.trim_end_matches(" # ");
        text.push('\n');
    }
    let is_open = |key| part.lines.iter().all(|line| line.key != key);
    if part.table == "heading" && is_open("baseline") {
        let why = say(Comment::Baseline);
        *text += &format!("# baseline = \"90 deg\" # {why}\n");
    }
    if part.table == "gnss" {
        let why = say(Comment::LeverArm);
        *text += &format!("# lever_arm = \"0, 0, 0 m\" # {why}\n");
    }
    *text += &commented(part.problem.as_deref().unwrap_or_default());
}

/// Lines of comments.
fn commented(text: &str) -> String {
    let lines = text.lines();
    lines.map(|line| format!("# {}\n", visible(line))).collect()
}

/// The file as seen from the folder: relative if it is below it, else whole.
fn relative(file: &Path, home: &Path) -> String {
    if let Some([first, second]) = halves::files(file) {
        let first = PathBuf::from(relative(&first, home));
        let same = first.with_file_name(second.file_name().unwrap_or_default());
        let second = if second.is_absolute() { second } else { same };
        return halves::name(&first, &second).display().to_string();
    }
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
    use super::{
        super::{Known, Line},
        *,
    };

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
        let say = |of: Comment| match of {
            Comment::Known(Known::FirstOf(others)) => {
                format!("the others are {}", others.join(", "))
            }
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
