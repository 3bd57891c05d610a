//! Files beside a database: SQLite files that may be damaged, temporary files, rows sorted in them, locks of unfinished files,
//! files below a folder, calls of libraries that may panic on damaged files, and the seal of certificate files.

pub mod folders;
pub mod output_lock;
pub mod outside;
pub mod scratch;
pub mod seal;
pub mod sorter;
pub mod sqlite;
