//! Compares what two databases say of the same vehicle: what became safe, unsafe, forbidden, conditional; what appeared and went.
//!
//! Edges and turns are the same if they have the same id. Where a way is cut at other nodes, its edges have other ids. Such edges are no
//! change as long as their verdict is that of the edges that they replace.

mod roads;
mod row;

use netcert_base::named;
use std::collections::{BTreeMap, BTreeSet};
use std::iter::Peekable;

use rustc_hash::FxHashMap;

pub use roads::{NamedRoad, OnRoad, RoadChange, Sum, Sums};
pub use row::ChangeRow;

use crate::osm::facts::Direction;
use crate::rows::{CertificateRow, EdgeRow, TurnRow};
use crate::settings::Settings;
use crate::verdict::{UnsafeReason, Verdict};

/// What a vehicle's certificate comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Standing {
    /// Safe.
    Safe,
    /// Unsafe for want of room, and it is known how much more would be enough.
    Conditional,
    /// Unsafe otherwise.
    Unsafe,
    /// Forbidden.
    Forbidden,
    /// Unknown.
    Unknown,
}

named!(Standing {
    Safe = "safe",
    Conditional = "conditional",
    Unsafe = "unsafe",
    Forbidden = "forbidden",
    Unknown = "unknown",
});

impl Standing {
    /// `need_m` is what would be enough, if that is known, metres.
    fn new(certificate: &CertificateRow, need_m: Option<f64>) -> Self {
        match certificate.verdict {
            Verdict::Safe => Self::Safe,
            Verdict::Unsafe(UnsafeReason::Width) if need_m.is_some() => Self::Conditional,
            Verdict::Unsafe(_) => Self::Unsafe,
            Verdict::Forbidden(_) => Self::Forbidden,
            Verdict::Unknown(_) => Self::Unknown,
        }
    }

    /// The standing of an edge.
    #[must_use]
    pub fn of_edge(row: &EdgeRow) -> Self {
        Self::new(&row.certificate, row.need_width_m)
    }

    /// The standing of a turn.
    #[must_use]
    pub fn of_turn(row: &TurnRow) -> Self {
        Self::new(&row.certificate, row.need_kerb_radius_m.or(row.need_flare_m))
    }
}

/// What changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Change {
    /// Another standing than before.
    Became(Standing),
    /// The older database does not have it.
    Appeared(Standing),
    /// The newer database does not have it.
    Went(Standing),
}

impl Change {
    /// The word for the change, such as `became_unsafe`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Became(Standing::Safe) => "became_safe",
            Self::Became(Standing::Conditional) => "became_conditional",
            Self::Became(Standing::Unsafe) => "became_unsafe",
            Self::Became(Standing::Forbidden) => "became_forbidden",
            Self::Became(Standing::Unknown) => "became_unknown",
            Self::Appeared(_) => "appeared",
            Self::Went(_) => "went",
        }
    }

    /// What it came to, or had come to before it went.
    #[must_use]
    pub fn standing(self) -> Standing {
        match self {
            Self::Became(standing) | Self::Appeared(standing) | Self::Went(standing) => standing,
        }
    }
}

/// Why two sets of certificates may differ although the map does not. The older set comes first. `definitions` are the hashes of both
/// definitions of the vehicle.
#[must_use]
pub fn notes(definitions: [&str; 2], settings: [&Settings; 2]) -> Vec<&'static str> {
    let vehicle = definitions[0] != definitions[1];
    let settings = settings[0] != settings[1];
    let vehicle = vehicle.then_some("the vehicle is defined otherwise in both files");
    vehicle.into_iter().chain(settings.then_some("certified with other settings in both files")).collect()
}

/// One edge or turn that changed. At least one of both rows is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Changed<R> {
    /// What changed.
    pub change: Change,
    /// The older row; where a way was cut anew, that of the first edge that was replaced.
    pub before: Option<R>,
    /// The newer row.
    pub after: Option<R>,
    /// Whether the way of an edge has edges in both directions, so that maps draw the two side by side. False for turns.
    pub two_way: bool,
}

impl<R> Changed<R> {
    fn became(standings: [Standing; 2], before: R, after: R) -> Option<Self> {
        let change = Change::Became(standings[1]);
        let changed = Self { change, before: Some(before), after: Some(after), two_way: false };
        (standings[0] != standings[1]).then_some(changed)
    }

    fn appeared(standing: Standing, row: R) -> Self {
        Self { change: Change::Appeared(standing), before: None, after: Some(row), two_way: false }
    }

    fn went(standing: Standing, row: R) -> Self {
        Self { change: Change::Went(standing), before: Some(row), after: None, two_way: false }
    }

    /// The newer row, or else the older one.
    #[must_use]
    pub fn row(&self) -> Option<&R> {
        self.after.as_ref().or(self.before.as_ref())
    }
}

/// Compares the edges of a vehicle in two databases, way by way. Both must come in order of the network, which is that of ways. `sink`
/// gets what changed.
///
/// # Errors
/// The first error of a row or of `sink`.
pub fn edges<E>(
    old: impl Iterator<Item = Result<EdgeRow, E>>,
    new: impl Iterator<Item = Result<EdgeRow, E>>,
    mut sink: impl FnMut(Changed<EdgeRow>) -> Result<(), E>,
) -> Result<(), E> {
    let (mut old, mut new) = (old.peekable(), new.peekable());
    while let Some(way) = [first_way(&mut old), first_way(&mut new)].into_iter().flatten().min() {
        let (before, after) = (of_way(&mut old, way)?, of_way(&mut new, way)?);
        way_changes(before, after).into_iter().try_for_each(&mut sink)?;
    }
    Ok(())
}

/// The way of the next row. A row that cannot be read comes first, so that its error is told.
fn first_way<E>(rows: &mut Peekable<impl Iterator<Item = Result<EdgeRow, E>>>) -> Option<i64> {
    rows.peek().map(|row| row.as_ref().map_or(i64::MIN, |row| row.edge.way_id))
}

fn of_way<E>(rows: &mut Peekable<impl Iterator<Item = Result<EdgeRow, E>>>, way: i64) -> Result<Vec<EdgeRow>, E> {
    let mut all = Vec::new();
    while let Some(row) = rows.next_if(|row| row.as_ref().map_or(true, |row| row.edge.way_id == way)) {
        all.push(row?);
    }
    Ok(all)
}

/// The changes on one way.
fn way_changes(before: Vec<EdgeRow>, after: Vec<EdgeRow>) -> Vec<Changed<EdgeRow>> {
    let two_way = [&before, &after].map(|rows| both_directions(rows));
    let mut known: BTreeMap<i64, EdgeRow> = before.into_iter().map(|row| (row.edge.id, row)).collect();
    let mut changes = Vec::new();
    let mut others = Vec::new();
    for row in after {
        match known.remove(&row.edge.id) {
            Some(old) => changes.extend(Changed::became([&old, &row].map(Standing::of_edge), old, row)),
            None => others.push(row),
        }
    }
    let mut left: Vec<EdgeRow> = known.into_values().collect();
    left.sort_by_key(|row| row.edge.index);
    for direction in [Direction::Forward, Direction::Backward] {
        let of = |rows: &[EdgeRow]| -> Vec<EdgeRow> {
            rows.iter().filter(|row| row.edge.direction == direction).cloned().collect()
        };
        changes.extend(cut_anew(of(&left), of(&others)));
    }
    for changed in &mut changes {
        changed.two_way = two_way[usize::from(changed.after.is_some())];
    }
    changes
}

fn both_directions(rows: &[EdgeRow]) -> bool {
    let has = |direction| rows.iter().any(|row| row.edge.direction == direction);
    has(Direction::Forward) && has(Direction::Backward)
}

/// The changes of edges of one way and direction, none of which has an id of the other side. If all the older ones had one standing, they
/// stand for what was there before.
fn cut_anew(gone: Vec<EdgeRow>, come: Vec<EdgeRow>) -> Vec<Changed<EdgeRow>> {
    let standings: BTreeSet<Standing> = gone.iter().map(Standing::of_edge).collect();
    if let (1, Some(old), false) = (standings.len(), gone.first(), come.is_empty()) {
        let changed = |row: EdgeRow| {
            let standings = [Standing::of_edge(old), Standing::of_edge(&row)];
            Changed::became(standings, old.clone(), row)
        };
        return come.into_iter().filter_map(changed).collect();
    }
    let went = |row: EdgeRow| Changed::went(Standing::of_edge(&row), row);
    let appeared = |row: EdgeRow| Changed::appeared(Standing::of_edge(&row), row);
    gone.into_iter().map(went).chain(come.into_iter().map(appeared)).collect()
}

/// Compares the turns of a vehicle in two databases, in any order. A turn of edges that are cut anew went, and another one appeared. The
/// older ones are held in memory.
///
/// # Errors
/// The first error of a row or of `sink`.
pub fn turns<E>(
    old: impl Iterator<Item = Result<TurnRow, E>>,
    new: impl Iterator<Item = Result<TurnRow, E>>,
    mut sink: impl FnMut(Changed<TurnRow>) -> Result<(), E>,
) -> Result<(), E> {
    let mut known: FxHashMap<i64, TurnRow> = FxHashMap::default();
    for row in old {
        let row = row?;
        known.insert(row.turn.id, row);
    }
    for row in new {
        let row = row?;
        let changed = match known.remove(&row.turn.id) {
            Some(old) => Changed::became([&old, &row].map(Standing::of_turn), old, row),
            None => Some(Changed::appeared(Standing::of_turn(&row), row)),
        };
        changed.into_iter().try_for_each(&mut sink)?;
    }
    let mut gone: Vec<TurnRow> = known.into_values().collect();
    gone.sort_unstable_by_key(|row| row.turn.index);
    let went = |row: TurnRow| Changed::went(Standing::of_turn(&row), row);
    gone.into_iter().map(went).try_for_each(&mut sink)
}
