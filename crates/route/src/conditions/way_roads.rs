//! Which edges of a way belong to one road.

use crate::network::{EdgeNo, Network, Road};

/// The number of the road of each edge of a way. A road ends where the way leaves it; the same road further on has another number.
pub(super) fn roads(network: &Network, way: &[EdgeNo]) -> Vec<usize> {
    let strokes = network.strokes_of_edges();
    let mut road = 0;
    let mut numbers = Vec::with_capacity(way.len());
    for (i, &edge) in way.iter().enumerate() {
        road += usize::from(i > 0 && !goes_on(network, &strokes, way[i - 1], edge));
        numbers.push(road);
    }
    numbers
}

/// Whether an edge belongs to the road of the edge before it: the same way, name or reference, or straight on.
pub(super) fn goes_on(network: &Network, strokes: &[u32], a: EdgeNo, b: EdgeNo) -> bool {
    let stroke = |edge: EdgeNo| strokes.get(edge.index()).filter(|&&stroke| stroke != u32::MAX);
    let road = |edge: EdgeNo| network.edges.get(edge.index()).map(|edge| network.road(edge));
    let same = |a: &Road, b: &Road| {
        let name = a.name.is_some() && a.name == b.name;
        let reference = a.reference.is_some() && a.reference == b.reference;
        a.way_id == b.way_id || (a.link == b.link && (name || reference))
    };
    road(a).zip(road(b)).is_some_and(|(a, b)| same(a, b)) || stroke(a).is_some_and(|of_a| stroke(b) == Some(of_a))
}
