//! The file: framing, inflating, index checks, passes over the blobs.
//!
//! A file is read whole or not at all. Every blob is inflated and every message checked, even those that are not kept.
//! The result is the same for any number of threads. The first pass takes ways and relations, the second pass the nodes
//! that kept ways name. Before them, a pass over the blobs with relations takes the multipolygons of the backdrop, whose ways have no tags
//! of their own. Most files claim to be sorted (nodes, ways, relations). The passes then skip the leading blobs that look as if they
//! held nothing for them, and a later pass verifies that.
//!
//! `wire` reads bulk data (ways, dense nodes) in place. Headers, plain nodes and relations are read through the
//! messages of `osmpbfreader`, after `wire` has checked what those messages do not check.

mod backdrop;
mod backdrop_objects;
mod block;
pub mod copy;
mod duplicates;
mod error;
mod frame;
mod gather;
mod header;
mod inflate;
mod nodes;
mod pass;
mod relations;
mod ways;
mod wire;
pub mod write;

use std::path::Path;

pub use super::read_account::{BackdropTally, HeaderInfo, NodeTally, ReadAccount, RelationTally};
pub use error::{ObjectId, PbfProblem, ReadError};
pub use wire::WireError;

use crate::osm::{
    Extract,
    changes::Changes,
    facts::{self, PointFacts, Tags, WayDraft},
};

use backdrop::AreaGatherer;
use block::Block;
use frame::{BlobKind, BlobPosition, BlobSource};
use gather::{NodeGatherer, WayGatherer};
use inflate::{Compression, Inflater};

/// Progress of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Current stage.
    pub stage: ReadingStage,
    /// Bytes of the file processed.
    pub done: u64,
    /// Bytes of the file in this stage.
    pub total: u64,
}

/// The stages of a reading, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadingStage {
    /// Framing and hash.
    Check,
    /// First pass.
    Ways,
    /// Second pass.
    Nodes,
}

impl ReadingStage {
    /// Name of the stage in a progress line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ReadingStage::Check => "check",
            ReadingStage::Ways => "ways",
            ReadingStage::Nodes => "nodes",
        }
    }
}

/// Reads an extract.
///
/// # Errors
/// [`ReadError`] if anything in the file is damaged, truncated or not supported.
pub fn read_extract(path: &Path, progress: &(dyn Fn(Progress) + Sync)) -> Result<Extract, ReadError> {
    read_extract_with(path, progress, facts::way_facts, facts::point_facts)
}

/// Reads an extract as it is after changes.
///
/// # Errors
/// [`ReadError`] if anything in the file is damaged, truncated or not supported.
pub fn read_changed_extract(
    path: &Path,
    changes: &Changes,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Extract, ReadError> {
    read(path, changes, progress, facts::way_facts, facts::point_facts)
}

/// As [`read_extract`], with other facts. `way` returns a way's facts, or why the way is left out. `point` returns the
/// facts of a node on a kept way, if any. Both are called from many threads.
///
/// # Errors
/// [`ReadError`] if anything in the file is damaged, truncated or not supported.
pub fn read_extract_with<W, P>(
    path: &Path,
    progress: &(dyn Fn(Progress) + Sync),
    way: W,
    point: P,
) -> Result<Extract, ReadError>
where
    W: for<'t> Fn(&Tags<'t>) -> Result<WayDraft<'t>, &'static str> + Sync,
    P: Fn(&Tags<'_>) -> Option<PointFacts> + Sync,
{
    read(path, &Changes::default(), progress, way, point)
}

fn read<W, P>(
    path: &Path,
    changes: &Changes,
    progress: &(dyn Fn(Progress) + Sync),
    way: W,
    point: P,
) -> Result<Extract, ReadError>
where
    W: for<'t> Fn(&Tags<'t>) -> Result<WayDraft<'t>, &'static str> + Sync,
    P: Fn(&Tags<'_>) -> Option<PointFacts> + Sync,
{
    let mut source = BlobSource::open(path)?;
    let total = source.len;
    let (frames, hash) = source.frames(|done| progress(Progress { stage: ReadingStage::Check, done, total }))?;
    let header = read_headers(&mut source, &frames)?;
    let data: Vec<BlobPosition> = frames.iter().copied().filter(|frame| frame.kind == BlobKind::Data).collect();
    let leading = if header.sorted { Leading::find(&mut source, &data)? } else { Leading::default() };
    let mut reading = Reading { source, data, changes, progress, way, point };
    let mut extract = match reading.run(leading)? {
        Some(extract) => extract,
        // The header's claim was wrong: read every blob on every pass.
        None => reading.run(Leading::default())?.unwrap_or_default(),
    };
    reading.source.check_unchanged()?;
    let account = &mut extract.account;
    account.header = header;
    account.bytes = total;
    account.blake3 = hash.to_hex().to_string();
    account.blobs_passed_over = frames.iter().filter(|frame| frame.kind == BlobKind::Other).count() as u64;
    Ok(extract)
}

/// The header of an extract, and the blake3 hash of the file in hexadecimal digits.
///
/// # Errors
/// The file cannot be read, or its frames or its header are damaged or not supported.
pub fn header_and_hash(path: &Path) -> Result<(HeaderInfo, String), ReadError> {
    let mut source = BlobSource::open(path)?;
    let (frames, hash) = source.frames(|_| ())?;
    Ok((read_headers(&mut source, &frames)?, hash.to_hex().to_string()))
}

/// Checks every header of the file (concatenated files have several) and returns the data of the first one.
fn read_headers(source: &mut BlobSource, frames: &[BlobPosition]) -> Result<HeaderInfo, ReadError> {
    let mut first = None;
    for frame in frames {
        match frame.kind {
            BlobKind::Header => {
                let parsed = with_block(source, frame, header::parse)?;
                // Two concatenated files are not sorted, whatever their headers claim.
                first = Some(first.map_or(parsed, |info| HeaderInfo { sorted: false, ..info }));
            }
            BlobKind::Data if first.is_none() => return Err(source.error(Some(frame.offset), PbfProblem::NoHeader)),
            BlobKind::Data | BlobKind::Other => {}
        }
    }
    first.ok_or_else(|| source.error(None, PbfProblem::NoHeader))
}

/// Numbers of leading blobs in a file that is sorted as claimed.
#[derive(Debug, Clone, Copy, Default)]
struct Leading {
    /// Those that hold nodes only.
    nodes: usize,
    /// Those that hold no relation.
    no_relations: usize,
}

impl Leading {
    fn find(source: &mut BlobSource, data: &[BlobPosition]) -> Result<Self, ReadError> {
        let nodes = leading(source, data, nodes::only_nodes)?;
        let rest = data.get(nodes..).unwrap_or_default();
        Ok(Self { nodes, no_relations: nodes + leading(source, rest, backdrop::no_relations)? })
    }
}

/// Number of leading blobs for which `holds`, found by bisection.
fn leading(
    source: &mut BlobSource,
    data: &[BlobPosition],
    holds: fn(&[u8]) -> Result<bool, PbfProblem>,
) -> Result<usize, ReadError> {
    let (mut low, mut high) = (0, data.len());
    while low < high {
        let middle = low.midpoint(high);
        let Some(frame) = data.get(middle) else { break };
        if with_block(source, frame, holds)? {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    Ok(low)
}

/// Reads a single blob.
fn with_block<T>(
    source: &mut BlobSource,
    frame: &BlobPosition,
    read: impl FnOnce(&[u8]) -> Result<T, PbfProblem>,
) -> Result<T, ReadError> {
    let mut blob = vec![0; frame.size];
    source.read_at(frame.body, &mut blob)?;
    let mut inflater = Inflater::default();
    let done = inflater.inflate(&blob).and_then(|(bytes, _)| read(bytes));
    done.map_err(|problem| source.error(Some(frame.offset), problem))
}

/// The state of reading a file.
struct Reading<'p, W, P> {
    source: BlobSource,
    data: Vec<BlobPosition>,
    /// Objects of the file that are changed do not count; those of the changes do.
    changes: &'p Changes,
    progress: &'p (dyn Fn(Progress) + Sync),
    way: W,
    point: P,
}

impl<W, P> Reading<'_, W, P>
where
    W: for<'t> Fn(&Tags<'t>) -> Result<WayDraft<'t>, &'static str> + Sync,
    P: Fn(&Tags<'_>) -> Option<PointFacts> + Sync,
{
    /// Runs all passes. `None` if the `leading` blobs hold more than they should.
    fn run(&mut self, leading: Leading) -> Result<Option<Extract>, ReadError> {
        let changed = write::blocks_of(self.changes);
        let mut account = ReadAccount::default();
        let areas = self.gather_areas(leading, &changed)?;
        let Some((mut ways, with_nodes)) = self.gather_ways(leading, &changed, &areas.members(), &mut account)? else {
            return Ok(None);
        };
        let (ids, backdrop_ids) = (ways.node_ids(), ways.backdrop_node_ids());
        let wanted = nodes::Ids { named: &ids, backdrop: &backdrop_ids };
        let Some(mut nodes) = self.gather_nodes(leading, &with_nodes, &changed, wanted, &mut account)? else {
            return Ok(None);
        };

        let of_backdrop = nodes.backdrop(backdrop_ids, &ways.inline_places);
        let places = std::mem::take(&mut nodes.place_nodes);
        let (backdrop, tally) = areas.finish(std::mem::take(&mut ways.backdrop), places, &of_backdrop);
        drop(of_backdrop);
        account.backdrop = tally;
        let (nodes, points, tally) = nodes.finish(ids, &ways.inline_places);
        account.ways_read = ways.read;
        account.ways_kept = ways.ways.len() as u64;
        account.ways_left_out = ways.left_out;
        account.tag_notes = ways.notes;
        account.road_areas = ways.areas.len() as u64;
        account.nodes = tally;
        account.relations = ways.relations.tally;
        account.relations.restrictions_off_road =
            ways.relations.vias.iter().filter(|&&id| nodes.place(id).is_none()).count() as u64;
        Ok(Some(Extract {
            ways: ways.ways,
            refs: ways.refs,
            nodes,
            points,
            areas: ways.areas,
            backdrop,
            restrictions: ways.relations.restrictions,
            strings: ways.strings,
            account,
        }))
    }

    /// The pass over relations: multipolygons of the backdrop. `changed` are the blocks of the changes.
    fn gather_areas(&mut self, leading: Leading, changed: &[Vec<u8>]) -> Result<AreaGatherer, ReadError> {
        let mut areas = AreaGatherer::default();
        let read_areas = |bytes: &[u8]| backdrop::areas(&Block::parse(bytes)?, self.changes);
        let take_areas = |_: BlobPosition, _: Compression, batch| {
            areas.add(batch);
            Ok(())
        };
        let with_relations = self.data.get(leading.no_relations..).unwrap_or_default();
        pass::run(&mut self.source, with_relations, read_areas, take_areas, |_| ())?;
        for block in changed {
            let batch = Block::parse(block).and_then(|block| backdrop::areas(&block, &Changes::default()));
            areas.add(batch.map_err(|problem| self.source.error(None, problem))?);
        }
        Ok(areas)
    }

    /// The pass over ways and relations: ways, and the blobs that may hold nodes. `members` are ways of the backdrop's areas. `None` if
    /// relations were found where none should be.
    fn gather_ways(
        &mut self,
        leading: Leading,
        changed: &[Vec<u8>],
        members: &[i64],
        account: &mut ReadAccount,
    ) -> Result<Option<(WayGatherer, Vec<BlobPosition>)>, ReadError> {
        let (presumed, rest) = self.data.split_at_checked(leading.nodes).unwrap_or_default();
        let mut with_nodes = presumed.to_vec();
        let mut ways = WayGatherer::default();
        let mut mistaken = false;
        let mut without_relations = leading.no_relations - presumed.len();
        let read_ways = |bytes: &[u8]| ways::read(&Block::parse(bytes)?, &self.way, members, self.changes);
        let take_ways = |frame: BlobPosition, compression: Compression, batch: ways::WayBatch| {
            *account.blobs.entry(compression.name()).or_default() += 1;
            if batch.has_nodes {
                with_nodes.push(frame);
            }
            if without_relations > 0 {
                without_relations -= 1;
                mistaken |= batch.relations.found;
            }
            ways.add(batch)
        };
        pass::run(&mut self.source, rest, read_ways, take_ways, report(self.progress, ReadingStage::Ways, rest))?;
        if mistaken {
            return Ok(None);
        }
        for block in changed {
            let read = |block: Block<'_>| ways::read(&block, &self.way, members, &Changes::default());
            let batch = Block::parse(block).and_then(read);
            batch.and_then(|batch| ways.add(batch)).map_err(|problem| self.source.error(None, problem))?;
        }
        ways.finish();
        Ok(Some((ways, with_nodes)))
    }

    /// The pass over the blobs with nodes: those that are `wanted`. `None` if something else was found in the leading blobs.
    fn gather_nodes(
        &mut self,
        leading: Leading,
        with_nodes: &[BlobPosition],
        changed: &[Vec<u8>],
        wanted: nodes::Ids<'_>,
        account: &mut ReadAccount,
    ) -> Result<Option<NodeGatherer>, ReadError> {
        let mut nodes = NodeGatherer::new(wanted.named.len(), wanted.backdrop.len());
        let mut mistaken = false;
        let mut presumed_left = self.data.get(..leading.nodes).map_or(0, <[BlobPosition]>::len);
        let read_nodes = |bytes: &[u8]| nodes::read(&Block::parse(bytes)?, wanted, &self.point, self.changes);
        let take_nodes = |_: BlobPosition, compression: Compression, batch: nodes::NodeBatch| {
            if presumed_left > 0 {
                presumed_left -= 1;
                mistaken |= batch.has_others;
                *account.blobs.entry(compression.name()).or_default() += 1;
            }
            nodes.add(batch);
            Ok(())
        };
        pass::run(
            &mut self.source,
            with_nodes,
            read_nodes,
            take_nodes,
            report(self.progress, ReadingStage::Nodes, with_nodes),
        )?;
        if mistaken {
            return Ok(None);
        }
        for block in changed {
            let block = Block::parse(block);
            let batch = block.and_then(|block| nodes::read(&block, wanted, &self.point, &Changes::default()));
            nodes.add(batch.map_err(|problem| self.source.error(None, problem))?);
        }
        Ok(Some(nodes))
    }
}

fn report<'p>(
    progress: &'p (dyn Fn(Progress) + Sync),
    stage: ReadingStage,
    frames: &[BlobPosition],
) -> impl FnMut(u64) + Send + 'p {
    let total = frames.iter().map(|frame| frame.size as u64).sum();
    move |done| progress(Progress { stage, done, total })
}
