//! Nothing is certified at stations that do not form a curve, nor just behind them.

use netcert::corridor::{Corridor, CurvatureProfile};
use netcert::stet::{Model, Options, SpanResult, certify, certify_planned};
use netcert::stop::Stop;

use crate::support::catalogue::catalogued;

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

#[test]
fn nor_while_the_vehicle_stands_there_or_has_just_been_there() {
    let mut corridor = bend();
    corridor.x[150] += 0.02;
    let spans = [0..60, 60..130, 140..160, 160..200, 240..300];
    let model = Model::new(&catalogued("EU-SEMI16.5")).unwrap();
    let (_, results) =
        certify_planned(&corridor, &model, &spans, &Options::default(), &Stop::never()).unwrap().unwrap();
    assert_eq!(results.iter().map(SpanResult::safe).collect::<Vec<_>>(), [true, false, false, false, true]);
}
