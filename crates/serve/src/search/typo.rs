//! Words that differ by a slip or two.

/// The slips that are forgiven in a word of this length, characters. Short words have too many neighbours.
pub(super) fn allowed(length: usize) -> usize {
    match length {
        0..=3 => 0,
        4..=7 => 1,
        _ => 2,
    }
}

/// The number of slips between two words, if it is at most `most`: a letter more, less or other, or two neighbours exchanged
/// (optimal string alignment). `prefix` compares with the beginning of `word` that fits best, for who is still typing.
pub(super) fn slips(typed: &[char], word: &[char], most: usize, prefix: bool) -> Option<usize> {
    if word.len() + most < typed.len() || (!prefix && typed.len() + most < word.len()) {
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
    let found = if prefix { row.iter().copied().min() } else { row.last().copied() };
    found.filter(|&slips| slips <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(a: &str, b: &str, prefix: bool) -> Option<usize> {
        let letters = |text: &str| text.chars().collect::<Vec<_>>();
        slips(&letters(a), &letters(b), allowed(a.chars().count()), prefix)
    }

    #[test]
    fn slips_are_counted_up_to_the_bound() {
        assert_eq!(between("burnsde", "burnside", false), Some(1));
        assert_eq!(between("brunside", "burnside", false), Some(1));
        assert_eq!(between("muehlweg", "muhlweg", false), Some(1));
        assert_eq!(between("burnside", "burnside", false), Some(0));
        assert_eq!(between("brnsd", "burnside", false), None);
        assert_eq!(between("oak", "oat", false), None);
        assert_eq!(between("hauprstr", "hauptstrasse", false), None);
        assert_eq!(between("hauprstr", "hauptstrasse", true), Some(1));
        assert_eq!(between("", "", false), Some(0));
    }
}
