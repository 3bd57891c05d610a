//! Rewrites the extract in one pass: copies nodes, tags and splits ways, makes relations name the parts, and writes new objects
//! after those of their kind.

use osmpbfreader::osmformat::{HeaderBlock, PrimitiveBlock, PrimitiveGroup, Relation, Way};
use protobuf::Message as _;

use super::block::{Spool, Texts, write_blob, write_block};
use super::limits::{NodeLimits, with_limits};
use super::refusals::{End, Refusals};
use super::relations::{PartEnds, RelationTurns, WaySplits, name_parts, set_aside, set_members, turns_of};
use super::split::{WayPart, parts};
use super::tags::{StretchPermits, Tag, with_permits};
use super::{FIRST_NEW_ID, Flavour};
use crate::osm::pbf::copy::Contents;
use crate::osm::pbf::write::zlib_blob;
use crate::rows::EdgeNo;
use crate::ways::{OnWay, WayEdges, WayStretch, check_ids, ids};
use crate::wider::Wider;
use crate::{Destination, ExportError, Sink, Source};

/// An engine may take a way with one of these keys for a road.
const KEYS: [&[u8]; 3] = [b"highway", b"route", b"bridge"];

/// Writes the extract again as the file `name` of an output.
pub(in crate::formats) fn rewrite(
    source: &Source<'_>,
    target: &'static str,
    flavour: Flavour,
    destination: &mut Destination,
    name: &str,
) -> Result<(), ExportError> {
    let mut rewriter = Rewriter {
        source,
        flavour,
        refusals: Refusals::create(source, flavour, destination)?,
        wider: source.wider()?,
        limits: NodeLimits::default(),
        splits: WaySplits::default(),
        new_ways: Spool::new(destination.scratch(".ways")?),
        next_id: FIRST_NEW_ID,
        unclear: 0,
        stage: Stage::Nodes,
        out: destination.create(name)?,
    };
    rewriter.blobs(target)?;
    rewriter.reach(Stage::Relations)?;
    let Rewriter { refusals, mut out, unclear, .. } = rewriter;
    refusals.write(&mut out)?;
    if unclear > 0 {
        source.reporter.note(&format!("ways closed whole, as nodes at one place make their edges unclear: {unclear}"));
    }
    out.close()
}

/// Kinds of objects, in the order of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    Nodes,
    Ways,
    Relations,
}

struct Rewriter<'s, 'r> {
    source: &'s Source<'r>,
    flavour: Flavour,
    refusals: Refusals<'s, 'r>,
    wider: Wider,
    limits: NodeLimits,
    splits: WaySplits,
    new_ways: Spool,
    /// Id of the next new way.
    next_id: i64,
    unclear: u64,
    stage: Stage,
    out: Sink,
}

impl Rewriter<'_, '_> {
    fn blobs(&mut self, target: &'static str) -> Result<(), ExportError> {
        let source = self.source;
        let mut blobs = source.blobs(target)?;
        let mut database = source.database()?;
        let mut edges = WayEdges::new(database.edge_steps(&source.ask.vehicle, source.ask.policy)?);
        source.reporter.begin("rewrite", blobs.file_bytes());
        while let Some(blob) = blobs.next_blob()? {
            match blobs.contents(&blob)? {
                Contents::Header(header) => self.header(*header)?,
                Contents::Nodes(limits) => {
                    self.reach(Stage::Nodes)?;
                    limits.iter().for_each(|block| self.limits.take(block));
                    write_blob(&mut self.out, "OSMData", &blob.bytes)?;
                }
                Contents::Block(block) => self.block(*block, &blob.bytes, &mut edges)?,
                Contents::Other => {}
            }
            source.reporter.advance(blob.end);
        }
        source.reporter.end();
        edges.finish().map_err(|detail| source.extract_error(detail))
    }

    fn header(&mut self, mut header: HeaderBlock) -> Result<(), ExportError> {
        let features = header.required_features.iter().chain(&header.optional_features);
        if features.into_iter().any(|feature| feature == "LocationsOnWays") {
            let detail = "its ways carry the places of their nodes, which parts of ways could not: make the file with them left out \
                          (`osmium cat`), and ingest that";
            return Err(self.source.extract_error(detail.to_owned()));
        }
        let before = header.writingprogram().to_owned();
        header.set_writingprogram(format!("netcert {} after {before}", env!("CARGO_PKG_VERSION")));
        header
            .set_source(format!("{} netcert: {}", header.source(), self.source.header.json()).trim_start().to_owned());
        let bytes = header.write_to_bytes().map_err(std::io::Error::other)?;
        write_blob(&mut self.out, "OSMHeader", &zlib_blob(&bytes))
    }

    /// Goes on to objects of a kind. Writes the new ways after the last way.
    fn reach(&mut self, stage: Stage) -> Result<(), ExportError> {
        if stage < self.stage {
            let detail =
                "its objects are not sorted by kind and id: sort it with `osmium sort`, then ingest that".to_owned();
            return Err(self.source.extract_error(detail));
        }
        if stage == Stage::Relations && self.stage < stage {
            self.new_ways.pour(&mut self.out)?;
        }
        self.stage = stage;
        Ok(())
    }

    fn block(&mut self, mut block: PrimitiveBlock, blob: &[u8], edges: &mut WayEdges<'_>) -> Result<(), ExportError> {
        self.limits.take(&block);
        let mut texts = Texts::over(std::mem::take(&mut block.stringtable.mut_or_insert_default().s));
        let mut changed = false;
        for group in &mut block.primitivegroup {
            for way in &mut group.ways {
                changed |= self.way(way, &mut texts, edges)?;
            }
            for relation in &mut group.relations {
                changed |= self.relation(relation, &mut texts)?;
            }
        }
        let groups = std::mem::take(&mut block.primitivegroup);
        let alike: Vec<&[PrimitiveGroup]> = groups.chunk_by(|a, b| stage_of(a) == stage_of(b)).collect();
        if let (false, [one]) = (changed, alike.as_slice()) {
            self.reach(one.first().map_or(self.stage, stage_of))?;
            return write_blob(&mut self.out, "OSMData", blob);
        }
        let table = texts.into_table();
        for groups in alike {
            self.reach(groups.first().map_or(self.stage, stage_of))?;
            block.primitivegroup = groups.to_vec();
            block.stringtable.mut_or_insert_default().s.clone_from(&table);
            write_block(&mut self.out, &block)?;
        }
        Ok(())
    }

    /// Makes a relation name the parts of ways, and a restriction one turn. Returns whether it was changed.
    fn relation(&mut self, relation: &mut Relation, texts: &mut Texts) -> Result<bool, ExportError> {
        check_ids("relation", relation.id(), &ids(&relation.memids))
            .map_err(|detail| self.source.extract_error(detail))?;
        let mut changed = name_parts(relation, &self.splits, texts);
        match turns_of(relation, texts) {
            RelationTurns::AsItIs => {}
            RelationTurns::NotToBeSaid => {
                set_aside(relation, texts);
                changed = true;
            }
            RelationTurns::Each(turns) => {
                let mut turns = turns.iter();
                let first = turns.next();
                for turn in turns {
                    self.refusals.one_of_several(relation, turn, texts)?;
                }
                first.into_iter().for_each(|turn| set_members(relation, turn, texts));
                changed = true;
            }
        }
        self.refusals.hear(relation, texts);
        Ok(changed)
    }

    /// Tags and splits a way. Returns whether it was changed.
    fn way(&mut self, way: &mut Way, texts: &mut Texts, edges: &mut WayEdges<'_>) -> Result<bool, ExportError> {
        if way.id() >= FIRST_NEW_ID {
            let detail = format!("way {} has an id that new ways have: was it made by an export?", way.id());
            return Err(self.source.extract_error(detail));
        }
        let refs = ids(&way.refs);
        check_ids("way", way.id(), &refs).map_err(|detail| self.source.extract_error(detail))?;
        let whole = || vec![WayPart { first: 0, last: refs.len().saturating_sub(1), said: StretchPermits::default() }];
        let (stretches, parts) = match edges.of(way.id(), &refs).map_err(|detail| self.source.extract_error(detail))? {
            OnWay::Nothing if !way.keys.iter().any(|&key| KEYS.contains(&texts.text(key))) => return Ok(false),
            OnWay::Nothing => (Vec::new(), whole()),
            OnWay::Unclear(_) => {
                self.unclear += 1;
                (Vec::new(), whole())
            }
            OnWay::Stretches(stretches) => {
                let limited = |nodes: &[i64]| self.limits.any_on(nodes);
                let said = |stretch: &WayStretch| self.said(stretch);
                let parts = parts(&stretches, &refs, &said, self.refusals.cuts(), &limited);
                (stretches, parts)
            }
        };
        let part_ids = self.number(way.id(), &parts, &refs);
        self.lay(&stretches, &parts, &part_ids, &refs)?;
        self.write_parts(way, &parts, &part_ids, &refs, texts)?;
        Ok(true)
    }

    fn said(&self, stretch: &WayStretch) -> StretchPermits {
        let permitted = |edge: EdgeNo| self.source.permitted.edges.get(edge.index());
        StretchPermits {
            permitted: stretch.edges.map(|edge| edge.is_some_and(permitted)),
            rsc_m: stretch.rsc_m,
            uses: stretch.edges.map(|edge| self.wider.uses(edge.filter(|&edge| permitted(edge))?)),
        }
    }

    /// The ids of the parts. The first part keeps the way's id.
    fn number(&mut self, way_id: i64, parts: &[WayPart], refs: &[i64]) -> Vec<i64> {
        let mut ids = vec![way_id];
        for _ in parts.iter().skip(1) {
            ids.push(self.next_id);
            self.next_id += 1;
        }
        if parts.len() > 1 {
            let node = |place: usize| refs.get(place).copied().unwrap_or_default();
            let ends = |part: &WayPart| [node(part.first), node(part.last)];
            let parts = ids.iter().zip(parts).map(|(&id, part)| PartEnds { id, ends: ends(part) }).collect();
            self.splits.insert(way_id, parts);
        }
        ids
    }

    /// Notes the ends of the edges that relations will name, and the ends at which turning back is refused.
    fn lay(
        &mut self,
        stretches: &[WayStretch],
        parts: &[WayPart],
        ids: &[i64],
        refs: &[i64],
    ) -> Result<(), ExportError> {
        for stretch in stretches {
            let way = |within: &dyn Fn(&WayPart) -> bool| {
                parts.iter().zip(ids).find(|(part, _)| within(part)).map_or(0, |(_, &id)| id)
            };
            let end = |way, place: usize| End { way, node: refs.get(place).copied().unwrap_or_default() };
            let first = end(way(&|part| (part.first..part.last).contains(&stretch.first)), stretch.first);
            let last = end(way(&|part| part.first < stretch.last && stretch.last <= part.last), stretch.last);
            for (edge, ends) in stretch.edges.into_iter().zip([[first, last], [last, first]]) {
                if let Some(edge) = edge {
                    self.refusals.lies(edge, ends, refs.get(stretch.first..=stretch.last).unwrap_or_default());
                }
            }
            if stretch.edges.iter().all(|edge| edge.is_some_and(|edge| self.source.permitted.edges.get(edge.index()))) {
                self.refusals.dead_end(first)?;
                self.refusals.dead_end(last)?;
            }
        }
        Ok(())
    }

    fn write_parts(
        &mut self,
        way: &mut Way,
        parts: &[WayPart],
        ids: &[i64],
        refs: &[i64],
        texts: &mut Texts,
    ) -> Result<(), ExportError> {
        let text = |number: &u32| texts.text(*number).to_vec();
        let tags: Vec<Tag> = way.keys.iter().zip(&way.vals).map(|(key, value)| (text(key), text(value))).collect();
        let tags_of = |part: &WayPart| {
            let of_nodes = self.limits.on(refs.get(part.first..=part.last).unwrap_or_default());
            with_limits(with_permits(&tags, part.said, self.flavour), &of_nodes)
        };
        let mut parts = parts.iter().zip(ids);
        let first = parts.next();
        for (part, &id) in parts {
            let mut new = way.clone();
            new.set_id(id);
            new.refs = steps(refs, part);
            self.new_ways.way(new, &tags_of(part), texts)?;
        }
        if let Some((part, _)) = first {
            way.refs = steps(refs, part);
            let tags = tags_of(part);
            way.keys = tags.iter().map(|(key, _)| texts.number(key)).collect();
            way.vals = tags.iter().map(|(_, value)| texts.number(value)).collect();
        }
        Ok(())
    }
}

fn stage_of(group: &PrimitiveGroup) -> Stage {
    match group {
        group if !group.relations.is_empty() => Stage::Relations,
        group if !group.ways.is_empty() => Stage::Ways,
        _ => Stage::Nodes,
    }
}

/// The references of a part in the format's form: differences from one to the next.
fn steps(refs: &[i64], part: &WayPart) -> Vec<i64> {
    let mut last = 0;
    let step = |&node: &i64| node.wrapping_sub(std::mem::replace(&mut last, node));
    refs.get(part.first..=part.last).unwrap_or_default().iter().map(step).collect()
}
