//! Tests whether a text is well-formed XML, as far as pictures use it: elements nest, attributes are quoted and not
//! repeated, markup characters are escaped. It is independent of the program's writer.

/// Panics with the place of the first fault.
pub fn well_formed(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = text;
    let mut roots = 0;
    let at = |rest: &str| text.len() - rest.len();
    while let Some(start) = rest.find('<') {
        let (before, tag) = rest.split_at(start);
        characters(before, at(rest));
        let end = tag.find('>').unwrap_or_else(|| panic!("byte {}: no end of tag", at(tag)));
        let inside = &tag[1..end];
        if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "byte {}: </{name}>", at(tag));
        } else {
            let empty = inside.ends_with('/');
            let inside = inside.strip_suffix('/').unwrap_or(inside);
            let name = inside.split(' ').next().unwrap();
            assert!(!name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric()), "byte {}: <{name}", at(tag));
            attributes(&inside[name.len()..], at(tag));
            roots += usize::from(open.is_empty());
            if !empty {
                open.push(name);
            }
        }
        rest = &tag[end + 1..];
    }
    assert!(rest.trim().is_empty(), "text after the end");
    assert!(open.is_empty(), "open: {open:?}");
    assert_eq!(roots, 1, "one root");
}

fn attributes(text: &str, at: usize) {
    let mut names = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (name, value) = rest.split_once("=\"").unwrap_or_else(|| panic!("byte {at}: {rest}"));
        assert!(!names.contains(&name), "byte {at}: {name} twice");
        names.push(name);
        let (value, more) = value.split_once('"').unwrap_or_else(|| panic!("byte {at}: {name} has no end"));
        characters(value, at);
        assert!(!value.contains("NaN") && !value.contains("inf"), "byte {at}: {name}={value}");
        rest = more.trim_start();
    }
}

fn characters(text: &str, at: usize) {
    let mut rest = text;
    while let Some(i) = rest.find('&') {
        let (entity, more) = rest[i + 1..].split_once(';').unwrap_or_else(|| panic!("byte {at}: a bare &"));
        assert!(["amp", "lt", "gt", "quot", "#39"].contains(&entity), "byte {at}: &{entity};");
        rest = more;
    }
    assert!(!text.chars().any(|c| c.is_control() && c != '\n'), "byte {at}: a control character");
}
