//! Where permits use more of the road than the vehicle's own lane, and what that costs a route (`data/rungs.toml`, as `netcert route --at-most`
//! counts it).
//!
//! Nothing is known if the database has the vehicle under one policy alone: then no road is dearer than another.

use rustc_hash::FxHashMap;

use super::permit::Bits;
use super::{ExportError, Source};
use crate::osm::facts::{Policy, RoadClass};
use crate::route::{Measure, RungPrices, Speeds};
use crate::rows::{EdgeNo, EdgeRung, TurnNo};
use crate::words::Named as _;

/// What the database knows of the strip that a permitted edge uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EdgeUse {
    /// The narrowest strip on which the vehicle is certified there.
    pub(super) strip: Policy,
    /// What the road costs a route: so many times its time. 1 on the own lane.
    pub(super) factor: f64,
}

/// A kind of road on which more than the own lane is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WiderRoad {
    /// The narrowest strip on which the vehicle is certified there.
    pub(super) strip: Policy,
    /// What the road costs a route: so many times its time.
    pub(super) factor: f64,
    /// The speed of a heavy vehicle there (`data/speeds.toml`), m/s.
    pub(super) m_s: f64,
}

/// The permitted edges and turns that use more than the own lane.
#[derive(Debug, Clone, Default)]
pub(super) struct Wider {
    /// Whether the database has the vehicle under a narrower policy, too.
    known: bool,
    /// In order of the edges, each with its place in `kinds`. There are few kinds and many edges.
    edges: Vec<(EdgeNo, u16)>,
    kinds: Vec<WiderRoad>,
    /// By turn: whether it uses other lanes of its direction, and whether it uses the oncoming lane.
    turns: [Bits; 2],
    /// The time of a turn with what it costs on these strips, seconds.
    turn_s: [f64; 2],
}

/// The strips wider than the own lane.
const STRIPS: [Policy; 2] = [Policy::Direction, Policy::Carriageway];

/// What two roads have in common if they cost the same.
type RoadKind = (Policy, RoadClass, bool, Option<u8>);

impl Wider {
    /// Whether the database knows where a narrower strip would do.
    pub(super) fn known(&self) -> bool {
        self.known
    }

    /// What a permitted edge uses. `None` if the database does not know whether a narrower strip would do.
    pub(super) fn uses(&self, edge: EdgeNo) -> Option<EdgeUse> {
        let lane = EdgeUse { strip: Policy::Lane, factor: 1.0 };
        self.known.then(|| self.edge(edge).map_or(lane, |WiderRoad { strip, factor, .. }| EdgeUse { strip, factor }))
    }

    /// What a permitted edge costs, if it uses more than the own lane.
    pub(super) fn edge(&self, edge: EdgeNo) -> Option<WiderRoad> {
        let at = self.edges.binary_search_by_key(&edge, |wide| wide.0).ok()?;
        self.kinds.get(usize::from(self.edges.get(at)?.1)).copied()
    }

    /// The time of a permitted turn (`data/speeds.toml`) with what it costs, if it uses more than the own lane, seconds.
    pub(super) fn turn_s(&self, turn: TurnNo) -> Option<f64> {
        let used = self.turns.iter().zip(self.turn_s).find(|(turns, _)| turns.get(turn.index()));
        used.map(|(_, seconds)| seconds)
    }
}

impl Source<'_> {
    /// Where permits use more than the own lane.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(super) fn wider(&self) -> Result<Wider, ExportError> {
        let (vehicle, policy) = (&self.ask.vehicle, self.ask.policy);
        let mut database = self.database()?;
        let (mut known, mut turns_known) = (false, false);
        for narrower in Policy::ALL.iter().filter(|narrower| **narrower < policy) {
            known |= database.certified_set(vehicle, *narrower)?.is_some();
            turns_known |= database.has_turns(vehicle, *narrower)?;
        }
        if !known {
            return Ok(Wider::default());
        }
        let (prices, speeds) = (RungPrices::builtin()?, Speeds::builtin()?);
        let (mut edges, mut kinds) = (Vec::new(), Vec::new());
        let mut places: FxHashMap<RoadKind, u16> = FxHashMap::default();
        for rung in self.told(database.edge_rungs(vehicle, policy)?) {
            let EdgeRung { edge, uses, class, link, maxspeed_kmh } = rung?;
            if uses == Policy::Lane || !self.permitted.edges.get(edge.index()) {
                continue;
            }
            let place = *places.entry((uses, class, link, maxspeed_kmh)).or_insert_with(|| {
                let (factor, m_s) = (1.0 + prices.share(uses, class), speeds.m_s(class, link, maxspeed_kmh));
                kinds.push(WiderRoad { strip: uses, factor, m_s });
                (kinds.len() - 1) as u16
            });
            edges.push((edge, place));
        }
        let mut turns = STRIPS.map(|_| Bits::unset(self.permitted.turns.len()));
        // Of a set without turns nothing is known of narrower turns.
        if turns_known {
            for rung in self.told(database.turn_rungs(vehicle, policy)?) {
                let (turn, uses) = rung?;
                for (bits, _) in turns.iter_mut().zip(STRIPS).filter(|(_, strip)| *strip == uses) {
                    bits.set(turn.index());
                }
            }
        }
        let own_s = 1e-3 * speeds.turn_cost(Measure::Time) as f64;
        Ok(Wider { known, edges, kinds, turns, turn_s: STRIPS.map(|strip| own_s + prices.turn_s(strip)) })
    }
}
