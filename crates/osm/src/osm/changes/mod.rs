//! Changes of a map (`.osc`, `.osc.gz`): which objects were created, modified or deleted since an extract.
//!
//! Of several changes of one object the one with the greatest version counts, and among equal versions the later one. An extract that is
//! read with changes is the same as one to which another program has applied them.

mod error;
mod read;

use std::collections::BTreeMap;

pub use error::ChangeError;
use serde::{Deserialize, Serialize};

use super::LonLat;

/// Kinds of objects, in the order of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum ObjectKind {
    /// A node.
    Node,
    /// A way.
    Way,
    /// A relation.
    Relation,
}

impl ObjectKind {
    /// The word for the kind.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Node => "node",
            Self::Way => "way",
            Self::Relation => "relation",
        }
    }
}

/// Keys and values, in the order of the file.
pub type TagList = Vec<(String, String)>;

/// An object as it is after a change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Object {
    /// A node with its position.
    Node {
        /// Position.
        place: LonLat,
        /// Its tags.
        tags: TagList,
    },
    /// A way.
    Way {
        /// Node ids along it.
        refs: Vec<i64>,
        /// Its tags.
        tags: TagList,
    },
    /// A relation.
    Relation {
        /// Kind, id and role of each member.
        members: Vec<(ObjectKind, i64, String)>,
        /// Its tags.
        tags: TagList,
    },
}

/// The state of an object after a change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectChange {
    /// The object's version; 0 if the file has none.
    pub version: u64,
    /// The object; `None` if it was deleted.
    pub object: Option<Object>,
}

/// Changes by object.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Changes {
    objects: BTreeMap<(ObjectKind, i64), ObjectChange>,
    /// The latest time stamp of a change, as the files have it; nothing if none has one.
    newest: Option<String>,
}

impl Changes {
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// Number of objects that changed.
    #[must_use]
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// Adds a later change.
    pub fn add(&mut self, kind: ObjectKind, id: i64, change: ObjectChange) {
        let known = self.objects.get(&(kind, id));
        if known.is_none_or(|known| known.version <= change.version) {
            self.objects.insert((kind, id), change);
        }
    }

    /// Adds later changes.
    pub fn merge(&mut self, later: Self) {
        self.newest = later.newest.max(self.newest.take());
        later.objects.into_iter().for_each(|((kind, id), change)| self.add(kind, id, change));
    }

    /// Notes the time stamp of a change, such as `2026-11-21T08:00:00Z`. Their order is that of time.
    fn note_time(&mut self, time: &str) {
        if self.newest.as_deref().is_none_or(|newest| newest < time) {
            self.newest = Some(time.to_owned());
        }
    }

    /// The latest time stamp of a change; nothing if no file had any.
    #[must_use]
    pub fn newest(&self) -> Option<&str> {
        self.newest.as_deref()
    }

    /// Whether an object of this kind and id was changed, so that an older one does not count.
    #[must_use]
    pub fn has(&self, kind: ObjectKind, id: i64) -> bool {
        !self.objects.is_empty() && self.objects.contains_key(&(kind, id))
    }

    /// The objects that exist after the changes, in the order of files.
    pub fn objects(&self) -> impl Iterator<Item = (i64, &Object)> {
        self.objects.iter().filter_map(|((_, id), change)| Some((*id, change.object.as_ref()?)))
    }
}
