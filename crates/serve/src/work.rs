//! Lanes for work that blocks: the database, certificates, pictures. A lane bounds how many pieces of work run at the same
//! time, how many may wait, and how long each may take.
//!
//! A lane never runs more work than its bound, even if clients have gone: a place is free again only when the work itself
//! has ended. Work whose time is up, or for which nobody waits any more, is told to stop; it stops at its next check. Slow
//! work has a lane of its own, so that it does not delay the map.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use tokio::sync::Semaphore;
use tokio::time::timeout;

use super::problem::Problem;
use crate::stop::Stop;

/// A lane with its bounds.
#[derive(Debug)]
pub(super) struct Lane {
    places: Arc<Semaphore>,
    waiting: AtomicUsize,
    most_waiting: usize,
    limit: Duration,
    at_a_time: usize,
    /// How long the last pieces of work took, a moving mean, milliseconds.
    mean_ms: AtomicU64,
}

/// Counts one waiting request while it lives.
struct Waiting<'l>(&'l AtomicUsize);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Tells work to stop when nobody waits for it any more.
struct StopOnDrop(Stop);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.tell();
    }
}

impl Lane {
    /// A lane that runs `at_a_time` pieces of work and lets `most_waiting` more wait. Each is answered within `limit`.
    pub(super) fn new(at_a_time: usize, most_waiting: usize, limit: Duration) -> Self {
        let places = Arc::new(Semaphore::new(at_a_time.max(1)));
        let (waiting, mean_ms) = (AtomicUsize::new(0), AtomicU64::new(0));
        Self { places, waiting, most_waiting, limit, at_a_time: at_a_time.max(1), mean_ms }
    }

    /// When half of a full queue is likely to be done: 1 to 10 seconds, which is as long as the page waits.
    fn relief(&self) -> Duration {
        let mean = Duration::from_millis(self.mean_ms.load(Ordering::Relaxed));
        let half = mean.mul_f64(self.most_waiting as f64 / (2 * self.at_a_time) as f64);
        half.clamp(Duration::from_secs(1), Duration::from_secs(10))
    }

    /// Takes the time of a piece of work into the mean.
    fn took(&self, time: Duration) {
        let (own, mean) = (u64::try_from(time.as_millis()).unwrap_or(u64::MAX), self.mean_ms.load(Ordering::Relaxed));
        let mean = if mean == 0 { own } else { (3 * (mean / 4)).saturating_add(own / 4) };
        self.mean_ms.store(mean, Ordering::Relaxed);
    }

    /// Runs `work` on a thread that may block. The given [`Stop`] tells the work when nobody waits for it any more.
    pub(super) async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce(Stop) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let begin = Instant::now();
        let place = {
            let waiting = Waiting(&self.waiting);
            if self.waiting.fetch_add(1, Ordering::Relaxed) >= self.most_waiting + self.places.available_permits() {
                let detail = format!("{} requests wait already; ask again in a moment", self.most_waiting);
                return Err(Problem::busy_for(detail, self.relief()));
            }
            let place = timeout(self.limit, Arc::clone(&self.places).acquire_owned()).await;
            drop(waiting);
            match place {
                Ok(Ok(place)) => place,
                Ok(Err(_)) => return Err(Problem::busy("the server is stopping")),
                Err(_) => {
                    let detail = "no place became free in time; ask again in a moment";
                    return Err(Problem::busy_for(detail, self.relief()));
                }
            }
        };
        let (awaited, started) = (StopOnDrop(Stop::default()), Instant::now());
        let stop = awaited.0.clone();
        let done = tokio::task::spawn_blocking(move || {
            let _place = place;
            work(stop)
        });
        let done = timeout(self.limit.saturating_sub(begin.elapsed()), done).await;
        self.took(started.elapsed());
        match done {
            Ok(Ok(result)) => result,
            Ok(Err(panicked)) => Err(Problem::fault(format!("the work was cut short: {panicked}"))),
            Err(_) => Err(Problem::too_slow(self.limit.as_secs_f64())),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use axum::http::StatusCode;

    fn runtime() -> tokio::runtime::Runtime {
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_time().build().unwrap()
    }

    #[test]
    fn never_more_at_a_time_than_there_are_places_and_none_is_lost() {
        let (now, most, done) = <(Arc<AtomicUsize>, Arc<AtomicUsize>, Arc<AtomicUsize>)>::default();
        let lane = Arc::new(Lane::new(3, 100, Duration::from_secs(20)));
        runtime().block_on(async {
            let mut all = tokio::task::JoinSet::new();
            for _ in 0..60 {
                let (lane, now, most, done) = (lane.clone(), now.clone(), most.clone(), done.clone());
                all.spawn(async move {
                    lane.run(move |_| {
                        most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        std::thread::sleep(Duration::from_millis(3));
                        now.fetch_sub(1, Ordering::SeqCst);
                        done.fetch_add(1, Ordering::SeqCst);
                        Ok(())
                    })
                    .await
                });
            }
            assert!(all.join_all().await.into_iter().all(|result| result.is_ok()));
        });
        assert_eq!((most.load(Ordering::SeqCst), done.load(Ordering::SeqCst)), (3, 60));
    }

    #[test]
    fn who_finds_the_queue_full_is_told_so_at_once() {
        let lane = Arc::new(Lane::new(1, 2, Duration::from_secs(20)));
        let refused = runtime().block_on(async {
            let mut all = tokio::task::JoinSet::new();
            for _ in 0..20 {
                let lane = lane.clone();
                all.spawn(async move {
                    lane.run(|_| {
                        std::thread::sleep(Duration::from_millis(100));
                        Ok(())
                    })
                    .await
                });
            }
            let results = all.join_all().await;
            results.into_iter().filter_map(Result::err).map(|problem| problem.status).collect::<Vec<_>>()
        });
        assert!(refused.len() >= 15, "{}", refused.len());
        assert!(refused.iter().all(|&status| status == StatusCode::SERVICE_UNAVAILABLE));
    }

    #[test]
    fn the_busier_a_lane_the_later_one_may_ask_again() {
        let lane = Lane::new(2, 16, Duration::from_secs(60));
        assert_eq!(lane.relief(), Duration::from_secs(1));
        lane.took(Duration::from_millis(800));
        assert_eq!(lane.relief(), Duration::from_millis(3200));
        for _ in 0..20 {
            lane.took(Duration::from_secs(30));
        }
        assert_eq!(lane.relief(), Duration::from_secs(10));
    }

    #[test]
    fn what_takes_too_long_keeps_its_place_until_it_has_ended() {
        let lane = Lane::new(1, 4, Duration::from_millis(60));
        runtime().block_on(async {
            let slow = |_| {
                std::thread::sleep(Duration::from_millis(200));
                Ok(())
            };
            assert_eq!(lane.run(slow).await.unwrap_err().status, StatusCode::GATEWAY_TIMEOUT);
            assert_eq!(lane.run(|_| Ok(())).await.unwrap_err().status, StatusCode::SERVICE_UNAVAILABLE);
            tokio::time::sleep(Duration::from_millis(250)).await;
            assert!(lane.run(|_| Ok(())).await.is_ok());
        });
    }

    /// The work never ends by itself, so its place becomes free only if the work is told to stop.
    #[test]
    fn who_is_cut_off_or_goes_away_frees_the_place() {
        let lane = Arc::new(Lane::new(1, 4, Duration::from_secs(20)));
        let hasty = Lane::new(1, 4, Duration::from_millis(60));
        let endless = |stop: Stop| -> Result<(), Problem> {
            while !stop.told() {
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(())
        };
        runtime().block_on(async {
            assert_eq!(hasty.run(endless).await.unwrap_err().status, StatusCode::GATEWAY_TIMEOUT);
            timeout(Duration::from_secs(20), async { while hasty.run(|_| Ok(())).await.is_err() {} }).await.unwrap();
            let gone = tokio::spawn({
                let lane = lane.clone();
                async move { lane.run(endless).await }
            });
            while lane.places.available_permits() > 0 {
                tokio::time::sleep(Duration::from_millis(1)).await;
            }
            gone.abort();
            assert!(lane.run(|_| Ok(())).await.is_ok());
        });
    }

    #[test]
    fn a_panic_is_a_fault_of_one_request_only() {
        let lane = Lane::new(1, 1, Duration::from_secs(5));
        runtime().block_on(async {
            let broken: Result<(), Problem> = lane.run(|_| std::panic::panic_any("broken")).await;
            assert_eq!(broken.unwrap_err().status, StatusCode::INTERNAL_SERVER_ERROR);
            assert!(lane.run(|_| Ok(())).await.is_ok());
        });
    }
}
