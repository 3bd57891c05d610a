//! Writes the areas of junctions, and reads them for the map.

use std::io;

use sqlx::Row as _;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::osm::{LonLat, NodeId};
use netcert_roads::turns::{JunctionArea, KerbSource};
use netcert_rows::Bounds;

use crate::columns::read::rows;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::blob;
use crate::file::bulk::{Bulk, Takes};
use crate::layers::contents::LayerTable;
use crate::layers::styles::{self, Shows};

type Sql<T> = Result<T, sqlx::Error>;

/// A junction on a map: its node, and its polygons, each with its outer ring first.
pub type MapJunction = (NodeId, Vec<Vec<Vec<LonLat>>>);

impl Database {
    /// The areas of all junctions, in order of their nodes.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn junction_areas(&mut self) -> Result<Vec<JunctionArea>, StoreError> {
        self.session.run(async |c| {
            rows(c, "SELECT node_id, roads, kerb_source, geom FROM junction ORDER BY node_id", junction_area).await
        })
    }

    /// The areas of the junctions that edges near a box lead to, in order of their nodes.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn map_junctions(&mut self, bounds: Bounds) -> Result<Vec<MapJunction>, StoreError> {
        let sql = "SELECT node_id, geom FROM junction WHERE node_id IN (SELECT e.to_node FROM rtree_edge_geom AS t \
                   CROSS JOIN edge AS e ON e.fid = t.id WHERE t.maxx >= ? AND t.minx <= ? AND t.maxy >= ? AND t.miny <= ?) \
                   ORDER BY node_id";
        let Bounds { west, south, east, north } = bounds;
        self.session.run(async |c| {
            let query = sqlx::query(sql).bind(west).bind(east).bind(south).bind(north);
            let read = |row: &SqliteRow| {
                let node = NodeId::new(row.try_get(0)?);
                let polygons = blob::decode_polygons(row.try_get(1)?);
                Ok((node, polygons.ok_or_else(|| content(format!("the area of junction {node}")))?))
            };
            query.fetch_all(c).await?.iter().map(read).collect()
        })
    }
}

/// The columns that [`junction_area`] reads.
pub(crate) const COLUMNS: &str = "node_id, roads, kerb_source, geom";

/// Reads the area of a junction from [`COLUMNS`].
pub(crate) fn junction_area(row: &SqliteRow) -> Sql<JunctionArea> {
    let node = NodeId::new(row.try_get(0)?);
    let damaged = || content(format!("the area of junction {node}"));
    let kerb_source = row.try_get::<Option<&str>, _>(2)?.map(|word| KerbSource::named(word).ok_or_else(damaged));
    let roads = usize::try_from(row.try_get::<i64, _>(1)?).map_err(|_| damaged())?;
    let polygons = blob::decode_polygons(row.try_get(3)?).ok_or_else(damaged)?;
    Ok(JunctionArea { node, roads, kerb_source: kerb_source.transpose()?, polygons })
}

/// Registers the areas as a layer.
pub(crate) async fn register(c: &mut SqliteConnection, bounds: Option<Bounds>, time: &str) -> Sql<()> {
    let layer = LayerTable { table: "junction", geometries: "MULTIPOLYGON", description: "Areas of junctions", bounds };
    layer.add(c, time).await?;
    styles::add(c, "junction", Shows::Junctions, time).await
}

/// Replaces the areas at some nodes. A node without a new area has none any more.
pub(crate) async fn replace(c: &mut SqliteConnection, nodes: &[NodeId], areas: &[JunctionArea]) -> Sql<()> {
    for node in nodes {
        sqlx::query("DELETE FROM junction WHERE node_id = ?").bind(node.get()).execute(&mut *c).await?;
    }
    insert(c, areas.iter().cloned().map(Ok)).await.map(|_| ())
}

/// Writes areas and returns the box around them.
pub(crate) async fn insert(
    to: &mut impl Takes,
    areas: impl Iterator<Item = io::Result<JunctionArea>>,
) -> Sql<Option<Bounds>> {
    let mut bulk = Bulk::new("junction", 4);
    let mut bounds: Option<Bounds> = None;
    for area in areas {
        let JunctionArea { node, roads, kerb_source, polygons } = area?;
        let encoded = blob::encode_polygons(&polygons);
        let (geom, around) = encoded.ok_or_else(|| content(format!("the area of junction {node} is empty")))?;
        bounds = Some(bounds.map_or(around, |b| b.union(around)));
        bulk.add(node.get());
        bulk.add(roads as i64);
        bulk.add(kerb_source.map(KerbSource::name));
        bulk.add(geom);
        bulk.end_row(to).await?;
    }
    bulk.finish(to).await?;
    Ok(bounds)
}
