//! Collects the tags of one object that may be rules, and decides whether rules have to be kept.

use super::judge::closed_to;
use super::rule::{About, Closes, Rule, Says, may_be_rule, oneway_closes, permission_for};
use super::set::{RuleGroup, RuleSet};
use super::subject::{At, Subject};
use super::{Legal, Property};
use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::{Direction, Limit, LimitKind, Oneway, Permission};
use crate::vehicle::{Class, Classes, EVERYBODY};

/// The tags of an object that may be rules.
#[derive(Debug, Default)]
pub(in crate::osm::facts) struct RuleTags<'t> {
    tags: Vec<(&'t str, &'t str)>,
    /// Whether a tag says more than plain limits and access can.
    needed: bool,
}

/// Whether a tag says no more than [`Legal`]'s plain limits and access.
fn is_simple(head: &str, suffix: &str, value: &str) -> bool {
    let direction = matches!(suffix, "" | "forward" | "backward");
    match head {
        "access" | "vehicle" | "motor_vehicle" | "hgv" => {
            direction && !value.split(';').any(|part| matches!(part.trim(), "psv" | "bus" | "tourist_bus" | "coach"))
        }
        "maxheight" | "maxlength" | "maxwidth" | "maxweight" | "maxaxleload" | "maxgcweight" | "maxweightrating"
        | "maxgcweightrating" => {
            suffix.split(':').all(|part| matches!(part, "" | "forward" | "backward" | "physical" | "legal" | "lanes"))
        }
        "oneway" => {
            let plain = |side| !matches!(oneway_closes(value, side), Closes::Sometimes | Closes::Unclear);
            suffix.is_empty() && plain(Direction::Forward) && plain(Direction::Backward)
        }
        _ => false,
    }
}

impl<'t> RuleTags<'t> {
    /// Takes a tag, its key split at the first colon, too.
    pub(in crate::osm::facts) fn take(&mut self, key: &'t str, head: &str, suffix: &str, value: &'t str) {
        if !may_be_rule(head) {
            return;
        }
        self.tags.push((key, value));
        if !self.needed && !is_simple(head, suffix, value) {
            self.needed = self.is_rule(key, value);
        }
    }

    /// Takes a width of the road that cannot be read.
    pub(in crate::osm::facts) fn take_unreadable_width(&mut self, key: &'t str, value: &'t str) {
        self.tags.push((key, value));
        self.needed = true;
    }

    /// The tags.
    pub(super) fn tags(&self) -> &[(&'t str, &'t str)] {
        &self.tags
    }

    fn is_rule(&self, key: &str, value: &str) -> bool {
        [Direction::Forward, Direction::Backward].iter().any(|&side| Rule::read(key, value, side).is_some())
    }

    fn plain(&self, wanted: &str) -> impl Iterator<Item = &'t str> {
        let of = move |key: &str| key.split(':').next() == Some(wanted) && !key.contains("conditional");
        self.tags.iter().filter(move |(key, _)| of(key)).map(|(_, value)| *value)
    }

    /// Whether rules have to be kept. `hgv=designated` is a fact of its own, and what opens a road to lorries alone opens it to no bus.
    fn are_needed(&self) -> bool {
        if self.needed {
            return true;
        }
        let Some(class) = Classes::builtin().get("semi") else { return true };
        let closed = EVERYBODY
            .iter()
            .flat_map(|key| self.plain(key))
            .any(|value| permission_for(value, class) > Permission::Yes);
        self.plain("hgv").any(|value| match permission_for(value, class) {
            Permission::Yes => closed || matches!(value, "designated" | "official"),
            Permission::Restricted => true,
            Permission::No => false,
        })
    }

    /// Whether there are rules of one-way traffic that depend on vehicle or time.
    fn has_oneway_rules(&self) -> bool {
        self.tags.iter().any(|(key, value)| {
            let (head, suffix) = key.split_once(':').unwrap_or((key, ""));
            (head == "oneway" || suffix.contains("oneway"))
                && !is_simple(head, suffix, value)
                && self.is_rule(key, value)
        })
    }

    fn group(&self, side: Direction, untagged: Oneway) -> RuleGroup {
        let oneway = self.has_oneway_rules();
        let is_oneway = |key: &str| key.split(':').any(|part| part == "oneway");
        // A motorway is one-way without a tag.
        let implied = oneway && untagged != Oneway::No && !self.tags.iter().any(|(key, _)| *key == "oneway");
        let tags = self.tags.iter().copied().filter(|(key, _)| oneway || !is_oneway(key));
        RuleGroup::new(tags.chain(implied.then_some(("oneway", "yes"))), side)
    }

    /// Adds the rules of a direction to its plain limits and access.
    pub(in crate::osm::facts) fn add_to(&self, legal: &mut Legal, side: Direction, untagged: Oneway) {
        if !self.are_needed() {
            return;
        }
        let group = self.group(side, untagged);
        for rule in &group.rules {
            show_limit(rule, legal);
        }
        legal.rules = RuleSet::of(vec![group]);
    }

    /// Remarks on rules.
    pub(in crate::osm::facts) fn note(&self, notes: &mut Notes) {
        if !self.are_needed() {
            return;
        }
        for side in [Direction::Forward, Direction::Backward] {
            for rule in self.group(side, Oneway::No).rules {
                if rule.is_strange() {
                    notes.add(if matches!(rule.about, About::Oneway(_)) {
                        Note::BadOneway
                    } else {
                        Note::BadCondition
                    });
                }
                if rule.depends_on_time() {
                    notes.add(Note::TimedRule);
                }
                if rule.has_unreadable_limit() {
                    notes.add(Note::BadLimit);
                }
            }
        }
    }

    /// The directions of travel that exist for some vehicle of `those` classes at some time, if rules of one-way traffic depend on vehicle
    /// or time. `None`: they do not.
    pub(in crate::osm::facts) fn oneway(&self, untagged: Oneway, those: impl Fn(&Class) -> bool) -> Option<Oneway> {
        if !self.has_oneway_rules() {
            return None;
        }
        let closed = [Direction::Forward, Direction::Backward].map(|side| {
            let group = self.group(side, untagged);
            let all = Classes::builtin().all();
            all.iter()
                .filter(|class| those(class))
                .all(|class| closed_to(&group, &Subject { vehicle: None, class, at: At::Always }))
        });
        Some(match closed {
            [false, true] => Oneway::Forward,
            [true, false] => Oneway::Backward,
            _ => Oneway::No,
        })
    }
}

/// Shows a limit for lorries among the plain ones, for people. Where there are rules, they decide.
fn show_limit(rule: &Rule, legal: &mut Legal) {
    let lorries = rule
        .scope
        .iter()
        .all(|key| matches!(key.as_str(), "vehicle" | "motor_vehicle" | "goods" | "hgv" | "hgv_articulated"));
    let (About::Limit(property), Says::Plain(value)) = (&rule.about, &rule.says) else { return };
    let kind = match property {
        Property::Height => LimitKind::Height,
        Property::Weight => LimitKind::Weight,
        Property::AxleLoad => LimitKind::AxleLoad,
        Property::Length => LimitKind::Length,
        Property::Width => LimitKind::Width,
        _ => return,
    };
    if lorries {
        for limit in value.split('|').filter(|limit| !limit.trim().is_empty()) {
            kind.add(legal, property.read(limit));
        }
    }
}

impl Rule {
    fn has_unreadable_limit(&self) -> bool {
        let About::Limit(property) = self.about else { return false };
        let unreadable = |text: &str| !text.trim().is_empty() && property.read(text) == Limit::Unreadable;
        match &self.says {
            Says::Plain(value) => value.split('|').any(unreadable),
            Says::Conditional(clauses) => clauses.iter().any(|clause| unreadable(&clause.value)),
        }
    }

    /// Whether it is an unconditional limit of a property.
    pub(super) fn is_plain_limit(&self, of: impl Fn(Property) -> bool) -> bool {
        matches!((&self.about, &self.says), (About::Limit(property), Says::Plain(_)) if of(*property))
    }

    /// The property and its bound, if the rule is that it is greater and nothing else.
    pub(super) fn only_size(&self) -> Option<(Property, f64)> {
        match &self.says {
            Says::Conditional(clauses) => match clauses.as_slice() {
                [clause] => clause.condition.only_size(),
                _ => None,
            },
            Says::Plain(_) => None,
        }
    }
}
