//! CSV tables by RFC 4180 without geometry: `edges.csv`, `turns.csv`, and the header beside them.

use std::io::{self, Write};

use super::layer_files::{LayerFormat, Table};
use super::layers::Row;
use crate::rows::Cell;
use crate::{ExportError, Sink};

/// `csv`
pub(super) struct Csv {
    sink: Sink,
}

impl LayerFormat for Csv {
    const NAME: &'static str = "csv";
    const ABOUT: &'static str = "edges and turns with all certificate columns, as tables";
    const ENDING: &'static str = "csv";

    fn open(table: &Table<'_>, mut sink: Sink) -> Result<Self, ExportError> {
        let names: Vec<&str> = table.columns.iter().map(|column| column.0).collect();
        write!(sink, "{}\r\n", names.join(","))?;
        Ok(Self { sink })
    }

    fn row(&mut self, _: &Table<'_>, row: &Row<'_>) -> Result<(), ExportError> {
        Ok(line(&mut self.sink, row.cells)?)
    }

    fn close(self, _: &Table<'_>) -> Result<(), ExportError> {
        self.sink.close()
    }
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
