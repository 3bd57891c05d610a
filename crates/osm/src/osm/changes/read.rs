//! Reads the XML of OsmChange, plain or gzipped.
//!
//! Memory grows with the objects of a file alone: a piece of the text has a greatest length and elements have a greatest depth, since a
//! megabyte of gzip can be a gigabyte of one text or of elements in each other.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek as _};
use std::path::Path;
use std::str::FromStr;

use flate2::bufread::MultiGzDecoder;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};

use super::{ChangeError, Changes, Object, ObjectChange, ObjectKind};
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

/// Most bytes of a tag with its attributes, of a comment, or of the text between two tags. A tag of an object has some 2 KB at most.
const MOST_BYTES: usize = 1 << 20;
/// Elements in each other: the root, a block, an object, a part of it, and some to spare.
const MOST_DEPTH: usize = 8;

/// A text of which only so much may be read on.
struct Bounded<R> {
    text: R,
    left: usize,
}

impl<R: BufRead> Read for Bounded<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(out)?;
        self.consume(read);
        Ok(read)
    }
}

impl<R: BufRead> BufRead for Bounded<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let bytes = self.text.fill_buf()?;
        if self.left == 0 && !bytes.is_empty() {
            return Err(io::Error::other("a tag, text or comment of more than 1 MiB"));
        }
        Ok(bytes.get(..self.left).unwrap_or(bytes))
    }

    fn consume(&mut self, count: usize) {
        self.left -= count;
        self.text.consume(count);
    }
}

struct Parser<'p, R: BufRead> {
    path: &'p Path,
    reader: quick_xml::Reader<Bounded<R>>,
    depth: usize,
    changes: Changes,
    action: Option<Action>,
    /// The object that is being read: kind, id and state.
    object: Option<(ObjectKind, i64, ObjectChange)>,
    /// Whether the root element was seen, and its end.
    root: [bool; 2],
}

impl<'p, R: BufRead> Parser<'p, R> {
    fn new(path: &'p Path, input: R) -> Self {
        let reader = quick_xml::Reader::from_reader(Bounded { text: input, left: MOST_BYTES });
        Self { path, reader, depth: 0, changes: Changes::default(), action: None, object: None, root: [false; 2] }
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
            self.reader.get_mut().left = MOST_BYTES;
            let event = self.reader.read_event_into(&mut buffer);
            match event.map_err(|error| self.broken(&error))? {
                Event::Start(_) if self.depth == MOST_DEPTH => {
                    return Err(self.error("elements stand too deep in each other; this is no osmChange"));
                }
                Event::Start(element) => {
                    self.depth += 1;
                    self.begin(&element)?;
                }
                Event::Empty(element) => {
                    self.begin(&element)?;
                    self.end(element.name().as_ref());
                }
                Event::End(element) => {
                    self.depth = self.depth.saturating_sub(1);
                    self.end(element.name().as_ref());
                }
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
            ("node", Some(action), None) => self.object(ObjectKind::Node, action, element)?,
            ("way", Some(action), None) => self.object(ObjectKind::Way, action, element)?,
            ("relation", Some(action), None) => self.object(ObjectKind::Relation, action, element)?,
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

    fn object(&mut self, kind: ObjectKind, action: Action, element: &BytesStart<'_>) -> Result<(), ChangeError> {
        let id: i64 = self.required(element, "id", kind.name())?;
        let version = self.number(element, "version")?.unwrap_or(0);
        if let Some(time) = self.attribute(element, "timestamp")? {
            self.changes.note_time(&time);
        }
        let gone = action == Action::Delete || self.attribute(element, "visible")?.as_deref() == Some("false");
        let object = match kind {
            _ if gone => None,
            ObjectKind::Node => {
                let e7 = |degrees: f64, most: f64| (degrees.abs() <= most).then(|| (degrees * 1e7).round() as i32);
                let lon = e7(self.required(element, "lon", "node")?, 180.0);
                let lat = e7(self.required(element, "lat", "node")?, 90.0);
                let (Some(lon_e7), Some(lat_e7)) = (lon, lat) else {
                    return Err(self.error(format!("node {id} is not on the earth")));
                };
                Some(Object::Node { place: LonLat { lon_e7, lat_e7 }, tags: Vec::new() })
            }
            ObjectKind::Way => Some(Object::Way { refs: Vec::new(), tags: Vec::new() }),
            ObjectKind::Relation => Some(Object::Relation { members: Vec::new(), tags: Vec::new() }),
        };
        self.object = Some((kind, id, ObjectChange { version, object }));
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
                if let Some((.., ObjectChange { object: Some(Object::Way { refs, .. }), .. })) = &mut self.object {
                    refs.push(node);
                }
            }
            _ => {
                let kind: String = self.required(element, "type", "member")?;
                let kind = [ObjectKind::Node, ObjectKind::Way, ObjectKind::Relation]
                    .into_iter()
                    .find(|known| known.name() == kind);
                let kind = kind.ok_or_else(|| self.error("a member is neither node nor way nor relation"))?;
                let member =
                    (kind, self.required(element, "ref", "member")?, self.required(element, "role", "member")?);
                if let Some((.., ObjectChange { object: Some(Object::Relation { members, .. }), .. })) =
                    &mut self.object
                {
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// What is said of `head`, then `count` times `piece`.
    fn said(head: &str, piece: &'static str, count: u64) -> String {
        let many = std::iter::repeat_n(piece, count as usize).collect::<String>();
        let text = BufReader::new(head.as_bytes().chain(many.as_bytes()));
        Parser::new(Path::new("x.osc"), text).run().unwrap_err().to_string()
    }

    #[test]
    fn a_text_or_a_depth_without_end_is_refused_before_it_fills_memory() {
        for head in ["", "<", "<osmChange>", "<osmChange><!--", "<osmChange a='", "<osmChange><create><node id='", "</"]
        {
            let error = said(head, " ", 2 << 20);
            assert!(error.contains("of more than 1 MiB"), "{head}: {error}");
        }
        assert!(said("<osmChange>", "<bounds>", 9).contains("too deep"));
    }

    #[test]
    fn long_texts_and_files_of_any_length_are_read() {
        let comment = format!("<osmChange><!--{}--><create>", " ".repeat(MOST_BYTES - 100));
        let node = "<node id='1' lon='8' lat='49'><tag k='a' v='b'/></node>\n".repeat(40_000);
        let text = format!("{comment}{node}</create></osmChange>");
        let changes = Parser::new(Path::new("x.osc"), BufReader::new(text.as_bytes())).run().unwrap();
        assert_eq!(changes.len(), 1);
    }
}
