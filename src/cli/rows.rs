//! Writes edges with their certificates as a table, CSV, JSON or GeoJSON, row by row.
//!
//! Names and units are those of the database's tables `edge` and `certificate`.

use std::io::{self, BufWriter, StdoutLock, Write};

use netcert::osm::facts::{Policy, WidthSource};
use netcert::rows::{Cell, Column, EdgeRow};
use netcert::words::{Named, verdict_words};
use serde_json::{Map, Value, json};

use super::output::printable;
use super::query::Format;

/// What is the same for all rows.
pub(crate) struct Head {
    pub(crate) vehicle: String,
    pub(crate) policy: Policy,
    /// The sentence that says what `safe` means.
    pub(crate) scope: String,
}

/// Writes rows in one format to standard output.
pub(crate) struct Sink<'h> {
    format: Format,
    head: &'h Head,
    out: BufWriter<StdoutLock<'static>>,
    rows: u64,
}

impl<'h> Sink<'h> {
    /// Begins the output and writes what precedes the first row.
    pub(crate) fn begin(format: Format, head: &'h Head, out: BufWriter<StdoutLock<'static>>) -> io::Result<Self> {
        let mut sink = Self { format, head, out, rows: 0 };
        match format {
            Format::Table => writeln!(
                sink.out,
                "{:>19}  {:>11} {:<8}  {:<14} {:>8}  {:>7} {:<10}  {:>7}  {:>8}  {:<22} road",
                "edge_id", "way", "dir", "highway", "length", "width", "source", "rsc", "hinge", "verdict"
            )?,
            Format::Csv => writeln!(sink.out, "{}", names(&EdgeRow::COLUMNS))?,
            Format::Json => {
                let (vehicle, scope) = (json!(head.vehicle), json!(head.scope));
                write!(
                    sink.out,
                    "{{\"netcert\":\"{}\",\"vehicle_id\":{vehicle},\"corridor\":\"{}\",\"scope\":{scope},\"edges\":[",
                    env!("CARGO_PKG_VERSION"),
                    head.policy.name()
                )?;
            }
            // `scope` is a foreign member, which RFC 7946, section 6.1, allows.
            Format::Geojson => {
                write!(sink.out, "{{\"type\":\"FeatureCollection\",\"scope\":{},\"features\":[", json!(head.scope))?;
            }
        }
        Ok(sink)
    }

    pub(crate) fn row(&mut self, row: &EdgeRow) -> io::Result<()> {
        match self.format {
            Format::Table => self.line(row)?,
            Format::Csv => {
                let cells: Vec<String> = self.members(row).iter().map(|(_, value)| csv(value)).collect();
                writeln!(self.out, "{}", cells.join(","))?;
            }
            Format::Json => {
                let members = Value::Object(self.members(row));
                self.item(&members)?;
            }
            Format::Geojson => {
                let coordinates: Vec<Value> = row.line.iter().map(|place| json!(place.degrees())).collect();
                let feature = json!({
                    "type": "Feature",
                    "id": row.edge_id.to_string(),
                    "geometry": {"type": "LineString", "coordinates": coordinates},
                    "properties": self.members(row),
                });
                self.item(&feature)?;
            }
        }
        self.rows += 1;
        Ok(())
    }

    /// Writes what follows the last row.
    pub(crate) fn end(mut self) -> io::Result<()> {
        if matches!(self.format, Format::Json | Format::Geojson) {
            writeln!(self.out, "\n]}}")?;
        }
        self.out.flush()
    }

    fn item(&mut self, value: &Value) -> io::Result<()> {
        let between = if self.rows == 0 { "\n" } else { ",\n" };
        write!(self.out, "{between}{value}")
    }

    fn line(&mut self, row: &EdgeRow) -> io::Result<()> {
        let (verdict, reason) = verdict_words(row.certificate.verdict);
        let verdict = if reason.is_empty() { verdict.to_owned() } else { format!("{verdict}: {reason}") };
        let road: Vec<&str> = [&row.reference, &row.name].into_iter().flatten().map(String::as_str).collect();
        let (metres, degrees) = (|m: f64| format!("{m:.2} m"), |d: f64| format!("{d:.1}°"));
        writeln!(
            self.out,
            "{:>19}  {:>11} {:<8}  {:<14} {:>8}  {:>7} {:<10}  {:>7}  {:>8}  {:<22} {}",
            row.edge_id,
            row.way_id,
            row.direction.name(),
            row.highway,
            format!("{:.0} m", row.length_m),
            row.width_m.map_or(String::new(), metres),
            row.width_source.map_or("", WidthSource::name),
            row.certificate.rsc_m.map_or(String::new(), metres),
            row.certificate.hinge_angle_deg().map_or(String::new(), degrees),
            verdict,
            printable(&road.join(" ")),
        )
    }

    fn members(&self, row: &EdgeRow) -> Map<String, Value> {
        members(&EdgeRow::COLUMNS, row.cells(&self.head.vehicle, self.head.policy))
    }
}

/// The header line of CSV.
pub(super) fn names(columns: &[Column]) -> String {
    columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",")
}

/// The members of a JSON object with these columns.
pub(super) fn members<const N: usize>(columns: &[Column; N], cells: [Cell<'_>; N]) -> Map<String, Value> {
    columns.iter().map(|(name, _)| (*name).to_owned()).zip(cells.map(Value::from)).collect()
}

/// A cell of CSV by RFC 4180. Null is an empty cell.
pub(super) fn csv(value: &Value) -> String {
    let text = match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_that_csv_would_split_are_quoted() {
        assert_eq!(csv(&json!("A 5")), "A 5");
        assert_eq!(csv(&json!("Main St, \"old\"")), "\"Main St, \"\"old\"\"\"");
        assert_eq!(csv(&json!("two\nlines")), "\"two\nlines\"");
        assert_eq!((csv(&Value::Null), csv(&json!(-0.25))), (String::new(), "-0.25".to_owned()));
    }
}
