//! Tests that modules go in no circle, down to single files.
//!
//! In each folder of a crate the parts are its files and its folders. If one part names an item of another, that part names none of it, not even
//! through a third. A `mod.rs` or `lib.rs` stands over the parts of its folder: it may use them, and they what it declares. What it re-exports
//! counts as an item of the part that declares it. Tests are left out. Methods are not seen, because nothing imports them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::walls::{crates, sources};

/// The path of a module in its crate, such as `["network", "stroke"]`; empty for the crate itself.
type Module = Vec<String>;

/// What the file of a module says of others.
#[derive(Default)]
struct Source {
    /// Imports: the name that each one brings, and its path.
    imports: Vec<(String, Vec<String>)>,
    /// Paths in the code.
    paths: Vec<Vec<String>>,
}

/// What a path leads to: a module, or an item of a module.
#[derive(Clone)]
struct Target {
    module: Module,
    item: Option<String>,
}

/// Imports that are followed already.
type Seen = BTreeSet<(Module, Vec<String>)>;

/// By folder: the parts of each part that names others.
type Arrows = BTreeMap<Module, BTreeMap<String, BTreeSet<String>>>;

/// The modules of a crate.
#[derive(Default)]
struct Sources(BTreeMap<Module, Source>);

impl Sources {
    /// Reads a crate. The library and the program of one folder have one root.
    fn of(folder: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let mut all = Self::default();
        for (path, text) in sources(folder) {
            let inner = path.strip_prefix(&root).unwrap().with_extension("");
            let module: Module = inner.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
            all.add(module, &text);
        }
        all
    }

    /// Adds a file by its path without `.rs`.
    fn add(&mut self, mut module: Module, text: &str) {
        if module.iter().any(|part| part == "tests") {
            return;
        }
        module.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
        let Source { imports, paths } = Source::read(text);
        let source = self.0.entry(module).or_default();
        source.imports.extend(imports);
        source.paths.extend(paths);
    }

    /// What a path in a module leads to. `None` if that is in another crate.
    fn find(&self, at: &[String], path: &[String], seen: &mut Seen) -> Option<Target> {
        let (first, mut rest) = path.split_first()?;
        let whole = |module: Module| Target { module, item: None };
        let mut found = match first.as_str() {
            "crate" => whole(Module::new()),
            "self" | "super" => {
                let steps = path.iter().take_while(|part| ["self", "super"].contains(&part.as_str())).count();
                let above = path[..steps].iter().filter(|part| *part == "super").count();
                rest = &path[steps..];
                whole(at[..at.len().checked_sub(above)?].to_vec())
            }
            name => self.named(at, name, rest, seen)?,
        };
        while let (None, Some((name, after))) = (&found.item, rest.split_first()) {
            found = match self.named(&found.module, name, after, seen) {
                Some(target) => target,
                None if self.imports(&found.module, name).next().is_some() => return None,
                None => Target { item: Some(name.clone()), ..found },
            };
            rest = after;
        }
        Some(found)
    }

    fn imports(&self, at: &[String], name: &str) -> impl Iterator<Item = &Vec<String>> {
        let imports = self.0.get(at).map_or(&[][..], |source| &source.imports[..]);
        imports.iter().filter(move |(brought, _)| brought == name).map(|(_, path)| path)
    }

    /// What a name is that a module imports or that is a module in it. `rest` is what follows the name in its path: a function has nothing
    /// inside, and a module may have the same name.
    fn named(&self, at: &[String], name: &str, rest: &[String], seen: &mut Seen) -> Option<Target> {
        for path in self.imports(at, name) {
            if !seen.insert((at.to_vec(), path.clone())) {
                continue;
            }
            let found = self.find(at, path, seen);
            let leads_on = |target: &Target| {
                target.item.as_ref().is_none_or(|item| rest.is_empty() || item.starts_with(char::is_uppercase))
            };
            if let Some(target) = found.filter(leads_on) {
                return Some(target);
            }
        }
        let below = [at, &[name.to_owned()]].concat();
        self.0.contains_key(&below).then_some(Target { module: below, item: None })
    }

    /// Which part of a folder names items of which.
    fn arrows(&self) -> Arrows {
        let mut arrows = Arrows::new();
        for (at, source) in &self.0 {
            for path in source.imports.iter().map(|(_, path)| path).chain(&source.paths) {
                let all_of = path.strip_suffix(&["*".to_owned()]).and_then(|all| self.find(at, all, &mut Seen::new()));
                assert!(all_of.is_none(), "{at:?}: all names of a module at once cannot be followed: {path:?}");
                let Some(Target { module: to, item: Some(_) }) = self.find(at, path, &mut Seen::new()) else {
                    continue;
                };
                let shared = at.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if let (Some(from), Some(to)) = (at.get(shared), to.get(shared)) {
                    let parts = arrows.entry(at[..shared].to_vec()).or_default();
                    parts.entry(from.clone()).or_default().insert(to.clone());
                }
            }
        }
        arrows
    }
}

impl Source {
    fn read(text: &str) -> Self {
        let words = without_tests(&words(text));
        let mut source = Self::default();
        let mut at = 0;
        while at < words.len() {
            let before = if at == 0 { ";" } else { words[at - 1] };
            if words[at] == "use" && [";", "{", "}", ")", "]", "pub"].contains(&before) {
                at = import(&words, at + 1, &[], &mut source.imports);
            } else if is_name(words[at]) && ![".", "::"].contains(&before) {
                let mut path = vec![words[at].to_owned()];
                while words.get(at + 1) == Some(&"::") && words.get(at + 2).is_some_and(|word| is_name(word)) {
                    at += 2;
                    path.push(words[at].to_owned());
                }
                if path.len() > 1 {
                    source.paths.push(path);
                }
                at += 1;
            } else {
                at += 1;
            }
        }
        source
    }
}

pub(super) fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Reads the tree of an import from a word on. Returns the place behind it.
fn import(words: &[&str], mut at: usize, above: &[String], found: &mut Vec<(String, Vec<String>)>) -> usize {
    let mut path = above.to_vec();
    loop {
        match words[at] {
            "{" => {
                at += 1;
                while words[at] != "}" {
                    at = import(words, at, &path, found);
                    at += usize::from(words[at] == ",");
                }
                return at + 1;
            }
            "as" => {
                found.push((words[at + 1].to_owned(), path));
                return at + 2;
            }
            "," | "}" | ";" => {
                found.push((path.last().unwrap().clone(), path));
                return at;
            }
            "::" => {}
            // In braces it is what stands before them.
            "self" if !path.is_empty() => {}
            name => path.push(name.to_owned()),
        }
        at += 1;
    }
}

/// The words and signs of a source text, without spaces, comments, texts and lifetimes.
pub(super) fn words(mut text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    while !text.is_empty() {
        let (length, counts) = word(text);
        let (word, rest) = text.split_at(length);
        found.extend(counts.then_some(word));
        text = rest;
    }
    found
}

/// The length of the first word of a text, and whether it counts.
fn word(text: &str) -> (usize, bool) {
    let behind = |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |at| from + at + end.len());
    let name = |from: usize| {
        text[from..].find(|c: char| !c.is_alphanumeric() && c != '_').map_or(text.len(), |length| from + length)
    };
    let raw = text.strip_prefix('b').unwrap_or(text).strip_prefix('r');
    let hashes = raw.map_or(0, |raw| raw.len() - raw.trim_start_matches('#').len());
    if text.starts_with("//") {
        (behind("\n", 0), false)
    } else if text.starts_with("/*") {
        (behind("*/", 0), false)
    } else if let Some(raw) = raw.filter(|raw| raw[hashes..].starts_with('"')) {
        (behind(&format!("\"{}", "#".repeat(hashes)), text.len() - raw.len() + hashes + 1), false)
    } else if let Some(inner) = text.strip_prefix('"') {
        let mut escaped = false;
        let ends = |&(_, c): &(usize, char)| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        };
        (inner.char_indices().find(ends).map_or(text.len(), |(at, _)| at + 2), false)
    } else if text.starts_with("'\\") {
        (behind("'", 3), false)
    } else if text.starts_with('\'') {
        let third = text.char_indices().nth(2);
        (third.filter(|(_, c)| *c == '\'').map_or_else(|| name(1), |(at, _)| at + 1), false)
    } else if text.starts_with("::") {
        (2, true)
    } else {
        let first = text.chars().next().unwrap();
        (name(0).max(first.len_utf8()), !first.is_whitespace())
    }
}

/// The place behind the group that opens at a word.
fn behind_group(words: &[&str], mut at: usize) -> usize {
    let mut depth = 0;
    while at < words.len() {
        match words[at] {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        at += 1;
        if depth == 0 {
            break;
        }
    }
    at
}

/// The words without items that only tests have.
pub(super) fn without_tests<'t>(words: &[&'t str]) -> Vec<&'t str> {
    let marks: [&[&str]; 2] =
        [&["#", "[", "cfg", "(", "test", ")", "]"], &["#", "[", "cfg", "(", "all", "(", "test", ","]];
    let (mut found, mut at) = (Vec::new(), 0);
    while at < words.len() {
        if marks.iter().any(|mark| words[at..].starts_with(mark)) {
            at = behind_item(words, at);
        } else {
            found.push(words[at]);
            at += 1;
        }
    }
    found
}

fn behind_item(words: &[&str], mut at: usize) -> usize {
    while at < words.len() {
        match words[at] {
            "#" => at = behind_group(words, at + 1),
            "(" | "[" => at = behind_group(words, at),
            "{" if words[at - 1] == "::" => at = behind_group(words, at),
            "{" => return behind_group(words, at),
            ";" | "," => return at + 1,
            _ => at += 1,
        }
    }
    at
}

/// Parts from which nothing leads are taken away until none is left, or only circles and what leads to them.
fn circles(mut parts: BTreeMap<String, BTreeSet<String>>) -> BTreeMap<String, BTreeSet<String>> {
    loop {
        let left: BTreeSet<String> = parts.keys().cloned().collect();
        parts.values_mut().for_each(|others| others.retain(|other| left.contains(other)));
        let before = parts.len();
        parts.retain(|_, others| !others.is_empty());
        if parts.len() == before {
            return parts;
        }
    }
}

#[test]
fn modules_are_in_no_circle() {
    let own = ["src".to_owned(), "python/src".to_owned()];
    for folder in crates().into_iter().map(|name| format!("crates/{name}/src")).chain(own) {
        for (inner, parts) in Sources::of(&folder).arrows() {
            let left = circles(parts);
            assert!(left.is_empty(), "{folder}/{}: in or above a circle: {left:#?}", inner.join("/"));
        }
    }
}

#[test]
fn items_are_followed_to_the_files_that_declare_them() {
    let arrows = Sources::of("crates/roads/src").arrows();
    assert!(arrows[&Module::new()]["turns"].contains("network"), "a folder");
    let network = &arrows[&vec!["network".to_owned()]];
    assert!(network["pairing"].contains("stroke_options"), "a re-export of the parent: {network:?}");
    assert!(!network.contains_key("stroke_options"));
    let cli = &Sources::of("src").arrows()[&vec!["cli".to_owned()]];
    assert!(cli["explain"].contains("database"), "a path over an imported module: {cli:?}");
}

/// The parts that `a/first.rs` names, in `a` and beside it.
fn named_by(first: &str) -> [Vec<String>; 2] {
    let mut all = Sources::default();
    for (path, text) in [
        ("lib", "use other::{a, function}; pub use b::Thing; pub use c::function; mod a; mod b; mod c;"),
        ("a/mod", "mod first; mod second; mod third; pub use second::Second;"),
        ("a/first", first),
        ("a/second", "pub struct Second;"),
        ("a/third", "pub fn third() {}"),
        ("b", "pub struct Thing;"),
        ("c", "pub fn function() {}"),
    ] {
        all.add(path.split('/').map(str::to_owned).collect(), text);
    }
    let arrows = all.arrows();
    let of = |folder: &[&str], part: &str| -> Vec<String> {
        let folder: Module = folder.iter().map(|&part| part.to_owned()).collect();
        arrows.get(&folder).and_then(|parts| parts.get(part)).into_iter().flatten().cloned().collect()
    };
    [of(&["a"], "first"), of(&[], "a")]
}

#[test]
fn imports_and_paths_of_every_form_are_read() {
    for (text, inside, beside) in [
        ("use super::Second;", "second", ""),
        ("use super::{second::Second as Other, third};", "second", ""),
        ("use super::third; fn f() { third::third() }", "third", ""),
        ("use crate::{Thing, a::{self, Second}};", "second", "b"),
        ("fn f() -> impl Fn() + use<> { super::super::c::function }", "", "c"),
        ("use crate::function;", "", "c"),
        ("use crate::function::Inside;", "", ""),
        ("use super::super::b; type T = b::Thing;", "", "b"),
        ("use self::super::super::b::Thing;", "", "b"),
        ("use other::Second; use other::b::{self, Thing}; fn f() { b::g() }", "", ""),
        (
            "// use super::Second;\nconst A: &str = \"\\\"use crate::Thing;\"; const B: &[char] = &['\"', '\\''];",
            "",
            "",
        ),
        ("fn f<'a>(a: &'a str) { g('a', r#\"\"#, crate::c::function) }", "", "c"),
        (
            "#[cfg(test)]\nuse super::{Second};\n#[cfg(all(test, unix))] fn f() { crate::Thing }\n#[cfg(test)]\nmod tests { use crate::Thing; }",
            "",
            "",
        ),
    ] {
        let expected = [inside, beside].map(|part| if part.is_empty() { vec![] } else { vec![part.to_owned()] });
        assert_eq!(named_by(text), expected, "{text}");
    }
}

#[test]
fn circles_are_found() {
    let parts = |arrows: &[(&str, &str)]| {
        let mut parts: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (from, to) in arrows {
            parts.entry((*from).to_owned()).or_default().insert((*to).to_owned());
        }
        parts
    };
    assert!(circles(parts(&[("a", "b"), ("a", "c"), ("b", "c")])).is_empty());
    assert_eq!(circles(parts(&[("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")])).len(), 3);
}
