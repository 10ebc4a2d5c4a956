//! What the documents show: commands run as they are printed, the tutorial's answers are what is printed, and links
//! lead somewhere. `UNDRIFT_BLESS=1` writes the tutorial's answers.

use crate::public;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A folder for commands; `examples` in it is the repository's, `DATA` the recorded logs where they are.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("undrift-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Output of a shell's command, errors with it, and whether it succeeded.
fn shell(folder: &Path, command: &str) -> (String, bool) {
    let program = Path::new(env!("CARGO_BIN_EXE_undrift"));
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let done = Command::new("sh")
        .args(["-c", &format!("{command} 2>&1")])
        .current_dir(folder)
        .env("PATH", path)
        .env("HOME", folder)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    (text, done.status.success())
}

#[test]
fn the_commands_of_the_readme_run_as_printed() {
    let text = fs::read_to_string(root().join("README.md")).unwrap();
    let folder = folder("readme");
    let mut run = Vec::new();
    let of_the_command = |command: &String| command.starts_with("undrift ");
    for command in commands(&text).into_iter().filter(of_the_command) {
        let (shown, succeeded) = shell(&folder, &command);
        assert!(succeeded, "{command}\n{shown}");
        // A reader who only looks at the first line has to see that it worked.
        let unusable = shown.lines().any(|line| line.starts_with("not usable"));
        assert!(!unusable, "{command}\n{shown}");
        run.push(command.split(' ').nth(1).unwrap_or_default().to_owned());
    }
    let expected = [
        "sample", "identify", "model", "inspect", "outages", "tune", "tune", "model", "live",
        "fleet",
    ];
    assert_eq!(run, expected);
    fs::remove_dir_all(&folder).unwrap();
}

/// The commands of a page, without their comments: indented lines that begin with the program's name or with
/// `cargo run`, the latter between backticks too, and the lines of blocks of a shell.
fn commands(page: &str) -> Vec<String> {
    let mut lines = page.lines();
    let mut block = None;
    let mut commands = Vec::new();
    while let Some(line) = lines.next() {
        if let Some(language) = line.trim_start().strip_prefix("```") {
            block = block.is_none().then_some(language);
            continue;
        }
        let command = match block {
            Some("sh" | "bash" | "shell") => {
                Some(line.trim()).filter(|line| !line.starts_with('#'))
            }
            Some("console") => line.strip_prefix("$ "),
            Some(_) => None,
            None => line.strip_prefix("    ").filter(|line| is_command(line)),
        };
        let Some(command) = command.filter(|command| !command.is_empty()) else {
            let spans = line.split('`').skip(1).step_by(2);
            let spans = spans.filter(|span| block.is_none() && run_by_cargo(span).is_some());
            commands.extend(spans.map(str::to_owned));
            continue;
        };
        let mut command = command.to_owned();
        while let Some(begun) = command.strip_suffix('\\') {
            command = format!("{begun}{}", lines.next().unwrap_or_default().trim());
        }
        let bare = command.split("  #").next().unwrap_or_default().trim_end();
        commands.push(bare.to_owned());
    }
    commands
}

/// Whether an indented line is to be run.
fn is_command(line: &str) -> bool {
    line.starts_with("undrift ") || run_by_cargo(line).is_some()
}

/// The arguments of `cargo run`, but for a mention of the profile alone.
fn run_by_cargo(command: &str) -> Option<&str> {
    let (_, arguments) = command.split_once("cargo run ")?;
    (arguments != "--release").then_some(arguments)
}

#[test]
fn commands_are_found_in_lines_blocks_and_sentences() {
    let page = "\
As `cargo run -p a` or `cargo test` do in `cargo run --release`:

    undrift one \\
        two   # a comment
    X=1 cargo run --bin b
    not one

```sh
#!/bin/sh
tools/c
```
```toml
undrift = 3
```
```console
$ undrift d
what it prints, `cargo run` too
```
";
    let expected = [
        "cargo run -p a",
        "undrift one two",
        "X=1 cargo run --bin b",
        "tools/c",
        "undrift d",
    ];
    assert_eq!(commands(page), expected);
}

/// `cargo run` of a page by the binary that is built already, with a drive of the public data for a reader's own.
fn without_cargo(command: &str) -> String {
    command
        .replacen("cargo run --release -- ", "undrift ", 1)
        .replace("YOUR/LOGS", "DATA/rtk-drive")
}

#[test]
fn what_the_pages_run_by_cargo_is_there() {
    let programs = root().join("tools/lab/src/bin");
    let mut run = 0;
    for (name, text) in documents() {
        for command in commands(&text) {
            let Some(arguments) = run_by_cargo(&command) else {
                continue;
            };
            run += 1;
            let words: Vec<&str> = arguments.split_whitespace().collect();
            match words[..] {
                ["--release", "--", ..] => (),
                ["--release", "-p", "undrift-lab", "--bin", program, ..] => {
                    let [file, folder] = [format!("{program}.rs"), format!("{program}/main.rs")];
                    let is_there = programs.join(file).is_file() || programs.join(folder).is_file();
                    assert!(is_there, "{name}: no program {program}");
                }
                _ => panic!("{name}: cargo run {command}"),
            }
        }
    }
    assert!(run > 20, "{run}");
}

#[test]
fn the_tutorial_prints_what_it_shows() {
    let page = root().join("docs/tutorial.md");
    let kept = fs::read_to_string(&page).unwrap();
    let folder = folder("tutorial");
    let mut now = String::new();
    let mut console = false;
    for line in kept.lines() {
        let command = line.strip_prefix("$ ").filter(|_| console);
        match line {
            "```console" => console = true,
            "```" => console = false,
            _ => (),
        }
        // An answer is printed with its command.
        if command.is_none() && console && line != "```console" {
            continue;
        }
        now += &format!("{line}\n");
        if let Some(command) = command {
            let (shown, succeeded) = shell(&folder, command);
            assert!(succeeded, "{command}\n{shown}");
            now += &shown;
        }
    }
    fs::remove_dir_all(&folder).unwrap();
    if std::env::var_os("UNDRIFT_BLESS").is_some() {
        fs::write(&page, &now).unwrap();
        return;
    }
    for (now, kept) in now.lines().zip(kept.lines()) {
        assert_eq!(now, kept);
    }
    assert_eq!(now, kept, "docs/tutorial.md is not up to date");
}

/// Commands of the pages that this test leaves out, and why.
const LEFT_OUT: [(&str, &str); 8] = [
    ("undrift demo", "minutes; the browser tests make its report"),
    ("tools/fuzz", "minutes; weekly, in a workflow"),
    (
        "cargo run --release -p undrift-lab",
        "studies of minutes to hours; `what_the_pages_run_by_cargo_is_there`",
    ),
    (
        "undrift completions",
        "writes where shells look; terminal.rs",
    ),
    ("undrift man", "writes where man looks; terminal.rs"),
    (
        "undrift montecarlo",
        "a hundred runs; montecarlo.rs runs some",
    ),
    (
        "undrift fleet fleet.toml",
        "its manifest is a user's; fleet.rs",
    ),
    ("undrift fleet --shard", "a share of the same"),
];

#[test]
#[ignore = "slow"]
fn the_commands_of_the_pages_run_as_printed() {
    let folder = folder("pages");
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink(
            fs::canonicalize(root().join("examples")).unwrap(),
            folder.join("examples"),
        )
        .unwrap();
        for (name, path) in [
            ("DATA", public::folder()),
            ("target", root().join("target")),
        ] {
            if let Ok(path) = fs::canonicalize(path) {
                symlink(path, folder.join(name)).unwrap();
            }
        }
    }
    // What the pages start from: the sample logs and the drive file that inspect writes of them.
    let start = [
        "undrift sample logs",
        "for day in monday tuesday wednesday thursday; do n=$((n + 1)); undrift sample days/$day --seed $n && \
         head -n 12001 days/$day/static.csv > $day.csv; done",
        "undrift inspect logs/drive/imu.csv logs/drive/gnss.csv -o drive.toml",
    ];
    for command in start {
        let (shown, succeeded) = shell(&folder, command);
        assert!(succeeded, "{command}\n{shown}");
    }
    let mut failed = String::new();
    let mut run = 0;
    let mut missing = BTreeSet::new();
    for (name, text) in documents() {
        // Which tests of their own run.
        let by_itself = |command: &String| match name.as_str() {
            "README.md" => !command.starts_with("undrift "),
            name => name != "tutorial.md",
        };
        for command in commands(&text).into_iter().filter(by_itself) {
            let command = without_cargo(&command);
            if LEFT_OUT.iter().any(|(start, _)| command.contains(start)) {
                continue;
            }
            let lacking = |word: &&str| {
                let input = ["DATA", "target/drive30", "target/drives"];
                let path = folder.join(word.trim_end_matches("*.json"));
                input.iter().any(|input| word.starts_with(input)) && !path.exists()
            };
            if let Some(word) = command.split_whitespace().find(lacking) {
                missing.insert(word.to_owned());
                continue;
            }
            let (shown, succeeded) = shell(&folder, &command);
            run += 1;
            if !succeeded {
                failed += &format!("{name}: {command}\n{shown}\n");
            }
        }
    }
    assert!(failed.is_empty(), "{failed}");
    assert!(run > 20, "{run}");
    // Results of benches/drives are nothing to lack.
    missing.retain(|path| !path.starts_with("target/drives"));
    for path in missing {
        public::skipped(&path);
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// The pages and what lies beside them, by name.
fn documents() -> BTreeMap<String, String> {
    let mut pages = pages();
    for name in ["README.md", "CONTRIBUTING.md"] {
        let text = fs::read_to_string(root().join(name)).unwrap();
        pages.insert(name.to_owned(), text);
    }
    pages
}

/// Pages of the documentation, by name; those of the lab begin with `lab/`.
fn pages() -> BTreeMap<String, String> {
    let folder = root().join("docs");
    let mut pages = BTreeMap::new();
    for shelf in ["", "lab/"] {
        for entry in fs::read_dir(folder.join(shelf)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "md") {
                let name = path.file_name().unwrap().to_string_lossy();
                pages.insert(format!("{shelf}{name}"), fs::read_to_string(&path).unwrap());
            }
        }
    }
    pages
}

#[test]
fn every_link_leads_somewhere() {
    let pages = pages();
    let mut broken = Vec::new();
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let docs = pages
        .iter()
        .map(|(name, text)| (format!("docs/{name}"), text));
    for (page, text) in docs.chain([("README.md".to_owned(), &readme)]) {
        let home = root().join(&page);
        for link in links(text) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => home.clone(),
                file => home.parent().unwrap().join(file),
            };
            if !target.exists() {
                broken.push(format!("{page}: no file for {link}"));
            } else if !anchor.is_empty() && !anchors(&target).contains(&anchor.to_owned()) {
                broken.push(format!("{page}: no heading for {link}"));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// The pages of the index with the part that each is in, in order.
fn index(contents: &str) -> Vec<(String, String)> {
    let mut part = String::new();
    let mut listed = Vec::new();
    for line in contents.lines() {
        if let Some(heading) = line.strip_prefix("# ") {
            heading.clone_into(&mut part);
        }
        listed.extend(
            links(line)
                .iter()
                .map(|&page| (part.clone(), page.to_owned())),
        );
    }
    listed
}

/// What a user reads fits into an afternoon; how it was checked and how it is built are in parts of their own.
#[test]
fn the_index_has_every_page_once_and_keeps_the_lab_apart() {
    let mut pages = pages();
    let contents = pages.remove("SUMMARY.md").unwrap();
    let index = index(&contents);
    for (part, page) in &index {
        let (in_lab, of_lab) = (part.starts_with("Lab: "), page.starts_with("lab/"));
        assert_eq!(in_lab, of_lab, "{page} is listed under {part}");
    }
    let listed: Vec<_> = index.into_iter().map(|(_, page)| page).collect();
    let mut sorted = listed.clone();
    sorted.sort();
    assert_eq!(sorted, Vec::from_iter(pages.keys().cloned()));
}

/// What a user reads: so many pages at most, so many words together. Measurements and reasons are for the lab.
const USER_PAGES: usize = 30;
const USER_WORDS: usize = 35_000;

#[test]
fn what_a_user_reads_is_short() {
    let mut pages = pages();
    pages.remove("SUMMARY.md");
    pages.retain(|name, _| !name.starts_with("lab/"));
    assert!(pages.len() <= USER_PAGES, "{} pages", pages.len());
    let words = |text: &String| text.split_whitespace().count();
    let mut counts: Vec<_> = pages
        .iter()
        .map(|(name, text)| (words(text), name))
        .collect();
    counts.sort();
    let all: usize = counts.iter().map(|(count, _)| count).sum();
    assert!(all <= USER_WORDS, "{all} words: {counts:?}");
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    assert!(readme.lines().count() <= 90 && words(&readme) <= 650);
}

/// Targets of the links of a page that lie in the repository.
fn links(text: &str) -> Vec<&str> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target)
        .filter(|target| !target.contains("://") && !target.contains(char::is_whitespace))
        .collect()
}

/// What links call the headings of a page: lower-case, without punctuation, hyphens for spaces.
fn anchors(page: &Path) -> Vec<String> {
    fs::read_to_string(page)
        .unwrap_or_default()
        .lines()
        .filter(|line| line.starts_with('#'))
        .map(|line| {
            let heading = line.trim_start_matches('#').trim().to_lowercase();
            heading
                .chars()
                .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
                .map(|c| if c == ' ' { '-' } else { c })
                .collect()
        })
        .collect()
}
