//! The number of lanes that a one-way road is supposed to have where no tag says it: by country and class, and only where nine tagged roads in
//! ten have as many.
//!
//! `data/roads.toml` has the groups (`[one_way]`), `data/lanes.tsv` the ways that they rest on. `widths` says which roads belong to a group.

use serde::Deserialize;

use crate::osm::facts::{CrossSection, Strip, WidthSource};

/// Share of the roads that has to have the supposed lanes, or more.
pub(super) const NINE_IN_TEN: f64 = 0.9;
/// The normal distribution's quantile for a bound that holds at 95 % on both sides.
const QUANTILE: f64 = 1.96;

/// The lanes that one-way roads of a country and class are supposed to have, and the tagged ways that it rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupposedLanes {
    /// Lanes of the road, all in its one direction.
    pub lanes: u8,
    /// Ways of the group whose number of lanes is tagged.
    pub tagged: u32,
    /// Those of them with that number or more.
    pub reached: u32,
}

impl SupposedLanes {
    /// Share of the tagged ways with that number of lanes or more.
    #[must_use]
    pub fn share(&self) -> f64 {
        f64::from(self.reached) / f64::from(self.tagged.max(1))
    }

    /// Lower bound (95 %, Wilson) of the share in all roads of the group, if each tagged way had been drawn by itself.
    #[must_use]
    pub fn bound(&self) -> f64 {
        lower_bound(self.share(), f64::from(self.tagged))
    }
}

/// Wilson's lower bound (95 %) of a share of which `draws` were seen.
fn lower_bound(share: f64, draws: f64) -> f64 {
    let square = QUANTILE * QUANTILE;
    let spread = QUANTILE * (share * (1.0 - share) / draws + square / (4.0 * draws * draws)).sqrt();
    (share + square / (2.0 * draws) - spread) / (1.0 + square / draws)
}

impl CrossSection {
    /// The lanes of the direction that were supposed, if its width rests on class and country alone: how many times the lane fits in.
    #[must_use]
    pub fn supposed_lanes(&self) -> Option<u8> {
        let assumed = |strip: &Strip| strip.source == WidthSource::Assumed;
        let (lane, direction) = self.lane.filter(assumed).zip(self.direction.filter(assumed))?;
        Some((direction.width_m() / lane.width_m()).round() as u8)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::collections::BTreeMap;

    use netcert_base::words::Named as _;

    use super::*;
    use crate::osm::facts::{RoadClass, Rules};

    /// Ways of a group in a neighbourhood: all, those with `lanes`, those with the number or more.
    #[derive(Clone, Copy)]
    struct Neighbourhood {
        place: &'static str,
        ways: u32,
        tagged: u32,
        reached: u32,
    }

    /// The neighbourhoods of each group (country, class, direction, lanes) in `data/lanes.tsv`.
    fn counted() -> BTreeMap<[&'static str; 4], Vec<Neighbourhood>> {
        let text = include_str!("../../../../../data/lanes.tsv");
        let mut rows = text.lines().filter(|line| !line.starts_with('#'));
        assert_eq!(rows.next(), Some("country\tclass\tdirection\tlanes\tplace\tcell\tways\ttagged\treached"));
        let mut groups: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for row in rows {
            let cells: Vec<&str> = row.split('\t').collect();
            let [country, class, direction, lanes, place, _, ways, tagged, reached] = cells[..] else {
                unreachable!("{row}")
            };
            let [ways, tagged, reached] = [ways, tagged, reached].map(|number| number.parse().unwrap());
            assert!(reached <= tagged && tagged <= ways, "{row}");
            groups.entry([country, class, direction, lanes]).or_default().push(Neighbourhood {
                place,
                ways,
                tagged,
                reached,
            });
        }
        groups
    }

    /// The lower bound if clusters of ways had been drawn, each with its ways that reach the number and its tagged ways.
    fn clustered(clusters: &[[u32; 2]]) -> f64 {
        let clusters: Vec<[f64; 2]> =
            clusters.iter().filter(|c| c[1] > 0).map(|c| [f64::from(c[0]), f64::from(c[1])]).collect();
        let many = clusters.len() as f64;
        if many < 2.0 {
            return 0.0;
        }
        let draws: f64 = clusters.iter().map(|[_, of]| of).sum();
        let share = clusters.iter().map(|[reached, _]| reached).sum::<f64>() / draws;
        let squares: f64 = clusters.iter().map(|[reached, of]| (reached - share * of).powi(2)).sum();
        let variance = squares * many / (many - 1.0) / (draws * draws);
        let worth = if variance > 0.0 { share * (1.0 - share) / variance } else { many };
        lower_bound(share, worth.min(draws))
    }

    fn sums(neighbourhoods: &[Neighbourhood]) -> [u32; 2] {
        let sum = |of: fn(&Neighbourhood) -> u32| neighbourhoods.iter().map(of).sum();
        [sum(|n| n.reached), sum(|n| n.tagged)]
    }

    /// The bounds of a group: by ways, by neighbourhoods, by extracts (none below five), and by fully tagged neighbourhoods.
    fn bounds(neighbourhoods: &[Neighbourhood]) -> [f64; 4] {
        let clusters = |of: &[Neighbourhood]| of.iter().map(|n| [n.reached, n.tagged]).collect::<Vec<_>>();
        let mut places: BTreeMap<&str, Vec<Neighbourhood>> = BTreeMap::new();
        for &neighbourhood in neighbourhoods {
            places.entry(neighbourhood.place).or_default().push(neighbourhood);
        }
        let places: Vec<[u32; 2]> = places.values().map(|of| sums(of)).filter(|of| of[1] > 0).collect();
        let full: Vec<Neighbourhood> = neighbourhoods.iter().copied().filter(|n| 10 * n.tagged >= 9 * n.ways).collect();
        let [reached, tagged] = sums(neighbourhoods);
        let by_places = if places.len() >= 5 { clustered(&places) } else { 0.0 };
        let by_ways = SupposedLanes { lanes: 2, tagged, reached }.bound();
        [by_ways, clustered(&clusters(neighbourhoods)), by_places, clustered(&clusters(&full))]
    }

    #[test]
    fn bounds_are_those_of_the_literature() {
        // Newcombe 1998, table I: 81 of 263 has 0.2553, 15 of 148 has 0.0624, 0 of 20 has 0, 1 of 29 has 0.0061.
        for (reached, tagged, bound) in [(81, 263, 0.2553), (15, 148, 0.0624), (0, 20, 0.0), (1, 29, 0.0061)] {
            let found = SupposedLanes { lanes: 2, tagged, reached }.bound();
            assert!((found - bound).abs() < 5e-5, "{reached} of {tagged}: {found}");
        }
        // Clusters that are all alike tell no more than one way each.
        let alike = clustered(&[[9, 10]; 20]);
        assert!((alike - lower_bound(0.9, 20.0)).abs() < 1e-12, "{alike}");
        // Ten neighbourhoods, each all or nothing: nearly ten draws.
        let apart = clustered(&[
            [20, 20],
            [20, 20],
            [20, 20],
            [20, 20],
            [20, 20],
            [20, 20],
            [20, 20],
            [20, 20],
            [0, 20],
            [0, 20],
        ]);
        assert!((apart - lower_bound(0.8, 9.0)).abs() < 1e-12, "{apart}");
    }

    #[test]
    fn nine_in_ten_of_every_group_have_the_lanes_that_are_supposed() {
        let rules = Rules::builtin().unwrap();
        let counted = counted();
        assert!(!rules.one_way.is_empty());
        for ((country, class), group) in &rules.one_way {
            let code = std::str::from_utf8(country).unwrap();
            let lanes = group.lanes.to_string();
            let of = format!("{code} {}", class.name());
            let neighbourhoods = &counted[&[code, class.name(), "one-way", &lanes]];
            assert_eq!(sums(neighbourhoods), [group.reached, group.tagged], "{of}");
            let ways: u32 = neighbourhoods.iter().map(|n| n.ways).sum();
            assert!(2 * group.tagged >= ways, "{of}: half of the ways are tagged");
            for bound in bounds(neighbourhoods) {
                assert!(bound >= NINE_IN_TEN, "{of}: {:?}", bounds(neighbourhoods));
            }
            assert!(group.lanes > rules.class_lanes(*class), "{of}");
        }
    }

    #[test]
    fn a_group_that_does_not_reach_nine_in_ten_by_every_bound_keeps_the_lanes_of_its_class() {
        let rules = Rules::builtin().unwrap();
        let mut left_out = Vec::new();
        for ([country, class, direction, lanes], neighbourhoods) in counted() {
            let class = *RoadClass::ALL.iter().find(|known| known.name() == class).unwrap();
            let code = <[u8; 2]>::try_from(country.as_bytes()).unwrap();
            let used = rules.one_way_lanes(class, code).is_some_and(|group| group.lanes.to_string() == lanes);
            if direction == "one-way" && !used && rules.class_lanes(class).to_string() != lanes {
                let bounds = bounds(&neighbourhoods);
                assert!(bounds.iter().any(|&bound| bound < NINE_IN_TEN), "{country} {class:?}: {bounds:?}");
                left_out.push(format!("{country} {}", class.name()));
            }
        }
        assert_eq!(left_out, ["DE primary", "DE trunk", "US trunk"]);
    }
}
