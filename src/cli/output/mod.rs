//! The two output streams: results go to standard output, everything else to standard error.

pub(crate) mod file;
pub(crate) mod relative;
pub(crate) mod relative_stats;
pub(crate) mod rows;
pub(crate) mod sheet;
pub(crate) mod table;
pub(crate) mod turn_rows;

use std::io::{self, BufWriter, StdoutLock, Write};
use std::time::Duration;

use indicatif::HumanDuration;

/// Standard output with a buffer. The caller must flush it and handle the error.
pub(crate) fn results() -> BufWriter<StdoutLock<'static>> {
    BufWriter::with_capacity(1 << 16, io::stdout().lock())
}

/// Prints a line for people. A failed write to standard error is ignored.
pub(crate) fn tell(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Prints an error. Every error message is complete in itself: what failed, where, and what the user can do.
pub(crate) fn complain(error: &anyhow::Error) {
    tell(&format!("error: {error}"));
}

/// Whether the reader of the results has closed the pipe, as in `netcert query … | head`.
pub(crate) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe)
}

/// `1234567` as `1,234,567`.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Metres as kilometres with one decimal.
pub(crate) fn km(metres: f64) -> String {
    format!("{:.1}", metres / 1000.0)
}

/// Text from a map or file, made safe for a terminal: control characters are replaced.
pub(crate) fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// A duration in words for people.
pub(crate) fn human(seconds: f64) -> String {
    if seconds < 60.0 { format!("{seconds:.1} s") } else { HumanDuration(Duration::from_secs_f64(seconds)).to_string() }
}

/// Wraps a text into lines of at most 100 characters. The second and later lines begin with `indent`.
pub(crate) fn wrapped(text: &str, indent: &str) -> String {
    let (mut out, mut column) = (String::new(), 0);
    for word in text.split(' ') {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > 100 {
            out.push('\n');
            out += indent;
            column = indent.len();
        } else if column > 0 {
            out.push(' ');
            column += 1;
        }
        out += word;
        column += length;
    }
    out
}
