//! Load: a fixed, bounded number of requests on loopback, with latency figures; and more than it can do.

use std::collections::BTreeMap;
use std::io::{BufReader, Write as _};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::http::{Reply, Server};
use super::tiles;

const CLIENTS: usize = 8;
const EACH: usize = 50;

/// One connection, kept open: status and time of each request.
fn ask_all(server: &Server, targets: &[String]) -> Vec<(u16, Duration)> {
    let stream = server.connect();
    stream.set_nodelay(true).unwrap();
    let mut writer = stream.try_clone().unwrap();
    let mut reader = BufReader::new(stream);
    targets
        .iter()
        .map(|target| {
            let begin = Instant::now();
            let request = format!("GET {target} HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n");
            writer.write_all(request.as_bytes()).unwrap();
            let reply = Reply::read(&mut reader);
            (reply.status, begin.elapsed())
        })
        .collect()
}

fn tell(what: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!("{what}: {} requests, p50 {:?}, p99 {:?}, most {:?}", times.len(), at(0.5), at(0.99), at(1.0));
}

#[test]
fn many_at_a_time_are_all_answered() {
    let server = Server::demo();
    let region = server.json("/api/region");
    let tile = |z: u32, x: usize, y: usize| format!("/tiles/lane/AU-SEMI19/{z}/{x}/{y}.mvt");
    let bbox: Vec<f64> = serde_json::from_value(region["bbox"].clone()).unwrap();
    let [column, row] = tiles::at(14, (bbox[0], bbox[3])).map(|c| c as usize);
    let all = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for client in 0..CLIENTS {
            let (server, all) = (&server, &all);
            scope.spawn(move || {
                let targets: Vec<String> = (0..EACH)
                    .map(|i| match (client + i) % 5 {
                        0 => "/api/region".to_owned(),
                        1 => format!("/api/search?q={}", ["a", "high", "main", "road"][i % 4]),
                        _ => tile(14, column + i % 7, row + (i / 7) % 7),
                    })
                    .collect();
                all.lock().unwrap().extend(ask_all(server, &targets));
            });
        }
    });
    let all = all.into_inner().unwrap();
    assert_eq!(all.len(), CLIENTS * EACH);
    assert!(all.iter().all(|(status, _)| *status == 200));
    tell("tiles, search and region of the demo, 8 clients", all.into_iter().map(|(_, time)| time).collect());
}

/// The slow lane has few places and a short queue. Some requests are refused at once, and the map is served meanwhile.
#[test]
fn more_than_it_can_do_is_refused_and_the_quick_lane_stays_quick() {
    let server = Server::demo();
    let edges =
        server.place.netcert("query --db demo.gpkg --vehicle AU-SEMI19 --verdict unsafe --format json").succeeds();
    let id = &edges.json()["edges"][0]["edge_id"].to_string();
    let counts = Mutex::new(BTreeMap::<u16, usize>::new());
    let health = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..48 {
            let (server, counts) = (&server, &counts);
            scope.spawn(move || {
                let reply = server.get(&format!("/api/explain/{id}?vehicle=AU-SEMI19"));
                if reply.status == 503 {
                    reply.is_problem("too many", 503);
                    assert!(reply.header("retry-after").is_some());
                }
                *counts.lock().unwrap().entry(reply.status).or_default() += 1;
            });
        }
        for _ in 0..20 {
            health.lock().unwrap().extend(ask_all(&server, &["/api/vehicles".to_owned()]));
        }
    });
    let counts = counts.into_inner().unwrap();
    println!("48 explanations at a time: {counts:?}");
    assert_eq!(counts.values().sum::<usize>(), 48);
    assert!(counts.keys().all(|status| [200, 503].contains(status)), "{counts:?}");
    assert!(counts.get(&200).is_some_and(|&answered| answered >= 1), "{counts:?}");
    let health = health.into_inner().unwrap();
    assert!(health.iter().all(|(status, _)| *status == 200));
    tell("vehicles meanwhile", health.into_iter().map(|(_, time)| time).collect());
    assert_eq!(server.get("/healthz").status, 200);
}
