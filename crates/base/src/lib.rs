//! Types that prover, checker and simulator share: vehicles, corridors, verdicts. This crate computes no certificates
//! and knows neither maps nor databases.

pub mod corrections;
pub mod corridor;
pub mod leeway;
pub mod speed_profile;
pub mod stop;
pub mod vehicle;
pub mod verdict;
pub mod watch;
pub mod words;
pub mod work_count;
