//! Where a certified route uses more of the road than its own lane, and how far at most.
//!
//! On a road the certificate bounds every body: its half-width less the leeway there. Near a turn the area of the junction counts instead
//! of half-widths, and a vehicle may be anywhere in it. On the roads before and after the turn that area has the strip of the turn, which is
//! the bound there. Between the roads, inside the crossing, there are no lanes. All numbers are upper bounds, disturbances included, with the
//! widths that the map or assumptions give.

use std::ops::Range;

use netcert_base::leeway::NOTHING_M;
use netcert_base::named;

use super::assemble::{PartKind, RoutePart, RoutePath};
use super::pieces::Strokes;
use super::turn_ends::TurnEnds;
use crate::corridor::FrameError;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::{CrossSection, Oneway, Policy, Strip};
use crate::stet::{Certificate, Side, known_m};
use crate::turns::StrokeLine;
use crate::vehicle::Vehicle;

/// What stands beyond a strip by less than this counts as inside, metres.
const LEAST_M: f64 = 0.01;
/// Uses of one road that are closer than this are one use, metres.
const GAP_M: f64 = 10.0;
/// The feet of a vehicle's bodies lie at most so many lengths of the vehicle behind its front.
const BEHIND: f64 = 2.0;

/// The kind of place at which a strip is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsePlace {
    /// On a road. The distance beyond the narrower strip comes from the certificate.
    Road,
    /// Beside a turn. The distance is that of the edge of the turn's strip.
    Turn,
}

named!(UsePlace { Road = "road", Turn = "turn" });

/// A stretch on which a vehicle may use more of the road than its own lane.
#[derive(Debug, Clone, PartialEq)]
pub struct StripUse {
    /// What it uses: [`Policy::Direction`] is another lane of its direction, [`Policy::Carriageway`] is beyond all lanes of its direction.
    pub strip: Policy,
    /// The kind of place.
    pub place: UsePlace,
    /// The edge or turn.
    pub at: PartKind,
    /// Beginning, metres from the route's beginning.
    pub from_m: f64,
    /// End, metres from the route's beginning.
    pub to_m: f64,
    /// The greatest distance of any point of a body beyond the edge of the narrower strip (the own lane, or all lanes of the direction),
    /// metres. An upper bound.
    pub beyond_m: f64,
    /// The side of that edge.
    pub side: Side,
}

/// How far the edges of the route's corridor, and of the strip that a turn near by may use, lie beyond those of narrower strips at a station,
/// `[left, right]`, metres. Negative: inside them.
#[derive(Debug, Clone, Copy)]
struct StationStrips {
    corridor_beyond: StripEdges,
    turn_beyond: StripEdges,
}

/// One number for each narrower strip.
#[derive(Debug, Clone, Copy)]
struct StripEdges {
    lane: [f64; 2],
    direction: [f64; 2],
}

impl StripEdges {
    /// The greater of each.
    fn most(self, other: Self) -> Self {
        let most = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        Self { lane: most(self.lane, other.lane), direction: most(self.direction, other.direction) }
    }
}

/// How far bodies stand beyond a strip at one station.
#[derive(Debug, Clone, Copy)]
struct Beyond {
    strip: Policy,
    by_m: f64,
    side: Side,
}

impl StripUse {
    /// All uses of a certified path, in driving order. `strokes` must be those that the path was made from.
    pub(super) fn all(
        strokes: &mut Strokes,
        path: &RoutePath,
        certificate: &Certificate,
        vehicle: &Vehicle,
    ) -> Vec<Self> {
        let windows = turn_windows(path, vehicle);
        let mut all: Vec<Self> = Vec::new();
        let mut beside: Vec<Option<Self>> = vec![None; windows.len()];
        for part in &path.parts {
            let PartKind::Edge(edge) = part.kind else { continue };
            let strips = PartStrips::new(strokes, path, part, edge, &windows);
            for k in part.stations.clone() {
                let window = windows.iter().position(|window| window.stations.contains(&k));
                let leeways = if window.is_some() { None } else { Some(leeways(certificate, k)) };
                let Some(beyond) = strips.beyond(k, leeways) else { continue };
                let found = Self::at_station(path, part.kind, k, beyond, window);
                match window {
                    Some(window) => {
                        let found = Self { at: windows[window].at, ..found };
                        match &mut beside[window] {
                            Some(known) => known.join(&found),
                            none => *none = Some(found),
                        }
                    }
                    None => match all.last_mut() {
                        Some(last) if last.goes_on_with(&found) => last.join(&found),
                        _ => all.push(found),
                    },
                }
            }
        }
        all.extend(beside.into_iter().flatten());
        all.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
        all
    }

    fn at_station(path: &RoutePath, at: PartKind, k: usize, beyond: Beyond, window: Option<usize>) -> Self {
        let spacing_m = path.corridor.spacing_m;
        let last_m = (path.corridor.len() - 1) as f64 * spacing_m;
        Self {
            strip: beyond.strip,
            place: if window.is_some() { UsePlace::Turn } else { UsePlace::Road },
            at,
            from_m: ((k as f64 - 1.0) * spacing_m).max(0.0),
            to_m: ((k as f64 + 1.0) * spacing_m).min(last_m),
            beyond_m: beyond.by_m,
            side: beyond.side,
        }
    }

    /// What the vehicle uses, in words.
    #[must_use]
    pub fn words(&self, network: &Network) -> &'static str {
        let edges = match self.at {
            PartKind::Edge(edge) => [edge, edge],
            PartKind::Turn { from, to } => [from, to],
        };
        let two_way =
            |edge: EdgeNo| network.edges.get(edge.index()).is_some_and(|edge| network.road(edge).oneway == Oneway::No);
        match self.strip {
            Policy::Lane => "its own lane",
            Policy::Direction => "another lane of its direction",
            Policy::Carriageway if edges.into_iter().any(two_way) => "the oncoming lane",
            Policy::Carriageway => "the road beyond its lanes",
        }
    }

    fn goes_on_with(&self, next: &Self) -> bool {
        (self.place, self.strip, self.side) == (next.place, next.strip, next.side) && next.from_m - self.to_m < GAP_M
    }

    /// Adds a use of the same place. The wider strip counts, with the greatest distance beyond its edge.
    fn join(&mut self, next: &Self) {
        if (next.strip, next.beyond_m) > (self.strip, self.beyond_m) {
            (self.strip, self.beyond_m, self.side) = (next.strip, next.beyond_m, next.side);
        }
        (self.from_m, self.to_m) = (self.from_m.min(next.from_m), self.to_m.max(next.to_m));
    }
}

/// Where an area counts instead of half-widths.
struct AreaWindow {
    /// The stations at which a body may be meanwhile.
    stations: Range<usize>,
    /// The turn that the area belongs to.
    at: PartKind,
}

/// The stations near the turns of a path. An area that belongs to no turn is the straight road beyond the path's ends, which is as wide as
/// the path is there.
fn turn_windows(path: &RoutePath, vehicle: &Vehicle) -> Vec<AreaWindow> {
    let corridor = &path.corridor;
    let stations = |metres: f64| (metres / corridor.spacing_m).ceil() as usize;
    let behind = stations(BEHIND * vehicle.length_m);
    let ahead = stations(2.0 * vehicle.units.first().map_or(0.0, |unit| unit.front_overhang_m));
    let turns = path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. }));
    let window = |part: &RoutePart| {
        let of_turn = |heads: &Range<usize>| heads.start <= part.stations.start && heads.end >= part.stations.end;
        let heads = corridor.areas.iter().map(|span| span.heads.clone()).find(of_turn);
        let heads = heads.unwrap_or_else(|| part.stations.clone());
        AreaWindow {
            stations: heads.start.saturating_sub(behind)..(heads.end + ahead).min(corridor.len()),
            at: part.kind,
        }
    };
    turns.map(window).collect()
}

/// The least leeway of bodies at a station, `[left, right]`, metres; not below the route's RSC. `None` on a side that no body passes.
fn leeways(certificate: &Certificate, k: usize) -> [Option<f64>; 2] {
    let rsc_m = certificate.result.rsc_m.unwrap_or(0.0);
    // Where the bounds do not close at γ = 1, they do at the route's γ, with the route's RSC.
    let closes = |m: &f64| if *m <= 0.5 * NOTHING_M { rsc_m } else { *m };
    [&certificate.left_m, &certificate.right_m]
        .map(|column| column.get(k).map(closes).and_then(known_m).map(|m| m.max(rsc_m)))
}

/// The strips along a part of a route that lies on an edge.
struct PartStrips {
    first: usize,
    /// `None` where the strips are not known.
    stations: Vec<Option<StationStrips>>,
    /// The half-widths of the route, which bound what is not known.
    widths_m: Vec<f64>,
}

impl PartStrips {
    fn new(strokes: &mut Strokes, path: &RoutePath, part: &RoutePart, edge: EdgeNo, windows: &[AreaWindow]) -> Self {
        let corridor = &path.corridor;
        let widths_m = part.stations.clone().map(|k| corridor.left_m[k] + corridor.right_m[k]).collect();
        let stations =
            Self::known(strokes, path, part, edge, windows).unwrap_or_else(|| vec![None; part.stations.len()]);
        Self { first: part.stations.start, stations, widths_m }
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
        let own = strokes.rungs().section(edge, section).strip(strokes.settings().policy)?;
        let of_window = |window: &AreaWindow| match window.at {
            // What was measured or traced at a junction may reach beyond all lanes.
            PartKind::Turn { from, to } if has_surface(network, [from, to]) => Policy::Carriageway,
            PartKind::Turn { from, to } => strokes.turn_strip(TurnEnds { from, to }),
            PartKind::Edge(_) => strokes.settings().policy,
        };
        let turn_strip = |k: usize| {
            let near = windows.iter().filter(|window| window.stations.contains(&k));
            near.map(of_window).max().unwrap_or(strokes.settings().policy)
        };
        let corridor = &path.corridor;
        let at = |(k, place): (usize, LinePlace)| {
            let half_widths = [corridor.left_m[k], corridor.right_m[k]];
            strips_at(&line, place, half_widths, own, &section, turn_strip(k))
        };
        Some(part.stations.clone().zip(places).map(at).collect())
    }

    /// How far bodies stand beyond a strip at a station of the route. `leeways`: their least leeway on each side; `None` where the turn's area
    /// counts. A body between two stations has its leeway against an edge between theirs, so the stations beside count, too.
    fn beyond(&self, k: usize, leeways: Option<[Option<f64>; 2]>) -> Option<Beyond> {
        let at = k - self.first;
        let near = self.stations.get(at.saturating_sub(1)..(at + 2).min(self.stations.len()))?;
        let Some(known) = near.iter().copied().collect::<Option<Vec<StationStrips>>>() else {
            // Nothing is known of the lanes. The vehicle may be anywhere in the strip.
            return Some(Beyond { strip: Policy::Carriageway, by_m: *self.widths_m.get(at)?, side: Side::Left });
        };
        let edges = |of: fn(&StationStrips) -> StripEdges| known.iter().map(of).reduce(StripEdges::most);
        let (edges, leeways) = match leeways {
            Some(leeways) => (edges(|strips| strips.corridor_beyond)?, leeways),
            None => (edges(|strips| strips.turn_beyond)?, [Some(0.0); 2]),
        };
        let over = |edges: [f64; 2], strip: Policy| {
            let side = |of: usize, side: Side| Some(Beyond { strip, by_m: edges[of] - leeways[of]?, side });
            let sides = [side(0, Side::Left), side(1, Side::Right)].into_iter().flatten();
            sides.max_by(|a, b| a.by_m.total_cmp(&b.by_m)).filter(|beyond| beyond.by_m > LEAST_M)
        };
        over(edges.direction, Policy::Carriageway).or_else(|| over(edges.lane, Policy::Direction))
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
        Some([0, 1].map(|side| here[side] + share * (there[side] - here[side]) - place.aside_m))
    };
    let (lane, direction, turn) = (edges(lane)?, edges(direction)?, edges(turn)?);
    let beyond = |outer: [f64; 2]| {
        let over = |inner: [f64; 2]| [outer[0] - inner[0], inner[1] - outer[1]];
        StripEdges { lane: over(lane), direction: over(direction) }
    };
    let corridor = [half_widths[0], -half_widths[1]];
    Some(StationStrips { corridor_beyond: beyond(corridor), turn_beyond: beyond(turn).most(beyond(corridor)) })
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
