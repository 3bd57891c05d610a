//! Objects with the same id, of which the last one of the file counts.

/// Of several in a row with the same id, the last one stays.
pub(super) fn keep_last<T, I: PartialEq>(sorted: &mut Vec<T>, id: impl Fn(&T) -> I) {
    sorted.dedup_by(|later, earlier| {
        let same = id(later) == id(earlier);
        if same {
            std::mem::swap(later, earlier);
        }
        same
    });
}
