//! Conditions of OpenStreetMap's conditional restrictions: `no @ (weight>7.5 AND 22:00-06:00); yes @ (PH)`.
//!
//! Conditions are joined by `AND`; `;` or `OR` inside parentheses means either. What cannot be parsed is [`RuleCondition::Strange`], whose truth is
//! unclear: it closes nothing for certain and opens nothing.

use super::hours::Hours;
use super::property::Property;
use super::subject::Subject;
use super::truth::Truth;
use crate::osm::facts::value;
use crate::vehicle::{Classes, Member};

/// How a number is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberComparison {
    Less,
    AtMost,
    Equal,
    AtLeast,
    More,
}

/// One condition.
#[derive(Debug, Clone)]
pub(crate) enum RuleCondition {
    /// All hold.
    All(Vec<RuleCondition>),
    /// One of them holds.
    Any(Vec<RuleCondition>),
    /// A size, mass or number of the vehicle.
    Size(Property, NumberComparison, f64),
    /// A class of vehicles, by its key.
    Class(String),
    /// `articulated`
    Articulated,
    /// `semitrailer`
    Semitrailer,
    /// Opening hours.
    Time(Hours),
    /// Weather, season, a signal: no clock tells it.
    Circumstance,
    /// `destination`, `delivery`: what the journey is for.
    Purpose,
    /// A load or a user that a lorry in general does not have: `hazmat`, `residents`.
    Others,
    /// Not understood.
    Strange,
}

/// A value and the condition under which it holds.
#[derive(Debug, Clone)]
pub(crate) struct Clause {
    pub(crate) value: String,
    pub(crate) condition: RuleCondition,
}

/// The clauses of a conditional value, in order. A part without `@` goes on the condition before it.
pub(crate) fn clauses(text: &str) -> Vec<Clause> {
    let mut parts: Vec<(String, Option<String>)> = Vec::new();
    for part in split(text, &|rest| rest.starts_with(';').then_some(1)) {
        let part = part.trim();
        if part.is_empty() {
            continue;
        }
        match (part.split_once('@'), parts.last_mut()) {
            (Some((value, condition)), _) => {
                parts.push((value.trim().to_owned(), Some(condition.trim().to_owned())));
            }
            (None, Some((_, Some(before)))) => {
                before.push_str("; ");
                before.push_str(part);
            }
            (None, _) => parts.push((part.to_owned(), None)),
        }
    }
    let clause = |(value, condition): (String, Option<String>)| {
        let condition = condition.map_or(RuleCondition::Strange, |text| RuleCondition::read(&text));
        Clause { value, condition }
    };
    parts.into_iter().map(clause).collect()
}

/// Parts of a text between separators that stand outside parentheses and quotes. `separator` has the length of one that the rest starts
/// with.
fn split<'t>(text: &'t str, separator: &dyn Fn(&str) -> Option<usize>) -> Vec<&'t str> {
    let (mut parts, mut from, mut depth, mut quoted, mut skip) = (Vec::new(), 0, 0_u32, false, 0);
    for (at, c) in text.char_indices() {
        if at < skip {
            continue;
        }
        match c {
            '"' => quoted = !quoted,
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > 0 || quoted {
            continue;
        }
        if let Some(length) = text.get(at..).and_then(separator) {
            parts.push(text.get(from..at).unwrap_or_default());
            from = at + length;
            skip = from;
        }
    }
    parts.push(text.get(from..).unwrap_or_default());
    parts
}

/// Parts between a word in any case.
fn split_word<'t>(text: &'t str, word: &str) -> Vec<&'t str> {
    let mut parts: Vec<&str> = Vec::new();
    let mut from = 0;
    let border = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric() && c != '_');
    let ends = split(text, &|rest| {
        let at = text.len() - rest.len();
        let head = rest.get(..word.len())?;
        let before = text.get(..at)?.chars().next_back();
        let after = rest.get(word.len()..)?.chars().next();
        (head.eq_ignore_ascii_case(word) && border(before) && border(after)).then_some(word.len())
    });
    for part in ends {
        parts.push(part);
        from += part.len() + word.len();
    }
    debug_assert!(from >= text.len());
    parts
}

/// The text without parentheses that hold all of it. One that is never closed, or never opened, is dropped.
fn bare(mut text: &str) -> &str {
    loop {
        text = text.trim();
        let mut depth = 0_i32;
        let mut closed_early = false;
        for (at, c) in text.char_indices() {
            match c {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            closed_early |= depth == 0 && at + c.len_utf8() < text.len();
        }
        text = match (text.strip_prefix('('), depth) {
            (Some(rest), 0) if !closed_early => rest.strip_suffix(')').unwrap_or(rest),
            (Some(rest), 1..) => rest,
            (_, ..0) => match text.strip_suffix(')') {
                Some(rest) => rest,
                None => return text,
            },
            _ => return text,
        };
    }
}

impl RuleCondition {
    /// Reads a condition.
    pub(crate) fn read(text: &str) -> Self {
        Self::read_within(text, 0)
    }

    fn read_within(text: &str, depth: u32) -> Self {
        let text = bare(text);
        if text.is_empty() || depth > 8 {
            return Self::Strange;
        }
        // Opening hours have semicolons and commas of their own.
        if let Some(hours) = Hours::read(text) {
            return Self::Time(hours);
        }
        let mut either = split(text, &|rest| {
            let two = rest.starts_with("||").then_some(2);
            two.or_else(|| rest.starts_with(';').then_some(1))
        });
        if either.len() == 1 {
            either = split_word(text, "or");
        }
        either.retain(|part| !part.trim().is_empty());
        if either.len() > 1 {
            return Self::Any(either.into_iter().map(|part| Self::read_within(part, depth + 1)).collect());
        }
        let all = split_word(text, "and");
        if all.len() > 1 {
            return Self::All(all.into_iter().map(|part| Self::read_within(part, depth + 1)).collect());
        }
        if text.starts_with('(') {
            return Self::Strange;
        }
        Self::term(text)
    }

    fn term(text: &str) -> Self {
        let word =
            text.to_ascii_lowercase().replace('≥', ">=").replace('≤', "<=").replace('≧', ">=").replace('≦', "<=");
        if word.starts_with("hazmat") || word.contains("placarded") {
            return Self::Others;
        }
        if let Some(at) = word.find(['<', '>', '=']) {
            let (left, rest) = word.split_at(at);
            return Self::compared(left.trim(), rest).unwrap_or(Self::Strange);
        }
        match word.as_str() {
            "trailer" | "trailers" | "with_trailer" | "with trailer" => {
                Self::Size(Property::Trailers, NumberComparison::AtLeast, 1.0)
            }
            "articulated" => Self::Articulated,
            "semitrailer" | "semi_trailer" | "semi-trailer" => Self::Semitrailer,
            "wet" | "rain" | "dry" | "snow" | "snowfall" | "ice" | "icy" | "fog" | "wind" | "storm" | "flood"
            | "flooded" | "high_water" | "high_tide" | "low_tide" | "tide" | "avalanche" | "frost" | "thaw" | "mud"
            | "winter" | "summer" | "spring" | "autumn" | "fall" | "season" | "seasonal" | "night" | "day"
            | "daytime" | "nighttime" | "daylight" | "darkness" | "dark" | "school" | "school_hours"
            | "school_days" | "holiday" | "holidays" | "rush_hour" | "peak" | "when_flashing" | "flashing"
            | "signal" | "signals" | "variable" | "event" | "events" | "market" | "closed" | "smog" | "congestion"
            | "maintenance" => Self::Circumstance,
            "destination" | "delivery" | "deliveries" | "customers" | "customer" | "loading" | "unloading"
            | "permit" | "local" | "access" | "local_traffic" => Self::Purpose,
            "residents" | "resident" | "private" | "employees" | "emergency" | "agricultural" | "forestry"
            | "military" | "disabled" | "taxi" | "motorcar" | "motorcycle" | "moped" | "mofa" | "bicycle" | "foot"
            | "horse" | "caravan" | "motorhome" | "minibus" | "school_bus" | "service" | "police" | "staff"
            | "members" | "guests" => Self::Others,
            word => {
                let classes = Classes::builtin();
                let key = classes.main_name(word);
                if classes.is_key(key) { Self::Class(key.to_owned()) } else { Self::Strange }
            }
        }
    }

    /// A comparison, as `weight` and `>7.5 t`. Without a property, a unit of mass means the weight.
    fn compared(left: &str, rest: &str) -> Option<Self> {
        let (comparison, length) = match rest.as_bytes() {
            [b'>', b'=', ..] | [b'=', b'>', ..] => (NumberComparison::AtLeast, 2),
            [b'<', b'=', ..] | [b'=', b'<', ..] => (NumberComparison::AtMost, 2),
            [b'=', b'=', ..] => (NumberComparison::Equal, 2),
            [b'>', ..] => (NumberComparison::More, 1),
            [b'<', ..] => (NumberComparison::Less, 1),
            [b'=', ..] => (NumberComparison::Equal, 1),
            _ => return None,
        };
        let bound = rest.get(length..)?.trim();
        let property = if left.is_empty() {
            // A bare number could mean anything.
            let unit = bound.trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | ' '));
            matches!(unit, "t" | "kg" | "lb" | "lbs" | "st" | "tonnes").then_some(Property::Weight)?
        } else {
            Property::of_word(left)?
        };
        if property == Property::Trailers {
            match (bound, comparison) {
                ("yes", NumberComparison::Equal) => return Some(Self::Size(property, NumberComparison::AtLeast, 1.0)),
                ("no", NumberComparison::Equal) => return Some(Self::Size(property, NumberComparison::Less, 1.0)),
                _ => {}
            }
        }
        let bound = if property.is_number() {
            f64::from(bound.parse::<u32>().ok()?)
        } else if property.is_mass() {
            f64::from(value::tonnes(bound)?)
        } else {
            f64::from(value::metres(bound)?)
        };
        Some(Self::Size(property, comparison, bound))
    }

    /// The property, if the condition is that it is greater than a bound and nothing else.
    pub(crate) fn only_size(&self) -> Option<(Property, f64)> {
        match *self {
            Self::Size(property, NumberComparison::More | NumberComparison::AtLeast, bound) => Some((property, bound)),
            _ => None,
        }
    }

    /// Whether something in it is not understood.
    pub(crate) fn has_strange(&self) -> bool {
        match self {
            Self::All(all) | Self::Any(all) => all.iter().any(Self::has_strange),
            other => matches!(other, Self::Strange),
        }
    }

    /// Whether it holds at some times, in some weather, and not at others, for some vehicle.
    pub(crate) fn depends_on_time(&self) -> bool {
        match self {
            Self::All(all) | Self::Any(all) => all.iter().any(Self::depends_on_time),
            Self::Time(hours) => hours.always().is_none(),
            Self::Circumstance => true,
            _ => false,
        }
    }

    /// When it holds for a vehicle, and whether only for journeys with a purpose here.
    pub(crate) fn truth(&self, subject: &Subject<'_>) -> (Truth, bool) {
        match self {
            Self::All(all) => {
                let parts: Vec<(Truth, bool)> = all.iter().map(|part| part.truth(subject)).collect();
                let has = |wanted| parts.iter().any(|(truth, _)| *truth == wanted);
                let truth = [Truth::Never, Truth::Unclear, Truth::Sometimes].into_iter().find(|&truth| has(truth));
                (truth.unwrap_or(Truth::Always), parts.iter().any(|part| part.1))
            }
            Self::Any(any) => {
                let parts: Vec<(Truth, bool)> = any.iter().map(|part| part.truth(subject)).collect();
                let has = |wanted| parts.iter().any(|(truth, _)| *truth == wanted);
                if parts.contains(&(Truth::Always, false)) {
                    return (Truth::Always, false);
                }
                let truth = [Truth::Always, Truth::Unclear, Truth::Sometimes].into_iter().find(|&truth| has(truth));
                (truth.unwrap_or(Truth::Never), parts.iter().any(|part| part.1 && part.0 != Truth::Never))
            }
            Self::Size(property, comparison, bound) => (compare(subject, *property, *comparison, *bound), false),
            Self::Class(key) => (of_member(subject.class.member(key)), false),
            Self::Articulated => (of_flag(subject.class.articulated), false),
            Self::Semitrailer => (of_flag(subject.class.semitrailer), false),
            Self::Time(hours) => (hours.truth(subject.at), false),
            Self::Circumstance => (Truth::Sometimes, false),
            Self::Purpose => (Truth::Always, true),
            Self::Others => (Truth::Never, false),
            Self::Strange => (Truth::Unclear, false),
        }
    }
}

fn of_member(member: Member) -> Truth {
    match member {
        Member::Yes => Truth::Always,
        Member::Maybe => Truth::Unclear,
        Member::No => Truth::Never,
    }
}

fn of_flag(flag: Option<bool>) -> Truth {
    match flag {
        Some(true) => Truth::Always,
        Some(false) => Truth::Never,
        None => Truth::Unclear,
    }
}

/// Compares what is known of the vehicle. A size that nobody stated is not compared, as with limits.
fn compare(subject: &Subject<'_>, property: Property, comparison: NumberComparison, bound: f64) -> Truth {
    let Some(vehicle) = subject.vehicle else { return Truth::Unclear };
    let Some((least, most)) = property.of(vehicle) else { return Truth::Never };
    let slack = property.slack();
    let holds = |size: f64| match comparison {
        NumberComparison::More => size > bound + slack,
        NumberComparison::AtLeast => size > bound - slack,
        NumberComparison::Less => size < bound - slack,
        NumberComparison::AtMost => size < bound + slack,
        NumberComparison::Equal => (size - bound).abs() < slack,
    };
    match (holds(least), holds(most)) {
        (true, true) => Truth::Always,
        (false, false) if comparison != NumberComparison::Equal || most < bound || least > bound => Truth::Never,
        _ => Truth::Unclear,
    }
}
