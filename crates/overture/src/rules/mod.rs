//! Rules become facts: access and limits, speeds, widths, slip roads, refs. Every rule is kept or counted under one reason.
//!
//! Of several rules the schema lets the last one that matches decide. Here a denial stands unless a later rule that is at least as
//! specific lifts it, so nothing is more open than the schema says. What cannot be decided closes the road or makes a limit unknown.

mod access;
mod measures;

use std::num::NonZeroU8;

use super::account::{Account, RULE};
use super::record::{Segment, SpeedLimit, When};
use crate::osm::facts::{Legal, Limit, LimitKind, Oneway, Permission, RoadClass, RoadValues};

pub(super) use access::concerns_lorries;
use access::{Effect, For, ModeRank, SegmentAccess};

/// Part of a segment that a rule holds on: shares from its begin and to its end.
pub(super) type Range = [f64; 2];

/// The rules of one segment.
#[derive(Debug, Default)]
pub(super) struct SegmentRules {
    access: Vec<(Range, Effect)>,
    buses: Vec<(Range, Effect)>,
    speeds: Vec<(Range, [bool; 2], NonZeroU8)>,
    widths: Vec<(Range, f64)>,
    links: Vec<Range>,
    /// Stretches that lead to a house or along parking spaces.
    minor: Vec<Range>,
    /// Stretches that are not in use.
    closed: Vec<Range>,
    refs: Vec<(Range, String)>,
    link: bool,
}

/// The range of a rule, or `None` for one that is no range of a segment.
pub(super) fn range(between: Option<&[f64]>) -> Option<Range> {
    match between {
        None => Some([0.0, 1.0]),
        Some(&[from, to]) if 0.0 <= from && from < to && to <= 1.0 => Some([from, to]),
        Some(_) => None,
    }
}

impl SegmentRules {
    /// Reads the rules of a segment and counts each.
    pub(super) fn of(segment: &Segment, account: &mut Account) -> Self {
        let mut rules = Self { link: segment.subclass.as_deref() == Some("link"), ..Self::default() };
        rules.minor.extend(segment.subclass.as_deref().is_some_and(is_minor).then_some([0.0, 1.0]));
        for rule in segment.access_restrictions.iter().flatten() {
            rules.add_access(rule, account);
        }
        for rule in segment.speed_limits.iter().flatten() {
            rules.add_speed(rule, account);
        }
        for rule in segment.width_rules.iter().flatten() {
            match rule.value.filter(|width| width.is_finite() && *width > 0.0) {
                // A width whose place is unknown may be anywhere.
                Some(width_m) => {
                    rules.widths.push((range_or_whole(rule.between.as_deref(), account), width_m));
                    account.kept(RULE, 1);
                }
                None => account.left_out(RULE, "width_unreadable", 1),
            }
        }
        for rule in segment.subclass_rules.iter().flatten() {
            match (rule.value.as_deref(), range(rule.between.as_deref())) {
                (Some("link"), Some(range)) => {
                    rules.links.push(range);
                    account.kept(RULE, 1);
                }
                // Where its place is unknown, all of the segment is left out.
                (Some(value), _) if is_minor(value) => {
                    rules.minor.push(range_or_whole(rule.between.as_deref(), account));
                    account.kept(RULE, 1);
                }
                _ => account.left_out(RULE, "subclass", 1),
            }
        }
        for rule in segment.road_flags.iter().flatten() {
            let has = |flag: &str| rule.values.iter().flatten().any(|value| value == flag);
            let closed = has("is_under_construction") || has("is_abandoned");
            if closed {
                rules.closed.push(range_or_whole(rule.between.as_deref(), account));
            }
            match range(rule.between.as_deref()) {
                Some(range) if has("is_link") => rules.links.push(range),
                _ if closed => {}
                _ => {
                    account.left_out(RULE, "road_flags", 1);
                    continue;
                }
            }
            account.kept(RULE, 1);
        }
        for route in segment.routes.iter().flatten() {
            let reference = route.reference.as_deref().map(str::trim).filter(|reference| !reference.is_empty());
            if let (Some(reference), Some(range)) = (reference, range(route.between.as_deref())) {
                rules.refs.push((range, reference.to_owned()));
            }
        }
        for (reason, number) in [
            ("road_surface", segment.road_surface.as_ref().map_or(0, Vec::len)),
            ("level", segment.level_rules.as_ref().map_or(0, Vec::len)),
            ("destinations", segment.destinations.as_ref().map_or(0, Vec::len)),
        ] {
            account.left_out(RULE, reason, number as u64);
        }
        rules
    }

    fn add_access(&mut self, rule: &super::record::Access, account: &mut Account) {
        let (effect, note) = Effect::of(rule, For::Lorries);
        let (of_buses, _) = Effect::of(rule, For::Buses);
        if let Some(note) = note {
            account.noted(RULE, note, 1);
        }
        let place = range(rule.between.as_deref());
        let for_buses = match (&of_buses, place) {
            (Effect::None(_), _) | (Effect::Allow { .. }, None) => false,
            (_, place) => {
                self.buses.push((place.unwrap_or([0.0, 1.0]), of_buses));
                true
            }
        };
        match (effect, place) {
            (Effect::None(_), _) if for_buses => account.kept(RULE, 1),
            (Effect::None(reason), _) => account.left_out(RULE, reason, 1),
            // Nobody knows where it opens the road.
            (Effect::Allow { .. }, None) => account.left_out(RULE, "between_unreadable", 1),
            (effect, _) => {
                self.access.push((range_or_whole(rule.between.as_deref(), account), effect));
                account.kept(RULE, 1);
            }
        }
    }

    fn add_speed(&mut self, rule: &SpeedLimit, account: &mut Account) {
        let when = rule.when.as_ref();
        let conditional = when.is_some_and(|when| {
            when.is_strange()
                || when.during.is_some()
                || when.using.is_some()
                || when.recognized.is_some()
                || when.vehicle.is_some()
        });
        let concerns = concerns_lorries(when);
        let speed = rule.max_speed.as_ref().and_then(measures::km_h);
        match (speed, range(rule.between.as_deref())) {
            (_, _) if !concerns => account.left_out(RULE, "other_vehicles", 1),
            (_, _) if conditional => account.left_out(RULE, "speed_conditional", 1),
            (Some(km_h), Some(range)) => {
                self.speeds.push((range, headings(when), km_h));
                account.kept(RULE, 1);
            }
            _ => account.left_out(RULE, "speed_unreadable", 1),
        }
    }

    /// Widens the ranges of what closes or narrows the road where both ends of a range are one vertex: such a rule would hold nowhere. Both ends
    /// move by the share `margin`. `vertex_at` is the vertex of a share. Returns whether a range was widened.
    pub(super) fn widen_short(&mut self, mut vertex_at: impl FnMut(f64) -> usize, margin: f64) -> bool {
        let access = self.access.iter_mut().chain(&mut self.buses);
        let closing = access.filter(|(_, effect)| !matches!(effect, Effect::Allow { .. })).map(|(range, _)| range);
        let widths = self.widths.iter_mut().map(|(range, _)| range);
        let mut widened = false;
        for range in closing.chain(widths).chain(&mut self.closed) {
            if vertex_at(range[0]) == vertex_at(range[1]) {
                *range = [(range[0] - margin).max(0.0), (range[1] + margin).min(1.0)];
                widened = true;
            }
        }
        widened
    }

    /// The shares at which facts may change, ascending and distinct.
    pub(super) fn changes(&self) -> Vec<f64> {
        let ranges = self.access.iter().chain(&self.buses).map(|rule| rule.0);
        let ranges = ranges.chain(self.speeds.iter().map(|rule| rule.0)).chain(self.widths.iter().map(|rule| rule.0));
        let ranges = ranges.chain([&self.links, &self.minor, &self.closed].into_iter().flatten().copied());
        let mut changes: Vec<f64> = ranges.flatten().filter(|share| *share > 0.0 && *share < 1.0).collect();
        changes.sort_by(f64::total_cmp);
        changes.dedup();
        changes
    }

    /// Whether a service road is a driveway or a parking aisle between two shares, and no rule there opens it to heavy vehicles by name. No
    /// rule changes inside.
    pub(super) fn is_minor(&self, part: Range) -> bool {
        let opens = |effect: &Effect| matches!(effect, Effect::Allow { rank: ModeRank::Lorry, .. });
        self.minor.iter().any(|range| holds(*range, part))
            && !self.access.iter().any(|(range, effect)| holds(*range, part) && opens(effect))
    }

    /// The same for every part of the segment.
    pub(super) fn is_minor_throughout(&self) -> bool {
        let shares: Vec<f64> = [0.0].into_iter().chain(self.changes()).chain([1.0]).collect();
        shares.array_windows().all(|&part| self.is_minor(part))
    }

    /// Whether some rule opens the road to motor vehicles by name, and a width is known.
    pub(super) fn open_with_width(&self) -> bool {
        let opens =
            |effect: &Effect| matches!(effect, Effect::Allow { rank: ModeRank::Lorry | ModeRank::MotorVehicle, .. });
        self.access.iter().any(|(_, effect)| opens(effect)) && !self.widths.is_empty()
    }

    /// The road between two shares. No rule changes inside.
    pub(super) fn road(&self, class: RoadClass, part: Range) -> RoadValues {
        let holds = |range: &Range| holds(*range, part);
        let all = |effects: &[(Range, Effect)]| {
            let mut access = SegmentAccess::default();
            effects.iter().filter(|(range, _)| holds(range)).for_each(|(_, effect)| access.apply(effect));
            access.finish()
        };
        let (mut legal, [oneway, traffic]) = all(&self.access).with_buses(&all(&self.buses));
        if self.closed.iter().any(holds) {
            let closed = Legal { motor_vehicle: Permission::No, ..Legal::default() };
            legal = legal.map(|legal| legal.merge(&closed));
        }
        let mut max_speed_km_h: [Option<NonZeroU8>; 2] = [None; 2];
        for (_, headings, km_h) in self.speeds.iter().filter(|(range, ..)| holds(range)) {
            for (slot, _) in max_speed_km_h.iter_mut().zip(headings).filter(|(_, on)| **on) {
                *slot = Some(slot.map_or(*km_h, |known| known.min(*km_h)));
            }
        }
        let widths = self.widths.iter().filter(|(range, _)| holds(range)).map(|(_, width)| *width);
        let link = self.link || self.links.iter().any(holds);
        RoadValues { class, link, oneway, traffic, legal, max_speed_km_h, width_m: widths.reduce(f64::min) }
    }

    /// The refs of the routes over a part, each once.
    pub(super) fn reference(&self, part: Range) -> Option<String> {
        let mut refs: Vec<&str> = Vec::new();
        for (_, reference) in self.refs.iter().filter(|(range, _)| holds(*range, part)) {
            if !refs.contains(&reference.as_str()) {
                refs.push(reference);
            }
        }
        (!refs.is_empty()).then(|| refs.join(";"))
    }
}

/// A rule about part of the road whose place cannot be read holds on all of it.
fn range_or_whole(between: Option<&[f64]>, account: &mut Account) -> Range {
    range(between).unwrap_or_else(|| {
        account.noted(RULE, "between_unreadable", 1);
        [0.0, 1.0]
    })
}

/// Whether a subclass is one that is left out, as the tags `service=driveway` and `service=parking_aisle` are.
fn is_minor(subclass: &str) -> bool {
    matches!(subclass, "driveway" | "parking_aisle")
}

/// Whether a rule holds on a part inside which no rule changes.
fn holds([from, to]: Range, part: Range) -> bool {
    let middle = f64::midpoint(part[0], part[1]);
    from <= middle && middle <= to
}

/// The headings that a rule is for: along the line, against it.
pub(super) fn headings(when: Option<&When>) -> [bool; 2] {
    match when.and_then(|when| when.heading.as_deref()) {
        Some("forward") => [true, false],
        Some("backward") => [false, true],
        _ => [true; 2],
    }
}

#[cfg(test)]
mod tests;
