//! What lies behind the roads, gathered on the passes over the file: multipolygons first, then the ways that they or their own tags make
//! part of the backdrop, then the nodes of those ways. None of it is part of the account of roads.

use std::collections::BTreeMap;

use crate::osm::backdrop::{self, Backdrop, BackdropShape};
use crate::osm::changes::{Changes, ObjectKind};
use crate::osm::facts::BackdropForm;
use crate::osm::read_account::BackdropTally;
use crate::osm::{LonLat, NodeId, NodeTable};

use super::backdrop_objects::{AreaRelation, BackdropWay, PlaceNode};
use super::block::Block;
use super::duplicates::keep_last;
use super::error::PbfProblem;
use super::relations;
use super::wire::Cursor;

/// The multipolygons of a block. Those that are `changed` are passed over.
pub(super) fn areas(block: &Block<'_>, changed: &Changes) -> Result<Vec<AreaRelation>, PbfProblem> {
    let mut found = Vec::new();
    for group in &block.groups {
        let mut cursor = Cursor::new(group);
        while let Some(field) = cursor.field()? {
            if field.number == 4 {
                found.extend(relations::area(field.bytes()?, &block.strings, changed)?);
            }
        }
    }
    Ok(found)
}

/// Whether a block holds no relation, judged by the kinds of its objects.
pub(super) fn no_relations(bytes: &[u8]) -> Result<bool, PbfProblem> {
    for group in Block::parse(bytes)?.groups {
        let mut cursor = Cursor::new(group);
        while let Some(field) = cursor.field()? {
            if field.number == 4 {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// Multipolygons and the ways that they name.
#[derive(Debug, Default)]
pub(super) struct AreaGatherer {
    areas: BTreeMap<i64, AreaRelation>,
}

impl AreaGatherer {
    /// Of several with the same id, the file's last one counts.
    pub(super) fn add(&mut self, areas: Vec<AreaRelation>) {
        self.areas.extend(areas.into_iter().map(|area| (area.id, area)));
    }

    /// The ids of all members, sorted and distinct.
    pub(super) fn members(&self) -> Vec<i64> {
        let mut ids: Vec<i64> = self.areas.values().flat_map(|area| &area.members).map(|member| member.0).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    /// The backdrop: multipolygons, ways, then nodes, each by id. `nodes` are those of the ways.
    pub(super) fn finish(
        self,
        mut ways: Vec<BackdropWay>,
        mut places: Vec<PlaceNode>,
        nodes: &NodeTable,
    ) -> (Vec<Backdrop>, BackdropTally) {
        let mut tally = BackdropTally::default();
        let mut all = Vec::new();
        ways.sort_by_key(|way| way.id);
        keep_last(&mut ways, |way| way.id);
        places.sort_by_key(|node| node.id);
        keep_last(&mut places, |node| node.id);
        for AreaRelation { id, kind, name, members } in self.areas.into_values() {
            let of = |hole: bool| {
                let known = |member: &&(i64, bool)| member.1 == hole;
                let refs = |member: &(i64, bool)| {
                    let at = ways.binary_search_by_key(&member.0, |way| way.id).ok()?;
                    ways.get(at).map(|way| way.refs.as_slice())
                };
                let members: Vec<&[NodeId]> = members.iter().filter(known).map(refs).collect::<Option<_>>()?;
                placed_rings(&backdrop::rings(&members)?, nodes)
            };
            if let Some(shape) = area(of(false).zip(of(true)), &mut tally) {
                all.push(Backdrop { kind, object: (ObjectKind::Relation, id), name, shape });
            }
        }
        for BackdropWay { id, kind, name, refs } in ways {
            let Some(kind) = kind else { continue };
            let shape = if kind.form() == BackdropForm::Area {
                area(placed_rings(&[refs], nodes).zip(Some(Vec::new())), &mut tally)
            } else {
                line(&refs, nodes, &mut tally)
            };
            all.extend(shape.map(|shape| Backdrop { kind, object: (ObjectKind::Way, id), name, shape }));
        }
        all.extend(places.into_iter().map(|PlaceNode { id, kind, name, place }| Backdrop {
            kind,
            object: (ObjectKind::Node, id.get()),
            name: Some(name),
            shape: BackdropShape::Place(place),
        }));
        tally.kept = all.len() as u64;
        (all, tally)
    }
}

/// Closed lines of positions.
type Rings = Vec<Vec<LonLat>>;

/// The rings as positions; `None` if a node is missing.
fn placed_rings(rings: &[Vec<NodeId>], nodes: &NodeTable) -> Option<Rings> {
    rings.iter().map(|ring| ring.iter().map(|&id| nodes.place(id)).collect()).collect()
}

/// The shape of an area with these outlines and holes. Without one of them nobody knows what is inside.
fn area(rings: Option<(Rings, Rings)>, tally: &mut BackdropTally) -> Option<BackdropShape> {
    let Some((outer, inner)) = rings.filter(|rings| !rings.0.is_empty()) else {
        tally.incomplete += 1;
        return None;
    };
    let polygons = backdrop::polygons(outer, &inner);
    tally.too_small += u64::from(polygons.is_empty());
    (!polygons.is_empty()).then_some(BackdropShape::Areas(polygons))
}

/// A line has a gap where nodes are missing.
fn line(refs: &[NodeId], nodes: &NodeTable, tally: &mut BackdropTally) -> Option<BackdropShape> {
    let places: Vec<Option<LonLat>> = refs.iter().map(|&id| nodes.place(id)).collect();
    let parts = places.split(Option::is_none).filter(|part| part.len() > 1);
    let simplified =
        |part: &[Option<LonLat>]| backdrop::simplified(&part.iter().flatten().copied().collect::<Vec<_>>());
    let lines: Vec<_> = parts.map(simplified).collect();
    tally.off_file += u64::from(lines.is_empty());
    (!lines.is_empty()).then_some(BackdropShape::Lines(lines))
}
