//! Turns of the network as pieces of routes: the corridors of `turns`, of which those that certify for the vehicle count.

use super::pieces::{Strokes, TurnPiece, Turns};
use crate::network::Movement;
use crate::osm::facts::Policy;
use crate::stet::{Model, Options, certify_spans};
use crate::turns::{Reach, TurnParams, nominal_leeway_m, turn_on};
use crate::verdict::UnknownReason;

/// Paths of a turn that get a certificate, at most: those with most room by themselves. The pipeline tries fewer; what it
/// found safe is among them.
const TRIED: usize = 6;

/// Turns made as a route asks for them.
#[derive(Debug, Clone)]
pub struct MadeTurns<'m> {
    /// The vehicle.
    pub model: &'m Model,
    /// Which width counts.
    pub policy: Policy,
    /// How turns are made into corridors.
    pub params: TurnParams,
    /// How corrections are made.
    pub options: Options,
}

impl Turns for MadeTurns<'_> {
    fn pieces(&self, strokes: &mut Strokes<'_>, movement: &Movement) -> Result<Vec<TurnPiece>, UnknownReason> {
        let vehicle = &self.model.vehicle;
        let reach = Reach::of(vehicle).ok_or(UnknownReason::Geometry)?;
        let lines = [strokes.line_of(movement.from)?, strokes.line_of(movement.to)?];
        let network = strokes.network();
        let made = turn_on(network, *movement, [&lines[0], &lines[1]], self.policy, &self.params, reach)?;
        let mut ranked: Vec<_> = made.paths.into_iter().map(|path| (nominal_leeway_m(&path, vehicle), path)).collect();
        // Paths come in the order of their numbers; the sort keeps it among equals.
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut safe = Vec::new();
        for (_, path) in ranked.into_iter().take(TRIED) {
            let rows = certify_spans(&path.corridor, &[self.model], std::slice::from_ref(&path.counted), &self.options);
            let result = rows.into_iter().next().and_then(|row| row.spans.into_iter().next());
            let Some(result) = result.filter(crate::stet::SpanResult::safe) else { continue };
            let (approach, departure) = (path.approach, path.departure);
            let piece = TurnPiece { frame: made.frame, corridor: path.corridor, turn: path.turn, approach, departure };
            safe.push((result.rsc_m, piece));
        }
        safe.sort_by(|a, b| b.0.total_cmp(&a.0));
        Ok(safe.into_iter().map(|(_, piece)| piece).collect())
    }
}
