//! The certified network on a map: a web server over one database, read-only.
//!
//! Promises: every answer comes from the database as it is now; every piece of work is bounded in size, time and
//! number; no request is answered that is not for this server; no address but its own table is ever looked up. `safe`
//! is never said without its scope. Leaves out: log-in and encryption, which is why it stays on loopback unless told
//! otherwise.
//!
//! | file | for |
//! | --- | --- |
//! | `options` | what the command line says; all bounds |
//! | `run` | listening, connections, stopping |
//! | `routes` | which address is answered by what |
//! | `gate` | what every request and response passes: methods, host, sizes, security headers |
//! | `lines` | what whoever runs the server is told, through `log` |
//! | `ask` | a request's names and parameters |
//! | `answer`, `cache` | entity tags, compression, conditional requests; answers kept |
//! | `problem` | what went wrong, as problem+json |
//! | `app`, `work` | what requests share; lanes for work that blocks |
//! | `region`, `roads` | one state of the file; the network in memory |
//! | `planning`, `drive` | routes, and how a vehicle drives along one |
//! | `recent` | what is made when first asked for; the last results of long work |
//! | `names` | names as people type them |
//! | `tiles` | vector tiles |
//! | `api` | everything else, one file an endpoint |
//! | `assets` | the page |

mod answer;
mod api;
mod app;
mod ask;
mod assets;
mod cache;
mod drive;
mod gate;
mod lines;
mod made_once;
mod names;
mod options;
mod planning;
mod problem;
mod region;
mod roads;
mod routes;
mod run;
mod tiles;
mod work;

pub use options::{BaseMap, LaneLimits, Limits, Options};
pub use run::{ServeError, Server};
