//! What an export is asked for.

use std::path::PathBuf;

use jiff::civil::DateTime;

use super::permit::PermitPolicy;
use crate::osm::facts::Policy;

/// What to export. The vehicle and its turns must be certified under the policy.
#[derive(Debug, Clone, PartialEq)]
pub struct Ask {
    /// The database.
    pub db: PathBuf,
    /// Vehicle id.
    pub vehicle: String,
    /// The policy of the certificates.
    pub policy: Policy,
    /// The conditions beyond a safe certificate.
    pub rule: PermitPolicy,
    /// The local time of the permits. `None`: they hold at all times.
    pub at: Option<DateTime>,
    /// The extract that the database was made from, for targets that need it.
    pub extract: Option<PathBuf>,
    /// The vehicle to compare with, for targets that have columns. It must be certified like `vehicle`. No permit depends on it.
    pub relative_to: Option<String>,
}
