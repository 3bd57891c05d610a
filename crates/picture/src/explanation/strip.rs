//! The whole edge: its leeway left and right as curves, and its shape on the map, coloured by the lesser leeway.

use super::super::furniture::{arrow, scale_bar};
use super::super::palette;
use super::super::style::{Anchor, Style, TextStyle};
use super::super::svg::Picture;
use super::super::{BoundingBox, Chart, PageFrame, Point, Scale, View};
use super::verdict_colour;
use crate::explain::{Explanation, Geometry};
use crate::stet::known_m;

/// Most points of a curve. Each bucket of stations shows its least value.
const MOST_POINTS: usize = 600;
/// Leeway above this is cut off, metres.
const ENOUGH_M: f64 = 1.2;
/// Leeway at which the overview's colours end, metres.
const FULL_M: f64 = 0.6;

pub(super) fn draw(picture: &mut Picture, e: &Explanation, g: &Geometry, frame: PageFrame) {
    let (left, right) = (series(g, &g.certificate.left_m), series(g, &g.certificate.right_m));
    let least = left.iter().chain(&right).map(|p| p[1]).fold(g.result.rsc_m.unwrap_or(0.0), f64::min).max(-3.0);
    let most = left.iter().chain(&right).map(|p| p[1]).fold(0.3, f64::max).min(ENOUGH_M);
    let chart = Chart {
        frame,
        x: Scale::new(0.0, g.length_m().max(1.0), &format!("metres along the {}, in driving direction", whole(e)))
            .ticks(10),
        y: Scale::new(least.min(0.0) - 0.1, most + 0.1, "leeway, m").ticks(5),
    };
    chart.axes(picture);
    let missing = |curve: &[Point]| -> Vec<Point> { curve.iter().map(|p| [p[0], p[1].min(0.0)]).collect() };
    for curve in [&left, &right] {
        chart.area(picture, "missing", &missing(curve), 0.0, palette::VERMILLION);
    }
    chart.level(picture, 0.0, Style::line(palette::INK, 1.2));
    chart.curve(picture, "left", &left, Style::line(palette::BLUE, 1.8));
    chart.curve(picture, "right", &right, Style::line(palette::GREEN, 1.8).dashed(7.0, 3.0));
    let (s, colour) = (g.along_m(g.place.station), verdict_colour(e));
    if let Some(rsc_m) = g.result.rsc_m.filter(|_| !e.hinge_decides()) {
        let at = chart.at(s, rsc_m.clamp(chart.y.low, chart.y.high));
        picture.segment([at[0], frame.y], [at[0], frame.y + frame.height], Style::line(colour, 1.0).dashed(3.0, 3.0));
        picture.circle(at, 5.0, Style::area(colour).outlined(palette::PAPER, 1.2));
        if g.result.shrink < 1.0 {
            let beyond = at[0] > frame.x + 0.85 * frame.width;
            let (x, anchor) = if beyond { (at[0] - 9.0, Anchor::End) } else { (at[0] + 9.0, Anchor::Start) };
            let text = format!("with γ = {:.3}", g.result.shrink);
            picture.text(
                [x, at[1] + 4.0],
                &text,
                TextStyle::size(12.5).bold().coloured(colour).anchored(anchor).haloed(),
            );
        }
    }
    let small = TextStyle::size(12.5).haloed();
    let top = frame.y - 6.0;
    picture.segment([frame.x, top - 4.0], [frame.x + 26.0, top - 4.0], Style::line(palette::BLUE, 1.8));
    picture.text([frame.x + 32.0, top], "to the left edge", small);
    let dashed = Style::line(palette::GREEN, 1.8).dashed(7.0, 3.0);
    picture.segment([frame.x + 140.0, top - 4.0], [frame.x + 166.0, top - 4.0], dashed);
    picture.text([frame.x + 172.0, top], "to the right edge", small);
    let tolerance =
        format!("after correction, with the whole tracking tolerance of ±{} m", e.vehicle.tracking_tolerance_m);
    let grey = small.coloured(palette::GREY).anchored(Anchor::End);
    picture.text([frame.x + frame.width, top], &tolerance, grey);
}

fn whole(e: &Explanation) -> &'static str {
    if e.road.is_some() { "edge" } else { "corridor" }
}

/// Metres along the span and leeway. Stations without a known leeway are left out.
fn series(g: &Geometry, leeway: &[f64]) -> Vec<Point> {
    let own = leeway.get(g.span.clone()).unwrap_or_default();
    let bucket = own.len().div_ceil(MOST_POINTS).max(1);
    own.chunks(bucket)
        .enumerate()
        .filter_map(|(i, chunk)| {
            let known = chunk.iter().enumerate().filter_map(|(k, &leeway)| Some((k, known_m(leeway)?)));
            let (k, least) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
            Some([(i * bucket + k) as f64 * g.corridor.spacing_m, least.max(-10.0)])
        })
        .collect()
}

pub(super) fn overview(picture: &mut Picture, e: &Explanation, g: &Geometry, frame: PageFrame) {
    let point = |k: usize| [g.corridor.x[k], g.corridor.y[k]];
    let own: Vec<Point> = g.span.clone().map(point).collect();
    let view = View::fit(&BoundingBox::of(&own).grown(0.02 * g.length_m() + 5.0), frame.inset(26.0));
    picture.clipped(frame, "overview", |p| {
        p.rect(frame, 0.0, Style::area(palette::PAPER));
        let all: Vec<Point> = (0..g.corridor.len()).step_by(1 + g.corridor.len() / 4000).map(point).collect();
        p.polyline(&view.all(&all), Style::line(palette::PALE, 2.0));
        p.polyline(&view.all(&own), Style::line(palette::INK, 7.0));
        let step = own.len().div_ceil(250).max(1);
        let leeway = |k: usize| {
            let least =
                |column: &[f64]| column[k..(k + step).min(column.len())].iter().fold(f64::INFINITY, |l, &v| l.min(v));
            least(&g.certificate.left_m).min(least(&g.certificate.right_m))
        };
        for k in (g.span.start..g.span.end.saturating_sub(1)).step_by(step) {
            let to = (k + step).min(g.span.end - 1);
            let colour = palette::diverging(leeway(k) / FULL_M);
            let part: Vec<Point> = (k..=to).map(point).collect();
            p.polyline(&view.all(&part), Style::line(colour, 4.6));
        }
        if let [first, second, ..] = view.all(&own)[..] {
            p.circle(first, 5.0, Style::area(palette::INK));
            let u = [second[0] - first[0], second[1] - first[1]];
            let length = u[0].hypot(u[1]).max(1e-6);
            let [ux, uy] = u.map(|c| c / length);
            let off = [first[0] - 12.0 * uy, first[1] + 12.0 * ux];
            arrow(p, off, [off[0] + 34.0 * ux, off[1] + 34.0 * uy], palette::INK, 1.4);
        }
        let station = if e.hinge_decides() { g.hinge.station } else { g.place.station };
        let at = view.at(point((station.max(0.0) as usize).min(g.corridor.len() - 1)));
        p.circle(at, 9.0, Style::line(verdict_colour(e), 2.6));
        scale_bar(p, &view, [frame.x + 14.0, frame.y + frame.height - 10.0], 120.0);
        let text = format!("the whole {}, north up: red {FULL_M} m missing, blue {FULL_M} m to spare", whole(e));
        p.text([frame.x + 12.0, frame.y + 16.0], &text, TextStyle::size(12.0).coloured(palette::GREY).haloed());
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
}
