//! Turn restrictions: what a relation's tags forbid to a heavy goods vehicle.
//!
//! <https://wiki.openstreetmap.org/wiki/Relation:restriction>. Conditions (times, weights) are not decided: a turn that
//! is forbidden at times counts as forbidden and is marked conditional. `except=goods` exempts no vehicle here, because
//! the access key `goods` means vehicles up to 3.5 t.

use serde::{Deserialize, Serialize};

use super::Tags;
use super::legal::OTHER_VEHICLES;
use super::limits::clauses;

/// The movement that a sign names. The relation's members determine its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RestrictedTurn {
    /// `left_turn`
    LeftTurn,
    /// `right_turn`
    RightTurn,
    /// `straight_on`
    StraightOn,
    /// `u_turn`
    UTurn,
    /// `entry`
    Entry,
    /// `exit`
    Exit,
    /// Any other word, such as `turn`. It names no side.
    Other,
}

/// `no_…` forbids the movement, `only_…` forbids all others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RestrictionKind {
    /// `only_…`
    pub only: bool,
    /// The named movement.
    pub turn: RestrictedTurn,
}

/// A rule of a restriction for heavy goods vehicles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TurnRule {
    /// What it forbids.
    pub kind: RestrictionKind,
    /// Whether it holds only at times, or under an undecided condition.
    pub conditional: bool,
}

/// Why a restriction relation has no rule for heavy goods vehicles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoRule {
    /// None of its values is known.
    Unknown,
    /// It concerns other vehicles only.
    OtherVehicles,
    /// `except=hgv` or a similar exemption.
    Exempt,
    /// It forbids turns at a red light only, such as `no_right_turn_on_red`.
    OnRed,
}

/// Vehicles beside those that netcert does not have whose restrictions do not concern heavy goods vehicles. A word that is neither may mean them.
const OTHERS: [&str; 7] = ["auto_rickshaw", "bus", "cargo_bike", "coach", "psv", "tourist_bus", "trolleybus"];
/// Values of `except` that exempt heavy goods vehicles.
const EXEMPTING: [&str; 3] = ["vehicle", "motor_vehicle", "hgv"];
/// Older tags that limit a restriction to certain times.
const TIMES: [&str; 4] = ["day_on", "day_off", "hour_on", "hour_off"];

/// The rules of a relation's tags for heavy goods vehicles, each once and in order. `None` if the relation is no
/// restriction.
#[must_use]
pub fn turn_rules(tags: &Tags<'_>) -> Option<Result<Vec<TurnRule>, NoRule>> {
    let of = |key: &str| tags.iter().find(|tag| tag.0 == key).map(|tag| tag.1);
    // The older `type=restriction:hgv` names the vehicle in the type.
    let kind = of("type")?.trim().to_ascii_lowercase();
    let scope = if kind == "restriction" { "" } else { kind.strip_prefix("restriction:")? };
    let timed = tags.iter().any(|tag| TIMES.contains(&tag.0));
    let exempts = |who: &str| EXEMPTING.contains(&who.trim().to_ascii_lowercase().as_str());
    let exempt = of("except").is_some_and(|list| list.split(';').any(exempts));
    let mut rules = Vec::new();
    let (mut known, mut exempted, mut on_red) = (false, false, false);
    for &(key, value) in tags {
        let Some(key) = Key::parse(&key.to_ascii_lowercase(), scope) else { continue };
        let (red, value) = without_red(value);
        on_red |= red;
        for (kind, undecided) in kinds(&value, key.conditional) {
            known = true;
            match key.whom {
                Whom::Others => {}
                Whom::All if exempt => exempted = true,
                Whom::All | Whom::HeavyGoods => {
                    rules.push(TurnRule { kind, conditional: timed || undecided });
                }
            }
        }
    }
    rules.sort_unstable();
    // A rule that always holds also holds under a condition.
    rules.dedup_by_key(|rule| rule.kind);
    Some(match (rules.is_empty(), known, exempted) {
        (false, ..) => Ok(rules),
        (true, false, _) if on_red => Err(NoRule::OnRed),
        (true, false, _) => Err(NoRule::Unknown),
        (true, true, true) => Err(NoRule::Exempt),
        (true, true, false) => Err(NoRule::OtherVehicles),
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Whom {
    All,
    HeavyGoods,
    Others,
}

/// `restriction[:vehicle][:conditional]`
struct Key {
    whom: Whom,
    conditional: bool,
}

impl Key {
    fn parse(key: &str, scope: &str) -> Option<Self> {
        let rest = key.strip_prefix("restriction")?;
        let (rest, conditional) = rest.strip_suffix(":conditional").map_or((rest, false), |rest| (rest, true));
        let vehicle = match rest {
            "" => scope,
            rest => rest.strip_prefix(':')?,
        };
        let whom = match vehicle {
            "" => Whom::All,
            vehicle if OTHER_VEHICLES.contains(&vehicle) || OTHERS.contains(&vehicle) => Whom::Others,
            _ => Whom::HeavyGoods,
        };
        Some(Self { whom, conditional })
    }
}

/// A value without its clauses about red lights, in lower case, and whether there were any.
fn without_red(value: &str) -> (bool, String) {
    let value = value.to_ascii_lowercase();
    let about_red = |clause: &&str| {
        let kind = clause.split('@').next().unwrap_or_default().trim().replace([' ', '-'], "_");
        kind.starts_with("no_") && kind.ends_with("_on_red")
    };
    if value.contains('@') || !value.split(';').any(|clause| about_red(&clause)) {
        return (false, value);
    }
    let rest: Vec<&str> = value.split(';').filter(|clause| !about_red(clause)).collect();
    (true, rest.join(";"))
}

/// The kinds of a value in lower case, each with whether its condition is undecided.
fn kinds(value: &str, conditional: bool) -> impl Iterator<Item = (RestrictionKind, bool)> + '_ {
    clauses(value)
        .filter(|(_, condition)| !dangerous_goods_only(condition))
        .filter_map(move |(kind, condition)| Some((parse_kind(kind)?, conditional || !condition.is_empty())))
}

/// Whether a condition holds for dangerous goods only. These are not modelled.
fn dangerous_goods_only(condition: &str) -> bool {
    let part = |part: &str| {
        let part = part.trim_matches(|c: char| c.is_whitespace() || "()".contains(c));
        part == "hazmat" || part.starts_with("hazmat:") && !part.contains(' ')
    };
    !condition.contains(" or ") && condition.split(" and ").any(part)
}

/// The kind of a value in lower case. A word that is not known forbids what its members say; it has a side if it names exactly one.
fn parse_kind(text: &str) -> Option<RestrictionKind> {
    let text = text.trim().replace([' ', '-'], "_");
    let (only, turn) = match (text.strip_prefix("no_"), text.strip_prefix("only_")) {
        (Some(turn), _) => (false, turn),
        (_, Some(turn)) => (true, turn),
        (None, None) => return None,
    };
    let turn = match turn {
        "entry" => RestrictedTurn::Entry,
        "exit" => RestrictedTurn::Exit,
        turn => side(turn),
    };
    Some(RestrictionKind { only, turn })
}

fn side(turn: &str) -> RestrictedTurn {
    let sides = [
        (["left", "left"], RestrictedTurn::LeftTurn),
        (["right", "right"], RestrictedTurn::RightTurn),
        (["straight", "ahead"], RestrictedTurn::StraightOn),
        (["u_turn", "uturn"], RestrictedTurn::UTurn),
    ];
    let mut named = sides.iter().filter(|(words, _)| words.iter().any(|word| turn.contains(word)));
    match (named.next(), named.next()) {
        (Some(&(_, side)), None) => side,
        _ => RestrictedTurn::Other,
    }
}

impl RestrictionKind {
    /// The tag's text, such as `no_left_turn`.
    #[must_use]
    pub fn name(self) -> String {
        let turn = match self.turn {
            RestrictedTurn::LeftTurn => "left_turn",
            RestrictedTurn::RightTurn => "right_turn",
            RestrictedTurn::StraightOn => "straight_on",
            RestrictedTurn::UTurn => "u_turn",
            RestrictedTurn::Entry => "entry",
            RestrictedTurn::Exit => "exit",
            RestrictedTurn::Other => "turn",
        };
        format!("{}_{turn}", if self.only { "only" } else { "no" })
    }

    /// The reverse of [`RestrictionKind::name`].
    #[must_use]
    pub fn named(text: &str) -> Option<Self> {
        parse_kind(text)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A conditional rule is shown as `no_left_turn?`.
    fn rules(tags: &[(&str, &str)]) -> Result<Vec<String>, NoRule> {
        let show = |r: &TurnRule| r.kind.name() + if r.conditional { "?" } else { "" };
        turn_rules(tags).unwrap().map(|rules| rules.iter().map(show).collect())
    }

    const IS: (&str, &str) = ("type", "restriction");

    #[test]
    fn a_sign_for_all_holds_for_heavy_goods_vehicles() {
        assert_eq!(rules(&[IS, ("restriction", "no_left_turn")]).unwrap(), ["no_left_turn"]);
        assert_eq!(rules(&[IS, ("restriction", "only_straight_on")]).unwrap(), ["only_straight_on"]);
        assert_eq!(rules(&[IS, ("restriction:hgv", "no_entry")]).unwrap(), ["no_entry"]);
        assert_eq!(rules(&[("type", "restriction:hgv"), ("restriction", "no_u_turn")]).unwrap(), ["no_u_turn"]);
        assert_eq!(turn_rules(&[("type", "route"), ("restriction", "no_left_turn")]), None);
    }

    #[test]
    fn what_is_not_decided_holds() {
        let times = "no_left_turn @ (Mo-Fr 07:00-09:00; 16:00-18:00)";
        assert_eq!(rules(&[IS, ("restriction:conditional", times)]).unwrap(), ["no_left_turn?"]);
        assert_eq!(rules(&[IS, ("restriction:hgv:conditional", times)]).unwrap(), ["no_left_turn?"]);
        assert_eq!(rules(&[IS, ("restriction", "no_exit"), ("hour_on", "7:00")]).unwrap(), ["no_exit?"]);
        let both = [IS, ("restriction:conditional", times), ("restriction", "no_left_turn")];
        assert_eq!(rules(&both).unwrap(), ["no_left_turn"]);
        let lifted = [IS, ("restriction", "no_left_turn"), ("restriction:conditional", "none @ (22:00-06:00)")];
        assert_eq!(rules(&lifted).unwrap(), ["no_left_turn"]);
    }

    #[test]
    fn signs_for_others_and_exemptions_do_not_concern_heavy_goods_vehicles() {
        assert_eq!(rules(&[IS, ("restriction:bus", "no_left_turn")]), Err(NoRule::OtherVehicles));
        assert_eq!(rules(&[("type", "restriction:bicycle"), ("restriction", "no_exit")]), Err(NoRule::OtherVehicles));
        assert_eq!(rules(&[IS, ("restriction", "no_left_turn"), ("except", "psv; hgv")]), Err(NoRule::Exempt));
        assert_eq!(rules(&[IS, ("restriction", "no_left_turn"), ("except", "bus;goods")]).unwrap(), ["no_left_turn"]);
        let of_its_own = [IS, ("restriction", "no_exit"), ("except", "hgv"), ("restriction:hgv", "no_u_turn")];
        assert_eq!(rules(&of_its_own).unwrap(), ["no_u_turn"]);
    }

    #[test]
    fn other_spellings_are_read() {
        let table = [
            ("No_Left_Turn", "no_left_turn"),
            ("NO_U_TURN", "no_u_turn"),
            ("no_u-turn", "no_u_turn"),
            ("no_uturn", "no_u_turn"),
            (" no left turn ", "no_left_turn"),
            ("Only_Straight", "only_straight_on"),
            ("no_left", "no_left_turn"),
            ("no_turn", "no_turn"),
            ("only_turn", "only_turn"),
            ("no_left_u_turn", "no_turn"),
            ("no_anything_else", "no_turn"),
            ("only_bend", "only_turn"),
            ("no_left_turn;no_straight_on", "no_left_turn no_straight_on"),
            ("no_left_turn ; no_right_turn_on_red", "no_left_turn"),
        ];
        for (value, expected) in table {
            assert_eq!(rules(&[IS, ("restriction", value)]).unwrap().join(" "), expected, "{value}");
        }
        assert_eq!(rules(&[("type", "Restriction"), ("Restriction:HGV", "No_Entry")]).unwrap(), ["no_entry"]);
        for value in ["no_right_turn_on_red", "no_left_turn_on_red", "No_Turn_On_Red"] {
            assert_eq!(rules(&[IS, ("restriction", value)]), Err(NoRule::OnRed), "{value}");
        }
    }

    #[test]
    fn vehicles_that_nobody_knows_may_be_heavy_goods_vehicles() {
        for vehicle in ["hgv", "hgv_articulated", "goods", "trailer", "roadtrain", "lhv", "bdouble", "something"] {
            let key = format!("restriction:{vehicle}");
            assert_eq!(rules(&[IS, (&key, "no_left_turn")]).unwrap(), ["no_left_turn"], "{vehicle}");
        }
        for vehicle in OTHERS.into_iter().chain(OTHER_VEHICLES) {
            let key = format!("restriction:{vehicle}");
            assert_eq!(rules(&[IS, (&key, "no_left_turn")]), Err(NoRule::OtherVehicles), "{vehicle}");
        }
    }

    #[test]
    fn conditions_on_dangerous_goods_do_not_concern_the_vehicles_here() {
        let at = |condition: &str| {
            let value = format!("no_left_turn @ ({condition})");
            rules(&[IS, ("restriction:conditional", &value)])
        };
        for condition in ["hazmat", "hazmat:water", "hazmat AND 22:00-06:00"] {
            assert_eq!(at(condition), Err(NoRule::Unknown), "{condition}");
        }
        for condition in ["hazmat OR weight>7.5", "not hazmat", "weight>3.5", "Mo-Fr 07:00-09:00", "wet"] {
            assert_eq!(at(condition).unwrap(), ["no_left_turn?"], "{condition}");
        }
    }

    #[test]
    fn a_value_that_forbids_no_turn_is_no_rule() {
        for value in ["no", "none", "yes", "give_way", "left_turn", "noleftturn"] {
            assert_eq!(rules(&[IS, ("restriction", value)]), Err(NoRule::Unknown), "{value}");
        }
        assert_eq!(rules(&[IS]), Err(NoRule::Unknown));
        assert_eq!(rules(&[IS, ("restriction:conditional", "no_exit @ (hazmat)")]), Err(NoRule::Unknown));
    }
}
