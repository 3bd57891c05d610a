//! A decision sheet: one page to file with a case. It says yes, no, or yes under conditions for one vehicle on one way, what that rests on, and
//! has room for the decision of a person.
//!
//! The same answer gives the same bytes, so the sheet has no date of its own: whoever signs it writes one.

mod map;

use std::fmt::Write as _;

use super::lengths::Units;
use super::sheet::{SheetStyle, styled_head};
use super::svg::escaped;
use super::vehicle::vehicle as drawing;
use crate::network::{Network, destination_words};
use crate::osm::facts::Policy;
use crate::words::{Named as _, verdict_words};
use netcert_base::vehicle::Vehicle;
use netcert_base::verdict::{UnsafeReason, Verdict};
use netcert_route::{Answer, Conditional, LimitedStretch, Obstacle, Route, place, title};

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
    page += &case(fields, basis);
    page += &verdict(network, answer, outcome, units);
    match outcome {
        Outcome::OnlyIf(conditional) => page += &conditions(network, conditional, units),
        Outcome::No => page += &blocked(network, answer, units),
        Outcome::Yes(_) => {}
    }
    let _ = write!(page, "<h2>Map</h2>{}", map::map(network, answer, units));
    if let Some(route) = outcome.route() {
        page += &way(network, vehicle, route, outcome, units);
    }
    let _ = write!(page, "<h2>Vehicle</h2><div class=\"drawing\">{}</div>", drawing(vehicle));
    page += &rests_on(vehicle, basis, outcome);
    page += &to_sign();
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

fn case(fields: &CaseFields, basis: &DecisionBasis) -> String {
    let text = |field: &Option<String>| field.clone().unwrap_or_default();
    rows(&[
        ("Case", text(&fields.case)),
        ("Applicant", text(&fields.applicant)),
        ("Applicant's reference", text(&fields.reference)),
        (
            "Time of the journey",
            basis.at.clone().unwrap_or_else(|| "any: what is closed at some times is closed".to_owned()),
        ),
    ])
}

fn verdict(network: &Network, answer: &Answer, outcome: Outcome<'_>, units: Units) -> String {
    let (word, more) = match outcome {
        Outcome::Yes(route) => {
            ("Yes: certified", format!("One certificate covers the whole way. {}", oncoming(network, route, units)))
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
        Outcome::No => {
            let known = answer.obstacles.as_ref().map_or(0, Vec::len);
            let more = if known == 0 {
                "No roads that this vehicle may lawfully use lead there, as far as the map knows.".to_owned()
            } else {
                "On every way some place is forbidden to this vehicle, or it cannot be proved that the vehicle stays on the road. The fewest such \
                 places are below. That does not say that no driver could do it."
                    .to_owned()
            };
            ("No: not certified", more)
        }
    };
    format!("<h2>{word}</h2><p class=\"scope\">{} It is no permit.</p>", escaped(&more))
}

/// What other traffic has to know of a route.
fn oncoming(network: &Network, route: &Route, units: Units) -> String {
    let uses: Vec<_> = route.uses.iter().filter(|used| used.strip == Policy::Carriageway).collect();
    if uses.is_empty() {
        return "No oncoming lane is used.".to_owned();
    }
    let length_m: f64 = uses.iter().map(|used| used.to_m - used.from_m).sum();
    let places = if uses.len() == 1 { "place" } else { "places" };
    let of = uses.first().map_or("oncoming lane", |used| used.words(network));
    format!(
        "Beyond all lanes of its direction ({of}) for {} at {} {places}: oncoming traffic must be held back there.",
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
            "<tr><td>{number}</td><td>{}{attested}</td><td>{}</td><td class=\"fill\" contenteditable=\"true\"></td></tr>",
            escaped(&condition.title(network)),
            escaped(&super::sheet::wanted(condition, units)),
        );
    }
    page + "</tbody></table>"
}

fn blocked(network: &Network, answer: &Answer, units: Units) -> String {
    let mut page = String::new();
    let obstacles = answer.obstacles.as_deref().unwrap_or_default();
    if !obstacles.is_empty() {
        page += "<h2>What stands in the way</h2><table><thead><tr><th>No.</th><th>Where</th><th>Why</th><th>At least missing</th></tr></thead><tbody>";
        for (number, obstacle) in (1..).zip(obstacles) {
            let Obstacle { at, permit, missing_m, .. } = obstacle;
            let _ = write!(
                page,
                "<tr><td>{number}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                escaped(&title(network, *at)),
                escaped(&why(permit.verdict)),
                missing_m.map_or_else(String::new, |missing_m| units.at_least(missing_m)),
            );
        }
        page += "</tbody></table>";
    }
    if !answer.nothing_helps.is_empty() {
        let all = answer.nothing_helps.iter().map(|&at| {
            let where_ = place(network, at).map_or_else(String::new, |[lon, lat]| format!(" ({lat:.5}, {lon:.5})"));
            format!("<li>{}{where_}</li>", escaped(&title(network, at)))
        });
        let all: String = all.collect();
        let _ = write!(page, "<p>No kerb radius, width or paving that was tried opens these places:</p><ul>{all}</ul>");
    }
    page
}

/// Why a place stands in the way.
fn why(verdict: Verdict) -> String {
    match verdict {
        Verdict::Unsafe(UnsafeReason::Width) => "too narrow".to_owned(),
        Verdict::Unsafe(UnsafeReason::Articulation) => "a hinge would fold too far".to_owned(),
        Verdict::Unsafe(UnsafeReason::SteeringLock) => "it would have to steer more than it can".to_owned(),
        Verdict::Safe => "a road to a destination only, or narrow for a whole way".to_owned(),
        _ => {
            let (kind, reason) = verdict_words(verdict);
            format!("{kind}: {}", reason.replace('_', " "))
        }
    }
}

fn rests_on(vehicle: &Vehicle, basis: &DecisionBasis, outcome: Outcome<'_>) -> String {
    let strip = |policy: Policy| match policy {
        Policy::Lane => "its own lane",
        Policy::Direction => "all lanes of its direction",
        Policy::Carriageway => "the whole carriageway",
    };
    let [own, widest] = basis.strips;
    let strips = if widest > own {
        format!("{}, and where that is not enough up to {}", strip(own), strip(widest))
    } else {
        strip(own).to_owned()
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
        ("Read by", format!("netcert {}", basis.read_by)),
    ];
    if let Some(route) = outcome.route() {
        let result = &route.certificate.result;
        let tolerance_m = result.shrink * vehicle.tracking_tolerance_m;
        all.push(("Steered within", format!("±{tolerance_m:.3} m of the planned path by the steer axle")));
    }
    format!(
        "<h2>What this rests on</h2>{}<p class=\"scope\">Within the stated model, widths and error bounds. Nothing is said of heights, weights \
         and bridges beyond the map, of grounding, roll-over, other traffic, ice or works, and of places where a vehicle is loaded or turns in \
         several moves.</p>",
        rows(&all)
    )
}

fn to_sign() -> String {
    format!(
        "<h2>Decision</h2><p>☐ granted &nbsp; ☐ granted under the conditions above &nbsp; ☐ refused</p>{}",
        rows(&[
            ("Remarks", String::new()),
            ("Valid from, until", String::new()),
            ("Date", String::new()),
            ("Name, signature, stamp", String::new()),
        ])
    )
}
