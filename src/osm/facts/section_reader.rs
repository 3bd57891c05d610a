//! Reads the tags of a cross section into [`SectionTags`], in any order.
//!
//! An unusable tag is noted and ignored. If two tags contradict each other, the narrower reading counts.

use crate::osm::facts::kerb_reader::KerbReader;
use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::section::{LANE_STEP_M, LISTED, LaneLine, LaneTags, Millimetres, Placement, SectionTags};
use crate::osm::facts::widths::LANE_M;
use crate::osm::facts::{Direction, Oneway, WidthSource, value};

/// Bounds of a carriageway, metres. Values outside are typing errors, or the way is not for lorries.
const CARRIAGEWAY_M: std::ops::RangeInclusive<f32> = 1.8..=40.0;

/// Lane lists of one direction (index 0: without a suffix), before their direction is known.
#[derive(Debug, Clone, Copy, Default)]
struct Lists {
    listed: u8,
    closed: u8,
    width_steps: [u8; LISTED],
    count: u8,
    bus: u8,
    /// Lanes with turns (`turn:lanes`); 0 if untagged.
    turns: u8,
    unusable: bool,
}

/// Collects the tags of the cross section, in any order.
#[derive(Debug, Default)]
pub(super) struct SectionReader {
    /// In order of precedence: `width:carriageway`, `width`, `est_width`.
    widths: [Option<Millimetres>; 3],
    estimated: bool,
    surveyed: bool,
    physical: Option<Millimetres>,
    narrow: bool,
    both_ways: u8,
    /// Indices: without a suffix, forward, backward.
    lists: [Lists; 3],
    kerbs: KerbReader,
    placements: [Option<Placement>; 3],
}

impl SectionReader {
    /// Takes a tag (key split at the first colon) if it concerns the cross section.
    pub(super) fn take(&mut self, head: &str, suffix: &str, text: &str, notes: &mut Notes) {
        match head {
            "width" => match suffix {
                "" => self.widths[1] = width(text, notes),
                "carriageway" => self.widths[0] = width(text, notes),
                "source" => self.origin(text),
                _ => self.lane_widths(suffix, text, notes),
            },
            "est_width" if suffix.is_empty() => self.widths[2] = width(text, notes),
            "source" if matches!(suffix, "width" | "width:carriageway") => self.origin(text),
            // `limits` reads the same tag as a limit, and notes it if it is unreadable.
            "maxwidth" if suffix == "physical" => {
                self.physical = value::metres(text).and_then(Millimetres::from_metres);
            }
            "narrow" if suffix.is_empty() => self.narrow = text == "yes",
            "lanes" => self.lanes(suffix, text, notes),
            "turn" => self.turns(suffix, text),
            "placement" => self.placement(suffix, text, notes),
            "access" | "vehicle" | "motor_vehicle" | "hgv" | "bus" | "psv" | "cycleway" | "bicycle"
                if suffix.starts_with("lanes") =>
            {
                self.closed_lanes(head, suffix, text, notes);
            }
            "cycleway" | "shoulder" | "parking" => self.kerbs.take(head, suffix, text),
            "busway" => self.busway(suffix, text),
            _ => {}
        }
    }

    pub(super) fn has_width(&self) -> bool {
        self.widths.iter().any(Option::is_some)
    }

    /// Takes a width of the carriageway that is no tag, metres. The same bounds hold.
    pub(super) fn given_width(&mut self, metres: f64, notes: &mut Notes) {
        self.widths[1] = usable_width(metres as f32, notes);
    }

    fn origin(&mut self, text: &str) {
        let text = text.to_ascii_lowercase();
        let says = |words: &[&str]| words.iter().any(|word| text.contains(word));
        self.estimated |=
            says(&["estimat", "guess", "approx", "aerial", "imagery", "bing", "image", "streetcomplete", "geschätzt"]);
        self.surveyed |= says(&["survey", "measure", "gemessen", "laser", "lidar", "arcore", "official", "cadastre"]);
    }

    fn lanes(&mut self, suffix: &str, text: &str, notes: &mut Notes) {
        let (bus, side) = match suffix.strip_prefix("psv").or_else(|| suffix.strip_prefix("bus")) {
            Some(rest) => (true, rest.trim_start_matches(':')),
            None => (false, suffix),
        };
        let slot = match side {
            "both_ways" if !bus => None,
            _ => match side_index(side) {
                Some(index) => Some(index),
                None => return,
            },
        };
        let (count, sound) = value::lane_count(text);
        if !(sound || bus && text == "0") {
            notes.add(Note::BadLanes);
        }
        let count = count.unwrap_or(0);
        match slot {
            None => self.both_ways = count,
            Some(index) if bus => self.lists[index].bus = count,
            Some(index) => self.lists[index].count = count,
        }
    }

    /// Counts the lanes of `turn:lanes`. More than a road can have are a typing error.
    fn turns(&mut self, suffix: &str, text: &str) {
        let Some(index) = list_index(suffix) else { return };
        let lanes = u8::try_from(text.split('|').count()).unwrap_or(u8::MAX);
        self.lists[index].turns = if lanes <= value::MOST_LANES { lanes } else { 0 };
    }

    fn lane_widths(&mut self, suffix: &str, text: &str, notes: &mut Notes) {
        let Some(index) = list_index(suffix) else { return };
        let lists = &mut self.lists[index];
        let mut steps = [0; LISTED];
        let mut count = 0;
        for part in text.split('|') {
            let step = value::metres(part).map_or(0.0, |width| (width / LANE_STEP_M + 1e-3).floor());
            // From half a metre (a cycle lane) to the widest lane.
            match steps.get_mut(count) {
                Some(slot) if (10.0..=*LANE_M.end() / LANE_STEP_M).contains(&step) => *slot = step as u8,
                _ => {
                    notes.add(Note::BadLaneWidths);
                    return;
                }
            }
            count += 1;
        }
        lists.agree(count, notes);
        lists.width_steps = steps;
    }

    /// Closes lanes: those for other traffic, and those closed by access, vehicle, motor_vehicle or hgv.
    fn closed_lanes(&mut self, head: &str, suffix: &str, text: &str, notes: &mut Notes) {
        let Some(index) = list_index(suffix) else { return };
        let mut count = 0;
        let mut closed = 0_u8;
        for part in text.split('|') {
            let shut = match head {
                "cycleway" => matches!(part, "lane" | "track"),
                "bicycle" | "bus" | "psv" => part == "designated",
                _ => !matches!(part, "" | "yes" | "designated" | "permissive" | "destination" | "delivery"),
            };
            if count < LISTED && shut {
                closed |= 1 << count;
            }
            count += 1;
        }
        if count > LISTED {
            notes.add(Note::BadLaneWidths);
            self.lists[index].unusable = true;
            return;
        }
        self.lists[index].agree(count, notes);
        self.lists[index].closed |= closed;
    }

    /// The driving side determines the direction that a side serves. Both directions get a bus lane at the kerb, so the
    /// lane beside it is the kerb-side lane in either case.
    fn busway(&mut self, suffix: &str, text: &str) {
        if text == "lane" && matches!(suffix, "" | "left" | "right" | "both") {
            self.lists[0].bus = self.lists[0].bus.max(1);
        }
    }

    /// Combines the tags, once the way's directions are known.
    pub(super) fn finish(self, oneway: Oneway, reversible: bool, alternating: bool, notes: &mut Notes) -> SectionTags {
        let [mut plain, mut forward, mut backward] = self.lists;
        // More lanes are a typing error in one of the tags, so none is used.
        if forward.count + backward.count + self.both_ways > value::MOST_LANES {
            notes.add(Note::BadLanes);
            [&mut plain, &mut forward, &mut backward].into_iter().for_each(|lists| lists.count = 0);
        }
        // With a cycle lane the lists are ambiguous, because they may include it.
        if !self.kerbs.has_cycle_lane() {
            count_turns([&mut plain, &mut forward, &mut backward], self.both_ways, oneway);
        }
        let directions = match oneway {
            Oneway::Forward => [plain.or(forward).tags(), LaneTags::default()],
            Oneway::Backward => [LaneTags::default(), plain.or(backward).tags()],
            // Lists without a suffix have no meaning on a two-way road.
            Oneway::No => [forward, backward].map(|lists| {
                let mut tags = lists.tags();
                tags.bus = tags.bus.max(plain.bus.div_ceil(2));
                tags
            }),
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
        let section = SectionTags {
            carriageway: self.widths.into_iter().flatten().next(),
            source,
            physical: self.physical,
            narrow: self.narrow,
            reversible,
            alternating,
            lanes: plain.count,
            both_ways: self.both_ways,
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
fn count_turns([plain, forward, backward]: [&mut Lists; 3], both_ways: u8, oneway: Oneway) {
    let unknown = |lists: &Lists| lists.count == 0 && lists.listed == 0;
    if oneway != Oneway::No {
        let own = if oneway == Oneway::Forward { forward } else { backward };
        if unknown(plain) && unknown(own) {
            plain.count = if plain.turns > 0 { plain.turns } else { own.turns };
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

impl Placement {
    /// The same line, counted in the lanes against the node order.
    fn backward(self) -> Placement {
        match self {
            Placement::At(line, lane, _) => Placement::At(line, lane, Direction::Backward),
            other => other,
        }
    }
}

impl Lists {
    /// The lists without a suffix, or else those with one.
    fn or(self, other: Lists) -> Lists {
        let lists = if self.listed > 0 { self } else { other };
        Lists { count: if self.count > 0 { self.count } else { other.count }, bus: self.bus.max(other.bus), ..lists }
    }

    /// All lists of a direction must have the same length. Otherwise none is used.
    fn agree(&mut self, count: usize, notes: &mut Notes) {
        let count = count as u8;
        if self.listed != 0 && self.listed != count {
            notes.add(Note::BadLaneWidths);
            self.unusable = true;
        }
        self.listed = count;
    }

    fn tags(self) -> LaneTags {
        let Lists { count, bus, .. } = self;
        if self.unusable {
            return LaneTags { count, bus, ..LaneTags::default() };
        }
        LaneTags { count, listed: self.listed, closed: self.closed, width_steps: self.width_steps, bus }
    }
}

fn width(text: &str, notes: &mut Notes) -> Option<Millimetres> {
    usable_width(value::metres(text).unwrap_or_default(), notes)
}

fn usable_width(metres: f32, notes: &mut Notes) -> Option<Millimetres> {
    let width = Some(metres).filter(|width| CARRIAGEWAY_M.contains(width)).and_then(Millimetres::from_metres);
    if width.is_none() {
        notes.add(Note::BadWidth);
    }
    width
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

/// As [`side_index`], for `lanes`, `lanes:forward`, `lanes:backward`.
fn list_index(suffix: &str) -> Option<usize> {
    ["lanes", "lanes:forward", "lanes:backward"].iter().position(|side| *side == suffix)
}
