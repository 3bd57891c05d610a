//! For pgRouting: tables in `COPY` format, and a psql script that loads all of them in one transaction.
//!
//! | table | for |
//! | --- | --- |
//! | `netcert.edge` | `pgr_dijkstra` and all others: directed edges, `cost` in metres, −1 where refused; `reverse_cost` is always −1 |
//! | `netcert.restriction` | `pgr_trsp`: refused turns and passages, turning back, restrictions over ways |
//! | `netcert.step` | `pgr_dijkstra` over edges as vertices: every permitted step from one edge into the next |
//! | `netcert.header` | the header: what the permits depend on |
//!
//! `netcert.step` expresses everything for the plain algorithm, and only it has passages. Restrictions over ways
//! and refused passages lack their first step there, because no state stores the path. `netcert.edge` alone has no turns.

use std::io::{self, Write};

use rustc_hash::FxHashSet;

use super::{Options, Target};
use crate::osm::LonLat;
use crate::osm::facts::{Policy, WidthSource};
use crate::rows::EdgeNo;
use crate::rows::Rings;
use crate::words::Named;
use crate::{Destination, ExportEdge, ExportError, Layout, PermitRefusal, Sink, Source};

/// Creates the tables in one transaction and loads them from the files beside it.
const LOAD: &str = include_str!("pgrouting_load.sql");

/// A missing value in `COPY` format.
const NULL: &[u8] = b"\\N";

/// `pgrouting`
pub(super) struct PgRouting;

impl Target for PgRouting {
    fn name(&self) -> &'static str {
        "pgrouting"
    }

    fn about(&self) -> &'static str {
        "pgRouting: tables of edges, refused turns and permitted steps, and a psql script that loads them"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::Folder { target: self.name(), instead: "" }
    }

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        destination.write_whole("load.sql", LOAD.as_bytes())?;
        let mut header = destination.create("header.copy")?;
        field(&mut header, &source.header.json().to_string())?;
        header.write_all(b"\n")?;
        header.close()?;
        edges(source, destination.create("edge.copy")?)?;
        restrictions(source, destination.create("restriction.copy")?)?;
        steps(source, destination.create("step.copy")?)
    }
}

fn edges(source: &Source<'_>, mut out: Sink) -> Result<(), ExportError> {
    let mut database = source.database()?;
    for edge in source.edges(&mut database)? {
        edge_line(&mut out, &edge?)?;
    }
    out.close()
}

fn edge_line(out: &mut dyn Write, edge: &ExportEdge) -> io::Result<()> {
    let row = &edge.row;
    let cost = if edge.refusal.is_none() { row.length_m } else { -1.0 };
    let (id, edge_id, way) = (u64::from(row.edge.index) + 1, row.edge.id, row.edge.way_id);
    write!(out, "{id}\t{edge_id}\t{way}\t{}\t{}\t{cost}\t{}\t", row.edge.from_node, row.edge.to_node, row.length_m)?;
    field(out, &row.road.highway)?;
    let refusal = edge.refusal.map(PermitRefusal::words);
    for text in [row.road.name.as_deref(), row.road.reference.as_deref(), refusal.as_deref()] {
        out.write_all(b"\t")?;
        match text {
            Some(text) => field(out, text)?,
            None => out.write_all(NULL)?,
        }
    }
    for number in [row.certificate.rsc_m, row.certificate.hinge_margin_deg, row.width_m] {
        match number {
            Some(number) => write!(out, "\t{number}")?,
            None => out.write_all(b"\t\\N")?,
        }
    }
    let words = [row.width_source.map(WidthSource::name), row.uses.map(Policy::name)].map(|word| word.unwrap_or("\\N"));
    write!(out, "\t{}\t", words.join("\t"))?;
    ewkb(out, &row.line)?;
    out.write_all(b"\n")
}

/// Writes refused turns between permitted edges, and refused sequences. The script finds turning back from the edges.
fn restrictions(source: &Source<'_>, mut out: Sink) -> Result<(), ExportError> {
    let mut database = source.database()?;
    for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
        let step = step?;
        if source.refuses_turn(&step) {
            path(&mut out, &[step.from, step.to])?;
        }
    }
    for sequence in source.sequences()? {
        path(&mut out, &sequence)?;
    }
    out.close()
}

/// Writes permitted steps from edge to edge, with the arcs between them.
fn steps(source: &Source<'_>, mut out: Sink) -> Result<(), ExportError> {
    let permitted = &source.permitted;
    let mut database = source.database()?;
    let rings = Rings::new(database.rings()?);
    let first_steps = |sequences: Vec<Vec<EdgeNo>>| -> FxHashSet<[EdgeNo; 2]> {
        sequences.iter().filter_map(|edges| edges.first_chunk().copied()).collect()
    };
    // A restriction may lead over a passage's arcs, which need no permit. A refused passage does not close other passages.
    let (by_law, mut banned) = (first_steps(database.forbidden_sequences()?), first_steps(source.sequences()?));
    banned.extend(&by_law);
    for pair in source.told(database.straight_on()?) {
        if let (from, Some(to)) = pair?
            && permitted.edges.get(from.index())
            && permitted.edges.get(to.index())
            && !banned.contains(&[from, to])
        {
            step_line(&mut out, [from, to], &[])?;
        }
    }
    for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
        let step = step?;
        if !permitted.turns.get(step.turn.index()) || banned.contains(&[step.from, step.to]) {
            continue;
        }
        match step.arcs.map(|arcs| rings.through(arcs)) {
            None => step_line(&mut out, [step.from, step.to], &[])?,
            Some(Some(arcs)) if step.arcs.is_some_and(|[first, _]| !by_law.contains(&[step.from, first])) => {
                step_line(&mut out, [step.from, step.to], &arcs)?;
            }
            Some(_) => {}
        }
    }
    out.close()
}

fn path(out: &mut dyn Write, edges: &[EdgeNo]) -> io::Result<()> {
    writeln!(out, "{}", array(edges))
}

fn step_line(out: &mut dyn Write, [from, to]: [EdgeNo; 2], arcs: &[EdgeNo]) -> io::Result<()> {
    writeln!(out, "{}\t{}\t{}", u64::from(from) + 1, u64::from(to) + 1, array(arcs))
}

fn array(edges: &[EdgeNo]) -> String {
    let ids: Vec<String> = edges.iter().map(|&edge| (u64::from(edge) + 1).to_string()).collect();
    format!("{{{}}}", ids.join(","))
}

/// Writes a text in `COPY` format: <https://www.postgresql.org/docs/15/sql-copy.html>
fn field(out: &mut dyn Write, text: &str) -> io::Result<()> {
    let escaped = text.replace('\\', "\\\\").replace('\t', "\\t").replace('\n', "\\n").replace('\r', "\\r");
    // A text in PostgreSQL cannot contain a zero byte.
    out.write_all(escaped.replace('\0', "\u{fffd}").as_bytes())
}

/// Writes a line for PostGIS: EWKB in hexadecimal, little endian, WGS 84.
fn ewkb(out: &mut dyn Write, line: &[LonLat]) -> io::Result<()> {
    const LINESTRING_WITH_SRID: u32 = 0x2000_0002;
    let mut bytes = vec![1];
    bytes.extend(LINESTRING_WITH_SRID.to_le_bytes());
    bytes.extend(4326_u32.to_le_bytes());
    bytes.extend((line.len() as u32).to_le_bytes());
    for (lon, lat) in line.iter().map(|place| place.degrees()) {
        bytes.extend(lon.to_le_bytes());
        bytes.extend(lat.to_le_bytes());
    }
    bytes.iter().try_for_each(|byte| write!(out, "{byte:02x}"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_would_end_a_field_or_a_line_is_escaped() {
        let mut out = Vec::new();
        field(&mut out, "A\tB\\N\nC\r\0").unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "A\\tB\\\\N\\nC\\r\u{fffd}");
    }

    #[test]
    fn a_line_is_ewkb() {
        let mut out = Vec::new();
        ewkb(&mut out, &[LonLat { lon_e7: 10_000_000, lat_e7: 0 }]).unwrap();
        // SELECT encode(ST_AsEWKB('SRID=4326;LINESTRING(1 0)'), 'hex') has the same form.
        assert_eq!(String::from_utf8(out).unwrap(), "0102000020e610000001000000000000000000f03f0000000000000000");
    }

    #[test]
    fn ids_are_rows_of_the_edge_table() {
        assert_eq!((array(&[0, 41].map(EdgeNo::new)), array(&[])), ("{1,42}".to_owned(), "{}".to_owned()));
    }
}
