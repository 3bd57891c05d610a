//! A newer ingest takes the register of the older database over: every measurement is matched anew, and what is matched otherwise is told.

use super::account;
use crate::account::AccountRow;
use crate::network::Network;
use crate::reporter::Reporter;
use crate::store::Register;
use crate::words::Named as _;
use netcert_evidence::{self as evidence, Entry, MeasurementTarget, State};

/// Notes on measurements that an ingest prints one by one.
const MOST_NOTES: usize = 20;

/// The register of an older database, matched anew to another network, and what became of it in words.
pub(crate) fn carried_over(
    network: &mut Network,
    mut register: Register,
    reporter: &dyn Reporter,
) -> (Register, Vec<AccountRow>) {
    let before = register.entries.clone();
    evidence::match_again(network, &mut register.entries);
    let decision = evidence::decide(network, &mut register.entries);
    network.site = decision.site;
    let mut notes: Vec<String> =
        before.iter().zip(&register.entries).filter_map(|(old, new)| difference(old, new)).collect();
    notes.extend(decision.conflicts.into_iter().map(|conflict| format!("conflict: {}", conflict.what)));
    reporter.note(&format!("{} measurements taken over from the older database", register.entries.len()));
    notes.iter().take(MOST_NOTES).for_each(|note| reporter.note(note));
    if notes.len() > MOST_NOTES {
        let more = notes.len() - MOST_NOTES;
        reporter.note(&format!("and {more} more such measurements; `netcert evidence list` shows all"));
    }
    let account = account(&register.entries);
    (register, account)
}

/// How a measurement is matched otherwise than before.
fn difference(old: &Entry, new: &Entry) -> Option<String> {
    let name = format!("measurement {} ({}:{}), {}", new.no, new.file, new.row.number, new.row.quantity.name());
    let why = new.why.as_deref().unwrap_or_default();
    match (old.state, new.state) {
        (State::Matched, State::Matched) if old.targets().eq(new.targets()) => None,
        (State::Matched, State::Matched) => {
            Some(format!("{name}: matched {} before, and {} now", places(old), places(new)))
        }
        (State::Matched, now) => Some(format!("{name}: matched before, {} now: {why}", now.name())),
        (then, State::Matched) => Some(format!("{name}: {} before, now matched: {}", then.name(), places(new))),
        _ => None,
    }
}

/// The places of an entry in words, the first few of them.
fn places(entry: &Entry) -> String {
    const TOLD: usize = 3;
    let told = entry.targets().take(TOLD).map(|target| match target {
        MeasurementTarget::Edge(id) => format!("edge {id}"),
        MeasurementTarget::Corner { node, edges: None } | MeasurementTarget::Area(node) => format!("junction {node}"),
        MeasurementTarget::Corner { node, edges: Some([from, to]) } => {
            format!("the corner of edges {from} and {to} at node {node}")
        }
    });
    let told: Vec<String> = told.collect();
    let more = entry.places.len().saturating_sub(TOLD);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    told.join(", ") + more.as_str()
}
