//! From tags to strips: the cross section of a way, laid out from its left edge to its right edge.
//!
//! The evidence in order of precedence is `width:carriageway`, `width`, `est_width` or `width:lanes`, then tagged lanes
//! times an assumed lane width, then class and country, which also say how many lanes are supposed. Parking, cycle lanes
//! and shoulders are deducted from a tagged carriageway; they add nothing to an assumed one. The way's line is the middle
//! of the carriageway unless `placement` says otherwise. If tags contradict each other, the narrower reading counts. A
//! width counts however small it is: no assumed width replaces it.

use crate::osm::facts::country::{Jurisdiction, TrafficSide};
use crate::osm::facts::layout::{LayoutSegment, NO_SECTION, RoadLayout, SHARED, Use, kerb_on_the_left_of_the_way};
use crate::osm::facts::rules::{ClassRule, KerbRule, Rules};
use crate::osm::facts::section::{Decimetres, Kerb, Mark, Millimetres, Parking, Placement, SectionTags, UNTAGGED};
use crate::osm::facts::{CrossSection, Direction, Oneway, WayFacts, WidthSource};

/// Bounds of the widths of lanes for cars and lorries, metres. Outside them the width or the lane count is wrong, or the lane
/// may be for cycles.
pub(super) const LANE_M: std::ops::RangeInclusive<f32> = 1.8..=6.0;
/// Below this width (metres) both directions share a two-way road without tagged lanes, because no centre line is
/// marked.
pub(super) const SHARED_BELOW_M: f32 = 5.0;
/// Widest lane on a road without tagged lanes, metres. A wider road may have more lanes than assumed.
const WIDEST_UNTAGGED_LANE_M: f32 = 4.25;
/// Largest excess of the lane widths over the carriageway's width, metres, before they are dropped. Mappers round.
const LISTED_SLACK_M: f32 = 0.3;

/// The cross sections of a way for travel along its node order and against it. `ring_radius_m` is the radius of the
/// ring that a roundabout's way is part of, if known.
#[must_use]
pub fn cross_sections(
    facts: &WayFacts,
    jurisdiction: &Jurisdiction,
    ring_radius_m: Option<f64>,
    rules: &Rules,
) -> [CrossSection; 2] {
    let class = rules.class(facts.class);
    // A ramp has one lane unless tagged otherwise, whatever its class.
    let lanes = if facts.link { 1 } else { lanes_of_group(facts, jurisdiction, rules).unwrap_or(class.lanes) };
    let builder = Builder {
        tags: &facts.section,
        class: ClassRule { lanes, ..class },
        lane_m: untagged_lane_m(facts, jurisdiction, rules),
        single_m: if facts.roundabout {
            rules.ring_m(jurisdiction.country, ring_radius_m)
        } else {
            rules.ramp_m(facts.class).filter(|_| facts.link)
        },
        side: jurisdiction.side(),
        kerb_rule: rules.kerb,
    };
    let one = |direction| builder.one_way(direction).section(direction, jurisdiction.side());
    match facts.traffic() {
        Oneway::Forward => [one(Direction::Forward), NO_SECTION],
        Oneway::Backward => [NO_SECTION, one(Direction::Backward)],
        Oneway::No if facts.section.is(Mark::Reversible) => [one(Direction::Forward), one(Direction::Backward)],
        Oneway::No => {
            let layout = builder.two_way();
            [Direction::Forward, Direction::Backward].map(|direction| layout.section(direction, jurisdiction.side()))
        }
    }
}

/// The lanes that a road is supposed to have because of its group: a one-way road that is no link and no ring, if no tag says anything of lanes or
/// of a width. `None`: those of its class.
fn lanes_of_group(facts: &WayFacts, jurisdiction: &Jurisdiction, rules: &Rules) -> Option<u8> {
    let group = rules.one_way_lanes(facts.class, jurisdiction.country)?;
    let section = &facts.section;
    let one_way = facts.traffic() != Oneway::No && !facts.link && !facts.roundabout;
    let ungrouped = [Mark::Ungrouped, Mark::Unreadable, Mark::Narrow].iter().any(|&mark| section.is(mark));
    let measured = section.carriageway.is_some() || section.physical.is_some();
    (one_way && !ungrouped && !measured).then_some(group.lanes)
}

/// The assumed width of a lane. Those of a narrow road of unknown width are no wider than a narrow road.
fn untagged_lane_m(facts: &WayFacts, jurisdiction: &Jurisdiction, rules: &Rules) -> f32 {
    let lane_m = rules.lane_m(facts.class, jurisdiction.country);
    let narrow = facts.section.is(Mark::Narrow) && facts.section.carriageway.is_none();
    if narrow { lane_m.min(rules.kerb.narrow_m) } else { lane_m }
}

/// Whether the lanes that are laid out are those of one direction or of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Traffic {
    OneWay,
    TwoWay,
}

/// Whether shoulders are taken off a carriageway.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shoulders {
    Within,
    LeftOut,
}

/// Lays out a way's cross section. `lanes` determines the lanes.
pub(super) struct Builder<'a> {
    pub(super) tags: &'a SectionTags,
    pub(super) class: ClassRule,
    pub(super) lane_m: f32,
    /// Assumed carriageway of a one-lane ring or ramp, metres; wider than a lane of its class.
    pub(super) single_m: Option<f32>,
    pub(super) side: TrafficSide,
    pub(super) kerb_rule: KerbRule,
}

impl Builder<'_> {
    /// Gives every lane its width. `known` says that the number of lanes is tagged. `assumed_m` replaces the lanes' sum
    /// if nothing is tagged.
    pub(super) fn lay_out(
        &self,
        mut lanes: Vec<LayoutSegment>,
        known: bool,
        assumed_m: Option<f32>,
        traffic: Traffic,
    ) -> RoadLayout {
        let tagged = self.available(&lanes);
        if let Some(room) = &tagged
            && given_m(&lanes) > room.width_m + LISTED_SLACK_M
        {
            lanes.iter_mut().for_each(|lane| (lane.most_m, lane.listed) = (lane.width_m.take(), false));
        }
        if lanes.iter().all(|lane| lane.width_m.is_some()) {
            let source = self.listed_source();
            return self.limited(self.finish(lanes, source, source));
        }
        // What cannot be read may say less than an assumed width.
        if self.tags.is(Mark::Unreadable) {
            return RoadLayout::default();
        }
        self.give_cycle_lanes_width(&mut lanes);
        if let Some(room) = tagged {
            if room.width_m <= 0.0 {
                return RoadLayout::default();
            }
            if let Some(layout) = self.share_out(&lanes, &room, known, traffic) {
                return self.limited(layout);
            }
        }
        let source = if known { WidthSource::FromLanes } else { WidthSource::Assumed };
        let each_m = assumed_m.map_or(self.lane_m, |all_m| all_m / unknown(&lanes).max(1.0));
        let lanes = lanes.into_iter().map(|lane| lane.with_share(each_m)).collect();
        self.limited(self.finish(lanes, source, source))
    }

    /// The evidence of lanes whose width a list gives.
    fn listed_source(&self) -> WidthSource {
        self.tags.source.min(WidthSource::Tagged)
    }

    /// Shares a tagged width out among the lanes. `None` if the lanes would be too wide to be the tagged ones.
    fn share_out(&self, lanes: &[LayoutSegment], room: &Room, known: bool, traffic: Traffic) -> Option<RoadLayout> {
        let left_m = room.width_m - given_m(lanes);
        let each_m = left_m / unknown(lanes);
        let shared_already = lanes.iter().any(|lane| lane.used == Use::Shared);
        if (known || shared_already) && each_m > *LANE_M.end() {
            return None;
        }
        let narrow =
            each_m < *LANE_M.start() || (traffic == Traffic::TwoWay && !known && room.width_m < SHARED_BELOW_M);
        // Lanes of known width stay; the others have what is left, however little.
        let listed = lanes.iter().any(|lane| lane.listed);
        if narrow && !shared_already && !listed {
            return Some(self.one_for_all(lanes, left_m, room, known, traffic));
        }
        let each_m = each_m.max(0.0);
        let mut out = Vec::with_capacity(lanes.len() + 2);
        for lane in lanes {
            match lane.of {
                Some(direction) if !known && lane.width_m.is_none() && each_m > WIDEST_UNTAGGED_LANE_M => {
                    let part = |width_m| lane.with_share(width_m);
                    let (at_kerb, rest) = (part(WIDEST_UNTAGGED_LANE_M), part(each_m - WIDEST_UNTAGGED_LANE_M));
                    if kerb_on_the_left_of_the_way(direction, self.side) {
                        out.extend([at_kerb, rest]);
                    } else {
                        out.extend([rest, at_kerb]);
                    }
                }
                _ => out.push(lane.with_share(each_m)),
            }
        }
        let divided = if known || out.len() == 1 { room.source } else { room.source.min(WidthSource::Estimated) };
        Some(self.with_kerbs(out, room, divided))
    }

    /// A road too narrow for its lanes gets one lane, by turns for both directions of a two-way road. If lanes are
    /// tagged, one of the two tags is wrong. It may be the width, so the lane is no wider than an assumed one.
    fn one_for_all(
        &self,
        lanes: &[LayoutSegment],
        left_m: f32,
        room: &Room,
        known: bool,
        traffic: Traffic,
    ) -> RoadLayout {
        let Some(open) = lanes.iter().find(|lane| matches!(lane.used, Use::Lane(_))) else {
            return RoadLayout::default();
        };
        let width_m = left_m.min(if known { self.lane_m } else { SHARED_BELOW_M });
        let most_m = lanes.iter().filter_map(|lane| lane.most_m).reduce(f32::min);
        let width_m = most_m.map_or(width_m, |most_m| most_m.min(width_m));
        if width_m <= 0.0 {
            return RoadLayout::default();
        }
        let one = LayoutSegment { width_m: Some(width_m), ..if traffic == Traffic::TwoWay { SHARED } else { *open } };
        let source = if width_m < left_m { room.source.min(WidthSource::FromLanes) } else { room.source };
        let divided = if lanes.len() > 1 { source.min(WidthSource::Estimated) } else { source };
        let whole = Room { source, ..*room };
        self.with_kerbs(vec![one], &whole, divided)
    }

    /// The tagged carriageway less what is not for traffic, and its evidence.
    fn available(&self, lanes: &[LayoutSegment]) -> Option<Room> {
        let carriageway_m = self.tags.carriageway?.metres();
        let taken_m =
            |shoulders| -> f32 { (0..2).map(|side| given_m(&self.kerb_segments(side, lanes, shoulders))).sum() };
        let kerbs = &self.tags.kerbs;
        let assumed = kerbs.iter().any(|k| [k.parking_dm, k.cycle_dm, k.shoulder_dm].contains(&UNTAGGED));
        let source = if assumed { self.tags.source.min(WidthSource::Estimated) } else { self.tags.source };
        let within = Room { width_m: carriageway_m - taken_m(Shoulders::Within), source, shoulders: Shoulders::Within };
        let lanes_m = unknown(lanes) * self.lane_m + given_m(lanes);
        if within.width_m >= lanes_m || kerbs.iter().all(|kerb| kerb.shoulder_dm == 0) {
            return Some(within);
        }
        // Many mappers leave shoulders out of the width (motorways with width=7.5, lanes=2, shoulder=yes). If not even
        // the assumed lanes fit beside the shoulders, the lanes are as assumed, but no wider than the tag.
        let without_m = (carriageway_m - taken_m(Shoulders::LeftOut)).min(lanes_m);
        Some(Room { width_m: without_m, source: source.min(WidthSource::FromLanes), shoulders: Shoulders::LeftOut })
    }

    /// The parts beside the lanes on one side (0: left of the node order), from the edge inwards.
    fn kerb_segments(&self, side: usize, lanes: &[LayoutSegment], shoulders: Shoulders) -> Vec<LayoutSegment> {
        let Kerb { parking, parking_dm, cycle_dm, shoulder_dm } = self.tags.kerbs[side];
        let rule = &self.kerb_rule;
        let parking_m = match parking {
            Parking::None | Parking::Parallel => rule.parallel_parking_m,
            Parking::Diagonal => rule.diagonal_parking_m,
            Parking::Perpendicular => rule.perpendicular_parking_m,
        };
        let metres = |dm: Decimetres, default_m: f32| if dm == UNTAGGED { default_m } else { f32::from(dm) / 10.0 };
        let outermost = if side == 0 { lanes.first() } else { lanes.last() };
        let listed = outermost.is_some_and(|lane| lane.used == Use::Aside);
        let mut inwards = Vec::new();
        for (dm, default_m, used) in [
            (parking_dm, parking_m, Use::Aside),
            (if listed { 0 } else { cycle_dm }, rule.cycle_lane_m, Use::Aside),
            (if shoulders == Shoulders::Within { shoulder_dm } else { 0 }, rule.shoulder_m, Use::Paved),
        ] {
            if dm > 0 {
                inwards.push(LayoutSegment { width_m: Some(metres(dm, default_m)), ..LayoutSegment::new(None, used) });
            }
        }
        inwards
    }

    fn give_cycle_lanes_width(&self, lanes: &mut [LayoutSegment]) {
        for lane in lanes.iter_mut().filter(|lane| lane.used == Use::Aside) {
            lane.width_m = lane.width_m.or(Some(self.kerb_rule.cycle_lane_m));
        }
    }

    fn with_kerbs(&self, lanes: Vec<LayoutSegment>, room: &Room, divided: WidthSource) -> RoadLayout {
        let mut segments = self.kerb_segments(0, &lanes, room.shoulders);
        let right = self.kerb_segments(1, &lanes, room.shoulders);
        segments.extend(lanes);
        segments.extend(right.into_iter().rev());
        self.finish(segments, room.source, divided)
    }

    fn finish(&self, segments: Vec<LayoutSegment>, whole: WidthSource, divided: WidthSource) -> RoadLayout {
        // The way's line is between two placements. The strips lie as around the middle, with weaker evidence.
        let weakest =
            if self.tags.placement == Placement::Transition { WidthSource::Estimated } else { WidthSource::Surveyed };
        let placement = self.tags.placement;
        let [whole, divided, listed] = [whole, divided, self.listed_source()].map(|source| Some(source.min(weakest)));
        RoadLayout { segments, whole, divided, listed, placement }
    }

    /// Applies `maxwidth:physical` as an upper bound of the paved width. All lanes shrink alike, or one lane is left.
    fn limited(&self, mut layout: RoadLayout) -> RoadLayout {
        let Some(most_m) = self.tags.physical.map(Millimetres::metres) else { return layout };
        let paved = |s: &LayoutSegment| s.used != Use::Aside;
        let paved_m: f32 = layout.segments.iter().filter(|s| paved(s)).filter_map(|s| s.width_m).sum();
        if paved_m <= most_m {
            return layout;
        }
        let bounded = |source: Option<WidthSource>| source.map(|source| source.min(WidthSource::Tagged));
        (layout.whole, layout.divided) = (bounded(layout.whole), bounded(layout.divided));
        layout.listed = bounded(layout.listed);
        let mut shrunk =
            layout.segments.iter().filter(|s| paved(s)).filter_map(|s| s.width_m).map(|m| m * most_m / paved_m);
        if shrunk.all(|width_m| width_m >= *LANE_M.start()) {
            for segment in layout.segments.iter_mut().filter(|s| paved(s)) {
                segment.width_m = segment.width_m.map(|width_m| width_m * most_m / paved_m);
            }
            return layout;
        }
        let used = |direction| layout.segments.iter().any(|s| s.is_open_to(direction));
        let used = match (used(Direction::Forward), used(Direction::Backward)) {
            (true, true) => Use::Shared,
            (true, false) => Use::Lane(Direction::Forward),
            (false, true) => Use::Lane(Direction::Backward),
            (false, false) => return RoadLayout::default(),
        };
        // No lane for all is wider than what a list gives one of them.
        let listed_m = layout.segments.iter().filter(|s| s.listed).filter_map(|s| s.width_m);
        let bounds_m = listed_m.chain(layout.segments.iter().filter_map(|s| s.most_m));
        let width_m = bounds_m.fold(most_m.min(self.lane_m), f32::min);
        let one = LayoutSegment { width_m: Some(width_m), ..LayoutSegment::new(None, used) };
        RoadLayout { segments: vec![one], placement: Placement::Middle, ..layout }
    }
}

/// A tagged width that lanes may share, and whether shoulders were deducted from it.
#[derive(Debug, Clone, Copy)]
struct Room {
    width_m: f32,
    source: WidthSource,
    shoulders: Shoulders,
}

fn given_m(segments: &[LayoutSegment]) -> f32 {
    segments.iter().filter_map(|segment| segment.width_m).sum()
}

/// Number of segments without a width.
fn unknown(segments: &[LayoutSegment]) -> f32 {
    segments.iter().filter(|segment| segment.width_m.is_none()).count() as f32
}
