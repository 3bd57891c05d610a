//! Writes relations that refuse turning back, turns between permitted edges, and sequences of edges.
//!
//! A refusal that the extract has already is not repeated. The wording that engines obey was found by trials on small networks;
//! `tests/engines/run_shapes.py` repeats them.

use std::io::Write as _;

use rustc_hash::{FxHashMap, FxHashSet};

use osmpbfreader::osmformat::Relation;

use super::block::{Spool, Texts};
use super::relations::{Kind, RefusedTurn, RelationMember, refusal_word, refused, set_members};
use super::split::Cuts;
use super::{FIRST_NEW_ID, Flavour};
use crate::osm::pbf::copy::Contents;
use crate::rows::EdgeNo;
use crate::scratch::Scratch;
use crate::ways::ids;
use crate::{Destination, ExportError, Sink, Source};

const ALL: &str = "restriction";
const HGV: &str = "restriction:hgv";

/// Valhalla 3.9.1 drops a restriction over more of its own edges than this. Its edges end at every node that two ways share.
const MOST_VIA_SEGMENTS: usize = 10;

/// A way and the node at which it ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) way: i64,
    pub(super) node: i64,
}

/// The first and last node of an edge, in direction of travel, each with its way. The ways differ if the edge is a loop.
type Ends = [End; 2];

/// The refusals, which are collected while ways and relations are read and written after them.
pub(super) struct Refusals<'s, 'r> {
    source: &'s Source<'r>,
    flavour: Flavour,
    cuts: Cuts,
    sequences: Vec<Vec<EdgeNo>>,
    /// The ends of the edges that relations will name.
    ends: FxHashMap<EdgeNo, Ends>,
    /// The nodes between the ends of each edge in the middle of a sequence.
    between: FxHashMap<EdgeNo, Vec<i64>>,
    /// The ends at which turning back is refused. They are in a file, because there are as many as edges.
    dead_ends: Scratch,
    /// What the extract refuses already, by key.
    said: FxHashSet<(&'static str, RefusedTurn)>,
    relations: Spool,
    next_id: i64,
}

impl<'s, 'r> Refusals<'s, 'r> {
    pub(super) fn create(
        source: &'s Source<'r>,
        flavour: Flavour,
        destination: &Destination,
    ) -> Result<Self, ExportError> {
        let sequences = source.sequences()?;
        let middle = |edges: &Vec<EdgeNo>| edges.get(1..edges.len() - 1).unwrap_or_default().to_vec();
        let between = sequences.iter().flat_map(middle).map(|edge| (edge, Vec::new())).collect();
        Ok(Self {
            source,
            flavour,
            cuts: cuts(source, &sequences)?,
            sequences,
            ends: FxHashMap::default(),
            between,
            dead_ends: destination.scratch(".ends")?,
            said: FxHashSet::default(),
            relations: Spool::new(destination.scratch(".relations")?),
            next_id: FIRST_NEW_ID,
        })
    }

    /// The places at which ways must end.
    pub(super) fn cuts(&self) -> &Cuts {
        &self.cuts
    }

    /// Notes the ends and nodes of an edge, if a relation will name it.
    pub(super) fn lies(&mut self, edge: EdgeNo, ends: Ends, nodes: &[i64]) {
        if self.cuts.speaks_of(edge) {
            self.ends.insert(edge, ends);
        }
        if let (Some(between), [_, inner @ .., _]) = (self.between.get_mut(&edge), nodes) {
            inner.clone_into(between);
        }
    }

    /// Notes an end at which turning back is refused.
    pub(super) fn dead_end(&mut self, end: End) -> Result<(), ExportError> {
        for number in [end.way, end.node] {
            self.dead_ends.write_all(&number.to_le_bytes())?;
        }
        Ok(())
    }

    /// Notes what a relation of the extract refuses. For Valhalla the two keys are kept apart, because they fail at different
    /// places. For other readers a restriction of all vehicles counts as one of lorries.
    pub(super) fn hear(&mut self, relation: &Relation, texts: &Texts) {
        for key in [ALL, HGV] {
            if let Some(refused) = refused(relation, texts, key) {
                self.said.insert((if self.flavour == Flavour::Hgv { HGV } else { key }, refused));
            }
        }
    }

    /// Adds a relation that says one turn of a restriction that says several, with its tags.
    pub(super) fn one_of_several(
        &mut self,
        restriction: &Relation,
        turn: &[RelationMember],
        texts: &mut Texts,
    ) -> Result<(), ExportError> {
        let mut one = restriction.clone();
        set_members(&mut one, turn, texts);
        self.hear(&one, texts);
        let text = |number: &u32| String::from_utf8_lossy(texts.text(*number)).into_owned();
        let mut tags: Vec<(String, String)> =
            one.keys.iter().zip(&one.vals).map(|(key, value)| (text(key), text(value))).collect();
        tags.push(("netcert:of".to_owned(), restriction.id().to_string()));
        let tags: Vec<(&str, &str)> = tags.iter().map(|(key, value)| (&**key, &**value)).collect();
        let id = self.next_id;
        self.next_id += 1;
        self.relations.relation(id, turn, &tags)
    }

    /// Writes all refusals, after the extract's own relations.
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
        // Valhalla ignores restrictions of lorries where turning back is the only way on.
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

    /// Refuses a step from the last node of one edge into another edge.
    fn step(&mut self, [from, to]: [Ends; 2], word: &str) -> Result<(), ExportError> {
        let members = over(from[1].way, from[1].node, to[0].way);
        // Valhalla obeys `restriction` only into the first seven ways of a node, and ignores `restriction:hgv` between two ways that
        // meet at both ends. Both keys are written, so only a turn with both conditions stays open.
        let keys: &[&'static str] = if self.flavour == Flavour::Hgv { &[HGV] } else { &[ALL, HGV] };
        keys.iter().try_for_each(|key| self.relation(&members, key, word))
    }

    /// Shortens sequences that are too long for Valhalla, by refusing them earlier.
    fn shorten(&mut self) -> Result<(), ExportError> {
        let most =
            |edges: &Vec<EdgeNo>| edges.iter().filter_map(|edge| self.between.get(edge)).map(|n| n.len() + 1).sum();
        if self.sequences.iter().map(most).all(|segments: usize| segments <= MOST_VIA_SEGMENTS) {
            return Ok(());
        }
        let shared = self.shared_nodes()?;
        for edges in &mut self.sequences {
            let mut segments = 0;
            let fits = |edge: &&EdgeNo| {
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

    /// The nodes within sequences at which another way of the extract passes. The extract is read once more.
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

    fn sequence(&mut self, edges: &[EdgeNo]) -> Result<(), ExportError> {
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
            // The edge has two ways if it is a loop.
            if last.way != first.way {
                members.push((Kind::WAY, last.way, "via"));
            }
        }
        members.push((Kind::WAY, to[0].way, "to"));
        self.relation(&members, if self.flavour == Flavour::Hgv { HGV } else { ALL }, "no_straight_on")
    }

    /// Adds a relation, unless the extract has the same refusal.
    fn relation(&mut self, members: &[RelationMember], key: &'static str, word: &str) -> Result<(), ExportError> {
        if RefusedTurn::by(members.iter().copied()).is_some_and(|refused| self.said.contains(&(key, refused))) {
            return Ok(());
        }
        let id = self.next_id;
        self.next_id += 1;
        self.relations.relation(id, members, &[("type", "restriction"), (key, word), ("netcert", "no")])
    }
}

fn over(from: i64, via: i64, to: i64) -> [RelationMember; 3] {
    [(Kind::WAY, from, "from"), (Kind::NODE, via, "via"), (Kind::WAY, to, "to")]
}

/// The places at which ways must end so that relations can name edges.
fn cuts(source: &Source<'_>, sequences: &[Vec<EdgeNo>]) -> Result<Cuts, ExportError> {
    let mut cuts = Cuts::none(source.permitted.edges.len());
    let mut database = source.database()?;
    let [first, last] = &mut cuts.at;
    for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
        let step = step?;
        if source.refuses_turn(&step) {
            last.set(step.from.index());
            first.set(step.to.index());
        }
    }
    for pair in sequences.iter().flat_map(|edges| edges.array_windows()) {
        let [from, to] = pair;
        last.set(from.index());
        first.set(to.index());
    }
    Ok(cuts)
}
