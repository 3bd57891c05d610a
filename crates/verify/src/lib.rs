//! Checks a whole database: its records, what of the register counts, and each certificate, by the independent checker.
//!
//! [`crate::check`] decides. The other modules read what it is told of. None of them uses the prover.

use netcert_base::{stop, vehicle, verdict, watch, words};
use netcert_evidence as evidence;
use netcert_files::seal;
use netcert_osm::{account, osm};
use netcert_roads::{corridor, network, turns};
use netcert_rows as rows;
use netcert_rows::settings;
use netcert_store as store;

pub mod check;
mod error;
mod records;
mod road_columns;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::check::{Finding, Outcome, SetClaim, SetReport, TurnsClaim};
use crate::evidence::Entry;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::Policy;
use crate::rows::{Bounds, EdgeRow, TurnRow};
use crate::settings::Settings;
use crate::stop::Stop;
use crate::store::{Area, CertifiedSet, Database, QueryOptions, TurnQuery};
use crate::turns::{Kerbs, TurnFacts, TurnNo, turn_facts};
use crate::vehicle::Vehicle;
use crate::verdict::Verdict;
use crate::words::verdict_words;

pub use error::VerifyError;

/// The seed of a sample, fixed so that every run draws the same rows.
const SEED: u64 = 0x6e65_7463_6572_7431;

/// Which certificates of a database to check.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Only those of these vehicles. Empty: of all.
    pub vehicles: Vec<String>,
    /// Only those under this policy.
    pub policy: Option<Policy>,
    /// Only edges and turns that touch this box.
    pub area: Option<Bounds>,
    /// At most so many edges and so many turns of each vehicle and policy, drawn with a fixed seed.
    pub sample: Option<usize>,
    /// The source of the database, whose hash is compared with the one that the database has.
    pub source: Option<PathBuf>,
}

/// What certificates are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertificateKind {
    /// Of edges.
    Edge,
    /// Of turns.
    Turn,
}

/// The outcomes of one vehicle's certificates of edges, or of turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// The vehicle.
    pub vehicle_id: String,
    /// The corridor policy.
    pub policy: Policy,
    /// What the certificates are of.
    pub kind: CertificateKind,
    /// One outcome for each certificate.
    pub report: SetReport,
}

/// The outcome for a database.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Verification {
    /// What is wrong with records of vehicles and runs, and with measurements.
    pub records: Vec<Complaint>,
    /// By vehicle and policy: edges, then turns.
    pub sets: Vec<Checked>,
}

/// A claim that is not confirmed, or a remark.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Complaint {
    /// How bad it is.
    pub grade: Grade,
    /// Which claim, and what is wrong with it.
    pub detail: String,
}

/// How bad a complaint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grade {
    /// All claims hold. What is displayed beside them is not so.
    Remark,
    /// A claim does not follow.
    NotConfirmed,
    /// A claim cannot be read or contradicts itself.
    Malformed,
}

impl Grade {
    /// The word that `verify` prints.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Remark => "remark",
            Self::NotConfirmed => "not confirmed",
            Self::Malformed => "malformed",
        }
    }
}

impl Verification {
    /// Whether every claim is confirmed.
    #[must_use]
    pub fn confirmed(&self) -> bool {
        self.complaints().next().is_none()
    }

    /// All claims that are not confirmed.
    pub fn complaints(&self) -> impl Iterator<Item = Complaint> {
        self.findings().filter(|complaint| complaint.grade != Grade::Remark)
    }

    /// What is displayed and is not so, beside claims that hold.
    pub fn remarks(&self) -> impl Iterator<Item = Complaint> {
        self.findings().filter(|complaint| complaint.grade == Grade::Remark)
    }

    fn findings(&self) -> impl Iterator<Item = Complaint> {
        self.records.iter().cloned().chain(self.sets.iter().flat_map(Checked::findings))
    }
}

impl CertificateKind {
    /// The word for one of them.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Edge => "edge",
            Self::Turn => "turn",
        }
    }
}

impl Checked {
    /// By verdict: how many certificates are confirmed, not confirmed and malformed.
    #[must_use]
    pub fn by_verdict(&self) -> BTreeMap<&'static str, [u64; 3]> {
        let mut counts: BTreeMap<&str, [u64; 3]> = BTreeMap::new();
        for row in &self.report.rows {
            let slot = match row.outcome {
                Outcome::Confirmed | Outcome::Remarked(_) => 0,
                Outcome::NotConfirmed(_) => 1,
                Outcome::Malformed(_) => 2,
            };
            counts.entry(verdict_words(row.verdict).0).or_default()[slot] += 1;
        }
        counts
    }

    /// Certificates that are not confirmed, and remarks about others.
    fn findings(&self) -> impl Iterator<Item = Complaint> {
        let joined = |found: &[Finding]| {
            found.iter().map(|f| format!("{}: {}", f.claim, f.detail)).collect::<Vec<_>>().join("; ")
        };
        self.report.rows.iter().filter_map(move |row| {
            let (grade, why) = match &row.outcome {
                Outcome::Confirmed => return None,
                Outcome::Remarked(found) => (Grade::Remark, joined(found)),
                Outcome::NotConfirmed(found) => (Grade::NotConfirmed, joined(found)),
                Outcome::Malformed(why) => (Grade::Malformed, why.clone()),
            };
            Some(Complaint { grade, detail: format!("{} {} {}: {why}", self.vehicle_id, self.kind.word(), row.id) })
        })
    }
}

/// Checks the certificates that are asked for. `done` gets each part as soon as it is checked.
///
/// # Errors
/// The database or the source cannot be read, it has no such certificates, or `stop` was told: each stroke and each turn polls it.
pub fn verify(
    path: &Path,
    request: &Request,
    stop: &Stop,
    done: &mut dyn FnMut(&Checked),
) -> Result<Verification, VerifyError> {
    let mut database = Database::open(path)?;
    let mut records = records::check(&mut database, request.source.as_deref())?;
    let network = database.load_network()?;
    records.extend(measurements(&mut database, &network)?);
    records.extend(road_columns::check(&mut database, &network)?);
    let mut sets = Vec::new();
    let mut facts: Option<(Kerbs, Vec<TurnFacts>)> = None;
    for set in request.sets(&mut database, path)? {
        let settings = set.settings()?;
        let mut add = |kind: CertificateKind, report: SetReport| {
            let checked = Checked { vehicle_id: set.vehicle_id.clone(), policy: set.policy, kind, report };
            done(&checked);
            sets.push(checked);
        };
        records.extend(missing_edges(&mut database, &network, &set)?);
        add(CertificateKind::Edge, request.edges(&mut database, &network, &set, &settings, stop)?);
        let has_turns = database.has_turns(&set.vehicle_id, set.policy)?;
        if !has_turns && !settings.turns {
            continue;
        }
        let known = facts.take().filter(|(kerbs, _)| *kerbs == settings.kerbs);
        let made = || (settings.kerbs.clone(), turn_facts(&network, &settings.kerbs));
        let (_, facts) = facts.insert(known.unwrap_or_else(made));
        if has_turns {
            records.extend(missing_turns(&mut database, facts, &set)?);
            add(CertificateKind::Turn, request.turns(&mut database, &network, facts, &set, &settings, stop)?);
        } else if !facts.is_empty() {
            let detail = format!("{}: its settings say that its turns are certified, and they are not", set.layer);
            records.push(Complaint { grade: Grade::Malformed, detail });
        }
    }
    Ok(Verification { records, sets })
}

impl Request {
    fn sets(&self, database: &mut Database, path: &Path) -> Result<Vec<CertifiedSet>, VerifyError> {
        let wanted = |set: &CertifiedSet| {
            (self.vehicles.is_empty() || self.vehicles.contains(&set.vehicle_id))
                && self.policy.is_none_or(|policy| policy == set.policy)
        };
        let sets: Vec<_> = database.certified()?.into_iter().filter(wanted).collect();
        if sets.is_empty() { Err(VerifyError::NoSuchCertificates { path: path.to_owned() }) } else { Ok(sets) }
    }

    fn edges(
        &self,
        database: &mut Database,
        network: &Network,
        set: &CertifiedSet,
        settings: &Settings,
        stop: &Stop,
    ) -> Result<SetReport, VerifyError> {
        let vehicle = defined(database, set)?;
        let query =
            QueryOptions { area: self.area.map(Area::Bounds), ..QueryOptions::new(&set.vehicle_id, set.policy) };
        let rows: Vec<EdgeRow> = database.query(&query)?.collect::<Result<_, _>>()?;
        let rows = self.sampled(rows, |row| row.edge.id);
        let rows: BTreeMap<EdgeNo, EdgeRow> = rows.into_iter().map(|row| (row.edge.index, row)).collect();
        let plans = database.plans(&set.vehicle_id, set.policy)?;
        let claim = SetClaim {
            network,
            vehicle: &vehicle,
            policy: set.policy,
            params: &settings.corridor,
            max_shift_m: settings.stet.max_shift_m,
            rows: &rows,
            plans: &plans,
        };
        Ok(claim.check(stop)?)
    }

    fn turns(
        &self,
        database: &mut Database,
        network: &Network,
        facts: &[TurnFacts],
        set: &CertifiedSet,
        settings: &Settings,
        stop: &Stop,
    ) -> Result<SetReport, VerifyError> {
        let vehicle = defined(database, set)?;
        let params = settings.turn_params();
        let every = QueryOptions::new(&set.vehicle_id, set.policy);
        let edges: BTreeMap<EdgeNo, Verdict> = database
            .query(&every)?
            .map(|row| row.map(|row| (row.edge.index, row.certificate.verdict)))
            .collect::<Result<_, _>>()?;
        let query = TurnQuery { area: self.area.map(Area::Bounds), ..TurnQuery::new(&set.vehicle_id, set.policy) };
        let rows = self.sampled(database.query_turns(&query)?, |row| row.turn.id);
        let rows: BTreeMap<TurnNo, TurnRow> = rows.into_iter().map(|row| (row.turn.index, row)).collect();
        let plans = database.turn_plans(&set.vehicle_id, set.policy)?;
        let claim = TurnsClaim {
            network,
            vehicle: &vehicle,
            policy: set.policy,
            params: &params,
            max_shift_m: settings.stet.max_shift_m,
            facts,
            edges: &edges,
            rows: &rows,
            plans: &plans,
        };
        Ok(claim.check(stop)?)
    }

    /// The rows whose hashes of seed and id are least, or all rows without a sample.
    fn sampled<R>(&self, mut rows: Vec<R>, id: impl Fn(&R) -> i64) -> Vec<R> {
        if let Some(n) = self.sample {
            let key = |row: &R| {
                let mut bytes = SEED.to_le_bytes().to_vec();
                bytes.extend(id(row).to_le_bytes());
                *blake3::hash(&bytes).as_bytes()
            };
            rows.sort_by_cached_key(key);
            rows.truncate(n);
        }
        rows
    }
}

/// Complaints about edges of the network that have no row in a set.
fn missing_edges(
    database: &mut Database,
    network: &Network,
    set: &CertifiedSet,
) -> Result<Vec<Complaint>, VerifyError> {
    let rows = database.edge_standings(&set.vehicle_id, set.policy)?;
    let there: Vec<u32> = rows.map(|row| row.map(|(index, _)| index)).collect::<Result<_, _>>()?;
    Ok(missing(set, CertificateKind::Edge, &there, network.edges.iter().map(|edge| edge.id)))
}

/// Complaints about turns of the network that have no row in a set.
fn missing_turns(
    database: &mut Database,
    facts: &[TurnFacts],
    set: &CertifiedSet,
) -> Result<Vec<Complaint>, VerifyError> {
    let rows = database.turn_standings(&set.vehicle_id, set.policy)?;
    let there: Vec<u32> = rows.map(|row| row.map(|(index, _)| index)).collect::<Result<_, _>>()?;
    Ok(missing(set, CertificateKind::Turn, &there, facts.iter().map(|turn| turn.id)))
}

/// `there`: the indices of the rows, in order. `all`: the ids of what is to have one.
fn missing(set: &CertifiedSet, kind: CertificateKind, there: &[u32], all: impl Iterator<Item = i64>) -> Vec<Complaint> {
    let lacking = (0_u32..).zip(all).filter(|(index, _)| there.binary_search(index).is_err());
    let complaint = |(_, id): (u32, i64)| Complaint {
        grade: Grade::Malformed,
        detail: format!("{} {} {id}: it has no certificate", set.vehicle_id, kind.word()),
    };
    lacking.map(complaint).collect()
}

/// Decides again what of the register counts. Complaints name measurements for which the database says otherwise.
fn measurements(database: &mut Database, network: &Network) -> Result<Vec<Complaint>, VerifyError> {
    let kept = database.register()?.entries;
    let mut again = kept.clone();
    evidence::match_again(network, &mut again);
    evidence::decide(network, &mut again);
    let differ = kept.iter().zip(&again).filter(|(kept, again)| kept != again);
    let complaint = |(kept, _): (&Entry, &Entry)| Complaint {
        grade: Grade::NotConfirmed,
        detail: format!("measurement {}: its place, or whether it counts there, is not what follows from it", kept.no),
    };
    Ok(differ.map(complaint).collect())
}

/// The vehicle of a set, as the database defines it.
fn defined(database: &mut Database, set: &CertifiedSet) -> Result<Vehicle, VerifyError> {
    let records = database.vehicles()?;
    let Some(record) = records.into_iter().find(|record| record.id == set.vehicle_id) else {
        return Err(VerifyError::NoDefinition { vehicle_id: set.vehicle_id.clone() });
    };
    Ok(Vehicle::from_json(&record.definition)?)
}
