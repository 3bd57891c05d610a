//! A fitter with what it knows, and ways while they are fitted.

use std::ops::Range;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::suppositions::Suppositions;
use crate::assemble::{DrivenWay, PartKind};
use crate::drive::Drive;
use crate::driver::Driver;
use crate::network::{self, EdgeNo, Network};
use crate::pieces::Choices;
use crate::roads::Roads;
use crate::whole::{CertifiedWay, Whole};

/// Fits ways, and keeps what it has found out about edges and turns. Its answers do not depend on earlier ones.
pub(crate) struct Fitter {
    pub(super) roads: Arc<Roads>,
    pub(super) driver: Arc<Driver>,
    /// The vehicle as it climbs, if it does.
    pub(super) climbing: Option<Arc<Driver>>,
    pub(super) base: Arc<network::Site>,
    pub(super) stroke_of: Arc<[u32]>,
    /// The widths that edges need.
    pub(super) needs_m: FxHashMap<EdgeNo, Option<f64>>,
    /// What turns need; `None` if nothing does.
    pub(super) turns: FxHashMap<TurnWidths, Option<Suppositions>>,
    /// Sections with what their edges and turns need by themselves, with enough to be safe, and with the least that was found for it.
    pub(super) supposed: FxHashMap<SectionKey, Result<Fitting, Unfit>>,
    pub(super) safe: FxHashMap<SectionKey, Result<Fitting, Unfit>>,
    pub(super) settled: FxHashMap<SectionKey, Result<Fitting, Unfit>>,
    /// What was certified last, and what was supposed there.
    pub(super) whole: Option<(Whole, Suppositions)>,
    /// Fitters that work beside this one, each on a network of its own.
    pub(super) helpers: Vec<Self>,
}

/// The edges of a section, the arcs of its passages, its ends, and which edges and steps have a price.
pub(super) type SectionKey = (Vec<EdgeNo>, Vec<Range<usize>>, [u64; 2], Vec<bool>);

/// The edges of a turn, with the widths of the roads beside it in centimetres.
pub(super) type TurnWidths = (Vec<EdgeNo>, Vec<i64>);

/// A way that is certified if everything supposed holds.
pub(crate) struct Fitted {
    /// The edges. Turns that are driven as one are one passage.
    pub(crate) drive: Drive,
    pub(crate) certified: CertifiedWay,
    pub(crate) supposed: Suppositions,
    /// Whether the search with nothing supposed finds the same, once everything is measured exactly as supposed.
    pub(crate) suffices: bool,
}

/// The places on a way for which nothing does. None if no single place is at fault.
#[derive(Clone)]
pub(crate) struct Unfit(pub(crate) Vec<PartKind>);

/// A way while it is fitted.
#[derive(Clone)]
pub(super) struct Fitting {
    pub(super) drive: Drive,
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) supposed: Suppositions,
    /// How often it has failed.
    pub(super) round: usize,
    pub(super) choices: Choices,
}

impl Fitting {
    pub(super) fn new(base: &Arc<network::Site>, way: &DrivenWay<'_>) -> Self {
        Self {
            drive: way.drive.clone(),
            start: way.start,
            end: way.end,
            supposed: Suppositions::new(Arc::clone(base)),
            round: 0,
            choices: Choices::default(),
        }
    }

    /// The way as it is certified, where measurements exactly as supposed suffice.
    pub(super) fn fitted(self, certified: CertifiedWay) -> Fitted {
        Fitted { drive: self.drive, certified, supposed: self.supposed, suffices: true }
    }

    /// Takes over the passages, suppositions and paths of a section that begins at the edge `first` of this way.
    pub(super) fn take_over(&mut self, section: &Self, first: usize) {
        let over = section.drive.over.iter().map(|arcs| arcs.start + first..arcs.end + first);
        self.drive.over.extend(over);
        self.supposed.add(&section.supposed);
        self.choices.extend(&section.choices);
    }
}

impl Fitter {
    /// A fitter for a vehicle with the permits of its widest strip. With `climbing`, ways keep to strips that are as narrow as they can be.
    pub(crate) fn new(roads: &Arc<Roads>, driver: &Arc<Driver>, climbing: Option<Arc<Driver>>) -> Self {
        let base = Arc::new(roads.network.site.clone());
        let stroke_of = roads.network.strokes_of_edges().into();
        Self { climbing, ..Self::beside(roads, driver, base, stroke_of) }
    }

    /// A fitter that knows nothing yet, on roads whose known site is `base`.
    pub(super) fn beside(
        roads: &Arc<Roads>,
        driver: &Arc<Driver>,
        base: Arc<network::Site>,
        stroke_of: Arc<[u32]>,
    ) -> Self {
        Self {
            roads: Arc::clone(roads),
            driver: Arc::clone(driver),
            climbing: None,
            base,
            stroke_of,
            needs_m: FxHashMap::default(),
            turns: FxHashMap::default(),
            supposed: FxHashMap::default(),
            safe: FxHashMap::default(),
            settled: FxHashMap::default(),
            whole: None,
            helpers: Vec::new(),
        }
    }
}

/// The network of roads that nobody else holds. If somebody does, it is copied first.
pub(super) fn network_of(roads: &mut Arc<Roads>) -> &mut Network {
    &mut Arc::make_mut(roads).network
}
