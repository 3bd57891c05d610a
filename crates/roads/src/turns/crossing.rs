//! What a crossing has beside the strips of a turn's two roads: the mouths of its other roads, the parts that two roads
//! share, and the corners between neighbouring roads. Inside the crossing no lane is reserved for one direction.
//!
//! Nothing is invented: every part is carriageway of a road of the map, or a corner as turns have it (mapped, else
//! rounded with the assumed radius). Between carriageways that run side by side there is no corner, so a median stays
//! out. Rings have islands and lanes of their own and are left alone.

use geo::{BooleanOps, MultiPolygon, Polygon};

use super::TurnParams;
use super::area::{ARC_STEP_RAD, CROSSING_M, Corner, polygon, rounded};
use super::path::wrapped;
use super::surface::surface;
use super::vector::along;
use crate::corridor::Frame;
use crate::network::{Edge, EdgeNo, Network, Road};
use crate::osm::NodeId;

/// Length of another road's mouth that bodies may overhang, from the node, metres. Parts that two roads share end there,
/// too.
const MOUTH_M: f64 = 15.0;
/// Least angle at which two roads share a part, radians. At smaller angles they run side by side.
const LEAST_ANGLE_RAD: f64 = 0.5;
/// Most roads at a node, and most nodes of a crossing, whose parts count. More are no crossing that was built; the area without
/// their parts is smaller.
const MOST_ROADS: usize = 16;
pub(super) const MOST_NODES: usize = 32;
/// Least angle between two mouths of a road that goes on, radians; and how far each is extended over the node, metres.
const GOES_ON_RAD: f64 = 2.36;
const JOINT_M: f64 = 2.0;
/// As [`ARC_STEP_RAD`], for people to look at. An arc is off by up to 0.5 % of its radius.
const COARSE_ARC_STEP_RAD: f64 = 0.2;

/// The carriageway of a road from the node outwards.
struct Mouth<'a> {
    network: &'a Network,
    edge: &'a Edge,
    road: &'a Road,
    line: Vec<[f64; 2]>,
    /// Edges of the carriageway, metres to the left of `line`.
    left_m: f64,
    right_m: f64,
    bearing: f64,
    /// Whether it is one of the turn's own roads.
    own: bool,
}

/// The parts of the crossing at the end of the first of two edges, beside the strips of their roads.
pub(super) fn parts(
    network: &Network,
    own: [EdgeNo; 2],
    frame: Frame,
    params: &TurnParams,
    mapped: Option<&MultiPolygon>,
) -> Vec<Polygon> {
    let Some(node) = network.edges.get(own[0].index()).map(|edge| edge.to_node) else { return Vec::new() };
    let mouths = mouths(network, node, &own, frame, params);
    if mouths.iter().any(|mouth| mouth.road.roundabout) {
        return Vec::new();
    }
    parts_of(&mouths, node, params, mapped, ARC_STEP_RAD)
}

/// All that the crossing at a node covers, and the number of its roads. A ring's arcs are roads like others, but have no corner between
/// them.
pub(super) fn whole(
    network: &Network,
    node: NodeId,
    frame: Frame,
    params: &TurnParams,
    mapped: Option<&MultiPolygon>,
) -> (Vec<Polygon>, usize) {
    let mouths = mouths(network, node, &[], frame, params);
    (parts_of(&mouths, node, params, mapped, COARSE_ARC_STEP_RAD), mouths.len())
}

/// The mouths of roads that are not the turn's own, what they share, the outsides of bends, and the corners.
fn parts_of(
    mouths: &[Mouth<'_>],
    node: NodeId,
    params: &TurnParams,
    mapped: Option<&MultiPolygon>,
    chord_rad: f64,
) -> Vec<Polygon> {
    let mut parts: Vec<Polygon> =
        mouths.iter().filter(|mouth| !mouth.own).filter_map(|mouth| mouth.outline(MOUTH_M, 0.0)).collect();
    for (i, a) in mouths.iter().enumerate() {
        for b in &mouths[i + 1..] {
            if wrapped(a.bearing - b.bearing).sin().abs() >= LEAST_ANGLE_RAD.sin() {
                // A mouth that is a part has what it shares with others.
                parts.extend(a.own.then(|| shared(a, b)).into_iter().flatten());
                parts.extend(b.own.then(|| shared(b, a)).into_iter().flatten());
            }
            if wrapped(a.bearing - b.bearing).abs() >= GOES_ON_RAD {
                parts.extend(joint(a, b));
            }
        }
    }
    for (i, a) in mouths.iter().enumerate() {
        let b = &mouths[(i + 1) % mouths.len()];
        // The turn's own corner is made from its corridors. Two arcs of a ring have none.
        let left_out = (a.own && b.own) || (a.road.roundabout && b.road.roundabout);
        if !left_out {
            parts.extend(corner(node, [a, b], params, mapped, chord_rad));
        }
    }
    parts
}

/// The parts of a crossing that two edges of one road pass. A node without another road has none.
pub(super) fn passed(network: &Network, own: [EdgeNo; 2], frame: Frame, params: &TurnParams) -> Vec<Polygon> {
    let [Some(before), Some(after)] = own.map(|edge| network.edges.get(edge.index())) else { return Vec::new() };
    let piece = |edge: &Edge| (edge.road, edge.shape.start);
    let meets = |edge: &EdgeNo| {
        let edge = network.edges.get(edge.index());
        edge.is_some_and(|edge| ![piece(before), piece(after)].contains(&piece(edge)))
    };
    if !network.crossings.at(before.to_node).iter().any(meets) {
        return Vec::new();
    }
    let mapped = surface(network, before.to_node, &[network.road(before), network.road(after)], frame);
    parts(network, own, frame, params, mapped.as_ref())
}

/// The whole carriageway of edges inside a crossing, one part from each end. Edges are shorter than twice a mouth.
pub(super) fn carriageways(network: &Network, edges: &[EdgeNo], frame: Frame, params: &TurnParams) -> Vec<Polygon> {
    let edges = edges.iter().filter_map(|&edge| network.edges.get(edge.index()));
    let ends = edges.flat_map(|edge| [(edge, edge.from_node), (edge, edge.to_node)]);
    ends.filter_map(|(edge, node)| mouth(network, edge, node, frame, params)?.outline(MOUTH_M, 0.0)).collect()
}

/// The mouths around a node, counter-clockwise.
fn mouths<'a>(network: &'a Network, node: NodeId, own: &[EdgeNo], frame: Frame, params: &TurnParams) -> Vec<Mouth<'a>> {
    let own: Vec<&Edge> = own.iter().filter_map(|&edge| network.edges.get(edge.index())).collect();
    let mut pieces: Vec<&Edge> = Vec::new();
    let edges = network.crossings.at(node).iter().filter_map(|&edge| network.edges.get(edge.index()));
    for edge in edges.filter(|edge| !network.is_against_traffic(edge)) {
        if !pieces.iter().any(|known| known.road == edge.road && known.shape == edge.shape) {
            pieces.push(edge);
        }
    }
    if pieces.len() > MOST_ROADS {
        return Vec::new();
    }
    let of = |edge: &'a Edge| {
        let own = own.iter().any(|own| own.road == edge.road && own.shape == edge.shape);
        Some(Mouth { own, ..mouth(network, edge, node, frame, params)? })
    };
    let mut mouths: Vec<Mouth<'a>> = pieces.into_iter().filter_map(of).collect();
    mouths.sort_by(|a, b| a.bearing.total_cmp(&b.bearing));
    mouths
}

/// The mouth of an edge at a node. `None` if the road has no width there that counts.
fn mouth<'a>(
    network: &'a Network,
    edge: &'a Edge,
    node: NodeId,
    frame: Frame,
    params: &TurnParams,
) -> Option<Mouth<'a>> {
    let road = network.road(edge);
    let outward = edge.from_node == node;
    let section = network.section(edge);
    let strip = section.carriageway.or(section.direction)?;
    let less_m = params.corridor.map_tolerance_m;
    let (left_m, right_m) = (f64::from(strip.left_m) - less_m, f64::from(strip.right_m) + less_m);
    let (left_m, right_m) = if outward { (left_m, right_m) } else { (-right_m, -left_m) };
    // A narrow place may be anywhere in the mouth. A width that is not a number is none.
    if (left_m - right_m).is_nan() || left_m <= right_m || !edge.narrowings.is_empty() {
        return None;
    }
    let places: Vec<_> = network.positions(edge).collect();
    let mut line = frame.forward(&places).ok()?;
    if !outward {
        line.reverse();
    }
    let line = first_metres(&line, CROSSING_M);
    let (first, last) = (line.first()?, line.get(1)?);
    let bearing = (last[1] - first[1]).atan2(last[0] - first[0]);
    Some(Mouth { network, edge, road, line, left_m, right_m, bearing, own: false })
}

impl Mouth<'_> {
    /// The line `left_m` to the left.
    fn aside(&self, left_m: f64) -> Vec<[f64; 2]> {
        let n = self.line.len();
        let place = |k: usize| {
            let (a, b) = (self.line[k.saturating_sub(1)], self.line[(k + 1).min(n - 1)]);
            let d = [b[0] - a[0], b[1] - a[1]];
            along(self.line[k], [-d[1], d[0]], left_m / d[0].hypot(d[1]).max(1e-9))
        };
        (0..n).map(place).collect()
    }

    /// Unit vector from the node outwards.
    fn outwards(&self) -> [f64; 2] {
        let (sin, cos) = self.bearing.sin_cos();
        [cos, sin]
    }

    /// The first metres of the carriageway, extended straight over the node by `beyond_m`.
    fn outline(&self, length_m: f64, beyond_m: f64) -> Option<Polygon> {
        let near = Mouth { line: first_metres(&self.line, length_m), ..*self };
        let side = |left_m: f64| {
            let mut side = near.aside(left_m);
            if let (true, Some(&first)) = (beyond_m > 0.0, side.first()) {
                side.insert(0, along(first, self.outwards(), -beyond_m));
            }
            side
        };
        let mut ring = side(self.left_m);
        ring.extend(side(self.right_m).into_iter().rev());
        (ring.len() > 3).then(|| polygon(&ring))
    }
}

/// The part of a road's mouth that another road crosses.
fn shared(a: &Mouth<'_>, b: &Mouth<'_>) -> Vec<Polygon> {
    common(a.outline(MOUTH_M, 0.0), b.outline(MOUTH_M, MOUTH_M))
}

/// The outside of the bend between two mouths of a road that goes on: what both have in common, each extended over the node.
fn joint(a: &Mouth<'_>, b: &Mouth<'_>) -> Vec<Polygon> {
    common(a.outline(JOINT_M, JOINT_M), b.outline(JOINT_M, JOINT_M))
}

fn common(a: Option<Polygon>, b: Option<Polygon>) -> Vec<Polygon> {
    a.zip(b).map_or_else(Vec::new, |(a, b)| a.intersection(&b).0)
}

/// The corner between a mouth and the next one counter-clockwise.
fn corner(
    node: NodeId,
    [a, b]: [&Mouth<'_>; 2],
    params: &TurnParams,
    mapped: Option<&MultiPolygon>,
    chord_rad: f64,
) -> Vec<Polygon> {
    let between = (b.bearing - a.bearing).rem_euclid(std::f64::consts::TAU);
    if between >= std::f64::consts::PI {
        return Vec::new();
    }
    // Who arrives on the one road and leaves on the other turns right.
    let turn_rad = between - std::f64::consts::PI;
    let kerb = |arm: usize, beyond_m: f64| {
        if arm == 0 {
            let mut line = a.aside(a.left_m + beyond_m);
            line.reverse();
            let end = line.last().map(|&last| along(last, a.outwards(), -CROSSING_M));
            line.extend(end);
            line
        } else {
            let mut line = b.aside(b.right_m - beyond_m);
            if let Some(&first) = line.first() {
                line.insert(0, along(first, b.outwards(), -CROSSING_M));
            }
            line
        }
    };
    match mapped {
        Some(surface) => Corner::between([&kerb(0, 0.0), &kerb(1, 0.0)], turn_rad)
            .map_or_else(Vec::new, |corner| corner.mapped(surface)),
        None => {
            let radius_m = params.kerbs.at(a.network, node, [a.edge, b.edge]);
            rounded(&kerb, turn_rad, radius_m, chord_rad).into_iter().collect()
        }
    }
}

/// The first metres of a line.
fn first_metres(line: &[[f64; 2]], length_m: f64) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = line.first().copied().into_iter().collect();
    let mut left_m = length_m;
    for w in line.windows(2) {
        let d = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let step_m = d[0].hypot(d[1]);
        if step_m >= left_m {
            out.push(along(w[0], d, left_m / step_m.max(1e-9)));
            break;
        }
        if step_m > 0.05 {
            out.push(w[1]);
        }
        left_m -= step_m;
    }
    out
}
