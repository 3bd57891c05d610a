//! A survey of a whole region: what joins the component in which a vehicle can drive from everywhere to everywhere.

use std::sync::Arc;

use super::bundles::{Bundle, BundleSearch};
use super::component::Component;
use super::joints::{CLOSED, Item, Joints, OPEN};
use super::opening::{HopelessItems, Opened, Opener};
use super::{Opens, Survey, SurveyStep};
use crate::conditions::Suppositions;
use crate::driver::Driver;
use crate::graph::Graph;
use crate::network::EdgeNo;
use crate::permits::Permits;
use crate::reach::components;
use crate::reporter::Reporter;
use crate::roads::Roads;
use crate::speeds::{Measure, Speeds};
use crate::stop::{Stop, Stopped};

/// How many bundles are certified for one step, at most.
const TRIES: usize = 16;

/// The measurements that open most of a region for a vehicle, the best first. The component that grows is the one with the most edges, or the
/// longest one that has one of the edges `from`. `stop` is checked before each search and each place that is certified.
///
/// # Errors
/// `stop` was told.
pub fn survey_region(
    roads: &Arc<Roads>,
    driver: &Arc<Driver>,
    speeds: &Speeds,
    from: &[EdgeNo],
    limit: usize,
    reporter: &dyn Reporter,
    stop: &Stop,
) -> Result<Survey, Stopped> {
    stop.check()?;
    let joints = Joints::of(roads, &driver.model.vehicle);
    let lengths_m: Vec<f64> = roads.network.edges.iter().map(|edge| roads.network.length_m(edge)).collect();
    let prices = joints.prices(roads, &driver.permits);
    let certified = EdgeNo::all().zip(&lengths_m).filter(|(edge, _)| driver.permits.edge(*edge));
    let all = certified.map(|(_, length_m)| length_m).fold(0.0, |sum, m| sum + m);
    let mut survey = Survey { opens: Opens::Metres, all, before: 0.0, steps: Vec::new(), hopeless: 0, gave_up: false };
    let Some(anchor) = anchor(roads, driver, speeds, &joints, &prices, &lengths_m, from) else { return Ok(survey) };
    let mut surveyor = Surveyor {
        opener: Opener::new(roads, driver, &joints),
        component: Component::of(&joints, &prices, anchor),
        permits: driver.permits.clone(),
        by_place: joints.by_place(),
        closed: Vec::new(),
        roads,
        joints,
        lengths_m,
        prices,
        anchor,
    };
    survey.before = surveyor.component.length_m(&surveyor.lengths_m);
    let mut reachable = survey.before;
    reporter.begin("survey", limit as u64);
    for rank in 0..limit {
        let Some((opened, now_m)) = surveyor.best(&mut survey.gave_up, stop)? else { break };
        let conditions = opened.conditions.clone();
        survey.steps.push(SurveyStep::new(roads, &surveyor.joints, conditions, now_m - reachable, now_m));
        reachable = now_m;
        surveyor.choose(opened);
        reporter.advance(rank as u64 + 1);
    }
    reporter.end();
    survey.hopeless = surveyor.hopeless_places();
    Ok(survey)
}

/// An edge of the component that is to grow. `None` if nothing is certified.
fn anchor(
    roads: &Arc<Roads>,
    driver: &Driver,
    speeds: &Speeds,
    joints: &Joints,
    prices: &[u32],
    lengths_m: &[f64],
    from: &[EdgeNo],
) -> Option<EdgeNo> {
    let usable = |edge: EdgeNo| driver.permits.edge(edge);
    // A journey that begins on a road to a destination goes on on the road before it.
    let usable =
        from.iter().copied().filter(|&edge| usable(edge)).map(|edge| joints.way_out(edge, usable).unwrap_or(edge));
    let length_m = |&edge: &EdgeNo| Component::of(joints, prices, edge).length_m(lengths_m);
    if let Some(edge) = usable.max_by(|a, b| length_m(a).total_cmp(&length_m(b))) {
        return Some(edge);
    }
    let graph = Graph::new(roads, speeds, Measure::Distance).for_vehicle(&driver.model.vehicle);
    let components = components(&graph, &driver.permits.access(&roads.movements));
    components.of.iter().position(|of| *of == Some(0)).map(EdgeNo::at)
}

struct Surveyor<'a> {
    roads: &'a Roads,
    joints: Joints,
    lengths_m: Vec<f64>,
    by_place: Vec<Vec<Item>>,
    anchor: EdgeNo,
    /// What is open with everything chosen, and what is not.
    permits: Permits,
    prices: Vec<u32>,
    component: Component,
    opener: Opener,
    /// Items that nothing opens.
    closed: Vec<Item>,
}

impl Surveyor<'_> {
    /// The best step from here, and the length of the component after it.
    fn best(&mut self, gave_up: &mut bool, stop: &Stop) -> Result<Option<(Opened, f64)>, Stopped> {
        let mut tries = TRIES;
        loop {
            let mut failed = false;
            let mut best: Option<(f64, Bundle, Suppositions)> = None;
            for bundle in self.field().bundles(stop)? {
                let score = best.as_ref().map_or(0.0, |best| best.0);
                if bundle.score() <= score || tries == 0 {
                    break;
                }
                let Some(bundle) = self.still_there(bundle) else { continue };
                let bundle = self.field().needed(&bundle);
                tries -= 1;
                match self.opener.open(&self.joints, &bundle.items, &self.permits, stop)? {
                    Ok(supposed) if bundle.score() > score => best = Some((bundle.score(), bundle, supposed)),
                    Ok(_) => {}
                    Err(HopelessItems(items)) => {
                        failed = true;
                        self.close(items);
                    }
                }
            }
            match best {
                Some((_, bundle, supposed)) => {
                    let opened = self.opener.certify(&self.joints, supposed, &self.permits);
                    let prices = self.prices_with(&opened.permits);
                    let now_m = Component::of(&self.joints, &prices, self.anchor).length_m(&self.lengths_m);
                    if now_m > self.component.length_m(&self.lengths_m) {
                        return Ok(Some((opened, now_m)));
                    }
                    self.close(bundle.items);
                }
                // Without what nothing opens, other bundles may be there.
                None if failed && tries > 0 => {}
                None => {
                    *gave_up |= tries == 0;
                    return Ok(None);
                }
            }
        }
    }

    fn close(&mut self, items: Vec<Item>) {
        items.iter().for_each(|&item| self.prices[item as usize] = CLOSED);
        self.closed.extend(items);
    }

    fn field(&self) -> BundleSearch<'_> {
        let Self { joints, prices, component, lengths_m, by_place, .. } = self;
        BundleSearch { joints, prices, component, lengths_m, by_place }
    }

    /// The bundle without what has turned out to be hopeless, if it still opens as much.
    fn still_there(&self, bundle: Bundle) -> Option<Bundle> {
        if bundle.items.iter().all(|&item| self.prices[item as usize] != CLOSED) {
            return Some(bundle);
        }
        let items = bundle.items.into_iter().filter(|&item| self.prices[item as usize] != CLOSED).collect();
        self.field().rated(items).filter(|rest| rest.opens_m >= bundle.opens_m)
    }

    fn prices_with(&self, permits: &Permits) -> Vec<u32> {
        let mut prices = self.joints.prices(self.roads, permits);
        for &item in &self.closed {
            let price = &mut prices[item as usize];
            *price = if *price == OPEN { OPEN } else { CLOSED };
        }
        prices
    }

    fn choose(&mut self, opened: Opened) {
        self.permits = opened.permits.clone();
        self.prices = self.prices_with(&self.permits);
        self.component = Component::of(&self.joints, &self.prices, self.anchor);
        self.opener.choose(opened);
    }

    /// Number of places among what nothing opens.
    fn hopeless_places(&self) -> usize {
        let mut places: Vec<u32> = self.closed.iter().map(|&item| self.joints.place(item)).collect();
        places.sort_unstable();
        places.dedup();
        places.len()
    }
}
