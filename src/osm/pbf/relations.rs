//! Relations: counted, not yet used. Turn restrictions are told apart, and the broken ones among them.
//!
//! Promises: whatever a relation refers to, itself included, is never followed.

use osmpbfreader::osmformat::{Relation, relation::MemberType};
use protobuf::Message;

use super::{
    block::Strings,
    error::{ObjectId, Problem},
    wire::{self, Shape},
};

/// How many relations there were.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RelationTally {
    /// All, used for nothing so far.
    pub read: u64,
    /// Of these, turn restrictions.
    pub restrictions: u64,
    /// Of these, without a way `from` and `to` and something `via`, of a kind nobody knows, or members of themselves.
    pub broken_restrictions: u64,
    /// Of the others, with a `via` node that is on no kept way, or not in the file.
    pub restrictions_off_road: u64,
}

impl RelationTally {
    pub(super) fn add(&mut self, other: Self) {
        self.read += other.read;
        self.restrictions += other.restrictions;
        self.broken_restrictions += other.broken_restrictions;
        self.restrictions_off_road += other.restrictions_off_road;
    }
}

/// Checks and counts one relation; of a whole restriction the `via` nodes are noted.
pub(super) fn read(
    message: &[u8],
    strings: &Strings<'_>,
    tally: &mut RelationTally,
    vias: &mut Vec<i64>,
) -> Result<(), Problem> {
    use Shape::{Bytes, Number, Numbers};
    wire::check(
        message,
        &[(1, Number), (2, Numbers), (3, Numbers), (4, Bytes), (8, Numbers), (9, Numbers), (10, Numbers)],
    )?;
    let relation = Relation::parse_from_bytes(message)
        .map_err(|error| Problem::Message { what: "relation", detail: error.to_string() })?;
    let object = ObjectId::Relation(relation.id());
    if relation.keys.len() != relation.vals.len() {
        return Err(Problem::Lengths { object, what: "keys and values" });
    }
    if relation.memids.len() != relation.roles_sid.len() || relation.memids.len() != relation.types.len() {
        return Err(Problem::Lengths { object, what: "members, roles and types" });
    }
    let mut kind = "";
    let mut restriction = None;
    for (&key, &value) in relation.keys.iter().zip(&relation.vals) {
        let (key, value) = (strings.text(key.into(), object)?, strings.text(value.into(), object)?);
        if key == "type" {
            kind = value;
        } else if key == "restriction" || key.starts_with("restriction:") {
            restriction = Some(value);
        }
    }
    let members = Members::of(&relation, strings, object)?;
    tally.read += 1;
    if kind == "restriction" || kind.starts_with("restriction:") {
        tally.restrictions += 1;
        if members.complete() && restriction.is_some_and(is_known) {
            vias.extend(members.via_node);
        } else {
            tally.broken_restrictions += 1;
        }
    }
    Ok(())
}

/// <https://wiki.openstreetmap.org/wiki/Relation:restriction>
fn is_known(restriction: &str) -> bool {
    // Conditional ones read "no_left_turn @ (Mo-Fr 07:00-09:00)".
    let kind = restriction.split('@').next().unwrap_or_default().trim();
    let turns = ["left_turn", "right_turn", "straight_on", "u_turn", "entry", "exit"];
    kind.strip_prefix("no_").or(kind.strip_prefix("only_")).is_some_and(|turn| turns.contains(&turn))
}

/// Which members of a restriction are there.
#[derive(Debug, Default)]
struct Members {
    from: bool,
    via: bool,
    /// The last one, if it is a node.
    via_node: Option<i64>,
    to: bool,
    itself: bool,
}

impl Members {
    fn of(relation: &Relation, strings: &Strings<'_>, object: ObjectId) -> Result<Self, Problem> {
        let mut found = Self::default();
        let mut member = 0;
        for ((&difference, kind), &role) in relation.memids.iter().zip(&relation.types).zip(&relation.roles_sid) {
            super::block::add(&mut member, difference, object, "a member")?;
            let kind = kind
                .enum_value()
                .map_err(|kind| Problem::Message { what: "relation", detail: format!("member of type {kind}") })?;
            // A negative index is out of range of any table.
            match strings.text(role as u64, object)? {
                "from" => found.from |= kind == MemberType::WAY,
                "to" => found.to |= kind == MemberType::WAY,
                "via" => {
                    found.via |= kind != MemberType::RELATION;
                    found.via_node = (kind == MemberType::NODE).then_some(member);
                }
                _ => {}
            }
            found.itself |= kind == MemberType::RELATION && member == relation.id();
        }
        Ok(found)
    }

    fn complete(&self) -> bool {
        self.from && self.via && self.to && !self.itself
    }
}
