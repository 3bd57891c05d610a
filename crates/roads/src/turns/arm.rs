//! A stroke near a junction: its corridor, and the extent of the road to both sides.
//!
//! A turn's approach and departure are windows of the corridors by which their edges are certified, so a route passes
//! from one into the other without a seam. Road edges are measured from the strip's edges without tapers: a road that
//! goes on narrower beyond the junction is as wide as mapped up to it. A narrow place narrows the junction with it.

use super::path::{PathPose, hermite};
use super::{LengthClass, Opening};
use crate::corridor::{Corridor, Frame, Params, Sections, StrokeCorridor, StrokeLayout};
use crate::network::{EdgeNo, Network};
use crate::osm::facts::{Policy, Strip};
use crate::verdict::UnknownReason;

/// Largest |κ|·half-width of a strip beyond the corridor's own.
const MOST_CROSSING: f64 = 0.9;
/// Distance from the node within which a turn may use its whole strip, metres. Paths leave and join the centrelines
/// within it; beyond it the strip narrows to the corridor's own, as before and after a path.
const WHOLE_STRIP_M: f64 = 60.0;

/// Largest change of a strip's half-width per metre beside a path. A certificate deducts the change along a body.
const STEEPEST: f64 = 0.1;

/// Edges of the road across a corridor's centreline, metres, positive left: `[left, right]`.
pub(super) type RoadEdges = [f64; 2];

/// A stroke's corridor with its frame and the edges of the road.
#[derive(Debug, Clone)]
pub struct StrokeLine {
    /// Index into `Network::strokes`.
    pub stroke: u32,
    /// The corridor by which the stroke's edges are certified.
    pub made: StrokeCorridor,
    pub(super) closed: bool,
    /// One entry per station: all lanes of the direction, then everything between the kerbs.
    direction: Vec<RoadEdges>,
    carriageway: Vec<RoadEdges>,
    /// The same without steps: where the road becomes wider, it does so gradually.
    gradual: [Vec<RoadEdges>; 2],
    /// The edges of the corridor's strip as the map has them, without tapers.
    mapped: Vec<RoadEdges>,
}

impl StrokeLine {
    /// Makes the corridor of a stroke.
    ///
    /// # Errors
    /// The reason if all edges of the stroke are unknown.
    pub fn new(network: &Network, stroke: u32, policy: Policy, params: &Params) -> Result<Self, UnknownReason> {
        Self::on(network, stroke, &|edge| network.section(edge), policy, params)
    }

    /// Makes the corridor of a stroke with other cross sections.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn on(
        network: &Network,
        stroke: u32,
        sections: &Sections<'_>,
        policy: Policy,
        params: &Params,
    ) -> Result<Self, UnknownReason> {
        let facts = network.strokes.get(stroke as usize).ok_or(UnknownReason::Geometry)?;
        let (made, mapped) = StrokeLayout::new(network, facts, params)?.corridor_and_strip(sections, policy)?;
        let c = &made.corridor;
        let own: Vec<RoadEdges> = c.left_m.iter().zip(&c.right_m).map(|(l, r)| [*l, -*r]).collect();
        let (mut direction, mut carriageway) = (own.clone(), own.clone());
        for span in &made.spans {
            let Some(edge) = network.edges.get(span.edge.index()) else { continue };
            let section = sections(edge);
            for k in span.stations.clone() {
                // A taper to the next edge narrows and moves the corridor, not the road.
                let strip = mapped[k];
                direction[k] = outer(own[k], wider(strip, section.strip(policy), section.direction));
                let all = section.carriageway.or(section.direction);
                carriageway[k] = outer(direction[k], wider(strip, section.strip(policy), all));
            }
        }
        let gradual = [&direction, &carriageway].map(|edges| gradual(&made.corridor, edges));
        Ok(Self { stroke, made, closed: facts.closed, direction, carriageway, gradual, mapped })
    }

    /// A drawn road, which has nothing beside its corridor.
    pub(super) fn drawn(stroke: u32, made: StrokeCorridor) -> Self {
        let c = &made.corridor;
        let own: Vec<RoadEdges> = c.left_m.iter().zip(&c.right_m).map(|(l, r)| [*l, -*r]).collect();
        let [direction, carriageway, first, second] = [own.clone(), own.clone(), own.clone(), own.clone()];
        Self { stroke, made, closed: false, direction, carriageway, gradual: [first, second], mapped: own }
    }

    /// The edges of `part`, a strip of the road at a station, metres to the left of the centreline: `[left, right]`. `own` is the strip that
    /// the corridor has there. Both are measured from the same line, as the strips of one cross section are.
    #[must_use]
    pub fn edges_of(&self, station: usize, own: Strip, part: Strip) -> Option<[f64; 2]> {
        let [left_m, right_m] = *self.mapped.get(station)?;
        Some([left_m + f64::from(part.left_m - own.left_m), right_m + f64::from(part.right_m - own.right_m)])
    }

    /// Half-widths at a station of the stroke, left and right: the corridor's own, and of what `strip` has beyond them the
    /// given part.
    pub fn half_widths(&self, strip: Policy, station: usize, opening: Opening) -> [f64; 2] {
        widened(&self.made.corridor, station, self.gradual(strip, station), opening)
    }

    /// Edges of a strip at a station for half-widths: as [`Self::strip`], without steps.
    fn gradual(&self, strip: Policy, station: usize) -> RoadEdges {
        let c = &self.made.corridor;
        match strip {
            Policy::Lane => [c.left_m[station], -c.right_m[station]],
            Policy::Direction => self.gradual[0][station],
            Policy::Carriageway => self.gradual[1][station],
        }
    }

    /// Edges of a strip at a station; never inside the corridor's own.
    fn strip(&self, strip: Policy, station: usize) -> RoadEdges {
        let c = &self.made.corridor;
        match strip {
            Policy::Lane => [c.left_m[station], -c.right_m[station]],
            Policy::Direction => self.direction[station],
            Policy::Carriageway => self.carriageway[station],
        }
    }

    /// Number of stations.
    #[must_use]
    pub fn stations(&self) -> usize {
        self.made.corridor.len()
    }
}

/// Half-widths of a corridor at a station, left and right, with the given part of what a strip has beyond them. The strip counts
/// only where normals do not cross.
fn widened(c: &Corridor, k: usize, strip: RoadEdges, opening: Opening) -> [f64; 2] {
    let own = [c.left_m[k], c.right_m[k]];
    let wide = [strip[0], -strip[1]];
    [0, 1].map(|side| {
        let towards = if side == 0 { c.curvature[k] } else { -c.curvature[k] };
        let clear = if towards > 0.0 { MOST_CROSSING / towards } else { f64::INFINITY };
        own[side].max((own[side] + opening.of(wide[side] - own[side])).min(clear))
    })
}

/// The edges of a strip without steps: nowhere farther out than they are, and nowhere inside the corridor.
fn gradual(c: &Corridor, edges: &[RoadEdges]) -> Vec<RoadEdges> {
    let mut out = edges.to_vec();
    let step_m = STEEPEST * c.spacing_m;
    let limit = |out: &mut [RoadEdges], k: usize, beside: usize| {
        let [left, right] = out[beside];
        out[k] = [
            out[k][0].min(left + step_m).max(c.left_m[k].min(edges[k][0])),
            out[k][1].max(right - step_m).min((-c.right_m[k]).max(edges[k][1])),
        ];
    };
    (1..out.len()).for_each(|k| limit(&mut out, k, k - 1));
    (1..out.len()).rev().for_each(|k| limit(&mut out, k - 1, k));
    out
}

/// The edges of `strip`, where `base` has its edges at `own`; never inside `own`.
fn wider(own: RoadEdges, base: Option<Strip>, strip: Option<Strip>) -> RoadEdges {
    let (Some(base), Some(strip)) = (base, strip) else { return own };
    let left = f64::from(strip.left_m - base.left_m).max(0.0);
    let right = f64::from(strip.right_m - base.right_m).min(0.0);
    [own[0] + left, own[1] + right]
}

/// The outer edges of two strips.
fn outer(a: RoadEdges, b: RoadEdges) -> RoadEdges {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Stations of a stroke around a node, in the frame of the turn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arm {
    /// Stations with the corridor's own half-widths.
    pub(super) line: Corridor,
    /// Edges of the strip that the turn may use, for its area and, without steps, for half-widths.
    pub(super) strip: Vec<RoadEdges>,
    gradual: Vec<RoadEdges>,
    pub(super) direction: Vec<RoadEdges>,
    pub(super) carriageway: Vec<RoadEdges>,
    /// Index of the node's station in `line`.
    pub(super) node: usize,
    /// The stroke's station that comes first in `line`.
    pub(super) first: usize,
    /// Stations of the stroke's own edges; the stations before them are approach.
    pub(super) own: std::ops::Range<usize>,
    /// Whether the stroke's corridor begins and ends where `line` does.
    pub(super) complete: [bool; 2],
}

/// Whether the approach before the stroke's own edges counts as road, too.
#[derive(Clone, Copy, PartialEq)]
enum Approach {
    Counts,
    LeftOut,
}

impl Arm {
    /// The end of edge `edge` on `line`, with up to `before_m` and `after_m` of road.
    pub(super) fn arriving(
        line: &StrokeLine,
        edge: EdgeNo,
        frame: Frame,
        strip: Policy,
        reach_m: [f64; 2],
    ) -> Result<Self, UnknownReason> {
        let span = line.made.spans.iter().find(|s| s.edge == edge).ok_or(UnknownReason::Geometry)?;
        match span.unknown {
            Some(reason) => Err(reason),
            None => Self::window(line, span.stations.end - 1, frame, strip, reach_m, Approach::Counts),
        }
    }

    /// The start of edge `edge` on `line`.
    pub(super) fn leaving(
        line: &StrokeLine,
        edge: EdgeNo,
        frame: Frame,
        strip: Policy,
        reach_m: [f64; 2],
    ) -> Result<Self, UnknownReason> {
        let span = line.made.spans.iter().find(|s| s.edge == edge).ok_or(UnknownReason::Geometry)?;
        match span.unknown {
            Some(reason) => Err(reason),
            None => Self::window(line, span.stations.start, frame, strip, reach_m, Approach::LeftOut),
        }
    }

    /// All stations of `line`.
    pub(super) fn whole(line: &StrokeLine, frame: Frame, strip: Policy) -> Result<Self, UnknownReason> {
        let length_m = line.stations() as f64 * line.made.corridor.spacing_m;
        Self::window(line, 0, frame, strip, [0.0, length_m], Approach::Counts)
    }

    /// A window of `line`.
    fn window(
        line: &StrokeLine,
        node: usize,
        frame: Frame,
        strip: Policy,
        [before_m, after_m]: [f64; 2],
        approach: Approach,
    ) -> Result<Self, UnknownReason> {
        let c = &line.made.corridor;
        let stations = |m: f64| (m / c.spacing_m).ceil() as usize;
        let begins = if line.closed { 0 } else { line.made.spans.first().map_or(0, |s| s.stations.start) };
        let first = node.saturating_sub(stations(before_m)).max(if approach == Approach::Counts { 0 } else { begins });
        let end = (node + stations(after_m) + 1).min(c.len());
        if end < first + 2 {
            return Err(UnknownReason::Geometry);
        }
        let mut window = c.sliced(first..end);
        if line.made.frame != frame {
            carry_over(&mut window, line.made.frame, frame).ok_or(UnknownReason::Geometry)?;
        }
        let own = begins.max(first) - first..end - first;
        Ok(Self {
            line: window,
            strip: (first..end).map(|k| line.strip(strip, k)).collect(),
            gradual: (first..end).map(|k| line.gradual(strip, k)).collect(),
            direction: line.direction[first..end].to_vec(),
            carriageway: line.carriageway[first..end].to_vec(),
            node: node - first,
            first,
            own,
            complete: [first == 0, end == c.len()],
        })
    }

    /// Half-widths of the turn's strip.
    pub(super) fn wide(&self, k: usize) -> [f64; 2] {
        widened(&self.line, k, self.gradual[k], Opening::WHOLE)
    }

    /// Half-widths at a station, so far before a joint.
    pub(super) fn before_joint(&self, k: usize, joint: usize, length_class: LengthClass) -> [f64; 2] {
        widened(
            &self.line,
            k,
            self.gradual[k],
            length_class.opening_before(joint.saturating_sub(k) as f64 * self.line.spacing_m),
        )
    }

    /// Half-widths at a station, so far behind a joint.
    pub(super) fn after_joint(&self, k: usize, joint: usize, length_class: LengthClass) -> [f64; 2] {
        widened(
            &self.line,
            k,
            self.gradual[k],
            length_class.opening_after(k.saturating_sub(joint) as f64 * self.line.spacing_m),
        )
    }

    /// Edges of the turn's strip at a station, wherever paths leave and join: the whole strip near the node, and the
    /// corridor's own far from it.
    pub(super) fn near_node(&self, k: usize, length_class: LengthClass) -> RoadEdges {
        let away_m = k.abs_diff(self.node) as f64 * self.line.spacing_m - WHOLE_STRIP_M;
        let opening =
            if k < self.node { length_class.opening_before(away_m) } else { length_class.opening_after(away_m) };
        let [left, right] = widened(&self.line, k, self.strip[k], opening.of_an_area());
        [left, -right]
    }

    pub(super) fn len(&self) -> usize {
        self.line.len()
    }

    pub(super) fn point(&self, k: usize) -> [f64; 2] {
        [self.line.x[k], self.line.y[k]]
    }

    /// Unit vector in direction of travel.
    pub(super) fn forward(&self, k: usize) -> [f64; 2] {
        let (sin, cos) = self.line.heading[k].sin_cos();
        [cos, sin]
    }

    /// The pose `left_m` to the left of a place between stations.
    pub(super) fn pose(&self, station: f64, left_m: f64) -> PathPose {
        let k = (station.max(0.0) as usize).min(self.len() - 1);
        let next = (k + 1).min(self.len() - 1);
        let t = if next > k { (station - k as f64).clamp(0.0, 1.0) } else { 0.0 };
        let at = if t > 0.0 {
            let places = [self.point(k), self.point(next)];
            let chord = (places[1][0] - places[0][0]).hypot(places[1][1] - places[0][1]);
            hermite(places, [self.forward(k), self.forward(next)], chord, t)
        } else {
            self.point(k)
        };
        let heading = self.line.heading[k] + t * (self.line.heading[next] - self.line.heading[k]);
        let (sin, cos) = heading.sin_cos();
        PathPose { at: [at[0] - left_m * sin, at[1] + left_m * cos], heading }
    }

    /// The place `left_m` to the left of a station.
    pub(super) fn aside(&self, k: usize, left_m: f64) -> [f64; 2] {
        let [x, y] = self.point(k);
        let [cos, sin] = self.forward(k);
        [x - left_m * sin, y + left_m * cos]
    }
}

/// Converts from one frame to another. The frames differ if strokes of a junction lie around different degrees. The
/// convergence of the meridians turns headings by the same angle all over a junction (to 1e-6).
fn carry_over(c: &mut Corridor, from: Frame, to: Frame) -> Option<()> {
    let points: Vec<[f64; 2]> = c.x.iter().zip(&c.y).map(|(x, y)| [*x, *y]).collect();
    let degrees = from.inverse(&points).ok()?;
    let moved = to.forward_degrees(degrees.into_iter().map(|[lon, lat]| (lon, lat)).collect()).ok()?;
    let last = points.len() - 1;
    let course = |p: &[[f64; 2]]| (p[last][1] - p[0][1]).atan2(p[last][0] - p[0][0]);
    let turned = course(&moved) - course(&points);
    c.heading.iter_mut().for_each(|h| *h += turned);
    for (k, [x, y]) in moved.into_iter().enumerate() {
        (c.x[k], c.y[k]) = (x, y);
    }
    Some(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::corridor::tests::{network, strip};
    use crate::osm::facts::CrossSection;

    fn line(sections: &[CrossSection], policy: Policy) -> StrokeLine {
        let points = |part: usize| (0..=4).map(|i| [200.0 * part as f64 + 50.0 * f64::from(i), 0.0]).collect();
        let edges: Vec<_> = sections.iter().enumerate().map(|(part, section)| (points(part), *section)).collect();
        let (mut network, stroke) = network(&edges, false);
        network.strokes.push(stroke);
        StrokeLine::new(&network, 0, policy, &Params::default()).unwrap()
    }

    /// The edges at a station, metres to the left of the map's line, which leads east.
    fn across(line: &StrokeLine, edges: &[RoadEdges], k: usize) -> RoadEdges {
        edges[k].map(|left_m| line.made.corridor.y[k] + left_m)
    }

    fn near(a: RoadEdges, b: RoadEdges) -> bool {
        (a[0] - b[0]).abs() < 0.02 && (a[1] - b[1]).abs() < 0.02
    }

    #[test]
    fn the_carriageway_of_a_road_of_four_lanes_is_as_wide_as_its_lanes() {
        let section =
            CrossSection { lane: strip((-3.5, -7.0)), direction: strip((0.0, -7.0)), carriageway: strip((7.0, -7.0)) };
        for policy in [Policy::Lane, Policy::Direction, Policy::Carriageway] {
            let line = line(&[section], policy);
            let direction = if policy == Policy::Carriageway { [7.0, -7.0] } else { [0.0, -7.0] };
            for k in 20..180 {
                assert!(near(across(&line, &line.direction, k), direction), "{policy:?} {k}");
                assert!(near(across(&line, &line.carriageway, k), [7.0, -7.0]), "{policy:?} {k}");
            }
        }
    }

    #[test]
    fn where_a_lane_is_added_the_road_is_as_wide_as_mapped_though_the_vehicle_moves_aside() {
        let two = CrossSection { lane: strip((0.0, -3.5)), direction: strip((3.5, -3.5)), carriageway: None };
        let three = CrossSection { lane: strip((-1.75, -5.25)), direction: strip((5.25, -5.25)), carriageway: None };
        for sections in [[two, three], [three, two]] {
            let line = line(&sections, Policy::Lane);
            let c = &line.made.corridor;
            assert!((c.y[c.len() - 1] - c.y[0]).abs() > 1.7, "the vehicle moves aside");
            for k in 0..c.len() {
                let beyond_m = c.x[k] - 200.0;
                // Stations beside the node may be either part's.
                let beside = beyond_m.abs() < 2.5;
                let wide = beside || (beyond_m > 0.0) == (sections[1] == three);
                let mapped = if wide { [5.25, -5.25] } else { [3.5, -3.5] };
                let own = [c.left_m[k], -c.right_m[k]].map(|left_m| c.y[k] + left_m);
                let (found, most) = (across(&line, &line.direction, k), outer(own, mapped));
                assert!(beside || near(found, most), "{k}: {found:?} {most:?}");
                assert!(found[0] <= most[0] + 0.02 && found[1] >= most[1] - 0.02, "{k}: {found:?} {most:?}");
            }
        }
    }
}
