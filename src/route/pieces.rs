//! The pieces of a route's corridor: strokes and turns, each in a frame of its own.

use std::ops::Range;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::roads::Roads;
use crate::corridor::{AreaSpan, Corridor, Frame};
use crate::network::{Movement, Network};
use crate::settings::Settings;
use crate::turns::{Joint, Reach, StrokeLine, TurnParams};
use crate::verdict::UnknownReason;

/// One way to drive a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnPiece {
    /// The frame of the corridor's positions.
    pub frame: Frame,
    /// A corridor that contains at least the turn.
    pub corridor: Corridor,
    /// The stations of the turn between the joints, including both.
    pub turn: Range<usize>,
    /// The joint with the stroke that the vehicle comes from.
    pub approach: Joint,
    /// The joint with the stroke that the vehicle goes to.
    pub departure: Joint,
    /// The junction's area, and the stations of `corridor` at which it counts.
    pub area: Option<AreaSpan>,
    /// How far before and after it the turn's strip counts.
    pub reach: Reach,
}

/// A source of turns.
pub trait Turns: Send {
    /// The ways to drive from one edge into another that the source counts, the best first. `arcs` are the edges between of a passage,
    /// else empty.
    ///
    /// # Errors
    /// The turn has no corridor; the error is the reason.
    fn pieces(&self, strokes: &mut Strokes, movement: &Movement, arcs: &[u32])
    -> Result<Vec<TurnPiece>, UnknownReason>;

    /// The first of [`Turns::pieces`] alone, if that is less work.
    ///
    /// # Errors
    /// The turn has no corridor; the error is the reason.
    fn first(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[u32],
    ) -> Result<Option<TurnPiece>, UnknownReason> {
        Ok(self.pieces(strokes, movement, arcs)?.into_iter().next())
    }
}

/// The paths of a turn that were made.
struct Made {
    /// The best first.
    paths: Result<Vec<Arc<TurnPiece>>, UnknownReason>,
    /// Whether these are all.
    all: bool,
}

impl Made {
    fn all(turns: &dyn Turns, strokes: &mut Strokes, movement: &Movement, arcs: &[u32]) -> Self {
        let pieces = turns.pieces(strokes, movement, arcs);
        Self { paths: pieces.map(|pieces| pieces.into_iter().map(Arc::new).collect()), all: true }
    }
}

/// By turn, the place of its chosen path. A turn that is missing has its best path.
pub(super) type Choices = FxHashMap<(u32, u32), usize>;

/// Chooses the path of each turn: the best one, until another is requested.
pub struct Menu {
    turns: Box<dyn Turns>,
    made: FxHashMap<(u32, u32), Made>,
    choice: Choices,
}

impl Menu {
    /// A menu without turns. Turns are made when they are first needed.
    #[must_use]
    pub fn new(turns: Box<dyn Turns>) -> Self {
        Self { turns, made: FxHashMap::default(), choice: FxHashMap::default() }
    }

    /// Forgets turns of which this holds, by the edges before and after them.
    pub(super) fn forget(&mut self, changed: impl Fn(u32, u32) -> bool) {
        self.made.retain(|&(from, to), _| !changed(from, to));
        self.choice.retain(|&(from, to), _| !changed(from, to));
    }

    /// Resets every turn to its best path.
    pub fn begin(&mut self) {
        self.choice.clear();
    }

    /// The chosen path of a turn, or of a passage over these arcs.
    ///
    /// # Errors
    /// The turn has no path that counts; the error is the reason.
    pub fn chosen(
        &mut self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[u32],
    ) -> Result<Arc<TurnPiece>, UnknownReason> {
        let key = (movement.from, movement.to);
        let turns = &self.turns;
        let choice = self.choice.entry(key).or_insert(0);
        let mut first = || Ok(turns.first(strokes, movement, arcs)?.into_iter().map(Arc::new).collect());
        let made = self.made.entry(key).or_insert_with(|| Made { paths: first(), all: false });
        if *choice > 0 && !made.all {
            *made = Made::all(turns.as_ref(), strokes, movement, arcs);
        }
        let paths = made.paths.as_ref().map_err(|reason| *reason)?;
        // A choice may come from another menu.
        *choice = (*choice).min(paths.len().saturating_sub(1));
        paths.get(*choice).cloned().ok_or(UnknownReason::Geometry)
    }

    /// The paths chosen so far, by their places in the order of each turn's paths.
    pub(super) fn choices(&self) -> &Choices {
        &self.choice
    }

    /// Chooses these paths, and of every other turn the best one.
    pub(super) fn choose(&mut self, choices: &Choices) {
        self.choice.clone_from(choices);
    }

    /// Chooses the next pair of paths for two successive turns. Returns whether there is one.
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

    /// Makes all paths of a turn, so that another one can be chosen.
    pub(super) fn make_all(&mut self, strokes: &mut Strokes, movement: &Movement, arcs: &[u32]) {
        let key = (movement.from, movement.to);
        if !self.made.get(&key).is_some_and(|made| made.all) {
            self.made.insert(key, Made::all(self.turns.as_ref(), strokes, movement, arcs));
        }
    }

    /// Chooses the next of the paths that were made of a turn. Returns whether there is one.
    pub fn another(&mut self, from: u32, to: u32) -> bool {
        let choice = self.choice.entry((from, to)).or_insert(0);
        let more = |made: &Made| made.paths.as_ref().is_ok_and(|paths| *choice + 1 < paths.len());
        let there = self.made.get(&(from, to)).is_some_and(more);
        *choice += usize::from(there);
        there
    }
}

/// A source without turns. Routes then only go straight on.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoTurns;

impl Turns for NoTurns {
    fn pieces(&self, _: &mut Strokes, _: &Movement, _: &[u32]) -> Result<Vec<TurnPiece>, UnknownReason> {
        Err(UnknownReason::Geometry)
    }
}

/// The corridors of a network's strokes under one set's settings. Each is made when it is first needed, and kept.
pub struct Strokes {
    roads: Arc<Roads>,
    settings: Settings,
    params: TurnParams,
    /// By edge: its stroke, and its index in the stroke.
    place: Vec<(u32, u32)>,
    made: FxHashMap<u32, Result<Arc<StrokeLine>, UnknownReason>>,
}

impl Strokes {
    /// The strokes of these roads. No corridor is made yet.
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

    /// Goes on with roads that differ from the earlier ones by their site. The lines of these strokes are made again.
    pub(super) fn go_on_with(&mut self, roads: &Arc<Roads>, changed: impl Fn(u32) -> bool) {
        self.roads = Arc::clone(roads);
        self.made.retain(|&stroke, _| !changed(stroke));
    }

    /// The settings of the strokes' corridors and of everything that is made from them.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The parameters of turns between the strokes.
    pub(super) fn turn_params(&self) -> &TurnParams {
        &self.params
    }

    /// The stroke of an edge, and the edge's index in it.
    pub(super) fn of(&self, edge: u32) -> Option<(u32, u32)> {
        self.place.get(edge as usize).copied().filter(|place| place.0 != u32::MAX)
    }

    /// The line of a stroke.
    ///
    /// # Errors
    /// The stroke has no corridor; the error is the reason.
    pub fn line(&mut self, stroke: u32) -> Result<Arc<StrokeLine>, UnknownReason> {
        let (network, policy, params) = (&self.roads.network, self.settings.policy, &self.settings.corridor);
        let make = || StrokeLine::new(network, stroke, policy, params).map(Arc::new);
        self.made.entry(stroke).or_insert_with(make).clone()
    }

    /// The line of the stroke that an edge belongs to.
    ///
    /// # Errors
    /// The stroke has no corridor; the error is the reason.
    pub fn line_of(&mut self, edge: u32) -> Result<Arc<StrokeLine>, UnknownReason> {
        let (stroke, _) = self.of(edge).ok_or(UnknownReason::Geometry)?;
        self.line(stroke)
    }

    pub(super) fn closed(&self, stroke: u32) -> bool {
        self.roads.network.strokes.get(stroke as usize).is_some_and(|stroke| stroke.closed)
    }
}
