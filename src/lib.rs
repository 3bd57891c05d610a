//! netcert certifies, edge by edge, on which roads of an OpenStreetMap extract an articulated vehicle fits.
//!
//! The folders are the pipeline, in the order in which data flows; nothing flows back:
//!
//! | stage | folder | from → to |
//! | --- | --- | --- |
//! | read | [`osm`] | a `.osm.pbf` file → [`osm::Extract`]: drivable ways as facts, and where their nodes are |
//! | network | [`network`] | `Extract` → [`network::Network`]: directed edges, cross sections, strokes |
//! | corridors | [`corridor`] | a stroke → [`corridor::StrokeCorridor`]: C¹ centreline and width profile, in metres |
//! | certificates | [`stet`] | a corridor and a [`vehicle`] → [`stet::Certificate`] |
//! | the paper | [`published`] | a corridor and a vehicle → the paper's own certificate, to the letter; it decides nothing |
//! | turns | [`turns`] | two strokes that meet → the corridors in which one turns from one into the other |
//! | whole networks | [`certify`] | network and vehicles → certificates of edges and turns, over threads |
//! | store | [`store`] | network, turns and certificates → a GeoPackage |
//! | routes | [`route`] | a network with permits, two places → the shortest way that certifies as a whole |
//! | files | [`certificate`] | a certificate → the file that `verify` checks |
//! | exports | [`export`] | a database and a vehicle → what routing engines and map programs read |
//! | reasons | [`explain`] | an edge or corridor and a vehicle → what limits, where, and what would do |
//! | manoeuvres | [`manoeuvres`] | a vehicle → swept paths of the turns that regulators ask for, beside their limits |
//! | pictures | [`picture`] | corridors, vehicles and certificates → SVG; of the library only `serve` depends on it |
//! | the map | [`serve`] | a database → a web server: vector tiles, a JSON interface, a page |
//!
//! [`check`] works out again what [`stet`] claims, without it.
//!
//! [`settings`] are what a certificate depends on besides network and vehicle. [`pipeline`] runs the stages in that order.
//!
//! Some modules come from crates that need neither PROJ nor SQLite nor a web server. `netcert-base` has [`vehicle`], [`verdict`],
//! [`speed_profile`] (when a vehicle is where) and [`stop`] (work that may be cut off). `netcert-kernel` has [`stet`] and
//! [`published`].

pub use netcert_base::{speed_profile, stop, vehicle, verdict};
pub use netcert_kernel::{published, stet};

pub mod account;
pub mod certificate;
pub mod certify;
pub mod check;
pub mod corridor;
pub mod explain;
pub mod export;
pub mod manoeuvres;
pub mod network;
pub mod osm;
mod output_lock;
pub mod picture;
pub mod pipeline;
pub mod reporter;
pub mod route;
pub mod rows;
pub mod serve;
pub mod settings;
pub mod store;
pub mod turns;
pub mod words;
