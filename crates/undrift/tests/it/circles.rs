//! Files of a crate that need each other in a circle: none, and no folders either, each taken with all that is in it. A
//! module and what is inside it are one.

use super::architecture::{product, sources};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

type Module = Vec<String>;

/// The code of a crate by modules.
fn modules(folder: &Path) -> BTreeMap<Module, String> {
    let mut files = Vec::new();
    sources(folder, &mut files);
    let module = |path: &Path| -> Module {
        let inside = path.strip_prefix(folder).unwrap().with_extension("");
        let names = inside.iter().map(|name| name.to_str().unwrap().to_owned());
        names
            .filter(|name| name != "lib" && name != "main")
            .collect()
    };
    let read = |path: &Path| product(&std::fs::read_to_string(path).unwrap());
    files
        .iter()
        .map(|path| (module(path), read(path)))
        .collect()
}

/// The paths of a `use` item, its groups taken apart.
fn spread(tree: &str, before: &str, all: &mut Vec<String>) {
    let Some((head, group)) = tree.split_once('{') else {
        all.push(format!("{before}{}", tree.trim()));
        return;
    };
    let group = group.trim_end().strip_suffix('}').unwrap_or(group);
    let before = format!("{before}{}", head.trim());
    let (mut depth, mut start) = (0, 0);
    for (at, letter) in group.char_indices().chain([(group.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                spread(&group[start..at], &before, all);
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// The paths that code uses: of its `use` items, and those that begin at the crate or near.
fn paths(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    let (mut rest, mut item) = (String::new(), String::new());
    for line in code.lines() {
        let begun = line.trim_start().split_once("use ");
        match begun.filter(|(before, _)| before.is_empty() || before.starts_with("pub")) {
            Some((_, tree)) if item.is_empty() => item = tree.to_owned(),
            _ if item.is_empty() => rest = rest + line + "\n",
            _ => item += line,
        }
        if let Some((tree, _)) = item.split_once(';') {
            spread(tree, "", &mut found);
            item.clear();
        }
    }
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in rest.match_indices(start) {
            let end = rest[at..].find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            found.push(rest[at..][..end.unwrap_or(rest.len() - at)].to_owned());
        }
    }
    found
}

/// The module of a crate that a path in `here` leads to, if it is not one of another crate.
fn leads(path: &str, here: &Module, all: &BTreeMap<Module, String>) -> Option<Module> {
    let mut names = path.split("::").map(str::trim).peekable();
    let mut at = here.clone();
    match *names.peek()? {
        "crate" => at.clear(),
        "self" | "super" => {}
        name => {
            at.push(name.to_owned());
            all.contains_key(&at).then_some(())?;
            at.pop();
        }
    }
    for name in names {
        match name {
            "crate" | "self" => {}
            "super" => drop(at.pop()),
            name => at.push(name.to_owned()),
        }
    }
    while !all.contains_key(&at) {
        at.pop()?;
    }
    Some(at)
}

/// Which module needs which other.
fn arrows(all: &BTreeMap<Module, String>) -> BTreeSet<(Module, Module)> {
    let mut arrows = BTreeSet::new();
    for (here, code) in all {
        for path in paths(code) {
            if let Some(there) = leads(&path, here, all)
                && !here.starts_with(&there)
                && !there.starts_with(here)
            {
                arrows.insert((here.clone(), there));
            }
        }
    }
    arrows
}

/// The same between what two modules are in beside each other: folders with all that is in them, or files.
fn between_folders(arrows: &BTreeSet<(Module, Module)>) -> BTreeSet<(Module, Module)> {
    let beside = |(from, to): &(Module, Module)| {
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        (from[..=common].to_vec(), to[..=common].to_vec())
    };
    arrows.iter().map(beside).collect()
}

/// What is left of the arrows when all that lead out of every circle, or into none, are taken away.
fn circles(mut arrows: BTreeSet<(Module, Module)>) -> BTreeSet<(Module, Module)> {
    loop {
        let ends: [BTreeSet<Module>; 2] = [
            arrows.iter().map(|(from, _)| from.clone()).collect(),
            arrows.iter().map(|(_, to)| to.clone()).collect(),
        ];
        let before = arrows.len();
        arrows.retain(|(from, to)| ends[0].contains(to) && ends[1].contains(from));
        if arrows.len() == before {
            return arrows;
        }
    }
}

#[test]
fn neither_files_nor_folders_need_each_other_in_a_circle() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for entry in std::fs::read_dir(crates).unwrap() {
        let folder = entry.unwrap().path().join("src");
        if folder.is_dir() {
            let arrows = arrows(&modules(&folder));
            for found in [circles(between_folders(&arrows)), circles(arrows)] {
                assert!(found.is_empty(), "{}: {found:#?}", folder.display());
            }
        }
    }
}

#[test]
fn a_circle_is_seen() {
    let code = [
        ("a", "use super::{b::{self, Of}, d};\nfn f() {}"),
        ("b", "fn g() { crate::c::Other::new() }"),
        ("c", "use crate::a;"),
        ("d", "use std::path;"),
    ];
    let all: BTreeMap<Module, String> = code
        .map(|(name, code)| (vec![name.to_owned()], code.to_owned()))
        .into();
    let found = circles(arrows(&all));
    let names: Vec<_> = found
        .iter()
        .map(|(from, to)| (&from[0][..], &to[0][..]))
        .collect();
    assert_eq!(names, [("a", "b"), ("b", "c"), ("c", "a")]);
    let without = all.into_iter().filter(|(name, _)| name[0] != "c").collect();
    assert!(circles(arrows(&without)).is_empty());
}

#[test]
fn a_circle_of_folders_is_seen() {
    let code = [
        ("a/one", "use crate::b::Other;"),
        ("a/two", ""),
        ("b", ""),
        ("b/deep/three", "use crate::a::two::f;"),
    ];
    let all: BTreeMap<Module, String> = code
        .map(|(path, code)| {
            (
                path.split('/').map(str::to_owned).collect(),
                code.to_owned(),
            )
        })
        .into();
    let arrows = arrows(&all);
    assert!(circles(arrows.clone()).is_empty());
    let found = circles(between_folders(&arrows));
    let names: Vec<_> = found
        .iter()
        .map(|(from, to)| (&from[..], &to[..]))
        .collect();
    let [a, b] = ["a", "b"].map(|name| vec![name.to_owned()]);
    assert_eq!(names, [(&a[..], &b[..]), (&b[..], &a[..])]);
}
