//! Facts of a road from a source that has values instead of tags. The bounds and rules are those of tags.

use std::num::NonZeroU8;

use super::class::road_class;
use super::notes::Notes;
use super::section_reader::{SectionReader, Sharing};
use super::{Legal, Oneway, RoadClass, WayFacts};

/// What such a source says of a road.
#[derive(Debug, Clone, PartialEq)]
pub struct RoadValues {
    /// Road class.
    pub class: RoadClass,
    /// Whether it is a slip road.
    pub link: bool,
    /// Directions that exist for some vehicle.
    pub oneway: Oneway,
    /// Directions for which the carriageway is laid out.
    pub traffic: Oneway,
    /// Limits and access along the line, and against it.
    pub legal: [Legal; 2],
    /// Speed limits along the line, and against it, km/h.
    pub max_speed_km_h: [Option<NonZeroU8>; 2],
    /// Width of the carriageway, metres.
    pub width_m: Option<f64>,
}

/// The class of a road by the name that OpenStreetMap has for it.
///
/// # Errors
/// The reason why it is no road for heavy vehicles: one of [`super::LEFT_OUT_REASONS`].
pub fn given_class(name: &str) -> Result<RoadClass, &'static str> {
    road_class(name)
}

impl RoadValues {
    /// The facts. A width that no road has is noted and not used.
    pub fn facts(&self, notes: &mut Notes) -> WayFacts {
        let mut section = SectionReader::default();
        section.knows_no_rings();
        if let Some(width_m) = self.width_m {
            section.given_width(width_m, notes);
        }
        let [legal_forward, legal_backward] = self.legal.clone();
        WayFacts {
            class: self.class,
            link: self.link,
            roundabout: false,
            oneway: self.oneway,
            name: None,
            reference: None,
            legal_forward,
            legal_backward,
            max_speed_km_h: self.max_speed_km_h,
            width_tags: None,
            section: section.finish(self.traffic, Sharing::Never, notes),
        }
    }
}
