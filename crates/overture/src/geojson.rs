//! Features of GeoJSON files, one after the other: a collection, as `export overture` and `overturemaps download -f geojson` write it, or a
//! sequence (`-f geojsonseq`).
//!
//! `overturemaps` writes no `type`, because in a release the folder has it. Such a feature is known by what it has.

use std::fmt;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::PathBuf;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::error::{FilePosition, OvertureError, OvertureProblem};

/// Stands before each feature of a sequence, if its writer follows RFC 8142.
pub(super) const SEPARATOR: char = '\u{1e}';

/// What a connector may have, besides its id and its place. What has more is something else.
const OF_CONNECTORS: [&str; 6] = ["id", "bbox", "sources", "theme", "type", "version"];

/// What only segments have. Two of them are those of a schema before September 2024, which [`super::record::Segment`] refuses by name.
const OF_SEGMENTS: [&str; 3] = ["connectors", "connector_ids", "road"];

/// What a feature is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FeatureKind {
    Segment,
    Connector,
}

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
    /// What it is, by the property `type`, or by content where there is none.
    ///
    /// # Errors
    /// It is neither a segment nor a connector.
    pub(super) fn kind(&self) -> Result<FeatureKind, OvertureProblem> {
        let kind = match self.properties.get("type").filter(|kind| !kind.is_null()) {
            Some(Value::String(kind)) if kind == "segment" => Some(FeatureKind::Segment),
            Some(Value::String(kind)) if kind == "connector" => Some(FeatureKind::Connector),
            Some(other) => return Err(OvertureProblem::OtherFeatures(format!("type {other}"))),
            None => self.kind_by_content(),
        };
        let missing = "the property type is missing, and it is neither a line with connectors nor a point without other properties";
        kind.ok_or_else(|| OvertureProblem::OtherFeatures(missing.to_owned()))
    }

    fn kind_by_content(&self) -> Option<FeatureKind> {
        let properties = self.properties.as_object()?;
        let has = |name: &&str| properties.get(*name).is_some_and(|value| !value.is_null());
        match self.geometry.get("type").and_then(Value::as_str)? {
            "LineString" => OF_SEGMENTS.iter().any(has).then_some(FeatureKind::Segment),
            "Point" => {
                let others =
                    properties.iter().any(|(name, value)| !value.is_null() && !OF_CONNECTORS.contains(&&**name));
                (!others).then_some(FeatureKind::Connector)
            }
            _ => None,
        }
    }

    /// The id. Some writers keep it among the properties.
    ///
    /// # Errors
    /// It is missing or no text.
    pub(super) fn id(&self) -> Result<String, OvertureProblem> {
        let id = if self.id.is_null() { self.properties.get("id").unwrap_or(&Value::Null) } else { &self.id };
        match id {
            Value::String(id) => Ok(id.clone()),
            Value::Null => Err(OvertureProblem::Value("a feature without id".to_owned())),
            other => {
                Err(OvertureProblem::Type { property: "id".to_owned(), detail: format!("it is {other}, and not text") })
            }
        }
    }
}

/// What becomes of a feature: nothing, or an error with its id.
type Taken = Result<(), (Option<String>, OvertureProblem)>;

/// Calls `take` for each feature of a file.
pub(super) fn each(file: &DrawnFile, take: &mut dyn FnMut(Feature) -> Taken) -> Result<(), OvertureError> {
    let path = &*file.path;
    let open = File::open(path).map_err(|e| OvertureError::of_file(path, e))?;
    let text = BufReader::with_capacity(1 << 16, open);
    let mut walk = Walk { take, number: 0, failed: None };
    let done = if file.sequence {
        walk.sequence(text)
    } else {
        let mut json = serde_json::Deserializer::from_reader(text);
        (&mut walk).deserialize(&mut json).and_then(|()| json.end())
    };
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

/// A GeoJSON file.
pub(super) struct DrawnFile {
    pub(super) path: PathBuf,
    /// Whether it is a sequence of features, and no collection.
    pub(super) sequence: bool,
}

struct Walk<'t> {
    take: &'t mut dyn FnMut(Feature) -> Taken,
    number: usize,
    failed: Option<(Option<String>, OvertureProblem)>,
}

impl Walk<'_> {
    /// Takes a feature. An error of `take` is kept, and ends the reading.
    fn feature<E: serde::de::Error>(&mut self, feature: Feature) -> Result<(), E> {
        if let Err(failed) = (self.take)(feature) {
            self.failed = Some(failed);
            return Err(E::custom("a feature"));
        }
        self.number += 1;
        Ok(())
    }

    /// Takes the features of a sequence. A feature may have several lines.
    fn sequence(&mut self, text: impl Read) -> serde_json::Result<()> {
        let features = serde_json::Deserializer::from_reader(Unseparated(text)).into_iter::<Feature>();
        for feature in features {
            self.feature(feature?)?;
        }
        Ok(())
    }
}

/// A text whose separators are blanks. In JSON that character stands nowhere else: in texts it is written as an escape.
struct Unseparated<R>(R);

impl<R: Read> Read for Unseparated<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let length = self.0.read(out)?;
        for byte in out.iter_mut().take(length).filter(|byte| **byte == SEPARATOR as u8) {
            *byte = b' ';
        }
        Ok(length)
    }
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
            self.0.feature(feature)?;
        }
        Ok(())
    }
}
