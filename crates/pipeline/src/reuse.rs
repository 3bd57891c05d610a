//! What an earlier database has of the same roads: its certificates stand where nothing changed on which they depend.
//!
//! They stand only if the earlier database was made by the same program with the same road rules, settings and vehicles.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::certify::{Dependents, NearNodes};
use crate::network::{Differences, EdgeNo, Network, Portion};
use crate::osm::changes::Changes;
use crate::osm::facts::Countries;
use crate::osm::{LonLat, NodeId};
use crate::reporter::Silent;
use crate::rows::{EdgeMeasure, StoredPlan};
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{self, CertifiedSet, Database, StoredPlans};
use crate::turns::{JunctionArea, TurnFacts, TurnNo, turn_facts};
use crate::verdict::{UnknownReason, Verdict};

use super::error::RunError;
use super::identity;
use super::recertification::StoredSet;
use super::roads::{Portions, read_roads};
use super::source::MapSource;
use super::summary::{StageSummary, Summary};
use super::vehicle_record::record;

/// The certificates of one vehicle.
struct Set {
    edges: Vec<store::StoredCertificate>,
    turns: Vec<store::StoredCertificate>,
    /// By first edge of the stroke, and by turn.
    plans: StoredPlans,
    turn_plans: StoredPlans,
}

/// What stands of an earlier database.
pub(super) struct Earlier {
    differences: Differences,
    measures: Vec<EdgeMeasure>,
    /// By vehicle of the run.
    sets: Vec<Set>,
    /// Turns of the earlier network.
    facts: Vec<TurnFacts>,
    /// Areas of its junctions, by node.
    junctions: Vec<JunctionArea>,
    /// Strokes and nodes of the new network that do not stand. It has no turns.
    touched: Dependents,
}

/// An earlier database.
pub(super) struct OlderDatabase<'a> {
    pub(super) database: &'a mut Database,
    /// Ids of the vehicles whose certificates may stand.
    pub(super) vehicles: Vec<String>,
    /// The extract and the changes that it was made from, if nothing else is in its network.
    pub(super) made_from: Option<(PathBuf, Changes)>,
}

/// An earlier database with the roads that it has, before they are compared with newer ones.
pub(super) struct StoredNetwork<'a> {
    database: &'a mut Database,
    vehicles: Vec<String>,
    pub(super) roads: Portion,
    /// Turns of the roads; none if none are certified.
    pub(super) facts: Vec<TurnFacts>,
    /// By edge of the database: its id, and what its corridor measures.
    pub(super) measures: Vec<(i64, EdgeMeasure)>,
    pub(super) certificates: Certificates,
    /// How long it took to read, seconds.
    seconds: f64,
}

/// The certificates of an earlier database.
pub(super) enum Certificates {
    /// The verdicts, if rows may be changed in place, and the connection that lets no other program change the database meanwhile.
    InPlace(Database, Vec<StoredSet>),
    /// All that they say.
    Read(KeptSets),
}

/// Certificates, and the areas of junctions by node.
pub(super) struct KeptSets {
    sets: Vec<Set>,
    junctions: Vec<JunctionArea>,
}

impl KeptSets {
    fn read(database: &mut Database, vehicles: &[String], settings: &Settings) -> Result<Self, RunError> {
        let mut sets = Vec::new();
        for id in vehicles {
            let [plans, turn_plans] = database.kept_plans(id, settings.policy)?;
            let edges = database.kept_edges(id, settings.policy)?;
            let turns = database.kept_turns(id, settings.policy)?;
            sets.push(Set { edges, turns, plans, turn_plans });
        }
        Ok(Self { sets, junctions: if settings.turns { database.junction_areas()? } else { Vec::new() } })
    }
}

impl<'a> StoredNetwork<'a> {
    /// Reads roads and verdicts beside each other. If the extract is known, the network is built from it again, which takes a third of the time
    /// of loading it.
    pub(super) fn read(older: OlderDatabase<'a>, countries: &Countries, settings: &Settings) -> Result<Self, RunError> {
        let clock = Instant::now();
        let OlderDatabase { database, vehicles, made_from } = older;
        let path = database.path().to_owned();
        let in_place = made_from.is_some();
        let of_database = || {
            // A database that is only to be read, or that another program is changing, is not changed in place.
            let change = |mut db: Database| db.begin_change().map(|()| db);
            let locked = in_place.then(|| Database::open_to_change(&path).and_then(change).ok()).flatten();
            if let Some(mut db) = locked {
                let (measures, sets) = (db.edge_measures()?, StoredSet::all(&mut db, &path)?);
                return Ok((measures, Certificates::InPlace(db, sets)));
            }
            let mut db = Database::open(&path)?;
            Ok::<_, RunError>((db.edge_measures()?, Certificates::Read(KeptSets::read(&mut db, &vehicles, settings)?)))
        };
        // Not on rayon's threads, which build the newer network meanwhile: these wait for SQLite most of the time.
        let (roads, of_database) = std::thread::scope(|scope| {
            let of_database = scope.spawn(of_database);
            let roads = match &made_from {
                Some((extract, changes)) => built(extract, changes, countries),
                None => database.load_network().map(Portion::whole).map_err(RunError::from),
            };
            let facts =
                |roads: &Portion| if settings.turns { turn_facts(&roads.network, &settings.kerbs) } else { Vec::new() };
            let roads = roads.map(|roads| (facts(&roads), roads));
            (roads, of_database.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        });
        let ((facts, roads), (measures, certificates)) = (roads?, of_database?);
        let seconds = clock.elapsed().as_secs_f64();
        Ok(Self { database, vehicles, roads, facts, measures, certificates, seconds })
    }

    /// Whether the database has the edges of the roads that were read for it.
    pub(super) fn has_these_edges(&self) -> bool {
        self.measures.iter().map(|(id, _)| *id).eq(self.roads.network.edges.iter().map(|edge| edge.id))
    }

    /// The summary of loading.
    pub(super) fn stage(&self) -> StageSummary {
        let items = self.roads.network.edges.len() as u64;
        StageSummary { stage: "load", seconds: self.seconds, items, what: "directed edges" }
    }
}

/// Whether the certificate of an edge was not made, because it took too long or a machine failed. A forbidden edge keeps its verdict then,
/// and lacks its measures.
pub(super) fn is_undone(verdict: Verdict, measure: &EdgeMeasure) -> bool {
    verdict.claims_nothing() || (matches!(verdict, Verdict::Forbidden(_)) && measure.centreline_deviation_m.is_none())
}

/// Why an edge that is taken over has no corridor, as far as its verdicts tell.
pub(super) fn without_corridor(
    measure: EdgeMeasure,
    mut verdicts: impl Iterator<Item = Verdict>,
) -> Option<UnknownReason> {
    let reason = |verdict| match verdict {
        Verdict::Unknown(reason @ (UnknownReason::Geometry | UnknownReason::Width)) => Some(reason),
        _ => None,
    };
    let missing = measure == EdgeMeasure::default();
    verdicts.find_map(reason).or(missing.then_some(UnknownReason::Geometry))
}

impl Earlier {
    /// Finds what stands in a newer network. `None` if the earlier database lacks certificates, or has other edges than the network that was
    /// read for it.
    pub(super) fn find(
        stored: StoredNetwork<'_>,
        network: &Network,
        settings: &Settings,
    ) -> Result<Option<Self>, RunError> {
        if !stored.has_these_edges() {
            return Ok(None);
        }
        let StoredNetwork {
            database,
            vehicles,
            roads: Portion { network: old, .. },
            facts,
            measures,
            certificates,
            ..
        } = stored;
        let KeptSets { sets, junctions } = match certificates {
            Certificates::Read(kept) => kept,
            Certificates::InPlace(locked, _) => {
                drop(locked);
                KeptSets::read(database, &vehicles, settings)?
            }
        };
        let whole =
            |set: &Set| set.edges.len() == old.edges.len() && (!settings.turns || set.turns.len() == facts.len());
        if !sets.iter().all(whole) {
            return Ok(None);
        }
        let differences = Differences::find(&old, network);
        let touched = Dependents::find(network, &[], &differences.edges, &differences.nodes);
        let measures = measures.into_iter().map(|(_, measure)| measure).collect();
        Ok(Some(Self { differences, measures, sets, facts, junctions, touched }))
    }

    /// The strokes that stand, as indices into the new network. A stroke whose certificates claim nothing does not.
    pub(super) fn strokes(&self, network: &Network) -> impl Iterator<Item = u32> {
        let touched: FxHashSet<u32> = self.touched.strokes.iter().copied().collect();
        let made = |stroke: &u32| {
            self.edges(network, *stroke)
                .all(|(_, measure, kept)| !kept.iter().any(|kept| is_undone(kept.verdict(), &measure)))
        };
        (0_u32..).take(network.strokes.len()).filter(move |stroke| !touched.contains(stroke) && made(stroke))
    }

    fn older(&self, edge: EdgeNo) -> Option<EdgeNo> {
        self.differences.older.get(edge.index()).copied().flatten()
    }

    /// The edges of a stroke that stands: measures, and one certificate for each vehicle.
    pub(super) fn edges<'a>(
        &'a self,
        network: &'a Network,
        stroke: u32,
    ) -> impl Iterator<Item = (EdgeNo, EdgeMeasure, Vec<&'a store::StoredCertificate>)> {
        edges_of(network, stroke).iter().filter_map(|&edge| {
            let older = self.older(edge)?.index();
            let kept = self.sets.iter().map(|set| set.edges.get(older)).collect::<Option<Vec<_>>>()?;
            Some((edge, *self.measures.get(older)?, kept))
        })
    }

    /// The plans of a stroke that stands, with their vehicle's index.
    pub(super) fn plans(&self, network: &Network, stroke: u32) -> Vec<(usize, StoredPlan)> {
        let Some(&first) = edges_of(network, stroke).first() else { return Vec::new() };
        let Some(older) = self.older(first) else { return Vec::new() };
        let plan = |(vehicle, set): (usize, &Set)| Some((vehicle, set.plans.at(older.get(), first.get())?));
        self.sets.iter().enumerate().filter_map(plan).collect()
    }

    /// The turns that stand: one certificate and plan for each vehicle.
    pub(super) fn turns<'a>(
        &'a self,
        network: &Network,
        turns: &'a [TurnFacts],
    ) -> impl Iterator<Item = (TurnNo, Vec<(&'a store::StoredCertificate, Option<StoredPlan>)>)> {
        let touched = Dependents::find(network, turns, &self.differences.edges, &self.differences.nodes);
        let touched: FxHashSet<TurnNo> = touched.turns.into_iter().collect();
        let by_id: FxHashMap<i64, TurnNo> =
            TurnNo::all().zip(&self.facts).map(|(index, turn)| (turn.id, index)).collect();
        TurnNo::all().zip(turns).filter_map(move |(index, turn)| {
            let older = *by_id.get(&turn.id)?;
            let stands = !touched.contains(&index) && self.same_turn(self.facts.get(older.index())?, turn);
            let of = |set: &'a Set| {
                let plan = set.turn_plans.at(older.get(), index.get());
                Some((set.turns.get(older.index())?, plan))
            };
            let kept = stands.then(|| self.sets.iter().map(of).collect::<Option<Vec<_>>>()).flatten();
            // What was not done is done now.
            let made = |kept: &Vec<(&store::StoredCertificate, _)>| {
                !kept.iter().any(|(kept, _)| kept.verdict().claims_nothing())
            };
            kept.filter(made).map(|kept| (index, kept))
        })
    }

    /// The areas that stand of the junctions at some nodes, and the nodes whose areas do not.
    pub(super) fn junctions(&self, network: &Network, places: &[(NodeId, LonLat)]) -> (Vec<JunctionArea>, Vec<NodeId>) {
        let touched = NearNodes::new(network, &self.touched.nodes);
        let (mut stand, mut others) = (Vec::new(), Vec::new());
        for &(node, place) in places {
            match self
                .junctions
                .binary_search_by_key(&node, |area| area.node)
                .ok()
                .and_then(|at| self.junctions.get(at))
            {
                Some(area) if !touched.has(&[place]) => stand.push(area.clone()),
                _ => others.push(node),
            }
        }
        (stand, others)
    }

    fn same_turn(&self, old: &TurnFacts, new: &TurnFacts) -> bool {
        same_turn(&self.differences, old, new)
    }
}

/// Whether two turns of one id are the same movement with the same kerb and the same restriction.
pub(super) fn same_turn(differences: &Differences, old: &TurnFacts, new: &TurnFacts) -> bool {
    let TurnFacts { id, movement, through, angle_deg, kerb_radius_m, kerb_source, line } = new;
    let same = |edge: EdgeNo, older: EdgeNo| differences.older.get(edge.index()).copied().flatten() == Some(older);
    *id == old.id
        && same(movement.from, old.movement.from)
        && same(movement.to, old.movement.to)
        && movement.kind == old.movement.kind
        && movement.forbidden.is_some() == old.movement.forbidden.is_some()
        && through.len() == old.through.len()
        && through.iter().zip(&old.through).all(|(&edge, &older)| same(edge, older))
        && (angle_deg, kerb_radius_m, kerb_source, line)
            == (&old.angle_deg, &old.kerb_radius_m, &old.kerb_source, &old.line)
}

/// The network of an extract with changes.
fn built(extract: &Path, changes: &Changes, countries: &Countries) -> Result<Portion, RunError> {
    let source = MapSource { inputs: &[extract], changes };
    let (roads, _) = read_roads(source, countries, Portions::Whole, &mut |_| Ok(()), &Silent, &mut Summary::default())?;
    Ok(roads.into_whole())
}

fn edges_of(network: &Network, stroke: u32) -> &[EdgeNo] {
    let range =
        network.strokes.get(stroke as usize).map(|stroke| stroke.edges.start as usize..stroke.edges.end as usize);
    range.and_then(|range| network.stroke_edges.get(range)).unwrap_or_default()
}

/// Why nothing of a database can stand, if so.
pub(super) fn differs(
    database: &mut Database,
    models: &[Model],
    countries: &Countries,
    settings: &Settings,
) -> Result<Option<String>, RunError> {
    let runs = database.runs()?;
    if let Some((run, _)) = runs.iter().find(|(run, _)| run.netcert_version != identity::PROGRAM) {
        return Ok(Some(format!("the older database is by netcert {}", run.netcert_version)));
    }
    let rules = identity::of_rules(countries);
    let known = |run: &crate::store::Run| {
        let parameters: serde_json::Value = serde_json::from_str(&run.parameters).ok()?;
        Some(parameters.get(identity::ROAD_RULES)?.as_str()? == rules)
    };
    if !runs.iter().filter_map(|(run, _)| known(run)).next_back().unwrap_or(false) {
        return Ok(Some("the road rules are others".to_owned()));
    }
    let sets = database.certified()?;
    let records = database.vehicles()?;
    for model in models {
        let id = &model.vehicle.id;
        let definition = record(&model.vehicle)?.definition;
        let vehicle = records.iter().any(|record| record.id == *id && record.definition == definition);
        let mut of_vehicle = sets.iter().filter(|set| set.vehicle_id == *id && set.policy == settings.policy);
        let of_set = of_vehicle.next().map(CertifiedSet::settings).transpose()?;
        if !vehicle || of_set.as_ref() != Some(settings) {
            return Ok(Some(format!("{id} is not certified in the older database with the same settings")));
        }
    }
    Ok(None)
}
