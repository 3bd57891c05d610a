//! Tags as the map has them, kept so that people see what a verdict was read from: one `key=value` a line.

/// Adds a tag to a text of lines. What breaks a line in a value becomes a space.
pub(super) fn add(lines: &mut String, key: &str, value: &str) {
    if !lines.is_empty() {
        lines.push('\n');
    }
    lines.push_str(key);
    lines.push('=');
    lines.extend(value.chars().map(|c| if c.is_control() { ' ' } else { c }));
}

/// The lines of two texts, each once, in order.
pub(super) fn merged(a: Option<&str>, b: Option<&str>) -> Option<Box<str>> {
    match (a, b) {
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => Some(one.into()),
        (Some(a), Some(b)) if a == b => Some(a.into()),
        (Some(a), Some(b)) => {
            let mut lines: Vec<&str> = a.lines().chain(b.lines()).collect();
            lines.sort_unstable();
            lines.dedup();
            Some(lines.join("\n").into())
        }
    }
}

/// The tags of a text.
pub(super) fn tags(lines: Option<&str>) -> impl Iterator<Item = (&str, &str)> {
    lines.into_iter().flat_map(str::lines).filter_map(|line| line.split_once('='))
}
