//! Streams the rows that an export reads: the facts that permits depend on, without geometry, and turns with all columns.
//!
//! Rows come in order of the network. Only some rows are in memory at the same time, whatever the size of the network.

use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::network::EdgeNo;
use crate::osm::NodeId;
use crate::osm::facts::{Policy, class_and_link};
use netcert_base::verdict::Verdict;
use netcert_rows::{EdgeRung, EdgeStep, TurnRow, TurnStep};

use crate::columns::names::{SAFE, width_columns};
use crate::columns::read::{edge_of, turn_of, verdict, word_or_none};
use crate::columns::uses;
use crate::database::Database;
use crate::database::row_stream::RowStream;
use crate::error::{StoreError, content};
use crate::file::blob;
use crate::results::turns::{self, TurnQuery};
use crate::roads::key::edge_key;

type Sql<T> = Result<T, sqlx::Error>;

/// An edge with its verdict and its RSC, metres, if it was computed.
pub type EdgeConclusion = (EdgeNo, Verdict, Option<f64>);

/// The first and the last edge of a turn with its verdict and its RSC, metres, if it was computed.
pub type TurnConclusion = ([EdgeNo; 2], Verdict, Option<f64>);

/// An edge and the edge that follows it straight on along its stroke. `None` means that the stroke ends.
pub type StraightOn = (EdgeNo, Option<EdgeNo>);

impl Database {
    /// The facts of every edge for a vehicle. There are no rows if the vehicle is not certified under this policy.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_steps(&mut self, vehicle: &str, policy: Policy) -> Result<RowStream<'_, EdgeStep>, StoreError> {
        let [_, source] = width_columns(policy);
        let sql = format!(
            "SELECT c.fid, e.edge_id, e.way_id, e.from_node, e.to_node, e.direction, e.shape_start, length(e.geom), \
             c.verdict_no, c.rsc_mm, e.{source} FROM certificate_compact AS c CROSS JOIN edge AS e ON e.fid = c.fid \
             WHERE c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND c.corridor_no = ? ORDER BY c.fid"
        );
        Ok(self.streamed(sql, vehicle, policy, edge_step))
    }

    /// The verdict and RSC of every edge for a vehicle. There are no rows if the vehicle is not certified under this policy.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_conclusions(
        &mut self,
        vehicle: &str,
        policy: Policy,
    ) -> Result<RowStream<'_, EdgeConclusion>, StoreError> {
        let sql = "SELECT fid, verdict_no, rsc_mm FROM certificate_compact \
                   WHERE vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND corridor_no = ? ORDER BY fid";
        Ok(self.streamed(sql.to_owned(), vehicle, policy, edge_conclusion))
    }

    /// The facts of every turn for a vehicle. There are no rows if its turns are not certified: see [`Database::has_turns`].
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn turn_steps(&mut self, vehicle: &str, policy: Policy) -> Result<RowStream<'_, TurnStep>, StoreError> {
        let sql = "SELECT c.fid, t.from_fid, t.to_fid, t.first_arc_fid, t.last_arc_fid, t.via_node, t.angle_deg, \
                   c.verdict_no, c.rsc_mm FROM turn_certificate_compact AS c CROSS JOIN turn AS t ON t.fid = c.fid \
                   WHERE c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND c.corridor_no = ? \
                   ORDER BY c.fid";
        Ok(self.streamed(sql.to_owned(), vehicle, policy, turn_step))
    }

    /// The verdict and RSC of every turn for a vehicle. There are no rows if its turns are not certified: see [`Database::has_turns`].
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn turn_conclusions(
        &mut self,
        vehicle: &str,
        policy: Policy,
    ) -> Result<RowStream<'_, TurnConclusion>, StoreError> {
        let sql = "SELECT t.from_fid, t.to_fid, c.verdict_no, c.rsc_mm \
                   FROM turn_certificate_compact AS c CROSS JOIN turn AS t ON t.fid = c.fid \
                   WHERE c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND c.corridor_no = ? \
                   ORDER BY c.fid";
        Ok(self.streamed(sql.to_owned(), vehicle, policy, turn_conclusion))
    }

    /// The narrowest strip on which each safe edge is safe, whatever the policy under which it is asked for.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_rungs(&mut self, vehicle: &str, policy: Policy) -> Result<RowStream<'_, EdgeRung>, StoreError> {
        let sql = format!(
            "SELECT c.fid, {uses}, e.highway FROM certificate_compact AS c CROSS JOIN edge AS e ON e.fid = c.fid \
             WHERE c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND c.corridor_no = ? \
             AND c.verdict_no = {SAFE} ORDER BY c.fid",
            uses = uses::number(uses::EDGES)
        );
        Ok(self.streamed(sql, vehicle, policy, edge_rung))
    }

    /// Every turn of a vehicle with all columns. There are no rows if its turns are not certified.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn turn_rows(&mut self, vehicle: &str, policy: Policy) -> Result<RowStream<'_, TurnRow>, StoreError> {
        let sql = turns::statement(&TurnQuery::new(vehicle, policy));
        Ok(self.streamed(sql, vehicle, policy, turns::turn_row))
    }

    /// The sequences of edges (by their numbers) of turn restrictions. They are few, so all are read at once.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn forbidden_sequences(&mut self) -> Result<Vec<Vec<EdgeNo>>, StoreError> {
        self.session.run(async |c| {
            let sql = "SELECT r.restriction_no, e.fid FROM restriction AS r JOIN restriction_edge AS e \
                       ON e.position > r.edge_start AND e.position <= r.edge_end ORDER BY r.restriction_no, e.position";
            let rows: Vec<(i64, u32)> = sqlx::query_as(sql).fetch_all(c).await?;
            let edges = |rows: &[(i64, u32)]| rows.iter().map(|row| edge_of(row.1)).collect();
            Ok(rows.chunk_by(|a, b| a.0 == b.0).map(edges).collect())
        })
    }

    /// Every edge of a stroke with the edge that follows it straight on, stroke by stroke.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn straight_on(&mut self) -> Result<RowStream<'_, StraightOn>, StoreError> {
        let sql = "SELECT a.fid, coalesce(b.fid, CASE WHEN s.closed THEN \
                   (SELECT fid FROM stroke_edge WHERE position = s.edge_start + 1) END) \
                   FROM stroke AS s JOIN stroke_edge AS a ON a.position > s.edge_start AND a.position <= s.edge_end \
                   LEFT JOIN stroke_edge AS b ON b.position = a.position + 1 AND b.position <= s.edge_end \
                   ORDER BY s.stroke_no, a.position";
        Ok(self.streamed_plainly(sql.to_owned(), straight_on))
    }

    /// The arcs of roundabouts (by their numbers), each ring in driving order. They are few, so all are read at
    /// once.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn rings(&mut self) -> Result<Vec<Vec<EdgeNo>>, StoreError> {
        self.session.run(async |c| {
            let sql = "SELECT s.stroke_no, a.fid \
                       FROM stroke AS s JOIN stroke_edge AS a ON a.position > s.edge_start AND a.position <= s.edge_end \
                       JOIN edge AS e ON e.fid = a.fid JOIN road AS r ON r.road_no = e.road_no \
                       WHERE r.roundabout ORDER BY s.stroke_no, a.position";
            let rows: Vec<(i64, u32)> = sqlx::query_as(sql).fetch_all(c).await?;
            let arcs = |rows: &[(i64, u32)]| rows.iter().map(|row| edge_of(row.1)).collect();
            Ok(rows.chunk_by(|a, b| a.0 == b.0).map(arcs).collect())
        })
    }
}

fn straight_on(row: &SqliteRow) -> Sql<StraightOn> {
    let next: Option<u32> = row.try_get(1)?;
    Ok((edge_of(row.try_get(0)?), next.map(edge_of)))
}

fn edge_conclusion(row: &SqliteRow) -> Sql<EdgeConclusion> {
    let fid: u32 = row.try_get(0)?;
    Ok((edge_of(fid), verdict(row, 1, || format!("edge {fid}"))?, metres(row, 2)?))
}

fn turn_conclusion(row: &SqliteRow) -> Sql<TurnConclusion> {
    let ends: [u32; 2] = [row.try_get(0)?, row.try_get(1)?];
    let of = || format!("the turn from edge {} into edge {}", ends[0], ends[1]);
    Ok((ends.map(edge_of), verdict(row, 2, of)?, metres(row, 3)?))
}

fn edge_step(row: &SqliteRow) -> Sql<EdgeStep> {
    let fid: u32 = row.try_get(0)?;
    let positions = blob::positions_of(row.try_get::<u32, _>(7)? as usize)
        .ok_or_else(|| content(format!("edge {fid} has a geometry that is no line")))?;
    Ok(EdgeStep {
        edge: edge_key(row, 1)?,
        shape_start: row.try_get(6)?,
        positions,
        verdict: verdict(row, 8, || format!("edge {fid}"))?,
        rsc_m: metres(row, 9)?,
        width_source: word_or_none(row, 10)?,
    })
}

fn edge_rung(row: &SqliteRow) -> Sql<EdgeRung> {
    let fid: u32 = row.try_get(0)?;
    let highway: &str = row.try_get(2)?;
    let (class, _) = class_and_link(highway).ok_or_else(|| content(format!("edge {fid}: highway {highway}")))?;
    let uses = uses::read(row, 1)?.ok_or_else(|| content(format!("edge {fid} is safe and uses no strip")))?;
    Ok(EdgeRung { edge: edge_of(fid), uses, class })
}

fn turn_step(row: &SqliteRow) -> Sql<TurnStep> {
    let fid: u32 = row.try_get(0)?;
    let index = |column| -> Sql<EdgeNo> { Ok(edge_of(row.try_get(column)?)) };
    let arc = |column| -> Sql<Option<EdgeNo>> { Ok(row.try_get::<Option<u32>, _>(column)?.map(edge_of)) };
    Ok(TurnStep {
        turn: turn_of(fid),
        from: index(1)?,
        to: index(2)?,
        arcs: arc(3)?.zip(arc(4)?).map(|(first, last)| [first, last]),
        via_node: NodeId::new(row.try_get(5)?),
        angle_deg: row.try_get(6)?,
        verdict: verdict(row, 7, || format!("turn {fid}"))?,
        rsc_m: metres(row, 8)?,
    })
}

fn metres(row: &SqliteRow, column: usize) -> Sql<Option<f64>> {
    Ok(row.try_get::<Option<i64>, _>(column)?.map(|mm| mm as f64 / 1000.0))
}
