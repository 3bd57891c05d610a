//! Keys, and parts of keys, that several readers of tags know.

/// Keys that say how wide the passage at a node is.
pub(super) const PASSAGE_KEYS: [&str; 5] = ["est_width", "maxwidth", "maxwidth:physical", "traffic_calming", "width"];

/// Parts of keys that make a remark of a tag, or a matter of lanes.
pub(super) const REMARKS: [&str; 25] = [
    "check_date",
    "colour",
    "comment",
    "date",
    "description",
    "end_date",
    "fixme",
    "image",
    "lane",
    "layer",
    "mapillary",
    "name",
    "note",
    "old",
    "operator",
    "proposed",
    "reason",
    "ref",
    "source",
    "start_date",
    "survey",
    "turn",
    "url",
    "variable",
    "was",
];
