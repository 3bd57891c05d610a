//! Reads the network from its tables. It equals the network that was written, except the numbering of interned texts and
//! positions that no edge uses. Writing the read network gives the same file.

use std::ops::Range;

use rustc_hash::FxHashMap;
use sqlx::Row as _;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::network::{Areas, Crossings, Edge, EdgeNo, Narrowing, Network, Road, RoadEnds, Site, Splits, Stroke};
use crate::osm::facts::class_and_link;
use crate::osm::facts::{CrossSection, Legal, Limit, RuleSet, Strip};
use crate::osm::{LonLat, NodeId, StringPool};

use crate::columns::read::{index, range, rows, word};
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::blob;
use crate::register::evidence;
use crate::roads::areas;
use crate::roads::restrictions::{self, Restrictions};

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// Loads the network, which equals the network that was written.
    pub fn load_network(&mut self) -> Result<Network, StoreError> {
        // Read first: a change while the network is read is then noticed.
        self.loaded = Some(self.register_state()?);
        self.session.run(async |c| read(c).await)
    }
}

/// Reads the whole network.
async fn read(c: &mut SqliteConnection) -> Sql<Network> {
    let sections = rows(c, "SELECT * FROM section ORDER BY section_no", |row| section(row, 1)).await?;
    let mut sets = RuleSets::default();
    let legals = rows(c, "SELECT * FROM legal ORDER BY legal_no", |row| legal(row, 1, [9, 10], &mut sets)).await?;
    let mut strings = StringPool::default();
    let roads =
        rows(c, "SELECT * FROM road ORDER BY road_no", |row| road(row, &sections, &legals, &mut strings)).await?;
    let mut shapes = Vec::new();
    let edges = "SELECT fid, edge_id, road_no, from_node, to_node, direction, geom, shape_start, narrowing_start, \
                 narrowing_end, barred, cut, max_height_m, max_weight_t, max_axle_load_t, max_length_m, max_width_m, \
                 unreadable_limits, hgv, motor_vehicle, rules, legal_tags FROM edge ORDER BY fid";
    let mut expected = 0;
    let edges = rows(c, edges, |row| {
        expected += 1;
        edge(row, expected, roads.len(), &mut shapes, &mut sets)
    })
    .await?;
    let narrowings = "SELECT vertex, passage_m FROM narrowing ORDER BY narrowing_no";
    let narrowings = rows(c, narrowings, |row| {
        Ok(Narrowing { vertex: row.try_get(0)?, passage_m: row.try_get::<f64, _>(1)? as f32 })
    })
    .await?;
    let strokes = rows(c, "SELECT * FROM stroke ORDER BY stroke_no", |row| {
        Ok(Stroke { approach: range(row, 1)?, edges: range(row, 3)?, closed: row.try_get(5)? })
    })
    .await?;
    let stroke_edges =
        rows(c, "SELECT fid FROM stroke_edge ORDER BY position", |row| index(row, 0, edges.len()).map(EdgeNo::new))
            .await?;
    let Restrictions { all: restrictions, edges: restriction_edges } = restrictions::read(c, edges.len()).await?;
    let areas = Areas::default();
    let mut network = Network {
        roads,
        edges,
        shapes,
        narrowings,
        strokes,
        stroke_edges,
        restrictions,
        restriction_edges,
        areas,
        splits: Splits::default(),
        crossings: Crossings::default(),
        site: Site::default(),
        ends: RoadEnds::default(),
        strings,
    };
    check_ranges(&network)?;
    network.splits = Splits::find(&network);
    network.crossings = Crossings::find(&network);
    network.areas = Areas::new(areas::read(c).await?, &network);
    network.site = evidence::site(c, &network).await?;
    Ok(network)
}

/// Checks that no range points outside its array, because the program indexes arrays by these ranges.
fn check_ranges(network: &Network) -> Sql<()> {
    let within = |range: &Range<u32>, length: usize| range.start <= range.end && range.end as usize <= length;
    let edges = network.edges.iter().all(|edge| within(&edge.narrowings, network.narrowings.len()));
    let length = network.stroke_edges.len();
    let strokes = network.strokes.iter().all(|s| within(&s.approach, length) && within(&s.edges, length));
    if edges && strokes { Ok(()) } else { Err(content("a narrow place or stroke points outside its table")) }
}

fn strip(row: &SqliteRow, column: usize) -> Sql<Option<Strip>> {
    let (Some(left_m), Some(right_m)) =
        (row.try_get::<Option<f64>, _>(column)?, row.try_get::<Option<f64>, _>(column + 1)?)
    else {
        return Ok(None);
    };
    Ok(Some(Strip { left_m: left_m as f32, right_m: right_m as f32, source: word(row, column + 2)? }))
}

fn section(row: &SqliteRow, column: usize) -> Sql<CrossSection> {
    Ok(CrossSection {
        lane: strip(row, column)?,
        direction: strip(row, column + 3)?,
        carriageway: strip(row, column + 6)?,
    })
}

/// Sets of rules by their text, each read once.
pub(crate) type RuleSets = FxHashMap<String, RuleSet>;

/// The set of rules in a column.
fn rule_set(row: &SqliteRow, column: usize, sets: &mut RuleSets) -> Sql<Option<RuleSet>> {
    let Some(text) = row.try_get::<Option<&str>, _>(column)? else { return Ok(None) };
    if let Some(known) = sets.get(text) {
        return Ok(Some(known.clone()));
    }
    let set = RuleSet::from_text(text).ok_or_else(|| content(format!("`{text}` are no rules that netcert writes")))?;
    sets.insert(text.to_owned(), set.clone());
    Ok(Some(set))
}

/// Limits and access in a row: the limits from `column` on, the rules and the tags in the columns named.
pub(crate) fn legal(row: &SqliteRow, column: usize, [rules, tags]: [usize; 2], sets: &mut RuleSets) -> Sql<Legal> {
    let unreadable: Option<&str> = row.try_get(column + 5)?;
    let limit = |at: usize, name: &str| -> Sql<Limit> {
        if unreadable.is_some_and(|names| names.split(',').any(|other| other == name)) {
            return Ok(Limit::Unreadable);
        }
        Ok(row.try_get::<Option<f64>, _>(column + at)?.map_or(Limit::None, |value| Limit::At(value as f32)))
    };
    Ok(Legal {
        max_height: limit(0, "max_height")?,
        max_weight: limit(1, "max_weight")?,
        max_axle_load: limit(2, "max_axle_load")?,
        max_length: limit(3, "max_length")?,
        max_width: limit(4, "max_width")?,
        hgv: word(row, column + 6)?,
        motor_vehicle: word(row, column + 7)?,
        rules: rule_set(row, rules, sets)?,
        tags: row.try_get::<Option<&str>, _>(tags)?.map(Into::into),
    })
}

/// The country code in a column.
pub(crate) fn country(row: &SqliteRow, column: usize) -> Sql<[u8; 2]> {
    let country: &str = row.try_get(column)?;
    country.as_bytes().try_into().map_err(|_| content(format!("`{country}` is no country code")))
}

fn road(row: &SqliteRow, sections: &[CrossSection], legals: &[Legal], strings: &mut StringPool) -> Sql<Road> {
    let highway: &str = row.try_get(2)?;
    let (class, link) = class_and_link(highway).ok_or_else(|| content(format!("`{highway}` is no class of road")))?;
    let section = |column| index(row, column, sections.len()).map(|i| sections[i as usize]);
    let legal = |column| index(row, column, legals.len()).map(|i| legals[i as usize].clone());
    Ok(Road {
        way_id: row.try_get(1)?,
        class,
        link,
        roundabout: row.try_get(3)?,
        oneway: word(row, 4)?,
        name: row.try_get::<Option<&str>, _>(5)?.map(|text| strings.intern(text)),
        reference: row.try_get::<Option<&str>, _>(6)?.map(|text| strings.intern(text)),
        lanes: row.try_get(7)?,
        country: country(row, 8)?,
        left_hand_traffic: row.try_get(9)?,
        sections: [section(10)?, section(11)?],
        legal: [legal(12)?, legal(13)?],
        max_speed_km_h: [row.try_get(14)?, row.try_get(15)?],
        width_tags: row.try_get::<Option<&str>, _>(16)?.map(Into::into),
    })
}

/// Reads an edge and puts its positions at their old place in [`Network::shapes`]. Neighbours and opposite directions may
/// share positions.
fn edge(row: &SqliteRow, expected: i64, roads: usize, shapes: &mut Vec<LonLat>, sets: &mut RuleSets) -> Sql<Edge> {
    let fid: i64 = row.try_get(0)?;
    if fid != expected {
        return Err(content(format!("edge {expected} of the network is missing")));
    }
    let direction = word(row, 5)?;
    let mut line = blob::decode(row.try_get(6)?).ok_or_else(|| content(format!("the geometry of edge {fid}")))?;
    if direction == crate::osm::facts::Direction::Backward {
        line.reverse();
    }
    let start: u32 = row.try_get(7)?;
    // Shapes are written in order without gaps. A start beyond the end means damage, and could require any amount of memory.
    if start as usize > shapes.len() || line.len() < 2 {
        return Err(content(format!("the shape of edge {fid}")));
    }
    let end = start as usize + line.len();
    let known = shapes.len().min(end);
    if shapes[start as usize..known] != line[..known - start as usize] {
        return Err(content(format!("the shape of edge {fid} is not that of its neighbours")));
    }
    shapes.extend_from_slice(&line[known - start as usize..]);
    Ok(Edge {
        id: row.try_get(1)?,
        road: index(row, 2, roads)?,
        from_node: NodeId::new(row.try_get(3)?),
        to_node: NodeId::new(row.try_get(4)?),
        direction,
        shape: start..end as u32,
        narrowings: range(row, 8)?,
        legal: legal(row, 12, [20, 21], sets)?,
        barred: row.try_get(10)?,
        cut: row.try_get(11)?,
    })
}
