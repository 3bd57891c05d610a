//! The account of network building. Every way read either gives edges or is left out for a counted reason. Every
//! direction of every piece of road is either an edge or not driven. The counts add up.

use super::Edge;
use super::cut::Unusable;
use super::restrictions::RuleReading;
use crate::account::AccountRow;

/// Counts of a run. `ways_read = ways_kept + Σ left out` and `directions = edges + not_driven`; areas add up likewise.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NetworkAccount {
    /// Ways read.
    pub ways_read: u64,
    /// Ways with edges.
    pub ways_kept: u64,
    /// Ways left out: the file has none of their nodes.
    pub no_node_in_file: u64,
    /// Ways left out: the file has some of their nodes, but no two consecutive ones.
    pub nodes_apart: u64,
    /// Ways left out: all nodes are at one place.
    pub one_place: u64,
    /// Ways at places of no known country. Their driving side is assumed.
    pub no_country: u64,
    /// Node references without a node in the file.
    pub missing_references: u64,
    /// Nodes merged with a neighbour at the same place.
    pub same_place_nodes: u64,
    /// Directions of all pieces of road between two cuts, two per piece.
    pub directions: u64,
    /// Directed edges made.
    pub edges: u64,
    /// Directions that the tags do not allow.
    pub not_driven: u64,
    /// Edges with a missing node at their start or end.
    pub cut_edges: u64,
    /// Edges barred by a barrier on them or at their ends.
    pub barred_edges: u64,
    /// Edges with a narrow place.
    pub narrowed_edges: u64,
    /// Edges with limits from a node.
    pub node_limited_edges: u64,
    /// Edges whose id another edge already had.
    pub id_collisions: u64,
    /// Strokes made.
    pub strokes: u64,
    /// Strokes that continue into their own first edge.
    pub closed_strokes: u64,
    /// Strokes that begin because the previous one became too long.
    pub strokes_split: u64,
    /// Strokes that begin where a road comes into another cell.
    pub strokes_split_at_cells: u64,
    /// Open strokes with an approach.
    pub strokes_with_approach: u64,
    /// Nodes with too many edges for any of them to be called straight on.
    pub crowded_nodes: u64,
    /// Mapped surfaces and islands read.
    pub areas_read: u64,
    /// Surfaces at junctions, and islands near roads.
    pub areas_kept: u64,
    /// Islands among them.
    pub islands_kept: u64,
    /// Islands that lack nodes, cross themselves or have very many corners, taken as the convex hull of the nodes there are.
    pub islands_widened: u64,
    /// Areas left out: the file lacks some of their nodes.
    pub areas_cut: u64,
    /// Areas left out: the ring crosses itself, encloses nothing, or has more corners than any real one.
    pub areas_invalid: u64,
    /// Turn restrictions read: `= restrictions_kept + off_network + without_effect`.
    pub restrictions_read: u64,
    /// Restrictions that forbid a movement of this network.
    pub restrictions_kept: u64,
    /// Restrictions left out: no vehicle can drive their members one after the other.
    pub restrictions_off_network: u64,
    /// Restrictions left out: they forbid nothing that could be driven.
    pub restrictions_without_effect: u64,
    /// Restrictions kept of which the value's side decides which turn is meant.
    pub restrictions_by_side: u64,
    /// Restrictions kept that forbid every turn that may be meant, because the side does not decide.
    pub restrictions_any_side: u64,
    /// Restrictions kept with a member that reaches the turn only over the rest of its road.
    pub restrictions_beyond_split: u64,
    /// Restrictions kept whose `via` is missing or in another order.
    pub restrictions_via_found: u64,
    /// Restrictions `only_…` kept that forbid every way on, because the one that they allow is not on the network.
    pub restrictions_no_destination: u64,
    /// Restrictions `only_…` off the network: nobody knows where they hold.
    pub only_not_placed: u64,
    /// Sequences of edges that restrictions forbid.
    pub forbidden_sequences: u64,
    /// Forbidden sequences with an undecided condition.
    pub conditional_sequences: u64,
    /// Forbidden sequences of more than two edges.
    pub long_sequences: u64,
}

impl NetworkAccount {
    pub(super) fn leave_out(&mut self, why: Unusable) {
        match why {
            Unusable::NoNodeInFile => self.no_node_in_file += 1,
            Unusable::NodesApart => self.nodes_apart += 1,
            Unusable::OnePlace => self.one_place += 1,
        }
    }

    /// Counts a new edge. `limited` says whether a node's tags limit it.
    pub(super) fn count_edge(&mut self, edge: &Edge, limited: bool) {
        self.edges += 1;
        self.cut_edges += u64::from(edge.cut);
        self.barred_edges += u64::from(edge.barred);
        self.narrowed_edges += u64::from(!edge.narrowings.is_empty());
        self.node_limited_edges += u64::from(limited);
    }

    /// Counts a restriction. `forbids` says how it was read, if it forbids anything.
    pub(super) fn count_restriction(&mut self, on_network: bool, only: bool, forbids: Option<&RuleReading>) {
        match (on_network, forbids) {
            (_, Some(reading)) => {
                self.restrictions_kept += 1;
                self.restrictions_by_side += u64::from(reading.by_side);
                self.restrictions_any_side += u64::from(reading.any_side);
                self.restrictions_beyond_split += u64::from(reading.beyond_split);
                self.restrictions_via_found += u64::from(reading.via_found);
                self.restrictions_no_destination += u64::from(reading.no_destination);
            }
            (true, None) => self.restrictions_without_effect += 1,
            (false, None) => {
                self.restrictions_off_network += 1;
                self.only_not_placed += u64::from(only);
            }
        }
    }

    /// Adds the counts of a part of the ways.
    pub(super) fn add_part(&mut self, part: &Self) {
        self.ways_read += part.ways_read;
        self.ways_kept += part.ways_kept;
        self.no_node_in_file += part.no_node_in_file;
        self.nodes_apart += part.nodes_apart;
        self.one_place += part.one_place;
        self.no_country += part.no_country;
        self.directions += part.directions;
        self.edges += part.edges;
        self.not_driven += part.not_driven;
        self.cut_edges += part.cut_edges;
        self.barred_edges += part.barred_edges;
        self.narrowed_edges += part.narrowed_edges;
        self.node_limited_edges += part.node_limited_edges;
    }

    /// The account's rows of stage `network`. Edges are counted against both directions of every piece.
    #[must_use]
    pub fn rows(&self) -> Vec<AccountRow> {
        [
            ("way", "read", "", self.ways_read),
            ("way", "kept", "", self.ways_kept),
            ("way", "left_out", "no_node_in_file", self.no_node_in_file),
            ("way", "left_out", "nodes_apart", self.nodes_apart),
            ("way", "left_out", "one_place", self.one_place),
            ("way", "noted", "country_unknown", self.no_country),
            ("node", "noted", "missing_reference", self.missing_references),
            ("node", "noted", "same_place_merged", self.same_place_nodes),
            ("node", "noted", "crowded", self.crowded_nodes),
            ("edge", "read", "", self.directions),
            ("edge", "kept", "", self.edges),
            ("edge", "left_out", "oneway", self.not_driven),
            ("edge", "noted", "cut", self.cut_edges),
            ("edge", "noted", "barred", self.barred_edges),
            ("edge", "noted", "narrowed", self.narrowed_edges),
            ("edge", "noted", "limited_by_node", self.node_limited_edges),
            ("edge", "noted", "id_collision", self.id_collisions),
            ("stroke", "read", "", self.strokes),
            ("stroke", "noted", "closed", self.closed_strokes),
            ("stroke", "noted", "split_by_length", self.strokes_split),
            ("stroke", "noted", "split_at_cell", self.strokes_split_at_cells),
            ("stroke", "noted", "with_approach", self.strokes_with_approach),
            ("area", "read", "", self.areas_read),
            ("area", "kept", "", self.areas_kept),
            ("area", "left_out", "missing_node", self.areas_cut),
            ("area", "left_out", "invalid", self.areas_invalid),
            ("area", "noted", "island", self.islands_kept),
            ("area", "noted", "island_widened", self.islands_widened),
            (
                "area",
                "left_out",
                "no_junction",
                self.areas_read - self.areas_kept - self.areas_cut - self.areas_invalid,
            ),
            ("restriction", "read", "", self.restrictions_read),
            ("restriction", "kept", "", self.restrictions_kept),
            ("restriction", "left_out", "off_network", self.restrictions_off_network),
            ("restriction", "left_out", "without_effect", self.restrictions_without_effect),
            ("restriction", "noted", "by_side", self.restrictions_by_side),
            ("restriction", "noted", "any_side", self.restrictions_any_side),
            ("restriction", "noted", "beyond_split", self.restrictions_beyond_split),
            ("restriction", "noted", "via_found", self.restrictions_via_found),
            ("restriction", "noted", "only_without_destination", self.restrictions_no_destination),
            ("restriction", "noted", "only_not_placed", self.only_not_placed),
            ("restriction", "noted", "forbidden_sequence", self.forbidden_sequences),
            ("restriction", "noted", "conditional_sequence", self.conditional_sequences),
            ("restriction", "noted", "sequence_over_ways", self.long_sequences),
        ]
        .into_iter()
        .map(|(item, outcome, reason, count)| AccountRow::new("network", item, outcome, reason, count))
        .collect()
    }
}
