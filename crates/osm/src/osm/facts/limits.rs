//! Plain limits and access per direction of travel, as the columns of an edge have them: what holds for a lorry in general.
//!
//! If several tags limit the same quantity, the strictest counts. What depends on the vehicle or the time stands here as "not for through
//! traffic" at most; the rules beside it decide ([`super::legal`]).

use crate::osm::facts::access::{AccessTags, is_access_key, permission};
use crate::osm::facts::legal::RuleTags;
use crate::osm::facts::limit_kind::LimitKind;
use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::{Direction, Legal, Limit, Oneway, Permission};

impl Limit {
    /// The stricter of two limits. An unreadable limit may be stricter than any number.
    #[must_use]
    pub fn stricter(self, other: Limit) -> Limit {
        match (self, other) {
            (Limit::Unreadable, _) | (_, Limit::Unreadable) => Limit::Unreadable,
            (Limit::None, limit) | (limit, Limit::None) => limit,
            (Limit::At(a), Limit::At(b)) => Limit::At(a.min(b)),
        }
    }
}

/// Limits and access of one way or node while its tags are read.
#[derive(Debug, Default)]
pub(super) struct LegalTags<'t> {
    limits: [Legal; 2],
    pub(super) access: AccessTags,
    rules: RuleTags<'t>,
}

impl<'t> LegalTags<'t> {
    /// Takes a width of the road that cannot be read, so that people see it.
    pub(super) fn take_unreadable_width(&mut self, key: &'t str, text: &'t str) {
        self.rules.take_unreadable_width(key, text);
    }

    /// Takes a tag if its key concerns limits, access or the direction of travel.
    pub(super) fn take(&mut self, key: &'t str, text: &'t str, notes: &mut Notes) {
        let (head, suffix) = key.split_once(':').unwrap_or((key, ""));
        self.rules.take(key, head, suffix, text);
        let conditional = suffix == "conditional" || suffix.ends_with(":conditional");
        let plain =
            if conditional { suffix.strip_suffix("conditional").unwrap_or("").trim_end_matches(':') } else { suffix };
        if let Some(kind) = LimitKind::of_key(head) {
            self.take_limit(kind, plain, text, conditional, notes);
        } else if is_access_key(head) {
            if conditional {
                self.take_conditional_access(head, plain, text, notes);
            } else {
                self.access.take(head, plain, text, notes);
            }
        }
    }

    fn take_limit(&mut self, kind: LimitKind, suffix: &str, text: &str, conditional: bool, notes: &mut Notes) {
        let mut directions = [true; 2];
        let mut by_lane = false;
        for part in suffix.split(':').filter(|part| !part.is_empty()) {
            match part {
                "forward" => directions[1] = false,
                "backward" => directions[0] = false,
                "lanes" => by_lane = true,
                "physical" | "legal" | "hgv" | "hgv_articulated" | "goods" => {}
                // For others, or a remark such as `maxweight:signed=no`.
                _ => return,
            }
        }
        if conditional {
            // The rules have it.
        } else if by_lane {
            for limit in text.split('|').filter(|limit| !limit.trim().is_empty()) {
                self.limit(kind, kind.read(limit), directions, notes);
            }
        } else {
            self.limit(kind, kind.read(text), directions, notes);
        }
    }

    fn limit(&mut self, kind: LimitKind, limit: Limit, directions: [bool; 2], notes: &mut Notes) {
        if limit == Limit::Unreadable {
            notes.add(Note::BadLimit);
        }
        for (legal, on) in self.limits.iter_mut().zip(directions) {
            if on {
                kind.add(legal, limit);
            }
        }
    }

    /// `no @ (weight>7.5)` is a weight limit. `no @ hazmat` does not concern dimensions. Any other condition is left to the rules.
    fn take_conditional_access(&mut self, head: &str, suffix: &str, text: &str, notes: &mut Notes) {
        let directions = match suffix {
            "" => [true, true],
            "forward" => [true, false],
            "backward" => [false, true],
            _ => return,
        };
        for (value, condition) in clauses(text) {
            let value = permission(value, notes);
            if condition.contains("hazmat") || condition.contains("placarded") {
                continue;
            }
            match dimension_condition(condition) {
                Some((kind, limit)) if value == Permission::No => self.limit(kind, limit, directions, notes),
                _ if value > Permission::Yes => {
                    self.access.condition(head, directions, value);
                }
                // A condition under which access is more lenient has no effect.
                _ => {}
            }
        }
    }

    /// The limits and access of a direction. `untagged`: the directions that the road has without a tag about them.
    pub(super) fn resolve(&self, direction: Direction, untagged: Oneway) -> Legal {
        let index = usize::from(direction == Direction::Backward);
        let (motor_vehicle, hgv) = self.access.resolve(direction);
        let mut legal = Legal { hgv, motor_vehicle, ..self.limits[index].clone() };
        self.rules.add_to(&mut legal, direction, untagged);
        if legal.rules.is_none() {
            legal.tags = self.rules.told(direction);
        }
        legal
    }

    /// The tags by which an authority signs a direction for vehicles, `key=value` lines in order. Of nodes they sign no road.
    pub(super) fn signs(&self, direction: Direction) -> Option<Box<str>> {
        self.rules.signs(direction)
    }

    /// The directions of travel that exist for some vehicle of `those` classes, if tags give them by vehicle or time.
    pub(super) fn oneway(&self, untagged: Oneway, those: impl Fn(&crate::vehicle::Class) -> bool) -> Option<Oneway> {
        self.rules.oneway(untagged, those)
    }

    /// Adds remarks on rules.
    pub(super) fn note_rules(&self, notes: &mut Notes) {
        self.rules.note(notes);
    }
}

/// `value @ condition` pairs. Semicolons inside parentheses belong to the condition. The condition is empty without an
/// `@`.
pub(super) fn clauses(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut depth = 0_u32;
    text.split(move |c| {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ';' && depth == 0
    })
    .filter(|clause| !clause.trim().is_empty())
    .map(|clause| clause.split_once('@').unwrap_or((clause, "")))
    .map(|(value, condition)| (value.trim(), condition.trim().trim_start_matches('(').trim_end_matches(')').trim()))
}

/// The comparison, if a condition is exactly one comparison with a dimension.
fn dimension_condition(condition: &str) -> Option<(LimitKind, Limit)> {
    let (word, bound) = condition.split_once('>')?;
    let kind = LimitKind::of_condition(word.trim())?;
    // The rest is a number with its unit, or more than a comparison (`weight>7.5 AND 22:00-06:00`), which stays
    // undecided.
    match kind.read(bound.trim_start_matches('=')) {
        Limit::At(limit) => Some((kind, Limit::At(limit))),
        Limit::None | Limit::Unreadable => None,
    }
}
