//! The figure of every scenario's certificate over its narrowest half-width: from the table, by Algorithm 1, and by netcert.

use netcert::picture::{Anchor, Chart, PageFrame, Picture, Scale, Style, TextStyle, palette};

use super::super::simulate::Simulated;
use super::{Mark, heading, marks};

const WIDTH: f64 = 1100.0;
const HEIGHT: f64 = 800.0;

pub(super) fn figure(simulated: &[Simulated]) -> String {
    let title = "Route safety certificate against the narrowest half width, scenarios 1 to 7";
    let mut picture = Picture::new(WIDTH, HEIGHT, title, "Three marks a scenario over its narrowest half width");
    heading(
        &mut picture,
        title,
        &[
            "Above 0 is safe. 𝒞 requires half a body's length on either side; RSC requires what the bodies take up across the road.",
            "RSC is computed without tolerances here, because 𝒞 has none.",
        ],
    );
    let keys = [
        (Mark::Disc, palette::VERMILLION, "𝒞 from Table I's own numbers"),
        (Mark::Ring, palette::PURPLE, "𝒞 by Algorithm 1 on the drawn route"),
        (Mark::Square, palette::BLUE, "netcert's RSC, same vehicle, same corridor"),
    ];
    marks(&mut picture, [100.0, 118.0], &keys);
    // A scenario without an RSC (no bound holds for the vehicle) is left out.
    let (simulated, values): (Vec<&Simulated>, Vec<[f64; 4]>) = simulated
        .iter()
        .filter_map(|s| {
            Some((s, [s.scenario.w_min_m, s.scenario.rsc().rsc_m, s.paper.rsc.rsc_m, s.exact.result.rsc_m?]))
        })
        .unzip();
    let chart = chart(&values);
    chart.axes(&mut picture);
    let (below, right) = (chart.at(chart.x.low, 0.0), chart.at(chart.x.high, chart.y.low));
    let unsafe_area = PageFrame { x: below[0], y: below[1], width: right[0] - below[0], height: right[1] - below[1] };
    picture.rect(unsafe_area, 0.0, Style::area(palette::VERMILLION).filled_at(0.07));
    chart.level(&mut picture, 0.0, Style::line(palette::INK, 1.6));
    let small = TextStyle::size(13.0).coloured(palette::GREY).anchored(Anchor::End);
    picture.text([right[0] - 8.0, below[1] - 8.0], "safe", small);
    picture.text([right[0] - 8.0, below[1] + 18.0], "unsafe", small);
    for (s, [w, table, algorithm, netcert]) in simulated.iter().zip(&values) {
        let ends = [chart.at(*w, table.min(*algorithm)), chart.at(*w, *netcert)];
        picture.segment(ends[0], ends[1], Style::line(palette::GREY, 0.9).dashed(3.0, 4.0));
        for ((mark, colour, _), value) in keys.iter().zip([table, algorithm, netcert]) {
            mark.draw(&mut picture, chart.at(*w, *value), *colour);
        }
        let name = TextStyle::size(14.0).bold().anchored(Anchor::Middle).haloed();
        picture.text([ends[1][0], ends[1][1] - 13.0], &format!("S{}", s.scenario.number), name);
    }
    picture.finish()
}

fn chart(values: &[[f64; 4]]) -> Chart {
    let all = || values.iter().flat_map(|v| v[1..].iter());
    let low = all().fold(0.0_f64, |low, &v| low.min(v));
    let high = all().fold(0.0_f64, |high, &v| high.max(v));
    let (first, last) = values.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v[0]), b.max(v[0])));
    let (first, last) = if first.is_finite() { (first, last) } else { (0.0, 1.0) };
    Chart {
        frame: PageFrame { x: 90.0, y: 200.0, width: WIDTH - 130.0, height: HEIGHT - 260.0 },
        x: Scale::new((first - 0.5).floor(), (last + 0.5).ceil(), "narrowest half width w_min, m").ticks(8),
        y: Scale::new(low - 0.6, high + 0.9, "certificate, m").ticks(8),
    }
}
