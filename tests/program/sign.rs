//! Signatures of certificate files and databases: whatever is changed afterwards is refused. OpenSSL judges keys and signatures from
//! outside.

use std::path::Path;
use std::process::Command;

use netcert::seal::sealed;
use netcert::sign::{PublicKey, Refusal, check_document};
use serde_json::{Value, json};

use netcert_testing::program;
use netcert_testing::skip::skipped;

use program::WorkFolder;

const VEHICLE: &str = "AU-ATRIPLE53";
/// Round a corner whose assumed kerb is too sharp: only a route under conditions leads there.
const ROUND_A_CORNER: &str = "--from 126.026942,-30.203315 --to 126.046615,-30.205563";

/// Runs OpenSSL in a place. Without OpenSSL a test says so and skips.
fn openssl(place: &WorkFolder, line: &str) -> Option<std::process::Output> {
    let mut command = Command::new("openssl");
    command.current_dir(place.path("")).args(line.split_whitespace());
    let output = command.output().inspect_err(|e| skipped("openssl", &e.to_string())).ok()?;
    Some(output)
}

/// A place with `route.json`, a route under conditions that is signed with `ours.pem`.
fn signed_route() -> WorkFolder {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    place.netcert(&format!("route --vehicle {VEHICLE} {ROUND_A_CORNER} --out route.json")).succeeds();
    place.netcert("keygen ours.pem").succeeds();
    place.netcert("sign route.json --key ours.pem --name Authority").succeeds();
    place
}

fn document(place: &WorkFolder, name: &str) -> Value {
    let mut document: Value = serde_json::from_slice(&place.read(name)).unwrap();
    document.as_object_mut().unwrap().shift_remove("sha256").unwrap();
    document
}

fn without_conditions(document: &mut Value) {
    assert!(!document["conditions"].as_array().unwrap().is_empty());
    document["conditions"] = json!([]);
    document["verdict"] = json!("safe");
    document["reason"] = Value::Null;
    document["safe"] = json!(true);
}

#[test]
fn conditions_that_are_taken_out_are_refused_with_the_key() {
    let place = signed_route();
    let with_key = "verify route.json --key ours.pub.pem";
    place
        .netcert(with_key)
        .succeeds()
        .shows("signed by Authority on ")
        .shows("confirmed      verdict")
        .shows("only if all of this");

    let mut forged = document(&place, "route.json");
    without_conditions(&mut forged);
    std::fs::write(place.path("changed.json"), sealed(&forged)).unwrap();
    forged.as_object_mut().unwrap().shift_remove("signature").unwrap();
    std::fs::write(place.path("unsigned.json"), sealed(&forged)).unwrap();

    // A seal is no signature: without a key the forged file is a certificate like any other.
    let told = place.netcert("verify unsigned.json").succeeds().out();
    assert!(told.lines().all(|line| line.starts_with("confirmed")), "{told}");
    place.netcert("verify unsigned.json --key ours.pub.pem").fails().tells("it is not signed");
    place.netcert("verify changed.json --key ours.pub.pem").fails().tells("it was changed after it was signed");
    place.netcert("verify changed.json").fails().tells("it was changed after it was signed");
}

#[test]
fn what_is_signed_names_extract_settings_vehicle_and_program() {
    let place = signed_route();
    let document = document(&place, "route.json");
    let origin = &document["origin"];
    let extract = blake3::hash(&std::fs::read(netcert_testing::demo::demo()).unwrap()).to_hex().to_string();
    assert_eq!(origin["input_blake3"], json!(extract));
    assert_eq!(origin["settings"]["corridor"], "carriageway");
    assert!(origin["program"].as_str().unwrap().starts_with(concat!(env!("CARGO_PKG_VERSION"), "+")));
    assert_eq!(document["vehicle"]["id"], VEHICLE);
    let signature = &document["signature"];
    assert_eq!((&signature["algorithm"], &signature["signer"]), (&json!("Ed25519"), &json!("Authority")));
    assert_eq!(signature["program"], origin["program"]);
    assert!(signature["time"].as_str().unwrap().parse::<jiff::Timestamp>().is_ok());
}

/// Changes a value to another one of its type.
fn other(value: &Value) -> Value {
    match value {
        Value::Null => json!(0),
        Value::Bool(truth) => json!(!truth),
        Value::Number(number) => json!(number.as_f64().unwrap() + 1.0),
        Value::String(text) => json!(format!("{text}0")),
        Value::Array(list) => json!([&list[..], &[Value::Null]].concat()),
        Value::Object(members) => {
            let mut members = members.clone();
            members.insert("more".to_owned(), json!(1));
            Value::Object(members)
        }
    }
}

#[test]
fn every_member_changed_or_removed_is_refused() {
    let place = signed_route();
    let key = PublicKey::read(&place.path("ours.pub.pem")).unwrap();
    let document = document(&place, "route.json");
    check_document(&sealed(&document), &[key]).expect("writing the document again changes nothing");
    let mut tried = 0;
    let mut refused = |what: &str, changed: &Value| {
        tried += 1;
        assert!(check_document(&sealed(changed), &[key]).is_err(), "{what}");
    };
    for path in ["", "/signature", "/vehicle", "/origin", "/conditions/0", "/corridor", "/corridor/stations/3"] {
        for name in document.pointer(path).unwrap().as_object().unwrap().keys() {
            let mut changed = document.clone();
            let member = &mut changed.pointer_mut(path).unwrap()[name.as_str()];
            *member = other(member);
            refused(&format!("{path}/{name} changed"), &changed);
            let mut gone = document.clone();
            gone.pointer_mut(path).unwrap().as_object_mut().unwrap().shift_remove(name).unwrap();
            refused(&format!("{path}/{name} gone"), &gone);
        }
    }
    let mut more = document.clone();
    more["more"] = json!(1);
    refused("a member more", &more);
    assert!(tried > 100, "{tried}");

    // Bytes between the members count as well.
    let text = String::from_utf8(place.read("route.json")).unwrap();
    let spaced = text.replacen("\"verdict\":", "\"verdict\": ", 1);
    assert!(matches!(check_document(&spaced, &[key]), Err(Refusal::Changed { .. })));
    // Nor does a signature in another form pass for none.
    let hidden = text.replacen("\"signature\":{", "\"signature\": {", 1);
    assert!(matches!(check_document(&hidden, &[]), Err(Refusal::Unreadable(_))));
}

#[test]
fn a_signature_is_of_one_of_the_given_keys() {
    let place =
        WorkFolder::empty().file("c.json", r#"{"frame": "metres", "points": [[0, 0], [60, 0]], "width_m": 4.0}"#);
    place.netcert("corridor c.json --vehicle AU-SEMI19 --out o.json").succeeds();
    let fingerprint = place.netcert("keygen ours.pem").succeeds().out();
    place.netcert("keygen theirs.pem --public theirs.pub").succeeds();
    place.netcert("verify o.json --key ours.pub.pem").fails().tells("it is not signed");

    place.netcert("sign o.json --key ours.pem").succeeds().tells(fingerprint.trim());
    place.netcert("verify o.json").succeeds().shows(fingerprint.trim()).shows("was not checked");
    let checked = place.netcert("verify o.json --key ours.pub.pem").succeeds();
    assert!(!checked.out().contains("was not checked"), "{}", checked.out());
    place.netcert("verify o.json --key theirs.pub").fails().tells("signed with another key").tells(fingerprint.trim());
    place.netcert("verify o.json --key theirs.pub --key ours.pub.pem").succeeds();

    place.netcert("sign o.json --key theirs.pem").fails().tells("it is signed already").tells("--replace");
    place.netcert("sign o.json --key theirs.pem --replace").succeeds();
    place.netcert("verify o.json --key theirs.pub").succeeds();
    place.netcert("verify o.json --key ours.pub.pem").fails();

    let mut refuted = document(&place, "o.json");
    refuted.as_object_mut().unwrap().shift_remove("signature");
    refuted["rsc_m"] = json!(refuted["rsc_m"].as_f64().unwrap() + 0.1);
    let place = place.file("refuted.json", sealed(&refuted));
    place.netcert("sign refuted.json --key ours.pem").fails().tells("not every claim is confirmed");
    assert_eq!(document(&place, "refuted.json"), refuted, "the file is as it was");
}

#[test]
fn the_same_input_is_signed_with_the_same_bytes() {
    let place =
        WorkFolder::empty().file("c.json", r#"{"frame": "metres", "points": [[0, 0], [60, 0]], "width_m": 4.0}"#);
    place.netcert("corridor c.json --vehicle AU-SEMI19 --out o.json").succeeds();
    place.netcert("keygen ours.pem").succeeds();
    let unsigned = place.read("o.json");
    let at = |seconds: &str| {
        std::fs::write(place.path("o.json"), &unsigned).unwrap();
        program::ProgramRun::of("sign", place.command("sign o.json --key ours.pem").env("SOURCE_DATE_EPOCH", seconds))
            .succeeds();
        place.read("o.json")
    };
    let first = at("1800000000");
    assert_eq!(first, at("1800000000"));
    assert_ne!(first, at("1800000001"));
    place.netcert("verify o.json").succeeds().shows("2027-01-15T08:00:01");
}

#[test]
fn openssl_makes_keys_and_confirms_signatures() {
    let place =
        WorkFolder::empty().file("c.json", r#"{"frame": "metres", "points": [[0, 0], [60, 0]], "width_m": 4.0}"#);
    place.netcert("corridor c.json --vehicle AU-SEMI19 --out o.json").succeeds();
    let Some(made) = openssl(&place, "genpkey -algorithm ed25519 -out theirs.pem") else { return };
    assert!(made.status.success(), "{made:?}");
    assert!(openssl(&place, "pkey -in theirs.pem -pubout -out theirs.pub.pem").unwrap().status.success());
    place.netcert("keygen ours.pem").succeeds();
    for key in ["theirs", "ours"] {
        place.netcert(&format!("sign o.json --key {key}.pem --replace")).succeeds();
        place.netcert(&format!("verify o.json --key {key}.pub.pem")).succeeds();
        let text = String::from_utf8(place.read("o.json")).unwrap();
        let (bytes, tail) = text.rsplit_once(",\"value\":\"").unwrap();
        let value: Vec<u8> = (0..64).map(|k| u8::from_str_radix(&tail[2 * k..2 * k + 2], 16).unwrap()).collect();
        std::fs::write(place.path("signature.bin"), value).unwrap();
        let verify =
            format!("pkeyutl -verify -rawin -pubin -inkey {key}.pub.pem -in signed.bin -sigfile signature.bin");
        std::fs::write(place.path("signed.bin"), bytes).unwrap();
        let said = openssl(&place, &verify).unwrap();
        assert!(said.status.success(), "{key}: {said:?}");
        std::fs::write(place.path("signed.bin"), format!("{bytes} ")).unwrap();
        assert!(!openssl(&place, &verify).unwrap().status.success(), "{key}: OpenSSL confirms anything");
        // OpenSSL finds the same public key in the private one.
        let public = openssl(&place, &format!("pkey -in {key}.pem -pubout")).unwrap().stdout;
        assert_eq!(public, place.read(&format!("{key}.pub.pem")), "{key}");
    }
}

#[test]
fn key_files_that_do_not_serve_are_named_with_the_way_out() {
    let place =
        WorkFolder::empty().file("c.json", r#"{"frame": "metres", "points": [[0, 0], [60, 0]], "width_m": 4.0}"#);
    place.netcert("corridor c.json --vehicle AU-SEMI19 --out o.json").succeeds();
    place.netcert("keygen ours.pem").succeeds();
    let place = place.file("empty.pem", "").file("text.pem", "no key\n").file("long.pem", vec![b'x'; 100_000]);
    let sign = |key: &str| place.netcert(&format!("sign o.json --key {key}")).fails().tells(&format!("error: {key}: "));
    let verify =
        |key: &str| place.netcert(&format!("verify o.json --key {key}")).fails().tells(&format!("error: {key}: "));
    for key in ["empty.pem", "text.pem"] {
        sign(key).tells("`netcert keygen`");
    }
    verify("empty.pem").tells("empty");
    verify("text.pem").tells("ask the signer");
    verify("long.pem").tells("too long");
    sign("missing.pem").tells("cannot read the key");
    verify("missing.pem").tells("cannot read the key");
    sign("ours.pub.pem").tells("a public key");
    verify("ours.pem").tells("a private key").tells("openssl pkey -in ours.pem -pubout");
    let damaged = String::from_utf8(place.read("ours.pem")).unwrap().replace("MC4", "MC5");
    std::fs::write(place.path("damaged.pem"), damaged).unwrap();
    sign("damaged.pem").tells("not an Ed25519 key");

    let before = place.read("ours.pem");
    place.netcert("keygen ours.pem").fails().tells("never overwritten");
    assert_eq!(place.read("ours.pem"), before);
    place.netcert("keygen new.pem --public ours.pub.pem").fails().tells("never overwritten");
    assert!(!place.path("new.pem").exists(), "a private key without its public one");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        assert_eq!(std::fs::metadata(place.path("ours.pem")).unwrap().permissions().mode() & 0o777, 0o600);
    }

    if openssl(&place, "genpkey -algorithm RSA -out rsa.pem").is_none() {
        return;
    }
    assert!(openssl(&place, "pkey -in rsa.pem -pubout -out rsa.pub.pem").unwrap().status.success());
    sign("rsa.pem").tells("not an Ed25519 key");
    verify("rsa.pub.pem").tells("not an Ed25519 key");
    assert!(openssl(&place, "pkey -in ours.pem -aes256 -passout pass:x -out secret.pem").unwrap().status.success());
    sign("secret.pem").tells("passphrase").tells("openssl pkey -in secret.pem");
}

#[test]
fn a_database_that_is_changed_after_it_was_signed_is_refused() {
    let place = WorkFolder::with_demo();
    let fingerprint = place.netcert("keygen ours.pem").succeeds().out();
    place.netcert("keygen theirs.pem").succeeds();
    let verify = "verify --db demo.gpkg --vehicle AU-SEMI19 --sample 5";
    let with_key = format!("{verify} --key ours.pub.pem");
    assert!(!place.netcert(verify).succeeds().out().contains("signed"));
    place.netcert(&with_key).fails().tells("it is not signed");
    place.netcert("sign --db demo.gpkg --key ours.pem --name Authority").succeeds().tells(fingerprint.trim());
    place.netcert(&with_key).succeeds().shows("signed by Authority on ").shows(fingerprint.trim());
    place.netcert(verify).succeeds().shows("was not checked");
    place.netcert(&format!("{verify} --key theirs.pub.pem")).fails().tells("signed with another key");
    place.sql("VACUUM");
    place.netcert(&with_key).succeeds();

    // A second signer beside the first, and one that signs again.
    place.netcert("sign --db demo.gpkg --key theirs.pem").succeeds();
    place.netcert("sign --db demo.gpkg --key ours.pem").succeeds();
    place.netcert(&with_key).succeeds();
    place.netcert(&format!("{verify} --key theirs.pub.pem")).succeeds();
    place.netcert(verify).succeeds().shows(fingerprint.trim());

    let signed = place.read("demo.gpkg");
    for (sql, table) in changes() {
        let place = WorkFolder::empty().file("demo.gpkg", &signed).file("ours.pub.pem", place.read("ours.pub.pem"));
        for trigger in ["insert", "update1", "update2", "update3", "update4", "delete"] {
            if sql.contains(" edge ") {
                place.sql(&format!("DROP TRIGGER rtree_edge_geom_{trigger}"));
            }
        }
        let before = place.read("demo.gpkg");
        place.sql(&format!("PRAGMA foreign_keys = OFF; {sql}"));
        assert_ne!(before, place.read("demo.gpkg"), "{sql}: nothing to change");
        place.netcert(&with_key).fails().tells("refused").tells(&table);
        place.netcert(verify).fails().tells("refused");
    }
}

/// Changes of a signed database: the statement, and what the refusal names.
fn changes() -> Vec<(String, String)> {
    let deleted = [
        ("certificate_compact", "fid = 7"),
        ("turn_certificate_compact", "true"),
        ("plan", "true"),
        ("edge", "fid = 9"),
        ("section", "section_no = 1"),
        ("vehicle", "vehicle_no = 2"),
        ("run", "run_id = 1"),
        ("account", "account_no = 1"),
        ("stroke", "stroke_no = 1"),
        ("certified_set", "vehicle_no = 2"),
        ("network_settings", "true"),
        ("gpkg_contents", "table_name = 'edge'"),
        ("rtree_edge_geom_node", "nodeno = 1"),
    ];
    let changed = [
        ("certificate_compact", "UPDATE certificate_compact SET rsc_mm = rsc_mm - 1 WHERE rsc_mm > 1 AND fid < 9"),
        ("edge", "UPDATE edge SET name = 'Elsewhere' WHERE fid = 9"),
        ("certified_set", "UPDATE certified_set SET settings = json_set(settings, '$.map_tolerance_m', 0.4)"),
        ("network_settings", "UPDATE network_settings SET settings = json_set(settings, '$.map_tolerance_m', 0.4)"),
        ("vehicle", "UPDATE vehicle SET definition = definition || ' '"),
        ("run", "UPDATE run SET input_blake3 = input_blake3 || '0'"),
        ("narrowing", "INSERT INTO narrowing VALUES (999999, 0, 3.0)"),
        (
            "evidence",
            "INSERT INTO evidence (file, file_row, quantity, value, sigma, direction, source, state) \
             VALUES ('f', 1, 'lane_width', 9.0, 0.0, 'both', 'me', 'unmatched')",
        ),
        ("_sqlx_migrations", "UPDATE _sqlx_migrations SET description = 'x' WHERE version = 14"),
        ("more", "CREATE TABLE more (a)"),
        ("sqlite_schema", "DROP VIEW permit"),
        ("signature", "UPDATE signature SET statement = replace(statement, 'Ed25519', 'Ed25518')"),
        (
            "the signature itself",
            "UPDATE signature SET statement = replace(statement, '\"signer\":null', '\"signer\":\"Mallory\"')",
        ),
    ];
    let deleted = deleted.map(|(table, rows)| (format!("DELETE FROM {table} WHERE {rows}"), table.to_owned()));
    deleted.into_iter().chain(changed.map(|(table, sql)| (sql.to_owned(), table.to_owned()))).collect()
}

#[test]
fn what_netcert_changes_itself_makes_a_signature_invalid() {
    let place = WorkFolder::with_demo();
    place.netcert("keygen ours.pem").succeeds();
    place.netcert("sign --db demo.gpkg --key ours.pem").succeeds();
    let verify = "verify --db demo.gpkg --vehicle AU-SEMI19 --sample 5 --key ours.pub.pem";
    place.netcert("query --vehicle AU-SEMI19").succeeds();
    place.netcert(verify).succeeds();
    place.netcert("certify --vehicle EU-SEMI16.5").succeeds();
    place.netcert(verify).fails().tells("it was changed after it was signed").tells("certified_set");
    place.netcert("sign --db demo.gpkg --key ours.pem").succeeds();
    place.netcert(verify).succeeds();
}

/// The commands of `docs/how-to/sign.md`, as they stand on the page.
#[test]
fn the_commands_of_the_page_work() {
    let page = include_str!("../../docs/how-to/sign.md");
    for program in ["openssl", "sqlite3", "basenc", "python3"] {
        if Command::new(program).arg("--version").output().is_err() {
            return skipped(program, "a command of the page");
        }
    }
    let place = WorkFolder::empty();
    std::fs::create_dir(place.path("data")).unwrap();
    std::fs::copy(netcert_testing::demo::demo(), place.path("data/demo.osm.pbf")).unwrap();
    let netcert = Path::new(env!("CARGO_BIN_EXE_netcert")).parent().unwrap().to_owned();
    let others = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(netcert).chain(std::env::split_paths(&others)));
    let commands: Vec<&str> = page.split("```sh\n").skip(1).map(|block| block.split("```").next().unwrap()).collect();
    let script = format!("set -euo pipefail\n{}", commands.concat());
    let mut bash = Command::new("bash");
    bash.arg("-c").arg(&script).current_dir(place.path("")).env("PATH", path.unwrap());
    let answer = program::ProgramRun::of("docs/how-to/sign.md", &mut bash).succeeds();
    assert_eq!(answer.out().matches("Signature Verified Successfully").count(), 2, "{}", answer.out());
    answer.shows("signed by Road Authority X on ").shows("every table is as it was signed");
}
