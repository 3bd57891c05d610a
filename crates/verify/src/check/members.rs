//! Reads members of a JSON document by path. A member that is missing or of the wrong type is an error that names the path.

use serde::Deserialize as _;
use serde_json::{Map, Value};

/// An object and its path in the document.
#[derive(Clone, Copy)]
pub(super) struct Members<'v> {
    object: &'v Map<String, Value>,
    path: &'v str,
}

/// What is wrong, with its path.
pub(super) type Wrong = String;

impl<'v> Members<'v> {
    pub(super) fn of(value: &'v Value, path: &'v str) -> Result<Self, Wrong> {
        let object = value.as_object().ok_or_else(|| format!("{path}: not an object"))?;
        Ok(Self { object, path })
    }

    fn path_of(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    /// Names that are not among `known`.
    pub(super) fn unknown(&self, known: &[&str]) -> Vec<String> {
        self.object.keys().filter(|name| !known.contains(&name.as_str())).map(|name| self.path_of(name)).collect()
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.object.contains_key(name)
    }

    pub(super) fn value(&self, name: &str) -> Result<&'v Value, Wrong> {
        self.object.get(name).ok_or_else(|| format!("{}: missing", self.path_of(name)))
    }

    pub(super) fn number(&self, name: &str) -> Result<f64, Wrong> {
        let number = self.value(name)?.as_f64().filter(|x| x.is_finite());
        number.ok_or_else(|| format!("{}: not a number", self.path_of(name)))
    }

    /// A number, or `None` for null.
    pub(super) fn number_or_null(&self, name: &str) -> Result<Option<f64>, Wrong> {
        if self.value(name)?.is_null() { Ok(None) } else { self.number(name).map(Some) }
    }

    pub(super) fn index(&self, name: &str) -> Result<usize, Wrong> {
        let index = self.value(name)?.as_u64().and_then(|n| usize::try_from(n).ok());
        index.ok_or_else(|| format!("{}: not a whole number", self.path_of(name)))
    }

    pub(super) fn truth(&self, name: &str) -> Result<bool, Wrong> {
        self.value(name)?.as_bool().ok_or_else(|| format!("{}: neither true nor false", self.path_of(name)))
    }

    pub(super) fn text(&self, name: &str) -> Result<&'v str, Wrong> {
        self.value(name)?.as_str().ok_or_else(|| format!("{}: not a text", self.path_of(name)))
    }

    /// A list with `count` entries, or of any length.
    pub(super) fn list(&self, name: &str, count: Option<usize>) -> Result<&'v [Value], Wrong> {
        let list = self.value(name)?.as_array().ok_or_else(|| format!("{}: not a list", self.path_of(name)))?;
        match count {
            Some(count) if count != list.len() => {
                Err(format!("{}: {} entries; there are {count} stations or units", self.path_of(name), list.len()))
            }
            _ => Ok(list),
        }
    }

    /// A list of numbers.
    pub(super) fn numbers(&self, name: &str, count: usize) -> Result<Vec<f64>, Wrong> {
        let one = |(k, value): (usize, &Value)| {
            let number = value.as_f64().filter(|x| x.is_finite());
            number.ok_or_else(|| format!("{}[{k}]: not a number", self.path_of(name)))
        };
        self.list(name, Some(count))?.iter().enumerate().map(one).collect()
    }

    /// A list of numbers, each of which may be null.
    pub(super) fn numbers_or_null(&self, name: &str, count: usize) -> Result<Vec<Option<f64>>, Wrong> {
        let one = |(k, value): (usize, &Value)| {
            let number = value.as_f64().filter(|x| x.is_finite());
            let wrong = || format!("{}[{k}]: neither a number nor null", self.path_of(name));
            if value.is_null() { Ok(None) } else { number.map(Some).ok_or_else(wrong) }
        };
        self.list(name, Some(count))?.iter().enumerate().map(one).collect()
    }

    /// A list of tuples of numbers.
    pub(super) fn tuples<const N: usize>(&self, name: &str, count: usize) -> Result<Vec<[f64; N]>, Wrong> {
        self.list(name, Some(count))?.iter().enumerate().map(|(k, value)| self.tuple(name, k, value)).collect()
    }

    /// A list of tuples of numbers, each of which may be null.
    pub(super) fn tuples_or_null<const N: usize>(
        &self,
        name: &str,
        count: usize,
    ) -> Result<Vec<Option<[f64; N]>>, Wrong> {
        let one = |(k, value): (usize, &Value)| {
            if value.is_null() { Ok(None) } else { self.tuple(name, k, value).map(Some) }
        };
        self.list(name, Some(count))?.iter().enumerate().map(one).collect()
    }

    /// A list of lists of places.
    pub(super) fn rings(&self, name: &str) -> Result<Vec<Vec<[f64; 2]>>, Wrong> {
        let place = |value: &Value| <[f64; 2]>::deserialize(value).ok().filter(|p| p.iter().all(|x| x.is_finite()));
        let ring = |(k, value): (usize, &Value)| {
            let places = value.as_array().and_then(|list| list.iter().map(place).collect::<Option<Vec<_>>>());
            let wrong = || format!("{}[{k}]: not a ring of at least three places", self.path_of(name));
            places.filter(|places| places.len() > 2).ok_or_else(wrong)
        };
        self.list(name, None)?.iter().enumerate().map(ring).collect()
    }

    fn tuple<const N: usize>(&self, name: &str, k: usize, value: &Value) -> Result<[f64; N], Wrong> {
        let numbers: Option<Vec<f64>> =
            value.as_array().and_then(|list| list.iter().map(|x| x.as_f64().filter(|x| x.is_finite())).collect());
        let tuple = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        tuple.ok_or_else(|| format!("{}[{k}]: not {N} numbers", self.path_of(name)))
    }
}
