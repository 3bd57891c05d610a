//! A planner's answer beside a reference vehicle: `relative_m` and `as_reference` of routes and obstacles.
//!
//! A route is certified for the reference on the corridor of the route itself, which was planned for the vehicle. Obstacles are
//! compared by their stored certificates. The answer stays as it is: routes are found without the reference.

use rustc_hash::FxHashMap;
use serde_json::{Value, json};

use super::assemble::{PartKind, RoutePath};
use super::driver::Driver;
use super::plan::Answer;
use super::route::Route;
use crate::network::EdgeNo;
use crate::rows::{CertificateStanding, Relative};
use crate::stet::{self, Model, SpanResult};
use crate::stop::{Stop, Stopped};
use crate::verdict::{UnknownReason, Verdict};

/// The stored certificates of a vehicle's edges and turns.
#[derive(Debug, Default)]
pub struct Standings {
    /// One for each edge.
    pub edges: Vec<CertificateStanding>,
    /// By the first and last edge of a turn or passage.
    pub turns: FxHashMap<(EdgeNo, EdgeNo), CertificateStanding>,
}

impl Standings {
    fn at(&self, at: PartKind) -> Option<CertificateStanding> {
        match at {
            PartKind::Edge(edge) => self.edges.get(edge.index()).copied(),
            PartKind::Turn { from, to } => self.turns.get(&(from, to)).copied(),
        }
    }

    /// What the law or missing facts say against a way: the first such verdict on its parts.
    fn against(&self, path: &RoutePath) -> Option<Verdict> {
        let verdicts = path.parts.iter().filter_map(|part| Some(self.at(part.kind)?.verdict()));
        let mut against = verdicts.filter(|verdict| matches!(verdict, Verdict::Forbidden(_) | Verdict::Unknown(_)));
        against.next()
    }
}

/// A reference vehicle beside the vehicle of a planner.
#[derive(Debug)]
pub struct Peer {
    /// The reference.
    pub model: Model,
    /// Whether it is the planner's own vehicle.
    pub same: bool,
    /// The certificates of the planner's vehicle.
    pub own: Standings,
    /// The certificates of the reference, made with the same settings.
    pub other: Standings,
}

/// What a comparison takes from a certificate of a route. `verdict` is the verdict with law and map.
fn standing(verdict: Verdict, result: &SpanResult) -> CertificateStanding {
    CertificateStanding::computed(verdict, result.rsc_m, result.hinge_margin_rad, result.shrink)
}

impl Peer {
    /// Compares the routes and obstacles of an answer. `driver` is that of the planner.
    ///
    /// # Errors
    /// `stop` was told.
    pub fn beside(&self, driver: &Driver, answer: &Answer, stop: &Stop) -> Result<Comparison, Stopped> {
        let routes = answer.routes.iter().map(|route| self.route(driver, route, stop)).collect::<Result<_, _>>()?;
        let obstacles = answer.obstacles.iter().flatten().map(|obstacle| self.place(obstacle.at)).collect();
        Ok(Comparison { relative_to: self.model.vehicle.id.clone(), routes, obstacles })
    }

    fn route(&self, driver: &Driver, route: &Route, stop: &Stop) -> Result<Relative, Stopped> {
        let own = standing(route.certificate.result.verdict(), &route.certificate.result);
        if self.same {
            return Ok(Relative::to_itself(own));
        }
        let options = &driver.permits.settings.stet;
        let certificate = stet::certify(&route.path.corridor, &self.model, options, stop)?;
        let other =
            certificate.map_or(CertificateStanding::bare(Verdict::Unknown(UnknownReason::Geometry)), |certificate| {
                let verdict = self.other.against(&route.path).unwrap_or_else(|| certificate.result.verdict());
                standing(verdict, &certificate.result)
            });
        let other = if route.path.corridor.areas.is_empty() { other } else { other.in_area() };
        Ok(Relative::between(own, other))
    }

    fn place(&self, at: PartKind) -> Relative {
        match (self.own.at(at), self.other.at(at)) {
            (Some(own), _) if self.same => Relative::to_itself(own),
            (Some(own), Some(other)) => Relative::between(own, other),
            _ => Relative::default(),
        }
    }
}

/// The comparison of an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Id of the reference.
    pub relative_to: String,
    /// One for each route of the answer.
    pub routes: Vec<Relative>,
    /// One for each obstacle of the answer.
    pub obstacles: Vec<Relative>,
}

impl Comparison {
    /// Adds the comparison to the answer's [`super::json`].
    pub fn add_to_json(&self, answer: &mut Value) {
        answer["relative_to"] = json!(self.relative_to);
        let rows = |answer: &mut Value, name: &str, all: &[Relative]| {
            let values = answer.get_mut(name).and_then(Value::as_array_mut).into_iter().flatten();
            values.zip(all).for_each(|(value, relative)| add(value, *relative));
        };
        rows(answer, "routes", &self.routes);
        rows(answer, "obstacles", &self.obstacles);
    }

    /// Adds the comparison to the answer's [`super::geojson`]: to whole routes and to obstacles, and the reference as a foreign
    /// member (RFC 7946, section 6.1).
    pub fn add_to_geojson(&self, answer: &mut Value) {
        answer["relative_to"] = json!(self.relative_to);
        let features = answer.get_mut("features").and_then(Value::as_array_mut).into_iter().flatten();
        let all: Vec<&mut Value> = features.collect();
        // A part of a route is a line, too, but not of this kind; obstacles are the only points.
        let (mut routes, mut obstacles) = (self.routes.iter(), self.obstacles.iter());
        for feature in all {
            let relative = match (&feature["properties"]["kind"], &feature["geometry"]["type"]) {
                (kind, _) if kind == "route" => routes.next(),
                (_, shape) if shape == "Point" => obstacles.next(),
                _ => None,
            };
            if let Some(relative) = relative {
                add(&mut feature["properties"], *relative);
            }
        }
    }
}

fn add(value: &mut Value, relative: Relative) {
    for ((name, _), cell) in Relative::COLUMNS.iter().zip(relative.cells()) {
        value[*name] = cell.into();
    }
}
