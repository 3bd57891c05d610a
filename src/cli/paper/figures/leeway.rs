//! The figure of left and right leeway along the route, before and after correction. It shows Algorithm 1 with β° as
//! printed, Algorithm 1 with the β of least trace, and netcert's certificate.

use netcert::picture::{Chart, LegendEntry, PageFrame, Picture, Scale, Style, TextStyle, legend, palette};
use netcert::published::{Correction, Leeway, RouteCert};

use super::super::simulate::Simulated;
use super::heading;

const WIDTH: f64 = 1400.0;
const HEIGHT: f64 = 1440.0;
const ROW: f64 = 330.0;
const TOP: f64 = 110.0;

/// The leeway of one side at every station, metres.
struct Curves {
    before: Vec<f64>,
    after: Vec<f64>,
}

pub(super) fn figure(five: &Simulated, tight: &Simulated, lane: &Simulated) -> String {
    let title = format!("Boundary leeway before and after correction, scenario {}", five.scenario.number);
    let mut picture = Picture::new(WIDTH, HEIGHT, &title, "Rows of two charts: left and right leeway along the route");
    let says = "Below 0 the tube or the body is over the edge. Where the two curves coincide, nothing was corrected.";
    heading(&mut picture, &title, &[says]);
    let before = Style::line(palette::VERMILLION, 2.4).dashed(7.0, 5.0);
    let after = Style::line(palette::BLUE, 2.4);
    let keys = [LegendEntry::new(before, "before correction"), LegendEntry::new(after, "after correction")];
    legend(&mut picture, [WIDTH - 210.0, 24.0], &keys);
    for (row, (name, sides)) in rows(five, tight, lane).iter().enumerate() {
        let y = TOP + ROW * row as f64;
        picture.text([30.0, y - 8.0], name, TextStyle::size(15.0).bold());
        let scale = scale(sides);
        for (column, (side, curves)) in ["left", "right"].iter().zip(sides).enumerate() {
            let x = 90.0 + column as f64 * 0.5 * WIDTH;
            let length_m = five.corridor.spacing_m * (five.corridor.len() as f64 - 1.0);
            let chart = Chart {
                frame: PageFrame { x, y: y + 8.0, width: 0.5 * WIDTH - 120.0, height: ROW - 90.0 },
                x: Scale::new(0.0, length_m, "along the route, m"),
                y: Scale::new(scale[0], scale[1], &format!("{side} leeway, m")).ticks(5),
            };
            draw(&mut picture, five, &chart, curves, before, after);
        }
    }
    picture.finish()
}

/// The caption and the two curves of each row.
fn rows(five: &Simulated, tight: &Simulated, lane: &Simulated) -> Vec<(String, [Curves; 2])> {
    let mut rows = Vec::new();
    let runs = [
        ("β° as printed (E1)", five, &five.printed_beta),
        ("β of least trace", five, &five.paper),
        ("β of least trace", tight, &tight.paper),
    ];
    for (beta, s, run) in runs {
        let corrected = run.steps.iter().filter(|step| step.correction != Correction::None).count();
        let gamma = run.steps.iter().fold(1.0_f64, |least, step| least.min(step.gamma));
        let name = format!(
            "Algorithm 1, last trailer, {beta}, w_min {:.2} m: corrected at {corrected} of {} instants, prime mover's tube shrunk to γ {gamma:.2}",
            s.scenario.w_min_m,
            run.steps.len(),
        );
        rows.push((name, algorithm(run)));
    }
    let (certificate, shift) = (&lane.exact, &lane.exact.shift_m);
    let most = shift.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    let name = format!(
        "netcert, all points of all units, no tolerances, w_min {:.2} m: steer axle shifted by up to {most:.2} m",
        lane.scenario.w_min_m
    );
    let sides = [
        Curves { before: certificate.left_centred_m.clone(), after: certificate.left_m.clone() },
        Curves { before: certificate.right_centred_m.clone(), after: certificate.right_m.clone() },
    ];
    rows.push((name, sides));
    rows
}

fn draw(picture: &mut Picture, s: &Simulated, chart: &Chart, curves: &Curves, before: Style, after: Style) {
    chart.axes(picture);
    chart.level(picture, 0.0, Style::line(palette::INK, 1.4));
    let along = |values: &[f64]| -> Vec<[f64; 2]> {
        // A station that no body point reaches has no leeway; netcert stores a very large number there.
        let known = values.iter().enumerate().filter(|(_, v)| v.abs() < 1e3);
        known.map(|(k, &v)| [k as f64 * s.corridor.spacing_m, v]).collect()
    };
    chart.curve(picture, "after", &along(&curves.after), after);
    chart.curve(picture, "before", &along(&curves.before), before);
}

fn algorithm(run: &RouteCert) -> [Curves; 2] {
    let side = |of: fn(&Leeway) -> f64| Curves {
        before: run.steps.iter().map(|step| of(&step.before)).collect(),
        after: run.steps.iter().map(|step| of(&step.after)).collect(),
    };
    [side(|l| l.left_m), side(|l| l.right_m)]
}

/// The range of leeway in metres, the same for both sides. It contains 0.
fn scale(sides: &[Curves; 2]) -> [f64; 2] {
    let known = || sides.iter().flat_map(|c| c.before.iter().chain(&c.after)).filter(|v| v.abs() < 1e3);
    let (low, high) = known().fold((0.0_f64, 0.0_f64), |(low, high), &v| (low.min(v), high.max(v)));
    let room = 0.06 * (high - low).max(0.1);
    [low - room, high + room]
}
