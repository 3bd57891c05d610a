//! Well-known text (ISO 19125), as in a CSV file: `POINT (8.69 49.41)`, `LINESTRING (…)`, `POLYGON ((…))`, and their kinds with
//! several parts. PostGIS's `SRID=4326;` may stand before, and hexadecimal well-known binary instead.

use super::{Shape, Xy, from_wkb};

/// The shape of a text; `None` if it is empty.
pub fn from_text(text: &str) -> Result<Option<Shape>, String> {
    let text = text.trim();
    if text.starts_with("00") || text.starts_with("01") {
        return from_wkb(&bytes(text)?);
    }
    let (srid, text) = match text.split_once(';') {
        Some((srid, text)) if srid.to_ascii_uppercase().starts_with("SRID=") => (srid[5..].trim(), text),
        _ => ("4326", text),
    };
    if srid != "4326" {
        return Err(format!("its reference system is {srid}; transform it to WGS 84 (EPSG:4326)"));
    }
    let mut words = Text { rest: text };
    let shape = words.shape()?;
    if words.rest.trim().is_empty() { Ok(shape) } else { Err(words.unexpected("the end")) }
}

fn bytes(hex: &str) -> Result<Vec<u8>, String> {
    let digit = |byte: &u8| char::from(*byte).to_digit(16).map(|digit| digit as u8);
    let pair = |pair: &[u8]| match pair {
        [high, low] => Some(digit(high)? << 4 | digit(low)?),
        _ => None,
    };
    hex.as_bytes()
        .chunks(2)
        .map(pair)
        .collect::<Option<_>>()
        .ok_or_else(|| "neither well-known text nor hexadecimal well-known binary; write the file again".to_owned())
}

/// Text that is still to be read.
struct Text<'t> {
    rest: &'t str,
}

impl<'t> Text<'t> {
    fn unexpected(&self, wanted: &str) -> String {
        let found: String = self.rest.trim_start().chars().take(20).collect();
        let found = if found.is_empty() { "the end".to_owned() } else { format!("`{}`", found.escape_debug()) };
        format!(
            "no well-known text: {wanted} expected, {found} found; write it like `LINESTRING (8.69 49.41, 8.70 49.42)`"
        )
    }

    /// The next letters.
    fn word(&mut self) -> &'t str {
        let text = self.rest.trim_start();
        let end = text.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.rest = rest;
        word
    }

    /// Whether the next character is this one; if so, it is read.
    fn skip(&mut self, c: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(c);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn number(&mut self) -> Option<f64> {
        let text = self.rest.trim_start();
        let end = text.find(|c: char| c.is_whitespace() || ",()".contains(c)).unwrap_or(text.len());
        let number = text[..end].parse().ok()?;
        self.rest = &text[end..];
        Some(number)
    }

    fn xy(&mut self) -> Result<Xy, String> {
        let (Some(x), Some(y)) = (self.number(), self.number()) else { return Err(self.unexpected("two numbers")) };
        while self.number().is_some() {}
        Ok([x, y])
    }

    /// Items between brackets and commas.
    fn list<T>(&mut self, item: impl Fn(&mut Self) -> Result<T, String>) -> Result<Vec<T>, String> {
        if !self.skip('(') {
            return Err(self.unexpected("`(`"));
        }
        let mut items = vec![item(self)?];
        while self.skip(',') {
            items.push(item(self)?);
        }
        if self.skip(')') { Ok(items) } else { Err(self.unexpected("`,` or `)`")) }
    }

    fn line(&mut self) -> Result<Vec<Xy>, String> {
        self.list(Self::xy)
    }

    fn polygon(&mut self) -> Result<Vec<Vec<Xy>>, String> {
        self.list(Self::line)
    }

    /// A point of several may stand in brackets of its own.
    fn point_of_several(&mut self) -> Result<Xy, String> {
        let bracket = self.skip('(');
        let at = self.xy()?;
        if bracket && !self.skip(')') { Err(self.unexpected("`)`")) } else { Ok(at) }
    }

    fn shape(&mut self) -> Result<Option<Shape>, String> {
        let kind = self.word().to_ascii_uppercase();
        let mut dimensions = self.word().to_ascii_uppercase();
        if ["Z", "M", "ZM"].contains(&dimensions.as_str()) {
            dimensions = self.word().to_ascii_uppercase();
        }
        if dimensions == "EMPTY" {
            return Ok(None);
        }
        match kind.as_str() {
            "POINT" => Shape::only(self.list(Self::xy)?, Shape::Point),
            "LINESTRING" => self.line().map(|line| Some(Shape::Line(line))),
            "POLYGON" => self.polygon().map(|rings| Some(Shape::Polygon(rings))),
            "MULTIPOINT" => Shape::only(self.list(Self::point_of_several)?, Shape::Point),
            "MULTILINESTRING" => Shape::only(self.list(Self::line)?, Shape::Line),
            "MULTIPOLYGON" => Shape::only(self.list(Self::polygon)?, Shape::Polygon),
            _ => {
                Err("neither point nor line nor polygon as well-known text; write it like `POINT (8.69 49.41)`"
                    .to_owned())
            }
        }
    }
}
