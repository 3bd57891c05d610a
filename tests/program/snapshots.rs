//! What people read, whole: help, `query`, `explain`, `route` and `stats` of the shipped region. A change of a word is seen in a review
//! of the files in `snapshots/`. `cargo insta review`, or `INSTA_UPDATE=always` in the environment of the test, writes them anew.

use netcert_testing::program::WorkFolder;

/// The answers of a group: each with its command, and what goes to standard error behind a line.
fn written(name: &str, lines: &[&str]) {
    let place = WorkFolder::with_wide_demo("AU-SEMI19 AU-ATRIPLE53");
    let told: Vec<String> = lines
        .iter()
        .map(|line| {
            let answer = place.netcert(line);
            let err = answer.err();
            let err = if err.is_empty() { String::new() } else { format!("--- on standard error\n{err}") };
            format!("$ netcert {line}\n{}{err}", answer.out())
        })
        .collect();
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.set_prepend_module_to_snapshot(false);
    for (what, is) in [(r"\d{4}-\d\d-\d\dT[0-9:.]+Z", "[time]"), (r"netcert \d+\.\d+\.\d+[^\s]*", "netcert [version]")]
    {
        settings.add_filter(what, is);
    }
    settings.bind(|| insta::assert_snapshot!(name, told.join("\n")));
}

#[test]
fn help_is_as_it_was_reviewed() {
    written("help", &["--help", "explain --help", "query --help", "route --help", "verify --help"]);
}

#[test]
fn lists_and_sums_are_as_they_were_reviewed() {
    written(
        "lists",
        &[
            "query --vehicle AU-ATRIPLE53 --verdict unsafe",
            "query --vehicle AU-ATRIPLE53 --turns --verdict safe",
            "query --vehicle AU-SEMI19 --verdict forbidden --relative-to AU-ATRIPLE53",
            "stats",
        ],
    );
}

#[test]
fn explanations_are_as_they_were_reviewed() {
    // A ramp that is too narrow, a motorway with room, a bridge with a limit, a corner of an estate.
    written(
        "explain",
        &[
            "explain --vehicle AU-ATRIPLE53 2593595137710578249",
            "explain --vehicle AU-ATRIPLE53 749698595110693023",
            "explain --vehicle AU-ATRIPLE53 7608755928392790659",
            "explain --vehicle AU-ATRIPLE53 3941920408532081999",
            "explain --vehicle AU-ATRIPLE53 Quandong",
        ],
    );
}

#[test]
fn routes_are_as_they_were_reviewed() {
    // A semi-trailer's certified way, the road train's way under a condition, and the way without the search for one.
    written(
        "route",
        &[
            "route --vehicle AU-SEMI19 --from 126.026942,-30.203315 --to 126.046615,-30.205563",
            "route --vehicle AU-ATRIPLE53 --from 126.026942,-30.203315 --to 126.046615,-30.205563",
            "route --vehicle AU-ATRIPLE53 --from 120,-30 --to 126.046615,-30.205563",
        ],
    );
}
