//! A stroke near a junction: its corridor, and the extent of the road to both sides.
//!
//! A turn's approach and departure are windows of the corridors by which their edges are certified, so a route passes
//! from one into the other without a seam. Road edges are measured from the strip's edges without tapers: a road that
//! goes on narrower beyond the junction is as wide as mapped up to it. A narrow place narrows the junction with it.

use super::Reach;
use super::path::{Pose, hermite};
use crate::corridor::{Corridor, Frame, Params, Sections, StrokeCorridor, TaperCause, stroke_corridor_on};
use crate::network::Network;
use crate::osm::facts::{CrossSection, Policy, Strip};
use crate::verdict::UnknownReason;

/// Largest |κ|·half-width of a strip beyond the corridor's own.
const MOST_CROSSING: f64 = 0.9;
/// Distance from the node within which a turn may use its whole strip, metres. Paths leave and join the centrelines
/// within it; beyond it the strip narrows to the corridor's own, as before and after a path.
const WHOLE_STRIP_M: f64 = 60.0;

/// Largest change of a strip's half-width per metre beside a path. A certificate deducts the change along a body.
const STEEPEST: f64 = 0.1;

/// Edges of the road across a corridor's centreline, metres, positive left: `[left, right]`.
pub(super) type Across = [f64; 2];

/// A stroke's corridor with its frame and the edges of the road.
#[derive(Debug, Clone)]
pub struct StrokeLine {
    /// Index into `Network::strokes`.
    pub stroke: u32,
    /// The corridor by which the stroke's edges are certified.
    pub made: StrokeCorridor,
    pub(super) closed: bool,
    /// One entry per station: all lanes of the direction, then everything between the kerbs.
    direction: Vec<Across>,
    carriageway: Vec<Across>,
    /// The same without steps: where the road becomes wider, it does so gradually.
    gradual: [Vec<Across>; 2],
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
        let made = stroke_corridor_on(network, facts, sections, policy, params)?;
        let c = &made.corridor;
        let own: Vec<Across> = c.left_m.iter().zip(&c.right_m).map(|(l, r)| [*l, -*r]).collect();
        let (mut direction, mut carriageway) = (own.clone(), own.clone());
        for span in &made.spans {
            let Some(edge) = network.edges.get(span.edge as usize) else { continue };
            let section = sections(edge);
            for k in span.stations.clone() {
                // A taper to the next edge narrows the corridor, not the road.
                direction[k] = wider(made.untapered[k], &section, policy, section.direction);
                carriageway[k] = wider(direction[k], &section, policy, section.carriageway.or(section.direction));
            }
        }
        keep_to_tapers(&made, &mut [&mut direction, &mut carriageway]);
        let gradual = [&direction, &carriageway].map(|edges| gradual(&made.corridor, edges));
        Ok(Self { stroke, made, closed: facts.closed, direction, carriageway, gradual })
    }

    /// Half-widths at a station of the stroke, left and right: the corridor's own, and of what `strip` has beyond them the
    /// given share.
    pub(crate) fn half_widths(&self, strip: Policy, station: usize, share: f64) -> [f64; 2] {
        widened(&self.made.corridor, station, self.gradual(strip, station), share)
    }

    /// Edges of a strip at a station for half-widths: as [`Self::strip`], without steps.
    fn gradual(&self, strip: Policy, station: usize) -> Across {
        let c = &self.made.corridor;
        match strip {
            Policy::Lane => [c.left_m[station], -c.right_m[station]],
            Policy::Direction => self.gradual[0][station],
            Policy::Carriageway => self.gradual[1][station],
        }
    }

    /// Edges of a strip at a station; never inside the corridor's own.
    fn strip(&self, strip: Policy, station: usize) -> Across {
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

/// Half-widths of a corridor at a station, left and right, with the given share of what a strip has beyond them. The strip counts
/// only where normals do not cross.
fn widened(c: &Corridor, k: usize, strip: Across, share: f64) -> [f64; 2] {
    let own = [c.left_m[k], c.right_m[k]];
    let wide = [strip[0], -strip[1]];
    [0, 1].map(|side| {
        let towards = if side == 0 { c.curvature[k] } else { -c.curvature[k] };
        let clear = if towards > 0.0 { MOST_CROSSING / towards } else { f64::INFINITY };
        own[side].max((own[side] + share * (wide[side] - own[side])).min(clear))
    })
}

/// The edges of a strip without steps: nowhere farther out than they are, and nowhere inside the corridor.
fn gradual(c: &Corridor, edges: &[Across]) -> Vec<Across> {
    let mut out = edges.to_vec();
    let step_m = STEEPEST * c.spacing_m;
    let limit = |out: &mut [Across], k: usize, beside: usize| {
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

/// The edges of `strip`, where the policy's own strip has its edges at `own`; never inside `own`. The distances between
/// the strips' edges are kept, so a narrowed corridor narrows both strips alike.
fn wider(own: Across, section: &CrossSection, policy: Policy, strip: Option<Strip>) -> Across {
    let (Some(base), Some(strip)) = (section.strip(policy), strip) else { return own };
    let left = f64::from(strip.left_m - base.left_m).max(0.0);
    let right = f64::from(strip.right_m - base.right_m).min(0.0);
    [own[0] + left, own[1] + right]
}

/// Reduces the road along tapers. A taper moves the strip beside its section's place by up to the taper's move. What is
/// measured from the strip is uncertain by that move, so that much less road counts.
fn keep_to_tapers(made: &StrokeCorridor, wider: &mut [&mut Vec<Across>; 2]) {
    let c = &made.corridor;
    for taper in made.tapers.iter().filter(|taper| taper.cause == TaperCause::Section && taper.shift_m != 0.0) {
        let less_m = taper.shift_m.abs();
        for k in taper.stations.clone() {
            for edges in wider.iter_mut() {
                let [left, right] = edges[k];
                edges[k] = [(left - less_m).max(c.left_m[k]), (right + less_m).min(-c.right_m[k])];
            }
        }
    }
}

/// Stations of a stroke around a node, in the frame of the turn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arm {
    /// Stations with the corridor's own half-widths.
    pub(super) line: Corridor,
    /// Edges of the strip that the turn may use, for its area and, without steps, for half-widths.
    pub(super) strip: Vec<Across>,
    gradual: Vec<Across>,
    pub(super) direction: Vec<Across>,
    pub(super) carriageway: Vec<Across>,
    /// Index of the node's station in `line`.
    pub(super) node: usize,
    /// The stroke's station that comes first in `line`.
    pub(super) first: usize,
    /// Stations of the stroke's own edges; the stations before them are approach.
    pub(super) own: std::ops::Range<usize>,
    /// Whether the stroke's corridor begins and ends where `line` does.
    pub(super) complete: [bool; 2],
}

impl Arm {
    /// The end of edge `edge` on `line`, with up to `before_m` and `after_m` of road.
    pub(super) fn arriving(
        line: &StrokeLine,
        edge: u32,
        frame: Frame,
        strip: Policy,
        reach_m: [f64; 2],
    ) -> Result<Self, UnknownReason> {
        let span = line.made.spans.iter().find(|s| s.edge == edge).ok_or(UnknownReason::Geometry)?;
        match span.unknown {
            Some(reason) => Err(reason),
            None => Self::window(line, span.stations.end - 1, (frame, strip), reach_m, true),
        }
    }

    /// The start of edge `edge` on `line`.
    pub(super) fn leaving(
        line: &StrokeLine,
        edge: u32,
        frame: Frame,
        strip: Policy,
        reach_m: [f64; 2],
    ) -> Result<Self, UnknownReason> {
        let span = line.made.spans.iter().find(|s| s.edge == edge).ok_or(UnknownReason::Geometry)?;
        match span.unknown {
            Some(reason) => Err(reason),
            None => Self::window(line, span.stations.start, (frame, strip), reach_m, false),
        }
    }

    /// All stations of `line`.
    pub(super) fn whole(line: &StrokeLine, frame: Frame, strip: Policy) -> Result<Self, UnknownReason> {
        let length_m = line.stations() as f64 * line.made.corridor.spacing_m;
        Self::window(line, 0, (frame, strip), [0.0, length_m], true)
    }

    /// A window of `line`. With `lead`, the approach before the stroke's own edges counts as road too.
    fn window(
        line: &StrokeLine,
        node: usize,
        (frame, strip): (Frame, Policy),
        [before_m, after_m]: [f64; 2],
        lead: bool,
    ) -> Result<Self, UnknownReason> {
        let c = &line.made.corridor;
        let stations = |m: f64| (m / c.spacing_m).ceil() as usize;
        let begins = if line.closed { 0 } else { line.made.spans.first().map_or(0, |s| s.stations.start) };
        let first = node.saturating_sub(stations(before_m)).max(if lead { 0 } else { begins });
        let end = (node + stations(after_m) + 1).min(c.len());
        if end < first + 2 {
            return Err(UnknownReason::Geometry);
        }
        let cut = |v: &[f64]| v[first..end].to_vec();
        let mut window = Corridor {
            spacing_m: c.spacing_m,
            x: cut(&c.x),
            y: cut(&c.y),
            heading: cut(&c.heading),
            curvature: cut(&c.curvature),
            left_m: cut(&c.left_m),
            right_m: cut(&c.right_m),
            areas: Vec::new(),
        };
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
        widened(&self.line, k, self.gradual[k], 1.0)
    }

    /// Half-widths at a station on the approach to a joint, or on the departure from it.
    pub(super) fn near_joint(&self, k: usize, joint: usize, reach: Reach) -> [f64; 2] {
        let away_m = k.abs_diff(joint) as f64 * self.line.spacing_m;
        let share = if k < joint { reach.share_before(away_m) } else { reach.share_after(away_m) };
        widened(&self.line, k, self.gradual[k], share)
    }

    /// Edges of the turn's strip at a station, wherever paths leave and join: the whole strip near the node, and the
    /// corridor's own far from it.
    pub(super) fn near_node(&self, k: usize, reach: Reach) -> Across {
        let away_m = k.abs_diff(self.node) as f64 * self.line.spacing_m - WHOLE_STRIP_M;
        let share = if k < self.node { reach.share_before(away_m) } else { reach.share_after(away_m) };
        let [left, right] = widened(&self.line, k, self.strip[k], share);
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
    pub(super) fn pose(&self, station: f64, left_m: f64) -> Pose {
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
        Pose { at: [at[0] - left_m * sin, at[1] + left_m * cos], heading }
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
