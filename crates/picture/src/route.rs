//! A route as a strip: leeway left and right along the route with its turns marked, below it where the route uses more than its own lane
//! (`route_uses`), and the route's shape on the map in the colours of the leeway.

use super::furniture::{arrow, scale_bar};
use super::palette;
use super::route_uses::{oncoming_words, uses};
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::{BoundingBox, Chart, PageFrame, Point, Scale, View};
use crate::network::Network;
use crate::stet::known_m;
use netcert_base::vehicle::Vehicle;
use netcert_route::{PartKind, Route, title};

/// Most points of a curve. Each bucket of stations shows its least value.
const MOST_POINTS: usize = 900;
/// Leeway above this is cut off, metres.
const ENOUGH_M: f64 = 1.2;
/// Leeway at which the map's colours end, metres.
const FULL_M: f64 = 0.6;
/// Room for the bars of a route that uses more than its own lane, page units.
const USES_HEIGHT: f64 = 210.0;
/// A turn's name is left out if it is closer than this to the previous name, page units.
const NAME_GAP: f64 = 17.0;

/// Draws a route that is certified under so many conditions; 0 if it is certified as it is.
#[must_use]
pub fn route(network: &Network, vehicle: &Vehicle, route: &Route, conditions: usize) -> String {
    let result = &route.certificate.result;
    let km = route.length_m / 1000.0;
    let head = match conditions {
        0 => format!("{}: a certified route of {km:.1} km", vehicle.id),
        1 => format!("{}: a route of {km:.1} km, certified only if one condition holds", vehicle.id),
        many => format!("{}: a route of {km:.1} km, certified only if {many} conditions hold", vehicle.id),
    };
    let unit = vehicle.units.get(result.limiting.unit).map_or("", |unit| &unit.name);
    let at = route.limiting().map_or_else(String::new, |at| title(network, at));
    let said = format!(
        "RSC {}: what the worst body point has to spare, all error bounds deducted, {:.1} km along, at {at} ({unit}, {} side)",
        result.rsc_m.map_or("unknown".to_owned(), |rsc_m| format!("{rsc_m:.2} m")),
        route.limiting_m() / 1000.0,
        if result.limiting.side == crate::stet::Side::Left { "left" } else { "right" },
    );
    let more = if route.uses.is_empty() { 0.0 } else { USES_HEIGHT };
    let mut picture = Picture::new(1200.0, 860.0 + more, &head, &said);
    picture.text([40.0, 44.0], &head, TextStyle::size(22.0).bold());
    picture.text([40.0, 70.0], &said, TextStyle::size(14.0));
    let frame = PageFrame { x: 80.0, y: 190.0, width: 1080.0, height: 220.0 };
    strip(&mut picture, network, route, frame);
    if let Some(words) = tolerance_words(vehicle, result.shrink) {
        let at = [frame.x + frame.width, frame.y + frame.height + 38.0];
        picture.text(at, &words, TextStyle::size(12.5).haloed().anchored(Anchor::End));
    }
    if !route.uses.is_empty() {
        let heading = oncoming_words(route).map_or_else(String::new, |words| format!(": {words}"));
        let y = 500.0;
        picture.text([40.0, y], &format!("Beyond its own lane{heading}"), TextStyle::size(14.0).bold());
        uses(&mut picture, network, route, PageFrame { x: 80.0, y: y + 18.0, width: 1080.0, height: 110.0 });
    }
    map(&mut picture, route, PageFrame { x: 40.0, y: 480.0 + more, width: 1120.0, height: 350.0 });
    picture.finish()
}

/// With what tolerance the curves are drawn, if the certificate asks for a smaller one. Then leeways may lie below 0.
fn tolerance_words(vehicle: &Vehicle, shrink: f64) -> Option<String> {
    let full_m = vehicle.tracking_tolerance_m;
    let certified_m = shrink * full_m;
    (shrink < 1.0).then(|| format!("drawn for a tracking tolerance of {full_m:.3} m; certified for {certified_m:.3} m"))
}

fn strip(picture: &mut Picture, network: &Network, route: &Route, frame: PageFrame) {
    let certificate = &route.certificate;
    let spacing_m = route.path.corridor.spacing_m;
    let (left, right) = (series(&certificate.left_m, spacing_m), series(&certificate.right_m, spacing_m));
    let rsc_m = certificate.result.rsc_m.unwrap_or(0.0);
    let least = left.iter().chain(&right).map(|p| p[1]).fold(rsc_m, f64::min).max(-3.0);
    let most = left.iter().chain(&right).map(|p| p[1]).fold(0.3, f64::max);
    let most = most.min(ENOUGH_M.max(rsc_m + 1.0));
    let chart = Chart {
        frame,
        x: Scale::new(0.0, route.length_m / 1000.0, "km along the route").ticks(10),
        y: Scale::new(least.min(0.0) - 0.1, most + 0.1, "leeway, m").ticks(5),
    };
    for part in route.parts().iter().filter(|part| matches!(part.kind, PartKind::Turn { .. })) {
        let [from, _] = chart.at(part.from_m / 1000.0, 0.0);
        let [to, _] = chart.at(part.to_m / 1000.0, 0.0);
        let band = PageFrame { x: from, y: frame.y, width: (to - from).max(2.0), height: frame.height };
        picture.rect(band, 0.0, Style::area(palette::PALE));
    }
    chart.axes(picture);
    chart.level(picture, 0.0, Style::line(palette::INK, 1.2));
    chart.curve(picture, "left", &left, Style::line(palette::BLUE, 1.6));
    chart.curve(picture, "right", &right, Style::line(palette::GREEN, 1.6).dashed(7.0, 3.0));
    let at = chart.at(route.limiting_m() / 1000.0, rsc_m.clamp(chart.y.low, chart.y.high));
    picture.circle(at, 5.0, Style::area(palette::VERMILLION).outlined(palette::PAPER, 1.2));
    names(picture, network, route, &chart);
    let small = TextStyle::size(12.5).haloed();
    let y = frame.y + frame.height + 38.0;
    picture.segment([frame.x, y - 4.0], [frame.x + 26.0, y - 4.0], Style::line(palette::BLUE, 1.6));
    picture.text([frame.x + 32.0, y], "to the left edge", small);
    let dashed = Style::line(palette::GREEN, 1.6).dashed(7.0, 3.0);
    picture.segment([frame.x + 140.0, y - 4.0], [frame.x + 166.0, y - 4.0], dashed);
    picture.text([frame.x + 172.0, y], "to the right edge; turns are shaded", small);
}

/// Writes the name of the road after each turn, slanted above the strip, if there is room.
fn names(picture: &mut Picture, network: &Network, route: &Route, chart: &Chart) {
    let mut last = f64::NEG_INFINITY;
    for part in route.parts() {
        let PartKind::Turn { to, .. } = part.kind else { continue };
        let [x, _] = chart.at(0.5 * (part.from_m + part.to_m) / 1000.0, 0.0);
        if x - last < NAME_GAP {
            continue;
        }
        last = x;
        let name: String = title(network, PartKind::Edge(to)).chars().take(22).collect();
        // Near the right margin a name leans the other way.
        let (anchor, turned_deg) =
            if x > chart.frame.x + 0.9 * chart.frame.width { (Anchor::End, -48.0) } else { (Anchor::Start, 48.0) };
        let style = TextStyle::size(12.0).coloured(palette::GREY).anchored(anchor).turned(turned_deg);
        picture.text([x, chart.frame.y - 8.0], &name, style);
    }
}

/// Kilometres along the route, and the least leeway nearby. Stations without a known leeway are left out.
fn series(leeway: &[f64], spacing_m: f64) -> Vec<Point> {
    let bucket = leeway.len().div_ceil(MOST_POINTS).max(1);
    leeway
        .chunks(bucket)
        .enumerate()
        .filter_map(|(i, chunk)| {
            let known = chunk.iter().enumerate().filter_map(|(k, &leeway)| Some((k, known_m(leeway)?)));
            let (k, least) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
            Some([(i * bucket + k) as f64 * spacing_m / 1000.0, least.clamp(-10.0, 10.0)])
        })
        .collect()
}

fn map(picture: &mut Picture, route: &Route, frame: PageFrame) {
    let c = &route.path.corridor;
    let points: Vec<Point> = c.x.iter().zip(&c.y).map(|(&x, &y)| [x, y]).collect();
    let view = View::fit(&BoundingBox::of(&points).grown(0.02 * route.length_m + 5.0), frame.inset(26.0));
    let step = points.len().div_ceil(400).max(1);
    let least = |column: &[f64], k: usize| {
        column[k..(k + step).min(column.len())].iter().copied().fold(f64::INFINITY, f64::min)
    };
    picture.clipped(frame, "map", |p| {
        p.rect(frame, 0.0, Style::area(palette::PAPER));
        p.polyline(&view.all(&points), Style::line(palette::INK, 7.0));
        for k in (0..points.len().saturating_sub(1)).step_by(step) {
            let leeway = least(&route.certificate.left_m, k).min(least(&route.certificate.right_m, k));
            let part = &points[k..=(k + step).min(points.len() - 1)];
            p.polyline(&view.all(part), Style::line(palette::diverging(leeway / FULL_M), 4.6));
        }
        if let [first, .., last] = points[..] {
            let [first, last] = [view.at(first), view.at(last)];
            p.circle(first, 6.0, Style::area(palette::INK));
            let from = TextStyle::size(13.0).bold().haloed().anchored(Anchor::End);
            p.text([first[0] - 10.0, first[1] - 7.0], "from", from);
            p.circle(last, 6.0, Style::area(palette::PAPER).outlined(palette::INK, 2.0));
            p.text([last[0] + 9.0, last[1] - 7.0], "to", TextStyle::size(13.0).bold().haloed());
            let next = view.at(points[(points.len() / 12).max(1).min(points.len() - 1)]);
            let u = [next[0] - first[0], next[1] - first[1]];
            let length = u[0].hypot(u[1]).max(1e-6);
            let off = [first[0] - 12.0 * u[1] / length, first[1] + 12.0 * u[0] / length];
            arrow(p, off, [off[0] + 34.0 * u[0] / length, off[1] + 34.0 * u[1] / length], palette::INK, 1.4);
        }
        let station = route.certificate.result.limiting.station.min(points.len() - 1);
        p.circle(view.at(points[station]), 9.0, Style::line(palette::VERMILLION, 2.6));
        scale_bar(p, &view, [frame.x + 14.0, frame.y + frame.height - 10.0], 140.0);
        let text =
            format!("north up: red {FULL_M} m missing, blue {FULL_M} m to spare; the ring is where it is tightest");
        p.text([frame.x + 12.0, frame.y + 16.0], &text, TextStyle::size(12.0).coloured(palette::GREY).haloed());
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
}
