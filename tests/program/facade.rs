//! What the library promises: the names below can be used at these paths, the table in the crate's documentation lists them, and the crate
//! shows them and nothing else.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Uses every promised name, and lists them by module.
macro_rules! promised {
    ($($module:ident $(:: $inner:ident)* { $($name:ident),+ $(,)? })+) => {
        $(const _: () = {
            #[allow(unused_imports)]
            use netcert::$module $(::$inner)* ::{$($name),+};
        };)+

        const PROMISED: &[(&str, &[&str])] =
            &[$((concat!(stringify!($module) $(, "::", stringify!($inner))*), &[$(stringify!($name)),+])),+];
    };
}

promised! {
    certificate { CertificateError, Origin, text, text_under }
    check { Report, certificate }
    corridor { Drawn, FileCorridor, FileError, corridor_from_file }
    explain { Explanation, explain_corridor, words }
    export { Ask, ExportError, Out, PermitPolicy, Source, Unfinished, export }
    export::formats { Options, named }
    network { Network }
    osm::facts { Countries, Policy, WidthSource }
    picture { explanation, route, vehicle }
    pipeline { EDGES_AT_ONCE, Ingest, RunError, Selection, ingest }
    region { Region, RegionError }
    reporter { Reporter, Silent }
    route { Answer, Measure, Planner, Position, Question, Route, Unanswered, geojson }
    rows { Bounds, EdgeRow, TurnRow }
    settings { Settings }
    sign {
        KeyError, NotSigned, PrivateKey, PublicKey, Refusal, SignError, Signed, Signer, check_database, check_document, sign_database,
        sign_document,
    }
    stet { Certificate, Model, ModelError, Options, certify }
    stop { Stop, Stopped }
    store { Area, Database, QueryOptions, StoreError, TurnQuery }
    vehicle { Catalogue, Vehicle, VehicleError }
    verdict { ForbiddenReason, UnknownReason, UnsafeReason, Verdict }
    verify { Request, Verification, VerifyError, verify }
    watch { Patience, set_patience }
    words { Named, VerdictKind, verdict_words }
}

/// Names by module.
type Names = BTreeMap<String, BTreeSet<String>>;

fn source(path: &str) -> Option<String> {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(path)).ok()
}

/// The rows of the documentation's table.
fn documented() -> Names {
    let text = source("lib.rs").unwrap();
    let (_, after) = text.split_once("//! # What is promised\n").unwrap();
    let (section, _) = after.split_once("//! # ").unwrap();
    let mut names = Names::new();
    for row in section.lines().filter_map(|line| line.strip_prefix("//! | [`")) {
        let (module, listed) = row.split_once("`] | ").unwrap();
        let listed = listed.split('`').skip(1).step_by(2).map(str::to_owned);
        names.entry(module.to_owned()).or_default().extend(listed);
    }
    names
}

/// The names of `use a::{B, C};`, `fn b(`, `struct B {` and the like, from which `pub` is taken away.
fn names_of(item: &str) -> Vec<String> {
    let (kind, rest) = item.split_once(' ').unwrap();
    let named = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    match (kind, rest.rsplit_once("::")) {
        ("use", Some((_, last))) => {
            let names = last.trim_matches(['{', '}', ';']).split(',').map(str::trim);
            names.filter(|name| !name.is_empty()).map(str::to_owned).collect()
        }
        ("fn" | "struct" | "enum" | "trait", _) => vec![named.to_owned()],
        _ => panic!("what is this? {item}"),
    }
}

/// The public names of a file with a module of its own that are not hidden.
fn own(module: &str) -> BTreeSet<String> {
    let text = source(&format!("{module}.rs")).or_else(|| source(&format!("{module}/mod.rs"))).unwrap();
    let mut names = BTreeSet::new();
    let mut hidden = false;
    // Methods are indented.
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with([' ', '/', '}'])) {
        if let Some(item) = line.strip_prefix("pub ").filter(|_| !hidden) {
            names.extend(names_of(item));
        }
        hidden = line == "#[doc(hidden)]" || hidden && line.starts_with("#[");
    }
    names
}

/// What the crate's documentation shows: by module, the names that `src/lib.rs` passes on without hiding them. Whatever else it passes on
/// must be hidden.
fn shown() -> Names {
    let text = source("lib.rs").unwrap();
    let mut names = Names::new();
    let mut within: Vec<&str> = Vec::new();
    let mut attributes: Vec<&str> = Vec::new();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    while let Some(line) = lines.next() {
        if line.starts_with("#[") {
            attributes.push(line);
            continue;
        }
        if line == "}" {
            within.pop().unwrap();
        } else if let Some(module) = line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(" {")) {
            within.push(module);
        } else if let Some(module) = line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';')) {
            names.insert(module.to_owned(), own(module));
        } else {
            let mut item = line.strip_prefix("pub ").unwrap_or_else(|| panic!("not public: {line}")).to_owned();
            while !item.ends_with(';') {
                item += lines.next().unwrap();
            }
            let is = |attribute| attributes.contains(&attribute);
            assert!(is("#[doc(hidden)]") != is("#[doc(inline)]"), "hidden or shown? {item}");
            if is("#[doc(inline)]") {
                names.entry(within.join("::")).or_default().extend(names_of(&item));
            }
        }
        attributes.clear();
    }
    names
}

#[test]
fn the_library_shows_what_it_promises_and_nothing_else() {
    let set = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let promised: Names = PROMISED.iter().map(|&(module, names)| (module.to_owned(), set(names))).collect();
    assert_eq!(documented(), promised);
    assert_eq!(shown(), promised);
    let count: usize = promised.values().map(BTreeSet::len).sum();
    assert!((70..=90).contains(&count), "{count} names");
}
