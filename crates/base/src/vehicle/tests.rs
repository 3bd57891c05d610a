//! Tests of the shipped catalogue, and of refusals: wrong files are refused with line, field and bound, and nothing
//! panics.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use proptest::prelude::*;

use super::*;

const SEMI: &str = r#"
[[vehicle]]
id = "semi"
[[vehicle.unit]]
name = "tractor"
coupling_to_axle_m = 3.7
hitch_offset_m = -0.6
front_overhang_m = 1.4
rear_overhang_m = 0.9
[[vehicle.unit]]
name = "trailer"
coupling_to_axle_m = 7.7
front_overhang_m = 1.6
rear_overhang_m = 4.3
"#;

/// The faults of a file, one per line.
fn refused(text: &str) -> String {
    match Catalogue::from_toml(text, "my.toml") {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(e) => e.to_string(),
    }
}

/// Changes `from` to `to` in a valid file and expects `message` in the refusal.
fn check(from: &str, to: &str, message: &str) {
    assert!(SEMI.contains(from), "{from}");
    let said = refused(&SEMI.replacen(from, to, 1));
    assert!(said.contains(message), "{to}: said {said:?}, expected {message:?}");
    assert!(said.starts_with("my.toml: refused"), "{said}");
}

#[test]
fn the_catalogue_has_the_35_combinations_with_their_sources() {
    let catalogue = Catalogue::builtin().unwrap();
    assert_eq!(catalogue.iter().len(), 35);
    for v in catalogue.iter() {
        assert!(v.source.contains("Assumed: ") && v.source.contains("Axle load: "), "{}", v.id);
        assert!(!v.name.is_empty() && v.name != v.id, "{}", v.id);
        assert!(v.height_m.is_some() && v.gross_mass_t.is_some() && v.axle_load_t.is_some(), "{}", v.id);
        assert!(["US", "CA", "AU", "EU", "indoor", "airside"].contains(&v.region.as_str()), "{}", v.id);
    }
    let count = |code| catalogue.region(code).count();
    assert_eq!([count("US"), count("CA"), count("AU"), count("EU")], [9, 5, 9, 10]);
}

#[test]
fn the_catalogue_relies_on_no_default() {
    let text = include_str!("../../../../data/vehicles.toml");
    let vehicles = text.matches("\n[[vehicle]]\n").count();
    let units = text.matches("\n[[vehicle.unit]]\n").count();
    for field in ["length_m", "region", "height_m", "axle_load_t", "tracking_tolerance_m", "min_shrink", "source"] {
        assert_eq!(text.matches(&format!("\n{field} = ")).count(), vehicles, "{field}");
    }
    for field in
        ["hitch_offset_m", "front_overhang_m", "rear_overhang_m", "width_m", "max_articulation_deg", "sway_deg"]
    {
        assert_eq!(text.matches(&format!("\n{field} = ")).count(), units, "{field}");
    }
}

/// What laws and tables state in pounds, feet and inches.
#[test]
fn no_value_is_rounded_up_over_its_law() {
    const POUND_T: f64 = 0.000_453_592_37;
    const FOOT_M: f64 = 0.3048;
    let catalogue = Catalogue::builtin().unwrap();
    let close = |value: f64, law: f64, what: &str| {
        assert!(value <= law + 1e-9 && value > law - 0.05, "{what}: {value} of {law}");
    };
    for (id, pounds, axle_pounds, width_ft, length_ft, height_ft) in [
        ("US-WB40", 80e3, 20e3, 8.0, 45.5, 13.5),
        ("US-WB50", 80e3, 20e3, 8.5, 55.0, 13.5),
        ("US-WB62", 80e3, 20e3, 8.5, 69.0, 13.5),
        ("US-WB67", 80e3, 20e3, 8.5, 73.5, 13.5),
        ("US-WB67D", 80e3, 20e3, 8.5, 72.3, 13.5),
        ("US-WB92D", 129e3, 20e3, 8.5, 97.3, 13.5),
        ("US-WB100T", 115e3, 20e3, 8.5, 104.8, 13.5),
        ("US-WB109D", 147e3, 20e3, 8.5, 114.0, 13.5),
        ("BUS-ART18-AASHTO", 64e3, 24e3, 8.5, 60.0, 11.0),
    ] {
        let v = catalogue.get(id).unwrap();
        close(v.gross_mass_t.unwrap(), pounds * POUND_T, id);
        close(v.axle_load_t.unwrap(), axle_pounds * POUND_T, id);
        close(v.width_m(), width_ft * FOOT_M, id);
        close(v.length_m, length_ft * FOOT_M, id);
        close(v.height_m.unwrap(), height_ft * FOOT_M, id);
    }
    // Laws in metres and kilograms.
    for (region, width_m, height_m, axle_t) in [("CA", 2.6, 4.15, 9.1), ("AU", 2.5, 4.3, 8.25), ("EU", 2.55, 4.0, 11.5)]
    {
        for v in catalogue.region(region) {
            assert!(
                v.width_m() <= width_m && v.height_m.unwrap() <= height_m && v.axle_load_t.unwrap() <= axle_t,
                "{}",
                v.id
            );
        }
    }
    for (id, gross_t, length_m) in [
        ("CA-SEMI23", 46.5, 23.0),
        ("CA-BTRAIN25", 63.5, 25.0),
        ("CA-RMD31", 63.5, 31.0),
        ("CA-TPD41", 63.5, 41.0),
        ("CA-TRIPLE35", 53.5, 35.0),
        ("AU-SEMI19", 42.5, 19.0),
        ("AU-BDOUBLE26", 62.5, 26.0),
        ("AU-ADOUBLE36", 79.0, 36.5),
        ("AU-BTRIPLE36", 82.5, 36.5),
        ("AU-ABTRIPLE44", 99.0, 44.0),
        ("AU-ATRIPLE53", 115.5, 53.5),
        ("EU-SEMI16.5", 40.0, 16.5),
        ("EU-DRAWBAR18.75", 40.0, 18.75),
        ("EU-CAT18.75", 40.0, 18.75),
        ("EU-EMS25-D", 60.0, 25.25),
        ("EU-EMS25-B", 60.0, 25.25),
        ("EU-EMS25-C", 60.0, 25.25),
    ] {
        let v = catalogue.get(id).unwrap();
        assert!(v.gross_mass_t.unwrap() <= gross_t && v.length_m <= length_m, "{id}");
    }
}

#[test]
fn the_type_2_road_train_is_three_trailers_on_two_dollies() {
    let catalogue = Catalogue::builtin().unwrap();
    let train = catalogue.get("AU-ATRIPLE53").unwrap();
    let lengths: Vec<f64> = train.units.iter().map(|u| u.coupling_to_axle_m).collect();
    assert_eq!(lengths, [5.3, 9.5, 5.0, 9.5, 5.0, 9.5]);
    assert_eq!(train.length_m, 53.2);
    assert_eq!(train.gross_mass_t, Some(115.5));
    assert_eq!(train.units[0].max_articulation_rad, 42.0_f64.to_radians());
}

/// AASHTO's minimum turns, as centreline turning radii of the steer axle (metres). The lock must leave what the
/// certificate keeps in reserve: about 6° (3° of heading, 3° of tracking and slip).
#[test]
fn steering_locks_allow_the_published_minimum_turns() {
    let catalogue = Catalogue::builtin().unwrap();
    for (id, radius_m) in [("US-WB40", 10.97), ("US-WB62", 12.50), ("US-WB67D", 12.47), ("US-WB109D", 17.04)] {
        let tractor = &catalogue.get(id).unwrap().units[0];
        let steering = (tractor.coupling_to_axle_m / radius_m).asin();
        assert!(steering.to_degrees() + 6.0 < tractor.max_articulation_rad.to_degrees(), "{id}");
    }
}

#[test]
fn every_vehicle_comes_back_bit_for_bit_through_its_json() {
    for v in Catalogue::builtin().unwrap().iter() {
        let json = v.to_json().unwrap().to_string();
        assert_eq!(&Vehicle::from_json(&json).unwrap(), v);
    }
}

#[test]
fn json_is_in_file_units() {
    let catalogue = Catalogue::builtin().unwrap();
    let json = catalogue.get("EU-SEMI16.5").unwrap().to_json().unwrap();
    assert_eq!(json["unit"][0]["max_articulation_deg"], 42.0);
    assert_eq!(json["unit"][1]["sway_deg"], 0.2);
    assert_eq!(json["tracking_heading_deg"], 3.0);
}

#[test]
fn json_is_checked_like_a_file() {
    let semi = Catalogue::from_toml(SEMI, "my.toml").unwrap();
    let json = semi.get("semi").unwrap().to_json().unwrap().to_string();
    let said = Vehicle::from_json(&json.replace("7.7", "-7.7")).unwrap_err().to_string();
    assert!(said.contains("unit 2 (trailer), coupling_to_axle_m: -7.7 is out of bounds"), "{said}");
}

#[test]
fn what_is_left_out_has_the_documented_default() {
    let catalogue = Catalogue::from_toml(SEMI, "my.toml").unwrap();
    let v = catalogue.get("semi").unwrap();
    assert_eq!((v.name.as_str(), v.region.as_str(), v.height_m, v.axle_load_t), ("semi", "", None, None));
    assert!((v.length_m - 16.5).abs() < 1e-9);
    assert_eq!((v.tracking_tolerance_m, v.min_shrink, v.width_m()), (0.15, 0.3, 2.6));
    assert_eq!(v.tracking_heading_rad, 3.0_f64.to_radians());
    let [tractor, trailer] = v.units.as_slice() else { panic!() };
    assert_eq!(tractor.max_articulation_rad, 42.0_f64.to_radians());
    assert_eq!(trailer.max_articulation_rad, 70.0_f64.to_radians());
    assert_eq!((trailer.hitch_offset_m, trailer.sway_rad), (0.0, 0.2_f64.to_radians()));
}

#[test]
fn wrong_values_are_refused_with_line_field_and_bound() {
    check(
        "= 7.7",
        "= 0",
        "line 12: vehicle \"semi\", unit 2 (trailer), coupling_to_axle_m: 0 is out of bounds: at least 0.05",
    );
    check(
        "= 7.7",
        "= nan",
        "line 12: vehicle \"semi\", unit 2 (trailer), coupling_to_axle_m: NaN is not a finite number",
    );
    check("= 7.7", "= -inf", "-inf is not a finite number");
    check(
        "= -0.6",
        "= -3.7",
        "line 7: vehicle \"semi\", unit 1 (tractor), hitch_offset_m: -3.7 must be more than -3.7",
    );
    check("= -0.6", "= 7.5", "hitch_offset_m: 7.5 must be more than -3.7 and at most 7.4");
    check(
        "= -0.6",
        "= -0.6\nwidth_m = 25.5",
        "line 8: vehicle \"semi\", unit 1 (tractor), width_m: 25.5 is out of bounds: at most 12",
    );
    check("= -0.6", "= -0.6\nmax_articulation_deg = 90", "max_articulation_deg: 90 is out of bounds: at most 85");
    check("= 7.7", "= 7.7\nmax_articulation_deg = 0", "max_articulation_deg: 0 is out of bounds: at least 1");
    check(
        "\"semi\"",
        "\"semi\"\nlength_m = 18.75",
        "line 4: vehicle \"semi\", length_m: 18.75 differs from the units' 16.50 m",
    );
    check("\"semi\"", "\"semi\"\nmin_shrink = 0", "min_shrink: 0 is out of bounds: at least 0.01");
    check("\"semi\"", "\"semi\"\nheight_m = 430", "height_m: 430 is out of bounds: at most 20");
    check("\"semi\"", "\"semi\"\ngross_mass_t = 5\naxle_load_t = 11.5", "11.5 t is more than the gross mass of 5 t");
    check(
        "= 1.6",
        "= 5.0",
        "line 13: vehicle \"semi\", unit 2 (trailer), front_overhang_m: the body reaches 1.90 m past the front coupling",
    );
    check("= 4.3", "= -10.0", "line 14: vehicle \"semi\", unit 2 (trailer), rear_overhang_m: the body is -0.70 m long");
    check("\"semi\"", "\"a/b\"", "line 3: vehicle \"a/b\", id: an id is 1 to 64 of the characters A-Z a-z 0-9 . - _");
    check("\"trailer\"", "\"a\\u0000b\"", "holds a control character");
}

#[test]
fn wrong_files_are_refused_with_the_line() {
    check("= 7.7", "= \"7.7\"", "line 12: invalid type: string \"7.7\", expected f64");
    check("front_overhang_m = 1.6", "front_overhand_m = 1.6", "line 13: unknown field `front_overhand_m`");
    check("coupling_to_axle_m = 7.7", "", "line 10: missing field `coupling_to_axle_m`");
    check("id = \"semi\"", "", "missing field `id`");
    check("= 7.7", "= = 7.7", "line 12: ");
    check("\n[[vehicle]]", "unit = 3\n[[vehicle]]", "unknown field `unit`");
    assert!(refused("").contains("missing field `vehicle`"));
    assert!(refused("vehicle = []").contains("no vehicle in the file"));
    assert!(
        refused("[[vehicle]]\nid = \"x\"\nunit = []")
            .contains("line 3: vehicle \"x\", unit: a vehicle has 1 to 16 units")
    );
}

#[test]
fn an_id_used_twice_is_refused_with_both_lines() {
    let said = refused(&SEMI.repeat(2));
    assert!(said.contains("line 17: vehicle \"semi\", id: the same id is already used on line 3"), "{said}");
}

#[test]
fn a_trailer_that_stands_in_the_body_before_the_dolly_is_refused() {
    let dolly =
        "[[vehicle.unit]]\nname = \"dolly\"\ncoupling_to_axle_m = 1.0\nfront_overhang_m = 0\nrear_overhang_m = 0.5\n";
    let rest =
        SEMI.replace("[[vehicle.unit]]\nname = \"trailer\"", &format!("{dolly}[[vehicle.unit]]\nname = \"trailer\""));
    let said = refused(&rest);
    assert!(
        said.contains("unit 3 (trailer), front_overhang_m: the body reaches 0.60 m past the front coupling"),
        "{said}"
    );
    assert!(said.contains("unit 3 (trailer), front_overhang_m: the body overlaps that of unit 1 by 2.10 m"), "{said}");
}

#[test]
fn all_faults_are_told_at_once() {
    let said = refused(&SEMI.replace("= 7.7", "= -1").replace("= 1.4", "= 99"));
    assert_eq!(said.lines().count(), 4, "{said}");
}

#[test]
fn an_unknown_id_is_answered_with_the_nearest() {
    let catalogue = Catalogue::builtin().unwrap();
    let said = |id| catalogue.get(id).unwrap_err().to_string();
    assert!(said("AU-ATRIPPLE53").contains("did you mean AU-ATRIPLE53"), "{}", said("AU-ATRIPPLE53"));
    assert!(said("wb67").contains("did you mean US-WB67, US-WB67D"), "{}", said("wb67"));
    assert!(said("bdouble").contains("AU-BDOUBLE26"), "{}", said("bdouble"));
    assert!(said("Rocky Mountain").contains("did you mean US-WB92D, CA-RMD31?"), "{}", said("Rocky Mountain"));
    assert!(said("Truck").contains("did you mean EU-SEMI16.5, US-WB67, AU-SEMI19, CA-SEMI23?"), "{}", said("Truck"));
    assert!(!said("zeppelin").contains("did you mean"), "{}", said("zeppelin"));
}

#[test]
fn an_unreadable_file_is_named() {
    let said = Catalogue::from_path(std::path::Path::new("/nowhere/v.toml")).unwrap_err().to_string();
    assert!(said.starts_with("/nowhere/v.toml: cannot read the vehicle file: "), "{said}");
}

#[test]
fn a_users_vehicle_never_takes_a_shipped_id() {
    let shipped = Catalogue::builtin().unwrap();
    let own = |id: &str| Catalogue::from_toml(&SEMI.replace("\"semi\"", &format!("{id:?}")), "my.toml").unwrap();
    assert_eq!(shipped.clone().extended(own("mine"), "my.toml").unwrap().iter().len(), 36);
    let said = shipped.extended(own("US-WB67"), "my.toml").unwrap_err().to_string();
    assert!(said.contains("my.toml: vehicle \"US-WB67\" is already in the catalogue"), "{said}");
}

#[test]
fn a_countrys_combinations_are_those_of_its_regions_and_no_others() {
    let (catalogue, regions) = (Catalogue::builtin().unwrap(), Regions::builtin().unwrap());
    let ids = |code: &[u8; 2]| -> Vec<&str> {
        catalogue.for_country(&regions, *code).into_iter().map(|v| v.id.as_str()).collect()
    };
    assert_eq!(ids(b"CA"), ["CA-SEMI23", "CA-BTRAIN25", "CA-RMD31", "CA-TPD41", "CA-TRIPLE35"]);
    assert_eq!(ids(b"AU").len(), 9);
    assert_eq!(ids(b"AD"), ids(b"DE"));
    assert_eq!(ids(b"DE").len(), 10);
    for (country, region) in [(b"LI", "EU-"), (b"US", "US-"), (b"NZ", "AU-"), (b"CA", "CA-")] {
        let foreign: Vec<&str> = ids(country).into_iter().filter(|id| !id.starts_with(region)).collect();
        assert!(foreign.iter().all(|id| id.starts_with("BUS-")), "{foreign:?}");
    }
    assert_eq!(regions.regions_for(*b"BR"), ["EU"]);
    for region in regions.iter() {
        assert!(catalogue.region(&region.code).next().is_some(), "{}", region.code);
        assert!(region.countries.iter().all(|c| c.bytes().all(|b| b.is_ascii_uppercase())));
    }
}

#[test]
fn no_country_is_in_two_regions() {
    let regions = Regions::builtin().unwrap();
    let mut all: Vec<&String> = regions.iter().flat_map(|r| &r.countries).collect();
    let listed = all.len();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), listed);
}

/// A piece of TOML, valid or not where it is put.
fn scrap() -> impl Strategy<Value = String> {
    prop_oneof![
        prop::sample::select(vec![
            "[[vehicle]]",
            "[[vehicle.unit]]",
            "[vehicle]",
            "unit",
            "id",
            "=",
            "nan",
            "-inf",
            "1e308",
            "-1e-320",
            "\"",
            "'''",
            "{",
            "[",
            "]",
            "\n",
            "width_m = ",
            "= {}",
            "= [[]]",
            "9999999999999999999999",
            "1979-05-27",
            "\u{0}",
            "\u{feff}",
            "é",
        ])
        .prop_map(str::to_owned),
        any::<f64>().prop_map(|x| x.to_string()),
        "\\PC{0,4}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Cuts and insertions anywhere give a catalogue or a refusal. An accepted vehicle keeps the bounds and comes back
    /// from JSON.
    #[test]
    fn a_mutated_file_never_panics(edits in prop::collection::vec((any::<prop::sample::Index>(), 0usize..12, scrap()), 1..5)) {
        let mut chars: Vec<char> = SEMI.chars().collect();
        for (at, cut, text) in edits {
            let start = at.index(chars.len() + 1);
            let end = (start + cut).min(chars.len());
            chars.splice(start..end, text.chars());
        }
        let text: String = chars.into_iter().collect();
        match Catalogue::from_toml(&text, "my.toml") {
            Ok(catalogue) => for v in catalogue.iter() {
                prop_assert!(v.units.iter().all(|u| u.coupling_to_axle_m >= 0.05 && u.width_m > 0.0));
                prop_assert_eq!(&Vehicle::from_json(&v.to_json().unwrap().to_string()).unwrap(), v);
            },
            Err(e) => prop_assert!(e.to_string().starts_with("my.toml: refused")),
        }
    }
}

/// What the page says before its tables: names that people use, and ids of the catalogue.
const HEAD: &str = "\
# Vehicles of the catalogue

`crates/base/src/vehicle/tests.rs` writes this page from [data/vehicles.toml](../data/vehicles.toml) (`NETCERT_WRITE_DOCS=1 cargo test -p netcert-base page_of_vehicles`).
A dimension of the catalogue is one of its kind, not that of your lorry: `netcert vehicles show ID > ours.toml` begins a file of your own.

| people say | where | see |
| --- | --- | --- |
| Sattelzug, articulated lorry, semi-remorque | Europe | EU-SEMI16.5 |
| Gliederzug, drawbar combination | Europe | EU-DRAWBAR18.75, EU-CAT18.75 |
| Lang-Lkw | Germany | EU-EMS25-D, EU-EMS25-B, EU-EMS25-C |
| LZV (langere en zwaardere vrachtautocombinatie) | Netherlands, Belgium | the same |
| modulvogntog, modulvogntåg, 25,25 m | Denmark, Norway, Sweden | the same |
| EMS 2, Duo2, HCT | Sweden, Finland, Denmark, Spain | EU-EMS2-A31.5, EU-EMS2-AB34.5 |
| semi, 18-wheeler | United States | US-WB62, US-WB67 |
| STAA double, twin 28s | United States | US-WB67D |
| longer combination vehicle (LCV): Rocky Mountain double, turnpike double, triple | United States, Canada | US-WB92D, US-WB109D, US-WB100T, CA-RMD31, CA-TPD41, CA-TRIPLE35 |
| B-train | Canada | CA-BTRAIN25 |
| B-double | Australia | AU-BDOUBLE26 |
| A-double | Australia | AU-ADOUBLE30, AU-ADOUBLE36 |
| road train, type 1 and type 2 | Australia | AU-ADOUBLE36, AU-BTRIPLE36, AU-ABTRIPLE44, AU-ATRIPLE53, AU-BABQUAD53, AU-ABBQUAD53 |
| bendy bus, Gelenkbus; double-articulated bus | everywhere | BUS-ART18-EU, BUS-ART18-AASHTO, BUS-BIART24 |
| tugger train | factories, airports | AGV-TUG4 |
";

fn page_of_vehicles(catalogue: &Catalogue) -> String {
    let mut page = HEAD.to_owned();
    let mut regions: Vec<&str> = Vec::new();
    for vehicle in catalogue.iter() {
        if !regions.contains(&vehicle.region.as_str()) {
            regions.push(&vehicle.region);
        }
    }
    let known = |value: Option<f64>| value.map_or("–".to_owned(), |value| value.to_string());
    for region in regions {
        page += &format!("\n## {region}\n\n");
        page += "| id | name | units | length, m | width, m | height, m | mass, t | axle, t | class |\n";
        page += "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
        for v in catalogue.region(region) {
            let class = v.class().map_or("–", |class| class.name.as_str());
            let (height, mass, axle) = (known(v.height_m), known(v.gross_mass_t), known(v.axle_load_t));
            page += &format!(
                "| `{}` | {} | {} | {} | {} | {height} | {mass} | {axle} | {class} |\n",
                v.id,
                v.name,
                v.units.len(),
                v.length_m,
                v.width_m()
            );
        }
        page += "\nWhat is published and where, and what is assumed:\n\n";
        for v in catalogue.region(region) {
            page += &format!("- `{}`: {}\n", v.id, v.source.split_whitespace().collect::<Vec<_>>().join(" "));
        }
    }
    page
}

#[test]
fn the_page_of_vehicles_is_true() {
    let catalogue = Catalogue::builtin().unwrap();
    let page = page_of_vehicles(&catalogue);
    for id in HEAD
        .split(|c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '.'))
        .filter(|word| ["EU-", "US-", "CA-", "AU-", "BUS-", "AGV-"].iter().any(|region| word.starts_with(region)))
    {
        assert!(catalogue.get(id).is_ok(), "the page names {id}");
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/vehicles.md");
    if std::env::var_os("NETCERT_WRITE_DOCS").is_some() {
        std::fs::write(path, &page).unwrap();
    }
    assert!(
        std::fs::read_to_string(path).unwrap_or_default() == page,
        "docs/vehicles.md differs; NETCERT_WRITE_DOCS=1 writes it"
    );
}
