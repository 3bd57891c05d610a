//! Writes edges with their certificates as a table, CSV, JSON or GeoJSON, row by row.
//!
//! Names and units are those of the database's tables `edge` and `certificate`.

use std::io::{self, BufWriter, StdoutLock, Write};

use clap::ValueEnum;
use netcert::osm::facts::{Policy, WidthSource};
use netcert::rows::{Cell, Column, EdgeRow, Relative};
use netcert::words::{Named, verdict_words};
use serde_json::{Map, Value, json};

use crate::cli::output::{printable, relative};

/// Form of the answer.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Table,
    Csv,
    Json,
    Geojson,
}

/// What is the same for all rows.
pub(crate) struct Head {
    pub(crate) vehicle: String,
    pub(crate) policy: Policy,
    /// The sentence that says what `safe` means.
    pub(crate) scope: String,
    /// The reference vehicle, if rows are compared with one.
    pub(crate) relative_to: Option<String>,
    /// Whether tables for people have a column with what would be enough. Other formats always have it.
    pub(crate) needs: bool,
    /// Whether tables for people have a column with the narrowest policy. Other formats always have it.
    pub(crate) uses: bool,
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
                "{:>19}  {:>11} {:<8}  {:<14} {:>8}  {:>7} {:<10}  {:>7}  {:>8}  {:<22} {}road",
                "edge_id",
                "way",
                "dir",
                "highway",
                "length",
                "width",
                "source",
                "rsc",
                "hinge",
                "verdict",
                head.heading()
            )?,
            Format::Csv => writeln!(sink.out, "{}", head.names(&EdgeRow::COLUMNS))?,
            Format::Json => {
                let (vehicle, scope) = (json!(head.vehicle), json!(head.scope));
                write!(
                    sink.out,
                    "{{\"netcert\":\"{}\",\"vehicle_id\":{vehicle},\"corridor\":\"{}\",{}\"scope\":{scope},\"edges\":[",
                    env!("CARGO_PKG_VERSION"),
                    head.policy.name(),
                    head.member()
                )?;
            }
            // `relative_to` and `scope` are foreign members, which RFC 7946, section 6.1, allows.
            Format::Geojson => {
                let (member, scope) = (head.member(), json!(head.scope));
                write!(sink.out, "{{\"type\":\"FeatureCollection\",{member}\"scope\":{scope},\"features\":[")?;
            }
        }
        Ok(sink)
    }

    /// Writes a row, with its comparison if the head names a reference.
    pub(crate) fn row(&mut self, row: &EdgeRow, relative: Option<Relative>) -> io::Result<()> {
        match self.format {
            Format::Table => self.line(row, relative)?,
            Format::Csv => {
                let cells: Vec<String> = self.members(row, relative).iter().map(|(_, value)| csv(value)).collect();
                writeln!(self.out, "{}", cells.join(","))?;
            }
            Format::Json => {
                let members = Value::Object(self.members(row, relative));
                self.item(&members)?;
            }
            Format::Geojson => {
                let coordinates: Vec<Value> = row.line.iter().map(|place| json!(place.degrees())).collect();
                let feature = json!({
                    "type": "Feature",
                    "id": row.edge.id.to_string(),
                    "geometry": {"type": "LineString", "coordinates": coordinates},
                    "properties": self.members(row, relative),
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

    fn line(&mut self, row: &EdgeRow, relative: Option<Relative>) -> io::Result<()> {
        let (verdict, reason) = verdict_words(row.certificate.verdict);
        let verdict = if reason.is_empty() { verdict.to_owned() } else { format!("{verdict}: {reason}") };
        let road: Vec<&str> = [&row.road.reference, &row.road.name].into_iter().flatten().map(String::as_str).collect();
        let (metres, degrees) = (|m: f64| format!("{m:.2} m"), |d: f64| format!("{d:.1}°"));
        writeln!(
            self.out,
            "{:>19}  {:>11} {:<8}  {:<14} {:>8}  {:>7} {:<10}  {:>7}  {:>8}  {:<22} {}{}",
            row.edge.id,
            row.edge.way_id,
            row.edge.direction.name(),
            row.road.highway,
            format!("{:.0} m", row.length_m),
            row.width_m.map_or(String::new(), metres),
            row.width_source.map_or("", WidthSource::name),
            row.certificate.rsc_m.map_or(String::new(), metres),
            row.certificate.hinge_angle_deg().map_or(String::new(), degrees),
            verdict,
            self.head.cells(row.uses, row.need_width_m, relative),
            printable(&road.join(" ")),
        )
    }

    fn members(&self, row: &EdgeRow, relative: Option<Relative>) -> Map<String, Value> {
        members(&EdgeRow::COLUMNS, row.cells(&self.head.vehicle, self.head.policy), relative)
    }
}

impl Head {
    /// The header line of CSV.
    pub(crate) fn names(&self, columns: &[Column]) -> String {
        let more = if self.relative_to.is_some() { &Relative::COLUMNS[..] } else { &[] };
        columns.iter().chain(more).map(|(name, _)| *name).collect::<Vec<_>>().join(",")
    }

    /// The headings of the columns that a table for people has on demand.
    pub(crate) fn heading(&self) -> String {
        let uses = if self.uses { used("uses") } else { String::new() };
        let needs = if self.needs { need("needs") } else { String::new() };
        uses + needs.as_str()
            + self.relative_to.as_ref().map_or_else(String::new, |_| padded(&["relative_m", "as_reference"])).as_str()
    }

    /// The cells of these columns: the narrowest policy, what would be enough, metres, and the comparison.
    pub(crate) fn cells(&self, uses: Option<Policy>, need_m: Option<f64>, relative: Option<Relative>) -> String {
        let uses = if self.uses { used(uses.map_or("-", Policy::name)) } else { String::new() };
        let metres = need_m.map_or_else(String::new, |m| format!("{m:.2} m"));
        let needs = if self.needs { need(&metres) } else { String::new() };
        uses + needs.as_str()
            + relative.map_or_else(String::new, |relative| padded(&relative::words(relative))).as_str()
    }

    /// The member of JSON that names the reference.
    pub(crate) fn member(&self) -> String {
        self.relative_to.as_ref().map_or_else(String::new, |id| format!("\"relative_to\":{},", json!(id)))
    }
}

fn used(cell: &str) -> String {
    format!("{cell:<11}  ")
}

fn need(cell: &str) -> String {
    format!("{cell:>7}  ")
}

fn padded(cells: &[impl AsRef<str>; 2]) -> String {
    let [relative_m, as_reference] = cells.each_ref().map(AsRef::as_ref);
    format!("{relative_m:>10}  {as_reference:<12}  ")
}

/// The members of a JSON object with these columns, and after them those of the comparison.
pub(crate) fn members<const N: usize>(
    columns: &[Column; N],
    cells: [Cell<'_>; N],
    relative: Option<Relative>,
) -> Map<String, Value> {
    let own = columns.iter().map(|(name, _)| (*name).to_owned()).zip(cells.map(Value::from));
    own.chain(relative.into_iter().flat_map(relative::members)).collect()
}

/// A cell of CSV by RFC 4180. Null is an empty cell.
pub(crate) fn csv(value: &Value) -> String {
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
