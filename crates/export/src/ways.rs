//! Matches the extract's ways with the database's edges: finds the nodes of a way that each edge passes.
//!
//! Both streams are in order of way ids, so a merge suffices and nothing of the network is kept. In the network, nodes at one
//! place are one node. If the edges' ends and lengths therefore match a way's nodes in several ways, the whole way is reported as
//! unclear, and the caller must refuse all of it.

use std::iter::Peekable;

use super::ExportError;
use crate::osm::NodeId;
use crate::osm::facts::Direction;
use crate::osm::pbf::copy::Blobs;
use crate::rows::EdgeNo;
use crate::rows::EdgeStep;
use crate::store::{RowStream, StoreError};

use super::Source;

/// The message for an extract that is not sorted. `ingest` accepts such an extract, but the merge does not.
const SORT: &str = "this export needs objects sorted by id; sort them with `osmium sort`, then ingest that file";

/// Refuses negative ids. Valhalla 3.9.1 takes −5 for 2^64 − 5, and OSRM 26.10 does not read such a file.
///
/// # Errors
/// The first negative one of the object's id and those that it names.
pub(super) fn check_ids(kind: &str, id: i64, named: &[i64]) -> Result<(), String> {
    match std::iter::once(&id).chain(named).find(|id| **id < 0) {
        None => Ok(()),
        Some(negative) => Err(format!(
            "{kind} {id} has the negative id {negative}, which engines do not read or take for another one; number the file anew with \
             `osmium sort` and `osmium renumber`, then ingest that file"
        )),
    }
}

/// Decodes ids, which the format stores as differences from one to the next.
pub(super) fn ids(steps: &[i64]) -> Vec<i64> {
    let next = |id: &mut i64, step: &i64| {
        *id = id.wrapping_add(*step);
        Some(*id)
    };
    steps.iter().scan(0, next).collect()
}

/// A stretch of a way between two junctions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WayStretch {
    /// Index of the first node in the way's references.
    pub(super) first: usize,
    /// Index of the last node in the way's references.
    pub(super) last: usize,
    /// The edges along the way and against it.
    pub(super) edges: [Option<EdgeNo>; 2],
    /// RSC of the two edges, metres.
    pub(super) rsc_m: [Option<f64>; 2],
}

/// The network's edges on a way.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum OnWay {
    /// There are none; the way is no road of the network.
    Nothing,
    /// The stretches in way order. They overlap only at their ends.
    Stretches(Vec<WayStretch>),
    /// The way has these edges, but their places are not clear.
    Unclear(Vec<EdgeNo>),
}

/// A stream of edges that follows a stream of ways.
pub(super) struct WayEdges<'d> {
    rows: Peekable<RowStream<'d, EdgeStep>>,
    last_way: i64,
}

impl<'d> WayEdges<'d> {
    /// Follows the rows of [`crate::store::Database::edge_steps`].
    #[must_use]
    pub(super) fn new(rows: RowStream<'d, EdgeStep>) -> Self {
        Self { rows: rows.peekable(), last_way: i64::MIN }
    }

    /// The edges of the next way. Ids must ascend.
    ///
    /// # Errors
    /// Ids do not ascend (the text says what to do), the extract lacks a way of the network, or the database cannot be read.
    pub(super) fn of(&mut self, way_id: i64, refs: &[i64]) -> Result<OnWay, String> {
        if way_id <= self.last_way {
            return Err(format!(
                "way {way_id} comes after way {}: sort it with `osmium sort`, then ingest again",
                self.last_way
            ));
        }
        self.last_way = way_id;
        let mut rows = Vec::new();
        while let Some(row) = self.rows.next_if(|row| row.as_ref().map_or(true, |row| row.edge.way_id <= way_id)) {
            let row = row.map_err(|e: StoreError| e.to_string())?;
            if row.edge.way_id < way_id {
                return Err(format!("way {} of the network is not where its id belongs: {SORT}", row.edge.way_id));
            }
            rows.push(row);
        }
        Ok(on_way(&rows, refs))
    }

    /// Checks that every edge had its way.
    ///
    /// # Errors
    /// The extract lacks a way.
    pub(super) fn finish(mut self) -> Result<(), String> {
        match self.rows.next() {
            None => Ok(()),
            Some(Ok(row)) => Err(format!("way {} of the network is not where its id belongs: {SORT}", row.edge.way_id)),
            Some(Err(error)) => Err(error.to_string()),
        }
    }
}

fn on_way(rows: &[EdgeStep], refs: &[i64]) -> OnWay {
    if rows.is_empty() {
        return OnWay::Nothing;
    }
    // Adjacent repetitions of a node count as one.
    let line: Vec<(usize, i64)> = {
        let mut line: Vec<(usize, i64)> = refs.iter().copied().enumerate().collect();
        line.dedup_by_key(|node| node.1);
        line
    };
    let mut stretches = Vec::new();
    let mut at = 0;
    for both in rows.chunk_by(|a, b| a.shape_start == b.shape_start) {
        let Some(place) = place_of(both, &line, at) else {
            return OnWay::Unclear(rows.iter().map(|row| row.edge.index).collect());
        };
        at = place + both[0].positions as usize - 1;
        let of = |direction| both.iter().find(|row| row.edge.direction == direction);
        let [along, against] = [of(Direction::Forward), of(Direction::Backward)];
        let (edges, rsc_m) =
            ([along, against].map(|row| row.map(|row| row.edge.index)), [along, against].map(|row| row?.rsc_m));
        stretches.push(WayStretch { first: line[place].0, last: line[at].0, edges, rsc_m });
    }
    OnWay::Stretches(stretches)
}

/// The index on the line at which a stretch starts: where the last stretch ended, or, after nodes that the file lacks, the only
/// matching place.
fn place_of(both: &[EdgeStep], line: &[(usize, i64)], at: usize) -> Option<usize> {
    let row = both.first()?;
    let ends = match row.edge.direction {
        Direction::Forward => [row.edge.from_node, row.edge.to_node],
        Direction::Backward => [row.edge.to_node, row.edge.from_node],
    };
    let steps = (row.positions as usize).checked_sub(1).filter(|&steps| steps > 0)?;
    let ends = ends.map(NodeId::get);
    let fits = |&place: &usize| {
        line.get(place).is_some_and(|node| node.1 == ends[0])
            && line.get(place + steps).is_some_and(|node| node.1 == ends[1])
    };
    if fits(&at) {
        return Some(at);
    }
    let mut places = (at..line.len()).filter(fits);
    let place = places.next()?;
    places.next().is_none().then_some(place)
}

impl Source<'_> {
    /// The blobs of the extract that the database was made from.
    ///
    /// # Errors
    /// No extract is given, it cannot be read, or it is another one.
    pub fn blobs(&self, target: &'static str) -> Result<Blobs, ExportError> {
        let provenance = &self.header.provenance;
        let Some(path) = &self.ask.extract else {
            return Err(ExportError::NoExtract { target, input: provenance.input.clone() });
        };
        self.reporter.begin("check", std::fs::metadata(path).map_or(0, |data| data.len()));
        let blobs = Blobs::open(path, &|done, _| self.reporter.advance(done))?;
        self.reporter.end();
        let wanted = provenance.input_blake3.clone().unwrap_or_default();
        if blobs.blake3() != wanted {
            return Err(ExportError::OtherExtract {
                path: path.clone(),
                database: self.ask.db.clone(),
                found: blobs.blake3().to_owned(),
                wanted,
                input: provenance.input.clone(),
            });
        }
        Ok(blobs)
    }

    /// An error about the extract's content.
    #[must_use]
    pub fn extract_error(&self, detail: String) -> ExportError {
        ExportError::Content { path: self.ask.extract.clone().unwrap_or_default(), detail }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;
    use crate::rows::EdgeKey;
    use crate::verdict::Verdict;

    fn row(
        edge: u32,
        shape_start: u32,
        positions: u32,
        [from_node, to_node]: [i64; 2],
        direction: Direction,
    ) -> EdgeStep {
        let [from_node, to_node] = [from_node, to_node].map(NodeId::new);
        let edge = EdgeKey { index: EdgeNo::new(edge), id: i64::from(edge), way_id: 1, from_node, to_node, direction };
        let (verdict, rsc_m, width_source) = (Verdict::Safe, None, None);
        EdgeStep { edge, shape_start, positions, verdict, rsc_m, width_source }
    }

    use Direction::{Backward, Forward};

    fn stretches(rows: &[EdgeStep], refs: &[i64]) -> Vec<(usize, usize)> {
        match on_way(rows, refs) {
            OnWay::Stretches(stretches) => stretches.iter().map(|stretch| (stretch.first, stretch.last)).collect(),
            _ => Vec::new(),
        }
    }

    #[test]
    fn edges_lie_one_after_the_other_along_their_way() {
        let rows = [row(0, 0, 3, [1, 3], Forward), row(1, 0, 3, [3, 1], Backward), row(2, 2, 2, [3, 4], Forward)];
        assert_eq!(stretches(&rows, &[1, 2, 3, 4]), [(0, 2), (2, 3)]);
        assert_eq!(stretches(&rows, &[1, 2, 2, 3, 4]), [(0, 3), (3, 4)]);
        let OnWay::Stretches(found) = on_way(&rows, &[1, 2, 3, 4]) else { panic!() };
        let number = |edge: Option<EdgeNo>| edge.map(EdgeNo::get);
        let edges = [found[0].edges, found[1].edges].map(|edges| edges.map(number));
        assert_eq!(edges, [[Some(0), Some(1)], [Some(2), None]]);
    }

    #[test]
    fn nodes_that_the_file_lacks_are_passed_over_where_that_is_clear() {
        // Node 9 is missing from the extract, so the network has edges 1-2 and 3-4.
        assert_eq!(
            stretches(&[row(0, 0, 2, [1, 2], Forward), row(1, 2, 2, [3, 4], Forward)], &[1, 2, 9, 3, 4]),
            [(0, 1), (3, 4)]
        );
        // The way runs twice along a loop behind a missing node, so the edge's place is not clear.
        let again = [row(0, 0, 2, [1, 2], Forward)];
        assert_eq!(on_way(&again, &[9, 1, 2, 1, 2]), OnWay::Unclear(vec![EdgeNo::new(0)]));
    }

    #[test]
    fn a_way_that_meets_itself_keeps_its_order() {
        let rows = [row(0, 0, 3, [1, 1], Forward), row(1, 2, 2, [1, 4], Forward)];
        assert_eq!(stretches(&rows, &[1, 2, 1, 4]), [(0, 2), (2, 3)]);
    }

    #[test]
    fn a_node_made_one_with_another_makes_a_way_unclear_and_no_edges_mean_no_road() {
        assert_eq!(on_way(&[row(7, 0, 2, [1, 3], Forward)], &[1, 2, 3]), OnWay::Unclear(vec![EdgeNo::new(7)]));
        assert_eq!(on_way(&[], &[1, 2, 3]), OnWay::Nothing);
    }
}
