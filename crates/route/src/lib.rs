//! Plans routes: the best way over edges and turns that a vehicle may use, with one certificate over the whole route.
//!
//! Every returned route has a `safe` certificate over its joined corridor, made by the same function as any other certificate.
//! No route breaks a turn restriction. If there is no route, the answer names what blocks it. Turning back on the road is not
//! planned, and traffic is ignored.
//!
//! | file | for |
//! | --- | --- |
//! | `speeds` | the cost of an edge |
//! | `bans` | restrictions over ways, as an automaton |
//! | `permits`, `database` | what a vehicle may use |
//! | `roads`, `driver` | what planners share: the roads, and a vehicle with its permits |
//! | `graph` | edges, movements and passages as a graph |
//! | `drive` | the edges of a way, and the arcs of passages among them |
//! | `search` | the shortest way |
//! | `snap` | the nearest point on a road to a place |
//! | `pieces` | strokes and turns, the pieces of a corridor |
//! | `turning` | turns that are made when a route needs them |
//! | `assemble`, `blend`, `grounds` | one corridor from pieces, with the areas of their turns |
//! | `whole` | the certificate of a whole way, and where it fails |
//! | `route` | a certified route, and its parts |
//! | `rungs` | the strip on which each edge and turn is used |
//! | `ladder` | one vehicle with its permits under several policies |
//! | `climb` | what stands higher on a way that fails |
//! | `look` | finds the failing parts of a way that climbs |
//! | `turn_ends` | the edges that name a turn |
//! | `rung_prices` | what it costs a route to use more than its own lane |
//! | `strip_use` | where a certified route uses more than its own lane, and how far |
//! | `title` | titles and places of edges, turns and passages |
//! | `plan` | searches, certifies, leaves out what failed, and searches again; alternatives |
//! | `obstacles` | what blocks a route, and on which way |
//! | `at_most` | how high a route may climb |
//! | `attested` | where a sign or the register says that the vehicle goes |
//! | `conditions` | what has to hold on site so that a way is certified |
//! | `conditional_search` | the way with the fewest and smallest conditions |
//! | `nearest_road` | the road beside a place, and why it may not be used |
//! | `best` | certified routes, else one under conditions |
//! | `report` | an answer as JSON and GeoJSON |
//! | `gpx` | an answer as GPX |
//! | `relative` | an answer beside a reference vehicle |
//! | `survey` | which measurements would open most |
//! | `through` | roads that are open at the ends of a route only |
//! | `reach` | what can be reached from a place, and back |

use netcert_base::{stop, vehicle, verdict, words};
use netcert_certify as certify;
use netcert_certify::reporter;
use netcert_evidence as evidence;
use netcert_kernel::stet;
use netcert_osm::osm;
use netcert_roads::{corridor, network, turns};
use netcert_rows as rows;
use netcert_rows::settings;
use netcert_store as store;

mod assemble;
mod at_most;
mod attested;
mod bans;
mod best;
mod blend;
mod climb;
mod conditional_search;
mod conditions;
mod database;
mod drive;
mod driver;
mod gpx;
mod graph;
mod grounds;
mod ladder;
mod look;
mod nearest_road;
mod obstacles;
mod permits;
mod pieces;
mod plan;
mod reach;
mod relative;
mod report;
mod roads;
mod route;
mod rung_prices;
mod rungs;
mod search;
mod snap;
mod speeds;
mod strip_use;
mod survey;
mod through;
mod title;
mod turn_ends;
mod turning;
mod whole;

pub use assemble::{AssemblyError, DrivenWay, PartKind, RoutePart, RoutePath, assemble, passes_over};
pub use at_most::{AtMost, Conditions};
pub use attested::Attested;
pub use bans::{Bans, Within};
pub use conditional_search::Hopeless;
pub use conditions::{Condition, ConditionAt, Conditional, SHEET_COLUMNS, sheet_csv, sheet_features, sheet_geojson};
pub use database::NoDriver;
pub use drive::{Drive, Join};
pub use driver::Driver;
pub use gpx::{GpxError, GpxFacts, gpx};
pub use graph::{Access, BARRED, Graph};
pub use ladder::{Ladder, UnlikeSets};
pub use nearest_road::NearestRoad;
pub use obstacles::{Basis, BlockedWay, Obstacle, Refutation};
pub use permits::{Permit, Permits};
pub use pieces::{Menu, NoTurns, Strokes, TurnPiece, Turns};
pub use plan::{Answer, Planner, Question, Unanswered};
pub use reach::{Components, ReachableEdges, components, reach, with_edge};
pub use relative::{Comparison, Peer, Standings};
pub use report::{CONDITIONAL, condition_members, geojson, json, obstacle_members, use_members};
pub use roads::Roads;
pub use route::{LimitedStretch, PartResult, Route};
pub use rung_prices::{RungPrices, RungPricesError};
pub use rungs::Rungs;
pub use search::{FoundWay, Goal, SearchExtent, Start, search, search_over};
pub use snap::{Position, SnapError, Snapped, Snapper, foot};
pub use speeds::{Measure, Speeds, SpeedsError};
pub use strip_use::{StripUse, UsePlace};
pub use survey::{
    Opens, Pairs, PlacePair, SURVEY_COLUMNS, SURVEY_SCOPE, Survey, SurveyLine, SurveyStep, survey_pairs, survey_region,
};
pub use title::{place, title};
pub use turn_ends::TurnEnds;
pub use turning::MadeTurns;
