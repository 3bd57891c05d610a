//! Pictures: the base on which every drawing of corridors, vehicles and charts stands. SVG as text, nothing else.
//!
//! Promises: true scale (a [`View`] never stretches one axis against the other), the same input gives the same bytes
//! (fixed decimals, no clocks, no maps), well-formed XML whatever a name holds, and colours that people with any kind of colour
//! vision tell apart ([`palette`], with sources). Every picture has its own light background, so that it reads the same on
//! a dark page. Left out: measuring text (its width is estimated), fonts, animation.
//!
//! | file | for |
//! | --- | --- |
//! | `svg` | [`Picture`]: the document, and shapes in page units |
//! | `style` | how shapes and texts look |
//! | `view` | from metres (x east, y north) to the page |
//! | `palette` | colours, and scales for numbers |
//! | `furniture` | dimension lines, arrows, scale bar, legend |
//! | `chart` | a curve over an axis |
//! | `bodies` | a vehicle from above |
//! | `turn` | a turn at a junction, with the vehicle all the way round |
//! | `explanation` | what limits a vehicle on a road |
//! | `vehicle` | a vehicle with its dimensions |
//! | `route` | a route's leeway all along, and its shape |
//! | `manoeuvres` | the turns by which a vehicle is judged |

mod bodies;
mod chart;
mod explanation;
mod furniture;
mod manoeuvres;
pub mod palette;
mod route;
mod style;
mod svg;
#[cfg(test)]
mod tests;
mod turn;
mod vehicle;
mod view;

pub use chart::{Chart, Scale};
pub use explanation::explanation;
pub use furniture::{Key, arrow, callout, dimension, legend, scale_bar};
pub use manoeuvres::manoeuvres;
pub use route::route;
pub use style::{Anchor, Style, TextStyle};
pub use svg::{Picture, escaped, number};
pub use turn::turn;
pub use vehicle::vehicle;
pub use view::{Bounds, Frame, View};

/// A place: metres in the world, or page units (right and *down*), as the context says.
pub type Point = [f64; 2];
