//! A region in memory with everything that routes need: network, movements, and permits of one vehicle for edges and
//! turns.

use std::collections::HashMap;
use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::sync::Arc;

use netcert::certify::{Job, TurnJob, certify_network, certify_turns};
use netcert::network::{Movement, build};
use netcert::osm::facts::{Countries, Policy, cross_sections};
use netcert::osm::pbf::read_extract;
use netcert::osm::{Extract, LonLat, NodeId, Way};
use netcert::route::{self, MadeTurns, Measure, Permit, Permits, Planner, Roads, Speeds, Strokes};
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::turns::{Kerbs, turn_facts};

use crate::catalogue::catalogued;
use netcert::reporter::Silent;

/// A network with its movements.
pub struct TestRegion {
    pub roads: Arc<Roads>,
    pub settings: Settings,
    pub kerbs: Kerbs,
}

impl Deref for TestRegion {
    type Target = Roads;

    fn deref(&self) -> &Roads {
        &self.roads
    }
}

/// A vehicle on it. Tests may change its permits between two planners.
pub struct TestDriver(pub Arc<route::Driver>);

impl Deref for TestDriver {
    type Target = route::Driver;

    fn deref(&self) -> &route::Driver {
        &self.0
    }
}

impl DerefMut for TestDriver {
    fn deref_mut(&mut self) -> &mut route::Driver {
        Arc::get_mut(&mut self.0).expect("no planner has it any more")
    }
}

impl TestRegion {
    pub fn read(path: &Path, policy: Policy) -> Self {
        Self::of(read_extract(path, &|_| ()).unwrap(), policy)
    }

    /// The roads within the given degrees of the middle of an extract's nodes.
    pub fn read_middle(path: &Path, policy: Policy, about_deg: [f64; 2]) -> Self {
        let mut extract = read_extract(path, &|_| ()).unwrap();
        let degrees = |id: &NodeId| extract.nodes.place(*id).map(LonLat::degrees);
        let refs = |way: &Way| extract.refs[way.refs.start as usize..way.refs.end as usize].iter();
        let middle = |k: fn((f64, f64)) -> f64| {
            let mut all: Vec<f64> = extract.refs.iter().filter_map(degrees).map(k).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let (lon, lat) = (middle(|p| p.0), middle(|p| p.1));
        let near = |p: (f64, f64)| (p.0 - lon).abs() < about_deg[0] && (p.1 - lat).abs() < about_deg[1];
        let ways = extract.ways.iter().filter(|way| refs(way).filter_map(degrees).any(near)).cloned().collect();
        extract.ways = ways;
        Self::of(extract, policy)
    }

    pub fn of(extract: Extract, policy: Policy) -> Self {
        let countries = Countries::load().unwrap();
        let rules = countries.rules();
        let (network, _) = build(extract, &|position| countries.jurisdiction(position), &|way, place, ring| {
            cross_sections(way, place, ring, rules)
        });
        // Permits need no needs, and on real extracts the search for them takes longer than all certificates.
        let settings = Settings { policy, needs: Needs::Off, ..Settings::default() };
        Self { roads: Roads::new(network), settings, kerbs: Kerbs::default() }
    }

    pub fn driver(&self, id: &str) -> TestDriver {
        let model = Model::new(&catalogued(id)).unwrap();
        let models = std::slice::from_ref(&model);
        let settings = self.settings();
        let job = Job { network: &self.network, models, settings: &settings };
        let mut edges = vec![Permit::UNKNOWN; self.network.edges.len()];
        certify_network(&job, &Silent, |_, certificate| {
            let rsc_m = certificate.conclusion.measured.map(|measured| measured.rsc_m);
            edges[certificate.edge.index()] = Permit { verdict: certificate.conclusion.verdict, rsc_m };
            Ok::<(), ()>(())
        })
        .unwrap();
        let permits = self.with_turns(&model, edges);
        TestDriver(Arc::new(route::Driver { model, permits, attested: route::Attested::default() }))
    }

    /// Permits with turns, certified as the pipeline does.
    fn with_turns(&self, model: &Model, edges: Vec<Permit>) -> Permits {
        let settings = self.settings();
        let turns = turn_facts(&self.network, &settings.kerbs);
        let verdicts = vec![edges.iter().map(|permit| permit.verdict).collect()];
        let models = std::slice::from_ref(model);
        let network = &self.network;
        let job = TurnJob { network, turns: &turns, models, edges: &verdicts, settings: &settings };
        let mut found = HashMap::new();
        certify_turns(&job, &Silent, |_, certificate| {
            let Movement { from, to, .. } = turns[certificate.turn.index()].movement;
            let rsc_m = certificate.conclusion.measured.map(|measured| measured.rsc_m);
            found.insert((from, to), Permit { verdict: certificate.conclusion.verdict, rsc_m });
            Ok::<(), ()>(())
        })
        .unwrap();
        let turn = |from, to| found.get(&(from, to)).copied().unwrap_or(Permit::UNKNOWN);
        Permits::new(settings, edges, &self.movements, turn)
    }

    fn settings(&self) -> Settings {
        Settings { kerbs: self.kerbs.clone(), ..self.settings.clone() }
    }

    pub fn strokes(&self) -> Strokes {
        Strokes::new(&self.roads, self.settings())
    }

    pub fn turns(driver: &TestDriver) -> MadeTurns {
        MadeTurns::new(Arc::clone(&driver.0))
    }

    pub fn planner(&self, driver: &TestDriver, measure: Measure) -> Planner {
        Planner::new(&self.roads, Arc::clone(&driver.0), Speeds::builtin().unwrap(), measure)
    }
}
