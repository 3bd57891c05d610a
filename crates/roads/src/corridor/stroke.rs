//! A stroke of the network becomes a corridor, and its edges become spans of stations.
//!
//! Only the part between a stroke's first and last edge is certified. Approach, lead-in and tail are driven. An edge
//! that the extract cuts is entered straight, like any first edge. Turns off the stroke have corridors of their own.

use super::course::{ChainLine, ChainLink, DrivenLink, Role};
use super::merge::Jog;
use super::profile::{CHANGE_M, MIDDLE, NarrowPlace, limit_offset, profile};
use super::resample::{ArcLength, EdgedCurve, LEAST_OFFSET_FACTOR};
use super::smooth::Smoothed;
use super::spline::Cubics;
use super::stretch::{Across, LineStretch};
use super::stroke_layout::{Sections, StrokeLayout};
use super::taper::Ramp;
use super::{Corridor, EdgeSpan, Params, StrokeCorridor, Taper, TaperCause};
use crate::network::{Network, Stroke};
use crate::osm::facts::{Direction, Policy};
use crate::verdict::UnknownReason;

/// Shortest stroke with a usable direction, metres.
const LEAST_LENGTH_M: f64 = 2.0;
/// Shorter edges get no station of their own, metres.
const LEAST_EDGE_M: f64 = 0.01;
/// |c′| is about 1. Below this value the line folds back on itself.
const LEAST_SPEED: f64 = 0.3;
/// Least change of width that is listed as a taper, metres.
const LEAST_TAPER_M: f64 = 0.05;
/// Where two sections meet, the narrower one counts for this distance to both sides, metres. Stations are closer.
const BESIDE_M: f64 = 1.5;
/// |κ|·half-width from which normals nearly cross inside the corridor.
const MOST_CROSSING: f64 = 0.98;

/// The corridor of a stroke, in a metric frame of its own.
///
/// # Errors
/// As [`StrokeLayout::new`] and [`StrokeLayout::corridor`].
pub fn stroke_corridor(
    network: &Network,
    stroke: &Stroke,
    policy: Policy,
    params: &Params,
) -> Result<StrokeCorridor, UnknownReason> {
    StrokeLayout::new(network, stroke, params)?.corridor(&|edge| network.section(edge), policy)
}

impl StrokeLayout<'_> {
    /// The corridor with the cross sections that `sections` gives.
    ///
    /// # Errors
    /// It fails only if every edge of the stroke is unknown: the stroke is shorter than two metres or folded (`Geometry`), or has no
    /// width at all (`Width`). A single bad edge among good ones is `unknown` in its span.
    pub fn corridor(&self, sections: &Sections<'_>, policy: Policy) -> Result<StrokeCorridor, UnknownReason> {
        self.make(sections, policy).map(|(made, _)| made)
    }

    /// As [`Self::corridor`], with the edges of the strip at each station as the map has them, metres to the left of the centreline:
    /// `[left, right]`. The corridor is narrower where the strip tapers to that of the next edge, and reaches beyond these edges where it
    /// moves aside.
    ///
    /// # Errors
    /// As [`Self::corridor`].
    pub fn corridor_and_strip(
        &self,
        sections: &Sections<'_>,
        policy: Policy,
    ) -> Result<(StrokeCorridor, Vec<[f64; 2]>), UnknownReason> {
        let (made, untapered) = self.make(sections, policy)?;
        let strip = untapered.edges(&made.corridor);
        Ok((made, strip))
    }

    fn make(&self, sections: &Sections<'_>, policy: Policy) -> Result<(StrokeCorridor, Untapered), UnknownReason> {
        let params = self.params;
        let links = self.links(sections, policy);
        let (mut course, splits) = (self.course(&links), &self.network.splits);
        if course.line.length() < LEAST_LENGTH_M {
            return Err(UnknownReason::Geometry);
        }
        let (jogs, aside) = course.straighten(&links, splits);
        let smoothed = self.smoothed(&course.line);
        let smoothed = smoothed.as_ref();
        let stretches = stretches(&links, &course.driven).ok_or(UnknownReason::Width)?;
        let gaps = gaps(self.network, &links, &course, smoothed);
        let (mut profile, ramps) = profile(&stretches, &aside, &gaps);
        let folded = limit_offset(&mut profile, &smoothed.curve, 1.0 - LEAST_OFFSET_FACTOR, LEAST_SPEED);
        let profile = profile.cubics();

        let track = EdgedCurve { curve: &smoothed.curve, profile: &profile };
        let (corridor, arc) = track.resample(0.0, course.end, params.spacing_m);
        if !(arc.total() >= 0.5 * LEAST_LENGTH_M && all_finite(&corridor)) {
            return Err(UnknownReason::Geometry);
        }
        let cut = Cut { corridor: &corridor, arc: &arc, smoothed, folded: &folded, torn: &corridor.torn(), params };
        let spans =
            course.driven.iter().filter(|p| p.role == Role::Counted).map(|p| cut.span(p, &links[p.link])).collect();
        let stations = |from: f64, to: f64| {
            let station = |u: f64| ((arc.at(u) / corridor.spacing_m).round() as usize).min(corridor.len() - 1);
            station(from)..station(to) + 1
        };
        let tapers = tapers(&stretches, &jogs, &ramps, &stations);
        let untapered = Untapered { stretches, aside, gaps, profile, arc };
        Ok((StrokeCorridor { frame: self.frame, corridor, spans, tapers }, untapered))
    }
}

/// The tapers, in the order of the line.
fn tapers(
    stretches: &[LineStretch],
    jogs: &[Jog],
    ramps: &[Ramp],
    stations: &dyn Fn(f64, f64) -> std::ops::Range<usize>,
) -> Vec<Taper> {
    let mut tapers: Vec<(f64, Taper)> = Vec::new();
    for (k, pair) in stretches.windows(2).enumerate() {
        let [a, b] = pair else { continue };
        let node = b.from;
        let widths_m = [a.strip.width_m(), b.strip.width_m()];
        let at_node = |u: f64, reach_m: f64| (u - node).abs() <= reach_m;
        let jog = jogs.iter().find(|jog| at_node(jog.at, 1e-6));
        // A ramp lies beside its node or around it. It belongs to the nearest node at which something changes.
        let ramp = ramps.iter().find(|ramp| ramp.node == k);
        let (from, to, shift_m, cause) = match (jog, ramp) {
            (Some(jog), _) if jog.ahead => (node, node + jog.reach_m, jog.shift_m, TaperCause::Parts),
            (Some(jog), _) => (node - jog.reach_m, node, -jog.shift_m, TaperCause::Joins),
            (None, Some(ramp)) => (ramp.from, ramp.to, ramp.by_m, TaperCause::Section),
            (None, None) if widths_m[0] < widths_m[1] - LEAST_TAPER_M => {
                (node, (node + CHANGE_M).min(b.to), 0.0, TaperCause::Section)
            }
            (None, None) if widths_m[1] < widths_m[0] - LEAST_TAPER_M => {
                ((node - CHANGE_M).max(a.from), node, 0.0, TaperCause::Section)
            }
            (None, None) => continue,
        };
        tapers.push((from, Taper { stations: stations(from, to), length_m: to - from, widths_m, shift_m, cause }));
    }
    tapers.sort_by(|a, b| a.0.total_cmp(&b.0));
    tapers.into_iter().map(|(_, taper)| taper).collect()
}

/// The strips without the tapers between them.
struct Untapered {
    stretches: Vec<LineStretch>,
    aside: Vec<Ramp>,
    gaps: Vec<NarrowPlace>,
    profile: Cubics<3>,
    arc: ArcLength,
}

impl Untapered {
    /// The edges of the strip at every station. Where two sections meet, what they have in common counts. Near a narrow place nothing
    /// outside the corridor counts.
    fn edges(&self, c: &Corridor) -> Vec<[f64; 2]> {
        let mut hint = 0;
        let mut first = 0;
        (0..c.len())
            .map(|k| {
                let own = [c.left_m[k], -c.right_m[k]];
                let u = self.arc.parameter(k as f64 * c.spacing_m, &mut hint);
                while self.stretches.get(first).is_some_and(|s| s.to < u - BESIDE_M) {
                    first += 1;
                }
                let near = self.stretches.iter().skip(first).take_while(|s| s.from <= u + BESIDE_M);
                let strip =
                    near.map(|s| [s.strip.left_m, s.strip.right_m]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
                let Some([left_m, right_m]) = strip else { return own };
                let [middle_m, _] = self.profile.component(MIDDLE, u);
                let by_m = self.aside.iter().map(|ramp| ramp.at(u)).sum::<f64>() - middle_m;
                let [left_m, right_m] = [left_m + by_m, right_m + by_m];
                let narrow = self.gaps.iter().any(|gap| (gap.at - u).abs() < CHANGE_M);
                if narrow { [left_m.min(own[0]), right_m.max(own[1])] } else { [left_m, right_m] }
            })
            .collect()
    }
}

/// The data from which a span is cut.
struct Cut<'c> {
    corridor: &'c Corridor,
    arc: &'c ArcLength,
    smoothed: &'c Smoothed,
    folded: &'c [f64],
    torn: &'c [usize],
    params: &'c Params,
}

impl Cut<'_> {
    fn span(&self, one: &DrivenLink, link: &ChainLink<'_>) -> EdgeSpan {
        let c = self.corridor;
        let last = c.len() - 1;
        let first = ((self.arc.at(one.from) / c.spacing_m).floor() as usize).min(last);
        let end = ((self.arc.at(one.to) / c.spacing_m).ceil() as usize).clamp(first, last);
        let centreline_deviation_m = self.smoothed.deviation_m(one.from, one.to);
        let sharpest = c.curvature[first..=end].iter().fold(0.0_f64, |k, c| k.max(c.abs()));
        let broken = one.to - one.from < LEAST_EDGE_M
            || centreline_deviation_m > self.params.tolerance_m
            || (first..=end).any(|i| c.curvature[i].abs() * c.left_m[i].max(c.right_m[i]) > MOST_CROSSING)
            || self.torn.iter().any(|k| (first..=end).contains(k))
            || self.folded.iter().any(|&u| u >= one.from && u <= one.to);
        EdgeSpan {
            edge: link.index,
            stations: first..end + 1,
            min_radius_m: 1.0 / sharpest,
            centreline_deviation_m,
            unknown: match (broken, link.room) {
                (true, _) => Some(UnknownReason::Geometry),
                (false, None) => Some(UnknownReason::Width),
                (false, Some(_)) => None,
            },
        }
    }
}

fn all_finite(c: &Corridor) -> bool {
    [&c.x, &c.y, &c.heading, &c.curvature, &c.left_m, &c.right_m].iter().all(|v| v.iter().all(|x| x.is_finite()))
}

/// One stretch per piece. A piece without width continues the previous one, or else the next one: the piece itself is
/// `unknown`, but its neighbours' vehicles drive over it. `None` if no piece has a width.
fn stretches(links: &[ChainLink<'_>], driven: &[DrivenLink]) -> Option<Vec<LineStretch>> {
    let mut known = driven.iter().find_map(|p| links[p.link].room)?;
    let stretches = driven.iter().map(|one| {
        known = links[one.link].room.unwrap_or(known);
        let link = &links[one.link];
        LineStretch {
            from: one.from,
            to: one.to,
            strip: known.strip.moved(one.aside_m),
            shift: known.shift.moved(one.aside_m),
            surface: known.surface.moved(one.aside_m),
            two_way: link.two_way,
            ratio: link.ratio,
        }
    });
    Some(stretches.collect())
}

/// Narrow places of all pieces. Each passage is centred on the map's vertex, and the smoothed line passes a little
/// beside it.
fn gaps(network: &Network, links: &[ChainLink<'_>], course: &ChainLine, smoothed: &Smoothed) -> Vec<NarrowPlace> {
    let mut gaps = Vec::new();
    for one in &course.driven {
        let link = &links[one.link];
        let range = link.edge.narrowings.start as usize..link.edge.narrowings.end as usize;
        for narrowing in network.narrowings.get(range).unwrap_or_default() {
            let last = link.skipped + link.points.len() - 1;
            let vertex = (narrowing.vertex as usize).min(last);
            let vertex = if link.edge.direction == Direction::Forward { vertex } else { last - vertex };
            let Some(vertex) = vertex.checked_sub(link.skipped) else { continue };
            let at = one.at[vertex];
            let [c, d, ..] = smoothed.curve.at(at);
            let off = [link.points[vertex][0] - c[0], link.points[vertex][1] - c[1]];
            let lateral = (d[0] * off[1] - d[1] * off[0]) / d[0].hypot(d[1]).max(LEAST_SPEED);
            let half = 0.5 * f64::from(narrowing.passage_m).max(0.0);
            gaps.push(NarrowPlace { at, room: Across { left_m: lateral + half, right_m: lateral - half } });
        }
    }
    gaps
}
