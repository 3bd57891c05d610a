//! The file itself: its schema, its unfinished part, how it is opened, written and hashed.

pub(crate) mod blob;
pub(crate) mod bulk;
pub(crate) mod contents;
pub(crate) mod digest;
pub(crate) mod interrupt;
pub(crate) mod part;
pub(crate) mod placing;
pub(crate) mod schema;
pub(crate) mod session;
pub(crate) mod styles;
