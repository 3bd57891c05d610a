//! The verdicts of edges, which certificates of turns need.

use crate::network::{EdgeNo, Portion};
use crate::settings::Settings;
use crate::stet::Model;
use crate::verdict::{UnknownReason, Verdict};

/// The verdicts by vehicle and edge, which certificates of turns need. Empty if no turns are certified.
pub(super) struct EdgeVerdicts(pub(super) Vec<Vec<Verdict>>);

impl EdgeVerdicts {
    pub(super) fn new(edges: usize, models: &[Model], settings: &Settings) -> Self {
        let edges = if settings.turns { edges } else { 0 };
        Self(vec![vec![Verdict::Unknown(UnknownReason::Geometry); edges]; models.len()])
    }

    pub(super) fn set(&mut self, vehicle: usize, edge: EdgeNo, verdict: Verdict) {
        if let Some(slot) = self.0.get_mut(vehicle).and_then(|edges| edges.get_mut(edge.index())) {
            *slot = verdict;
        }
    }

    /// Those of a portion's edges, by their indices there.
    pub(super) fn of(&self, portion: &Portion) -> Self {
        let edges = EdgeNo::first(portion.network.edges.len());
        let verdict = |verdicts: &Vec<Verdict>, edge| verdicts.get(portion.edge(edge).index()).copied();
        let unknown = Verdict::Unknown(UnknownReason::Geometry);
        let of_vehicle = |verdicts| edges.clone().map(|edge| verdict(verdicts, edge).unwrap_or(unknown)).collect();
        Self(self.0.iter().map(of_vehicle).collect())
    }
}
