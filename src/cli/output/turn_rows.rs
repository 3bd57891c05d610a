//! Writes turns with their certificates as a table, CSV, JSON or GeoJSON.
//!
//! Names and units are those of the database's tables `turn` and `turn_certificate`.

use std::collections::BTreeMap;
use std::io::{self, Write};

use netcert::rows::{Relative, TurnRow};
use netcert::turns::KerbSource;
use netcert::words::{Named, VerdictKind, verdict_words};
use serde_json::{Map, Value, json};

use crate::cli::output::rows::{self, Format, Head, csv};
use crate::cli::output::{grouped, printable};

/// A turn with its comparison, if there is one.
pub(crate) type Row = (TurnRow, Option<Relative>);

/// Writes all rows.
pub(crate) fn write(format: Format, head: &Head, rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    match format {
        Format::Table => table(head, rows, out),
        Format::Csv => {
            writeln!(out, "{}", head.names(&TurnRow::COLUMNS))?;
            for row in rows {
                let cells: Vec<String> = members(head, row).iter().map(|(_, value)| csv(value)).collect();
                writeln!(out, "{}", cells.join(","))?;
            }
            Ok(())
        }
        Format::Json => {
            let (vehicle, scope) = (json!(head.vehicle), json!(head.scope));
            let (version, policy) = (env!("CARGO_PKG_VERSION"), head.policy.name());
            write!(
                out,
                "{{\"netcert\":\"{version}\",\"vehicle_id\":{vehicle},\"corridor\":\"{policy}\",{}\"scope\":{scope},\"turns\":[",
                head.member()
            )?;
            items(out, rows.iter().map(|row| Value::Object(members(head, row))))
        }
        Format::Geojson => {
            let (member, scope) = (head.member(), json!(head.scope));
            write!(out, "{{\"type\":\"FeatureCollection\",{member}\"scope\":{scope},\"features\":[")?;
            let feature = |row: &Row| {
                let coordinates: Vec<Value> = row.0.line.iter().map(|place| json!(place.degrees())).collect();
                json!({
                    "type": "Feature",
                    "id": row.0.turn.id.to_string(),
                    "geometry": {"type": "LineString", "coordinates": coordinates},
                    "properties": members(head, row),
                })
            };
            items(out, rows.iter().map(feature))
        }
    }
}

fn items(out: &mut dyn Write, values: impl Iterator<Item = Value>) -> io::Result<()> {
    for (i, value) in values.enumerate() {
        write!(out, "{}{value}", if i == 0 { "\n" } else { ",\n" })?;
    }
    writeln!(out, "\n]}}")
}

fn table(head: &Head, rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "{:>19}  {:>11} {:<12} {:>6}  {:>6}  {:>7}  {:>7}  {:<22} {}from → to",
        "turn_id",
        "node",
        "kind",
        "angle",
        "kerb",
        "rsc",
        "hinge",
        "verdict",
        head.heading()
    )?;
    for (row, relative) in rows {
        let (verdict, reason) = verdict_words(row.certificate.verdict);
        let verdict = if reason.is_empty() { verdict.to_owned() } else { format!("{verdict}: {reason}") };
        let name = |name: &Option<String>| printable(name.as_deref().unwrap_or("–"));
        writeln!(
            out,
            "{:>19}  {:>11} {:<12} {:>5.0}°  {:>6}  {:>7}  {:>7}  {:<22} {}{} → {}",
            row.turn.id,
            row.via_node,
            row.kind,
            row.angle_deg,
            kerb(row),
            row.certificate.rsc_m.map_or(String::new(), |m| format!("{m:.2} m")),
            row.certificate.hinge_angle_deg().map_or(String::new(), |d| format!("{d:.1}°")),
            verdict,
            head.cells(row.uses, row.need_kerb_radius_m, *relative),
            name(&row.turn.from_name),
            name(&row.turn.to_name),
        )?;
    }
    Ok(())
}

/// The assumed kerb radius, or a word that says the corner is mapped.
fn kerb(row: &TurnRow) -> String {
    let mapped = row.kerb_source.as_deref().filter(|source| *source == KerbSource::Mapped.name());
    row.kerb_radius_m.map_or_else(|| mapped.unwrap_or_default().to_owned(), |m| format!("{m:.1} m"))
}

fn members(head: &Head, (row, relative): &Row) -> Map<String, Value> {
    rows::members(&TurnRow::COLUMNS, row.cells(&head.vehicle, head.policy), *relative)
}

/// The number of turns by verdict, in one line.
pub(crate) fn totals(rows: &[Row]) -> String {
    let mut by_verdict: BTreeMap<&str, u64> = BTreeMap::new();
    for (row, _) in rows {
        *by_verdict.entry(verdict_words(row.certificate.verdict).0).or_default() += 1;
    }
    let mut text = format!("{} turns", grouped(rows.len() as u64));
    for kind in VerdictKind::ALL {
        if let Some(&count) = by_verdict.get(kind.name()) {
            text += &format!("; {} {}", kind.name(), grouped(count));
        }
    }
    text
}
