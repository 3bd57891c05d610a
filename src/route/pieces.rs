//! What a route's corridor is made of: strokes and turns, each in a frame of its own.

use std::ops::Range;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::roads::Roads;
use crate::corridor::{Corridor, Frame};
use crate::network::{Movement, Network};
use crate::settings::Settings;
use crate::turns::{Joint, Reach, StrokeLine, TurnParams};
use crate::verdict::UnknownReason;

/// One certified way to drive a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnPiece {
    /// In which the corridor's positions are.
    pub frame: Frame,
    /// At least the turn itself.
    pub corridor: Corridor,
    /// Stations of the turn, between the joints, both included.
    pub turn: Range<usize>,
    /// Where it leaves the stroke of the edge that one comes from.
    pub approach: Joint,
    /// Where it joins the stroke of the edge that one goes to.
    pub departure: Joint,
    /// How far before and after it the turn's strip counts.
    pub reach: Reach,
}

/// Where turns come from.
pub trait Turns: Send {
    /// Ways to drive from one edge into another that are certified for the vehicle, the best first; over these arcs, where it is
    /// a passage of a roundabout.
    ///
    /// # Errors
    /// There is none, and why.
    fn pieces(&self, strokes: &mut Strokes, movement: &Movement, arcs: &[u32])
    -> Result<Vec<TurnPiece>, UnknownReason>;
}

/// The paths of a turn, the best first.
type Made = Result<Vec<Arc<TurnPiece>>, UnknownReason>;

/// Which of its paths each turn is to be driven on: the best one, until another is asked for.
pub struct Menu {
    turns: Box<dyn Turns>,
    made: FxHashMap<(u32, u32), Made>,
    choice: FxHashMap<(u32, u32), usize>,
}

impl Menu {
    /// Nothing is made yet.
    #[must_use]
    pub fn new(turns: Box<dyn Turns>) -> Self {
        Self { turns, made: FxHashMap::default(), choice: FxHashMap::default() }
    }

    /// Every turn on its best path again.
    pub fn begin(&mut self) {
        self.choice.clear();
    }

    /// The path of a turn, or of a passage over these arcs.
    ///
    /// # Errors
    /// There is none, and why.
    pub fn chosen(
        &mut self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[u32],
    ) -> Result<Arc<TurnPiece>, UnknownReason> {
        let key = (movement.from, movement.to);
        let turns = &self.turns;
        let make = || Ok(turns.pieces(strokes, movement, arcs)?.into_iter().map(Arc::new).collect());
        let made = self.made.entry(key).or_insert_with(make).as_ref().map_err(|reason| *reason)?;
        let choice = self.choice.get(&key).copied().unwrap_or(0);
        made.get(choice).cloned().ok_or(UnknownReason::Geometry)
    }

    /// Takes the next pair of paths of two turns that follow each other; whether there is one.
    pub fn another_pair(&mut self, before: (u32, u32), after: (u32, u32)) -> bool {
        if self.another(after.0, after.1) {
            return true;
        }
        let there = before != after && self.another(before.0, before.1);
        if there {
            self.choice.remove(&after);
        }
        there
    }

    /// Takes the next path of a turn; whether there is one.
    pub fn another(&mut self, from: u32, to: u32) -> bool {
        let choice = self.choice.entry((from, to)).or_insert(0);
        let there = matches!(self.made.get(&(from, to)), Some(Ok(made)) if *choice + 1 < made.len());
        *choice += usize::from(there);
        there
    }
}

/// No turn at all: routes then only go straight on.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoTurns;

impl Turns for NoTurns {
    fn pieces(&self, _: &mut Strokes, _: &Movement, _: &[u32]) -> Result<Vec<TurnPiece>, UnknownReason> {
        Err(UnknownReason::Geometry)
    }
}

/// Strokes of a network, made into corridors under one set's settings as they are asked for, and kept.
pub struct Strokes {
    roads: Arc<Roads>,
    settings: Settings,
    params: TurnParams,
    /// By edge: its stroke, and its place in it.
    place: Vec<(u32, u32)>,
    made: FxHashMap<u32, Result<Arc<StrokeLine>, UnknownReason>>,
}

impl Strokes {
    /// Nothing is made yet.
    #[must_use]
    pub fn new(roads: &Arc<Roads>, settings: Settings) -> Self {
        let network = &roads.network;
        let mut place = vec![(u32::MAX, 0); network.edges.len()];
        for (stroke, facts) in (0_u32..).zip(&network.strokes) {
            let edges = &network.stroke_edges[facts.edges.start as usize..facts.edges.end as usize];
            for (i, &edge) in (0_u32..).zip(edges) {
                place[edge as usize] = (stroke, i);
            }
        }
        let params = settings.turn_params();
        Self { roads: Arc::clone(roads), settings, params, place, made: FxHashMap::default() }
    }

    pub(super) fn network(&self) -> &Network {
        &self.roads.network
    }

    /// What the strokes are made with, and all that is strung together from them.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The same for turns between them.
    pub(super) fn turn_params(&self) -> &TurnParams {
        &self.params
    }

    /// Stroke of an edge, and the edge's place in it.
    pub(super) fn of(&self, edge: u32) -> Option<(u32, u32)> {
        self.place.get(edge as usize).copied().filter(|place| place.0 != u32::MAX)
    }

    /// The line of a stroke.
    ///
    /// # Errors
    /// Nothing can be said of any of its edges.
    pub fn line(&mut self, stroke: u32) -> Result<Arc<StrokeLine>, UnknownReason> {
        let (network, policy, params) = (&self.roads.network, self.settings.policy, &self.settings.corridor);
        let make = || StrokeLine::new(network, stroke, policy, params).map(Arc::new);
        self.made.entry(stroke).or_insert_with(make).clone()
    }

    /// The line of the stroke that an edge belongs to.
    ///
    /// # Errors
    /// Nothing can be said of any of its edges.
    pub fn line_of(&mut self, edge: u32) -> Result<Arc<StrokeLine>, UnknownReason> {
        let (stroke, _) = self.of(edge).ok_or(UnknownReason::Geometry)?;
        self.line(stroke)
    }

    pub(super) fn closed(&self, stroke: u32) -> bool {
        self.roads.network.strokes.get(stroke as usize).is_some_and(|stroke| stroke.closed)
    }
}
