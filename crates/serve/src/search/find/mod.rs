//! The index of all roads and named places by their words, and the search in it.
//!
//! Every word of the region's names stands in one sorted list. For each typed word, every word of the list gets a [`Fit`]. Then all roads
//! are looked at. What fits worse is tried only if nothing fits better: first whole words, beginnings and middles, then slips, then
//! words that the road does not have. A road is also found by its name together with that of the place that it lies in.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::abbreviations::Abbreviations;
use super::fold;
use super::settlement::{Settlement, Settlements};
use super::typo::{self, Compared};
use super::whole::{WholeRoad, edges_of, refs, whole_roads};
use crate::network::Network;
use crate::osm::LonLat;

/// More typed words are not looked at.
const MOST_WORDS: usize = 8;
/// Where fewer roads fit as typed, those are looked for, too, that fit with a slip.
const FEW: usize = 4;
/// The greatest number of a road's ways that are asked in which place they lie.
const MOST_PLACES: usize = 16;
/// The position of words that name the place of a road. By these words alone no road is found.
const OF_TOWN: u8 = u8::MAX;
/// Parts of words are looked for from this number of letters on.
const LEAST_WITHIN: usize = 3;

/// How a word of a road fits a typed word, the best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fit {
    Whole,
    Beginning,
    Within,
    /// So many half slips.
    Slip(u8),
    Not,
}

/// How exactly a word must be as it was typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Spelling {
    AsTyped,
    WithSlips,
}

/// How a road fits what was typed, the best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in super::super) enum MatchRank {
    /// All of the name, or the ref.
    Exact,
    /// The name begins so.
    Prefix,
    /// Words of the name, or their beginnings.
    Words,
    /// Parts of words.
    Within,
    /// With so many half slips.
    Slips(u8),
    /// Without so many of the typed words.
    Without(u8),
}

/// What the index has.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) enum Subject {
    Road {
        road: WholeRoad,
        /// The named place in which it lies, if it is one.
        town: Option<Box<str>>,
    },
    Settlement(Settlement),
}

impl Subject {
    /// Named places before roads, then by size.
    fn order(&self) -> (u8, f64) {
        match self {
            Self::Settlement(place) => (0, -place.reach_m()),
            Self::Road { road, .. } => (1, -f64::from(road.length_m)),
        }
    }
}

/// A road or a named place that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Found<'f> {
    pub(in super::super) rank: MatchRank,
    pub(in super::super) subject: &'f Subject,
}

/// The words of a road or place. `words` are pairs of a position in the name and a word of the list, which may stand there.
struct Entry {
    subject: Subject,
    /// The number of words of the name. The words of refs and of the road's place come after it.
    named: u8,
    words: Box<[(u8, u32)]>,
    /// The folded ref without spaces, if the road is one by its ref.
    reference: Option<Box<str>>,
}

/// A road with what else it is found by.
struct IndexedRoad {
    road: WholeRoad,
    /// The refs of its ways, folded, if it is one by its name.
    refs: Vec<String>,
    /// Where it lies.
    places: Vec<LonLat>,
}

/// A typed word.
struct Typed {
    /// How each word of the list fits.
    fits: Vec<Fit>,
    /// Whether the word tells one road from others: no number, no short form, no `street`.
    telling: bool,
    /// Whether that is so, too, if it fits with a slip.
    slips_tell: bool,
}

/// The roads and named places of a region, to be searched.
pub(in super::super) struct Finder {
    abbreviations: Abbreviations,
    /// All words of all roads and places, sorted.
    words: Vec<Box<str>>,
    entries: Vec<Entry>,
    settlements: Settlements,
}

impl Finder {
    /// # Errors
    /// The shipped table of short forms cannot be read, which a test rules out.
    pub(in super::super) fn new(network: &Network, settlements: Settlements) -> Result<Self, toml::de::Error> {
        let indexed = |road: WholeRoad| {
            let refs = if road.by_ref { Vec::new() } else { refs_of(network, &road) };
            let places = places_of(network, &road);
            IndexedRoad { road, refs, places }
        };
        Self::of(whole_roads(network).into_iter().map(indexed), settlements)
    }

    fn of(roads: impl Iterator<Item = IndexedRoad>, settlements: Settlements) -> Result<Self, toml::de::Error> {
        let abbreviations = Abbreviations::builtin()?;
        let mut numbers: FxHashMap<Box<str>, u32> = FxHashMap::default();
        let mut words: Vec<Box<str>> = Vec::new();
        let mut number = |word: String| {
            *numbers.entry(word.into_boxed_str()).or_insert_with_key(|word| {
                words.push(word.clone());
                words.len() as u32 - 1
            })
        };
        let mut entries = Vec::new();
        let places =
            settlements.all().iter().map(|one| (Subject::Settlement(one.clone()), Vec::new(), BTreeSet::new()));
        let roads = roads.map(|IndexedRoad { road, refs, places }| {
            let towns: BTreeSet<&str> =
                places.into_iter().filter_map(|at| settlements.around(at)).map(|town| &*town.name).collect();
            let town = towns.first().filter(|_| towns.len() == 1).map(|&name| name.into());
            (Subject::Road { road, town }, refs, towns)
        });
        for (subject, of_refs, towns) in places.chain(roads) {
            let (text, by_ref) = match &subject {
                Subject::Settlement(place) => (&*place.name, false),
                Subject::Road { road, .. } => (&*road.text, road.by_ref),
            };
            let name = fold::words(text);
            let of_town: BTreeSet<String> = towns.into_iter().flat_map(fold::words).collect();
            let named = name.len().min(usize::from(u8::MAX / 2));
            // `Goethe Straße` is also found as `goethestr`.
            let joined = (0..).zip(name.windows(2).take(named).map(<[String]>::concat));
            let of_refs = (named as u8..).zip(of_refs.into_iter().take(usize::from(u8::MAX / 2)));
            let of_town = of_town.into_iter().map(|word| (OF_TOWN, word));
            let all = (0..).zip(name.iter().take(named).cloned()).chain(joined).chain(of_refs).chain(of_town);
            let words =
                all.flat_map(|(at, word)| abbreviations.meanings(&word).into_iter().map(move |word| (at, word)));
            let words = words.map(|(at, word)| (at, number(word))).collect();
            let reference = by_ref.then(|| name.concat().into_boxed_str());
            entries.push(Entry { subject, named: named as u8, words, reference });
        }
        // Sorted, so that beginnings are found by halving.
        let mut order: Vec<u32> = (0..words.len() as u32).collect();
        order.sort_by(|&a, &b| words[a as usize].cmp(&words[b as usize]));
        let mut place = vec![0; words.len()];
        for (new, &old) in (0..).zip(&order) {
            place[old as usize] = new;
        }
        for entry in &mut entries {
            for word in &mut entry.words {
                word.1 = place[word.1 as usize];
            }
        }
        words.sort_unstable();
        Ok(Self { abbreviations, words, entries, settlements })
    }

    /// All roads, in the order of their names.
    pub(in super::super) fn roads(&self) -> impl Iterator<Item = &WholeRoad> {
        self.entries.iter().filter_map(|entry| match &entry.subject {
            Subject::Road { road, .. } => Some(road),
            Subject::Settlement(_) => None,
        })
    }

    /// The named place that a position belongs to.
    pub(in super::super) fn town(&self, at: LonLat) -> Option<&Settlement> {
        self.settlements.around(at)
    }

    /// The roads and places that fit a text, the best first: by rank, then places by kind, then roads by length.
    pub(in super::super) fn find(&self, text: &str) -> Vec<Found<'_>> {
        let mut typed = fold::words(text);
        typed.truncate(MOST_WORDS);
        if typed.is_empty() {
            return Vec::new();
        }
        let asked_ref = self.abbreviations.reference(&typed);
        let typed = self.with_refs(typed);
        let exact: Vec<Typed> = typed.iter().map(|word| self.typed(word, Spelling::AsTyped)).collect();
        let mut found = self.ranked(&exact, &asked_ref, 0);
        let few = found.len() < FEW;
        if few {
            let slips: Vec<Typed> = typed.iter().map(|word| self.typed(word, Spelling::WithSlips)).collect();
            let without = (0..typed.len() as u8).map(|without| self.ranked(&slips, &asked_ref, without));
            // Words are left out only where nothing else is found.
            let most = if found.is_empty() { typed.len() } else { 1 };
            let more = without.take(most).find(|found| !found.is_empty()).unwrap_or_default();
            let new: Vec<Found<'_>> =
                more.into_iter().filter(|hit| !found.iter().any(|one| one.subject == hit.subject)).collect();
            found.extend(new);
        }
        let order = |hit: &Found<'_>| hit.subject.order();
        found.sort_by(|a, b| {
            a.rank.cmp(&b.rank).then(order(a).0.cmp(&order(b).0)).then(order(a).1.total_cmp(&order(b).1))
        });
        found
    }

    /// Joins the two words of a ref, such as `us 30`, if there is such a ref. A number by itself may be that of a house.
    fn with_refs(&self, typed: Vec<String>) -> Vec<String> {
        let mut joined: Vec<String> = Vec::new();
        for word in typed {
            let both = joined
                .last()
                .filter(|_| word.starts_with(|c: char| c.is_ascii_digit()))
                .map(|letters| format!("{letters}{word}"));
            let known = both.filter(|both| self.words.binary_search_by(|known| (**known).cmp(both)).is_ok());
            if known.is_some() {
                joined.pop();
            }
            joined.push(known.unwrap_or(word));
        }
        joined
    }

    fn typed(&self, word: &str, spelling: Spelling) -> Typed {
        let letters = word.chars().count();
        let plain = letters >= 4 && word.chars().all(char::is_alphabetic) && !self.abbreviations.knows(word);
        // `5th`, not the `12a` of a house.
        let ordinal =
            ["st", "nd", "rd", "th"].iter().any(|end| word.strip_suffix(end).is_some_and(|n| n.parse::<u16>().is_ok()));
        Typed { fits: self.fits(word, spelling), telling: plain || ordinal, slips_tell: letters >= 6 }
    }

    /// How each word of the list fits a typed word. With slips, also the words that nearly fit.
    fn fits(&self, typed: &str, spelling: Spelling) -> Vec<Fit> {
        let mut fits = vec![Fit::Not; self.words.len()];
        let letters: Vec<char> = typed.chars().collect();
        if letters.len() >= LEAST_WITHIN {
            for (fit, word) in fits.iter_mut().zip(&self.words) {
                if word.contains(typed) {
                    *fit = Fit::Within;
                }
            }
        }
        let begin = self.words.partition_point(|word| &**word < typed);
        for (fit, word) in fits.iter_mut().zip(&self.words).skip(begin) {
            if !word.starts_with(typed) {
                break;
            }
            *fit = Fit::Beginning;
        }
        for meaning in self.abbreviations.meanings(typed) {
            if let Ok(at) = self.words.binary_search_by(|word| (**word).cmp(&meaning)) {
                fits[at] = Fit::Whole;
            }
        }
        let most = typo::allowed(letters.len());
        if spelling == Spelling::WithSlips && most > 0 {
            let mut word_letters = Vec::new();
            for (fit, word) in fits.iter_mut().zip(&self.words).filter(|(fit, _)| **fit == Fit::Not) {
                word_letters.clear();
                word_letters.extend(word.chars());
                // The first letter is rarely wrong, and one that fits spares most comparisons.
                let near = word_letters.iter().take(2).any(|letter| letters.first() == Some(letter));
                let slips =
                    |compared| typo::slips(&letters, &word_letters, most, compared).map(|slips| 2 * slips as u8);
                // A word that fits only at its beginning is half a slip worse.
                if let Some(slips) =
                    near.then(|| slips(Compared::WholeWord).or_else(|| Some(slips(Compared::Beginning)? + 1))).flatten()
                {
                    *fit = Fit::Slip(slips);
                }
            }
        }
        fits
    }

    /// The roads that have all typed words but `without` of them.
    fn ranked(&self, typed: &[Typed], asked_ref: &str, without: u8) -> Vec<Found<'_>> {
        let rank = |entry: &Entry| match &entry.reference {
            Some(own) if **own == *asked_ref => Some(MatchRank::Exact),
            Some(own) if own.starts_with(asked_ref) && without == 0 => Some(MatchRank::Within),
            // The same number with other letters: `OH 315` for `SR 315`.
            Some(own) if without == 1 && same_number(own, asked_ref) => Some(MatchRank::Without(1)),
            _ => entry.rank(typed, without),
        };
        self.entries.iter().filter_map(|entry| Some(Found { rank: rank(entry)?, subject: &entry.subject })).collect()
    }
}

/// Whether two folded refs have letters and then the same number.
fn same_number(a: &str, b: &str) -> bool {
    let parts = |text: &str| text.find(|c: char| c.is_ascii_digit()).filter(|&at| (1..=3).contains(&at));
    parts(a).zip(parts(b)).is_some_and(|(at_a, at_b)| a[at_a..] == b[at_b..])
}

impl Entry {
    fn rank(&self, typed: &[Typed], without: u8) -> Option<MatchRank> {
        let (mut worst, mut slips, mut missing) = (Fit::Whole, 0_u8, 0_u8);
        let (mut in_order, mut known) = (true, false);
        // Words that the road's place has, too, find the place, and not every road in it.
        let (mut all_own, mut one_own) = (true, false);
        for (i, Typed { fits, telling, slips_tell }) in (0..).zip(typed) {
            let best = |of_town: bool| {
                let words = self.words.iter().filter(|(at, _)| (*at == OF_TOWN) == of_town);
                words.map(|&(at, word)| (fits[word as usize], at != i)).min().unwrap_or((Fit::Not, true))
            };
            let (own, of_town) = (best(false), best(true));
            all_own &= own.0 != Fit::Not;
            one_own |= own.0 != Fit::Not && of_town.0 == Fit::Not;
            let (fit, elsewhere) = if own.0 <= Fit::Within || own.0 <= of_town.0 { own } else { of_town };
            match fit {
                Fit::Not => missing += 1,
                Fit::Slip(number) => slips += number,
                _ => {}
            }
            known |= *telling && (own.0 < Fit::Within || (*slips_tell && matches!(own.0, Fit::Slip(_))));
            in_order &= !elsewhere;
            if fit != Fit::Not {
                worst = worst.max(fit);
            }
        }
        let all_named = typed.len() == usize::from(self.named);
        match () {
            () if !(all_own || one_own) || missing > without || (missing > 0 && !known) => None,
            () if missing > 0 => Some(MatchRank::Without(missing)),
            () if slips > 0 => Some(MatchRank::Slips(slips)),
            () if worst == Fit::Within => Some(MatchRank::Within),
            () if in_order && all_named && worst == Fit::Whole => Some(MatchRank::Exact),
            () if in_order && typed.len() <= usize::from(self.named) => Some(MatchRank::Prefix),
            () => Some(MatchRank::Words),
        }
    }
}

/// Where a road lies: a position of some of its ways.
fn places_of(network: &Network, road: &WholeRoad) -> Vec<LonLat> {
    let every = road.ways.len().div_ceil(MOST_PLACES).max(1);
    let first = |&way: &u32| {
        let edge = network.edges.get(edges_of(network, way).next()?.index())?;
        network.positions(edge).next()
    };
    road.ways.iter().step_by(every).filter_map(first).collect()
}

/// The refs of a road's ways, folded and without spaces.
fn refs_of(network: &Network, road: &WholeRoad) -> Vec<String> {
    let mut ids: Vec<u32> = Vec::new();
    for way in &road.ways {
        let id = network.roads.get(*way as usize).and_then(|road| road.reference).map(|id| id.0);
        if let Some(id) = id.filter(|id| !ids.contains(id)) {
            ids.push(id);
        }
    }
    let texts = ids.iter().map(|&id| network.strings.text(crate::osm::StringId(id)));
    let mut words: Vec<String> = texts.flat_map(refs).map(fold::reference).collect();
    words.sort_unstable();
    words.dedup();
    words
}

#[cfg(test)]
mod tests;
