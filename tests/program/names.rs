//! Tests that types do not share names: in a crate no two types that other modules see, and over all crates no two that other crates may see.
//!
//! Other modules see `pub`, `pub(crate)`, `pub(super)` and `pub(in …)`. Other crates may see plain `pub`, whether or not the module is public.
//! Tests are left out. Types that a macro makes are not seen.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::circles::{is_name, without_tests, words};
use crate::walls::{crates, sources};

/// Names that types of several crates share: the name, the crates and the reason.
const SHARED: [(&str, &[&str], &str); 1] =
    [("Options", &["base", "export"], "the library promises `stet::Options` and `export::formats::Options`")];

/// A type that other modules see.
#[derive(Debug, PartialEq, Eq)]
struct SeenType {
    name: String,
    /// Whether other crates may see it, too.
    everywhere: bool,
}

/// The types of a source text that other modules see.
fn seen_types(text: &str) -> Vec<SeenType> {
    let words = without_tests(&words(text));
    let mut found = Vec::new();
    for (at, _) in words.iter().enumerate().filter(|(_, word)| **word == "pub") {
        let everywhere = words.get(at + 1) != Some(&"(");
        let within = if everywhere { 0 } else { words[at..].iter().position(|word| *word == ")").unwrap() };
        let mut after = words[at + within + 1..].iter().filter(|word| !["unsafe", "auto"].contains(word));
        if let (Some(&kind), Some(&name)) = (after.next(), after.next())
            && ["struct", "enum", "trait", "type", "union"].contains(&kind)
            && is_name(name)
        {
            found.push(SeenType { name: name.to_owned(), everywhere });
        }
    }
    found
}

/// The files of the modules that a file declares for tests alone.
fn files_for_tests(path: &Path, text: &str) -> Vec<PathBuf> {
    let declared = |words: &[&str]| -> BTreeSet<String> {
        let modules = words.windows(3).filter(|three| three[0] == "mod" && three[2] == ";");
        modules.map(|three| three[1].to_owned()).collect()
    };
    let all = words(text);
    let folder = match path.file_stem().unwrap().to_str().unwrap() {
        "mod" | "lib" | "main" => path.parent().unwrap().to_owned(),
        _ => path.with_extension(""),
    };
    let of_tests = &declared(&all) - &declared(&without_tests(&all));
    of_tests.iter().map(|name| folder.join(name)).collect()
}

/// The types of a crate that other modules see, with their files.
fn types_of(folder: &str) -> Vec<(SeenType, PathBuf)> {
    let all = sources(folder);
    let of_tests: Vec<PathBuf> = all.iter().flat_map(|(path, text)| files_for_tests(path, text)).collect();
    let is_test = |path: &Path| of_tests.iter().any(|module| path.with_extension("").starts_with(module));
    let code = all.into_iter().filter(|(path, _)| !is_test(path));
    code.flat_map(|(path, text)| seen_types(&text).into_iter().map(move |one| (one, path.clone()))).collect()
}

/// The crates with the folders of their sources.
fn folders() -> Vec<(String, String)> {
    let own = [("netcert", "src"), ("python", "python/src")].map(|(name, folder)| (name.to_owned(), folder.to_owned()));
    crates().into_iter().map(|name| (name.clone(), format!("crates/{name}/src"))).chain(own).collect()
}

#[test]
fn a_crate_has_no_two_types_of_one_name() {
    let mut count = 0;
    for (name, folder) in folders() {
        let mut files: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
        for (one, path) in types_of(&folder) {
            files.entry(one.name).or_default().push(path);
            count += 1;
        }
        files.retain(|_, paths| paths.len() > 1);
        assert!(files.is_empty(), "{name}: name each type by what it is: {files:#?}");
    }
    assert!(count > 900, "{count} types");
}

#[test]
fn no_two_crates_have_public_types_of_one_name() {
    let mut owners: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (name, folder) in folders() {
        for (one, _) in types_of(&folder).into_iter().filter(|(one, _)| one.everywhere) {
            owners.entry(one.name).or_default().insert(name.clone());
        }
    }
    for (name, listed, reason) in SHARED {
        let own: Vec<String> = owners.remove(name).unwrap_or_default().into_iter().collect();
        assert_eq!(own, listed, "{name} is listed, because {reason}");
    }
    owners.retain(|_, crates| crates.len() > 1);
    assert!(owners.is_empty(), "name each type by what it is: {owners:#?}");
}

#[test]
fn types_of_every_form_are_seen() {
    for (text, expected) in [
        ("pub struct A<'a>(&'a str);", Some(true)),
        ("#[derive(Debug)] pub enum A { B }", Some(true)),
        ("pub unsafe trait A {}", Some(true)),
        ("pub type A = u8;", Some(true)),
        ("pub(crate) union A { b: u8 }", Some(false)),
        ("pub(in crate::b) struct A { pub b: u8 }", Some(false)),
        ("struct A; impl A { pub fn b() {} pub const TYPE: u8 = 0; }", None),
        ("// pub struct A;\nconst B: &str = \"pub struct A;\"; pub use b::A; pub mod a {}", None),
        ("#[cfg(test)] mod tests { pub struct A; }", None),
        ("macro_rules! b { ($name:ident) => { pub struct $name; } }", None),
    ] {
        let expected: Vec<SeenType> =
            expected.into_iter().map(|everywhere| SeenType { name: "A".to_owned(), everywhere }).collect();
        assert_eq!(seen_types(text), expected, "{text}");
    }
    let files = files_for_tests(Path::new("a/b.rs"), "mod c; #[cfg(test)] mod d; #[cfg(test)] mod e { mod f {} }");
    assert_eq!(files, [Path::new("a/b/d")]);
}
