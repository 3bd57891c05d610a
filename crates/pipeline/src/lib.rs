//! Runs the stages in order: read, network, corridors and certificates, store.
//!
//! [`ingest()`] makes a database from an extract. [`certify()`] adds or replaces certificates in an existing database. Both run the
//! same stages on the same network, so the same edge and vehicle get the same bytes. [`netcert_certify`] makes the certificates.
//! Progress is reported through [`Reporter`](reporter::Reporter), so this module does not depend on command lines or terminals.
//!
//! | file | for |
//! | --- | --- |
//! | `program`, `identity` | which program this is, and on what the work of a run depends |
//! | `error`, `summary` | why a run fails, and what it did |
//! | `vehicle_record`, `select` | the record of a vehicle, and the vehicles of a run |
//! | `source`, `roads` | what a map is read from, and its roads as portions |
//! | `edge_verdicts`, `share` | verdicts that turns need, and the progress of one portion |
//! | `recertification` | what a change touches, certified again in every set of a database |
//! | `reuse`, `amendment` | what stands of an earlier database, and the rows of it that change in place |
//! | `tasks`, `task_results` | a region as tasks of other machines, and what these made |
//! | `certifier` | the certificates of a new database, portion by portion |
//! | `new_database` | what a database is made from |
//! | `steps` | the stages in their order |
//! | `ingest`, `assemble`, `update` | a database from an extract, from results of tasks, and from newer data |
//! | `replacement`, `evidence` | new certificates and measurements in an existing database |

use netcert_base::{stop, vehicle, verdict, words};
use netcert_certify as certify;
use netcert_certify::reporter;
use netcert_kernel::stet;
use netcert_osm::{account, osm};
#[cfg(feature = "overture")]
use netcert_overture as overture;
use netcert_roads::{network, turns};
use netcert_rows as rows;
use netcert_rows::settings;
use netcert_store as store;

mod amendment;
mod assemble;
mod certifier;
mod edge_verdicts;
mod error;
mod evidence;
mod identity;
mod ingest;
mod new_database;
pub mod program;
mod recertification;
mod replacement;
mod reuse;
mod roads;
mod select;
mod share;
mod source;
mod steps;
mod summary;
mod task_results;
mod tasks;
mod update;
mod vehicle_record;

pub use assemble::{Assemble, assemble};
pub use error::RunError;
pub use evidence::{EvidenceChange, EvidenceChanged, SetChanged, What, change_evidence};
pub use ingest::{Ingest, ingest};
pub use recertification::VerdictChanges;
pub use replacement::{Certify, certify};
pub use roads::{EDGES_AT_ONCE, read_network};
pub use select::{Selection, own_countries, selected};
pub use summary::{StageSummary, Summary, TurnWork};
pub use task_results::TaskResult;
pub use tasks::{Divided, EDGES_OF_A_TASK, NeededTasks, StrokesDone, Task, TaskError, TaskJob, divide};
pub use update::{Newer, Update, run_of_extract, update};
pub use vehicle_record::record;
