//! Tests of requests that must be refused: other methods, bodies, other hosts, climbing paths, injected statements, and requests
//! that are too large.

use std::io::Write as _;

use serde_json::Value;

use super::http::Server;

#[test]
fn only_reading_is_allowed() {
    let server = Server::demo();
    for method in ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "BREW"] {
        let target = if method == "CONNECT" { "localhost:80" } else { "/api/region" };
        let request = format!("{method} {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        let reply = server.raw(request.as_bytes());
        reply.is_problem(method, 405);
        assert_eq!(reply.header("allow"), Some("GET, HEAD"), "{method}");
    }
    let head = server.raw(b"HEAD /api/region HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    assert_eq!((head.status, head.body.len()), (200, 0));
    assert!(head.header("etag").is_some());
}

#[test]
fn a_request_with_a_body_is_refused_without_reading_it() {
    let server = Server::demo();
    let head = "GET /api/region HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n";
    server.raw(format!("{head}Content-Length: 5\r\n\r\nhello").as_bytes()).is_problem("a body", 413);
    server.raw(format!("{head}Content-Length: 99999999999\r\n\r\n").as_bytes()).is_problem("a great body", 413);
    let chunked = format!("{head}Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n");
    server.raw(chunked.as_bytes()).is_problem("chunks", 413);
    assert_eq!(server.raw(format!("{head}Content-Length: 0\r\n\r\n").as_bytes()).status, 200);
}

#[test]
fn another_host_is_refused() {
    let server = Server::demo();
    let asked =
        |host: &str| server.raw(format!("GET /api/region HTTP/1.1\r\n{host}Connection: close\r\n\r\n").as_bytes());
    for host in
        ["evil.example", "localhost.evil.example", "127.0.0.1.evil.example:80", "10.0.0.1", "", "user@localhost"]
    {
        asked(&format!("Host: {host}\r\n")).is_problem(host, 421);
    }
    asked("").is_problem("no host", 421);
    asked("Host: localhost\r\nHost: localhost\r\n").is_problem("two hosts", 421);
    for host in ["localhost", "LocalHost:1234", "127.0.0.1", "[::1]:8080"] {
        assert_eq!(asked(&format!("Host: {host}\r\n")).status, 200, "{host}");
    }
    let absolute = b"GET http://evil.example/api/region HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    server.raw(absolute).is_problem("absolute form", 421);
}

#[test]
fn no_path_leads_out_of_the_table() {
    let server = Server::demo();
    for path in [
        "/../../../../etc/passwd",
        "/..%2f..%2f..%2fetc%2fpasswd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/assets/../../Cargo.toml",
        "/assets/..%5c..%5cCargo.toml",
        "/index.html/..",
        "//etc/passwd",
        "/demo.gpkg",
        "/api",
        "/api/",
        "/api/region/",
        "/api/vehicles/..%2f..%2fdemo.gpkg/drawing.svg",
        "/tiles/lane/AU-SEMI19/0/0/..%2f0.mvt",
        "/.git/config",
        "/index.html%00.png",
    ] {
        let problem = server.problem(path, 404);
        assert!(!problem["detail"].as_str().unwrap().contains("/tmp"), "{path}: {problem}");
    }
}

#[test]
fn statements_smuggled_into_names_are_names() {
    let server = Server::demo();
    let before = server.json("/api/stats?policy=lane");
    for name in
        ["'%20OR%201=1--", "x';DROP%20TABLE%20edge;--", "%22%20UNION%20SELECT%20*%20FROM%20run--", "%00", "AU-SEMI19'"]
    {
        server.problem(&format!("/tiles/lane/{name}/14/0/0.mvt"), 404);
        server.problem(&format!("/api/vehicles/{name}/drawing.svg"), 404);
        server.problem(&format!("/api/edges/{name}"), 404);
        server.problem(&format!("/tiles/{name}/AU-SEMI19/14/0/0.mvt"), 400);
        let found = server.json(&format!("/api/search?q={name}"));
        assert_eq!(found.as_array().map(Vec::len), Some(0), "{name}: {found}");
    }
    // `%` and `_` are no wildcards.
    assert_eq!(server.json("/api/search?q=%25").as_array().map(Vec::len), Some(0));
    assert_eq!(server.json("/api/search?q=_").as_array().map(Vec::len), Some(0));
    assert_eq!(server.json("/api/stats?policy=lane"), before);
}

#[test]
fn what_is_too_large_is_refused() {
    let server = Server::demo();
    let long = "a".repeat(5000);
    server.problem(&format!("/{long}"), 414);
    server.problem(&format!("/api/search?q={}", "a".repeat(150)), 400);
    server.problem(&format!("/api/search?q={}", "a".repeat(300)), 400);
    server.problem(&format!("/api/region?{}", "state=1&".repeat(40)), 400);
    let headers: String = (0..400).map(|i| format!("X-{i}: {}\r\n", "b".repeat(100))).collect();
    // Or the connection is cut while the rest of them is still on its way.
    let status = server.with("/api/region", &headers).status;
    assert!([431, 0].contains(&status), "{status}");
    assert_eq!(server.get("/healthz").status, 200);
}

#[test]
fn parameters_are_checked_and_named() {
    let server = Server::demo();
    for (target, parameter) in [
        ("/api/route?vehicle=AU-SEMI19&to=1,2", "from"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2", "to"),
        ("/api/route?from=1,2&to=1,2", "vehicle"),
        ("/api/route?vehicle=AU-SEMI19&from=NaN,2&to=1,2", "from"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2&to=1,91", "to"),
        ("/api/route?vehicle=AU-SEMI19&from=1e999,2&to=1,2", "from"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2&to=1,2&alternatives=99", "alternatives"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2&to=1,2&snap=inf", "snap"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2&to=1,2&snap=-1", "snap"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2&to=1,2&least=money", "least"),
        ("/api/route?vehicle=AU-SEMI19&from=1,2&to=1,2&from=3,4", "from"),
        (
            "/api/route?vehicle=AU-SEMI19&from=1,2&to=1,2&via=1,1&via=1,1&via=1,1&via=1,1&via=1,1&via=1,1&via=1,1&via=1,1&via=1,1",
            "via",
        ),
        ("/api/explain/1", "vehicle"),
        ("/api/explain/1?vehicle=AU-SEMI19&policy=pavement", "policy"),
        ("/api/search", "q"),
        ("/api/search?q=", "q"),
        ("/api/search?q=a&limit=0", "limit"),
        ("/api/search?q=a&limit=1e3", "limit"),
        ("/api/stats?polcy=lane", "polcy"),
        ("/api/vehicles?x=1", "x"),
        ("/tiles/lane/AU-SEMI19/0/0/0.mvt?x=1", "x"),
    ] {
        let problem = server.problem(target, 400);
        assert_eq!(problem["parameter"], parameter, "{target}: {problem}");
        assert!(problem["detail"].as_str().unwrap().contains(parameter), "{target}: {problem}");
    }
}

#[test]
fn what_is_not_there_is_said_with_the_way_out() {
    let server = Server::demo();
    for (target, says) in [
        ("/api/edges/1", "edge 1"),
        ("/api/edges/99999999999999999999", "whole numbers"),
        ("/api/edges/-5", "whole numbers"),
        ("/api/edges/1?vehicle=NONE", "AU-SEMI19"),
        ("/api/explain/1?vehicle=AU-SEMI19", "neither an edge nor a turn"),
        ("/api/explain/1?vehicle=AU-SEMI19&policy=carriageway", "netcert certify"),
        ("/api/vehicles/NONE/drawing.svg", "AU-ATRIPLE53"),
        ("/tiles/lane/AU-SEMI19/17/0/0.mvt", "zoom 0 to 16"),
        ("/tiles/lane/AU-SEMI19/1/2/0.mvt", "less than 2"),
        ("/tiles/lane/AU-SEMI19/1/-1/0.mvt", "tile"),
        ("/tiles/lane/AU-SEMI19/1/0/0.png", ".mvt"),
        ("/tiles/carriageway/AU-SEMI19/1/0/0.mvt", "netcert certify"),
    ] {
        let problem = server.problem(target, 404);
        assert!(problem["detail"].as_str().unwrap().contains(says), "{target}: {problem}");
    }
    let far = server.problem("/api/route?vehicle=AU-SEMI19&from=0,0&to=1,1", 422);
    assert!(far["detail"].as_str().unwrap().contains("road"), "{far}");
    assert_eq!((&far["parameter"], &far["nearest"], &far["beside"]), (&"from".into(), &Value::Null, &Value::Null));
}

#[test]
fn noise_instead_of_http_does_not_disturb_others() {
    let server = Server::demo();
    for noise in [
        &b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..],
        b"\0\0\0\0\r\n\r\n",
        b"GET\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
    ] {
        let reply = server.raw(noise);
        assert!([0, 400, 505].contains(&reply.status), "{noise:?}: {}", reply.status);
    }
    // One that sends half a request and waits holds nobody up.
    let mut half = server.connect();
    half.write_all(b"GET /api/region HTTP/1.1\r\nHost: loc").unwrap();
    assert_eq!(server.get("/healthz").status, 200);
}

#[test]
fn every_response_carries_the_security_headers() {
    let server = Server::demo();
    for target in ["/", "/api/region", "/nothing", "/api/search?q=", "/tiles/lane/AU-SEMI19/0/0/0.mvt"] {
        let reply = server.get(target);
        assert_eq!(reply.header("x-content-type-options"), Some("nosniff"), "{target}");
        assert_eq!(reply.header("referrer-policy"), Some("no-referrer"), "{target}");
        assert_eq!(reply.header("access-control-allow-origin"), None, "{target}");
        let policy = reply.header("content-security-policy").unwrap();
        assert!(policy.starts_with("default-src 'none'") && !policy.contains("http"), "{target}: {policy}");
    }
}

#[test]
fn other_machines_are_let_in_only_when_asked() {
    let place = netcert_testing::program::WorkFolder::with_demo();
    place.netcert("serve --db demo.gpkg --addr 0.0.0.0:0").fails().tells("--allow-remote");
    place.netcert("serve --db nothing.gpkg --addr 127.0.0.1:0").fails().tells("no such database");
    place.netcert("serve --db demo.gpkg --base-map-attribution me").ends_as_misuse();
    place.netcert("serve --db demo.gpkg --addr nowhere").ends_as_misuse();
    let server = Server::over(
        place,
        "serve --db demo.gpkg --addr 127.0.0.1:0 --allow-remote --base-map https://tiles.example.org/{z}/{x}/{y}.png \
         --base-map-attribution <b>©Example</b>",
    );
    let request = b"GET /api/region HTTP/1.1\r\nHost: map.example.org\r\nConnection: close\r\n\r\n";
    let reply = server.raw(request);
    assert_eq!(reply.status, 200);
    assert!(reply.header("content-security-policy").unwrap().contains("connect-src 'self' https://tiles.example.org;"));
    let said = serde_json::json!({
        "url": "https://tiles.example.org/{z}/{x}/{y}.png", "attribution": "<b>©Example</b>",
    });
    assert_eq!(reply.json()["base_map"], said);
}

/// Escapes, line breaks and marks of writing direction arrive in every part of a request.
#[test]
fn a_refused_request_is_one_plain_line_on_standard_error() {
    let server = Server::demo();
    let hostile = "%1b%5B31m%0d%0aforged%20line%c2%9b2J%e2%80%ae";
    let get = |target: &str| format!("GET {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    let requests = [
        (get(&format!("/api/search?q=a&{hostile}=1")), 400),
        (get(&format!("/api/search?{hostile}=1&{hostile}=2")), 400),
        (get(&format!("/api/edges/{hostile}")), 404),
        (get(&format!("/api/edges/1?policy={hostile}")), 400),
        (get(&format!("/api/explain/1?vehicle={hostile}")), 404),
        (get(&format!("/tiles/lane/{hostile}/1/0/0.mvt")), 404),
        (get(&format!("/{hostile}")), 404),
        (get(&format!("/{}", "x".repeat(5000))), 414),
        (get("/api/region").replace("localhost", "evil.example"), 421),
        (get("/api/region").replace("GET", "BREW"), 405),
    ];
    for (request, status) in &requests {
        server.raw(request.as_bytes()).is_problem(request, *status);
    }
    // Bytes that are no characters of an address: refused before it is looked at, or as any other.
    let odd = ["/\u{9b}31m", "/\u{202e}"].map(|target| server.raw(get(target).as_bytes()));
    let odd = odd.iter().filter(|reply| reply.header("content-type") == Some("application/problem+json")).count();
    server.raw(b"GET /\x1b[31m HTTP/1.1\r\nHost: localhost\r\n\r\n");
    assert_eq!(server.get("/healthz").status, 200);
    server.signal("-INT");
    let (_, said) = server.end();
    let plain = |c: char| c == '\n' || c == ' ' || c.is_alphanumeric() || c.is_ascii_punctuation() || "…–©".contains(c);
    assert!(said.chars().all(plain), "{said:?}");
    let refused: Vec<&str> = said.lines().filter(|line| line.contains(": 4")).collect();
    assert_eq!(refused.len(), requests.len() + odd, "{said}");
    for (line, (_, status)) in refused.iter().zip(&requests) {
        assert!(line.contains(&format!(": {status} ")) && line.len() < 1000, "{line}");
    }
    assert!(refused[8].starts_with("GET /api/region: 421 Not for this server: ") && refused[9].starts_with("BREW "));
    // How to end it, and that it has ended.
    assert_eq!(said.lines().count(), refused.len() + 2, "the requests that were answered say nothing: {said}");
}
