//! The counted work of turns: the same whatever the number of threads, and not much more than it was. No test asserts a time.

use netcert_testing::program::WorkFolder;

/// What `ingest --stats` told of the drawn region's turns, for each that was laid out: paths scored, sweeps, distances.
fn work_of(threads: u32) -> [f64; 3] {
    let line = format!("ingest {{demo}} --vehicle AU-SEMI19 --corridor carriageway --threads {threads} --stats");
    let told = WorkFolder::empty().netcert(&line).succeeds().err().to_owned();
    let line = told.lines().find(|line| line.trim_start().starts_with("work: ")).unwrap();
    let before = |unit: &str| {
        let words = line.split_once(unit).unwrap().0.trim_end();
        words.rsplit(' ').next().unwrap().replace(',', "").parse::<f64>().unwrap()
    };
    [before("paths scored"), before("sweeps"), before("distances")]
}

/// Work that doubles is a fault, or a change that a decision must name.
#[test]
fn a_turn_takes_no_more_work_than_it_did() {
    let work = work_of(1);
    assert_eq!(work, work_of(2));
    for (now, (what, known)) in work.into_iter().zip([("scores", 158.7), ("sweeps", 8.4), ("distances", 23_847.0)]) {
        assert!((0.5 * known..1.5 * known).contains(&now), "{what}: {now} for each turn, {known} before");
    }
}
