//! Relations: turn restrictions for heavy goods vehicles are kept, and all others counted.
//!
//! Every relation is kept or counted under one reason. References to other relations, or to itself, are never followed.

use osmpbfreader::osmformat::{Relation, relation::MemberType};
use protobuf::Message;
use rustc_hash::FxHashSet;

use crate::osm::changes::{Changes, ObjectKind};
use crate::osm::facts::{BackdropForm, NoRule, TurnRule, backdrop_kind, turn_rules};
use crate::osm::read_account::RelationTally;
use crate::osm::{NodeId, Restriction, Via};

use super::{
    backdrop_objects::AreaRelation,
    block::Strings,
    error::{ObjectId, PbfProblem},
    wire::{self, FieldEncoding},
};

/// Results from a block's relations.
#[derive(Debug, Default)]
pub(super) struct RelationBatch {
    /// Whether there was any relation at all.
    pub(super) found: bool,
    pub(super) tally: RelationTally,
    pub(super) restrictions: Vec<Restriction>,
    /// `via` nodes of whole restrictions, for any vehicle.
    pub(super) vias: Vec<NodeId>,
}

/// A relation whose message was checked, and its tags.
struct Checked<'a> {
    relation: Relation,
    object: ObjectId,
    tags: Vec<(&'a str, &'a str)>,
}

fn checked<'a>(message: &[u8], strings: &Strings<'a>) -> Result<Checked<'a>, PbfProblem> {
    use FieldEncoding::{Bytes, Number, Numbers};
    wire::check(
        message,
        &[(1, Number), (2, Numbers), (3, Numbers), (4, Bytes), (8, Numbers), (9, Numbers), (10, Numbers)],
    )?;
    let relation = Relation::parse_from_bytes(message)
        .map_err(|error| PbfProblem::Message { what: "relation", detail: error.to_string() })?;
    let object = ObjectId::Relation(relation.id());
    if relation.keys.len() != relation.vals.len() {
        return Err(PbfProblem::Lengths { object, what: "keys and values" });
    }
    if relation.memids.len() != relation.roles_sid.len() || relation.memids.len() != relation.types.len() {
        return Err(PbfProblem::Lengths { object, what: "members, roles and types" });
    }
    super::block::limit_tags(relation.keys.len())?;
    super::block::limit(relation.memids.len(), "the number of members of a relation")?;
    let mut tags = Vec::with_capacity(relation.keys.len());
    for (&key, &value) in relation.keys.iter().zip(&relation.vals) {
        tags.push((strings.text(key.into(), object)?, strings.text(value.into(), object)?));
    }
    Ok(Checked { relation, object, tags })
}

/// The multipolygon that a relation is, if its tags make it part of the backdrop and it is not `changed`.
pub(super) fn area(
    message: &[u8],
    strings: &Strings<'_>,
    changed: &Changes,
) -> Result<Option<AreaRelation>, PbfProblem> {
    let Checked { relation, object, tags } = checked(message, strings)?;
    let value = |wanted: &str| tags.iter().find(|(key, _)| *key == wanted).map(|tag| tag.1);
    if value("type") != Some("multipolygon") || changed.has(ObjectKind::Relation, relation.id()) {
        return Ok(None);
    }
    let Some(kind) = backdrop_kind(&tags).filter(|kind| kind.form() == BackdropForm::Area) else { return Ok(None) };
    let mut members = Vec::new();
    // A member that is named again would be the same ring again, with all its nodes.
    let mut known = FxHashSet::default();
    let mut member = 0;
    for ((&difference, kind), &role) in relation.memids.iter().zip(&relation.types).zip(&relation.roles_sid) {
        super::block::add(&mut member, difference, object, "a member")?;
        if kind.enum_value() == Ok(MemberType::WAY) {
            let named = (member, strings.text(role as u64, object)? == "inner");
            if known.insert(named) {
                members.push(named);
            }
        }
    }
    Ok(Some(AreaRelation { id: relation.id(), kind, name: value("name").map(Into::into), members }))
}

/// Checks and counts one relation, and keeps it if it restricts turns of heavy goods vehicles. One that is `changed` is passed over.
pub(super) fn read(
    message: &[u8],
    strings: &Strings<'_>,
    changed: &Changes,
    batch: &mut RelationBatch,
) -> Result<(), PbfProblem> {
    let Checked { relation, object, tags } = checked(message, strings)?;
    batch.found = true;
    let members = Members::of(&relation, strings, object)?;
    if changed.has(ObjectKind::Relation, relation.id()) {
        return Ok(());
    }
    batch.tally.read += 1;
    let Some(rules) = turn_rules(&tags) else { return Ok(()) };
    batch.tally.restrictions += 1;
    if rules == Err(NoRule::Unknown) {
        batch.tally.unknown_restrictions += 1;
        return Ok(());
    }
    let only = rules.as_ref().is_ok_and(|rules| rules.iter().any(|rule| rule.kind.only));
    if !members.understood(only) {
        batch.tally.broken_restrictions += 1;
        return Ok(());
    }
    batch.vias.extend(members.via_nodes.last());
    match rules {
        Ok(rules) => {
            batch.tally.incomplete_restrictions += u64::from(!members.complete());
            batch.restrictions.push(members.restriction(relation.id(), rules));
        }
        Err(NoRule::Exempt) => batch.tally.exempt += 1,
        Err(NoRule::OnRed) => batch.tally.on_red += 1,
        Err(NoRule::OtherVehicles | NoRule::Unknown) => batch.tally.other_vehicles += 1,
    }
    Ok(())
}

/// The members of a restriction.
#[derive(Debug, Default)]
struct Members {
    from: Vec<i64>,
    via_nodes: Vec<NodeId>,
    via_ways: Vec<i64>,
    to: Vec<i64>,
    itself: bool,
}

impl Members {
    fn of(relation: &Relation, strings: &Strings<'_>, object: ObjectId) -> Result<Self, PbfProblem> {
        let mut found = Self::default();
        // Nodes that stand for a missing `via`, the better ones first.
        let mut hints: [Vec<NodeId>; 2] = Default::default();
        let mut member = 0;
        for ((&difference, kind), &role) in relation.memids.iter().zip(&relation.types).zip(&relation.roles_sid) {
            super::block::add(&mut member, difference, object, "a member")?;
            let kind = kind
                .enum_value()
                .map_err(|kind| PbfProblem::Message { what: "relation", detail: format!("member of type {kind}") })?;
            // A negative index is out of range of any table.
            match (strings.text(role as u64, object)?.trim().to_ascii_lowercase().as_str(), kind) {
                ("from", MemberType::WAY) => found.from.push(member),
                ("to", MemberType::WAY) => found.to.push(member),
                ("via", MemberType::NODE) => found.via_nodes.push(NodeId::new(member)),
                ("via", MemberType::WAY) => found.via_ways.push(member),
                ("intersection", MemberType::NODE) => hints[0].push(NodeId::new(member)),
                ("location_hint", MemberType::NODE) => hints[1].push(NodeId::new(member)),
                _ => {}
            }
            found.itself |= kind == MemberType::RELATION && member == relation.id();
        }
        if !found.has_via() {
            found.via_nodes = hints.into_iter().find(|nodes| !nodes.is_empty()).unwrap_or_default();
        }
        Ok(found)
    }

    fn has_via(&self) -> bool {
        !self.via_nodes.is_empty() || !self.via_ways.is_empty()
    }

    fn complete(&self) -> bool {
        self.has_via() && !self.from.is_empty() && !self.to.is_empty()
    }

    /// Whether the members say which turns are meant, or at least among which. A missing `via` is where the others meet. Without
    /// `from` nobody knows whom an `only_…` concerns.
    fn understood(&self, only: bool) -> bool {
        let two = match (self.from.is_empty(), self.has_via(), self.to.is_empty()) {
            (true, true, false) => !only && self.via_ways.is_empty(),
            (from, via, to) => !from && (via || !to),
        };
        two && !self.itself
    }

    fn restriction(self, id: i64, rules: Vec<TurnRule>) -> Restriction {
        let via = if self.via_ways.is_empty() { Via::Nodes(self.via_nodes) } else { Via::Ways(self.via_ways) };
        Restriction { id, rules, from: self.from, via, to: self.to }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use MemberType::{NODE, WAY};

    /// Reads one relation with these tags and members.
    fn reading(tags: &[(&str, &str)], members: &[(MemberType, i64, &str)]) -> RelationBatch {
        let mut relation = Relation::new();
        relation.set_id(7);
        let mut texts = Vec::new();
        for (key, value) in tags {
            relation.keys.push(texts.len() as u32);
            relation.vals.push(texts.len() as u32 + 1);
            texts.extend([*key, *value]);
        }
        let mut last = 0;
        for &(kind, id, role) in members {
            relation.types.push(kind.into());
            relation.memids.push(id - last);
            relation.roles_sid.push(texts.len() as i32);
            texts.push(role);
            last = id;
        }
        let mut batch = RelationBatch::default();
        let message = relation.write_to_bytes().unwrap();
        read(&message, &Strings::of(&texts), &Changes::default(), &mut batch).unwrap();
        let tally = batch.tally;
        assert_eq!(tally.read, 1);
        assert_eq!(tally.kept(), batch.restrictions.len() as u64);
        batch
    }

    /// `from > via > to`, with nodes of a `via` after `@`, or `None` if the relation is not kept.
    fn read_as(value: &str, members: &[(MemberType, i64, &str)]) -> Option<String> {
        let mut batch = reading(&[("type", "restriction"), ("restriction", value)], members);
        let restriction = batch.restrictions.pop()?;
        let list = |ids: &[i64]| ids.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
        let nodes_of = |nodes: &[NodeId]| list(&nodes.iter().map(|node| node.get()).collect::<Vec<_>>());
        let via = match &restriction.via {
            Via::Nodes(nodes) => format!("@{}", nodes_of(nodes)),
            Via::Ways(ways) => list(ways),
        };
        Some(format!("{} > {via} > {}", list(&restriction.from), list(&restriction.to)))
    }

    #[test]
    fn members_are_understood_in_other_spellings_and_places() {
        type Case = (&'static str, &'static [(MemberType, i64, &'static str)], Option<&'static str>);
        let table: [Case; 15] = [
            ("no_left_turn", &[(WAY, 1, "from"), (NODE, 5, "via"), (WAY, 2, "to")], Some("1 > @5 > 2")),
            ("no_left_turn", &[(WAY, 2, "To"), (NODE, 5, "VIA"), (WAY, 1, " From ")], Some("1 > @5 > 2")),
            ("no_entry", &[(WAY, 1, "from"), (WAY, 3, "from"), (NODE, 5, "via"), (WAY, 2, "to")], Some("1,3 > @5 > 2")),
            ("no_exit", &[(WAY, 1, "from"), (NODE, 5, "via"), (WAY, 2, "to"), (WAY, 3, "to")], Some("1 > @5 > 2,3")),
            ("no_u_turn", &[(WAY, 1, "from"), (WAY, 3, "via"), (WAY, 4, "via"), (WAY, 2, "to")], Some("1 > 3,4 > 2")),
            ("no_u_turn", &[(WAY, 1, "from"), (NODE, 5, "via"), (WAY, 3, "via"), (WAY, 2, "to")], Some("1 > 3 > 2")),
            ("no_left_turn", &[(WAY, 1, "from"), (NODE, 5, "intersection"), (WAY, 2, "to")], Some("1 > @5 > 2")),
            ("no_left_turn", &[(WAY, 1, "from"), (NODE, 5, "location_hint"), (WAY, 2, "to")], Some("1 > @5 > 2")),
            (
                "no_left_turn",
                &[(WAY, 1, "from"), (NODE, 6, "location_hint"), (NODE, 5, "via"), (WAY, 2, "to")],
                Some("1 > @5 > 2"),
            ),
            ("no_left_turn", &[(WAY, 1, "from"), (WAY, 2, "to")], Some("1 > @ > 2")),
            ("only_left_turn", &[(WAY, 1, "from"), (NODE, 5, "via")], Some("1 > @5 > ")),
            ("no_left_turn", &[(NODE, 5, "via"), (WAY, 2, "to")], Some(" > @5 > 2")),
            ("only_left_turn", &[(NODE, 5, "via"), (WAY, 2, "to")], None),
            ("no_left_turn", &[(WAY, 3, "via"), (WAY, 2, "to")], None),
            ("no_left_turn", &[(NODE, 5, "via"), (NODE, 1, "from"), (NODE, 2, "to")], None),
        ];
        for (value, members, expected) in table {
            assert_eq!(read_as(value, members).as_deref(), expected, "{value} {members:?}");
        }
    }

    #[test]
    fn every_restriction_has_one_counted_outcome() {
        const MEMBERS: &[(MemberType, i64, &str)] = &[(WAY, 1, "from"), (NODE, 5, "via"), (WAY, 2, "to")];
        let tally =
            |tags: &[(&str, &str)], members| reading(&[&[("type", "restriction")], tags].concat(), members).tally;
        let plain = ("restriction", "no_left_turn");
        assert_eq!(tally(&[plain], MEMBERS).kept(), 1);
        assert_eq!(tally(&[("restriction", "none")], MEMBERS).unknown_restrictions, 1);
        assert_eq!(tally(&[], MEMBERS).unknown_restrictions, 1);
        assert_eq!(tally(&[("restriction", "no_right_turn_on_red")], MEMBERS).on_red, 1);
        assert_eq!(tally(&[plain, ("except", "hgv")], MEMBERS).exempt, 1);
        assert_eq!(tally(&[("restriction:bus", "no_left_turn")], MEMBERS).other_vehicles, 1);
        assert_eq!(tally(&[plain], &MEMBERS[..1]).broken_restrictions, 1);
        let incomplete = tally(&[plain], &MEMBERS[..2]);
        assert_eq!((incomplete.kept(), incomplete.incomplete_restrictions), (1, 1));
        assert_eq!(reading(&[("type", "route")], MEMBERS).tally.restrictions, 0);
    }

    /// Each name is a few bytes of file; as a ring it would be all nodes of the way again.
    #[test]
    fn a_member_that_is_named_again_is_one_member() {
        let strings = Strings::of(&["", "type", "multipolygon", "natural", "water", "outer", "inner"]);
        let n = 100_000;
        let mut relation = Relation::new();
        relation.set_id(7);
        (relation.keys, relation.vals) = (vec![1, 3], vec![2, 4]);
        // Way 5 as outline again and again, then as a hole, and then way 6.
        relation.memids = [5].into_iter().chain(std::iter::repeat_n(0, n)).chain([1]).collect();
        relation.roles_sid = std::iter::repeat_n(5, n).chain([6, 5]).collect();
        relation.types = std::iter::repeat_n(MemberType::WAY.into(), n + 2).collect();
        let found = area(&relation.write_to_bytes().unwrap(), &strings, &Changes::default()).unwrap().unwrap();
        assert_eq!(found.members, [(5, false), (5, true), (6, false)]);
    }
}
