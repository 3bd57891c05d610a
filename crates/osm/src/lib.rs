//! Readers of maps: OpenStreetMap extracts and their changes become facts about ways and nodes, with an account of everything left out.
//!
//! Knows neither roads nor certificates nor databases.

use netcert_base::{vehicle, verdict, words};

pub mod account;
pub mod osm;
pub mod shape;
