//! Writes what lies behind the roads, and reads it for the map.

use std::io;

use sqlx::AssertSqlSafe;
use sqlx::Row as _;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::osm::facts::BackdropKind;
use crate::osm::{Backdrop, BackdropShape};
use crate::words::Named as _;
use netcert_rows::{Bounds, MapBackdrop};

use crate::columns::read::word;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::blob;
use crate::file::bulk::Bulk;

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// Whether the map's extract had anything that lies behind the roads.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn has_backdrop(&mut self) -> Result<bool, StoreError> {
        self.session.run(async |c| sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM backdrop)").fetch_one(c).await)
    }

    /// Things of these kinds whose boxes touch a box, in drawing order. The longer side of their boxes is at least `least_deg` degrees of
    /// latitude.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn map_backdrop(
        &mut self,
        bounds: Bounds,
        kinds: &[BackdropKind],
        least_deg: f64,
    ) -> Result<Vec<MapBackdrop>, StoreError> {
        let marks = vec!["?"; kinds.len()].join(", ");
        let sql = format!(
            "SELECT b.fid, b.kind, b.name, b.geom FROM rtree_backdrop_geom AS t CROSS JOIN backdrop AS b ON b.fid = t.fid \
             WHERE t.east >= ? AND t.west <= ? AND t.north >= ? AND t.south <= ? AND t.size_deg >= ? AND b.kind IN ({marks}) \
             ORDER BY b.fid"
        );
        let Bounds { west, south, east, north } = bounds;
        self.session.run(async |c| {
            let query = sqlx::query(AssertSqlSafe(sql)).bind(west).bind(east).bind(south).bind(north).bind(least_deg);
            let query = kinds.iter().fold(query, |query, kind| query.bind(kind.name()));
            query.fetch_all(c).await?.iter().map(map_backdrop).collect()
        })
    }
}

fn map_backdrop(row: &SqliteRow) -> Sql<MapBackdrop> {
    let fid: i64 = row.try_get(0)?;
    let shape = blob::decode_shape(row.try_get(3)?).ok_or_else(|| content(format!("the shape of backdrop {fid}")))?;
    Ok(MapBackdrop { number: fid, kind: word(row, 1)?, name: row.try_get(2)?, shape })
}

/// Replaces everything.
pub(crate) async fn replace(c: &mut SqliteConnection, things: impl Iterator<Item = io::Result<Backdrop>>) -> Sql<()> {
    sqlx::query("DELETE FROM backdrop").execute(&mut *c).await?;
    sqlx::query("DELETE FROM rtree_backdrop_geom").execute(&mut *c).await?;
    insert(c, things).await
}

pub(crate) async fn insert(c: &mut SqliteConnection, things: impl Iterator<Item = io::Result<Backdrop>>) -> Sql<()> {
    let mut rows = Bulk::new("backdrop", 5);
    let mut boxes = Bulk::new("rtree_backdrop_geom", 6);
    for (fid, thing) in (1_i64..).zip(things) {
        let Backdrop { kind, object: (object, id), name, shape } = thing?;
        let object = format!("{} {id}", object.name());
        let (geom, bounds) =
            blob::encode_shape(&shape).ok_or_else(|| content(format!("the shape of {object} is empty")))?;
        rows.add(fid);
        rows.add(kind.name());
        rows.add(object);
        rows.add(name.as_deref());
        rows.add(geom);
        rows.end_row(c).await?;
        let Bounds { west, south, east, north } = bounds;
        boxes.add(fid);
        for side in [west, east, south, north] {
            boxes.add(side);
        }
        boxes.add(size_deg(&shape, bounds));
        boxes.end_row(c).await?;
    }
    rows.finish(c).await?;
    boxes.finish(c).await
}

/// The longer side of a box in degrees of latitude. Of several polygons, that of the largest.
fn size_deg(shape: &BackdropShape, whole: Bounds) -> f64 {
    let size = |bounds: Bounds| {
        let middle = (0.5 * (bounds.south + bounds.north)).to_radians().cos();
        ((bounds.east - bounds.west) * middle).max(bounds.north - bounds.south)
    };
    match shape {
        BackdropShape::Areas(polygons) => polygons
            .iter()
            .filter_map(|polygon| Bounds::around(polygon.first()?.iter().copied()))
            .map(size)
            .fold(0.0, f64::max),
        BackdropShape::Lines(_) | BackdropShape::Place(_) => size(whole),
    }
}
