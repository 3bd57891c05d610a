//! Rows per second and bytes per certificate of the store, on a synthetic network: `cargo bench --bench store -- [WAYS]
//! [VEHICLES] [KEEP.gpkg]` (default 30 000 ways, 20 vehicles: 2 M certificates).

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use netcert::network::Portion;
use netcert::osm::facts::Policy;
use netcert::settings::Settings;
use netcert::store::{Database, QueryOptions, Run, VehicleRecord};
use netcert_testing::store_network;

/// User and system time of all threads of this process, seconds; 0 without Linux's `/proc`. It shows whether the
/// machine is busy.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    // utime and stime, the 14th and 15th fields of the line, in hundredths of a second.
    after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn main() {
    let mut numbers = std::env::args().filter_map(|argument| argument.parse::<u32>().ok());
    let (ways, vehicles) = (numbers.next().unwrap_or(30_000), numbers.next().unwrap_or(20));
    let network = store_network::network(ways);
    let edges = network.edges.len() as u32;
    let folder = tempfile::tempdir().unwrap();
    let kept = std::env::args().find(|argument| argument.ends_with(".gpkg"));
    let path = kept.map_or_else(|| folder.path().join("bench.gpkg"), PathBuf::from);
    let timed = |what: &str, rows: u32, work: &mut dyn FnMut()| {
        let (start, cpu) = (Instant::now(), cpu_seconds());
        work();
        let (seconds, cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
        let rate = f64::from(rows) / seconds;
        println!("{what:<34} {rows:>9} rows {seconds:>7.2} s ({cpu:>6.2} s of CPU) {rate:>9.0} rows/s");
    };
    let mut writer = Database::create(&path, &Settings::default()).unwrap();
    let portion = Portion::whole(network);
    timed("edges, sorted", edges, &mut || writer.portion(&portion, &[]).unwrap());
    timed("certificates, sorted", edges * vehicles, &mut || {
        let numbers: Vec<_> = (0..vehicles)
            .map(|v| {
                let (id, definition) = (format!("vehicle-{v}"), format!("{{\"id\":{v}}}"));
                writer.vehicle(VehicleRecord { name: id.clone(), id, definition })
            })
            .collect();
        for edge in 0..edges {
            for (seed, &vehicle) in (0..).zip(&numbers) {
                writer.certificate(vehicle, Policy::Lane, &store_network::certificate(edge, seed)).unwrap();
            }
        }
    });
    let run = Run {
        command: "ingest".into(),
        input_name: String::new(),
        input_blake3: None,
        replication_timestamp: None,
        netcert_version: String::new(),
        started: String::new(),
        finished: "2026-11-21T08:00:00.000Z".into(),
        parameters: "{}".into(),
    };
    let mut writer = Some(writer);
    timed("all tables, layers, checks", edges * vehicles, &mut || writer.take().unwrap().finish(&run).unwrap());
    let bytes = std::fs::metadata(&path).unwrap().len() as f64 / 1e6;
    println!("{bytes:.0} MB, network included; certificates alone: the test `a_certificate_takes_at_most_32_bytes`");

    let mut database = Database::open(&path).unwrap();
    timed("load the network", edges, &mut || drop(database.load_network().unwrap()));
    timed("query every edge of a vehicle", edges, &mut || {
        let rows = database.query(&QueryOptions::new("vehicle-3", Policy::Lane)).unwrap();
        assert_eq!(rows.map(Result::unwrap).count(), edges as usize);
    });
    timed("stats", edges * vehicles, &mut || drop(database.stats().unwrap()));
}
