//! The steer axles of the rides of a sweep, a block of head stations at a time.

use super::block::BLOCK;
use super::lanes::{LANES, Vector};
use super::ride::Ride;
use super::track::Track;

/// The steer axles of a block's lanes at its head stations and at the next two.
pub(super) struct SteerPaths {
    x: [[f64; LANES]; BLOCK + 2],
    y: [[f64; LANES]; BLOCK + 2],
    /// The tracks' first headings.
    pub(super) heading: [[f64; LANES]; 2],
    /// 1 over the square of the spacing, 1/m².
    pub(super) per_step2: [f64; LANES],
    /// Stations driven.
    driven: usize,
}

impl SteerPaths {
    /// Before the first block.
    pub(super) fn new(rides: &[&Ride<'_>]) -> Self {
        let lanes = |of: &dyn Fn(&Track) -> f64| std::array::from_fn(|lane| of(rides[lane.min(rides.len() - 1)].track));
        let per_step2 = lanes(&|track| 1.0 / (track.spacing * track.spacing));
        let heading =
            [lanes(&|track| track.fields.tangent_x[track.lead]), lanes(&|track| track.fields.tangent_y[track.lead])];
        Self { x: [[0.0; LANES]; BLOCK + 2], y: [[0.0; LANES]; BLOCK + 2], heading, per_step2, driven: 0 }
    }

    /// Moves on to the next block. A ride that has ended goes straight on.
    pub(super) fn next_block(&mut self, rides: &[&Ride<'_>]) {
        for (lane, ride) in rides.iter().enumerate() {
            let (f, shift, last) = (&ride.track.fields, ride.shift, ride.track.len() - 1);
            let head = ride.track.first_head + self.driven;
            for (k, (x, y)) in self.x.iter_mut().zip(&mut self.y).enumerate() {
                let at = (head + k).min(last);
                let beyond = (head + k - at) as f64 * ride.track.spacing;
                x[lane] = f.x[at] - shift[at] * f.tangent_y[at] + beyond * f.tangent_x[at];
                y[lane] = f.y[at] + shift[at] * f.tangent_x[at] + beyond * f.tangent_y[at];
            }
        }
        for place in self.x.iter_mut().chain(&mut self.y) {
            let last = place[rides.len() - 1];
            place[rides.len()..].fill(last);
        }
        self.driven += BLOCK;
    }

    #[inline(always)]
    pub(super) fn at<V: Vector>(&self, k: usize) -> (V, V) {
        (V::from(self.x[k]), V::from(self.y[k]))
    }
}
