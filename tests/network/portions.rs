//! However a network is divided into portions, their edges, strokes, restrictions and areas are those of the whole network.

use std::collections::BTreeMap;

use netcert::network::{Division, EdgeNo, Ground, Network, Portion, PortionRestriction, StrokeOptions};
use netcert::osm::facts::{Countries, CrossSection, Jurisdiction, WayFacts, cross_sections};
use netcert::osm::pbf::read_extract;
use netcert::osm::{Extract, LonLat};

use crate::cells::{ORIGIN, drawn};
use netcert_testing::ascii_map::offset;
use netcert_testing::extracts;

type Places<'c> = Box<dyn Fn(LonLat) -> Jurisdiction + Sync + 'c>;
type Sections<'c> = Box<dyn Fn(&WayFacts, &Jurisdiction, Option<f64>) -> [CrossSection; 2] + Sync + 'c>;

fn ground(extract: Extract, countries: &Countries) -> Ground<Places<'_>, Sections<'_>> {
    let rules = countries.rules();
    let places: Places<'_> = Box::new(|position| countries.jurisdiction(position));
    let sections: Sections<'_> =
        Box::new(move |way, place, ring_radius_m| cross_sections(way, place, ring_radius_m, rules));
    Ground::new(extract, places, sections, StrokeOptions::default())
}

/// An edge with all that its row says, its road included.
fn edge_text(network: &Network, edge: EdgeNo) -> String {
    let e = &network.edges[edge.index()];
    let road = network.road(e);
    let name = road.name.map(|name| network.strings.text(name));
    let reference = road.reference.map(|name| network.strings.text(name));
    let line: Vec<LonLat> = network.positions(e).collect();
    let narrowings = &network.narrowings[e.narrowings.start as usize..e.narrowings.end as usize];
    format!(
        "{} {} {} {} {:?} {line:?} {narrowings:?} {:?} {} {} {:?} {name:?} {reference:?} {:?}",
        e.id,
        road.way_id,
        e.from_node,
        e.to_node,
        e.direction,
        e.legal,
        e.barred,
        e.cut,
        road.class,
        network.section(e)
    )
}

/// Strokes by their first edge, with indices of the whole network. Of an approach only the end is driven.
fn strokes(portion: &Portion) -> BTreeMap<EdgeNo, String> {
    let text = |stroke: u32| {
        let stroke = &portion.network.strokes[stroke as usize];
        let edges = |range: &std::ops::Range<u32>| -> Vec<EdgeNo> {
            let edges = &portion.network.stroke_edges[range.start as usize..range.end as usize];
            edges.iter().map(|&edge| portion.edge(edge)).collect()
        };
        let own = edges(&stroke.edges);
        (own[0], format!("{:?} {own:?} {}", edges(&stroke.approach), stroke.closed))
    };
    portion.strokes().map(text).collect()
}

fn restrictions(portion: &Portion) -> Vec<String> {
    let text = |PortionRestriction { rule, restriction, edges, .. }: PortionRestriction| {
        format!("{} {:?} {} {edges:?} {rule:?}", restriction.relation_id, restriction.kind, restriction.conditional)
    };
    portion.restrictions().map(text).collect()
}

/// Returns the number of portions.
pub(crate) fn compare(extract: &Extract, most: u64) -> usize {
    let countries = Countries::load().unwrap();
    let (whole, account) = ground(extract.clone(), &countries).whole();
    let ground = ground(extract.clone(), &countries);
    let mut division: Division = ground.divide(most);
    assert_eq!(division.edges() as usize, whole.network.edges.len());
    assert_eq!(division.countries().values().sum::<usize>(), whole.network.roads.len());
    let mut edges = BTreeMap::new();
    let mut all_strokes = BTreeMap::new();
    let mut all_restrictions = Vec::new();
    for number in 0..division.blocks() {
        let portion = ground.portion(&division, number);
        for (edge, e) in portion.edges() {
            let index = portion.edge(edge);
            assert!(edges.insert(index, number).is_none(), "edge {index} has two owners");
            assert_eq!(edge_text(&portion.network, edge), edge_text(&whole.network, index));
            assert_eq!(portion.road(e.road), whole.network.edges[index.index()].road);
        }
        all_strokes.extend(strokes(&portion));
        all_restrictions.extend(restrictions(&portion));
        division.add(&portion);
    }
    assert_eq!(edges.len(), whole.network.edges.len(), "every edge has an owner");
    assert_eq!(all_strokes, strokes(&whole));
    all_restrictions.sort();
    let mut expected = restrictions(&whole).into_iter().collect::<Vec<_>>();
    expected.sort();
    assert_eq!(all_restrictions, expected);
    assert_eq!(ground.kept_areas(&division), whole.network.areas.all());
    assert_eq!(ground.account(&division), account);
    division.blocks()
}

#[test]
fn portions_of_drawn_roads_make_up_the_whole() {
    for seed in 1..9 {
        let mut extract = drawn(seed);
        if seed % 2 == 0 {
            let degrees = |metres: f64| offset(ORIGIN, metres, metres).degrees();
            let [near, far] = [degrees(-900.0), degrees(15_000.0)];
            let nano = |degrees: f64| (degrees * 1e9) as i64;
            extract.account.header.bbox_nanodegrees = Some([near.0, near.1, far.0, far.1].map(nano));
        }
        let blocks = [u64::MAX, 200, 30, 1].map(|most| compare(&extract, most));
        assert!(blocks[0] == 1 && blocks.is_sorted() && blocks[3] > 20, "{blocks:?}");
    }
}

#[test]
fn portions_of_a_real_region_make_up_the_whole() {
    for (name, most) in [("rhein_neckar_de.osm.pbf", 4000), ("sydney_au.osm.pbf", 1)] {
        let Some(path) = extracts::extract(name) else { continue };
        let extract = read_extract(&path, &|_| ()).unwrap();
        assert!(compare(&extract, most) > 1, "{name}");
    }
}
