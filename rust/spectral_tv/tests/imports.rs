//! No file of the crate imports one that imports it, over however many others.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Each module by its path, `a::b`, with the text of its file, without comments and tests.
type Modules = BTreeMap<String, String>;

fn read(folder: &Path, module: &str, modules: &mut Modules) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_string();
        let child = match (module, &*stem) {
            (_, "mod") => module.to_string(),
            ("", stem) => stem.to_string(),
            (module, stem) => format!("{module}::{stem}"),
        };
        if path.is_dir() {
            read(&path, &child, modules);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
            let lines = text.lines().map(|line| line.split("//").next().unwrap());
            modules.insert(child, lines.collect::<Vec<_>>().join("\n"));
        }
    }
}

/// The paths that a declaration names: `a::{b, c::d}` names `a::b` and `a::c::d`.
fn expanded(path: &str) -> Vec<String> {
    let path: String = path.split_whitespace().collect();
    let Some((prefix, group)) = path.split_once('{') else {
        return vec![path];
    };
    let mut paths = Vec::new();
    let (mut depth, mut part) = (0, String::new());
    for character in group.strip_suffix('}').unwrap().chars().chain([',']) {
        match character {
            ',' if depth == 0 => {
                let part = std::mem::take(&mut part);
                let parts = expanded(&part).into_iter().filter(|part| !part.is_empty());
                paths.extend(parts.map(|part| format!("{prefix}{part}")));
                continue;
            }
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        part.push(character);
    }
    paths
}

/// Full paths of what a module imports, or of what it hands on with `pub use`.
fn imported(module: &str, modules: &Modules, hands_on: bool) -> Vec<String> {
    let declarations = modules[module].split(';').filter_map(|statement| {
        let start = statement.rfind("use ").filter(|&start| {
            let before = statement[..start].chars().next_back();
            before.is_none_or(char::is_whitespace)
        })?;
        let line = statement[..start].rsplit('\n').next().unwrap().trim();
        (line.starts_with("pub") == hands_on).then(|| &statement[start + 4..])
    });
    declarations
        .flat_map(expanded)
        .map(|path| full(module, &path))
        .collect()
}

/// Full paths that a module names where it uses them, without an import.
fn named_in_place(module: &str, text: &str) -> Vec<String> {
    let starts = ["crate::", "super::"].into_iter();
    let places = starts.flat_map(|start| text.match_indices(start));
    let is_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let paths = places.map(|(place, _)| text[place..].split(|c| !is_of_path(c)).next().unwrap());
    // Those that end in colons are imports of several.
    let paths = paths.filter(|path| !path.ends_with(':'));
    paths.map(|path| full(module, path)).collect()
}

/// The path from the crate's root of what `module` calls `path`.
fn full(module: &str, path: &str) -> String {
    match path.split_once("::") {
        Some(("crate", rest)) => rest.to_string(),
        Some(("super", rest)) => {
            let parent = module.rsplit_once("::").map_or("", |parts| parts.0);
            format!("{parent}::{rest}").trim_start_matches("::").into()
        }
        _ => format!("{module}::{path}"),
    }
}

/// The module whose file has what a path names, also where others hand it on.
fn home(path: &str, modules: &Modules) -> Option<String> {
    let module = path.rmatch_indices("::").map(|(end, _)| &path[..end]);
    let module = [path].into_iter().chain(module);
    let module = module
        .into_iter()
        .find(|path| modules.contains_key(*path))?;
    let rest = path[module.len()..].trim_start_matches("::");
    let handed_on = imported(module, modules, true).into_iter();
    let mut origin = handed_on.filter(|origin| {
        !rest.is_empty() && origin.ends_with(&format!("::{rest}")) && origin != path
    });
    match origin.next() {
        Some(origin) => home(&origin, modules),
        None => Some(module.to_string()),
    }
}

#[test]
fn no_file_imports_one_that_imports_it() {
    let mut modules = Modules::new();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    read(&source, "", &mut modules);
    assert!(modules.len() > 100);
    let imports = |module: &String| -> BTreeSet<String> {
        let paths = imported(module, &modules, false).into_iter();
        let paths = paths.chain(named_in_place(module, &modules[module]));
        let homes = paths.filter_map(|path| home(&path, &modules));
        homes.filter(|home| home != module).collect()
    };
    let mut rest: BTreeMap<_, _> = modules.keys().map(|m| (m.clone(), imports(m))).collect();
    assert!(rest.values().map(BTreeSet::len).sum::<usize>() > 300);
    // What imports nothing of the rest, or what nothing of it imports, is no part of a circle.
    loop {
        let before = rest.len();
        let known: BTreeSet<_> = rest.keys().cloned().collect();
        let used: BTreeSet<_> = rest.values().flatten().cloned().collect();
        rest.retain(|module, imports| used.contains(module) && !imports.is_disjoint(&known));
        if rest.len() == before {
            break;
        }
    }
    assert!(rest.is_empty(), "these import one another: {rest:#?}");
}

#[test]
fn paths_are_found_where_they_are_used() {
    let text = "use crate::a::{b, c};\nlet d = super::e::F::new(crate::g::h);";
    assert_eq!(named_in_place("x::y", text), ["g::h", "x::e::F::new"]);
}

#[test]
fn declarations_are_expanded() {
    let paths = expanded("crate::a::{b, c::{D, e}, f}");
    assert_eq!(
        paths,
        [
            "crate::a::b",
            "crate::a::c::D",
            "crate::a::c::e",
            "crate::a::f"
        ]
    );
}
