//! Makes the turns of a route from the corridors of `turns`. Only corridors that are certified as safe for the vehicle count.

use std::sync::Arc;

use super::driver::Driver;
use super::pieces::{Strokes, TurnPiece, Turns};
use crate::certify::best_of;
use crate::network::Movement;
use crate::stet::{Options, SpanResult, certify_spans};
use crate::turns::{Planner, Reach, TurnCorridors, TurnPath, turn_on};
use crate::verdict::UnknownReason;

/// The usual number of simple paths of a turn.
const MORE: usize = 5;

/// Turns that are made when a route needs them, with the settings of its strokes.
#[derive(Debug, Clone)]
pub struct MadeTurns {
    /// The vehicle that takes the turns.
    pub driver: Arc<Driver>,
    /// Number of simple paths of a turn that are tried beside the path of its permit. Those with the most room are tried.
    pub more: usize,
}

impl MadeTurns {
    /// Turns with the usual number of paths.
    #[must_use]
    pub fn new(driver: Arc<Driver>) -> Self {
        Self { driver, more: MORE }
    }
}

impl Turns for MadeTurns {
    fn pieces(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[u32],
    ) -> Result<Vec<TurnPiece>, UnknownReason> {
        let made = self.made(strokes, movement, arcs)?;
        let options = &strokes.settings().stet;
        let known = best_of(&made, &[&self.driver.model], options).pop().flatten();
        let known = known.filter(|(_, result)| result.safe());
        let code = known.as_ref().map(|(path, _)| path.code);
        let others = Planner::new(&made).best_seeds(&self.driver.model.vehicle, self.more);
        let others = others.into_iter().filter(|other| Some(other.code) != code).filter_map(|other| {
            let path = made.path(other.code)?;
            let result = self.safe(&path, options)?;
            Some((path, result))
        });
        let mut safe: Vec<(TurnPath, SpanResult)> = known.into_iter().chain(others).collect();
        safe.sort_by(|a, b| b.1.rsc_m.partial_cmp(&a.1.rsc_m).unwrap_or(std::cmp::Ordering::Equal));
        let frame = made.frame;
        let reach = Reach::of(&self.driver.model.vehicle).ok_or(UnknownReason::Geometry)?;
        let piece = |path: TurnPath| {
            let TurnPath { corridor, area, turn, approach, departure, .. } = path;
            TurnPiece { frame, corridor, turn, approach, departure, area, reach }
        };
        Ok(safe.into_iter().map(|(path, _)| piece(path)).collect())
    }
}

impl MadeTurns {
    fn made(&self, strokes: &mut Strokes, movement: &Movement, arcs: &[u32]) -> Result<TurnCorridors, UnknownReason> {
        let reach = Reach::of(&self.driver.model.vehicle).ok_or(UnknownReason::Geometry)?;
        let driven = [movement.from, movement.to].into_iter().chain(arcs.iter().copied());
        let lines: Vec<_> =
            driven.map(|edge| Ok((edge, strokes.line_of(edge)?))).collect::<Result<_, UnknownReason>>()?;
        let line = |edge: u32| {
            let found = lines.iter().find(|(of, _)| *of == edge);
            found.map(|(_, line)| line.as_ref()).ok_or(UnknownReason::Geometry)
        };
        let (network, policy, params) = (strokes.network(), strokes.settings().policy, strokes.turn_params());
        turn_on(network, (*movement, arcs), &line, policy, params, reach)
    }

    fn safe(&self, path: &TurnPath, options: &Options) -> Option<SpanResult> {
        let rows = certify_spans(&path.corridor, &[&self.driver.model], std::slice::from_ref(&path.counted), options);
        rows.into_iter().next()?.spans.into_iter().next().filter(SpanResult::safe)
    }
}
