//! A road network drawn in characters becomes an extract, and a network is printed in the same characters.
//!
//! Every letter or digit is a node whose id is its character code; everything else is decoration. A column is `metres`
//! wide and a row equally high; north is up. Ways are named by their nodes in order and tagged as in OpenStreetMap.

use netcert::network::{Edge, EdgeNo, Network, NetworkAccount, build};
use netcert::osm::facts::{self, CrossSection, Jurisdiction, PointFacts, WayFacts};
use netcert::osm::{Extract, LonLat, NodeId, NodeTable, Restriction, RoadArea, StringPool, Via, Way};

/// Position of the upper left corner of a drawing.
const ORIGIN: LonLat = LonLat { lon_e7: 80_000_000, lat_e7: 490_000_000 };

/// A drawing with its ways, and the nodes that the file lacks.
#[derive(Debug, Clone, Default)]
pub struct AsciiMap {
    nodes: Vec<(char, LonLat)>,
    missing: Vec<char>,
    ways: Vec<(i64, String, String)>,
    points: Vec<(char, PointFacts)>,
    restrictions: Vec<Restriction>,
    areas: Vec<(String, Vec<LonLat>)>,
}

/// Ids of an area's way and nodes count from here.
const AREAS: i64 = 1 << 40;

impl AsciiMap {
    /// The nodes of a drawing.
    pub fn drawn(metres: f64, drawing: &str) -> Self {
        let mut nodes = Vec::new();
        for (row, line) in drawing.lines().enumerate() {
            for (column, c) in line.chars().enumerate().filter(|(_, c)| c.is_alphanumeric()) {
                assert!(nodes.iter().all(|&(other, _)| other != c), "{c} is drawn twice");
                nodes.push((c, offset(ORIGIN, column as f64 * metres, -(row as f64) * metres)));
            }
        }
        Self { nodes, ..Self::default() }
    }

    /// Nodes at the given metres east and north, for places off the grid of characters.
    pub fn placed(nodes: &[(char, [f64; 2])]) -> Self {
        let node = |&(c, [east_m, north_m]): &(char, [f64; 2])| (c, offset(ORIGIN, east_m, north_m));
        Self { nodes: nodes.iter().map(node).collect(), ..Self::default() }
    }

    /// Adds a way through these nodes. Ids count from 1.
    pub fn way(self, nodes: &str, tags: &str) -> Self {
        let id = self.ways.len() as i64 + 1;
        self.way_of_id(id, nodes, tags)
    }

    /// Adds a way with this id.
    pub fn way_of_id(mut self, id: i64, nodes: &str, tags: &str) -> Self {
        self.ways.push((id, nodes.to_owned(), tags.to_owned()));
        self
    }

    /// Removes a way.
    pub fn without_way(mut self, id: i64) -> Self {
        self.ways.retain(|way| way.0 != id);
        self
    }

    /// Removes a node from the file, although ways name it.
    pub fn missing(mut self, node: char) -> Self {
        self.missing.push(node);
        self
    }

    /// Puts `node` at the place of `other`.
    pub fn same_place(mut self, node: char, other: char) -> Self {
        let at = self.nodes.iter().find(|n| n.0 == other).unwrap_or_else(|| panic!("{other} is not drawn")).1;
        self.nodes.retain(|n| n.0 != node);
        self.nodes.push((node, at));
        self
    }

    /// Sets the facts of a tagged node.
    pub fn point(mut self, node: char, facts: PointFacts) -> Self {
        self.points.push((node, facts));
        self
    }

    /// Adds a turn restriction with these tags (`type=restriction` by default). Ids count from 1.
    pub fn restriction(mut self, from: &[i64], via: Via, to: &[i64], tags: &str) -> Self {
        let mut pairs: Vec<_> = tags.split_whitespace().filter_map(|tag| tag.split_once('=')).collect();
        if pairs.iter().all(|tag| tag.0 != "type") {
            pairs.push(("type", "restriction"));
        }
        let rules = facts::turn_rules(&pairs).expect("a restriction").expect("for heavy goods vehicles");
        let id = self.restrictions.len() as i64 + 1;
        self.restrictions.push(Restriction { id, rules, from: from.to_vec(), via, to: to.to_vec() });
        self
    }

    /// Adds a closed way through places given in metres east and north of a node. Its last reference equals the first.
    pub fn area(mut self, node: char, corners: &[[f64; 2]], tags: &str) -> Self {
        let at = self.nodes.iter().find(|n| n.0 == node).unwrap_or_else(|| panic!("{node} is not drawn")).1;
        let ring = corners.iter().map(|&[east_m, north_m]| offset(at, east_m, north_m)).collect();
        self.areas.push((tags.to_owned(), ring));
        self
    }

    /// The extract that reading a file of this map would give.
    pub fn extract(&self) -> Extract {
        let mut extract = Extract::default();
        let mut ways = self.ways.clone();
        ways.sort();
        for (id, nodes, tags) in ways {
            let start = extract.refs.len() as u32;
            extract.refs.extend(nodes.chars().map(id_of));
            let refs = start..extract.refs.len() as u32;
            let facts = way_facts(&tags, &mut extract.strings);
            extract.ways.push(Way { id, refs, facts });
        }
        let mut ids = extract.refs.clone();
        ids.sort_unstable();
        ids.dedup();
        let places = ids.iter().map(|&id| self.place(id)).collect();
        extract.nodes = NodeTable { ids, places };
        self.add_areas(&mut extract);
        extract.points = self.points.iter().map(|(node, facts)| (id_of(*node), facts.clone())).collect();
        extract.points.sort_by_key(|point| point.0);
        extract.restrictions.clone_from(&self.restrictions);
        extract
    }

    fn add_areas(&self, extract: &mut Extract) {
        for (id, (tags, ring)) in (AREAS..).zip(&self.areas) {
            let pairs: Vec<_> = tags.split_whitespace().filter_map(|tag| tag.split_once('=')).collect();
            let kind = facts::area_kind(&pairs).unwrap_or_else(|| panic!("{tags} is no area"));
            let mut refs: Vec<NodeId> = (0..).zip(ring).map(|(i, _)| NodeId::new(1000 * id + i)).collect();
            extract.nodes.ids.extend(&refs);
            extract.nodes.places.extend(ring.iter().copied().map(Some));
            refs.extend(refs.first().copied());
            extract.areas.push(RoadArea { id, kind, refs });
        }
    }

    fn place(&self, id: NodeId) -> Option<LonLat> {
        let (c, place) =
            *self.nodes.iter().find(|n| id_of(n.0) == id).unwrap_or_else(|| panic!("node {id} is not drawn"));
        (!self.missing.contains(&c)).then_some(place)
    }
}

/// The id of a drawn node.
pub fn id_of(node: char) -> NodeId {
    NodeId::new(i64::from(u32::from(node)))
}

/// The drawn node with an id.
pub fn node_of(id: NodeId) -> char {
    u32::try_from(id.get()).ok().and_then(char::from_u32).unwrap_or('?')
}

/// The place east and north of another one, accurate enough for a drawing.
pub fn offset(from: LonLat, east_m: f64, north_m: f64) -> LonLat {
    const DEGREE_M: f64 = 111_195.0;
    let cos = from.degrees().1.to_radians().cos();
    LonLat {
        lon_e7: from.lon_e7 + (east_m / (DEGREE_M * cos) * 1e7).round() as i32,
        lat_e7: from.lat_e7 + (north_m / DEGREE_M * 1e7).round() as i32,
    }
}

/// Facts of a way with these tags, written `key=value` and separated by spaces.
pub fn way_facts(tags: &str, strings: &mut StringPool) -> WayFacts {
    let tags: Vec<_> = tags.split_whitespace().filter_map(|tag| tag.split_once('=')).collect();
    let draft = facts::way_facts(&tags).unwrap_or_else(|why| panic!("{tags:?} is no road: {why}"));
    let name = draft.name.map(|name| strings.intern(name));
    let reference = draft.reference.map(|name| strings.intern(name));
    let mut facts = draft.facts;
    (facts.name, facts.reference) = (name, reference);
    facts
}

/// The same country everywhere.
pub fn somewhere(_: LonLat) -> Jurisdiction {
    Jurisdiction { country: *b"DE", left_hand_traffic: false }
}

/// No road has a width.
pub fn no_sections(_: &WayFacts, _: &Jurisdiction, _: Option<f64>) -> [CrossSection; 2] {
    [CrossSection { lane: None, direction: None, carriageway: None }; 2]
}

/// The network of a map in one country, without widths.
pub fn built(map: &AsciiMap) -> (Network, NetworkAccount) {
    build(map.extract(), &somewhere, &no_sections)
}

/// The edge from one drawn node to another, `AB`.
pub fn edge(network: &Network, ends: &str) -> EdgeNo {
    let ends: Vec<NodeId> = ends.chars().map(id_of).collect();
    let found = network.numbered_edges().find(|(_, e)| [e.from_node, e.to_node] == ends[..]);
    found.unwrap_or_else(|| panic!("no edge {ends:?}")).0
}

/// All edges in order: `AB` from A to B, followed by `!` if barred and `~` if cut.
pub fn edges(network: &Network) -> String {
    let edge = |e: &Edge| {
        let mut text = ends(e);
        text.extend(e.barred.then_some('!'));
        text.extend(e.cut.then_some('~'));
        text
    };
    network.edges.iter().map(edge).collect::<Vec<_>>().join(" ")
}

fn ends(edge: &Edge) -> String {
    [edge.from_node, edge.to_node].into_iter().map(node_of).collect()
}

/// All strokes in order, one per line: their nodes in driving order, with the approach's nodes before `>`, and `@`
/// after a closed stroke.
pub fn strokes(network: &Network) -> String {
    let nodes = |range: std::ops::Range<u32>| {
        let edges = network.stroke_edges[range.start as usize..range.end as usize].iter();
        let ends: Vec<String> = edges.map(|&e| ends(&network.edges[e.index()])).collect();
        let first = ends.first().map_or("", |e| &e[..1]).to_owned();
        first + ends.iter().map(|e| &e[1..]).collect::<String>().as_str()
    };
    let stroke = |s: &netcert::network::Stroke| {
        let approach = if s.approach.is_empty() {
            String::new()
        } else {
            let nodes = nodes(s.approach.clone());
            nodes[..nodes.len() - 1].to_owned() + ">"
        };
        approach + nodes(s.edges.clone()).as_str() + if s.closed { "@" } else { "" }
    };
    network.strokes.iter().map(stroke).collect::<Vec<_>>().join(" ")
}
