//! Checks the columns of edges that repeat what the database says of their roads: a reader of the table sees these, and certificates use
//! the road's.

use super::{Complaint, Grade, VerifyError};
use crate::network::{Edge, Network};
use crate::osm::facts::highway;
use crate::rows::EdgeFacts;
use crate::store::Database;
use crate::words::Named as _;

/// Complaints about edges whose columns differ from their road.
pub(super) fn check(database: &mut Database, network: &Network) -> Result<Vec<Complaint>, VerifyError> {
    let mut complaints = Vec::new();
    for facts in database.all_edge_facts()? {
        let facts = facts?;
        let detail = match network.edges.get(facts.edge.index.index()) {
            Some(edge) => wrong(network, edge, &facts).map(|column| format!("{column}: not what its road says")),
            None => Some("its road is not there".to_owned()),
        };
        complaints.extend(
            detail.map(|detail| Complaint {
                grade: Grade::Malformed,
                detail: format!("edge {}: {detail}", facts.edge.id),
            }),
        );
    }
    Ok(complaints)
}

/// The first column that is wrong.
fn wrong(network: &Network, edge: &Edge, facts: &EdgeFacts) -> Option<String> {
    let road = network.road(edge);
    let text = |id| network.strings.text(id).to_owned();
    let direction = edge.direction as usize;
    let same = [
        ("way_id", facts.edge.way_id == road.way_id),
        ("oneway", facts.oneway == road.oneway),
        ("highway", facts.road.highway == highway(road.class, road.link)),
        ("name", facts.road.name == road.name.map(text)),
        ("ref", facts.road.reference == road.reference.map(text)),
        ("lanes", facts.lanes == road.lanes),
        ("maxspeed_kmh", facts.maxspeed_kmh == road.max_speed_km_h[direction].map(u8::from)),
        // What nodes and barriers add is stricter than the road.
        ("limits, access and rules", road.legal[direction].merge(&edge.legal) == edge.legal),
        ("open_when", facts.open_when == edge.legal.open_when()),
        ("width_tags", facts.width_tags.as_deref() == road.width_tags.as_deref()),
    ];
    if let Some((column, _)) = same.iter().find(|(_, same)| !same) {
        return Some((*column).to_owned());
    }
    let section = network.section(edge);
    facts.widths.iter().find_map(|&(policy, width_m, source)| {
        let strip = section.strip(policy);
        let width = strip.map(|strip| (f64::from(strip.width_m()) * 1000.0).round() / 1000.0);
        (width != width_m || strip.map(|strip| strip.source) != source).then(|| format!("{} width", policy.name()))
    })
}
