//! Which quantity a limit bounds, and what its tags say.

use crate::osm::facts::keys::REMARKS;
use crate::osm::facts::{Legal, Limit, value};

/// Tolerance of comparisons, as in [`super::legal`].
const SLACK: f64 = 1e-3;

/// The quantity that a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitKind {
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

impl LimitKind {
    /// The kind of a key of a limit, without what follows its first colon.
    pub(super) fn of_key(head: &str) -> Option<LimitKind> {
        Some(match head {
            "maxheight" => LimitKind::Height,
            "maxweight" | "maxweightrating" | "maxgcweight" | "maxgcweightrating" => LimitKind::Weight,
            "maxaxleload" => LimitKind::AxleLoad,
            "maxlength" => LimitKind::Length,
            "maxwidth" => LimitKind::Width,
            _ => return None,
        })
    }

    /// The kind of a tag that is a limit of the whole road at all times. The key may name a class or a direction, too, before or after:
    /// `maxheight`, `maxweight:hgv`, `hgv:maxweight:forward`. Lists by lane, conditions and remarks (`source:maxheight`) are none.
    #[must_use]
    pub fn of_tag(key: &str) -> Option<LimitKind> {
        let other = |part: &str| matches!(part, "lanes" | "conditional") || REMARKS.contains(&part);
        if !key.contains("max") || key.split(':').any(other) {
            return None;
        }
        key.split(':').find_map(LimitKind::of_key)
    }

    /// The kind of a word in a condition, as in `no @ (weight>7.5)`.
    pub(super) fn of_condition(word: &str) -> Option<LimitKind> {
        Some(match word {
            "height" => LimitKind::Height,
            "weight" | "weightrating" | "maxweight" | "maxweightrating" | "gcweight" | "gcweightrating" => {
                LimitKind::Weight
            }
            "axleload" => LimitKind::AxleLoad,
            "length" => LimitKind::Length,
            "width" => LimitKind::Width,
            _ => return None,
        })
    }

    /// The greatest value that a sign shows. Greater ones are refused, because their unit is missing (kilograms, centimetres).
    fn greatest(self) -> f32 {
        match self {
            LimitKind::Height => 15.0,
            LimitKind::Weight => 500.0,
            LimitKind::AxleLoad => 60.0,
            LimitKind::Length => 150.0,
            LimitKind::Width => 30.0,
        }
    }

    /// What a tag's value says, in metres or tonnes.
    #[must_use]
    pub fn read(self, text: &str) -> Limit {
        let number = match self {
            LimitKind::Weight | LimitKind::AxleLoad => value::tonnes,
            LimitKind::Height | LimitKind::Length | LimitKind::Width => value::metres,
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
            LimitKind::Height => &mut legal.max_height,
            LimitKind::Weight => &mut legal.max_weight,
            LimitKind::AxleLoad => &mut legal.max_axle_load,
            LimitKind::Length => &mut legal.max_length,
            LimitKind::Width => &mut legal.max_width,
        }
    }
}
