//! Errors of a file. Each names the file, the byte at which the blob starts, and a remedy.

use std::{fmt, io, path::PathBuf};

use thiserror::Error;

use super::wire::WireError;

/// Why a file was not read. A file with this error gives no partial result.
#[derive(Debug, Error)]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Offset at which the faulty blob starts (its four-byte length), from 0. `None` for the file as a whole.
    pub offset: Option<u64>,
    /// The fault.
    #[source]
    pub problem: PbfProblem,
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

/// The fault of a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PbfProblem {
    /// An error of the operating system.
    #[error("cannot read: {0}")]
    Io(io::Error),
    /// A directory, a pipe, a device.
    #[error("not a regular file")]
    NotAFile,
    /// No bytes at all.
    #[error("empty file")]
    Empty,
    /// Another format under a `.pbf` name. The text names it, and the command converts it.
    #[error("not a PBF file, but {what}")]
    NotPbf {
        /// Apparent format.
        what: &'static str,
        /// Remedy.
        remedy: &'static str,
    },
    /// The file ends too early.
    #[error("truncated: the file ends inside {0}")]
    Truncated(&'static str),
    /// The file's size or modification time changed during reading.
    #[error("the file changed while it was read")]
    Changed,
    /// An impossible length.
    #[error("{what} is {found}, allowed is {allowed}")]
    Size {
        /// Name of the length.
        what: &'static str,
        /// Value found.
        found: i64,
        /// Allowed values, as text.
        allowed: &'static str,
    },
    /// Data before the first `OSMHeader`.
    #[error("no OSMHeader before the data")]
    NoHeader,
    /// The file requires a feature that this reader lacks.
    #[error("the file requires the feature {0:?}, which is not supported")]
    Feature(String),
    /// A full-history file.
    #[error("a full-history file (HistoricalInformation), but a snapshot is needed")]
    History,
    /// A compression that is not supported.
    #[error("unsupported blob compression {0}")]
    Compression(&'static str),
    /// The compressed data is damaged.
    #[error("cannot inflate the {compression} blob: {detail}")]
    Inflate {
        /// Name of the compression.
        compression: &'static str,
        /// The decoder's message.
        detail: String,
    },
    /// Inflated data differs in size from the blob's `raw_size`.
    #[error("raw_size says {declared} bytes, but the data inflates to {found}")]
    RawSize {
        /// `raw_size`
        declared: usize,
        /// `more`, or a number.
        found: String,
    },
    /// Not well-formed protobuf.
    #[error("damaged message: {0}")]
    Wire(#[from] WireError),
    /// The generated parser refused a message.
    #[error("damaged {what}: {detail}")]
    Message {
        /// Name of the message.
        what: &'static str,
        /// The parser's message.
        detail: String,
    },
    /// A required field is missing.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// An index out of range.
    #[error("{object}: string {index} of a table of {strings}")]
    StringIndex {
        /// The object.
        object: ObjectId,
        /// Index found.
        index: u64,
        /// Number of entries in the block's string table.
        strings: usize,
    },
    /// A tag that is not text.
    #[error("{object}: a tag is not valid UTF-8")]
    Utf8 {
        /// The object.
        object: ObjectId,
    },
    /// Arrays that belong together differ in length.
    #[error("{object}: {what} differ in number")]
    Lengths {
        /// The object.
        object: ObjectId,
        /// Names of the arrays.
        what: &'static str,
    },
    /// A sum of deltas exceeds 64 bits.
    #[error("{object}: {what} beyond 64 bits")]
    Overflow {
        /// The object.
        object: ObjectId,
        /// The summed quantity.
        what: &'static str,
    },
    /// More objects than this program's indices can hold.
    #[error("more than 4,294,967,295 {0}")]
    TooLarge(&'static str),
}

/// The object of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjectId {
    /// Way with this id.
    Way(i64),
    /// Node with this id.
    Node(i64),
    /// Relation with this id.
    Relation(i64),
    /// The nodes of a dense group; no single one.
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

impl PbfProblem {
    /// What the user can do.
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
