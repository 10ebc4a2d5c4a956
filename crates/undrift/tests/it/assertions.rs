//! Every test can fail: its body, or a function of the tests that it calls, asserts something.
//!
//! What counts is an `assert…!`, `prop_assert…!`, `panic!` or `unreachable!`, an error that is demanded (`unwrap_err`,
//! `expect_err`), clap's `debug_assert()` and `#[should_panic]`. An `unwrap`, an `expect` or a `?` by itself does not:
//! it says that the program came to an end, not what it found. Nor does what the product asserts.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

/// A source with the insides of comments and literals blanked, of the same length.
fn code(source: &str) -> String {
    let bytes = source.as_bytes();
    let mut out = bytes.to_vec();
    let blank = |out: &mut Vec<u8>, range: Range<usize>| {
        for byte in &mut out[range] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
    };
    let is_name = |at: usize| bytes[at].is_ascii_alphanumeric() || bytes[at] == b'_';
    let mut at = 0;
    while at < bytes.len() {
        let rest = &bytes[at..];
        let fresh = at == 0 || !is_name(at - 1);
        let hashes = |from: usize| rest[from..].iter().take_while(|b| **b == b'#').count();
        let raw = match rest {
            [b'r', ..] if fresh => Some(1),
            [b'b' | b'c', b'r', ..] if fresh => Some(2),
            _ => None,
        };
        let raw = raw.filter(|&prefix| rest.get(prefix + hashes(prefix)) == Some(&b'"'));
        let end = match (rest, raw) {
            (_, Some(prefix)) => {
                let count = hashes(prefix);
                let close = format!("\"{}", "#".repeat(count));
                let begin = prefix + count + 1;
                let length = source[at + begin..].find(&close);
                at + begin + length.map_or(0, |length| length + close.len())
            }
            ([b'/', b'/', ..], _) => {
                at + rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len())
            }
            ([b'/', b'*', ..], _) => at + source[at..].find("*/").map_or(rest.len(), |end| end + 2),
            ([b'"', ..], _) => {
                let mut end = at + 1;
                while bytes.get(end).is_some_and(|b| *b != b'"') {
                    end += if bytes[end] == b'\\' { 2 } else { 1 };
                }
                end + 1
            }
            ([b'\'', b'\\', ..], _) => {
                at + 3 + rest[3..].iter().position(|b| *b == b'\'').unwrap_or(0) + 1
            }
            ([b'\'', ..], _) => {
                // A character, or else a lifetime.
                let letter = source[at + 1..].chars().next().map_or(1, char::len_utf8);
                if rest.get(1 + letter) == Some(&b'\'') {
                    at + 2 + letter
                } else {
                    at
                }
            }
            _ => at,
        };
        let end = end.min(bytes.len());
        blank(&mut out, at..end);
        at = end.max(at + 1);
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Where the bracket that opens at `open` closes.
fn closes(code: &str, open: usize) -> usize {
    let mut depth = 0;
    for (at, byte) in code.bytes().enumerate().skip(open) {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at;
        }
    }
    code.len() - 1
}

/// The places of a word.
fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word)
        .map(|(at, _)| at)
        .filter(move |&at| {
            !code[..at].ends_with(is_name) && !code[at + word.len()..].starts_with(is_name)
        })
}

/// The name at the start of a text.
fn name(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_'));
    &text[..end.unwrap_or(text.len())]
}

/// The braces of the item whose signature begins at `from`; `None` of one that has no body.
fn body(code: &str, from: usize) -> Option<Range<usize>> {
    let mut at = from;
    while at < code.len() {
        match code.as_bytes()[at] {
            b'(' | b'[' => at = closes(code, at),
            b'{' => return Some(at..closes(code, at) + 1),
            b';' => return None,
            _ => {}
        }
        at += 1;
    }
    None
}

/// A function of the tests.
#[derive(Clone, Debug)]
struct Function {
    file: PathBuf,
    line: usize,
    name: String,
    /// Type of the `impl` that it is in.
    of: Option<String>,
    is_test: bool,
    /// Whether it asserts by itself.
    asserts: bool,
    /// What it calls: type or module before `::`, if any, or "." of a method, and name.
    calls: BTreeSet<(String, String)>,
}

/// What fails by being reached or by being wrong.
fn asserts(code: &str) -> bool {
    let macros = code.match_indices('!').any(|(at, _)| {
        let start = code[..at].rfind(|c: char| !(c.is_alphanumeric() || c == '_'));
        let name = &code[start.map_or(0, |start| start + 1)..at];
        let begins = ["assert", "prop_assert", "debug_assert"];
        begins.iter().any(|begin| name.starts_with(begin))
            || ["panic", "unreachable"].contains(&name)
    });
    let called = ["unwrap_err", "expect_err", "debug_assert"];
    macros || called.iter().any(|word| words(code, word).next().is_some())
}

/// What a body calls.
fn calls(code: &str) -> BTreeSet<(String, String)> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices('(') {
        let mut before = &code[..at];
        // Of `f::<T>(`, the name before the types.
        if before.ends_with('>')
            && let Some(open) = before.rfind("::<")
        {
            before = &before[..open];
        }
        let start = before.trim_end_matches(is_name).len();
        let called = &before[start..];
        if called.is_empty() {
            continue;
        }
        let head = before[..start].trim_end();
        let of = match head.strip_suffix("::") {
            Some(path) => {
                let path = path.trim_end_matches('>');
                let start = path.trim_end_matches(is_name).len();
                &path[start..]
            }
            None if head.ends_with('.') => ".",
            None => "",
        };
        found.insert((of.to_owned(), called.to_owned()));
    }
    found
}

/// The functions of a source inside of `tests`.
fn functions(file: &Path, code: &str, tests: &[Range<usize>]) -> Vec<Function> {
    let mut impls = Vec::new();
    for keyword in ["impl", "trait"] {
        for at in words(code, keyword) {
            let Some(braces) = body(code, at) else {
                continue;
            };
            let head = &code[at + keyword.len()..braces.start];
            // Generics in front are no type.
            let head = match head.strip_prefix('<') {
                Some(rest) => rest.split_once("> ").map_or(rest, |(_, rest)| rest),
                None => head,
            };
            let head = head.rsplit(" for ").next().unwrap_or(head).trim();
            let path = head.split(['<', ' ']).next().unwrap_or(head);
            impls.push((braces, path.rsplit("::").next().unwrap_or(path).to_owned()));
        }
    }
    let mut found = Vec::new();
    for at in words(code, "fn") {
        let name = name(code[at + 2..].trim_start());
        let Some(braces) = body(code, at) else {
            continue;
        };
        if name.is_empty() || !tests.iter().any(|range| range.contains(&at)) {
            continue;
        }
        let head = code[..at].rfind([';', '{', '}']).map_or(0, |end| end + 1);
        let head = &code[head..at];
        let inside = &code[braces.clone()];
        let of = impls.iter().filter(|(range, _)| range.contains(&at));
        let of = of.min_by_key(|(range, _)| range.len());
        found.push(Function {
            file: file.to_owned(),
            line: code[..at].matches('\n').count() + 1,
            name: name.to_owned(),
            of: of.map(|(_, of)| of.clone()),
            is_test: head.contains("#[test]"),
            asserts: asserts(inside) || head.contains("#[should_panic"),
            calls: calls(inside),
        });
    }
    found
}

/// Tests in which nothing can fail.
fn empty(all: &[Function]) -> Vec<&Function> {
    let mut by_name: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (at, function) in all.iter().enumerate() {
        by_name.entry(&function.name).or_default().push(at);
    }
    let called = |from: &Function, (of, name): &(String, String)| -> Vec<usize> {
        let is_type = of.starts_with(|c: char| c.is_uppercase());
        let of = if of == "Self" {
            from.of.clone().unwrap_or_default()
        } else {
            of.clone()
        };
        let fits = |at: &&usize| match all[**at].of.as_deref() {
            Some(own) => of == "." || of == own,
            None => of != "." && !is_type,
        };
        let fitting = by_name.get(name.as_str()).into_iter().flatten();
        let fitting: Vec<usize> = fitting.filter(fits).copied().collect();
        // One of the same file hides those of others.
        let near: Vec<usize> = fitting
            .iter()
            .copied()
            .filter(|at| all[*at].file == from.file)
            .collect();
        if near.is_empty() { fitting } else { near }
    };
    let mut can: Vec<bool> = all.iter().map(|function| function.asserts).collect();
    loop {
        let next: Vec<bool> = all
            .iter()
            .zip(&can)
            .map(|(function, can_now)| {
                *can_now
                    || function
                        .calls
                        .iter()
                        .any(|call| called(function, call).iter().any(|at| can[*at]))
            })
            .collect();
        if next == can {
            break;
        }
        can = next;
    }
    let tests = all.iter().zip(can);
    tests
        .filter(|(function, can)| function.is_test && !can)
        .map(|(function, _)| function)
        .collect()
}

/// All sources below a folder.
fn sources(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            all.push(path);
        }
    }
}

/// The functions of the tests among sources, which are those of a crate in `folder`: what is in a folder `tests`, in a
/// module for tests alone, or is a test itself.
fn of_sources(folder: &Path, sources: &[(PathBuf, String)]) -> Vec<Function> {
    let mut whole = vec![folder.join("tests")];
    let mut ranges: Vec<Vec<Range<usize>>> = Vec::new();
    for (path, code) in sources {
        let mut own = Vec::new();
        for (at, attribute) in code.match_indices("#[cfg(test)]") {
            let start = at + attribute.len();
            if let Some(braces) = body(code, start) {
                own.push(at..braces.end);
            } else if let Some(module) = words(&code[start..], "mod").next() {
                // In a file of its own.
                let name = name(code[start + module + 3..].trim_start());
                let inside = match path.file_stem().and_then(|stem| stem.to_str()) {
                    Some("lib" | "main" | "mod") => path.with_file_name(name),
                    _ => path.with_extension("").join(name),
                };
                whole.push(inside);
            }
        }
        for (at, attribute) in code.match_indices("#[test]") {
            own.extend(body(code, at + attribute.len()).map(|braces| at..braces.end));
        }
        ranges.push(own);
    }
    let mut all = Vec::new();
    for ((path, code), mut own) in sources.iter().zip(ranges) {
        let module = path.with_extension("");
        if whole.iter().any(|whole| module.starts_with(whole)) {
            own.push(0..code.len());
        }
        all.extend(functions(path, code, &own));
    }
    all
}

#[test]
fn every_test_asserts_something() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let crates = fs::read_dir(root.join("crates")).unwrap();
    let mut folders: Vec<PathBuf> = crates.map(|entry| entry.unwrap().path()).collect();
    folders.extend(["fuzz", "tools/lab", "embedded"].map(|folder| root.join(folder)));
    let (mut tests, mut found) = (0, Vec::new());
    for folder in folders {
        let mut files = Vec::new();
        for part in ["src", "tests", "targets"].map(|part| folder.join(part)) {
            if part.is_dir() {
                sources(&part, &mut files);
            }
        }
        let read = |path: PathBuf| {
            let text = code(&fs::read_to_string(&path).unwrap());
            (path, text)
        };
        let all = of_sources(&folder, &files.into_iter().map(read).collect::<Vec<_>>());
        tests += all.iter().filter(|function| function.is_test).count();
        for test in empty(&all) {
            let file = test.file.strip_prefix(&root).unwrap();
            found.push(format!("{}:{}: {}", file.display(), test.line, test.name));
        }
    }
    assert!(tests > 1000, "{tests} tests are seen");
    assert!(
        found.is_empty(),
        "nothing can fail in\n{}",
        found.join("\n")
    );
}

#[test]
fn a_test_that_asserts_nothing_is_seen() {
    let product = r##"
        pub fn checked(x: f64) -> f64 { assert!(x > 0.0); x }
        #[cfg(test)]
        mod tests {
            #[test] fn direct() { let open = '{'; assert_eq!(open, '{'); }
            #[test] fn by_a_helper() { for _ in 0..3 { outer::<3>(2) } }
            #[test] fn by_a_method() { Log::new().says("}"); }
            #[test] #[should_panic(expected = "no")] fn by_panicking() { super::checked(-1.0); }
            #[test] fn by_an_error() -> Result<(), Error> { read("x")?.unwrap_err(); Ok(()) }
            fn outer<const N: usize>(x: i32) { inner(x) }
            fn inner(x: i32) { if x > 2 { panic!("{x}") } }
            impl<'a, T: Of<'a>> Log<T> { fn says(&self, what: &str) { let _ = what; } fn new() -> Self { Self } }
            impl Drop for Log<u8> { fn drop(&mut self) { assert!(self.0.is_empty()) } }
            // fn silent() { assert!(true) }
            #[test] fn by_the_product_alone() { super::checked(1.0); }
            #[test] fn in_a_literal() { println!("assert!(x) {}", r#"panic!("}")"#); /* assert!(x) */ }
            #[test] fn by_unwrapping() { read("x").unwrap(); read("y").expect("a file"); }
        }
        #[cfg(test)] mod more;
    "##;
    let more = r#"
        proptest! {
            #![proptest_config(ProptestConfig { cases: 3, ..ProptestConfig::default() })]
            #[test] fn of_a_property(x in 0..3, (a, b) in pairs()) { prop_assert!(x < 3); }
            #[test] fn of_nothing(x in 0..3) { let _ = read(x)?; }
        }
        #[test] fn by_a_helper_of_another_file() { super::tests::inner(3) }
    "#;
    let files = [("a/src/b.rs", product), ("a/src/b/more.rs", more)];
    let files = files.map(|(path, text)| (PathBuf::from(path), code(text)));
    let all = of_sources(Path::new("a"), &files);
    let found: Vec<&str> = empty(&all).iter().map(|test| test.name.as_str()).collect();
    let expected = [
        "by_a_method",
        "by_the_product_alone",
        "in_a_literal",
        "by_unwrapping",
        "of_nothing",
    ];
    assert_eq!(found, expected);
    assert_eq!(all.iter().filter(|function| function.is_test).count(), 11);
}
