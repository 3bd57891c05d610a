//! Pages of edges, turns and junctions in order of their keys, under conditions.
//!
//! A page begins after the last feature of the page before. So pages have neither gaps nor repeats, as long as the file does not change.

use geo::Intersects as _;
use sqlx::sqlite::SqliteRow;

use crate::osm::LonLat;
use crate::osm::facts::Policy;
use netcert_roads::turns::JunctionArea;
use netcert_rows::{Bounds, EdgeRow, SetKey, TurnRow};

use crate::columns::names::{corridor_no, width_columns};
use crate::columns::uses;
use crate::database::Database;
use crate::error::StoreError;
use crate::results::predicate::{BoundSql, ColumnSql, Predicate};
use crate::results::query::{self, Area, polygons};
use crate::results::turns;
use crate::roads::junctions;

type Sql<T> = Result<T, sqlx::Error>;

/// The features of a page. All conditions must hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageQuery<'q> {
    /// Only features after the one with this key: the `fid` of an edge or turn, the `node_id` of a junction.
    pub after: Option<i64>,
    /// Only the feature with this `edge_id`, `turn_id` or `node_id`.
    pub id: Option<i64>,
    /// Only features that touch this box.
    pub area: Option<Bounds>,
    /// Only features for which this is true.
    pub filter: Option<&'q Predicate>,
    /// The greatest number of features.
    pub most: usize,
}

/// How far the line of a turn may lie from the edge that it comes from, metres: it ends 12 m behind the node.
const BEYOND_TURN_M: f64 = 50.0;
/// The same for a passage of a roundabout, whose ring is 10 km round at most.
const BEYOND_RING_M: f64 = 6000.0;
/// How far the area of a junction may lie from the edges at its node, metres. Its roads end after 15 m; a mapped surface may be large.
const BEYOND_JUNCTION_M: f64 = 2000.0;
/// The least length of a degree of latitude, and of a degree of longitude at the equator, metres.
const DEGREE_M: [f64; 2] = [110_500.0, 111_300.0];

impl Database {
    /// A page of edges with a vehicle's certificates, in order of the network.
    ///
    /// # Errors
    /// The vehicle is not certified under this policy ([`StoreError::NotThere`]); a column of the condition does not exist; the file cannot
    /// be read.
    pub fn edge_page(&mut self, set: SetKey<'_>, ask: &PageQuery<'_>) -> Result<Vec<EdgeRow>, StoreError> {
        let vehicle_no = self.vehicle_no_of_set(set.vehicle, set.policy)?;
        let make = || -> Sql<BoundSql> {
            let mut asked = BoundSql::new(query::select(set.policy));
            asked.whole(vehicle_no.into())?;
            asked.whole(corridor_no(set.policy).into())?;
            if let Some(area) = ask.area {
                asked.sql.push_str(" AND c.fid IN ");
                near(&mut asked, area, 0.0)?;
            }
            rest(&mut asked, ask, "c.fid", "SELECT fid FROM edge WHERE edge_id = ?", &|name| {
                edge_column(set.policy, name)
            })?;
            Ok(asked)
        };
        let touches = line_filter(ask.area);
        self.page(make(), query::edge_row, ask.most, |row| touches(&row.line))
    }

    /// A page of turns with a vehicle's certificates, in order of the network.
    ///
    /// # Errors
    /// As [`Self::edge_page`].
    pub fn turn_page(&mut self, set: SetKey<'_>, ask: &PageQuery<'_>) -> Result<Vec<TurnRow>, StoreError> {
        let vehicle_no = self.vehicle_no_of_set(set.vehicle, set.policy)?;
        let make = || -> Sql<BoundSql> {
            let mut asked = BoundSql::new(format!("{} WHERE c.vehicle_no = ? AND c.corridor_no = ?", turns::select()));
            asked.whole(vehicle_no.into())?;
            asked.whole(corridor_no(set.policy).into())?;
            if let Some(area) = ask.area {
                asked.sql.push_str(" AND c.fid IN (SELECT fid FROM turn WHERE from_fid IN ");
                near(&mut asked, area, BEYOND_RING_M)?;
                asked.sql.push_str(" AND (first_arc_fid NOT NULL OR from_fid IN ");
                near(&mut asked, area, BEYOND_TURN_M)?;
                asked.sql.push_str("))");
            }
            rest(&mut asked, ask, "c.fid", "SELECT fid FROM turn WHERE turn_id = ?", &turn_column)?;
            Ok(asked)
        };
        let touches = line_filter(ask.area);
        self.page(make(), turns::turn_row, ask.most, |row| touches(&row.line))
    }

    /// A page of the areas of junctions, in order of their nodes.
    ///
    /// # Errors
    /// As [`Self::edge_page`].
    pub fn junction_page(&mut self, ask: &PageQuery<'_>) -> Result<Vec<JunctionArea>, StoreError> {
        let make = || -> Sql<BoundSql> {
            let mut asked = BoundSql::new(format!("SELECT {} FROM junction WHERE 1", junctions::COLUMNS));
            if let Some(area) = ask.area {
                asked.sql.push_str(" AND node_id IN (SELECT to_node FROM edge WHERE fid IN ");
                near(&mut asked, area, BEYOND_JUNCTION_M)?;
                asked.sql.push_str(" UNION SELECT from_node FROM edge WHERE fid IN ");
                near(&mut asked, area, BEYOND_JUNCTION_M)?;
                asked.sql.push(')');
            }
            rest(&mut asked, ask, "node_id", "?", &junction_column)?;
            Ok(asked)
        };
        let boxes = ask.area.map(|area| polygons(&Area::Bounds(area)));
        self.page(make(), junctions::junction_area, ask.most, |junction| {
            boxes.as_ref().is_none_or(|boxes| junction.polygons.iter().any(|rings| boxes.intersects(&polygon(rings))))
        })
    }

    /// The number of turns with a vehicle's certificates; 0 if its turns are not certified under this policy.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn certified_turns(&mut self, set: SetKey<'_>) -> Result<u64, StoreError> {
        let sql = "SELECT turns FROM certified_turns WHERE corridor_no = ? \
                   AND vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?)";
        let turns: Option<i64> = self.session.run(async |c| {
            sqlx::query_scalar(sql).bind(corridor_no(set.policy)).bind(set.vehicle).fetch_optional(c).await
        })?;
        Ok(turns.unwrap_or(0).unsigned_abs())
    }

    /// The number of junctions with an area.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn junctions(&mut self) -> Result<u64, StoreError> {
        let sql = "SELECT count(*) FROM junction";
        let count: i64 = self.session.run(async |c| sqlx::query_scalar(sql).fetch_one(c).await)?;
        Ok(count.unsigned_abs())
    }

    /// The first `most` rows of a statement that pass.
    fn page<T>(
        &mut self,
        asked: Sql<BoundSql>,
        read: fn(&SqliteRow) -> Sql<T>,
        most: usize,
        passes: impl Fn(&T) -> bool,
    ) -> Result<Vec<T>, StoreError> {
        let asked = asked.map_err(|e| StoreError::sql(&self.session.path, e))?;
        let mut page = Vec::new();
        for row in self.streamed_with(asked.sql, asked.values, read) {
            let row = row?;
            if passes(&row) {
                page.push(row);
            }
            if page.len() >= most {
                break;
            }
        }
        Ok(page)
    }
}

/// Adds the conditions that all features have, the order and the bound. `by_id` selects the key of a feature by its id.
fn rest(
    asked: &mut BoundSql,
    ask: &PageQuery<'_>,
    key: &str,
    by_id: &str,
    column_of: &dyn Fn(&str) -> Option<ColumnSql>,
) -> Sql<()> {
    if let Some(after) = ask.after {
        // With an area its few keys are looked up. Without the plus SQLite would go through all keys behind `after`.
        let plus = if ask.area.is_some() { "+" } else { "" };
        asked.sql.push_str(&format!(" AND {plus}{key} > ?"));
        asked.whole(after)?;
    }
    if let Some(id) = ask.id {
        asked.sql.push_str(&format!(" AND {key} = ({by_id})"));
        asked.whole(id)?;
    }
    if let Some(filter) = ask.filter {
        asked.sql.push_str(" AND ");
        asked.condition(filter, column_of)?;
    }
    asked.sql.push_str(&format!(" ORDER BY {key}"));
    // With an area rows are left out afterwards: the spatial index compares boxes only.
    if ask.area.is_none() {
        asked.sql.push_str(" LIMIT ?");
        asked.whole(i64::try_from(ask.most).unwrap_or(i64::MAX))?;
    }
    Ok(())
}

/// Adds the edges whose box comes nearer than so many metres to a box, as a list in parentheses.
fn near(asked: &mut BoundSql, area: Bounds, beyond_m: f64) -> Sql<()> {
    let boxes = if area.west <= area.east {
        vec![area]
    } else {
        vec![Bounds { east: 180.0, ..area }, Bounds { west: -180.0, ..area }]
    };
    let meets = vec!["(maxx >= ? AND minx <= ? AND maxy >= ? AND miny <= ?)"; boxes.len()].join(" OR ");
    asked.sql.push_str(&format!("(SELECT id FROM rtree_edge_geom WHERE {meets})"));
    for own in boxes {
        let Bounds { west, south, east, north } = widened(own, beyond_m);
        for side in [west, east, south, north] {
            asked.number(side)?;
        }
    }
    Ok(())
}

/// A box that is at least so many metres wider on every side.
fn widened(own: Bounds, metres: f64) -> Bounds {
    let high = metres / DEGREE_M[0];
    let farthest = (own.south.abs().max(own.north.abs()) + high).min(89.9);
    let wide = (metres / (DEGREE_M[1] * farthest.to_radians().cos())).min(360.0);
    Bounds { west: own.west - wide, south: own.south - high, east: own.east + wide, north: own.north + high }
}

/// Whether a line touches the area, as `query` has it.
fn line_filter(area: Option<Bounds>) -> impl Fn(&[LonLat]) -> bool {
    let boxes = area.map(|area| polygons(&Area::Bounds(area)));
    move |line| {
        let Some(boxes) = &boxes else { return true };
        boxes.intersects(&line.iter().map(|place| place.degrees()).collect::<geo::LineString>())
    }
}

fn polygon(rings: &[Vec<LonLat>]) -> geo::Polygon {
    let ring = |ring: &Vec<LonLat>| ring.iter().map(|place| place.degrees()).collect::<geo::LineString>();
    let mut rings = rings.iter().map(ring);
    let outer = rings.next().unwrap_or_else(|| geo::LineString(Vec::new()));
    geo::Polygon::new(outer, rings.collect())
}

/// What stands for a column of [`EdgeRow::COLUMNS`]. The columns that are the same for a whole set are left out.
fn edge_column(policy: Policy, name: &str) -> Option<ColumnSql> {
    let [width, source] = width_columns(policy);
    let own = |sql: String, is_id| Some(ColumnSql { sql, is_id });
    match name {
        "edge_id" | "way_id" | "from_node" | "to_node" => own(format!("e.{name}"), true),
        "width_m" => own(format!("e.{width}"), false),
        "width_source" => own(format!("e.{source}"), false),
        "direction" | "highway" | "name" | "ref" | "length_m" | "min_radius_m" | "maxspeed_kmh" => {
            own(format!("e.{name}"), false)
        }
        "rsc_published_m" | "need_width_m" => own(format!("c.{name}"), false),
        "uses" => own(uses::word(uses::EDGES), false),
        _ => certificate_column(name),
    }
}

/// What stands for a column of [`TurnRow::COLUMNS`]. The columns that are the same for a whole set are left out.
fn turn_column(name: &str) -> Option<ColumnSql> {
    let own = |sql: &str, is_id| Some(ColumnSql { sql: sql.to_owned(), is_id });
    match name {
        "turn_id" => own("t.turn_id", true),
        "from_edge" => own("a.edge_id", true),
        "to_edge" => own("b.edge_id", true),
        "via_node" => own("t.via_node", true),
        "first_arc" => own("(SELECT edge_id FROM edge WHERE fid = t.first_arc_fid)", true),
        "last_arc" => own("(SELECT edge_id FROM edge WHERE fid = t.last_arc_fid)", true),
        "from_name" => own("coalesce(a.name, a.ref)", false),
        "to_name" => own("coalesce(b.name, b.ref)", false),
        "kind" | "angle_deg" | "kerb_radius_m" | "kerb_source" | "restriction" => own(&format!("t.{name}"), false),
        "need_kerb_radius_m" | "need_flare_m" => own(&format!("c.{name}"), false),
        "uses" => own(&uses::word(uses::TURNS), false),
        _ => certificate_column(name),
    }
}

fn certificate_column(name: &str) -> Option<ColumnSql> {
    let sql = match name {
        "verdict" | "reason" => format!("(SELECT {name} FROM verdict AS w WHERE w.verdict_no = c.verdict_no)"),
        "rsc_m" | "hinge_margin_deg" | "shrink" | "limiting_s_m" | "limiting_unit" | "limiting_side" => {
            format!("c.{name}")
        }
        _ => return None,
    };
    Some(ColumnSql { sql, is_id: false })
}

fn junction_column(name: &str) -> Option<ColumnSql> {
    let is_id = name == "node_id";
    ["node_id", "roads", "kerb_source"].contains(&name).then(|| ColumnSql { sql: name.to_owned(), is_id })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_of_a_row_has_its_sql_except_what_the_set_says() {
        let of_set = ["vehicle_id", "corridor"];
        for (name, _) in EdgeRow::COLUMNS {
            for &policy in <Policy as crate::words::Named>::ALL {
                assert_eq!(edge_column(policy, name).is_none(), of_set.contains(&name), "{name}");
            }
        }
        for (name, _) in TurnRow::COLUMNS {
            assert_eq!(turn_column(name).is_none(), of_set.contains(&name), "{name}");
        }
        assert!(edge_column(Policy::Lane, "geom").is_none() && junction_column("geom").is_none());
    }

    #[test]
    fn a_widened_box_is_wider_by_at_least_so_many_metres() {
        for lat in [0.0, 49.0, -70.0] {
            let own = Bounds { west: 8.0, south: lat, east: 8.1, north: lat + 0.1 };
            let wide = widened(own, 1000.0);
            // A degree of longitude is shortest where the box is farthest from the equator.
            let metre = 111_320.0 * own.south.abs().max(own.north.abs()).to_radians().cos();
            assert!((own.west - wide.west) * metre >= 1000.0 && (wide.east - own.east) * metre >= 1000.0);
            assert!((wide.north - own.north) * 110_574.0 >= 1000.0 && (own.south - wide.south) * 110_574.0 >= 1000.0);
        }
    }
}
