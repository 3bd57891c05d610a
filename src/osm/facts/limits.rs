//! Legal limits per direction of travel, including conditional ones, and their comparison with a vehicle.
//!
//! If several tags limit the same quantity, the strictest counts. A condition that depends on time counts as always
//! fulfilled for numeric limits, and as "not for through traffic" for access.

use crate::osm::facts::access::{Access, is_access_key, permission};
use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::{Direction, Legal, Limit, Permission, value};
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

/// Tolerance of the comparison: tags have two decimals and limits are `f32`, so 2.55 must not exceed 2.55.
const SLACK: f64 = 1e-3;

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

impl Legal {
    /// Merges two sets of rules: the stricter limit of each kind.
    #[must_use]
    pub fn merge(self, other: Legal) -> Legal {
        Legal {
            max_height: self.max_height.stricter(other.max_height),
            max_weight: self.max_weight.stricter(other.max_weight),
            max_axle_load: self.max_axle_load.stricter(other.max_axle_load),
            max_length: self.max_length.stricter(other.max_length),
            max_width: self.max_width.stricter(other.max_width),
            hgv: self.hgv.max(other.hgv),
            motor_vehicle: self.motor_vehicle.max(other.motor_vehicle),
        }
    }

    /// `Forbidden` if a rule excludes the vehicle, `Unknown(Limit)` if only an unreadable limit stands against it,
    /// otherwise `None`. Unknown properties of the vehicle (height, masses) are not compared. `Permission::Restricted`
    /// does not exclude, because a lorry may have its destination here.
    #[must_use]
    pub fn forbids(&self, vehicle: &Vehicle) -> Option<Verdict> {
        if self.motor_vehicle == Permission::No {
            return Some(Verdict::Forbidden(ForbiddenReason::Access));
        }
        if self.hgv == Permission::No {
            return Some(Verdict::Forbidden(ForbiddenReason::Hgv));
        }
        let compared = [
            (self.max_height, vehicle.height_m, ForbiddenReason::Height),
            (self.max_weight, vehicle.gross_mass_t, ForbiddenReason::Weight),
            (self.max_axle_load, vehicle.axle_load_t, ForbiddenReason::AxleLoad),
            (self.max_length, Some(vehicle.length_m), ForbiddenReason::Length),
            (self.max_width, Some(vehicle.width_m()), ForbiddenReason::Width),
        ];
        let mut unreadable = false;
        for (limit, size, reason) in compared {
            match (limit, size) {
                (Limit::At(most), Some(size)) if size > f64::from(most) + SLACK => {
                    return Some(Verdict::Forbidden(reason));
                }
                (Limit::Unreadable, Some(_)) => unreadable = true,
                _ => {}
            }
        }
        unreadable.then_some(Verdict::Unknown(UnknownReason::Limit))
    }
}

/// The quantity that a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Height, metres.
    Height,
    /// Gross mass of the combination, tonnes.
    Weight,
    /// Axle load, tonnes.
    AxleLoad,
    /// Length, metres.
    Length,
    /// Width, metres.
    Width,
}

impl Kind {
    fn of_key(head: &str) -> Option<Kind> {
        Some(match head {
            "maxheight" => Kind::Height,
            "maxweight" | "maxweightrating" | "maxgcweight" | "maxgcweightrating" => Kind::Weight,
            "maxaxleload" => Kind::AxleLoad,
            "maxlength" => Kind::Length,
            "maxwidth" => Kind::Width,
            _ => return None,
        })
    }

    /// The kind of a word in a condition, as in `no @ (weight>7.5)`.
    fn of_condition(word: &str) -> Option<Kind> {
        Some(match word {
            "height" => Kind::Height,
            "weight" | "weightrating" | "maxweight" | "maxweightrating" | "gcweight" | "gcweightrating" => Kind::Weight,
            "axleload" => Kind::AxleLoad,
            "length" => Kind::Length,
            "width" => Kind::Width,
            _ => return None,
        })
    }

    /// The greatest value that a sign shows. Greater ones are refused, because their unit is missing (kilograms, centimetres).
    fn greatest(self) -> f32 {
        match self {
            Kind::Height => 15.0,
            Kind::Weight => 500.0,
            Kind::AxleLoad => 60.0,
            Kind::Length => 150.0,
            Kind::Width => 30.0,
        }
    }

    fn read(self, text: &str) -> Limit {
        let number = match self {
            Kind::Weight | Kind::AxleLoad => value::tonnes,
            Kind::Height | Kind::Length | Kind::Width => value::metres,
        };
        value::limit(text, number, self.greatest())
    }

    /// A limit of metres or tonnes, under the same bounds as a tag.
    #[must_use]
    pub fn at(self, value: f64) -> Limit {
        let most = value as f32;
        if most > 0.0 && most <= self.greatest() { Limit::At(most) } else { Limit::Unreadable }
    }

    /// A limit that bars sizes from this one on, where [`Self::at`] bars greater ones only.
    #[must_use]
    pub fn below(self, value: f64) -> Limit {
        self.at(value - 2.0 * SLACK)
    }

    /// Adds a limit of this kind. The stricter one counts.
    pub fn add(self, legal: &mut Legal, limit: Limit) {
        let slot = self.slot(legal);
        *slot = slot.stricter(limit);
    }

    fn slot(self, legal: &mut Legal) -> &mut Limit {
        match self {
            Kind::Height => &mut legal.max_height,
            Kind::Weight => &mut legal.max_weight,
            Kind::AxleLoad => &mut legal.max_axle_load,
            Kind::Length => &mut legal.max_length,
            Kind::Width => &mut legal.max_width,
        }
    }
}

/// Limits and access of one way or node while its tags are read.
#[derive(Debug, Default)]
pub(super) struct LegalTags {
    limits: [Legal; 2],
    pub(super) access: Access,
}

impl LegalTags {
    /// Takes a tag if its key (split at the first colon) concerns limits or access.
    pub(super) fn take(&mut self, head: &str, suffix: &str, text: &str, notes: &mut Notes) {
        let conditional = suffix == "conditional" || suffix.ends_with(":conditional");
        let plain =
            if conditional { suffix.strip_suffix("conditional").unwrap_or("").trim_end_matches(':') } else { suffix };
        if let Some(kind) = Kind::of_key(head) {
            self.take_limit(kind, plain, text, conditional, notes);
        } else if is_access_key(head) {
            if conditional {
                self.take_conditional_access(head, plain, text, notes);
            } else {
                self.access.take(head, plain, text, notes);
            }
        }
    }

    fn take_limit(&mut self, kind: Kind, suffix: &str, text: &str, conditional: bool, notes: &mut Notes) {
        let mut directions = [true; 2];
        let mut by_lane = false;
        for part in suffix.split(':').filter(|part| !part.is_empty()) {
            match part {
                "forward" => directions[1] = false,
                "backward" => directions[0] = false,
                "lanes" => by_lane = true,
                "physical" | "legal" | "hgv" | "hgv_articulated" | "trailer" | "goods" => {}
                // For buses, or a remark such as `maxweight:signed=no`.
                _ => return,
            }
        }
        if conditional {
            for (limit, _) in clauses(text) {
                self.limit(kind, kind.read(limit), directions, notes);
            }
        } else if by_lane {
            for limit in text.split('|').filter(|limit| !limit.trim().is_empty()) {
                self.limit(kind, kind.read(limit), directions, notes);
            }
        } else {
            self.limit(kind, kind.read(text), directions, notes);
        }
    }

    fn limit(&mut self, kind: Kind, limit: Limit, directions: [bool; 2], notes: &mut Notes) {
        if limit == Limit::Unreadable {
            notes.add(Note::BadLimit);
        }
        for (legal, on) in self.limits.iter_mut().zip(directions) {
            if on {
                kind.add(legal, limit);
            }
        }
    }

    /// `no @ (weight>7.5)` is a weight limit. `no @ hazmat` does not concern dimensions. Any other condition stays
    /// undecided.
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
                    notes.add(Note::UndecidedCondition);
                    self.access.condition(head, directions, value);
                }
                // A condition under which access is more lenient has no effect.
                _ => {}
            }
        }
    }

    /// The rules of a direction.
    pub(super) fn resolve(&self, direction: Direction) -> Legal {
        let index = usize::from(direction == Direction::Backward);
        let (motor_vehicle, hgv) = self.access.resolve(direction);
        Legal { hgv, motor_vehicle, ..self.limits[index] }
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
fn dimension_condition(condition: &str) -> Option<(Kind, Limit)> {
    let (word, bound) = condition.split_once('>')?;
    let kind = Kind::of_condition(word.trim())?;
    // The rest is a number with its unit, or more than a comparison (`weight>7.5 AND 22:00-06:00`), which stays
    // undecided.
    match kind.read(bound.trim_start_matches('=')) {
        Limit::At(limit) => Some((kind, Limit::At(limit))),
        Limit::None | Limit::Unreadable => None,
    }
}
