//! For Valhalla: the extract rewritten for its tile builder, and an example request.
//!
//! `extract.osm.pbf` is for `valhalla_build_tiles`. Its tags close roads to all motor vehicles, so the file is for this vehicle
//! only. `request.json` has the costing and the vehicle's dimensions, for Valhalla's own checks of limits. `wider.json` has what a request
//! needs besides to keep to the own lane where it can (`cost_lines.rs`).
//!
//! What Valhalla cannot express is refused: a passage is open only where each of its edges and turns is permitted.

mod cost_lines;

use serde_json::{Map, Value, json};

use super::osm_pbf::{Flavour, rewrite};
use super::{Options, Target};
use crate::{Destination, ExportError, Layout, Source};

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

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        rewrite(source, self.name(), Flavour::Valhalla, destination, "extract.osm.pbf")?;
        cost_lines::write(source, destination)?;
        destination
            .write_whole("request.json", format!("{:#}\n", request(&source.header.provenance.vehicle)).as_bytes())
    }
}

/// Dimensions: their name in Valhalla's truck costing, in a vehicle's definition, and the greatest value that Valhalla 3.9.1 takes. Above it
/// Valhalla counts its default, which is that of a small truck, and gives no error (`findings/valhalla-truck-beyond-range.sh`).
const DIMENSIONS: [(&str, &str, f64); 6] = [
    ("height", "height_m", 10.0),
    ("width", "width_m", 10.0),
    ("length", "length_m", 50.0),
    ("weight", "gross_mass_t", 100.0),
    ("axle_load", "axle_load_t", 40.0),
    ("axle_count", "axles", 20.0),
];

/// The greatest distance over which Valhalla may move a place onto a road, metres.
const SEARCH_CUTOFF_M: u32 = 10;

fn request(vehicle: &Value) -> Value {
    let units = vehicle.get("unit").and_then(Value::as_array).map_or(&[] as &[Value], Vec::as_slice);
    let widths_m = units.iter().filter_map(|unit| unit.get("width_m")?.as_f64());
    let widest_m = widths_m.reduce(f64::max);
    let own = |name: &str| if name == "width_m" { widest_m } else { vehicle.get(name)?.as_f64() };
    let mut truck = Map::new();
    let mut id = vehicle.get("id").and_then(Value::as_str).unwrap_or_default().to_owned();
    for (name, ours, most) in DIMENSIONS {
        let Some(value) = own(ours) else { continue };
        let sent = value.min(most);
        truck.insert(name.to_owned(), if name == "axle_count" { (sent as u32).into() } else { sent.into() });
        if value > most {
            id += &format!("; {name} {value} is sent as {most}, the most that Valhalla takes");
        }
    }
    // With Valhalla's defaults, a place on a road with few onward roads is moved to a road kilometres away, and a place within 5 m
    // of a crossing is moved to the crossing.
    let place = json!({
        "lat": 0.0, "lon": 0.0,
        "minimum_reachability": 0, "radius": 0, "search_cutoff": SEARCH_CUTOFF_M, "node_snap_tolerance": 0,
    });
    json!({"id": id, "locations": [place, place], "costing": "truck", "costing_options": {"truck": truck}})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_has_at_most_what_valhalla_takes_and_says_so() {
        let vehicle = json!({
            "id": "LONG", "length_m": 53.5, "height_m": 4.3, "gross_mass_t": 126.0, "axle_load_t": 9.0, "axles": 26,
            "unit": [{"width_m": 2.5}, {"width_m": 2.6}],
        });
        let request = request(&vehicle);
        let truck = json!({
            "height": 4.3, "width": 2.6, "length": 50.0, "weight": 100.0, "axle_load": 9.0, "axle_count": 20,
        });
        assert_eq!(request["costing_options"]["truck"], truck);
        let id = request["id"].as_str();
        assert_eq!(
            id,
            Some(
                "LONG; length 53.5 is sent as 50, the most that Valhalla takes; weight 126 is sent as 100, the most that Valhalla \
                 takes; axle_count 26 is sent as 20, the most that Valhalla takes"
            )
        );
        let small = request_of_a_lorry();
        assert_eq!(small["id"], "LORRY");
        assert_eq!(small["costing_options"]["truck"], json!({"length": 16.5, "width": 2.55}));
    }

    fn request_of_a_lorry() -> Value {
        request(&json!({"id": "LORRY", "length_m": 16.5, "unit": [{"width_m": 2.55}]}))
    }
}
