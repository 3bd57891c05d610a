//! Turns: every movement at a junction that is not straight on gets corridors of its own, to be certified like any other.
//!
//! A turn's corridor begins on the centreline of the stroke that it leaves and ends on that of the stroke it joins, with their
//! half-widths, so that a route strings stroke, turn and stroke together without a seam. In between it runs along one of a
//! family of reference paths, as wide as the drivable area lets it be. When in doubt it is narrower: nothing that no road covers
//! counts as road but the kerb return: as its surface is mapped, or of a radius that is assumed and says so.
//!
//! | file | for |
//! | --- | --- |
//! | `arm` | a stroke near the junction, with the edges of the road |
//! | `kerbs` | assumed kerb radii, `data/kerbs.toml` |
//! | `surface` | the junction's surface, where it is mapped |
//! | `area` | the drivable area as polygons |
//! | `path` | transition, arc, transition; lane shifts |
//! | `rays` | how wide the area is along a path |
//! | `family` | which paths there are, and the corridors they give |
//! | `roundabout` | onto a ring, round and off it as one movement |
//! | `rank` | which of them a vehicle's certificate is worth trying on |
//! | `facts` | what the map says of a turn: id, angle, line |
//!
//! Left out: surfaces mapped as relations (with holes), lane markings inside the junction; lanes for turning (`turn:lanes`): the vehicle arrives
//! and leaves in the lanes that its edges are certified for.

mod area;
mod arm;
mod facts;
mod family;
mod kerbs;
mod path;
mod rank;
mod rays;
mod roundabout;
mod surface;

use std::ops::Range;

use geo::MultiPolygon;

pub use arm::StrokeLine;
pub use facts::{KerbSource, TurnFacts, turn_facts};
pub use kerbs::Kerbs;
pub use rank::nominal_leeway_m;

use crate::corridor::{Corridor, Frame, Params};
use crate::network::{Movement, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// How turns are made into corridors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TurnParams {
    /// How strokes are made into corridors.
    pub corridor: Params,
    /// What is assumed of kerbs.
    pub kerbs: Kerbs,
}

/// How long the vehicles are for which a turn is made: how much road before and after it counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reach {
    /// Up to 20 m.
    Short,
    /// Up to 60 m.
    Long,
}

impl Reach {
    /// The reach for a vehicle; `None`: it is longer than any.
    #[must_use]
    pub fn of(vehicle: &crate::vehicle::Vehicle) -> Option<Self> {
        let length_m = vehicle.length_m;
        if length_m <= 20.0 { Some(Self::Short) } else { (length_m <= 60.0).then_some(Self::Long) }
    }

    /// Before the path begins, that counts: the vehicle's tail is still there when its head turns. Metres.
    const fn counted_before_m(self) -> f64 {
        match self {
            Self::Short => 20.0,
            Self::Long => 60.0,
        }
    }

    /// Before that: driven, so that the vehicle arrives articulated as the road makes it. Metres.
    const fn run_in_m(self) -> f64 {
        match self {
            Self::Short => 20.0,
            Self::Long => 40.0,
        }
    }

    /// After the path has ended, that counts: by then a vehicle is as good as straight (its units' angles fall by a factor of e
    /// over their lengths). Metres.
    const fn counted_after_m(self) -> f64 {
        match self {
            Self::Short => 45.0,
            Self::Long => 100.0,
        }
    }
}

/// Where a path leaves or joins a stroke's centreline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// Index into `Network::strokes`.
    pub stroke: u32,
    /// Station of the stroke's corridor.
    pub station: usize,
}

/// One way to drive a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnPath {
    /// Its place in the family: the same turn, policy and reach give the same path the same number.
    pub number: u8,
    /// Approach, turn, departure: metric, in the turn's frame.
    pub corridor: Corridor,
    /// Stations of the turn itself, between the joints.
    pub turn: Range<usize>,
    /// Stations that count for the turn's certificate: from where the vehicle's tail is when its head begins to turn, to where it
    /// is straight again (or the departure stroke ends).
    pub counted: Range<usize>,
    /// Where it leaves the stroke of `from`.
    pub approach: Joint,
    /// Where it joins the stroke of `to`.
    pub departure: Joint,
    /// Smallest radius between the joints, metres.
    pub min_radius_m: f64,
}

/// All ways to drive a turn that stay on the road.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnCorridors {
    /// In which everything is.
    pub frame: Frame,
    /// Between the strokes' directions at the node, radians, positive left.
    pub turn_rad: f64,
    /// What may be driven on.
    pub area: MultiPolygon,
    /// Assumed radius of the kerb return, metres; `None`: the corner has none (too acute or too flat), or its surface is mapped.
    pub kerb_radius_m: Option<f64>,
    /// In order of their numbers; may be empty: then no path of the family stays on the road.
    pub paths: Vec<TurnPath>,
}

/// The corridors of a turn, from the network alone.
///
/// # Errors
/// One of its edges has no corridor.
pub fn turn_corridors(
    network: &Network,
    movement: Movement,
    policy: Policy,
    params: &TurnParams,
    reach: Reach,
) -> Result<TurnCorridors, UnknownReason> {
    let line = |edge: u32| {
        let stroke = stroke_of(network, edge).ok_or(UnknownReason::Geometry)?;
        StrokeLine::new(network, stroke, policy, &params.corridor)
    };
    turn_on(network, movement, [&line(movement.from)?, &line(movement.to)?], policy, params, reach)
}

/// As [`turn_corridors`], on the lines of the two edges' strokes.
///
/// # Errors
/// One of the edges has no corridor.
pub fn turn_on(
    network: &Network,
    movement: Movement,
    lines: [&StrokeLine; 2],
    policy: Policy,
    params: &TurnParams,
    reach: Reach,
) -> Result<TurnCorridors, UnknownReason> {
    family::Junction::new(network, movement, lines, lines[0].frame, policy, params, reach)?.corridors()
}

/// The corridors of a turn, or of a roundabout's passage: as [`turn_corridors`] and [`passage_on`].
///
/// # Errors
/// One of its edges or arcs has no corridor; the ring is too small to have any.
pub fn corridors_of(
    network: &Network,
    turn: &TurnFacts,
    policy: Policy,
    params: &TurnParams,
    reach: Reach,
) -> Result<TurnCorridors, UnknownReason> {
    let TurnFacts { movement, through, .. } = turn;
    let Some(&arc) = through.first() else {
        return turn_corridors(network, turn.movement, policy, params, reach);
    };
    let line = |edge: u32| {
        let stroke = stroke_of(network, edge).ok_or(UnknownReason::Geometry)?;
        StrokeLine::new(network, stroke, policy, &params.corridor)
    };
    let lines = [line(turn.movement.from)?, line(arc)?, line(turn.movement.to)?];
    passage_on(network, (*movement, through), lines.each_ref(), policy, params, reach)
}

/// A roundabout entered, circulated over some arcs and left as one movement: `lines` are those of the strokes of `from`, the ring and
/// `to`.
///
/// Joints, frame and stations are as those of a turn, so that a route strings it in the same way.
///
/// # Errors
/// One of its edges or arcs has no corridor; the ring is too small to have any.
pub fn passage_on(
    network: &Network,
    over: (Movement, &[u32]),
    lines: [&StrokeLine; 3],
    policy: Policy,
    params: &TurnParams,
    reach: Reach,
) -> Result<TurnCorridors, UnknownReason> {
    roundabout::Passage::new(network, over, lines, policy, params, reach)?.corridors()
}

/// The stroke that an edge belongs to.
fn stroke_of(network: &Network, edge: u32) -> Option<u32> {
    let has = |s: &crate::network::Stroke| {
        network.stroke_edges.get(s.edges.start as usize..s.edges.end as usize).is_some_and(|all| all.contains(&edge))
    };
    network.strokes.iter().position(has).map(|i| i as u32)
}
