//! Which edges and movements a vehicle may use, with verdict and RSC: what a search starts from.

use super::graph::{Access, BARRED};
use crate::network::{MovementKind, Movements};
use crate::settings::Settings;
use crate::verdict::{UnknownReason, Verdict};

/// What is said of an edge or a movement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Permit {
    /// With its reason.
    pub verdict: Verdict,
    /// Metres, where it was computed.
    pub rsc_m: Option<f64>,
}

impl Permit {
    /// Nothing is known of it.
    pub const UNKNOWN: Self = Self { verdict: Verdict::Unknown(UnknownReason::Geometry), rsc_m: None };
    /// Covered by other certificates.
    pub const COVERED: Self = Self { verdict: Verdict::Safe, rsc_m: None };

    /// Whether a search may use it: one meaning for routes and exports.
    #[must_use]
    pub fn usable(&self) -> bool {
        self.verdict == Verdict::Safe
    }
}

/// All permits of one vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Permits {
    /// How they were made: a route over them is certified in the same way.
    pub settings: Settings,
    /// One an edge.
    pub edges: Vec<Permit>,
    /// One a movement, in the order of [`Movements::all`]; of those straight on nothing is asked.
    pub movements: Vec<Permit>,
    /// One a passage of a roundabout, in the order of [`Movements::passages`].
    pub passages: Vec<Permit>,
}

impl Permits {
    /// With `turn` for every movement that is a turn and for every passage; straight on is covered by the edges.
    pub fn new(
        settings: Settings,
        edges: Vec<Permit>,
        movements: &Movements,
        turn: impl Fn(u32, u32) -> Permit,
    ) -> Self {
        let permit = |m: &crate::network::Movement| match m.kind {
            MovementKind::StraightOn => Permit::COVERED,
            MovementKind::Turn => turn(m.from, m.to),
            MovementKind::UTurn => Permit::UNKNOWN,
        };
        let passages = movements.passages().iter().map(|passage| turn(passage.from, passage.to)).collect();
        Self { settings, edges, movements: movements.all().iter().map(permit).collect(), passages }
    }

    /// What is safe may be used, and no restriction may be broken; nobody turns back on the road.
    #[must_use]
    pub fn access(&self, movements: &Movements) -> Access {
        self.access_at(movements, |_| BARRED)
    }

    /// The same, but what is not safe may be used at a price.
    #[must_use]
    pub fn access_at(&self, movements: &Movements, price: impl Fn(&Permit) -> u64) -> Access {
        let cost = |permit: &Permit| if permit.usable() { 0 } else { price(permit) };
        let movement = |(m, permit): (&crate::network::Movement, &Permit)| {
            if m.forbidden.is_some() || m.kind == MovementKind::UTurn { BARRED } else { cost(permit) }
        };
        let passage = |(p, permit): (&crate::network::Passage, &Permit)| {
            if p.forbidden.is_some() { BARRED } else { cost(permit) }
        };
        Access {
            edges: self.edges.iter().map(cost).collect(),
            movements: movements.all().iter().zip(&self.movements).map(movement).collect(),
            passages: movements.passages().iter().zip(&self.passages).map(passage).collect(),
        }
    }

    /// Whether an edge may be used.
    #[must_use]
    pub fn edge(&self, edge: u32) -> bool {
        self.edges.get(edge as usize).is_some_and(Permit::usable)
    }
}
