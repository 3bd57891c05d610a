//! Errata of the paper. In each test the printed form fails, and the repaired form or netcert's own form holds.
//! `docs/errata.md` explains them for readers of the paper; these tests print its numbers (`cargo test --test
//! certificate errata -- --nocapture`).
//!
//! The two code paths are `netcert::published` to the letter, and either the same with the fault's switch in `Reading`
//! or `netcert::stet`.

mod algorithm;
mod certificate;
mod leeway;
mod motion;
mod property;
mod scene;
mod tubes;

/// The page describes every test, and no other.
#[test]
fn page_and_tests_are_about_the_same_errata() {
    let page = include_str!("../../../docs/errata.md");
    let sources = [
        include_str!("algorithm.rs"),
        include_str!("certificate.rs"),
        include_str!("leeway.rs"),
        include_str!("motion.rs"),
        include_str!("property.rs"),
        include_str!("tubes.rs"),
    ];
    let after = |text: &str, mark: &str| -> Vec<String> {
        let ends = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
        text.split(mark).skip(1).filter_map(|rest| rest.split(ends).next()).map(str::to_owned).collect()
    };
    let told = |name: &str| name.starts_with('e') && name[1..].starts_with(|c: char| c.is_ascii_digit());
    let mut tests: Vec<_> = sources.iter().flat_map(|text| after(text, "#[test]\nfn ")).collect();
    for name in &tests {
        assert!(page.contains(&format!("`{name}`")), "docs/errata.md does not name {name}");
    }
    tests.retain(|name| told(name));
    assert!(tests.len() > 20);
    for name in after(page, "`").iter().filter(|name| told(name) && name.len() > 4) {
        assert!(tests.contains(name), "docs/errata.md names {name}, which is no test");
    }
}
