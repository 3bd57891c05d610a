//! The figure of run time over the number of trailers, with the fitted lines. The paper's two times come from another
//! machine and program, so the figure names them in its text and does not draw them.

use netcert::picture::{Chart, PageFrame, Picture, Scale, Style, TextStyle, palette};

use super::super::timing::{Series, Timing};
use super::{Mark, heading};

const COLUMN: f64 = 530.0;
const WIDTH: f64 = 3.0 * COLUMN;
const HEIGHT: f64 = 560.0;
const COLOURS: [palette::Colour; 3] = [palette::PURPLE, palette::BLUE, palette::GREEN];

pub(super) fn figure(timing: &Timing) -> String {
    let title = "Run time against the number of trailers";
    let mut picture = Picture::new(
        WIDTH,
        HEIGHT,
        title,
        "Three charts, milliseconds by trailers: Algorithm 1, netcert's certificate, its gains",
    );
    heading(
        &mut picture,
        title,
        &[
            "Scenario 5's vehicle on its route of 543.62 m, widened for all; least of some runs on this machine. Gains are computed once per vehicle. The paper: 0.5 s for two, 1.15 s for five \
           trailers (i7-12650H).",
        ],
    );
    for (column, ((name, series), colour)) in timing.series().into_iter().zip(COLOURS).enumerate() {
        panel(&mut picture, 85.0 + column as f64 * COLUMN, name, series, colour);
    }
    picture.finish()
}

fn panel(picture: &mut Picture, x: f64, name: &str, series: &Series, colour: palette::Colour) {
    let most_s = series.points.iter().fold(0.0_f64, |most, p| most.max(p.1));
    let most = series.points.last().map_or(1.0, |p| p.0 as f64);
    let chart = Chart {
        frame: PageFrame { x, y: 150.0, width: COLUMN - 110.0, height: HEIGHT - 220.0 },
        x: Scale::new(0.0, most + 0.5, "trailers").ticks(10),
        y: Scale::new(0.0, 1.12e3 * most_s, "run time, ms"),
    };
    let line = |n: f64| [n, 1e3 * (series.intercept_s + series.slope_s * n)];
    let text = format!("{name}: {:.2} ms a trailer, R² {:.3}", 1e3 * series.slope_s, series.r_squared);
    picture.text([x, 128.0], &text, TextStyle::size(15.0).bold());
    chart.axes(picture);
    chart.curve(picture, "fit", &[line(0.5), line(most + 0.4)], Style::line(palette::GREY, 1.6).dashed(6.0, 4.0));
    for &(trailers, seconds) in &series.points {
        Mark::Disc.draw(picture, chart.at(trailers as f64, 1e3 * seconds), colour);
    }
}
