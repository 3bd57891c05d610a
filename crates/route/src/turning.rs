//! Makes the turns of a route from the corridors of `turns`.

use std::sync::Arc;

use super::driver::Driver;
use super::pieces::{Strokes, TurnPiece, Turns};
use super::turn_ends::TurnEnds;
use crate::certify::best_of;
use crate::network::{EdgeNo, Movement};
use crate::osm::facts::Policy;
use crate::stet::{Options, SpanResult, certify_spans};
use crate::turns::{LengthClass, TurnCorridors, TurnEdges, TurnPath, TurnPlanner, turn_on};
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
    /// Whether paths count whose own certificate is not safe. That certificate judges the road before and after the turn as if the
    /// vehicle went straight on there. A route under conditions is judged as a whole.
    pub unsafe_too: bool,
}

impl MadeTurns {
    /// Turns with the usual number of paths.
    #[must_use]
    pub fn new(driver: Arc<Driver>) -> Self {
        Self { driver, more: MORE, unsafe_too: false }
    }
}

impl Turns for MadeTurns {
    fn pieces(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<Vec<TurnPiece>, UnknownReason> {
        let (made, strip) = (self.made(strokes, movement, arcs)?, strokes.turn_strip(TurnEnds::of(movement)));
        let options = &strokes.settings().stet;
        let known = self.best(&made, options);
        let code = known.as_ref().map(|(path, _)| path.code);
        let others = TurnPlanner::new(&made).best_seeds(&self.driver.model.vehicle, self.more);
        let others = others.into_iter().filter(|other| Some(other.code) != code).filter_map(|other| {
            let path = made.path(other.code)?;
            let result = self.certified(&path, options)?;
            Some((path, result))
        });
        let mut others: Vec<(TurnPath, SpanResult)> = others.collect();
        let order = |result: &SpanResult| (result.safe(), result.rsc_m);
        others.sort_by(|a, b| order(&b.1).partial_cmp(&order(&a.1)).unwrap_or(std::cmp::Ordering::Equal));
        known.into_iter().chain(others).map(|(path, _)| self.piece(&made, path, strip)).collect()
    }

    fn first(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<Option<TurnPiece>, UnknownReason> {
        let (made, strip) = (self.made(strokes, movement, arcs)?, strokes.turn_strip(TurnEnds::of(movement)));
        match self.best(&made, &strokes.settings().stet) {
            Some((path, _)) => self.piece(&made, path, strip).map(Some),
            // Another path may count although the best one of the search does not.
            None => Ok(self.pieces(strokes, movement, arcs)?.into_iter().next()),
        }
    }

    fn of_code(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
        code: i64,
    ) -> Result<Option<TurnPiece>, UnknownReason> {
        let (made, strip) = (self.made(strokes, movement, arcs)?, strokes.turn_strip(TurnEnds::of(movement)));
        let counts = |path: &TurnPath| self.unsafe_too || self.certified(path, &strokes.settings().stet).is_some();
        made.path(code).filter(counts).map(|path| self.piece(&made, path, strip)).transpose()
    }
}

impl MadeTurns {
    fn made(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<TurnCorridors, UnknownReason> {
        let reach = LengthClass::of(&self.driver.model.vehicle).ok_or(UnknownReason::Geometry)?;
        let driven = [movement.from, movement.to].into_iter().chain(arcs.iter().copied());
        let lines: Vec<_> =
            driven.map(|edge| Ok((edge, strokes.line_of(edge)?))).collect::<Result<_, UnknownReason>>()?;
        let line = |edge: EdgeNo| {
            let found = lines.iter().find(|(of, _)| *of == edge);
            found.map(|(_, line)| line.as_ref()).ok_or(UnknownReason::Geometry)
        };
        let (network, policy) = (strokes.network(), strokes.rungs().turn(TurnEnds::of(movement)));
        turn_on(network, TurnEdges { movement: *movement, through: arcs }, &line, policy, strokes.turn_params(), reach)
    }

    fn best(&self, made: &TurnCorridors, options: &Options) -> Option<(TurnPath, SpanResult)> {
        best_of(made, &[&self.driver.model], options).pop().flatten().filter(|(_, result)| self.counts(result))
    }

    fn piece(&self, made: &TurnCorridors, path: TurnPath, strip: Policy) -> Result<TurnPiece, UnknownReason> {
        let TurnPath { code, corridor, area, turn, approach, departure, .. } = path;
        let reach = LengthClass::of(&self.driver.model.vehicle).ok_or(UnknownReason::Geometry)?;
        Ok(TurnPiece { code, frame: made.frame, corridor, turn, approach, departure, area, reach, strip })
    }

    fn counts(&self, result: &SpanResult) -> bool {
        self.unsafe_too || result.safe()
    }

    fn certified(&self, path: &TurnPath, options: &Options) -> Option<SpanResult> {
        let rows = certify_spans(&path.corridor, &[&self.driver.model], std::slice::from_ref(&path.counted), options);
        rows.into_iter().next()?.spans.into_iter().next().filter(|result| self.counts(result))
    }
}
