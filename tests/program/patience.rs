//! Long work is bounded and told: it ends as `unknown: took_too_long`, Ctrl-C ends it at once, and a log shows where it is.

use std::io::Read as _;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use netcert_testing::demo::demo;
use netcert_testing::program::WorkFolder;

#[test]
fn work_without_patience_ends_as_unknown_and_is_made_up_for_later() {
    let place = WorkFolder::empty();
    let hasty = place.netcert("ingest {demo} --vehicle AU-SEMI19 --patience 0").succeeds();
    let counted = |what: &str| place.netcert("stats --format json").succeeds().out().matches(what).count();
    assert!(counted("took_too_long") > 0, "{}", hasty.err());
    place.netcert("query --vehicle AU-SEMI19 --turns --verdict unknown").succeeds().shows("took_too_long");
    // It claims nothing, so nothing is refuted.
    place.netcert("verify --db demo.gpkg").succeeds();
    assert_eq!(place.files(), ["demo.gpkg"]);
    let hurried = place.read("demo.gpkg");
    place.netcert("certify --vehicle AU-SEMI19").succeeds();
    let patient = WorkFolder::empty();
    patient.netcert("ingest {demo} --vehicle AU-SEMI19").succeeds();
    let rows = |place: &WorkFolder| {
        let edges = place.rows("AU-SEMI19").into_iter().map(|row| format!("{} {:?}", row.edge.id, row.certificate));
        let turns = place.netcert("query --vehicle AU-SEMI19 --turns --format csv").succeeds().out();
        (edges.collect::<Vec<_>>(), turns)
    };
    assert!(rows(&place) == rows(&patient), "certified again, they are those of a patient run");
    // An update with the same data does what was not done, too.
    let later = WorkFolder::empty().file("demo.gpkg", hurried);
    let extract = demo().display().to_string();
    later.netcert(&format!("update --db demo.gpkg --new-extract {extract}")).succeeds();
    assert!(rows(&later) == rows(&patient), "updated, they are those of a patient run");
}

#[test]
fn a_check_without_patience_confirms_nothing_and_ends() {
    let place = WorkFolder::with_demo();
    let ask = "verify --db demo.gpkg --vehicle AU-SEMI19 --sample 40";
    let hasty = place.netcert(&format!("{ask} --patience 0")).fails();
    let (out, err) = (hasty.out(), hasty.err());
    assert!(out.contains("not confirmed") && out.contains("the check took too long and was ended after 0 s"), "{out}");
    assert!(err.contains("claims are not confirmed") && err.contains("`--patience SECONDS`"), "{err}");
    place.netcert(ask).succeeds();
    // What took too long to certify claims nothing, however long its check takes.
    let bare = WorkFolder::empty();
    bare.netcert("ingest {demo} --vehicle AU-SEMI19 --patience 0").succeeds();
    let hasty = bare.netcert("verify --db demo.gpkg --patience 0").fails().out();
    let claims = bare.netcert("query --vehicle AU-SEMI19 --format csv").succeeds().out();
    let count = |words: &str| claims.lines().filter(|line| line.contains(words)).count();
    let (open, others) = (count("took_too_long"), count(",unknown,") - count("took_too_long"));
    let row = hasty.lines().find(|line| line.contains(" edges ") && line.contains(" unknown ")).unwrap();
    let counts: Vec<usize> = row.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(open > 0 && counts[0] >= open && counts[1] <= others, "{row}: {open} open, {others} others");
    // A certificate file is guarded, too.
    let straight = r#"{"frame": "metres", "points": [[0, 0], [600, 0]], "width_m": 4.0}"#;
    let place = place.file("c.json", straight);
    place.netcert("corridor c.json --vehicle EU-SEMI16.5 --out certificate.json").succeeds();
    let hasty = place.netcert("verify certificate.json --patience 0").fails().out();
    assert!(hasty.contains("the check took too long and was ended"), "{hasty}");
    place.netcert("verify certificate.json").succeeds();
}

#[cfg(unix)]
#[test]
fn ctrl_c_or_a_closed_terminal_ends_every_long_verb_within_a_second_with_a_line() {
    let place = WorkFolder::with_demo();
    // The end of the terminal counts on Linux, unless these tests are run under `nohup`.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).map(|mask| mask.trim().to_owned());
    let counts = ignored.is_some_and(|mask| u64::from_str_radix(&mask, 16).unwrap() & 1 == 0);
    let hangup = if counts { "-HUP" } else { "-INT" };
    for (line, signal) in [
        ("ingest {demo} --db other.gpkg --all-vehicles --threads 1", "-INT"),
        ("certify --vehicle AU-SEMI19 EU-SEMI16.5 AU-BDOUBLE26 --threads 1 --needs all", hangup),
        ("survey --vehicle EU-SEMI16.5 --limit 50 --threads 1", "-INT"),
        ("verify --db demo.gpkg --threads 1", "-INT"),
        ("serve --addr 127.0.0.1:0", hangup),
    ] {
        let mut run = place.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(400));
        let told = Instant::now();
        assert!(Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap().success());
        let code = run.wait().unwrap().code();
        let took = told.elapsed();
        let mut err = String::new();
        run.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        let serves = line.starts_with("serve");
        assert_eq!(code, Some(if serves { 0 } else { 130 }), "{line}: {err}");
        assert!(err.lines().last().is_some_and(|line| line.starts_with("stopped")), "{line}: {err}");
        // A second, and room for a loaded machine.
        assert!(took < Duration::from_secs(4), "{line}: {took:?}");
    }
}

/// `nohup` asks the system to ignore the end of the terminal.
#[cfg(target_os = "linux")]
#[test]
fn a_run_under_nohup_outlives_its_terminal() {
    let place = WorkFolder::with_demo();
    let line = place.command("certify --vehicle AU-SEMI19 EU-SEMI16.5 --corridor carriageway --threads 1");
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" \"$@\""]).arg(line.get_program()).args(line.get_args());
    shell.current_dir(line.get_current_dir().unwrap()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut run = shell.spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    assert!(run.try_wait().unwrap().is_none(), "it was over too soon");
    assert!(Command::new("kill").args(["-HUP", &run.id().to_string()]).status().unwrap().success());
    assert!(run.wait().unwrap().success());
}

#[test]
fn a_log_has_a_line_for_each_stage_and_quiet_runs_have_none() {
    let place = WorkFolder::empty();
    let log = place.netcert("ingest {demo} --vehicle AU-SEMI19").succeeds();
    for stage in ["check", "network", "certificates", "turns", "store"] {
        let of_stage = |line: &str| line.starts_with(stage) && line.ends_with('…');
        assert!(log.err().lines().any(of_stage), "no line of {stage} in\n{}", log.err());
    }
    place.netcert("ingest {demo} --vehicle AU-SEMI19 -q").succeeds().tells_nothing();
}
