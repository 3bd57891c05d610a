//! A web server that shows one certified database on a map, and takes measurements if it is told to.
//!
//! - Every answer comes from the current state of the database file.
//! - Every piece of work is bounded in size, time and number.
//! - The server answers only requests that are meant for it, and only the addresses of its own tables.
//! - Every answer that says `safe` also says the scope of `safe`.
//! - Only measurements can be changed, only if an option says so, and only as `netcert evidence` does.
//! - There is no log-in and no encryption, so the server listens on loopback only, unless told otherwise.
//!
//! | file | for |
//! | --- | --- |
//! | `options` | options of the command line, and all bounds |
//! | `run` | listening, connections, stopping |
//! | `routes` | the endpoint of every address |
//! | `gate` | checks of every request, security headers of every response |
//! | `ids` | ids of edges as text |
//! | `editing` | who may change measurements |
//! | `lines` | log lines for the operator of the server |
//! | `ask` | names and parameters of a request |
//! | `answer`, `cache` | entity tags, compression, conditional requests; the cache of answers |
//! | `problem` | errors, as problem+json |
//! | `app`, `work` | the state that requests share; lanes for work that blocks |
//! | `state` | what requests are answered from: the region, the older database, and the last results of long work |
//! | `region`, `roads` | one state of the database file; the network in memory |
//! | `older`, `changes` | the older database beside it; what changed since then |
//! | `planning`, `drive` | routes, and how a vehicle drives along one |
//! | `memo` | values that are made on first use; the last results of long work |
//! | `search` | roads by what people type |
//! | `tiles` | vector tiles |
//! | `api` | the JSON interface, one file for each endpoint |
//! | `ogc` | OGC API – Features |
//! | `assets` | the page |
//!
//! No module uses one above it. From below:
//!
//! 1. `options`, `editing`, `ids`, `lines`, `problem`, `ask`, `answer`, `cache`, `memo`, `work` know no database.
//! 2. `roads`, `search` and `region` read one file.
//! 3. `older`, `changes`, `planning`, `drive` and `tiles` make results from regions. Each defines how many of its results are kept.
//! 4. `api` and `ogc` answer from the values that an endpoint needs. `state` puts these values together.
//! 5. `app`, `gate`, `assets`, `routes` and `run` connect requests to them.

use netcert_base::{speed_profile, stop, vehicle, verdict, words};
use netcert_certify as certify;
use netcert_certify::reporter;
use netcert_explain as explain;
use netcert_explain::diff;
use netcert_kernel::stet;
use netcert_osm::osm;
use netcert_picture as picture;
use netcert_roads::{corridor, network, turns};
use netcert_route as route;
use netcert_rows as rows;
use netcert_rows::settings;
use netcert_store as store;

mod answer;
mod api;
mod app;
mod ask;
mod assets;
mod cache;
mod changes;
mod drive;
mod editing;
mod gate;
mod ids;
mod lines;
mod memo;
mod ogc;
mod older;
mod options;
mod planning;
mod problem;
mod region;
mod roads;
mod routes;
mod run;
mod search;
mod state;
mod tiles;
mod work;

pub use options::{BaseMap, Editing, LaneLimits, Limits, ServerOptions};
pub use run::{ServeError, Server};
