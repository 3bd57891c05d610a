//! Passages: movements over a junction that the map draws as several nodes. They enter by one edge, pass the edges inside, and
//! leave by another edge. Their certificate covers the whole way, because a long vehicle stands on several of the nodes at once.
//!
//! There are two kinds: over the arcs of a roundabout (`roundabouts`), and over the short edges inside a complex (`complexes`).

use rustc_hash::FxHashMap;

use super::{EdgeNo, Network};

/// The junction that a passage leads over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum PassageKind {
    /// A roundabout. The edges between are its arcs.
    Roundabout,
    /// A complex. The edges between lie inside it.
    Complex,
}

impl PassageKind {
    /// Name in the database and in answers.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Roundabout => "roundabout",
            Self::Complex => "complex",
        }
    }
}

/// One passage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Passage {
    /// The edge before the junction. It ends at the junction's first node.
    pub from: EdgeNo,
    /// The edge after the junction. It starts at the junction's last node.
    pub to: EdgeNo,
    /// The edges between in driving order: at least one. Of a roundabout, less than the whole ring.
    pub through: Vec<EdgeNo>,
    /// A restriction that forbids any step of the passage (index into [`Network::restrictions`]).
    pub forbidden: Option<u32>,
}

impl Network {
    /// All passages, by the edge before them and the edge after them.
    #[must_use]
    pub fn passages(&self) -> Vec<Passage> {
        let bans = Bans::of(self);
        let mut ways: Vec<_> = self.over_rings().into_iter().chain(self.over_complexes()).collect();
        ways.sort_by(|a, b| (a.0, a.2, &a.1).cmp(&(b.0, b.2, &b.1)));
        let passage = |(from, through, to): (EdgeNo, Vec<EdgeNo>, EdgeNo)| {
            let forbidden = bans.first(self, from, &through, to);
            Passage { from, to, through, forbidden }
        };
        ways.into_iter().map(passage).collect()
    }

    /// The kind of a passage over these edges. `None` if there are none.
    #[must_use]
    pub fn passage_kind(&self, through: &[EdgeNo]) -> Option<PassageKind> {
        let edge = self.edges.get(through.first()?.index())?;
        Some(if self.road(edge).roundabout { PassageKind::Roundabout } else { PassageKind::Complex })
    }
}

/// Restrictions by their first edge.
struct Bans(FxHashMap<EdgeNo, Vec<u32>>);

impl Bans {
    fn of(network: &Network) -> Self {
        let mut bans: FxHashMap<EdgeNo, Vec<u32>> = FxHashMap::default();
        for (no, restriction) in (0_u32..).zip(&network.restrictions) {
            if let Some(&first) = network.sequence(restriction).first() {
                bans.entry(first).or_default().push(no);
            }
        }
        Self(bans)
    }

    /// The first restriction that forbids a step of a way.
    fn first(&self, network: &Network, from: EdgeNo, through: &[EdgeNo], to: EdgeNo) -> Option<u32> {
        let way: Vec<EdgeNo> = std::iter::once(from).chain(through.iter().copied()).chain([to]).collect();
        let holds = |at: usize, no: u32| {
            network.restrictions.get(no as usize).is_some_and(|ban| way[at..].starts_with(network.sequence(ban)))
        };
        (0..way.len()).find_map(|at| self.0.get(&way[at])?.iter().copied().find(|&no| holds(at, no)))
    }
}
