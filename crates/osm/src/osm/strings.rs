//! Names and refs of ways, each text once.

/// An interned string (names, refs) of a [`StringPool`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub struct StringId(pub u32);

/// Interned strings. The same text has the same id, and ids follow first use in way order.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(from = "Vec<Box<str>>", into = "Vec<Box<str>>")]
pub struct StringPool {
    texts: Vec<Box<str>>,
    ids: rustc_hash::FxHashMap<Box<str>, u32>,
}

impl From<Vec<Box<str>>> for StringPool {
    fn from(texts: Vec<Box<str>>) -> Self {
        let ids = texts.iter().cloned().zip(0..).collect();
        Self { texts, ids }
    }
}

impl From<StringPool> for Vec<Box<str>> {
    fn from(pool: StringPool) -> Self {
        pool.texts
    }
}

impl StringPool {
    /// The id of `text`, which is added if it is new.
    pub fn intern(&mut self, text: &str) -> StringId {
        if let Some(&id) = self.ids.get(text) {
            return StringId(id);
        }
        let id = self.texts.len() as u32;
        self.texts.push(text.into());
        self.ids.insert(text.into(), id);
        StringId(id)
    }

    /// All texts, in the order of their ids.
    pub fn texts(&self) -> impl ExactSizeIterator<Item = &str> {
        self.texts.iter().map(|text| &**text)
    }

    /// The text of an id of this pool.
    #[must_use]
    pub fn text(&self, id: StringId) -> &str {
        &self.texts[id.0 as usize]
    }
}
