//! Short forms of words: `data/abbreviations.toml`, which names its source.

use std::collections::BTreeMap;

use rustc_hash::{FxHashMap, FxHashSet};
use serde::Deserialize;

const TABLE: &str = include_str!("../../../../data/abbreviations.toml");

#[derive(Deserialize)]
struct Table {
    refs: BTreeMap<String, String>,
    #[serde(flatten)]
    languages: BTreeMap<String, Language>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Language {
    #[serde(default)]
    words: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    suffixes: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    ordinals: BTreeMap<String, Vec<String>>,
}

/// The short forms of all languages. A road's language is not known, so they hold everywhere.
pub(super) struct Abbreviations {
    /// By short form: what it may stand for.
    words: FxHashMap<String, Vec<String>>,
    /// Short and long end of compounds.
    suffixes: Vec<(String, String)>,
    /// The words that have short forms, such as `street`.
    long: FxHashSet<String>,
    /// Words before a number, the longest first, and the letters of a ref that they stand for.
    refs: Vec<(String, String)>,
}

impl Abbreviations {
    /// # Errors
    /// The shipped table is no such table, which a test rules out.
    pub(super) fn builtin() -> Result<Self, toml::de::Error> {
        let table: Table = toml::from_str(TABLE)?;
        let (mut words, mut suffixes) = (FxHashMap::<String, Vec<String>>::default(), Vec::new());
        let mut long = FxHashSet::default();
        for language in table.languages.into_values() {
            long.extend(language.words.keys().cloned());
            for (word, short) in language.words.into_iter().chain(language.ordinals) {
                for short in short {
                    let known = words.entry(short).or_default();
                    if !known.contains(&word) {
                        known.push(word.clone());
                    }
                }
            }
            for (suffix, short) in language.suffixes {
                suffixes.extend(short.into_iter().map(|short| (short, suffix.clone())));
            }
        }
        let mut refs: Vec<(String, String)> = table.refs.into_iter().collect();
        refs.sort_by_key(|(words, _)| std::cmp::Reverse(words.len()));
        Ok(Self { words, suffixes, long, refs })
    }

    /// Whether a folded word is a short or long form of the table. Such words are in many names.
    pub(super) fn knows(&self, word: &str) -> bool {
        self.long.contains(word)
            || self.words.get(word).is_some_and(|all| all.iter().any(|word| self.long.contains(word)))
    }

    /// All that a folded word may stand for, itself first.
    pub(super) fn meanings(&self, word: &str) -> Vec<String> {
        let mut all = vec![word.to_owned()];
        all.extend(self.words.get(word).into_iter().flatten().cloned());
        // Three letters at least are the name itself.
        let compound = |(short, long): &(String, String)| {
            let stem = word.strip_suffix(short.as_str()).filter(|stem| stem.chars().count() >= 3)?;
            Some(format!("{stem}{long}"))
        };
        all.extend(self.suffixes.iter().filter_map(compound));
        all
    }

    /// The words as a ref without spaces, with letters for words such as `interstate`.
    pub(super) fn reference(&self, words: &[String]) -> String {
        let text = words.join(" ");
        let known = self.refs.iter().find_map(|(words, letters)| {
            let number = text.strip_prefix(words.as_str())?.strip_prefix(' ')?;
            Some(format!("{letters}{number}"))
        });
        known.unwrap_or(text).replace(' ', "")
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::fold;
    use super::*;

    #[test]
    fn every_entry_is_folded() {
        let table: Table = toml::from_str(TABLE).unwrap();
        let of_language = |language: &Language| -> Vec<String> {
            let both = language.words.iter().chain(&language.suffixes).chain(&language.ordinals);
            both.flat_map(|(word, short)| std::iter::once(word).chain(short).cloned().collect::<Vec<_>>()).collect()
        };
        let mut all: Vec<String> = table.languages.values().flat_map(of_language).collect();
        all.extend(table.refs.into_iter().flat_map(|(words, letters)| [words, letters]));
        assert!(all.len() > 300);
        for word in all {
            assert_eq!(fold::words(&word).join(" "), word);
        }
    }

    #[test]
    fn a_short_form_means_all_its_words() {
        let known = Abbreviations::builtin().unwrap();
        assert!(["street", "saint", "sankt"].iter().all(|word| known.meanings("st").contains(&(*word).to_owned())));
        assert!(known.meanings("hauptstr").contains(&"hauptstrasse".to_owned()));
        assert_eq!(known.meanings("cornell"), ["cornell"]);
        assert_eq!(known.reference(&fold::words("Interstate 5")), "i5");
        assert_eq!(known.reference(&fold::words("State Route 315")), "sr315");
        assert!(known.knows("st") && known.knows("road") && !known.knows("5th") && !known.knows("cornell"));
    }
}
