//! A set holds all certificates of one vehicle under one policy. A set is complete or absent. A layer shows each set.

use std::io;

use sqlx::AssertSqlSafe;
use sqlx::sqlite::SqliteConnection;

use crate::osm::facts::Policy;
use crate::words::Named;
use netcert_rows::Bounds;

use crate::columns::names::{SAFE, corridor_no, width_columns};
use crate::columns::set_no::SetNo;
use crate::file::bulk::Bulk;
use crate::layers::contents::LayerTable;
use crate::layers::styles::{self, Shows};
use crate::results::compact::CompactCertificate;
use crate::results::complete::{Complete, Fault};

type Sql<T> = Result<T, sqlx::Error>;

const COLUMNS: &str = "certificate_compact (vehicle_no, corridor_no, fid, verdict_no, rsc_mm, rsc_published_mm, \
                       hinge_margin_cdeg, shrink_milli, limiting_s_dm, limiting_at, need_cm)";

/// Inserts certificates of edges.
pub(crate) async fn insert_rows(
    c: &mut SqliteConnection,
    set: SetNo,
    rows: impl Iterator<Item = io::Result<CompactCertificate>>,
) -> Sql<()> {
    let mut bulk = Bulk::new(COLUMNS, 11);
    for row in rows {
        let row = row?;
        bulk.add(set.vehicle_no);
        bulk.add(set.corridor_no());
        row.add_to(&mut bulk);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await
}

/// A set to insert: its vehicle, policy and run.
pub(crate) struct Set<'a> {
    pub(crate) vehicle_no: u32,
    pub(crate) vehicle_id: &'a str,
    pub(crate) vehicle_name: &'a str,
    pub(crate) policy: Policy,
    pub(crate) run_id: i64,
    /// Time stamp of the layer.
    pub(crate) time: &'a str,
    /// The settings as text, from [`netcert_rows::settings::Settings::written`].
    pub(crate) settings: &'a str,
}

impl Set<'_> {
    /// Inserts the rows of all edges and registers their layer. The database must not have the set yet. After a fault, what was inserted
    /// must be thrown away.
    pub(crate) async fn insert(
        &self,
        c: &mut SqliteConnection,
        rows: impl Iterator<Item = io::Result<CompactCertificate>>,
        edges: u32,
    ) -> Sql<Result<(), Fault>> {
        let set = SetNo { vehicle_no: self.vehicle_no, policy: self.policy };
        let mut complete = Complete::new(edges);
        let rows = rows.inspect(|row| row.iter().for_each(|row| complete.look_at(row)));
        insert_rows(c, set, rows).await?;
        let rows = match complete.finish() {
            Ok(rows) => rows,
            Err(fault) => return Ok(Err(fault)),
        };
        let layer = self.layer_name(c).await?;
        sqlx::query("INSERT INTO certified_set VALUES (?, ?, ?, ?, ?, ?)")
            .bind(set.vehicle_no)
            .bind(set.corridor_no())
            .bind(self.run_id)
            .bind(rows)
            .bind(&layer)
            .bind(self.settings)
            .execute(&mut *c)
            .await?;
        self.register(c, &layer).await.map(Ok)
    }

    /// The layer's name: `permit_<vehicle>`, followed by the policy unless that is `lane`. A number follows if the name is
    /// taken.
    async fn layer_name(&self, c: &mut SqliteConnection) -> Sql<String> {
        let plain = |ch: char| if ch.is_ascii_alphanumeric() { ch.to_ascii_lowercase() } else { '_' };
        let mut base: String = "permit_".chars().chain(self.vehicle_id.chars().map(plain)).collect();
        if self.policy != Policy::Lane {
            base = format!("{base}_{}", self.policy.name());
        }
        let mut name = base.clone();
        for number in 2.. {
            let taken = "SELECT count(*) FROM sqlite_schema WHERE lower(name) = ?";
            if sqlx::query_scalar::<_, i64>(taken).bind(&name).fetch_one(&mut *c).await? == 0 {
                break;
            }
            name = format!("{base}_{number}");
        }
        Ok(name)
    }

    /// Creates the view and registers it as a layer with a style. The first column is the key (GeoPackage 1.3, requirement
    /// 150). No column may have the name OGC_FID: some readers add a key of that name to views, and DuckDB refuses two columns
    /// of one name.
    async fn register(&self, c: &mut SqliteConnection, layer: &str) -> Sql<()> {
        let (vehicle, corridor) = (self.vehicle_no, corridor_no(self.policy));
        let [width, source] = width_columns(self.policy);
        let view = format!(
            "CREATE VIEW {layer} AS SELECT e.fid AS fid, e.geom AS geom, e.edge_id, e.way_id, e.from_node, e.to_node, \
             e.direction, e.length_m, e.highway, e.name, e.ref, e.oneway, e.left_hand_traffic, e.{width} AS width_m, \
             e.{source} AS width_source, c.rsc_m, c.hinge_margin_deg, c.shrink \
             FROM certificate_compact AS c JOIN edge AS e ON e.fid = c.fid \
             WHERE c.vehicle_no = {vehicle} AND c.corridor_no = {corridor} AND c.verdict_no = {SAFE}"
        );
        // The statement is safe: its names and numbers come from the program and have only letters, digits and underscores.
        sqlx::query(AssertSqlSafe(view)).persistent(false).execute(&mut *c).await?;
        let description = format!("Roads that {} may use ({} policy)", self.vehicle_name, self.policy.name());
        let bounds = network_bounds(c).await?;
        let listed = LayerTable { table: layer, geometries: "LINESTRING", description: &description, bounds };
        listed.add(c, self.time).await?;
        styles::add(c, layer, Shows::Permits, self.time).await
    }
}

/// The box of the whole network, which every layer has. The standard calls the box informative. Computing a box for each
/// layer would take a third of the time of a set (0.6 µs of 2 µs per certificate).
async fn network_bounds(c: &mut SqliteConnection) -> Sql<Option<Bounds>> {
    let sql = "SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE table_name = 'edge' AND min_x NOT NULL";
    let bounds = sqlx::query_as(sql).fetch_optional(c).await?;
    Ok(bounds.map(|(west, south, east, north)| Bounds { west, south, east, north }))
}

/// Removes a set with its turns and its layer.
pub(crate) async fn remove(c: &mut SqliteConnection, set: SetNo) -> Sql<()> {
    // Certificates of turns depend on the verdicts of edges.
    crate::results::turns::remove(c, set).await?;
    let layer: Option<String> =
        sqlx::query_scalar("SELECT layer FROM certified_set WHERE vehicle_no = ? AND corridor_no = ?")
            .bind(set.vehicle_no)
            .bind(set.corridor_no())
            .fetch_optional(&mut *c)
            .await?;
    let Some(layer) = layer else { return Ok(()) };
    for sql in
        ["DELETE FROM gpkg_geometry_columns WHERE table_name = ?", "DELETE FROM gpkg_contents WHERE table_name = ?"]
    {
        sqlx::query(sql).bind(&layer).execute(&mut *c).await?;
    }
    styles::remove(c, &layer).await?;
    let quoted = layer.replace('"', "\"\"");
    sqlx::query(AssertSqlSafe(format!("DROP VIEW \"{quoted}\""))).persistent(false).execute(&mut *c).await?;
    for sql in [
        "DELETE FROM plan WHERE vehicle_no = ? AND corridor_no = ?",
        "DELETE FROM certified_set WHERE vehicle_no = ? AND corridor_no = ?",
        "DELETE FROM certificate_compact WHERE vehicle_no = ? AND corridor_no = ?",
    ] {
        sqlx::query(sql).bind(set.vehicle_no).bind(set.corridor_no()).execute(&mut *c).await?;
    }
    Ok(())
}
