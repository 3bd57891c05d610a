//! From a file to a network and its use: the reader's rules, drawn maps, turns, roundabouts, routes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)]

mod antimeridian;
mod areas;
mod backdrop;
mod bends;
mod cells;
mod complexes;
mod conditions;
mod contraflow;
mod corners;
mod corridor_extracts;
mod demo_region;
mod destination_only;
mod drawn_widths;
mod graph_properties;
mod islands;
mod junction_areas;
mod malformed;
mod maps;
mod monotone;
mod needs;
mod portions;
mod reader_rules;
mod restrictions;
mod roundabouts;
mod route_junctions;
mod routes;
mod rungs;
mod tapers;
mod titles;
mod turns;
