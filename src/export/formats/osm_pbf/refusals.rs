//! What relations refuse: turning back, turns between permitted edges, and sequences of edges.
//!
//! Promises: nothing is said again that the extract says as plainly. How a refusal must be worded so that an engine obeys was
//! tried on small networks; `tests/engines/run_shapes.py` does so again.

use std::io::Write as _;

use rustc_hash::{FxHashMap, FxHashSet};

use osmpbfreader::osmformat::Relation;

use super::block::{Spool, Texts};
use super::relations::{Kind, Refused, refusal_word, refused};
use super::split::Cuts;
use super::{FIRST_NEW_ID, Flavour};
use crate::export::sorter::Scratch;
use crate::export::ways::ids;
use crate::export::{ExportError, Place, Sink, Source};
use crate::osm::pbf::copy::Contents;

const ALL: &str = "restriction";
const HGV: &str = "restriction:hgv";

/// Valhalla 3.9.1 drops a restriction over more edges than this, counting its own, which end at every node that two ways share.
const MOST_VIA_SEGMENTS: usize = 10;

/// A way and the node at which it ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) way: i64,
    pub(super) node: i64,
}

/// Of an edge: its first and its last node, in direction of travel, each with its way; two ways where it is a loop.
type Ends = [End; 2];

/// Gathered while ways and relations go by; written after them.
pub(super) struct Refusals<'s, 'r> {
    source: &'s Source<'r>,
    flavour: Flavour,
    cuts: Cuts,
    sequences: Vec<Vec<u32>>,
    /// Of edges of which relations will speak.
    ends: FxHashMap<u32, Ends>,
    /// Of edges in the middle of a sequence: the nodes between their ends.
    between: FxHashMap<u32, Vec<i64>>,
    /// Ends at which nobody turns back. In a file: there are as many as edges.
    dead_ends: Scratch,
    /// Refused by the extract already, under this key.
    said: FxHashSet<(&'static str, Refused)>,
    relations: Spool,
    next_id: i64,
}

impl<'s, 'r> Refusals<'s, 'r> {
    pub(super) fn create(source: &'s Source<'r>, flavour: Flavour, place: &Place) -> Result<Self, ExportError> {
        let sequences = source.sequences()?;
        let middle = |edges: &Vec<u32>| edges.get(1..edges.len() - 1).unwrap_or_default().to_vec();
        let between = sequences.iter().flat_map(middle).map(|edge| (edge, Vec::new())).collect();
        Ok(Self {
            source,
            flavour,
            cuts: cuts(source, &sequences)?,
            sequences,
            ends: FxHashMap::default(),
            between,
            dead_ends: place.scratch(".ends")?,
            said: FxHashSet::default(),
            relations: Spool::new(place.scratch(".relations")?),
            next_id: FIRST_NEW_ID,
        })
    }

    /// Where ways must end.
    pub(super) fn cuts(&self) -> &Cuts {
        &self.cuts
    }

    /// Where an edge lies, over these nodes; kept if a relation will speak of it.
    pub(super) fn lies(&mut self, edge: u32, ends: Ends, nodes: &[i64]) {
        if self.cuts.speaks_of(edge) {
            self.ends.insert(edge, ends);
        }
        if let (Some(between), [_, inner @ .., _]) = (self.between.get_mut(&edge), nodes) {
            inner.clone_into(between);
        }
    }

    /// Nobody turns back here.
    pub(super) fn dead_end(&mut self, end: End) -> Result<(), ExportError> {
        for number in [end.way, end.node] {
            self.dead_ends.write_all(&number.to_le_bytes())?;
        }
        Ok(())
    }

    /// What the extract itself refuses. Valhalla's two ways of refusing a turn fail at different places: one does not stand for the
    /// other. To all others a restriction of everybody is one of lorries.
    pub(super) fn hear(&mut self, relation: &Relation, texts: &Texts) {
        for key in [ALL, HGV] {
            if let Some(refused) = refused(relation, texts, key) {
                self.said.insert((if self.flavour == Flavour::Hgv { HGV } else { key }, refused));
            }
        }
    }

    /// Writes all of it, after the extract's own relations.
    pub(super) fn write(mut self, out: &mut Sink) -> Result<(), ExportError> {
        self.turning_back()?;
        self.turns()?;
        if self.flavour == Flavour::Valhalla {
            self.shorten()?;
        }
        for sequence in std::mem::take(&mut self.sequences) {
            self.sequence(&sequence)?;
        }
        self.relations.pour(out)
    }

    fn turning_back(&mut self) -> Result<(), ExportError> {
        // Valhalla obeys no restriction of lorries where it turns back for want of another way on.
        let key = if self.flavour == Flavour::Hgv { HGV } else { ALL };
        let mut bytes = [0; 16];
        for at in (0..self.dead_ends.written()).step_by(bytes.len()) {
            self.dead_ends.read_at(at, &mut bytes)?;
            let [way, node] = [0, 8].map(|from| i64::from_le_bytes(*bytes[from..].first_chunk().unwrap_or(&[0; 8])));
            self.relation(&over(way, node, way), key, "no_u_turn")?;
        }
        Ok(())
    }

    fn turns(&mut self) -> Result<(), ExportError> {
        let source = self.source;
        let mut database = source.database()?;
        for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
            let step = step?;
            if let (true, Some(from), Some(to)) =
                (source.refuses_turn(&step), self.ends.get(&step.from).copied(), self.ends.get(&step.to).copied())
            {
                self.step([from, to], refusal_word(step.angle_deg))?;
            }
        }
        Ok(())
    }

    /// From the last node of an edge into another edge.
    fn step(&mut self, [from, to]: [Ends; 2], word: &str) -> Result<(), ExportError> {
        let members = over(from[1].way, from[1].node, to[0].way);
        // Valhalla obeys `restriction` into the first seven ways of a node only, and `restriction:hgv` not between two ways that meet
        // at both ends; what neither refuses would have to be both.
        let keys: &[&'static str] = if self.flavour == Flavour::Hgv { &[HGV] } else { &[ALL, HGV] };
        keys.iter().try_for_each(|key| self.relation(&members, key, word))
    }

    /// Refuses further ahead what is too long for Valhalla.
    fn shorten(&mut self) -> Result<(), ExportError> {
        let most = |edges: &Vec<u32>| edges.iter().filter_map(|edge| self.between.get(edge)).map(|n| n.len() + 1).sum();
        if self.sequences.iter().map(most).all(|segments: usize| segments <= MOST_VIA_SEGMENTS) {
            return Ok(());
        }
        let shared = self.shared_nodes()?;
        for edges in &mut self.sequences {
            let mut segments = 0;
            let fits = |edge: &&u32| {
                let inner = self.between.get(edge).map_or(&[][..], Vec::as_slice);
                segments += 1 + inner.iter().filter(|node| shared.contains(node)).count();
                segments <= MOST_VIA_SEGMENTS
            };
            let via = edges.get(1..edges.len() - 1).unwrap_or_default().iter().take_while(fits).count();
            edges.truncate(via + 2);
        }
        self.sequences.dedup();
        Ok(())
    }

    /// Of the nodes within sequences those at which any other way of the extract passes: it is read once more.
    fn shared_nodes(&self) -> Result<FxHashSet<i64>, ExportError> {
        let mut passed: FxHashMap<i64, u8> = self.between.values().flatten().map(|&node| (node, 0)).collect();
        let mut blobs = self.source.blobs("valhalla")?;
        while let Some(blob) = blobs.next_blob()? {
            let Contents::Block(block) = blobs.contents(&blob)? else { continue };
            for node in block.primitivegroup.iter().flat_map(|group| &group.ways).flat_map(|way| ids(&way.refs)) {
                if let Some(times) = passed.get_mut(&node) {
                    *times = times.saturating_add(1);
                }
            }
        }
        Ok(passed.into_iter().filter(|&(_, times)| times > 1).map(|(node, _)| node).collect())
    }

    fn sequence(&mut self, edges: &[u32]) -> Result<(), ExportError> {
        let Some(on) = edges.iter().map(|edge| self.ends.get(edge).copied()).collect::<Option<Vec<Ends>>>() else {
            return Ok(());
        };
        let [from, between @ .., to] = on.as_slice() else { return Ok(()) };
        if between.is_empty() {
            return self.step([*from, *to], "no_straight_on");
        }
        let mut members = vec![(Kind::WAY, from[1].way, "from")];
        for [first, last] in between {
            members.push((Kind::WAY, first.way, "via"));
            // Two where it is a loop.
            if last.way != first.way {
                members.push((Kind::WAY, last.way, "via"));
            }
        }
        members.push((Kind::WAY, to[0].way, "to"));
        self.relation(&members, if self.flavour == Flavour::Hgv { HGV } else { ALL }, "no_straight_on")
    }

    /// Says it, if nobody did.
    fn relation(&mut self, members: &[Member], key: &'static str, word: &str) -> Result<(), ExportError> {
        if Refused::by(members.iter().copied()).is_some_and(|refused| self.said.contains(&(key, refused))) {
            return Ok(());
        }
        let id = self.next_id;
        self.next_id += 1;
        self.relations.relation(id, members, &[("type", "restriction"), (key, word), ("netcert", "no")])
    }
}

type Member = (Kind, i64, &'static str);

fn over(from: i64, via: i64, to: i64) -> [Member; 3] {
    [(Kind::WAY, from, "from"), (Kind::NODE, via, "via"), (Kind::WAY, to, "to")]
}

/// Where ways must end so that relations can speak of edges.
fn cuts(source: &Source<'_>, sequences: &[Vec<u32>]) -> Result<Cuts, ExportError> {
    let mut cuts = Cuts::none(source.permitted.edges.len());
    let mut database = source.database()?;
    let [first, last] = &mut cuts.at;
    for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
        let step = step?;
        if source.refuses_turn(&step) {
            last.set(step.from);
            first.set(step.to);
        }
    }
    for pair in sequences.iter().flat_map(|edges| edges.array_windows()) {
        let [from, to] = pair;
        last.set(*from);
        first.set(*to);
    }
    Ok(cuts)
}
