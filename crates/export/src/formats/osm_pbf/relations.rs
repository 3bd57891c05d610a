//! Relations. Those of the extract are changed to name the parts of split ways; new ones refuse turns.

use osmpbfreader::osmformat::Relation;
pub(super) use osmpbfreader::osmformat::relation::MemberType as Kind;
use protobuf::EnumOrUnknown;
use rustc_hash::FxHashMap;

use super::block::Texts;
use crate::ways::ids;

/// A part of a split way: its id, and its first and last node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PartEnds {
    pub(super) id: i64,
    pub(super) ends: [i64; 2],
}

/// The parts of each split way, in way order.
pub(super) type WaySplits = FxHashMap<i64, Vec<PartEnds>>;

/// Replaces split ways by their parts. Returns whether there were any. A restriction of which two parts of one way meet the `via` says
/// no longer which one it means. Its refusals are written anew, so it is no restriction any more.
pub(super) fn name_parts(relation: &mut Relation, splits: &WaySplits, texts: &mut Texts) -> bool {
    let ids = ids(&relation.memids);
    let kinds: Vec<Kind> = relation.types.iter().map(EnumOrUnknown::enum_value_or_default).collect();
    if !ids.iter().zip(&kinds).any(|(id, kind)| *kind == Kind::WAY && splits.contains_key(id)) {
        return false;
    }
    let restriction = value(relation, texts, "type").is_some_and(|kind| kind.starts_with(b"restriction"));
    let roles = roles(relation, texts);
    let via: Vec<i64> = (0..ids.len())
        .filter(|&i| restriction && roles.get(i).is_some_and(|role| role == "via"))
        .flat_map(|i| via_nodes(ids[i], kinds.get(i).copied(), splits))
        .collect();
    let loose = |i: usize| {
        let parts = splits.get(&ids[i]).filter(|_| kinds.get(i) == Some(&Kind::WAY));
        let side = roles.get(i).is_some_and(|role| matches!(role.trim().to_ascii_lowercase().as_str(), "from" | "to"));
        side && parts.is_some_and(|parts| parts.iter().filter(|part| meets(part, &via)).count() > 1)
    };
    if restriction && (0..ids.len()).any(loose) {
        set_aside(relation, texts);
    }
    let (mut types, mut memids, mut roles_sid, mut last) = (Vec::new(), Vec::new(), Vec::new(), 0_i64);
    for (i, &id) in ids.iter().enumerate() {
        let (kind, role) = (kinds.get(i).copied().unwrap_or_default(), roles.get(i).map_or("", String::as_str));
        let parts = match splits.get(&id).filter(|_| kind == Kind::WAY) {
            None => vec![id],
            Some(parts) if restriction && matches!(role, "from" | "to") => vec![touching(parts, &via)],
            Some(parts) if role == "backward" => parts.iter().rev().map(|part| part.id).collect(),
            Some(parts) => parts.iter().map(|part| part.id).collect(),
        };
        for part in parts {
            types.push(kind.into());
            memids.push(part.wrapping_sub(last));
            roles_sid.push(relation.roles_sid.get(i).copied().unwrap_or_default());
            last = part;
        }
    }
    (relation.types, relation.memids, relation.roles_sid) = (types, memids, roles_sid);
    true
}

/// Makes a restriction none. Its refusals are written anew.
pub(super) fn set_aside(relation: &mut Relation, texts: &mut Texts) {
    let was = texts.number(b"netcert:was:type");
    for key in &mut relation.keys {
        if texts.text(*key) == b"type" {
            *key = was;
        }
    }
}

/// A member: its kind, id and role.
pub(super) type RelationMember = (Kind, i64, &'static str);

/// Gives a relation these members.
pub(super) fn set_members(relation: &mut Relation, members: &[RelationMember], texts: &mut Texts) {
    (relation.types, relation.memids, relation.roles_sid) = (Vec::new(), Vec::new(), Vec::new());
    let mut last = 0_i64;
    for &(kind, id, role) in members {
        relation.types.push(kind.into());
        relation.memids.push(id.wrapping_sub(last));
        relation.roles_sid.push(texts.number(role.as_bytes()) as i32);
        last = id;
    }
}

/// What a restriction says of turns, one by one. Of several members Valhalla 3.9.1 takes one pair, and OSRM 26.10 drops some restrictions
/// whole (`findings/restriction-of-several-roads.sh`).
#[derive(Debug, PartialEq, Eq)]
pub(super) enum RelationTurns {
    /// It has one of each, or is no restriction.
    AsItIs,
    /// Members of one restriction for each turn.
    Each(Vec<Vec<RelationMember>>),
    /// `only_…` into several roads, or too many turns: no relation says that.
    NotToBeSaid,
}

/// The most turns that one restriction is divided into. No crossing has more.
const MOST_TURNS: usize = 1000;

/// The turns of a restriction. Each `from` is meant with each `to`, over each node, as ingest reads it.
pub(super) fn turns_of(relation: &Relation, texts: &Texts) -> RelationTurns {
    if !value(relation, texts, "type").is_some_and(|kind| kind.starts_with(b"restriction")) {
        return RelationTurns::AsItIs;
    }
    let kinds = relation.types.iter().map(EnumOrUnknown::enum_value_or_default);
    let (mut from, mut to, mut nodes, mut ways) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for ((kind, id), role) in kinds.zip(ids(&relation.memids)).zip(roles(relation, texts)) {
        match (role.trim().to_ascii_lowercase().as_str(), kind) {
            ("from", Kind::WAY) => from.push((kind, id, "from")),
            ("to", Kind::WAY) => to.push((kind, id, "to")),
            ("via", Kind::NODE) => nodes.push((kind, id, "via")),
            ("via", Kind::WAY) => ways.push((kind, id, "via")),
            _ => {}
        }
    }
    let vias: Vec<Vec<RelationMember>> = match nodes.len() {
        // Ways are driven one after the other.
        0 => vec![ways],
        _ if !ways.is_empty() => vec![[nodes, ways].concat()],
        _ => nodes.into_iter().map(|node| vec![node]).collect(),
    };
    let turns = from.len() * to.len() * vias.len();
    if turns < 2 {
        return RelationTurns::AsItIs;
    }
    let only = relation.keys.iter().zip(&relation.vals).any(|(&key, &value)| {
        texts.text(key).starts_with(b"restriction") && texts.text(value).trim_ascii_start().starts_with(b"only_")
    });
    if only && to.len() > 1 || turns > MOST_TURNS {
        return RelationTurns::NotToBeSaid;
    }
    let of_pair = |from: RelationMember, to: RelationMember| {
        vias.iter().map(move |via| [&[from], via.as_slice(), &[to]].concat())
    };
    RelationTurns::Each(from.iter().flat_map(|&from| to.iter().flat_map(move |&to| of_pair(from, to))).collect())
}

fn value<'t>(relation: &Relation, texts: &'t Texts, key: &str) -> Option<&'t [u8]> {
    let at = relation.keys.iter().position(|&number| texts.text(number) == key.as_bytes())?;
    Some(texts.text(*relation.vals.get(at)?))
}

fn roles(relation: &Relation, texts: &Texts) -> Vec<String> {
    relation.roles_sid.iter().map(|&role| String::from_utf8_lossy(texts.text(role as u32)).into_owned()).collect()
}

/// A refusal of a relation: from a way, over a node or over ways, into a way.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct RefusedTurn {
    over_ways: bool,
    /// The ids of the members in driving order.
    ids: Vec<i64>,
}

impl RefusedTurn {
    /// The refusal by members with these roles. `None` unless there is one `from` and one `to`.
    pub(super) fn by<'m>(members: impl Iterator<Item = (Kind, i64, &'m str)>) -> Option<Self> {
        let (mut from, mut via, mut to, mut over_ways) = (Vec::new(), Vec::new(), Vec::new(), false);
        for (kind, id, role) in members {
            match (role, kind) {
                ("from", Kind::WAY) => from.push(id),
                ("to", Kind::WAY) => to.push(id),
                ("via", Kind::NODE | Kind::WAY) => {
                    over_ways |= kind == Kind::WAY;
                    via.push(id);
                }
                _ => return None,
            }
        }
        let plain = from.len() == 1 && to.len() == 1 && (via.len() == 1 || over_ways && via.len() > 1);
        plain.then(|| Self { over_ways, ids: [from, via, to].concat() })
    }
}

/// Keys that limit a restriction.
const BUT: [&str; 5] = ["except", "day_on", "day_off", "hour_on", "hour_off"];

/// What a relation refuses under this key, always and without exception. `None` if it does not.
pub(super) fn refused(relation: &Relation, texts: &Texts, key: &str) -> Option<RefusedTurn> {
    let restriction = value(relation, texts, "type") == Some(b"restriction");
    let refuses = value(relation, texts, key).is_some_and(|word| word.starts_with(b"no_"));
    if !restriction || !refuses || BUT.iter().any(|key| value(relation, texts, key).is_some()) {
        return None;
    }
    let (ids, roles) = (ids(&relation.memids), roles(relation, texts));
    let kinds = relation.types.iter().map(EnumOrUnknown::enum_value_or_default);
    RefusedTurn::by(kinds.zip(ids).zip(&roles).map(|((kind, id), role)| (kind, id, role.as_str())))
}

/// The nodes of a `via`: the node itself, or the ends of the way, which are known only if the way was split.
fn via_nodes(id: i64, kind: Option<Kind>, splits: &WaySplits) -> Vec<i64> {
    match kind {
        Some(Kind::NODE) => vec![id],
        Some(Kind::WAY) => splits.get(&id).map_or_else(Vec::new, |parts| {
            let ends = [parts.first().map(|part| part.ends[0]), parts.last().map(|part| part.ends[1])];
            ends.into_iter().flatten().collect()
        }),
        _ => Vec::new(),
    }
}

/// The part of a way at the `via`. If the nodes of the `via` are not known, the first part; a restriction over ways is written
/// again with the right parts.
fn touching(parts: &[PartEnds], via: &[i64]) -> i64 {
    parts.iter().find(|part| meets(part, via)).or(parts.first()).map_or(0, |part| part.id)
}

fn meets(part: &PartEnds, via: &[i64]) -> bool {
    part.ends.iter().any(|end| via.contains(end))
}

/// The word that refuses a turn by this angle, degrees, positive to the left.
pub(super) fn refusal_word(angle_deg: f64) -> &'static str {
    match angle_deg {
        a if a > 35.0 => "no_left_turn",
        a if a < -35.0 => "no_right_turn",
        _ => "no_straight_on",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relation(members: &[(Kind, i64, &str)], texts: &mut Texts) -> Relation {
        let mut relation = Relation::new();
        let mut last = 0;
        for &(kind, id, role) in members {
            relation.types.push(kind.into());
            relation.memids.push(id - last);
            relation.roles_sid.push(texts.number(role.as_bytes()) as i32);
            last = id;
        }
        relation
    }

    #[test]
    fn a_restriction_names_the_part_at_its_node_and_a_route_all_parts() {
        let mut texts = Texts::over(vec![Vec::new()]);
        let part = |id, ends| PartEnds { id, ends };
        let splits = WaySplits::from_iter([(5, vec![part(5, [1, 2]), part(105, [2, 3]), part(106, [3, 4])])]);
        let mut ban = relation(&[(Kind::WAY, 5, "from"), (Kind::NODE, 4, "via"), (Kind::WAY, 9, "to")], &mut texts);
        ban.keys.push(texts.number(b"type"));
        ban.vals.push(texts.number(b"restriction"));
        assert!(name_parts(&mut ban, &splits, &mut texts));
        assert_eq!(ids(&ban.memids), [106, 4, 9]);
        // Two parts meet the node, so the relation means neither.
        let mut loose = relation(&[(Kind::WAY, 9, "from"), (Kind::NODE, 2, "via"), (Kind::WAY, 5, "To")], &mut texts);
        loose.keys.push(texts.number(b"type"));
        loose.vals.push(texts.number(b"restriction"));
        assert!(name_parts(&mut loose, &splits, &mut texts));
        assert_eq!(value(&loose, &texts, "type"), None);
        assert_eq!(value(&loose, &texts, "netcert:was:type"), Some(&b"restriction"[..]));
        let mut route = relation(&[(Kind::WAY, 7, ""), (Kind::WAY, 5, ""), (Kind::WAY, 5, "backward")], &mut texts);
        assert!(name_parts(&mut route, &splits, &mut texts));
        assert_eq!(ids(&route.memids), [7, 5, 105, 106, 106, 105, 5]);
        let mut other = relation(&[(Kind::NODE, 5, ""), (Kind::WAY, 8, "")], &mut texts);
        assert!(!name_parts(&mut other, &splits, &mut texts));
    }

    #[test]
    fn a_restriction_of_several_members_is_one_for_each_pair() {
        let turns = |members: &[RelationMember], word: &str| {
            let mut texts = Texts::over(vec![Vec::new()]);
            let mut relation = relation(members, &mut texts);
            for (key, value) in [("type", "restriction"), ("restriction", word)] {
                relation.keys.push(texts.number(key.as_bytes()));
                relation.vals.push(texts.number(value.as_bytes()));
            }
            turns_of(&relation, &texts)
        };
        let (a, b) = ((Kind::WAY, 1, "from"), (Kind::WAY, 2, "from"));
        let (c, d) = ((Kind::WAY, 3, "to"), (Kind::WAY, 4, "to"));
        let via = (Kind::NODE, 9, "via");
        assert_eq!(turns(&[a, b, via, c], "no_entry"), RelationTurns::Each(vec![vec![a, via, c], vec![b, via, c]]));
        assert_eq!(turns(&[a, via, c, d], "no_exit"), RelationTurns::Each(vec![vec![a, via, c], vec![a, via, d]]));
        let all = [[a, c], [a, d], [b, c], [b, d]].map(|[from, to]| vec![from, via, to]);
        assert_eq!(turns(&[a, b, via, c, d], "no_exit"), RelationTurns::Each(all.to_vec()));
        let ways = [(Kind::WAY, 7, "via"), (Kind::WAY, 8, "via")];
        let over = |from: RelationMember| vec![from, ways[0], ways[1], c];
        assert_eq!(turns(&[a, b, ways[0], ways[1], c], "no_entry"), RelationTurns::Each(vec![over(a), over(b)]));
        assert_eq!(
            turns(&[a, b, via, c], "only_straight_on"),
            RelationTurns::Each(vec![vec![a, via, c], vec![b, via, c]])
        );
        assert_eq!(turns(&[a, via, c, d], "only_straight_on"), RelationTurns::NotToBeSaid);
        assert_eq!(turns(&[a, via, c], "no_left_turn"), RelationTurns::AsItIs);
        assert_eq!(turns(&[a, b, via], "no_entry"), RelationTurns::AsItIs);
        let many: Vec<RelationMember> =
            (0..40).flat_map(|id| [(Kind::WAY, id, "from"), (Kind::WAY, id, "to")]).collect();
        assert_eq!(turns(&many, "no_exit"), RelationTurns::NotToBeSaid);
    }

    #[test]
    fn only_a_plain_refusal_makes_another_one_needless() {
        let mut texts = Texts::over(vec![Vec::new()]);
        let members = [(Kind::WAY, 5, "from"), (Kind::NODE, 4, "via"), (Kind::WAY, 9, "to")];
        let mut read = |members: &[(Kind, i64, &str)], tags: &[(&str, &str)], key: &str| {
            let mut relation = relation(members, &mut texts);
            for (key, value) in tags {
                relation.keys.push(texts.number(key.as_bytes()));
                relation.vals.push(texts.number(value.as_bytes()));
            }
            refused(&relation, &texts, key)
        };
        let plain = [("type", "restriction"), ("restriction", "no_left_turn")];
        let ours = |members: &[(Kind, i64, &'static str)]| RefusedTurn::by(members.iter().copied());
        assert_eq!(read(&members, &plain, "restriction"), ours(&members));
        assert_eq!(read(&members, &plain, "restriction:hgv"), None);
        assert_eq!(read(&members, &[plain[0], plain[1], ("except", "hgv")], "restriction"), None);
        assert_eq!(read(&members, &[plain[0], ("restriction", "only_left_turn")], "restriction"), None);
        assert_eq!(read(&members[..2], &plain, "restriction"), None);
        let two = [members[0], (Kind::WAY, 6, "from"), members[1], members[2]];
        assert_eq!(read(&two, &plain, "restriction"), None);
        let over = [members[0], (Kind::WAY, 4, "via"), members[2]];
        assert_eq!(read(&over, &plain, "restriction"), ours(&over));
        assert_ne!(ours(&over), ours(&members));
    }
}
