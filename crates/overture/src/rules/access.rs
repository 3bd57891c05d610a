//! Access restrictions: what each does to an articulated lorry and to a bus, and what all of them do together.

use super::measures;
use super::{Limit, LimitKind, Oneway, Permission, headings};
use crate::osm::facts::{Legal, RuleSet};
use crate::record::{Access as Rule, When};

/// How specific the modes of a rule are for a lorry. The more specific one is the greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ModeRank {
    /// No modes are named.
    All,
    /// `vehicle`
    Vehicle,
    /// `motor_vehicle`
    MotorVehicle,
    /// `truck`, `hgv`; for a bus, `bus`
    Lorry,
}

/// For whom rules are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum For {
    Lorries,
    Buses,
}

/// Modes that are neither lorries nor buses.
const OTHERS: [&str; 8] = ["bicycle", "car", "emergency", "foot", "hov", "motorcycle", "pedestrian", "taxi"];

/// The rank of a rule's modes, and whether some of them are unknown. `None` if it concerns no vehicle of the kind.
fn rank(when: Option<&When>, whom: For) -> (Option<ModeRank>, bool) {
    let Some(modes) = when.and_then(|when| when.mode.as_ref()).filter(|modes| !modes.is_empty()) else {
        return (Some(ModeRank::All), false);
    };
    let mut strange = false;
    let of_mode = |mode: &String| match mode.as_str() {
        "vehicle" => Some(ModeRank::Vehicle),
        "motor_vehicle" => Some(ModeRank::MotorVehicle),
        "truck" | "hgv" => (whom == For::Lorries).then_some(ModeRank::Lorry),
        "bus" => (whom == For::Buses).then_some(ModeRank::Lorry),
        other => {
            strange |= !OTHERS.contains(&other);
            None
        }
    };
    (modes.iter().filter_map(of_mode).max(), strange)
}

/// Whether a rule that closes or slows may concern a lorry. An unknown mode may be one.
pub(crate) fn concerns_lorries(when: Option<&When>) -> bool {
    let (rank, strange) = rank(when, For::Lorries);
    rank.is_some() || strange
}

/// What a rule does.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Effect {
    /// Closes the headings, whole or to through traffic. `direction`: the rule says that this direction of travel does not exist.
    Deny { rank: ModeRank, headings: [bool; 2], to: Permission, direction: bool },
    /// Closes the headings at some times.
    DenyDuring { rank: ModeRank, headings: [bool; 2], times: String },
    /// Lifts denials.
    Allow { rank: ModeRank, headings: [bool; 2], to: Permission },
    /// Bars large vehicles.
    Limit { headings: [bool; 2], kind: LimitKind, limit: Limit },
    /// Bars vehicles with more axles.
    Axles { headings: [bool; 2], most: u32 },
    /// Nothing, and why.
    None(&'static str),
}

impl Effect {
    /// The effect of a rule, and a remark on it.
    pub(super) fn of(rule: &Rule, whom: For) -> (Self, Option<&'static str>) {
        let when = rule.when.as_ref();
        let (rank, strange_mode) = rank(when, whom);
        let strange = strange_mode || when.is_some_and(When::is_strange);
        match rule.access_type.as_deref() {
            Some("allowed" | "designated") => {
                let effect = match rank {
                    None => Self::None("other_vehicles"),
                    Some(_) if strange => Self::None("not_understood"),
                    Some(rank) => Self::allow(when, rank),
                };
                (effect, None)
            }
            kind => match rank.or(strange_mode.then_some(ModeRank::Lorry)) {
                None => (Self::None("other_vehicles"), None),
                Some(rank) if !strange && kind == Some("denied") => Self::deny(when, rank),
                // What is not understood may close the road, and so may an unknown kind of rule.
                Some(rank) => {
                    let headings = headings(when);
                    (Self::Deny { rank, headings, to: Permission::No, direction: false }, Some("not_understood"))
                }
            },
        }
    }

    /// What a rule opens of which everything is understood but perhaps its heading.
    fn allow(when: Option<&When>, rank: ModeRank) -> Self {
        let Some(when) = when else { return Self::Allow { rank, headings: [true; 2], to: Permission::Yes } };
        if !matches!(when.heading.as_deref(), None | Some("forward" | "backward")) {
            return Self::None("not_understood");
        }
        // When and for which sizes it opens is not decided, so it opens nothing.
        if when.during.is_some() || when.vehicle.as_ref().is_some_and(|sizes| !sizes.is_empty()) {
            return Self::None("opens_under_conditions");
        }
        let any = |words: &Option<Vec<String>>, known: &[&str]| {
            words.as_ref().map(|words| words.iter().any(|word| known.contains(&word.as_str())))
        };
        let using = any(&when.using, &["as_customer", "at_destination", "to_deliver"]);
        let recognized = any(&when.recognized, &["as_permitted"]);
        let to = match (using, recognized) {
            (None, None) => Permission::Yes,
            (Some(false), _) | (_, Some(false)) => return Self::None("opens_under_conditions"),
            _ => Permission::Restricted,
        };
        Self::Allow { rank, headings: headings(Some(when)), to }
    }

    /// What a rule closes of which everything is understood, and a remark on it.
    fn deny(when: Option<&When>, rank: ModeRank) -> (Self, Option<&'static str>) {
        let Some(when) = when else {
            return (Self::Deny { rank, headings: [true; 2], to: Permission::No, direction: false }, None);
        };
        let headings = headings(Some(when));
        let sizes = when.vehicle.as_deref().unwrap_or_default();
        let times = when.during.is_some() || when.using.is_some() || when.recognized.is_some();
        if !sizes.is_empty() {
            // All comparisons hold together, so each of them bars at least what the rule bars. Sizes that are always known come first.
            let usable = sizes.iter().filter_map(measures::limit).min_by_key(|(kind, _)| order(*kind));
            let note = if sizes.len() > 1 { Some("several_sizes") } else { times.then_some("condition_undecided") };
            return match usable {
                None if let Some(most) = sizes.iter().find_map(measures::axles) => {
                    (Self::Axles { headings, most }, note)
                }
                Some((kind, limit)) => (Self::Limit { headings, kind, limit }, note),
                // Every vehicle has a length, so this makes every verdict unknown.
                None => (
                    Self::Limit { headings, kind: LimitKind::Length, limit: Limit::Unreadable },
                    Some("size_undecided"),
                ),
            };
        }
        if let (Some(times), None, None) = (&when.during, &when.using, &when.recognized) {
            return (Self::DenyDuring { rank, headings, times: times.clone() }, None);
        }
        if times {
            return (
                Self::Deny { rank, headings, to: Permission::Restricted, direction: false },
                Some("condition_undecided"),
            );
        }
        let one = headings[0] != headings[1];
        (Self::Deny { rank, headings, to: Permission::No, direction: one && rank == ModeRank::All }, None)
    }
}

/// The order in which sizes are preferred: height and masses of a vehicle may be unknown.
fn order(kind: LimitKind) -> u8 {
    match kind {
        LimitKind::Length => 0,
        LimitKind::Width => 1,
        LimitKind::Height => 2,
        LimitKind::Weight => 3,
        LimitKind::AxleLoad => 4,
    }
}

/// Access of a part of a road, while its rules are applied in order.
#[derive(Debug, Default)]
pub(super) struct SegmentAccess {
    limits: [Legal; 2],
    /// By heading and rank.
    denied: [[Permission; 4]; 2],
    /// By heading: whether a rule says that the direction does not exist.
    absent: [bool; 2],
    /// Times at which headings are closed, by rank.
    times: Vec<(usize, ModeRank, String)>,
    /// Greatest number of axles, by heading.
    axles: [Option<u32>; 2],
}

/// Access of a part of a road for lorries or for buses.
pub(super) struct VehicleAccess {
    pub(super) limits: [Legal; 2],
    pub(super) denied: [[Permission; 4]; 2],
    pub(super) oneway: Oneway,
    pub(super) times: Vec<(usize, ModeRank, String)>,
    pub(super) axles: [Option<u32>; 2],
}

impl SegmentAccess {
    pub(super) fn apply(&mut self, effect: &Effect) {
        match effect.clone() {
            Effect::None(_) => {}
            Effect::Axles { headings, most } => {
                for (slot, _) in self.axles.iter_mut().zip(headings).filter(|(_, on)| *on) {
                    *slot = Some(slot.map_or(most, |known| known.min(most)));
                }
            }
            Effect::DenyDuring { rank, headings, times } => {
                let on = headings.into_iter().enumerate().filter(|(_, on)| *on);
                self.times.extend(on.map(|(heading, _)| (heading, rank, times.clone())));
            }
            Effect::Limit { headings, kind, limit } => {
                for (legal, _) in self.limits.iter_mut().zip(headings).filter(|(_, on)| *on) {
                    kind.add(legal, limit);
                }
            }
            Effect::Deny { rank, headings, to, direction } => {
                for (heading, _) in headings.into_iter().enumerate().filter(|(_, on)| *on) {
                    let slot = &mut self.denied[heading][rank as usize];
                    *slot = (*slot).max(to);
                    self.absent[heading] |= direction;
                }
            }
            Effect::Allow { rank, headings, to } => {
                for (heading, _) in headings.into_iter().enumerate().filter(|(_, on)| *on) {
                    self.denied[heading].iter_mut().take(rank as usize + 1).for_each(|slot| *slot = (*slot).min(to));
                    self.absent[heading] = false;
                    self.times.retain(|(closed, of, _)| *closed != heading || *of > rank || to > Permission::Yes);
                }
            }
        }
    }

    /// What all rules together say.
    pub(super) fn finish(self) -> VehicleAccess {
        let oneway = match self.absent {
            [false, true] => Oneway::Forward,
            [true, false] => Oneway::Backward,
            _ => Oneway::No,
        };
        VehicleAccess { limits: self.limits, denied: self.denied, oneway, times: self.times, axles: self.axles }
    }
}

impl VehicleAccess {
    /// Access by the general ranks, and by that of the kind of vehicle.
    fn permissions(&self, heading: usize) -> [Permission; 2] {
        let [general @ .., own] = self.denied[heading];
        [general.into_iter().max().unwrap_or_default(), own]
    }

    /// Limits and access by heading; the directions that exist for some vehicle, and those of lorries. What differs for buses, and what depends on times or
    /// axles, becomes rules as tags would say them.
    pub(super) fn with_buses(self, buses: &Self) -> ([Legal; 2], [Oneway; 2]) {
        let oneway = if self.oneway == buses.oneway { self.oneway } else { Oneway::No };
        let mut legal = self.limits.clone();
        for (heading, legal) in legal.iter_mut().enumerate() {
            let [general, lorry] = self.permissions(heading);
            (legal.motor_vehicle, legal.hgv) = (general, lorry);
            let timed = |rank: fn(ModeRank) -> bool| self.times.iter().any(|(at, of, _)| *at == heading && rank(*of));
            if timed(|rank| rank < ModeRank::Lorry) {
                legal.motor_vehicle = legal.motor_vehicle.max(Permission::Restricted);
            }
            if timed(|rank| rank == ModeRank::Lorry) {
                legal.hgv = legal.hgv.max(Permission::Restricted);
            }
            legal.rules = self.rules(buses, heading);
        }
        (legal, [oneway, self.oneway])
    }

    /// What holds at all times, with the direction of travel.
    fn total(&self, heading: usize) -> Permission {
        let gone = matches!((heading, self.oneway), (0, Oneway::Backward) | (1, Oneway::Forward));
        let closed = if gone { Permission::No } else { Permission::Yes };
        self.permissions(heading).into_iter().fold(closed, Permission::max)
    }

    fn rules(&self, buses: &Self, heading: usize) -> Option<RuleSet> {
        let both = [("hgv", self), ("bus", buses)];
        let timed = both.iter().any(|(_, outcome)| outcome.times.iter().any(|(at, ..)| *at == heading));
        let axles = both.iter().any(|(_, outcome)| outcome.axles[heading].is_some());
        let differ = self.total(heading) != buses.total(heading) || self.limits[heading] != buses.limits[heading];
        if !(timed || axles || differ) {
            return None;
        }
        let word = |permission| match permission {
            Permission::Yes => "yes",
            Permission::Restricted => "destination",
            Permission::No => "no",
        };
        let [general, lorry] = self.permissions(heading);
        let general = if lorry < self.total(heading) { self.total(heading) } else { general };
        let mut tags = vec![("motor_vehicle".to_owned(), word(general).to_owned())];
        for (key, outcome) in both {
            if outcome.total(heading) != general {
                tags.push((key.to_owned(), word(outcome.total(heading)).to_owned()));
            }
            let times = outcome.times.iter().filter(|(at, ..)| *at == heading);
            let times: Vec<String> = times.map(|(_, _, times)| format!("no @ ({times})")).collect();
            if !times.is_empty() {
                tags.push((format!("{key}:conditional"), times.join("; ")));
            }
            tags.extend(outcome.axles[heading].map(|most| (format!("maxaxles:{key}"), most.to_string())));
            tags.extend(outcome.limits[heading].limit_tags(&format!(":{key}")));
        }
        RuleSet::from_tags(&tags)
    }
}
