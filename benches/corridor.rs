//! Speed of making strokes into corridors: stations per second and core, on winding roads as a mapper draws them.
//!
//! `cargo bench --bench corridor`

#![allow(clippy::unwrap_used)]

use divan::counter::ItemsCount;
use netcert::corridor::{Corridor, CurvatureProfile, Frame, Params, stroke_corridor};
use netcert::network::{Edge, EdgeNo, Network, Road, Stroke};
use netcert::osm::facts::{CrossSection, Direction, Legal, Oneway, Policy, RoadClass, Strip, WidthSource};
use netcert::osm::{LonLat, NodeId};

fn main() {
    divan::main();
}

/// `strokes` roads of about 4 km with bends between 40 and 600 m. Vertices are 8 to 30 m apart and 0.3 m off the road.
/// There is an edge every ten vertices, and every eighth edge has one more lane.
fn network(strokes: u32) -> Network {
    let frame = Frame::around_degrees([(9.0, 48.0)]).unwrap();
    let mut n = Network::default();
    for lanes in [2.0_f32, 3.0] {
        let strip = |left_m, right_m| Some(Strip { left_m, right_m, source: WidthSource::Tagged });
        let kerb = -1.75 * lanes;
        let section = CrossSection {
            lane: strip(kerb + 3.5, kerb),
            direction: strip(-kerb, kerb),
            carriageway: strip(-kerb, kerb),
        };
        n.roads.push(road(section));
    }
    let mut seed = 7_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / 2_f64.powi(53)
    };
    for _ in 0..strokes {
        let mut profile = CurvatureProfile::new(1.0).straight(100.0);
        while profile.curvature.len() < 4000 {
            let side = if random() < 0.5 { -1.0 } else { 1.0 };
            let bend = side / (40.0 * 15_f64.powf(random()));
            let length = 0.2 + 0.8 * random();
            profile = profile.clothoid(bend, 40.0).arc(bend, length / bend.abs().max(0.01)).clothoid(0.0, 40.0);
            profile = profile.straight(200.0 * random());
        }
        let c = Corridor::from_curvature(1.0, [0.0; 2], 6.0 * random(), &profile.curvature, 1.0, 1.0);
        let (mut points, mut i) = (Vec::new(), 0);
        while i < c.len() {
            points.push([c.x[i] + 0.6 * (random() - 0.5), c.y[i] + 0.6 * (random() - 0.5)]);
            i += 8 + (22.0 * random()) as usize;
        }
        add_stroke(&mut n, &frame.inverse(&points).unwrap());
    }
    n
}

fn road(section: CrossSection) -> Road {
    Road {
        way_id: 1,
        class: RoadClass::Primary,
        link: false,
        roundabout: false,
        oneway: Oneway::Forward,
        name: None,
        reference: None,
        lanes: None,
        country: *b"DE",
        left_hand_traffic: false,
        sections: [section; 2],
        legal: Default::default(),
        max_speed_km_h: [None; 2],
        width_tags: None,
    }
}

fn add_stroke(n: &mut Network, degrees: &[[f64; 2]]) {
    let first = n.shapes.len() as u32;
    let end = first + degrees.len() as u32;
    n.shapes.extend(
        degrees.iter().map(|p| LonLat { lon_e7: (p[0] * 1e7).round() as i32, lat_e7: (p[1] * 1e7).round() as i32 }),
    );
    let edges = n.stroke_edges.len() as u32;
    for start in (first..end - 1).step_by(10) {
        let index = n.edges.len() as u32;
        n.edges.push(Edge {
            id: i64::from(index) + 1,
            road: u32::from(index.is_multiple_of(8)),
            from_node: NodeId::new(1),
            to_node: NodeId::new(2),
            direction: Direction::Forward,
            shape: start..(start + 11).min(end),
            narrowings: 0..0,
            legal: Legal::default(),
            barred: false,
            cut: false,
        });
        n.stroke_edges.push(EdgeNo::new(index));
    }
    n.strokes.push(Stroke { approach: 0..0, edges: edges..n.stroke_edges.len() as u32, closed: false });
}

fn stations(network: &Network, params: &Params) -> usize {
    let corridors = network.strokes.iter().map(|s| stroke_corridor(network, s, Policy::Lane, params).unwrap());
    corridors.map(|c| c.corridor.len()).sum()
}

#[divan::bench(sample_count = 10)]
fn strokes(bencher: divan::Bencher<'_, '_>) {
    let (network, params) = (network(50), Params::default());
    let count = stations(&network, &params);
    bencher.counter(ItemsCount::new(count)).bench(|| stations(&network, &params));
}
