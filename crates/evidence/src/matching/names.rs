//! Whether the name of a row is that of a road.
//!
//! Case, spaces and hyphens do not matter, nor the common short form of the German street. Other spellings differ, and a row
//! whose name differs from the road's is reported.

use crate::network::{Network, Road};

/// What names say of a road.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fit {
    /// Row and road have the same name.
    Same,
    /// One of them has none.
    Unknown,
    /// They have different names.
    Differs,
}

/// The name of a row, prepared for comparing.
pub(super) struct RowName(Option<String>);

impl RowName {
    pub(super) fn of(name: Option<&str>) -> Self {
        Self(name.map(plain).filter(|name| !name.is_empty()))
    }

    /// What the road's name or number says.
    pub(super) fn fit(&self, network: &Network, road: &Road) -> Fit {
        let Some(own) = &self.0 else { return Fit::Unknown };
        let texts: Vec<&str> =
            [road.name, road.reference].into_iter().flatten().map(|id| network.strings.text(id)).collect();
        // Several numbers of a road are separated by semicolons.
        let same = texts.iter().flat_map(|text| text.split(';').chain([*text])).any(|text| plain(text) == *own);
        match (same, texts.is_empty()) {
            (true, _) => Fit::Same,
            (false, true) => Fit::Unknown,
            (false, false) => Fit::Differs,
        }
    }
}

/// The name of a road for messages.
pub(super) fn told<'n>(network: &'n Network, road: &Road) -> &'n str {
    road.name.or(road.reference).map_or("without a name", |id| network.strings.text(id))
}

fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| !c.is_whitespace() && !"-‐–".contains(*c)).flat_map(char::to_lowercase);
    let name: String = letters.collect::<String>().replace('ß', "ss");
    name.strip_suffix("str.").map(|street| format!("{street}strasse")).unwrap_or(name)
}
