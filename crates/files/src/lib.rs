//! Files beside a database: SQLite files that may be damaged, temporary files, rows sorted in them, and locks of unfinished files.

pub mod output_lock;
pub mod scratch;
pub mod sorter;
pub mod sqlite;
