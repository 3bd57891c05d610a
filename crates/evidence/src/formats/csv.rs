//! Comma separated values (RFC 4180). The header tells the separator: comma, semicolon or tab.
//!
//! A file that was cut between two rows cannot be told from a shorter one. A cut within a row is found: a cell is missing, a
//! quotation mark is open, or the last number is not followed by the end of a line.

use crate::columns::{EvidenceColumn, FileRecord, columns};
use crate::error::Failure;
use crate::shape;

/// Columns of words. A last cell of any other kind needs the end of its line, as its last digits may be missing.
const WORDS: [EvidenceColumn; 7] = [
    EvidenceColumn::Source,
    EvidenceColumn::Licence,
    EvidenceColumn::Name,
    EvidenceColumn::Note,
    EvidenceColumn::Vehicle,
    EvidenceColumn::Date,
    EvidenceColumn::Geometry,
];

/// All records of a file.
pub(super) fn records(bytes: &[u8]) -> Result<Vec<FileRecord>, Failure> {
    let text = super::text(bytes)?;
    closed(text)?;
    let mut reader =
        csv::ReaderBuilder::new().delimiter(separator(text)).has_headers(true).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| failed(&error))?.clone();
    let columns = columns(&header)?;
    let mut lines = Lines { text, counted: 0, line: 1 };
    let mut records = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|error| failed(&error))?;
        let number = lines.at(row.position().map_or(0, csv::Position::byte) as usize);
        records.push(record(number, &columns, &row));
    }
    ended(text, columns.last().copied().flatten(), records.last())?;
    Ok(records)
}

fn record(number: u64, columns: &[Option<EvidenceColumn>], row: &csv::StringRecord) -> FileRecord {
    let mut record = FileRecord::new(number);
    for (column, cell) in columns.iter().zip(row) {
        match column {
            Some(EvidenceColumn::Geometry) if !cell.trim().is_empty() => record.set_shape(shape::from_text(cell)),
            Some(column) => record.set(*column, cell),
            None => {}
        }
    }
    record
}

/// The separator that is most often in the header; a comma if there is none.
fn separator(text: &str) -> u8 {
    let header = text.lines().next().unwrap_or_default();
    let count = |separator: u8| header.bytes().filter(|&byte| byte == separator).count();
    let semicolon_or_tab = if count(b';') >= count(b'\t') { b';' } else { b'\t' };
    if count(semicolon_or_tab) > count(b',') { semicolon_or_tab } else { b',' }
}

/// Checks that no quotation mark is open at the end. `csv` would take all the rest of the file as one cell.
fn closed(text: &str) -> Result<(), Failure> {
    let mut open = None;
    let mut line = 1;
    for byte in text.bytes() {
        match byte {
            b'"' => open = if open.is_some() { None } else { Some(line) },
            b'\n' => line += 1,
            _ => {}
        }
    }
    let what = |line| format!("line {line}: a quotation mark is not closed; close it, or write the file again");
    open.map_or(Ok(()), |line| Err(Failure::File(what(line))))
}

/// Checks that a number at the very end of the file is whole.
fn ended(text: &str, last: Option<EvidenceColumn>, record: Option<&FileRecord>) -> Result<(), Failure> {
    let (Some(last), Some(record)) = (last, record) else { return Ok(()) };
    if text.ends_with(['\n', '\r', '"']) || WORDS.contains(&last) || record.text(last).is_none() {
        return Ok(());
    }
    let what =
        format!("row {}: {}: the file ends within the line, so this may be cut off; ", record.number, last.name());
    Err(Failure::File(what + "check it, and end the line"))
}

fn failed(error: &csv::Error) -> Failure {
    let line = error.position().map_or(0, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => Failure::File(format!(
            "line {line}: {len} cells, and the header has {expected_len} columns; put cells with separators into quotation marks"
        )),
        _ => Failure::File(format!("no CSV: {error}")),
    }
}

/// Numbers of lines, counted once over the file. `csv` counts otherwise where lines end with CR LF or are empty.
struct Lines<'t> {
    text: &'t str,
    counted: usize,
    line: u64,
}

impl Lines<'_> {
    /// The line of the record that begins at or after a byte.
    fn at(&mut self, byte: usize) -> u64 {
        let rest = self.text.as_bytes().get(byte..).unwrap_or_default();
        let begins = byte + rest.iter().take_while(|byte| b"\r\n".contains(byte)).count();
        let passed = self.text.as_bytes().get(self.counted..begins).unwrap_or_default();
        self.line += passed.iter().filter(|&&byte| byte == b'\n').count() as u64;
        self.counted = begins.max(self.counted);
        self.line
    }
}
