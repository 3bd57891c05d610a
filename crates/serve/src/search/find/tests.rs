//! The search over drawn names.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::osm::BackdropShape;
use crate::osm::facts::BackdropKind;
use crate::rows::{Bounds, MapBackdrop};

const NAMES: &[&str] = &[
    "Northwest Cornell Road",
    "Southwest 5th Avenue",
    "Sixth Street",
    "West Burnside Street",
    "Burnside Court",
    "Saint Helens Road",
    "Main Street",
    "Old Main Street",
    "Main Street Extension",
    "Domain Road",
    "Hauptstraße",
    "Goethe Straße",
    "Römerstraße",
    "Willy-Brandt-Platz",
    "Avinguda de la Mare de Déu",
    "Łódzka",
    "Carrer de l'Estany",
];
const REFS: &[&str] = &["I 5", "A 5", "A 5a", "US 30", "L 551"];

/// A road at a longitude on the equator.
fn road(number: u32, text: &str, by_ref: bool, lon: f64) -> WholeRoad {
    WholeRoad {
        text: text.into(),
        by_ref,
        ways: Box::new([number]),
        bounds: Bounds { west: lon, south: 0.0, east: lon, north: 0.0 },
        pieces: 1,
        length_m: 100.0 - number as f32,
    }
}

fn name_of<'f>(hit: &Found<'f>) -> &'f str {
    match hit.subject {
        Subject::Road { road, .. } => &road.text,
        Subject::Settlement(place) => &place.name,
    }
}

fn finder() -> Finder {
    let road = |number, text, by_ref| road(number, text, by_ref, 0.0);
    let named = |road| IndexedRoad { road, refs: Vec::new(), places: Vec::new() };
    let names = (0..).zip(NAMES).map(|(number, text)| named(road(number, text, false)));
    let refs = (50..).zip(REFS).map(|(number, text)| named(road(number, text, true)));
    let of_refs = vec!["i5".to_owned(), "ca12".to_owned()];
    let other = IndexedRoad { refs: of_refs, ..named(road(99, "Pacific Highway", false)) };
    Finder::of(names.chain(refs).chain([other]), Settlements::default()).unwrap()
}

#[test]
fn roads_are_found_as_people_type_them() {
    let finder = finder();
    for (typed, text, rank) in [
        ("NW Cornell Rd", "Northwest Cornell Road", MatchRank::Exact),
        ("nw cornell", "Northwest Cornell Road", MatchRank::Prefix),
        ("north west cornell", "Northwest Cornell Road", MatchRank::Within),
        ("cornell", "Northwest Cornell Road", MatchRank::Words),
        ("SW 5th Ave", "Southwest 5th Avenue", MatchRank::Exact),
        ("Southwest Fifth", "Southwest 5th Avenue", MatchRank::Prefix),
        ("6th st", "Sixth Street", MatchRank::Exact),
        ("burnsde", "West Burnside Street", MatchRank::Slips(2)),
        ("St. Helens", "Saint Helens Road", MatchRank::Prefix),
        ("hauptstr 12", "Hauptstraße", MatchRank::Without(1)),
        ("Hauptstr. 12a, Heidelberg", "Hauptstraße", MatchRank::Without(2)),
        ("E 5th Ave", "Southwest 5th Avenue", MatchRank::Without(1)),
        ("OH 30", "US 30", MatchRank::Without(1)),
        ("US Highway 30", "US 30", MatchRank::Exact),
        ("CA 12 Pacific", "Pacific Highway", MatchRank::Words),
        ("pacific hwy 12", "Pacific Highway", MatchRank::Without(1)),
        ("haupstrasse", "Hauptstraße", MatchRank::Slips(2)),
        ("HAUPTSTRASSE", "Hauptstraße", MatchRank::Exact),
        ("goethestr", "Goethe Straße", MatchRank::Prefix),
        ("roemerstrasse", "Römerstraße", MatchRank::Slips(2)),
        ("willy brandt pl", "Willy-Brandt-Platz", MatchRank::Exact),
        ("avda mare de deu", "Avinguda de la Mare de Déu", MatchRank::Words),
        ("lodzka", "Łódzka", MatchRank::Exact),
        ("lestany", "Carrer de l'Estany", MatchRank::Words),
        ("I-5", "I 5", MatchRank::Exact),
        ("Interstate 5", "I 5", MatchRank::Exact),
        ("a5", "A 5", MatchRank::Exact),
        ("Autobahn 5", "A 5", MatchRank::Exact),
        ("l551", "L 551", MatchRank::Exact),
    ] {
        let found = finder.find(typed);
        let first = found.first().map(|hit| (name_of(hit), hit.rank));
        assert_eq!(first, Some((text, rank)), "{typed}");
    }
    for nothing in ["no such road", "xyzzy", "street 12 zzz", "12", "", "…"] {
        assert!(finder.find(nothing).is_empty(), "{nothing}: {:?}", finder.find(nothing));
    }
}

#[test]
fn the_whole_name_is_before_its_beginning_its_words_and_parts_of_words() {
    let finder = finder();
    let found = finder.find("main street");
    let texts: Vec<&str> = found.iter().map(|hit| name_of(hit)).collect();
    assert_eq!(texts, ["Main Street", "Main Street Extension", "Old Main Street"]);
    let found = finder.find("main");
    let ranks: Vec<(&str, MatchRank)> = found.iter().map(|hit| (name_of(hit), hit.rank)).collect();
    assert_eq!(ranks.last(), Some(&("Domain Road", MatchRank::Within)));
    // The ref itself is before the roads that carry it, and these before others of similar refs.
    let of_ref: Vec<&str> = finder.find("i5").iter().map(|hit| name_of(hit)).collect();
    assert_eq!(of_ref, ["I 5", "Pacific Highway"]);
    assert_eq!(finder.find("a5").len(), 2);
}

#[test]
fn places_are_found_and_their_names_tell_roads_apart() {
    let place = |number, kind, name: &str, lon_e7| {
        let shape = BackdropShape::Place(LonLat { lon_e7, lat_e7: 0 });
        MapBackdrop { number, kind, name: Some(name.to_owned()), shape }
    };
    let places = Settlements::of(vec![
        place(1, BackdropKind::Village, "Unterdorf", 0),
        place(2, BackdropKind::Town, "Sankt Anton", 1_000_000),
        place(3, BackdropKind::Hamlet, "Dorf", 2_000_000),
    ]);
    let of = |number, text, e7: &[i32]| {
        let places = e7.iter().map(|&lon_e7| LonLat { lon_e7, lat_e7: 0 }).collect();
        IndexedRoad { road: road(number, text, false, 0.0), refs: Vec::new(), places }
    };
    let roads = [
        of(1, "Dorfstraße", &[0]),
        of(2, "Dorfstraße", &[1_000_000]),
        of(3, "Dorf", &[5_000_000]),
        of(4, "Kirchweg", &[1_000_000]),
        of(5, "Landstraße", &[0, 500_000, 1_000_000]),
        of(6, "Antonsweg", &[1_000_000]),
    ];
    let finder = Finder::of(roads.into_iter(), places).unwrap();
    let found = |typed: &str| -> Vec<(String, u32)> {
        let number = |hit: &Found<'_>| match hit.subject {
            Subject::Road { road, .. } => road.ways[0],
            Subject::Settlement(_) => 0,
        };
        finder.find(typed).iter().map(|hit| (name_of(hit).to_owned(), number(hit))).collect()
    };
    let of = |all: &[(&str, u32)]| all.iter().map(|(text, number)| ((*text).to_owned(), *number)).collect::<Vec<_>>();
    assert_eq!(found("sankt anton"), of(&[("Sankt Anton", 0)]), "its roads are not found by its name alone");
    assert_eq!(found("St. Anton"), of(&[("Sankt Anton", 0)]));
    assert_eq!(found("dorfstr sankt anton"), of(&[("Dorfstraße", 2)]));
    assert_eq!(found("Dorfstrasse Unterdorf")[0], ("Dorfstraße".to_owned(), 1));
    assert_eq!(found("dorf")[..2], of(&[("Dorf", 0), ("Dorf", 3)]), "a place is before a road of the same name");
    assert_eq!(found("kirchweg, sankt anton"), of(&[("Kirchweg", 4)]));
    for town in ["Unterdorf", "Sankt Anton"] {
        assert_eq!(found(&format!("Landstr. {town}")), of(&[("Landstraße", 5)]), "a road lies in several places");
    }
    assert_eq!(found("Nordstr. Unterdorf"), of(&[("Unterdorf", 0)]), "the place alone finds no road of it");
    assert_eq!(found("anton"), of(&[("Antonsweg", 6), ("Sankt Anton", 0)]));
    assert_eq!(finder.town(LonLat { lon_e7: 1_010_000, lat_e7: 0 }).map(|town| &*town.name), Some("Sankt Anton"));
}
