//! A vehicle to scale: from above with dimension lines and hinge limits, from the side as a scheme, and every number in
//! a table.
//!
//! The view from above shows data only. The side view shows real lengths, and the height of the tallest unit if known.
//! Cabs, decks and wheels are drawn as usual for such vehicles, and the picture says so.

use super::furniture::dimension;
use super::palette;
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::{PageFrame, Point, scale_bar};
use super::{View, bodies};
use crate::stet::motion::Pose;
use netcert_base::vehicle::{Unit, Vehicle};

const WIDTH: f64 = 1400.0;
const MARGIN: f64 = 60.0;
/// Largest scale, page units per metre. Small vehicles need not fill the page.
const MOST_SCALE: f64 = 64.0;
/// Shorter dimension lines (page units) have no room for their number, which is in the table.
const LEAST_LINE: f64 = 34.0;
/// Height in the side view if unknown, as a multiple of the width.
const ASSUMED_HEIGHT: f64 = 1.5;

/// The picture of a vehicle.
#[must_use]
pub fn vehicle(vehicle: &Vehicle) -> String {
    let layout = Layout::of(vehicle);
    let title = format!("{}: {}", vehicle.id, vehicle.name);
    let description =
        format!("The combination from above and from the side, to scale; {:.2} m long.", vehicle.length_m);
    let mut picture = Picture::new(WIDTH, layout.height, &title, &description);
    heading(&mut picture, vehicle);
    side(&mut picture, vehicle, &layout);
    above(&mut picture, vehicle, &layout);
    dimensions(&mut picture, vehicle, &layout);
    table(&mut picture, vehicle, layout.table);
    scale_bar(&mut picture, &layout.view, [MARGIN, layout.height - 16.0], 160.0);
    picture.finish()
}

/// Places on the page. The front is at the left, as manufacturers draw it.
struct Layout {
    /// Poses of the straight vehicle, with the front at x = 0 and the rear at x = −length.
    poses: Vec<Pose>,
    view: View,
    /// Page y of the ground in the side view.
    ground: f64,
    /// Page y of the first dimension row.
    rows: f64,
    table: f64,
    height: f64,
}

impl Layout {
    fn of(vehicle: &Vehicle) -> Self {
        let poses = straight(vehicle);
        let scale = ((WIDTH - 2.0 * MARGIN) / vehicle.length_m).min(MOST_SCALE);
        let tall = scale * height_m(vehicle);
        let ground = 120.0 + tall;
        let reach = scale * (0.5 * vehicle.width_m() + swing_m(vehicle));
        let middle = ground + 44.0 + reach;
        let rows = middle + reach + 30.0;
        let table = rows + 4.0 * 34.0 + 10.0;
        let height = table + 22.0 * (vehicle.units.len() as f64 + 1.0) + 70.0;
        // After half a turn the front at x = 0 is at the left edge.
        let ends: Vec<Point> = vec![[0.0, 0.0], [-vehicle.length_m, 0.0]];
        let frame = PageFrame { x: MARGIN, y: middle - 1.0, width: WIDTH - 2.0 * MARGIN, height: 2.0 };
        let view = View::turned(&ends, std::f64::consts::PI, frame).at_most(MOST_SCALE);
        Self { poses, view, ground, rows, table, height }
    }

    /// Page x of a place along the vehicle.
    fn x(&self, along_m: f64) -> f64 {
        self.view.at([along_m, 0.0])[0]
    }
}

/// Extent of drawn hinge limits beside the vehicle, metres.
fn swing_m(vehicle: &Vehicle) -> f64 {
    0.45 * vehicle.width_m()
}

fn height_m(vehicle: &Vehicle) -> f64 {
    vehicle.height_m.unwrap_or(ASSUMED_HEIGHT * vehicle.width_m())
}

/// Poses of all units in line, with the front bumper at x = 0.
fn straight(vehicle: &Vehicle) -> Vec<Pose> {
    let mut coupling = -vehicle.units.first().map_or(0.0, |u| u.front_overhang_m);
    vehicle
        .units
        .iter()
        .map(|unit| {
            let axle = coupling - unit.coupling_to_axle_m;
            coupling = axle - unit.hitch_offset_m;
            Pose { axle: [axle, 0.0], heading: [1.0, 0.0] }
        })
        .collect()
}

fn heading(picture: &mut Picture, v: &Vehicle) {
    picture.text([MARGIN, 44.0], &v.name, TextStyle::size(24.0).bold());
    let known =
        |value: Option<f64>, unit: &str| value.map_or("not known".to_owned(), |value| format!("{value} {unit}"));
    let text = format!(
        "{} · length {:.2} m · width {:.2} m · height {} · gross mass {} · steering lock {:.0}°",
        v.id,
        v.length_m,
        v.width_m(),
        known(v.height_m, "m"),
        known(v.gross_mass_t, "t"),
        v.units.first().map_or(0.0, |u| u.max_articulation_rad.to_degrees())
    );
    picture.text([MARGIN, 70.0], &text, TextStyle::size(15.0).coloured(palette::GREY));
}

/// Draws the side view, as a scheme.
fn side(picture: &mut Picture, v: &Vehicle, layout: &Layout) {
    let (scale, ground) = (layout.view.scale, layout.ground);
    let tall = height_m(v);
    // Wheels, deck and frame as shares of the height: 1.0 m, 1.1 m and 0.9 m of 4.3 m.
    let (wheel, deck, frame) = (0.115 * tall, 0.26 * tall, 0.21 * tall);
    let block = |from_m: f64, to_m: f64, low: f64, high: f64| {
        let (a, b) = (layout.x(from_m), layout.x(to_m));
        PageFrame { x: a, y: ground - scale * high, width: (b - a).max(0.0), height: scale * (high - low) }
    };
    picture.group("side", |p| {
        p.segment([MARGIN - 20.0, ground], [WIDTH - MARGIN + 20.0, ground], Style::line(palette::PALE, 1.5));
        for (i, (unit, pose)) in v.units.iter().zip(&layout.poses).enumerate() {
            let (front, rear, coupling) = extent(unit, pose);
            let style = Style::area(palette::category(i)).filled_at(0.35).outlined(palette::INK, 1.3);
            p.rect(block(front, rear, deck - 0.5 * frame, deck), 0.0, style);
            if coupling > front {
                p.rect(block(coupling, front, deck - 0.5 * frame, deck - 0.25 * frame), 0.0, style);
            }
            let next = v.units.get(i + 1).zip(layout.poses.get(i + 1)).map(|(u, pose)| extent(u, pose).0);
            if i == 0 && v.carries(0) {
                let cab = next.map_or(front - 2.0, |next| (next + 0.3).max(front - 2.4)).min(front - 0.8);
                p.rect(block(front, cab, deck, 0.93 * tall), 3.0, style);
            } else if !v.is_dolly(i) {
                // A frame that carries the next unit has no load of its own under it.
                let end = if v.carries(i) { next.map_or(rear, |next| (next + 0.2).max(rear)) } else { rear };
                p.rect(block(front, end, deck, tall), 2.0, style);
            }
            let wheels = if i == 0 { vec![coupling, pose.axle[0]] } else { vec![pose.axle[0]] };
            for at in wheels {
                let look = Style::area(palette::INK).outlined(palette::PAPER, 1.0);
                p.circle([layout.x(at), ground - scale * wheel], scale * wheel, look);
                p.circle([layout.x(at), ground - scale * wheel], 0.4 * scale * wheel, Style::area(palette::PALE));
            }
        }
        for (unit, pose) in v.units.iter().zip(&layout.poses).take(v.units.len().saturating_sub(1)) {
            let x = layout.x(pose.axle[0] - unit.hitch_offset_m);
            p.circle([x, ground - scale * (deck - 0.2 * frame)], 4.0, Style::area(palette::VERMILLION));
        }
        let x = layout.x(-v.length_m) + 28.0;
        let (top, style) = (ground - scale * tall, TextStyle::size(13.0).coloured(palette::GREY));
        let said = if v.height_m.is_some() { format!("{tall:.2} m") } else { "height not known".to_owned() };
        dimension(p, [x, ground], [x, top], &said, style);
        let note = "from the side: lengths to scale; cab, decks and wheels are a scheme";
        p.text([MARGIN, ground + 18.0], note, TextStyle::size(12.0).coloured(palette::GREY));
    });
}

/// Front, rear and front coupling of a unit in line.
fn extent(unit: &Unit, pose: &Pose) -> (f64, f64, f64) {
    let coupling = pose.axle[0] + unit.coupling_to_axle_m;
    (coupling + unit.front_overhang_m, pose.axle[0] - unit.rear_overhang_m, coupling)
}

/// Draws the view from above, with the angles that hinges allow.
fn above(picture: &mut Picture, v: &Vehicle, layout: &Layout) {
    let view = &layout.view;
    picture.group("limits", |p| {
        for (i, (unit, pose)) in v.units.iter().zip(&layout.poses).enumerate() {
            let pivot = pose.place(unit.coupling_to_axle_m, 0.0);
            // The lock turns the wheels ahead of the steer axle; a hinge turns the unit behind it.
            let way = if i == 0 { 1.0 } else { -1.0 };
            let reach = 0.5 * v.width_m() + swing_m(v);
            let ray = |angle: f64| [pivot[0] + way * reach * angle.cos(), pivot[1] + reach * angle.sin()];
            let limit = unit.max_articulation_rad;
            let steps = 24;
            let arc: Vec<Point> = (-steps..=steps).map(|k| ray(limit * f64::from(k) / f64::from(steps))).collect();
            let mut wedge = vec![view.at(pivot)];
            wedge.extend(view.all(&arc));
            p.polygon(&wedge, Style::area(palette::VERMILLION).filled_at(0.10).outlined(palette::VERMILLION, 0.8));
        }
    });
    bodies::vehicle(picture, view, v, &layout.poses, &palette::category);
    picture.group("drawbars", |p| {
        for (_, (unit, pose)) in v.units.iter().zip(&layout.poses).enumerate().filter(|(i, _)| v.is_dolly(*i)) {
            let eye = view.at(pose.place(unit.coupling_to_axle_m, 0.0));
            let half = 0.3 * unit.width_m;
            for left in [half, -half] {
                p.segment(
                    eye,
                    view.at(pose.place(0.25 * unit.coupling_to_axle_m, left)),
                    Style::line(palette::INK, 1.8),
                );
            }
        }
    });
    picture.group("labels", |p| {
        for (i, (unit, pose)) in v.units.iter().zip(&layout.poses).enumerate() {
            let pivot = view.at(pose.place(unit.coupling_to_axle_m, 0.0));
            let up = view.length(0.5 * v.width_m() + swing_m(v)) + 8.0;
            let style = TextStyle::size(12.5).bold().coloured(palette::VERMILLION).anchored(Anchor::Middle).haloed();
            let x = pivot[0] + if i == 0 { -0.3 } else { 0.3 } * view.length(swing_m(v));
            p.text([x, pivot[1] - up + 12.0], &format!("±{:.0}°", unit.max_articulation_rad.to_degrees()), style);
        }
    });
}

/// Draws rows of dimension lines under the view from above: L, d, overhangs, total length.
fn dimensions(picture: &mut Picture, v: &Vehicle, layout: &Layout) {
    let style = TextStyle::size(13.0).coloured(palette::GREY);
    let row = |n: f64| layout.rows + 34.0 * n;
    // Extension lines begin below the bodies.
    let below = layout.view.at([0.0, 0.0])[1] + layout.view.length(0.5 * v.width_m()) + 3.0;
    let mut ticks: Vec<f64> = Vec::new();
    let mut lines: Vec<(f64, f64, f64, String)> = Vec::new();
    let last = v.units.len().saturating_sub(1);
    for (i, (unit, pose)) in v.units.iter().zip(&layout.poses).enumerate() {
        let (front, rear, coupling) = extent(unit, pose);
        let axle = pose.axle[0];
        lines.push((coupling, axle, row(0.0), format!("L {:.2}", unit.coupling_to_axle_m)));
        ticks.extend([coupling, axle]);
        if i < last {
            lines.push((axle, axle - unit.hitch_offset_m, row(1.0), format!("d {:.2}", unit.hitch_offset_m)));
        }
        if i == 0 {
            lines.push((front, coupling, row(2.0), format!("f {:.2}", unit.front_overhang_m)));
        }
        if i == last {
            lines.push((axle, rear, row(2.0), format!("r {:.2}", unit.rear_overhang_m)));
        }
    }
    let rear = layout.poses.iter().zip(&v.units).map(|(pose, unit)| pose.axle[0] - unit.rear_overhang_m);
    let rear = rear.fold(f64::INFINITY, f64::min);
    let front =
        layout.poses.iter().zip(&v.units).map(|(pose, unit)| extent(unit, pose).0).fold(f64::NEG_INFINITY, f64::max);
    lines.push((front, rear, row(3.0), format!("length {:.2} m", v.length_m)));
    ticks.extend([front, rear]);
    picture.group("dimensions", |p| {
        for tick in ticks {
            let x = layout.x(tick);
            p.segment([x, below], [x, row(3.0) + 4.0], Style::line(palette::PALE, 0.8));
        }
        for (from, to, y, text) in lines {
            let (a, b) = ([layout.x(from), y], [layout.x(to), y]);
            if (b[0] - a[0]).abs() >= LEAST_LINE {
                dimension(p, a, b, &text, style);
            }
        }
        let half = 0.5 * v.units.last().map_or(0.0, |u| u.width_m);
        let x = layout.x(rear) + 28.0;
        let [top, bottom] = [half, -half].map(|left| layout.view.at([0.0, left])[1]);
        let width = v.units.last().map_or(0.0, |u| u.width_m);
        dimension(p, [x, top.max(bottom)], [x, top.min(bottom)], &format!("{width:.2} m"), style);
    });
}

fn table(picture: &mut Picture, v: &Vehicle, top: f64) {
    let columns = [
        (MARGIN + 30.0, "unit", Anchor::Start),
        (520.0, "L coupling to axle", Anchor::End),
        (650.0, "d hitch offset", Anchor::End),
        (790.0, "f front overhang", Anchor::End),
        (920.0, "r rear overhang", Anchor::End),
        (1020.0, "b width", Anchor::End),
        (1170.0, "θ most articulation", Anchor::End),
        (1340.0, "σ sway", Anchor::End),
    ];
    picture.group("table", |p| {
        let style = TextStyle::size(12.5);
        for (x, heading, anchor) in columns {
            p.text([x, top + 14.0], heading, style.coloured(palette::GREY).anchored(anchor));
        }
        p.segment([MARGIN, top + 20.0], [WIDTH - MARGIN, top + 20.0], Style::line(palette::PALE, 1.0));
        for (i, u) in v.units.iter().enumerate() {
            let y = top + 38.0 + 22.0 * i as f64;
            let sample = Style::area(palette::category(i)).filled_at(0.45).outlined(palette::INK, 1.0);
            p.rect(PageFrame { x: MARGIN, y: y - 11.0, width: 20.0, height: 13.0 }, 1.0, sample);
            let kind = if v.is_dolly(i) && !u.name.contains("dolly") { " (dolly)" } else { "" };
            let cells = [
                format!("{} {}{kind}", i + 1, u.name),
                format!("{:.2} m", u.coupling_to_axle_m),
                if i + 1 < v.units.len() { format!("{:.2} m", u.hitch_offset_m) } else { "–".to_owned() },
                format!("{:.2} m", u.front_overhang_m),
                format!("{:.2} m", u.rear_overhang_m),
                format!("{:.2} m", u.width_m),
                format!("{:.0}°", u.max_articulation_rad.to_degrees()),
                format!("{:.2}°", u.sway_rad.to_degrees()),
            ];
            for ((x, _, anchor), cell) in columns.iter().zip(cells) {
                p.text([*x, y], &cell, style.anchored(*anchor));
            }
        }
    });
}
