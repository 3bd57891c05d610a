//! Writes a whole new database into `PATH.part`. [`Writer::finish`] checks the file and puts it in place.
//!
//! The same calls give the same bytes, in whatever order certificates come. The caller gives the time stamps.

mod create;
mod finish;
mod placing;

use std::io;
use std::path::Path;

use crate::account::AccountRow;
use crate::network::{EdgeNo, MappedArea, Portion};
use crate::osm::facts::Policy;
use crate::osm::{Backdrop, NodeId};
use netcert_roads::turns::{JunctionArea, TurnFacts, TurnNo};
use netcert_rows::{EdgeCertificate, EdgeMeasure, SegmentRow, StoredPlan, TurnCertificate};

use crate::columns::set_no::SetNo;
use crate::error::StoreError;
use crate::file::companions::{sorter, with_suffix};
use crate::file::unfinished_file::UnfinishedFile;
use crate::provenance::records::VehicleRecord;
use crate::register::evidence::Register;
use crate::results::carry_over::StoredCertificate;
use crate::results::checkpoint::{self, Checkpoint};
use crate::results::compact::CompactCertificate;
use crate::results::turns::{self, TurnOrder};
use crate::results::write_order::CertificateSorter;
use crate::roads::map_changes::MapChanges;
use crate::roads::network_rows::MapRows;
use crate::roads::network_thread::NewNetwork;
use crate::writer::placing::OlderRegister;
use netcert_files::sorter::Sorter;

/// The number of a vehicle in a [`Writer`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VehicleNo(u32);

/// A database under construction. If it is dropped unfinished, an older file at its path stays unchanged.
pub struct Writer {
    /// Dropped before `part`, which then nobody writes any more.
    network: NewNetwork,
    /// The stored text of the settings, by the policy's number.
    settings: Vec<String>,
    vehicles: Vec<VehicleRecord>,
    account: Vec<AccountRow>,
    map_rows: MapRows,
    certificates: CertificateSorter,
    turns: Option<Turns>,
    /// Nothing if there is no older database, or none with measurements that can be read.
    older: Option<OlderRegister>,
    /// The register to write.
    evidence: Register,
    map_changes: MapChanges,
    segments: Vec<SegmentRow>,
    part: UnfinishedFile,
}

/// Turns and the areas of their junctions, as portions bring them.
struct Turns {
    /// By their places in the whole network: the turns with their numbers in the order of their arrival.
    rows: Sorter<TurnOrder, (u32, turns::TurnRecord)>,
    count: u32,
    /// By node.
    junctions: Sorter<NodeId, JunctionArea>,
    /// By the turns' numbers.
    certificates: CertificateSorter,
}

impl Turns {
    fn create(path: &Path) -> io::Result<Self> {
        let rows = sorter(path, "-turns")?;
        let junctions = sorter(path, "-junctions")?;
        let certificates = CertificateSorter::create(&with_suffix(path, "-turn"))?;
        Ok(Self { rows, count: 0, junctions, certificates })
    }
}

impl Writer {
    /// Whether a killed run had left a part behind, which was emptied.
    #[must_use]
    pub fn replaced_leftover(&self) -> bool {
        self.part.leftover
    }

    /// The work that a killed run with this identity has finished; empty if there is none.
    ///
    /// # Errors
    /// The file beside the database cannot be written.
    pub fn checkpoint(&self, identity: &[u8; 32]) -> Result<Checkpoint, StoreError> {
        Checkpoint::open(checkpoint::path_of(&self.part.target), identity)
    }

    /// The register of the older database; `None` if it has no measurements and never had any, or cannot be read.
    #[must_use]
    pub fn older_register(&self) -> Option<Register> {
        let known = self.older.as_ref()?.as_ref().ok()?;
        (known.0.last_no > 0).then(|| known.0.clone())
    }

    /// Why the register of the older database cannot be read, if so.
    #[must_use]
    pub fn register_lost(&self) -> Option<&StoreError> {
        self.older.as_ref()?.as_ref().err()
    }

    /// Adds the register. The network must have its site.
    pub fn evidence(&mut self, register: Register) {
        self.evidence = register;
    }

    /// Adds what was applied to the extract before it was read.
    pub fn map_changes(&mut self, changes: MapChanges) {
        self.map_changes = changes;
    }

    /// Adds the segments that the ways were made from, in the order of the ways.
    pub fn segments(&mut self, segments: Vec<SegmentRow>) {
        self.segments = segments;
    }

    /// Adds what a portion owns of the network. `measures` has one entry per edge of the portion's network, or is empty. The call may
    /// follow those of the certificates, because the measures are known only then.
    pub fn portion(&mut self, portion: &Portion, measures: &[EdgeMeasure]) -> Result<(), StoreError> {
        let added = self.network.rows().and_then(|rows| rows.add(portion, measures));
        added.map_err(|e| StoreError::io(&self.part.target, e))?;
        self.map_rows.restrictions.extend(portion.restrictions());
        Ok(())
    }

    /// Begins to write the network, which has all its portions, on a thread of its own. [`Writer::finish`] reports what fails there.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn network_complete(mut self) -> Result<Self, StoreError> {
        self.network = NewNetwork::Writing(self.network.write(&self.part.path)?);
        Ok(self)
    }

    /// Adds the areas of the whole network.
    pub fn areas(&mut self, areas: Vec<MappedArea>) {
        self.map_rows.areas = areas;
    }

    /// Adds what lies behind the roads.
    pub fn backdrop(&mut self, things: &[Backdrop]) -> Result<(), StoreError> {
        self.map_rows.add_backdrop(things).map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds a vehicle. Ids must be distinct.
    pub fn vehicle(&mut self, vehicle: VehicleRecord) -> VehicleNo {
        self.vehicles.push(vehicle);
        VehicleNo(self.vehicles.len() as u32)
    }

    /// Adds the certificate of one edge, given by its number in the whole network; edges may come in any order. A vehicle and policy with any certificate must get
    /// exactly one for every edge. Refuses a `safe` certificate whose numbers do not support it.
    pub fn certificate(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        certificate: &EdgeCertificate,
    ) -> Result<(), StoreError> {
        let packed = CompactCertificate::edge(certificate)
            .map_err(|detail| unsound(&self.vehicles, vehicle.0, certificate.edge.get(), detail))?;
        self.push(vehicle, policy, packed)
    }

    fn push(&mut self, vehicle: VehicleNo, policy: Policy, packed: CompactCertificate) -> Result<(), StoreError> {
        let waiting = self.certificates.certificate(SetNo { vehicle_no: vehicle.0, policy }, packed);
        waiting.map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds the plan of a stroke whose plan is not the centreline, by the index of its first edge in the whole network. A stroke has at most
    /// one.
    pub fn plan(&mut self, vehicle: VehicleNo, policy: Policy, plan: &StoredPlan) -> Result<(), StoreError> {
        let waiting = self.certificates.plan(SetNo { vehicle_no: vehicle.0, policy }, plan);
        waiting.map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds turns that a portion owns, and the areas of junctions in it. Returns the number of the first turn; the others follow it. Their
    /// certificates come by these numbers.
    pub fn turns(
        &mut self,
        portion: &Portion,
        facts: &[TurnFacts],
        junctions: &[JunctionArea],
    ) -> Result<TurnNo, StoreError> {
        let at = |e| StoreError::io(&self.part.target, e);
        let turns = match &mut self.turns {
            Some(turns) => turns,
            none => none.insert(Turns::create(&self.part.path).map_err(at)?),
        };
        let first = TurnNo::new(turns.count);
        for facts in facts {
            let record = turns::TurnRecord::new(&portion.network, facts, |edge| portion.edge(edge));
            turns.rows.push(record.key(), &(turns.count, record)).map_err(at)?;
            turns.count += 1;
        }
        junctions.iter().try_for_each(|area| turns.junctions.push(area.node, area)).map_err(at)?;
        Ok(first)
    }

    /// Adds the certificate of one turn; turns may come in any order. `first` is what [`Writer::turns`] returned for its portion. A vehicle
    /// and policy with any certificate of a turn must get exactly one for every turn.
    pub fn turn_certificate(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        first: TurnNo,
        certificate: &TurnCertificate,
    ) -> Result<(), StoreError> {
        let packed = CompactCertificate::turn(certificate)
            .map_err(|detail| unsound(&self.vehicles, vehicle.0, certificate.turn.get(), detail))?;
        let plan = certificate.plan.clone().map(|plan| StoredPlan { at: plan.at + first.get(), ..plan });
        self.push_turn(vehicle, policy, CompactCertificate { fid: packed.fid + first.get(), ..packed }, plan)
    }

    fn push_turn(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        packed: CompactCertificate,
        plan: Option<StoredPlan>,
    ) -> Result<(), StoreError> {
        let Some(turns) = &mut self.turns else { return Ok(()) };
        let set = SetNo { vehicle_no: vehicle.0, policy };
        let mut waiting = turns.certificates.certificate(set, packed);
        if let Some(plan) = plan {
            waiting = waiting.and_then(|()| turns.certificates.plan(set, &plan));
        }
        waiting.map_err(|e| StoreError::io(&self.part.target, e))
    }

    /// Adds a certificate of an older database for the edge with this number.
    ///
    /// # Errors
    /// A temporary file cannot be written.
    pub fn kept(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        edge: EdgeNo,
        kept: &StoredCertificate,
    ) -> Result<(), StoreError> {
        self.push(vehicle, policy, CompactCertificate { fid: edge.get() + 1, ..kept.packed })
    }

    /// Adds a certificate of an older database for the turn with this number.
    ///
    /// # Errors
    /// A temporary file cannot be written.
    pub fn kept_turn(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        turn: TurnNo,
        kept: &StoredCertificate,
        plan: Option<StoredPlan>,
    ) -> Result<(), StoreError> {
        self.push_turn(vehicle, policy, CompactCertificate { fid: turn.get() + 1, ..kept.packed }, plan)
    }

    /// Adds to the account of the run.
    pub fn account(&mut self, rows: &[AccountRow]) {
        self.account.extend_from_slice(rows);
    }
}

fn unsound(vehicles: &[VehicleRecord], vehicle_no: u32, edge: u32, detail: String) -> StoreError {
    let vehicle = vehicles.get(vehicle_no as usize - 1).map_or("", |vehicle| &vehicle.id).to_owned();
    StoreError::Unsound { edge, vehicle, detail }
}
