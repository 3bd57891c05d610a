//! Where a route uses more than its own lane: bars along the route, upwards for the left side and downwards for the right, as far as bodies
//! stand over the line at most.

use super::palette::{self, Colour};
use super::style::{Anchor, Style, TextStyle};
use super::svg::Picture;
use super::{Chart, PageFrame, Scale};
use crate::network::Network;
use crate::osm::facts::Policy;
use crate::stet::Side;
use netcert_route::{Route, StripUse};

/// Least width of a bar, page units: a short stretch of a long route must be seen.
const LEAST_WIDTH: f64 = 3.0;
/// The number of a bar is left out if it is closer than this to the previous number, page units.
const NUMBER_GAP: f64 = 46.0;

/// The colour of a strip. Strips differ in their outline, too.
fn colour(strip: Policy) -> Colour {
    if strip == Policy::Carriageway { palette::ORANGE } else { palette::SKY }
}

fn style(strip: Policy) -> Style {
    let area = Style::area(colour(strip));
    if strip == Policy::Carriageway { area.outlined(palette::INK, 1.0) } else { area }
}

/// Draws the bars of a route that uses more than its own lane.
pub(super) fn uses(picture: &mut Picture, network: &Network, route: &Route, frame: PageFrame) {
    let most_m = route.uses.iter().map(|used| used.beyond_m).fold(0.5, f64::max);
    let chart = Chart {
        frame,
        x: Scale::new(0.0, route.length_m / 1000.0, "km along the route").ticks(10),
        y: Scale::new(-1.15 * most_m, 1.15 * most_m, "over the line, m").ticks(4),
    };
    chart.axes(picture);
    chart.level(picture, 0.0, Style::line(palette::INK, 1.2));
    let mut last = f64::NEG_INFINITY;
    for used in &route.uses {
        let (bar, end) = bar(&chart, used);
        picture.rect(bar, 0.0, style(used.strip));
        let middle = bar.x + 0.5 * bar.width;
        if middle - last >= NUMBER_GAP {
            last = middle;
            let y = if used.side == Side::Left { end - 4.0 } else { end + 13.0 };
            let number = format!("{:.2} m", (100.0 * used.beyond_m).ceil() / 100.0);
            picture.text([middle, y], &number, TextStyle::size(11.5).haloed().anchored(Anchor::Middle));
        }
    }
    legend(picture, network, route, frame);
}

/// A bar and the height on the page at which it ends.
fn bar(chart: &Chart, used: &StripUse) -> (PageFrame, f64) {
    let beyond_m = if used.side == Side::Left { used.beyond_m } else { -used.beyond_m };
    let ([from, end], [to, line]) = (chart.at(used.from_m / 1000.0, beyond_m), chart.at(used.to_m / 1000.0, 0.0));
    (PageFrame { x: from, y: end.min(line), width: (to - from).max(LEAST_WIDTH), height: (end - line).abs() }, end)
}

fn legend(picture: &mut Picture, network: &Network, route: &Route, frame: PageFrame) {
    let small = TextStyle::size(12.5).haloed();
    let y = frame.y + frame.height + 38.0;
    let mut x = frame.x;
    let mut named: Vec<&str> = Vec::new();
    for used in &route.uses {
        let words = used.words(network);
        if named.contains(&words) {
            continue;
        }
        named.push(words);
        picture.rect(PageFrame { x, y: y - 10.0, width: 16.0, height: 10.0 }, 0.0, style(used.strip));
        picture.text([x + 22.0, y], words, small);
        x += 40.0 + 7.0 * words.len() as f64;
    }
    picture.text(
        [frame.x + frame.width, y],
        "up: on the left, down: on the right; at most",
        small.anchored(Anchor::End),
    );
}

/// What holding traffic back takes on a route, or nothing if it stays in the lanes of its direction.
pub(super) fn oncoming_words(route: &Route) -> Option<String> {
    let (places, metres) = route.beyond_all_lanes();
    let at = if places == 1 { "place" } else { "places" };
    (places > 0).then(|| {
        format!("beyond all lanes of its direction for {metres:.0} m at {places} {at}: oncoming traffic must be held back there")
    })
}
