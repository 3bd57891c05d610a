//! The measurements behind an explained edge or turn, in words.

use std::io::Write;

use netcert::rows::Measurement;

use crate::cli::output::{printable, wrapped};

/// Prints a line for each measurement.
pub(crate) fn tell(out: &mut dyn Write, all: &[Measurement]) -> std::io::Result<()> {
    if all.is_empty() {
        return Ok(());
    }
    writeln!(out, "\nmeasured here, by the register (`netcert evidence list`):")?;
    for m in all {
        let unit = if m.quantity == "max_weight" { "t" } else { "m" };
        let number = match (m.value, m.lower) {
            (Some(value), Some(lower)) if lower < value => {
                format!(" {value:.2} {unit}, of which {lower:.2} {unit} counts")
            }
            (Some(value), _) => format!(" {value:.2} {unit}"),
            (None, _) => String::new(),
        };
        let date = m.date.as_deref().map_or(String::new(), |date| format!(", {date}"));
        let text =
            format!("  {} {}{number}: {}{date} ({}, row {})", m.evidence_no, m.quantity, m.source, m.file, m.file_row);
        writeln!(out, "{}", wrapped(&printable(&text), "      "))?;
    }
    Ok(())
}
