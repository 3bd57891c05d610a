//! The rules of a direction of travel that depend on the vehicle or the time, as they are kept and stored.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::rule::{About, Rule};
use crate::osm::facts::Direction;

/// The rules of one object, a way or a node. They are judged together: a more specific one may lift another.
#[derive(Debug, Clone)]
pub(crate) struct RuleGroup {
    pub(crate) side: Direction,
    pub(crate) rules: Vec<Rule>,
}

#[derive(Debug)]
struct Inner {
    text: String,
    groups: Vec<RuleGroup>,
}

/// Rules that depend on the vehicle or the time. A set is whole: it has all limits and access rules of its objects, so that
/// [`super::Legal::judge`] asks nothing else where there is one.
///
/// As text: one `key=value` a line, in order. Objects are separated by an empty line; each begins with its direction of travel.
#[derive(Clone)]
pub struct RuleSet(Arc<Inner>);

impl PartialEq for RuleSet {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0.text == other.0.text
    }
}

impl Eq for RuleSet {}

impl Hash for RuleSet {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.text.hash(state);
    }
}

impl fmt::Debug for RuleSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RuleSet({:?})", self.0.text)
    }
}

impl Serialize for RuleSet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.text.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for RuleSet {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::from_text(&text).ok_or_else(|| serde::de::Error::custom("rules that netcert does not write"))
    }
}

const SIDES: [(Direction, &str); 2] = [(Direction::Forward, "forward"), (Direction::Backward, "backward")];

impl RuleGroup {
    /// The rules of an object for a direction of travel.
    pub(crate) fn new<'t>(tags: impl Iterator<Item = (&'t str, &'t str)>, side: Direction) -> Self {
        let mut rules: Vec<Rule> = tags.filter_map(|(key, value)| Rule::read(key, value, side)).collect();
        rules.sort_by(|a, b| a.text.cmp(&b.text));
        rules.dedup_by(|a, b| a.text == b.text);
        Self { side, rules }
    }

    fn text(&self) -> String {
        let side = SIDES.iter().find(|(side, _)| *side == self.side).map_or("", |(_, name)| name);
        let mut text = side.to_owned();
        for rule in &self.rules {
            text.push('\n');
            text.push_str(&rule.text);
        }
        text
    }

    fn from_text(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let side = lines.next()?;
        let side = SIDES.iter().find(|(_, name)| *name == side)?.0;
        let tags: Vec<(&str, &str)> = lines.map(|line| line.split_once('=')).collect::<Option<_>>()?;
        let group = Self::new(tags.iter().copied(), side);
        (group.rules.len() == tags.len()).then_some(group)
    }
}

impl RuleSet {
    /// `None` without a rule.
    pub(crate) fn of(groups: Vec<RuleGroup>) -> Option<Self> {
        let mut groups: Vec<(String, RuleGroup)> =
            groups.into_iter().filter(|group| !group.rules.is_empty()).map(|group| (group.text(), group)).collect();
        groups.sort_by(|a, b| a.0.cmp(&b.0));
        groups.dedup_by(|a, b| a.0 == b.0);
        if groups.is_empty() {
            return None;
        }
        let text = groups.iter().map(|group| group.0.as_str()).collect::<Vec<_>>().join("\n\n");
        Some(Self(Arc::new(Inner { text, groups: groups.into_iter().map(|group| group.1).collect() })))
    }

    /// The rules of an object whose tags are the same in both directions of travel.
    pub fn from_tags(tags: &[(String, String)]) -> Option<Self> {
        let tags = tags.iter().map(|(key, value)| (key.as_str(), value.as_str()));
        Self::of(vec![RuleGroup::new(tags, Direction::Forward)])
    }

    /// The set of a text. `None` for a text that [`Self::text`] does not make.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        let groups = text.split("\n\n").map(RuleGroup::from_text).collect::<Option<Vec<_>>>()?;
        Self::of(groups).filter(|set| set.text() == text)
    }

    /// The rules as text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0.text
    }

    pub(crate) fn groups(&self) -> &[RuleGroup] {
        &self.0.groups
    }

    /// The rules of both, each object by itself.
    pub(crate) fn with(&self, other: &[RuleGroup]) -> Option<Self> {
        Self::of(self.groups().iter().chain(other).cloned().collect())
    }

    /// The rules, each as `key=value`.
    pub fn rules(&self) -> impl Iterator<Item = &str> {
        self.groups().iter().flat_map(|group| &group.rules).map(|rule| rule.text.as_str())
    }

    /// The widths that cannot be read, each as `key=value`.
    pub fn unreadable_widths(&self) -> impl Iterator<Item = &str> {
        let widths = self.groups().iter().flat_map(|group| &group.rules).filter(|rule| rule.about == About::Width);
        widths.map(|rule| rule.text.as_str())
    }

    /// The rules that say different things at different times, separated by semicolons.
    #[must_use]
    pub fn open_when(&self) -> Option<String> {
        let timed = self.groups().iter().flat_map(|group| &group.rules).filter(|rule| rule.depends_on_time());
        let mut texts: Vec<&str> = timed.map(|rule| rule.text.as_str()).collect();
        texts.sort_unstable();
        texts.dedup();
        (!texts.is_empty()).then(|| texts.join("; "))
    }
}
