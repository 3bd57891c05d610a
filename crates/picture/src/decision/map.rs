//! The map of a decision sheet: the way among the roads around it, with the places that it depends on as numbered pins.

use std::collections::BTreeSet;

use super::super::furniture::{LegendEntry, legend, scale_bar_in};
use super::super::lengths::Units;
use super::super::sheet::pin_down;
use super::super::style::{Anchor, Style, TextStyle};
use super::super::svg::Picture;
use super::super::{BoundingBox, PageFrame, Point, View, palette};
use crate::network::{Network, offset_m};
use crate::osm::LonLat;
use crate::osm::facts::{Policy, RoadClass};
use netcert_route::{Answer, Position, Route, place};

/// How far the map goes beyond the way, as a share of its size, and metres at least.
const AROUND: f64 = 0.06;
const AROUND_M: f64 = 150.0;
/// Up to these sides of the map, metres, these classes of roads are drawn. On a larger one all roads would hide the way.
const CLASSES: [(f64, RoadClass); 3] =
    [(3_000.0, RoadClass::Busway), (12_000.0, RoadClass::Tertiary), (f64::INFINITY, RoadClass::Secondary)];
/// A degree of latitude, metres.
const DEGREE_M: f64 = 111_200.0;
/// A name of a road needs so much of its line, page units.
const NAME_ROOM: f64 = 60.0;
const FRAME: PageFrame = PageFrame { x: 20.0, y: 20.0, width: 960.0, height: 560.0 };

/// A stretch of the way with one style.
struct Stretch {
    line: Vec<Point>,
    style: Style,
}

/// Positions as metres from the first place of the question.
struct Plane {
    centre: LonLat,
}

impl Plane {
    fn degrees(&self, [lon, lat]: [f64; 2]) -> Point {
        offset_m(self.centre, Position { lon, lat }.into())
    }

    /// The position of a point, within some metres.
    fn inverse(&self, [east_m, north_m]: Point) -> LonLat {
        let e7 = |metres: f64| (metres / DEGREE_M * 1e7) as i32;
        let (_, lat) = self.centre.degrees();
        LonLat {
            lon_e7: self.centre.lon_e7.saturating_add(e7(east_m / lat.to_radians().cos().max(0.01))),
            lat_e7: self.centre.lat_e7.saturating_add(e7(north_m)),
        }
    }
}

/// Draws the way of an answer. Of an answer without a way, the one that is blocked.
pub(super) fn map(network: &Network, answer: &Answer, units: Units) -> String {
    let conditional = answer.conditional.as_ref();
    let snapped = super::snapped(answer);
    let Some(first) = snapped.first() else { return String::new() };
    let plane = Plane { centre: first.position.into() };
    let route = answer.routes.first().or(conditional.map(|one| &one.route));
    let certified = !answer.routes.is_empty();
    let stretches = match (route, &answer.blocked) {
        (Some(route), _) => of_route(route, &plane, certified),
        (None, Some(way)) => {
            let line = way.line(network).into_iter().map(|at| plane.degrees(at)).collect();
            vec![Stretch { line, style: Style::line(palette::GREY, 3.0).dashed(4.0, 5.0) }]
        }
        (None, None) => Vec::new(),
    };
    let pins: Vec<Option<[f64; 2]>> = match (route, conditional) {
        (_, Some(conditional)) => conditional.conditions.iter().map(|one| one.place(network)).collect(),
        (None, None) => answer.obstacles.iter().flatten().map(|one| place(network, one.at)).collect(),
        _ => Vec::new(),
    };
    let pins: Vec<(usize, Point)> = (1..).zip(pins).filter_map(|(no, at)| Some((no, plane.degrees(at?)))).collect();
    let ends: Vec<Point> = snapped.iter().map(|one| offset_m(plane.centre, one.position.into())).collect();
    let mut bounds = BoundingBox::of(stretches.iter().flat_map(|one| &one.line).chain(&ends));
    let [width, height] = bounds.size();
    bounds = filling(&bounds.grown(AROUND_M.max(AROUND * width.max(height))));
    let view = View::fit(&bounds, FRAME);
    let mut picture =
        Picture::new(1000.0, 640.0, "The way on the map", "Roads around it in grey; numbers are those of the table");
    picture.clipped(FRAME, "map", |picture| {
        roads(picture, network, &plane, &view, &bounds);
        stretches.iter().for_each(|one| picture.polyline(&view.all(&one.line), one.style));
        names(picture, network, route, &plane, &view);
        for (no, at) in (0..).zip(&ends) {
            let colour = if no == 0 { palette::GREEN } else { palette::INK };
            picture.circle(view.at(*at), 6.0, Style::area(colour).outlined(palette::PAPER, 1.5));
        }
        pin_down(picture, &view, &pins);
    });
    scale_bar_in(&mut picture, &view, [30.0, 615.0], 160.0, units);
    if route.is_some() {
        let key = |strip: Policy, text: &str| LegendEntry::new(style(strip, certified), text);
        let keys = [
            key(Policy::Lane, "in its own lane, and inside crossings"),
            key(Policy::Direction, "in other lanes of its direction"),
            key(Policy::Carriageway, "beyond all lanes of its direction"),
        ];
        legend(&mut picture, [640.0, 582.0], &keys);
    }
    picture.finish()
}

/// The box with the frame's form around a box, so that roads fill the frame.
fn filling(bounds: &BoundingBox) -> BoundingBox {
    let [width, height] = bounds.size();
    let more = [
        (height * FRAME.width / FRAME.height - width).max(0.0),
        (width * FRAME.height / FRAME.width - height).max(0.0),
    ];
    let mut all = *bounds;
    for side in [-0.5, 0.5] {
        let corner = if side < 0.0 { bounds.low } else { bounds.high };
        all.add([corner[0] + side * more[0], corner[1] + side * more[1]]);
    }
    all
}

/// Dashed is what is not certified.
fn style(strip: Policy, certified: bool) -> Style {
    let colour = match strip {
        Policy::Lane => palette::GREEN,
        Policy::Direction => palette::BLUE,
        Policy::Carriageway => palette::VERMILLION,
    };
    let line = Style::line(colour, 4.0);
    if certified { line } else { line.dashed(9.0, 5.0) }
}

/// The stretches of a route by the strip that they use.
fn of_route(route: &Route, plane: &Plane, certified: bool) -> Vec<Stretch> {
    let corridor = &route.path.corridor;
    let spacing_m = corridor.spacing_m;
    let strip = |k: usize| {
        let at_m = k as f64 * spacing_m;
        let uses = route.uses.iter().filter(|used| used.from_m <= at_m && at_m <= used.to_m);
        uses.map(|used| used.strip).max().unwrap_or(Policy::Lane)
    };
    let strips: Vec<Policy> = (0..corridor.len()).map(strip).collect();
    let plan: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
    let Ok(places) = route.path.frame.inverse(&plan) else { return Vec::new() };
    let line: Vec<Point> = places.into_iter().map(|at| plane.degrees(at)).collect();
    let mut stretches = Vec::new();
    let mut begin = 0;
    for same in strips.chunk_by(|a, b| a == b) {
        // To the first station of the next stretch, so that no gap is left.
        let end = (begin + same.len() + 1).min(line.len());
        let points = line.get(begin..end).unwrap_or_default().to_vec();
        stretches
            .push(Stretch { line: points, style: style(same.first().copied().unwrap_or(Policy::Lane), certified) });
        begin += same.len();
    }
    stretches
}

/// The roads in the map's box. The larger the map, the fewer classes.
fn roads(picture: &mut Picture, network: &Network, plane: &Plane, view: &View, bounds: &BoundingBox) {
    let [width, height] = bounds.size();
    let least =
        CLASSES.iter().find(|(side_m, _)| width.max(height) <= *side_m).map_or(RoadClass::Motorway, |one| one.1);
    // In degrees first: a region may have millions of edges.
    let [west_south, east_north] = [bounds.low, bounds.high].map(|corner| plane.inverse(corner));
    let near = |at: LonLat| {
        (west_south.lon_e7..=east_north.lon_e7).contains(&at.lon_e7)
            && (west_south.lat_e7..=east_north.lat_e7).contains(&at.lat_e7)
    };
    let mut drawn = BTreeSet::new();
    for edge in network.edges.iter().filter(|edge| network.road(edge).class <= least) {
        // Both directions have one shape.
        if network.positions(edge).any(near) && drawn.insert(edge.shape.start) {
            let line: Vec<Point> = network.positions(edge).map(|at| offset_m(plane.centre, at)).collect();
            let width = if network.road(edge).class <= RoadClass::Secondary { 2.0 } else { 1.0 };
            picture.polyline(&view.all(&line), Style::line(palette::PALE, width));
        }
    }
}

/// The names of the route's roads, where their line is long enough and no other name stands.
fn names(picture: &mut Picture, network: &Network, route: Option<&Route>, plane: &Plane, view: &View) {
    let Some(route) = route else { return };
    let corridor = &route.path.corridor;
    let style = TextStyle::size(12.0).anchored(Anchor::Middle);
    let mut taken: Vec<Point> = Vec::new();
    for (part, title) in route.titled_parts(network) {
        let station = (0.5 * (part.from_m + part.to_m) / corridor.spacing_m) as usize;
        let (Some(&x), Some(&y)) = (corridor.x.get(station), corridor.y.get(station)) else { continue };
        let Ok(places) = route.path.frame.inverse(&[[x, y]]) else { continue };
        let Some(&at) = places.first() else { continue };
        let [x, y] = view.at(plane.degrees(at));
        let room = view.length(part.to_m - part.from_m);
        let free = taken.iter().all(|other| (other[0] - x).abs() > 110.0 || (other[1] - y).abs() > 15.0);
        if !part.kind.is_turn() && room >= NAME_ROOM && free {
            picture.text([x, y - 8.0], &title, style);
            taken.push([x, y]);
        }
    }
}
