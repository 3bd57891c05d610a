//! The certificate of one vehicle on one corridor. The crate is pure: no input or output, and no clock but that of the guard that ends work
//! which takes too long ([`netcert_base::watch`]). No result depends on the number of threads.
//!
//! [`stet`] decides. [`published`] is the paper's own certificate to the letter and decides nothing.

// `stet/lanes/` uses instructions that not every processor has. It asks first.
#![allow(unsafe_code)]

pub mod published;
pub mod stet;
