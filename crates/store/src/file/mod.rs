//! The file itself: its connection, its schema, how rows are inserted in bulk, how shapes are encoded, and how the content is hashed.
//! Nothing here knows what the tables mean.

pub(crate) mod blob;
pub(crate) mod bulk;
pub(crate) mod companions;
pub(crate) mod digest;
pub(crate) mod schema;
pub(crate) mod session;
pub(crate) mod unfinished_file;
