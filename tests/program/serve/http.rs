//! A running server, and a small client that makes one request per connection, unless told otherwise.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::Value;

use netcert_testing::program::WorkFolder;

/// Long enough for a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) struct Server {
    child: Child,
    /// The server's standard error. It is read all the time, so that the server never waits for a reader.
    said: Arc<Mutex<String>>,
    listener: Option<JoinHandle<()>>,
    pub(crate) address: SocketAddr,
    pub(crate) place: WorkFolder,
}

#[derive(Debug)]
pub(crate) struct Reply {
    pub(crate) status: u16,
    headers: Vec<(String, String)>,
    pub(crate) body: Vec<u8>,
}

impl Server {
    /// Over the demo region.
    pub(crate) fn demo() -> Self {
        Self::over(WorkFolder::with_demo(), "serve --db demo.gpkg --addr 127.0.0.1:0")
    }

    pub(crate) fn over(place: WorkFolder, line: &str) -> Self {
        let mut child =
            place.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let mut first = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
        let address = first.trim().strip_prefix("http://").and_then(|text| text.strip_suffix('/')).map(str::parse);
        let Some(Ok(address)) = address else {
            let mut error = String::new();
            child.stderr.take().unwrap().read_to_string(&mut error).unwrap();
            panic!("{line}: {first:?}\n{error}");
        };
        let said = Arc::<Mutex<String>>::default();
        let (stderr, heard) = (child.stderr.take().unwrap(), Arc::clone(&said));
        let listener = std::thread::spawn(move || {
            for line in BufReader::new(stderr).split(b'\n').map_while(Result::ok) {
                *heard.lock().unwrap() += &format!("{}\n", String::from_utf8_lossy(&line));
            }
        });
        Self { child, said, listener: Some(listener), address, place }
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// As it is, over one connection.
    pub(crate) fn raw(&self, request: &[u8]) -> Reply {
        let mut stream = self.connect();
        // The server may answer and close before it has read everything.
        let _ = stream.write_all(request);
        Reply::read(&mut BufReader::new(stream))
    }

    pub(crate) fn with(&self, target: &str, headers: &str) -> Reply {
        self.raw(format!("GET {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}\r\n").as_bytes())
    }

    /// A request with a body and its length.
    pub(crate) fn send(&self, method: &str, target: &str, headers: &str, body: &str) -> Reply {
        let length = body.len();
        let head =
            format!("{method} {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: {length}");
        self.raw(format!("{head}\r\n{headers}\r\n{body}").as_bytes())
    }

    pub(crate) fn get(&self, target: &str) -> Reply {
        self.with(target, "")
    }

    /// An answer in JSON.
    pub(crate) fn json(&self, target: &str) -> Value {
        let reply = self.get(target);
        assert_eq!(reply.status, 200, "{target}: {}", reply.text());
        assert_eq!(reply.header("content-type"), Some("application/json"), "{target}");
        reply.json()
    }

    /// A refusal: problem+json of this status.
    pub(crate) fn problem(&self, target: &str, status: u16) -> Value {
        self.get(target).is_problem(target, status)
    }

    pub(crate) fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        assert!(std::process::Command::new("kill").args([name, &id]).status().unwrap().success());
    }

    /// What it has said so far on standard error.
    pub(crate) fn said(&self) -> String {
        self.said.lock().unwrap().clone()
    }

    /// Waits for the server's end. Returns its exit status and its standard error.
    pub(crate) fn end(mut self) -> (ExitStatus, String) {
        let begin = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(begin.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(5));
        };
        self.listener.take().unwrap().join().unwrap();
        (status, self.said())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Reply {
    /// Reads one response; nothing at all is status 0.
    pub(crate) fn read(stream: &mut impl std::io::BufRead) -> Self {
        let mut head = Vec::new();
        loop {
            let mut line = Vec::new();
            if stream.read_until(b'\n', &mut line).unwrap_or(0) == 0 {
                break;
            }
            let line = String::from_utf8(line).unwrap().trim_end().to_owned();
            if line.is_empty() {
                break;
            }
            head.push(line);
        }
        let status = head.first().and_then(|line| line.split(' ').nth(1)).map_or(0, |code| code.parse().unwrap());
        let header = |line: &String| line.split_once(": ").map(|(name, value)| (name.to_lowercase(), value.to_owned()));
        let mut reply = Self { status, headers: head.iter().skip(1).filter_map(header).collect(), body: Vec::new() };
        let length = reply.header("content-length").map(|length| length.parse::<u64>().unwrap());
        match length {
            Some(length) if status != 304 => {
                let _ = stream.take(length).read_to_end(&mut reply.body);
            }
            None if status != 304 => {
                let _ = stream.read_to_end(&mut reply.body);
            }
            _ => {}
        }
        reply
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|header| header.0 == name).map(|header| header.1.as_str())
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    /// A good answer in JSON.
    pub(crate) fn is_json(&self) -> Value {
        assert_eq!((self.status, self.header("content-type")), (200, Some("application/json")), "{}", self.text());
        self.json()
    }

    pub(crate) fn is_problem(&self, what: &str, status: u16) -> Value {
        assert_eq!(self.status, status, "{what}: {}", self.text());
        assert_eq!(self.header("content-type"), Some("application/problem+json"), "{what}");
        let problem = self.json();
        assert_eq!(problem["status"], status, "{what}");
        assert!(problem["type"].as_str().unwrap().starts_with("urn:netcert:problem:"), "{what}");
        assert!(!problem["detail"].as_str().unwrap().is_empty(), "{what}");
        problem
    }
}
