//! Uses that take room between the lanes and the edge of the carriageway: parked cars, cycle lanes, shoulders.
//!
//! Sides refer to the way's node order. Cycle tracks and parking bays beside the carriageway take no room of it.

use crate::osm::facts::section::{Decimetres, Kerb, Parking, UNTAGGED};
use crate::osm::facts::value;

/// Collects the tags of both sides, in any order.
#[derive(Debug, Default)]
pub(super) struct KerbReader {
    /// Widths as tagged, whether or not the use itself is tagged.
    kerbs: [Kerb; 2],
    orientations: [Parking; 2],
    parked: [bool; 2],
    /// Whether a tag says that cars park beside the carriageway.
    parked_beside: [bool; 2],
    /// Whether a cycle lane on the carriageway is tagged. A width alone may belong to a track beside it.
    cycle_lanes: [bool; 2],
}

impl KerbReader {
    /// Takes a `cycleway`, `shoulder` or `parking` tag.
    pub(super) fn take(&mut self, head: &str, suffix: &str, text: &str) {
        match head {
            "cycleway" => self.cycleway(suffix, text),
            "shoulder" => self.shoulder(suffix, text),
            "parking" => self.parking(suffix, text),
            _ => {}
        }
    }

    /// Whether a side has a cycle lane.
    pub(super) fn has_cycle_lane(&self) -> bool {
        self.cycle_lanes.iter().any(|lane| *lane)
    }

    /// The uses on the left and on the right.
    pub(super) fn finish(&self) -> [Kerb; 2] {
        [self.kerb(0), self.kerb(1)]
    }

    fn kerb(&self, side: usize) -> Kerb {
        let Kerb { parking_dm, cycle_dm, shoulder_dm, .. } = self.kerbs[side];
        let parking = match self.orientations[side] {
            _ if self.parked_beside[side] || !self.parked[side] => Parking::None,
            Parking::None => Parking::Parallel,
            orientation => orientation,
        };
        let tagged_or_default = |dm| if dm == 0 { UNTAGGED } else { dm };
        Kerb {
            parking,
            parking_dm: if parking == Parking::None { 0 } else { tagged_or_default(parking_dm) },
            cycle_dm: if self.cycle_lanes[side] { tagged_or_default(cycle_dm) } else { 0 },
            shoulder_dm,
        }
    }

    fn cycleway(&mut self, suffix: &str, text: &str) {
        let (sides, rest) = sides(suffix);
        let on_carriageway = matches!(text, "lane" | "opposite_lane" | "soft_lane");
        if (rest.is_empty() && on_carriageway) || (rest == "lane" && matches!(text, "exclusive" | "advisory")) {
            for &side in sides {
                self.cycle_lanes[side] = true;
            }
        }
        if rest == "width" {
            self.kerb_width(suffix, text, |kerb| &mut kerb.cycle_dm);
        }
    }

    fn shoulder(&mut self, suffix: &str, text: &str) {
        let (named, rest) = sides(suffix);
        let sides: &[usize] = match (suffix, text) {
            ("", "left") => &[0],
            ("", "right") => &[1],
            _ if rest.is_empty() && matches!(text, "both" | "yes" | "left;right") => named,
            _ => &[],
        };
        for &side in sides {
            if self.kerbs[side].shoulder_dm == 0 {
                self.kerbs[side].shoulder_dm = UNTAGGED;
            }
        }
        if rest == "width" {
            self.kerb_width(suffix, text, |kerb| &mut kerb.shoulder_dm);
        }
    }

    fn kerb_width(&mut self, suffix: &str, text: &str, slot: fn(&mut Kerb) -> &mut Decimetres) {
        let Some(width) = value::metres(text).filter(|width| *width < 20.0) else { return };
        for &side in sides(suffix).0 {
            *slot(&mut self.kerbs[side]) = (width * 10.0 - 1e-3).ceil() as u8;
        }
    }

    /// Reads both schemes: `parking:right=lane` with `parking:right:orientation`, and the older
    /// `parking:lane:right=parallel`.
    fn parking(&mut self, suffix: &str, text: &str) {
        let (old, suffix) = match suffix.strip_prefix("lane:") {
            Some(rest) => (true, rest),
            None => (false, suffix),
        };
        let (sides, rest) = sides(suffix);
        let (orientation, kind) = match (old, rest) {
            (true, "") => (orientation(text), "lane"),
            (false, "") => (Parking::None, text),
            (false, "orientation") => (orientation(text), ""),
            (false, "width") => return self.kerb_width(suffix, text, |kerb| &mut kerb.parking_dm),
            (true, "parallel" | "diagonal" | "perpendicular") => (orientation(rest), text),
            _ => return,
        };
        for &side in sides {
            if rest == "orientation" || old {
                self.orientations[side] = orientation.max(self.orientations[side]);
            }
            match kind {
                "street_side" | "on_kerb" | "lay_by" | "shoulder" | "separate" => self.parked_beside[side] = true,
                // Half on the kerb counts as fully on the carriageway.
                "lane" | "on_street" | "half_on_kerb" | "yes" | "marked" | "painted_area_only" => {
                    self.parked[side] |= !old || orientation != Parking::None;
                }
                _ => {}
            }
        }
    }
}

fn orientation(text: &str) -> Parking {
    match text {
        "parallel" | "inline" | "half_on_kerb" | "marked" => Parking::Parallel,
        "diagonal" => Parking::Diagonal,
        "perpendicular" | "orthogonal" => Parking::Perpendicular,
        _ => Parking::None,
    }
}

/// The sides that a suffix names (both if it names none), and the rest of the suffix.
fn sides(suffix: &str) -> (&'static [usize], &str) {
    let (side, rest) = suffix.split_once(':').unwrap_or((suffix, ""));
    match side {
        "left" => (&[0], rest),
        "right" => (&[1], rest),
        "both" => (&[0, 1], rest),
        _ => (&[0, 1], suffix),
    }
}
