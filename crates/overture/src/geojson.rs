//! Features of GeoJSON files, one after the other: `export overture` and `overturemaps download -f geojson` write them.

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::error::{FilePosition, OvertureError, OvertureProblem};

/// A feature.
#[derive(Deserialize)]
pub(super) struct Feature {
    #[serde(default)]
    id: Value,
    #[serde(default)]
    pub(super) geometry: Value,
    #[serde(default)]
    pub(super) properties: Value,
}

impl Feature {
    /// `segment` or `connector`.
    pub(super) fn kind(&self) -> &str {
        self.properties.get("type").and_then(Value::as_str).unwrap_or_default()
    }

    /// The same for messages, whatever stands there.
    pub(super) fn kind_as_written(&self) -> String {
        self.properties
            .get("type")
            .map_or_else(|| "the property type is missing".to_owned(), |kind| format!("type {kind}"))
    }

    /// The id.
    ///
    /// # Errors
    /// It is missing or no text.
    pub(super) fn id(&self) -> Result<String, OvertureProblem> {
        match &self.id {
            Value::String(id) => Ok(id.clone()),
            Value::Null => Err(OvertureProblem::Value("a feature without id".to_owned())),
            other => {
                Err(OvertureProblem::Type { property: "id".to_owned(), detail: format!("it is {other}, and not text") })
            }
        }
    }
}

/// Calls `take` for each feature of a file.
pub(super) fn each(
    path: &Path,
    take: &mut dyn FnMut(Feature) -> Result<(), (Option<String>, OvertureProblem)>,
) -> Result<(), OvertureError> {
    let file = File::open(path).map_err(|e| OvertureError::of_file(path, e))?;
    let mut walk = Walk { take, number: 0, failed: None };
    let mut json = serde_json::Deserializer::from_reader(BufReader::with_capacity(1 << 16, file));
    let done = (&mut walk).deserialize(&mut json).and_then(|()| json.end());
    let (number, failed) = (walk.number, walk.failed);
    let at = |position, (id, problem)| OvertureError { path: path.to_owned(), position, id, problem };
    match (done, failed) {
        (_, Some(failed)) => Err(at(FilePosition::Feature(number), failed)),
        // The text is JSON, but not of the form of features.
        (Err(error), None) if error.is_data() => Err(at(
            FilePosition::Feature(number),
            (None, OvertureProblem::Value(format!("no GeoJSON of features: {error}"))),
        )),
        (Err(error), None) => {
            Err(at(FilePosition::Feature(number), (None, OvertureProblem::Damaged(error.to_string()))))
        }
        (Ok(()), None) => Ok(()),
    }
}

struct Walk<'t> {
    take: &'t mut dyn FnMut(Feature) -> Result<(), (Option<String>, OvertureProblem)>,
    number: usize,
    failed: Option<(Option<String>, OvertureProblem)>,
}

impl<'de> DeserializeSeed<'de> for &mut Walk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, json: D) -> Result<(), D::Error> {
        json.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for &mut Walk<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a FeatureCollection")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        while let Some(name) = members.next_key::<String>()? {
            if name == "features" {
                members.next_value_seed(Features(self))?;
            } else {
                members.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

struct Features<'w, 't>(&'w mut Walk<'t>);

impl<'de> DeserializeSeed<'de> for Features<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, json: D) -> Result<(), D::Error> {
        json.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Features<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("features")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut features: A) -> Result<(), A::Error> {
        while let Some(feature) = features.next_element::<Feature>()? {
            if let Err(failed) = (self.0.take)(feature) {
                self.0.failed = Some(failed);
                return Err(serde::de::Error::custom("a feature"));
            }
            self.0.number += 1;
        }
        Ok(())
    }
}
