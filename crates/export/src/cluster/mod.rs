//! What machines of a cluster read and write: a folder with the tasks of a region, and tables of their results (Parquet).
//!
//! | file | for |
//! | --- | --- |
//! | `folder` | `netcert.json`: what the tasks were made from |
//! | `tasks` | `tasks.parquet`: a group of rows for each task |
//! | `results` | the results that an engine such as Spark wrote |
//!
//! [`crate::pipeline`] makes the tasks and takes the results. Tables hold both as bytes.

mod folder;
mod results;
mod tasks;

use std::path::PathBuf;

pub use folder::{ExtractOrigin, RegionFolder};
pub use results::Results;
pub use tasks::TaskWriter;

/// The file that says what the tasks were made from.
pub const ABOUT: &str = "netcert.json";
/// The table of tasks.
pub const TASKS: &str = "tasks.parquet";
/// The folder of results inside the region's folder, unless another is named.
pub const RESULTS: &str = "certified";

/// Why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file is not what this program wrote.
    #[error("{}: {detail}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what helps.
        detail: String,
    },
}
