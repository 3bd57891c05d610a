//! CSV tables by RFC 4180 without geometry: `edges.csv`, `turns.csv`, and the header beside them.

use std::io::{self, Write};

use super::layers::asked;
use super::{Options, Target, one_file_a_layer};
use crate::rows::{Cell, Column};
use crate::{ExportError, Layout, Place, Source};

/// `csv`
pub(super) struct Csv;

impl Target for Csv {
    fn name(&self) -> &'static str {
        "csv"
    }

    fn about(&self) -> &'static str {
        "edges and turns with all certificate columns, as tables"
    }

    fn layout(&self, options: &Options) -> Layout {
        one_file_a_layer(self.name(), options)
    }

    fn has_columns(&self) -> bool {
        true
    }

    fn write(&self, source: &Source<'_>, options: &Options, place: &mut Place) -> Result<(), ExportError> {
        for layer in asked(options) {
            let mut sink = place.create(&format!("{}.csv", layer.name()))?;
            head(&mut sink, &layer.columns(source))?;
            layer.each(source, |row| Ok(line(&mut sink, row.cells)?))?;
            sink.close()?;
        }
        Ok(())
    }
}

fn head(out: &mut dyn Write, columns: &[Column]) -> io::Result<()> {
    let names: Vec<&str> = columns.iter().map(|column| column.0).collect();
    write!(out, "{}\r\n", names.join(","))
}

fn line(out: &mut dyn Write, cells: &[Cell<'_>]) -> io::Result<()> {
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            out.write_all(b",")?;
        }
        match cell {
            Cell::Integer(None) | Cell::Real(None) | Cell::Text(None) => {}
            Cell::Integer(Some(number)) => write!(out, "{number}")?,
            Cell::Real(Some(number)) => write!(out, "{number}")?,
            Cell::Flag(yes) => write!(out, "{yes}")?,
            Cell::Text(Some(text)) if text.contains(['"', ',', '\n', '\r']) => {
                write!(out, "\"{}\"", text.replace('"', "\"\""))?;
            }
            Cell::Text(Some(text)) => out.write_all(text.as_bytes())?,
        }
    }
    out.write_all(b"\r\n")
}
