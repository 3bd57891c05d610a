//! Reads the main roads of a region for maps of small scale, in one pass over the table.
//!
//! All edges of the requested classes come in order of the network. Names and ids are left out, because maps of small scale
//! do not show them.

use sqlx::sqlite::SqliteRow;
use sqlx::{AssertSqlSafe, Row as _};

use crate::osm::facts::RoadClass;
use crate::osm::facts::class_and_link;
use crate::words::Named as _;
use netcert_rows::{MainRoad, SetKey};

use crate::columns::names::{corridor_no, width_columns};
use crate::columns::read::{line, verdict, word_or_none};
use crate::columns::uses;
use crate::database::Database;
use crate::error::{StoreError, content};

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// All edges of these classes (with their links), with a vehicle's certificates.
    ///
    /// # Errors
    /// The file cannot be read. A vehicle that is not certified under this policy has no rows.
    pub fn main_roads(&mut self, set: SetKey<'_>, classes: &[RoadClass]) -> Result<Vec<MainRoad>, StoreError> {
        let [_, source] = width_columns(set.policy);
        let words: Vec<String> = classes.iter().map(|class| format!("'{0}','{0}_link'", class.name())).collect();
        let sql = format!(
            "SELECT e.highway, e.{source}, c.verdict_no, c.rsc_mm, e.geom, {} FROM edge AS e \
             CROSS JOIN certificate_compact AS c \
             ON c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) \
             AND c.corridor_no = ? AND c.fid = e.fid \
             WHERE e.highway IN ({}) ORDER BY e.fid",
            uses::number(uses::EDGES),
            words.join(",")
        );
        self.session.run(async |c| {
            let query = sqlx::query(AssertSqlSafe(sql)).bind(set.vehicle).bind(corridor_no(set.policy));
            query.fetch_all(c).await?.iter().map(main_road).collect()
        })
    }
}

fn main_road(row: &SqliteRow) -> Sql<MainRoad> {
    let highway: &str = row.try_get(0)?;
    let (class, link) = class_and_link(highway).ok_or_else(|| content(format!("highway {highway}")))?;
    Ok(MainRoad {
        class,
        link,
        width_source: word_or_none(row, 1)?,
        verdict: verdict(row, 2, || "a main road".to_owned())?,
        rsc_mm: row.try_get(3)?,
        uses: uses::read(row, 5)?,
        line: line(row, 4, || "a main road".to_owned())?,
    })
}
