//! Tests over HTTP, with one piece of slow work at a time, that a request whose time is up or whose client has gone does not delay
//! the next one.

use std::io::{BufReader, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use netcert::serve::{Editing, LaneLimits, Limits, Server, ServerOptions};

use super::http::Reply;
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";
const PATIENCE: Duration = Duration::from_secs(120);

/// A server in this process, so that its bounds can be chosen; it ends with the value.
struct Narrow {
    address: SocketAddr,
    stop: Option<tokio::sync::oneshot::Sender<()>>,
}

impl Narrow {
    /// One piece of slow work at a time, each done within `time`.
    fn over(place: &WorkFolder, time: Duration) -> Self {
        let slow = LaneLimits { at_a_time: 1, waiting: 8, time };
        let server = Server::bind(ServerOptions {
            db: place.path("demo.gpkg"),
            before: None,
            addr: "127.0.0.1:0".parse().unwrap(),
            allow_remote: false,
            base_map: None,
            editing: Editing::Off,
            now: std::sync::Arc::new(String::new),
            limits: Limits { slow, ..Limits::default() },
        });
        let server = server.unwrap();
        let address = server.address();
        let (stop, stopped) = tokio::sync::oneshot::channel();
        std::thread::spawn(move || {
            server.run(async {
                let _ = stopped.await;
            });
        });
        Self { address, stop: Some(stop) }
    }

    fn send(&self, target: &str) -> TcpStream {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(stream, "GET {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        stream
    }

    fn get(&self, target: &str) -> Reply {
        Reply::read(&mut BufReader::new(self.send(target)))
    }

    /// How long it takes until this is answered well, asked again and again.
    fn until_answered(&self, target: &str) -> Duration {
        let begin = Instant::now();
        while self.get(target).status != 200 {
            assert!(begin.elapsed() < PATIENCE, "{target}: {}", self.get(target).text());
        }
        begin.elapsed()
    }
}

impl Drop for Narrow {
    fn drop(&mut self) {
        self.stop.take().map(|stop| stop.send(()));
    }
}

/// From one side of the drawn region to the other: 13 km over six turns, each of the certificates over all of it.
fn long(snap: u32) -> String {
    let (from, to) = ("125.9952716,-30.2156702", "126.0478862,-30.2097030");
    format!("/api/route?vehicle={VEHICLE}&from={from}&to={to}&alternatives=3&drive=none&tries=30&snap={snap}")
}

/// Some metres from its beginning.
fn short(snap: u32) -> String {
    let at = "125.9952716,-30.2156702";
    format!("/api/route?vehicle={VEHICLE}&from={at}&to={at}&drive=none&snap={snap}")
}

/// A different `snap` changes no answer here, but makes each request new to the cache.
#[test]
fn the_next_is_answered_soon_whoever_is_cut_off_or_goes_away() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let patient = Narrow::over(&place, PATIENCE);
    assert!(!patient.get(&long(100)).json()["routes"].as_array().unwrap().is_empty());
    let begin = Instant::now();
    assert_eq!(patient.get(&long(99)).status, 200);
    // With all turns made already: it takes no less.
    let time = begin.elapsed();

    let hasty = Narrow::over(&place, time / 10);
    hasty.until_answered(&short(100));
    let problem = hasty.get(&long(100)).is_problem("over its time", 504);
    assert_eq!(problem["type"], "urn:netcert:problem:too-slow");
    let free = hasty.until_answered(&short(99));
    assert!(free < time / 2, "the place was free after {free:?}; the work takes {time:?}");

    let gone = patient.send(&long(98));
    std::thread::sleep(time / 10);
    drop(gone);
    let free_again = patient.until_answered(&short(99));
    assert!(free_again < time / 2, "the place was free after {free_again:?}; the work takes {time:?}");
    println!("a route of {time:?}: the next one after {free:?} and {free_again:?}");
}
