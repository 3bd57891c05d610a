//! Relations: those of the extract name the parts of ways that were split, and new ones refuse turns.

use osmpbfreader::osmformat::Relation;
pub(super) use osmpbfreader::osmformat::relation::MemberType as Kind;
use protobuf::EnumOrUnknown;
use rustc_hash::FxHashMap;

use super::block::Texts;

/// A part of a split way: its id, and its first and last node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PartEnds {
    pub(super) id: i64,
    pub(super) ends: [i64; 2],
}

/// By way: its parts, in way order; of split ways only.
pub(super) type Splits = FxHashMap<i64, Vec<PartEnds>>;

/// Puts parts in the place of split ways; whether there were any.
pub(super) fn name_parts(relation: &mut Relation, splits: &Splits, texts: &mut Texts) -> bool {
    let mut id = 0_i64;
    let ids: Vec<i64> = relation
        .memids
        .iter()
        .map(|step| {
            id = id.wrapping_add(*step);
            id
        })
        .collect();
    let kinds: Vec<Kind> = relation.types.iter().map(EnumOrUnknown::enum_value_or_default).collect();
    if !ids.iter().zip(&kinds).any(|(id, kind)| *kind == Kind::WAY && splits.contains_key(id)) {
        return false;
    }
    let restriction = is_restriction(relation, texts);
    let roles: Vec<String> =
        relation.roles_sid.iter().map(|&role| String::from_utf8_lossy(texts.text(role as u32)).into_owned()).collect();
    let via: Vec<i64> = (0..ids.len())
        .filter(|&i| restriction && roles.get(i).is_some_and(|role| role == "via"))
        .flat_map(|i| via_nodes(ids[i], kinds.get(i).copied(), splits))
        .collect();
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

fn is_restriction(relation: &Relation, texts: &Texts) -> bool {
    let value = |(key, value): (&u32, &u32)| (texts.text(*key) == b"type").then(|| texts.text(*value));
    relation.keys.iter().zip(&relation.vals).find_map(value).is_some_and(|kind| kind.starts_with(b"restriction"))
}

/// Where one passes through a `via`: itself if it is a node, else the ends of the way, which are known if it was split.
fn via_nodes(id: i64, kind: Option<Kind>, splits: &Splits) -> Vec<i64> {
    match kind {
        Some(Kind::NODE) => vec![id],
        Some(Kind::WAY) => splits.get(&id).map_or_else(Vec::new, |parts| {
            let ends = [parts.first().map(|part| part.ends[0]), parts.last().map(|part| part.ends[1])];
            ends.into_iter().flatten().collect()
        }),
        _ => Vec::new(),
    }
}

/// The part at the `via`. Where that is not known the first one: a restriction over ways is written anew with the parts that it
/// means.
fn touching(parts: &[PartEnds], via: &[i64]) -> i64 {
    let touches = |part: &&PartEnds| part.ends.iter().any(|end| via.contains(end));
    parts.iter().find(touches).or(parts.first()).map_or(0, |part| part.id)
}

/// Which word refuses a turn by so many degrees, positive left.
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

    fn ids(relation: &Relation) -> Vec<i64> {
        relation
            .memids
            .iter()
            .scan(0, |id, step| {
                *id += step;
                Some(*id)
            })
            .collect()
    }

    #[test]
    fn a_restriction_names_the_part_at_its_node_and_a_route_all_parts() {
        let mut texts = Texts::over(vec![Vec::new()]);
        let part = |id, ends| PartEnds { id, ends };
        let splits = Splits::from_iter([(5, vec![part(5, [1, 2]), part(105, [2, 3]), part(106, [3, 4])])]);
        let mut ban = relation(&[(Kind::WAY, 5, "from"), (Kind::NODE, 4, "via"), (Kind::WAY, 9, "to")], &mut texts);
        ban.keys.push(texts.number(b"type"));
        ban.vals.push(texts.number(b"restriction"));
        assert!(name_parts(&mut ban, &splits, &mut texts));
        assert_eq!(ids(&ban), [106, 4, 9]);
        let mut route = relation(&[(Kind::WAY, 7, ""), (Kind::WAY, 5, ""), (Kind::WAY, 5, "backward")], &mut texts);
        assert!(name_parts(&mut route, &splits, &mut texts));
        assert_eq!(ids(&route), [7, 5, 105, 106, 106, 105, 5]);
        let mut other = relation(&[(Kind::NODE, 5, ""), (Kind::WAY, 8, "")], &mut texts);
        assert!(!name_parts(&mut other, &splits, &mut texts));
    }
}
