//! From roads to the extract: ways sorted by number, one table of their nodes, texts.

use std::path::Path;

use rayon::prelude::*;

use super::account::{Account, SEGMENT};
use super::connectors::Connectors;
use super::error::{OvertureError, OvertureProblem};
use super::segment::RoadSegment;
use super::turns;
use crate::osm::{Extract, LonLat, NodeId, NodeTable, StringPool, Way};
use crate::rows::SegmentRow;

/// Makes the extract, and says which segment each way is of. `path` names the source in errors.
pub(super) fn extract(
    mut roads: Vec<RoadSegment>,
    connectors: &Connectors,
    account: &mut Account,
    path: &Path,
) -> Result<(Extract, Vec<SegmentRow>), OvertureError> {
    let failed = |problem: OvertureProblem| OvertureError::of_file(path, problem);
    roads.par_sort_by_key(|road| (road.key.number(), road.key));
    let before = roads.len();
    roads.dedup_by_key(|road| road.key);
    // Files of neighbouring places repeat segments. What was counted as kept is then left out.
    account.superseded(SEGMENT, "duplicate_id", (before - roads.len()) as u64);
    let turns = turns::resolve(&mut roads, account);
    let restrictions = turns::restrictions(&roads, &turns);

    let mut parts: Vec<(i64, u32, usize, usize)> = Vec::new();
    for (index, road) in roads.iter().enumerate() {
        parts.extend(road.parts().map(|(from, to, _)| (road.way(from), index as u32, from, to)));
    }
    parts.par_sort_unstable();
    if let Some(pair) = parts.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let [one, other] = [&pair[0], &pair[1]].map(|part| roads[part.1 as usize].id.to_string());
        let problem = OvertureProblem::Collision { number: pair[0].0, other };
        return Err(OvertureError { id: Some(one), ..failed(problem) });
    }

    let mut extract = Extract { restrictions, ..Extract::default() };
    let mut places: Vec<(NodeId, LonLat)> = Vec::new();
    let mut strings = StringPool::default();
    let mut segments = Vec::with_capacity(parts.len());
    for &(id, index, from, to) in &parts {
        let road = &roads[index as usize];
        let begin =
            u32::try_from(extract.refs.len()).map_err(|_| failed(OvertureProblem::TooLarge("node references")))?;
        for (&node, &place) in road.line.nodes[from..=to].iter().zip(&road.line.places[from..=to]) {
            places.push((node, place));
            // A connector that is named twice may be on two vertices in a row.
            if extract.refs.get(begin as usize..).and_then(<[NodeId]>::last) != Some(&node) {
                extract.refs.push(node);
            }
        }
        if extract.refs.len() < begin as usize + 2 {
            extract.refs.truncate(begin as usize);
            continue;
        }
        let end =
            u32::try_from(extract.refs.len()).map_err(|_| failed(OvertureProblem::TooLarge("node references")))?;
        let Some((.., (facts, reference))) = road.parts().find(|part| part.0 == from) else { continue };
        let mut facts = facts.clone();
        facts.name = road.name.as_deref().map(|name| strings.intern(name));
        facts.reference = reference.as_deref().map(|reference| strings.intern(reference));
        extract.ways.push(Way { id, refs: begin..end, facts });
        let share = [road.line.share(from), road.line.share(to)];
        segments.push(SegmentRow { way_id: id, segment_id: road.id.to_string(), share });
    }
    extract.strings = strings;
    extract.nodes = nodes(places).map_err(failed)?;
    connectors.count(account, |node| extract.nodes.index(node).is_some());
    Ok((extract, segments))
}

/// The table of nodes. A connector that no file has lies where the first road has it; elsewhere it would be another node.
fn nodes(mut places: Vec<(NodeId, LonLat)>) -> Result<NodeTable, OvertureProblem> {
    places.par_sort_unstable();
    places.dedup();
    let near = |a: LonLat, b: LonLat| a.lon_e7.abs_diff(b.lon_e7).max(a.lat_e7.abs_diff(b.lat_e7)) <= NEAR_E7;
    if let Some(pair) = places.windows(2).find(|pair| pair[0].0 == pair[1].0 && !near(pair[0].1, pair[1].1)) {
        let ((lon, lat), number) = (pair[1].1.degrees(), pair[0].0);
        return Err(OvertureProblem::Collision {
            number: number.get(),
            other: format!("the node at {lon:.7}, {lat:.7}"),
        });
    }
    places.dedup_by_key(|(id, _)| *id);
    let (ids, places) = places.into_iter().map(|(id, place)| (id, Some(place))).unzip();
    Ok(NodeTable { ids, places })
}

/// Two places of one connector, from the shares of two segments, differ by less, 1e-7 degree (about 1 m).
const NEAR_E7: u32 = 100;
