//! Pictures of corridors, vehicles and charts, as SVG text.
//!
//! The scale is true: a [`View`] never stretches one axis. The same input gives the same bytes (fixed decimals, no
//! clocks, no hash maps). The XML is well-formed for any name. People with any kind of colour vision can tell the
//! colours apart ([`palette`], with sources). Every picture has its own light background, so it looks the same on a
//! dark page. Text is not measured (its width is estimated), and there are no fonts and no animation.
//!
//! | file | for |
//! | --- | --- |
//! | `svg` | [`Picture`]: the document, and shapes in page units |
//! | `style` | appearance of shapes and texts |
//! | `view` | from metres (x east, y north) to the page |
//! | `palette` | colours, and colour scales for numbers |
//! | `lengths` | lengths in words, in metres or in feet and inches |
//! | `furniture` | dimension lines, arrows, scale bar, legend |
//! | `chart` | a curve over an axis |
//! | `bodies` | a vehicle from above |
//! | `turn` | a turn at a junction, with the vehicle all the way round |
//! | `explanation` | what limits a vehicle on a road |
//! | `vehicle` | a vehicle with its dimensions |
//! | `route` | the leeway along a route, and the route's shape |
//! | `route_uses` | where a route uses more than its own lane |
//! | `sheet` | a page to print: a route under conditions |
//! | `decision` | a page to file: whether one vehicle is certified on one way, or under which conditions |
//! | `manoeuvres` | the turns by which a vehicle is judged |
//! | `corners` | the corners that a vehicle takes |

use netcert_base::{verdict, words};
use netcert_evidence as evidence;
use netcert_explain as explain;
use netcert_kernel::stet;
use netcert_osm::osm;
use netcert_roads::{network, turns};

mod bodies;
mod chart;
mod corners;
mod decision;
mod explanation;
mod furniture;
mod lengths;
mod manoeuvres;
pub mod palette;
mod route;
mod route_uses;
mod sheet;
mod style;
mod svg;
#[cfg(test)]
mod tests;
mod turn;
mod vehicle;
mod view;

pub use chart::{Chart, Scale};
pub use corners::corners;
pub use decision::{CaseFields, DecisionBasis, decision};
pub use explanation::explanation;
pub use furniture::{LegendEntry, arrow, callout, dimension, legend, scale_bar};
pub use lengths::Units;
pub use manoeuvres::manoeuvres;
pub use route::route;
pub use sheet::{SHEET_STYLE, SheetStyle, sheet, survey_sheet};
pub use style::{Anchor, Style, TextStyle};
pub use svg::{Picture, escaped, number};
pub use turn::turn;
pub use vehicle::vehicle;
pub use view::{BoundingBox, PageFrame, View};

/// A place: metres in the world, or page units (right and *down*), depending on the context.
pub type Point = [f64; 2];
