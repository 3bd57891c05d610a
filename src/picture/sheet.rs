//! A page to print and to take along: a route under conditions, its conditions as numbered pins, and a box for each value to fill in.
//!
//! The page needs no other file but its style sheet, if that is not within. Its only links lead to OpenStreetMap, for people who read it on a screen.

use std::fmt::Write as _;

use super::furniture::scale_bar;
use super::palette;
use super::style::{Anchor, Style, TextStyle};
use super::svg::{Picture, escaped};
use super::{Bounds, Frame, Point, View};
use crate::network::Network;
use crate::route::{ConditionAt, Conditional};
use crate::vehicle::Vehicle;

const HEAD: &str = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
    <meta name=\"viewport\" content=\"width=device-width\">";
/// The style sheet of the page.
pub const SHEET_STYLE: &str = "body{font:15px/1.4 sans-serif;color:#1a1a1a;background:#fff;max-width:60rem;margin:1rem auto;padding:0 1rem}\
    h1{font-size:1.4rem;margin:0 0 .3rem}svg{width:100%;height:auto}\
    table{border-collapse:collapse;width:100%}th,td{border:1px solid #888;padding:.35rem .5rem;text-align:left;vertical-align:top}\
    td.fill{min-width:5.5rem;height:2.6rem}th{background:#f2f2f2}tr{break-inside:avoid}.scope{border-left:4px solid #b35900;padding-left:.7rem}\
    @media print{body{margin:0;max-width:none}a{color:inherit;text-decoration:none}}";

/// Where the page has its style sheet.
#[derive(Debug, Clone, Copy)]
pub enum SheetStyle<'a> {
    /// In the page, so that it is one file.
    Within,
    /// At an address, because a server may forbid styles within pages.
    At(&'a str),
}

/// The sheet of a route under conditions, as a whole HTML document.
#[must_use]
pub fn sheet(network: &Network, vehicle: &Vehicle, conditional: &Conditional, style: SheetStyle<'_>) -> String {
    let route = &conditional.route;
    let count = conditional.conditions.len();
    let title = format!("{}: a route of {:.1} km if {count} conditions hold", vehicle.id, route.length_m / 1000.0);
    let style = match style {
        SheetStyle::Within => format!("<style>{SHEET_STYLE}</style>"),
        // The empty icon keeps browsers from asking the server for one.
        SheetStyle::At(address) => {
            format!("<link rel=\"icon\" href=\"data:,\"><link rel=\"stylesheet\" href=\"{}\">", escaped(address))
        }
    };
    let mut page = format!("{HEAD}<title>{0}</title>{style}</head><body><h1>{0}</h1>", escaped(&title));
    let rsc = route.certificate.result.rsc_m.map_or("unknown".to_owned(), |rsc_m| format!("{rsc_m:.2} m"));
    let _ = write!(
        page,
        "<p>{}. RSC {rsc} under the conditions: what the worst body point has to spare, all error bounds deducted.</p>\
         <p class=\"scope\">The route is certified only if every line below is so on site. This sheet does not say that it is, and it is \
         no permit. What counts of a measurement is its value less 1.64 times its standard uncertainty.</p>",
        escaped(&vehicle.name)
    );
    page += &map(network, conditional);
    page += "<table><thead><tr><th>No.</th><th>Where</th><th>What has to be so</th><th>Measured, m</th><th>Uncertainty, m</th>\
             <th>Date, by</th><th>Photo</th></tr></thead><tbody>";
    for (number, condition) in (1..).zip(&conditional.conditions) {
        let place = condition.place(network).map_or_else(String::new, |[lon, lat]| {
            format!(
                "<br><a href=\"https://www.openstreetmap.org/?mlat={lat:.6}&amp;mlon={lon:.6}#map=19/{lat:.6}/{lon:.6}\">\
                 latitude {lat:.5}, longitude {lon:.5}</a>"
            )
        });
        let length_m = condition.length_m(network);
        let over = match &condition.at {
            ConditionAt::Road(_) => format!("<br>over {length_m:.0} m"),
            ConditionAt::Corner { node, .. } | ConditionAt::Junction(node) => format!("<br>OpenStreetMap node {node}"),
        };
        let _ = write!(
            page,
            "<tr><td>{number}</td><td>{}{place}{over}</td><td>{}</td><td class=\"fill\"></td><td class=\"fill\"></td>\
             <td class=\"fill\"></td><td class=\"fill\"></td></tr>",
            escaped(&condition.title(network)),
            escaped(&condition.words())
        );
    }
    page += "</tbody></table><p>Write the measurements into the sheet as CSV (<code>netcert route --sheet conditions.csv</code>), then \
             <code>netcert evidence add conditions.csv</code>.</p></body></html>\n";
    page
}

/// The route with the conditions as numbered pins.
fn map(network: &Network, conditional: &Conditional) -> String {
    let path = &conditional.route.path;
    let line: Vec<Point> = path.corridor.x.iter().zip(&path.corridor.y).map(|(&x, &y)| [x, y]).collect();
    let places = conditional.conditions.iter().map(|condition| condition.place(network));
    let pins: Vec<Option<Point>> = places
        .map(|place| {
            let [lon, lat] = place?;
            path.frame.forward_degrees(vec![(lon, lat)]).ok()?.first().copied()
        })
        .collect();
    let frame = Frame { x: 30.0, y: 20.0, width: 940.0, height: 440.0 };
    let bounds = Bounds::of(line.iter().chain(pins.iter().flatten()));
    let view = View::fit(&bounds, frame);
    let mut picture = Picture::new(1000.0, 500.0, "The route and its conditions", "Numbers are those of the table");
    // Dashed, as nothing certified is.
    picture.polyline(&view.all(&line), Style::line(palette::INK, 3.0).dashed(9.0, 5.0));
    for (at, colour) in [(line.first(), palette::GREEN), (line.last(), palette::INK)] {
        if let Some(&at) = at {
            picture.circle(view.at(at), 6.0, Style::area(colour).outlined(palette::PAPER, 1.5));
        }
    }
    for (number, pin) in (1..).zip(&pins) {
        let Some(pin) = pin else { continue };
        // Pins of one place stand side by side.
        let before = pins.iter().take(number - 1).filter(|other| other.as_ref() == Some(pin)).count();
        let [x, y] = view.at(*pin);
        let at = [x + 21.0 * before as f64, y];
        picture.circle(at, 10.0, Style::area(palette::VERMILLION).outlined(palette::PAPER, 1.5));
        let text = TextStyle::size(11.0).bold().anchored(Anchor::Middle).coloured(palette::PAPER);
        picture.text([at[0], at[1] + 4.0], &format!("{number}"), text);
    }
    scale_bar(&mut picture, &view, [40.0, 480.0], 160.0);
    picture.finish()
}
