//! A decision sheet: one page to file with a case. It says whether one vehicle is certified on one way, or under which conditions, what that rests
//! on, and has room for the decision of a person.
//!
//! The same answer gives the same bytes, so the sheet has no date of its own: whoever signs it writes one.

mod map;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::lengths::Units;
use super::sheet::{SheetStyle, styled_head};
use super::svg::escaped;
use super::vehicle::vehicle as drawing;
use crate::network::{Network, destination_words};
use crate::osm::facts::Policy;
use crate::words::Named as _;
use netcert_base::vehicle::Vehicle;
use netcert_route::{
    Answer, Conditional, Conditions, LimitedStretch, Obstacle, PartKind, Position, Route, Snapped, place, title,
};

/// More than this is missing where no bound holds, metres.
const MOST_MISSING_M: f64 = 100.0;

/// What an office writes on a decision sheet. What is `None` is left blank, to be filled in.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CaseFields {
    /// Number of the case.
    pub case: Option<String>,
    /// Who applies.
    pub applicant: Option<String>,
    /// The applicant's own reference.
    pub reference: Option<String>,
}

/// What an answer rests on, for a decision sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DecisionBasis {
    /// Name of the extract.
    pub input_name: String,
    /// The extract's own time stamp.
    pub map_time: Option<String>,
    /// BLAKE3 of the extract.
    pub input_blake3: Option<String>,
    /// The version of the program that read the extract.
    pub read_by: String,
    /// How many measurements the register has.
    pub measurements: usize,
    /// The time of the journey, local time. `None`: of all times together.
    pub at: Option<String>,
    /// Where a way might have conditions.
    pub conditions: Conditions,
    /// The strip that the vehicle may use, and the widest one if the way may climb.
    pub strips: [Policy; 2],
}

/// The answer in one word.
#[derive(Debug, Clone, Copy)]
enum Outcome<'a> {
    Yes(&'a Route),
    OnlyIf(&'a Conditional),
    No,
}

/// The decision sheet of an answer, as a whole HTML document.
#[must_use]
pub fn decision(
    network: &Network,
    vehicle: &Vehicle,
    answer: &Answer,
    fields: &CaseFields,
    basis: &DecisionBasis,
    units: Units,
    style: SheetStyle<'_>,
) -> String {
    let outcome = match (answer.routes.first(), &answer.conditional) {
        (Some(route), _) => Outcome::Yes(route),
        (None, Some(conditional)) => Outcome::OnlyIf(conditional),
        (None, None) => Outcome::No,
    };
    let mut page = styled_head(&format!("Decision on a route for {}", vehicle.id), style);
    page += &case(network, answer, fields, basis);
    page += &verdict(network, answer, outcome, basis, units);
    match outcome {
        Outcome::OnlyIf(conditional) => page += &conditions(network, conditional, units),
        Outcome::No => page += &blocked(network, vehicle, answer, units),
        Outcome::Yes(_) => {}
    }
    let _ = write!(page, "<h2>Map</h2>{}", map::map(network, answer, units));
    if let Some(route) = outcome.route() {
        page += &way(network, vehicle, route, outcome, units);
    }
    let _ = write!(page, "<h2>Vehicle</h2><div class=\"drawing\">{}</div>", drawing(vehicle));
    page += &rests_on(vehicle, basis, outcome, units);
    page += &to_sign(outcome);
    page += "<p>Map data © OpenStreetMap contributors, Open Database License 1.0 (openstreetmap.org/copyright), or as the extract's own \
             licence says.</p></body></html>\n";
    page
}

impl<'a> Outcome<'a> {
    fn route(self) -> Option<&'a Route> {
        match self {
            Self::Yes(route) => Some(route),
            Self::OnlyIf(conditional) => Some(&conditional.route),
            Self::No => None,
        }
    }
}

/// Rows of a table with two columns. What is empty can be typed in a browser.
fn rows(all: &[(&str, String)]) -> String {
    let row = |(name, text): &(&str, String)| match text.as_str() {
        "" => format!("<tr><th>{name}</th><td class=\"fill\" contenteditable=\"true\"></td></tr>"),
        text => format!("<tr><th>{name}</th><td>{}</td></tr>", escaped(text)),
    };
    format!("<table><tbody>{}</tbody></table>", all.iter().map(row).collect::<String>())
}

fn case(network: &Network, answer: &Answer, fields: &CaseFields, basis: &DecisionBasis) -> String {
    let text = |field: &Option<String>| field.clone().unwrap_or_default();
    let mut all = vec![
        ("Case", text(&fields.case)),
        ("Applicant", text(&fields.applicant)),
        ("Applicant's reference", text(&fields.reference)),
    ];
    let places = snapped(answer);
    for (number, place) in places.iter().enumerate() {
        let name = match number {
            0 => "From",
            _ if number + 1 == places.len() => "To",
            _ => "Over",
        };
        let Position { lon, lat } = place.position;
        let road =
            place.on.first().map_or_else(String::new, |on| format!(", {}", title(network, PartKind::Edge(on.edge))));
        all.push((name, format!("latitude {lat:.5}, longitude {lon:.5}{road}")));
    }
    all.push((
        "Time of the journey",
        basis.at.clone().unwrap_or_else(|| "any: what is closed at some times is closed".to_owned()),
    ));
    rows(&all)
}

/// The places of the question, moved to the road.
fn snapped(answer: &Answer) -> &[Snapped] {
    match &answer.conditional {
        Some(conditional) if answer.snapped.is_empty() => &conditional.snapped,
        _ => &answer.snapped,
    }
}

/// A position as a line of its own in a table.
fn at(place: Option<[f64; 2]>) -> String {
    place.map_or_else(String::new, |[lon, lat]| format!("<br>latitude {lat:.5}, longitude {lon:.5}"))
}

fn verdict(network: &Network, answer: &Answer, outcome: Outcome<'_>, basis: &DecisionBasis, units: Units) -> String {
    let (word, more) = match outcome {
        Outcome::Yes(route) => {
            ("Certified on the whole way", format!("One certificate covers it. {}", oncoming(network, route, units)))
        }
        Outcome::OnlyIf(conditional) => {
            let count = conditional.conditions.len();
            let attested = conditional.conditions.iter().filter(|one| one.attested_by.is_some()).count();
            let of = match attested {
                0 => String::new(),
                _ => format!(
                    " {attested} of these places are attested by a sign or by the register, which proves nothing."
                ),
            };
            let (conditions, hold) = if count == 1 { ("condition", "holds") } else { ("conditions", "hold") };
            (
                "Only under conditions: not certified",
                format!("The way would be certified if {count} {conditions} {hold} on site. Nothing here says so.{of}"),
            )
        }
        Outcome::No => ("Not certified", not_certified(answer, basis)),
    };
    format!("<h2>{word}</h2><p class=\"scope\">{} It is no permit.</p>", escaped(&more))
}

/// What was not found, and what was not looked for.
fn not_certified(answer: &Answer, basis: &DecisionBasis) -> String {
    if answer.obstacles.as_ref().is_none_or(Vec::is_empty) {
        return "No roads lead there that this vehicle may lawfully use, as far as the map knows.".to_owned();
    }
    let searched = if answer.gave_up {
        "The search ended before all ways were tried. On those that were tried, "
    } else {
        "On every way "
    };
    let conditions = match (basis.conditions, answer.conditions_cut_short) {
        (Conditions::Nowhere, _) => " Nobody asked whether measurements would help.",
        (_, true) => " The search for measurements that would help was ended before it was through.",
        (Conditions::WhereAttested, false) => {
            " Measurements were looked for only where a sign or the register attests the vehicle. None were found that would help."
        }
        (Conditions::Anywhere, false) => " No measurements were found that would help.",
    };
    format!(
        "{searched}some place is forbidden to this vehicle, or it cannot be proved that the vehicle stays on the road there. The cheapest set of \
         such places is below. That does not say that no driver could do it.{conditions}"
    )
}

/// What other traffic has to know of a route. Inside crossings there are no lanes.
fn oncoming(network: &Network, route: &Route, units: Units) -> String {
    let uses: Vec<_> = route.uses.iter().filter(|used| used.strip == Policy::Carriageway).collect();
    if uses.is_empty() {
        return "Outside crossings no oncoming lane is used.".to_owned();
    }
    let length_m: f64 = uses.iter().map(|used| used.to_m - used.from_m).sum();
    let places = if uses.len() == 1 { "place" } else { "places" };
    let what: BTreeSet<&str> = uses.iter().map(|used| used.words(network)).collect();
    format!(
        "Beyond all lanes of its direction ({}) for {} at {} {places}: oncoming traffic must be held back there.",
        what.into_iter().collect::<Vec<_>>().join(", "),
        units.along(length_m),
        uses.len()
    )
}

fn way(network: &Network, vehicle: &Vehicle, route: &Route, outcome: Outcome<'_>, units: Units) -> String {
    let under = if let Outcome::OnlyIf(_) = outcome { " under the conditions" } else { "" };
    let rsc = route.certificate.result.rsc_m.map_or("unknown".to_owned(), |rsc_m| units.at_most(rsc_m));
    let mut page = format!(
        "<h2>Way</h2><p>{}, about {:.0} min. Where it is tightest{under}, {rsc} are to spare, all error bounds deducted.</p>\
         <table><thead><tr><th>From</th><th>Length</th><th>Road</th><th>Room to spare{under}</th></tr></thead><tbody>",
        units.route(route.length_m),
        (route.time_s / 60.0).ceil()
    );
    for (part, road) in route.titled_parts(network) {
        let turn = if part.kind.is_turn() { "turn: " } else { "" };
        let _ = write!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{turn}{}</td><td>{}</td></tr>",
            units.route(part.from_m),
            units.along(part.to_m - part.from_m),
            escaped(&road),
            part.rsc_m.map_or_else(String::new, |rsc_m| units.at_most(rsc_m)),
        );
    }
    page += "</tbody></table>";
    if !route.uses.is_empty() {
        page += "<h3>Beyond its own lane</h3><table><thead><tr><th>From</th><th>Length</th><th>What it uses</th><th>At most beyond</th>\
                 <th>Road</th></tr></thead><tbody>";
        for used in &route.uses {
            let _ = write!(
                page,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{} {}</td><td>{}</td></tr>",
                units.route(used.from_m),
                units.along(used.to_m - used.from_m),
                used.words(network),
                units.at_least((used.beyond_m * 100.0).ceil() / 100.0),
                used.side.name(),
                escaped(&title(network, used.at)),
            );
        }
        page += "</tbody></table>";
    }
    let stretches = |what: &str, all: &[LimitedStretch]| -> String {
        let one = |stretch: &LimitedStretch| {
            let (road, tag) = (escaped(&stretch.title), destination_words(&stretch.tag));
            format!("<p>{what}: {road} from {} ({}).</p>", units.route(stretch.from_m), escaped(&tag))
        };
        all.iter().map(one).collect()
    };
    page += &stretches("Only for a journey that begins or ends there", &route.destination_only(network, vehicle));
    page += &stretches("Closed to the vehicle at other times", &route.only_at_times(network, vehicle));
    page
}

fn conditions(network: &Network, conditional: &Conditional, units: Units) -> String {
    let mut page =
        "<h2>What would have to be so</h2><table><thead><tr><th>No.</th><th>Where</th><th>What has to be so</th>\
                    <th>So on site?</th></tr></thead><tbody>"
            .to_owned();
    for (number, condition) in (1..).zip(&conditional.conditions) {
        let attested = condition.attested().map_or_else(String::new, |by| format!("<br>attested: {}", escaped(&by)));
        let _ = write!(
            page,
            "<tr><td>{number}</td><td>{}{}{attested}</td><td>{}</td><td class=\"fill\" contenteditable=\"true\"></td></tr>",
            escaped(&condition.title(network)),
            at(condition.place(network)),
            escaped(&super::sheet::wanted(condition, units)),
        );
    }
    page + "</tbody></table>"
}

fn blocked(network: &Network, vehicle: &Vehicle, answer: &Answer, units: Units) -> String {
    let mut page = String::new();
    let obstacles = answer.obstacles.as_deref().unwrap_or_default();
    if !obstacles.is_empty() {
        page += "<h2>What stands in the way</h2><table><thead><tr><th>No.</th><th>Where</th><th>Why</th><th>Missing</th></tr></thead><tbody>";
        for (number, obstacle) in (1..).zip(obstacles) {
            let _ = write!(
                page,
                "<tr><td>{number}</td><td>{}{}</td><td>{}</td><td>{}</td></tr>",
                escaped(&title(network, obstacle.at)),
                at(place(network, obstacle.at)),
                escaped(&why(network, vehicle, obstacle)),
                missing(obstacle, units),
            );
        }
        page += "</tbody></table>";
    }
    if !answer.nothing_helps.is_empty() {
        let one = |&part: &PartKind| format!("<li>{}{}</li>", escaped(&title(network, part)), at(place(network, part)));
        let all: String = answer.nothing_helps.iter().map(one).collect();
        let _ = write!(page, "<p>No kerb radius, width or paving that was tried opens these places:</p><ul>{all}</ul>");
    }
    page
}

/// Why a place stands in the way, in the words of the command line.
fn why(network: &Network, vehicle: &Vehicle, obstacle: &Obstacle) -> String {
    if let Some(tag) = obstacle.tag(network, vehicle) {
        return format!("open to a destination only ({})", destination_words(&tag));
    }
    let (verdict, reason) = obstacle.words(network, vehicle);
    let verdict = match verdict {
        "unsafe" => "not certified",
        "refuted" => "passes by itself, and not as part of a whole way",
        other => other,
    };
    if reason.is_empty() { verdict.to_owned() } else { format!("{verdict}: {}", reason.replace('_', " ")) }
}

/// What is missing, if it is a matter of metres. At a turn it is at least that.
fn missing(obstacle: &Obstacle, units: Units) -> String {
    match obstacle.missing_m.filter(|missing_m| *missing_m < MOST_MISSING_M) {
        Some(missing_m) if obstacle.at.is_turn() => format!("at least {}", units.at_most(missing_m)),
        Some(missing_m) => units.at_least(missing_m),
        None => String::new(),
    }
}

fn rests_on(vehicle: &Vehicle, basis: &DecisionBasis, outcome: Outcome<'_>, units: Units) -> String {
    let [own, widest] = basis.strips;
    let strips = if widest > own {
        format!("{}, and where that is not enough up to {}", own.words(), widest.words())
    } else {
        own.words().to_owned()
    };
    let or_none = |text: &Option<String>| text.clone().unwrap_or_else(|| "not given".to_owned());
    let measured = match basis.measurements {
        0 => "none: widths and kerbs as the map or assumptions have them".to_owned(),
        many => format!("{many} in the register; else widths and kerbs as the map or assumptions have them"),
    };
    let mut all = vec![
        ("Vehicle", format!("{} ({}), as drawn above", vehicle.name, vehicle.id)),
        ("Strip", strips),
        ("Map", basis.input_name.clone()),
        ("Date of the map", or_none(&basis.map_time)),
        ("BLAKE3 of the map", or_none(&basis.input_blake3)),
        ("Measurements", measured),
        ("Map read by", format!("netcert {}", basis.read_by)),
    ];
    if let Some(route) = outcome.route() {
        let result = &route.certificate.result;
        let tolerance_m = result.shrink * vehicle.tracking_tolerance_m;
        all.push((
            "Steered within",
            format!("{} to either side of the planned path by the steer axle", units.at_most(tolerance_m)),
        ));
    }
    format!(
        "<h2>What this rests on</h2>{}<p class=\"scope\">Within the stated model, widths and error bounds. Nothing is said of heights, weights \
         and bridges beyond the map, of grounding, roll-over, other traffic, ice or works, and of places where a vehicle is loaded or turns in \
         several moves.</p>",
        rows(&all)
    )
}

/// Room for the decision of the office. The boxes fit the answer.
fn to_sign(outcome: Outcome<'_>) -> String {
    let boxes = match outcome {
        Outcome::Yes(_) => "☐ granted &nbsp; ☐ granted with conditions of the office &nbsp; ☐ refused",
        Outcome::OnlyIf(_) => {
            "☐ granted, all conditions above were found to hold &nbsp; ☐ to be looked at again &nbsp; ☐ refused"
        }
        Outcome::No => "☐ refused &nbsp; ☐ to be looked at again",
    };
    format!(
        "<h2>Decision of the office</h2><p>{boxes}</p>{}<p>The decision is that of the office. The answer above is no permit.</p>",
        rows(&[
            ("Remarks", String::new()),
            ("Valid from, until", String::new()),
            ("Date", String::new()),
            ("Name, signature, stamp", String::new()),
        ])
    )
}
