//! The register: the measurements that a database keeps, what each was matched to, and which of them count.
//!
//! Of several measurements of one place the latest counts; where dates are equal or missing, the least. Every choice between rows, and every
//! difference from the map, is reported. Nothing here knows databases or vehicles.

use netcert_base::named;
use std::collections::BTreeMap;

use rustc_hash::{FxHashMap, FxHashSet};

use super::matching::{Match, match_rows};
use super::row::{MeasurementRow, Quantity};
use super::surface::Counted;
use crate::network::{Edge, EdgeNo, Network, Pieces, Site, pieces};
use crate::osm::NodeId;
use crate::osm::facts::{Limit, Policy, WidthSource};

/// Whether a place was found for a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum State {
    /// Its place was found.
    Matched,
    /// No road or junction was found.
    Unmatched,
    /// Several could be meant.
    Ambiguous,
}

named!(State { Matched = "matched", Unmatched = "unmatched", Ambiguous = "ambiguous" });

/// What becomes of a matched measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Usage {
    /// Certificates use it, at one of its places at least.
    Counts,
    /// Another measurement of the same places counts.
    Superseded,
    /// No certificate uses such a quantity, or the value says nothing.
    Kept,
}

named!(Usage { Counts = "counts", Superseded = "superseded", Kept = "kept" });

/// A place of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MeasurementTarget {
    /// `edge_id`
    Edge(i64),
    /// A junction, or one corner of it.
    Corner {
        /// OSM node id.
        node: NodeId,
        /// `edge_id` of the edge that ends and of the edge that begins at the corner.
        edges: Option<[i64; 2]>,
    },
    /// A junction whose surface was measured: OSM node id.
    Area(NodeId),
}

/// A measurement of the register.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its number, which it keeps.
    pub no: i64,
    /// Name of the file that it came from.
    pub file: String,
    /// The measurement.
    pub row: MeasurementRow,
    /// Whether its place was found.
    pub state: State,
    /// Why not, or why it is not used.
    pub why: Option<String>,
    /// Its places, each with whether it counts there.
    pub places: Vec<(MeasurementTarget, bool)>,
}

impl Entry {
    /// What becomes of it; `None` if it is not matched.
    #[must_use]
    pub fn usage(&self) -> Option<Usage> {
        match self.state {
            State::Matched if self.places.iter().any(|place| place.1) => Some(Usage::Counts),
            State::Matched if self.unused().is_some() => Some(Usage::Kept),
            State::Matched => Some(Usage::Superseded),
            State::Unmatched | State::Ambiguous => None,
        }
    }

    /// Why no certificate can use it.
    fn unused(&self) -> Option<&'static str> {
        match self.row.quantity {
            Quantity::DrivableBy => {
                Some("kept, not used by certificates; `--relative-to drivable_by` compares with it")
            }
            Quantity::Surface => self
                .row
                .counted()
                .is_none()
                .then_some("kept, not used by certificates: it has holes, or its uncertainty leaves nothing of it"),
            Quantity::KerbRadius => None,
            _ => self
                .row
                .lower()
                .is_none_or(|least| least <= 0.0)
                .then_some("kept, not used by certificates: its uncertainty leaves nothing of it"),
        }
    }

    /// Its places without whether they count.
    pub fn targets(&self) -> impl Iterator<Item = MeasurementTarget> + '_ {
        self.places.iter().map(|place| place.0)
    }

    fn set(&mut self, found: Match, network: &Network) {
        let id = |edge: EdgeNo| network.edges.get(edge.index()).map_or(0, |edge| edge.id);
        let (state, targets, why) = match found {
            Match::Edges(edges) => {
                (State::Matched, edges.into_iter().map(|edge| MeasurementTarget::Edge(id(edge))).collect(), None)
            }
            Match::Corner { node, edges } => {
                (State::Matched, vec![MeasurementTarget::Corner { node, edges: edges.map(|pair| pair.map(id)) }], None)
            }
            Match::Area(nodes) => (State::Matched, nodes.into_iter().map(MeasurementTarget::Area).collect(), None),
            Match::Unmatched(why) => (State::Unmatched, Vec::new(), Some(why)),
            Match::Ambiguous(why) => (State::Ambiguous, Vec::new(), Some(why)),
        };
        self.state = state;
        self.places = targets.into_iter().map(|target| (target, false)).collect();
        self.why = why.or_else(|| self.unused().map(str::to_owned));
    }
}

/// Rows as new entries, numbered from `first` on, with their places in a network. Which of them count is not decided yet.
#[must_use]
pub fn entries(network: &Network, file: &str, rows: Vec<MeasurementRow>, first: i64) -> Vec<Entry> {
    let found = match_rows(network, &rows);
    let entry = |((no, row), found): ((i64, MeasurementRow), Match)| {
        let file = file.to_owned();
        let mut entry = Entry { no, file, row, state: State::Unmatched, why: None, places: Vec::new() };
        entry.set(found, network);
        entry
    };
    (first..).zip(rows).zip(found).map(entry).collect()
}

/// Matches entries anew, to a network that may be another one than before.
pub fn match_again(network: &Network, entries: &mut [Entry]) {
    if entries.is_empty() {
        return;
    }
    let rows: Vec<MeasurementRow> = entries.iter().map(|entry| entry.row.clone()).collect();
    for (entry, found) in entries.iter_mut().zip(match_rows(network, &rows)) {
        entry.set(found, network);
    }
}

/// The rows that are not in the register yet, and those that are, each with the number that the register has for it. A row that a
/// file has twice is kept once; its double has no number yet.
#[must_use]
pub fn without_doubles(
    register: &[Entry],
    rows: Vec<MeasurementRow>,
) -> (Vec<MeasurementRow>, Vec<(MeasurementRow, Option<i64>)>) {
    let mut known: FxHashMap<String, Option<i64>> =
        register.iter().map(|entry| (content(&entry.row), Some(entry.no))).collect();
    let (mut new, mut doubles) = (Vec::new(), Vec::new());
    for row in rows {
        let content = content(&row);
        match known.get(&content) {
            Some(&no) => doubles.push((row, no)),
            None => {
                known.insert(content, None);
                new.push(row);
            }
        }
    }
    (new, doubles)
}

/// All that a row says. Where it stood in its file does not matter.
fn content(row: &MeasurementRow) -> String {
    format!("{:?}", MeasurementRow { number: 0, ..row.clone() })
}

/// A contradiction between a measurement and another one, or the map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    /// The measurements: the one that counts first.
    pub entries: Vec<i64>,
    /// What contradicts what, and what counts.
    pub what: String,
}

/// What counts, and what contradicts it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Decision {
    /// What certificates see.
    pub site: Site,
    /// Contradictions, by measurement.
    pub conflicts: Vec<Conflict>,
}

/// A place at which one measurement of a quantity counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum MeasuredObject {
    Edge(i64),
    Corner(NodeId, Option<Pieces>),
    Area(NodeId),
}

/// Decides which entries count, and marks them.
pub fn decide(network: &Network, register: &mut [Entry]) -> Decision {
    let edges = Edges::of(network, register.iter().flat_map(Entry::targets));
    let mut rivals: BTreeMap<(Quantity, MeasuredObject), Vec<(usize, usize)>> = BTreeMap::new();
    for (i, entry) in register.iter_mut().enumerate() {
        let unused = entry.unused().is_some();
        for (k, (target, counts)) in entry.places.iter_mut().enumerate() {
            *counts = false;
            if let (false, Some(object)) = (unused, edges.object(*target)) {
                rivals.entry((entry.row.quantity, object)).or_default().push((i, k));
            }
        }
    }
    let mut overruled: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    for places in rivals.values() {
        let Some(&(first, k)) = best(register, places) else { continue };
        register[first].places[k].1 = true;
        let value = |i: usize| register[i].row.lower();
        for &(other, _) in places.iter().filter(|place| value(place.0) != value(first)) {
            *overruled.entry((register[first].no, register[other].no)).or_default() += 1;
        }
    }
    let mut conflicts = between_rows(register, &overruled);
    conflicts.extend(register.iter().filter_map(|entry| against_map(network, &edges, entry)));
    conflicts.sort_by_key(|conflict| conflict.entries[0]);
    let counting = register.iter().flat_map(|entry| {
        let counted = entry.row.counted();
        let counting = entry.places.iter().filter(|place| place.1);
        counting.filter_map(move |place| Some((entry.row.quantity, place.0, counted.clone()?)))
    });
    Decision { site: edges.site(counting), conflicts }
}

/// Of several measurements of one place, the one that counts.
fn best<'p>(register: &[Entry], places: &'p [(usize, usize)]) -> Option<&'p (usize, usize)> {
    let date = |place: &(usize, usize)| register[place.0].row.date.as_deref();
    let latest = places.iter().filter_map(date).max();
    // A row without a date may be the latest one.
    let eligible = places.iter().filter(|place| date(place).is_none() || date(place) == latest);
    let value = |place: &(usize, usize)| register[place.0].row.lower().unwrap_or(f64::INFINITY);
    eligible.min_by(|a, b| value(a).total_cmp(&value(b)).then(register[a.0].no.cmp(&register[b.0].no)))
}

fn between_rows(register: &[Entry], overruled: &BTreeMap<(i64, i64), usize>) -> Vec<Conflict> {
    let by_no: FxHashMap<i64, &Entry> = register.iter().map(|entry| (entry.no, entry)).collect();
    let conflict = |(&(first, other), &places): (&(i64, i64), &usize)| {
        let (a, b) = (by_no.get(&first)?, by_no.get(&other)?);
        let later = match (&a.row.date, &b.row.date) {
            (Some(a), Some(b)) if a > b => "it is later",
            _ => "it is the lesser",
        };
        let what = format!(
            "{} says {} and {} says {} for {}; {first} counts there, {later}",
            a.label(),
            a.says(),
            b.label(),
            b.says(),
            counted(places, a.row.quantity),
        );
        Some(Conflict { entries: vec![first, other], what })
    };
    overruled.iter().filter_map(conflict).collect()
}

impl Entry {
    /// How messages name it.
    fn label(&self) -> String {
        format!("{} ({}:{})", self.no, self.file, self.row.number)
    }

    /// Its quantity and what counts of it.
    fn says(&self) -> String {
        format!("{} {}", crate::words::Named::name(self.row.quantity), self.shown(self.row.lower().unwrap_or(0.0)))
    }

    /// A number in the unit of its quantity.
    fn shown(&self, value: f64) -> String {
        format!("{value:.2} {}", if self.row.quantity == Quantity::MaxWeight { "t" } else { "m" })
    }
}

fn counted(places: usize, quantity: Quantity) -> String {
    let kind = if quantity == Quantity::KerbRadius { "corner" } else { "directed edge" };
    format!("{places} {kind}{}", if places == 1 { "" } else { "s" })
}

/// What the map says of a quantity at an edge.
enum Tagged {
    Value(f64),
    /// A tag that cannot be read.
    Unreadable,
}

/// What somebody tagged there. Assumed widths are no contradiction.
fn tagged(network: &Network, edge: &Edge, quantity: Quantity) -> Option<Tagged> {
    let limit = match quantity {
        Quantity::MaxHeight => edge.legal.max_height,
        Quantity::MaxWeight => edge.legal.max_weight,
        _ => {
            let strip = network.mapped_section(edge).strip(policy(quantity)?)?;
            return (strip.source >= WidthSource::Tagged).then_some(Tagged::Value(f64::from(strip.width_m())));
        }
    };
    match limit {
        Limit::None => None,
        Limit::At(most) => Some(Tagged::Value(f64::from(most))),
        Limit::Unreadable => Some(Tagged::Unreadable),
    }
}

/// What of an entry that counts contradicts a width or limit that somebody tagged.
fn against_map(network: &Network, edges: &Edges<'_>, entry: &Entry) -> Option<Conflict> {
    let (mut places, mut unreadable, mut least, mut most) = (0, 0, f64::INFINITY, f64::NEG_INFINITY);
    let (quantity, lower) = (entry.row.quantity, entry.row.lower()?);
    for (target, _) in entry.places.iter().filter(|place| place.1) {
        let MeasurementTarget::Edge(id) = *target else { continue };
        match edges.of_id(id).and_then(|edge| tagged(network, edge, quantity)) {
            Some(Tagged::Value(value)) if (value - lower).abs() >= 0.01 => {
                places += 1;
                (least, most) = (least.min(value), most.max(value));
            }
            Some(Tagged::Unreadable) => unreadable += 1,
            _ => {}
        }
    }
    let shown = |value: f64| entry.shown(value);
    let (label, says) = (entry.label(), entry.says());
    let mut told = Vec::new();
    if places > 0 {
        let tagged = if most - least < 0.01 { shown(most) } else { format!("{} to {}", shown(least), shown(most)) };
        let measured = match (lower < least, lower > most) {
            (true, _) => "is less than the map's tagged",
            (_, true) => "is more than the map's tagged",
            _ => "differs from the map's tagged",
        };
        told.push(format!("{measured} {tagged} on {}", counted(places, quantity)));
    }
    if unreadable > 0 {
        told.push(format!("replaces a tag that cannot be read on {}", counted(unreadable, quantity)));
    }
    let what = format!("{label}: {says} {}; the measurement counts", told.join(", and "));
    (!told.is_empty()).then(|| Conflict { entries: vec![entry.no], what })
}

/// The strip whose width a quantity is.
fn policy(quantity: Quantity) -> Option<Policy> {
    match quantity {
        Quantity::CarriagewayWidth => Some(Policy::Carriageway),
        Quantity::DirectionWidth => Some(Policy::Direction),
        Quantity::LaneWidth => Some(Policy::Lane),
        _ => None,
    }
}

/// The edges of a network that measurements name.
pub struct Edges<'n> {
    network: &'n Network,
    indices: FxHashMap<i64, EdgeNo>,
}

impl<'n> Edges<'n> {
    /// Looks the targets' edges up.
    pub fn of(network: &'n Network, targets: impl Iterator<Item = MeasurementTarget>) -> Self {
        let mut named = FxHashSet::default();
        for target in targets {
            match target {
                MeasurementTarget::Edge(id) => named.extend([id]),
                MeasurementTarget::Corner { edges, .. } => named.extend(edges.into_iter().flatten()),
                MeasurementTarget::Area(_) => {}
            }
        }
        let indices = if named.is_empty() {
            FxHashMap::default()
        } else {
            let known = network.numbered_edges().filter(|(_, edge)| named.contains(&edge.id));
            known.map(|(index, edge)| (edge.id, index)).collect()
        };
        Self { network, indices }
    }

    fn of_id(&self, id: i64) -> Option<&'n Edge> {
        self.network.edges.get(self.indices.get(&id)?.index())
    }

    /// `None` if the network does not have the place.
    fn object(&self, target: MeasurementTarget) -> Option<MeasuredObject> {
        match target {
            MeasurementTarget::Edge(id) => self.of_id(id).map(|edge| MeasuredObject::Edge(edge.id)),
            MeasurementTarget::Corner { node, edges: None } => Some(MeasuredObject::Corner(node, None)),
            MeasurementTarget::Corner { node, edges: Some([a, b]) } => {
                Some(MeasuredObject::Corner(node, Some(pieces([self.of_id(a)?, self.of_id(b)?]))))
            }
            MeasurementTarget::Area(node) => Some(MeasuredObject::Area(node)),
        }
    }

    /// Whether the network has the place.
    pub fn has(&self, target: MeasurementTarget) -> bool {
        self.object(target).is_some()
    }

    /// The site of measurements that count: at most one for each place and quantity.
    pub fn site(&self, counting: impl Iterator<Item = (Quantity, MeasurementTarget, Counted)>) -> Site {
        let mut site = Site::default();
        let mut widths_m: FxHashMap<i64, [Option<f64>; 3]> = FxHashMap::default();
        for (quantity, target, counted) in counting {
            let lower = match counted {
                Counted::Number(lower) => lower,
                Counted::Surface(rings) => {
                    if let MeasurementTarget::Area(node) = target {
                        rings.into_iter().for_each(|ring| site.add_surface(node, ring));
                    }
                    continue;
                }
            };
            match (quantity, target) {
                (Quantity::MaxHeight | Quantity::MaxWeight, MeasurementTarget::Edge(id)) => {
                    let Some(edge) = self.of_id(id) else { continue };
                    let limits = site.limits_mut(edge);
                    let slot =
                        if quantity == Quantity::MaxHeight { &mut limits.height_m } else { &mut limits.weight_t };
                    *slot = Some(lower as f32);
                }
                (Quantity::KerbRadius, MeasurementTarget::Corner { node, edges }) => {
                    let edges = edges.map(|pair| pair.map(|id| self.of_id(id)));
                    match edges {
                        None => site.set_kerb(node, None, lower),
                        Some([Some(a), Some(b)]) => site.set_kerb(node, Some([a, b]), lower),
                        Some(_) => {}
                    }
                }
                (_, MeasurementTarget::Edge(id)) => {
                    if let Some(policy) = policy(quantity) {
                        widths_m.entry(id).or_default()[policy as usize] = Some(lower);
                    }
                }
                _ => {}
            }
        }
        for (id, widths_m) in widths_m {
            let Some(edge) = self.of_id(id) else { continue };
            let section = self.network.mapped_section(edge).with_widths(widths_m, WidthSource::Surveyed);
            site.set_section(edge, section);
        }
        site
    }
}
