//! The state that all requests share: the current region, the cache of finished answers, and the lanes for work.

use std::sync::{Arc, Mutex, PoisonError, RwLock};

use axum::response::{IntoResponse as _, Response};

use super::answer::{Keep, Stored};
use super::ask::{Ask, STATE};
use super::cache::Cache;
use super::lines;
use super::older::Older;
use super::options::Options;
use super::problem::Problem;
use super::region::{Identity, Region};
use super::tiles;
use super::work::Lane;

/// The application.
pub(super) struct App {
    pub(super) options: Options,
    region: RwLock<Arc<Region>>,
    /// Locked while a changed file is read, so that one request reads it and the others wait.
    reading: Mutex<()>,
    cache: Cache,
    quick: Lane,
    slow: Lane,
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
    pub(super) fn new(options: Options, region: Region) -> Self {
        let limits = options.limits;
        let (quick, slow) = (limits.quick, limits.slow);
        Self {
            region: RwLock::new(Arc::new(region)),
            reading: Mutex::new(()),
            cache: Cache::new(limits.cache_bytes),
            quick: Lane::new(quick.at_a_time, quick.waiting, quick.time),
            slow: Lane::new(slow.at_a_time, slow.waiting, slow.time),
            options,
        }
    }

    /// The region of the current file. Reads the file if it has changed.
    async fn region(self: &Arc<Self>) -> Result<Arc<Region>, Problem> {
        if let Some(known) = self.unchanged()? {
            return Ok(known);
        }
        let app = Arc::clone(self);
        let read = move |_| {
            let _reading = app.reading.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(read) = app.unchanged()? {
                return Ok(read);
            }
            let known = Arc::clone(&app.region.read().unwrap_or_else(PoisonError::into_inner));
            let before = app.options.before.as_deref();
            let older = before.map(|path| Older::open(path, known.older.as_ref())).transpose()?;
            let region = Region::open(&app.options.db, older)?.holding(app.options.limits.held_edges);
            let region = Arc::new(region);
            *app.region.write().unwrap_or_else(PoisonError::into_inner) = Arc::clone(&region);
            lines::read_anew(&app.options.db);
            Ok(region)
        };
        self.quick.run(read).await
    }

    /// The known region, if neither the file nor the older one has changed since they were read.
    fn unchanged(&self) -> Result<Option<Arc<Region>>, Problem> {
        let known = Arc::clone(&self.region.read().unwrap_or_else(PoisonError::into_inner));
        let same = Identity::of(&self.options.db)? == known.identity;
        let older = self.options.before.as_deref().map(|path| Identity::of(path).ok());
        let same_older = older.as_ref() == known.older.as_ref().map(|older| &older.identity);
        Ok((same && same_older).then_some(known))
    }

    /// Loads in advance what the first tiles need.
    pub(super) async fn first_map(self: &Arc<Self>) {
        let Ok(region) = self.region().await else { return };
        // An error is ignored here; the first request that needs the roads gets it.
        let _ = self.slow.run(move |_| region.first_map()).await;
    }

    /// Makes the overviews in advance, which the first map of each vehicle needs.
    pub(super) async fn prepare(self: &Arc<Self>) {
        let Ok(region) = self.region().await else { return };
        // An error is ignored here; the first request that needs an overview gets it.
        let _ = self.slow.run(move |stop| tiles::prepare(&region, &stop)).await;
    }

    /// Loads in advance what tiles of deeper zooms, and the first explanation, route and search need.
    pub(super) async fn warm_up(self: Arc<Self>) {
        let Ok(region) = self.region().await else { return };
        // An error is ignored here; the first request that needs the roads gets it.
        let _ = self.slow.run(move |stop| region.warm_up(&stop)).await;
    }

    /// Answers from the cache, or does the work and caches the answer.
    pub(super) async fn answer(
        self: &Arc<Self>,
        ask: Ask,
        pace: Pace,
        work: impl FnOnce(&Region, &Ask) -> Result<Stored, Problem> + Send + 'static,
    ) -> Response {
        match self.try_answer(&ask, pace, work).await {
            Ok((stored, keep)) => stored.respond(&ask, keep),
            Err(problem) => problem.into_response(),
        }
    }

    async fn try_answer(
        self: &Arc<Self>,
        ask: &Ask,
        pace: Pace,
        work: impl FnOnce(&Region, &Ask) -> Result<Stored, Problem> + Send + 'static,
    ) -> Result<(Arc<Stored>, Keep), Problem> {
        let region = self.region().await?;
        let keep = if ask.parameter(STATE) == Some(&region.state) { Keep::ForEver } else { Keep::Ask };
        let key = format!("{} {}", region.state, ask.key());
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
                let stored = Arc::new(work(&region, &asked)?);
                app.cache.put(&key, Arc::clone(&stored));
                Ok(stored)
            })
            .await?;
        Ok((stored, keep))
    }
}
