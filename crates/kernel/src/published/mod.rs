//! The paper to the letter: Faruqui, Das, Kumar L, Jagtap, *Spatiotemporal Tube-Based Safety-Certificate for Autonomous
//! Navigation of Articulated Vehicles*. There is one file per subject. Nothing here decides anything.
//!
//! Each public item holds a printed formula and names its number; equations are counted through the paper's source.
//! Where the print cannot be right, [`Reading`] switches to the repaired form, fault by fault. `docs/errata.md` shows
//! each fault in numbers. This module is independent of [`crate::stet`], which decides.
//!
//! | file | in the paper |
//! | --- | --- |
//! | `plane`, `system` | vectors of the plane; Σ, the paper's vehicle |
//! | `reading` | the print to the letter, or with faults repaired |
//! | `ellipse` | Def. 1, Eq. 1-2: 𝓔(q, Q), support radius |
//! | `route` | Def. 2, Eq. 3-4: 𝓡(t), 𝒫_l, 𝒫_r |
//! | `kinematics` | Def. 4, Eq. 5-8: κ_i, ι_i, Ω, Ξ over sway tuples |
//! | `lipschitz` | Assumption 1, Eq. 9, and the constants of Def. 6 |
//! | `reach` | Eq. 10-15: 𝓜_i, 𝓗_i, D, a_i, b_i, Q^lim |
//! | `sum` | Eq. 16-18: the Kurzhanski-Varaiya bound, β |
//! | `leeway` | Def. 5, Eq. 19-20 |
//! | `corrections` | Def. 6: CORRCEN, SHRINK |
//! | `route_cert` | Algorithm 1 |
//! | `theorem` | the Theorem, Eq. 21-23 |
//! | `rsc` | the Corollary, Eq. 24-25: CERT, 𝒞, h_Ω, h_Ξ, w_min |
//! | `table`, `drawn_route` | Table I, and netcert's own route, as long as the paper's |
//! | `radius` | r_N^max of a vehicle of the catalogue, for the column `rsc_published_m` |
//!
//! The paper leaves some points open. They are read here as follows:
//!
//! - ê_i(t) is the velocity's direction at q_i(t). With δ = 0 throughout, as in Eq. 16, trailers swing *out* of every
//!   bend. With the δ̂(t) of rolling wheels Eq. 6-8 are the real motion. [`Sway`] chooses between the two.
//! - r_0 comes from half the dimensions 𝒟: the paper says "prime mover dimensions with margins" without naming the
//!   margins.
//! - CORRCEN shifts by half the difference of the leeways, and SHRINK shrinks by what is missing (`corrections`).
//!   Δq_0^max and γ_0^min have no values in the paper.
//! - Σ has one L, θ and 𝒟 for all units, and couplings over axles.

mod corrections;
mod drawn_route;
mod ellipse;
mod kinematics;
mod leeway;
mod lipschitz;
mod plane;
mod radius;
mod reach;
mod reading;
mod route;
mod route_cert;
mod rsc;
mod sum;
mod system;
mod table;
mod theorem;

pub use corrections::{Permissible, corrcen, shrink};
pub use drawn_route::{DrawnError, DrawnRoute, drawn_route};
pub use ellipse::{EllipseMatrix, Stet};
pub use kinematics::{KinematicChain, Link, follower_centre, follower_shape, no_slip_sway};
pub use leeway::{Leeway, boundary_leeway};
pub use lipschitz::{Axes, centre_constant, shape_constant};
pub use plane::link_direction;
pub use radius::last_radius_m;
pub use reach::{in_reachable_set, peak_sways_m, reach_displacement, sway_displacement, sway_ellipse, sway_shape};
pub use reading::{As, Beta, Offset, Reading, Sway};
pub use route::TimedRoute;
pub use route_cert::{Correction, LoopInstant, RouteCert, route_cert};
pub use rsc::{Rsc, cert};
pub use sum::{kurzhanski_varaiya, optimal_beta};
pub use system::System;
pub use table::{Scenario, TableError, scenarios};
pub use theorem::{bound_m, worst_side};
