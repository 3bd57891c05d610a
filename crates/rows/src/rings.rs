//! Finds the edges of a passage. The database names only the first and the last one: of a roundabout the arcs between follow from
//! the ring, and a complex has at most two edges inside.

use netcert_roads::network::EdgeNo;
use rustc_hash::FxHashMap;

/// All roundabouts.
#[derive(Debug, Clone, Default)]
pub struct Rings {
    rings: Vec<Vec<EdgeNo>>,
    /// By arc: the index of its ring, and its index on the ring.
    at: FxHashMap<EdgeNo, (usize, usize)>,
}

impl Rings {
    /// Indexes the rings of turns as a database has them.
    pub fn new(rings: Vec<Vec<EdgeNo>>) -> Self {
        let places = rings
            .iter()
            .enumerate()
            .flat_map(|(ring, arcs)| arcs.iter().enumerate().map(move |(place, &arc)| (arc, (ring, place))));
        Self { at: places.collect(), rings }
    }

    /// The edges from the first to the last in driving order. `None` if only one of them is on a ring, or they are on two.
    pub fn through(&self, [first, last]: [EdgeNo; 2]) -> Option<Vec<EdgeNo>> {
        let (&(ring, from), &(same, to)) = match (self.at.get(&first), self.at.get(&last)) {
            (None, None) if first == last => return Some(vec![first]),
            (None, None) => return Some(vec![first, last]),
            (a, b) => (a?, b?),
        };
        let arcs = self.rings.get(ring).filter(|_| ring == same)?;
        let count = if to >= from { to - from + 1 } else { arcs.len() - from + to + 1 };
        Some(arcs.iter().cycle().skip(from).take(count).copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges<const N: usize>(numbers: [u32; N]) -> [EdgeNo; N] {
        numbers.map(EdgeNo::new)
    }

    #[test]
    fn arcs_go_round_and_past_where_the_ring_begins() {
        let rings = Rings::new(vec![edges([7, 8, 9]).to_vec(), edges([3]).to_vec()]);
        assert_eq!(rings.through(edges([7, 8])), Some(edges([7, 8]).to_vec()));
        assert_eq!(rings.through(edges([9, 7])), Some(edges([9, 7]).to_vec()));
        assert_eq!(rings.through(edges([3, 3])), Some(edges([3]).to_vec()));
        assert_eq!(rings.through(edges([7, 3])), None);
        assert_eq!(rings.through(edges([7, 4])), None);
    }

    #[test]
    fn edges_inside_a_complex_are_those_that_are_named() {
        let rings = Rings::new(vec![edges([7, 8, 9]).to_vec()]);
        assert_eq!(rings.through(edges([4, 4])), Some(edges([4]).to_vec()));
        assert_eq!(rings.through(edges([4, 5])), Some(edges([4, 5]).to_vec()));
    }
}
