//! Changes the register of measurements and all that depends on it, in one transaction: the columns of `edge` and `turn`, and the
//! certificates of the edges and turns that see a change. If the program is killed, everything is as before.

use sqlx::sqlite::SqliteConnection;
use sqlx::{AssertSqlSafe, Row as _};

use crate::account::AccountRow;
use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use crate::osm::facts::Policy;
use netcert_roads::turns::{JunctionArea, KerbSource, TurnFacts};
use netcert_rows::{EdgeCertificate, EdgeMeasure, StoredPlan, TurnCertificate};

use crate::columns::read::rows;
use crate::columns::set_no::SetNo;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::bulk::Bulk;
use crate::layers::descriptions;
use crate::provenance::records::{self, Run};
use crate::register::evidence::{self, Register};
use crate::results::compact::CompactCertificate;
use crate::results::plans;
use crate::results::sets;
use crate::results::turns;
use crate::roads::junctions;
use crate::roads::network_write::add_widths;

type Sql<T> = Result<T, sqlx::Error>;

/// The part of a set of certificates that was made again.
pub struct SetRenewal {
    /// Id of the vehicle.
    pub vehicle: String,
    /// Policy of the set.
    pub policy: Policy,
    /// One certificate for each edge of the strokes that were certified again.
    pub edges: Vec<EdgeCertificate>,
    /// Plans of those strokes.
    pub plans: Vec<StoredPlan>,
    /// Certificates of turns.
    pub turns: Vec<TurnCertificate>,
}

/// All that changes.
pub struct Renewal<'a> {
    /// The network with what the new register says.
    pub network: &'a Network,
    /// The new register.
    pub register: &'a Register,
    /// Edges whose widths or centrelines may differ, with the measures of their corridors.
    pub edges: &'a [(EdgeNo, EdgeMeasure)],
    /// All turns of the network, if the database has turns and any of their kerbs may differ.
    pub turns: Option<&'a [TurnFacts]>,
    /// If the database has turns: nodes whose junctions may differ, and the areas that these junctions have now.
    pub junctions: Option<(&'a [NodeId], &'a [JunctionArea])>,
    /// Certificates.
    pub sets: Vec<SetRenewal>,
    /// The record of the run.
    pub run: &'a Run,
    /// Its account.
    pub account: &'a [AccountRow],
}

impl Database {
    /// Begins a change: until [`Self::renew`], no other program changes the file, so what is read meanwhile stays true. Dropping the
    /// database instead leaves everything as it was.
    ///
    /// # Errors
    /// Another program is writing the file.
    pub fn begin_change(&mut self) -> Result<(), StoreError> {
        self.session.run(async |c| sqlx::query("BEGIN IMMEDIATE").execute(c).await.map(|_| ()))
    }

    /// Ends a change that [`Self::begin_change`] began: writes everything, or nothing.
    ///
    /// # Errors
    /// Something may not or cannot be stored. Everything is then as before.
    pub fn renew(&mut self, renewal: &mut Renewal<'_>) -> Result<(), StoreError> {
        let mut packed = Vec::new();
        for set in &mut renewal.sets {
            packed.push(pack(set)?);
        }
        self.session.run(async |c| {
            let done = write(c, renewal, &packed).await;
            let end = if done.is_ok() { "COMMIT" } else { "ROLLBACK" };
            let ended = sqlx::query(end).execute(&mut *c).await;
            done.and(ended.map(|_| ()))
        })
    }
}

/// A set's rows, ready to be written.
pub(crate) struct PackedRenewal {
    edges: Vec<CompactCertificate>,
    turns: Vec<CompactCertificate>,
    turn_plans: Vec<StoredPlan>,
}

pub(crate) fn pack(set: &mut SetRenewal) -> Result<PackedRenewal, StoreError> {
    let vehicle = &set.vehicle;
    let unsound = |edge, detail| StoreError::Unsound { edge, vehicle: vehicle.clone(), detail };
    let edge = |known: &EdgeCertificate| CompactCertificate::edge(known).map_err(|why| unsound(known.edge.get(), why));
    let turn = |known: &TurnCertificate| CompactCertificate::turn(known).map_err(|why| unsound(known.turn.get(), why));
    let mut edges = set.edges.iter().map(edge).collect::<Result<Vec<_>, _>>()?;
    let mut turns = set.turns.iter().map(turn).collect::<Result<Vec<_>, _>>()?;
    edges.sort_unstable_by_key(|row| row.fid);
    turns.sort_unstable_by_key(|row| row.fid);
    let turn_plans = set.turns.iter_mut().filter_map(|turn| turn.plan.take()).collect();
    Ok(PackedRenewal { edges, turns, turn_plans })
}

async fn write(c: &mut SqliteConnection, renewal: &mut Renewal<'_>, packed: &[PackedRenewal]) -> Sql<()> {
    let Renewal { network, register, edges, turns, junctions, sets, run, account } = renewal;
    evidence::write(c, register, &run.finished).await?;
    change_edges(c, network, edges).await?;
    if let Some(facts) = turns {
        change_kerbs(c, facts).await?;
    }
    if let Some((nodes, areas)) = junctions {
        junctions::replace(c, nodes, areas).await?;
    }
    replace_sets(c, sets, packed).await?;
    records::add_run(c, run, account).await?;
    sqlx::query("UPDATE gpkg_contents SET last_change = ?").bind(&run.finished).execute(&mut *c).await?;
    descriptions::describe(c).await
}

/// Replaces some certificates of some sets, with their plans.
pub(crate) async fn replace_sets(
    c: &mut SqliteConnection,
    sets: &mut [SetRenewal],
    packed: &[PackedRenewal],
) -> Sql<()> {
    for (set, packed) in sets.iter_mut().zip(packed) {
        let number = sqlx::query_scalar("SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?");
        let vehicle_no: u32 = number.bind(&set.vehicle).fetch_one(&mut *c).await?;
        replace(c, SetNo { vehicle_no, policy: set.policy }, set, packed).await?;
    }
    Ok(())
}

/// Replaces some certificates of a set, with their plans.
async fn replace(c: &mut SqliteConnection, of: SetNo, set: &mut SetRenewal, packed: &PackedRenewal) -> Sql<()> {
    remove(c, ["certificate_compact", "plan"], of, &packed.edges).await?;
    sets::insert_rows(c, of, packed.edges.iter().copied().map(Ok)).await?;
    plans::insert(c, plans::STROKES, of, plans::sorted(&mut set.plans)).await?;
    remove(c, ["turn_certificate_compact", "turn_plan"], of, &packed.turns).await?;
    turns::insert_rows(c, of, packed.turns.iter().copied().map(Ok)).await?;
    plans::insert(c, plans::TURNS, of, plans::sorted(&mut packed.turn_plans.clone())).await
}

async fn remove(
    c: &mut SqliteConnection,
    tables: [&'static str; 2],
    set: SetNo,
    rows: &[CompactCertificate],
) -> Sql<()> {
    for table in tables {
        let sql: std::sync::Arc<str> =
            format!("DELETE FROM {table} WHERE vehicle_no = ? AND corridor_no = ? AND fid = ?").into();
        for row in rows {
            let delete = sqlx::query(AssertSqlSafe(std::sync::Arc::clone(&sql)));
            delete.bind(set.vehicle_no).bind(set.corridor_no()).bind(row.fid).execute(&mut *c).await?;
        }
    }
    Ok(())
}

/// The triggers that keep the spatial index of edges. They call functions that SQLite alone does not have, so they are away while rows
/// of `edge` are written.
pub(crate) struct Triggers(Vec<(String, String)>);

impl Triggers {
    pub(crate) async fn remove(c: &mut SqliteConnection) -> Sql<Self> {
        let triggers =
            "SELECT name, sql FROM sqlite_schema WHERE type = 'trigger' AND tbl_name = 'edge' ORDER BY rowid";
        let triggers: Vec<(String, String)> = sqlx::query_as(triggers).fetch_all(&mut *c).await?;
        for (name, _) in &triggers {
            let name = name.replace('"', "\"\"");
            sqlx::query(AssertSqlSafe(format!("DROP TRIGGER \"{name}\""))).persistent(false).execute(&mut *c).await?;
        }
        Ok(Self(triggers))
    }

    pub(crate) async fn restore(self, c: &mut SqliteConnection) -> Sql<()> {
        for (_, sql) in self.0 {
            sqlx::query(AssertSqlSafe(sql)).persistent(false).execute(&mut *c).await?;
        }
        Ok(())
    }
}

/// Writes the widths of edges and the measures of their corridors. No geometry changes.
async fn change_edges(c: &mut SqliteConnection, network: &Network, edges: &[(EdgeNo, EdgeMeasure)]) -> Sql<()> {
    if edges.is_empty() {
        return Ok(());
    }
    let triggers = Triggers::remove(c).await?;
    sqlx::query(
        "CREATE TEMP TABLE changed (fid INTEGER PRIMARY KEY, lane DOUBLE, lane_source TEXT, direction DOUBLE, \
         direction_source TEXT, carriageway DOUBLE, carriageway_source TEXT, radius DOUBLE, deviation DOUBLE)",
    )
    .execute(&mut *c)
    .await?;
    let mut bulk = Bulk::new("changed", 9);
    for &(index, measure) in edges {
        let edge = network.edges.get(index.index()).ok_or_else(|| content(format!("edge {index} is missing")))?;
        bulk.add(i64::from(index) + 1);
        add_widths(&mut bulk, &network.section(edge));
        bulk.add(measure.min_radius_m.filter(|radius| radius.is_finite()));
        bulk.add(measure.centreline_deviation_m.filter(|deviation| deviation.is_finite()));
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await?;
    sqlx::query(
        "UPDATE edge SET lane_width_m = n.lane, width_source = n.lane_source, direction_width_m = n.direction, \
         direction_width_source = n.direction_source, carriageway_width_m = n.carriageway, \
         carriageway_width_source = n.carriageway_source, min_radius_m = n.radius, centreline_deviation_m = n.deviation \
         FROM changed AS n WHERE n.fid = edge.fid",
    )
    .execute(&mut *c)
    .await?;
    sqlx::query("DROP TABLE changed").execute(&mut *c).await?;
    triggers.restore(c).await
}

/// Writes the kerbs of turns where they differ.
async fn change_kerbs(c: &mut SqliteConnection, facts: &[TurnFacts]) -> Sql<()> {
    let stored = rows(c, "SELECT kerb_radius_m, kerb_source FROM turn ORDER BY fid", |row| {
        Ok((row.try_get::<Option<f64>, _>(0)?, row.try_get::<Option<String>, _>(1)?))
    })
    .await?;
    if stored.len() != facts.len() {
        return Err(content(format!("{} turns are stored, the network has {}", stored.len(), facts.len())));
    }
    for (fid, ((radius_m, source), turn)) in (1_i64..).zip(stored.into_iter().zip(facts)) {
        let now = turn.kerb_source.map(KerbSource::name);
        if (radius_m, source.as_deref()) != (turn.kerb_radius_m, now) {
            let update = sqlx::query("UPDATE turn SET kerb_radius_m = ?, kerb_source = ? WHERE fid = ?");
            update.bind(turn.kerb_radius_m).bind(now).bind(fid).execute(&mut *c).await?;
        }
    }
    Ok(())
}
