//! Finds the sequences of permitted edges that may not be driven: refused turns, turn restrictions and refused passages.
//!
//! A passage is refused by its own certificate, even if the edges between and the turns onto and off them are permitted. `netcert route`
//! may still try the parts, because it certifies the whole route afterwards. An export cannot, so it closes the sequence. Formats
//! without sequences refuse the first step of the sequence.

use crate::rows::EdgeNo;
use crate::rows::Rings;
use rustc_hash::FxHashSet;

use super::{ExportError, Source};
use crate::rows::TurnStep;

impl Source<'_> {
    /// Whether the step is a turn that is refused although both its edges are permitted.
    pub(super) fn refuses_turn(&self, step: &TurnStep) -> bool {
        let open = self.permitted.edges.get(step.from.index()) && self.permitted.edges.get(step.to.index());
        step.arcs.is_none() && open && !self.permitted.turns.get(step.turn.index())
    }

    /// The sequences of two or more permitted edges that may not be driven one right after the other, sorted. A sequence that
    /// contains a refused turn is left out as redundant. A sequence of two edges is therefore always a step straight on.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(super) fn sequences(&self) -> Result<Vec<Vec<EdgeNo>>, ExportError> {
        let (vehicle, policy) = (&self.ask.vehicle, self.ask.policy);
        let mut database = self.database()?;
        let rings = Rings::new(database.rings()?);
        let mut sequences = database.forbidden_sequences()?;
        for step in self.told(database.turn_steps(vehicle, policy)?) {
            let step = step?;
            let refused = step.arcs.filter(|_| !self.permitted.turns.get(step.turn.index()));
            if let Some(arcs) = refused.and_then(|arcs| rings.through(arcs)) {
                sequences.push([&[step.from], &arcs[..], &[step.to]].concat());
            }
        }
        sequences.retain(|edges| edges.len() > 1 && edges.iter().all(|&edge| self.permitted.edges.get(edge.index())));
        let steps: FxHashSet<[EdgeNo; 2]> = sequences.iter().flat_map(|edges| pairs(edges)).collect();
        let mut refused = FxHashSet::default();
        for step in self.told(database.turn_steps(vehicle, policy)?) {
            let step = step?;
            if self.refuses_turn(&step) && steps.contains(&[step.from, step.to]) {
                refused.insert([step.from, step.to]);
            }
        }
        sequences.retain(|edges| !pairs(edges).any(|pair| refused.contains(&pair)));
        sequences.sort_unstable();
        sequences.dedup();
        Ok(sequences)
    }
}

fn pairs(edges: &[EdgeNo]) -> impl Iterator<Item = [EdgeNo; 2]> {
    edges.array_windows().copied()
}
