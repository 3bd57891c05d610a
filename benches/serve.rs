//! Tiles over real HTTP: the time from the start of the program to the first tile, then the latency per zoom for first
//! and repeated requests.
//!
//!     cargo bench --bench serve -- REGION.gpkg [VEHICLE] [POLICY]
//!
//! The table begins some seconds after the first tile. One client on loopback uses gzip and one connection. Tiles are spread evenly over those that hold a vertex of a
//! road. On Linux the server's processor time for first requests is measured too; on a busy machine it is the only
//! reproducible figure.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

use std::collections::BTreeSet;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use netcert::osm::facts::Policy;
use netcert::store::{Database, QueryOptions};
use netcert::words::Named as _;

/// The pause after the first tile.
const LOADED_AFTER: Duration = Duration::from_secs(8);
/// Most tiles per zoom.
const MOST_TILES: usize = 300;

struct Client {
    reader: BufReader<TcpStream>,
}

impl Client {
    /// Bytes as sent, and the time until the last byte.
    fn get(&mut self, target: &str) -> (usize, Duration) {
        let begin = Instant::now();
        let request = format!("GET {target} HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n");
        self.reader.get_mut().write_all(request.as_bytes()).unwrap();
        let (mut length, mut line) = (0, String::new());
        loop {
            line.clear();
            self.reader.read_line(&mut line).unwrap();
            assert!(!line.starts_with("HTTP") || line.contains(" 200 "), "{target}: {line}");
            if let Some(value) = line.to_lowercase().strip_prefix("content-length: ") {
                length = value.trim().parse().unwrap();
            }
            if line.trim().is_empty() {
                break;
            }
        }
        let mut body = vec![0; length];
        self.reader.read_exact(&mut body).unwrap();
        (length, begin.elapsed())
    }
}

/// Tiles of a zoom that hold a vertex.
fn tiles(lines: &[Vec<(f64, f64)>], z: u32) -> Vec<(u32, u32)> {
    let side = f64::from(1_u32 << z);
    let place = |&(lon, lat): &(f64, f64)| {
        let y = 0.5 - lat.to_radians().tan().asinh() / std::f64::consts::TAU;
        (((lon + 180.0) / 360.0 * side) as u32, (y * side) as u32)
    };
    let all: BTreeSet<(u32, u32)> = lines.iter().flatten().map(place).collect();
    let step = all.len().div_ceil(MOST_TILES).max(1);
    all.into_iter().step_by(step).collect()
}

/// User and system time of a process, milliseconds. `None` without `/proc`. Ticks are hundredths of a second for every
/// program (proc(5)).
fn cpu_ms(process: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |field: usize| fields.get(field)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) * 10.0)
}

fn figures(mut times: Vec<Duration>) -> String {
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize].as_secs_f64() * 1000.0;
    format!("{:.1} / {:.1} / {:.1}", at(0.5), at(0.99), at(1.0))
}

fn main() {
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with("--"));
    let Some(db) = words.next() else {
        println!("skipped: name a database: cargo bench --bench serve -- REGION.gpkg [VEHICLE] [POLICY]");
        return;
    };
    let mut database = Database::open(db.as_ref()).unwrap();
    let sets = database.certified().unwrap();
    let vehicle = words.next().unwrap_or_else(|| sets[0].vehicle_id.clone());
    let policy = words.next().map_or(sets[0].policy, |word| Policy::named(&word).unwrap());
    let rows = database.query(&QueryOptions::new(&vehicle, policy)).unwrap();
    let lines: Vec<Vec<(f64, f64)>> =
        rows.map(|row| row.unwrap().line.iter().map(|position| position.degrees()).collect()).collect();
    println!("{db}: {} edges, {vehicle}, {} policy", lines.len(), policy.name());
    let target = |z: u32, (x, y): (u32, u32)| format!("/tiles/{}/{vehicle}/{z}/{x}/{y}.mvt", policy.name());

    let begin = Instant::now();
    let mut program = Command::new(env!("CARGO_BIN_EXE_netcert"));
    program.args(["serve", "--quiet", "--addr", "127.0.0.1:0", "--db", &db]).stdout(Stdio::piped());
    let mut child = program.spawn().unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    let ready = begin.elapsed();
    let address = first.trim().trim_start_matches("http://").trim_end_matches('/');
    let stream = TcpStream::connect(address).unwrap();
    stream.set_nodelay(true).unwrap();
    let mut client = Client { reader: BufReader::new(stream) };
    client.get("/api/region");
    let whole = tiles(&lines, 10);
    client.get(&target(10, whole[0]));
    println!("start: ready after {ready:.0?}, first tile (zoom 10) after {:.0?}\n", begin.elapsed());

    // By then the network is in memory, from which deeper zooms are made.
    std::thread::sleep(LOADED_AFTER);
    table(&mut client, child.id(), &lines, &target);
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Prints a row per zoom.
fn table(client: &mut Client, process: u32, lines: &[Vec<(f64, f64)>], target: &dyn Fn(u32, (u32, u32)) -> String) {
    println!(
        "| zoom | tiles | first asked, ms (p50 / p99 / most) | of it CPU, mean | asked again, ms | kB, median / most |"
    );
    println!("| --- | --- | --- | --- | --- | --- |");
    for z in 6..=16 {
        let all = tiles(lines, z);
        let before = cpu_ms(process);
        let cold: Vec<(usize, Duration)> = all.iter().map(|&tile| client.get(&target(z, tile))).collect();
        let cpu = cpu_ms(process).zip(before).map(|(after, before)| (after - before) / all.len() as f64);
        let cpu = cpu.map_or("–".to_owned(), |ms| format!("{ms:.1}"));
        let warm: Vec<Duration> = all.iter().map(|&tile| client.get(&target(z, tile)).1).collect();
        let mut bytes: Vec<usize> = cold.iter().map(|answer| answer.0).collect();
        bytes.sort_unstable();
        let kb = |bytes: usize| bytes as f64 / 1000.0;
        let cold = figures(cold.into_iter().map(|answer| answer.1).collect());
        let (median, most) = (kb(bytes[bytes.len() / 2]), kb(bytes[bytes.len() - 1]));
        println!("| {z} | {} | {cold} | {cpu} | {} | {median:.1} / {most:.1} |", all.len(), figures(warm));
    }
}
