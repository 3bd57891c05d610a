//! Where permits need more of the road than the narrowest strip that was tried, and what that costs a route (`data/rungs.toml`, as `netcert
//! route --at-most` counts it).
//!
//! Nothing is known if the database has the vehicle under no narrower policy: then no road is dearer than another.

use super::{ExportError, Source};
use crate::osm::facts::{Policy, RoadClass};
use crate::route::RungPrices;
use crate::rows::{EdgeNo, EdgeRung};
use crate::words::Named as _;

/// What the database knows of the strip that a permitted edge uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EdgeUse {
    /// The narrowest strip on which the vehicle is certified there.
    pub(super) strip: Policy,
    /// What the road costs a route: so many times its time. 1 on the narrowest strip that was tried.
    pub(super) factor: f64,
}

/// The permitted edges that need more than the narrowest strip that was tried.
#[derive(Debug, Clone, Default)]
pub(super) struct Wider {
    /// The narrowest strip that was tried. `None`: it is that of the permits, and nothing is known of narrower ones.
    base: Option<Policy>,
    /// In order of the edges, each with its place in `kinds`. There are few kinds and many edges.
    edges: Vec<(EdgeNo, u16)>,
    kinds: Vec<EdgeUse>,
}

impl Wider {
    /// Whether the database knows where a narrower strip would do.
    pub(super) fn known(&self) -> bool {
        self.base.is_some()
    }

    /// What a permitted edge uses. `None` if the database does not know whether a narrower strip would do.
    pub(super) fn uses(&self, edge: EdgeNo) -> Option<EdgeUse> {
        Some(self.edge(edge).unwrap_or(EdgeUse { strip: self.base?, factor: 1.0 }))
    }

    /// What a permitted edge uses, if it needs more than the narrowest strip that was tried.
    pub(super) fn edge(&self, edge: EdgeNo) -> Option<EdgeUse> {
        let at = self.edges.binary_search_by_key(&edge, |wide| wide.0).ok()?;
        self.kinds.get(usize::from(self.edges.get(at)?.1)).copied()
    }
}

impl Source<'_> {
    /// Where permits need more than the narrowest strip that was tried.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(super) fn wider(&self) -> Result<Wider, ExportError> {
        let (vehicle, policy) = (&self.ask.vehicle, self.ask.policy);
        let mut database = self.database()?;
        let mut base = None;
        for &narrower in Policy::ALL.iter().filter(|narrower| **narrower < policy) {
            if base.is_none() && database.certified_set(vehicle, narrower)?.is_some() {
                base = Some(narrower);
            }
        }
        let Some(narrowest) = base else { return Ok(Wider::default()) };
        let prices = RungPrices::builtin()?;
        let mut wider = Wider { base, ..Wider::default() };
        let mut of_kinds: Vec<(Policy, RoadClass)> = Vec::new();
        for rung in self.told(database.edge_rungs(vehicle, policy)?) {
            let EdgeRung { edge, uses, class } = rung?;
            if uses <= narrowest || !self.permitted.edges.get(edge.index()) {
                continue;
            }
            let known = of_kinds.iter().position(|kind| *kind == (uses, class));
            let place = known.unwrap_or_else(|| {
                of_kinds.push((uses, class));
                wider.kinds.push(EdgeUse { strip: uses, factor: 1.0 + prices.share(uses, class) });
                of_kinds.len() - 1
            });
            wider.edges.push((edge, place as u16));
        }
        Ok(wider)
    }
}
