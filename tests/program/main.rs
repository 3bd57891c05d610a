//! Tests of the built program: verbs as a user sees them, the database, exports and the engines that read them, the server, and
//! what `verify` refutes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)]

mod all_outputs;
mod at_time;
mod cli;
mod columns;
mod conditional;
mod conditions_suffice;
mod corners;
mod counted_work;
mod diff;
mod engines;
mod evidence;
mod explain;
mod explain_shapes;
mod export;
mod export_engines;
mod export_evidence;
mod export_formats;
mod facade;
mod geopackage;
mod gis;
mod manoeuvres;
mod named_tags;
mod overture;
mod pages;
mod paper;
mod patience;
mod relative;
mod resume;
mod route_cli;
mod serve;
mod settings;
mod sign;
mod snapshots;
mod survey;
mod tasks;
mod turns_program;
mod update;
mod vehicle_pictures;
mod verify_database;
mod verify_mutations;
mod verify_routes;
mod verify_turns;
mod walls;
mod widths;
