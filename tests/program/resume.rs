//! A killed `ingest` goes on where it stopped, and the database is that of a run that nothing disturbed.

use std::process::Stdio;
use std::time::Duration;

use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::skip::skipped;
use netcert_testing::thorough::cases;

const LINE: &str = "ingest {demo} --vehicle AU-SEMI19 EU-SEMI16.5 --needs off";
/// Runs that are killed.
fn kills() -> u32 {
    cases(16, 100)
}

/// Portion by portion, too. The drawn region lies in four cells.
const IN_PORTIONS: &str = "--edges-at-once 1";
/// The longest run before a kill, milliseconds, by turns: soon after the start, and where several groups of strokes are done.
const LONGEST_MS: [u32; 2] = [300, 2500];

fn command(place: &WorkFolder, line: &str) -> std::process::Command {
    let mut command = place.command(line);
    command.env("SOURCE_DATE_EPOCH", "1700000000");
    command
}

/// The same moments in every run of the test, up to the machine's speed.
fn moments() -> impl Iterator<Item = Duration> {
    let next = |drawn: &u32| Some((u64::from(*drawn) * 48_271 % 0x7fff_ffff) as u32);
    std::iter::successors(Some(77_u32), next)
        .skip(9)
        .zip(LONGEST_MS.iter().cycle())
        .map(|(drawn, longest)| Duration::from_millis(u64::from(drawn % longest)))
}

#[test]
fn killed_at_any_moment_it_ends_with_the_same_bytes() {
    let undisturbed = WorkFolder::empty();
    ProgramRun::of(LINE, &mut command(&undisturbed, LINE)).succeeds();
    let expected = undisturbed.read("demo.gpkg");

    let (mut whole, mut went_on) = (0, 0);
    let mut moments = moments();
    for line in [LINE.to_owned(), format!("{LINE} {IN_PORTIONS}")] {
        let place = WorkFolder::empty();
        for (kill, moment) in (0..kills() / 2).zip(moments.by_ref()) {
            let threads = format!("{line} --threads {}", 1 + kill % 2);
            let mut run = command(&place, &threads).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
            std::thread::sleep(moment);
            run.kill().unwrap();
            if run.wait().unwrap().success() {
                assert!(place.read("demo.gpkg") == expected, "after {kill} kills");
                assert_eq!(place.files(), ["demo.gpkg"]);
                std::fs::remove_file(place.path("demo.gpkg")).unwrap();
                whole += 1;
            } else {
                let done = std::fs::metadata(place.path("demo.gpkg.done")).is_ok_and(|file| file.len() > 1000);
                went_on += u32::from(done);
            }
        }
        let last = ProgramRun::of(&line, &mut command(&place, &line)).succeeds();
        assert!(place.read("demo.gpkg") == expected, "{}", last.err());
        assert_eq!(place.files(), ["demo.gpkg"]);
    }
    assert!(went_on > kills() / 5, "{went_on} of {} runs left finished work; {whole} were whole", kills());
}

#[test]
fn work_of_other_vehicles_or_settings_is_not_taken() {
    let place = WorkFolder::empty();
    let kill = || {
        let mut run = place.command(LINE).stderr(Stdio::null()).spawn().unwrap();
        // A block that is still being written counts for nothing: the file must have stopped growing for a moment.
        let (mut length, mut still) = (0, 0);
        while still < 5 {
            assert!(run.try_wait().unwrap().is_none(), "it was over before it could be killed");
            std::thread::sleep(Duration::from_millis(1));
            let now = std::fs::metadata(place.path("demo.gpkg.done")).map_or(0, |file| file.len());
            still = if now > 1000 && now == length { still + 1 } else { 0 };
            length = now;
        }
        run.kill().unwrap();
        run.wait().unwrap();
    };
    kill();
    for other in ["--vehicle AU-SEMI19 --no-turns", "--vehicle AU-SEMI19 --no-turns --country AU"] {
        place.netcert(&format!("ingest {{demo}} {other}")).succeeds().tells("beginning afresh");
        assert_eq!(place.files(), ["demo.gpkg"]);
        kill();
    }
    place.netcert(LINE).succeeds().tells("going on where it stopped");
    assert_eq!(place.files(), ["demo.gpkg"]);
}

#[cfg(unix)]
#[test]
fn finished_work_outlives_a_full_disk() {
    use std::process::Command;
    let place = WorkFolder::empty();
    let small = place.path("small");
    std::fs::create_dir(&small).unwrap();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=200k", "tmpfs"]).arg(&small).output();
    if !mount.is_ok_and(|out| out.status.success()) {
        return skipped("small file system", "needs the right to mount");
    }
    let line = format!("{LINE} --db small/demo.gpkg");
    let full = std::panic::catch_unwind(|| {
        place.netcert(&line).fails().tells("free some space");
        let resized = Command::new("mount").args(["-o", "remount,size=64m"]).arg(&small).output().unwrap();
        assert!(resized.status.success());
        place.netcert(&line).succeeds();
        std::fs::read_dir(&small).unwrap().map(|entry| entry.unwrap().file_name()).collect::<Vec<_>>()
    });
    assert!(Command::new("umount").arg(&small).output().unwrap().status.success());
    assert_eq!(full.unwrap(), ["demo.gpkg"]);
}
