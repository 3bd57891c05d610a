//! Lines for whoever runs the server. Requests come from outside: nothing of them may move a terminal's cursor, colour it, or
//! begin a line of its own. Where lines go is the program's choice: they are handed to `log`.

use std::path::Path;

use axum::http::{Method, Uri};

/// Longest part of a line that a request decides, characters.
const LONGEST: usize = 300;

/// What a response says of its refusal, beside its body.
#[derive(Debug, Clone)]
pub(super) struct Refused(pub(super) String);

/// A request is refused.
pub(super) fn refused(method: &Method, target: &Uri, refused: &Refused) {
    log::warn!("{}", line(&refusal(method, target, refused)));
}

/// The database has changed.
pub(super) fn read_anew(db: &Path) {
    log::info!("{}", line(&format!("{}: it has changed; read anew", db.display())));
}

fn refusal(method: &Method, target: &Uri, Refused(why): &Refused) -> String {
    let target = target.path_and_query().map_or("", |target| target.as_str());
    format!("{} {}: {}", cut(method.as_str()), cut(target), cut(why))
}

fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// As one line: what does not print is written as its escape, `\u{1b}` or `\n`; so is a backslash.
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
        // C1 controls, line separators, marks that turn the writing round, and what takes no room.
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
            (target.replace(['\\', '{', '}'], "-").parse().unwrap_or_default(), Refused("é".repeat(9999)));
        assert!(refusal(&Method::GET, &target, &why).chars().count() < 2 * LONGEST + 20);
    }
}
