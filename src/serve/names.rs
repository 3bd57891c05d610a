//! Compares road names with what people type: capitals, accents and the spaces of a ref do not matter.

use crate::rows::RoadRow;

/// A way with its name and ref in folded form.
#[derive(Debug)]
pub(super) struct NamedRoad {
    pub(super) row: RoadRow,
    name: String,
    /// The folded ref without spaces.
    reference: String,
}

impl NamedRoad {
    pub(super) fn new(row: RoadRow) -> Self {
        let name = row.name.as_deref().map_or(String::new(), folded);
        let reference = row.reference.as_deref().map_or(String::new(), |text| folded(text).replace(' ', ""));
        Self { row, name, reference }
    }

    /// The rank of the match with `asked`, which must be folded. A lower rank is better; `None` means no match.
    pub(super) fn rank(&self, asked: &str) -> Option<u8> {
        let close = asked.replace(' ', "");
        if self.name == asked || (!self.reference.is_empty() && self.reference.split(';').any(|one| one == close)) {
            Some(0)
        } else if self.name.starts_with(asked) {
            Some(1)
        } else if self.name.match_indices(asked).any(|(at, _)| self.name[..at].ends_with([' ', '-', '.', '/'])) {
            Some(2)
        } else if self.name.contains(asked) || (!close.is_empty() && self.reference.starts_with(&close)) {
            Some(3)
        } else {
            None
        }
    }
}

/// The folded form of a text: lower case, without the accents of European languages, with single spaces.
pub(super) fn folded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.trim().chars().flat_map(char::to_lowercase) {
        match c {
            'ä' | 'á' | 'à' | 'â' | 'ã' | 'å' | 'ą' | 'ă' => out.push('a'),
            'ç' | 'ć' | 'č' => out.push('c'),
            'ď' | 'đ' => out.push('d'),
            'é' | 'è' | 'ê' | 'ë' | 'ę' | 'ě' => out.push('e'),
            'í' | 'ì' | 'î' | 'ï' => out.push('i'),
            'ł' | 'ľ' => out.push('l'),
            'ñ' | 'ń' | 'ň' => out.push('n'),
            'ö' | 'ó' | 'ò' | 'ô' | 'õ' | 'ø' | 'ő' => out.push('o'),
            'ř' => out.push('r'),
            'ś' | 'š' | 'ș' => out.push('s'),
            'ß' => out.push_str("ss"),
            'ť' | 'ț' => out.push('t'),
            'ü' | 'ú' | 'ù' | 'û' | 'ű' | 'ů' => out.push('u'),
            'ý' | 'ÿ' => out.push('y'),
            'ź' | 'ż' | 'ž' => out.push('z'),
            'æ' => out.push_str("ae"),
            'œ' => out.push_str("oe"),
            c if c.is_whitespace() && (out.is_empty() || out.ends_with(' ')) => {}
            c if c.is_whitespace() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::Bounds;

    fn road(name: &str, reference: &str) -> NamedRoad {
        let text = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        let bounds = Bounds { west: 0.0, south: 0.0, east: 0.0, north: 0.0 };
        let (name, reference) = (text(name), text(reference));
        NamedRoad::new(RoadRow { way_id: 1, highway: "primary".into(), name, reference, edge_id: 1, bounds })
    }

    #[test]
    fn accents_capitals_and_spaces_do_not_matter() {
        assert_eq!(folded("  Große  STRASSE é"), "grosse strasse e");
        assert_eq!(road("Große Straße", "").rank(&folded("GROSSE STRASSE")), Some(0));
        assert_eq!(road("", "A 5;B 3").rank(&folded("b3")), Some(0));
    }

    #[test]
    fn better_matches_rank_before_worse_ones() {
        let rank = |name: &str| road(name, "").rank("main");
        assert_eq!(
            [rank("Main"), rank("Main Street"), rank("Old Main Street"), rank("Domain Road")],
            [0, 1, 2, 3].map(Some)
        );
        assert_eq!(rank("High Street"), None);
        assert_eq!(road("", "").rank("x"), None);
    }
}
