//! A page to print and to take along: conditions of a route or of a survey as numbered pins, and a box for each value to fill in.
//!
//! The page needs no other file but its style sheet, if that is not within. Its only links lead to OpenStreetMap, for people who read it on a screen.

use std::fmt::Write as _;

use super::furniture::{scale_bar, scale_bar_in};
use super::lengths::Units;
use super::palette;
use super::style::{Anchor, Style, TextStyle};
use super::svg::{Picture, escaped};
use super::{BoundingBox, PageFrame, Point, View};
use crate::evidence::Quantity;
use crate::network::{Network, offset_m};
use crate::osm::LonLat;
use crate::osm::facts::{Direction, RoadClass};
use crate::words::Named as _;
use netcert_base::vehicle::Vehicle;
use netcert_route::{Condition, ConditionAt, Conditional, Opens, Position, SURVEY_SCOPE, Survey, SurveyLine};

/// How far the map of a survey goes beyond its places, metres.
const AROUND_M: f64 = 300.0;
const HEAD: &str = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
    <meta name=\"viewport\" content=\"width=device-width\">";
/// The style sheet of the page.
pub const SHEET_STYLE: &str = "body{font:15px/1.4 sans-serif;color:#1a1a1a;background:#fff;max-width:60rem;margin:1rem auto;padding:0 1rem}\
    h1{font-size:1.4rem;margin:0 0 .3rem}svg{width:100%;height:auto}\
    table{border-collapse:collapse;width:100%}th,td{border:1px solid #888;padding:.35rem .5rem;text-align:left;vertical-align:top}\
    td.fill{min-width:5.5rem;height:2.6rem}td:first-child{white-space:nowrap}.drawing{max-width:36rem}th{background:#f2f2f2}tr{break-inside:avoid}.scope{border-left:4px solid #b35900;padding-left:.7rem}\
    @media print{body{margin:0;max-width:none}a{color:inherit;text-decoration:none}}";

/// Where the page has its style sheet.
#[derive(Debug, Clone, Copy)]
pub enum SheetStyle<'a> {
    /// In the page, so that it is one file.
    Within,
    /// At an address, because a server may forbid styles within pages.
    At(&'a str),
}

/// The beginning of a page, up to its heading.
pub(super) fn styled_head(title: &str, style: SheetStyle<'_>) -> String {
    let style = match style {
        SheetStyle::Within => format!("<style>{SHEET_STYLE}</style>"),
        // The empty icon keeps browsers from asking the server for one.
        SheetStyle::At(address) => {
            format!("<link rel=\"icon\" href=\"data:,\"><link rel=\"stylesheet\" href=\"{}\">", escaped(address))
        }
    };
    format!("{HEAD}<title>{0}</title>{style}</head><body><h1>{0}</h1>", escaped(title))
}

/// The sheet of a route under conditions, as a whole HTML document.
#[must_use]
pub fn sheet(
    network: &Network,
    vehicle: &Vehicle,
    conditional: &Conditional,
    units: Units,
    style: SheetStyle<'_>,
) -> String {
    let route = &conditional.route;
    let count = conditional.conditions.len();
    let length = units.route(route.length_m);
    let title = format!("{}: a route of {length} if {count} conditions hold", vehicle.id);
    let mut page = styled_head(&title, style);
    let rsc = route.certificate.result.rsc_m.map_or("unknown".to_owned(), |rsc_m| units.at_most(rsc_m));
    let _ = write!(
        page,
        "<p>{}. RSC {rsc} under the conditions: what the worst body point has to spare, all error bounds deducted.</p>\
         <p class=\"scope\">The route is certified only if every line below is so on site. This sheet does not say that it is, and it is \
         no permit. What counts of a measurement is its value less 1.64 times its standard uncertainty.</p>",
        escaped(&vehicle.name)
    );
    page += &map(network, conditional, units);
    page += &table(network, (1..).zip(&conditional.conditions), units);
    if units == Units::Feet {
        page += "<p>In the CSV below, give the unit of each value: <code>ft</code> or <code>in</code>.</p>";
    }
    page += "<p>Write the measurements into the sheet as CSV (<code>netcert route --sheet conditions.csv</code>), then \
             <code>netcert evidence add conditions.csv</code>.</p></body></html>\n";
    page
}

/// The sheet of a survey, as a whole HTML document.
#[must_use]
pub fn survey_sheet(network: &Network, vehicle: &Vehicle, survey: &Survey) -> String {
    let title = format!("{}: the measurements that would open most", vehicle.id);
    let mut page =
        format!("{HEAD}<title>{0}</title><style>{SHEET_STYLE}</style></head><body><h1>{0}</h1>", escaped(&title));
    let _ = write!(
        page,
        "<p>{}.</p><p class=\"scope\">{SURVEY_SCOPE} What counts of a measurement is its value less 1.64 times its standard \
         uncertainty.</p>",
        escaped(&vehicle.name)
    );
    let lines: Vec<_> = survey.lines().collect();
    page += &survey_map(network, &lines);
    let amount = |number: f64| match survey.opens {
        Opens::Metres => format!("{:.1} km of certified road, each direction by itself", number / 1000.0),
        Opens::Pairs => format!("{number:.0} pairs of places"),
    };
    for step in lines.chunk_by(|a, b| a.rank == b.rank) {
        let Some(first) = step.first() else { continue };
        let (opens, total) = (amount(first.opens), amount(first.total));
        let _ = write!(page, "<h2>{}. Opens {opens}; {total} with those before</h2>", first.rank);
        page += &table(network, step.iter().map(|line| (line.number, line.condition)), Units::Metres);
    }
    page += "<p>Write the measurements into the sheet as CSV (<code>netcert survey --sheet survey.csv</code>), then \
             <code>netcert evidence add survey.csv</code>.</p></body></html>\n";
    page
}

/// A row for each condition, with room for what is measured.
fn table<'c>(network: &Network, conditions: impl Iterator<Item = (usize, &'c Condition)>, units: Units) -> String {
    let [value, uncertainty] = match units {
        Units::Metres => ["m", "m"],
        Units::Feet => ["ft and in", "in"],
    };
    let mut page = format!(
        "<table><thead><tr><th>No.</th><th>Where</th><th>What has to be so</th><th>Measured, {value}</th>\
         <th>Uncertainty, {uncertainty}</th><th>Date, by</th><th>Photo</th></tr></thead><tbody>"
    );
    for (number, condition) in conditions {
        let place = condition.place(network).map_or_else(String::new, |[lon, lat]| {
            format!(
                "<br><a href=\"https://www.openstreetmap.org/?mlat={lat:.6}&amp;mlon={lon:.6}#map=19/{lat:.6}/{lon:.6}\">\
                 latitude {lat:.5}, longitude {lon:.5}</a>"
            )
        });
        let length_m = condition.length_m(network);
        let over = match &condition.at {
            ConditionAt::Road(_) => format!("<br>over {}", units.along(length_m)),
            ConditionAt::Corner { node, .. } | ConditionAt::Junction(node) => format!("<br>OpenStreetMap node {node}"),
        };
        let attested = condition.attested().map_or_else(String::new, |by| format!("<br>attested: {}", escaped(&by)));
        let _ = write!(
            page,
            "<tr><td>{number}</td><td>{}{place}{over}{attested}</td><td>{}</td><td class=\"fill\"></td><td class=\"fill\"></td>\
             <td class=\"fill\"></td><td class=\"fill\"></td></tr>",
            escaped(&condition.title(network)),
            escaped(&wanted(condition, units))
        );
    }
    page + "</tbody></table>"
}

/// What has to be so. In feet, metres stand beside them, because the CSV and the database have metres.
pub(super) fn wanted(condition: &Condition, units: Units) -> String {
    if units == Units::Metres {
        return condition.words();
    }
    let needed = format!("{} ({:.2} m)", units.at_least(condition.needed_m), condition.needed_m);
    let what = match condition.quantity {
        Quantity::Surface => format!("paved and free of kerbs up to {needed} from the node"),
        quantity => format!("{} at least {needed}", quantity.name().replace('_', " ")),
    };
    condition.assumed_m.map_or(what.clone(), |m| format!("{what}; assumed {}", units.at_most(m)))
}

/// The route with the conditions as numbered pins.
fn map(network: &Network, conditional: &Conditional, units: Units) -> String {
    let path = &conditional.route.path;
    let line: Vec<Point> = path.corridor.x.iter().zip(&path.corridor.y).map(|(&x, &y)| [x, y]).collect();
    let places = conditional.conditions.iter().map(|condition| condition.place(network));
    let pins: Vec<Option<Point>> = places
        .map(|place| {
            let [lon, lat] = place?;
            path.frame.forward_degrees(vec![(lon, lat)]).ok()?.first().copied()
        })
        .collect();
    let frame = PageFrame { x: 30.0, y: 20.0, width: 940.0, height: 440.0 };
    let bounds = BoundingBox::of(line.iter().chain(pins.iter().flatten()));
    let view = View::fit(&bounds, frame);
    let mut picture = Picture::new(1000.0, 500.0, "The route and its conditions", "Numbers are those of the table");
    // Dashed, as nothing certified is.
    picture.polyline(&view.all(&line), Style::line(palette::INK, 3.0).dashed(9.0, 5.0));
    for (at, colour) in [(line.first(), palette::GREEN), (line.last(), palette::INK)] {
        if let Some(&at) = at {
            picture.circle(view.at(at), 6.0, Style::area(colour).outlined(palette::PAPER, 1.5));
        }
    }
    let numbered: Vec<_> = (1..).zip(&pins).filter_map(|(number, pin)| Some((number, (*pin)?))).collect();
    pin_down(&mut picture, &view, &numbered);
    scale_bar_in(&mut picture, &view, [40.0, 480.0], 160.0, units);
    picture.finish()
}

/// The places of a survey as pins with the numbers of their steps, and the roads between them.
fn survey_map(network: &Network, lines: &[SurveyLine<'_>]) -> String {
    let places: Vec<(usize, LonLat)> = lines
        .iter()
        .filter_map(|line| {
            let [lon, lat] = line.condition.place(network)?;
            Some((line.rank, Position { lon, lat }.into()))
        })
        .collect();
    let Some(&(_, centre)) = places.first() else { return String::new() };
    let pins: Vec<(usize, Point)> = places.iter().map(|&(rank, at)| (rank, offset_m(centre, at))).collect();
    let mut bounds = BoundingBox::of(pins.iter().map(|(_, at)| at));
    for [x, y] in [bounds.low, bounds.high] {
        bounds.add([x - AROUND_M, y - AROUND_M]);
        bounds.add([x + AROUND_M, y + AROUND_M]);
    }
    let view = View::fit(&bounds, PageFrame { x: 30.0, y: 20.0, width: 940.0, height: 440.0 });
    let mut picture = Picture::new(1000.0, 500.0, "The places of the survey", "Numbers are those of the steps");
    let within =
        |[x, y]: Point| (bounds.low[0]..=bounds.high[0]).contains(&x) && (bounds.low[1]..=bounds.high[1]).contains(&y);
    // The larger roads show where the places are; all roads of a town would hide it.
    for edge in network.edges.iter().filter(|edge| network.road(edge).class <= RoadClass::Tertiary) {
        let line: Vec<Point> = network.positions(edge).map(|at| offset_m(centre, at)).collect();
        if edge.direction == Direction::Forward && line.iter().all(|&at| within(at)) {
            picture.polyline(&view.all(&line), Style::line(palette::PALE, 1.0));
        }
    }
    pin_down(&mut picture, &view, &pins);
    scale_bar(&mut picture, &view, [40.0, 480.0], 160.0);
    picture.finish()
}

/// Numbered pins. Those of one place stand side by side.
pub(super) fn pin_down(picture: &mut Picture, view: &View, pins: &[(usize, Point)]) {
    for (i, (number, pin)) in pins.iter().enumerate() {
        let before = pins[..i].iter().filter(|(_, other)| other == pin).count();
        let [x, y] = view.at(*pin);
        let at = [x + 21.0 * before as f64, y];
        picture.circle(at, 10.0, Style::area(palette::VERMILLION).outlined(palette::PAPER, 1.5));
        let text = TextStyle::size(11.0).bold().anchored(Anchor::Middle).coloured(palette::PAPER);
        picture.text([at[0], at[1] + 4.0], &format!("{number}"), text);
    }
}
