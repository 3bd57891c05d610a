//! The measurements behind an explained edge or turn, in words and as JSON.

use std::io::Write;

use netcert::network::Network;
use netcert::store::{Database, Measured, StoreError};
use netcert::turns::TurnFacts;
use serde_json::{Value, json};

use super::explain::wrapped;
use super::output::printable;

/// The measurements that count on an edge.
pub(super) fn of_edge(database: &mut Database, network: &Network, edge: u32) -> Result<Vec<Measured>, StoreError> {
    let ids: Vec<i64> = network.edges.get(edge as usize).map(|edge| edge.id).into_iter().collect();
    database.measured(&ids, None)
}

/// The measurements that count on the edges of a turn, those between included, and at its first corner.
pub(super) fn of_turn(
    database: &mut Database,
    network: &Network,
    turn: &TurnFacts,
) -> Result<Vec<Measured>, StoreError> {
    let edge = |index: u32| network.edges.get(index as usize);
    let way = [turn.movement.from].into_iter().chain(turn.through.iter().copied()).chain([turn.movement.to]);
    let way: Vec<_> = way.filter_map(edge).collect();
    let corner = match way[..] {
        [first, second, ..] => Some((first.to_node, [first.id, second.id])),
        _ => None,
    };
    database.measured(&way.iter().map(|edge| edge.id).collect::<Vec<_>>(), corner)
}

/// The measurements as JSON.
pub(super) fn json(all: &[Measured]) -> Value {
    let row = |m: &Measured| {
        json!({
            "evidence_no": m.evidence_no, "quantity": m.quantity, "value": m.value, "counts": m.lower,
            "source": m.source, "date": m.date, "file": m.file, "file_row": m.file_row,
        })
    };
    all.iter().map(row).collect()
}

/// Prints a line for each measurement.
pub(super) fn tell(out: &mut dyn Write, all: &[Measured]) -> std::io::Result<()> {
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
