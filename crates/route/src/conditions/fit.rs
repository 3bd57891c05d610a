//! Finds what has to hold on one way, so that the whole way is certified.
//!
//! A way is fitted section by section (`sections`). Each edge and turn that is not safe by itself gets what it needs. Then the section is
//! certified, and where it fails more is supposed. Two turns on too short a road between them become one passage. At last the conditions
//! that the section does not need are taken back. The whole way is certified with what all sections need.

use std::ops::Range;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::failing::{Failing, failing};
use super::joint;
use super::parts::TurnKey;
use super::sections::{Section, sections};
use super::suppositions::Suppositions;
use crate::assemble::{PartKind, Way};
use crate::drive::Drive;
use crate::driver::Driver;
use crate::graph::Access;
use crate::network::{self, Network};
use crate::obstacles::Refutation;
use crate::pieces::Choices;
use crate::roads::Roads;
use crate::stop::{Stop, Stopped};
use crate::turning::MadeTurns;
use crate::whole::{Certified, Looked, Whole};

/// How many paths of a turn are tried beside the best one.
const MORE_PATHS: usize = 2;
/// How often a way is tried, each time with more supposed where it failed.
const ROUNDS: usize = 12;
/// A leg between two turns that is as much longer than the vehicle parts a way, metres.
const APART_M: f64 = 80.0;

/// Fits ways, and keeps what it has found out about edges and turns. Its answers do not depend on earlier ones.
pub(crate) struct Fitter {
    pub(super) roads: Arc<Roads>,
    pub(super) driver: Arc<Driver>,
    base: Arc<network::Site>,
    pub(super) stroke_of: Arc<[u32]>,
    /// The widths that edges need.
    pub(super) needs_m: FxHashMap<u32, Option<f64>>,
    /// What turns need; `None` if nothing does.
    pub(super) turns: FxHashMap<TurnKey, Option<Suppositions>>,
    /// Sections with what their edges and turns need by themselves, and with what the whole section needs.
    supposed: FxHashMap<SectionKey, Result<Fitting, Unfit>>,
    settled: FxHashMap<SectionKey, Result<Fitting, Unfit>>,
    /// What was certified last, and what was supposed there.
    whole: Option<(Whole, Suppositions)>,
}

/// The edges of a section, the arcs of its passages, its ends, and which edges and steps have a price.
type SectionKey = (Vec<u32>, Vec<Range<usize>>, [u64; 2], Vec<bool>);

/// A way that is certified if everything supposed holds.
pub(super) struct Fitted {
    /// The edges. Turns that are driven as one are one passage.
    pub(super) drive: Drive,
    pub(super) certified: Certified,
    pub(super) supposed: Suppositions,
    /// Whether the search with nothing supposed finds the same, once everything is measured exactly as supposed.
    pub(super) suffices: bool,
}

/// The places on a way for which nothing does. None if no single place is at fault.
#[derive(Clone)]
pub(super) struct Unfit(pub(super) Vec<PartKind>);

/// A way while it is fitted.
#[derive(Clone)]
pub(super) struct Fitting {
    pub(super) drive: Drive,
    start: f64,
    end: f64,
    pub(super) supposed: Suppositions,
    /// How often it has failed.
    pub(super) round: usize,
    pub(super) choices: Choices,
}

impl Fitting {
    fn new(base: &Arc<network::Site>, way: &Way<'_>) -> Self {
        Self {
            drive: way.drive.clone(),
            start: way.start,
            end: way.end,
            supposed: Suppositions::new(Arc::clone(base)),
            round: 0,
            choices: Choices::default(),
        }
    }

    fn fitted(self, certified: Certified, suffices: bool) -> Fitted {
        Fitted { drive: self.drive, certified, supposed: self.supposed, suffices }
    }

    /// Takes over the passages, suppositions and paths of a section that begins at the edge `first` of this way.
    fn take_over(&mut self, section: &Self, first: usize) {
        let over = section.drive.over.iter().map(|arcs| arcs.start + first..arcs.end + first);
        self.drive.over.extend(over);
        self.supposed.add(&section.supposed);
        self.choices.extend(&section.choices);
    }
}

impl Fitter {
    pub(super) fn new(roads: &Arc<Roads>, driver: &Arc<Driver>) -> Self {
        let base = Arc::new(roads.network.site.clone());
        Self {
            roads: Arc::clone(roads),
            driver: Arc::clone(driver),
            base,
            stroke_of: roads.network.strokes_of_edges().into(),
            needs_m: FxHashMap::default(),
            turns: FxHashMap::default(),
            supposed: FxHashMap::default(),
            settled: FxHashMap::default(),
            whole: None,
        }
    }

    /// Fits a way. `access` says what has a price.
    pub(super) fn fit(
        &mut self,
        way: &Way<'_>,
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Fitted, Unfit>, Stopped> {
        if !self.base.is_empty()
            && let Some(fitted) = self.as_measured(way, Suppositions::new(Arc::clone(&self.base)), stop)?
        {
            return Ok(Ok(fitted));
        }
        let long_m = self.driver.model.vehicle.length_m + APART_M;
        let sections = sections(&self.roads.network, &self.roads.movements, way, long_m);
        // Where nothing does for a place, nothing needs to be known of other sections.
        let mut unfit = Vec::new();
        for section in &sections {
            unfit.extend(self.suppose(section, access, stop)?.err().into_iter().flat_map(|Unfit(places)| places));
        }
        if !unfit.is_empty() {
            return Ok(Err(Unfit(unfit)));
        }
        let mut whole = Fitting::new(&self.base, way);
        whole.drive.over.clear();
        for section in &sections {
            match self.settle(section, access, stop)? {
                Ok(own) => whole.take_over(&own, section.first),
                Err(unfit) => return Ok(Err(unfit)),
            }
        }
        // Fewer conditions first. The answer is made from nothing that was made before.
        let mut level = whole.clone();
        level.supposed.level_roads(&self.roads.network, &whole.drive.edges);
        // Where less does on the whole, each edge and turn may also get what it needs by itself.
        let mut generous = whole.supposed.clone();
        for section in &sections {
            if let Ok(own) = self.suppose(section, access, stop)? {
                generous.add(&own.supposed);
            }
        }
        for supposed in [level.supposed.clone(), whole.supposed.clone(), generous] {
            if let Some(fitted) = self.as_measured(way, supposed, stop)? {
                return Ok(Ok(fitted));
            }
        }
        // No search with nothing supposed is known to find these once they are measured.
        for whole in [level, whole.clone()] {
            if let Some(certified) = self.fresh(&whole, stop)? {
                return Ok(Ok(whole.fitted(certified, false)));
            }
        }
        if let Some(at) = self.suppose_until_safe(&mut whole, stop)? {
            return Ok(Err(Unfit(joint::parted(way.drive, at))));
        }
        Ok(match self.fresh(&whole, stop)? {
            Some(certified) => Ok(whole.fitted(certified, false)),
            // No single place is at fault.
            None => Err(Unfit(Vec::new())),
        })
    }

    /// The way under what is supposed, if it is safe. What is supposed counts as if it were measured: when it is, the same search with nothing
    /// supposed finds the same. Edges and turns need not be safe by themselves.
    fn as_measured(&mut self, way: &Way<'_>, supposed: Suppositions, stop: &Stop) -> Result<Option<Fitted>, Stopped> {
        let mut fitting = Fitting { supposed, ..Fitting::new(&self.base, way) };
        for round in 0..ROUNDS {
            fitting.round = round;
            let places = match self.look(&mut fitting, stop)? {
                Ok(looked) if looked.safe() => {
                    let certified = self.fresh(&fitting, stop)?;
                    return Ok(certified.map(|certified| fitting.fitted(certified, true)));
                }
                Ok(looked) => failing(&looked).into_iter().map(|place| place.at).collect(),
                Err(Refutation { at, .. }) => vec![at],
            };
            let mut more = false;
            for at in places.into_iter().filter(|at| matches!(at, PartKind::Turn { .. })) {
                let Fitting { drive, choices, .. } = &mut fitting;
                let another = self.whole.as_mut().is_some_and(|(whole, _)| whole.another(drive, at, choices));
                more |= another || self.merge(&mut fitting, at, stop)?;
            }
            if !more {
                break;
            }
        }
        Ok(None)
    }

    /// Supposes for each edge and turn of a section what it needs by itself.
    fn suppose(&mut self, section: &Section, access: &Access, stop: &Stop) -> Result<Result<Fitting, Unfit>, Stopped> {
        let key = self.section_key(section, access);
        if let Some(known) = self.supposed.get(&key) {
            return Ok(known.clone());
        }
        let mut fitting = Fitting::new(&self.base, &section.way());
        let mut unfit = Vec::new();
        // Turns that are not safe by themselves may pass as parts of the whole.
        let roomy = fitting.drive.edges.iter().all(|&edge| access.edges.get(edge as usize) == Some(&0));
        if !(roomy && self.look(&mut fitting, stop)?.is_ok_and(|looked| looked.safe())) {
            unfit.extend(self.suppose_widths(&mut fitting, access, stop)?);
            unfit.extend(self.suppose_turns(&mut fitting, access, stop)?);
        }
        let unfit: Vec<PartKind> = unfit.into_iter().flat_map(|at| joint::parted(&section.drive, at)).collect();
        let supposed = if unfit.is_empty() { Ok(fitting) } else { Err(Unfit(unfit)) };
        self.supposed.insert(key, supposed.clone());
        Ok(supposed)
    }

    /// Supposes the least that makes a section safe.
    fn settle(&mut self, section: &Section, access: &Access, stop: &Stop) -> Result<Result<Fitting, Unfit>, Stopped> {
        let key = self.section_key(section, access);
        if let Some(known) = self.settled.get(&key) {
            return Ok(known.clone());
        }
        let mut settled = self.suppose(section, access, stop)?;
        if let Ok(fitting) = &mut settled {
            match self.suppose_until_safe(fitting, stop)? {
                Some(at) => settled = Err(Unfit(joint::parted(&section.drive, at))),
                None => self.lessen(fitting, access, stop)?,
            }
        }
        self.settled.insert(key, settled.clone());
        Ok(settled)
    }

    /// Everything that decides what a section needs.
    fn section_key(&self, section: &Section, access: &Access) -> SectionKey {
        let Section { drive, start, end, .. } = section;
        let edges = drive.edges.iter().map(|&edge| access.edges.get(edge as usize).is_none_or(|&price| price > 0));
        let priced = edges.chain(drive.joins().map(|join| self.price(access, join) > 0)).collect();
        (drive.edges.clone(), drive.over.clone(), [start.to_bits(), end.to_bits()], priced)
    }

    /// Supposes more where a way fails, until it is safe. Returns the place where nothing more does.
    fn suppose_until_safe(&mut self, fitting: &mut Fitting, stop: &Stop) -> Result<Option<PartKind>, Stopped> {
        let mut last = None;
        for round in 0..ROUNDS {
            fitting.round = round;
            let goes_on = match self.look(fitting, stop)? {
                Err(Refutation { at, .. }) => {
                    last = Some(at);
                    self.merge(fitting, at, stop)?
                }
                Ok(looked) if looked.safe() => return Ok(None),
                Ok(looked) => {
                    let places = failing(&looked);
                    last = places.first().map(|place| place.at);
                    let mut more = false;
                    for place in places {
                        more |= self.help(fitting, &place, stop)?;
                    }
                    more
                }
            };
            if !goes_on {
                break;
            }
        }
        Ok(last.or_else(|| fitting.drive.edges.first().map(|&edge| PartKind::Edge(edge))))
    }

    /// Supposes more at a place where a way fails, or drives another path there. Returns whether there is more to try.
    fn help(&mut self, fitting: &mut Fitting, place: &Failing, stop: &Stop) -> Result<bool, Stopped> {
        let PartKind::Turn { from, to } = place.at else { return Ok(self.more_room(fitting, place)) };
        let another = |fitter: &mut Self, fitting: &mut Fitting| {
            let Fitting { drive, choices, .. } = fitting;
            fitter.whole.as_mut().is_some_and(|(whole, _)| whole.another(drive, place.at, choices))
        };
        // More room does not unfold a vehicle. Another path may, or one path over two turns.
        if place.folds {
            return Ok(another(self, fitting)
                || self.merge(fitting, place.at, stop)?
                || self.more_room(fitting, place));
        }
        if self.more_room(fitting, place) {
            // The turn's paths are others now.
            fitting.choices.remove(&(from, to));
            return Ok(true);
        }
        Ok(another(self, fitting) || self.merge(fitting, place.at, stop)?)
    }

    /// Joins and certifies the way under what is supposed.
    pub(super) fn look(&mut self, fitting: &mut Fitting, stop: &Stop) -> Result<Result<Looked, Refutation>, Stopped> {
        fitting.supposed.apply(network_of(&mut self.roads));
        let going = match self.whole.take() {
            None => self.new_whole(),
            Some((mut whole, before)) => {
                let edges = fitting.supposed.differing_edges(&before);
                let nodes = fitting.supposed.differing_nodes(&before, &self.roads.network);
                whole.go_on_with(&self.roads, &edges, &nodes);
                whole
            }
        };
        let (whole, _) = self.whole.insert((going, fitting.supposed.clone()));
        let Fitting { drive, start, end, choices, .. } = fitting;
        whole.look(&Way { drive, start: *start, end: *end }, choices, stop)
    }

    /// The way under what is supposed, if it is safe when everything is made anew.
    fn fresh(&mut self, fitting: &Fitting, stop: &Stop) -> Result<Option<Certified>, Stopped> {
        fitting.supposed.apply(network_of(&mut self.roads));
        let mut fresh = self.new_whole();
        let way = Way { drive: &fitting.drive, start: fitting.start, end: fitting.end };
        match fresh.look(&way, &mut fitting.choices.clone(), stop)? {
            Ok(looked) => fresh.prove(looked.path, stop),
            Err(_) => Ok(None),
        }
    }

    /// Certifies ways on the roads as they are now.
    fn new_whole(&self) -> Whole {
        let driver = Arc::clone(&self.driver);
        let turns = Box::new(MadeTurns { driver, more: MORE_PATHS, unsafe_too: true });
        Whole::new(&self.roads, Arc::clone(&self.driver), turns)
    }
}

/// The network of roads that nobody else holds. If somebody does, it is copied first.
pub(super) fn network_of(roads: &mut Arc<Roads>) -> &mut Network {
    &mut Arc::make_mut(roads).network
}
