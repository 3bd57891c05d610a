//! Segments and connectors as the schema has them
//! (<https://docs.overturemaps.org/schema/reference/transportation/segment/>). Members that netcert does not use are not read.

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::error::OvertureProblem;

/// A segment without id and geometry.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Segment {
    pub(super) subtype: Option<String>,
    pub(super) class: Option<String>,
    pub(super) subclass: Option<String>,
    pub(super) names: Option<Names>,
    pub(super) connectors: Option<Vec<ConnectorAt>>,
    pub(super) routes: Option<Vec<Route>>,
    pub(super) access_restrictions: Option<Vec<Access>>,
    pub(super) prohibited_transitions: Option<Vec<Transition>>,
    pub(super) speed_limits: Option<Vec<SpeedLimit>>,
    pub(super) subclass_rules: Option<Vec<Text>>,
    pub(super) width_rules: Option<Vec<Width>>,
    pub(super) road_flags: Option<Vec<Flags>>,
    pub(super) road_surface: Option<Vec<IgnoredAny>>,
    pub(super) level_rules: Option<Vec<IgnoredAny>>,
    pub(super) destinations: Option<Vec<IgnoredAny>>,
}

impl Segment {
    /// Reads the properties of a feature, or the columns of a row.
    ///
    /// # Errors
    /// [`OvertureProblem::Type`] names the first property of another type. [`OvertureProblem::Schema`]: they are of a schema before September 2024.
    pub(super) fn read(properties: Value) -> Result<Self, OvertureProblem> {
        if let Some(old) = OLD.iter().find(|name| properties.get(name).is_some()) {
            return Err(old_schema(old));
        }
        serde_path_to_error::deserialize(properties).map_err(|error| {
            let property = error.path().to_string();
            OvertureProblem::Type { property, detail: mismatch(&error.into_inner().to_string()) }
        })
    }
}

/// Properties that releases before September 2024 had in place of those of today.
pub(super) const OLD: [&str; 2] = ["road", "connector_ids"];

/// The error of a file that has one of them.
pub(super) fn old_schema(name: &str) -> OvertureProblem {
    OvertureProblem::Schema(format!("the property {name} is of an older schema, which netcert does not know"))
}

/// What serde says of a type, in plain words.
fn mismatch(said: &str) -> String {
    let Some((found, expected)) = said.strip_prefix("invalid type: ").and_then(|said| said.rsplit_once(", expected "))
    else {
        return said.to_owned();
    };
    let expected = match expected {
        "f64" => "a number",
        "a sequence" => "a list",
        "a string" => "text",
        // Only objects are left.
        _ => "an object",
    };
    let found = found.replace("floating point `", "the number `").replace("integer `", "the number `");
    format!("it is {found}, and not {expected}")
}

#[derive(Debug, Deserialize)]
pub(super) struct Names {
    pub(super) primary: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct ConnectorAt {
    pub(super) connector_id: String,
    pub(super) at: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Route {
    #[serde(rename = "ref")]
    pub(super) reference: Option<String>,
    pub(super) between: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Access {
    pub(super) access_type: Option<String>,
    pub(super) when: Option<When>,
    pub(super) between: Option<Vec<f64>>,
}

/// The conditions of a rule. All must hold together.
#[derive(Debug, Default, Deserialize)]
pub(super) struct When {
    pub(super) heading: Option<String>,
    pub(super) during: Option<String>,
    pub(super) mode: Option<Vec<String>>,
    pub(super) using: Option<Vec<String>>,
    pub(super) recognized: Option<Vec<String>>,
    pub(super) vehicle: Option<Vec<Comparison>>,
    /// Conditions that this program does not know.
    #[serde(flatten)]
    pub(super) others: serde_json::Map<String, serde_json::Value>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Comparison {
    pub(super) dimension: Option<String>,
    pub(super) comparison: Option<String>,
    pub(super) value: Option<f64>,
    pub(super) unit: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct SpeedLimit {
    pub(super) max_speed: Option<Speed>,
    pub(super) when: Option<When>,
    pub(super) between: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Speed {
    pub(super) value: Option<f64>,
    pub(super) unit: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Text {
    pub(super) value: Option<String>,
    pub(super) between: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Width {
    pub(super) value: Option<f64>,
    pub(super) between: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Flags {
    pub(super) values: Option<Vec<String>>,
    pub(super) between: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Transition {
    pub(super) sequence: Option<Vec<Step>>,
    pub(super) final_heading: Option<String>,
    pub(super) when: Option<When>,
    pub(super) between: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Step {
    pub(super) connector_id: Option<String>,
    pub(super) segment_id: Option<String>,
}

impl When {
    /// Whether it has a condition that this program does not know.
    pub(super) fn is_strange(&self) -> bool {
        self.others.values().any(|value| !value.is_null())
    }
}
