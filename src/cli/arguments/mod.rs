//! Arguments that several verbs take.

pub(crate) mod area;
pub(crate) mod certify_options;
pub(crate) mod position;
pub(crate) mod relative;
pub(crate) mod values;
pub(crate) mod vehicle_args;
pub(crate) mod vehicle_files;
