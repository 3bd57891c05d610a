//! The areas of a route's turns, carried over into the route's corridor.

use std::ops::Range;
use std::sync::Arc;

use super::pieces::TurnPiece;
use crate::corridor::{AreaSpan, Corridor, Frame, FrameError, PlaneArea};

/// A turn's area, and how far before and behind the turn's own stations it counts.
pub(super) struct TurnArea {
    area: Arc<PlaneArea>,
    before_m: f64,
    after_m: f64,
}

impl TurnArea {
    /// The area of a turn, in the route's frame.
    pub(super) fn of(piece: &TurnPiece, frame: Frame) -> Result<Option<Self>, FrameError> {
        let Some(span) = &piece.area else { return Ok(None) };
        let metres = |from: usize, to: usize| (to as f64 - from as f64) * piece.corridor.spacing_m;
        let area = match piece.frame == frame {
            true => Arc::clone(&span.area),
            false => Arc::new(in_frame(&span.area, piece.frame, frame)?),
        };
        let (before_m, after_m) = (metres(span.heads.start, piece.turn.start), metres(piece.turn.end, span.heads.end));
        Ok(Some(Self { area, before_m, after_m }))
    }

    /// Where the area counts in a route whose turn has these stations.
    pub(super) fn along(&self, corridor: &Corridor, turn: &Range<usize>) -> AreaSpan {
        let stations = |metres: f64| (metres / corridor.spacing_m).round() as isize;
        let within = |k: isize| k.clamp(0, corridor.len() as isize) as usize;
        let heads =
            within(turn.start as isize - stations(self.before_m))..within(turn.end as isize + stations(self.after_m));
        AreaSpan { heads, area: Arc::clone(&self.area) }
    }
}

fn in_frame(area: &PlaneArea, own: Frame, frame: Frame) -> Result<PlaneArea, FrameError> {
    let moved = |ring: &Vec<[f64; 2]>| {
        let degrees = own.inverse(ring)?;
        frame.forward_degrees(degrees.into_iter().map(|[lon, lat]| (lon, lat)).collect())
    };
    Ok(PlaneArea { rings: area.rings.iter().map(moved).collect::<Result<_, FrameError>>()? })
}
