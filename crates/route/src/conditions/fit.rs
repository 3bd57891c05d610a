//! Finds what has to hold on one way, so that the whole way is certified.
//!
//! A way is fitted section by section (`sections`). Each edge and turn that is not safe by itself gets what it needs. Then the section is
//! certified, and where it fails more is supposed. Two turns on too short a road between them become one passage. At last the conditions
//! that the section does not need are taken back. The whole way is certified with what all sections need.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::failing::failing;
use super::fitter::{Fitted, Fitter, Fitting, SectionKey, Unfit, network_of};
use super::joint;
use super::mend::Parted;
use super::sections::{Section, sections};
use super::stretch::ROUNDS;
use super::suppositions::Suppositions;
use crate::assemble::{DrivenWay, PartKind};
use crate::driver::Driver;
use crate::graph::Access;
use crate::obstacles::Refutation;
use crate::pieces::Choices;
use crate::rungs::Rungs;
use crate::stop::{Stop, Stopped};
use crate::turn_ends::TurnEnds;
use crate::whole::{CertifiedWay, MOST_RAISED};

/// A leg between two turns that is as much longer than the vehicle parts a way, metres.
const APART_M: f64 = 80.0;
/// How often what fails is raised at first, while roads beside corners begin with their lanes.
const FIRST_RAISED: usize = 4;

impl Fitter {
    /// Fits a way. `access` says what has a price.
    pub(crate) fn fit(
        &mut self,
        way: &DrivenWay<'_>,
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Fitted, Unfit>, Stopped> {
        if !self.base.is_empty()
            && let Some(fitted) = self.as_measured(way, &Suppositions::new(Arc::clone(&self.base)), stop)?
        {
            return Ok(Ok(fitted));
        }
        let sections = self.sections(way);
        // Where nothing does for a place, nothing needs to be known of other sections. Least work comes first.
        let own = match self.supposed_for(&sections, access, stop)? {
            Ok(own) => own,
            Err(unfit) => return Ok(Err(unfit)),
        };
        let safe = match self.safe_for(&sections, &own, access, stop)? {
            Ok(safe) => safe,
            Err(unfit) => return Ok(Err(unfit)),
        };
        let least = match self.least_for(&sections, &safe, access, stop)? {
            Ok(least) => least,
            Err(unfit) => return Ok(Err(unfit)),
        };
        let mut whole = self.joined(way, &sections, &least);
        whole.supposed.level_roads(&self.roads.network, &whole.drive.edges);
        let more: Vec<Suppositions> =
            own.iter().zip(&safe).map(|(own, safe)| own.supposed.with(&safe.supposed)).collect();
        let parted = Parted { way, sections: &sections, more: &more };
        match self.mended(&parted, whole.supposed.clone(), stop)? {
            Ok(fitted) => return Ok(Ok(fitted)),
            Err(supposed) => whole.supposed.add(&supposed),
        }
        // No search with nothing supposed is known to find these once they are measured.
        if let Some(at) = self.suppose_until_safe(&mut whole, stop)? {
            return Ok(Err(Unfit(joint::parted(way.drive, at))));
        }
        Ok(match self.fresh(&whole, stop)? {
            Some(certified) => Ok(Fitted { suffices: false, ..whole.fitted(certified) }),
            // No single place is at fault.
            None => Err(Unfit(Vec::new())),
        })
    }

    fn sections(&self, way: &DrivenWay<'_>) -> Vec<Section> {
        let long_m = self.driver.model.vehicle.length_m + APART_M;
        sections(&self.roads.network, &self.roads.movements, way, long_m)
    }

    /// A way with the passages, suppositions and paths of its sections.
    pub(super) fn joined(&self, way: &DrivenWay<'_>, sections: &[Section], own: &[Fitting]) -> Fitting {
        let mut whole = Fitting::new(&self.base, way);
        whole.drive.over.clear();
        sections.iter().zip(own).for_each(|(section, own)| whole.take_over(own, section.first));
        whole
    }

    /// What the edges and turns of each section need by themselves.
    fn supposed_for(
        &mut self,
        sections: &[Section],
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Vec<Fitting>, Unfit>, Stopped> {
        let work = |fitter: &mut Self, at: usize| fitter.suppose(&sections[at], access, stop);
        self.known_or(|fitter| &mut fitter.supposed, sections, access, work)
    }

    /// For each section enough to be safe.
    fn safe_for(
        &mut self,
        sections: &[Section],
        own: &[Fitting],
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Vec<Fitting>, Unfit>, Stopped> {
        let work = |fitter: &mut Self, at: usize| {
            let mut fitting = own[at].clone();
            let unfit = fitter.suppose_until_safe(&mut fitting, stop)?;
            Ok(unfit.map_or(Ok(fitting), |at_fault| Err(Unfit(joint::parted(&sections[at].drive, at_fault)))))
        };
        self.known_or(|fitter| &mut fitter.safe, sections, access, work)
    }

    /// The least that makes each section safe.
    fn least_for(
        &mut self,
        sections: &[Section],
        safe: &[Fitting],
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Vec<Fitting>, Unfit>, Stopped> {
        let work = |fitter: &mut Self, at: usize| {
            let mut fitting = safe[at].clone();
            fitter.lessen(&mut fitting, access, stop)?;
            Ok(Ok(fitting))
        };
        self.known_or(|fitter| &mut fitter.settled, sections, access, work)
    }

    /// What is known of sections, or else what `work` says of them. All places at fault, if a section does not fit.
    fn known_or(
        &mut self,
        known: impl Fn(&mut Self) -> &mut FxHashMap<SectionKey, Result<Fitting, Unfit>>,
        sections: &[Section],
        access: &Access,
        work: impl Fn(&mut Self, usize) -> Result<Result<Fitting, Unfit>, Stopped> + Sync,
    ) -> Result<Result<Vec<Fitting>, Unfit>, Stopped> {
        let keys: Vec<SectionKey> = sections.iter().map(|section| self.section_key(section, access)).collect();
        let new: Vec<usize> = (0..keys.len()).filter(|&at| !known(self).contains_key(&keys[at])).collect();
        let made = self.together(new.len(), |fitter, i| work(fitter, new[i]))?;
        known(self).extend(new.iter().map(|&at| keys[at].clone()).zip(made));
        let (mut fitted, mut unfit) = (Vec::new(), Vec::new());
        for key in &keys {
            match known(self).get(key).cloned() {
                Some(Ok(fitting)) => fitted.push(fitting),
                Some(Err(Unfit(places))) => unfit.extend(places),
                None => {}
            }
        }
        Ok(if fitted.len() == keys.len() { Ok(fitted) } else { Err(Unfit(unfit)) })
    }

    /// Everything that decides what a section needs.
    fn section_key(&self, section: &Section, access: &Access) -> SectionKey {
        let Section { drive, start, end, .. } = section;
        let edges = drive.edges.iter().map(|&edge| access.edges.get(edge.index()).is_none_or(|&price| price > 0));
        let priced = edges.chain(drive.joins().map(|join| self.price(access, join) > 0)).collect();
        (drive.edges.clone(), drive.over.clone(), [start.to_bits(), end.to_bits()], priced)
    }

    /// The way under what is supposed, if it is safe. What is supposed counts as if it were measured: when it is, the same search with nothing
    /// supposed finds the same. Edges and turns need not be safe by themselves.
    fn as_measured(
        &mut self,
        way: &DrivenWay<'_>,
        supposed: &Suppositions,
        stop: &Stop,
    ) -> Result<Option<Fitted>, Stopped> {
        let sections = self.sections(way);
        // A certificate over the whole takes longest. Where a section fails it is not tried.
        let tried = self.each_as_measured(&sections, supposed, stop)?;
        let Some(own) = tried.into_iter().collect::<Option<Vec<Fitting>>>() else { return Ok(None) };
        let mut fitting = self.joined(way, &sections, &own);
        fitting.supposed.add(supposed);
        if let Some(certified) = self.fresh(&fitting, stop)? {
            return Ok(Some(fitting.fitted(certified)));
        }
        let certified = if self.safe_as_measured(&mut fitting, stop)? { self.fresh(&fitting, stop)? } else { None };
        Ok(certified.map(|certified| fitting.fitted(certified)))
    }

    /// By section: what is safe under what is supposed, as if it were measured. `None` where nothing is.
    pub(super) fn each_as_measured(
        &mut self,
        sections: &[Section],
        supposed: &Suppositions,
        stop: &Stop,
    ) -> Result<Vec<Option<Fitting>>, Stopped> {
        self.together(sections.len(), |fitter, at| {
            let mut fitting = Fitting { supposed: supposed.clone(), ..Fitting::new(&fitter.base, &sections[at].way()) };
            Ok(fitter.safe_as_measured(&mut fitting, stop)?.then_some(fitting))
        })
    }

    /// Looks for paths along which a stretch is safe under what is supposed: other paths of turns, or one path over two turns.
    fn safe_as_measured(&mut self, fitting: &mut Fitting, stop: &Stop) -> Result<bool, Stopped> {
        for round in 0..ROUNDS {
            fitting.round = round;
            let places = match self.look(fitting, stop)? {
                Ok(looked) if looked.safe() => return Ok(true),
                Ok(looked) => failing(&looked).into_iter().map(|place| place.at).collect(),
                Err(Refutation { at, .. }) => vec![at],
            };
            let mut more = false;
            for at in places.into_iter().filter(|at| matches!(at, PartKind::Turn { .. })) {
                let Fitting { drive, choices, .. } = &mut *fitting;
                let another = self.whole.as_mut().is_some_and(|(whole, _)| whole.another(drive, at, choices));
                more |= another || self.merge(fitting, at, stop)?;
            }
            if !more {
                break;
            }
        }
        Ok(false)
    }

    /// The way under what is supposed, if it is safe when everything is made anew: on strips that are as narrow as they can be, if the vehicle
    /// climbs, or else on the widest one.
    pub(super) fn fresh(&mut self, fitting: &Fitting, stop: &Stop) -> Result<Option<CertifiedWay>, Stopped> {
        fitting.supposed.apply(network_of(&mut self.roads));
        let way = DrivenWay { drive: &fitting.drive, start: fitting.start, end: fitting.end };
        if let Some(climbing) = &self.climbing {
            let climbed = self.climbed(&way, &fitting.supposed, &fitting.choices, climbing, stop)?;
            if climbed.is_some() {
                return Ok(climbed);
            }
        }
        self.new_whole().prove(&way, &fitting.choices, stop)
    }

    /// The way on strips that are as narrow as they can be. `None` if it is not safe on these.
    fn climbed(
        &self,
        way: &DrivenWay<'_>,
        supposed: &Suppositions,
        choices: &Choices,
        climbing: &Arc<Driver>,
        stop: &Stop,
    ) -> Result<Option<CertifiedWay>, Stopped> {
        let mut whole = Self::whole_of(&self.roads, climbing);
        // Along all of a long road the widest strip is more than its corner needs. Where that does not do soon, it seldom does at all.
        for (roads, most_raised) in [(WidestRoads::Wider, FIRST_RAISED), (WidestRoads::OfSections, MOST_RAISED)] {
            let (rungs, choices) = self.rungs_at_conditions(way, supposed, choices.clone(), climbing, roads);
            whole.choose(&choices);
            if let Ok(certified) = whole.climb_from(rungs, most_raised, way, stop)? {
                return Ok(Some(certified));
            }
        }
        Ok(None)
    }

    /// The strips with which a way under conditions begins to climb, and the paths that its turns keep. Turns of sections with a condition have
    /// the widest strip and their paths. All other sections begin with the strips of the climbing vehicle's permits.
    fn rungs_at_conditions(
        &self,
        way: &DrivenWay<'_>,
        supposed: &Suppositions,
        mut choices: Choices,
        climbing: &Driver,
        roads: WidestRoads,
    ) -> (Rungs, Choices) {
        let network = &self.roads.network;
        let mut rungs = climbing.permits.rungs.clone();
        for section in self.sections(way) {
            let drive = &section.drive;
            if supposed.edges_of(network, &drive.edges).next().is_none() {
                for join in drive.joins() {
                    choices.remove(&TurnEnds { from: join.from, to: join.to });
                }
                continue;
            }
            let roads = match roads {
                WidestRoads::Wider => supposed.wider_edges(&drive.edges).collect(),
                WidestRoads::OfSections => drive.edges.clone(),
            };
            rungs.widen_wholly(network, &roads);
            rungs.raise_turns(drive);
        }
        (rungs, choices)
    }
}

/// The roads that begin with the widest strip in a section with a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WidestRoads {
    /// Those whose width is a condition.
    Wider,
    /// All.
    OfSections,
}
