//! For `osrm-customize` and `osrm-contract`: closed segments and penalties of turns.
//!
//! `segment-speeds.csv` has a line `from,to,0` for every pair of neighbouring nodes, in every direction, that is not permitted, on
//! any way that OSRM's profiles might use. `turn-penalties.csv` has a line `from,via,to,3276.7` for every refused turn between
//! permitted edges, and for turning back. OSRM closes segments. It stores penalties in 16 bits, so a turn cannot be closed, only
//! be made to cost 55 minutes. Where nothing else meets, OSRM has no turn that could cost anything, so the segment before is closed.
//!
//! What OSRM cannot express is refused. Of a restriction over ways, and of a refused passage, the first step is refused. A passage
//! is open only where each of its edges and turns is permitted.

use std::io::Write as _;

use osmpbfreader::osmformat::PrimitiveBlock;
use rustc_hash::FxHashSet;

use super::{Options, Target};
use crate::osm::pbf::copy::Contents;
use crate::rows::EdgeNo;
use crate::scratch::Scratch;
use crate::ways::{OnWay, WayEdges, WayStretch, check_ids, ids};
use crate::{Destination, ExportError, Layout, Sink, Source};

/// The penalty of a refused turn, seconds. It is the greatest that OSRM can store (2^15 − 1 tenths).
const PENALTY_S: f64 = 3276.7;

/// OSRM's car profile looks only at ways with one of these keys (`process_way` in `profiles/car.lua` of 26.10).
const KEYS: [&[u8]; 3] = [b"highway", b"route", b"bridge"];

/// `osrm`
pub(super) struct Osrm;

impl Target for Osrm {
    fn name(&self) -> &'static str {
        "osrm"
    }

    fn about(&self) -> &'static str {
        "OSRM: segment speeds and turn penalties for osrm-customize or osrm-contract"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::Folder { target: self.name(), instead: "" }
    }

    fn needs_extract(&self) -> bool {
        true
    }

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        let ends = Ends::new(destination.scratch(".ends")?);
        let stopped = source.stopped()?;
        let speeds = destination.create("segment-speeds.csv")?;
        let turns = destination.create("turn-penalties.csv")?;
        let mut tables = Tables { source, speeds, turns, ends, stopped, unclear: 0 };
        tables.ways()?;
        tables.turns()?;
        if tables.unclear > 0 {
            let note = format!("ways closed whole, as nodes at one place make their edges unclear: {}", tables.unclear);
            source.reporter.note(&note);
        }
        tables.speeds.close()?;
        tables.turns.close()
    }
}

struct Tables<'s, 'r> {
    source: &'s Source<'r>,
    speeds: Sink,
    turns: Sink,
    ends: Ends,
    /// Edges whose last segment is closed, because the only way on is refused.
    stopped: FxHashSet<EdgeNo>,
    unclear: u64,
}

impl Tables<'_, '_> {
    fn ways(&mut self) -> Result<(), ExportError> {
        let source = self.source;
        let mut blobs = source.blobs("osrm")?;
        let mut database = source.database()?;
        let mut edges = WayEdges::new(database.edge_steps(&source.ask.vehicle, source.ask.policy)?);
        source.reporter.begin("ways", blobs.file_bytes());
        while let Some(blob) = blobs.next_blob()? {
            if let Contents::Block(block) = blobs.contents(&blob)? {
                self.block(&block, &mut edges)?;
            }
            source.reporter.advance(blob.end);
        }
        source.reporter.end();
        edges.finish().map_err(|detail| source.extract_error(detail))
    }

    fn block(&mut self, block: &PrimitiveBlock, edges: &mut WayEdges<'_>) -> Result<(), ExportError> {
        let texts = &block.stringtable.s;
        for way in block.primitivegroup.iter().flat_map(|group| &group.ways) {
            let refs = ids(&way.refs);
            let on = edges.of(way.id(), &refs).map_err(|detail| self.source.extract_error(detail))?;
            let road =
                way.keys.iter().any(|&key| texts.get(key as usize).is_some_and(|key| KEYS.contains(&key.as_slice())));
            match on {
                OnWay::Nothing if !road => {}
                _ if let Err(detail) = check_ids("way", way.id(), &refs) => {
                    return Err(self.source.extract_error(detail));
                }
                OnWay::Stretches(stretches) => self.stretches(&refs, &stretches)?,
                OnWay::Unclear(edges) => {
                    self.unclear += 1;
                    edges.iter().try_for_each(|&edge| self.ends.push(edge, [0; 3]))?;
                    self.close(&refs, 0, refs.len().saturating_sub(1), [true; 2])?;
                }
                OnWay::Nothing => self.close(&refs, 0, refs.len().saturating_sub(1), [true; 2])?,
            }
        }
        Ok(())
    }

    fn stretches(&mut self, refs: &[i64], stretches: &[WayStretch]) -> Result<(), ExportError> {
        let mut done = 0;
        for stretch in stretches {
            let &WayStretch { first, last, edges, .. } = stretch;
            self.close(refs, done, first, [true; 2])?;
            done = last;
            let permitted = edges.map(|edge| edge.is_some_and(|edge| self.source.permitted.edges.get(edge.index())));
            self.close(refs, first, last, permitted.map(|yes| !yes))?;
            let node = |place: usize| refs.get(place).copied().unwrap_or_default();
            // The nearest different node at each end, because adjacent repetitions of a node count as one.
            let after = (first..last).map(|i| node(i + 1)).find(|&id| id != node(first)).unwrap_or_default();
            let before = (first..last).rev().map(node).find(|&id| id != node(last)).unwrap_or_default();
            for (direction, edge) in edges.into_iter().enumerate() {
                if let Some(edge) = edge {
                    let [second, last_but_one, end] =
                        if direction == 0 { [after, before, node(last)] } else { [before, after, node(first)] };
                    self.ends.push(edge, [second, last_but_one, end])?;
                }
            }
            let stops = edges.map(|edge| edge.is_some_and(|edge| self.stopped.contains(&edge)));
            let ends = [[before, node(last)], [after, node(first)]];
            for (end, [from, via]) in ends.into_iter().enumerate() {
                // Of a single segment the way back may be closed.
                let back = !(stops[1 - end] && ends[1 - end] == [via, from]);
                if stops[end] {
                    writeln!(self.speeds, "{from},{via},0")?;
                } else if permitted == [true; 2] && back {
                    self.penalise(from, via, from)?;
                }
            }
        }
        self.close(refs, done, refs.len().saturating_sub(1), [true; 2])
    }

    /// Closes the segments between two indices of a way, along the way and against it as `closed` says.
    fn close(&mut self, refs: &[i64], from: usize, to: usize, closed: [bool; 2]) -> Result<(), ExportError> {
        for pair in refs.get(from..=to).unwrap_or_default().windows(2).filter(|pair| pair[0] != pair[1]) {
            for ([a, b], closed) in [[pair[0], pair[1]], [pair[1], pair[0]]].into_iter().zip(closed) {
                if closed {
                    writeln!(self.speeds, "{a},{b},0")?;
                }
            }
        }
        Ok(())
    }

    fn penalise(&mut self, from: i64, via: i64, to: i64) -> Result<(), ExportError> {
        Ok(writeln!(self.turns, "{from},{via},{to},{PENALTY_S}")?)
    }

    /// Writes refused turns and the first steps of refused sequences.
    fn turns(&mut self) -> Result<(), ExportError> {
        let source = self.source;
        let mut database = source.database()?;
        for step in source.told(database.turn_steps(&source.ask.vehicle, source.ask.policy)?) {
            let step = step?;
            if source.refuses_turn(&step) {
                self.refuse(step.from, step.to)?;
            }
        }
        for sequence in source.sequences()? {
            if let [from, to, ..] = sequence.as_slice() {
                self.refuse(*from, *to)?;
            }
        }
        Ok(())
    }

    fn refuse(&mut self, from: EdgeNo, to: EdgeNo) -> Result<(), ExportError> {
        let ([_, before, via], [after, _, end]) = (self.ends.get(from)?, self.ends.get(to)?);
        let closed = self.stopped.contains(&from) || (self.stopped.contains(&to) && after == end);
        if before == 0 || after == 0 || closed {
            return Ok(());
        }
        self.penalise(before, via, after)
    }
}

/// By edge: its second, last but one and last node, or zeros if they are not clear. The nodes are in a file, so that memory does
/// not grow with the network.
struct Ends {
    file: Scratch,
    edges: u32,
}

const ENDS_BYTES: usize = 3 * 8;

impl Ends {
    fn new(file: Scratch) -> Self {
        Self { file, edges: 0 }
    }

    /// Adds an edge. Edges must come in order.
    fn push(&mut self, edge: EdgeNo, nodes: [i64; 3]) -> Result<(), ExportError> {
        for _ in self.edges..edge.get() {
            self.file.write_all(&[0; ENDS_BYTES])?;
        }
        self.edges = edge.get().saturating_add(1);
        nodes.iter().try_for_each(|node| self.file.write_all(&node.to_le_bytes()))?;
        Ok(())
    }

    fn get(&mut self, edge: EdgeNo) -> Result<[i64; 3], ExportError> {
        let (mut bytes, mut nodes) = ([0; ENDS_BYTES], [0; 3]);
        if edge.get() < self.edges {
            self.file.read_at(u64::from(edge) * ENDS_BYTES as u64, &mut bytes)?;
        }
        nodes.iter_mut().zip(bytes.as_chunks().0).for_each(|(node, word)| *node = i64::from_le_bytes(*word));
        Ok(nodes)
    }
}
