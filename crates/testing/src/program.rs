//! Runs the built program in a folder of its own: `folder.netcert("query --vehicle X").succeeds().tells("…")`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex, OnceLock};

use netcert::osm::LonLat;
use netcert::osm::facts::Policy;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert::rows::EdgeRow;
use netcert::store::{Database, QueryOptions};
use sqlx::{Connection as _, SqliteConnection};
use tempfile::TempDir;

use crate::demo::demo;

/// A temporary working folder.
pub struct WorkFolder(TempDir);

/// The result of a run.
pub struct ProgramRun {
    line: String,
    output: Output,
}

/// The program that was built for these tests: it lies beside the folder of the test's own program.
fn built() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let path = test.parent().and_then(Path::parent).unwrap().join(format!("netcert{}", std::env::consts::EXE_SUFFIX));
    assert!(path.exists(), "{} is missing: the tests of the program build it", path.display());
    path
}

impl WorkFolder {
    pub fn empty() -> Self {
        Self(TempDir::new().unwrap())
    }

    /// With `demo.gpkg`, in which AU-SEMI19 and AU-ATRIPLE53 are certified. The database is made once.
    pub fn with_demo() -> Self {
        static MADE: OnceLock<Vec<u8>> = OnceLock::new();
        let made = MADE.get_or_init(|| {
            let folder = Self::empty();
            folder.netcert("ingest {demo} --vehicle AU-SEMI19 AU-ATRIPLE53").succeeds();
            folder.read("demo.gpkg")
        });
        Self::empty().file("demo.gpkg", made)
    }

    /// With `demo.gpkg`, in which these vehicles are certified on the whole carriageway, so that some can turn corners.
    /// The database is made once per set of vehicles.
    pub fn with_wide_demo(vehicles: &str) -> Self {
        static MADE: Mutex<BTreeMap<String, Arc<OnceLock<Vec<u8>>>>> = Mutex::new(BTreeMap::new());
        let of_these = Arc::clone(MADE.lock().unwrap().entry(vehicles.to_owned()).or_default());
        let made = of_these.get_or_init(|| {
            let folder = Self::empty();
            let line = format!("ingest {{demo}} --db demo.gpkg --vehicle {vehicles} --corridor carriageway");
            folder.netcert(&line).succeeds();
            folder.read("demo.gpkg")
        });
        Self::empty().file("demo.gpkg", made)
    }

    /// With `demo.gpkg` of the drawn `unknown.osm.pbf`, in which AU-SEMI19 is certified on the whole carriageway: a wide road, and a side
    /// road whose parked cars leave no width, so that its edges and the turns onto and off it are unknown.
    pub fn with_unknown_road() -> Self {
        let at = |id, lon_e7, lat_e7| NodeRecord { id, place: LonLat { lon_e7, lat_e7 }, tags: Vec::new() };
        let nodes = [at(1, 0, 0), at(2, 30_000, 0), at(3, 60_000, 0), at(4, 30_000, 30_000)];
        let way = |id, refs: &[i64], tags: &[(&str, &str)]| {
            let tags = tags.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
            WayRecord { id, refs: refs.to_vec(), tags }
        };
        let parked = [("parking:both", "lane"), ("parking:both:orientation", "perpendicular")];
        let side = [&[("highway", "residential"), ("width", "6")], &parked[..]].concat();
        let ways = [way(1, &[1, 2, 3], &[("highway", "primary"), ("width", "12")]), way(2, &[2, 4], &side)];
        let folder = Self::empty().file("unknown.osm.pbf", write_extract(&nodes, &ways));
        folder.netcert("ingest unknown.osm.pbf --db demo.gpkg --vehicle AU-SEMI19 --corridor carriageway").succeeds();
        folder
    }

    pub fn file(self, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        std::fs::write(self.path(name), bytes).unwrap();
        self
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// `demo.gpkg`
    pub fn database(&self) -> Database {
        Database::open(&self.path("demo.gpkg")).unwrap()
    }

    /// All rows of a vehicle in `demo.gpkg` under the lane policy, by edge.
    pub fn rows(&self, vehicle: &str) -> Vec<EdgeRow> {
        self.database().query(&QueryOptions::new(vehicle, Policy::Lane)).unwrap().map(Result::unwrap).collect()
    }

    /// Changes `demo.gpkg` without netcert. Returns the number of changed rows.
    pub fn sql(&self, statement: &str) -> u64 {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let mut c = SqliteConnection::connect(self.path("demo.gpkg").to_str().unwrap()).await.unwrap();
            let done = sqlx::query(sqlx::AssertSqlSafe(statement.to_owned())).execute(&mut c).await.unwrap();
            c.close().await.unwrap();
            done.rows_affected()
        })
    }

    /// Names of the files in the folder, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Arguments are separated by blanks. `{demo}` stands for the shipped region.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(built());
        command.current_dir(self.0.path()).env_remove("SOURCE_DATE_EPOCH").stdin(Stdio::null());
        command.args(line.split_whitespace().map(|word| if word == "{demo}" { demo() } else { word.into() }));
        command
    }

    pub fn netcert(&self, line: &str) -> ProgramRun {
        ProgramRun { line: line.to_owned(), output: self.command(line).output().unwrap() }
    }
}

impl ProgramRun {
    pub fn of(line: &str, command: &mut Command) -> Self {
        Self { line: line.to_owned(), output: command.output().unwrap() }
    }

    fn status(self, expected: i32) -> Self {
        assert_eq!(self.output.status.code(), Some(expected), "{}\n{}\n{}", self.line, self.out(), self.err());
        self
    }

    pub fn succeeds(self) -> Self {
        self.status(0)
    }

    /// Expects exit status 1 and one error.
    pub fn fails(self) -> Self {
        assert_eq!(self.err().matches("error: ").count(), 1, "{}: {}", self.line, self.err());
        self.status(1)
    }

    /// Expects exit status 2.
    pub fn ends_as_misuse(self) -> Self {
        self.status(2)
    }

    /// Expects `text` on standard output.
    pub fn shows(self, text: &str) -> Self {
        assert!(self.out().contains(text), "{}: no {text:?} in\n{}", self.line, self.out());
        self
    }

    /// Expects `text` on standard error.
    pub fn tells(self, text: &str) -> Self {
        assert!(self.err().contains(text), "{}: no {text:?} in\n{}", self.line, self.err());
        self
    }

    pub fn tells_nothing(self) -> Self {
        assert_eq!(self.err(), "", "{}", self.line);
        self
    }

    pub fn out(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    pub fn err(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out()).unwrap_or_else(|e| panic!("{}: {e}\n{}", self.line, self.out()))
    }
}
