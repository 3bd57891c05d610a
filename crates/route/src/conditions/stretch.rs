//! What a stretch of a way needs: each edge and turn by itself, then the stretch as a whole until it is safe.

use std::sync::Arc;

use super::failing::{Failing, failing};
use super::fitter::{Fitter, Fitting, Unfit, network_of};
use super::joint;
use super::sections::Section;
use crate::assemble::{DrivenWay, PartKind};
use crate::driver::Driver;
use crate::graph::Access;
use crate::obstacles::Refutation;
use crate::roads::Roads;
use crate::stop::{Stop, Stopped};
use crate::turn_ends::TurnEnds;
use crate::turning::MadeTurns;
use crate::whole::{Looked, Whole};

/// How many paths of a turn are tried beside the best one.
const MORE_PATHS: usize = 2;
/// How often a stretch is tried, each time with more supposed where it failed.
pub(super) const ROUNDS: usize = 12;

impl Fitter {
    /// Supposes for each edge and turn of a section what it needs by itself.
    pub(super) fn suppose(
        &mut self,
        section: &Section,
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Fitting, Unfit>, Stopped> {
        let mut fitting = Fitting::new(&self.base, &section.way());
        let mut unfit = Vec::new();
        // Turns that are not safe by themselves may pass as parts of the whole.
        let roomy = fitting.drive.edges.iter().all(|&edge| access.edges.get(edge.index()) == Some(&0));
        if !(roomy && self.look(&mut fitting, stop)?.is_ok_and(|looked| looked.safe())) {
            unfit.extend(self.suppose_widths(&mut fitting, access, stop)?);
            unfit.extend(self.suppose_turns(&mut fitting, access, stop)?);
        }
        let unfit: Vec<PartKind> = unfit.into_iter().flat_map(|at| joint::parted(&section.drive, at)).collect();
        Ok(if unfit.is_empty() { Ok(fitting) } else { Err(Unfit(unfit)) })
    }

    /// Supposes more where a way fails, until it is safe. Returns the place where nothing more does.
    pub(super) fn suppose_until_safe(
        &mut self,
        fitting: &mut Fitting,
        stop: &Stop,
    ) -> Result<Option<PartKind>, Stopped> {
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
    pub(super) fn help(&mut self, fitting: &mut Fitting, place: &Failing, stop: &Stop) -> Result<bool, Stopped> {
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
            fitting.choices.remove(&TurnEnds { from, to });
            return Ok(true);
        }
        Ok(another(self, fitting) || self.merge(fitting, place.at, stop)?)
    }

    /// Joins and certifies the way under what is supposed.
    pub(super) fn look(&mut self, fitting: &mut Fitting, stop: &Stop) -> Result<Result<Looked, Refutation>, Stopped> {
        let mut before = self.whole.take();
        // Otherwise the network would be copied.
        before.iter_mut().for_each(|(whole, _)| whole.let_go_of_roads());
        fitting.supposed.apply(network_of(&mut self.roads));
        let going = match before {
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
        whole.look(&DrivenWay { drive, start: *start, end: *end }, choices, stop)
    }

    /// Certifies ways on the roads as they are now.
    pub(super) fn new_whole(&self) -> Whole {
        Self::whole_of(&self.roads, &self.driver)
    }

    pub(super) fn whole_of(roads: &Arc<Roads>, driver: &Arc<Driver>) -> Whole {
        let turns = Box::new(MadeTurns { driver: Arc::clone(driver), more: MORE_PATHS, unsafe_too: true });
        Whole::new(roads, Arc::clone(driver), turns)
    }
}
