//! A turn, prepared for any vehicle of a length class: its area, and the corridor of every path code.

use std::sync::Arc;

use geo::{MultiPolygon, Polygon};

use super::area::{opened, rings};
use super::arm::Arm;
use super::arms::{Arms, PathLine};
use super::code::PathCode;
use super::complex::Complex;
use super::ends::Ends;
use super::islands;
use super::junction::Junction;
use super::path::STEP_M;
use super::rays::{Boundary, Widths};
use super::roundabout::PreparedPassage;
use super::{LengthClass, TurnPath, family};
use crate::corridor::{Frame, PlaneArea};
use crate::network::Network;
use crate::verdict::UnknownReason;

/// A turn whose paths are made from codes.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnCorridors {
    /// Frame of all positions.
    pub frame: Frame,
    /// Angle between the strokes' directions at the node, radians, positive left.
    pub turn_rad: f64,
    /// The drivable area, without the islands.
    pub area: MultiPolygon,
    /// The mapped traffic islands that the area would have in it.
    pub islands: Vec<Polygon>,
    /// Assumed radius of the kerb return, metres. `None` if the corner is too acute or too flat, or its surface is
    /// mapped.
    pub kerb_radius_m: Option<f64>,
    /// The area's boundary.
    rings: Arc<PlaneArea>,
    /// The area with the straight road beyond the ends of both roads: a path may join its road at the very end.
    opened: MultiPolygon,
    way: Way,
}

/// Over one node, over a complex, or over a roundabout.
#[derive(Debug, Clone, PartialEq)]
enum Way {
    Direct(Box<Arms>),
    Passage(Box<PreparedPassage>),
}

impl TurnCorridors {
    pub(super) fn at(junction: Junction, network: &Network, frame: Frame) -> Result<Self, UnknownReason> {
        let (area, kerb_radius_m) = junction.area();
        Self::on(area, kerb_radius_m, network, frame, junction.arms.turn_rad(), Way::Direct(Box::new(junction.arms)))
    }

    pub(super) fn across(complex: Complex, network: &Network, frame: Frame) -> Result<Self, UnknownReason> {
        let (area, kerb_radius_m) = complex.area();
        Self::on(area, kerb_radius_m, network, frame, complex.arms.turn_rad(), Way::Direct(Box::new(complex.arms)))
    }

    pub(super) fn over(passage: PreparedPassage, network: &Network, frame: Frame) -> Result<Self, UnknownReason> {
        let (area, kerb_radius_m) = passage.area();
        Self::on(area, kerb_radius_m, network, frame, passage.turn_rad(), Way::Passage(Box::new(passage)))
    }

    fn on(
        area: MultiPolygon,
        kerb_radius_m: Option<f64>,
        network: &Network,
        frame: Frame,
        turn_rad: f64,
        way: Way,
    ) -> Result<Self, UnknownReason> {
        let opened = opened(&area, way.arms(), way.length_class());
        // An island that cannot be placed may lie anywhere.
        let islands = islands::touching(network, frame, &opened).map_err(|_| UnknownReason::Geometry)?;
        let (area, opened) = (islands::without(area, &islands), islands::without(opened, &islands));
        let rings = Arc::new(rings(&area));
        Ok(Self { frame, turn_rad, area, islands, kerb_radius_m, rings, opened, way })
    }

    /// The path with a code. `None` if the turn has no such path.
    #[must_use]
    pub fn path(&self, code: i64) -> Option<TurnPath> {
        let line = self.line(code, STEP_M)?;
        let widths = Boundary::new(&self.opened).widths(&line.points);
        self.along(code, &line, widths.unwrap_or_else(|| Widths::slim(line.points.len())))
    }

    /// The codes with which a search for a path begins.
    #[must_use]
    pub fn seeds(&self) -> Vec<i64> {
        match &self.way {
            Way::Direct(arms) => family::seeds(arms).iter().map(PathCode::encode).collect(),
            Way::Passage(passage) => passage.numbers(),
        }
    }

    /// The paths of [`Self::seeds`] that stay on the road.
    #[must_use]
    pub fn on_road(&self) -> Vec<TurnPath> {
        let boundary = Boundary::new(&self.opened);
        let path = |code: i64| {
            let line = self.line(code, STEP_M)?;
            let widths = boundary.widths(&line.points)?;
            self.along(code, &line, widths)
        };
        self.seeds().into_iter().filter_map(path).collect()
    }

    fn along(&self, code: i64, line: &PathLine, widths: Widths) -> Option<TurnPath> {
        let strokes = match &self.way {
            Way::Direct(arms) => arms.strokes,
            Way::Passage(passage) => passage.strokes,
        };
        let ends = Ends {
            arms: self.arms(),
            strokes,
            stations: line.joints,
            length_class: self.length_class(),
            islands: &self.islands,
        };
        ends.path(code, &line.points, widths, &self.rings)
    }

    /// The line of the path with a code, with points about `step_m` apart.
    pub(super) fn line(&self, code: i64, step_m: f64) -> Option<PathLine> {
        match &self.way {
            Way::Direct(arms) => arms.line(&PathCode::decode(code)?.shape(), step_m),
            Way::Passage(passage) => passage.line(code, step_m),
        }
    }

    /// The road before the turn and the road after it.
    pub(super) fn arms(&self) -> [&Arm; 2] {
        self.way.arms()
    }

    pub(super) fn length_class(&self) -> LengthClass {
        self.way.length_class()
    }

    /// The boundary of the area for planning.
    pub(super) fn opened(&self) -> PlaneArea {
        rings(&self.opened)
    }
}

impl Way {
    fn arms(&self) -> [&Arm; 2] {
        match self {
            Self::Direct(arms) => [&arms.from, &arms.to],
            Self::Passage(passage) => [&passage.entry.arms.from, &passage.exit.arms.to],
        }
    }

    fn length_class(&self) -> LengthClass {
        match self {
            Self::Direct(arms) => arms.length_class,
            Self::Passage(passage) => passage.entry.arms.length_class,
        }
    }
}
