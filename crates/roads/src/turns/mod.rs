//! Turns: every movement at a junction that is not straight on gets corridors of its own, which are certified like any
//! other.
//!
//! A turn's corridor begins on the centreline of the stroke that it leaves and ends on that of the stroke that it
//! joins, with their half-widths. A route can therefore join stroke, turn and stroke without a seam. In between the
//! corridor follows a path that a planner finds for the vehicle, as wide as the drivable area allows. In doubt it is
//! narrower, and the area itself counts beside it.
//! Only surface that a road covers counts, with one exception: the kerb return. Its surface is mapped, or it has an
//! assumed radius and is marked as assumed.
//!
//! | file | for |
//! | --- | --- |
//! | `arm` | a stroke near the junction, with the edges of the road |
//! | `kerbs` | assumed kerb radii, `data/kerbs.toml` |
//! | `surface` | the junction's mapped surface |
//! | `islands` | mapped islands, which every area lacks |
//! | `vector` | places and directions in the plane |
//! | `area` | the drivable area as polygons |
//! | `crossing` | what the other roads of the junction add to it |
//! | `drawn_corner` | a corner between two drawn roads, without a map |
//! | `path` | transition, arc, transition; lane shifts |
//! | `code` | a path's parameters in one integer |
//! | `arms` | the two roads of a turn, and the path of each code |
//! | `junction` | a turn over one node, with its area |
//! | `complex` | a movement over several nodes of one crossing |
//! | `roundabout` | entering, circulating and leaving a ring as one movement |
//! | `rays` | the width of the area along a path |
//! | `ends` | the corridor along a path, with its area |
//! | `corridors` | a turn, prepared: from codes to corridors |
//! | `family` | the paths with which the search begins |
//! | `planner` | the search for the path with the most room for a vehicle |
//! | `facts` | facts of a turn from the map: id, angle, line |
//! | `turn_no` | the number of a turn in its network |
//! | `junction_area` | the area of a junction, for people to look at |
//!
//! Surfaces mapped as relations (with holes) and lane markings inside the junction are left out. The vehicle arrives and
//! leaves in the lanes that its edges are certified for.

mod area;
mod arm;
mod arms;
mod code;
mod complex;
mod corridors;
mod crossing;
mod drawn_corner;
mod ends;
mod facts;
mod family;
mod islands;
mod junction;
mod junction_area;
mod kerbs;
mod path;
mod planner;
mod rays;
mod roundabout;
mod surface;
mod turn_no;
mod vector;

use std::ops::Range;

pub use arm::StrokeLine;
pub use corridors::TurnCorridors;
pub use drawn_corner::DrawnCorner;
pub use facts::{KerbSource, TurnFacts, turn_facts};
pub use islands::cut_out_of_route;
pub use junction_area::{JunctionArea, Ring, junction_areas, junction_nodes, junction_places};
pub use kerbs::Kerbs;
pub use planner::{PlannedPath, TurnPlanner};
pub use turn_no::TurnNo;

use crate::corridor::{AreaSpan, Corridor, Params};
use crate::network::{EdgeNo, Movement, Network, PassageKind};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Parameters of turn corridors.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnParams {
    /// The strip that a vehicle may use near a turn; never less than its own policy's. A long vehicle uses all lanes of
    /// its direction before and after a turn, and guidelines count on it (AASHTO, Green Book, encroachment conditions).
    pub strip: Policy,
    /// Parameters of stroke corridors.
    pub corridor: Params,
    /// Assumed kerb radii.
    pub kerbs: Kerbs,
    /// The radius of the turn's own corners instead, metres: those on the inside, where its roads meet. The other corners of the
    /// junction stay.
    pub own_kerb_m: Option<f64>,
}

impl Default for TurnParams {
    /// The policy's own strip, and the built-in kerbs.
    fn default() -> Self {
        Self { strip: Policy::Lane, corridor: Params::default(), kerbs: Kerbs::default(), own_kerb_m: None }
    }
}

/// Length class of the vehicles for which a turn is made. It determines how much road before and after the turn counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LengthClass {
    /// Vehicles up to 20 m.
    Short,
    /// Vehicles up to 60 m.
    Long,
}

impl LengthClass {
    /// The length class of a vehicle. `None` if the vehicle is too long.
    #[must_use]
    pub fn of(vehicle: &crate::vehicle::Vehicle) -> Option<Self> {
        let length_m = vehicle.length_m;
        if length_m <= 20.0 { Some(Self::Short) } else { (length_m <= 60.0).then_some(Self::Long) }
    }

    /// Length before the path that counts, metres: the vehicle's rear is still there when its front turns.
    pub const fn counted_before_m(self) -> f64 {
        match self {
            Self::Short => 20.0,
            Self::Long => 60.0,
        }
    }

    /// Length of the longest vehicle, metres.
    const fn longest_m(self) -> f64 {
        match self {
            Self::Short => 20.0,
            Self::Long => 60.0,
        }
    }

    /// Length before that, metres. It is driven, so that the vehicle arrives articulated as on the road.
    const fn run_in_m(self) -> f64 {
        match self {
            Self::Short => 20.0,
            Self::Long => 40.0,
        }
    }

    /// Length after the path that counts, metres. At its end a vehicle is almost straight: articulation angles fall by
    /// a factor of e over a unit's length.
    pub const fn counted_after_m(self) -> f64 {
        match self {
            Self::Short => 45.0,
            Self::Long => 100.0,
        }
    }

    /// What counts of the turn's strip at a distance before a path begins: all of it at the joint, nothing where the vehicle's rear is
    /// when its front begins to turn.
    pub fn opening_before(self, before_m: f64) -> Opening {
        Opening::new(1.0 - before_m / self.counted_before_m(), self.counted_before_m() - before_m)
    }

    /// The same at a distance after a path has ended: all of it for half the way that counts, nothing at its end.
    pub fn opening_after(self, after_m: f64) -> Opening {
        Opening::new(2.0 - 2.0 * after_m / self.counted_after_m(), self.counted_after_m() - after_m)
    }
}

/// What counts of a strip beyond the policy's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Share of what the strip has beyond.
    share: f64,
    /// At most this for half-widths, metres. A certificate deducts the change of a half-width along a body, so a lane that opened into
    /// a wide road at once would be lost where it begins to open.
    most_m: f64,
}

/// Largest change of a half-width per metre where a strip opens.
const OPENING: f64 = 0.05;

impl Opening {
    /// Nothing counts.
    pub const NONE: Self = Self { share: 0.0, most_m: 0.0 };
    /// All of the strip counts.
    pub(super) const WHOLE: Self = Self { share: 1.0, most_m: f64::INFINITY };

    fn new(share: f64, way_m: f64) -> Self {
        Self { share: share.clamp(0.0, 1.0), most_m: (OPENING * way_m).max(0.0) }
    }

    /// The same for an area's edges, which no slope costs anything.
    pub(super) fn of_an_area(self) -> Self {
        Self { most_m: f64::INFINITY, ..self }
    }

    /// What counts of `beyond_m`, metres.
    pub(super) fn of(self, beyond_m: f64) -> f64 {
        (self.share * beyond_m).min(self.most_m)
    }
}

/// The place where a path leaves or joins a stroke's centreline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// Index into `Network::strokes`.
    pub stroke: u32,
    /// Station of the stroke's corridor.
    pub station: usize,
}

/// One path of a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnPath {
    /// Code of the path. The same turn, policy and length class make the same path from the same code.
    pub code: i64,
    /// Corridor of approach, turn and departure, metres in the turn's frame. Its areas are the junction's and, where a road ends with it,
    /// the straight road beyond.
    pub corridor: Corridor,
    /// The junction's area, and the stations of `corridor` at which it counts. `None` if the corridor ends at once.
    pub area: Option<AreaSpan>,
    /// Stations of the turn itself, between the joints.
    pub turn: Range<usize>,
    /// Stations that count for the turn's certificate. They begin at the vehicle's rear when its front starts to turn.
    /// They end where the vehicle is straight again, or where the departure stroke ends.
    pub counted: Range<usize>,
    /// Where the path leaves the stroke of `from`.
    pub approach: Joint,
    /// Where the path joins the stroke of `to`.
    pub departure: Joint,
    /// Smallest radius between the joints, metres.
    pub min_radius_m: f64,
}

/// The edges of a turn or passage.
#[derive(Debug, Clone, Copy)]
pub struct TurnEdges<'t> {
    /// The edges before and after it.
    pub movement: Movement,
    /// The edges between, in driving order, for a passage; otherwise empty.
    pub through: &'t [EdgeNo],
}

impl TurnFacts {
    /// Its edges.
    #[must_use]
    pub fn edges(&self) -> TurnEdges<'_> {
        TurnEdges { movement: self.movement, through: &self.through }
    }
}

/// The corridors of a turn, from the network alone.
///
/// # Errors
/// The reason if one of its edges has no corridor.
pub fn turn_corridors(
    network: &Network,
    movement: Movement,
    policy: Policy,
    params: &TurnParams,
    length_class: LengthClass,
) -> Result<TurnCorridors, UnknownReason> {
    on_lines_of(network, TurnEdges { movement, through: &[] }, policy, params, length_class)
}

/// The corridors of a turn or passage, as [`turn_corridors`].
///
/// # Errors
/// The reason if one of its edges has no corridor, or if a ring is too small.
pub fn corridors_of(
    network: &Network,
    turn: &TurnFacts,
    policy: Policy,
    params: &TurnParams,
    length_class: LengthClass,
) -> Result<TurnCorridors, UnknownReason> {
    on_lines_of(network, turn.edges(), policy, params, length_class)
}

fn on_lines_of(
    network: &Network,
    turn: TurnEdges<'_>,
    policy: Policy,
    params: &TurnParams,
    length_class: LengthClass,
) -> Result<TurnCorridors, UnknownReason> {
    let edges = [turn.movement.from, turn.movement.to].into_iter().chain(turn.through.iter().copied());
    let strokes = edges.map(|edge| Some((edge, stroke_of(network, edge)?)));
    let strokes: Vec<(EdgeNo, u32)> = strokes.collect::<Option<_>>().ok_or(UnknownReason::Geometry)?;
    let mut lines: Vec<StrokeLine> = Vec::new();
    for (_, stroke) in &strokes {
        if !lines.iter().any(|line| line.stroke == *stroke) {
            lines.push(StrokeLine::new(network, *stroke, policy, &params.corridor)?);
        }
    }
    let line = |edge: EdgeNo| {
        let stroke = strokes.iter().find(|of| of.0 == edge).map(|of| of.1);
        lines.iter().find(|line| Some(line.stroke) == stroke).ok_or(UnknownReason::Geometry)
    };
    turn_on(network, turn, &line, policy, params, length_class)
}

/// The corridors of a turn, or of a passage over edges. `line` gives the line of an
/// edge's stroke; it is asked for the movement's edges and those between.
///
/// All have joints, frame and stations alike, so a route joins them in the same way.
///
/// # Errors
/// The reason if one of the edges has no corridor, or if a ring is too small.
pub fn turn_on<'l>(
    network: &Network,
    turn: TurnEdges<'_>,
    line: &dyn Fn(EdgeNo) -> Result<&'l StrokeLine, UnknownReason>,
    policy: Policy,
    params: &TurnParams,
    length_class: LengthClass,
) -> Result<TurnCorridors, UnknownReason> {
    let TurnEdges { movement, through } = turn;
    let (from, to) = (line(movement.from)?, line(movement.to)?);
    let frame = from.made.frame;
    match (network.passage_kind(through), through.first()) {
        (Some(PassageKind::Roundabout), Some(&arc)) => {
            let passage =
                roundabout::PreparedPassage::new(network, turn, [from, line(arc)?, to], policy, params, length_class)?;
            TurnCorridors::over(passage, network, frame)
        }
        (Some(PassageKind::Complex), _) => TurnCorridors::across(
            complex::Complex::new(network, turn, line, policy, params, length_class)?,
            network,
            frame,
        ),
        _ => {
            let junction = junction::Junction::new(network, movement, [from, to], frame, policy, params, length_class)?;
            TurnCorridors::at(junction, network, frame)
        }
    }
}

/// The stroke of an edge.
fn stroke_of(network: &Network, edge: EdgeNo) -> Option<u32> {
    let has = |s: &crate::network::Stroke| {
        network.stroke_edges.get(s.edges.start as usize..s.edges.end as usize).is_some_and(|all| all.contains(&edge))
    };
    network.strokes.iter().position(has).map(|i| i as u32)
}
