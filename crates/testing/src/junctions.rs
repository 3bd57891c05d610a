//! Drawn junctions with kerbs of the test's own: turns and passages by name, the vehicles that can take them, and their
//! certificates.

use netcert::account::AccountRow;
use netcert::certify::{TurnJob, best_of, certify_turns};
use netcert::network::{EdgeNo, Network, build};
use netcert::osm::facts::{Countries, Jurisdiction, Policy, TrafficSide, cross_sections};
use netcert::rows::TurnCertificate;
use netcert::settings::Settings;
use netcert::stet::{Model, Options, SpanResult};
use netcert::turns::{Kerbs, LengthClass, TurnCorridors, TurnFacts, TurnParams, corridors_of, turn_facts};
use netcert::verdict::{UnknownReason, Verdict};

use crate::ascii_map::{AsciiMap, id_of};
use crate::catalogue::catalogued;
use netcert::osm::NodeId;
use netcert::reporter::Silent;

pub struct DrawnNetwork {
    pub network: Network,
    pub params: TurnParams,
}

/// Certificates with the number of their vehicle, in the order made, and their account.
pub type Certified = (Vec<(usize, TurnCertificate)>, Vec<AccountRow>);

impl DrawnNetwork {
    pub fn new(map: &AsciiMap, side: TrafficSide, kerb_m: f64) -> Self {
        let countries = Countries::load().unwrap();
        let rules = countries.rules();
        let jurisdiction = |_| Jurisdiction { country: *b"DE", left_hand_traffic: side == TrafficSide::Left };
        let (network, _) =
            build(map.extract(), &jurisdiction, &|facts, at, ring| cross_sections(facts, at, ring, rules));
        Self { network, params: TurnParams { kerbs: Kerbs::everywhere(kerb_m), ..TurnParams::default() } }
    }

    pub fn facts(&self) -> Vec<TurnFacts> {
        turn_facts(&self.network, &self.params.kerbs)
    }

    /// The turn with the nodes that it passes: `EBC` from E over B to C.
    pub fn turn(&self, nodes: &str) -> TurnFacts {
        let ids: Vec<NodeId> = nodes.chars().map(id_of).collect();
        let is = |edge: EdgeNo, from: NodeId, to: NodeId| {
            let edge = &self.network.edges[edge.index()];
            (edge.from_node, edge.to_node) == (from, to)
        };
        let fits = |t: &TurnFacts| is(t.movement.from, ids[0], ids[1]) && is(t.movement.to, ids[1], ids[2]);
        self.facts().into_iter().find(fits).unwrap_or_else(|| panic!("{nodes} is no turn"))
    }

    /// Roundabouts as one movement.
    pub fn passages(&self) -> Vec<TurnFacts> {
        self.facts().into_iter().filter(|turn| !turn.through.is_empty()).collect()
    }

    /// The passage from the end of one arm to the end of another: `WE`.
    pub fn passage(&self, ends: &str) -> TurnFacts {
        let ids: Vec<NodeId> = ends.chars().map(id_of).collect();
        let edge = |edge: EdgeNo| &self.network.edges[edge.index()];
        let fits = |t: &TurnFacts| edge(t.movement.from).from_node == ids[0] && edge(t.movement.to).to_node == ids[1];
        self.passages().into_iter().find(fits).unwrap_or_else(|| panic!("{ends} is no passage"))
    }

    /// Corridors of a turn (named by three nodes) or of a passage (named by two ends).
    pub fn corridors(
        &self,
        name: &str,
        policy: Policy,
        length_class: LengthClass,
    ) -> Result<TurnCorridors, UnknownReason> {
        let turn = if name.len() == 2 { self.passage(name) } else { self.turn(name) };
        corridors_of(&self.network, &turn, policy, &self.params, length_class)
    }

    pub fn best(&self, name: &str, policy: Policy, id: &str) -> Option<SpanResult> {
        let vehicle = catalogued(id);
        let made = self.corridors(name, policy, LengthClass::of(&vehicle).unwrap()).unwrap();
        let model = Model::new(&vehicle).unwrap();
        best_of(&made, &[&model], &Options::default()).pop().unwrap().map(|(_, result)| result)
    }

    pub fn safe(&self, name: &str, policy: Policy, id: &str) -> bool {
        self.best(name, policy, id).is_some_and(|result| result.safe())
    }

    /// Certifies all turns and passages. `edges` are the vehicles' verdicts on the edges.
    pub fn certified(&self, ids: &[&str], edges: &[Verdict], policy: Policy, threads: usize) -> Certified {
        let models: Vec<Model> = ids.iter().map(|id| Model::new(&catalogued(id)).unwrap()).collect();
        let edges = vec![edges.to_vec(); models.len()];
        let (corridor, kerbs) = (self.params.corridor, self.params.kerbs.clone());
        let settings = Settings { policy, corridor, kerbs, ..Settings::default() };
        let (network, turns) = (&self.network, self.facts());
        let job = TurnJob { network, turns: &turns, models: &models, edges: &edges, settings: &settings };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut out = Vec::new();
            let outcome = certify_turns(&job, &Silent, |vehicle, certificate| {
                out.push((vehicle, certificate.clone()));
                Ok::<(), ()>(())
            });
            (out, outcome.unwrap().rows())
        })
    }
}
