//! Writes turns and their certificates, and reads them for `query`, `explain` and `stats`.
//!
//! A set of certificates of turns is complete or absent, like a set of certificates of edges.

use std::io;

use serde::{Deserialize, Serialize};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Row as _};

use crate::network::{EdgeNo, Movement, Network, PassageKind};
use crate::osm::NodeId;
use crate::osm::facts::Policy;
use crate::words::VerdictKind;
use netcert_roads::turns::{JunctionArea, KerbSource, TurnFacts, TurnNo};
use netcert_rows::{Bounds, StoredPlan, TurnCertificate, TurnCount, TurnRow};

use crate::columns::names::{corridor_no, of_kind};
use crate::columns::read::{centimetres, line, verdict, word};
use crate::columns::set_no::SetNo;
use crate::columns::uses;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::blob;
use crate::file::bulk::{Bulk, Takes};
use crate::layers::contents::LayerTable;
use crate::layers::styles::{self, Shows};
use crate::results::compact::CompactCertificate;
use crate::results::complete::{Complete, Fault, check_complete};
use crate::results::numbers;
use crate::results::plans;
use crate::results::query::{Area, polygons};
use crate::roads::junctions;
use crate::roads::key::turn_key;

type Sql<T> = Result<T, sqlx::Error>;

const COLUMNS: &str = "turn_certificate_compact (vehicle_no, corridor_no, fid, verdict_no, rsc_mm, rsc_published_mm, \
                       hinge_margin_cdeg, shrink_milli, limiting_s_dm, limiting_at, need_kerb_cm, need_flare_cm, \
                       path_no)";

/// All turns of a network, and one vehicle's certificates of them.
pub struct TurnSet<'a> {
    /// The network of the turns.
    pub network: &'a Network,
    /// All turns of the network, in order.
    pub facts: &'a [TurnFacts],
    /// The areas of its junctions. They are written with the turns if the database has none yet.
    pub junctions: &'a [JunctionArea],
    /// One certificate per turn, in any order.
    pub certificates: Vec<TurnCertificate>,
}

/// A packed set: rows in order, and the plans that the certificates were made for.
pub(crate) struct PackedSet {
    pub(crate) rows: Vec<CompactCertificate>,
    pub(crate) plans: Vec<StoredPlan>,
}

impl TurnSet<'_> {
    /// Packs the set. The error names a turn whose certificate is missing or whose numbers do not support its verdict.
    pub(crate) fn pack(&mut self) -> Result<PackedSet, (u32, String)> {
        let pack = |turn: &TurnCertificate| CompactCertificate::turn(turn).map_err(|why| (turn.turn.get(), why));
        let mut rows = self.certificates.iter().map(pack).collect::<Result<Vec<CompactCertificate>, _>>()?;
        rows.sort_unstable_by_key(|row| row.fid);
        check_complete(&rows, self.facts.len() as u32).map_err(|(turn, why)| (turn, why.to_owned()))?;
        let plans = self.certificates.iter_mut().filter_map(|turn| turn.plan.take()).collect();
        Ok(PackedSet { rows, plans })
    }
}

/// A turn with all that its row says: it can be written without the network.
#[derive(PartialEq, Serialize, Deserialize)]
pub(crate) struct TurnRecord {
    /// With numbers of edges of the whole network, and no index of a restriction.
    facts: TurnFacts,
    via_node: NodeId,
    /// The tagged words of the restriction that forbids the turn.
    restriction: Option<String>,
    passage: Option<PassageKind>,
}

/// The place of a turn in the order of the whole network ([`netcert_roads::turns::turn_facts`]): passages last, then by node, by edge before and by
/// edge after. Passages have no node.
pub(crate) type TurnOrder = (bool, NodeId, EdgeNo, EdgeNo);

impl TurnRecord {
    /// The record of a turn of a network. `number` returns the number of an edge in the whole network.
    pub(crate) fn new(network: &Network, facts: &TurnFacts, number: impl Fn(EdgeNo) -> EdgeNo) -> Self {
        let via_node = network.edges.get(facts.movement.from.index()).map_or(NodeId::new(0), |edge| edge.to_node);
        let forbids = facts.movement.forbidden.and_then(|no| network.restrictions.get(no as usize));
        let restriction = forbids.map(|restriction| restriction.kind.name());
        let passage = network.passage_kind(&facts.through);
        let Movement { from, to, .. } = facts.movement;
        let movement = Movement { from: number(from), to: number(to), forbidden: None, ..facts.movement };
        let through = facts.through.iter().map(|&edge| number(edge)).collect();
        Self { facts: TurnFacts { movement, through, ..facts.clone() }, via_node, restriction, passage }
    }

    pub(crate) fn key(&self) -> TurnOrder {
        let Movement { from, to, .. } = self.facts.movement;
        let passage = !self.facts.through.is_empty();
        (passage, if passage { NodeId::new(0) } else { self.via_node }, from, to)
    }
}

/// The kind of a turn by its angle, such as `left` or `slight_right`. A passage has the kind of its junction.
fn kind(facts: &TurnFacts, passage: Option<PassageKind>) -> &'static str {
    match facts.angle_deg {
        _ if passage.is_some() => passage.map_or("", PassageKind::name),
        a if a > 150.0 => "sharp_left",
        a if a > 35.0 => "left",
        a if a > 0.0 => "slight_left",
        a if a > -35.0 => "slight_right",
        a if a > -150.0 => "right",
        _ => "sharp_right",
    }
}

/// Writes turns into the table `turn` and returns the box around them. Each comes with its number in the whole network.
pub(crate) async fn write(
    to: &mut impl Takes,
    turns: impl Iterator<Item = io::Result<(TurnNo, TurnRecord)>>,
) -> Sql<Option<Bounds>> {
    let mut bulk = Bulk::new("turn", 13);
    let mut bounds: Option<Bounds> = None;
    for turn in turns {
        let (index, TurnRecord { facts, via_node, restriction, passage }) = turn?;
        let (geom, around) = blob::encode(facts.line.iter().copied()).ok_or_else(|| content("a turn has no line"))?;
        bounds = Some(bounds.map_or(around, |b| b.union(around)));
        bulk.add(i64::from(index) + 1);
        bulk.add(facts.id);
        bulk.add(i64::from(facts.movement.from) + 1);
        bulk.add(i64::from(facts.movement.to) + 1);
        bulk.add(via_node.get());
        bulk.add(geom);
        bulk.add((facts.angle_deg * 10.0).round() / 10.0);
        bulk.add(kind(&facts, passage));
        bulk.add(facts.kerb_radius_m);
        bulk.add(facts.kerb_source.map(KerbSource::name));
        bulk.add(restriction.as_deref());
        for arc in [facts.through.first(), facts.through.last()] {
            bulk.add(arc.map(|&arc| i64::from(arc) + 1));
        }
        bulk.end_row(to).await?;
    }
    bulk.finish(to).await?;
    Ok(bounds)
}

/// Registers the turns as a layer.
pub(crate) async fn register(c: &mut SqliteConnection, bounds: Option<Bounds>, time: &str) -> Sql<()> {
    let layer = LayerTable { table: "turn", geometries: "LINESTRING", description: "Turns at junctions", bounds };
    layer.add(c, time).await?;
    styles::add(c, "turn", Shows::Turns, time).await
}

/// Inserts certificates of turns.
pub(crate) async fn insert_rows(
    c: &mut SqliteConnection,
    set: SetNo,
    rows: impl Iterator<Item = io::Result<CompactCertificate>>,
) -> Sql<()> {
    let mut bulk = Bulk::new(COLUMNS, 13);
    for row in rows {
        let row = row?;
        bulk.add(set.vehicle_no);
        bulk.add(set.corridor_no());
        row.add_to(&mut bulk);
        bulk.add(row.needs_cm[1]);
        bulk.add(row.path_no);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await
}

/// Inserts a set with the certificates of this number of turns. The database must not have the set yet. After a fault, what was inserted
/// must be thrown away.
pub(crate) async fn insert(
    c: &mut SqliteConnection,
    set: SetNo,
    run_id: i64,
    rows: impl Iterator<Item = io::Result<CompactCertificate>>,
    plans: impl Iterator<Item = io::Result<StoredPlan>>,
    turns: u32,
) -> Sql<Result<(), Fault>> {
    let mut complete = Complete::new(turns);
    let rows = rows.inspect(|row| row.iter().for_each(|row| complete.look_at(row)));
    insert_rows(c, set, rows).await?;
    plans::insert(c, plans::TURNS, set, plans).await?;
    let rows = match complete.finish() {
        Ok(rows) => rows,
        Err(fault) => return Ok(Err(fault)),
    };
    let insert = sqlx::query("INSERT INTO certified_turns VALUES (?, ?, ?, ?)").bind(set.vehicle_no);
    insert.bind(set.corridor_no()).bind(run_id).bind(rows).execute(c).await?;
    Ok(Ok(()))
}

/// Removes a set, if there is one.
pub(crate) async fn remove(c: &mut SqliteConnection, set: SetNo) -> Sql<()> {
    for table in ["certified_turns", "turn_plan", "turn_certificate_compact"] {
        let sql = format!("DELETE FROM {table} WHERE vehicle_no = ? AND corridor_no = ?");
        sqlx::query(AssertSqlSafe(sql)).bind(set.vehicle_no).bind(set.corridor_no()).execute(&mut *c).await?;
    }
    Ok(())
}

/// The conditions of a query of turns. All of them must hold.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnQuery {
    /// Vehicle id.
    pub vehicle: String,
    /// The policy of the certificates.
    pub policy: Policy,
    /// Only turns whose line touches this area.
    pub area: Option<Area>,
    /// Only the turn with this `turn_id`.
    pub turn_id: Option<i64>,
    /// Only turns with this verdict.
    pub verdict: Option<VerdictKind>,
    /// Only turns with at least this RSC, metres.
    pub min_rsc_m: Option<f64>,
    /// Only turns whose kerb radius would be enough with at most this much more, metres.
    pub needs_at_most_m: Option<f64>,
    /// Only turns for which this is the narrowest policy under which they are safe.
    pub uses: Option<Policy>,
}

impl TurnQuery {
    /// Every turn of a vehicle.
    #[must_use]
    pub fn new(vehicle: &str, policy: Policy) -> Self {
        let vehicle = vehicle.to_owned();
        Self {
            vehicle,
            policy,
            area: None,
            turn_id: None,
            verdict: None,
            min_rsc_m: None,
            needs_at_most_m: None,
            uses: None,
        }
    }
}

impl Database {
    /// Whether the database has the turns of its network.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn keeps_turns(&mut self) -> Result<bool, StoreError> {
        let layers: i64 = self.session.run(async |c| {
            sqlx::query_scalar("SELECT count(*) FROM gpkg_contents WHERE table_name = 'turn'").fetch_one(c).await
        })?;
        Ok(layers > 0)
    }

    /// Whether this vehicle's turns are certified under this policy.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn has_turns(&mut self, vehicle: &str, policy: Policy) -> Result<bool, StoreError> {
        let count: i64 = self.session.run(async |c| {
            let sql = "SELECT count(*) FROM certified_turns JOIN vehicle USING (vehicle_no) \
                       WHERE vehicle_id = ? AND corridor_no = ?";
            sqlx::query_scalar(sql).bind(vehicle).bind(corridor_no(policy)).fetch_one(c).await
        })?;
        Ok(count > 0)
    }

    /// Turns with their certificates, in order of the network.
    ///
    /// # Errors
    /// The vehicle's turns are not certified here ([`StoreError::NotThere`]); the file cannot be read.
    pub fn query_turns(&mut self, options: &TurnQuery) -> Result<Vec<TurnRow>, StoreError> {
        if !self.has_turns(&options.vehicle, options.policy)? {
            return Err(StoreError::turns_not_certified(&self.session.path, &options.vehicle, options.policy));
        }
        if let Some(strip) = options.uses
            && !self.has_turns(&options.vehicle, strip)?
        {
            return Err(StoreError::turns_not_certified(&self.session.path, &options.vehicle, strip));
        }
        let area = options.area.as_ref().map(polygons);
        let mut rows = self.session.run(async |c| fetch(c, options).await)?;
        if let Some(area) = area {
            use geo::Intersects as _;
            rows.retain(|row| {
                area.intersects(&row.line.iter().map(|place| place.degrees()).collect::<geo::LineString>())
            });
        }
        Ok(rows)
    }
}

/// Inserts a vehicle's certificates of turns, and the turns themselves if the database has none yet. The database must not
/// have certificates of turns for this vehicle and policy.
pub(crate) async fn insert_set(
    c: &mut SqliteConnection,
    set: SetNo,
    run_id: i64,
    made: &TurnSet<'_>,
    packed: &mut PackedSet,
    time: &str,
) -> Sql<()> {
    let (kept, layers): (i64, i64) = sqlx::query_as(
        "SELECT (SELECT count(*) FROM turn), (SELECT count(*) FROM gpkg_contents WHERE table_name = 'turn')",
    )
    .fetch_one(&mut *c)
    .await?;
    if layers == 0 {
        let record = |(index, facts)| Ok((index, TurnRecord::new(made.network, facts, |edge| edge)));
        let bounds = write(c, TurnNo::all().zip(made.facts).map(record)).await?;
        register(c, bounds, time).await?;
        let around = junctions::insert(c, made.junctions.iter().cloned().map(Ok)).await?;
        junctions::register(c, around, time).await?;
    } else if kept != made.facts.len() as i64 {
        return Err(content(format!("{kept} turns are stored, the network has {}", made.facts.len())));
    }
    let (rows, plans) = (packed.rows.iter().copied().map(Ok), plans::sorted(&mut packed.plans));
    let inserted = insert(c, set, run_id, rows, plans, packed.rows.len() as u32).await?;
    inserted.map_err(|(turn, detail)| content(format!("turn {turn}: {detail}")))
}

async fn fetch(c: &mut SqliteConnection, options: &TurnQuery) -> Sql<Vec<TurnRow>> {
    let rows = sqlx::query(AssertSqlSafe(statement(options))).bind(&options.vehicle).bind(corridor_no(options.policy));
    rows.fetch_all(c).await?.iter().map(turn_row).collect()
}

/// The columns that [`turn_row`] reads.
pub(crate) fn select() -> String {
    let mut sql = "SELECT c.fid, t.turn_id, a.edge_id, b.edge_id, t.via_node, t.angle_deg, t.kind, t.kerb_radius_m, \
                   t.kerb_source, t.restriction, coalesce(a.name, a.ref), coalesce(b.name, b.ref), c.path_no, t.geom, \
                   (SELECT edge_id FROM edge WHERE fid = t.first_arc_fid), \
                   (SELECT edge_id FROM edge WHERE fid = t.last_arc_fid), c.need_kerb_cm, c.need_flare_cm, "
        .to_owned();
    sql += numbers::COLUMNS;
    sql += &format!(", {}", uses::number(uses::TURNS));
    sql + " FROM turn_certificate_compact AS c CROSS JOIN turn AS t ON t.fid = c.fid \
           CROSS JOIN edge AS a ON a.fid = t.from_fid CROSS JOIN edge AS b ON b.fid = t.to_fid"
}

/// The statement of a query, whose rows [`turn_row`] reads. The caller binds the vehicle's id and the corridor's number.
pub(crate) fn statement(options: &TurnQuery) -> String {
    let mut sql = select()
        + " WHERE c.corridor_no = ?2 AND c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?1)";
    if let Some(kind) = options.verdict {
        sql += &format!(" AND {}", of_kind("c.verdict_no", kind));
    }
    if let Some(rsc_m) = options.min_rsc_m {
        sql += &format!(" AND c.rsc_mm >= {}", rsc_m * 1000.0);
    }
    if let Some(more_m) = options.needs_at_most_m {
        sql += &format!(" AND c.need_kerb_cm <= 100.0 * (t.kerb_radius_m + {more_m}) + 1e-6");
    }
    if let Some(strip) = options.uses {
        sql += &format!(" AND {}", uses::is(uses::TURNS, strip));
    }
    if let Some(id) = options.turn_id {
        sql += &format!(" AND c.fid = (SELECT fid FROM turn WHERE turn_id = {id})");
    }
    sql + " ORDER BY c.fid"
}

pub(crate) fn turn_row(row: &SqliteRow) -> Sql<TurnRow> {
    let fid: u32 = row.try_get(0)?;
    Ok(TurnRow {
        turn: turn_key(row, 10)?,
        arcs: row.try_get::<Option<i64>, _>(14)?.zip(row.try_get(15)?).map(|(first, last)| [first, last]),
        via_node: NodeId::new(row.try_get(4)?),
        angle_deg: row.try_get(5)?,
        kind: row.try_get(6)?,
        kerb_radius_m: row.try_get(7)?,
        kerb_source: row.try_get(8)?,
        restriction: row.try_get(9)?,
        need_kerb_radius_m: centimetres(row, 16)?,
        need_flare_m: centimetres(row, 17)?,
        certificate: numbers::read(row, 18, || format!("turn {fid}"))?,
        uses: uses::read(row, 25)?,
        path_no: row.try_get(12)?,
        line: line(row, 13, || format!("turn {fid}"))?,
    })
}

/// The number of turns by vehicle, policy and verdict.
pub(crate) async fn counts(c: &mut SqliteConnection) -> Sql<Vec<TurnCount>> {
    let sql = "SELECT vehicle_id, corridor, verdict_no, n FROM (SELECT vehicle_no, corridor_no, verdict_no, count(*) AS n \
               FROM turn_certificate_compact GROUP BY vehicle_no, corridor_no, verdict_no) JOIN vehicle USING (vehicle_no) \
               JOIN corridor USING (corridor_no) ORDER BY vehicle_no, corridor_no, verdict_no";
    let count = |row: &SqliteRow| -> Sql<TurnCount> {
        Ok(TurnCount {
            vehicle_id: row.try_get(0)?,
            policy: word(row, 1)?,
            verdict: verdict(row, 2, || "a count".to_owned())?,
            turns: row.try_get::<i64, _>(3)?.unsigned_abs(),
        })
    };
    sqlx::query(sql).fetch_all(c).await?.iter().map(count).collect()
}
