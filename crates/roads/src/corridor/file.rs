//! A corridor drawn by a user, in metres or in degrees, as values or as a corridor file.
//!
//! The file's format is stable for users. An error names the field and index; nothing is repaired.

use serde::Deserialize;

use super::centreline::{CentrelineError, from_centreline};
use super::{Corridor, Frame, FrameError, Params};

/// Why a drawn corridor cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// Not JSON, or not of this form. The message gives line and column.
    #[error("not a corridor file: {0}")]
    Json(#[from] serde_json::Error),
    /// A value that cannot be used.
    #[error(transparent)]
    Centreline(#[from] CentrelineError),
    /// Points that have no common metric frame.
    #[error("points: {0}")]
    Frame(#[from] FrameError),
}

/// A corridor from a file, with the conversion back to the file's coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct FileCorridor {
    /// In metres.
    pub corridor: Corridor,
    /// Frame of the corridor's metres, if the file is in degrees.
    pub frame: Option<Frame>,
}

impl FileCorridor {
    /// Converts points of the corridor's frame (metres) to the file's coordinates: metres unchanged, or longitude and
    /// latitude.
    pub fn to_input(&self, points: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, FrameError> {
        self.frame.map_or_else(|| Ok(points.to_vec()), |frame| frame.inverse(points))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    frame: FormFrame,
    points: Vec<[f64; 2]>,
    width_m: Option<Widths>,
    left_m: Option<Widths>,
    right_m: Option<Widths>,
    smoothing_tolerance_m: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum FormFrame {
    Metres,
    LonLat,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number of metres, or a list with one number per point")]
enum Widths {
    All(f64),
    Each(Vec<f64>),
}

impl Widths {
    fn into_vec(self) -> Vec<f64> {
        match self {
            Self::All(width) => vec![width],
            Self::Each(widths) => widths,
        }
    }
}

/// A corridor as a user draws it. Either `width_m`, or `left_m` and `right_m`, are needed: one value, or one for each point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawn {
    /// Whether the points are longitudes and latitudes in degrees. Otherwise they are metres.
    pub degrees: bool,
    /// The centreline in driving direction.
    pub points: Vec<[f64; 2]>,
    /// Widths, metres. The centreline is in the middle.
    pub width_m: Option<Vec<f64>>,
    /// Widths to the left of the centreline, metres.
    pub left_m: Option<Vec<f64>>,
    /// Widths to the right of the centreline, metres.
    pub right_m: Option<Vec<f64>>,
    /// The vehicle follows the smoothest line within this distance of the points, metres. Default 0.5.
    pub smoothing_tolerance_m: Option<f64>,
}

impl Drawn {
    /// The corridor, with stations a metre apart.
    ///
    /// # Errors
    /// A field is wrong, or points in degrees have no common metric frame.
    pub fn corridor(self) -> Result<FileCorridor, FileError> {
        let (left, right) = half_widths(self.width_m, self.left_m, self.right_m)?;
        let (frame, points) = if self.degrees {
            let degrees: Vec<(f64, f64)> = self.points.iter().map(|p| (p[0], p[1])).collect();
            let frame = Frame::around_degrees(degrees.iter().copied())?;
            (Some(frame), frame.forward_degrees(degrees)?)
        } else {
            (None, self.points)
        };
        let params = Params::default();
        let tolerance_m = self.smoothing_tolerance_m.unwrap_or(params.tolerance_m);
        let corridor = from_centreline(&points, &left, &right, tolerance_m, params.spacing_m)?;
        Ok(FileCorridor { corridor, frame })
    }
}

/// Reads the corridor that a JSON text describes: the members of [`Drawn`], with `frame` in place of `degrees`.
///
/// # Errors
/// As [`Drawn::corridor`], or the text has another form.
pub fn corridor_from_file(json: &str) -> Result<FileCorridor, FileError> {
    let form: Form = serde_json::from_str(json)?;
    let drawn = Drawn {
        degrees: matches!(form.frame, FormFrame::LonLat),
        points: form.points,
        width_m: form.width_m.map(Widths::into_vec),
        left_m: form.left_m.map(Widths::into_vec),
        right_m: form.right_m.map(Widths::into_vec),
        smoothing_tolerance_m: form.smoothing_tolerance_m,
    };
    drawn.corridor()
}

type HalfWidths = (Vec<f64>, Vec<f64>);

fn half_widths(
    width: Option<Vec<f64>>,
    left: Option<Vec<f64>>,
    right: Option<Vec<f64>>,
) -> Result<HalfWidths, CentrelineError> {
    match (width, left, right) {
        (Some(width), None, None) => {
            if let Some(i) = width.iter().position(|w| !(*w > 0.0 && w.is_finite())) {
                let field = if width.len() == 1 { "width_m".to_owned() } else { format!("width_m[{i}]") };
                return Err(CentrelineError::value(
                    field,
                    format!("{} is not a width in metres; expected more than 0", width[i]),
                ));
            }
            let half: Vec<f64> = width.iter().map(|w| 0.5 * w).collect();
            Ok((half.clone(), half))
        }
        (None, Some(left), Some(right)) => Ok((left, right)),
        (Some(_), ..) => {
            Err(CentrelineError::value("width_m", "is given with left_m or right_m; give width_m, or both of them"))
        }
        (None, Some(_), None) => Err(CentrelineError::value("right_m", "is missing, but left_m is given")),
        (None, None, Some(_)) => Err(CentrelineError::value("left_m", "is missing, but right_m is given")),
        (None, None, None) => Err(CentrelineError::value("width_m", "missing; give width_m, or left_m and right_m")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_file_in_metres_is_a_corridor_in_the_same_metres() {
        let json = r#"{"frame": "metres", "points": [[1000, 10], [1050, 10], [1100, 10]], "width_m": 7.0}"#;
        let c = corridor_from_file(json).unwrap();
        assert_eq!((c.corridor.len(), c.corridor.left_m[50], c.corridor.right_m[100]), (101, 3.5, 3.5));
        assert!((c.corridor.x[40] - 1040.0).abs() < 1e-9 && (c.corridor.y[40] - 10.0).abs() < 1e-9);
        assert_eq!(c.to_input(&[[1.0, 2.0]]).unwrap(), [[1.0, 2.0]]);
    }

    #[test]
    fn a_file_in_degrees_goes_to_metres_and_back() {
        let json = r#"{"frame": "lonlat", "points": [[179.999, -36.5], [-179.999, -36.5]],
            "left_m": [2, 3], "right_m": 1.5, "smoothing_tolerance_m": 0}"#;
        let c = corridor_from_file(json).unwrap();
        assert!((c.corridor.spacing_m * (c.corridor.len() - 1) as f64 - 179.2).abs() < 0.1);
        let last = c.corridor.len() - 1;
        assert_eq!((c.corridor.left_m[0], c.corridor.left_m[last], c.corridor.right_m[7]), (2.0, 3.0, 1.5));
        let back = c.to_input(&[[c.corridor.x[last], c.corridor.y[last]]]).unwrap();
        assert!((back[0][0] + 179.999).abs() < 1e-9 && (back[0][1] + 36.5).abs() < 1e-9);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let with = |rest: &str| {
            let json = format!(r#"{{"points": [[0, 0], [9, 0]], {rest}}}"#);
            corridor_from_file(&json).unwrap_err().to_string()
        };
        assert!(with(r#""width_m": 3"#).contains("missing field `frame`"));
        assert!(with(r#""frame": "feet", "width_m": 3"#).contains("expected `metres` or `lonlat`"));
        assert!(with(r#""frame": "metres", "width_m": "3 m""#).contains("expected a number of metres"));
        assert!(with(r#""frame": "metres", "width": 3"#).contains("unknown field `width`"));
        assert!(with(r#""frame": "metres""#).starts_with("width_m: missing"));
        assert!(with(r#""frame": "metres", "left_m": 3"#).starts_with("right_m: is missing"));
        assert!(with(r#""frame": "metres", "left_m": 3, "width_m": 3"#).starts_with("width_m: is given with left_m"));
        assert!(with(r#""frame": "metres", "width_m": [3, 0]"#).starts_with("width_m[1]: 0 is not a width"));
        assert!(with(r#""frame": "metres", "width_m": [3, 2, 3]"#).contains("3 values for 2 points"));
        let off = r#"{"frame": "lonlat", "points": [[0, 0], [9, 91]], "width_m": 3}"#;
        assert!(
            corridor_from_file(off)
                .unwrap_err()
                .to_string()
                .starts_with("points: position 1: longitude 9, latitude 91")
        );
    }
}
