//! Closed ways that map a road's surface (`area:highway`), and traffic islands.
//!
//! Kept are surfaces of road classes that a lorry uses, on the ground, if their tags admit lorries. In doubt a surface is
//! left out, and corners there are handled as unmapped. In doubt an island is kept, on whatever level it may be: it only takes
//! road away.

use super::class::road_class;
use super::limits::LegalTags;
use super::notes::Notes;
use super::{Direction, Oneway, Permission, RoadClass, Tags};

/// Kind of an area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum AreaKind {
    /// The surface of roads of this class (`area:highway=primary`, or its `_link`).
    Road(RoadClass),
    /// An island that must not be driven on (`area:highway=traffic_island`, `traffic_calming=island`).
    Island,
}

/// Keys that show that an area may lie above or below other roads.
const OTHER_LEVELS: [&str; 5] = ["bridge", "tunnel", "covered", "level", "layer"];

/// The kind of area from a closed way's tags. `None` if the way is no relevant area.
#[must_use]
pub fn area_kind(tags: &Tags<'_>) -> Option<AreaKind> {
    let value = |wanted: &str| tags.iter().find(|(key, _)| *key == wanted).map(|tag| tag.1);
    // A closed way with `highway` is a path around something, unless it says otherwise.
    let ground = value("highway").is_none() || value("area") == Some("yes");
    if value("area:highway") == Some("traffic_island") || value("traffic_calming") == Some("island") && ground {
        return Some(AreaKind::Island);
    }
    let value = value("area:highway")?;
    let class = road_class(value).ok()?;
    if matches!(class, RoadClass::Track | RoadClass::Busway) || value == "road" {
        return None;
    }
    let mut legal = LegalTags::default();
    let mut notes = Notes::default();
    for &(key, value) in tags {
        let head = key.split(':').next().unwrap_or(key);
        if OTHER_LEVELS.contains(&head) && !matches!(value, "no" | "0") {
            return None;
        }
        // A surface for buses is not for lorries, whoever else may use it.
        if matches!(head, "bus" | "psv") && value == "designated" {
            return None;
        }
        legal.take(key, value, &mut notes);
    }
    let open = |direction| {
        let legal = legal.resolve(direction, Oneway::No);
        legal.motor_vehicle == Permission::Yes && legal.hgv == Permission::Yes
    };
    (open(Direction::Forward) && open(Direction::Backward)).then_some(AreaKind::Road(class))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_of_roads_count_and_what_is_in_doubt_does_not() {
        let road = |class| Some(AreaKind::Road(class));
        for (tags, kind) in [
            (&[("area:highway", "primary")][..], road(RoadClass::Primary)),
            (&[("surface", "asphalt"), ("area:highway", "primary_link")], road(RoadClass::Primary)),
            (&[("area:highway", "service"), ("layer", "0")], road(RoadClass::Service)),
            (&[("area:highway", "traffic_island"), ("layer", "1")], Some(AreaKind::Island)),
            (&[("traffic_calming", "island"), ("surface", "grass")], Some(AreaKind::Island)),
            (&[("traffic_calming", "island"), ("highway", "footway"), ("area", "yes")], Some(AreaKind::Island)),
            (&[("traffic_calming", "island"), ("area:highway", "primary")], Some(AreaKind::Island)),
            (&[("traffic_calming", "island"), ("highway", "footway")], None),
            (&[("traffic_calming", "painted_island")], None),
            (&[("traffic_calming", "table")], None),
            (&[("area:highway", "footway")], None),
            (&[("area:highway", "yes")], None),
            (&[("area:highway", "track")], None),
            (&[("area:highway", "road")], None),
            (&[("area:highway", "primary"), ("layer", "1")], None),
            (&[("area:highway", "primary"), ("bridge", "yes")], None),
            (&[("area:highway", "service"), ("bus", "designated")], None),
            (&[("area:highway", "service"), ("access", "private")], None),
            (&[("area:highway", "service"), ("hgv", "no")], None),
            (&[("area:highway", "service"), ("motor_vehicle:forward", "no")], None),
            (&[("highway", "primary"), ("area", "yes")], None),
        ] {
            assert_eq!(area_kind(tags), kind, "{tags:?}");
        }
    }
}
