-- Areas of junctions, for people to look at: what the roads and corners at a node cover. `node_id`: the node in OpenStreetMap; it is
-- `turn.via_node` of the turns over it. `roads`: how many with a width meet there. `kerb_source`: where the corners come from, as in
-- `turn`. No certificate rests on these areas.
CREATE TABLE junction (
    node_id INTEGER PRIMARY KEY NOT NULL,
    roads INTEGER NOT NULL,
    kerb_source TEXT,
    geom MULTIPOLYGON NOT NULL
);
