//! The pieces of a route's corridor: strokes and turns, each in a frame of its own.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::roads::Roads;
use super::rungs::Rungs;
use super::turn_ends::TurnEnds;
use crate::corridor::{AreaSpan, Corridor, Frame};
use crate::network::{Edge, EdgeNo, Movement, Network};
use crate::osm::facts::Policy;
use crate::settings::Settings;
use crate::stop::{Stop, Stopped};
use crate::turns::{Joint, LengthClass, StrokeLine, TurnParams};
use crate::verdict::UnknownReason;

/// One way to drive a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnPiece {
    /// The code of the path. A turn has at most one path of a code.
    pub code: i64,
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
    pub reach: LengthClass,
    /// The turn's strip.
    pub strip: Policy,
}

/// A source of turns.
pub trait Turns: Send + Sync {
    /// The ways to drive from one edge into another that the source counts, the best first. `arcs` are the edges between of a passage,
    /// else empty.
    ///
    /// # Errors
    /// The turn has no corridor; the error is the reason.
    fn pieces(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<Vec<TurnPiece>, UnknownReason>;

    /// The first of [`Turns::pieces`] alone, if that is less work.
    ///
    /// # Errors
    /// The turn has no corridor; the error is the reason.
    fn first(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<Option<TurnPiece>, UnknownReason> {
        Ok(self.pieces(strokes, movement, arcs)?.into_iter().next())
    }

    /// The path of a code, if there is one and it counts.
    ///
    /// # Errors
    /// The turn has no corridor; the error is the reason.
    fn of_code(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
        code: i64,
    ) -> Result<Option<TurnPiece>, UnknownReason> {
        Ok(self.pieces(strokes, movement, arcs)?.into_iter().find(|piece| piece.code == code))
    }
}

/// The paths of a turn that were made.
#[derive(Default)]
struct Made {
    /// Those that the source counts, the best first. `None` if nobody has asked for them.
    paths: Option<Result<Vec<Arc<TurnPiece>>, UnknownReason>>,
    /// Whether these are all.
    all: bool,
    /// Those that were asked for by their code.
    coded: Vec<Arc<TurnPiece>>,
}

impl Made {
    fn make_all(&mut self, turns: &dyn Turns, strokes: &mut Strokes, movement: &Movement, arcs: &[EdgeNo]) {
        if !self.all {
            let pieces = turns.pieces(strokes, movement, arcs);
            self.paths = Some(pieces.map(|pieces| pieces.into_iter().map(Arc::new).collect()));
            self.all = true;
        }
    }

    fn counted(&self) -> &[Arc<TurnPiece>] {
        self.paths.as_ref().and_then(|paths| paths.as_ref().ok()).map_or(&[], Vec::as_slice)
    }

    fn of_code(&self, code: i64) -> Option<Arc<TurnPiece>> {
        self.counted().iter().chain(&self.coded).find(|piece| piece.code == code).cloned()
    }
}

/// By turn, the code of its chosen path. A turn that is missing has its best path.
pub(super) type Choices = FxHashMap<TurnEnds, i64>;

/// Chooses the path of each turn: the best one, until another is requested.
pub struct Menu {
    turns: Box<dyn Turns>,
    made: FxHashMap<TurnEnds, Made>,
    /// Paths asked for by their place among those that count, and by their code.
    places: FxHashMap<TurnEnds, usize>,
    codes: Choices,
    /// What was chosen last.
    chosen: Choices,
}

impl Menu {
    /// A menu without turns. Turns are made when they are first needed.
    #[must_use]
    pub fn new(turns: Box<dyn Turns>) -> Self {
        Self {
            turns,
            made: FxHashMap::default(),
            places: FxHashMap::default(),
            codes: Choices::default(),
            chosen: Choices::default(),
        }
    }

    /// Forgets turns of which this holds, by the edges before and after them.
    pub(super) fn forget(&mut self, changed: impl Fn(EdgeNo, EdgeNo) -> bool) {
        self.made.retain(|ends, _| !changed(ends.from, ends.to));
        self.places.retain(|ends, _| !changed(ends.from, ends.to));
    }

    /// Resets every turn to its best path.
    pub fn begin(&mut self) {
        self.choose(&Choices::default());
    }

    /// Makes the chosen paths of turns, given with the arcs between, on several threads. [`Self::chosen`] then knows them. A turn that has no
    /// path of the chosen code is left for it.
    ///
    /// # Errors
    /// `stop` was told.
    pub(super) fn make(
        &mut self,
        strokes: &mut Strokes,
        turns: &[(Movement, &[EdgeNo])],
        stop: &Stop,
    ) -> Result<(), Stopped> {
        let wanted = turns.iter().filter_map(|&(movement, arcs)| {
            let key = TurnEnds::of(&movement);
            if self.places.contains_key(&key) {
                return None;
            }
            let (made, code) = (self.made.get(&key), self.codes.get(&key).copied());
            let known = made.is_some_and(|made| code.map_or(made.paths.is_some(), |code| made.of_code(code).is_some()));
            (!known).then_some((key, movement, arcs, code))
        });
        // A way may take a turn twice.
        let mut seen = FxHashSet::default();
        let wanted: Vec<_> = wanted.filter(|(key, ..)| seen.insert(*key)).collect();
        // All threads have the lines that the turns need.
        for (_, movement, arcs, _) in &wanted {
            for edge in [movement.from, movement.to].iter().chain(*arcs) {
                let _ = strokes.line_of(*edge);
            }
        }
        let (source, lines) = (self.turns.as_ref(), &*strokes);
        let made: Vec<_> = wanted
            .par_iter()
            .map_init(
                || lines.clone(),
                |strokes, (_, movement, arcs, code)| {
                    stop.check()?;
                    Ok(match code {
                        Some(code) => source.of_code(strokes, movement, arcs, *code),
                        None => source.first(strokes, movement, arcs),
                    })
                },
            )
            .collect::<Result<_, Stopped>>()?;
        for ((key, _, _, code), piece) in wanted.into_iter().zip(made) {
            let made = self.made.entry(key).or_default();
            match (code, piece) {
                (Some(_), Ok(Some(piece))) => made.coded.push(Arc::new(piece)),
                (Some(_), _) => {}
                (None, piece) => {
                    made.paths.get_or_insert(piece.map(|piece| piece.into_iter().map(Arc::new).collect()));
                }
            }
        }
        Ok(())
    }

    /// The chosen path of a turn, or of a passage over these arcs.
    ///
    /// # Errors
    /// The turn has no path that counts; the error is the reason.
    pub fn chosen(
        &mut self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<Arc<TurnPiece>, UnknownReason> {
        let key = TurnEnds::of(movement);
        let turns = self.turns.as_ref();
        let made = self.made.entry(key).or_default();
        let place = self.places.get(&key).copied();
        if let (None, Some(&code)) = (place, self.codes.get(&key)) {
            let known = made.of_code(code);
            let piece = known.or_else(|| turns.of_code(strokes, movement, arcs, code).ok().flatten().map(Arc::new));
            // What has changed since the path was chosen may have no such path.
            if let Some(piece) = piece {
                if made.of_code(code).is_none() {
                    made.coded.push(Arc::clone(&piece));
                }
                self.chosen.insert(key, code);
                return Ok(piece);
            }
        }
        let place = place.unwrap_or(0);
        if place > 0 {
            made.make_all(turns, strokes, movement, arcs);
        }
        let first = || Ok(turns.first(strokes, movement, arcs)?.into_iter().map(Arc::new).collect());
        let paths = made.paths.get_or_insert_with(first).as_ref().map_err(|reason| *reason)?;
        let piece = paths.get(place.min(paths.len().saturating_sub(1))).cloned().ok_or(UnknownReason::Geometry)?;
        self.chosen.insert(key, piece.code);
        Ok(piece)
    }

    /// The paths chosen so far.
    pub(super) fn choices(&self) -> &Choices {
        &self.chosen
    }

    /// Chooses these paths, and of every other turn the best one.
    pub(super) fn choose(&mut self, choices: &Choices) {
        self.places.clear();
        self.codes.clone_from(choices);
        self.chosen.clone_from(choices);
    }

    /// Chooses the next pair of paths for two successive turns. Returns whether there is one.
    pub fn another_pair(&mut self, before: TurnEnds, after: TurnEnds) -> bool {
        if self.another(after) {
            return true;
        }
        let there = before != after && self.another(before);
        if there {
            self.places.insert(after, 0);
        }
        there
    }

    /// Makes all paths of a turn, so that another one can be chosen.
    pub(super) fn make_all(&mut self, strokes: &mut Strokes, movement: &Movement, arcs: &[EdgeNo]) {
        let made = self.made.entry(TurnEnds::of(movement)).or_default();
        made.make_all(self.turns.as_ref(), strokes, movement, arcs);
    }

    /// Chooses the next of the paths that were made of a turn. Returns whether there is one.
    pub fn another(&mut self, turn: TurnEnds) -> bool {
        let paths = self.made.get(&turn).map_or(&[][..], Made::counted);
        let of_code = |code: &i64| paths.iter().position(|piece| piece.code == *code);
        let next = match (self.places.get(&turn), self.codes.get(&turn)) {
            (Some(&place), _) => place + 1,
            // A path that does not count comes before all that do.
            (None, Some(code)) => of_code(code).map_or(0, |place| place + 1),
            (None, None) => 1,
        };
        let Some(piece) = paths.get(next) else { return false };
        self.chosen.insert(turn, piece.code);
        self.places.insert(turn, next);
        true
    }
}

/// A source without turns. Routes then only go straight on.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoTurns;

impl Turns for NoTurns {
    fn pieces(&self, _: &mut Strokes, _: &Movement, _: &[EdgeNo]) -> Result<Vec<TurnPiece>, UnknownReason> {
        Err(UnknownReason::Geometry)
    }
}

/// The corridors of a network's strokes under one set's settings. Each is made when it is first needed, and kept.
#[derive(Clone)]
pub struct Strokes {
    roads: Arc<Roads>,
    settings: Settings,
    params: TurnParams,
    rungs: Rungs,
    /// By edge: its stroke, and its index in the stroke.
    place: Arc<[(u32, u32)]>,
    made: FxHashMap<u32, Result<Arc<StrokeLine>, UnknownReason>>,
}

impl Strokes {
    /// The strokes of these roads, with the strip of the settings everywhere. No corridor is made yet.
    #[must_use]
    pub fn new(roads: &Arc<Roads>, settings: Settings) -> Self {
        let rungs = Rungs::level(settings.policy);
        Self::on_rungs(roads, settings, rungs)
    }

    /// The strokes of these roads, each edge with its own strip. No corridor is made yet.
    pub(super) fn on_rungs(roads: &Arc<Roads>, settings: Settings, rungs: Rungs) -> Self {
        let network = &roads.network;
        let mut place = vec![(u32::MAX, 0); network.edges.len()];
        for (stroke, facts) in (0_u32..).zip(&network.strokes) {
            let edges = &network.stroke_edges[facts.edges.start as usize..facts.edges.end as usize];
            for (i, &edge) in (0_u32..).zip(edges) {
                place[edge.index()] = (stroke, i);
            }
        }
        let params = settings.turn_params();
        Self { roads: Arc::clone(roads), settings, params, rungs, place: place.into(), made: FxHashMap::default() }
    }

    /// The strips of edges and turns.
    pub(super) fn rungs(&self) -> &Rungs {
        &self.rungs
    }

    /// The strip of a turn, as far as the settings let turns use more than roads.
    pub(super) fn turn_strip(&self, turn: TurnEnds) -> Policy {
        self.params.strip.max(self.rungs.turn(turn))
    }

    /// Changes the strips of `edges` and of turns. The lines of the strokes that `edges` belong to are made again.
    pub(super) fn put_rungs(&mut self, rungs: Rungs, edges: &[EdgeNo]) {
        self.rungs = rungs;
        // An edge also lies in the approach of other strokes.
        let network = &self.roads.network;
        let on = |range: &Range<u32>| {
            let all = network.stroke_edges.get(range.start as usize..range.end as usize);
            all.is_some_and(|all| all.iter().any(|edge| edges.contains(edge)))
        };
        self.made.retain(|&stroke, _| {
            let facts = network.strokes.get(stroke as usize);
            !facts.is_some_and(|facts| on(&facts.edges) || on(&facts.approach))
        });
    }

    pub(super) fn network(&self) -> &Network {
        &self.roads.network
    }

    /// Lets go of the roads. [`Self::go_on_with`] must follow.
    pub(super) fn let_go_of_roads(&mut self) {
        self.roads = Arc::default();
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
    pub(super) fn of(&self, edge: EdgeNo) -> Option<(u32, u32)> {
        self.place.get(edge.index()).copied().filter(|place| place.0 != u32::MAX)
    }

    /// The line of a stroke.
    ///
    /// # Errors
    /// The stroke has no corridor; the error is the reason.
    pub fn line(&mut self, stroke: u32) -> Result<Arc<StrokeLine>, UnknownReason> {
        let (network, policy, params) = (&self.roads.network, self.settings.policy, &self.settings.corridor);
        let numbers = self.numbers_on(stroke);
        let sections = |edge: &Edge| {
            let section = network.section(edge);
            numbers.get(&edge.id).map_or(section, |&no| self.rungs.section(no, section))
        };
        let make = || StrokeLine::on(network, stroke, &sections, policy, params).map(Arc::new);
        self.made.entry(stroke).or_insert_with(make).clone()
    }

    /// By id of a stroke's edges, those of its approach included: the edge whose strip counts there. An edge that the way does not drive is as
    /// much wider as the nearest one that it drives. Otherwise the line would bend, and the road become narrow, where the way turns off. Empty if
    /// no road is wider than its policy's strip.
    fn numbers_on(&self, stroke: u32) -> FxHashMap<i64, EdgeNo> {
        let network = &self.roads.network;
        let Some(facts) = network.strokes.get(stroke as usize).filter(|_| !self.rungs.is_level()) else {
            return FxHashMap::default();
        };
        let ranges = [&facts.approach, &facts.edges];
        let edges =
            ranges.into_iter().filter_map(|range| network.stroke_edges.get(range.start as usize..range.end as usize));
        let edges: Vec<EdgeNo> = edges.flatten().copied().collect();
        let driven: Vec<usize> = (0..edges.len()).filter(|&at| self.rungs.drives(edges[at])).collect();
        let counts =
            |at: usize| driven.iter().min_by_key(|driven| driven.abs_diff(at)).map_or(edges[at], |&at| edges[at]);
        (0..edges.len()).filter_map(|at| Some((network.edges.get(edges[at].index())?.id, counts(at)))).collect()
    }

    /// The line of the stroke that an edge belongs to.
    ///
    /// # Errors
    /// The stroke has no corridor; the error is the reason.
    pub fn line_of(&mut self, edge: EdgeNo) -> Result<Arc<StrokeLine>, UnknownReason> {
        let (stroke, _) = self.of(edge).ok_or(UnknownReason::Geometry)?;
        self.line(stroke)
    }

    pub(super) fn closed(&self, stroke: u32) -> bool {
        self.roads.network.strokes.get(stroke as usize).is_some_and(|stroke| stroke.closed)
    }
}
