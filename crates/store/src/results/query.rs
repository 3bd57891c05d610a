//! Queries edges with a vehicle's certificates. Rows stream in order of the network, each with all that a table, CSV, JSON or
//! GeoJSON needs.

use std::pin::Pin;

use futures_util::{Stream, TryStreamExt as _};
use geo::{BoundingRect as _, Intersects as _};
use sqlx::sqlite::{SqliteArguments, SqliteRow};
use sqlx::{Arguments as _, AssertSqlSafe, Row as _};
use tokio::runtime::Runtime;

use crate::osm::LonLat;
use crate::osm::facts::{Policy, WidthSource};
use crate::words::{Named, VerdictKind};
use netcert_rows::{Bounds, EdgeRow};

use crate::columns::names::{corridor_no, of_kind, width_columns};
use crate::columns::read::{centimetres, line, word_or_none};
use crate::columns::uses;
use crate::database::Database;
use crate::error::StoreError;
use crate::results::numbers;
use crate::roads::key::{edge_key, road_name};

type Sql<T> = Result<T, sqlx::Error>;

/// An area in degrees. An edge that touches the area is in it.
#[derive(Debug, Clone, PartialEq)]
pub enum Area {
    /// A box. A box with `west > east` spans the 180th meridian.
    Bounds(Bounds),
    /// Polygons, as from a GeoJSON file.
    Polygons(geo::MultiPolygon),
}

/// The conditions of a query. All of them must hold.
#[derive(Debug, Clone, PartialEq)]
pub struct QueryOptions {
    /// Vehicle id.
    pub vehicle: String,
    /// The policy of the certificates.
    pub policy: Policy,
    /// Only edges that touch this area.
    pub area: Option<Area>,
    /// Only the edge with this `edge_id`.
    pub edge_id: Option<i64>,
    /// Only edges with this verdict.
    pub verdict: Option<VerdictKind>,
    /// Only edges with at least this RSC, metres.
    pub min_rsc_m: Option<f64>,
    /// Only edges that would be safe with at most this much more width, metres.
    pub needs_at_most_m: Option<f64>,
    /// Only edges whose width comes from this source or a better one.
    pub min_width_source: Option<WidthSource>,
    /// Only edges for which this is the narrowest policy under which they are safe.
    pub uses: Option<Policy>,
}

impl QueryOptions {
    /// Every edge of a vehicle.
    #[must_use]
    pub fn new(vehicle: &str, policy: Policy) -> Self {
        Self {
            vehicle: vehicle.to_owned(),
            policy,
            area: None,
            edge_id: None,
            verdict: None,
            min_rsc_m: None,
            needs_at_most_m: None,
            min_width_source: None,
            uses: None,
        }
    }
}

/// The rows of a query, read from the file one by one.
pub struct Rows<'d> {
    stream: Pin<Box<dyn Stream<Item = Sql<SqliteRow>> + Send + 'd>>,
    runtime: &'d Runtime,
    path: &'d std::path::Path,
    area: Option<geo::MultiPolygon>,
}

impl Iterator for Rows<'_> {
    type Item = Result<EdgeRow, StoreError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let row = self.runtime.block_on(self.stream.try_next());
            match row.and_then(|row| row.as_ref().map(edge_row).transpose()) {
                Ok(Some(row)) if !self.touches(&row.line) => {}
                Ok(row) => return row.map(Ok),
                Err(e) => return Some(Err(StoreError::sql(self.path, e))),
            }
        }
    }
}

impl Rows<'_> {
    /// Whether a line touches the area. The spatial index compares boxes only.
    fn touches(&self, line: &[LonLat]) -> bool {
        let Some(area) = &self.area else { return true };
        let line: geo::LineString = line.iter().map(|place| place.degrees()).collect();
        area.intersects(&line)
    }
}

impl Database {
    /// Edges with their certificates, in order of the network. A vehicle that is not certified under this policy is an
    /// error ([`StoreError::NotThere`]), not an empty answer.
    pub fn query(&mut self, options: &QueryOptions) -> Result<Rows<'_>, StoreError> {
        let vehicle_no = self.vehicle_no_of_set(&options.vehicle, options.policy)?;
        if let Some(strip) = options.uses {
            // Nothing is known of a policy that was not certified, and an empty answer would say that no road needs it.
            self.vehicle_no_of_set(&options.vehicle, strip)?;
        }
        let area = options.area.as_ref().map(polygons);
        let (sql, values) =
            statement(options, vehicle_no, area.as_ref()).map_err(|e| StoreError::sql(&self.session.path, e))?;
        let stream = sqlx::query_with(AssertSqlSafe(sql), values).fetch(&mut self.session.connection);
        Ok(Rows { stream, runtime: &self.session.runtime, path: &self.session.path, area })
    }

    /// The number of a vehicle that is certified under this policy.
    pub(crate) fn vehicle_no_of_set(&mut self, vehicle: &str, policy: Policy) -> Result<u32, StoreError> {
        let number: Option<u32> = self.session.run(async |c| {
            let sql = "SELECT vehicle_no FROM certified_set JOIN vehicle USING (vehicle_no) \
                       WHERE vehicle_id = ? AND corridor_no = ?";
            sqlx::query_scalar(sql).bind(vehicle).bind(corridor_no(policy)).fetch_optional(c).await
        })?;
        number.ok_or_else(|| StoreError::not_certified(&self.session.path, vehicle, policy))
    }
}

pub(crate) fn polygons(area: &Area) -> geo::MultiPolygon {
    let rect = |west, south, east, north| geo::Rect::new((west, south), (east, north)).to_polygon();
    match area {
        Area::Polygons(polygons) => polygons.clone(),
        &Area::Bounds(Bounds { west, south, east, north }) if west <= east => {
            geo::MultiPolygon(vec![rect(west, south, east, north)])
        }
        &Area::Bounds(Bounds { west, south, east, north }) => {
            geo::MultiPolygon(vec![rect(west, south, 180.0, north), rect(-180.0, south, east, north)])
        }
    }
}

/// The columns that [`edge_row`] reads, of a set whose vehicle and policy are the first two values.
pub(crate) fn select(policy: Policy) -> String {
    let [width, source] = width_columns(policy);
    format!(
        "SELECT c.fid, e.edge_id, e.way_id, e.from_node, e.to_node, e.direction, e.highway, e.name, e.ref, e.length_m, \
         e.{width}, e.{source}, e.min_radius_m, e.geom, e.maxspeed_kmh, c.need_cm, {columns}, {uses} \
         FROM certificate_compact AS c CROSS JOIN edge AS e ON e.fid = c.fid \
         WHERE c.vehicle_no = ? AND c.corridor_no = ?",
        columns = numbers::COLUMNS,
        uses = uses::number(uses::EDGES)
    )
}

fn statement(
    options: &QueryOptions,
    vehicle_no: u32,
    area: Option<&geo::MultiPolygon>,
) -> Sql<(String, SqliteArguments)> {
    let [width, source] = width_columns(options.policy);
    let mut sql = select(options.policy);
    let mut values = SqliteArguments::default();
    let mut bind = |value: f64| values.add(value).map_err(sqlx::Error::Encode);
    bind(f64::from(vehicle_no))?;
    bind(f64::from(corridor_no(options.policy)))?;
    if let Some(kind) = options.verdict {
        sql += &format!(" AND {}", of_kind("c.verdict_no", kind));
    }
    if let Some(rsc_m) = options.min_rsc_m {
        sql += " AND c.rsc_mm >= ?";
        bind(rsc_m * 1000.0)?;
    }
    if let Some(more_m) = options.needs_at_most_m {
        sql += &format!(" AND c.need_cm <= 100.0 * (e.{width} + ?) + 1e-6");
        bind(more_m)?;
    }
    if let Some(least) = options.min_width_source {
        let enough: Vec<_> =
            WidthSource::ALL.iter().filter(|&&s| s >= least).map(|s| format!("'{}'", s.name())).collect();
        sql += &format!(" AND e.{source} IN ({})", enough.join(","));
    }
    if let Some(strip) = options.uses {
        sql += &format!(" AND {}", uses::is(uses::EDGES, strip));
    }
    if let Some(area) = area {
        let boxes: Vec<geo::Rect> = area.iter().filter_map(geo::Polygon::bounding_rect).collect();
        let meets = vec!["(maxx >= ? AND minx <= ? AND maxy >= ? AND miny <= ?)"; boxes.len()].join(" OR ");
        let meets = if boxes.is_empty() { "FALSE".to_owned() } else { meets };
        sql += &format!(" AND c.fid IN (SELECT id FROM rtree_edge_geom WHERE {meets})");
        for rect in boxes {
            for side in [rect.min().x, rect.max().x, rect.min().y, rect.max().y] {
                bind(side)?;
            }
        }
    }
    if let Some(edge_id) = options.edge_id {
        sql += " AND c.fid = (SELECT fid FROM edge WHERE edge_id = ?)";
        values.add(edge_id).map_err(sqlx::Error::Encode)?;
    }
    sql += " ORDER BY c.fid";
    Ok((sql, values))
}

pub(crate) fn edge_row(row: &SqliteRow) -> Sql<EdgeRow> {
    let fid: u32 = row.try_get(0)?;
    Ok(EdgeRow {
        edge: edge_key(row, 1)?,
        road: road_name(row, 6)?,
        length_m: row.try_get(9)?,
        width_m: row.try_get(10)?,
        width_source: word_or_none(row, 11)?,
        min_radius_m: row.try_get(12)?,
        maxspeed_kmh: row.try_get(14)?,
        need_width_m: centimetres(row, 15)?,
        certificate: numbers::read(row, 16, || format!("edge {fid}"))?,
        uses: uses::read(row, 23)?,
        line: line(row, 13, || format!("edge {fid}"))?,
    })
}
