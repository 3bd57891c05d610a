//! The roads of an extract: as one network, or as portions of it that are built one after the other.

use std::collections::BTreeMap;

use crate::account::AccountRow;
use crate::network::{Area, Division, Ground, Network, Portion, StrokeOptions};
use crate::osm::facts::{Countries, CrossSection, Place, WayFacts, cross_sections};
use crate::osm::{Extract, LonLat};

/// Directed edges of one portion. With what surrounds it and its turns, a portion takes some 2 kB for each of them.
pub const EDGES_AT_ONCE: u64 = 150_000;

type Places<'c> = Box<dyn Fn(LonLat) -> Place + Sync + 'c>;
type Sections<'c> = Box<dyn Fn(&WayFacts, &Place, Option<f64>) -> [CrossSection; 2] + Sync + 'c>;

/// The roads of an extract.
pub(super) struct Roads<'c> {
    /// `None` if one portion is the whole network.
    divided: Option<Box<(Ground<Places<'c>, Sections<'c>>, Division)>>,
    /// The portion that was built last, with its number.
    current: Option<(usize, Portion)>,
    account: Vec<AccountRow>,
}

impl<'c> Roads<'c> {
    /// The roads of an extract, in portions of at most `edges_at_once` directed edges. `whole`: as one network, whatever its size.
    pub(super) fn new(extract: Extract, countries: &'c Countries, edges_at_once: u64, whole: bool) -> Self {
        let rules = countries.rules();
        let places: Places<'c> = Box::new(|position| countries.place(position));
        let sections: Sections<'c> =
            Box::new(move |facts, place, ring_radius_m| cross_sections(facts, place, ring_radius_m, rules));
        let ground = Ground::new(extract, places, sections, StrokeOptions::default());
        // A way has about two references for each directed edge.
        if whole || ground.references() as u64 <= 2 * edges_at_once {
            let (portion, account) = ground.whole();
            return Self { divided: None, current: Some((0, portion)), account: account.rows() };
        }
        let division = ground.divide(edges_at_once);
        Self { divided: Some(Box::new((ground, division))), current: None, account: Vec::new() }
    }

    /// The network, if it is whole.
    pub(super) fn whole(&mut self) -> Option<&mut Network> {
        let portion = if self.divided.is_some() { None } else { self.current.as_mut() };
        portion.map(|(_, portion)| &mut portion.network)
    }

    /// The only portion, if the network is whole.
    pub(super) fn only(&self) -> Option<&Portion> {
        let portion = if self.divided.is_some() { None } else { self.current.as_ref() };
        portion.map(|(_, portion)| portion)
    }

    /// The only portion of a network, which must be whole.
    pub(super) fn into_whole(self) -> Portion {
        self.current.map_or_else(|| Portion::whole(Network::default()), |(_, portion)| portion)
    }

    /// Number of portions.
    pub(super) fn portions(&self) -> usize {
        self.divided.as_ref().map_or(1, |divided| divided.1.blocks())
    }

    /// The portions that may own edges around a portion.
    pub(super) fn needs(&self, number: usize) -> Vec<u32> {
        self.divided.as_ref().map_or_else(Vec::new, |divided| divided.1.needs(number))
    }

    /// Number of directed edges.
    pub(super) fn edges(&self) -> u32 {
        let whole = || self.current.as_ref().map_or(0, |(_, portion)| portion.network.edges.len() as u32);
        self.divided.as_ref().map_or_else(whole, |divided| divided.1.edges())
    }

    /// Number of roads by country.
    pub(super) fn countries(&self) -> BTreeMap<[u8; 2], usize> {
        if let Some(divided) = &self.divided {
            return divided.1.countries().clone();
        }
        let mut counts = BTreeMap::new();
        let roads = self.current.iter().flat_map(|(_, portion)| &portion.network.roads);
        roads.for_each(|road| *counts.entry(road.country).or_default() += 1);
        counts
    }

    /// A portion, which is built unless it was the last one to be asked for.
    pub(super) fn portion(&mut self, number: usize) -> &Portion {
        if let Some(divided) = &self.divided
            && self.current.as_ref().is_none_or(|(current, _)| *current != number)
        {
            // Two portions are never in memory at the same time.
            self.current = None;
            self.current = Some((number, divided.0.portion(&divided.1, number)));
        }
        &self.current.get_or_insert_with(|| (0, Portion::whole(Network::default()))).1
    }

    /// Adds the current portion to the account and to the areas that are kept. Call it once for each portion.
    pub(super) fn count(&mut self) {
        if let (Some(divided), Some((_, portion))) = (&mut self.divided, &self.current) {
            divided.1.add(portion);
        }
    }

    /// The account of the network. It is complete once every portion is counted.
    pub(super) fn account(&self) -> Vec<AccountRow> {
        self.divided.as_ref().map_or_else(|| self.account.clone(), |divided| divided.0.account(&divided.1).rows())
    }

    /// The areas of the network, once every portion is counted.
    pub(super) fn areas(&self) -> Vec<Area> {
        let whole = || self.current.as_ref().map_or_else(Vec::new, |(_, portion)| portion.network.areas.all().to_vec());
        self.divided.as_ref().map_or_else(whole, |divided| divided.0.kept_areas(&divided.1))
    }
}
