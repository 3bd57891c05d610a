//! One segment becomes a road: its line with numbered vertices, and facts for each part on which no rule changes.

use super::account::{Account, CONNECTOR, RULE, SEGMENT};
use super::connectors::Connectors;
use super::error::OvertureProblem;
use super::ids::FeatureKey;
use super::line::{Line, SNAP_M};
use super::record::{Segment, Transition};
use super::rules::SegmentRules;
use crate::osm::facts::{Notes, RoadClass, WayFacts, given_class};
use crate::osm::{LonLat, NodeId};

/// Left out: fewer than two places.
const TOO_FEW_PLACES: &str = "too_few_places";
/// Left out: a railway or waterway.
const NOT_A_ROAD: &str = "not_a_road";
/// Left out: nobody knows what kind of road it is.
const UNKNOWN_CLASS: &str = "unknown_class";
/// Left out as in extracts: ways in car parks and to houses, tracks.
const MINOR_SERVICE: &str = "minor_service";
const TRACK: &str = "track";
/// Noted: a stretch of a road that is left out like such a way.
const MINOR_STRETCH: &str = "minor_service";

/// What closes the road over less than a vertex's reach holds on so much more before and behind it, metres. Then its ends are two vertices:
/// they are farther apart than twice that reach.
const WIDER_M: f64 = SNAP_M + 0.05;

/// A segment that is a road for heavy vehicles.
#[derive(Debug)]
pub(super) struct RoadSegment {
    pub(super) id: Box<str>,
    pub(super) key: FeatureKey,
    pub(super) line: Line,
    pub(super) name: Option<String>,
    /// Vertices at which rules change, ascending, without the ends.
    changes: Vec<usize>,
    /// Facts and refs of the parts between them. `None` for a part that is left out.
    facts: Vec<Option<(WayFacts, Option<String>)>>,
    pub(super) transitions: Vec<Transition>,
    /// Vertices at which the road is cut: where rules change, and where a prohibited transition begins or ends.
    pub(super) cuts: Vec<usize>,
}

/// A segment with its geometry, as a file has it.
pub(super) struct SegmentFeature {
    pub(super) id: String,
    pub(super) places: Vec<LonLat>,
    pub(super) segment: Segment,
}

impl RoadSegment {
    /// Makes a road of a segment, or counts why it is none.
    pub(super) fn of(
        feature: SegmentFeature,
        connectors: &Connectors,
        account: &mut Account,
    ) -> Result<Option<Self>, OvertureProblem> {
        let SegmentFeature { id, places, mut segment } = feature;
        let mut of_rules = Account::default();
        let mut rules = SegmentRules::of(&segment, &mut of_rules);
        let (class, mut line) =
            match class(&segment, &rules).and_then(|class| Ok((class, Line::new(places).ok_or(TOO_FEW_PLACES)?))) {
                Ok(both) => both,
                Err(reason) => {
                    account.left_out(SEGMENT, reason, 1);
                    return Ok(None);
                }
            };
        account.kept(SEGMENT, 1);
        account.add(&of_rules);
        let key = FeatureKey::segment(&id);
        let ends = segment
            .connectors
            .take()
            .ok_or_else(|| OvertureProblem::Value("the segment has no connectors".to_owned()))?;
        for connector in ends {
            if connector.at.is_some_and(|at| !(0.0..=1.0).contains(&at)) {
                return Err(OvertureProblem::Value(format!(
                    "connector {} is not within 0 to 1",
                    connector.connector_id
                )));
            }
            let of_connector = FeatureKey::connector(&connector.connector_id);
            let place = connectors.place(of_connector);
            if place.is_none() {
                account.noted(CONNECTOR, "missing", 1);
            }
            if !line.join(NodeId::new(of_connector.number()), place, connector.at) {
                account.noted(CONNECTOR, "off_its_line", 1);
            }
        }
        let margin = line.share_of(WIDER_M);
        loop {
            for share in rules.changes() {
                line.vertex_at(share);
            }
            if !rules.widen_short(|share| line.vertex_at(share), margin) {
                break;
            }
        }
        let mut changes: Vec<usize> = rules.changes().into_iter().map(|share| line.vertex_at(share)).collect();
        changes.retain(|vertex| (1..line.places.len() - 1).contains(vertex));
        changes.dedup();
        let mut bounds = vec![0];
        bounds.extend(&changes);
        bounds.push(line.places.len() - 1);
        let mut notes = Notes::default();
        let part = |pair: &[usize]| {
            let range = [line.share(pair[0]), line.share(pair[1])];
            let minor = class == RoadClass::Service && rules.is_minor(range);
            (!minor).then(|| (rules.road(class, range).facts(&mut notes), rules.reference(range)))
        };
        let facts: Vec<_> = bounds.windows(2).map(part).collect();
        let minor = facts.iter().filter(|part| part.is_none()).count();
        if minor > 0 {
            account.noted(SEGMENT, MINOR_STRETCH, minor as u64);
        }
        for note in notes.names() {
            account.noted(RULE, note, 1);
        }
        line.number_rest(key);
        let name = segment.names.and_then(|names| names.primary).filter(|name| !name.trim().is_empty());
        let cuts = changes.clone();
        let transitions = segment.prohibited_transitions.unwrap_or_default();
        Ok(Some(Self { id: id.into(), key, line, name, changes, facts, transitions, cuts }))
    }

    /// The parts of the road between its cuts: first and last vertex, and their facts. Parts that are left out are not among them.
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, usize, &(WayFacts, Option<String>))> {
        let ends = self.cuts.iter().copied().chain([self.line.places.len() - 1]);
        std::iter::once(0).chain(self.cuts.iter().copied()).zip(ends).filter_map(|(from, to)| {
            let part = self.changes.partition_point(|change| *change <= from);
            Some((from, to, self.facts.get(part)?.as_ref()?))
        })
    }

    /// The number of the way that begins at a cut. The first part has the segment's number.
    pub(super) fn way(&self, from: usize) -> i64 {
        if from == 0 {
            return self.key.number();
        }
        let node = self.line.nodes[from];
        let earlier = self.line.nodes[..from].iter().filter(|other| **other == node).count();
        self.key.of_part([node.get().cast_unsigned(), earlier as u64])
    }

    /// Cuts the road at a vertex.
    pub(super) fn cut(&mut self, vertex: usize) {
        if (1..self.line.places.len() - 1).contains(&vertex)
            && let Err(place) = self.cuts.binary_search(&vertex)
        {
            self.cuts.insert(place, vertex);
        }
    }
}

/// The class of a segment that is a road for heavy vehicles, by the rules for extracts.
fn class(segment: &Segment, rules: &SegmentRules) -> Result<RoadClass, &'static str> {
    if segment.subtype.as_deref().is_some_and(|subtype| subtype != "road") {
        return Err(NOT_A_ROAD);
    }
    let class = match segment.class.as_deref() {
        None | Some("unknown") => return Err(UNKNOWN_CLASS),
        Some(name) => given_class(name)?,
    };
    if class == RoadClass::Service && rules.is_minor_throughout() {
        return Err(MINOR_SERVICE);
    }
    if class == RoadClass::Track && !rules.open_with_width() {
        return Err(TRACK);
    }
    Ok(class)
}
