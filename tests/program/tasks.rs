//! Tasks of a region: what other machines certify is what `ingest` certifies, byte for byte.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use netcert::osm::facts::{Countries, Policy};
use netcert::pipeline::{
    Assemble, Divided, EDGES_AT_ONCE, Ingest, NeededTasks, RunError, Selection, Summary, Task, TaskError, TaskJob,
    TaskResult, assemble, divide, ingest,
};
use netcert::reporter::Silent;
use netcert::settings::Settings;
use netcert::stop::Stop;
use netcert::store::{CheckpointStage, Database, QueryOptions};
use netcert::vehicle::Catalogue;
use netcert::verdict::{UnknownReason, Verdict};

const VEHICLES: [&str; 2] = ["AU-SEMI19", "AGV-TUG4"];
/// Each cell by itself. The drawn region lies in four.
const EDGES_OF_A_TASK: u64 = 1;

fn extract() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/demo.osm.pbf")
}

fn now() -> String {
    "2026-01-01T00:00:00.000Z".to_owned()
}

fn settings() -> Settings {
    Settings { policy: Policy::Carriageway, ..Settings::default() }
}

/// The tasks, the job, and what machines make of all of them.
static DONE: LazyLock<(Vec<Task>, Divided, String, Vec<TaskResult>)> = LazyLock::new(|| {
    let ((tasks, divided), job) = (tasks(), job());
    let results = results(&tasks, &job, &[]);
    (tasks, divided, job, results)
});

fn tasks() -> (Vec<Task>, Divided) {
    let mut tasks = Vec::new();
    let countries = Countries::load().unwrap();
    let divided = divide(&extract(), &countries, EDGES_OF_A_TASK, &Silent, |task| {
        tasks.push(task);
        Ok::<(), RunError>(())
    });
    (tasks, divided.unwrap())
}

fn job() -> String {
    let catalogue = Catalogue::builtin().unwrap();
    TaskJob::written(&settings(), &VEHICLES.map(|id| catalogue.get(id).unwrap())).unwrap()
}

/// What machines make of the tasks, except of those that `fails` names.
fn results(tasks: &[Task], job: &str, fails: &[u32]) -> Vec<TaskResult> {
    let job = TaskJob::read(job).unwrap();
    let strokes: Vec<_> = tasks
        .iter()
        .map(|task| (!fails.contains(&task.number)).then(|| job.strokes(&task.bytes, &Stop::never()).unwrap()))
        .collect();
    let mut results = Vec::new();
    for (task, done) in tasks.iter().zip(&strokes) {
        let around = task.needs.iter().chain([&task.number]);
        let verdicts: Vec<&[u8]> =
            around.clone().filter_map(|&need| strokes[need as usize].as_ref()).map(|done| &done.verdicts[..]).collect();
        let needed = if verdicts.len() < around.count() { NeededTasks::SomeFailed } else { NeededTasks::Done };
        let turns = done.as_ref().map(|_| job.turns(&task.bytes, &verdicts, needed, &Stop::never()).unwrap());
        results.push(TaskResult { part: (CheckpointStage::Turns, task.number), work: turns });
    }
    let part = |(task, done): (&Task, Option<netcert::pipeline::StrokesDone>)| TaskResult {
        part: (CheckpointStage::Strokes, task.number),
        work: done.map(|done| done.work),
    };
    results.extend(tasks.iter().zip(strokes).map(part));
    results
}

fn assembled(divided: &Divided, job: &str, results: Vec<TaskResult>, db: &Path) -> Result<Summary, RunError> {
    let ask = Assemble {
        input: &extract(),
        db,
        countries: &Countries::load().unwrap(),
        edges_at_once: EDGES_OF_A_TASK,
        divided,
        job: &TaskJob::read(job).unwrap(),
        parameters: "{}".parse().unwrap(),
        now: &now,
    };
    assemble(&ask, &mut results.into_iter().map(Ok), &Silent)
}

fn ingested(db: &Path) {
    let ask = Ingest {
        inputs: &[&extract()],
        db,
        catalogue: &Catalogue::builtin().unwrap(),
        selection: &Selection::Ids(VEHICLES.map(str::to_owned).to_vec()),
        countries: &Countries::load().unwrap(),
        settings: &settings(),
        edges_at_once: EDGES_AT_ONCE,
        parameters: "{}".parse().unwrap(),
        now: &now,
    };
    ingest(&ask, &Silent).unwrap();
}

#[test]
fn the_results_of_tasks_make_the_database_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    let [one, many] = ["one.gpkg", "many.gpkg"].map(|name| folder.path().join(name));
    let (tasks, divided, job, results) = &*DONE;
    assert_eq!((tasks.len(), divided.tasks), (4, 4));
    assert_eq!(tasks.iter().map(|task| task.edges).sum::<u64>(), u64::from(divided.edges));
    assert!(tasks.iter().all(|task| task.length_km > 0.0 && !task.needs.contains(&task.number)));
    let again = self::tasks().0;
    assert!(tasks.iter().zip(&again).all(|(task, again)| task.bytes == again.bytes));
    assembled(divided, job, results.clone(), &many).unwrap();
    ingested(&one);
    assert!(std::fs::read(&one).unwrap() == std::fs::read(&many).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn roads_of_a_task_that_failed_are_unknown_and_all_others_are_as_ever() {
    let folder = tempfile::tempdir().unwrap();
    let [one, many] = ["one.gpkg", "many.gpkg"].map(|name| folder.path().join(name));
    let (tasks, divided, job, _) = &*DONE;
    let failed = &tasks[2];
    assembled(divided, job, results(tasks, job, &[failed.number]), &many).unwrap();
    ingested(&one);
    for id in VEHICLES {
        let query = QueryOptions::new(id, Policy::Carriageway);
        let rows = |db: &Path| -> Vec<_> {
            Database::open(db).unwrap().query(&query).unwrap().map(|row| row.unwrap()).collect()
        };
        let (whole, some) = (rows(&one), rows(&many));
        let unknown = Verdict::Unknown(UnknownReason::Failed);
        let (lost, kept): (Vec<_>, Vec<_>) =
            whole.iter().zip(&some).partition(|(_, row)| row.certificate.verdict == unknown);
        assert_eq!(lost.len() as u64, failed.edges);
        assert!(kept.iter().all(|(before, after)| before == after));
    }
}

#[test]
fn what_is_missing_foreign_or_damaged_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let db = folder.path().join("region.gpkg");
    let (tasks, divided, text, results) = &*DONE;
    let refused = |divided: &Divided, results: Vec<TaskResult>| {
        let error = assembled(divided, text, results, &db).unwrap_err().to_string();
        assert!(!db.exists());
        error
    };
    let mut lacking = results.clone();
    lacking.retain(|result| result.part != (CheckpointStage::Turns, 3));
    assert!(refused(divided, lacking).contains("the results of task 3 lack"));
    let mut cut = results.clone();
    cut[0].work = cut[0].work.take().map(|work| work[..0].to_vec());
    assert!(refused(divided, cut).contains("the result of task 0 is damaged"));
    let other = Divided { extract_blake3: "0".repeat(64), ..divided.clone() };
    assert!(refused(&other, Vec::new()).contains("another extract"));
    let other = Divided { tasks: 9, ..divided.clone() };
    assert!(refused(&other, Vec::new()).contains("9 tasks were made of it, and now it has 4 parts"));

    let job = TaskJob::read(text).unwrap();
    for cut in [0, 9, tasks[0].bytes.len() / 2] {
        let done = job.strokes(&tasks[0].bytes[..cut], &Stop::never());
        assert!(matches!(done, Err(TaskError::Damaged { what: "task", .. })));
    }
    let own = job.strokes(&tasks[0].bytes, &Stop::never()).unwrap();
    let alone = job.turns(&tasks[0].bytes, &[], NeededTasks::Done, &Stop::never());
    assert!(matches!(alone, Err(TaskError::NoVerdict { task: 0, .. })));
    assert!(job.turns(&tasks[0].bytes, &[&own.verdicts[..1]], NeededTasks::Done, &Stop::never()).is_err());
    let foreign = text.replacen(concat!(env!("CARGO_PKG_VERSION"), "+"), "0.0.9+", 1);
    assert!(matches!(TaskJob::read(&foreign), Err(TaskError::OtherProgram { what: "job", .. })));
    let told = Stop::never();
    told.tell();
    assert!(matches!(job.strokes(&tasks[0].bytes, &told), Err(TaskError::Stopped(_))));
}
