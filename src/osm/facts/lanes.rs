//! The lanes of a road, from the left of the way's node order to its right, with their direction and use.
//!
//! Tagged lanes count first, then those of the class. Lanes for other traffic (bus, cycle) are not open. Both
//! directions share a road without marked lanes.

use crate::osm::facts::Direction;
use crate::osm::facts::layout::{Layout, SHARED, Segment, Use};
use crate::osm::facts::section::LaneTags;
use crate::osm::facts::widths::{Builder, LANE_M, SHARED_BELOW_M};

impl Builder<'_> {
    /// The layout of a one-way road.
    pub(super) fn one_way(&self, direction: Direction) -> Layout {
        let tags = self.lane_tags(direction);
        let tagged = if tags.count > 0 { tags.count } else { self.tags.lanes };
        let mut lanes = self.lanes(direction, tags, tagged);
        if direction == Direction::Backward {
            lanes.reverse();
        }
        let known = tagged > 0 || tags.listed > 0;
        let narrow = self.tags.narrow && tagged <= 1 && tags.listed == 0;
        let single_m = self.single_m.filter(|_| lanes.len() == 1).map(|width_m| width_m.max(self.lane_m));
        let assumed_m = if narrow { Some(self.kerb_rule.narrow_m) } else { single_m };
        self.lay_out(lanes, known, assumed_m, false)
    }

    /// The layout of a two-way road.
    pub(super) fn two_way(&self) -> Layout {
        let (forward, backward) = (self.lane_tags(Direction::Forward), self.lane_tags(Direction::Backward));
        let listed = forward.listed > 0 || backward.listed > 0;
        let known = self.tags.tagged_lanes().is_some() || listed;
        let single = self.tags.alternating || (self.tags.tagged_lanes() == Some(1) && !listed);
        let unmarked = !known && (self.class.shared_m.is_some() || self.tags.narrow);
        if single || unmarked {
            let assumed_m = match (self.tags.narrow, self.class.shared_m) {
                (true, _) => self.kerb_rule.narrow_m,
                (false, Some(shared_m)) if !known => shared_m,
                (false, _) => self.lane_m,
            };
            // A wide road is not shared merely because a tag is missing: each direction gets a half.
            if single || self.tags.carriageway.is_none_or(|width| width.metres() < SHARED_BELOW_M) {
                return self.lay_out(vec![SHARED], known, Some(assumed_m), true);
            }
        }
        let (n_forward, n_backward, n_centre) = self.lane_counts();
        let mut forward = self.lanes(Direction::Forward, forward, n_forward);
        let mut backward = self.lanes(Direction::Backward, backward, n_backward);
        backward.reverse();
        let centre = (0..n_centre).map(|_| Segment { width_m: None, of: None, used: Use::Paved });
        let lanes = if self.left_hand_traffic {
            forward.extend(centre);
            forward.append(&mut backward);
            forward
        } else {
            backward.extend(centre);
            backward.append(&mut forward);
            backward
        };
        self.lay_out(lanes, known, None, true)
    }

    fn lane_tags(&self, direction: Direction) -> &LaneTags {
        &self.tags.directions[usize::from(direction == Direction::Backward)]
    }

    /// Number of lanes forward, backward, and for turning in the middle of a two-way road. An odd lane without a
    /// direction counts as a middle lane, which neither direction may use.
    fn lane_counts(&self) -> (u8, u8, u8) {
        let [forward, backward] = [&self.tags.directions[0], &self.tags.directions[1]].map(|tags| tags.count);
        let centre = self.tags.both_ways;
        let rest = |taken: u8| self.tags.lanes.saturating_sub(centre).saturating_sub(taken).max(1);
        match (forward, backward) {
            (0, 0) if self.tags.lanes == 0 => (self.class.lanes, self.class.lanes, centre),
            (0, 0) => {
                let running = rest(0);
                ((running / 2).max(1), (running / 2).max(1), centre + running % 2)
            }
            (forward, 0) => (forward, rest(forward), centre),
            (0, backward) => (rest(backward), backward, centre),
            (forward, backward) => (forward, backward, centre),
        }
    }

    /// The lanes of one direction, from left to right in direction of travel. `count` 0 means unknown.
    fn lanes(&self, direction: Direction, tags: &LaneTags, count: u8) -> Vec<Segment> {
        let of = Some(direction);
        let plain = |n: u8| vec![Segment { width_m: None, of, used: Use::Lane(direction) }; usize::from(n)];
        let mut lanes = if tags.listed > 0 && tags.listed >= count {
            let mut lanes = plain(tags.listed);
            if let Some(widths) = tags.widths_m() {
                for (lane, width_m) in lanes.iter_mut().zip(widths) {
                    lane.width_m = Some(width_m);
                }
            }
            // `lanes` excludes cycle lanes and lane lists include them, so the difference is the number of cycle lanes.
            let cycle_lanes = if count > 0 { tags.listed - count } else { tags.listed };
            self.close(&mut lanes, cycle_lanes, tags);
            lanes
        } else {
            plain(if count > 0 { count } else { self.class.lanes })
        };
        if tags.closed == 0 {
            self.lanes_from_kerb(&mut lanes).take(usize::from(tags.bus)).for_each(|lane| lane.used = Use::Paved);
        }
        lanes
    }

    fn close(&self, lanes: &mut [Segment], mut cycle_lanes: u8, tags: &LaneTags) {
        let closed: Vec<bool> = (0..lanes.len())
            .map(|at| tags.is_closed(at) || lanes[at].width_m.is_some_and(|width_m| width_m < *LANE_M.start()))
            .collect();
        let mut order: Vec<usize> = (0..lanes.len()).filter(|&at| closed[at]).collect();
        if !self.left_hand_traffic {
            order.reverse();
        }
        for at in order {
            lanes[at].used = if cycle_lanes > 0 { Use::Aside } else { Use::Paved };
            cycle_lanes = cycle_lanes.saturating_sub(1);
        }
    }

    /// The lanes of one direction (in direction of travel) from the kerb to the middle.
    fn lanes_from_kerb<'l>(&self, lanes: &'l mut [Segment]) -> Box<dyn Iterator<Item = &'l mut Segment> + 'l> {
        if self.left_hand_traffic { Box::new(lanes.iter_mut()) } else { Box::new(lanes.iter_mut().rev()) }
    }
}
