//! The paper's figures, as SVG. All but `timing.svg` depend only on the data that netcert ships.

mod leeway;
mod rsc;
mod timing;
mod tubes;

use netcert::picture::{Picture, Style, TextStyle, palette};
use netcert::published::{DrawnRoute, Scenario};

use super::simulate::{self, Simulated};
use super::timing::Timing;

/// Number of the scenario that the paper draws.
pub(super) const DRAWN: u32 = 5;

/// Narrowest half-widths, metres, at which the vehicle of scenario 5 needs correction: by Algorithm 1, whose tubes are wide,
/// and by netcert.
const SHORT_OF_ROOM_M: [f64; 2] = [5.0, 1.7];

/// The file name and the SVG document of each figure.
pub(super) fn all(
    simulated: &[Simulated],
    route: &DrawnRoute,
    timing: Option<&Timing>,
) -> anyhow::Result<Vec<(&'static str, String)>> {
    let mut figures = Vec::new();
    if let Some(five) = simulated.iter().find(|s| s.scenario.number == DRAWN) {
        figures.push(("tubes.svg", tubes::figure(five)));
        let [tight, lane] = SHORT_OF_ROOM_M;
        let narrower = |w_min_m| simulate::run(&Scenario { w_min_m, ..five.scenario }, route);
        figures.push(("leeway.svg", leeway::figure(five, &narrower(tight)?, &narrower(lane)?)));
    }
    figures.push(("rsc.svg", rsc::figure(simulated)));
    if let Some(timing) = timing {
        figures.push(("timing.svg", timing::figure(timing)));
    }
    Ok(figures)
}

/// Draws the title and the lines of text below it.
fn heading(picture: &mut Picture, title: &str, lines: &[&str]) {
    picture.text([30.0, 38.0], title, TextStyle::size(20.0).bold());
    for (i, line) in lines.iter().enumerate() {
        let at = [30.0, 60.0 + 19.0 * i as f64];
        picture.text(at, line, TextStyle::size(14.0).coloured(palette::GREY));
    }
}

/// The mark of a value. Marks differ in shape, so that a reader need not tell colours apart.
#[derive(Clone, Copy)]
enum Mark {
    Disc,
    Ring,
    Square,
}

impl Mark {
    fn draw(self, picture: &mut Picture, at: [f64; 2], colour: palette::Colour) {
        let [x, y] = at;
        match self {
            Self::Disc => picture.circle(at, 6.0, Style::area(colour)),
            Self::Ring => picture.circle(at, 5.5, Style::area(palette::PAPER).outlined(colour, 2.2)),
            Self::Square => {
                let frame = netcert::picture::PageFrame { x: x - 5.5, y: y - 5.5, width: 11.0, height: 11.0 };
                picture.rect(frame, 0.0, Style::area(colour));
            }
        }
    }
}

/// Draws the legend: each mark with its meaning, one below the other.
fn marks(picture: &mut Picture, at: [f64; 2], keys: &[(Mark, palette::Colour, &str)]) {
    picture.group("legend", |p| {
        for (i, (mark, colour, text)) in keys.iter().enumerate() {
            let y = at[1] + 22.0 * i as f64;
            mark.draw(p, [at[0], y], *colour);
            p.text([at[0] + 16.0, y + 4.5], text, TextStyle::size(13.0));
        }
    });
}
