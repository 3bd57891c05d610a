//! The edges of lanes and of a direction's lanes along a route, on both sides of the route's corridor.

use std::ops::Range;

use super::super::assemble::{RoutePart, RoutePath};
use super::super::pieces::Strokes;
use super::windows::AreaWindow;
use crate::corridor::FrameError;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::{CrossSection, Policy, Strip};
use crate::turns::StrokeLine;

/// What is known of the strips at one station of a route, as distances of their edges from the route's corridor line to the left and to the
/// right, metres. Negative: on the other side of the line.
#[derive(Debug, Clone, Copy)]
pub(super) struct StationStrips {
    /// The own lane.
    pub(super) lane: [f64; 2],
    /// All lanes of the direction.
    pub(super) direction: [f64; 2],
    /// The route's corridor.
    pub(super) corridor: [f64; 2],
    /// The strip that a turn near by may use; nowhere narrower than the corridor.
    pub(super) turn: [f64; 2],
    /// Whether the turn's area may reach beyond this strip, because a paved surface beside the map counts.
    pub(super) has_surface: bool,
}

/// The strips along a part of a route that lies on an edge.
pub(super) struct PartStrips {
    pub(super) stations: Range<usize>,
    /// `None` where the strips are not known.
    known: Vec<Option<StationStrips>>,
    /// The widths of the route's corridor, which bound what is not known.
    widths_m: Vec<f64>,
}

impl PartStrips {
    pub(super) fn new(
        strokes: &mut Strokes,
        path: &RoutePath,
        part: &RoutePart,
        edge: EdgeNo,
        windows: &[AreaWindow],
    ) -> Self {
        let corridor = &path.corridor;
        let widths_m = part.stations.clone().map(|k| corridor.left_m[k] + corridor.right_m[k]).collect();
        let known = Self::known(strokes, path, part, edge, windows).unwrap_or_else(|| vec![None; part.stations.len()]);
        Self { stations: part.stations.clone(), known, widths_m }
    }

    fn known(
        strokes: &mut Strokes,
        path: &RoutePath,
        part: &RoutePart,
        edge: EdgeNo,
        windows: &[AreaWindow],
    ) -> Option<Vec<Option<StationStrips>>> {
        let line = strokes.line_of(edge).ok()?;
        let network = strokes.network();
        let section = network.section(network.edges.get(edge.index())?);
        let places = on_line(path, part.stations.clone(), &line).ok()?;
        let policy = strokes.settings().policy;
        let own = strokes.rungs().section(edge, section).strip(policy)?;
        let surface = |window: &AreaWindow| window.turn.is_some_and(|ends| has_surface(network, [ends.from, ends.to]));
        let of_window = |window: &AreaWindow| match window.turn {
            // What was measured or traced at a junction may reach beyond all lanes.
            Some(_) if surface(window) => Policy::Carriageway,
            Some(ends) => strokes.turn_strip(ends),
            None => policy,
        };
        let corridor = &path.corridor;
        let at = |(k, place): (usize, LinePlace)| {
            let near = || windows.iter().filter(|window| window.stations.contains(&k));
            let turn_strip = near().map(of_window).max().unwrap_or(policy);
            let half_widths = [corridor.left_m[k], corridor.right_m[k]];
            let strips = strips_at(&line, place, half_widths, own, &section, turn_strip)?;
            Some(StationStrips { has_surface: near().any(surface), ..strips })
        };
        Some(part.stations.clone().zip(places).map(at).collect())
    }

    /// The strips at a station of the route.
    pub(super) fn at(&self, k: usize) -> Option<StationStrips> {
        *self.known.get(k.checked_sub(self.stations.start)?)?
    }

    /// The strips at a station and those beside it on this part. `None` if any is not known.
    pub(super) fn around(&self, k: usize) -> Option<Vec<(usize, StationStrips)>> {
        let near = k.saturating_sub(1).max(self.stations.start)..(k + 2).min(self.stations.end);
        near.map(|k| Some((k, self.at(k)?))).collect()
    }

    /// The width of the route's corridor at a station, metres.
    pub(super) fn width_m(&self, k: usize) -> Option<f64> {
        self.widths_m.get(k.checked_sub(self.stations.start)?).copied()
    }
}

/// Whether a paved surface beside the map counts at the junction of a turn.
fn has_surface(network: &Network, [from, to]: [EdgeNo; 2]) -> bool {
    let edge = |edge: EdgeNo| network.edges.get(edge.index());
    let nodes = [edge(from).map(|edge| edge.to_node), edge(to).map(|edge| edge.from_node)];
    nodes.into_iter().flatten().any(|node| !network.site.surfaces(node).is_empty())
}

/// A place beside a line.
#[derive(Debug, Clone, Copy)]
struct LinePlace {
    /// The nearest station.
    station: usize,
    /// How far ahead of that station the place is, stations; negative: behind it.
    ahead: f64,
    /// How far to the left of the line it is, metres.
    aside_m: f64,
}

/// The strips at a place of the route beside a line, where the route's corridor has these half-widths.
fn strips_at(
    line: &StrokeLine,
    place: LinePlace,
    half_widths: [f64; 2],
    own: Strip,
    section: &CrossSection,
    turn_strip: Policy,
) -> Option<StationStrips> {
    let lane = section.lane?;
    // A lane may lie outside of what counts as its direction. What the vehicle may use there is no other lane.
    let direction = section.direction.unwrap_or(lane);
    let direction = outer(direction, lane);
    let turn = outer(section.strip(turn_strip).unwrap_or(own), own);
    // Edges at the place, between the stations before and behind it.
    let edges = |part: Strip| {
        let other = if place.ahead < 0.0 { place.station.saturating_sub(1) } else { place.station + 1 };
        let here = line.edges_of(place.station, own, part)?;
        let there = line.edges_of(other.min(line.stations() - 1), own, part)?;
        let share = place.ahead.abs().min(1.0);
        let [left, right] = [0, 1].map(|side| here[side] + share * (there[side] - here[side]) - place.aside_m);
        Some([left, -right])
    };
    let turn = edges(turn)?;
    Some(StationStrips {
        lane: edges(lane)?,
        direction: edges(direction)?,
        corridor: half_widths,
        turn: [0, 1].map(|side| turn[side].max(half_widths[side])),
        has_surface: false,
    })
}

/// The outer edges of two strips.
fn outer(a: Strip, b: Strip) -> Strip {
    Strip { left_m: a.left_m.max(b.left_m), right_m: a.right_m.min(b.right_m), ..a }
}

/// For each station of the route, its place beside a line.
fn on_line(path: &RoutePath, stations: Range<usize>, line: &StrokeLine) -> Result<Vec<LinePlace>, FrameError> {
    let (corridor, own) = (&path.corridor, &line.made.corridor);
    let metres: Vec<[f64; 2]> = stations.map(|k| [corridor.x[k], corridor.y[k]]).collect();
    let degrees = path.frame.inverse(&metres)?.into_iter().map(|[lon, lat]| (lon, lat)).collect();
    let metres = line.made.frame.forward_degrees(degrees)?;
    let away = |at: [f64; 2], k: usize| (own.x[k] - at[0]).hypot(own.y[k] - at[1]);
    let mut out = Vec::with_capacity(metres.len());
    let mut known: Option<usize> = None;
    for at in metres {
        let candidates = match known {
            Some(station) => station.saturating_sub(4)..(station + 5).min(own.len()),
            None => 0..own.len(),
        };
        let station = candidates.min_by(|&a, &b| away(at, a).total_cmp(&away(at, b))).unwrap_or(0);
        known = Some(station);
        let (sin, cos) = own.heading[station].sin_cos();
        let [x, y] = [at[0] - own.x[station], at[1] - own.y[station]];
        out.push(LinePlace { station, ahead: (x * cos + y * sin) / own.spacing_m, aside_m: y * cos - x * sin });
    }
    Ok(out)
}
