//! What can be wrong with a file: each error names the file, the byte where the blob starts, and the way out.

use std::{fmt, io, path::PathBuf};

use thiserror::Error;

use super::wire::WireError;

/// Why a file was not read. A file that gives this error gives nothing else: never a part of itself.
#[derive(Debug, Error)]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Where the blob at fault starts (its four-byte length), counted from 0; `None` for the file as a whole.
    pub offset: Option<u64>,
    /// What is wrong.
    #[source]
    pub problem: Problem,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.display())?;
        if let Some(offset) = self.offset {
            write!(f, "at byte {offset}: ")?;
        }
        write!(f, "{}; {}", self.problem, self.problem.way_out())
    }
}

/// What is wrong with a file.
#[derive(Debug, Error)]
pub enum Problem {
    /// The operating system refused.
    #[error("cannot read: {0}")]
    Io(io::Error),
    /// A directory, a pipe, a device.
    #[error("not a regular file")]
    NotAFile,
    /// No bytes at all.
    #[error("empty file")]
    Empty,
    /// Something else under a `.pbf` name; the text says what, the command how to make a PBF of it.
    #[error("not a PBF file, but {what}")]
    NotPbf {
        /// What it looks like.
        what: &'static str,
        /// The way out.
        remedy: &'static str,
    },
    /// The file ends too early.
    #[error("truncated: the file ends inside {0}")]
    Truncated(&'static str),
    /// Size or time of change differ from what they were when reading began.
    #[error("the file changed while it was read")]
    Changed,
    /// A length that cannot be: the number is what was found.
    #[error("{what} is {found}, allowed is {allowed}")]
    Size {
        /// Which length.
        what: &'static str,
        /// As found.
        found: i64,
        /// For people.
        allowed: &'static str,
    },
    /// Data before the first `OSMHeader`.
    #[error("no OSMHeader before the data")]
    NoHeader,
    /// The file needs something of its reader that this one lacks.
    #[error("the file requires the feature {0:?}, which is not supported")]
    Feature(String),
    /// A full-history file.
    #[error("a full-history file (HistoricalInformation), but a snapshot is needed")]
    History,
    /// A compression that is not built in.
    #[error("unsupported blob compression {0}")]
    Compression(&'static str),
    /// The compressed data is damaged.
    #[error("cannot inflate the {compression} blob: {detail}")]
    Inflate {
        /// Which compression.
        compression: &'static str,
        /// What the decoder says.
        detail: String,
    },
    /// Inflated data has another size than the blob says.
    #[error("raw_size says {declared} bytes, but the data inflates to {found}")]
    RawSize {
        /// `raw_size`
        declared: usize,
        /// `more` or a number.
        found: String,
    },
    /// Not well-formed protobuf.
    #[error("damaged message: {0}")]
    Wire(#[from] WireError),
    /// The generated parser refused.
    #[error("damaged {what}: {detail}")]
    Message {
        /// Which message.
        what: &'static str,
        /// What the parser says.
        detail: String,
    },
    /// A field that must be there is not.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// An index that points nowhere.
    #[error("{object}: string {index} of a table of {strings}")]
    StringIndex {
        /// Which object.
        object: ObjectId,
        /// As found.
        index: u64,
        /// Entries of the block's string table.
        strings: usize,
    },
    /// A tag that is not text.
    #[error("{object}: a tag is not valid UTF-8")]
    Utf8 {
        /// Which object.
        object: ObjectId,
    },
    /// Arrays that belong together differ in length.
    #[error("{object}: {what} differ in number")]
    Lengths {
        /// Which object.
        object: ObjectId,
        /// Which arrays.
        what: &'static str,
    },
    /// A sum of differences leaves 64 bits.
    #[error("{object}: {what} beyond 64 bits")]
    Overflow {
        /// Which object.
        object: ObjectId,
        /// What was added up.
        what: &'static str,
    },
    /// More than this program's indices can hold.
    #[error("more than 4,294,967,295 {0}")]
    TooLarge(&'static str),
}

/// The object that an error is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjectId {
    /// Way with this id.
    Way(i64),
    /// Node with this id.
    Node(i64),
    /// Relation with this id.
    Relation(i64),
    /// The nodes of a dense group, no single one.
    DenseNodes,
}

impl fmt::Display for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Way(id) => write!(f, "way {id}"),
            Self::Node(id) => write!(f, "node {id}"),
            Self::Relation(id) => write!(f, "relation {id}"),
            Self::DenseNodes => write!(f, "dense nodes"),
        }
    }
}

impl Problem {
    /// What the user can do about it.
    #[must_use]
    pub fn way_out(&self) -> &'static str {
        match self {
            Self::Io(_) => "check that the path is right and the file readable",
            Self::NotAFile => "give the path of a .osm.pbf file (a pipe cannot be read twice: save it to a file first)",
            Self::NotPbf { remedy, .. } => remedy,
            Self::Changed => "wait until nothing writes to it, then start again",
            Self::Feature(_) | Self::Compression(_) => {
                "rewrite it with `osmium cat IN.osm.pbf -o OUT.osm.pbf`, or fetch the extract elsewhere"
            }
            Self::History => "make a snapshot with `osmium time-filter IN.osh.pbf -o OUT.osm.pbf`",
            Self::TooLarge(_) => "cut the region into parts, for instance with `osmium extract`",
            _ => "the file is damaged: fetch it again and compare its checksum",
        }
    }
}
