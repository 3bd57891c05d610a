//! Writes the network into its tables. Arrays keep their order, so that [`crate::roads::network_read`] reads the same network.

use std::io;
use std::ops::Range;
use std::path::Path;

use rustc_hash::FxHashMap;

use crate::network::{Edge, EdgeNo};
use crate::osm::LonLat;
use crate::osm::facts::highway;
use crate::osm::facts::{CrossSection, Direction, Legal, Limit, RuleSet, Strip};
use crate::words::Named;
use netcert_rows::Bounds;

use crate::error::content;
use crate::file::blob;
use crate::file::bulk::{Bulk, Takes};
use crate::file::companions::sorter;
use crate::roads::network_rows::{MapEdgeRow, NetworkRows, RoadRow, StrokeRow};
use netcert_files::sorter::{Sorted, Sorter};

type Sql<T> = Result<T, sqlx::Error>;

/// The network as it was written.
pub(crate) struct Written {
    /// Number of edges.
    pub(crate) edges: u32,
    /// The box around all edges.
    pub(crate) bounds: Option<Bounds>,
}

/// Writes all tables of the network except those of restrictions and areas. A temporary file is made beside `path`.
pub(crate) async fn write(
    to: &mut impl Takes,
    NetworkRows { roads, edges, strokes }: NetworkRows,
    path: &Path,
) -> Sql<Written> {
    let mut boxes = sorter(path, "-boxes")?;
    let written = roads_and_edges(to, roads.sorted()?, edges.sorted()?, &mut boxes).await?;
    write_strokes(to, strokes.sorted()?.map(|row| row.map(|(_, row)| row))).await?;
    spatial_index(to, boxes.sorted()?).await?;
    Ok(written)
}

/// Writes the table of roads, with their sections and limits.
pub(crate) struct RoadWriter {
    sections: Distinct<[Option<(u32, u32, u8)>; 3]>,
    legals: Distinct<LegalKey>,
    bulk: Bulk,
}

impl RoadWriter {
    pub(crate) fn new() -> Self {
        let (sections, legals) = (Distinct::new("section", 10), Distinct::new("legal", 11));
        Self { sections, legals, bulk: Bulk::new("road", 17) }
    }

    /// Writes the next road.
    pub(crate) async fn write(&mut self, to: &mut impl Takes, no: u32, row: &RoadRow) -> Sql<()> {
        let road = &row.road;
        let mut section = [0; 2];
        let mut legal = [0; 2];
        for i in 0..2 {
            section[i] =
                self.sections.number(to, section_key(&road.sections[i]), &road.sections[i], add_section).await?;
            legal[i] = self.legals.number(to, legal_key(&road.legal[i]), &road.legal[i], add_legal).await?;
        }
        let country = std::str::from_utf8(&road.country).map_err(|_| content("a country code is not text"))?;
        let bulk = &mut self.bulk;
        bulk.add(i64::from(no) + 1);
        bulk.add(road.way_id);
        bulk.add(highway(road.class, road.link));
        bulk.add(road.roundabout);
        bulk.add(road.oneway.name());
        bulk.add(row.name.as_deref());
        bulk.add(row.reference.as_deref());
        bulk.add(road.lanes);
        bulk.add(country);
        bulk.add(road.left_hand_traffic);
        for no in section.into_iter().chain(legal) {
            bulk.add(no);
        }
        for limit in road.max_speed_km_h {
            bulk.add(limit);
        }
        bulk.add(road.width_tags.as_deref());
        bulk.end_row(to).await
    }

    pub(crate) async fn finish(self, to: &mut impl Takes) -> Sql<()> {
        self.sections.bulk.finish(to).await?;
        self.legals.bulk.finish(to).await?;
        self.bulk.finish(to).await
    }
}

/// Where an edge's positions and narrow places are, among those of all edges. Both directions of a piece of road share theirs, and a piece
/// shares its first position with the piece before. Positions that no edge uses do not count.
#[derive(Clone, Default)]
pub(crate) struct Ranges {
    road: Option<u32>,
    place: u32,
    pub(crate) shape: Range<u32>,
    pub(crate) narrowings: Range<u32>,
    /// End of all positions.
    end: u32,
}

impl Ranges {
    /// Goes on to the next edge. Returns whether its piece of road is a new one.
    pub(crate) fn next(&mut self, row: &MapEdgeRow) -> bool {
        let same_road = self.road == Some(row.road);
        if same_road && row.place == self.place {
            return false;
        }
        let start =
            if same_road { (self.shape.start + row.place.saturating_sub(self.place)).min(self.end) } else { self.end };
        self.shape = start..start + row.shape.len() as u32;
        self.end = self.end.max(self.shape.end);
        self.narrowings = self.narrowings.end..self.narrowings.end + row.narrowings.len() as u32;
        (self.road, self.place) = (Some(row.road), row.place);
        true
    }
}

async fn roads_and_edges(
    to: &mut impl Takes,
    mut roads: Sorted<u32, RoadRow>,
    edges: Sorted<EdgeNo, MapEdgeRow>,
    boxes: &mut Sorter<(u64, EdgeNo), Bounds>,
) -> Sql<Written> {
    let mut of_roads = RoadWriter::new();
    let mut current: Option<(u32, RoadRow)> = None;
    let mut bulk = Bulk::new("edge", 41);
    let mut narrowings = Narrowings::new();
    let mut ranges = Ranges::default();
    let mut written = Written { edges: 0, bounds: None };
    for row in edges {
        let (index, row) = row?;
        if index.get() != written.edges {
            return Err(content(format!("edge {} is missing or there twice", written.edges)));
        }
        written.edges += 1;
        if ranges.next(&row) {
            narrowings.write(to, &ranges, &row).await?;
        }
        while current.as_ref().is_none_or(|(no, _)| *no != row.road) {
            let (no, road) = roads.next().ok_or_else(|| content(format!("road {} is missing", row.road)))??;
            of_roads.write(to, no, &road).await?;
            current = Some((no, road));
        }
        let (_, road) = current.as_ref().ok_or_else(|| content("a road is missing"))?;
        let bounds = write_edge(to, &mut bulk, index, row, road, &ranges).await?;
        boxes.push((morton(&bounds), index), &bounds)?;
        written.bounds = Some(written.bounds.map_or(bounds, |all| all.union(bounds)));
    }
    of_roads.finish(to).await?;
    bulk.finish(to).await?;
    narrowings.finish(to).await?;
    Ok(written)
}

/// Writes the table of narrow places.
pub(crate) struct Narrowings(Bulk);

impl Narrowings {
    pub(crate) fn new() -> Self {
        Self(Bulk::new("narrowing", 3))
    }

    /// Writes those of an edge whose piece of road is a new one.
    pub(crate) async fn write(&mut self, to: &mut impl Takes, ranges: &Ranges, row: &MapEdgeRow) -> Sql<()> {
        for (no, narrowing) in (i64::from(ranges.narrowings.start) + 1..).zip(&row.narrowings) {
            self.0.add(no);
            self.0.add(narrowing.vertex);
            self.0.add(decimal(narrowing.passage_m));
            self.0.end_row(to).await?;
        }
        Ok(())
    }

    pub(crate) async fn finish(self, to: &mut impl Takes) -> Sql<()> {
        self.0.finish(to).await
    }
}

/// Writes the row of an edge with this number in the whole network, and returns the box around it. `bulk` collects rows of the table `edge`;
/// `road` and `ranges` are those of the edge.
pub(crate) async fn write_edge(
    to: &mut impl Takes,
    bulk: &mut Bulk,
    index: EdgeNo,
    row: MapEdgeRow,
    road: &RoadRow,
    ranges: &Ranges,
) -> Sql<Bounds> {
    let MapEdgeRow { edge, mut shape, section, measure, road: road_no, .. } = row;
    if edge.direction == Direction::Backward {
        shape.reverse();
    }
    let (geom, bounds) = blob::encode(shape.iter().copied()).ok_or_else(|| content("an edge has no shape"))?;
    bulk.add(i64::from(index) + 1);
    bulk.add(edge.id);
    bulk.add(road.road.way_id);
    bulk.add(edge.from_node.get());
    bulk.add(edge.to_node.get());
    bulk.add(edge.direction.name());
    bulk.add(geom);
    bulk.add(measure.length_m.filter(|length| length.is_finite()).unwrap_or_else(|| geodesic_length_m(&shape)));
    add_road_columns(bulk, road, &edge, &section);
    bulk.add(measure.min_radius_m.filter(|radius| radius.is_finite()));
    bulk.add(measure.centreline_deviation_m.filter(|deviation| deviation.is_finite()));
    add_limits(bulk, &edge.legal);
    bulk.add(edge.barred);
    bulk.add(edge.cut);
    bulk.add(i64::from(road_no) + 1);
    bulk.add(ranges.shape.start);
    bulk.add(ranges.narrowings.start);
    bulk.add(ranges.narrowings.end);
    bulk.add(edge.legal.rules.as_ref().map(RuleSet::text));
    bulk.add(edge.legal.open_when());
    bulk.add(edge.legal.tags.as_deref());
    bulk.add(road.road.width_tags.as_deref());
    bulk.end_row(to).await?;
    Ok(bounds)
}

/// Adds the columns of the road that users want with each edge.
fn add_road_columns(bulk: &mut Bulk, row: &RoadRow, edge: &Edge, section: &CrossSection) {
    let road = &row.road;
    bulk.add(highway(road.class, road.link));
    bulk.add(row.name.as_deref());
    bulk.add(row.reference.as_deref());
    bulk.add(road.oneway.name());
    bulk.add(road.left_hand_traffic);
    bulk.add(road.lanes);
    bulk.add(road.max_speed_km_h[edge.direction as usize]);
    add_widths(bulk, section);
}

/// Adds the columns of an edge's widths.
pub(crate) fn add_widths(bulk: &mut Bulk, section: &CrossSection) {
    for strip in [section.lane, section.direction, section.carriageway] {
        // People read this width, so it is rounded to millimetres. Certificates use the strip's edges in `section`.
        bulk.add(strip.map(|strip| (f64::from(strip.width_m()) * 1000.0).round() / 1000.0));
        bulk.add(strip.map(|strip| strip.source.name()));
    }
}

/// Writes the strokes, which come in the order of their first edges.
pub(crate) async fn write_strokes(
    to: &mut impl Takes,
    strokes: impl Iterator<Item = io::Result<StrokeRow>>,
) -> Sql<()> {
    let mut bulk = Bulk::new("stroke", 6);
    let mut stroke_edges = Bulk::new("stroke_edge", 2);
    let mut position = 0_i64;
    for (no, row) in (1_i64..).zip(strokes) {
        let StrokeRow { approach, edges, closed } = row?;
        bulk.add(no);
        for list in [&approach, &edges] {
            bulk.add(position);
            for &edge in list {
                position += 1;
                stroke_edges.add(position);
                stroke_edges.add(i64::from(edge) + 1);
                stroke_edges.end_row(to).await?;
            }
            bulk.add(position);
        }
        bulk.add(closed);
        bulk.end_row(to).await?;
    }
    bulk.finish(to).await?;
    stroke_edges.finish(to).await
}

/// Fills the spatial index along a space-filling curve, so that neighbours share pages and pages fill one after the other.
async fn spatial_index(to: &mut impl Takes, boxes: Sorted<(u64, EdgeNo), Bounds>) -> Sql<()> {
    let mut bulk = Bulk::new("rtree_edge_geom", 5);
    for row in boxes {
        let ((_, index), bounds) = row?;
        bulk.add(i64::from(index) + 1);
        for side in [bounds.west, bounds.east, bounds.south, bounds.north] {
            bulk.add(side);
        }
        bulk.end_row(to).await?;
    }
    bulk.finish(to).await
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

    async fn number<T>(&mut self, to: &mut impl Takes, key: K, value: &T, add: fn(&mut Bulk, &T)) -> Sql<i64> {
        let next = self.numbers.len() as i64 + 1;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.bulk.add(number);
            add(&mut self.bulk, value);
            self.bulk.end_row(to).await?;
        }
        Ok(number)
    }
}

fn section_key(section: &CrossSection) -> [Option<(u32, u32, u8)>; 3] {
    [section.lane, section.direction, section.carriageway]
        .map(|strip| strip.map(|s| (s.left_m.to_bits(), s.right_m.to_bits(), s.source as u8)))
}

fn add_section(bulk: &mut Bulk, section: &CrossSection) {
    for strip in [section.lane, section.direction, section.carriageway] {
        bulk.add(strip.map(|Strip { left_m, .. }| decimal(left_m)));
        bulk.add(strip.map(|Strip { right_m, .. }| decimal(right_m)));
        bulk.add(strip.map(|Strip { source, .. }| source.name()));
    }
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

/// The bits of limits and access, the rules and the tags.
type LegalKey = ([(u8, u32); 5], [u8; 2], Option<RuleSet>, Option<Box<str>>);

fn legal_key(legal: &Legal) -> LegalKey {
    let key = |limit| match limit {
        Limit::None => (0, 0),
        Limit::At(value) => (1, value.to_bits()),
        Limit::Unreadable => (2, 0),
    };
    let permissions = [legal.hgv, legal.motor_vehicle].map(|permission| permission as u8);
    let limits = limits(legal).map(|(limit, _)| key(limit));
    (limits, permissions, legal.rules.clone(), legal.tags.clone())
}

fn add_legal(bulk: &mut Bulk, legal: &Legal) {
    add_limits(bulk, legal);
    bulk.add(legal.rules.as_ref().map(RuleSet::text));
    bulk.add(legal.tags.as_deref());
}

fn add_limits(bulk: &mut Bulk, legal: &Legal) {
    let limits = limits(legal);
    for (limit, _) in limits {
        bulk.add(if let Limit::At(value) = limit { Some(decimal(value)) } else { None });
    }
    let unreadable: Vec<_> = limits.iter().filter(|(limit, _)| *limit == Limit::Unreadable).map(|row| row.1).collect();
    bulk.add((!unreadable.is_empty()).then(|| unreadable.join(",")));
    bulk.add(legal.hgv.name());
    bulk.add(legal.motor_vehicle.name());
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
