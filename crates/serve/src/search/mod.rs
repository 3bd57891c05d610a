//! Finds roads and named places by what people type: short forms, other spelling, slips, house styles of refs, and extra words.
//!
//! | file | for |
//! | --- | --- |
//! | `fold` | capitals, accents, punctuation |
//! | `abbreviations` | short forms of words, from `data/abbreviations.toml` |
//! | `typo` | slips |
//! | `whole` | ways of one name or ref that lie near each other are one road |
//! | `settlement` | towns, villages and other named places, and which of them a road lies in |
//! | `find` | the index of a region's roads and places, and the order of what is found |
//! | `place` | coordinates |

mod abbreviations;
mod find;
mod fold;
mod place;
mod settlement;
mod typo;
mod whole;

pub(super) use find::{Finder, Subject};
pub(super) use place::coordinates;
pub(super) use settlement::{KINDS, Settlement, Settlements};
pub(super) use whole::{WholeRoad, edges_of};
