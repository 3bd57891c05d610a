//! Reads the tags of a cross section into [`SectionTags`], in any order.
//!
//! An unusable tag is noted. A width that cannot be read leaves the cross section unknown if no other width can be read:
//! it may say less than an assumed one. If two tags contradict each other, the narrower reading counts.

use crate::osm::facts::kerb_reader::KerbReader;
use crate::osm::facts::lane_lists::{Lists, list_index};
use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::section::{LaneLine, LaneTags, Mark, MarkSet, Millimetres, Placement, SectionTags};
use crate::osm::facts::value::{self, readable};
use crate::osm::facts::widths::LANE_M;
use crate::osm::facts::{Direction, Oneway, WidthSource};

/// Greatest width of a carriageway, metres. A greater value is a typing error.
const WIDEST_M: f32 = 40.0;

/// Whether both directions use the carriageway by turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sharing {
    Never,
    /// As `oneway=reversible` says: one direction at a time, for hours.
    Reversible,
    /// As `oneway=alternating` says: one direction at a time, for minutes.
    Alternating,
}

/// Collects the tags of the cross section, in any order.
#[derive(Debug, Default)]
pub(super) struct SectionReader {
    /// In order of precedence: `width:carriageway`, `width`, `est_width`.
    widths: [Option<Millimetres>; 3],
    /// Whether one of these tags cannot be read.
    unreadable: bool,
    estimated: bool,
    surveyed: bool,
    physical: Option<Millimetres>,
    narrow: bool,
    both_ways: u8,
    /// Lists of the lanes for both directions.
    middle: Lists,
    /// Indices: without a suffix, forward, backward.
    lists: [Lists; 3],
    /// Whether a one-way road has a lane for oncoming buses (`busway=opposite_lane`), and whether it is open to them.
    oncoming_lane: bool,
    oncoming: bool,
    kerbs: KerbReader,
    /// Whether the source does not say which roads are rings of roundabouts.
    rings_unknown: bool,
    placements: [Option<Placement>; 3],
}

impl SectionReader {
    /// Takes a tag (key split at the first colon) if it concerns the cross section. Returns whether it can be read, if it is a width.
    pub(super) fn take(&mut self, head: &str, suffix: &str, text: &str, notes: &mut Notes) -> bool {
        match head {
            "width" => match suffix {
                "" => return self.width(1, text, notes),
                "carriageway" => return self.width(0, text, notes),
                "source" => self.origin(text),
                _ => {
                    if let Some(lists) = self.lists_of(suffix) {
                        lists.widths(text, notes);
                    }
                }
            },
            "est_width" if suffix.is_empty() => return self.width(2, text, notes),
            "source" if matches!(suffix, "width" | "width:carriageway") => self.origin(text),
            // `limits` reads the same tag as a limit, and notes it if it is unreadable.
            "maxwidth" if suffix == "physical" => {
                self.physical = value::metres(text).and_then(Millimetres::from_metres);
            }
            "narrow" if suffix.is_empty() => self.narrow = !matches!(text, "no" | "false" | "0"),
            "lanes" => self.lanes(suffix, text, notes),
            "turn" => {
                if let Some(lists) = self.lists_of(suffix) {
                    lists.turns(text);
                }
            }
            "placement" => self.placement(suffix, text, notes),
            _ if suffix.starts_with("lanes") => {
                if let Some(lists) = self.lists_of(suffix) {
                    lists.closed(head, text, notes);
                }
            }
            "cycleway" | "shoulder" | "parking" => self.kerbs.take(head, suffix, text),
            "busway" => self.busway(suffix, text),
            "hov" => {
                if let Some(index) = side_index(suffix).filter(|_| text == "lane") {
                    self.lists[index].more_hov(1);
                }
            }
            "oneway" => self.oncoming |= matches!(suffix, "bus" | "psv") && text == "no",
            "bus" | "psv" => {
                self.oncoming |= (suffix == "oneway" && text == "no")
                    || (suffix == "backward" && matches!(text, "yes" | "designated"));
            }
            _ => {}
        }
        true
    }

    pub(super) fn has_width(&self) -> bool {
        self.widths.iter().any(Option::is_some)
    }

    /// Notes that the source does not say which roads are rings of roundabouts.
    pub(super) fn knows_no_rings(&mut self) {
        self.rings_unknown = true;
    }

    /// Takes a width of the carriageway that is no tag, metres. The same bounds hold.
    pub(super) fn given_width(&mut self, metres: f64, notes: &mut Notes) {
        self.put_width(1, Some(metres as f32), notes);
    }

    /// A width as mappers write it. Lists, ranges and approximations are no more than estimates.
    fn width(&mut self, slot: usize, text: &str, notes: &mut Notes) -> bool {
        let exact = readable(text);
        self.put_width(slot, exact.or_else(|| least_of(text)), notes);
        self.estimated |= exact.is_none() && self.widths[slot].is_some();
        self.widths[slot].is_some()
    }

    fn put_width(&mut self, slot: usize, metres: Option<f32>, notes: &mut Notes) {
        self.widths[slot] = metres.filter(|metres| *metres <= WIDEST_M).and_then(Millimetres::from_metres);
        if self.widths[slot].is_none() {
            notes.add(Note::BadWidth);
            self.unreadable = true;
        }
    }

    /// The lists that a suffix such as `lanes:forward` names.
    fn lists_of(&mut self, suffix: &str) -> Option<&mut Lists> {
        if suffix == "lanes:both_ways" {
            return Some(&mut self.middle);
        }
        list_index(suffix).map(|index| &mut self.lists[index])
    }

    fn origin(&mut self, text: &str) {
        let text = text.to_ascii_lowercase();
        let says = |words: &[&str]| words.iter().any(|word| text.contains(word));
        self.estimated |=
            says(&["estimat", "guess", "approx", "aerial", "imagery", "bing", "image", "streetcomplete", "geschätzt"]);
        self.surveyed |= says(&["survey", "measure", "gemessen", "laser", "lidar", "arcore", "official", "cadastre"]);
    }

    fn lanes(&mut self, suffix: &str, text: &str, notes: &mut Notes) {
        let kind = ["psv", "bus", "hov"]
            .into_iter()
            .find(|kind| suffix.strip_prefix(kind).is_some_and(|rest| rest.is_empty() || rest.starts_with(':')));
        let side = kind.map_or(suffix, |kind| suffix[kind.len()..].trim_start_matches(':'));
        let slot = match side {
            "both_ways" if kind.is_none() => None,
            _ => match side_index(side) {
                Some(index) => Some(index),
                None => return,
            },
        };
        let (count, sound) = value::lane_count(text);
        if !(sound || kind.is_some() && text == "0") {
            notes.add(Note::BadLanes);
        }
        let count = count.unwrap_or(0);
        match (slot, kind) {
            (None, _) => self.both_ways = count,
            (Some(index), Some("hov")) => self.lists[index].more_hov(count),
            (Some(index), Some(_)) => self.lists[index].more_bus(count),
            (Some(index), None) => self.lists[index].count = count,
        }
    }

    /// The driving side determines the direction that a side serves. Both directions get a bus lane at the kerb, so the
    /// lane beside it is the kerb-side lane in either case.
    fn busway(&mut self, suffix: &str, text: &str) {
        let index = match suffix {
            "" | "left" | "right" | "both" => 0,
            "forward" => 1,
            "backward" => 2,
            _ => return,
        };
        match text {
            "lane" => self.lists[index].more_bus(1),
            "opposite_lane" => self.oncoming_lane = true,
            "opposite" => self.oncoming = true,
            _ => {}
        }
    }

    /// Combines the tags, once the directions are known for which the carriageway is laid out.
    pub(super) fn finish(self, oneway: Oneway, sharing: Sharing, notes: &mut Notes) -> SectionTags {
        let lane_tags = self.middle != Lists::default() || self.lists.iter().any(|lists| *lists != Lists::default());
        let ungrouped = self.rings_unknown || self.oncoming || self.oncoming_lane || lane_tags;
        let mut lists = self.lists;
        let both_ways = self.both_ways.max(self.middle.lanes()).max(self.middle.turns);
        // More lanes are a typing error in one of the tags, so none is used.
        if lists[1].count + lists[2].count + both_ways > value::MOST_LANES {
            notes.add(Note::BadLanes);
            lists.iter_mut().for_each(|lists| lists.count = 0);
        }
        // With a cycle lane the lists are ambiguous, because they may include it.
        if !self.kerbs.has_cycle_lane() {
            count_turns(&mut lists, both_ways, oneway);
        }
        let (directions, whole_road) = match oneway {
            Oneway::No if sharing == Sharing::Reversible => (by_turns(&lists), false),
            Oneway::No => two_way(&mut lists, both_ways),
            Oneway::Forward => {
                let (own, other, whole_road) = self.one_way(&lists, 1);
                ([own, other], whole_road)
            }
            Oneway::Backward => {
                let (own, other, whole_road) = self.one_way(&lists, 2);
                ([other, own], whole_road)
            }
        };
        let [plain_line, forward_line, backward_line] = self.placements;
        let placement = match oneway {
            Oneway::Forward => plain_line.or(forward_line),
            Oneway::Backward => plain_line.or(backward_line).map(Placement::backward),
            // Without a suffix the direction of the counted lanes is unknown.
            Oneway::No => forward_line.or(backward_line).or(plain_line.map(|_| Placement::Transition)),
        };
        let source = match self.widths {
            [None, None, Some(_)] => WidthSource::Estimated,
            _ if self.estimated => WidthSource::Estimated,
            _ if self.surveyed => WidthSource::Surveyed,
            _ => WidthSource::Tagged,
        };
        let carriageway = self.widths.into_iter().flatten().next();
        let section = SectionTags {
            carriageway,
            source,
            physical: self.physical,
            marks: MarkSet::of(&[
                (Mark::Unreadable, self.unreadable && carriageway.is_none()),
                (Mark::Narrow, self.narrow),
                (Mark::Reversible, sharing == Sharing::Reversible),
                (Mark::Alternating, sharing == Sharing::Alternating),
                (Mark::WholeRoad, whole_road),
                (Mark::Along, oneway == Oneway::Forward),
                (Mark::Against, oneway == Oneway::Backward),
                (Mark::Ungrouped, ungrouped),
            ]),
            lanes: lists[0].count,
            both_ways,
            both_ways_steps: self.middle.narrowest(),
            directions,
            kerbs: self.kerbs.finish(),
            placement: placement.unwrap_or_default(),
        };
        if let (Some(width), Some(lanes)) = (section.carriageway, section.tagged_lanes())
            && !LANE_M.contains(&(width.metres() / f32::from(lanes)))
        {
            notes.add(Note::WidthContradictsLanes);
        }
        section
    }

    /// The lanes of a one-way road and those of oncoming buses, and whether the lists cover both. `own` is the index of
    /// the lists of its direction.
    fn one_way(&self, lists: &[Lists; 3], own: usize) -> (LaneTags, LaneTags, bool) {
        let (plain, with_suffix, against) = (&lists[0], &lists[own], &lists[3 - own]);
        let for_buses = against.bus.max(u8::from(self.oncoming_lane));
        let spare = plain.count.saturating_sub(with_suffix.count.max(1));
        let oncoming = match (with_suffix.count, plain.count) {
            (1.., 1..) => for_buses.max(spare),
            // Lanes against the direction that nobody counted are left from before a road was mapped as two. Buses that
            // may come need one of the lanes, unless there is only one for all.
            (0, 2..) => for_buses.max(spare.min(against.count.max(against.lanes()))).max(u8::from(self.oncoming)),
            (0, 0) if self.widths.iter().any(Option::is_some) => for_buses.max(u8::from(self.oncoming)),
            _ => for_buses,
        };
        let mut tags = plain.or(*with_suffix).tags();
        tags.count = match (with_suffix.count, plain.count) {
            (0, 0) => 0,
            (0, all) => all.saturating_sub(oncoming).max(1),
            (own, _) => own,
        };
        let whole_road = oncoming > 0 && plain.lanes() > 0 && plain.lanes() != tags.count;
        let mut other = if oncoming > 0 { against.tags() } else { LaneTags::default() };
        other.count = oncoming;
        (tags, other, whole_road)
    }

    fn placement(&mut self, suffix: &str, text: &str, notes: &mut Notes) {
        let Some(index) = side_index(suffix) else { return };
        let direction = if index == 2 { Direction::Backward } else { Direction::Forward };
        self.placements[index] = placement(text, direction);
        if self.placements[index].is_none() {
            notes.add(Note::BadPlacement);
        }
    }
}

/// Takes the lanes with turns as the number of lanes where that is not tagged. On a two-way road whose lanes are counted, each
/// direction keeps at least one.
fn count_turns(lists: &mut [Lists; 3], both_ways: u8, oneway: Oneway) {
    let unknown = |lists: &Lists| lists.count == 0 && lists.lanes() == 0;
    let [plain, forward, backward] = lists;
    if oneway != Oneway::No {
        let own = if oneway == Oneway::Forward { forward } else { backward };
        if unknown(plain) && unknown(own) {
            own.count = if plain.turns > 0 { plain.turns } else { own.turns };
        }
        return;
    }
    let of = |lists: &Lists| if unknown(lists) { lists.turns } else { lists.count };
    let running = of(forward).max(1) + of(backward).max(1) + both_ways;
    if plain.count == 0 || running <= plain.count {
        for lists in [forward, backward].into_iter().filter(|lists| unknown(lists)) {
            lists.count = lists.turns;
        }
    }
}

/// The lanes of both directions of a two-way road, and whether one list of widths covers the whole road. It does if it names
/// no direction and no other list does. Other lists without a direction have no meaning on a two-way road.
fn two_way(lists: &mut [Lists; 3], both_ways: u8) -> ([LaneTags; 2], bool) {
    let [plain, forward, backward] = lists;
    let whole_road = plain.measured() > 0 && forward.lanes() == 0 && backward.lanes() == 0;
    let counted = forward.count.saturating_add(backward.count).saturating_add(both_ways);
    if whole_road && plain.count == 0 && counted == 0 {
        plain.count = plain.measured();
    }
    let mut tags = [forward, backward].map(|lists| {
        let mut tags = lists.tags();
        tags.bus = tags.bus.max(plain.bus.div_ceil(2));
        tags.hov = tags.hov.max(plain.hov.div_ceil(2));
        tags
    });
    if whole_road {
        plain.give_widths(&mut tags[0]);
    } else {
        tags.iter_mut().for_each(|tags| tags.bound(plain.narrowest()));
    }
    (tags, whole_road)
}

/// The lanes of a road whose lanes all go one way at a time. Lists without a direction bound the widths, because their
/// order is that of one direction.
fn by_turns(lists: &[Lists; 3]) -> [LaneTags; 2] {
    let [plain, forward, backward] = lists;
    [forward, backward].map(|lists| {
        let mut tags = lists.tags();
        tags.bus = tags.bus.max(plain.bus.div_ceil(2));
        tags.hov = tags.hov.max(plain.hov.div_ceil(2));
        tags.bound(plain.narrowest());
        tags
    })
}

impl Placement {
    /// The same line, counted in the lanes against the node order.
    fn backward(self) -> Placement {
        match self {
            Placement::At(line, lane, _) => Placement::At(line, lane, Direction::Backward),
            other => other,
        }
    }
}

/// The least length of a list, of a range or of an approximation: `3;4`, `3-4`, `~3`, `ca. 3`, `3+`. `None` if a part cannot
/// be read. What lies below a length (`<3`) is unknown.
fn least_of(text: &str) -> Option<f32> {
    let text = text.trim();
    let about = ["~", "≈", "±", ">=", ">", "ca.", "ca ", "approx.", "approx ", "about "];
    let text = about.iter().find_map(|word| text.strip_prefix(word)).unwrap_or(text).trim();
    let text = text.strip_suffix('+').unwrap_or(text);
    let mut least: Option<f32> = None;
    for part in text.split([';', '-', '–']) {
        let metres = readable(part)?;
        least = Some(least.map_or(metres, |least| least.min(metres)));
    }
    least
}

fn placement(text: &str, direction: Direction) -> Option<Placement> {
    if text == "transition" {
        return Some(Placement::Transition);
    }
    let (line, lane) = text.split_once(':')?;
    let line = match line {
        "left_of" => LaneLine::Left,
        "middle_of" => LaneLine::Middle,
        "right_of" => LaneLine::Right,
        _ => return None,
    };
    Some(Placement::At(line, value::lane_count(lane).0?, direction))
}

/// Index into `[without, forward, backward]`.
fn side_index(suffix: &str) -> Option<usize> {
    ["", "forward", "backward"].iter().position(|side| *side == suffix)
}
