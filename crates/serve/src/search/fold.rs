//! The form of a text in which capitals, accents and punctuation do not matter.

use unicode_normalization::UnicodeNormalization as _;
use unicode_normalization::char::is_combining_mark;

/// The words of a text: lower case, without accents of any language, cut at all that is neither letter nor digit. An apostrophe within a
/// word is left out.
pub(super) fn words(text: &str) -> Vec<String> {
    let mut folded = String::with_capacity(text.len());
    for c in text.nfkd().filter(|&c| !is_combining_mark(c)).flat_map(char::to_lowercase) {
        match c {
            'ß' => folded.push_str("ss"),
            'æ' => folded.push_str("ae"),
            'œ' => folded.push_str("oe"),
            'þ' => folded.push_str("th"),
            'ø' => folded.push('o'),
            'đ' | 'ð' => folded.push('d'),
            'ł' => folded.push('l'),
            'ħ' => folded.push('h'),
            'ŧ' => folded.push('t'),
            'ı' => folded.push('i'),
            '\'' | '’' | 'ʼ' | '`' | '´' => {}
            // `to_lowercase` of some capitals gives a mark: İ.
            c if is_combining_mark(c) => {}
            c if c.is_alphanumeric() => folded.push(c),
            _ => folded.push(' '),
        }
    }
    folded.split_whitespace().map(str::to_owned).collect()
}

/// A ref without all that house styles differ in: `I-5`, `I 5` and `i5` are `i5`.
pub(super) fn reference(text: &str) -> String {
    words(text).concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capitals_accents_and_punctuation_do_not_matter() {
        assert_eq!(words("  Große  STRASSE, é"), ["grosse", "strasse", "e"]);
        assert_eq!(words("Carrer de l’Estany"), ["carrer", "de", "lestany"]);
        assert_eq!(words("Łódź-İzmir Ørsted Þing"), ["lodz", "izmir", "orsted", "thing"]);
        assert_eq!(words("Ελευθερίας Ёлкина"), ["ελευθεριας", "елкина"]);
        assert_eq!(words("… – ·"), Vec::<String>::new());
        assert_eq!(["I-5", "I 5", "i5"].map(reference), ["i5", "i5", "i5"]);
    }
}
