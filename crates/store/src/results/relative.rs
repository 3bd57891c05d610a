//! Reads the certificates of a reference vehicle beside those of another vehicle.
//!
//! [`DRIVABLE_BY`] stands for the vehicles that the register knows to go somewhere: each is compared where it is known to go, and
//! nowhere else (`known_vehicles`). [`ATTESTED`] stands for these and for the vehicles that signs admit (`attested`).
//!
//! Two sets compare only if they were made with the same settings. [`Database::reference`] checks that; every reader of a reference
//! begins there. [`ReferenceCertificates`] takes rows in order of the network and reads the reference's certificates along with them, so memory does
//! not grow with the network.

use std::collections::BTreeMap;
use std::iter::Fuse;
use std::path::Path;

use jiff::civil::DateTime;
use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::osm::facts::Policy;
use crate::words::Named as _;
use netcert_rows::settings::Settings;
use netcert_rows::{CertificateStanding, Relative, RelativeCount};

use crate::columns::names::verdict_no;
use crate::columns::read::verdict;
use crate::database::Database;
use crate::database::row_stream::RowStream;
use crate::error::StoreError;
use crate::register::known_vehicles::KnownVehicle;
use crate::results::settings::CertifiedSet;

type Sql<T> = Result<T, sqlx::Error>;

/// The standing of an edge or turn, with its index in the network.
pub type IndexedStanding = (u32, CertificateStanding);

/// Instead of a vehicle's id: on each road the vehicles that the register knows to go there.
pub const DRIVABLE_BY: &str = "drivable_by";

/// Instead of a vehicle's id: on each road the certified vehicles that the register or a sign on the map knows to go there.
pub const ATTESTED: &str = "attested";

/// A vehicle, and the settings that it was, or would be, certified with.
#[derive(Debug, Clone, Copy)]
pub struct VehicleSettings<'a> {
    /// Id of the vehicle.
    pub vehicle: &'a str,
    /// The settings.
    pub settings: &'a Settings,
}

/// A reference whose certificates were made like those of a set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    id: String,
    policy: Policy,
    vehicles: Vec<ReferenceVehicle>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct ReferenceVehicle {
    id: String,
    /// Whether it is the set's own vehicle.
    same: bool,
    /// Where it is compared. `None` means everywhere.
    known: Option<KnownVehicle>,
}

impl Database {
    /// The vehicle `reference`, or those of [`DRIVABLE_BY`] or [`ATTESTED`], as a reference for a set.
    ///
    /// # Errors
    /// A vehicle is not certified under the set's policy, or none is known ([`StoreError::NotThere`]); a vehicle is certified with other
    /// settings ([`StoreError::NotAlike`]).
    pub fn reference(&mut self, set: &CertifiedSet, reference: &str) -> Result<Reference, StoreError> {
        let vehicles: Vec<(String, Option<KnownVehicle>)> = match reference {
            DRIVABLE_BY | ATTESTED => {
                let known = self.reference_vehicles(reference, &set.vehicle_id, set.policy)?;
                known.into_iter().map(|(id, known)| (id, Some(known))).collect()
            }
            _ => vec![(reference.to_owned(), None)],
        };
        let mut all = Vec::new();
        for (id, known) in vehicles {
            let same = set.vehicle_id == id;
            if !same {
                let other = self.certified_set(&id, set.policy)?;
                let other = other.ok_or_else(|| StoreError::not_certified(&self.session.path, &id, set.policy))?;
                let own = VehicleSettings { vehicle: &set.vehicle_id, settings: &set.settings()? };
                self.alike(own, VehicleSettings { vehicle: &id, settings: &other.settings()? })?;
            }
            all.push(ReferenceVehicle { id, same, known });
        }
        Ok(Reference { id: reference.to_owned(), policy: set.policy, vehicles: all })
    }

    /// The ids of the vehicles that a reference stands for beside a vehicle under a policy. Of [`ATTESTED`] they are certified.
    ///
    /// # Errors
    /// None is known ([`StoreError::NotThere`]); the file cannot be read.
    pub fn reference_ids(&mut self, reference: &str, vehicle: &str, policy: Policy) -> Result<Vec<String>, StoreError> {
        match reference {
            DRIVABLE_BY | ATTESTED => Ok(self.reference_vehicles(reference, vehicle, policy)?.into_keys().collect()),
            _ => Ok(vec![reference.to_owned()]),
        }
    }

    /// The vehicles of [`DRIVABLE_BY`] or [`ATTESTED`], with the places where they are known to go.
    fn reference_vehicles(
        &mut self,
        reference: &str,
        vehicle: &str,
        policy: Policy,
    ) -> Result<BTreeMap<String, KnownVehicle>, StoreError> {
        let attested = reference == ATTESTED;
        let mut known = if attested { self.attested_vehicles()? } else { self.register_vehicles()? };
        let there = known.keys().cloned().collect::<Vec<_>>().join(", ");
        if attested {
            let certified = self.certified()?;
            let is_certified = |id: &str| certified.iter().any(|set| set.vehicle_id == id && set.policy == policy);
            known.retain(|id, _| id == vehicle || is_certified(id));
        }
        let detail = match (there.is_empty(), attested) {
            _ if !known.is_empty() => return Ok(known),
            (_, false) => {
                "the register knows no vehicle that goes anywhere; add rows `drivable_by` with `netcert evidence add`"
                    .to_owned()
            }
            (true, true) => {
                "no sign on the map and no row `drivable_by` of the register says that a vehicle goes anywhere"
                    .to_owned()
            }
            (false, true) => format!(
                "roads are attested for {there}, and none of them is certified under the {} policy; certify one with `netcert \
                 certify --vehicle ID`",
                policy.name()
            ),
        };
        Err(StoreError::NotThere { path: self.session.path.clone(), detail })
    }

    /// Checks that two vehicles were, or would be, certified with the same settings under the same policy.
    ///
    /// # Errors
    /// The settings differ ([`StoreError::NotAlike`]).
    pub fn alike(&self, own: VehicleSettings<'_>, reference: VehicleSettings<'_>) -> Result<(), StoreError> {
        if own.settings == reference.settings {
            return Ok(());
        }
        Err(StoreError::NotAlike {
            path: self.session.path.clone(),
            vehicle: own.vehicle.to_owned(),
            reference: reference.vehicle.to_owned(),
            policy: own.settings.policy.name(),
            differ: differences(own.settings, reference.settings),
        })
    }

    /// The standing of every edge of a vehicle, in order of the network. There are no rows if it is not certified.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_standings(
        &mut self,
        vehicle: &str,
        policy: Policy,
    ) -> Result<RowStream<'_, IndexedStanding>, StoreError> {
        Ok(self.standings("certificate_compact", vehicle, policy, standing))
    }

    /// The standing of every turn of a vehicle, in order of the network. There are no rows if its turns are not certified.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn turn_standings(
        &mut self,
        vehicle: &str,
        policy: Policy,
    ) -> Result<RowStream<'_, IndexedStanding>, StoreError> {
        let in_area = |row: &SqliteRow| standing(row).map(|(turn, standing)| (turn, standing.in_area()));
        Ok(self.standings("turn_certificate_compact", vehicle, policy, in_area))
    }

    fn standings(
        &mut self,
        table: &str,
        vehicle: &str,
        policy: Policy,
        read: fn(&SqliteRow) -> Sql<IndexedStanding>,
    ) -> RowStream<'_, IndexedStanding> {
        let sql = format!(
            "SELECT fid, verdict_no, rsc_mm, hinge_margin_cdeg, shrink_milli FROM {table} \
             WHERE vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND corridor_no = ? ORDER BY fid"
        );
        self.streamed(sql, vehicle, policy, read)
    }

    /// Numbers and lengths of a set's edges by verdict and by whether the vehicle needs no more room than the reference.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn relative_counts(
        &mut self,
        set: &CertifiedSet,
        reference: &Reference,
    ) -> Result<Vec<RelativeCount>, StoreError> {
        let mut other = ReferenceReader::open(&self.session.path, reference.clone(), self.time)?;
        let mut beside = other.edges()?;
        let sql = "SELECT c.fid, c.verdict_no, c.rsc_mm, c.hinge_margin_cdeg, c.shrink_milli, e.length_m \
                   FROM certificate_compact AS c CROSS JOIN edge AS e ON e.fid = c.fid \
                   WHERE c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND c.corridor_no = ? \
                   ORDER BY c.fid";
        let with_length = |row: &SqliteRow| Ok((standing(row)?, row.try_get::<f64, _>(5)?));
        let mut counts: BTreeMap<_, RelativeCount> = BTreeMap::new();
        for row in self.streamed(sql.to_owned(), &set.vehicle_id, set.policy, with_length) {
            let ((edge, own), length_m) = row?;
            let (verdict, as_reference) = (own.verdict(), beside.relative(edge, own)?.as_reference);
            let count = counts.entry((verdict_no(verdict), !as_reference)).or_insert(RelativeCount {
                verdict,
                as_reference,
                edges: 0,
                length_m: 0.0,
            });
            count.edges += 1;
            count.length_m += length_m;
        }
        Ok(counts.into_values().collect())
    }
}

fn standing(row: &SqliteRow) -> Sql<IndexedStanding> {
    let fid: u32 = row.try_get(0)?;
    let parts = |column, parts: f64| -> Sql<Option<f64>> {
        Ok(row.try_get::<Option<i64>, _>(column)?.map(|whole| whole as f64 / parts))
    };
    let verdict = verdict(row, 1, || format!("row {fid}"))?;
    Ok((
        fid.saturating_sub(1),
        CertificateStanding::stored(verdict, parts(2, 1000.0)?, parts(3, 100.0)?, parts(4, 1000.0)?),
    ))
}

/// The settings that differ, as `max_shift_m 1.5 and 0.0`.
fn differences(settings: &Settings, others: &Settings) -> String {
    let (Ok(own), Ok(other)) = (settings.options(), others.options()) else { return "settings".to_owned() };
    let differ = own.iter().filter(|(name, value)| other.get(*name) != Some(value));
    let mut words: Vec<String> =
        differ.map(|(name, value)| format!("{name} {value} and {}", other.get(name).unwrap_or_default())).collect();
    if settings.kerbs != others.kerbs {
        words.push("kerbs".to_owned());
    }
    words.join(", ")
}

impl Reference {
    /// The vehicle's id, or [`DRIVABLE_BY`], or [`ATTESTED`].
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Whether it is the compared vehicle itself, everywhere.
    #[must_use]
    pub fn same(&self) -> bool {
        self.vehicles.iter().all(|vehicle| vehicle.same && vehicle.known.is_none())
    }

    /// Checks that its turns are certified.
    ///
    /// # Errors
    /// They are not ([`StoreError::NotThere`]); the file cannot be read.
    pub fn check_turns(&self, database: &mut Database) -> Result<(), StoreError> {
        for ReferenceVehicle { id, .. } in &self.vehicles {
            if !database.has_turns(id, self.policy)? {
                return Err(StoreError::turns_not_certified(&database.session.path, id, self.policy));
            }
        }
        Ok(())
    }
}

/// A reference with connections of its own, from which its certificates are read beside other rows.
pub struct ReferenceReader {
    reference: Reference,
    /// One for each vehicle that is read.
    databases: Vec<Database>,
}

impl ReferenceReader {
    /// Opens the database at `path`, in which the reference is, with its verdicts at a time ([`Database::set_time`]) if one is given.
    ///
    /// # Errors
    /// As [`Database::open`].
    pub fn open(path: &Path, reference: Reference, time: Option<DateTime>) -> Result<Self, StoreError> {
        let read = reference.vehicles.iter().filter(|vehicle| !vehicle.same);
        let open = |_| {
            let mut database = Database::open_to_stream(path)?;
            time.map(|time| database.set_time(time)).transpose()?;
            Ok(database)
        };
        let databases = read.map(open).collect::<Result<_, StoreError>>()?;
        Ok(Self { reference, databases })
    }

    /// The reference's edges, to be read beside those of the set.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edges(&mut self) -> Result<ReferenceCertificates<'_>, StoreError> {
        self.beside(Database::edge_standings, |known| &known.edges)
    }

    /// The reference's turns, to be read beside those of the set.
    ///
    /// # Errors
    /// Its turns are not certified ([`StoreError::NotThere`]); the file cannot be read.
    pub fn turns(&mut self) -> Result<ReferenceCertificates<'_>, StoreError> {
        if let Some(database) = self.databases.first_mut() {
            self.reference.check_turns(database)?;
        }
        self.beside(Database::turn_standings, |known| &known.turns)
    }

    fn beside(
        &mut self,
        standings: impl for<'s> Fn(&'s mut Database, &str, Policy) -> Result<RowStream<'s, IndexedStanding>, StoreError>,
        places: impl Fn(&KnownVehicle) -> &Vec<u32>,
    ) -> Result<ReferenceCertificates<'_>, StoreError> {
        let mut databases = self.databases.iter_mut();
        let mut vehicles = Vec::new();
        for vehicle in &self.reference.vehicles {
            let database = if vehicle.same { None } else { databases.next() };
            let rows = match database {
                Some(database) => Some(standings(database, &vehicle.id, self.reference.policy)?.fuse()),
                None => None,
            };
            let places = vehicle.known.as_ref().map(|known| places(known).as_slice());
            vehicles.push(BesideVehicle { rows, ahead: None, places });
        }
        Ok(ReferenceCertificates { vehicles })
    }
}

/// The certificates of a reference, read along with rows of another vehicle.
pub struct ReferenceCertificates<'d> {
    vehicles: Vec<BesideVehicle<'d>>,
}

struct BesideVehicle<'d> {
    /// `None` if it is the compared vehicle itself.
    rows: Option<Fuse<RowStream<'d, IndexedStanding>>>,
    ahead: Option<IndexedStanding>,
    /// The sorted indices at which it is compared. `None` means all.
    places: Option<&'d [u32]>,
}

impl ReferenceCertificates<'_> {
    /// Compares the edge or turn with this index in the network. Calls must be in order of the network; they may leave rows out. Of
    /// several vehicles the one counts beside which the compared vehicle needs the least more room.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn relative(&mut self, index: u32, own: CertificateStanding) -> Result<Relative, StoreError> {
        let mut best = Relative::default();
        for vehicle in &mut self.vehicles {
            let relative = vehicle.relative(index, own)?;
            let rank = |relative: Relative| (relative.as_reference, relative.relative_m.unwrap_or(f64::NEG_INFINITY));
            if rank(relative) > rank(best) {
                best = relative;
            }
        }
        Ok(best)
    }
}

impl BesideVehicle<'_> {
    fn relative(&mut self, index: u32, own: CertificateStanding) -> Result<Relative, StoreError> {
        if self.places.is_some_and(|places| places.binary_search(&index).is_err()) {
            return Ok(Relative::default());
        }
        let Some(rows) = &mut self.rows else { return Ok(Relative::to_itself(own)) };
        while self.ahead.is_none_or(|(at, _)| at < index) {
            self.ahead = match rows.next() {
                Some(row) => Some(row?),
                None => return Ok(Relative::default()),
            };
        }
        let there = self.ahead.filter(|(at, _)| *at == index);
        Ok(there.map_or_else(Relative::default, |(_, reference)| Relative::between(own, reference)))
    }
}
