//! A synthetic network of any size with every kind of value that the store must give back: all limits, permissions,
//! sources and directions, shared shapes, narrow places, strokes with approach.

use std::num::NonZeroU8;

use netcert::network::{Areas, Edge, EdgeNo, ForbiddenSequence, MappedArea, Narrowing, Network, Road, Stroke};
use netcert::osm::facts::{
    AreaKind, CrossSection, Direction, Legal, Limit, Oneway, Permission, RestrictionKind, RoadClass, RuleSet, Strip,
    WidthSource,
};
use netcert::osm::{LonLat, NodeId};
use netcert::rows::{Conclusion, EdgeCertificate, Measured};
use netcert::stet::Side;
use netcert::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};

const CLASSES: [RoadClass; 5] =
    [RoadClass::Motorway, RoadClass::Primary, RoadClass::LivingStreet, RoadClass::Track, RoadClass::Busway];
const SOURCES: [WidthSource; 5] =
    [WidthSource::Assumed, WidthSource::FromLanes, WidthSource::Estimated, WidthSource::Tagged, WidthSource::Surveyed];

/// A grid of `ways` roads, 20 in a row, each cut into two edges per direction. Every third road is one-way.
pub fn network(ways: u32) -> Network {
    let mut network = Network::default();
    for way in 0..ways {
        add_way(&mut network, way);
    }
    add_strokes(&mut network);
    add_restrictions(&mut network);
    network.areas = areas(&network);
    network
}

/// A surface around the first node, and an island.
fn areas(network: &Network) -> Areas {
    let Some(&at) = network.shapes.iter().find(|at| at.lon_e7 > 1) else { return Areas::default() };
    let corner = |x: i32, y: i32| LonLat { lon_e7: at.lon_e7 + x, lat_e7: at.lat_e7 + y };
    let ring = |m: i32| [(-m, -m), (m, -m), (m, m), (-m, m), (-m, -m)].map(|(x, y)| corner(x, y)).to_vec();
    let area = |way_id, kind, m| MappedArea { way_id, kind, ring: ring(m) };
    Areas::new(vec![area(7, AreaKind::Road(RoadClass::Primary), 700), area(9, AreaKind::Island, 50)], network)
}

fn add_way(network: &mut Network, way: u32) {
    let oneway = if way.is_multiple_of(3) { Oneway::Forward } else { Oneway::No };
    let name = (!way.is_multiple_of(4)).then(|| network.strings.intern(&format!("Straße {} 'Ost'", way % 7)));
    let reference = way.is_multiple_of(5).then(|| network.strings.intern(&format!("A{}", way % 9)));
    network.roads.push(Road {
        way_id: 1_000_000_000_000 + i64::from(way) * 3,
        class: CLASSES[way as usize % 5],
        link: way.is_multiple_of(10),
        roundabout: way % 11 == 3,
        oneway,
        name,
        reference,
        lanes: (way % 6 != 1).then_some((way % 6) as u8),
        country: if way.is_multiple_of(2) { *b"DE" } else { *b"AU" },
        left_hand_traffic: way % 2 == 1,
        sections: [section(way), section(way + 1)],
        legal: [legal(way), legal(way * 7 + 2)],
        max_speed_km_h: [NonZeroU8::new((way % 4 * 30) as u8), NonZeroU8::new((way % 3 * 50) as u8)],
        width_tags: (way % 5 == 2).then(|| format!("width={}\nlanes=2", way % 8).into()),
    });
    // A position of a piece that was left out.
    network.shapes.extend((way % 9 == 7).then_some(LonLat { lon_e7: 1, lat_e7: 2 }));
    let start = network.shapes.len() as u32;
    let (x, y) = ((way % 20) as i32 * 100_000 + 86_000_000, (way / 20) as i32 * 90_000 + 494_000_000);
    network.shapes.extend((0..7).map(|i| LonLat { lon_e7: x + i * 15_003, lat_e7: y + (i * i) * 311 - 7 }));
    let narrow = network.narrowings.len() as u32;
    if way % 6 == 2 {
        network.narrowings.push(Narrowing { vertex: 1 + way % 2, passage_m: 2.6 + way as f32 * 0.01 });
    }
    let narrowings = narrow..network.narrowings.len() as u32;
    // Two edges share the vertex where the way is cut, and both directions share a shape.
    for (part, shape) in [start..start + 4, start + 3..start + 7].into_iter().enumerate() {
        let nodes = [0, 1].map(|end| NodeId::new(i64::from(way) * 10 + part as i64 + end));
        for direction in [Direction::Forward, Direction::Backward] {
            if direction == Direction::Backward && oneway == Oneway::Forward {
                continue;
            }
            let forward = direction == Direction::Forward;
            network.edges.push(Edge {
                id: 7_000_000_000 + i64::from(way) * 8 + part as i64 * 2 + i64::from(forward),
                road: way,
                from_node: nodes[usize::from(!forward)],
                to_node: nodes[usize::from(forward)],
                direction,
                shape: shape.clone(),
                narrowings: if part == 0 { narrowings.clone() } else { narrowings.end..narrowings.end },
                legal: legal(way + part as u32),
                barred: way % 13 == 4,
                cut: way % 17 == 5,
            });
        }
    }
}

/// Strokes of three edges, each with the last edge of the previous stroke as its approach.
fn add_strokes(network: &mut Network) {
    let edges: Vec<EdgeNo> = EdgeNo::first(network.edges.len()).collect();
    for (no, chain) in edges.chunks(3).enumerate() {
        let start = network.stroke_edges.len() as u32;
        network.stroke_edges.extend(chain[0].get().checked_sub(1).map(EdgeNo::new));
        let first = network.stroke_edges.len() as u32;
        network.stroke_edges.extend(chain.iter().rev());
        let end = network.stroke_edges.len() as u32;
        network.strokes.push(Stroke { approach: start..first, edges: first..end, closed: no % 8 == 7 });
    }
}

/// Restrictions of two, three and four edges in turn, of both kinds and every turn.
fn add_restrictions(network: &mut Network) {
    let turns = ["left_turn", "right_turn", "straight_on", "u_turn", "entry", "exit"];
    for no in 0..network.edges.len() as u32 / 7 {
        let start = network.restriction_edges.len() as u32;
        network.restriction_edges.extend((no * 7..).map(EdgeNo::new).take(2 + no as usize % 3));
        let kind = format!("{}_{}", if no.is_multiple_of(4) { "only" } else { "no" }, turns[no as usize % 6]);
        network.restrictions.push(ForbiddenSequence {
            relation_id: 3_000_000_000 + i64::from(no / 2),
            kind: RestrictionKind::named(&kind).unwrap(),
            conditional: no.is_multiple_of(5),
            edges: start..network.restriction_edges.len() as u32,
        });
    }
}

fn section(k: u32) -> CrossSection {
    let strip = |left_m: f32, right_m: f32, off: u32| {
        (k % 9 != off).then_some(Strip { left_m, right_m, source: SOURCES[(k + off) as usize % 5] })
    };
    CrossSection {
        lane: strip(0.0, -3.5 + (k % 4) as f32 * 0.1, 0),
        direction: strip(0.05, -3.65, 1),
        carriageway: strip(3.7, -3.7, 2),
    }
}

fn legal(k: u32) -> Legal {
    let limit = |at: u32, value: f32| match (k + at) % 6 {
        0 => Limit::At(value),
        1 => Limit::Unreadable,
        _ => Limit::None,
    };
    let permission = |k: u32| [Permission::Yes, Permission::Restricted, Permission::No][k as usize % 3];
    Legal {
        max_height: limit(0, 3.8),
        max_weight: limit(1, 7.5),
        max_axle_load: limit(2, 11.5),
        max_length: limit(3, 18.75),
        max_width: limit(4, 2.3),
        hgv: permission(k / 5),
        motor_vehicle: permission(k / 7),
        rules: (k % 11 == 3)
            .then_some("forward\nhgv:conditional=no @ (22:00-06:00)\nmaxaxles=4\n\nforward\nhgv=no")
            .and_then(RuleSet::from_text),
        tags: (k % 7 == 4).then(|| "hgv=no\nmaxweight=8 st".into()),
    }
}

/// A certificate of every kind, by edge. `seed` distinguishes vehicles.
pub fn certificate(edge: u32, seed: u32) -> EdgeCertificate {
    let k = edge.wrapping_mul(2_654_435_761).wrapping_add(seed.wrapping_mul(40_503)) >> 8;
    let verdict = match k % 10 {
        0..=4 => Verdict::Safe,
        5 => Verdict::Unsafe(UnsafeReason::Width),
        6 => Verdict::Unsafe(UnsafeReason::Articulation),
        7 => Verdict::Forbidden(ForbiddenReason::Weight),
        8 => Verdict::Forbidden(ForbiddenReason::Hgv),
        _ => Verdict::Unknown(UnknownReason::Width),
    };
    let rsc_m = match verdict {
        Verdict::Safe => f64::from(k % 700) / 1000.0 + 0.0004,
        _ => -f64::from(k % 3000) / 1000.0 - 0.0004,
    };
    let measured = Measured {
        rsc_m,
        rsc_published_m: rsc_m - 3.0 - f64::from(k % 17),
        hinge_margin_rad: f64::from(k % 60).to_radians(),
        shrink: if k.is_multiple_of(3) { f64::from(300 + k % 700) / 1000.0 } else { 1.0 },
        limiting_s_m: f64::from(k % 4000) / 10.0,
        limiting_unit: (k % 5) as usize,
        limiting_side: if k.is_multiple_of(2) { Side::Left } else { Side::Right },
    };
    let measured = (!matches!(verdict, Verdict::Unknown(_))).then_some(measured);
    let need_width_m = (verdict == Verdict::Unsafe(UnsafeReason::Width)).then(|| 3.0 + f64::from(k % 40) / 20.0);
    EdgeCertificate { edge: EdgeNo::new(edge), conclusion: Conclusion { verdict, measured }, need_width_m }
}
