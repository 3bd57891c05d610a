//! Conditions as JSON, and as a sheet to take along: the rows of a file that `netcert evidence add` reads when it is filled in.

use serde_json::{Value, json};

use super::suppositions::disc;
use super::{Condition, ConditionAt};
use crate::assemble::PartKind;
use crate::evidence::Quantity;
use crate::network::{EdgeNo, Network};
use crate::osm::{LonLat, NodeId, rounded};
use crate::rows::AttestedBy;
use crate::title::title as title_of;
use crate::words::Named as _;

/// The columns of a sheet. Those that begin with `_` are for the reader; a register of measurements ignores them.
pub const SHEET_COLUMNS: [&str; 16] = [
    "id",
    "quantity",
    "value",
    "unit",
    "sigma",
    "source",
    "date",
    "licence",
    "edge_id",
    "junction",
    "from_edge",
    "to_edge",
    "geometry",
    "_needed",
    "_assumed",
    "_title",
];

impl Condition {
    /// What has to be so, where: `Main Street into High Street`.
    #[must_use]
    pub fn title(&self, network: &Network) -> String {
        match &self.at {
            ConditionAt::Road(edges) => {
                let mut titles: Vec<String> = Vec::new();
                for title in edges.iter().map(|&edge| title_of(network, PartKind::Edge(edge))) {
                    if !titles.contains(&title) {
                        titles.push(title);
                    }
                }
                match titles.as_slice() {
                    [first, _, _, _, ..] => format!("{first} and {} more", titles.len() - 1),
                    _ => titles.join(" and "),
                }
            }
            ConditionAt::Corner { between: [from, to], .. } => {
                title_of(network, PartKind::Turn { from: *from, to: *to })
            }
            ConditionAt::Junction(node) => {
                let edges = edges_at(network, *node);
                let mut titles: Vec<String> =
                    edges.iter().map(|&edge| title_of(network, PartKind::Edge(edge))).collect();
                titles.sort();
                titles.dedup();
                titles.join(" and ")
            }
        }
    }

    /// The quantity and the least value that does, as words: `kerb radius at least 7.5 m (assumed 4.5)`.
    #[must_use]
    pub fn words(&self) -> String {
        let what = match self.quantity {
            Quantity::Surface => format!("paved and free of kerbs up to {:.0} m from the node", self.needed_m),
            quantity => format!("{} at least {:.2} m", quantity.name().replace('_', " "), self.needed_m),
        };
        self.assumed_m.map_or(what.clone(), |m| format!("{what} (assumed {m:.2})"))
    }

    /// Who says that the vehicle goes there all the same, as words. `None` if nobody does.
    #[must_use]
    pub fn attested(&self) -> Option<String> {
        self.attested_by.map(AttestedBy::words)
    }

    /// Longitude and latitude of the place, degrees.
    #[must_use]
    pub fn place(&self, network: &Network) -> Option<[f64; 2]> {
        let (lon, lat) = self.position(network)?.degrees();
        Some(rounded([lon, lat]))
    }

    /// The positions of the surface that has to be paved, degrees; the first is the last again. `None` for other conditions.
    #[must_use]
    pub fn ring(&self, network: &Network) -> Option<Vec<[f64; 2]>> {
        let ConditionAt::Junction(node) = &self.at else { return None };
        let ring = disc(node_position(network, *node)?, self.needed_m);
        Some(ring.into_iter().map(|at| rounded([at.degrees().0, at.degrees().1])).collect())
    }

    fn position(&self, network: &Network) -> Option<LonLat> {
        match &self.at {
            ConditionAt::Road(edges) => {
                let edge = network.edges.get(edges.get(edges.len() / 2)?.index())?;
                let line: Vec<LonLat> = network.positions(edge).collect();
                let middle = line.len() / 2;
                match (line.get(middle.checked_sub(1)?), line.get(middle)) {
                    (Some(a), Some(b)) if line.len().is_multiple_of(2) => Some(LonLat {
                        lon_e7: i32::midpoint(a.lon_e7, b.lon_e7),
                        lat_e7: i32::midpoint(a.lat_e7, b.lat_e7),
                    }),
                    (_, at) => at.copied(),
                }
            }
            ConditionAt::Corner { between: [from, _], .. } => {
                network.positions(network.edges.get(from.index())?).next_back()
            }
            ConditionAt::Junction(node) => node_position(network, *node),
        }
    }

    /// The members of the condition, numbered from 1.
    #[must_use]
    pub fn members(&self, network: &Network, number: usize) -> Value {
        let id = |edge: EdgeNo| network.edges.get(edge.index()).map(|edge| edge.id);
        let mut members = json!({
            "number": number,
            "kind": self.quantity.name(),
            "place": self.place(network),
            "assumed": self.assumed_m,
            "needed": self.needed_m,
            "unit": "m",
            "title": self.title(network),
            "attested": self.attested_by.map(AttestedBy::members),
        });
        match &self.at {
            ConditionAt::Road(edges) => {
                members["edge_id"] = json!(edges.first().and_then(|&edge| id(edge)));
                members["edge_ids"] = json!(edges.iter().filter_map(|&edge| id(edge)).collect::<Vec<_>>());
                members["length_m"] = json!(self.length_m(network));
            }
            ConditionAt::Corner { node, between: [from, to] } => {
                members["junction"] = json!(node);
                members["from_edge"] = json!(id(*from));
                members["to_edge"] = json!(id(*to));
            }
            ConditionAt::Junction(node) => members["junction"] = json!(node),
        }
        members
    }

    /// The rows of the sheet for this condition, in the order of [`SHEET_COLUMNS`]: one for each edge, corner or junction. What is to be
    /// filled in is empty.
    #[must_use]
    pub fn sheet(&self, network: &Network, number: usize) -> Vec<[String; 16]> {
        let id = |edge: EdgeNo| network.edges.get(edge.index()).map_or_else(String::new, |edge| edge.id.to_string());
        let row = |label: String, [edge, junction, from, to]: [String; 4], geometry: String| {
            let unit = if self.quantity == Quantity::Surface { "" } else { "m" };
            [
                label,
                self.quantity.name().to_owned(),
                String::new(),
                unit.to_owned(),
                String::new(),
                String::new(),
                String::new(),
                String::new(),
                edge,
                junction,
                from,
                to,
                geometry,
                format!("{:.2}", self.needed_m),
                self.assumed_m.map_or_else(String::new, |m| format!("{m:.2}")),
                self.title(network),
            ]
        };
        let none = String::new;
        match &self.at {
            ConditionAt::Road(edges) => {
                let one = |(i, &edge): (usize, &EdgeNo)| {
                    let label = if edges.len() > 1 { format!("{number}.{}", i + 1) } else { number.to_string() };
                    row(label, [id(edge), none(), none(), none()], none())
                };
                edges.iter().enumerate().map(one).collect()
            }
            ConditionAt::Corner { node, between: [from, to] } => {
                vec![row(number.to_string(), [none(), node.to_string(), id(*from), id(*to)], none())]
            }
            ConditionAt::Junction(node) => {
                let ring = node_position(network, *node).map(|at| disc(at, self.needed_m)).unwrap_or_default();
                let corner = |at: &LonLat| format!("{:.7} {:.7}", at.degrees().0, at.degrees().1);
                let text = ring.iter().map(corner).collect::<Vec<_>>().join(", ");
                vec![row(number.to_string(), [none(), none(), none(), none()], format!("POLYGON (({text}))"))]
            }
        }
    }
}

/// The edges that meet at a node. Where two roads meet, the network keeps no list of them.
fn edges_at(network: &Network, node: NodeId) -> Vec<EdgeNo> {
    let known = network.crossings.at(node);
    if !known.is_empty() {
        return known.to_vec();
    }
    let meets = |edge: &EdgeNo| {
        network.edges.get(edge.index()).is_some_and(|edge| edge.from_node == node || edge.to_node == node)
    };
    EdgeNo::first(network.edges.len()).filter(meets).collect()
}

fn node_position(network: &Network, node: NodeId) -> Option<LonLat> {
    let edge = edges_at(network, node).into_iter().find_map(|edge| network.edges.get(edge.index()))?;
    let mut line = network.positions(edge);
    if edge.from_node == node { line.next() } else { line.next_back() }
}
