//! Rules and a vehicle make a verdict.
//!
//! Access: of the keys of the vehicle's class the most specific one decides, with a direction before without, as on the wiki page
//! Key:access. Conditions come after plain values of the same key, a later clause before an earlier one. Limits: the strictest counts.
//!
//! One rule is stricter than the wiki: a plain value of a more specific key does not lift a condition that closes the road, because passes
//! and gates are closed for everybody. `designated` and the keys of buses lift conditions of `vehicle` and `motor_vehicle`.

use super::condition::Clause;
use super::outcomes::{Cause, Outcomes, RuleOutcome};
use super::property::{Property, SLACK};
use super::rule::{About, Closes, Rule, Says, oneway_closes, permission_for};
use super::set::RuleGroup;
use super::subject::Subject;
use super::truth::Truth;
use crate::osm::facts::{Direction, Limit, Permission};
use crate::vehicle::{EVERYBODY, Member};
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

/// What stands against a vehicle, and by which rule.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Finding<'g> {
    pub(crate) verdict: Verdict,
    pub(crate) rule: &'g Rule,
    /// The limit and what it limits.
    pub(crate) limit: Option<(Property, Option<f64>)>,
}

/// The greater, the more it says against the vehicle. What time decides comes last: another time may do.
pub(crate) fn weight(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Forbidden(_) => 4,
        Verdict::Unknown(UnknownReason::Limit) => 3,
        Verdict::Unknown(UnknownReason::Rule) => 2,
        Verdict::Unknown(_) => 1,
        Verdict::Safe | Verdict::Unsafe(_) => 0,
    }
}

/// Whether the keys are those of access or of the direction of travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Chain {
    Access,
    Oneway,
}

impl Chain {
    fn key(self, rule: &Rule) -> Option<&str> {
        match (self, &rule.about) {
            (Self::Access, About::Access(key)) | (Self::Oneway, About::Oneway(key)) => Some(key),
            _ => None,
        }
    }
}

/// Adds what an object's rules say against a vehicle to `found`, and returns its permission with the rule that gives it.
pub(crate) fn judge<'g>(
    group: &'g RuleGroup,
    subject: &Subject<'_>,
    found: &mut Vec<Finding<'g>>,
) -> (Permission, Option<&'g Rule>) {
    let access = outcomes(group, subject, Chain::Access);
    found.extend(finding(group, &access, Chain::Access));
    let oneway = outcomes(group, subject, Chain::Oneway);
    found.extend(finding(group, &oneway, Chain::Oneway));
    for rule in &group.rules {
        found.extend(of_rule(rule, subject));
    }
    let open = access.iter().filter(|outcome| outcome.permission < Permission::No);
    let strictest = open.max_by_key(|outcome| outcome.permission);
    strictest.map_or((Permission::No, None), |outcome| {
        (outcome.permission, outcome.rule.and_then(|rule| group.rules.get(rule)))
    })
}

/// Whether the rules of one-way traffic close the direction to all vehicles of the class at all times.
pub(crate) fn closed_to(group: &RuleGroup, subject: &Subject<'_>) -> bool {
    let outcomes = outcomes(group, subject, Chain::Oneway);
    let mut all = outcomes.iter();
    all.all(|outcome| outcome.permission == Permission::No && outcome.cause == Cause::Certain)
}

/// Whether `designated` and the keys of buses lift a condition that closes the road.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Closure {
    Liftable,
    Lasting,
}

/// What the rules of a key can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Force {
    /// They decide.
    Decides,
    /// They close, and open nothing.
    ClosesOnly,
}

/// Conditions that close the road, whatever more specific keys say.
#[derive(Default)]
struct Closures(Vec<(RuleOutcome, Closure)>);

impl Closures {
    fn add(&mut self, outcomes: &Outcomes, closure: Closure) {
        self.0.extend(outcomes.get(Permission::No).map(|outcome| (outcome, closure)));
    }

    fn lift(&mut self) {
        self.0.retain(|(_, closure)| *closure == Closure::Lasting);
    }
}

fn outcomes(group: &RuleGroup, subject: &Subject<'_>, chain: Chain) -> Outcomes {
    let open = RuleOutcome { permission: Permission::Yes, cause: Cause::Certain, rule: None };
    let mut outcomes = Outcomes::one(open);
    let keys: Vec<(usize, &Rule, &str)> =
        group.rules.iter().enumerate().filter_map(|(i, rule)| Some((i, rule, chain.key(rule)?))).collect();
    if keys.is_empty() {
        return outcomes;
    }
    let mut closures = Closures::default();
    let everybody = (chain == Chain::Oneway).then_some("").into_iter().chain(EVERYBODY);
    let levels = everybody.chain(subject.class.keys.iter().map(String::as_str));
    for key in levels {
        let maybe = !key.is_empty() && subject.class.member(key) == Member::Maybe;
        let force = if maybe { Force::ClosesOnly } else { Force::Decides };
        for directed in [false, true] {
            let level: Vec<(usize, &Rule)> = keys
                .iter()
                .filter(|(_, rule, own)| *own == key && rule.directed == directed && rule.scope.is_empty())
                .map(|(i, rule, _)| (*i, *rule))
                .collect();
            step(&level, subject, group.side, key, force, &mut outcomes, &mut closures);
        }
    }
    // `hgv:trailer`: whatever the keys by themselves say.
    for (i, rule, key) in &keys {
        let concerns = key.is_empty() || subject.class.member(key) != Member::No;
        if !rule.scope.is_empty() && concerns && rule.concerns(subject.class) {
            step(&[(*i, *rule)], subject, group.side, key, Force::ClosesOnly, &mut outcomes, &mut closures);
        }
    }
    for (outcome, _) in closures.0 {
        if outcome.cause == Cause::Certain {
            return Outcomes::one(outcome);
        }
        outcomes.add(outcome);
    }
    outcomes
}

/// Applies the rules of one key, plain ones first.
fn step(
    level: &[(usize, &Rule)],
    subject: &Subject<'_>,
    side: Direction,
    key: &str,
    force: Force,
    outcomes: &mut Outcomes,
    closures: &mut Closures,
) {
    let plain = level.iter().filter_map(|&(i, rule)| match &rule.says {
        Says::Plain(value) => Some((plain_outcome(rule, value, side, i, subject), value.as_str())),
        Says::Conditional(_) => None,
    });
    let strictest = plain.max_by_key(|(outcome, _)| (outcome.permission, outcome.cause));
    if let Some((outcome, value)) = strictest {
        if force == Force::ClosesOnly {
            let mut both = outcomes.restricted(outcome);
            if outcome.cause > Cause::Certain {
                both.add_all(outcomes);
            }
            *outcomes = both;
        } else {
            *outcomes = Outcomes::one(outcome);
            if outcome.cause > Cause::Certain {
                outcomes.add(RuleOutcome { permission: Permission::Yes, cause: Cause::Certain, ..outcome });
            }
            let lifts = matches!(value, "designated" | "official") || matches!(key, "psv" | "bus" | "tourist_bus");
            if lifts && outcome.permission < Permission::No {
                closures.lift();
            }
        }
        if outcome.cause == Cause::Time {
            closures.add(outcomes, Closure::Lasting);
        }
    }
    for &(i, rule) in level {
        if let Says::Conditional(clauses) = &rule.says {
            let (new, covered) = conditional(rule, clauses, side, i, subject);
            if force == Force::ClosesOnly {
                let mut all = if covered { Outcomes::NONE } else { *outcomes };
                new.iter().for_each(|outcome| all.add_all(&outcomes.restricted(outcome)));
                *outcomes = all;
            } else {
                let mut all = new;
                if covered {
                    closures.lift();
                } else {
                    all.add_all(outcomes);
                }
                *outcomes = all;
            }
            closures.add(&new, if key == "access" { Closure::Lasting } else { Closure::Liftable });
        }
    }
}

fn plain_outcome(rule: &Rule, value: &str, side: Direction, i: usize, subject: &Subject<'_>) -> RuleOutcome {
    let (permission, cause) = meaning(rule, value, side, subject);
    RuleOutcome { permission, cause, rule: Some(i) }
}

/// What a value says of access, or of a direction of travel.
fn meaning(rule: &Rule, value: &str, side: Direction, subject: &Subject<'_>) -> (Permission, Cause) {
    match rule.about {
        About::Oneway(_) => match oneway_closes(value, side) {
            Closes::No => (Permission::Yes, Cause::Certain),
            Closes::Sometimes => (Permission::No, Cause::Time),
            Closes::Unclear => (Permission::No, Cause::Unclear),
            Closes::Yes => (Permission::No, Cause::Certain),
        },
        _ => (permission_for(value, subject.class), Cause::Certain),
    }
}

/// The outcomes of clauses, the last one first, and whether one of them always holds.
fn conditional(rule: &Rule, clauses: &[Clause], side: Direction, i: usize, subject: &Subject<'_>) -> (Outcomes, bool) {
    let mut new = Outcomes::NONE;
    for clause in clauses.iter().rev() {
        let (truth, purpose) = clause.condition.truth(subject);
        let Some(mut cause) = Cause::of(truth) else { continue };
        let (mut permission, unclear) = meaning(rule, &clause.value, side, subject);
        cause = cause.max(unclear);
        if purpose && permission == Permission::Yes {
            permission = Permission::Restricted;
        } else if purpose && permission == Permission::No {
            // Closed to those with a destination here, which nobody means.
            cause = cause.max(Cause::Unclear);
        }
        // What is not understood opens nothing.
        if cause == Cause::Unclear && permission == Permission::Yes {
            continue;
        }
        new.add(RuleOutcome { permission, cause, rule: Some(i) });
        if cause == Cause::Certain {
            return (new, true);
        }
    }
    (new, false)
}

/// The finding of outcomes: closed, or closed at some times.
fn finding<'g>(group: &'g RuleGroup, outcomes: &Outcomes, chain: Chain) -> Option<Finding<'g>> {
    let no = outcomes.get(Permission::No)?;
    let rule_of = |outcome: RuleOutcome| outcome.rule.and_then(|i| group.rules.get(i));
    let mut opens = outcomes.iter().filter(|outcome| outcome.permission < Permission::No).collect::<Vec<_>>();
    opens.sort_by_key(|outcome| outcome.cause);
    let open = opens.last().copied();
    let cause = open.map_or(no.cause, |open| open.cause.max(no.cause));
    if open.is_none() && cause == Cause::Certain {
        let rule = rule_of(no)?;
        return Some(Finding { verdict: Verdict::Forbidden(reason(rule, chain)), rule, limit: None });
    }
    let decisive = if no.cause > Cause::Certain { Some(no) } else { open };
    let rule = decisive.and_then(rule_of).or_else(|| rule_of(no))?;
    let reason = if cause == Cause::Unclear { UnknownReason::Rule } else { UnknownReason::Time };
    Some(Finding { verdict: Verdict::Unknown(reason), rule, limit: None })
}

/// The reason of a rule that closes.
fn reason(rule: &Rule, chain: Chain) -> ForbiddenReason {
    if chain == Chain::Oneway {
        return ForbiddenReason::Oneway;
    }
    if let Says::Conditional(clauses) = &rule.says
        && let [clause] = clauses.as_slice()
        && let Some((property, _)) = clause.condition.only_size()
    {
        return property.reason();
    }
    match &rule.about {
        About::Access(key) => match key.as_str() {
            "hgv" | "goods" | "hgv_articulated" | "trailer" | "semitrailer" => ForbiddenReason::Hgv,
            _ if !rule.scope.is_empty() => ForbiddenReason::Class,
            key if EVERYBODY.contains(&key) => ForbiddenReason::Access,
            _ => ForbiddenReason::Class,
        },
        _ => ForbiddenReason::Access,
    }
}

/// What a limit, or a rule without a vehicle, says.
fn of_rule<'g>(rule: &'g Rule, subject: &Subject<'_>) -> Option<Finding<'g>> {
    let of = |verdict, limit| Some(Finding { verdict, rule, limit });
    match (&rule.about, &rule.says) {
        (About::Limit(property), says) if rule.concerns(subject.class) => of_limit(rule, *property, says, subject),
        (About::Impassable, Says::Plain(_)) => of(Verdict::Forbidden(ForbiddenReason::Access), None),
        (About::Seasonal, Says::Plain(_)) => of(Verdict::Unknown(UnknownReason::Time), None),
        (About::Impassable | About::Seasonal, Says::Conditional(clauses)) => {
            let worst = clauses.iter().filter(|clause| clause.value != "no");
            let truth = worst.map(|clause| clause.condition.truth(subject).0).max_by_key(|truth| *truth as u8)?;
            of(verdict_of(truth, ForbiddenReason::Access)?, None)
        }
        _ => None,
    }
}

fn verdict_of(truth: Truth, reason: ForbiddenReason) -> Option<Verdict> {
    Some(match truth {
        Truth::Never => return None,
        Truth::Sometimes => Verdict::Unknown(UnknownReason::Time),
        Truth::Unclear => Verdict::Unknown(UnknownReason::Rule),
        Truth::Always => Verdict::Forbidden(reason),
    })
}

fn of_limit<'g>(rule: &'g Rule, property: Property, says: &Says, subject: &Subject<'_>) -> Option<Finding<'g>> {
    let mut worst: Option<Finding<'g>> = None;
    let mut take = |verdict: Verdict, most: Option<f64>| {
        let finding = Finding { verdict, rule, limit: Some((property, most)) };
        if worst.is_none_or(|known| weight(finding.verdict) > weight(known.verdict)) {
            worst = Some(finding);
        }
    };
    match says {
        Says::Plain(value) => {
            for limit in value.split('|').filter(|limit| !limit.trim().is_empty()) {
                let (verdict, most) = compared(property, limit, subject)?;
                verdict.into_iter().for_each(|verdict| take(verdict, most));
            }
        }
        Says::Conditional(clauses) => {
            for clause in clauses {
                // A purpose is no excuse: a limit for some journeys counts for all.
                let (truth, _) = clause.condition.truth(subject);
                let (verdict, most) = compared(property, &clause.value, subject)?;
                let Some(verdict) = verdict else { continue };
                match truth {
                    Truth::Never => {}
                    Truth::Always => take(verdict, most),
                    Truth::Sometimes => take(Verdict::Unknown(UnknownReason::Time), most),
                    Truth::Unclear => take(Verdict::Unknown(UnknownReason::Rule), most),
                }
            }
        }
    }
    worst
}

/// The verdict of a limit's text, and the limit. `None`: the vehicle's value is not stated, so that nothing is compared.
fn compared(property: Property, text: &str, subject: &Subject<'_>) -> Option<(Option<Verdict>, Option<f64>)> {
    let (least, most) = property.of(subject.vehicle?)?;
    Some(match property.read(text) {
        Limit::None => (None, None),
        Limit::Unreadable => (Some(Verdict::Unknown(UnknownReason::Limit)), None),
        Limit::At(allowed) => {
            let allowed = f64::from(allowed);
            let verdict = if least > allowed + SLACK {
                Some(Verdict::Forbidden(property.reason()))
            } else {
                (most > allowed + SLACK).then_some(Verdict::Unknown(UnknownReason::Limit))
            };
            (verdict, Some(allowed))
        }
    })
}
