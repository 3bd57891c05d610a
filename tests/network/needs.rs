//! What a certificate says would be enough is enough: with it on the site, the edge or turn is safe.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use netcert::certify::{Job, TurnCase, best_of, certify_network};
use netcert::network::{EdgeNo, Network};
use netcert::osm::facts::Policy;
use netcert::reporter::Silent;
use netcert::rows::EdgeCertificate;
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::turns::{LengthClass, StrokeLine, TurnEdges, turn_facts, turn_on};
use netcert::verdict::{UnknownReason, UnsafeReason, Verdict};

use netcert_testing::catalogue::catalogued;
use netcert_testing::extracts;
use netcert_testing::routing::TestRegion;
use netcert_testing::thorough::cases;

/// The vehicles whose needs on the drawn region are looked at.
fn vehicles() -> &'static [&'static str] {
    cases(&["AU-BDOUBLE26"], &["AU-BDOUBLE26", "AU-ATRIPLE53"])
}

fn certified(network: &Network, model: &Model, settings: &Settings) -> Vec<EdgeCertificate> {
    let mut all = Vec::new();
    let job = Job { network, models: std::slice::from_ref(model), settings };
    certify_network(&job, &Silent, |_, certificate| {
        all.push(certificate.clone());
        Ok::<(), ()>(())
    })
    .unwrap();
    all
}

/// Widens every stroke, with the road before it, to one of its edges' needs at a time, certifies everything again, and asks these edges. A corridor may depend on
/// the roads beside it, so an edge that is not safe then is asked once more with its own stroke alone. Returns how many needs there were,
/// how many held, and how many edges have none.
fn widened(path: &Path, vehicle: &str, policy: Policy) -> (usize, usize, usize) {
    let region = TestRegion::read(path, policy);
    let model = Model::new(&catalogued(vehicle)).unwrap();
    let settings = Settings { needs: Needs::Edges, ..region.settings.clone() };
    let mut network = region.network.clone();
    let mut by_stroke: BTreeMap<usize, Vec<(EdgeNo, f64)>> = BTreeMap::new();
    let (mut needs, mut none) = (0, 0);
    let stroke_of = |edge: EdgeNo| {
        let of = |range: &std::ops::Range<u32>| {
            region.network.stroke_edges[range.start as usize..range.end as usize].contains(&edge)
        };
        region.network.strokes.iter().position(|stroke| of(&stroke.edges)).unwrap()
    };
    for certificate in certified(&network, &model, &settings) {
        let lacks = certificate.conclusion.verdict == Verdict::Unsafe(UnsafeReason::Width);
        assert!(lacks || certificate.need_width_m.is_none(), "only what lacks room has a need");
        match certificate.need_width_m {
            Some(need_m) => by_stroke.entry(stroke_of(certificate.edge)).or_default().push((certificate.edge, need_m)),
            None => none += usize::from(lacks),
        }
        needs += usize::from(certificate.need_width_m.is_some());
    }
    let settings = Settings { needs: Needs::Off, ..settings };
    let widen = |network: &mut Network, stroke: usize, need_m: f64| {
        let stroke = &region.network.strokes[stroke];
        let all = [&stroke.edges, &stroke.approach].map(|range| range.start as usize..range.end as usize);
        for &edge in all.into_iter().flat_map(|range| &region.network.stroke_edges[range]) {
            let facts = &region.network.edges[edge.index()];
            network.site.set_section(facts, region.network.section(facts).at_least(policy, need_m));
        }
    };
    let (mut held, mut alone) = (0, Vec::new());
    while !by_stroke.is_empty() {
        network.site = region.network.site.clone();
        let mut asked: BTreeMap<EdgeNo, (usize, f64)> = BTreeMap::new();
        for (&stroke, edges) in &mut by_stroke {
            let (_, need_m) = edges[0];
            asked.extend(edges.extract_if(.., |(_, other_m)| *other_m == need_m).map(|(edge, m)| (edge, (stroke, m))));
            widen(&mut network, stroke, need_m);
        }
        by_stroke.retain(|_, edges| !edges.is_empty());
        for certificate in certified(&network, &model, &settings) {
            let Some(&(stroke, need_m)) = asked.get(&certificate.edge) else { continue };
            match certificate.conclusion.verdict {
                Verdict::Safe => held += 1,
                _ => alone.push((certificate.edge, stroke, need_m)),
            }
        }
    }
    for (edge, stroke, need_m) in alone {
        network.site = region.network.site.clone();
        widen(&mut network, stroke, need_m);
        let own = certified(&network, &model, &settings).into_iter().find(|c| c.edge == edge).unwrap();
        println!("edge {edge} with {need_m} m, its own stroke alone: {:?}", own.conclusion.verdict);
        held += usize::from(own.conclusion.verdict == Verdict::Safe);
    }
    (needs, held, none)
}

#[test]
fn an_edge_with_the_width_that_it_needs_is_safe() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/demo.osm.pbf");
    let mut all = 0;
    for vehicle in vehicles() {
        let (needs, held, none) = widened(&demo, vehicle, Policy::Lane);
        println!("{vehicle}: {needs} needs, {held} held, {none} edges lack room without one");
        assert_eq!(held, needs, "{vehicle}");
        all += needs;
    }
    assert!(all >= 50 * vehicles().len(), "{all} needs");
    let Some(sydney) = extracts::extract("sydney_au.osm.pbf") else { return };
    let (needs, held, none) = widened(&sydney, "AU-SEMI19", Policy::Carriageway);
    println!("Sydney: {needs} needs, {held} held, {none} edges lack room without one");
    assert!(needs >= 100 && held == needs && none * 10 < needs);
}

/// An estimate is no certificate, but whoever looks for roads to measure goes by it. It changes nothing else.
#[test]
fn an_estimated_need_is_seldom_far_from_the_certified_one() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/demo.osm.pbf");
    for vehicle in vehicles() {
        let region = TestRegion::read(&demo, Policy::Lane);
        let model = Model::new(&catalogued(vehicle)).unwrap();
        let [estimated, searched] = [Needs::Estimated, Needs::Edges]
            .map(|needs| certified(&region.network, &model, &Settings { needs, ..region.settings.clone() }));
        assert_eq!(estimated.len(), searched.len());
        let mut apart_m = Vec::new();
        for (estimated, searched) in estimated.iter().zip(&searched) {
            assert_eq!((estimated.edge, estimated.conclusion), (searched.edge, searched.conclusion));
            let lacks = estimated.conclusion.verdict == Verdict::Unsafe(UnsafeReason::Width);
            assert!(lacks || estimated.need_width_m.is_none(), "only what lacks room has a need");
            if let (Some(likely_m), Some(need_m)) = (estimated.need_width_m, searched.need_width_m) {
                let twentieths = likely_m * 20.0;
                assert!((twentieths - twentieths.round()).abs() < 1e-9, "{likely_m}: steps are 5 cm");
                apart_m.push((likely_m - need_m).abs());
            } else {
                assert!(searched.need_width_m.is_none(), "edge {}: a need without an estimate", searched.edge);
            }
        }
        let within = |m: f64| apart_m.iter().filter(|apart_m| **apart_m < m + 1e-6).count();
        println!(
            "{vehicle}: {} needs, {} equal, {} a step apart at most, {} within 0.35 m",
            apart_m.len(),
            within(0.0),
            within(0.05),
            within(0.35)
        );
        assert!(apart_m.len() >= 50 && 2 * within(0.0) >= apart_m.len());
        assert!(10 * within(0.05) >= 8 * apart_m.len() && 20 * within(0.35) >= 19 * apart_m.len());
    }
}

#[test]
fn a_turn_with_the_kerb_or_the_width_that_it_needs_is_safe() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/demo.osm.pbf");
    let region = TestRegion::read(&demo, Policy::Carriageway);
    let driver = region.driver("AU-SEMI19");
    let (settings, model) = (&driver.permits.settings, &driver.model);
    let mut strokes = region.strokes();
    let reach = LengthClass::of(&model.vehicle).unwrap();
    let (mut kerbs, mut flares, mut asked) = (0, 0, 0);
    for turn in turn_facts(&region.network, &settings.kerbs) {
        let (from, to) = (turn.movement.from, turn.movement.to);
        let Some(place) = region.movements.index(from, to) else { continue };
        let permit = driver.permits.movements[place];
        if permit.verdict != Verdict::Unsafe(UnsafeReason::Width)
            || permit.rsc_m.is_none()
            || kerbs + flares >= cases(12, 25)
        {
            continue;
        }
        asked += 1;
        let lines: Vec<(EdgeNo, Arc<StrokeLine>)> =
            [from, to].into_iter().filter_map(|edge| Some((edge, strokes.line_of(edge).ok()?))).collect();
        let line = |edge: EdgeNo| {
            let found = lines.iter().find(|(of, _)| *of == edge);
            found.map(|(_, line)| line.as_ref()).ok_or(UnknownReason::Geometry)
        };
        let case = TurnCase { network: &region.network, turn: &turn, model, settings };
        let need = case.need(turn.kerb_radius_m, &line);
        let Some(radius_m) = need.kerb_radius_m else {
            flares += usize::from(need.flare_m.is_some());
            continue;
        };
        let mut network = region.network.clone();
        let edge = |edge: EdgeNo| &region.network.edges[edge.index()];
        network.site.set_kerb(edge(from).to_node, Some([edge(from), edge(to)]), radius_m);
        let made = turn_on(
            &network,
            TurnEdges { movement: turn.movement, through: &[] },
            &line,
            settings.policy,
            &settings.turn_params(),
            reach,
        );
        let (_, result) = best_of(&made.unwrap(), &[model], &settings.stet).pop().flatten().unwrap();
        assert!(result.safe(), "turn {}: {radius_m} m, {result:?}", turn.id);
        assert!(turn.kerb_radius_m.is_some_and(|has_m| has_m < radius_m));
        kerbs += 1;
    }
    println!("{asked} turns lack room: {kerbs} need a greater radius, {flares} a wider road");
    assert!(kerbs >= 5, "{kerbs} of {asked}");
}
