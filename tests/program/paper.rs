//! `netcert paper` as a user meets it.

use netcert_testing::program;

use program::WorkFolder;
use serde_json::Value;

const FILES: [&str; 4] = ["leeway.svg", "rsc.svg", "tubes.json", "tubes.svg"];

fn safe(answer: &Value, which: &str) -> Vec<u64> {
    let rows = answer["scenarios"].as_array().unwrap().iter();
    rows.filter(|row| row[which]["safe"] == true).map(|row| row["scenario"].as_u64().unwrap()).collect()
}

#[test]
fn scenarios_one_three_and_five_are_safe_by_the_table_and_by_algorithm_one() {
    let answer = WorkFolder::empty().netcert("paper --format json").succeeds().tells_nothing().json();
    assert_eq!(answer["route_length_m"], 543.62);
    assert_eq!(safe(&answer, "table"), [1, 3, 5]);
    assert_eq!(safe(&answer, "simulated"), [1, 3, 5]);
    for row in answer["scenarios"].as_array().unwrap() {
        let number = |which: &str, field: &str| row[which][field].as_f64().unwrap();
        assert!(number("netcert_no_tolerances", "rsc_m") > number("table", "rsc_m"), "{row}");
        assert!(number("netcert_usual_tolerances", "rsc_m") < number("netcert_no_tolerances", "rsc_m"));
        // 𝒞 is made of the parts that stand beside it.
        for which in ["table", "simulated", "simulated_beta_as_printed"] {
            let [w, h, r, c] = ["w_min_m", "h_omega_m", "r_n_max_m", "rsc_m"].map(|field| number(which, field));
            assert!((w - (h + r) - c).abs() < 1e-9);
        }
        assert_eq!(number("simulated", "w_min_m"), number("table", "w_min_m"), "the drawn route reaches w_min");
    }
}

#[test]
fn the_table_says_what_is_printed_what_is_computed_and_why_they_differ() {
    let place = WorkFolder::empty();
    place.netcert("paper").succeeds().shows("543.62 m").shows("7.683").shows("Why they differ");
    assert_eq!(place.files(), Vec::<String>::new(), "no figures unless asked for");
    place.netcert("help paper").succeeds().shows("--timing").shows("docs/errata.md");
}

#[test]
fn figures_are_the_same_bytes_every_time() {
    let place = WorkFolder::empty();
    place.netcert("paper --out a/deep/er --format json").succeeds().tells("tubes.svg");
    place.netcert("paper --out b --threads 1 --format json").succeeds();
    for name in FILES {
        let [a, b] = ["a/deep/er", "b"].map(|folder| place.read(&format!("{folder}/{name}")));
        assert!(a == b, "{name}");
        let text = String::from_utf8(a).unwrap();
        if name == "tubes.json" {
            continue;
        }
        assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n") && text.contains("<title>"));
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
    let mut names: Vec<_> = std::fs::read_dir(place.path("b")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, FILES, "run time is drawn only when measured");
}

#[test]
fn run_time_is_measured_on_request() {
    let place = WorkFolder::empty();
    let answer = place.netcert("paper --timing --out . --format json").succeeds().json();
    assert_eq!(answer["timing"]["algorithm_1"]["seconds"].as_array().unwrap().len(), 10);
    assert!(answer["timing"]["algorithm_1"]["slope_s"].as_f64().unwrap() > 0.0);
    assert!(place.files().contains(&"timing.svg".to_owned()));
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let place = WorkFolder::empty().file("taken", "a file");
    place.netcert("paper --out taken").fails().tells("tubes.svg: cannot write it").tells("--out");
}

#[test]
fn tubes_are_functions_of_time() {
    let place = WorkFolder::empty();
    place.netcert("paper --out .").succeeds();
    let file: Value = serde_json::from_slice(&place.read("tubes.json")).unwrap();
    let numbers =
        |value: &Value| -> Vec<f64> { value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect() };
    let tubes = file["tubes"].as_array().unwrap();
    assert_eq!((file["scenario"].as_u64(), tubes.len()), (Some(5), 4));
    for tube in tubes {
        let t = numbers(&tube["t"]);
        assert!(t[0] == 0.0 && t.windows(2).all(|w| w[1] > w[0]) && t.len() == 545);
        // 543.62 m at 80 km/h and less take 24.5 s and more.
        assert!(t[544] > 24.5 && t[544] < 60.0, "{}", t[544]);
        for field in ["centre", "shape", "leeway_m"] {
            assert_eq!(tube[field].as_array().unwrap().len(), t.len());
        }
        for shape in tube["shape"].as_array().unwrap() {
            let [q11, q12, q22] = numbers(shape)[..] else { panic!("three elements") };
            assert!(q11 > 0.0 && q11 * q22 - q12 * q12 > 0.0, "Q is positive definite");
        }
    }
}
