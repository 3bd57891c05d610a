//! What a route's corridor is made of: strokes and turns, each in a frame of its own.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::corridor::{Corridor, Frame, Params, StrokeCorridor, stroke_corridor};
use crate::network::Network;
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Where a turn's path leaves or joins a stroke's centreline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// Index into `Network::strokes`.
    pub stroke: u32,
    /// Station of the stroke's corridor.
    pub station: usize,
}

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
}

/// Where turns come from.
pub trait Turns {
    /// Ways to drive from one edge into another that are certified for the vehicle, the best first.
    ///
    /// # Errors
    /// There is none, and why.
    fn pieces(&self, from: u32, to: u32) -> Result<Vec<TurnPiece>, UnknownReason>;
}

/// No turn at all: routes then only go straight on.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoTurns;

impl Turns for NoTurns {
    fn pieces(&self, _: u32, _: u32) -> Result<Vec<TurnPiece>, UnknownReason> {
        Err(UnknownReason::Geometry)
    }
}

/// A stroke's corridor with its frame.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) frame: Frame,
    pub(super) made: StrokeCorridor,
    pub(super) closed: bool,
}

/// Strokes of a network, made into corridors as they are asked for and kept.
pub struct Strokes<'n> {
    network: &'n Network,
    policy: Policy,
    params: Params,
    /// By edge: its stroke, and its place in it.
    place: Vec<(u32, u32)>,
    made: FxHashMap<u32, Result<Line, UnknownReason>>,
}

impl<'n> Strokes<'n> {
    /// Nothing is made yet.
    #[must_use]
    pub fn new(network: &'n Network, policy: Policy, params: Params) -> Self {
        let mut place = vec![(u32::MAX, 0); network.edges.len()];
        for (stroke, facts) in (0_u32..).zip(&network.strokes) {
            let edges = &network.stroke_edges[facts.edges.start as usize..facts.edges.end as usize];
            for (i, &edge) in (0_u32..).zip(edges) {
                place[edge as usize] = (stroke, i);
            }
        }
        Self { network, policy, params, place, made: FxHashMap::default() }
    }

    /// Stroke of an edge, and the edge's place in it.
    pub(super) fn of(&self, edge: u32) -> Option<(u32, u32)> {
        self.place.get(edge as usize).copied().filter(|place| place.0 != u32::MAX)
    }

    pub(super) fn line(&mut self, stroke: u32) -> Result<&Line, UnknownReason> {
        let (network, policy, params) = (self.network, self.policy, &self.params);
        let line = self.made.entry(stroke).or_insert_with(|| make(network, stroke, policy, params));
        line.as_ref().map_err(|reason| *reason)
    }
}

fn make(network: &Network, stroke: u32, policy: Policy, params: &Params) -> Result<Line, UnknownReason> {
    let facts = network.strokes.get(stroke as usize).ok_or(UnknownReason::Geometry)?;
    let made = stroke_corridor(network, facts, policy, params)?;
    let chain = facts.approach.start as usize..facts.edges.end as usize;
    let positions: Vec<_> =
        network.stroke_edges[chain].iter().flat_map(|&edge| network.positions(&network.edges[edge as usize])).collect();
    let frame = Frame::around(&positions).map_err(|_| UnknownReason::Geometry)?;
    Ok(Line { frame, made, closed: facts.closed })
}
