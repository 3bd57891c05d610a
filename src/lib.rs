//! netcert certifies, edge by edge, on which roads of an OpenStreetMap extract an articulated vehicle fits.
//!
//! `safe` always means: within the stated model, widths and error bounds. `docs/proof.md` has the mathematics.
//!
//! # Use it as a library
//!
//! | to … | take |
//! | --- | --- |
//! | make a database from an extract | [`pipeline::ingest`] |
//! | query roads, plan certified routes, ask why | [`region::Region`] |
//! | certify one corridor | [`corridor::corridor_from_file`], [`stet::certify`] |
//! | write a certificate file, and check one | [`certificate::text`], [`check::certificate`] |
//! | check a database | [`verify::verify`] |
//! | sign either, and check signatures | [`sign`] |
//! | draw any of it | [`picture`] |
//! | cancel long work | [`stop::Stop`], which every long function takes |
//! | bound what one piece of work takes | [`watch::set_patience`] |
//!
//! A corridor of one's own, its certificate, and the second opinion on it:
//!
//! ```
//! use netcert::corridor::corridor_from_file;
//! use netcert::stet::{Model, Options, certify};
//! use netcert::stop::Stop;
//! use netcert::vehicle::Catalogue;
//! use netcert::{certificate, check};
//!
//! let drawn = r#"{"frame": "metres", "points": [[0, 0], [60, 0], [120, 15]], "width_m": 7.0}"#;
//! let corridor = corridor_from_file(drawn)?;
//! let catalogue = Catalogue::builtin()?;
//! let model = Model::new(catalogue.get("EU-SEMI16.5")?)?;
//! let options = Options::default();
//! let certified = certify(&corridor.corridor, &model, &options, &Stop::never())?.expect("the corridor has stations");
//! // Every point of the vehicle keeps at least so far from both edges, whatever the disturbances within their bounds.
//! assert!(certified.result.safe() && certified.result.rsc_m > Some(0.0));
//!
//! let file = certificate::text(&corridor, &model, &certified, &options)?;
//! assert!(check::certificate(&file).confirmed());
//! assert!(!check::certificate(&file.replace("\"safe\":true", "\"safe\":false")).confirmed());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features and crates
//!
//! | feature | brings |
//! | --- | --- |
//! | `cli` (default) | the program, and all below |
//! | `export` | [`export`]: what routing engines and map programs read (Parquet, FlatGeobuf) |
//! | `overture` | [`overture`]: Overture's files as a source (Parquet) |
//! | `serve` | [`serve`]: the map's web server (hyper, axum) |
//!
//! Some modules come from crates that need neither PROJ nor SQLite nor a web server; take those where they do.
//! `netcert-base` has [`vehicle`], [`verdict`], [`speed_profile`] (when a vehicle is where) and [`stop`]. `netcert-kernel` has [`stet`] and
//! [`published`]. `netcert-check` is what [`check`] stands on.
//!
//! # The pipeline
//!
//! The folders are the pipeline, in the order in which data flows; nothing flows back:
//!
//! | stage | folder | from → to |
//! | --- | --- | --- |
//! | read | [`osm`] | a `.osm.pbf` file → [`osm::Extract`]: drivable ways as facts, and where their nodes are |
//! | read | [`overture`] | Overture's segments and connectors → the same `Extract` |
//! | network | [`network`] | `Extract` → [`network::Network`]: directed edges, cross sections, strokes |
//! | corridors | [`corridor`] | a stroke → [`corridor::StrokeCorridor`]: C¹ centreline and width profile, in metres |
//! | certificates | [`stet`] | a corridor and a [`vehicle`] → [`stet::Certificate`] |
//! | the paper | [`published`] | a corridor and a vehicle → the paper's own certificate, to the letter; it decides nothing |
//! | turns | [`turns`] | two strokes that meet → the corridors in which one turns from one into the other |
//! | evidence | [`evidence`] | files with measurements → rows, and the edges or junctions that they mean |
//! | whole networks | [`certify`] | network and vehicles → certificates of edges and turns, over threads |
//! | store | [`store`] | network, turns and certificates → a GeoPackage |
//! | routes | [`route`] | a network with permits, two places → the shortest way that certifies as a whole |
//! | files | [`certificate`] | a certificate → the file that `verify` checks |
//! | what changed | [`diff`] | two databases and a vehicle → what became safe, unsafe, forbidden, conditional |
//! | exports | [`export`] | a database and a vehicle → what routing engines and map programs read |
//! | many machines | [`cluster`] | the tasks of a region, and their results, as tables |
//! | reasons | [`explain`] | an edge or corridor and a vehicle → what limits, where, and what would do |
//! | manoeuvres | [`manoeuvres`] | a vehicle → swept paths of the turns that regulators ask for, beside their limits |
//! | pictures | [`picture`] | corridors, vehicles and certificates → SVG; of the library only `serve` depends on it |
//! | the map | [`serve`] | a database → a web server: vector tiles, a JSON interface, a page |
//!
//! [`check`] works out again what [`stet`] claims, without it.
//!
//! [`settings`] are what a certificate depends on besides network and vehicle. [`pipeline`] runs the stages in that order.

pub use netcert_base::{speed_profile, stop, vehicle, verdict, watch, words};
pub use netcert_certify as certify;
pub use netcert_certify::reporter;
pub use netcert_evidence as evidence;
pub use netcert_explain as explain;
pub use netcert_explain::{diff, manoeuvres};
#[cfg(feature = "export")]
pub use netcert_export as export;
#[cfg(feature = "export")]
pub use netcert_export::cluster;
pub use netcert_files::seal;
pub use netcert_kernel::{published, stet};
pub use netcert_osm::{account, osm};
#[cfg(feature = "overture")]
pub use netcert_overture as overture;
pub use netcert_picture as picture;
pub use netcert_pipeline as pipeline;
pub use netcert_pipeline::program;
pub use netcert_roads::{corridor, network, turns};
pub use netcert_route as route;
pub use netcert_rows as rows;
pub use netcert_rows::settings;
#[cfg(feature = "serve")]
pub use netcert_serve as serve;
pub use netcert_store as store;
pub use netcert_verify as verify;
pub use netcert_verify::check;

pub mod certificate;
pub mod region;
pub mod sign;
