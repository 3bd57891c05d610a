//! What a certification is told.

use crate::network::Network;
use crate::settings::Settings;
use crate::stet::Model;

/// Inputs of a certification.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The road network.
    pub network: &'a Network,
    /// The vehicles.
    pub models: &'a [Model],
    /// Settings of the certificates.
    pub settings: &'a Settings,
}
