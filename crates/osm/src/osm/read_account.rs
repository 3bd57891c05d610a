//! The account of a reading: counts of objects read, kept and left out, by reason.

use std::collections::BTreeMap;

use crate::account::AccountRow;

/// Counts of every object read. `ways_read = ways_kept + Σ ways_left_out`, and nodes add up likewise.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadAccount {
    /// Data from the file's header.
    pub header: HeaderInfo,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// blake3 hash of the file, in hexadecimal digits.
    pub blake3: String,
    /// Way objects in the file.
    pub ways_read: u64,
    /// Ways in the extract.
    pub ways_kept: u64,
    /// Ways left out, by reason.
    pub ways_left_out: BTreeMap<&'static str, u64>,
    /// Ways left out as roads, but kept as the surface of a road or an island on it.
    pub road_areas: u64,
    /// Remarks on tags of kept ways, each at most once per way.
    pub tag_notes: BTreeMap<&'static str, u64>,
    /// Node objects in the file.
    pub nodes: NodeTally,
    /// Relations in the file.
    pub relations: RelationTally,
    /// What lies behind the roads.
    pub backdrop: BackdropTally,
    /// Blobs of data, by compression.
    pub blobs: BTreeMap<&'static str, u64>,
    /// Blobs of an unknown type, skipped as the format demands.
    pub blobs_passed_over: u64,
}

/// Counts of node objects: `read = placed + unnamed + deleted + invalid + superseded`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct NodeTally {
    /// All objects.
    pub read: u64,
    /// Named by a kept way or area, at a valid place.
    pub placed: u64,
    /// Named by no kept way or area.
    pub unnamed: u64,
    /// `visible=false`
    pub deleted: u64,
    /// Named, but at an invalid place; treated as missing.
    pub invalid: u64,
    /// Named, but followed by another object with the same id: the file's last one counts.
    pub superseded: u64,
    /// Distinct nodes that kept ways and areas name, in the file or not.
    pub named: u64,
    /// Named nodes that are not in the file.
    pub missing: u64,
    /// Missing or invalid nodes placed by a way that carries their positions (`LocationsOnWays`).
    pub placed_by_ways: u64,
}

impl ReadAccount {
    /// Warnings for the user. The format has no end mark, so a file cut exactly between two blobs is a legal shorter
    /// one. Only these signs show the cut.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let nodes = &self.nodes;
        let mut warnings = Vec::new();
        if self.ways_read == 0 {
            warnings.push(format!("the file has {} nodes and no ways: was it cut off?", nodes.read));
        } else if self.relations.read == 0 {
            warnings
                .push("the file has no relations: it was written without, or cut off between two blocks".to_owned());
        }
        let lost = nodes.missing + nodes.invalid - nodes.placed_by_ways;
        if lost > 0 {
            let named = nodes.named;
            warnings.push(format!("{lost} of the {named} nodes of its roads are not in the file: roads are cut there"));
        }
        warnings
    }

    /// The account as rows of stage `read`, in a fixed order.
    #[must_use]
    pub fn rows(&self) -> Vec<AccountRow> {
        let mut rows = Vec::new();
        let mut row = |item: &str, outcome: &str, reason: &str, count: u64| {
            if count > 0 || reason.is_empty() {
                rows.push(AccountRow::new("read", item, outcome, reason, count));
            }
        };
        row("way", "read", "", self.ways_read);
        row("way", "kept", "", self.ways_kept);
        for (reason, &count) in &self.ways_left_out {
            row("way", "left_out", reason, count);
        }
        row("way", "noted", "road_area", self.road_areas);
        for (note, &count) in &self.tag_notes {
            row("tag", "noted", note, count);
        }
        let nodes = &self.nodes;
        row("node", "read", "", nodes.read);
        row("node", "kept", "", nodes.placed);
        row("node", "left_out", "deleted", nodes.deleted);
        row("node", "left_out", "duplicate_id", nodes.superseded);
        row("node", "left_out", "invalid_location", nodes.invalid);
        row("node", "left_out", "not_on_a_road", nodes.unnamed);
        row("node", "noted", "missing", nodes.missing);
        row("node", "noted", "named_by_ways", nodes.named);
        row("node", "noted", "placed_by_ways", nodes.placed_by_ways);
        row("relation", "read", "", self.relations.read);
        let relations = &self.relations;
        row("relation", "kept", "", relations.kept());
        row("relation", "left_out", "duplicate_id", relations.superseded);
        row("relation", "left_out", "exempt", relations.exempt);
        row("relation", "left_out", "not_a_restriction", relations.read - relations.restrictions);
        row("relation", "left_out", "other_vehicles", relations.other_vehicles);
        row("relation", "left_out", "restriction_broken", relations.broken_restrictions);
        row("relation", "left_out", "restriction_on_red", relations.on_red);
        row("relation", "left_out", "restriction_unknown", relations.unknown_restrictions);
        row("relation", "noted", "restriction", relations.restrictions);
        row("relation", "noted", "restriction_incomplete", relations.incomplete_restrictions);
        row("relation", "noted", "restriction_off_road", relations.restrictions_off_road);
        let BackdropTally { kept, incomplete, too_small, off_file } = self.backdrop;
        if self.backdrop.read() > 0 {
            row("backdrop", "read", "", self.backdrop.read());
            row("backdrop", "kept", "", kept);
            row("backdrop", "left_out", "incomplete", incomplete);
            row("backdrop", "left_out", "missing_nodes", off_file);
            row("backdrop", "left_out", "too_small", too_small);
        }
        for (compression, &count) in &self.blobs {
            row("blob", "noted", compression, count);
        }
        row("blob", "noted", "unknown_type", self.blobs_passed_over);
        rows
    }
}

/// Data of the file's first header. Missing texts are empty.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct HeaderInfo {
    /// West, south, east, north in nanodegrees, if given.
    pub bbox_nanodegrees: Option<[i64; 4]>,
    /// Program that wrote the file.
    pub writing_program: String,
    /// Source of the data.
    pub source: String,
    /// Seconds since 1970 (UTC) up to which the data is complete, if given.
    pub replication_timestamp_s: Option<i64>,
    /// Sequence number of the replication, if given.
    pub replication_sequence: Option<i64>,
    /// Whether the file claims to be sorted by type and id. The claim is always checked.
    pub sorted: bool,
    /// Whether the file claims that ways carry the positions of their nodes.
    pub locations_on_ways: bool,
}

impl HeaderInfo {
    /// West, south, east, north in degrees, if given.
    #[must_use]
    pub fn bbox_deg(&self) -> Option<[f64; 4]> {
        self.bbox_nanodegrees.map(|sides| sides.map(|side| side as f64 * 1e-9))
    }
}

/// Counts of relations: `read = kept + (read − restrictions) + broken_restrictions + unknown_restrictions + on_red +
/// other_vehicles + exempt + superseded`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RelationTally {
    /// All relations.
    pub read: u64,
    /// Turn restrictions. Nothing else is used.
    pub restrictions: u64,
    /// Restrictions whose members do not say which turns they mean, or that are their own member.
    pub broken_restrictions: u64,
    /// Restrictions without a value that begins with `no_` or `only_`.
    pub unknown_restrictions: u64,
    /// Whole restrictions of turns at red lights.
    pub on_red: u64,
    /// Kept restrictions that lack one member, so that more than one turn may be meant.
    pub incomplete_restrictions: u64,
    /// Whole restrictions that concern only vehicles other than heavy goods vehicles.
    pub other_vehicles: u64,
    /// Whole restrictions that exempt heavy goods vehicles.
    pub exempt: u64,
    /// Whole restrictions followed by another one with the same id: the file's last one counts.
    pub superseded: u64,
    /// Whole restrictions with a `via` node that is on no kept way or not in the file.
    pub restrictions_off_road: u64,
}

impl RelationTally {
    /// Adds the counts of another block.
    pub(in crate::osm) fn add(&mut self, other: Self) {
        self.read += other.read;
        self.restrictions += other.restrictions;
        self.broken_restrictions += other.broken_restrictions;
        self.unknown_restrictions += other.unknown_restrictions;
        self.on_red += other.on_red;
        self.incomplete_restrictions += other.incomplete_restrictions;
        self.other_vehicles += other.other_vehicles;
        self.exempt += other.exempt;
        self.superseded += other.superseded;
        self.restrictions_off_road += other.restrictions_off_road;
    }

    /// Restrictions in the extract.
    #[must_use]
    pub fn kept(&self) -> u64 {
        let unread = self.broken_restrictions + self.unknown_restrictions;
        self.restrictions - unread - self.on_red - self.other_vehicles - self.exempt - self.superseded
    }
}

/// Counts of the backdrop's things: `kept + incomplete + too_small + off_file` is all that was read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BackdropTally {
    /// Things in the extract.
    pub kept: u64,
    /// Areas of which the file lacks a way or a node, or whose ways do not close.
    pub incomplete: u64,
    /// Areas that are too small to be seen on any map.
    pub too_small: u64,
    /// Lines of which the file has no two nodes in a row.
    pub off_file: u64,
}

impl BackdropTally {
    /// All things that were read.
    #[must_use]
    pub fn read(&self) -> u64 {
        self.kept + self.incomplete + self.too_small + self.off_file
    }
}
