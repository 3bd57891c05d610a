//! The component of the roads in which a vehicle can drive from everywhere to everywhere, and what joins it when more is open.

use super::joints::{CLOSED, Item, JointStep, Joints, OPEN, Sense};
use crate::network::EdgeNo;

/// The roads from which one edge can be reached and that can be reached from it.
pub(super) struct Component {
    /// By edge: whether a way leads there.
    pub(super) there: Vec<bool>,
    /// By edge: whether a way leads back.
    pub(super) back: Vec<bool>,
}

/// Room for one flood after another, without clearing between them.
pub(super) struct FloodBuffers {
    round: u32,
    extra: Vec<u32>,
    there: Vec<u32>,
    back: Vec<u32>,
    open: Vec<EdgeNo>,
}

impl FloodBuffers {
    pub(super) fn new(joints: &Joints) -> Self {
        let edges = joints.edges();
        Self { round: 0, extra: vec![0; joints.items()], there: vec![0; edges], back: vec![0; edges], open: Vec::new() }
    }
}

impl Component {
    /// The component of an edge over everything that is open.
    pub(super) fn of(joints: &Joints, prices: &[u32], edge: EdgeNo) -> Self {
        let flood = |sense: Sense| {
            let mut seen = vec![false; joints.edges()];
            let mut open = vec![edge];
            seen[edge.index()] = true;
            while let Some(at) = open.pop() {
                let mut visit = |step: JointStep, next: EdgeNo| {
                    let usable = prices[step.item as usize] == OPEN && prices[next.index()] == OPEN;
                    if usable && !std::mem::replace(&mut seen[next.index()], true) {
                        open.push(next);
                    }
                };
                match sense {
                    Sense::Ahead => joints.after(at).for_each(|step| visit(step, step.to)),
                    Sense::Back => joints.before(at).for_each(|step| visit(step, step.from)),
                }
            }
            seen
        };
        Self { there: flood(Sense::Ahead), back: flood(Sense::Back) }
    }

    /// Whether an edge belongs to the component.
    pub(super) fn has(&self, edge: EdgeNo) -> bool {
        self.there[edge.index()] && self.back[edge.index()]
    }

    /// The sum of `lengths_m` over the edges of the component.
    pub(super) fn length_m(&self, lengths_m: &[f64]) -> f64 {
        // The fold begins at 0.0, because an empty `sum` of floats is -0.0.
        let on = EdgeNo::all().zip(lengths_m).filter(|(edge, _)| self.has(*edge));
        on.map(|(_, length_m)| length_m).fold(0.0, |sum, m| sum + m)
    }

    /// The length of what joins the component if `items` are open, too.
    pub(super) fn joined_m(
        &self,
        joints: &Joints,
        prices: &[u32],
        items: &[Item],
        lengths_m: &[f64],
        scratch: &mut FloodBuffers,
    ) -> f64 {
        scratch.round += 1;
        let FloodBuffers { round, extra, there, back, open } = scratch;
        for &item in items.iter().filter(|&&item| prices[item as usize] != CLOSED) {
            extra[item as usize] = *round;
        }
        let is_open = |item: Item| prices[item as usize] == OPEN || extra[item as usize] == *round;
        let mut joined_m = 0.0;
        for sense in [Sense::Ahead, Sense::Back] {
            let ahead = sense == Sense::Ahead;
            let (known, seen) = if ahead { (&self.there, &mut *there) } else { (&self.back, &mut *back) };
            open.clear();
            for &item in items {
                // Where the item is an edge, any step onto it; else its own step.
                let edge = (item as usize) < joints.edges();
                let from_edge: Vec<JointStep> = match (edge, ahead) {
                    (true, true) => joints.before(EdgeNo::new(item)).collect(),
                    (true, false) => joints.after(EdgeNo::new(item)).collect(),
                    (false, _) => joints.step(item).into_iter().collect(),
                };
                for step in from_edge {
                    let (at, next) = if ahead { (step.from, step.to) } else { (step.to, step.from) };
                    let usable = is_open(step.item) && is_open(at.get()) && is_open(next.get());
                    if usable && known[at.index()] && !known[next.index()] && seen[next.index()] != *round {
                        seen[next.index()] = *round;
                        open.push(next);
                    }
                }
            }
            let mut done = 0;
            while let Some(&at) = open.get(done) {
                done += 1;
                let mut visit = |step: JointStep, next: EdgeNo| {
                    let new = !known[next.index()] && seen[next.index()] != *round;
                    if new && is_open(step.item) && is_open(next.get()) {
                        seen[next.index()] = *round;
                        open.push(next);
                    }
                };
                match sense {
                    Sense::Ahead => joints.after(at).for_each(|step| visit(step, step.to)),
                    Sense::Back => joints.before(at).for_each(|step| visit(step, step.from)),
                }
            }
            if ahead {
                // What is reached now and led back before, or leads back now, too, is found below.
                let both = open.iter().filter(|&&edge| self.back[edge.index()]);
                joined_m += both.map(|&edge| lengths_m[edge.index()]).fold(0.0, |sum, m| sum + m);
            } else {
                let both = open.iter().filter(|&&edge| self.there[edge.index()] || there[edge.index()] == *round);
                joined_m += both.map(|&edge| lengths_m[edge.index()]).fold(0.0, |sum, m| sum + m);
            }
        }
        joined_m
    }
}
