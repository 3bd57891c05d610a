//! Replaces one whole set of certificates, with its plans and its turns, in one transaction.

use sqlx::sqlite::SqliteConnection;

use crate::account::AccountRow;
use crate::osm::facts::Policy;
use crate::words::Named as _;
use netcert_rows::settings::Settings;
use netcert_rows::{EdgeCertificate, StoredPlan};

use crate::columns::set_no::SetNo;
use crate::database::Database;
use crate::database::register_state::RegisterState;
use crate::error::{StoreError, content};
use crate::layers::{contents, descriptions};
use crate::provenance::records::{self, Run, VehicleRecord};
use crate::results::compact::CompactCertificate;
use crate::results::complete::check_complete;
use crate::results::plans;
use crate::results::sets::{self, Set};
use crate::results::turns::{self, PackedSet, TurnSet};

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// Replaces a vehicle's set of certificates, its plans and its turns in one transaction. If the program is killed, the
    /// old set stays.
    ///
    /// `certificates` must be complete and may be in any order; `settings` are those they were made with. Without `turns`
    /// the vehicle has no turns afterwards. If the vehicle's definition has changed, its sets under other policies are
    /// removed, too.
    #[allow(clippy::too_many_arguments)] // Each argument is one thing that the transaction replaces.
    pub fn replace_certificates(
        &mut self,
        vehicle: &VehicleRecord,
        settings: &Settings,
        certificates: impl IntoIterator<Item = EdgeCertificate>,
        plans: Vec<StoredPlan>,
        mut turns: Option<TurnSet<'_>>,
        run: &Run,
        account: &[AccountRow],
    ) -> Result<(), StoreError> {
        let written = self.acceptable(settings)?;
        let unsound = |edge, detail| StoreError::Unsound { edge, vehicle: vehicle.id.clone(), detail };
        let pack = |certificate: EdgeCertificate| {
            CompactCertificate::edge(&certificate).map_err(|why| unsound(certificate.edge.get(), why))
        };
        let mut rows = certificates.into_iter().map(pack).collect::<Result<Vec<CompactCertificate>, _>>()?;
        rows.sort_unstable_by_key(|row| row.fid);
        let edges: u32 =
            self.session.run(async |c| sqlx::query_scalar("SELECT count(*) FROM edge").fetch_one(c).await)?;
        check_complete(&rows, edges).map_err(|(edge, detail)| unsound(edge, detail.to_owned()))?;
        let packed = match &mut turns {
            Some(turns) => Some(turns.pack().map_err(|(turn, why)| unsound(turn, why))?),
            None => None,
        };
        let policy = settings.policy;
        let mut renewed = Renewed { settings: written, rows, plans, turns: turns.zip(packed) };
        let loaded = self.loaded;
        let path = self.session.path.clone();
        let same = self.session.run(async |c| {
            sqlx::query("BEGIN IMMEDIATE").execute(&mut *c).await?;
            if loaded.is_some() && loaded != Some(RegisterState::read(c).await?) {
                sqlx::query("ROLLBACK").execute(&mut *c).await?;
                return Ok(false);
            }
            let done = replace(c, vehicle, policy, &mut renewed, run, account).await;
            let end = if done.is_ok() { "COMMIT" } else { "ROLLBACK" };
            let ended = sqlx::query(end).execute(&mut *c).await;
            done.and(ended.map(|_| true))
        })?;
        if same { Ok(()) } else { Err(StoreError::RegisterChanged(path)) }
    }

    /// The text of a set's settings as it is stored. Kerbs must be those of the ingest, because all sets share one table of
    /// turns.
    fn acceptable(&mut self, settings: &Settings) -> Result<String, StoreError> {
        let refused = |detail| StoreError::SettingsRefused { path: self.session.path.clone(), detail };
        let written = settings.written().map_err(refused)?;
        if self.settings_of_new_sets()?.kerbs == settings.kerbs {
            return Ok(written);
        }
        let detail = "its turns were made with other kerbs; run `netcert ingest` again with the new kerbs".to_owned();
        Err(StoreError::SettingsRefused { path: self.session.path.clone(), detail })
    }
}

/// A vehicle's new certificates in packed form.
struct Renewed<'a> {
    settings: String,
    rows: Vec<CompactCertificate>,
    plans: Vec<StoredPlan>,
    turns: Option<(TurnSet<'a>, PackedSet)>,
}

async fn replace(
    c: &mut SqliteConnection,
    vehicle: &VehicleRecord,
    policy: Policy,
    renewed: &mut Renewed<'_>,
    run: &Run,
    account: &[AccountRow],
) -> Sql<()> {
    let known: Option<(u32, String)> = sqlx::query_as("SELECT vehicle_no, blake3 FROM vehicle WHERE vehicle_id = ?")
        .bind(&vehicle.id)
        .fetch_optional(&mut *c)
        .await?;
    let vehicle_no = match known {
        Some((number, hash)) if hash == vehicle.blake3() => {
            sets::remove(c, SetNo { vehicle_no: number, policy }).await?;
            number
        }
        Some((number, _)) => {
            for &other in Policy::ALL {
                sets::remove(c, SetNo { vehicle_no: number, policy: other }).await?;
            }
            sqlx::query("DELETE FROM vehicle WHERE vehicle_no = ?").bind(number).execute(&mut *c).await?;
            records::add_vehicle(c, number, vehicle).await?;
            number
        }
        None => {
            let next = "SELECT coalesce(max(vehicle_no), 0) + 1 FROM vehicle";
            let number = sqlx::query_scalar(next).fetch_one(&mut *c).await?;
            records::add_vehicle(c, number, vehicle).await?;
            number
        }
    };
    let run_id = records::add_run(c, run, account).await?;
    let (vehicle_id, vehicle_name) = (&vehicle.id, &vehicle.name);
    let plans = plans::sorted(&mut renewed.plans);
    plans::insert(c, plans::STROKES, SetNo { vehicle_no, policy }, plans).await?;
    let set =
        Set { vehicle_no, vehicle_id, vehicle_name, policy, run_id, time: &run.finished, settings: &renewed.settings };
    let rows = renewed.rows.iter().copied().map(Ok);
    let inserted = set.insert(c, rows, renewed.rows.len() as u32).await?;
    inserted.map_err(|(edge, detail)| content(format!("edge {edge}: {detail}")))?;
    contents::touch_tables(c, &run.finished).await?;
    if let Some((turns, packed)) = &mut renewed.turns {
        turns::insert_set(c, SetNo { vehicle_no, policy }, run_id, turns, packed, &run.finished).await?;
    }
    descriptions::describe(c).await
}
