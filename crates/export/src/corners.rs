//! Finds the edges before a refused corner of a road. Formats that cannot refuse a turn there close the edge.

use rustc_hash::{FxHashMap, FxHashSet};

use super::{ExportError, Source};
use crate::osm::NodeId;
use crate::rows::EdgeNo;

impl Source<'_> {
    /// The permitted edges from which the only way on is a refused turn: nothing else meets where they end.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(super) fn stopped(&self) -> Result<FxHashSet<EdgeNo>, ExportError> {
        let (vehicle, policy) = (&self.ask.vehicle, self.ask.policy);
        let mut database = self.database()?;
        let mut refused: Vec<(EdgeNo, NodeId)> = Vec::new();
        for step in self.told(database.turn_steps(vehicle, policy)?) {
            let step = step?;
            refused.extend(self.refuses_turn(&step).then_some((step.from, step.via_node)));
        }
        // How many ends of pieces meet at each of these nodes. Both edges of a piece come one after the other.
        let mut meeting: FxHashMap<NodeId, u32> = refused.iter().map(|&(_, node)| (node, 0)).collect();
        let mut piece = None;
        for row in self.told(database.edge_steps(vehicle, policy)?) {
            let row = row?;
            if piece.replace(row.shape_start) != Some(row.shape_start) {
                for node in [row.edge.from_node, row.edge.to_node] {
                    meeting.entry(node).and_modify(|ends| *ends += 1);
                }
            }
        }
        Ok(refused.into_iter().filter(|(_, node)| meeting.get(node) == Some(&2)).map(|(edge, _)| edge).collect())
    }
}
