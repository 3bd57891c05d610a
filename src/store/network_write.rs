//! Writes the network into its tables. Arrays keep their order, so that [`super::network_read`] reads the same network.

use rustc_hash::FxHashMap;
use sqlx::sqlite::SqliteConnection;

use crate::network::{Edge, Network, Road};
use crate::osm::LonLat;
use crate::osm::facts::{CrossSection, Legal, Limit, Strip};
use crate::rows::{Bounds, EdgeMeasure};
use crate::words::{Named, highway};

use super::blob;
use super::bulk::Bulk;
use super::error::content;

type Sql<T> = Result<T, sqlx::Error>;

/// Writes all tables of the network and returns the box around it. `measures` has one entry per edge, or is empty.
pub(super) async fn write(
    c: &mut SqliteConnection,
    network: &Network,
    measures: &[EdgeMeasure],
) -> Sql<Option<Bounds>> {
    if !measures.is_empty() && measures.len() != network.edges.len() {
        return Err(content(format!("{} measures for {} edges", measures.len(), network.edges.len())));
    }
    roads(c, network).await?;
    let bounds = edges(c, network, measures).await?;
    narrowings_and_strokes(c, network).await?;
    spatial_index(c, &bounds).await?;
    Ok(bounds.into_iter().reduce(Bounds::union))
}

async fn roads(c: &mut SqliteConnection, network: &Network) -> Sql<()> {
    let mut sections = Distinct::new("section", 10);
    let mut legals = Distinct::new("legal", 9);
    let mut bulk = Bulk::new("road", 16);
    for (no, road) in (1_i64..).zip(&network.roads) {
        let mut section = [0; 2];
        let mut legal = [0; 2];
        for i in 0..2 {
            section[i] = sections.number(c, section_key(&road.sections[i]), &road.sections[i], add_section).await?;
            legal[i] = legals.number(c, legal_key(&road.legal[i]), &road.legal[i], add_legal).await?;
        }
        let country = std::str::from_utf8(&road.country).map_err(|_| content("a country code is not text"))?;
        bulk.add(no)?;
        bulk.add(road.way_id)?;
        bulk.add(highway(road.class, road.link))?;
        bulk.add(road.roundabout)?;
        bulk.add(road.oneway.name())?;
        bulk.add(road.name.map(|id| network.strings.text(id)))?;
        bulk.add(road.reference.map(|id| network.strings.text(id)))?;
        bulk.add(road.lanes)?;
        bulk.add(country)?;
        bulk.add(road.left_hand_traffic)?;
        for no in section.into_iter().chain(legal) {
            bulk.add(no)?;
        }
        for limit in road.max_speed_km_h {
            bulk.add(limit)?;
        }
        bulk.end_row(c).await?;
    }
    sections.bulk.finish(c).await?;
    legals.bulk.finish(c).await?;
    bulk.finish(c).await
}

async fn edges(c: &mut SqliteConnection, network: &Network, measures: &[EdgeMeasure]) -> Sql<Vec<Bounds>> {
    let mut bulk = Bulk::new("edge", 37);
    let mut boxes = Vec::with_capacity(network.edges.len());
    let mut line = Vec::new();
    let starts = shape_starts(network)?;
    for (index, edge) in network.edges.iter().enumerate() {
        line.clear();
        line.extend(network.positions(edge));
        let (geom, bounds) = blob::encode(line.iter().copied()).ok_or_else(|| content("an edge has no shape"))?;
        boxes.push(bounds);
        let measure = measures.get(index).copied().unwrap_or_default();
        bulk.add(index as i64 + 1)?;
        bulk.add(edge.id)?;
        let road = network.road(edge);
        bulk.add(road.way_id)?;
        bulk.add(edge.from_node)?;
        bulk.add(edge.to_node)?;
        bulk.add(edge.direction.name())?;
        bulk.add(geom)?;
        bulk.add(measure.length_m.filter(|length| length.is_finite()).unwrap_or_else(|| geodesic_length_m(&line)))?;
        add_road_columns(&mut bulk, network, road, edge)?;
        bulk.add(measure.min_radius_m.filter(|radius| radius.is_finite()))?;
        bulk.add(measure.centreline_deviation_m.filter(|deviation| deviation.is_finite()))?;
        add_legal(&mut bulk, &edge.legal)?;
        bulk.add(edge.barred)?;
        bulk.add(edge.cut)?;
        bulk.add(i64::from(edge.road) + 1)?;
        bulk.add(starts[index])?;
        bulk.add(edge.narrowings.start)?;
        bulk.add(edge.narrowings.end)?;
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await?;
    Ok(boxes)
}

/// The start of each edge's shape, not counting positions that no edge uses (those of pieces that were left out). The shapes
/// must be in the order of the edges, because the edges are read one after the other by these starts.
fn shape_starts(network: &Network) -> Sql<Vec<u32>> {
    let mut used = vec![false; network.shapes.len()];
    for edge in &network.edges {
        let shape = used.get_mut(edge.shape.start as usize..edge.shape.end as usize);
        shape.ok_or_else(|| content("an edge's shape is out of range"))?.fill(true);
    }
    let before: Vec<u32> = used
        .iter()
        .scan(0, |count, &used| {
            *count += u32::from(used);
            Some(*count - u32::from(used))
        })
        .collect();
    let mut end = 0;
    let start = |edge: &Edge| {
        let start = before.get(edge.shape.start as usize).copied().filter(|&start| start <= end);
        let start = start.ok_or_else(|| content("the shapes are not in the order of the edges"))?;
        end = end.max(start + edge.shape.len() as u32);
        Ok(start)
    };
    network.edges.iter().map(start).collect()
}

/// Adds the columns of the road that users want with each edge.
fn add_road_columns(bulk: &mut Bulk, network: &Network, road: &Road, edge: &Edge) -> Sql<()> {
    bulk.add(highway(road.class, road.link))?;
    bulk.add(road.name.map(|id| network.strings.text(id)))?;
    bulk.add(road.reference.map(|id| network.strings.text(id)))?;
    bulk.add(road.oneway.name())?;
    bulk.add(road.left_hand_traffic)?;
    bulk.add(road.lanes)?;
    bulk.add(road.max_speed_km_h[edge.direction as usize])?;
    add_widths(bulk, &network.section(edge))
}

/// Adds the columns of an edge's widths.
pub(super) fn add_widths(bulk: &mut Bulk, section: &CrossSection) -> Sql<()> {
    for strip in [section.lane, section.direction, section.carriageway] {
        // People read this width, so it is rounded to millimetres. Certificates use the strip's edges in `section`.
        bulk.add(strip.map(|strip| (f64::from(strip.width_m()) * 1000.0).round() / 1000.0))?;
        bulk.add(strip.map(|strip| strip.source.name()))?;
    }
    Ok(())
}

async fn narrowings_and_strokes(c: &mut SqliteConnection, network: &Network) -> Sql<()> {
    let mut narrowings = Bulk::new("narrowing", 3);
    for (no, narrowing) in (1_i64..).zip(&network.narrowings) {
        narrowings.add(no)?;
        narrowings.add(narrowing.vertex)?;
        narrowings.add(decimal(narrowing.passage_m))?;
        narrowings.end_row(c).await?;
    }
    narrowings.finish(c).await?;
    let mut strokes = Bulk::new("stroke", 6);
    for (no, stroke) in (1_i64..).zip(&network.strokes) {
        strokes.add(no)?;
        for range in [&stroke.approach, &stroke.edges] {
            strokes.add(range.start)?;
            strokes.add(range.end)?;
        }
        strokes.add(stroke.closed)?;
        strokes.end_row(c).await?;
    }
    strokes.finish(c).await?;
    let mut stroke_edges = Bulk::new("stroke_edge", 2);
    for (no, &edge) in (1_i64..).zip(&network.stroke_edges) {
        stroke_edges.add(no)?;
        stroke_edges.add(i64::from(edge) + 1)?;
        stroke_edges.end_row(c).await?;
    }
    stroke_edges.finish(c).await
}

/// Fills the spatial index along a space-filling curve, so that neighbours share pages and pages fill one after the other.
async fn spatial_index(c: &mut SqliteConnection, boxes: &[Bounds]) -> Sql<()> {
    let mut order: Vec<(u64, u32)> = (0_u32..).zip(boxes).map(|(index, bounds)| (morton(bounds), index)).collect();
    order.sort_unstable();
    let mut bulk = Bulk::new("rtree_edge_geom", 5);
    for (_, index) in order {
        let bounds = boxes[index as usize];
        bulk.add(i64::from(index) + 1)?;
        for side in [bounds.west, bounds.east, bounds.south, bounds.north] {
            bulk.add(side)?;
        }
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await
}

/// The position of a box's middle on the Z-order curve.
fn morton(bounds: &Bounds) -> u64 {
    let spread = |degrees: f64| {
        let mut x = ((degrees + 360.0) / 720.0 * f64::from(u32::MAX)) as u64;
        for (shift, mask) in [
            (16, 0x0000_ffff_0000_ffff),
            (8, 0x00ff_00ff_00ff_00ff),
            (4, 0x0f0f_0f0f_0f0f_0f0f),
            (2, 0x3333_3333_3333_3333),
            (1, 0x5555_5555_5555_5555),
        ] {
            x = (x | x << shift) & mask;
        }
        x
    };
    spread(bounds.west + bounds.east) | spread(bounds.south + bounds.north) << 1
}

fn geodesic_length_m(line: &[LonLat]) -> f64 {
    use geo::{Geodesic, Length};
    Geodesic.length(&line.iter().map(|place| place.degrees()).collect::<geo::LineString>())
}

/// A table of distinct values that other tables refer to by number. A value is inserted when it first appears.
struct Distinct<K> {
    numbers: FxHashMap<K, i64>,
    bulk: Bulk,
}

impl<K: std::hash::Hash + Eq> Distinct<K> {
    fn new(table: &'static str, columns: usize) -> Self {
        Self { numbers: FxHashMap::default(), bulk: Bulk::new(table, columns) }
    }

    async fn number<T>(
        &mut self,
        c: &mut SqliteConnection,
        key: K,
        value: &T,
        add: fn(&mut Bulk, &T) -> Sql<()>,
    ) -> Sql<i64> {
        let next = self.numbers.len() as i64 + 1;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.bulk.add(number)?;
            add(&mut self.bulk, value)?;
            self.bulk.end_row(c).await?;
        }
        Ok(number)
    }
}

fn section_key(section: &CrossSection) -> [Option<(u32, u32, u8)>; 3] {
    [section.lane, section.direction, section.carriageway]
        .map(|strip| strip.map(|s| (s.left_m.to_bits(), s.right_m.to_bits(), s.source as u8)))
}

fn add_section(bulk: &mut Bulk, section: &CrossSection) -> Sql<()> {
    for strip in [section.lane, section.direction, section.carriageway] {
        bulk.add(strip.map(|Strip { left_m, .. }| decimal(left_m)))?;
        bulk.add(strip.map(|Strip { right_m, .. }| decimal(right_m)))?;
        bulk.add(strip.map(|Strip { source, .. }| source.name()))?;
    }
    Ok(())
}

/// An edge's limits, in the order of the columns of `legal` and `edge`, with their names in `unreadable_limits`.
fn limits(legal: &Legal) -> [(Limit, &'static str); 5] {
    [
        (legal.max_height, "max_height"),
        (legal.max_weight, "max_weight"),
        (legal.max_axle_load, "max_axle_load"),
        (legal.max_length, "max_length"),
        (legal.max_width, "max_width"),
    ]
}

fn legal_key(legal: &Legal) -> ([(u8, u32); 5], u8, u8) {
    let key = |limit| match limit {
        Limit::None => (0, 0),
        Limit::At(value) => (1, value.to_bits()),
        Limit::Unreadable => (2, 0),
    };
    (limits(legal).map(|(limit, _)| key(limit)), legal.hgv as u8, legal.motor_vehicle as u8)
}

fn add_legal(bulk: &mut Bulk, legal: &Legal) -> Sql<()> {
    let limits = limits(legal);
    for (limit, _) in limits {
        bulk.add(if let Limit::At(value) = limit { Some(decimal(value)) } else { None })?;
    }
    let unreadable: Vec<_> = limits.iter().filter(|(limit, _)| *limit == Limit::Unreadable).map(|row| row.1).collect();
    bulk.add((!unreadable.is_empty()).then(|| unreadable.join(",")))?;
    bulk.add(legal.hgv.name())?;
    bulk.add(legal.motor_vehicle.name())
}

/// The shortest decimal of a single-precision value, such as 3.8 and not 3.799999952. It converts back to the same bits; if it
/// does not, the exact value is returned.
fn decimal(value: f32) -> f64 {
    let exact = f64::from(value);
    value.to_string().parse().ok().filter(|&short: &f64| short as f32 == value).unwrap_or(exact)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_decimal_comes_back_to_the_same_bits(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!((decimal(value) as f32).to_bits(), bits);
        }
    }

    #[test]
    fn a_decimal_reads_as_it_was_written() {
        assert!([3.8_f32, 4.3, 2.55, 44.0, 0.1].map(decimal) == [3.8, 4.3, 2.55, 44.0, 0.1]);
    }
}
