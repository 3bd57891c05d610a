//! For Valhalla: the extract rewritten for its tile builder, and an example request.
//!
//! `extract.osm.pbf` is for `valhalla_build_tiles`. Its tags close roads to all motor vehicles, so the file is for this vehicle
//! only. `request.json` has the costing and the vehicle's dimensions, for Valhalla's own checks of limits.
//!
//! What Valhalla cannot express is refused: a passage is open only where each of its edges and turns is permitted.

use serde_json::{Map, Value, json};

use super::osm_pbf::{Flavour, rewrite};
use super::{Options, Target};
use crate::export::{ExportError, Layout, Place, Source};

/// `valhalla`
pub(super) struct Valhalla;

impl Target for Valhalla {
    fn name(&self) -> &'static str {
        "valhalla"
    }

    fn about(&self) -> &'static str {
        "Valhalla: an extract for its tile builder, and a request with the vehicle's dimensions"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::Folder { target: self.name(), instead: "" }
    }

    fn needs_extract(&self) -> bool {
        true
    }

    fn write(&self, source: &Source<'_>, _: &Options, place: &mut Place) -> Result<(), ExportError> {
        rewrite(source, self.name(), Flavour::Valhalla, place, "extract.osm.pbf")?;
        place.write_whole("request.json", format!("{:#}\n", request(&source.header.provenance.vehicle)).as_bytes())
    }
}

/// Names of dimensions in Valhalla's truck costing and in a vehicle's definition.
const DIMENSIONS: [(&str, &str); 4] =
    [("height", "height_m"), ("length", "length_m"), ("weight", "gross_mass_t"), ("axle_load", "axle_load_t")];

/// The greatest distance over which Valhalla may move a place onto a road, metres.
const SEARCH_CUTOFF_M: u32 = 10;

fn request(vehicle: &Value) -> Value {
    let mut truck: Map<String, Value> = DIMENSIONS
        .iter()
        .filter_map(|(name, ours)| Some(((*name).to_owned(), vehicle.get(ours)?.as_f64()?.into())))
        .collect();
    let units = vehicle.get("unit").and_then(Value::as_array).map_or(&[] as &[Value], Vec::as_slice);
    let width_m = units.iter().filter_map(|unit| unit.get("width_m")?.as_f64()).fold(0.0, f64::max);
    if width_m > 0.0 {
        truck.insert("width".to_owned(), width_m.into());
    }
    // With Valhalla's defaults, a place on a road with few onward roads is moved to a road kilometres away, and a place within 5 m
    // of a crossing is moved to the crossing.
    let place = json!({
        "lat": 0.0, "lon": 0.0,
        "minimum_reachability": 0, "radius": 0, "search_cutoff": SEARCH_CUTOFF_M, "node_snap_tolerance": 0,
    });
    json!({"locations": [place, place], "costing": "truck", "costing_options": {"truck": truck}})
}
