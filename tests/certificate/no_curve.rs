//! Nothing is certified at stations that do not form a curve, nor just behind them.

use netcert::check::{Chain, SpanClaim, StationReading, Subject, Weight};
use netcert::corridor::{Corridor, CurvatureProfile};
use netcert::stet::{Model, Options, SpanResult, certify, certify_planned};
use netcert::stop::Stop;

use netcert_testing::catalogue::catalogued;

fn bend() -> Corridor {
    let profile = CurvatureProfile::new(0.5).straight(60.0).clothoid(0.02, 10.0).arc(0.02, 20.0).clothoid(0.0, 10.0);
    let profile = profile.straight(60.0);
    Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 5.0, 5.0)
}

fn safe(corridor: &Corridor) -> bool {
    certify(corridor, &Model::new(&catalogued("EU-SEMI16.5")).unwrap(), &Options::default(), &Stop::never())
        .unwrap()
        .unwrap()
        .result
        .safe()
}

#[test]
fn a_curve_is_certified_and_none_where_a_station_is_aside_or_turned_or_normals_cross() {
    let (mut aside, mut turned, mut crossed) = (bend(), bend(), bend());
    assert!(safe(&aside));
    aside.x[150] += 0.02;
    turned.heading[150..].iter_mut().for_each(|heading| *heading += 0.03);
    crossed.curvature[150] = 0.21;
    for corridor in [aside, turned, crossed] {
        assert!(!corridor.torn().is_empty() && !safe(&corridor));
    }
}

/// A bend and 200 m of straight road behind it. Station 150 is 2 cm aside.
fn torn() -> Corridor {
    let profile = CurvatureProfile::new(0.5).straight(60.0).clothoid(0.02, 10.0).arc(0.02, 20.0).clothoid(0.0, 10.0);
    let profile = profile.straight(200.0);
    let mut corridor = Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 5.0, 5.0);
    corridor.x[150] += 0.02;
    corridor
}

#[test]
fn nor_while_the_vehicle_stands_there_nor_until_its_units_have_settled() {
    let spans = [0..60, 60..130, 140..160, 160..200, 240..300, 330..360, 520..570];
    let model = Model::new(&catalogued("EU-SEMI16.5")).unwrap();
    let (_, results) = certify_planned(&torn(), &model, &spans, &Options::default(), &Stop::never()).unwrap().unwrap();
    assert_eq!(
        results.iter().map(SpanResult::safe).collect::<Vec<_>>(),
        [true, false, false, false, false, false, true]
    );
}

#[test]
fn the_second_program_confirms_nothing_there_either() {
    let corridor = torn();
    let chain = Chain::new(&catalogued("EU-SEMI16.5"));
    let subject = Subject::new(&chain, &corridor, |_| 0.0, StationReading::Lenient).unwrap();
    let claim =
        |stations| SpanClaim { stations, rsc_m: Some(0.0), hinge_margin_rad: None, shrink: 1.0, limiting: None };
    let claims = [0..60, 140..160, 240..300, 330..360, 520..570].map(claim);
    let weights = subject.check(&claims).into_iter().map(|found| found.iter().map(|f| f.weight).max());
    let unbounded = Some(Weight::Unbounded);
    assert_eq!(weights.collect::<Vec<_>>(), [None, unbounded, unbounded, unbounded, None]);
}
