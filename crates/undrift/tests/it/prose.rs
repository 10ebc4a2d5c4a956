//! Sentences for users are made above the engine: its sources hold none outside of errors. Comments and pages
//! do without the idioms of [`IDIOMS`].

use std::{fs, path::Path};

/// Files that may hold sentences, with the reason.
const ALLOWED: [(&str, &str); 30] = [
    (
        "noise/src/model_file/kalibr.rs",
        "messages of ModelError, with file, line and key; text of a model file",
    ),
    ("experiments/src/demo/models.rs", "names of models"),
    (
        "drive/src/drive",
        "messages of ConfigError, with file, line and key",
    ),
    (
        "events/src/aid.rs",
        "what the schema of results says of a field",
    ),
    (
        "fleet/src/manifest",
        "messages of ConfigError, with file, line and key",
    ),
    (
        "fleet/src/outcome.rs",
        "messages of ConfigError, with file, line and key",
    ),
    (
        "fleet/src/summary",
        "what each measure is, stored in fleet.json",
    ),
    (
        "drive/src/identify.rs",
        "where a model comes from, stored in the model file",
    ),
    (
        "experiments/src/montecarlo/spec.rs",
        "messages of ConfigError, with file, line and key",
    ),
    (
        "drive/src/record.rs",
        "messages of ReadError, with file and option",
    ),
    (
        "drive/src/record/columns.rs",
        "messages of ReadError, with file and option",
    ),
    (
        "drive/src/record/guess.rs",
        "messages of ReadError, with file and option",
    ),
    ("results/src/demo.rs", "names of models"),
    ("results/src/drive.rs", "a value of gnss_use"),
    (
        "tune/src/lib.rs",
        "where a model comes from, stored in the model file",
    ),
    (
        "tune/src/file.rs",
        "a comment of the drive file that is written",
    ),
    ("tune/src/rest_noise.rs", "the name of a model"),
    (
        "drive/src/findings/tuned.rs",
        "where a model comes from, stored in the model file",
    ),
    ("results/src/usability.rs", "names of verdicts"),
    ("simulate/src/gnss.rs", "messages of SimulationError"),
    (
        "experiments/src/demo/result.rs",
        "the name of a simulated recording",
    ),
    ("noise/src/temperature.rs", "the name of a noise"),
    ("noise/src/compared.rs", "names of candidates"),
    (
        "noise/src/identify/candidates/recipe.rs",
        "names of candidates",
    ),
    ("noise/src/compared/power_spectrum.rs", "a message of Unfit"),
    ("noise/src/presets.rs", "messages of ModelError"),
    ("noise/src/model_file/read.rs", "messages of ModelError"),
    (
        "noise/src/model_file/reason.rs",
        "why a model was chosen, stored in the model file",
    ),
    (
        "noise/src/export/comments.rs",
        "comments in files of other programs",
    ),
    (
        "noise/src/export/formats.rs",
        "comments in files of other programs",
    ),
];

/// Literals of this many words are a sentence.
const WORDS: usize = 3;

/// What precedes a literal that no user reads, or that an error says.
const BEFORE: [&str; 9] = [
    ".expect(",
    "panic!(",
    "unreachable!(",
    "debug_assert!(",
    "RecordError::Argument(",
    "ArmaError::BadOption(",
    "ShapingError::BadParameter(",
    "Failure::Missing(",
    "needs:",
];

/// The string literals of a source with their lines, without those of attributes, comments and tests.
fn literals(source: &str) -> Vec<(usize, String)> {
    let source = source.split("#[cfg(test)]").next().unwrap_or_default();
    let bytes = source.as_bytes();
    let mut found = Vec::new();
    let (mut at, mut attribute) = (0, 0usize);
    while at < bytes.len() {
        let rest = &source.as_bytes()[at..];
        match rest {
            [b'/', b'/', ..] => at += rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len()),
            [b'\'', b'\\', _, ..] => {
                at += 3 + rest[3..].iter().position(|b| *b == b'\'').unwrap() + 1
            }
            [b'\'', _, b'\'', ..] => at += 3,
            [b'#', b'[', ..] if attribute == 0 => (at, attribute) = (at + 2, 1),
            [b'[', ..] if attribute > 0 => (at, attribute) = (at + 1, attribute + 1),
            [b']', ..] if attribute > 0 => (at, attribute) = (at + 1, attribute - 1),
            [b'"', ..] => {
                let mut end = at + 1;
                while bytes[end] != b'"' {
                    end += if bytes[end] == b'\\' { 2 } else { 1 };
                }
                let before = source[..at].trim_end();
                if attribute == 0 && !BEFORE.iter().any(|word| before.ends_with(word)) {
                    let line = source[..at].matches('\n').count() + 1;
                    found.push((line, source[at + 1..end].to_owned()));
                }
                at = end + 1;
            }
            _ => at += 1,
        }
    }
    found
}

/// How many words of plain letters it has, placeholders aside.
fn words(literal: &str) -> usize {
    let mut text = String::new();
    let mut depth = 0;
    for c in literal.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ if depth == 0 => text.push(c),
            _ => {}
        }
    }
    let is_word = |word: &&str| {
        let word = word.trim_matches(|c: char| c.is_ascii_punctuation());
        word.len() > 1 && word.chars().all(|c| c.is_alphabetic() || c == '\'')
    };
    text.split_whitespace().filter(is_word).count()
}

/// Whether a file is this one, or belongs to the module of this name.
fn is_in(file: &str, allowed: &str) -> bool {
    let rest = file.strip_prefix(allowed);
    rest.is_some_and(|rest| rest.is_empty() || rest == ".rs" || rest.starts_with('/'))
}

fn visit(folder: &Path, root: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path
            .strip_prefix(root)
            .unwrap()
            .to_string_lossy()
            .into_owned();
        if path.is_dir() {
            visit(&path, root, found);
        } else if name.ends_with(".rs")
            && !name.ends_with("tests.rs")
            && !name.contains("/tests/")
            && !ALLOWED.iter().any(|(allowed, _)| is_in(&name, allowed))
        {
            for (line, literal) in literals(&fs::read_to_string(&path).unwrap()) {
                if words(&literal) >= WORDS {
                    found.push(format!("{name}:{line}: {literal}"));
                }
            }
        }
    }
}

#[test]
fn the_engine_holds_no_prose_for_users() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    for name in [
        "undrift",
        "results",
        "noise",
        "drive",
        "tune",
        "fleet",
        "experiments",
        "events",
        "engine",
        "simulate",
    ] {
        visit(&root.join(name).join("src"), &root, &mut found);
    }
    found.sort();
    for (file, reason) in ALLOWED {
        let path = root.join(file);
        let is_there = path.exists() || path.with_extension("rs").exists();
        assert!(
            is_there && !reason.is_empty(),
            "{file} is allowed and not there"
        );
    }
    assert!(
        found.is_empty(),
        "sentences belong to undrift-report (`say`) or to an error's `#[error(…)]`:\n{}",
        found.join("\n")
    );
}

#[test]
fn what_counts_as_a_sentence() {
    let source = "#[error(\"not this one here\")] // \"nor this one here\"\nx.expect(\"nor this one here\"); 'a' '\"' f(\"but {this one} is a sentence\") \"not a_b c.d\"\n#[cfg(test)] \"nor this one here\"";
    let found: Vec<_> = literals(source)
        .into_iter()
        .filter(|(_, l)| words(l) >= WORDS)
        .collect();
    assert_eq!(found, [(2, "but {this one} is a sentence".to_owned())]);
}

/// Idioms that comments and pages do without: the terms of the field are understood at first reading.
const IDIOMS: [&str; 18] = [
    "is none",
    "are none",
    "tells",
    "told",
    "untold",
    "what became of",
    "bears on",
    "nobody's business",
    "of which nobody",
    "gave way",
    "gives way",
    "stands at",
    "it stands",
    "filter stands",
    "vehicle stands",
    "paper has it",
    "file has it",
    "json has it",
];

/// The idioms in a line, as whole words in any case, without what code holds in backticks.
fn idioms(line: &str) -> Vec<&'static str> {
    let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" _ ");
    let words: Vec<String> = prose
        .split(|c: char| !c.is_alphanumeric() && c != '_' && c != '\'')
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    // "If there is none" is plain English; "a sample of 0 s is none" is not.
    let text = format!(" {} ", words.join(" "));
    let text = text
        .replace(" there is none ", " _ ")
        .replace(" there are none ", " _ ");
    let mut found = IDIOMS.to_vec();
    found.retain(|idiom| text.contains(&format!(" {idiom} ")));
    found
}

/// The comment of a line of Rust, empty if it has none.
fn comment(line: &str) -> &str {
    let start = line.trim_start();
    if start.starts_with("//") {
        return start;
    }
    line.split_once(" // ").map_or("", |(_, comment)| comment)
}

/// The files below a path of the workspace with one ending, with their paths.
fn texts(root: &Path, name: &str, ending: &str, found: &mut Vec<(String, String)>) {
    let path = root.join(name);
    if path.is_dir() {
        for entry in fs::read_dir(&path).unwrap() {
            let inner = entry.unwrap().file_name();
            let inner = format!("{name}/{}", inner.to_string_lossy());
            texts(root, &inner, ending, found);
        }
    } else if name.ends_with(ending) {
        found.push((name.to_owned(), fs::read_to_string(&path).unwrap()));
    }
}

#[test]
fn comments_and_pages_are_in_the_words_of_the_field() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut sources, mut pages) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(root.join("crates")).unwrap() {
        let name = entry.unwrap().file_name();
        let source = format!("crates/{}/src", name.to_string_lossy());
        if root.join(&source).is_dir() {
            texts(&root, &source, ".rs", &mut sources);
        }
    }
    texts(&root, "docs", ".md", &mut pages);
    texts(&root, "README.md", ".md", &mut pages);
    assert!(sources.len() > 100 && !pages.is_empty());
    let mut found = Vec::new();
    let mut look = |files: &[(String, String)], prose: fn(&str) -> &str| {
        for (name, text) in files {
            for (line, n) in text.lines().zip(1..) {
                for idiom in idioms(prose(line)) {
                    found.push(format!("{name}:{n}: {idiom}: {}", line.trim()));
                }
            }
        }
    };
    look(&sources, comment);
    look(&pages, |line| line);
    found.sort();
    assert!(
        found.is_empty(),
        "say it in the terms of the field:\n{}",
        found.join("\n")
    );
}

#[test]
fn what_counts_as_an_idiom() {
    assert_eq!(idioms("/// A row that IS none, or `told`."), ["is none"]);
    assert_eq!(idioms("// `None` if x.is_none(); untold"), ["untold"]);
    assert_eq!(idioms("it is nobody's business"), ["nobody's business"]);
    assert_eq!(
        comment("let told = 1; // What became of it."),
        "What became of it."
    );
    assert_eq!(comment("let told = \"told\";"), "");
}
