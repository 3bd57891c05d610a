//! Rows whose place is a position.

use super::super::{Along, MeasurementRow, Quantity};
use super::drawing::{Drawing, point, told};
use crate::network::Network;

/// Two junctions 100 m apart on a road, with a parallel road 20 m away.
fn network() -> Network {
    Drawing::default()
        .main_road([0.0, 100.0, 200.0, 300.0], [80.0, 80.0])
        .way(1, &[1, 2, 3, 4], "name=Main")
        .way(2, &[2, 5], "name=North")
        .way(3, &[3, 6], "")
        .road(9, &[[0.0, -20.0], [300.0, -20.0]], "Back")
        .network()
}

#[test]
fn a_point_means_the_nearest_road() {
    let network = network();
    assert_eq!(told(&network, &point([50.0, 3.0])), "1:1-2 1:2-1");
    assert_eq!(told(&network, &MeasurementRow { along: Along::Backward, ..point([50.0, 3.0]) }), "1:2-1");
    assert_eq!(told(&network, &point([50.0, 40.0])), "unmatched: no road within 15 m, in this direction");
    let between = told(&network, &point([50.0, -10.0]));
    assert!(between.starts_with("ambiguous: could be way 1 (edges ") && between.contains(" or way 9 ("), "{between}");
    let named = |name: &str| MeasurementRow { name: Some(name.to_owned()), ..point([50.0, -10.0]) };
    assert_eq!(told(&network, &named("Back")), "9:9000-9001 9:9001-9000");
    assert!(told(&network, &named("Front")).starts_with("unmatched: the road has another name: way 1"));
    assert!(told(&network, &point([98.0, 2.0])).starts_with("ambiguous"));
}

#[test]
fn a_kerb_means_the_nearest_junction() {
    let kerb = |place| MeasurementRow { quantity: Quantity::KerbRadius, ..point(place) };
    assert_eq!(told(&network(), &kerb([108.0, 6.0])), "corner 2");
    assert_eq!(told(&network(), &kerb([150.0, 6.0])), "unmatched: no junction within 25 m");
    // At node 1 the road only ends.
    assert_eq!(told(&network(), &kerb([0.0, 0.0])), "unmatched: no junction within 25 m");
    let close = Drawing::default()
        .main_road([0.0, 50.0, 60.0, 100.0], [40.0, -40.0])
        .way(1, &[1, 2, 3, 4], "")
        .way(2, &[2, 5], "")
        .way(3, &[3, 6], "")
        .network();
    assert_eq!(told(&close, &kerb([52.0, 2.0])), "ambiguous: could be node 2, 2.8 m away or node 3, 8.2 m away");
}
