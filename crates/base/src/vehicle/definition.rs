//! A vehicle as files write it: degrees, optional fields, the names of the TOML format. JSON uses the same names.
//!
//! A vehicle read from a file comes back bit for bit through its definition, because each angle is written as the
//! shortest decimal that converts to the same radians.

use serde::{Deserialize, Serialize};

use super::{Unit, Vehicle, defaults};

/// `[[vehicle]]` of a vehicle file. Only `id` and the units are required.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleDefinition {
    /// Letters, digits, `.`, `-` and `_`; unique in its file.
    pub id: String,
    /// Name for people. Default: the id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Region code. Default: empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// Class of `data/classes.toml`. Default: the one of the units, which no rule opens a road for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<String>,
    /// Number of axles. Default: unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axles: Option<u32>,
    /// Overall length. It is checked against the units. Default: their sum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_m: Option<f64>,
    /// Height. Default: unknown, and a tagged height limit then leaves the verdict open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Gross mass of the combination. Default: unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gross_mass_t: Option<f64>,
    /// Load of the heaviest single axle. Default: unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axle_load_t: Option<f64>,
    /// ε, tolerance of the steer axle. Default 0.15.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracking_tolerance_m: Option<f64>,
    /// m, tolerance of the steer axle's course. Default 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracking_heading_deg: Option<f64>,
    /// γ_min, least shrinking of ε. Default 0.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_shrink: Option<f64>,
    /// Where the dimensions come from. Default: empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// `[[vehicle.unit]]`, front to rear.
    pub unit: Vec<UnitDefinition>,
}

/// `[[vehicle.unit]]`. Only `coupling_to_axle_m` is required; see `defaults` for the rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnitDefinition {
    /// Name for people. Default: `unit 1`, `unit 2` …
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// L, front coupling to axle.
    pub coupling_to_axle_m: f64,
    /// d, axle back to rear coupling. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hitch_offset_m: Option<f64>,
    /// f, body ahead of the front coupling. Default 1.6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front_overhang_m: Option<f64>,
    /// r, body behind the axle. Default 4.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rear_overhang_m: Option<f64>,
    /// b, body width. Default 2.6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_m: Option<f64>,
    /// θ, hinge limit. Default 42 for the first unit (its steering lock), 70 for the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_articulation_deg: Option<f64>,
    /// σ, slip of the axle. Default 0.2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sway_deg: Option<f64>,
}

impl VehicleDefinition {
    /// The vehicle with defaults for what is left out. Nothing is checked.
    pub(crate) fn vehicle(&self) -> Vehicle {
        let units: Vec<Unit> = self.unit.iter().enumerate().map(|(i, u)| u.unit(i)).collect();
        let tracking_heading_deg = self.tracking_heading_deg.unwrap_or(defaults::TRACKING_HEADING_DEG);
        Vehicle {
            id: self.id.clone(),
            name: self.name.clone().unwrap_or_else(|| self.id.clone()),
            region: self.region.clone().unwrap_or_default(),
            class: self.class.clone(),
            axles: self.axles,
            length_m: self.length_m.unwrap_or_else(|| closure_m(&units)),
            height_m: self.height_m,
            gross_mass_t: self.gross_mass_t,
            axle_load_t: self.axle_load_t,
            tracking_tolerance_m: self.tracking_tolerance_m.unwrap_or(defaults::TRACKING_TOLERANCE_M),
            tracking_heading_rad: tracking_heading_deg.to_radians(),
            min_shrink: self.min_shrink.unwrap_or(defaults::MIN_SHRINK),
            source: self.source.clone().unwrap_or_default(),
            units,
        }
    }
}

impl UnitDefinition {
    fn unit(&self, index: usize) -> Unit {
        let (front_m, lock_deg) = match index {
            0 => (defaults::FRONT_OVERHANG_FIRST_M, defaults::STEERING_LOCK_DEG),
            _ => (defaults::FRONT_OVERHANG_TRAILER_M, defaults::HINGE_DEG),
        };
        Unit {
            name: self.name.clone().unwrap_or_else(|| format!("unit {}", index + 1)),
            coupling_to_axle_m: self.coupling_to_axle_m,
            hitch_offset_m: self.hitch_offset_m.unwrap_or(defaults::HITCH_OFFSET_M),
            front_overhang_m: self.front_overhang_m.unwrap_or(front_m),
            rear_overhang_m: self.rear_overhang_m.unwrap_or(defaults::REAR_OVERHANG_M),
            width_m: self.width_m.unwrap_or(defaults::WIDTH_M),
            max_articulation_rad: self.max_articulation_deg.unwrap_or(lock_deg).to_radians(),
            sway_rad: self.sway_deg.unwrap_or(defaults::SWAY_DEG).to_radians(),
        }
    }
}

/// Length of the straight vehicle from the front of the foremost body to the rear of the rearmost, metres.
pub(crate) fn closure_m(units: &[Unit]) -> f64 {
    let (mut coupling, mut front, mut rear) = (0.0_f64, f64::NEG_INFINITY, f64::INFINITY);
    for unit in units {
        let axle = coupling - unit.coupling_to_axle_m;
        front = front.max(coupling + unit.front_overhang_m);
        rear = rear.min(axle - unit.rear_overhang_m);
        coupling = axle - unit.hitch_offset_m;
    }
    if units.is_empty() { 0.0 } else { front - rear }
}

impl Vehicle {
    /// The whole definition in file units. Only unknown fields are left out.
    #[must_use]
    pub fn definition(&self) -> VehicleDefinition {
        VehicleDefinition {
            id: self.id.clone(),
            name: Some(self.name.clone()),
            region: Some(self.region.clone()),
            class: self.class.clone(),
            axles: self.axles,
            length_m: Some(self.length_m),
            height_m: self.height_m,
            gross_mass_t: self.gross_mass_t,
            axle_load_t: self.axle_load_t,
            tracking_tolerance_m: Some(self.tracking_tolerance_m),
            tracking_heading_deg: Some(degrees(self.tracking_heading_rad)),
            min_shrink: Some(self.min_shrink),
            source: Some(self.source.clone()),
            unit: self.units.iter().map(unit_definition).collect(),
        }
    }

    /// The definition as JSON, in the field order of the TOML format.
    ///
    /// # Errors
    /// None for a vehicle that passed the checks; otherwise serde_json's.
    pub fn to_json(&self) -> Result<serde_json::Value, serde_json::Error> {
        serde_json::to_value(self.definition())
    }
}

fn unit_definition(unit: &Unit) -> UnitDefinition {
    UnitDefinition {
        name: Some(unit.name.clone()),
        coupling_to_axle_m: unit.coupling_to_axle_m,
        hitch_offset_m: Some(unit.hitch_offset_m),
        front_overhang_m: Some(unit.front_overhang_m),
        rear_overhang_m: Some(unit.rear_overhang_m),
        width_m: Some(unit.width_m),
        max_articulation_deg: Some(degrees(unit.max_articulation_rad)),
        sway_deg: Some(degrees(unit.sway_rad)),
    }
}

/// The shortest decimal number of degrees that converts to exactly `radians`. (`to_degrees` turns 42° into
/// 42.00000000000001°.) If there is none, the plain conversion.
fn degrees(radians: f64) -> f64 {
    let plain = radians.to_degrees();
    (0..=15)
        .filter_map(|places| format!("{plain:.places$}").parse::<f64>().ok())
        .find(|rounded| rounded.to_radians().to_bits() == radians.to_bits())
        .unwrap_or(plain)
}
