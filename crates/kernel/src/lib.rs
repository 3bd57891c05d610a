//! The certificate of one vehicle on one corridor. The crate is pure: no input or output, no clock, no threads.
//!
//! [`stet`] decides. [`published`] is the paper's own certificate to the letter and decides nothing.

// For instructions of a processor that is asked first (`stet/lanes.rs`).
#![allow(unsafe_code)]

pub mod published;
pub mod stet;
