//! Reads the certificates of a reference vehicle beside those of another vehicle.
//!
//! Two sets compare only if they were made with the same settings. [`Database::reference`] checks that; every reader of a reference
//! begins there. [`Beside`] takes rows in order of the network and reads the reference's certificates along with them, so memory does
//! not grow with the network.

use std::collections::BTreeMap;
use std::iter::Fuse;
use std::path::Path;

use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::osm::facts::Policy;
use crate::rows::{Relative, RelativeCount, Standing};
use crate::settings::Settings;
use crate::words::Named as _;

use super::database::Database;
use super::error::StoreError;
use super::names::verdict_no;
use super::network_read::verdict;
use super::settings::CertifiedSet;
use super::stream::Streamed;

type Sql<T> = Result<T, sqlx::Error>;

/// The standing of an edge or turn, with its index in the network.
pub type IndexedStanding = (u32, Standing);

/// A reference vehicle whose certificates were made like those of a set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    id: String,
    policy: Policy,
    /// Whether it is the set's own vehicle.
    same: bool,
}

impl Database {
    /// The vehicle `reference` as a reference for a set.
    ///
    /// # Errors
    /// It is not certified under the set's policy ([`StoreError::NotThere`]), or with other settings ([`StoreError::NotAlike`]).
    pub fn reference(&mut self, set: &CertifiedSet, reference: &str) -> Result<Reference, StoreError> {
        let (id, policy) = (reference.to_owned(), set.policy);
        if set.vehicle_id == reference {
            return Ok(Reference { id, policy, same: true });
        }
        let path = self.session.path.clone();
        let other = self.certified_set(reference, policy)?;
        let other = other.ok_or_else(|| StoreError::not_certified(&path, reference, policy))?;
        self.alike((&set.vehicle_id, &set.settings()?), (reference, &other.settings()?))?;
        Ok(Reference { id, policy, same: false })
    }

    /// Checks that two vehicles were, or would be, certified with the same settings under the same policy.
    ///
    /// # Errors
    /// The settings differ ([`StoreError::NotAlike`]).
    pub fn alike(
        &self,
        (vehicle, settings): (&str, &Settings),
        (reference, others): (&str, &Settings),
    ) -> Result<(), StoreError> {
        if settings == others {
            return Ok(());
        }
        Err(StoreError::NotAlike {
            path: self.session.path.clone(),
            vehicle: vehicle.to_owned(),
            reference: reference.to_owned(),
            policy: settings.policy.name(),
            differ: differences(settings, others),
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
    ) -> Result<Streamed<'_, IndexedStanding>, StoreError> {
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
    ) -> Result<Streamed<'_, IndexedStanding>, StoreError> {
        let in_area = |row: &SqliteRow| standing(row).map(|(turn, standing)| (turn, standing.in_area()));
        Ok(self.standings("turn_certificate_compact", vehicle, policy, in_area))
    }

    fn standings(
        &mut self,
        table: &str,
        vehicle: &str,
        policy: Policy,
        read: fn(&SqliteRow) -> Sql<IndexedStanding>,
    ) -> Streamed<'_, IndexedStanding> {
        let sql = format!(
            "SELECT fid, verdict_no, rsc_mm, hinge_margin_cdeg FROM {table} \
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
        let mut other = ReferenceReader::open(&self.session.path, reference.clone())?;
        let mut beside = other.edges()?;
        let sql = "SELECT c.fid, c.verdict_no, c.rsc_mm, c.hinge_margin_cdeg, e.length_m \
                   FROM certificate_compact AS c CROSS JOIN edge AS e ON e.fid = c.fid \
                   WHERE c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) AND c.corridor_no = ? \
                   ORDER BY c.fid";
        let with_length = |row: &SqliteRow| Ok((standing(row)?, row.try_get::<f64, _>(4)?));
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
    Ok((fid.saturating_sub(1), Standing::stored(verdict, parts(2, 1000.0)?, parts(3, 100.0)?)))
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
    /// The vehicle's id.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Whether it is the compared vehicle itself.
    #[must_use]
    pub fn same(&self) -> bool {
        self.same
    }

    /// Checks that its turns are certified.
    ///
    /// # Errors
    /// They are not ([`StoreError::NotThere`]); the file cannot be read.
    pub fn check_turns(&self, database: &mut Database) -> Result<(), StoreError> {
        if database.has_turns(&self.id, self.policy)? {
            return Ok(());
        }
        Err(StoreError::turns_not_certified(&database.session.path, &self.id, self.policy))
    }
}

/// A reference with a connection of its own, from which its certificates are read beside other rows.
pub struct ReferenceReader {
    reference: Reference,
    database: Database,
}

impl ReferenceReader {
    /// Opens the database at `path`, in which the reference is.
    ///
    /// # Errors
    /// As [`Database::open`].
    pub fn open(path: &Path, reference: Reference) -> Result<Self, StoreError> {
        Ok(Self { reference, database: Database::open_to_stream(path)? })
    }

    /// The reference's edges, to be read beside those of the set.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edges(&mut self) -> Result<Beside<'_>, StoreError> {
        let Reference { id, policy, same } = &self.reference;
        let rows = if *same { None } else { Some(self.database.edge_standings(id, *policy)?.fuse()) };
        Ok(Beside { rows, ahead: None })
    }

    /// The reference's turns, to be read beside those of the set.
    ///
    /// # Errors
    /// Its turns are not certified ([`StoreError::NotThere`]); the file cannot be read.
    pub fn turns(&mut self) -> Result<Beside<'_>, StoreError> {
        self.reference.check_turns(&mut self.database)?;
        let Reference { id, policy, same } = &self.reference;
        let rows = if *same { None } else { Some(self.database.turn_standings(id, *policy)?.fuse()) };
        Ok(Beside { rows, ahead: None })
    }
}

/// The certificates of a reference, read along with rows of another vehicle.
pub struct Beside<'d> {
    /// `None` if the reference is the vehicle itself.
    rows: Option<Fuse<Streamed<'d, IndexedStanding>>>,
    ahead: Option<IndexedStanding>,
}

impl Beside<'_> {
    /// Compares the edge or turn with this index in the network. Calls must be in order of the network; they may leave rows out.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn relative(&mut self, index: u32, own: Standing) -> Result<Relative, StoreError> {
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
