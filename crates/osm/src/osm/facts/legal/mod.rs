//! Limits and access of a direction of travel, and their judgement for a vehicle and a time.
//!
//! Plain limits and access of most roads are numbers and words in [`Legal`]. What depends on the vehicle's class or on the time is kept as
//! rules ([`RuleSet`]), with the text of the tags, and judged when vehicle and time are known.
//!
//! | file | for |
//! | --- | --- |
//! | `tags` | the tags of an object that may be rules |
//! | `rule` | a tag as a rule: whom it concerns, what it says |
//! | `condition`, `hours` | conditions and their times |
//! | `truth` | whether something holds always, never or at times |
//! | `property` | what is compared of a vehicle |
//! | `set` | the rules of a direction as they are kept and stored |
//! | `plain_tags` | the tag behind a plain limit, access or a barrier |
//! | `subject` | for whom and when a rule is judged |
//! | `judge`, `outcomes` | rules and a vehicle make a verdict |

mod condition;
mod hours;
mod judge;
mod outcomes;
mod plain_tags;
mod property;
mod rule;
mod set;
mod subject;
mod tags;
#[cfg(test)]
mod tests;
mod truth;

use super::{Direction, Legal, Limit, Permission, tag_lines};
use crate::vehicle::{Member, Vehicle};
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};
use plain_tags::AccessOf;
use property::{Property, SLACK};
use set::RuleGroup;
use subject::Subject;

pub(super) use rule::OTHER_VEHICLES;
pub use set::RuleSet;
pub use subject::At;
pub(super) use tags::RuleTags;

/// What limits and access say to a vehicle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Judgement {
    /// `Forbidden` if a rule excludes the vehicle, `Unknown(Limit)` if a limit that cannot be read or compared stands against it,
    /// `Unknown(Rule)` if a rule that is not understood may, `Unknown(Time)` if it is excluded at some times. `None`: nothing stands
    /// against it.
    pub verdict: Option<Verdict>,
    /// Whether it may go through, or only to a destination here, where it is not closed. `No` if it is forbidden, or if a plain limit stands
    /// against it.
    pub permission: Permission,
    /// The tag that opens the road to a destination only, as `key=value`; its keys if the tag is not known.
    pub destination: Option<String>,
    /// The tag behind the verdict as `key=value`. `None` if it is not known.
    pub rule: Option<String>,
    /// What a limit of that rule allows, in `unit`.
    pub allowed: Option<f64>,
    /// What the vehicle has, in `unit`.
    pub has: Option<f64>,
    /// `m`, `t` or empty.
    pub unit: &'static str,
}

/// The plain limits of a direction, beside the properties that they limit and their keys.
fn plain_limits(legal: &Legal) -> [(Limit, Property, &'static str); 5] {
    [
        (legal.max_height, Property::Height, "maxheight"),
        (legal.max_weight, Property::Weight, "maxweight"),
        (legal.max_axle_load, Property::AxleLoad, "maxaxleload"),
        (legal.max_length, Property::Length, "maxlength"),
        (legal.max_width, Property::Width, "maxwidth"),
    ]
}

impl Legal {
    /// Merges the rules of two objects: the stricter limit of each kind, and both sets of rules.
    #[must_use]
    pub fn merge(&self, other: &Legal) -> Legal {
        let rules = match (&self.rules, &other.rules) {
            (None, None) => None,
            (Some(own), Some(others)) if own == others => Some(own.clone()),
            (Some(own), Some(others)) => own.with(others.groups()),
            (Some(rules), None) => rules.with(&other.plain_group()),
            (None, Some(rules)) => rules.with(&self.plain_group()),
        };
        Legal {
            max_height: self.max_height.stricter(other.max_height),
            max_weight: self.max_weight.stricter(other.max_weight),
            max_axle_load: self.max_axle_load.stricter(other.max_axle_load),
            max_length: self.max_length.stricter(other.max_length),
            max_width: self.max_width.stricter(other.max_width),
            hgv: self.hgv.max(other.hgv),
            motor_vehicle: self.motor_vehicle.max(other.motor_vehicle),
            rules,
            tags: tag_lines::merged(self.tags.as_deref(), other.tags.as_deref()),
        }
    }

    /// Plain limits and access as rules, to be judged beside others.
    fn plain_group(&self) -> Vec<RuleGroup> {
        let word = |permission| match permission {
            Permission::Yes => None,
            Permission::Restricted => Some("destination"),
            Permission::No => Some("no"),
        };
        let mut tags: Vec<(&str, String)> = Vec::new();
        tags.extend(word(self.motor_vehicle).map(|word| ("motor_vehicle", word.to_owned())));
        tags.extend(word(self.hgv).map(|word| ("hgv", word.to_owned())));
        let limits = self.limit_tags("");
        let tags = tags.iter().map(|(key, value)| (*key, value.as_str()));
        let limits = limits.iter().map(|(key, value)| (key.as_str(), value.as_str()));
        vec![RuleGroup::new(tags.chain(limits), Direction::Forward)]
    }

    /// The plain limits as tags, their keys with an ending.
    pub fn limit_tags(&self, ending: &str) -> Vec<(String, String)> {
        let said = plain_limits(self).into_iter().filter_map(|(limit, _, key)| match limit {
            Limit::None => None,
            Limit::At(most) => Some((key, most.to_string())),
            Limit::Unreadable => Some((key, "unreadable".to_owned())),
        });
        said.map(|(key, value)| (format!("{key}{ending}"), value)).collect()
    }

    /// The same with other greatest heights and masses, where they are given: somebody measured what the signs say.
    #[must_use]
    pub fn with_limits(&self, height_m: Option<f32>, weight_t: Option<f32>) -> Legal {
        if height_m.is_none() && weight_t.is_none() {
            return self.clone();
        }
        let replaced = |property| match property {
            Property::Height => height_m.is_some(),
            Property::Weight => weight_t.is_some(),
            _ => false,
        };
        let rules = self.rules.as_ref().and_then(|rules| {
            let mut groups: Vec<RuleGroup> = rules.groups().to_vec();
            for group in &mut groups {
                group.rules.retain(|rule| !rule.is_plain_limit(replaced));
            }
            let tags = [("maxheight", height_m), ("maxweight", weight_t)];
            let tags: Vec<(&str, String)> =
                tags.iter().filter_map(|(key, most)| Some((*key, (*most)?.to_string()))).collect();
            groups.push(RuleGroup::new(tags.iter().map(|(key, value)| (*key, value.as_str())), Direction::Forward));
            RuleSet::of(groups)
        });
        Legal {
            max_height: height_m.map_or(self.max_height, Limit::At),
            max_weight: weight_t.map_or(self.max_weight, Limit::At),
            rules,
            tags: self.tags_but(replaced),
            ..self.clone()
        }
    }

    /// The verdict of limits and access at all times together. Sizes and masses that nobody stated of the vehicle are not compared.
    /// `Permission::Restricted` does not exclude, because a lorry may have its destination here.
    #[must_use]
    pub fn forbids(&self, vehicle: &Vehicle) -> Option<Verdict> {
        self.judge(vehicle, At::Always).verdict
    }

    /// What limits and access say to a vehicle at a time.
    #[must_use]
    pub fn judge(&self, vehicle: &Vehicle, at: At) -> Judgement {
        match (&self.rules, vehicle.class()) {
            (Some(rules), Some(class)) => judge_rules(rules, &Subject { vehicle: Some(vehicle), class, at }),
            _ => self.judge_plain(vehicle),
        }
    }

    fn judge_plain(&self, vehicle: &Vehicle) -> Judgement {
        let lorry = vehicle.class().is_none_or(|class| class.member("hgv") != Member::No);
        let hgv = if lorry { self.hgv } else { Permission::Yes };
        let permission = self.motor_vehicle.max(hgv);
        let closed = |reason, of| Judgement {
            verdict: Some(Verdict::Forbidden(reason)),
            permission: Permission::No,
            rule: self.tag_of_access(of, Permission::No),
            ..Judgement::default()
        };
        if self.motor_vehicle == Permission::No {
            return closed(ForbiddenReason::Access, AccessOf::MotorVehicles);
        }
        if hgv == Permission::No {
            return closed(ForbiddenReason::Hgv, AccessOf::Lorries);
        }
        let mut unreadable = None;
        for (limit, property, _) in plain_limits(self) {
            let Some((_, size)) = property.of(vehicle) else { continue };
            let of = |verdict, allowed| Judgement {
                verdict: Some(verdict),
                permission: Permission::No,
                destination: None,
                rule: self.tag_of_limit(property, limit),
                allowed,
                has: Some(size),
                unit: property.unit(),
            };
            match limit {
                Limit::At(most) if size > f64::from(most) + SLACK => {
                    return of(Verdict::Forbidden(property.reason()), Some(f64::from(most)));
                }
                Limit::Unreadable if unreadable.is_none() => {
                    unreadable = Some(of(Verdict::Unknown(UnknownReason::Limit), None));
                }
                _ => {}
            }
        }
        let restricted = (permission == Permission::Restricted).then(|| {
            let (of, keys) = if hgv == Permission::Restricted {
                (AccessOf::Lorries, "hgv")
            } else {
                (AccessOf::MotorVehicles, "access, vehicle or motor_vehicle")
            };
            self.tag_of_access(of, permission).unwrap_or_else(|| keys.to_owned())
        });
        unreadable.unwrap_or(Judgement { permission, destination: restricted, ..Judgement::default() })
    }

    /// The rules that say different things at different times, as text. `None` without one.
    #[must_use]
    pub fn open_when(&self) -> Option<String> {
        self.rules.as_ref()?.open_when()
    }
}

fn judge_rules(rules: &RuleSet, subject: &Subject<'_>) -> Judgement {
    let mut found = Vec::new();
    let (mut permission, mut by) = (Permission::Yes, None);
    for group in rules.groups() {
        let (own, rule) = judge::judge(group, subject, &mut found);
        if own > permission {
            (permission, by) = (own, rule);
        }
    }
    let mut worst: Option<judge::Finding<'_>> = None;
    for finding in found {
        if worst.is_none_or(|known| judge::weight(finding.verdict) > judge::weight(known.verdict)) {
            worst = Some(finding);
        }
    }
    let destination = by.filter(|_| permission == Permission::Restricted).map(|rule| rule.text.clone());
    let Some(judge::Finding { verdict, rule, limit }) = worst else {
        return Judgement { permission, destination, ..Judgement::default() };
    };
    let (property, allowed) = limit.map_or((None, None), |(property, allowed)| (Some(property), allowed));
    // The size that a rule of access compares.
    let (property, allowed) = match (property, rule.only_size()) {
        (None, Some((property, bound))) => (Some(property), Some(bound)),
        _ => (property, allowed),
    };
    let has = property
        .and_then(|property| property.of(subject.vehicle?))
        .map(|(_, most)| most)
        .filter(|most| most.is_finite());
    Judgement {
        verdict: Some(verdict),
        permission: if matches!(verdict, Verdict::Forbidden(_)) { Permission::No } else { permission },
        destination: destination.filter(|_| !matches!(verdict, Verdict::Forbidden(_))),
        rule: Some(rule.text.clone()),
        allowed,
        has,
        unit: property.map_or("", Property::unit),
    }
}
