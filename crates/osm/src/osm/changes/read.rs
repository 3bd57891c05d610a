//! Reads the XML of OsmChange, plain or gzipped.

use std::fs::File;
use std::io::{BufRead, BufReader, Read as _, Seek as _};
use std::path::Path;
use std::str::FromStr;

use flate2::bufread::MultiGzDecoder;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};

use super::{Change, ChangeError, Changes, Kind, Object};
use crate::osm::LonLat;

/// What a block of the file does to its objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Action {
    Put,
    Delete,
}

impl Changes {
    /// Reads a file of changes whole, or not at all.
    ///
    /// # Errors
    /// The file cannot be read, is cut off, or is no OsmChange.
    pub fn read(path: &Path) -> Result<Self, ChangeError> {
        let io = |error: std::io::Error| ChangeError::new(path, None, error.to_string());
        let mut file = File::open(path).map_err(io)?;
        let mut magic = [0; 2];
        let gzipped = file.read(&mut magic).map_err(io)? == 2 && magic == [0x1f, 0x8b];
        file.rewind().map_err(io)?;
        let file = BufReader::new(file);
        if gzipped {
            Parser::new(path, BufReader::new(MultiGzDecoder::new(file))).run()
        } else {
            Parser::new(path, file).run()
        }
    }
}

struct Parser<'p, R: BufRead> {
    path: &'p Path,
    reader: quick_xml::Reader<R>,
    changes: Changes,
    action: Option<Action>,
    /// The object that is being read: kind, id and state.
    object: Option<(Kind, i64, Change)>,
    /// Whether the root element was seen, and its end.
    root: [bool; 2],
}

impl<'p, R: BufRead> Parser<'p, R> {
    fn new(path: &'p Path, input: R) -> Self {
        let reader = quick_xml::Reader::from_reader(input);
        Self { path, reader, changes: Changes::default(), action: None, object: None, root: [false; 2] }
    }

    fn error(&self, detail: impl Into<String>) -> ChangeError {
        ChangeError::new(self.path, Some(self.reader.buffer_position()), detail)
    }

    fn broken(&self, error: &impl std::fmt::Display) -> ChangeError {
        let detail = error.to_string();
        self.error(format!("broken XML: {}; fetch the file again", detail.trim_start_matches("syntax error: ")))
    }

    fn run(mut self) -> Result<Changes, ChangeError> {
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            let event = self.reader.read_event_into(&mut buffer);
            match event.map_err(|error| self.broken(&error))? {
                Event::Start(element) => self.begin(&element)?,
                Event::Empty(element) => {
                    self.begin(&element)?;
                    self.end(element.name().as_ref());
                }
                Event::End(element) => self.end(element.name().as_ref()),
                Event::Eof if self.root == [true, true] => return Ok(self.changes),
                Event::Eof => return Err(self.error("the file ends too soon, or is no osmChange; fetch it again")),
                _ => {}
            }
        }
    }

    fn begin(&mut self, element: &BytesStart<'_>) -> Result<(), ChangeError> {
        let name = element.name();
        let name: &str = name.as_ref();
        match (name, self.action, &self.object) {
            ("osmChange", None, None) if !self.root[0] => self.root[0] = true,
            ("create" | "modify", None, None) if self.root[0] => self.action = Some(Action::Put),
            ("delete", None, None) if self.root[0] => self.action = Some(Action::Delete),
            ("node", Some(action), None) => self.object(Kind::Node, action, element)?,
            ("way", Some(action), None) => self.object(Kind::Way, action, element)?,
            ("relation", Some(action), None) => self.object(Kind::Relation, action, element)?,
            ("tag" | "nd" | "member", _, Some(_)) => self.part(name, element)?,
            ("bounds" | "bound", ..) => {}
            _ => {
                return Err(self.error(format!("<{name}> has no place here; this is no osmChange")));
            }
        }
        Ok(())
    }

    fn end(&mut self, name: &str) {
        match name {
            "osmChange" => self.root[1] = true,
            "create" | "modify" | "delete" => self.action = None,
            "node" | "way" | "relation" => {
                if let Some((kind, id, change)) = self.object.take() {
                    self.changes.add(kind, id, change);
                }
            }
            _ => {}
        }
    }

    fn object(&mut self, kind: Kind, action: Action, element: &BytesStart<'_>) -> Result<(), ChangeError> {
        let id: i64 = self.required(element, "id", kind.name())?;
        let version = self.number(element, "version")?.unwrap_or(0);
        if let Some(time) = self.attribute(element, "timestamp")? {
            self.changes.note_time(&time);
        }
        let gone = action == Action::Delete || self.attribute(element, "visible")?.as_deref() == Some("false");
        let object = match kind {
            _ if gone => None,
            Kind::Node => {
                let e7 = |degrees: f64, most: f64| (degrees.abs() <= most).then(|| (degrees * 1e7).round() as i32);
                let lon = e7(self.required(element, "lon", "node")?, 180.0);
                let lat = e7(self.required(element, "lat", "node")?, 90.0);
                let (Some(lon_e7), Some(lat_e7)) = (lon, lat) else {
                    return Err(self.error(format!("node {id} is not on the earth")));
                };
                Some(Object::Node { place: LonLat { lon_e7, lat_e7 }, tags: Vec::new() })
            }
            Kind::Way => Some(Object::Way { refs: Vec::new(), tags: Vec::new() }),
            Kind::Relation => Some(Object::Relation { members: Vec::new(), tags: Vec::new() }),
        };
        self.object = Some((kind, id, Change { version, object }));
        Ok(())
    }

    /// A tag, a node of a way, or a member of a relation.
    fn part(&mut self, name: &str, element: &BytesStart<'_>) -> Result<(), ChangeError> {
        match name {
            "tag" => {
                let tag = (self.required(element, "k", "tag")?, self.required(element, "v", "tag")?);
                let tags = self.object.as_mut().and_then(|(.., change)| match change.object.as_mut()? {
                    Object::Node { tags, .. } | Object::Way { tags, .. } | Object::Relation { tags, .. } => Some(tags),
                });
                tags.into_iter().for_each(|tags| tags.push(tag.clone()));
            }
            "nd" => {
                let node = self.required(element, "ref", "nd")?;
                if let Some((.., Change { object: Some(Object::Way { refs, .. }), .. })) = &mut self.object {
                    refs.push(node);
                }
            }
            _ => {
                let kind: String = self.required(element, "type", "member")?;
                let kind = [Kind::Node, Kind::Way, Kind::Relation].into_iter().find(|known| known.name() == kind);
                let kind = kind.ok_or_else(|| self.error("a member is neither node nor way nor relation"))?;
                let member =
                    (kind, self.required(element, "ref", "member")?, self.required(element, "role", "member")?);
                if let Some((.., Change { object: Some(Object::Relation { members, .. }), .. })) = &mut self.object {
                    members.push(member);
                }
            }
        }
        Ok(())
    }

    fn attribute(&self, element: &BytesStart<'_>, name: &str) -> Result<Option<String>, ChangeError> {
        let found = element.try_get_attribute(name).map_err(|error| self.broken(&error))?;
        let Some(found) = found else { return Ok(None) };
        let value = found.normalized_value(XmlVersion::Implicit1_0);
        Ok(Some(value.map_err(|error| self.broken(&error))?.into_owned()))
    }

    fn number<T: FromStr>(&self, element: &BytesStart<'_>, name: &str) -> Result<Option<T>, ChangeError> {
        let Some(text) = self.attribute(element, name)? else { return Ok(None) };
        match text.parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) => Err(self.error(format!("{name}=\"{text}\" cannot be read"))),
        }
    }

    fn required<T: FromStr>(&self, element: &BytesStart<'_>, name: &str, of: &str) -> Result<T, ChangeError> {
        self.number(element, name)?.ok_or_else(|| self.error(format!("a {of} has no {name}")))
    }
}
