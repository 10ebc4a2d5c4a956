//! The commands of the README run as they are printed there, one after the other in one folder.

use std::{path::Path, process::Command};

#[test]
fn the_commands_of_the_readme_run_as_printed() {
    let readme = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");
    let text = std::fs::read_to_string(readme).unwrap();
    let commands = text
        .lines()
        .filter_map(|line| line.strip_prefix("    undrift "));
    let folder = std::env::temp_dir().join(format!("undrift-readme-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_undrift"));
    let mut run = Vec::new();
    for command in commands {
        let mut shell = Command::new("sh");
        let path = std::env::var("PATH").unwrap_or_default();
        let path = format!("{}:{path}", program.parent().unwrap().display());
        let shell = shell.current_dir(&folder).env("PATH", path);
        let done = shell
            .args(["-c", &format!("undrift {command}")])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(done.status.success(), "undrift {command}\n{said}");
        // A reader who only looks at the first line has to see that it worked.
        let shown = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(
            !shown.to_lowercase().starts_with("not usable"),
            "undrift {command}\n{shown}"
        );
        run.push(command.split(' ').next().unwrap_or_default().to_owned());
    }
    let expected = [
        "sample", "identify", "model", "inspect", "outages", "tune", "fleet",
    ];
    assert_eq!(run, expected);
    std::fs::remove_dir_all(&folder).unwrap();
}
