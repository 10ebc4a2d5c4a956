//! Results read back from their JSON.

use serde::{Deserialize, de::DeserializeOwned};
use std::path::Path;
use undrift_io::ReadError;
use undrift_results::{Results, SCHEMA};

/// What every result begins with.
#[derive(Deserialize)]
struct Head {
    #[expect(dead_code, reason = "without it, this is not a result")]
    undrift: String,
    kind: String,
    #[serde(default)]
    schema: u32,
}

/// Reads a result; `path` is for messages.
///
/// # Errors
/// A text that is no result, or that of a later version, with line and key.
pub fn read(path: &Path, text: &str) -> Result<Results, ReadError> {
    let head: Head = part(path, text)?;
    if head.schema > SCHEMA {
        let problem = format!("schema {} is from a later version of undrift", head.schema);
        return Err(ReadError::new(path, problem).key("schema"));
    }
    Ok(match head.kind.as_str() {
        "identify" => Results::Identify(part(path, text)?),
        "navigate" => Results::Navigate(part(path, text)?),
        "outages" => Results::Outages(part(path, text)?),
        "montecarlo" => Results::MonteCarlo(part(path, text)?),
        "demo" => Results::Demo(part(path, text)?),
        "fleet" => Results::Fleet(part(path, text)?),
        "tune" => Results::Tune(part(path, text)?),
        other => {
            let why = format!(
                "unknown kind \"{other}\"; known: identify, navigate, outages, montecarlo, demo, fleet, tune"
            );
            return Err(not_a_result(path, &why).key("kind"));
        }
    })
}

fn not_a_result(path: &Path, why: &str) -> ReadError {
    ReadError::new(path, format!("not a result of undrift: {why}"))
}

fn part<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ReadError> {
    serde_json::from_str(text).map_err(|error| {
        let full = error.to_string();
        if !text.trim_start().starts_with('{') {
            return not_a_result(path, "not JSON; give a file that --json wrote");
        }
        // The line is part of the error itself.
        let why = full.split(" at line ").next().unwrap_or(&full);
        let failed = not_a_result(path, why).at(error.line() as u64);
        match key_at(text, error.line(), error.column()) {
            key if key.is_empty() => failed,
            key => failed.key(key.as_str()),
        }
    })
}

/// One part of the path to a place in JSON.
enum Part {
    Key(String),
    Index(usize),
}

/// Where in JSON a place is, by line and column \[bytes\], both from 1: `drift[2].ratio`. A deserialiser that keeps track of it
/// makes a third of the crate's code.
fn key_at(text: &str, line: usize, column: usize) -> String {
    let lines = text.split_inclusive('\n').take(line.saturating_sub(1));
    let before: usize = lines.map(str::len).sum();
    let mut bytes = text.bytes().take(before + column);
    let mut path = Vec::new();
    let mut word = Vec::new();
    while let Some(byte) = bytes.next() {
        match (byte, path.last_mut()) {
            (b'"', _) => {
                word.clear();
                while let Some(byte) = bytes.next().filter(|byte| *byte != b'"') {
                    word.push(byte);
                    if byte == b'\\' {
                        word.extend(bytes.next());
                    }
                }
            }
            (b'{', _) => path.push(Part::Key(String::new())),
            (b'[', _) => path.push(Part::Index(0)),
            (b'}' | b']', _) => drop(path.pop()),
            (b':', Some(Part::Key(key))) => *key = String::from_utf8_lossy(&word).into_owned(),
            (b',', Some(Part::Index(index))) => *index += 1,
            _ => {}
        }
    }
    let mut place = String::new();
    for step in path {
        match step {
            Part::Index(index) => place += &format!("[{index}]"),
            Part::Key(key) if place.is_empty() || key.is_empty() => place += &key,
            Part::Key(key) => place += &format!(".{key}"),
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_has_a_key() {
        let text = "{\n  \"a\": {\"b\\\"]\": [1, {\"c\": true}, \"x\"]},\n  \"d\": 5\n}\n";
        let at = |line, what: &str| {
            let column = text.lines().nth(line - 1).unwrap().find(what).unwrap();
            key_at(text, line, column + what.len())
        };
        assert_eq!(at(2, "[1"), "a.b\\\"][0]");
        assert_eq!(at(2, "true"), "a.b\\\"][1].c");
        assert_eq!(at(2, "}"), "a.b\\\"][1]");
        assert_eq!(at(2, "]}"), "a");
        assert_eq!(at(3, "5"), "d");
        assert_eq!(at(4, "}"), "");
    }
    /// What a text is refused for.
    fn refused(text: &str) -> String {
        read(Path::new("a.json"), text).unwrap_err().to_string()
    }

    #[test]
    fn a_text_that_is_no_result_says_where_and_why() {
        let head = r#""undrift": "1", "kind": "#;
        assert_eq!(
            refused("a,b\n1,2\n"),
            "a.json: not a result of undrift: not JSON; give a file that --json wrote"
        );
        assert_eq!(
            refused(&format!("{{{head}\"plot\"}}")),
            "a.json: not a result of undrift: unknown kind \"plot\"; known: identify, navigate, outages, montecarlo, demo, fleet, tune (key kind)"
        );
        assert_eq!(
            refused(&format!("{{{head}\"tune\", \"schema\": 4000000}}")),
            "a.json: schema 4000000 is from a later version of undrift (key schema)"
        );
        let inside = refused(&format!("{{{head}\"tune\",\n \"windows\": -1}}"));
        assert!(
            inside.starts_with("a.json line 2: not a result of undrift: invalid value")
                && inside.ends_with("(key windows)"),
            "{inside}"
        );
        // Beyond the result there is no key.
        let after = refused(&format!("{{{head}\"tune\"}}\n x"));
        assert_eq!(
            after,
            "a.json line 2: not a result of undrift: trailing characters"
        );
        // Whatever comes after the name of a program is a result by its kind.
        let kinds = [
            "identify",
            "navigate",
            "outages",
            "montecarlo",
            "demo",
            "fleet",
            "tune",
        ];
        for kind in kinds {
            let result = read(Path::new(""), &format!("{{{head}\"{kind}\"}}")).unwrap();
            assert_eq!(result.version(), "1", "{kind}");
        }
    }
}
