//! How many of the turns that can be driven are safe. For turns between safe main roads it draws a crossing of two straight
//! roads with the same strips, angle and kerb. A planner that knows nothing of certificates searches a path on it
//! (`crates/oracle/src/planner.rs`). The drawn crossing has none of the bends and other arms of the map, so some turns are
//! safe that cannot be driven on it, and the other way round.
//!
//! `cargo run --release --example turn_recall -- REGION.gpkg VEHICLE POLICY TURNS`, with a database that certifies the vehicle's
//! edges and turns for this policy. In its lane a vehicle may use all lanes of its direction near a turn, and all of the crossing.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::collections::BTreeMap;

use netcert::network::{EdgeNo, MovementKind, Network};
use netcert::osm::facts::{Direction, Policy, RoadClass};
use netcert::rows::TurnRow;
use netcert::store::Database;
use netcert::vehicle::Vehicle;
use netcert::verdict::Verdict;
use netcert::words::Named as _;
use netcert_oracle::crossing::{Crossing, CrossingPose};
use netcert_oracle::planner::drivable;
use rayon::prelude::*;

/// Angles of the turns, degrees.
const ANGLES_DEG: std::ops::RangeInclusive<f64> = 60.0..=105.0;
/// Bounds between classes of undisturbed room, metres. From the second bound on a turn counts as drivable.
const SPARE_M: [f64; 3] = [0.15, 0.3, 0.5];

/// A turn on a drawn crossing.
struct Tried {
    room_m: f64,
    row: TurnRow,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, id, policy, count] = arguments.as_slice() else {
        panic!("usage: turn_recall REGION.gpkg VEHICLE POLICY TURNS")
    };
    let policy = Policy::named(policy).expect("lane, direction or carriageway");
    let mut database = Database::open(file.as_ref()).unwrap();
    let record = database.vehicles().unwrap().into_iter().find(|record| &record.id == id).expect("certified");
    let vehicle = Vehicle::from_json(&record.definition).unwrap();
    let network = database.load_network().unwrap();
    let edges: BTreeMap<i64, EdgeNo> =
        EdgeNo::all().zip(&network.edges).map(|(index, edge)| (edge.id, index)).collect();
    let mut safe = vec![false; network.edges.len()];
    for row in database.query(&netcert::store::QueryOptions::new(id, policy)).unwrap() {
        let row = row.unwrap();
        safe[row.edge.index.index()] = row.certificate.verdict == Verdict::Safe;
    }
    let rows = database.turn_rows(id, policy).unwrap().map(|row| row.unwrap());
    let main = |edge: EdgeNo| network.road(&network.edges[edge.index()]).class <= RoadClass::Tertiary;
    let wanted = |row: &TurnRow| {
        let ends = [edges[&row.turn.from_edge], edges[&row.turn.to_edge]];
        let turns = row.arcs.is_none() && row.restriction.is_none() && ANGLES_DEG.contains(&row.angle_deg.abs());
        turns && ends.iter().all(|&edge| safe[edge.index()] && main(edge))
    };
    let mut rows: Vec<TurnRow> = rows.filter(wanted).collect();
    let all = rows.len();
    // Ids are hashes, so this is a fixed random choice.
    rows.sort_by_key(|row| row.turn.id);
    rows.truncate(count.parse().unwrap());
    let movements = network.movements();
    let tried = |row: TurnRow| {
        let ends = [edges[&row.turn.from_edge], edges[&row.turn.to_edge]];
        let beyond = movements.after(ends[0]).iter().any(|movement| movement.kind == MovementKind::StraightOn);
        let crossing = crossing(&network, ends, &row, beyond, policy)?;
        Some(Tried { room_m: drivable(&crossing, &vehicle, row.turn.id as u64).room_m, row })
    };
    let tried: Vec<Tried> = rows.into_par_iter().filter_map(tried).collect();
    println!("{file} {id}: {} of {all} turns of 60 to 105 degrees between safe main roads", tried.len());
    let is_safe = |tried: &&Tried| tried.row.certificate.verdict == Verdict::Safe;
    let classes = [f64::NEG_INFINITY].into_iter().chain(SPARE_M);
    for (k, from_m) in classes.enumerate() {
        let to_m = SPARE_M.get(k).copied().unwrap_or(f64::INFINITY);
        let among: Vec<&Tried> = tried.iter().filter(|tried| (from_m..to_m).contains(&tried.room_m)).collect();
        let safe = among.iter().copied().filter(is_safe).count();
        println!("  room {from_m} to {to_m} m on the drawn crossing: {} turns, {safe} safe", among.len());
    }
    let missed = tried.iter().filter(|tried| tried.room_m >= SPARE_M[1] && !is_safe(tried));
    for Tried { room_m, row } in missed {
        let rsc = row.certificate.rsc_m.map_or("none".to_owned(), |m| format!("{m:.2} m"));
        println!(
            "    {} ({:.0}°, {} into {}): {room_m:.2} m on the drawn crossing, RSC {rsc}",
            row.turn.id,
            row.angle_deg,
            row.turn.from_name.as_deref().unwrap_or("?"),
            row.turn.to_name.as_deref().unwrap_or("?"),
        );
    }
}

/// The turn on straight roads, drawn to the left.
fn crossing(network: &Network, ends: [EdgeNo; 2], row: &TurnRow, beyond: bool, policy: Policy) -> Option<Crossing> {
    let strip = |edge: EdgeNo, policy: Policy| {
        let edge = &network.edges[edge.index()];
        let section = network.road(edge).sections[usize::from(edge.direction == Direction::Backward)];
        let strip = section.strip(policy)?;
        let [right_m, left_m] = [f64::from(strip.right_m), f64::from(strip.left_m)];
        Some(if row.angle_deg > 0.0 { [right_m, left_m] } else { [-left_m, -right_m] })
    };
    // What turns may use where the policy is the lane.
    let near_turns = policy.max(Policy::Direction);
    let mut crossing = Crossing {
        strips: [strip(ends[0], Policy::Carriageway)?, strip(ends[1], Policy::Carriageway)?],
        lanes: [strip(ends[0], near_turns)?, strip(ends[1], near_turns)?],
        angle: row.angle_deg.abs().to_radians(),
        kerb_m: row.kerb_radius_m?,
        beyond,
        split: false,
        islands: Vec::new(),
        pose: CrossingPose { mirrored: false, heading: 0.0, at: [0.0; 2] },
    };
    crossing.islands = crossing.beside_lanes();
    Some(crossing)
}
