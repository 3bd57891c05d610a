//! Random pairs of main roads: certified, certified under conditions, or neither.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use netcert::network::{EdgeNo, MovementKind};
use netcert::route::{Access, BARRED, Goal, Measure, PartKind, Planner, Question, Snapper, Speeds, Start, search_over};
use netcert::stop::Stop;
use netcert::verdict::Verdict;
use netcert::words::Named as _;
use rayon::prelude::*;

use super::{Draw, Region};

/// What became of a pair.
enum Outcome {
    /// No lawful way joins the places.
    Unjoined,
    Certified,
    /// By quantity, the number of conditions.
    Conditions(BTreeMap<&'static str, usize>),
    /// No route. The text says what stopped the search.
    Nothing(String),
}

pub(super) fn tell(region: &Region, from: &[EdgeNo], pairs: u64) {
    let began = Instant::now();
    let lawful = lawful(region);
    let outcomes: Vec<(Outcome, f64)> =
        (0..pairs).into_par_iter().map(|pair| outcome(region, &lawful, from, pair)).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let mut conditions: Vec<usize> = Vec::new();
    let mut quantities: BTreeMap<&str, usize> = BTreeMap::new();
    let mut seconds: Vec<f64> = Vec::new();
    for (outcome, took_s) in outcomes {
        let word = match &outcome {
            Outcome::Unjoined => "no lawful way",
            Outcome::Certified => "certified",
            Outcome::Conditions(of) => match of.values().sum() {
                0 => "certified as it is",
                1 => "1 condition",
                2..=3 => "2 to 3 conditions",
                _ => "more conditions",
            },
            Outcome::Nothing(_) => "none",
        };
        *counts.entry(word).or_default() += 1;
        if let Outcome::Nothing(why) = &outcome {
            *reasons.entry(why.clone()).or_default() += 1;
        }
        if let Outcome::Conditions(of) = outcome {
            conditions.push(of.values().sum());
            of.into_iter().for_each(|(quantity, count)| *quantities.entry(quantity).or_default() += count);
            seconds.push(took_s);
        }
    }
    conditions.sort_unstable();
    seconds.sort_by(f64::total_cmp);
    let median = conditions.get(conditions.len() / 2).copied().unwrap_or(0);
    let middle = |share: f64| seconds.get((share * seconds.len() as f64) as usize).copied().unwrap_or(0.0);
    println!("  {pairs} pairs: {counts:?}");
    for (why, pairs) in reasons {
        println!("    {pairs:5}  none: {why}");
    }
    println!("  conditions by quantity: {quantities:?}");
    println!(
        "  conditions: median {median}, most {}; seconds for such a route: median {:.1}, 9 of 10 within {:.1}; {:.0} s in all",
        conditions.last().copied().unwrap_or(0),
        middle(0.5),
        middle(0.9),
        began.elapsed().as_secs_f64()
    );
}

fn outcome(region: &Region, lawful: &Access, from: &[EdgeNo], pair: u64) -> (Outcome, f64) {
    let mut draw = Draw(pair);
    let places = vec![region.place(from, &mut draw), region.place(from, &mut draw)];
    let (graph, snapper, stop) = (region.graph(), Snapper::new(&region.roads), Stop::never());
    let open = |edge: EdgeNo| lawful.edges[edge.index()] != BARRED;
    let snapped: Vec<_> = places.iter().map(|&place| snapper.snap(place, 50.0, open).unwrap()).collect();
    let starts: Vec<Start> = snapped[0].on.iter().map(|on| Start::new(on.edge, on.share)).collect();
    let goals: Vec<Vec<Goal>> = vec![snapped[1].on.clone()];
    if search_over(&graph, lawful, &starts, &goals, &stop).unwrap().is_none() {
        return (Outcome::Unjoined, 0.0);
    }
    let began = Instant::now();
    let speeds = Speeds::builtin().unwrap();
    let mut planner = Planner::new(&region.roads, Arc::clone(&region.driver), speeds, Measure::Time);
    let question = Question { places, snap_m: 50.0, alternatives: 0, tries: 30 };
    let answer = planner.answer(&question, &stop).unwrap_or_default();
    let outcome = if answer.routes.is_empty() {
        match planner.under_conditions(&question, &answer.refuted, &stop).unwrap() {
            Ok(route) => {
                assert!(route.route.certificate.result.safe(), "certified under its conditions");
                let mut of = BTreeMap::new();
                route.conditions.iter().for_each(|c| *of.entry(c.quantity.name()).or_default() += 1);
                Outcome::Conditions(of)
            }
            Err(hopeless) if hopeless.gave_up => Outcome::Nothing("given up".to_owned()),
            Err(hopeless) => Outcome::Nothing(match hopeless.places.last() {
                Some(&at) => kind(region, at),
                None => "no way over places that room would open".to_owned(),
            }),
        }
    } else {
        Outcome::Certified
    };
    (outcome, began.elapsed().as_secs_f64())
}

/// The access to everything that no sign and no restriction forbids.
fn lawful(region: &Region) -> Access {
    let (permits, movements) = (&region.driver.permits, &region.roads.movements);
    let price = |verdict: Verdict| if matches!(verdict, Verdict::Forbidden(_)) { BARRED } else { 0 };
    Access {
        edges: permits.edges.iter().map(|permit| price(permit.verdict)).collect(),
        movements: movements
            .all()
            .iter()
            .map(|m| if m.forbidden.is_some() || m.kind == MovementKind::UTurn { BARRED } else { 0 })
            .collect(),
        passages: movements.passages().iter().map(|p| if p.forbidden.is_some() { BARRED } else { 0 }).collect(),
        pass_through: BARRED,
    }
}

/// A place for which nothing does, in a few words.
fn kind(region: &Region, at: PartKind) -> String {
    let (permits, movements) = (&region.driver.permits, &region.roads.movements);
    match at {
        PartKind::Edge(edge) => format!("edge, {:?}", permits.edges[edge.index()].verdict),
        PartKind::Turn { from, to } => match movements.index(from, to) {
            Some(place) => format!("turn, {:?}", permits.movements[place].verdict),
            None => format!("passage, {:?}", movements.passage(from, to).map(|place| permits.passages[place].verdict)),
        },
    }
}
