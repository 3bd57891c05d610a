//! Finds roads by what people type: short forms, other spelling, slips, house styles of refs, and extra words.
//!
//! | file | for |
//! | --- | --- |
//! | `fold` | capitals, accents, punctuation |
//! | `abbreviations` | short forms of words, from `data/abbreviations.toml` |
//! | `typo` | slips |
//! | `whole` | ways of one name or ref that lie near each other are one road |
//! | `find` | the index of a region's roads, and the order of what is found |
//! | `place` | coordinates |

mod abbreviations;
mod find;
mod fold;
mod place;
mod typo;
mod whole;

pub(super) use find::Finder;
pub(super) use place::coordinates;
pub(super) use whole::{WholeRoad, edges_of};
