//! The state that all requests share: what is served now, the cache of finished answers, and the lanes for work.

use std::sync::{Arc, Mutex, PoisonError, RwLock};

use axum::response::{IntoResponse as _, Response};

use super::answer::{Keep, StoredAnswer};
use super::ask::{DecodedRequest, STATE};
use super::cache::Cache;
use super::lines;
use super::older::OlderState;
use super::options::ServerOptions;
use super::problem::Problem;
use super::region::{Identity, RegionState};
use super::state::ServedState;
use super::work::Lane;

/// The application.
pub(super) struct App {
    pub(super) options: ServerOptions,
    served: RwLock<Arc<ServedState>>,
    /// Locked while a changed file is read, so that one request reads it and the others wait.
    reading: Mutex<()>,
    cache: Cache,
    quick: Lane,
    slow: Lane,
    changes: Lane,
}

/// The lane for a piece of work.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pace {
    /// For work that reads some rows.
    Quick,
    /// For work that certifies or reads the whole database.
    Slow,
}

impl App {
    pub(super) fn new(options: ServerOptions, served: ServedState) -> Self {
        let limits = options.limits;
        let (quick, slow, changes) = (limits.quick, limits.slow, limits.changes);
        Self {
            served: RwLock::new(Arc::new(served)),
            reading: Mutex::new(()),
            cache: Cache::new(limits.cache_bytes),
            quick: Lane::new(quick.at_a_time, quick.waiting, quick.time),
            slow: Lane::new(slow.at_a_time, slow.waiting, slow.time),
            changes: Lane::new(changes.at_a_time, changes.waiting, changes.time),
            options,
        }
    }

    /// What is served of the current file. Reads the file if it has changed.
    async fn served(self: &Arc<Self>) -> Result<Arc<ServedState>, Problem> {
        if let Some(known) = self.unchanged()? {
            return Ok(known);
        }
        let app = Arc::clone(self);
        let read = move |_| {
            let _reading = app.reading.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(read) = app.unchanged()? {
                return Ok(read);
            }
            let known = Arc::clone(&app.served.read().unwrap_or_else(PoisonError::into_inner));
            let before = app.options.before.as_deref();
            let older = before.map(|path| OlderState::open(path, known.older.as_ref())).transpose()?;
            let region = RegionState::open(&app.options.db)?.holding(app.options.limits.held_edges);
            let served = Arc::new(ServedState::new(region, older));
            *app.served.write().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&served);
            lines::read_anew(&app.options.db);
            Ok(served)
        };
        self.quick.run(read).await
    }

    /// What is served, if neither the file nor the older one has changed since they were read.
    fn unchanged(&self) -> Result<Option<Arc<ServedState>>, Problem> {
        let known = Arc::clone(&self.served.read().unwrap_or_else(PoisonError::into_inner));
        let same = Identity::of(&self.options.db)? == known.region.identity;
        let older = self.options.before.as_deref().map(|path| Identity::of(path).ok());
        let same_older = older.as_ref() == known.older.as_ref().map(|older| &older.identity);
        Ok((same && same_older).then_some(known))
    }

    /// Loads in advance what the first tiles need.
    pub(super) async fn first_map(self: &Arc<Self>) {
        let Ok(served) = self.served().await else { return };
        // An error is ignored here; the first request that needs the roads gets it.
        let _ = self.slow.run(move |_| served.region.first_map()).await;
    }

    /// Makes the overviews in advance, which the first map of each vehicle needs.
    pub(super) async fn prepare(self: &Arc<Self>) {
        let Ok(served) = self.served().await else { return };
        // An error is ignored here; the first request that needs an overview gets it.
        let _ = self.slow.run(move |stop| served.overviews.prepare(&served.region, &stop)).await;
    }

    /// Loads in advance what tiles of deeper zooms, and the first explanation, route and search need.
    pub(super) async fn warm_up(self: Arc<Self>) {
        let Ok(served) = self.served().await else { return };
        // An error is ignored here; the first request that needs the roads gets it.
        let _ = self.slow.run(move |stop| served.region.warm_up(&stop)).await;
    }

    /// Answers from the cache, or does the work and caches the answer.
    pub(super) async fn answer(
        self: &Arc<Self>,
        ask: DecodedRequest,
        pace: Pace,
        work: impl FnOnce(&ServedState, &DecodedRequest) -> Result<StoredAnswer, Problem> + Send + 'static,
    ) -> Response {
        match self.try_answer(&ask, pace, work).await {
            Ok((stored, keep)) => stored.respond(&ask, keep),
            Err(problem) => problem.into_response(),
        }
    }

    /// Changes the database, one change after the other. A change that was begun is finished, whoever goes away.
    pub(super) async fn change(
        self: &Arc<Self>,
        ask: DecodedRequest,
        work: impl FnOnce(&ServerOptions, &DecodedRequest) -> Result<StoredAnswer, Problem> + Send + 'static,
    ) -> Response {
        let (app, asked) = (Arc::clone(self), ask.clone());
        uncached(&ask, self.changes.run(move |_| work(&app.options, &asked)).await)
    }

    /// Answers a request with a body, which no cache keeps.
    pub(super) async fn suppose(
        self: &Arc<Self>,
        ask: DecodedRequest,
        work: impl FnOnce(&ServedState, &DecodedRequest) -> Result<StoredAnswer, Problem> + Send + 'static,
    ) -> Response {
        let served = match self.served().await {
            Ok(served) => served,
            Err(problem) => return problem.into_response(),
        };
        let mut asked = ask.clone();
        let answer = self.slow.run(move |stop| {
            asked.stop = stop;
            work(&served, &asked)
        });
        uncached(&ask, answer.await)
    }

    async fn try_answer(
        self: &Arc<Self>,
        ask: &DecodedRequest,
        pace: Pace,
        work: impl FnOnce(&ServedState, &DecodedRequest) -> Result<StoredAnswer, Problem> + Send + 'static,
    ) -> Result<(Arc<StoredAnswer>, Keep), Problem> {
        let served = self.served().await?;
        let keep = if ask.parameter(STATE) == Some(&served.state) { Keep::ForEver } else { Keep::Ask };
        let key = format!("{} {}", served.state, ask.key());
        if let Some(stored) = self.cache.get(&key) {
            return Ok((stored, keep));
        }
        let (app, mut asked) = (Arc::clone(self), ask.clone());
        let lane = match pace {
            Pace::Quick => &self.quick,
            Pace::Slow => &self.slow,
        };
        let stored = lane
            .run(move |stop| {
                asked.stop = stop;
                // Another request may have made the answer while this one waited.
                if let Some(stored) = app.cache.get(&key) {
                    return Ok(stored);
                }
                let stored = Arc::new(work(&served, &asked)?);
                app.cache.put(&key, Arc::clone(&stored));
                Ok(stored)
            })
            .await?;
        Ok((stored, keep))
    }
}

/// The response with an answer that no cache keeps.
fn uncached(ask: &DecodedRequest, made: Result<StoredAnswer, Problem>) -> Response {
    made.map_or_else(Problem::into_response, |stored| stored.respond(ask, Keep::Ask))
}
