//! Writes and reads the table of mapped surfaces of junctions.

use sqlx::Row as _;
use sqlx::sqlite::SqliteConnection;

use crate::network::MappedArea;
use crate::osm::facts::{AreaKind, RoadClass};
use crate::words::Named;

use crate::columns::read::{line, rows};
use crate::error::content;
use crate::file::blob;
use crate::file::bulk::Bulk;

type Sql<T> = Result<T, sqlx::Error>;

const ISLAND: &str = "island";

/// Inserts the areas.
pub(crate) async fn insert(c: &mut SqliteConnection, areas: &[MappedArea]) -> Sql<()> {
    let mut bulk = Bulk::new("area", 4);
    for (no, area) in (1_i64..).zip(areas) {
        let (geom, _) = blob::encode(area.ring.iter().copied()).ok_or_else(|| content("an area has no shape"))?;
        bulk.add(no);
        bulk.add(area.way_id);
        bulk.add(match area.kind {
            AreaKind::Road(class) => class.name(),
            AreaKind::Island => ISLAND,
        });
        bulk.add(geom);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await
}

/// Replaces all areas.
pub(crate) async fn replace(c: &mut SqliteConnection, areas: &[MappedArea]) -> Sql<()> {
    sqlx::query("DELETE FROM area").execute(&mut *c).await?;
    insert(c, areas).await
}

/// Reads all areas.
pub(crate) async fn read(c: &mut SqliteConnection) -> Sql<Vec<MappedArea>> {
    rows(c, "SELECT way_id, kind, geom FROM area ORDER BY area_no", |row| {
        let way_id: i64 = row.try_get(0)?;
        let kind = match row.try_get(1)? {
            ISLAND => AreaKind::Island,
            word => AreaKind::Road(RoadClass::named(word).ok_or_else(|| content(format!("`{word}` is no area")))?),
        };
        Ok(MappedArea { way_id, kind, ring: line(row, 2, || format!("area {way_id}"))? })
    })
    .await
}
