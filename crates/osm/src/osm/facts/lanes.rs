//! The lanes of a road, from the left of the way's node order to its right, with their direction and use.
//!
//! Tagged lanes count first, then those of the class. Lanes for other traffic (bus, cycle) are not open. Both
//! directions share a road without marked lanes.

use crate::osm::facts::layout::{LayoutSegment, RoadLayout, SHARED, Use};
use crate::osm::facts::section::{LISTED, LaneTags, Mark, in_metres};
use crate::osm::facts::widths::{Builder, LANE_M, SHARED_BELOW_M, Traffic};
use crate::osm::facts::{Direction, TrafficSide};

impl Builder<'_> {
    /// The layout of a one-way road. Lanes of oncoming buses lie beyond its own.
    pub(super) fn one_way(&self, direction: Direction) -> RoadLayout {
        let opposite = opposite(direction);
        let oncoming = if self.tags.is(Mark::Reversible) { 0 } else { self.lane_tags(opposite).count };
        let mut tags = *self.lane_tags(direction);
        let tagged = if tags.count > 0 { tags.count } else { self.tags.lanes };
        let mut against = *self.lane_tags(opposite);
        let listed = tags.listed > 0;
        if self.tags.is(Mark::WholeRoad) {
            let own = if tagged > 0 { tagged } else { self.class.lanes };
            (tags, against) = self.split_list(&tags, &against, [own, 0, oncoming]);
        }
        let mut lanes = self.lanes(direction, &tags, tagged);
        let mut others = if oncoming > 0 { self.lanes(opposite, &against, oncoming) } else { Vec::new() };
        for other in others.iter_mut().filter(|lane| lane.used != Use::Aside) {
            other.used = Use::Paved;
        }
        others.reverse();
        if self.side == TrafficSide::Left {
            lanes.append(&mut others);
        } else {
            others.append(&mut lanes);
            lanes = others;
        }
        if direction == Direction::Backward {
            lanes.reverse();
        }
        let known = tagged > 0 || listed;
        let one_lane = lanes.len() == 1 || (tagged <= 1 && !listed);
        let assumed_m = if self.tags.is(Mark::Narrow) {
            Some(self.kerb_rule.narrow_m).filter(|_| one_lane)
        } else {
            self.single_m.filter(|_| lanes.len() == 1).map(|width_m| width_m.max(self.lane_m))
        };
        self.lay_out(lanes, known, assumed_m, Traffic::OneWay)
    }

    /// The layout of a two-way road.
    pub(super) fn two_way(&self) -> RoadLayout {
        let (mut forward, mut backward) = (*self.lane_tags(Direction::Forward), *self.lane_tags(Direction::Backward));
        let listed = forward.listed > 0 || backward.listed > 0;
        let known = self.tags.tagged_lanes().is_some() || listed;
        let single = self.tags.is(Mark::Alternating)
            || (self.tags.tagged_lanes() == Some(1) && (!listed || self.tags.is(Mark::WholeRoad)));
        let unmarked = !known && (self.class.shared_m.is_some() || self.tags.is(Mark::Narrow));
        if single || unmarked {
            let assumed_m = match (self.tags.is(Mark::Narrow), self.class.shared_m) {
                (true, _) => self.kerb_rule.narrow_m,
                (false, Some(shared_m)) if !known => shared_m,
                (false, _) => self.lane_m,
            };
            // A wide road is not shared merely because a tag is missing: each direction gets a half.
            if single || self.tags.carriageway.is_none_or(|width| width.metres() < SHARED_BELOW_M) {
                return self.lay_out(vec![self.shared(&[forward, backward])], known, Some(assumed_m), Traffic::TwoWay);
            }
        }
        let (n_forward, n_backward, n_centre) = self.lane_counts();
        if self.tags.is(Mark::WholeRoad) {
            (forward, backward) = self.split_list(&forward, &backward, [n_forward, n_centre, n_backward]);
        }
        // Lists may include cycle lanes only if lanes are counted, too.
        let count = |lanes| if self.tags.tagged_lanes().is_some() { lanes } else { 0 };
        let mut forward = self.lanes(Direction::Forward, &forward, count(n_forward));
        let mut backward = self.lanes(Direction::Backward, &backward, count(n_backward));
        backward.reverse();
        let centre_m = in_metres(self.tags.both_ways_steps).filter(|_| self.tags.both_ways > 0);
        let centre =
            LayoutSegment { width_m: centre_m, listed: centre_m.is_some(), ..LayoutSegment::new(None, Use::Paved) };
        let centre = (0..n_centre).map(|_| centre);
        let lanes = if self.side == TrafficSide::Left {
            forward.extend(centre);
            forward.append(&mut backward);
            forward
        } else {
            backward.extend(centre);
            backward.append(&mut forward);
            backward
        };
        self.lay_out(lanes, known, None, Traffic::TwoWay)
    }

    /// The lane that both directions share. It is no wider than any width that a list gives.
    fn shared(&self, directions: &[LaneTags; 2]) -> LayoutSegment {
        let listed =
            directions.iter().filter_map(|tags| tags.narrowest_m().into_iter().chain(tags.most_m(0)).reduce(f32::min));
        let most_m = listed.reduce(f32::min);
        if self.tags.is(Mark::WholeRoad) && directions[0].listed == 1 {
            return LayoutSegment { width_m: most_m, listed: most_m.is_some(), ..SHARED };
        }
        LayoutSegment { most_m, ..SHARED }
    }

    /// Divides the list of the whole road, from left to right in the direction of `own`, into the lanes of that direction and
    /// of the other one. `counts` are the lanes of the direction, in the middle, and of the other one. A list of
    /// another length bounds all lanes.
    fn split_list(&self, own: &LaneTags, other: &LaneTags, counts: [u8; 3]) -> (LaneTags, LaneTags) {
        let [n_own, n_centre, n_other] = counts.map(usize::from);
        let mut steps: Vec<u8> = own.width_steps[..usize::from(own.listed).min(LISTED)].to_vec();
        let mut closed: Vec<bool> = (0..steps.len()).map(|at| own.is_closed(at)).collect();
        // Lists include cycle lanes, and counts do not.
        while steps.len() > n_own + n_centre + n_other
            && let Some(at) = steps.iter().position(|&step| in_metres(step).is_some_and(|m| m < *LANE_M.start()))
        {
            steps.remove(at);
            closed.remove(at);
        }
        let blank = |tags: &LaneTags| LaneTags { listed: 0, closed: 0, width_steps: [0; LISTED], ..*tags };
        let (mut own_tags, mut other_tags) = (blank(own), blank(other));
        if steps.len() != n_own + n_centre + n_other {
            let narrowest = own.width_steps.iter().copied().filter(|&step| step > 0).min().unwrap_or(0);
            own_tags.bound(narrowest);
            other_tags.bound(narrowest);
            return (own_tags, other_tags);
        }
        if self.side == TrafficSide::Right {
            // From the kerb of the direction's own side.
            steps.reverse();
            closed.reverse();
        }
        let take = |tags: &mut LaneTags, lanes: Vec<usize>| {
            tags.listed = lanes.len() as u8;
            for (at, lane) in lanes.into_iter().enumerate().take(LISTED) {
                tags.width_steps[at] = steps[lane];
                tags.closed |= u8::from(closed[lane]) << at;
            }
        };
        // The other direction has its left where the own one has its right.
        let (own_lanes, other_lanes) = (0..n_own, n_own + n_centre..steps.len());
        if self.side == TrafficSide::Left {
            take(&mut own_tags, own_lanes.collect());
            take(&mut other_tags, other_lanes.rev().collect());
        } else {
            take(&mut own_tags, own_lanes.rev().collect());
            take(&mut other_tags, other_lanes.collect());
        }
        (own_tags, other_tags)
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
    fn lanes(&self, direction: Direction, tags: &LaneTags, count: u8) -> Vec<LayoutSegment> {
        let number = match count.max(tags.listed) {
            0 => self.class.lanes,
            number => number,
        };
        let most_m = tags.most_m(number);
        let lane = |at| {
            let width_m = tags.width_m(at);
            let lane = LayoutSegment::new(Some(direction), Use::Lane(direction));
            LayoutSegment { width_m, listed: width_m.is_some(), most_m: most_m.filter(|_| width_m.is_none()), ..lane }
        };
        let mut lanes: Vec<LayoutSegment> = (0..usize::from(number)).map(lane).collect();
        if tags.listed > 0 {
            self.close(&mut lanes, tags, count);
        }
        if tags.closed == 0 {
            self.lanes_from_kerb(&mut lanes).take(usize::from(tags.bus)).for_each(|lane| lane.used = Use::Paved);
            let from_middle = usize::from(number.saturating_sub(tags.hov));
            self.lanes_from_kerb(&mut lanes).skip(from_middle).for_each(|lane| lane.used = Use::Paved);
        }
        lanes
    }

    /// Closes listed lanes. `lanes` excludes cycle lanes and lane lists include them, so the difference is the number of
    /// cycle lanes.
    fn close(&self, lanes: &mut [LayoutSegment], tags: &LaneTags, count: u8) {
        let shorter = tags.listed < count;
        let listed = usize::from(tags.listed);
        let all_closed = shorter && (0..listed).all(|at| tags.is_closed(at));
        let closed: Vec<bool> = (0..lanes.len()).map(|at| tags.is_closed(at) || all_closed).collect();
        let number = closed.iter().filter(|&&closed| closed).count() as u8;
        let (mut cycle_lanes, mut narrow) = if count > 0 {
            let more = tags.listed.saturating_sub(count);
            (more, more.saturating_sub(number))
        } else {
            let tagged = self.tags.kerbs.iter().filter(|kerb| kerb.cycle_dm > 0).count() as u8;
            (tags.listed, tagged.saturating_sub(number))
        };
        let mut order: Vec<usize> = (0..lanes.len()).collect();
        if self.side == TrafficSide::Right {
            order.reverse();
        }
        for at in order {
            let too_narrow = lanes[at].width_m.is_some_and(|width_m| width_m < *LANE_M.start());
            if closed[at] {
                lanes[at].used = if cycle_lanes > 0 { Use::Aside } else { Use::Paved };
                cycle_lanes = cycle_lanes.saturating_sub(1);
            } else if too_narrow && narrow > 0 {
                lanes[at].used = Use::Aside;
                narrow -= 1;
            }
        }
    }

    /// The lanes of one direction (in direction of travel) from the kerb to the middle.
    fn lanes_from_kerb<'l>(
        &self,
        lanes: &'l mut [LayoutSegment],
    ) -> Box<dyn Iterator<Item = &'l mut LayoutSegment> + 'l> {
        if self.side == TrafficSide::Left { Box::new(lanes.iter_mut()) } else { Box::new(lanes.iter_mut().rev()) }
    }
}

fn opposite(direction: Direction) -> Direction {
    match direction {
        Direction::Forward => Direction::Backward,
        Direction::Backward => Direction::Forward,
    }
}
