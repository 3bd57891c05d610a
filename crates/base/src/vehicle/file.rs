//! Reads TOML or JSON text into vehicles, or into all its faults with their lines.
//!
//! Unknown fields are refused: a misspelt `width_n` would otherwise put a default into a certificate.

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::check::{FieldPath, faults, warnings};
use super::definition::VehicleDefinition;
use super::{Vehicle, VehicleError, VehicleFault};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleFile {
    vehicle: Vec<VehicleDefinition>,
}

/// The vehicles of a file's text in file order, at least one, and the warnings about them.
pub(crate) fn parse(text: &str) -> Result<(Vec<Vehicle>, Vec<VehicleFault>), Vec<VehicleFault>> {
    let unreadable = |e: &toml::de::Error| {
        let line = e.span().map(|span| line_at(text, span.start));
        vec![VehicleFault { line, place: String::new(), problem: e.message().to_owned() }]
    };
    let tree = DeTable::parse(text).map_err(|e| unreadable(&e))?;
    let file: VehicleFile = toml::from_str(text).map_err(|e| unreadable(&e))?;
    if file.vehicle.is_empty() {
        let problem = "no vehicle in the file; it needs at least one [[vehicle]]".to_owned();
        return Err(vec![VehicleFault { line: None, place: String::new(), problem }]);
    }
    let line_of = |path| Some(line_at(text, offset(&tree, path)?));
    let faults = faults(&file.vehicle, &line_of);
    if !faults.is_empty() {
        return Err(faults);
    }
    let odd = warnings(&file.vehicle, &line_of);
    Ok((file.vehicle.iter().map(VehicleDefinition::vehicle).collect(), odd))
}

/// Byte offset of a field's value. If the field is left out, the offset of its unit or vehicle.
fn offset(tree: &Spanned<DeTable<'_>>, path: FieldPath) -> Option<usize> {
    let vehicle = tree.get_ref().get("vehicle")?.get_ref().get(path.vehicle)?;
    let table = match path.unit {
        Some(unit) => vehicle.get_ref().get("unit")?.get_ref().get(unit)?,
        None => vehicle,
    };
    let field: Option<&Spanned<DeValue<'_>>> = table.get_ref().get(path.field);
    Some(field.unwrap_or(table).span().start)
}

/// Line of a byte offset, from 1.
fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&b| b == b'\n').count()
}

impl Vehicle {
    /// Reads a vehicle from its definition in JSON, with the checks of a file.
    ///
    /// # Errors
    /// [`VehicleError::Refused`] with field and bound, and with the line of a syntax error.
    pub fn from_json(json: &str) -> Result<Self, VehicleError> {
        let refused = |faults| VehicleError::Refused { file: "vehicle definition".into(), faults };
        let definition: VehicleDefinition = serde_json::from_str(json).map_err(|e| {
            refused(vec![VehicleFault { line: Some(e.line()), place: String::new(), problem: e.to_string() }])
        })?;
        let faults = faults(std::slice::from_ref(&definition), &|_| None);
        if faults.is_empty() { Ok(definition.vehicle()) } else { Err(refused(faults)) }
    }
}
