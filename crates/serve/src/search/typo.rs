//! Words that differ by a slip or two.

/// The slips that are forgiven in a word of this length, characters. Short words have too many neighbours.
pub(super) fn allowed(length: usize) -> usize {
    match length {
        0..=3 => 0,
        4..=7 => 1,
        _ => 2,
    }
}

/// What of a word is compared with what was typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compared {
    /// All of the word.
    WholeWord,
    /// The beginning that fits best, for who is still typing.
    Beginning,
}

/// The number of slips between two words, if it is at most `most`: a letter more, less or other, or two neighbours exchanged
/// (optimal string alignment).
pub(super) fn slips(typed: &[char], word: &[char], most: usize, compared: Compared) -> Option<usize> {
    let whole = compared == Compared::WholeWord;
    if word.len() + most < typed.len() || (whole && typed.len() + most < word.len()) {
        return None;
    }
    let word = &word[..word.len().min(typed.len() + most)];
    let (mut before, mut row): (Vec<usize>, Vec<usize>) = (Vec::new(), (0..=word.len()).collect());
    for (i, &a) in typed.iter().enumerate() {
        let mut next = vec![i + 1; word.len() + 1];
        for (j, &b) in word.iter().enumerate() {
            let mut best = (row[j] + usize::from(a != b)).min(row[j + 1] + 1).min(next[j] + 1);
            if i > 0 && j > 0 && a == word[j - 1] && typed[i - 1] == b {
                best = best.min(before[j - 1] + 1);
            }
            next[j + 1] = best;
        }
        if next.iter().all(|&slips| slips > most) {
            return None;
        }
        before = std::mem::replace(&mut row, next);
    }
    let found = if whole { row.last().copied() } else { row.iter().copied().min() };
    found.filter(|&slips| slips <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(a: &str, b: &str, compared: Compared) -> Option<usize> {
        let letters = |text: &str| text.chars().collect::<Vec<_>>();
        slips(&letters(a), &letters(b), allowed(a.chars().count()), compared)
    }

    #[test]
    fn slips_are_counted_up_to_the_bound() {
        use Compared::{Beginning, WholeWord};
        assert_eq!(between("burnsde", "burnside", WholeWord), Some(1));
        assert_eq!(between("brunside", "burnside", WholeWord), Some(1));
        assert_eq!(between("muehlweg", "muhlweg", WholeWord), Some(1));
        assert_eq!(between("burnside", "burnside", WholeWord), Some(0));
        assert_eq!(between("brnsd", "burnside", WholeWord), None);
        assert_eq!(between("oak", "oat", WholeWord), None);
        assert_eq!(between("hauprstr", "hauptstrasse", WholeWord), None);
        assert_eq!(between("hauprstr", "hauptstrasse", Beginning), Some(1));
        assert_eq!(between("", "", WholeWord), Some(0));
    }
}
