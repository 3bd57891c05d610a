//! Writes what is left of a new database, or what differs in a copy of the older one, and puts the file in place.

use std::path::PathBuf;

use crate::changes::amendment::{self, Amendment};
use crate::changes::renewal;
use crate::columns::set_no::SetNo;
use crate::error::StoreError;
use crate::file::companions::with_suffix;
use crate::file::schema::migrate;
use crate::file::session::Session;
use crate::layers::contents::{self, LayerTable};
use crate::layers::descriptions;
use crate::layers::styles::{self, Shows};
use crate::provenance::records::{self, Run, VehicleRecord};
use crate::register::evidence;
use crate::results::plans;
use crate::results::sets::Set;
use crate::results::turns;
use crate::results::write_order::CertificateSorter;
use crate::roads::areas;
use crate::roads::backdrop;
use crate::roads::junctions;
use crate::roads::map_changes;
use crate::roads::network_rows::MapRows;
use crate::roads::network_write::Written;
use crate::roads::restrictions;
use crate::roads::segments;
use crate::writer::placing::put_in_place;
use crate::writer::{Turns, Writer, unsound};
use netcert_roads::turns::TurnNo;

impl Writer {
    /// Writes what is left, checks the file, and puts it in place of the old one.
    pub fn finish(self, run: &Run) -> Result<(), StoreError> {
        let path = self.part.target.clone();
        let at = |e| StoreError::io(&path, e);
        let (mut session, Written { edges, bounds }) = self.network.finish(&self.part.path)?;
        let MapRows { mut restrictions, areas, backdrop: things } = self.map_rows;
        let things = things.sorted().map_err(at)?.map(|row| row.map(|(_, thing)| thing));
        let (vehicles, account) = (&self.vehicles, &self.account);
        let description = "Directed edges of the road network";
        let layer = LayerTable { table: "edge", geometries: "LINESTRING", description, bounds };
        let run_id = session.run(async |c| {
            layer.add(c, &run.finished).await?;
            styles::add(c, "edge", Shows::Edges, &run.finished).await?;
            for (number, vehicle) in (1..).zip(vehicles) {
                records::add_vehicle(c, number, vehicle).await?;
            }
            records::add_run(c, run, account).await
        })?;
        let (mut certificates, mut all_plans) = self.certificates.sorted().map_err(at)?;
        while let Some(set_no) = certificates.next_set().map_err(at)? {
            let (SetNo { vehicle_no, policy }, rows) = (set_no, certificates.of(set_no));
            let known =
                self.vehicles.get(vehicle_no as usize - 1).zip(self.settings.get(usize::from(set_no.corridor_no())));
            let unknown = || unsound(&self.vehicles, vehicle_no, 0, "the vehicle was never added".to_owned());
            let (vehicle, settings) = known.ok_or_else(unknown)?;
            let (vehicle_id, vehicle_name) = (&vehicle.id, &vehicle.name);
            let set = Set { vehicle_no, vehicle_id, vehicle_name, policy, run_id, time: &run.finished, settings };
            let inserted = session.run(async |c| set.insert(c, rows, edges).await)?;
            inserted.map_err(|(edge, detail)| unsound(&self.vehicles, vehicle_no, edge, detail.to_owned()))?;
        }
        let (register, map_changes, of_ways) = (&self.evidence, &self.map_changes, &self.segments);
        session.run(async |c| {
            sqlx::query("COMMIT").execute(&mut *c).await?;
            migrate(c, None).await?;
            sqlx::query("BEGIN").execute(&mut *c).await?;
            restrictions::insert(c, &mut restrictions).await?;
            areas::insert(c, &areas).await?;
            evidence::write(c, register, &run.finished).await?;
            map_changes::insert(c, map_changes).await?;
            segments::insert(c, of_ways).await?;
            backdrop::insert(c, things).await?;
            while let Some(set) = all_plans.next_set()? {
                plans::insert(c, plans::STROKES, set, all_plans.of(set)).await?;
            }
            sqlx::query("COMMIT").execute(c).await
        })?;
        if let Some(turns) = self.turns {
            let finishing = FinishTurns { session: &mut session, path: &self.part.path, vehicles: &self.vehicles };
            finishing.run(turns, run, run_id)?;
        }
        session.run(async |c| {
            sqlx::query("BEGIN").execute(&mut *c).await?;
            contents::add_tables(c, &run.finished).await?;
            descriptions::describe(c).await?;
            sqlx::query("COMMIT").execute(c).await
        })?;
        put_in_place(session, self.part, self.older.as_ref())
    }

    /// Puts a copy of the older database in place, in which only what differs is changed. The caller has begun a change of the older one
    /// ([`crate::Database::begin_change`]), so that it is the same until then. Certificates, roads and turns that were added to this writer do not count.
    ///
    /// # Errors
    /// Something cannot be read or stored. The older database is then unchanged.
    pub fn amend(mut self, amendment: &mut Amendment<'_>, run: &Run) -> Result<(), StoreError> {
        let path = self.part.target.clone();
        self.network.without_network()?.close()?;
        self.part.copy_target()?;
        let mut session = Session::open(&path, &self.part.options())?;
        let things = self.map_rows.backdrop.sorted().map_err(|e| StoreError::io(&path, e))?;
        let things = things.map(|row| row.map(|(_, thing)| thing));
        let packed = amendment.sets.iter_mut().map(renewal::pack).collect::<Result<Vec<_>, _>>()?;
        session.run(async |c| {
            sqlx::query("BEGIN").execute(&mut *c).await?;
            amendment::write(c, amendment, &packed).await?;
            areas::replace(c, &self.map_rows.areas).await?;
            backdrop::replace(c, things).await?;
            map_changes::replace(c, &self.map_changes).await?;
            records::replace_runs(c, run, &self.account).await?;
            sqlx::query("COMMIT").execute(c).await
        })?;
        put_in_place(session, self.part, self.older.as_ref())
    }
}

/// Writes turns, their layer and their certificates.
struct FinishTurns<'w> {
    session: &'w mut Session,
    path: &'w PathBuf,
    vehicles: &'w [VehicleRecord],
}

impl FinishTurns<'_> {
    fn run(self, turns: Turns, run: &Run, run_id: i64) -> Result<(), StoreError> {
        let Self { session, path, vehicles } = self;
        let name = session.path.clone();
        let at = |e| StoreError::io(&name, e);
        // By a turn's number in the order of arrival: its index in the order of the whole network.
        let mut numbers = vec![0_u32; turns.count as usize];
        let rows = turns.rows.sorted().map_err(at)?.enumerate().map(|(index, row)| {
            let (_, (arrival, record)) = row?;
            numbers[arrival as usize] = index as u32;
            Ok((TurnNo::at(index), record))
        });
        let junctions = turns.junctions.sorted().map_err(at)?.map(|row| row.map(|(_, area)| area));
        session.run(async |c| sqlx::query("BEGIN").execute(c).await)?;
        let bounds = session.fill(async |to| turns::write(to, rows).await)?;
        let around = session.fill(async |to| junctions::insert(to, junctions).await)?;
        session.run(async |c| {
            turns::register(c, bounds, &run.finished).await?;
            junctions::register(c, around, &run.finished).await
        })?;
        let in_order = numbers.is_sorted();
        let waiting = turns.certificates;
        let waiting = if in_order { Ok(waiting) } else { waiting.renumbered(&with_suffix(path, "-ordered"), &numbers) };
        let (mut certificates, mut plans) = waiting.and_then(CertificateSorter::sorted).map_err(at)?;
        while let Some(set) = certificates.next_set().map_err(at)? {
            let (rows, plans) = (certificates.of(set), plans.of(set));
            let inserted = session.run(async |c| turns::insert(c, set, run_id, rows, plans, turns.count).await)?;
            inserted.map_err(|(turn, detail)| unsound(vehicles, set.vehicle_no, turn, detail.to_owned()))?;
        }
        session.run(async |c| sqlx::query("COMMIT").execute(c).await)?;
        Ok(())
    }
}
