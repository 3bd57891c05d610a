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
//! | give permits to routing engines and map programs | [`export`] |
//! | follow long work | [`reporter::Reporter`] |
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
//! # What is promised
//!
//! These names, their paths and their meaning stay within a minor version, such as 0.2. Enumerations of errors and of a verdict's reasons are
//! `#[non_exhaustive]`: they may get more cases. A match on a reason needs a last case, which must not mean `safe`.
//!
//! | module | names |
//! | --- | --- |
//! | [`region`] | `Region`, `RegionError` |
//! | [`pipeline`] | `EDGES_AT_ONCE`, `Ingest`, `RunError`, `Selection`, `ingest` |
//! | [`settings`] | `Settings` |
//! | [`osm::facts`] | `Countries`, `Policy`, `WidthSource` |
//! | [`reporter`] | `Reporter`, `Silent` |
//! | [`stop`] | `Stop`, `Stopped` |
//! | [`watch`] | `Patience`, `set_patience` |
//! | [`vehicle`] | `Catalogue`, `Vehicle`, `VehicleError` |
//! | [`verdict`] | `ForbiddenReason`, `UnknownReason`, `UnsafeReason`, `Verdict` |
//! | [`words`] | `Named`, `VerdictKind`, `verdict_words` |
//! | [`store`] | `Area`, `Database`, `QueryOptions`, `StoreError`, `TurnQuery` |
//! | [`rows`] | `Bounds`, `EdgeRow`, `TurnRow` |
//! | [`network`] | `Network` |
//! | [`route`] | `Answer`, `Measure`, `Planner`, `Position`, `Question`, `Route`, `Unanswered`, `geojson` |
//! | [`explain`] | `Explanation`, `explain_corridor`, `words` |
//! | [`corridor`] | `Drawn`, `FileCorridor`, `FileError`, `corridor_from_file` |
//! | [`stet`] | `Certificate`, `Model`, `ModelError`, `Options`, `certify` |
//! | [`certificate`] | `CertificateError`, `Origin`, `text`, `text_under` |
//! | [`check`] | `Report`, `certificate` |
//! | [`verify`] | `Request`, `Verification`, `VerifyError`, `verify` |
//! | [`sign`] | `KeyError`, `NotSigned`, `PrivateKey`, `PublicKey`, `Refusal`, `SignError`, `Signed`, `Signer` |
//! | [`sign`] | `check_database`, `check_document`, `sign_database`, `sign_document` |
//! | [`picture`] | `explanation`, `route`, `vehicle` |
//! | [`export`] | `Ask`, `ExportError`, `Out`, `PermitPolicy`, `Source`, `Unfinished`, `export` |
//! | [`export::formats`] | `Options`, `named` |
//!
//! Everything else that can be reached is hidden from this documentation. The project's own program and tests use it, and it may change at
//! any time, also where a promised type has it in a field.
//!
//! # Features and crates
//!
//! | feature | brings |
//! | --- | --- |
//! | `cli` (default) | the program, and all below |
//! | `export` | [`export`]: what routing engines and map programs read (Parquet, FlatGeobuf) |
//! | `overture` | `overture`: Overture's files as a source (Parquet) |
//! | `serve` | `serve`: the map's web server (hyper, axum) |
//!
//! Some modules come from crates that need neither PROJ nor SQLite nor a web server; take those where they do.
//! `netcert-base` has [`vehicle`], [`verdict`], `speed_profile` (when a vehicle is where) and [`stop`]. `netcert-kernel` has [`stet`] and
//! `published`. `netcert-check` is what [`check`] stands on.
//!
//! # The pipeline
//!
//! The modules are the pipeline, in the order in which data flows; nothing flows back:
//!
//! | stage | module | from → to |
//! | --- | --- | --- |
//! | read | [`osm`] | a `.osm.pbf` file → `osm::Extract`: drivable ways as facts, and where their nodes are |
//! | read | `overture` | Overture's segments and connectors → the same `Extract` |
//! | network | [`network`] | `Extract` → [`network::Network`]: directed edges, cross sections, strokes |
//! | corridors | [`corridor`] | a stroke → `corridor::StrokeCorridor`: C¹ centreline and width profile, in metres |
//! | certificates | [`stet`] | a corridor and a [`vehicle`] → [`stet::Certificate`] |
//! | the paper | `published` | a corridor and a vehicle → the paper's own certificate, to the letter; it decides nothing |
//! | turns | `turns` | two strokes that meet → the corridors in which one turns from one into the other |
//! | evidence | `evidence` | files with measurements → rows, and the edges or junctions that they mean |
//! | whole networks | `certify` | network and vehicles → certificates of edges and turns, over threads |
//! | store | [`store`] | network, turns and certificates → a GeoPackage |
//! | routes | [`route`] | a network with permits, two places → the shortest way that certifies as a whole |
//! | files | [`certificate`] | a certificate → the file that `verify` checks |
//! | what changed | `diff` | two databases and a vehicle → what became safe, unsafe, forbidden, conditional |
//! | exports | [`export`] | a database and a vehicle → what routing engines and map programs read |
//! | many machines | `cluster` | the tasks of a region, and their results, as tables |
//! | reasons | [`explain`] | an edge or corridor and a vehicle → what limits, where, and what would do |
//! | manoeuvres | `manoeuvres` | a vehicle → swept paths of the turns that regulators ask for, beside their limits |
//! | pictures | [`picture`] | corridors, vehicles and certificates → SVG; of the library only `serve` depends on it |
//! | the map | `serve` | a database → a web server: vector tiles, a JSON interface, a page |
//!
//! [`check`] works out again what [`stet`] claims, without it.
//!
//! [`settings`] are what a certificate depends on besides network and vehicle. [`pipeline`] runs the stages in that order.

#[doc(hidden)]
pub use netcert_base::speed_profile;
#[doc(hidden)]
pub use netcert_certify as certify;
#[doc(hidden)]
pub use netcert_evidence as evidence;
#[doc(hidden)]
pub use netcert_explain::{diff, manoeuvres};
#[cfg(feature = "export")]
#[doc(hidden)]
pub use netcert_export::cluster;
#[doc(hidden)]
pub use netcert_files::seal;
#[doc(hidden)]
pub use netcert_kernel::published;
#[doc(hidden)]
pub use netcert_osm::account;
#[cfg(feature = "overture")]
#[doc(hidden)]
pub use netcert_overture as overture;
#[doc(hidden)]
pub use netcert_pipeline::program;
#[doc(hidden)]
pub use netcert_roads::turns;
#[cfg(feature = "serve")]
#[doc(hidden)]
pub use netcert_serve as serve;

pub mod certificate;
pub mod region;
pub mod sign;

pub mod check {
    //! Checks certificate files by code of its own.
    //!
    //! ```
    //! use netcert::check;
    //!
    //! // The example of the crate's documentation writes a file, and checks it.
    //! let report = check::certificate("this is no certificate");
    //! assert!(!report.confirmed());
    //! for (claim, outcome) in &report.claims {
    //!     println!("{claim}: {outcome:?}");
    //! }
    //! ```

    #[doc(inline)]
    pub use netcert_verify::check::{Report, certificate};

    #[doc(hidden)]
    pub use netcert_verify::check::*;
}

pub mod corridor {
    //! Corridors that a user draws, in metres or in degrees.
    //!
    //! ```
    //! use netcert::corridor::{Drawn, FileError};
    //!
    //! let points = vec![[0.0, 0.0], [100.0, 0.0]];
    //! let aisle = Drawn { points: points.clone(), width_m: Some(vec![3.5]), ..Drawn::default() }.corridor()?;
    //! // A station each metre, the ends included.
    //! assert_eq!(aisle.corridor.len(), 101);
    //!
    //! let without_width = Drawn { points, ..Drawn::default() }.corridor();
    //! assert!(matches!(without_width, Err(FileError::Centreline(_))));
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_roads::corridor::{Drawn, FileCorridor, FileError, corridor_from_file};

    #[doc(hidden)]
    pub use netcert_roads::corridor::*;
}

pub mod explain {
    //! Why a vehicle fits or does not. [`Region::explain`](crate::region::Region::explain) explains roads.
    //!
    //! ```
    //! use netcert::corridor::Drawn;
    //! use netcert::explain::{explain_corridor, words};
    //! use netcert::stet::{Model, Options};
    //! use netcert::stop::Stop;
    //! use netcert::vehicle::Catalogue;
    //!
    //! let points = vec![[0.0, 0.0], [60.0, 0.0], [120.0, 0.0]];
    //! let narrow = Drawn { points, width_m: Some(vec![2.4]), ..Drawn::default() }.corridor()?;
    //! let model = Model::new(Catalogue::builtin()?.get("EU-SEMI16.5")?)?;
    //! let explained = explain_corridor(&narrow.corridor, &model, &Options::default(), &Stop::never())?;
    //! let (certificate, explanation) = explained.expect("the corridor has stations");
    //! assert!(!certificate.result.safe());
    //! // A semi-trailer is 2.55 m wide.
    //! assert!(words(&explanation).headline.starts_with("unsafe: 0.20 m too narrow"));
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_explain::{Explanation, explain_corridor, words};

    #[doc(hidden)]
    pub use netcert_explain::*;
}

#[cfg(feature = "export")]
pub mod export {
    //! Permits for routing engines and map programs. `docs/export` has a page for each target.
    //!
    //! ```
    //! # let (folder, db) = netcert_testing::documentation::junction_region();
    //! use netcert::export::{Ask, Out, PermitPolicy, Source, Unfinished, export, formats};
    //! use netcert::osm::facts::Policy;
    //! use netcert::reporter::Silent;
    //!
    //! let ask = Ask {
    //!     db,
    //!     vehicle: "AGV-TUG4".to_owned(),
    //!     policy: Policy::Carriageway,
    //!     rule: PermitPolicy { min_rsc_m: 0.5, ..PermitPolicy::default() },
    //!     at: None,
    //!     extract: None,
    //!     relative_to: None,
    //! };
    //! let source = Source::open(ask, &Silent)?;
    //! assert_eq!((source.permitted.edge_tally.permitted, source.permitted.edge_tally.total()), (6, 6));
    //!
    //! let out = folder.path().join("permits");
    //! let csv = formats::named("csv").expect("netcert export lists it");
    //! export(&source, csv, &formats::Options::default(), Out::Path(out.clone()), Unfinished::default())?;
    //! assert!(out.join("edges.csv").exists() && out.join("turns.csv").exists());
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_export::{Ask, ExportError, Out, PermitPolicy, Source, Unfinished, export};

    #[doc(hidden)]
    pub use netcert_export::*;

    pub mod formats {
        //! The formats, by their names on the command line.

        #[doc(inline)]
        pub use netcert_export::formats::{Options, named};

        #[doc(hidden)]
        pub use netcert_export::formats::*;
    }
}

pub mod network {
    //! Roads as directed edges.
    //!
    //! ```
    //! # let (_folder, path) = netcert_testing::documentation::junction_region();
    //! use netcert::network::Network;
    //! use netcert::region::Region;
    //!
    //! let roads = Region::open(&path)?.roads()?;
    //! let network: &Network = &roads.network;
    //! let kilometres = network.edges.iter().map(|edge| network.length_m(edge) / 1000.0).sum::<f64>();
    //! // Three roads of about 330 m meet, and each is an edge in both directions.
    //! assert_eq!(network.edges.len(), 6);
    //! assert!((1.9..2.1).contains(&kilometres));
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_roads::network::Network;

    #[doc(hidden)]
    pub use netcert_roads::network::*;
}

pub mod osm {
    //! What is read from OpenStreetMap.

    #[doc(hidden)]
    pub use netcert_osm::osm::*;

    pub mod facts {
        //! What follows from tags: which width counts, where it comes from, and the rules of countries.

        #[doc(inline)]
        pub use netcert_osm::osm::facts::{Countries, Policy, WidthSource};

        #[doc(hidden)]
        pub use netcert_osm::osm::facts::*;
    }
}

pub mod picture {
    //! Pictures, as the text of SVG files.
    //!
    //! ```
    //! use netcert::picture;
    //! use netcert::vehicle::Catalogue;
    //!
    //! let catalogue = Catalogue::builtin()?;
    //! let svg = picture::vehicle(catalogue.get("AU-ATRIPLE53")?);
    //! assert!(svg.starts_with("<svg") && svg.contains("AU-ATRIPLE53"));
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_picture::{explanation, route, vehicle};

    #[doc(hidden)]
    pub use netcert_picture::*;
}

pub mod pipeline {
    //! From an extract to a database.
    //!
    //! ```
    //! # let folder = tempfile::tempdir()?;
    //! # let extract = netcert_testing::documentation::junction(folder.path());
    //! use netcert::osm::facts::{Countries, Policy};
    //! use netcert::pipeline::{EDGES_AT_ONCE, Ingest, Selection, ingest};
    //! use netcert::reporter::Silent;
    //! use netcert::settings::Settings;
    //! use netcert::vehicle::Catalogue;
    //!
    //! let ask = Ingest {
    //!     inputs: &[extract.as_path()],
    //!     db: &folder.path().join("region.gpkg"),
    //!     catalogue: &Catalogue::builtin()?,
    //!     selection: &Selection::Ids(vec!["AGV-TUG4".to_owned()]),
    //!     countries: &Countries::load()?,
    //!     settings: &Settings { policy: Policy::Carriageway, ..Settings::default() },
    //!     edges_at_once: EDGES_AT_ONCE,
    //!     parameters: serde_json::json!({}),
    //!     now: &|| "2026-11-21T08:00:00.000Z".to_owned(),
    //! };
    //! let summary = ingest(&ask, &Silent)?;
    //! assert_eq!(summary.vehicles, ["AGV-TUG4"]);
    //! assert!(ask.db.exists());
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_pipeline::{EDGES_AT_ONCE, Ingest, RunError, Selection, ingest};

    #[doc(hidden)]
    pub use netcert_pipeline::*;
}

pub mod reporter {
    //! How far long work is.
    //!
    //! ```
    //! use std::sync::Mutex;
    //!
    //! use netcert::reporter::Reporter;
    //!
    //! /// Keeps the names of the stages.
    //! #[derive(Default)]
    //! struct Stages(Mutex<Vec<&'static str>>);
    //!
    //! impl Reporter for Stages {
    //!     fn begin(&self, stage: &'static str, _total: u64) {
    //!         self.0.lock().expect("no thread panics").push(stage);
    //!     }
    //!     fn advance(&self, _done: u64) {}
    //!     fn end(&self) {}
    //!     fn note(&self, _text: &str) {}
    //! }
    //!
    //! let stages = Stages::default();
    //! // `ingest` and the others call it like this.
    //! let reporter: &dyn Reporter = &stages;
    //! reporter.begin("network", 0);
    //! reporter.end();
    //! assert_eq!(*stages.0.lock().expect("no thread panics"), ["network"]);
    //! ```

    #[doc(inline)]
    pub use netcert_certify::reporter::{Reporter, Silent};
}

pub mod route {
    //! Certified routes, or what blocks them. [`Region::planner`](crate::region::Region::planner) makes a planner.
    //!
    //! ```
    //! # let (_folder, path) = netcert_testing::documentation::junction_region();
    //! use netcert::osm::facts::Policy;
    //! use netcert::region::Region;
    //! use netcert::route::{Answer, Measure, Position, Question, geojson};
    //! use netcert::stop::Stop;
    //!
    //! let mut planner = Region::open(&path)?.planner("AGV-TUG4", Policy::Carriageway, Measure::Distance)?;
    //! let places = vec![Position { lon: 0.001, lat: 0.0 }, Position { lon: 0.003, lat: 0.002 }];
    //! let question = Question { places, snap_m: 50.0, alternatives: 0, tries: 30 };
    //! let answer: Answer = planner.answer(&question, &Stop::never())?;
    //! // 223 m straight on, then a turn to the left and 221 m.
    //! assert!(answer.routes[0].certificate.result.safe());
    //! assert!((430.0..450.0).contains(&answer.routes[0].length_m));
    //!
    //! let map = geojson(planner.network(), &planner.driver().model, &answer)?;
    //! assert_eq!(map["type"], "FeatureCollection");
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_route::{Answer, Measure, Planner, Position, Question, Route, Unanswered, geojson};

    #[doc(hidden)]
    pub use netcert_route::*;
}

pub mod rows {
    //! Roads and turns with their certificates, as rows. `docs/columns.md` has the units.

    #[doc(inline)]
    pub use netcert_rows::{Bounds, EdgeRow, TurnRow};

    #[doc(hidden)]
    pub use netcert_rows::*;
}

pub mod settings {
    //! What a certificate depends on besides network and vehicle.

    #[doc(inline)]
    pub use netcert_rows::settings::Settings;

    #[doc(hidden)]
    pub use netcert_rows::settings::*;
}

pub mod stet {
    //! The certificate of one vehicle on one corridor.
    //!
    //! ```
    //! use netcert::corridor::Drawn;
    //! use netcert::stet::{Certificate, Model, Options, certify};
    //! use netcert::stop::Stop;
    //! use netcert::vehicle::Catalogue;
    //!
    //! let points = vec![[0.0, 0.0], [60.0, 0.0], [120.0, 15.0]];
    //! let bend = Drawn { points, width_m: Some(vec![7.0]), ..Drawn::default() }.corridor()?;
    //! let model = Model::new(Catalogue::builtin()?.get("EU-SEMI16.5")?)?;
    //! // The steer axle is to follow the centreline.
    //! let options = Options { max_shift_m: 0.0, ..Options::default() };
    //! let certificate: Certificate = certify(&bend.corridor, &model, &options, &Stop::never())?.expect("stations");
    //! assert!(certificate.result.safe() && certificate.result.rsc_m > Some(1.5));
    //! assert!(certificate.shift_m.iter().all(|&shift_m| shift_m == 0.0));
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_kernel::stet::{Certificate, Model, ModelError, Options, certify};

    #[doc(hidden)]
    pub use netcert_kernel::stet::*;
}

pub mod stop {
    //! Ends long work from another thread.
    //!
    //! ```
    //! use netcert::stop::{Stop, Stopped};
    //!
    //! let stop = Stop::default();
    //! let of_the_user = stop.clone();
    //! assert_eq!(stop.check(), Ok(()));
    //! std::thread::spawn(move || of_the_user.tell()).join().expect("it only tells");
    //! // Whatever was called with `&stop` now ends with this error, within moments.
    //! assert_eq!(stop.check(), Err(Stopped));
    //! ```

    #[doc(inline)]
    pub use netcert_base::stop::{Stop, Stopped};
}

pub mod store {
    //! Databases, and queries of them. [`Region`](crate::region::Region) answers most questions.
    //!
    //! ```
    //! # let (_folder, path) = netcert_testing::documentation::junction_region();
    //! use netcert::osm::facts::Policy;
    //! use netcert::region::Region;
    //! use netcert::rows::{Bounds, EdgeRow};
    //! use netcert::store::{Area, QueryOptions};
    //!
    //! let north = Area::Bounds(Bounds { west: 0.0, south: 0.001, east: 0.01, north: 0.01 });
    //! let options = QueryOptions { area: Some(north), ..QueryOptions::new("AGV-TUG4", Policy::Carriageway) };
    //! let edges: Vec<EdgeRow> = Region::open(&path)?.edges(&options)?.collect::<Result<_, _>>()?;
    //! // The side road, in both directions.
    //! assert_eq!(edges.iter().map(|edge| edge.road.highway.as_str()).collect::<Vec<_>>(), ["residential"; 2]);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_store::{Area, Database, QueryOptions, StoreError, TurnQuery};

    #[doc(hidden)]
    pub use netcert_store::*;
}

pub mod vehicle {
    //! Articulated vehicles: those that ship, and your own in the form of `data/vehicles.toml`.
    //!
    //! ```
    //! use netcert::vehicle::{Catalogue, Vehicle, VehicleError};
    //!
    //! let catalogue = Catalogue::builtin()?;
    //! let semi: &Vehicle = catalogue.get("EU-SEMI16.5")?;
    //! assert_eq!((semi.units.len(), semi.length_m), (2, 16.5));
    //!
    //! // The error names the ids that may be meant.
    //! let Err(VehicleError::Unknown { nearest, .. }) = catalogue.get("eu semi 16.5") else { panic!("ids are exact") };
    //! assert_eq!(nearest[0], "EU-SEMI16.5");
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_base::vehicle::{Catalogue, Vehicle, VehicleError};

    #[doc(hidden)]
    pub use netcert_base::vehicle::*;
}

pub mod verdict {
    //! What can be said of a road and a vehicle, with the reason.
    //!
    //! ```
    //! use netcert::verdict::{UnsafeReason, Verdict};
    //!
    //! fn advice(verdict: Verdict) -> &'static str {
    //!     match verdict {
    //!         Verdict::Safe => "take it",
    //!         Verdict::Unsafe(UnsafeReason::Width) => "measure how wide it is",
    //!         // Reasons that are yet to come, too.
    //!         Verdict::Unsafe(_) | Verdict::Forbidden(_) | Verdict::Unknown(_) => "avoid it",
    //!     }
    //! }
    //! assert_eq!(advice(Verdict::Unsafe(UnsafeReason::SteeringLock)), "avoid it");
    //! ```

    #[doc(inline)]
    pub use netcert_base::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};
}

pub mod verify {
    //! A second opinion on a whole database.
    //!
    //! ```
    //! # let (_folder, path) = netcert_testing::documentation::junction_region();
    //! use netcert::stop::Stop;
    //! use netcert::verify::{Request, Verification, verify};
    //!
    //! let request = Request { vehicles: vec!["AGV-TUG4".to_owned()], ..Request::default() };
    //! let found: Verification = verify(&path, &request, &Stop::never(), &mut |_| {})?;
    //! for complaint in found.complaints() {
    //!     println!("{}: {}", complaint.grade.word(), complaint.detail);
    //! }
    //! assert!(found.confirmed());
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```

    #[doc(inline)]
    pub use netcert_verify::{Request, Verification, VerifyError, verify};

    #[doc(hidden)]
    pub use netcert_verify::*;
}

pub mod watch {
    //! How long one piece of work may take: a stroke, a turn, a search.
    //!
    //! ```
    //! use netcert::watch::{Patience, set_patience};
    //!
    //! // Work is named as slow after 5 s of processor time, and ended after 60 s.
    //! let patience = Patience::seconds(5, 60);
    //! assert!(patience.end_after < Patience::REGION.end_after);
    //! // From now on, for the whole process.
    //! set_patience(patience);
    //! ```

    #[doc(inline)]
    pub use netcert_base::watch::{Patience, set_patience};

    #[doc(hidden)]
    pub use netcert_base::watch::*;
}

pub mod words {
    //! The words of databases, exports and options.
    //!
    //! ```
    //! use netcert::osm::facts::Policy;
    //! use netcert::verdict::{UnsafeReason, Verdict};
    //! use netcert::words::{Named, VerdictKind, verdict_words};
    //!
    //! assert_eq!(Policy::named("carriageway"), Some(Policy::Carriageway));
    //! assert_eq!(VerdictKind::Safe.name(), "safe");
    //! assert_eq!(verdict_words(Verdict::Unsafe(UnsafeReason::Width)), ("unsafe", "width"));
    //! ```

    #[doc(inline)]
    pub use netcert_base::words::{Named, VerdictKind, verdict_words};

    #[doc(hidden)]
    pub use netcert_base::words::*;
}
