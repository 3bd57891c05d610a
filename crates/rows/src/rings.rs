//! Finds the edges of a passage. The database names only the first and the last one: of a roundabout the arcs between follow from
//! the ring, and a complex has at most two edges inside.

use rustc_hash::FxHashMap;

/// All roundabouts.
#[derive(Debug, Clone, Default)]
pub struct Rings {
    rings: Vec<Vec<u32>>,
    /// By arc: the index of its ring, and its index on the ring.
    at: FxHashMap<u32, (usize, usize)>,
}

impl Rings {
    /// Indexes the rings of turns as a database has them.
    pub fn new(rings: Vec<Vec<u32>>) -> Self {
        let places = rings
            .iter()
            .enumerate()
            .flat_map(|(ring, arcs)| arcs.iter().enumerate().map(move |(place, &arc)| (arc, (ring, place))));
        Self { at: places.collect(), rings }
    }

    /// The edges from the first to the last in driving order. `None` if only one of them is on a ring, or they are on two.
    pub fn through(&self, [first, last]: [u32; 2]) -> Option<Vec<u32>> {
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

    #[test]
    fn arcs_go_round_and_past_where_the_ring_begins() {
        let rings = Rings::new(vec![vec![7, 8, 9], vec![3]]);
        assert_eq!(rings.through([7, 8]), Some(vec![7, 8]));
        assert_eq!(rings.through([9, 7]), Some(vec![9, 7]));
        assert_eq!(rings.through([3, 3]), Some(vec![3]));
        assert_eq!(rings.through([7, 3]), None);
        assert_eq!(rings.through([7, 4]), None);
    }

    #[test]
    fn edges_inside_a_complex_are_those_that_are_named() {
        let rings = Rings::new(vec![vec![7, 8, 9]]);
        assert_eq!(rings.through([4, 4]), Some(vec![4]));
        assert_eq!(rings.through([4, 5]), Some(vec![4, 5]));
    }
}
