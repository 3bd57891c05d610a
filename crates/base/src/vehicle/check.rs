//! The bounds of a vehicle definition. Each fault names vehicle, field, value and bound, and the line if it is known.
//!
//! The bounds keep out typing errors (a shifted decimal point, degrees for radians) and values that the kinematics
//! cannot handle. They do not say that a vehicle is legal anywhere. All faults are collected.

use super::class::Classes;
use super::collide::{self, BodyEnds, Clash};
use super::definition::{VehicleDefinition, closure_m};
use super::{Unit, Vehicle, VehicleFault};

/// A field of a file: vehicle, unit (if the field is a unit's), field name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FieldPath {
    pub(crate) vehicle: usize,
    pub(crate) unit: Option<usize>,
    pub(crate) field: &'static str,
}

/// Most units of a vehicle. The kernel's cost and the tubes grow with the square of the number; the longest vehicles in
/// service have eight.
const MAX_UNITS: usize = 16;
/// Bounds of texts that reach tables, layer names and pictures.
const MAX_ID_CHARS: usize = 64;
const MAX_NAME_CHARS: usize = 200;
const MAX_SOURCE_CHARS: usize = 4000;
/// Allowed difference between the stated length and the sum of the units: published dimensions are rounded.
const LENGTH_TOLERANCE_M: f64 = 0.1;

/// All faults of `definitions`, in file order. `line_of` returns the line of a field.
pub(crate) fn faults(
    definitions: &[VehicleDefinition],
    line_of: &dyn Fn(FieldPath) -> Option<usize>,
) -> Vec<VehicleFault> {
    let mut check = Check { line_of, vehicle: 0, label: String::new(), faults: Vec::new() };
    for (index, definition) in definitions.iter().enumerate() {
        check.vehicle = index;
        check.label = format!("vehicle {:?}", shown(&definition.id));
        check.id(definition, &definitions[..index]);
        let found = check.faults.len();
        let vehicle = definition.vehicle();
        check.whole(&vehicle);
        check.units(&vehicle.units);
        // Sums of values out of bounds would only repeat the fault.
        if check.faults.len() == found && !vehicle.units.is_empty() {
            check.bodies(&vehicle.units);
            check.length(&vehicle);
        }
        // Bodies that already overlap when the vehicle is straight have been reported.
        if check.faults.len() == found {
            check.turning(&vehicle.units, BodyEnds::Round);
        }
    }
    check.faults
}

/// Warnings about vehicles without a fault. A real vehicle may be so, but somebody should look at it.
pub(crate) fn warnings(
    definitions: &[VehicleDefinition],
    line_of: &dyn Fn(FieldPath) -> Option<usize>,
) -> Vec<VehicleFault> {
    let mut check = Check { line_of, vehicle: 0, label: String::new(), faults: Vec::new() };
    for (index, definition) in definitions.iter().enumerate() {
        check.vehicle = index;
        check.label = format!("vehicle {:?}", shown(&definition.id));
        let vehicle = definition.vehicle();
        check.turning(&vehicle.units, BodyEnds::Square);
    }
    check.faults
}

struct Check<'a> {
    line_of: &'a dyn Fn(FieldPath) -> Option<usize>,
    vehicle: usize,
    label: String,
    faults: Vec<VehicleFault>,
}

impl Check<'_> {
    fn fault(&mut self, unit: Option<(usize, &Unit)>, field: &'static str, problem: String) {
        let line = (self.line_of)(FieldPath { vehicle: self.vehicle, unit: unit.map(|(i, _)| i), field });
        let place = match unit {
            Some((i, u)) => format!("{}, unit {} ({}), {field}", self.label, i + 1, shown(&u.name)),
            None => format!("{}, {field}", self.label),
        };
        self.faults.push(VehicleFault { line, place, problem });
    }

    fn id(&mut self, definition: &VehicleDefinition, earlier: &[VehicleDefinition]) {
        let id = &definition.id;
        let plain = |c: char| c.is_ascii_alphanumeric() || ".-_".contains(c);
        if id.is_empty() || id.chars().count() > MAX_ID_CHARS || !id.chars().all(plain) {
            let problem = format!("an id is 1 to {MAX_ID_CHARS} of the characters A-Z a-z 0-9 . - _");
            self.fault(None, "id", problem);
        }
        if let Some(first) = earlier.iter().position(|v| v.id == *id) {
            let line = (self.line_of)(FieldPath { vehicle: first, unit: None, field: "id" });
            let at = line.map_or(String::new(), |l| format!(" on line {l}"));
            self.fault(None, "id", format!("the same id is already used{at}; ids are unique in a file"));
        }
    }

    fn whole(&mut self, v: &Vehicle) {
        self.text(None, "name", &v.name, MAX_NAME_CHARS);
        self.text(None, "region", &v.region, MAX_ID_CHARS);
        self.text(None, "source", &v.source, MAX_SOURCE_CHARS);
        self.range(None, "length_m", v.length_m, 0.2, 200.0);
        if let Some(class) = &v.class
            && Classes::builtin().get(class).is_none()
        {
            let known: Vec<&str> = Classes::builtin().all().iter().map(|class| class.id.as_str()).collect();
            self.fault(None, "class", format!("{:?} is none of {}", shown(class), known.join(", ")));
        }
        if let Some(axles) = v.axles {
            self.range(None, "axles", f64::from(axles), v.units.len() as f64 + 1.0, 100.0);
        }
        for (field, value, least, most) in [
            ("height_m", v.height_m, 0.1, 20.0),
            ("gross_mass_t", v.gross_mass_t, 0.01, 5000.0),
            ("axle_load_t", v.axle_load_t, 0.01, 100.0),
        ] {
            if let Some(value) = value {
                self.range(None, field, value, least, most);
            }
        }
        if let (Some(axle), Some(gross)) = (v.axle_load_t, v.gross_mass_t)
            && axle > gross
        {
            self.fault(None, "axle_load_t", format!("{axle} t is more than the gross mass of {gross} t"));
        }
        self.range(None, "tracking_tolerance_m", v.tracking_tolerance_m, 0.0, 2.0);
        self.range(None, "tracking_heading_deg", v.tracking_heading_rad.to_degrees(), 0.0, 30.0);
        self.range(None, "min_shrink", v.min_shrink, 0.01, 1.0);
    }

    fn units(&mut self, units: &[Unit]) {
        if units.is_empty() || units.len() > MAX_UNITS {
            let problem = format!("a vehicle has 1 to {MAX_UNITS} units, this one {}", units.len());
            self.fault(None, "unit", problem);
        }
        for (i, u) in units.iter().enumerate().take(MAX_UNITS) {
            let at = Some((i, u));
            self.text(at, "name", &u.name, MAX_NAME_CHARS);
            self.range(at, "coupling_to_axle_m", u.coupling_to_axle_m, 0.05, 50.0);
            self.range(at, "front_overhang_m", u.front_overhang_m, -50.0, 20.0);
            self.range(at, "rear_overhang_m", u.rear_overhang_m, -50.0, 50.0);
            self.range(at, "width_m", u.width_m, 0.1, 12.0);
            // At 90° of lock the steer axle's path gives the axle no direction (1/cos δ). Hinges may exceed 90°.
            let most_deg = if i == 0 { 85.0 } else { 170.0 };
            self.range(at, "max_articulation_deg", u.max_articulation_rad.to_degrees(), 1.0, most_deg);
            self.range(at, "sway_deg", u.sway_rad.to_degrees(), 0.0, 10.0);
            self.hitch(at, u);
        }
    }

    /// d must exceed −L: a coupling ahead of the unit's own front coupling reverses the chain. d must not exceed 2 L:
    /// beyond that, a deviation at the front coupling leaves the rear coupling more than doubled and reversed.
    fn hitch(&mut self, at: Option<(usize, &Unit)>, u: &Unit) {
        let (d, l) = (u.hitch_offset_m, u.coupling_to_axle_m);
        if !(d > -l && d <= 2.0 * l) {
            let problem = format!("{d} must be more than {} and at most {} (coupling_to_axle_m is {l})", -l, 2.0 * l);
            self.fault(at, "hitch_offset_m", problem);
        }
    }

    /// Each body has a positive length, and bodies do not overlap when the vehicle is straight. A trailer's body may
    /// reach over the unit that tows it (fifth wheel). It may not reach past that unit's front coupling, nor into the
    /// unit before that one.
    fn bodies(&mut self, units: &[Unit]) {
        let (mut coupling, mut rears) = (0.0, Vec::with_capacity(units.len()));
        for (i, u) in units.iter().enumerate() {
            let front = coupling + u.front_overhang_m;
            let rear = coupling - u.coupling_to_axle_m - u.rear_overhang_m;
            if front - rear < 0.05 {
                let problem = format!("the body is {:.2} m long; it must be at least 0.05 m", front - rear);
                self.fault(Some((i, u)), "rear_overhang_m", problem);
            }
            if let Some(towing) = i.checked_sub(1).and_then(|t| units.get(t)) {
                let towing_front_coupling = coupling + towing.hitch_offset_m + towing.coupling_to_axle_m;
                if front > towing_front_coupling {
                    let past = front - towing_front_coupling;
                    let problem = format!("the body reaches {past:.2} m past the front coupling of the unit before it");
                    self.fault(Some((i, u)), "front_overhang_m", problem);
                }
            }
            if let Some((towing, &before)) = i.checked_sub(1).and_then(|t| units.get(t)).zip(rears.last())
                && !collide::carries(units, i - 1)
                && !collide::is_dolly(units, i)
                && front > before + collide::TOUCH_M
            {
                let how =
                    if towing.hitch_offset_m < towing.rear_overhang_m { "under its body" } else { "behind its body" };
                let problem = format!(
                    "the body reaches {:.2} m into that of unit {i}, which draws it by a coupling {how}; at most {:.2}",
                    front - before,
                    u.front_overhang_m - (front - before)
                );
                self.fault(Some((i, u)), "front_overhang_m", problem);
            }
            if let Some(&before) = i.checked_sub(2).and_then(|b| rears.get(b))
                && front > before
            {
                let problem = format!("the body overlaps that of unit {} by {:.2} m", i - 1, front - before);
                self.fault(Some((i, u)), "front_overhang_m", problem);
            }
            rears.push(rear);
            coupling -= u.coupling_to_axle_m + u.hitch_offset_m;
        }
    }

    /// Hinge limits that overlapping bodies keep the hinge from reaching. If even rounded ends overlap, the limit is a
    /// fault, otherwise a warning.
    fn turning(&mut self, units: &[Unit], ends: BodyEnds) {
        for clash in collide::clashes(units).into_iter().filter(|clash| clash.ends == ends) {
            let Clash { hinge, units: (ahead, behind), angle_deg, .. } = clash;
            let Some(unit) = units.get(hinge) else { continue };
            let limit_deg = (unit.max_articulation_rad.to_degrees() * 1e9).round() / 1e9;
            let who = format!("the bodies of units {} and {}", ahead + 1, behind + 1);
            match (angle_deg > 0.0, ends) {
                (false, _) => {
                    let problem = format!("{who} overlap when the vehicle is straight");
                    self.fault(Some((hinge, unit)), "front_overhang_m", problem);
                }
                (true, BodyEnds::Round) => {
                    let problem = format!(
                        "{limit_deg} cannot be reached: {who} meet at {angle_deg}° even if their ends are round"
                    );
                    self.fault(Some((hinge, unit)), "max_articulation_deg", problem);
                }
                (true, BodyEnds::Square) => {
                    let problem = format!(
                        "{limit_deg} is reached only by bodies with rounded corners: as rectangles, {who} meet at \
                         {angle_deg}°"
                    );
                    self.fault(Some((hinge, unit)), "max_articulation_deg", problem);
                }
            }
        }
    }

    fn length(&mut self, v: &Vehicle) {
        let sum = closure_m(&v.units);
        if (v.length_m - sum).abs() > LENGTH_TOLERANCE_M {
            let problem = format!(
                "{} differs from the units' {sum:.2} m (front overhang, coupling to axle, hitch offsets, rear overhang) by \
                 more than {LENGTH_TOLERANCE_M} m",
                v.length_m
            );
            self.fault(None, "length_m", problem);
        }
    }

    fn range(&mut self, at: Option<(usize, &Unit)>, field: &'static str, value: f64, least: f64, most: f64) {
        if !value.is_finite() {
            self.fault(at, field, format!("{value} is not a finite number"));
        // Degrees are converted to radians and back: a value equal to the bound must pass.
        } else if value < least - 1e-9 || value > most + 1e-9 {
            let bound = if value < least { "least" } else { "most" };
            let limit = if value < least { least } else { most };
            let value = (value * 1e9).round() / 1e9;
            self.fault(at, field, format!("{value} is out of bounds: at {bound} {limit}"));
        }
    }

    fn text(&mut self, at: Option<(usize, &Unit)>, field: &'static str, text: &str, most: usize) {
        let chars = text.chars().count();
        if chars > most {
            self.fault(at, field, format!("{chars} characters long; at most {most}"));
        }
        if text.chars().any(|c| c.is_control() && !(field == "source" && c == '\n')) {
            self.fault(at, field, "holds a control character".into());
        }
    }
}

/// A name from a file for use in messages: without control characters, and shortened.
fn shown(text: &str) -> String {
    let mut short: String = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(40).collect();
    if text.chars().count() > 40 {
        short.push('…');
    }
    short
}
