//! Which items to open together: those on the cheapest way from the component to a road, and on the cheapest way back.
//!
//! A vehicle does not turn back on the road. So one junction alone seldom joins anything: what leads there and what leads back open only
//! together. Everything here supposes that measuring helps; what is near the top is certified afterwards.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use rayon::prelude::*;

use super::component::{Component, FloodBuffers};
use super::joints::{CLOSED, Item, Joints, OPEN, Sense};
use crate::network::EdgeNo;
use crate::stop::{Stop, Stopped};

/// The greatest price of a way there and back, centimetres of missing room.
const MOST_CM: u32 = 2000;
/// Of several items of one place the dearest counts, and this share of each other one.
const SHARE: f64 = 0.25;
/// Bundles that open less than this are none, metres.
const LEAST_M: f64 = 1.0;

/// Items to open together.
#[derive(Debug, Clone)]
pub(super) struct Bundle {
    /// Sorted.
    pub(super) items: Vec<Item>,
    /// What they would open at most as far as the graph tells, metres.
    pub(super) opens_m: f64,
    /// The price of its places.
    pub(super) cost: f64,
}

impl Bundle {
    /// Metres for the price.
    pub(super) fn score(&self) -> f64 {
        self.opens_m / self.cost
    }
}

/// What bundles are looked for in.
#[derive(Clone, Copy)]
pub(super) struct BundleSearch<'a> {
    pub(super) joints: &'a Joints,
    pub(super) prices: &'a [u32],
    pub(super) component: &'a Component,
    pub(super) lengths_m: &'a [f64],
    /// Items by place.
    pub(super) by_place: &'a [Vec<Item>],
}

impl BundleSearch<'_> {
    /// All bundles that open something, the best first.
    pub(super) fn bundles(&self, stop: &Stop) -> Result<Vec<Bundle>, Stopped> {
        let (there, back) = (Ways::find(self, Sense::Ahead), Ways::find(self, Sense::Back));
        let mut found: BTreeSet<Vec<Item>> = BTreeSet::new();
        for edge in EdgeNo::first(self.joints.edges()) {
            let sum = there.cm[edge.index()].saturating_add(back.cm[edge.index()]);
            if self.component.has(edge) || sum > MOST_CM {
                continue;
            }
            let mut items = there.items(edge);
            items.extend(back.items(edge));
            items.sort_unstable();
            items.dedup();
            found.insert(items);
        }
        // A place by itself: both directions of a road, or all corners of a junction.
        found.extend(self.by_place.iter().map(|items| self.lacking(items)).filter(|items| !items.is_empty()));
        stop.check()?;
        // The price is that of the ways; what else lacks room at their places may open more, and is left out later if it does not.
        let mut priced: BTreeMap<Vec<Item>, f64> = BTreeMap::new();
        for items in found {
            let cost = self.cost(&items);
            let known = priced.entry(self.with_places(&items)).or_insert(cost);
            *known = known.min(cost);
        }
        let all: Vec<(Vec<Item>, f64)> = priced.into_iter().collect();
        let rated = all.into_par_iter().map_init(
            || FloodBuffers::new(self.joints),
            |scratch, (items, cost)| {
                stop.check()?;
                let opens_m = self.component.joined_m(self.joints, self.prices, &items, self.lengths_m, scratch);
                Ok((opens_m >= LEAST_M).then_some(Bundle { items, opens_m, cost }))
            },
        );
        let mut bundles: Vec<Bundle> = rated.collect::<Result<Vec<_>, Stopped>>()?.into_iter().flatten().collect();
        bundles.sort_by(|a, b| b.score().total_cmp(&a.score()).then_with(|| a.items.cmp(&b.items)));
        Ok(bundles)
    }

    /// What items open by themselves. `None` if it is next to nothing.
    pub(super) fn rated(&self, items: Vec<Item>) -> Option<Bundle> {
        let mut scratch = FloodBuffers::new(self.joints);
        let opens_m = self.component.joined_m(self.joints, self.prices, &items, self.lengths_m, &mut scratch);
        let cost = self.cost(&items);
        (opens_m >= LEAST_M).then_some(Bundle { items, opens_m, cost })
    }

    /// The bundle without what opens nothing more.
    pub(super) fn needed(&self, bundle: &Bundle) -> Bundle {
        let mut scratch = FloodBuffers::new(self.joints);
        let mut items = bundle.items.clone();
        let mut dearest = bundle.items.clone();
        dearest.sort_by_key(|&item| Reverse(self.prices[item as usize]));
        for item in dearest {
            let without: Vec<Item> = items.iter().copied().filter(|&other| other != item).collect();
            let opens_m = self.component.joined_m(self.joints, self.prices, &without, self.lengths_m, &mut scratch);
            if opens_m >= bundle.opens_m - LEAST_M {
                items = without;
            }
        }
        let cost = self.cost(&items);
        Bundle { items, opens_m: bundle.opens_m, cost }
    }

    fn lacking(&self, items: &[Item]) -> Vec<Item> {
        items.iter().copied().filter(|&item| !matches!(self.prices[item as usize], OPEN | CLOSED)).collect()
    }

    /// The items with all others of their places.
    fn with_places(&self, items: &[Item]) -> Vec<Item> {
        let places: BTreeSet<u32> = items.iter().map(|&item| self.joints.place(item)).collect();
        let mut all: Vec<Item> =
            places.into_iter().flat_map(|place| self.lacking(&self.by_place[place as usize])).collect();
        all.sort_unstable();
        all
    }

    fn cost(&self, items: &[Item]) -> f64 {
        let mut places: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        for &item in items {
            let price = f64::from(self.prices[item as usize]);
            let (most, sum) = places.entry(self.joints.place(item)).or_default();
            (*most, *sum) = (most.max(price), *sum + price);
        }
        places.values().fold(0.0, |cost, (most, sum)| cost + most + SHARE * (sum - most))
    }
}

/// The cheapest ways from the component to each edge, or back.
struct Ways {
    /// By edge: the price.
    cm: Vec<u32>,
    /// By edge: the last link of its way.
    last: Vec<u32>,
    /// Items with the link before.
    links: Vec<(Item, u32)>,
}

const NONE: u32 = u32::MAX;

impl Ways {
    fn find(field: &BundleSearch<'_>, sense: Sense) -> Self {
        let BundleSearch { joints, prices, component, .. } = field;
        let edges = joints.edges();
        let mut ways = Self { cm: vec![u32::MAX; edges], last: vec![NONE; edges], links: Vec::new() };
        let mut queue = BinaryHeap::new();
        for edge in EdgeNo::first(edges).filter(|&edge| component.has(edge)) {
            ways.cm[edge.index()] = 0;
            queue.push(Reverse((0, edge)));
        }
        while let Some(Reverse((cm, at))) = queue.pop() {
            if cm > ways.cm[at.index()] {
                continue;
            }
            let mut visit = |item: Item, next: EdgeNo| {
                let on = next.get();
                let own = [item, on].map(|item| prices[item as usize]);
                let sum = own.iter().fold(cm, |sum, &price| sum.saturating_add(price));
                if sum > MOST_CM || sum >= ways.cm[next.index()] {
                    return;
                }
                ways.cm[next.index()] = sum;
                let mut last = ways.last[at.index()];
                for (item, price) in [item, on].into_iter().zip(own) {
                    if price != OPEN {
                        ways.links.push((item, last));
                        last = ways.links.len() as u32 - 1;
                    }
                }
                ways.last[next.index()] = last;
                queue.push(Reverse((sum, next)));
            };
            match sense {
                Sense::Ahead => joints.after(at).for_each(|step| visit(step.item, step.to)),
                Sense::Back => joints.before(at).for_each(|step| visit(step.item, step.from)),
            }
        }
        ways
    }

    /// What is not open on the way of an edge, with the edge itself.
    fn items(&self, edge: EdgeNo) -> Vec<Item> {
        let mut items = Vec::new();
        let mut link = self.last[edge.index()];
        while let Some(&(item, before)) = self.links.get(link as usize) {
            items.push(item);
            link = before;
        }
        items
    }
}
