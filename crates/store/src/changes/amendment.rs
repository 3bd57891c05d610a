//! Changes the rows of a database that newer roads change, where no edge and no turn gets another number: an update then costs what changed,
//! and not what is there. What the rows say is what [`crate::Writer::finish`] would write.

use std::rc::Rc;

use sqlx::Row as _;
use sqlx::query::Query;
use sqlx::sqlite::SqliteConnection;

use crate::network::{EdgeNo, Portion, PortionRestriction};
use crate::osm::{LonLat, NodeId};
use netcert_roads::turns::{JunctionArea, TurnFacts, TurnNo};
use netcert_rows::{Bounds, EdgeMeasure};

use crate::changes::renewal::{self, PackedRenewal, SetRenewal, Triggers};
use crate::columns::read::rows;
use crate::error::content;
use crate::file::blob;
use crate::file::bulk::Bulk;
use crate::results::turns::{self, TurnRecord};
use crate::roads::junctions;
use crate::roads::network_rows::{MapEdgeRow, NetworkRow, RoadRow, StrokeRow, edge_rows, stroke_rows};
use crate::roads::network_write::{Narrowings, Ranges, RoadWriter, write_edge, write_strokes};
use crate::roads::restrictions;

type Sql<T> = Result<T, sqlx::Error>;

/// What newer roads change.
pub struct Amendment<'a> {
    /// The whole roads that the older database has.
    pub before: &'a Portion,
    /// Their turns; none if the database has no turns.
    pub turns_before: &'a [TurnFacts],
    /// The whole newer roads. Their edges have the same ids in the same order.
    pub after: &'a Portion,
    /// Their turns. They have the same ids in the same order.
    pub turns: &'a [TurnFacts],
    /// The edges that were certified again, in order, with the measures of their corridors.
    pub measures: Vec<(EdgeNo, EdgeMeasure)>,
    /// If the database has turns: nodes whose junctions may differ, and the areas that these junctions have now.
    pub junctions: Option<(Vec<NodeId>, Vec<JunctionArea>)>,
    /// Certificates that were made again.
    pub sets: Vec<SetRenewal>,
}

/// Writes the network, the turns and the certificates, of which `packed` has those of each set.
pub(crate) async fn write(
    c: &mut SqliteConnection,
    amendment: &mut Amendment<'_>,
    packed: &[PackedRenewal],
) -> Sql<()> {
    let around = edges(c, amendment).await?;
    let layers = "table_name = 'edge' OR table_name IN (SELECT layer FROM certified_set)";
    set_box(c, layers, around).await?;
    strokes(c, amendment).await?;
    let mut of_network: Vec<PortionRestriction> = amendment.after.restrictions().collect();
    restrictions::replace(c, &mut of_network).await?;
    if let Some((nodes, areas)) = &amendment.junctions {
        let around = change_turns(c, amendment).await?;
        set_box(c, "table_name = 'turn'", around).await?;
        let around = change_junctions(c, nodes, areas).await?;
        set_box(c, "table_name = 'junction'", around).await?;
    }
    renewal::replace_sets(c, &mut amendment.sets, packed).await
}

/// Writes the box of some layers.
async fn set_box(c: &mut SqliteConnection, layers: &'static str, around: Option<Bounds>) -> Sql<()> {
    let sql = format!("UPDATE gpkg_contents SET min_x = ?, min_y = ?, max_x = ?, max_y = ? WHERE {layers}");
    let update = sqlx::query(sqlx::AssertSqlSafe(sql)).bind(around.map(|b| b.west)).bind(around.map(|b| b.south));
    update.bind(around.map(|b| b.east)).bind(around.map(|b| b.north)).execute(c).await.map(|_| ())
}

/// An edge whose row differs.
struct Changed {
    index: EdgeNo,
    row: MapEdgeRow,
    /// Whether the row has the measures of its corridor. If not, those of the database stand.
    measured: bool,
    road: Rc<RoadRow>,
    ranges: Ranges,
}

/// Edges one after the other whose numbers of road, positions and narrow places moved by the same amounts.
struct Moved {
    edges: std::ops::RangeInclusive<EdgeNo>,
    by: [i64; 4],
}

/// How the rows of edges differ.
#[derive(Default)]
struct EdgeChanges {
    changed: Vec<Changed>,
    moved: Vec<Moved>,
    /// Whether roads, or their numbers, differ.
    roads: bool,
    /// Whether narrow places, or their numbers, differ.
    narrowings: bool,
    /// The box around all edges.
    around: Option<Bounds>,
}

impl EdgeChanges {
    fn find(amendment: &Amendment<'_>) -> Sql<Self> {
        let mut found = Self::default();
        let (mut ranges, mut ranges_before) = (Ranges::default(), Ranges::default());
        let mut road: Option<(Rc<RoadRow>, bool)> = None;
        let mut measures = amendment.measures.iter().peekable();
        for ((index, now), (_, before)) in edge_rows(amendment.after, &[]).zip(edge_rows(amendment.before, &[])) {
            let (NetworkRow { road: road_now, edge: row }, NetworkRow { road: road_before, edge: mut row_before }) =
                (now, before);
            ranges.next(&row);
            ranges_before.next(&row_before);
            if let Some(row) = road_now {
                let differs = Some(&row) != road_before.as_ref();
                found.roads |= differs;
                road = Some((Rc::new(row), differs));
            }
            let Some((road, road_differs)) = &road else { return Err(content("an edge has no road")) };
            let starts = |row: &MapEdgeRow, ranges: &Ranges| {
                [row.road, ranges.shape.start, ranges.narrowings.start, ranges.narrowings.end].map(i64::from)
            };
            let (starts, starts_before) = (starts(&row, &ranges), starts(&row_before, &ranges_before));
            let by = std::array::from_fn(|k| starts[k] - starts_before[k]);
            found.roads |= by[0] != 0;
            found.narrowings |= by[2..] != [0; 2] || row.narrowings != row_before.narrowings;
            found.move_on(index, by);
            let around = Bounds::around(row.shape.iter().copied());
            found.around = found.around.into_iter().chain(around).reduce(Bounds::union);
            row_before.road = row.road;
            let measure = measures.next_if(|(edge, _)| *edge == index);
            if *road_differs || row != row_before || measure.is_some() {
                let (measured, road, ranges) = (measure.is_some(), Rc::clone(road), ranges.clone());
                let measure = measure.map_or_else(EdgeMeasure::default, |(_, measure)| *measure);
                found.changed.push(Changed { index, row: MapEdgeRow { measure, ..row }, measured, road, ranges });
            }
        }
        match measures.next() {
            Some((edge, _)) => Err(content(format!("edge {edge} has a measure and no row"))),
            None => Ok(found),
        }
    }

    fn move_on(&mut self, index: EdgeNo, by: [i64; 4]) {
        match self.moved.last_mut() {
            Some(last) if last.by == by && last.edges.end().get() + 1 == index.get() => {
                last.edges = *last.edges.start()..=index;
            }
            _ if by != [0; 4] => self.moved.push(Moved { edges: index..=index, by }),
            _ => {}
        }
    }
}

/// Writes the rows of edges that differ, and all roads or narrow places if any differs. Returns the box around all edges.
async fn edges(c: &mut SqliteConnection, amendment: &Amendment<'_>) -> Sql<Option<Bounds>> {
    let EdgeChanges { changed, moved, roads, narrowings, around } = EdgeChanges::find(amendment)?;
    if roads || narrowings {
        write_roads(c, amendment.after).await?;
    }
    if changed.is_empty() && moved.is_empty() {
        return Ok(around);
    }
    let triggers = Triggers::remove(c).await?;
    for Moved { edges, by } in moved {
        let sql = "UPDATE edge SET road_no = road_no + ?, shape_start = shape_start + ?, \
                   narrowing_start = narrowing_start + ?, narrowing_end = narrowing_end + ? WHERE fid BETWEEN ? AND ?";
        let update = by.into_iter().fold(sqlx::query(sql), Query::bind);
        update.bind(edges.start().get() + 1).bind(edges.end().get() + 1).execute(&mut *c).await?;
    }
    let (mut bulk, mut boxes) = (Bulk::new("edge", 41), Bulk::new("rtree_edge_geom", 5));
    for Changed { index, mut row, measured, road, ranges } in changed {
        let fid = i64::from(index) + 1;
        if !measured {
            let sql = "SELECT min_radius_m, centreline_deviation_m FROM edge WHERE fid = ?";
            let (min_radius_m, centreline_deviation_m) = sqlx::query_as(sql).bind(fid).fetch_one(&mut *c).await?;
            row.measure = EdgeMeasure { length_m: None, min_radius_m, centreline_deviation_m };
        }
        for sql in ["DELETE FROM edge WHERE fid = ?", "DELETE FROM rtree_edge_geom WHERE id = ?"] {
            sqlx::query(sql).bind(fid).execute(&mut *c).await?;
        }
        let bounds = write_edge(c, &mut bulk, index, row, &road, &ranges).await?;
        boxes.add(fid);
        for side in [bounds.west, bounds.east, bounds.south, bounds.north] {
            boxes.add(side);
        }
        boxes.end_row(c).await?;
    }
    bulk.finish(c).await?;
    boxes.finish(c).await?;
    triggers.restore(c).await?;
    Ok(around)
}

/// Replaces all roads and narrow places.
async fn write_roads(c: &mut SqliteConnection, after: &Portion) -> Sql<()> {
    for table in ["road", "section", "legal", "narrowing"] {
        sqlx::query(sqlx::AssertSqlSafe(format!("DELETE FROM {table}"))).execute(&mut *c).await?;
    }
    let (mut roads, mut narrowings, mut ranges) = (RoadWriter::new(), Narrowings::new(), Ranges::default());
    for (_, NetworkRow { road, edge }) in edge_rows(after, &[]) {
        if let Some(road) = road {
            roads.write(c, edge.road, &road).await?;
        }
        if ranges.next(&edge) {
            narrowings.write(c, &ranges, &edge).await?;
        }
    }
    roads.finish(c).await?;
    narrowings.finish(c).await
}

/// Replaces all strokes if any differs.
async fn strokes(c: &mut SqliteConnection, amendment: &Amendment<'_>) -> Sql<()> {
    let [before, after] = [amendment.before, amendment.after].map(|portion| {
        let mut strokes: Vec<StrokeRow> = stroke_rows(portion).filter(|row| !row.edges.is_empty()).collect();
        strokes.sort_by_key(|row| row.edges.first().copied());
        strokes
    });
    if before == after {
        return Ok(());
    }
    for table in ["stroke", "stroke_edge"] {
        sqlx::query(sqlx::AssertSqlSafe(format!("DELETE FROM {table}"))).execute(&mut *c).await?;
    }
    write_strokes(c, after.into_iter().map(Ok)).await
}

/// Writes the rows of turns that differ. Returns the box around all turns.
async fn change_turns(c: &mut SqliteConnection, amendment: &Amendment<'_>) -> Sql<Option<Bounds>> {
    let Amendment { before, turns_before, after, turns, .. } = amendment;
    let record = |portion: &Portion, facts| TurnRecord::new(&portion.network, facts, |edge| edge);
    let mut changed = Vec::new();
    let mut around = None;
    for ((index, now), then) in TurnNo::all().zip(*turns).zip(*turns_before) {
        let row = record(after, now);
        around = around.into_iter().chain(Bounds::around(now.line.iter().copied())).reduce(Bounds::union);
        if row != record(before, then) {
            changed.push((index, row));
        }
    }
    for (index, _) in &changed {
        sqlx::query("DELETE FROM turn WHERE fid = ?").bind(i64::from(*index) + 1).execute(&mut *c).await?;
    }
    turns::write(c, changed.into_iter().map(Ok)).await?;
    Ok(around)
}

/// Replaces the areas of some junctions. Returns the box around all areas.
async fn change_junctions(c: &mut SqliteConnection, nodes: &[NodeId], areas: &[JunctionArea]) -> Sql<Option<Bounds>> {
    let of_blob = |blob: &[u8]| {
        let polygons = blob::decode_polygons(blob).ok_or_else(|| content("the area of a junction"))?;
        Ok::<_, sqlx::Error>(around_all(&polygons))
    };
    let sql = "SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE table_name = 'junction' AND min_x NOT NULL";
    let known: Option<(f64, f64, f64, f64)> = sqlx::query_as(sql).fetch_optional(&mut *c).await?;
    let known = known.map(|(west, south, east, north)| Bounds { west, south, east, north });
    let mut at_border = false;
    for node in nodes {
        let sql = "SELECT geom FROM junction WHERE node_id = ?";
        let gone: Option<Vec<u8>> = sqlx::query_scalar(sql).bind(node.get()).fetch_optional(&mut *c).await?;
        let gone = gone.as_deref().map(of_blob).transpose()?.flatten();
        let sides = |b: Bounds| [b.west, b.south, b.east, b.north];
        at_border |=
            gone.zip(known).is_some_and(|(gone, all)| sides(gone).iter().zip(sides(all)).any(|(a, b)| *a == b));
    }
    junctions::replace(c, nodes, areas).await?;
    if at_border {
        // The box may have become smaller.
        let all = rows(c, "SELECT geom FROM junction", |row| of_blob(row.try_get(0)?)).await?;
        return Ok(all.into_iter().flatten().reduce(Bounds::union));
    }
    let new = areas.iter().filter_map(|area| around_all(&area.polygons));
    Ok(known.into_iter().chain(new).reduce(Bounds::union))
}

/// The box around polygons.
fn around_all(polygons: &[Vec<Vec<LonLat>>]) -> Option<Bounds> {
    Bounds::around(polygons.iter().flatten().flatten().copied())
}
