//! Tests of Ctrl-C and kill: requests in progress are answered, then the server ends.

use std::io::{BufReader, Write as _};
use std::net::TcpStream;
use std::time::Instant;

use netcert::serve::Limits;

use super::http::{Reply, Server};

#[test]
fn it_ends_well_when_told_to() {
    for signal in ["-INT", "-TERM"] {
        let server = Server::demo();
        assert_eq!(server.get("/healthz").status, 200);
        let address = server.address;
        // One that keeps its connection open holds nothing up.
        let mut idle = server.connect();
        idle.write_all(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
        assert_eq!(Reply::read(&mut BufReader::new(&idle)).status, 200);
        server.signal(signal);
        let (status, said) = server.end();
        assert!(status.success(), "{signal}: {status}\n{said}");
        assert!(!said.contains("panic"), "{said}");
        assert!(TcpStream::connect(address).is_err(), "{signal}: the port is free");
    }
}

#[test]
fn what_is_being_answered_is_answered() {
    let server = Server::demo();
    let edges =
        server.place.netcert("query --db demo.gpkg --vehicle AU-SEMI19 --verdict safe --format json").succeeds();
    let id = edges.json()["edges"][0]["edge_id"].to_string();
    let mut stream = server.connect();
    let target = format!("/api/explain/{id}?vehicle=AU-SEMI19");
    stream.write_all(format!("GET {target} HTTP/1.1\r\nHost: localhost\r\n\r\n").as_bytes()).unwrap();
    // Whoever came later has been answered: it is at it, or has done it.
    for _ in 0..3 {
        assert_eq!(server.get("/healthz").status, 200);
    }
    server.signal("-INT");
    let begin = Instant::now();
    let reply = Reply::read(&mut BufReader::new(stream));
    if begin.elapsed() < Limits::default().stop_time {
        assert_eq!(reply.status, 200, "{}", reply.text());
        assert_eq!(reply.json()["verdict"], "safe");
    } else {
        println!("cut after {:?}: the machine is too busy to explain an edge within the bound", begin.elapsed());
    }
    assert!(server.end().0.success());
}

#[test]
fn a_port_that_is_taken_is_an_error_with_a_way_out() {
    let server = Server::demo();
    let line = format!("serve --db demo.gpkg --addr {}", server.address);
    server.place.netcert(&line).fails().tells("--addr 127.0.0.1:0");
}
