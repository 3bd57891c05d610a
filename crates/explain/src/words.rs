//! Writes an explanation as sentences: first what limits the vehicle and where, then hints, then the scope of the answer.

use super::hints::{KerbHint, MOST_MORE_M, OtherStrip};
use super::names::{cut, hinge_name, needed, source_words, strip_name};
use super::no_bound;
use super::{BodyPart, Explanation, Geometry, HingePlace, LaneGroup, LimitingPlace};
use crate::corridor::{Taper, TaperCause};
use crate::network::destination_words;
use crate::osm::facts::Designation;
use crate::rows::AttestedBy;
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};
use netcert_base::words::{Named as _, verdict_words};

/// Below this leeway, metres, the missing width is not named, because the bounds are wider than any road.
const FAR_M: f64 = -100.0;

/// An explanation in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Words {
    /// One line with the verdict, what decides it, and where.
    pub headline: String,
    /// The reasons as sentences.
    pub reasons: Vec<String>,
    /// The hints as sentences. Empty if the edge is not unsafe.
    pub hints: Vec<String>,
    /// The scope: the model, widths and tolerances for which the answer holds.
    pub scope: String,
}

/// Puts an explanation into words.
#[must_use]
pub fn words(e: &Explanation) -> Words {
    let headline = match (e.verdict, &e.geometry) {
        (Verdict::Forbidden(reason), _) => forbidden(e, reason),
        (Verdict::Unknown(reason), _) => unknown(e, reason),
        (Verdict::Safe, Some(g)) => {
            format!("safe: {} m to spare at {:.0} m, where it is tightest: {}", cut(rsc(g)), at(g), who(e, g))
        }
        (Verdict::Unsafe(UnsafeReason::Width), Some(g)) if rsc(g) <= FAR_M => {
            format!("unsafe: the swept bodies leave the {} by far at {:.0} m: {}", e.strip_name(), at(g), who(e, g))
        }
        (Verdict::Unsafe(UnsafeReason::Width), Some(g)) => {
            format!("unsafe: {} m too narrow at {:.0} m: {}", lacks(g), at(g), who(e, g))
        }
        (Verdict::Unsafe(_), Some(g)) => format!("unsafe: {}", hinge_headline(e, g)),
        (Verdict::Safe, None) => "nothing was computed".to_owned(),
        (Verdict::Unsafe(_), None) => {
            "unsafe: no path was found that leads from the one road into the other".to_owned()
        }
    };
    let mut reasons = match (e.verdict, &e.geometry) {
        (Verdict::Safe | Verdict::Unsafe(_), Some(g)) => geometry_reasons(e, g),
        (_, Some(g)) => vec![beside(e, g)],
        (_, None) => Vec::new(),
    };
    reasons.extend(e.turn.as_ref().and_then(|turn| refused(&turn.refused)));
    if e.road.as_ref().is_some_and(|road| road.lane_shared) {
        reasons
            .push("Both directions share the lane: it is the whole road, and oncoming traffic has to wait.".to_owned());
    }
    reasons.extend(e.road.as_ref().and_then(|road| road.supposed_lanes.as_ref()).map(supposed_lanes));
    if let Some(road) = e.road.as_ref().filter(|road| !road.narrowed_by.is_empty()) {
        reasons.push(format!("The road has a narrow place: {}.", road.narrowed_by.join(", ")));
    }
    reasons.extend(e.road.as_ref().and_then(|road| road.destination_tag.as_deref()).map(destination_only));
    let attested =
        |sign: &&'static Designation| format!("Attested, not proved: {}.", AttestedBy::Designation(sign).words());
    reasons.extend(e.signs.iter().map(attested));
    Words { headline, reasons, hints: hints(e), scope: scope(e) }
}

/// Which rule says how many lanes the road has, and what it rests on. The share is rounded down.
fn supposed_lanes(group: &LaneGroup) -> String {
    let LaneGroup { country, class, lanes, rests_on } = group;
    let because = match rests_on {
        Some(group) => format!(
            "{:.0} % of the {} one-way roads of class {} in {country} whose lanes are tagged have as many or more",
            (100.0 * group.share()).floor(),
            group.tagged,
            class.name()
        ),
        None => format!(
            "the rules with which the roads were read say so of one-way roads of class {} in {country}",
            class.name()
        ),
    };
    format!("How many lanes the road has is not tagged: {lanes} are supposed, because {because}.")
}

fn destination_only(tag: &str) -> String {
    let tag = destination_words(tag);
    format!("Only for vehicles whose journey begins or ends there ({tag}): no route passes through.")
}

/// The RSC, or −∞ if there is none.
fn rsc(g: &Geometry) -> f64 {
    g.result.rsc_m.unwrap_or(f64::NEG_INFINITY)
}

fn at(g: &Geometry) -> f64 {
    g.along_m(g.place.station)
}

/// The corner, its unit, and its place in a bend.
fn who(e: &Explanation, g: &Geometry) -> String {
    format!("{}, {}", e.corner(&g.place), bend(&g.place))
}

fn bend(place: &LimitingPlace) -> String {
    match place.bend {
        None => "on a straight".to_owned(),
        Some(bend) => {
            let side = if bend.to == place.side { "inside" } else { "outside" };
            format!("on the {side} of a bend of {:.0} m radius", bend.radius_m)
        }
    }
}

/// The roads beside a turn that the vehicle may not use, in one sentence.
fn refused(roads: &[(String, Verdict)]) -> Option<String> {
    let one = |(road, verdict): &(String, Verdict)| {
        let (verdict, reason) = verdict_words(*verdict);
        format!("{road} is itself {verdict} ({})", reason.replace('_', " "))
    };
    let all: Vec<String> = roads.iter().map(one).collect();
    let whose = if all.len() > 1 { "the verdict of the first of them" } else { "that verdict" };
    (!all.is_empty()).then(|| format!("{}: a database lists the turn with {whose}.", all.join(", and ")))
}

fn hinge_headline(e: &Explanation, g: &Geometry) -> String {
    let h = &g.hinge;
    let name = hinge_name(&e.vehicle, h.unit);
    let place = g.along_m(h.station);
    let Some(margin_rad) = g.result.hinge_margin_rad else { return no_bound::headline(e, g) };
    let over_deg = (-margin_rad.to_degrees() * 10.0 - 1e-6).ceil() / 10.0;
    format!("{name} would need {over_deg:.1}° more than its {:.0}° at {place:.0} m", h.limit_rad.to_degrees())
}

fn degrees(h: &HingePlace) -> f64 {
    h.angle_rad.abs().to_degrees()
}

fn geometry_reasons(e: &Explanation, g: &Geometry) -> Vec<String> {
    let mut reasons = Vec::new();
    let strip = e.strip_name();
    if let (Some(bounds_m), Some(margin_rad)) = (g.place.bounds_m, g.result.hinge_margin_rad)
        && rsc(g) > FAR_M
    {
        reasons.push(gap(e, &g.place, bounds_m, strip));
        reasons.extend(g.taper().map(|taper| tapers(taper, strip)));
        reasons.push(tracking(&e.vehicle, g));
        reasons.push(hinge_reason(&e.vehicle, g, margin_rad));
    }
    if !g.result.closes() {
        reasons.extend(no_bound::reason(e, g));
    }
    let shift = g.certificate.shift_m.get(g.span.clone()).unwrap_or_default();
    let most = shift.iter().fold(0.0_f64, |most, q| if q.abs() > most.abs() { *q } else { most });
    if most.abs() >= 0.05 {
        let side = if most > 0.0 { "left" } else { "right" };
        reasons.push(format!(
            "The steer axle is planned up to {:.2} m to the {side} of the {strip}'s middle, to leave the rest room.",
            most.abs()
        ));
    }
    reasons
}

fn gap(e: &Explanation, place: &LimitingPlace, bounds_m: f64, strip: &str) -> String {
    let source = e.road.as_ref().and_then(|road| {
        let said = source_words(road.width_source?);
        let tags = road.width_tags.join(", ");
        Some(if tags.is_empty() { format!(" ({said})") } else { format!(" ({said}: {tags})") })
    });
    let source = source.unwrap_or_default();
    let nominally = if place.nominal_m >= 0.0 {
        format!("stays {:.2} m inside its edge", place.nominal_m)
    } else {
        format!("stands {:.2} m beyond its edge", -place.nominal_m)
    };
    let part = if matches!(place.part, BodyPart::FrontCorner | BodyPart::RearCorner) { "corner" } else { "side" };
    let there = match place.width_m {
        Some(width_m) => format!("The {strip} is {width_m:.2} m wide there{source}"),
        None => "The edge of the junction's area counts there".to_owned(),
    };
    format!("{there}; steered exactly, that {part} {nominally}, and {bounds_m:.2} m are kept for errors.")
}

fn tapers(taper: &Taper, strip: &str) -> String {
    let [from_m, to_m] = taper.widths_m;
    let cause = match taper.cause {
        TaperCause::Section => "where the cross section changes",
        TaperCause::Joins => "where two carriageways become one road",
        TaperCause::Parts => "where the road parts into two carriageways",
    };
    let moves = if taper.cause == TaperCause::Section && taper.shift_m.abs() >= 0.05 {
        let side = if taper.shift_m > 0.0 { "left" } else { "right" };
        format!(", and moves {:.2} m to the {side}", taper.shift_m.abs())
    } else {
        String::new()
    };
    let how = if (from_m - to_m).abs() < 0.005 {
        format!("keeps its {from_m:.2} m")
    } else {
        format!("tapers from {from_m:.2} m to {to_m:.2} m")
    };
    format!("There the {strip} {how} over {:.0} m{moves}, {cause}.", taper.length_m)
}

fn tracking(vehicle: &Vehicle, g: &Geometry) -> String {
    let shrink = g.result.shrink;
    let tolerance_m = shrink * vehicle.tracking_tolerance_m;
    if shrink >= 1.0 {
        return format!("That is with the vehicle's whole tracking tolerance of ±{tolerance_m:.2} m.");
    }
    let least = shrink <= vehicle.min_shrink + 1e-3 && g.result.too_narrow();
    let why = if least { "the closest that it can be asked for" } else { "the widest with which it fits" };
    format!(
        "That is with the steer axle within ±{tolerance_m:.3} m of the plan, γ = {shrink:.3} of its ±{} m: {why}.",
        vehicle.tracking_tolerance_m
    )
}

fn hinge_reason(vehicle: &Vehicle, g: &Geometry, margin_rad: f64) -> String {
    let (h, margin) = (&g.hinge, margin_rad.to_degrees());
    let name = hinge_name(vehicle, h.unit);
    let limit = h.limit_rad.to_degrees();
    let kept = limit - degrees(h) - margin;
    if margin >= 0.0 {
        return format!(
            "Of all hinges {name} comes closest to its limit: {:.1}° are left of {limit:.0}°.",
            (margin * 10.0).floor() / 10.0
        );
    }
    format!(
        "At its furthest {name} turns to {:.1}° at {:.0} m, {:.1}° are kept for errors, and it allows {limit:.0}°.",
        degrees(h),
        g.along_m(h.station),
        kept.max(0.0)
    )
}

/// The road that decides a turn's verdict, to be appended to a sentence.
fn on_road(e: &Explanation) -> String {
    let road = e.turn.as_ref().and_then(|turn| turn.decides.as_ref());
    road.map_or(String::new(), |road| format!(", on {road}"))
}

fn forbidden(e: &Explanation, reason: ForbiddenReason) -> String {
    if reason == ForbiddenReason::Restriction {
        let banning = e.turn.as_ref().and_then(|turn| turn.restriction.as_ref());
        let which = banning.map_or(String::new(), |banning| format!(" ({banning})"));
        return format!("forbidden: a restriction on the map bans this turn{which}");
    }
    let on = on_road(e);
    let Some(c) = &e.conflict else {
        return format!("forbidden: {}{on}", verdict_words(e.verdict).1.replace('_', " "));
    };
    let by_rule = c.tag.contains('=');
    let said = match (reason, c.allowed, c.has) {
        (ForbiddenReason::Oneway, ..) => {
            format!("forbidden: one-way for this vehicle in the other direction ({})", c.tag)
        }
        (ForbiddenReason::Hgv | ForbiddenReason::Access | ForbiddenReason::Class, ..) if by_rule => {
            format!("forbidden: {}", c.tag)
        }
        (ForbiddenReason::Hgv, ..) => "forbidden: no heavy goods vehicles (hgv=no or its kind)".to_owned(),
        (ForbiddenReason::Access, ..) => {
            "forbidden: no through traffic of motor vehicles (access, vehicle or motor_vehicle = no or private)"
                .to_owned()
        }
        (ForbiddenReason::Barrier, ..) if by_rule => {
            format!("forbidden: a barrier on it stops heavy vehicles ({})", c.tag)
        }
        (ForbiddenReason::Barrier, ..) => "forbidden: a barrier on it stops heavy vehicles".to_owned(),
        (_, Some(allowed), Some(has)) => {
            let what = match reason {
                ForbiddenReason::Height => "height",
                ForbiddenReason::Weight => "gross mass",
                ForbiddenReason::AxleLoad => "heaviest axle load",
                ForbiddenReason::Length => "length",
                ForbiddenReason::Axles => "number of axles",
                ForbiddenReason::Trailers => "number of trailers",
                _ => "width",
            };
            let measured = if c.surveyed { " (measured)" } else { "" };
            let tag = &c.tag;
            let unit = if c.unit.is_empty() { String::new() } else { format!(" {}", c.unit) };
            let digits = if c.unit.is_empty() { 0 } else { 2 };
            let stated = if by_rule { "at most" } else { "is" };
            let comma = if by_rule { "," } else { "" };
            format!(
                "forbidden: {tag}{comma} {stated} {allowed}{unit}{measured}, the vehicle's {what} {has:.digits$}{unit}"
            )
        }
        _ => format!("forbidden: {}", c.tag),
    };
    format!("{said}{on}")
}

fn unknown(e: &Explanation, reason: UnknownReason) -> String {
    let on = on_road(e);
    let said = match (reason, &e.conflict) {
        (UnknownReason::Width, _) => {
            let unreadable = e.road.as_ref().map_or(&[][..], |road| &road.unreadable_widths);
            let why = if unreadable.is_empty() {
                "the lanes are for others, or the map says nothing that can be read".to_owned()
            } else {
                format!("{} cannot be read", unreadable.join(", "))
            };
            format!("unknown: no width of the {} can be derived: {why}", e.strip_name())
        }
        (UnknownReason::Geometry, _) => {
            "unknown: the line on the map gives no corridor: too short, folded back on itself, \
                                         or too crooked for a smooth line within the tolerance"
                .to_owned()
        }
        (UnknownReason::Cut, _) => {
            "unknown: the extract ends on this edge: what comes before or after is not known".to_owned()
        }
        (UnknownReason::Limit, Some(c)) if c.tag.contains('=') => {
            format!("unknown: {} cannot be read, or not be compared with what is known of the vehicle", c.tag)
        }
        (UnknownReason::Time, Some(c)) => format!("unknown: closed to the vehicle at some times: {}", c.tag),
        (UnknownReason::Time, None) => "unknown: closed to the vehicle at some times".to_owned(),
        (UnknownReason::Rule, Some(c)) => {
            format!("unknown: a rule that is not understood may exclude the vehicle: {}", c.tag)
        }
        (UnknownReason::Rule, None) => "unknown: a rule that is not understood may exclude the vehicle".to_owned(),
        (UnknownReason::Limit, Some(c)) => {
            format!("unknown: {} is tagged with a value that cannot be read", c.tag)
        }
        (UnknownReason::Limit, None) => "unknown: a limit is tagged with a value that cannot be read".to_owned(),
        (UnknownReason::Failed, _) => "unknown: the machine that was to certify it failed".to_owned(),
        (UnknownReason::TookTooLong, _) => {
            "unknown: the certificate took too long; `netcert certify --patience` gives it more time".to_owned()
        }
        _ => format!("unknown: {}", verdict_words(e.verdict).1.replace('_', " ")),
    };
    format!("{said}{on}")
}

/// What is missing, metres. In an area an RSC below 0 is a bound of it from below.
fn lacks(g: &Geometry) -> String {
    let least = if g.result.limiting.in_area { "at least " } else { "" };
    format!("{least}{}", needed(-rsc(g)))
}

/// What the certificate says if something else decided the verdict.
fn beside(e: &Explanation, g: &Geometry) -> String {
    let strip = e.strip_name();
    match () {
        () if !g.result.closes() => format!("Besides, {}.", hinge_headline(e, g)),
        () if g.result.too_narrow() => {
            format!("Besides, the {strip} is {} m too narrow at {:.0} m: {}.", lacks(g), at(g), who(e, g))
        }
        () if !g.result.safe() => format!("Besides, {}.", hinge_headline(e, g)),
        () => format!(
            "Its width alone would do, as far as it is known: {} m to spare at {:.0} m, {}.",
            cut(rsc(g)),
            at(g),
            who(e, g)
        ),
    }
}

fn hints(e: &Explanation) -> Vec<String> {
    if !matches!(e.verdict, Verdict::Unsafe(_)) {
        return Vec::new();
    }
    let (h, strip) = (&e.hints, e.strip_name());
    let mut out = Vec::new();
    if let Some(g) = e.geometry.as_ref().filter(|g| g.result.too_narrow()) {
        let widened = g.place.width_m.is_some();
        out.extend(match h.width {
            Some(hint) => {
                let how = if hint.shrink < 1.0 {
                    format!(", tracked as closely as γ = {:.3}", hint.shrink)
                } else {
                    String::new()
                };
                Some(format!("A {strip} of at least {:.2} m would do{how}.", hint.width_m))
            }
            None => widened.then(|| format!("No {strip} up to {MOST_MORE_M:.0} m wider along the same line would do.")),
        });
        out.push(match h.tolerance_m {
            Some(tolerance_m) => {
                format!("As wide as it is, it would do with a tracking tolerance of ±{tolerance_m:.3} m.")
            }
            None => "No tracking tolerance would do, not even ±0 m.".to_owned(),
        });
    }
    if let Some(limit) = h.hinge_limit_deg {
        out.push(format!("With a limit of {limit:.1}° it would do."));
    }
    match h.kerb {
        Some(KerbHint::AtLeast(radius_m)) => {
            out.push(format!("A kerb return of at least {radius_m:.1} m radius would do."));
        }
        Some(KerbHint::NotUpTo(radius_m)) => {
            out.push(format!("No kerb return of up to {radius_m:.0} m radius would do."));
        }
        None => {}
    }
    out.extend(h.shorter.as_ref().map(no_bound::words));
    out.extend(h.other_strips.iter().map(other_strip));
    out
}

fn other_strip(other: &OtherStrip) -> String {
    let strip = strip_name(other.policy);
    match (other.safe, other.rsc_m) {
        (true, Some(rsc_m)) => {
            format!(
                "Using the whole {strip} ({:.2} m at the least) it is safe, {} m to spare.",
                other.width_m,
                cut(rsc_m)
            )
        }
        (false, Some(rsc_m)) if rsc_m < 0.0 && rsc_m > FAR_M => {
            format!("Even the whole {strip} ({:.2} m at the least) is {} m too narrow.", other.width_m, needed(-rsc_m))
        }
        (_, None) => {
            format!("Even the whole {strip} ({:.2} m at the least) does not do: no bound holds there.", other.width_m)
        }
        (false, Some(_)) => {
            format!("Even the whole {strip} ({:.2} m at the least) does not do: a hinge turns too far.", other.width_m)
        }
    }
}

fn scope(e: &Explanation) -> String {
    let v = &e.vehicle;
    let width = match e.road.as_ref() {
        None if e.turn.is_some() => "roads as wide as mapped or else assumed".to_owned(),
        None => "a corridor as wide as the file says".to_owned(),
        Some(road) => match road.width_source {
            Some(source) => format!("a width that is {}", source_words(source)),
            None => "no known width".to_owned(),
        },
    };
    let tolerance_m = e.geometry.as_ref().map_or(1.0, |g| g.result.shrink) * v.tracking_tolerance_m;
    format!(
        "This holds within the model: {width}, the vehicle as defined, driven forward with its steer axle within \
         ±{tolerance_m:.3} m of the plan and its course within {:.1}°, every axle slipping no more than its sway bound; it \
         is no permit and says nothing of bridges, turns off the road or traffic.",
        v.tracking_heading_rad.to_degrees()
    )
}
