//! The turns of a vehicle: the road that it sweeps in 90°, 180° and a full circle, with the numbers at their places.

use std::ops::RangeInclusive;

use super::furniture::{arrow, dimension};
use super::palette;
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::{BoundingBox, PageFrame, Point, View, bodies, scale_bar};
use netcert_base::vehicle::Vehicle;
use netcert_explain::manoeuvres::{
    self, DrivenTurn, LimitFinding, ManoeuvreReport, PerformanceMeasure, PrescribedTurn, RADIUS_M, TurnMeasurements,
};

const WIDTH: f64 = 1400.0;
const MARGIN: f64 = 28.0;
/// Distance between drawn bodies of the swept area, metres. The steps are not visible.
const SMEAR_M: f64 = 0.25;

/// The picture of a vehicle's manoeuvres.
#[must_use]
pub fn manoeuvres(vehicle: &Vehicle) -> String {
    let report = manoeuvres::report(vehicle);
    let title = format!("{}: turns at low speed", vehicle.id);
    let description = format!(
        "Swept path {} in a 90° turn at 12.5 m; inner radius {:.2} m in a circle of 12.5 m.",
        width(&report.right_angle),
        report.circle.inner_m
    );
    let panel = (WIDTH - 4.0 * MARGIN) / 3.0;
    let frames =
        [0.0, 1.0, 2.0].map(|i| PageFrame { x: MARGIN + i * (panel + MARGIN), y: 122.0, width: panel, height: 470.0 });
    let mut picture = Picture::new(WIDTH, 880.0, &title, &description);
    picture.text([MARGIN, 44.0], &vehicle.name, TextStyle::size(24.0).bold());
    let subtitle =
        format!("{} · low-speed turns, exact no-slip motion of rectangular bodies; a pass is no approval", vehicle.id);
    picture.text([MARGIN, 70.0], &subtitle, TextStyle::size(15.0).coloured(palette::GREY));
    let [first, second, third] = frames;
    turn(&mut picture, vehicle, &manoeuvres::right_angle(vehicle), &report.right_angle, first);
    turn(&mut picture, vehicle, &manoeuvres::u_turn(vehicle), &report.u_turn, second);
    circle(&mut picture, vehicle, &report, third);
    let below = |frame: PageFrame| [frame.x, frame.y + frame.height + 22.0];
    let of = |measures: &[PerformanceMeasure]| -> Vec<LimitFinding> {
        report.findings.iter().copied().filter(|f| measures.contains(&f.limit.measure)).collect()
    };
    let pbs = of(&[PerformanceMeasure::SweptPath, PerformanceMeasure::TailSwing, PerformanceMeasure::FrontalSwing]);
    numbers(&mut picture, below(first), vehicle, &report.right_angle, &pbs);
    numbers(&mut picture, below(second), vehicle, &report.u_turn, &[]);
    ring_numbers(
        &mut picture,
        below(third),
        vehicle,
        &report,
        &of(&[PerformanceMeasure::InnerRadius, PerformanceMeasure::RingWidth, PerformanceMeasure::SwingOut]),
    );
    let notes = "Limits of PBS: the standard is named, its text was not read. EU: directive 96/53/EC with 97/27/EC; DE: \
                 StVZO § 32d; both read. Rounded corners of real bodies swing less.";
    picture.text([MARGIN, 866.0], notes, TextStyle::size(12.0).coloured(palette::GREY));
    picture.finish()
}

fn heading(picture: &mut Picture, frame: PageFrame, title: &str, guide: &str) {
    picture.text([frame.x, frame.y - 24.0], title, TextStyle::size(17.0).bold());
    let style = TextStyle::size(12.5).coloured(palette::GREY);
    picture.text([frame.x, frame.y - 8.0], &format!("{guide} follows the blue path"), style);
}

fn turn(picture: &mut Picture, vehicle: &Vehicle, turn: &PrescribedTurn, swept: &TurnMeasurements, frame: PageFrame) {
    let degrees = turn.angle_rad.to_degrees();
    heading(picture, frame, &format!("{degrees:.0}° at {RADIUS_M} m"), turn.guide.words());
    let drive = turn.drive(vehicle);
    let ends = seen(&drive, turn);
    let mut points: Vec<Point> = ends.clone().flat_map(|at| bodies::corners(vehicle, pose_at(&drive, at))).collect();
    points.push([0.0, turn.radius_m]);
    let view = View::fit(&BoundingBox::of(&points).grown(1.0), frame);
    picture.clipped(frame, "turn", |p| {
        smear(p, &view, vehicle, &drive, -2.0..=1e9);
        path(p, &view, &drive);
        let arc = turn.radius_m * turn.angle_rad;
        for share in [0.0, 0.5, 1.0] {
            outline(p, &view, vehicle, pose_at(&drive, share * arc));
        }
        bodies::vehicle(p, &view, vehicle, pose_at(&drive, moment(&drive, swept)), &palette::category);
        let across = |left: f64| view.at(beside(turn, swept.width_at_m, left));
        let style = TextStyle::size(15.0).bold().coloured(palette::VERMILLION);
        if swept.width_m.is_some() {
            dimension(p, across(swept.extent_m[1]), across(swept.extent_m[0]), &width(swept), style);
        }
        centre(p, &view, turn);
        scale_bar(p, &view, [frame.x + 12.0, frame.y + frame.height - 10.0], 110.0);
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
}

/// Guide places that the picture shows: from the entry until the front is well out of the turn.
fn seen(drive: &DrivenTurn, turn: &PrescribedTurn) -> impl Iterator<Item = f64> + Clone + use<> {
    let last = drive.at_m.last().copied().unwrap_or(0.0).min(turn.radius_m * turn.angle_rad + 14.0);
    (0..=12).map(move |i| -2.0 + (last + 2.0) * f64::from(i) / 12.0)
}

/// Place of the guide when the inner side of the unit that cuts in most passes the widest place, approximately.
fn moment(drive: &DrivenTurn, swept: &TurnMeasurements) -> f64 {
    let place = beside(&drive.turn, swept.width_at_m, swept.extent_m[0]);
    let near = |poses: &[crate::stet::motion::Pose]| {
        poses.last().map_or(f64::INFINITY, |pose| (pose.axle[0] - place[0]).hypot(pose.axle[1] - place[1]))
    };
    let best = drive.poses.iter().zip(&drive.at_m).min_by(|a, b| near(a.0).total_cmp(&near(b.0)));
    best.map_or(0.0, |(_, at)| *at)
}

/// The place `at_m` along the path and `left_m` to its left.
fn beside(turn: &PrescribedTurn, at_m: f64, left_m: f64) -> Point {
    let (here, on) = (turn.place(at_m), turn.place(at_m + 1e-3));
    let u = [(on[0] - here[0]) / 1e-3, (on[1] - here[1]) / 1e-3];
    [here[0] - left_m * u[1], here[1] + left_m * u[0]]
}

fn pose_at(drive: &DrivenTurn, at_m: f64) -> &[crate::stet::motion::Pose] {
    let k = drive.at_m.partition_point(|&at| at < at_m).min(drive.poses.len().saturating_sub(1));
    drive.poses.get(k).map_or(&[], Vec::as_slice)
}

/// Draws the area that the bodies sweep while the guide is at these places, metres along the path.
fn smear(picture: &mut Picture, view: &View, vehicle: &Vehicle, drive: &DrivenTurn, guide_m: RangeInclusive<f64>) {
    picture.group("swept", |p| {
        let mut next = *guide_m.start();
        for (poses, &at) in drive.poses.iter().zip(&drive.at_m) {
            if at >= next && at <= *guide_m.end() {
                next = at + SMEAR_M;
                for (unit, pose) in vehicle.units.iter().zip(poses) {
                    p.polygon(&view.all(&pose.outline(unit)), Style::area(palette::ROAD).outlined(palette::ROAD, 0.8));
                }
            }
        }
    });
}

fn outline(picture: &mut Picture, view: &View, vehicle: &Vehicle, poses: &[crate::stet::motion::Pose]) {
    picture.group("before-and-after", |p| {
        for (unit, pose) in vehicle.units.iter().zip(poses) {
            p.polygon(&view.all(&pose.outline(unit)), Style::line(palette::GREY, 0.8).drawn_at(0.7));
        }
    });
}

fn path(picture: &mut Picture, view: &View, drive: &DrivenTurn) {
    let step = (drive.path.len() / 600).max(1);
    let points: Vec<Point> = drive.path.iter().step_by(step).copied().collect();
    picture.group("path", |p| {
        p.polyline(&view.all(&points), Style::line(palette::BLUE, 2.0));
        let first = view.at(drive.turn.place(-2.0));
        arrow(p, [first[0] - 1.0, first[1]], view.at(drive.turn.place(1.0)), palette::BLUE, 2.0);
    });
}

fn centre(picture: &mut Picture, view: &View, turn: &PrescribedTurn) {
    let [x, y] = view.at([0.0, turn.radius_m]);
    for (dx, dy) in [(5.0, 0.0), (0.0, 5.0)] {
        picture.segment([x - dx, y - dy], [x + dx, y + dy], Style::line(palette::GREY, 1.2));
    }
}

fn circle(picture: &mut Picture, vehicle: &Vehicle, report: &ManoeuvreReport, frame: PageFrame) {
    let turn = manoeuvres::circle(vehicle);
    heading(picture, frame, "360°, 12.5 m and 5.3 m", turn.guide.words());
    let drive = turn.drive(vehicle);
    let (reach, middle) = (turn.radius_m + 1.2, [0.0, turn.radius_m]);
    let bounds = BoundingBox { low: [-reach, middle[1] - reach], high: [reach, middle[1] + reach] };
    let view = View::fit(&bounds, frame);
    let arc = turn.radius_m * turn.angle_rad;
    picture.clipped(frame, "circle", |p| {
        smear(p, &view, vehicle, &drive, 0.0..=arc);
        p.circle(view.at(middle), view.length(turn.radius_m), Style::line(palette::BLUE, 2.0));
        p.circle(view.at(middle), view.length(5.30), Style::line(palette::INK, 1.2).dashed(6.0, 4.0));
        let inner = Style::line(palette::VERMILLION, 1.6);
        p.circle(view.at(middle), view.length(report.circle.inner_m), inner);
        bodies::vehicle(p, &view, vehicle, pose_at(&drive, arc), &palette::category);
        let text = TextStyle::size(15.0).bold().coloured(palette::VERMILLION);
        let at =
            |angle: f64, radius: f64| view.at([middle[0] + radius * angle.cos(), middle[1] + radius * angle.sin()]);
        if undrivable(vehicle, &report.circle.angles_rad).is_none() {
            let inner_m = report.circle.inner_m;
            dimension(p, view.at(middle), at(0.6, inner_m), &format!("{inner_m:.2} m"), text);
        }
        let ink = TextStyle::size(13.0).anchored(Anchor::Middle).haloed();
        p.text(at(1.57, 5.55), "5.3 m", ink);
        p.text(at(1.57, 12.75), "12.5 m", ink.coloured(palette::BLUE));
        centre(p, &view, &turn);
        scale_bar(p, &view, [frame.x + 12.0, frame.y + frame.height - 10.0], 110.0);
    });
    picture.rect(frame, 0.0, Style::line(palette::PALE, 1.0));
}

fn width(swept: &TurnMeasurements) -> String {
    swept.width_m.map_or("past the centre".to_owned(), |metres| format!("{metres:.2} m"))
}

/// A warning if an angle exceeds the vehicle's limit.
fn undrivable(vehicle: &Vehicle, angles_rad: &[f64]) -> Option<String> {
    let unit = manoeuvres::beyond_limit(vehicle, angles_rad)?;
    let limit = vehicle.units.get(unit)?.max_articulation_rad.to_degrees();
    Some(match unit {
        0 => format!("cannot be driven so: the lock is {limit:.0}°"),
        _ => format!("cannot be driven so: hinge {unit} allows {limit:.0}°"),
    })
}

fn numbers(picture: &mut Picture, at: Point, vehicle: &Vehicle, swept: &TurnMeasurements, findings: &[LimitFinding]) {
    let hinge = swept.angles_rad.iter().skip(1).fold(0.0_f64, |most, &a| most.max(a)).to_degrees();
    let steering = swept.angles_rad.first().map_or(0.0, |a| a.to_degrees());
    let mut lines = vec![
        match swept.width_m {
            Some(_) => format!("swept path {} · last axle cuts in {:.2} m", width(swept), swept.offtracking_m),
            None => "comes past the centre: no swept path".to_owned(),
        },
        format!("tail swing {:.2} m · frontal swing {:.2} m", swept.tail_swing_m, swept.frontal_swing_m),
        format!("greatest steering angle {steering:.1}° · articulation {hinge:.1}°"),
    ];
    lines.extend(undrivable(vehicle, &swept.angles_rad));
    listed(picture, at, &lines, findings);
}

fn ring_numbers(
    picture: &mut Picture,
    at: Point,
    vehicle: &Vehicle,
    report: &ManoeuvreReport,
    findings: &[LimitFinding],
) {
    let ring = &report.circle;
    let hinge = ring.angles_rad.iter().skip(1).fold(0.0_f64, |most, &a| most.max(a)).to_degrees();
    let mut lines = vec![
        format!("inner radius {:.2} m · ring {:.2} m", ring.inner_m, ring.width_m()),
        format!("swing-out on entering {:.2} m", ring.swing_out_m),
        format!("greatest articulation {hinge:.1}°"),
    ];
    if let Some(why) = undrivable(vehicle, &ring.angles_rad) {
        lines = vec![why, format!("articulation would come to {hinge:.1}°")];
    }
    listed(picture, at, &lines, findings);
}

fn listed(picture: &mut Picture, at: Point, lines: &[String], findings: &[LimitFinding]) {
    let style = TextStyle::size(13.5);
    for (i, line) in lines.iter().enumerate() {
        picture.text([at[0], at[1] + 19.0 * i as f64], line, style);
    }
    let top = at[1] + 19.0 * lines.len() as f64 + 6.0;
    for (i, f) in findings.iter().enumerate() {
        let y = top + 18.0 * i as f64;
        // A cross or a tick as well as the colour.
        let (sign, colour) = if f.passes { ("✓", palette::BLUE) } else { ("✗", palette::VERMILLION) };
        let bound = if f.limit.measure.at_least() { "≥" } else { "≤" };
        let what = f.limit.measure.words().split(',').next().unwrap_or("");
        picture.text([at[0], y], sign, TextStyle::size(14.0).bold().coloured(colour));
        let measured = f.metres.map_or("–".to_owned(), |m| format!("{m:.2} m"));
        let text = format!("{what} {measured} {bound} {:.2} m, {}", f.limit.metres, f.limit.who);
        picture.text([at[0] + 18.0, y], &text, TextStyle::size(12.5));
    }
}
