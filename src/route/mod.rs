//! Routes: the shortest way over edges and turns that a vehicle may use, with one certificate over the whole of it.
//!
//! Promises that no route is returned without a `safe` certificate over its concatenated corridor, made by the same call
//! as any other; that no restriction is broken; and that where there is no route, what blocks is named. Leaves out:
//! turning back on the road, and traffic.
//!
//! | file | for |
//! | --- | --- |
//! | `speeds` | what an edge costs |
//! | `bans` | restrictions over ways, as an automaton |
//! | `permits`, `stored` | what a vehicle may use |
//! | `roads`, `driver` | what planners share: the roads, and a vehicle with its permits |
//! | `graph` | edges, movements and passages of roundabouts as a graph |
//! | `drive` | the edges of a way, and which are driven as part of a passage |
//! | `search` | the shortest way |
//! | `snap` | from a place to the road |
//! | `pieces` | strokes and turns that a corridor is made of |
//! | `turning` | turns made as a route asks for them |
//! | `assemble`, `blend` | from pieces to one corridor |
//! | `plan` | search, certify, leave out, search on; alternatives |
//! | `obstacles` | what blocks |
//! | `report` | an answer as JSON and GeoJSON |
//! | `reach` | where one can get to, and back |

mod assemble;
mod bans;
mod blend;
mod drive;
mod driver;
mod graph;
mod obstacles;
mod permits;
mod pieces;
mod plan;
mod reach;
mod report;
mod roads;
mod search;
mod snap;
mod speeds;
mod stored;
mod turning;

pub use assemble::{AssemblyError, Part, PartKind, RoutePath, Way, assemble, passes_over};
pub use bans::{Bans, Within};
pub use drive::{Drive, Join};
pub use driver::Driver;
pub use graph::{Access, BARRED, Graph};
pub use obstacles::Obstacle;
pub use permits::{Permit, Permits};
pub use pieces::{Menu, NoTurns, Strokes, TurnPiece, Turns};
pub use plan::{Answer, Planner, Question, Refutation, Route, Unanswered};
pub use reach::{Components, Reach, components, reach, with_edge};
pub use report::{PartResult, geojson, json, obstacle_members, place, title};
pub use roads::Roads;
pub use search::{Found, Goal, Start, search, search_over};
pub use snap::{Position, SnapError, Snapped, Snapper};
pub use speeds::{Measure, Speeds, SpeedsError};
pub use stored::NoDriver;
pub use turning::MadeTurns;
