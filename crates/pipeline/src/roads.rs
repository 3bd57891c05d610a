//! The roads of an extract: as one network, or as portions of it that are built one after the other.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use super::error::RunError;
use super::source::{self, MapSource, SourceDescription};
use super::summary::Summary;
use crate::account::AccountRow;
use crate::network::{Division, Ground, MappedArea, Network, Portion, StrokeOptions};
use crate::osm::changes::Changes;
use crate::osm::facts::{Countries, CrossSection, Jurisdiction, WayFacts, cross_sections};
use crate::osm::{Backdrop, Extract, LonLat};
use crate::reporter::Reporter;

/// Directed edges of one portion. With what surrounds it and its turns, a portion takes some 2 kB for each of them.
pub const EDGES_AT_ONCE: u64 = 150_000;

/// Into which portions roads are divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Portions {
    /// One portion is the whole network, whatever its size.
    Whole,
    /// Each has at most so many directed edges.
    OfAtMost(u64),
}

type Places<'c> = Box<dyn Fn(LonLat) -> Jurisdiction + Sync + 'c>;
type Sections<'c> = Box<dyn Fn(&WayFacts, &Jurisdiction, Option<f64>) -> [CrossSection; 2] + Sync + 'c>;

/// The roads of an extract.
pub(super) struct ExtractRoads<'c> {
    /// `None` if one portion is the whole network.
    divided: Option<Box<(Ground<Places<'c>, Sections<'c>>, Division)>>,
    /// The portion that was built last, with its number.
    current: Option<(usize, Portion)>,
    account: Vec<AccountRow>,
}

impl<'c> ExtractRoads<'c> {
    /// The roads of an extract, in portions.
    pub(super) fn new(extract: Extract, countries: &'c Countries, portions: Portions) -> Self {
        let rules = countries.rules();
        let places: Places<'c> = Box::new(|position| countries.jurisdiction(position));
        let sections: Sections<'c> =
            Box::new(move |facts, place, ring_radius_m| cross_sections(facts, place, ring_radius_m, rules));
        let ground = Ground::new(extract, places, sections, StrokeOptions::default());
        match portions {
            // A way has about two references for each directed edge.
            Portions::OfAtMost(edges) if ground.references() as u64 > 2 * edges => {
                let division = ground.divide(edges);
                Self { divided: Some(Box::new((ground, division))), current: None, account: Vec::new() }
            }
            Portions::OfAtMost(_) | Portions::Whole => {
                let (portion, account) = ground.whole();
                Self { divided: None, current: Some((0, portion)), account: account.rows() }
            }
        }
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
    pub(super) fn areas(&self) -> Vec<MappedArea> {
        let whole = || self.current.as_ref().map_or_else(Vec::new, |(_, portion)| portion.network.areas.all().to_vec());
        self.divided.as_ref().map_or_else(whole, |divided| divided.0.kept_areas(&divided.1))
    }
}

/// Stages one and two: reads the extract and builds the network.
///
/// # Errors
/// The file is damaged or has no roads.
pub fn read_network(
    input: &Path,
    countries: &Countries,
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Result<(Network, String), RunError> {
    let source = MapSource { inputs: &[input], changes: &Changes::default() };
    let (roads, origin) = read_roads(source, countries, Portions::Whole, &mut |_| Ok(()), reporter, summary)?;
    summary.account.extend(roads.account());
    Ok((roads.into_whole().network, origin.blake3))
}

/// Reads a source as it is after changes. `behind` takes what a map shows behind its roads.
pub(super) fn read_roads<'c>(
    source: MapSource<'_>,
    countries: &'c Countries,
    portions: Portions,
    behind: &mut dyn FnMut(&[Backdrop]) -> Result<(), RunError>,
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Result<(ExtractRoads<'c>, SourceDescription), RunError> {
    let (mut extract, origin) = source::read(source, reporter, summary)?;
    behind(&std::mem::take(&mut extract.backdrop))?;
    let clock = Instant::now();
    reporter.begin("network", 0);
    let roads = ExtractRoads::new(extract, countries, portions);
    reporter.end();
    summary.stage("network", clock, u64::from(roads.edges()), "directed edges");
    Ok((roads, origin))
}
