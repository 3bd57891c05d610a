//! The answer of `netcert route` as text: certified routes, a route under conditions, or what blocks.

use std::collections::BTreeMap;
use std::io::Write;

use netcert::network::{Network, PassageKind, destination_words};
use netcert::route::{self, Answer, Comparison, Conditional, LimitedStretch, PartKind, Route, UsePlace};
use netcert::words::Named;

use crate::cli::database::routing::RoutingInputs;
use crate::cli::output::table::Table;
use crate::cli::output::{printable, relative, wrapped};

/// Tells an answer, without its scope.
pub(super) fn tell(
    out: &mut dyn Write,
    inputs: &RoutingInputs,
    answer: &Answer,
    compared: Option<&Comparison>,
) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    for (number, found) in answer.routes.iter().enumerate() {
        let which = if number == 0 { "a certified route" } else { "another one" };
        writeln!(
            out,
            "{} {}: {which}, {:.1} km, about {:.0} min\n",
            vehicle.id,
            vehicle.name,
            found.length_m / 1000.0,
            (found.time_s / 60.0).ceil()
        )?;
        numbers(out, inputs, found)?;
        if let Some(compared) = compared {
            let relative = compared.routes.get(number).copied().unwrap_or_default();
            relative::tell(out, &compared.relative_to, relative)?;
        }
        writeln!(out)?;
        parts(out, network, found)?;
        writeln!(out)?;
        uses(out, network, found)?;
        limited(out, inputs, found)?;
    }
    if answer.routes.is_empty() {
        writeln!(out, "{} {}: no certified route\n", vehicle.id, vehicle.name)?;
        if let Some(conditional) = &answer.conditional {
            under_conditions(out, inputs, conditional)?;
        }
        if answer.conditional.is_none() || answer.obstacles.is_some() {
            blocked(out, inputs, answer, compared)?;
        }
        nothing_helps(out, network, answer)?;
    }
    for refutation in &answer.refuted {
        let why = match (&refutation.result, &refutation.assembly) {
            (Some((rsc_m, _)), _) if *rsc_m < 0.0 => format!("{:.2} m missing", -rsc_m),
            (Some(_), _) => "a hinge or the steering lock would not do".to_owned(),
            (None, Some(error)) => error.to_string(),
            (None, None) => "no bound holds for the vehicle there".to_owned(),
        };
        let at = printable(&route::title(network, refutation.at));
        writeln!(out, "{}", wrapped(&format!("Tried and refuted as a whole, at {at}: {why}."), "  "))?;
    }
    Ok(())
}

/// Tells who says of the places of conditions that the vehicle goes there all the same.
fn attested(out: &mut dyn Write, conditional: &Conditional) -> std::io::Result<()> {
    let mut of: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (number, condition) in (1..).zip(&conditional.conditions) {
        condition.attested().into_iter().for_each(|by| of.entry(by).or_default().push(number));
    }
    if of.is_empty() {
        return Ok(());
    }
    for (by, numbers) in of {
        let numbers: Vec<String> = numbers.iter().map(usize::to_string).collect();
        writeln!(out, "{}", wrapped(&format!("Attested, {}: {by}.", numbers.join(", ")), "  "))?;
    }
    let told = match conditional.attested() {
        true => {
            "Every place of a condition is attested. Attested is not proved: the law or a person says that such a vehicle goes there, and \
             nothing here says how."
        }
        false => {
            "Attested is not proved: the law or a person says that such a vehicle goes there, and nothing here says how."
        }
    };
    writeln!(out, "{}\n", wrapped(told, "  "))
}

/// Tells a route that is certified only under conditions.
fn under_conditions(out: &mut dyn Write, inputs: &RoutingInputs, conditional: &Conditional) -> std::io::Result<()> {
    let (network, found) = (&inputs.roads.network, &conditional.route);
    let count = conditional.conditions.len();
    let (conditions, hold) = if count == 1 { ("condition", "holds") } else { ("conditions", "hold") };
    let minutes = (found.time_s / 60.0).ceil();
    writeln!(
        out,
        "  A route if {count} {conditions} {hold}, {:.1} km, about {minutes:.0} min\n",
        found.length_m / 1000.0
    )?;
    let mut table = Table::new(&[">", "what has to be so", ">over", "at", "where"]);
    for (number, condition) in (1..).zip(&conditional.conditions) {
        let length_m = condition.length_m(network);
        table.row([
            number.to_string(),
            condition.words(),
            if length_m > 0.0 { format!("{length_m:.0} m") } else { String::new() },
            condition.place(network).map_or_else(String::new, |[lon, lat]| format!("{lon:.5},{lat:.5}")),
            printable(&condition.title(network)),
        ]);
    }
    table.write(out, "  ")?;
    writeln!(out)?;
    attested(out, conditional)?;
    numbers(out, inputs, found)?;
    writeln!(out)?;
    parts(out, network, found)?;
    writeln!(out)?;
    uses(out, network, found)?;
    limited(out, inputs, found)?;
    let told = "The numbers hold only if all of this is so on site. Nothing here says that it is: `netcert route --sheet` writes it \
                down to be checked, and `netcert evidence add` takes the measurements.";
    writeln!(out, "{}\n", wrapped(told, "  "))?;
    if !conditional.suffices {
        let told = "If all of it is measured exactly so, the route may still ask for more: another search than the one that looks at measured \
                    roads found it. Measure more room where there is some.";
        writeln!(out, "{}\n", wrapped(told, "  "))?;
    }
    Ok(())
}

fn numbers(out: &mut dyn Write, inputs: &RoutingInputs, found: &Route) -> std::io::Result<()> {
    let result = &found.certificate.result;
    let unit = inputs.driver.model.vehicle.units.get(result.limiting.unit).map_or("", |unit| &unit.name);
    let at = found.limiting().map_or_else(String::new, |at| route::title(&inputs.roads.network, at));
    if let Some(rsc_m) = result.rsc_m {
        writeln!(out, "  RSC          {rsc_m:>8.3} m  to spare where it is tightest, all error bounds deducted")?;
    }
    writeln!(
        out,
        "  tightest at  {:>8.2} km {} ({}, {} side)",
        found.limiting_m() / 1000.0,
        printable(&at),
        unit,
        result.limiting.side.name()
    )?;
    if let Some(margin_rad) = result.hinge_margin_rad {
        writeln!(out, "  hinge margin {:>8.1} °", margin_rad.to_degrees())?;
    }
    let tolerance_m = result.shrink * inputs.driver.model.vehicle.tracking_tolerance_m;
    writeln!(
        out,
        "  shrink       {:>8.3}    the steer axle must stay within {tolerance_m:.3} m of the plan",
        result.shrink
    )
}

/// Prints the parts of the route. Consecutive edges of the same road share one row.
fn parts(out: &mut dyn Write, network: &Network, found: &Route) -> std::io::Result<()> {
    let mut table = Table::new(&[">from", ">length", ">rsc", "", "road"]);
    for (part, title) in found.titled_parts(network) {
        let rsc = part.rsc_m.map_or(String::new(), |rsc_m| format!("{rsc_m:.2} m"));
        table.row([
            format!("{:.2} km", part.from_m / 1000.0),
            format!("{:.0} m", part.to_m - part.from_m),
            rsc,
            how(network, part.kind).to_owned(),
            printable(&title),
        ]);
    }
    table.write(out, "  ")
}

/// Says where the route uses more of the road than its own lane, and how far at most.
fn uses(out: &mut dyn Write, network: &Network, found: &Route) -> std::io::Result<()> {
    if found.uses.is_empty() {
        return Ok(());
    }
    writeln!(out, "  Beyond its own lane:\n")?;
    let mut table = Table::new(&[">from", ">length", ">at most", "", "what it uses", "", "road"]);
    for used in &found.uses {
        let place = if used.place == UsePlace::Turn { "at the turn" } else { "" };
        table.row([
            format!("{:.2} km", used.from_m / 1000.0),
            format!("{:.0} m", used.to_m - used.from_m),
            format!("{:.2} m", (used.beyond_m * 100.0).ceil() / 100.0),
            used.side.name().to_owned(),
            used.words(network).to_owned(),
            place.to_owned(),
            printable(&route::title(network, used.at)),
        ]);
    }
    table.write(out, "  ")?;
    let (places, metres) = found.beyond_all_lanes();
    if places > 0 {
        let at = if places == 1 { "place" } else { "places" };
        let told = format!(
            "Beyond all lanes of its direction for {metres:.0} m at {places} {at}. Oncoming traffic must be held back there; nothing here says \
             that it is."
        );
        writeln!(out, "\n{}", wrapped(&told, "  "))?;
    }
    writeln!(out)
}

/// A word for the movement on a part: along an edge, round a roundabout, across a complex, or a turn.
fn how(network: &Network, at: PartKind) -> &'static str {
    match at {
        PartKind::Edge(_) => "along",
        PartKind::Turn { .. } => match route::passes_over(network, at) {
            Some(PassageKind::Roundabout) => "round",
            Some(PassageKind::Complex) => "across",
            None => "turn",
        },
    }
}

/// Says where the route uses roads that are open to their destination only, or at some times only.
fn limited(out: &mut dyn Write, inputs: &RoutingInputs, found: &Route) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    let tell = |out: &mut dyn Write, what: &str, stretches: &[LimitedStretch]| {
        stretches.iter().try_for_each(|stretch| {
            let (road, tag) = (printable(&stretch.title), printable(&destination_words(&stretch.tag)));
            let (from_km, to_km) = (stretch.from_m / 1000.0, stretch.to_m / 1000.0);
            let text = format!("{what}: {road} from {from_km:.2} km to {to_km:.2} km ({tag}).");
            writeln!(out, "{}", wrapped(&text, "  "))
        })
    };
    let destinations = found.destination_only(network, vehicle);
    let times = found.only_at_times(network, vehicle);
    tell(out, "Only for a vehicle whose journey begins or ends there", &destinations)?;
    tell(out, "Closed to the vehicle at other times", &times)?;
    if destinations.is_empty() && times.is_empty() { Ok(()) } else { writeln!(out) }
}

/// Names the places for which the search for conditions found none.
fn nothing_helps(out: &mut dyn Write, network: &Network, answer: &Answer) -> std::io::Result<()> {
    if answer.nothing_helps.is_empty() {
        return Ok(());
    }
    let told = "A route under conditions was looked for, and there is none. No kerb radius, width or paving that was tried opens these places:";
    writeln!(out, "{}\n", wrapped(told, "  "))?;
    let mut table = Table::new(&["at", "", "road"]);
    for &at in &answer.nothing_helps {
        let place = route::place(network, at).map_or_else(String::new, |[lon, lat]| format!("{lon:.5},{lat:.5}"));
        table.row([place, how(network, at).to_owned(), printable(&route::title(network, at))]);
    }
    table.write(out, "  ")?;
    writeln!(out)
}

/// What is missing at an obstacle, metres. At a turn it is a bound from below.
fn missing(at: PartKind, m: f64) -> String {
    let least = if matches!(at, PartKind::Turn { .. }) { "at least " } else { "" };
    format!("{least}{m:.2} m")
}

fn blocked(
    out: &mut dyn Write,
    inputs: &RoutingInputs,
    answer: &Answer,
    compared: Option<&Comparison>,
) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    let Some(obstacles) = &answer.obstacles else {
        return writeln!(out, "  No roads lead there at all, lawful turns and one-way roads considered.\n");
    };
    if answer.conditions_cut_short {
        let told = "The search for a route under conditions took too long and was ended; `--patience SECONDS` gives it more time.";
        writeln!(out, "{}", wrapped(told, "  "))?;
    }
    if answer.gave_up {
        writeln!(out, "  Given up after {} whole routes that failed; --tries allows more.", answer.refuted.len())?;
    }
    let count = obstacles.len();
    let closed = obstacles.iter().any(|obstacle| obstacle.destination_only);
    let what = if closed { "What stands in the way" } else { "What would have to become safe" };
    writeln!(out, "  {what}: {count} {}\n", if count == 1 { "place" } else { "places" })?;
    let as_reference = compared.map(|compared| format!("as {}", compared.relative_to));
    let more = as_reference.iter().flat_map(|heading| [">relative", heading.as_str()]);
    let headings: Vec<&str> = ["at", "", "verdict", ">missing"].into_iter().chain(more).chain(["road"]).collect();
    let mut table = Table::new(&headings);
    for (number, obstacle) in obstacles.iter().enumerate() {
        let verdict = match obstacle.words(network, vehicle) {
            ("refuted", _) => "refuted as part of the whole".to_owned(),
            (verdict, _) if obstacle.destination_only => format!("{verdict}: destination only"),
            (verdict, "") => verdict.to_owned(),
            (verdict, reason) => format!("{verdict}: {reason}"),
        };
        let relative = compared.map(|compared| compared.obstacles.get(number).copied().unwrap_or_default());
        let own = [
            route::place(network, obstacle.at).map_or_else(String::new, |[lon, lat]| format!("{lon:.5},{lat:.5}")),
            how(network, obstacle.at).to_owned(),
            verdict,
            obstacle.missing_m.filter(|m| *m < 100.0).map_or_else(String::new, |m| missing(obstacle.at, m)),
        ];
        let road = printable(&route::title(network, obstacle.at));
        table.row(own.into_iter().chain(relative.into_iter().flat_map(relative::words)).chain([road]));
    }
    table.write(out, "  ")?;
    for obstacle in obstacles {
        let Some(tag) = obstacle.tag(network, vehicle) else { continue };
        let road = printable(&route::title(network, obstacle.at));
        let text = format!(
            "{road} is open only to a vehicle whose journey begins or ends there ({}), and the way passes through it. No other way is \
             certified.",
            printable(&destination_words(&tag))
        );
        writeln!(out, "\n{}", wrapped(&text, "  "))?;
    }
    let cheapest =
        "The cheapest set of places: each costs 1, plus the metres that are missing there (5 where that is not known).";
    writeln!(out, "\n{}\n", wrapped(cheapest, "  "))
}
