//! Log lines for the operator of the server. Text from requests is escaped, so that it cannot move the cursor of a terminal,
//! change its colours or begin a new line. The lines go to the `log` crate, and the program decides where they appear.

use std::path::Path;

use axum::http::{Method, Uri};

/// Where programs that log look for these lines, whatever the crate is called.
const TARGET: &str = "netcert::serve";
/// The greatest length of each part of a line that comes from a request, characters.
const LONGEST: usize = 300;

/// The reason of a refusal. The response carries it as an extension beside its body.
#[derive(Debug, Clone)]
pub(super) struct RefusalReason(pub(super) String);

/// Logs a refused request.
pub(super) fn refused(method: &Method, target: &Uri, refused: &RefusalReason) {
    log::warn!(target: TARGET, "{}", line(&refusal(method, target, refused)));
}

/// Logs that the database has changed and was read again.
pub(super) fn read_anew(db: &Path) {
    log::info!(target: TARGET, "{}", line(&format!("{}: it has changed; read anew", db.display())));
}

fn refusal(method: &Method, target: &Uri, RefusalReason(why): &RefusalReason) -> String {
    let target = target.path_and_query().map_or("", |target| target.as_str());
    format!("{} {}: {}", cut(method.as_str()), cut(target), cut(why))
}

fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The text as one line. Characters that do not print, and backslashes, are replaced by escapes such as `\u{1b}` or `\n`.
fn line(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '"' | '\'' => out.push(c),
            _ => out.extend(c.escape_debug()),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_print_is_escaped_and_the_rest_stays() {
        assert_eq!(line("Größe \"5\" – it's 道路"), "Größe \"5\" – it's 道路");
        assert_eq!(line("a\nb\r\t\u{1b}[31m\\n\u{7f}"), r"a\nb\r\t\u{1b}[31m\\n\u{7f}");
        // C1 controls, line separators, marks of writing direction, and characters of no width.
        for c in ['\u{9b}', '\u{85}', '\u{2028}', '\u{2029}', '\u{202e}', '\u{2066}', '\u{200b}', '\u{feff}', '\u{301}']
        {
            let escaped = line(&c.to_string());
            assert!(escaped.is_ascii() && escaped.starts_with("\\u{"), "{escaped}");
        }
    }

    #[test]
    fn a_line_is_bounded() {
        let target = format!("/{}", "é".repeat(100_000).escape_unicode());
        let (target, why) =
            (target.replace(['\\', '{', '}'], "-").parse().unwrap_or_default(), RefusalReason("é".repeat(9999)));
        assert!(refusal(&Method::GET, &target, &why).chars().count() < 2 * LONGEST + 20);
    }
}
