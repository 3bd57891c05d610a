//! Writes answers as GPX 1.1 for navigation devices: each way as a track, and as waypoints the places that were asked for, where a way
//! begins to use more than its own lane, what its conditions are, and what stands in the way.
//!
//! <https://www.topografix.com/GPX/1/1/>

use std::io;

use geo::{LineString, Simplify as _};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use super::plan::Answer;
use super::route::{LimitedStretch, Route};
use super::strip_use::StripUse;
use super::title::{place, title};
use crate::corridor::FrameError;
use crate::network::Network;
use crate::osm::rounded;
use crate::stet::Model;
use crate::words::Named as _;

/// Points of a track that lie this close to the line between others are left out, metres. Devices keep some thousand points.
const TOLERANCE_M: f64 = 0.25;

/// What a GPX file says beside the ways.
#[derive(Debug, Clone, Copy)]
pub struct GpxFacts<'a> {
    /// What `certified` means: model, policy, widths.
    pub scope: &'a str,
    /// The time of the map's data, as RFC 3339.
    pub map_time: Option<&'a str>,
}

/// Why there is no file.
#[derive(Debug, thiserror::Error)]
pub enum GpxError {
    /// Positions cannot be converted from a route's frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The writer of XML failed.
    #[error("the file cannot be made: {0}")]
    Xml(#[from] io::Error),
}

struct Waypoint {
    at: [f64; 2],
    name: String,
    /// Empty if there is nothing to say.
    text: String,
}

struct Track {
    name: String,
    text: String,
    line: Vec<[f64; 2]>,
}

/// The whole answer as GPX.
///
/// # Errors
/// Positions cannot be converted from a route's frame.
pub fn gpx(network: &Network, model: &Model, answer: &Answer, facts: GpxFacts<'_>) -> Result<String, GpxError> {
    let (waypoints, tracks) = (waypoints(network, model, answer)?, tracks(network, model, answer, facts)?);
    let none =
        if answer.routes.is_empty() { "No way between these places is certified for this vehicle. " } else { "" };
    let about = format!("{none}{}", facts.scope);
    let mut out = Writer::new_with_indent(Vec::new(), b' ', 1);
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let root = out.create_element("gpx").with_attributes([
        ("version", "1.1"),
        ("creator", concat!("netcert ", env!("CARGO_PKG_VERSION"))),
        ("xmlns", "http://www.topografix.com/GPX/1/1"),
    ]);
    root.write_inner_content(|out| {
        metadata(out, model, &about, facts)?;
        waypoints.iter().try_for_each(|waypoint| waypoint.write(out))?;
        tracks.iter().try_for_each(|track| track.write(out))
    })?;
    let mut text = String::from_utf8_lossy(&out.into_inner()).into_owned();
    text.push('\n');
    Ok(text)
}

fn metadata(out: &mut Writer<Vec<u8>>, model: &Model, about: &str, facts: GpxFacts<'_>) -> io::Result<()> {
    out.create_element("metadata").write_inner_content(|out| {
        element(out, "name", &format!("netcert: {} {}", model.vehicle.id, model.vehicle.name))?;
        element(out, "desc", about)?;
        let rights = out.create_element("copyright").with_attribute(("author", "OpenStreetMap contributors"));
        rights.write_inner_content(|out| element(out, "license", "https://opendatacommons.org/licenses/odbl/1-0/"))?;
        facts.map_time.map_or(Ok(()), |time| element(out, "time", time))
    })?;
    Ok(())
}

impl Waypoint {
    fn write(&self, out: &mut Writer<Vec<u8>>) -> io::Result<()> {
        point(out, "wpt", self.at, |out| {
            element(out, "name", &self.name)?;
            if self.text.is_empty() { Ok(()) } else { element(out, "desc", &self.text) }
        })
    }
}

impl Track {
    fn write(&self, out: &mut Writer<Vec<u8>>) -> io::Result<()> {
        out.create_element("trk").write_inner_content(|out| {
            element(out, "name", &self.name)?;
            element(out, "desc", &self.text)?;
            out.create_element("trkseg")
                .write_inner_content(|out| self.line.iter().try_for_each(|&at| point(out, "trkpt", at, |_| Ok(()))))?;
            Ok(())
        })?;
        Ok(())
    }
}

/// A point with what is said of it.
fn point(
    out: &mut Writer<Vec<u8>>,
    kind: &str,
    [lon, lat]: [f64; 2],
    inner: impl FnOnce(&mut Writer<Vec<u8>>) -> io::Result<()>,
) -> io::Result<()> {
    let (lat, lon) = (lat.to_string(), lon.to_string());
    out.create_element(kind).with_attributes([("lat", &*lat), ("lon", &*lon)]).write_inner_content(inner)?;
    Ok(())
}

/// An element with a text. XML has no control characters but tabs and ends of lines.
fn element(out: &mut Writer<Vec<u8>>, name: &str, text: &str) -> io::Result<()> {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    out.create_element(name).write_text_content(BytesText::new(&plain))?;
    Ok(())
}

fn waypoints(network: &Network, model: &Model, answer: &Answer) -> Result<Vec<Waypoint>, FrameError> {
    let last = answer.snapped.len().saturating_sub(1);
    let asked = answer.snapped.iter().enumerate().map(|(i, snapped)| Waypoint {
        at: rounded([snapped.position.lon, snapped.position.lat]),
        name: if i == 0 {
            "Start".to_owned()
        } else if i == last {
            "End".to_owned()
        } else {
            format!("Stop {i}")
        },
        text: String::new(),
    });
    let mut all: Vec<Waypoint> = asked.collect();
    let conditional = answer.conditional.as_ref();
    let ways: Vec<&Route> = answer.routes.iter().chain(conditional.map(|conditional| &conditional.route)).collect();
    for (number, way) in (1..).zip(&ways) {
        let which = if ways.len() > 1 { format!("Way {number} uses") } else { "Uses".to_owned() };
        for used in &way.uses {
            all.push(Waypoint {
                at: at(way, used.from_m)?,
                name: format!("{which} {}", used.words(network)),
                text: beyond(used),
            });
        }
    }
    let conditions = conditional.map_or(&[][..], |conditional| &conditional.conditions);
    for (number, condition) in (1..).zip(conditions) {
        let Some(at) = condition.place(network) else { continue };
        let attested = condition.attested().map_or_else(String::new, |by| format!("; attested: {by}"));
        let text = format!("{}: {}{attested}", condition.title(network), condition.words());
        all.push(Waypoint { at, name: format!("Check {number}"), text });
    }
    for obstacle in answer.obstacles.iter().flatten() {
        let Some(at) = place(network, obstacle.at) else { continue };
        let (verdict, reason) = obstacle.words(network, &model.vehicle);
        let why = if reason.is_empty() { verdict.to_owned() } else { format!("{verdict}: {reason}") };
        let text = format!("{}, {why}", title(network, obstacle.at));
        all.push(Waypoint { at, name: "Blocked".to_owned(), text });
    }
    for &closed in &answer.nothing_helps {
        let Some(at) = place(network, closed) else { continue };
        let text = format!("{}: no measurement that was tried opens it", title(network, closed));
        all.push(Waypoint { at, name: "Closed".to_owned(), text });
    }
    Ok(all)
}

/// How long a stretch beyond the own lane is, and how far beyond at most, rounded up to centimetres.
fn beyond(used: &StripUse) -> String {
    let most_m = (used.beyond_m * 100.0).ceil() / 100.0;
    format!(
        "for {:.0} m, at most {most_m:.2} m over the line on the {} side",
        (used.to_m - used.from_m).ceil(),
        used.side.name()
    )
}

/// The ways as tracks. A name says whether the way is certified, and the text what that holds for: devices show no more of a file.
fn tracks(network: &Network, model: &Model, answer: &Answer, facts: GpxFacts<'_>) -> Result<Vec<Track>, FrameError> {
    let id = &model.vehicle.id;
    let whole = |route: &Route, first: String| {
        let limited = limited(network, model, route);
        format!(
            "{first}{:.1} km; widest strip: {}. {limited}{}",
            route.length_m / 1000.0,
            route.rung().name(),
            facts.scope
        )
    };
    let certified = answer.routes.iter().enumerate().map(|(i, route)| {
        let which = if i == 0 { "certified way".to_owned() } else { format!("certified way {}", i + 1) };
        (format!("{id}: {which}"), whole(route, "certified, ".to_owned()), route)
    });
    let conditional = answer.conditional.as_ref().map(|known| {
        let words = (1..)
            .zip(&known.conditions)
            .map(|(number, condition)| format!("{number}. {}: {}", condition.title(network), condition.words()));
        let more = if known.suffices { "" } else { "Even then the way may ask for more. " };
        let first =
            format!("Certified only if all of this is so on site: {}. {more}", words.collect::<Vec<_>>().join("; "));
        (format!("{id}: way under conditions, NOT certified"), whole(&known.route, first), &known.route)
    });
    let track = |(name, text, route)| Ok(Track { name, text, line: line(route)? });
    certified.chain(conditional).map(track).collect()
}

/// Where the way is open at its ends only, or at some times only, as sentences with an end.
fn limited(network: &Network, model: &Model, route: &Route) -> String {
    let all = [
        ("Open to a destination there only", route.destination_only(network, &model.vehicle)),
        ("Closed at some times", route.only_at_times(network, &model.vehicle)),
    ];
    let words = |(what, stretches): (&str, Vec<LimitedStretch>)| {
        let each = stretches.iter().map(|stretch| format!("{} ({})", stretch.title, stretch.tag));
        let each: Vec<String> = each.collect();
        if each.is_empty() { String::new() } else { format!("{what}: {}. ", each.join(", ")) }
    };
    all.into_iter().map(words).collect()
}

/// The planned path of the steer axle, degrees.
fn line(route: &Route) -> Result<Vec<[f64; 2]>, FrameError> {
    let corridor = &route.path.corridor;
    let whole: LineString = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| (x, y)).collect();
    let metres: Vec<[f64; 2]> = whole.simplify(TOLERANCE_M).coords().map(|at| [at.x, at.y]).collect();
    Ok(route.path.frame.inverse(&metres)?.into_iter().map(rounded).collect())
}

/// The place so many metres from the beginning, degrees.
fn at(route: &Route, metres: f64) -> Result<[f64; 2], FrameError> {
    let corridor = &route.path.corridor;
    let station = ((metres / corridor.spacing_m).round() as usize).min(corridor.len().saturating_sub(1));
    let degrees = route.path.frame.inverse(&[[corridor.x[station], corridor.y[station]]])?;
    Ok(rounded(degrees.first().copied().unwrap_or_default()))
}
