//! Fits sections on several threads. Each thread has a fitter with a network of its own, because what is supposed is written into the
//! network. Answers do not depend on which fitter gives them.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::fitter::Fitter;
use crate::stop::Stopped;

/// The greatest number of fitters, and of edges in all their copies of the network together. In Heidelberg an edge takes 1.4 kilobytes.
const MOST_HELPERS: usize = 8;
const MOST_EDGES: usize = 1_000_000;

impl Fitter {
    /// Does `count` pieces of work, and returns their results in order.
    pub(super) fn together<T: Send>(
        &mut self,
        count: usize,
        work: impl Fn(&mut Self, usize) -> Result<T, Stopped> + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let copies = MOST_EDGES / self.roads.network.edges.len().max(1);
        let threads = rayon::current_num_threads().min(MOST_HELPERS).min(copies).min(count);
        if threads < 2 {
            return (0..count).map(|at| work(self, at)).collect();
        }
        while self.helpers.len() < threads {
            let (base, stroke_of) = (Arc::clone(&self.base), Arc::clone(&self.stroke_of));
            self.helpers.push(Self::beside(&self.roads, &self.driver, base, stroke_of));
        }
        let (next, (send, receive)) = (AtomicUsize::new(0), std::sync::mpsc::channel());
        rayon::scope(|scope| {
            for helper in self.helpers.iter_mut().take(threads) {
                let (send, next, work) = (send.clone(), &next, &work);
                scope.spawn(move |_| {
                    loop {
                        let at = next.fetch_add(1, Ordering::Relaxed);
                        // Nobody hangs up before all work is done.
                        if at >= count || send.send((at, work(helper, at))).is_err() {
                            return;
                        }
                    }
                });
            }
        });
        drop(send);
        let mut done: Vec<(usize, Result<T, Stopped>)> = receive.into_iter().collect();
        done.sort_by_key(|(at, _)| *at);
        done.into_iter().map(|(_, result)| result).collect()
    }
}
