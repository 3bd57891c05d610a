//! Which areas count at which stations of the steer axle, and the room that each leaves ([`ground`]).

mod ground;

use std::cell::RefCell;
use std::sync::Arc;

use netcert_base::corridor::{AreaSpan, Corridor, PlaneArea};

pub(super) use ground::{AreaGrid, FAR_OUTSIDE_M, PlanePoint, SweptPiece, apart};

/// A span of stations of the steer axle, with its area.
#[derive(Clone)]
struct Window {
    /// First and last extended station.
    first: usize,
    last: usize,
    /// `None` where the area cannot be used: nothing is inside.
    ground: Option<Arc<AreaGrid>>,
}

/// Areas whose boundaries have been prepared. Paths of one junction share its area.
#[derive(Default)]
pub struct Grounds(RefCell<Vec<Prepared>>);

type Prepared = (Arc<PlaneArea>, Option<Arc<AreaGrid>>);

impl Grounds {
    fn of(&self, area: &Arc<PlaneArea>) -> Option<Arc<AreaGrid>> {
        if let Some((_, ground)) = self.0.borrow().iter().find(|(known, _)| Arc::ptr_eq(known, area)) {
            return ground.clone();
        }
        let ground = AreaGrid::new(area).map(Arc::new);
        self.0.borrow_mut().push((Arc::clone(area), ground.clone()));
        ground
    }
}

/// The areas of a corridor, prepared for its extended stations.
pub(super) struct PreparedAreas(Vec<Window>);

impl PreparedAreas {
    pub(super) fn new(corridor: &Corridor, lead: usize, grounds: &Grounds) -> Self {
        let last = corridor.len().saturating_sub(1);
        let window = |span: &AreaSpan| Window {
            first: lead + span.heads.start.min(last),
            last: lead + span.heads.end.saturating_sub(1).min(last),
            ground: grounds.of(&span.area),
        };
        Self(corridor.areas.iter().map(window).collect())
    }

    /// The areas for every second station.
    pub(super) fn coarse(&self, first: usize) -> Self {
        let half = |w: &Window| Window {
            first: w.first.saturating_sub(first).div_ceil(2),
            last: w.last.saturating_sub(first) / 2,
            ground: w.ground.clone(),
        };
        Self(self.0.iter().map(half).collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The areas that count at all of the given stations of the steer axle.
    #[inline]
    pub(super) fn count(&self, from: usize, to: usize) -> impl Iterator<Item = Option<&AreaGrid>> {
        self.0.iter().filter(move |w| w.first <= from && to <= w.last).map(|w| w.ground.as_deref())
    }

    /// Whether any area counts over the step from station `k` to the next.
    #[inline]
    pub(super) fn over(&self, k: usize) -> bool {
        self.count(k, k + 1).next().is_some()
    }

    /// Whether any area counts near the given stations of the steer axle.
    #[inline(always)]
    pub(super) fn touch(&self, from: usize, to: usize) -> bool {
        self.0.iter().any(|w| w.first <= to && from <= w.last)
    }

    /// Whether areas count from the step before station `from` to the step behind station `to`. The corridor's edges then
    /// do not matter.
    #[inline(always)]
    pub(super) fn replace(&self, from: usize, to: usize) -> bool {
        (from.saturating_sub(1)..=to).all(|k| self.over(k))
    }

    /// Whether an area begins to count at station `k`.
    #[inline]
    pub(super) fn begins(&self, k: usize) -> bool {
        self.0.iter().any(|w| w.first == k)
    }

    /// Whether other areas count over the step from station `k` to the next than over the step before.
    #[inline]
    pub(super) fn changes(&self, k: usize) -> bool {
        self.begins(k) || self.0.iter().any(|w| w.last == k)
    }
}
