//! Roads: facts of ways become a network of directed edges, the corridors of its strokes, and the areas and paths of its turns.
//!
//! Knows neither the prover nor the checker nor databases: what both sides are told of a road is made here.

use netcert_base::{vehicle, verdict, watch, words};
use netcert_osm::{account, osm};

pub mod corridor;
pub mod network;
mod number;
pub mod turns;
