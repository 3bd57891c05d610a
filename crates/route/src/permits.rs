//! The edges and movements that a vehicle may use, with verdict and RSC. A search starts from them.

use super::graph::{Access, BARRED};
use super::rungs::Rungs;
use crate::network::{EdgeNo, MovementKind, Movements, Network};
use crate::rows::CertificateRow;
use crate::settings::Settings;
use crate::vehicle::Vehicle;
use crate::verdict::{UnknownReason, Verdict};

/// The verdict on an edge or a movement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Permit {
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// The RSC, metres, if it was computed.
    pub rsc_m: Option<f64>,
}

impl Permit {
    /// The permit of what nothing is known about.
    pub const UNKNOWN: Self = Self { verdict: Verdict::Unknown(UnknownReason::Geometry), rsc_m: None };
    /// The permit of what other certificates cover.
    pub const COVERED: Self = Self { verdict: Verdict::Safe, rsc_m: None };

    /// The permit that a stored certificate gives.
    #[must_use]
    pub fn of(certificate: &CertificateRow) -> Self {
        Self { verdict: certificate.verdict, rsc_m: certificate.rsc_m }
    }

    /// Whether a search may use it.
    #[must_use]
    pub fn usable(&self) -> bool {
        self.verdict == Verdict::Safe
    }
}

/// All permits of one vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Permits {
    /// The settings of the certificates. A route over these permits is certified with the same settings.
    pub settings: Settings,
    /// One permit for each edge.
    pub edges: Vec<Permit>,
    /// One permit for each movement, in the order of [`Movements::all`]. Movements straight on are covered by their edges.
    pub movements: Vec<Permit>,
    /// One permit for each passage, in the order of [`Movements::passages`].
    pub passages: Vec<Permit>,
    /// The strip that belongs to each permit.
    pub rungs: Rungs,
}

impl Permits {
    /// Makes permits from those of edges. `turn` gives the permit of each movement that is a turn and of each passage.
    pub fn new(
        settings: Settings,
        edges: Vec<Permit>,
        movements: &Movements,
        turn: impl Fn(EdgeNo, EdgeNo) -> Permit,
    ) -> Self {
        let permit = |m: &crate::network::Movement| match m.kind {
            MovementKind::StraightOn => Permit::COVERED,
            MovementKind::Turn => turn(m.from, m.to),
            MovementKind::UTurn => Permit::UNKNOWN,
        };
        let passages = movements.passages().iter().map(|passage| turn(passage.from, passage.to)).collect();
        let rungs = Rungs::level(settings.policy);
        Self { settings, edges, movements: movements.all().iter().map(permit).collect(), passages, rungs }
    }

    /// Tells of edges and passages that lack room what the rules of the road say besides, which a database keeps for safe ones only. What a rule
    /// may close is then no matter of room: no condition opens it.
    pub(super) fn add_rules(&mut self, network: &Network, movements: &Movements, vehicle: &Vehicle) {
        let rule = |edge: EdgeNo| network.legal(network.edges.get(edge.index())?).forbids(vehicle);
        let lacks = |permit: &Permit| matches!(permit.verdict, Verdict::Unsafe(_));
        for (edge, permit) in EdgeNo::all().zip(&mut self.edges).filter(|(_, permit)| lacks(permit)) {
            permit.verdict = rule(edge).unwrap_or(permit.verdict);
        }
        let passages = movements.passages().iter().zip(&mut self.passages);
        for (passage, permit) in passages.filter(|(_, permit)| lacks(permit)) {
            permit.verdict = passage.through.iter().find_map(|&arc| rule(arc)).unwrap_or(permit.verdict);
        }
    }

    /// The access to what is safe and breaks no restriction. Turning back on the road is barred.
    #[must_use]
    pub fn access(&self, movements: &Movements) -> Access {
        self.access_at(movements, |_| BARRED)
    }

    /// The access to what is lawful. What is not safe has a price.
    #[must_use]
    pub fn access_at(&self, movements: &Movements, price: impl Fn(&Permit) -> u64) -> Access {
        self.access_by(movements, |_, permit| price(permit), &price)
    }

    /// The access to what is lawful. What is not safe has a price: `edge` gives that of an edge, `turn` that of a movement or passage.
    pub(super) fn access_by(
        &self,
        movements: &Movements,
        edge: impl Fn(EdgeNo, &Permit) -> u64,
        turn: impl Fn(&Permit) -> u64,
    ) -> Access {
        let cost = |permit: &Permit| if permit.usable() { 0 } else { turn(permit) };
        let movement = |(m, permit): (&crate::network::Movement, &Permit)| {
            if m.forbidden.is_some() || m.kind == MovementKind::UTurn { BARRED } else { cost(permit) }
        };
        let passage = |(p, permit): (&crate::network::Passage, &Permit)| {
            if p.forbidden.is_some() { BARRED } else { cost(permit) }
        };
        Access {
            edges: EdgeNo::all()
                .zip(&self.edges)
                .map(|(i, permit)| if permit.usable() { 0 } else { edge(i, permit) })
                .collect(),
            movements: movements.all().iter().zip(&self.movements).map(movement).collect(),
            passages: movements.passages().iter().zip(&self.passages).map(passage).collect(),
            pass_through: BARRED,
        }
    }

    /// Whether an edge may be used.
    #[must_use]
    pub fn edge(&self, edge: EdgeNo) -> bool {
        self.edges.get(edge.index()).is_some_and(Permit::usable)
    }
}
