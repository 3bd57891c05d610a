//! Limits in the form that every reader takes: bare numbers of metres and tonnes, on the ways.
//!
//! Engines misread units. OSRM 26.10 takes `12 ft` for 12 m and `380 cm` for 380 m (`findings/osrm-height-units.sh`), Valhalla 3.9.1 takes
//! `20000 lbs` for 10 t and `7,5` for 7 t (`findings/valhalla-weight-units.sh`). Both pass over limits of nodes. A value changes only in
//! its form, or becomes smaller. What cannot be read stays as it is: the permits close such a road.

use osmpbfreader::osmformat::PrimitiveBlock;
use rustc_hash::FxHashMap;

use super::tags::Tag;
use crate::osm::facts::{Limit, LimitKind};
use crate::ways::ids;

/// Widths of roads, which OSRM reads like limits.
const WIDTHS: [&str; 2] = ["width", "est_width"];

/// A limit: its key without a direction, and its value in metres or tonnes.
type NodeLimit = (String, f32);

/// The limits of nodes.
#[derive(Default)]
pub(super) struct NodeLimits {
    by_node: FxHashMap<i64, Vec<NodeLimit>>,
}

impl NodeLimits {
    /// Takes the limits of a block's nodes.
    pub(super) fn take(&mut self, block: &PrimitiveBlock) {
        let texts = &block.stringtable.s;
        let text =
            |number: usize| texts.get(number).and_then(|text| std::str::from_utf8(text).ok()).unwrap_or_default();
        for group in &block.primitivegroup {
            for node in &group.nodes {
                for (&key, &value) in node.keys.iter().zip(&node.vals) {
                    self.tag(node.id(), text(key as usize), text(value as usize));
                }
            }
            // Keys and values by turns; a zero ends the tags of a node.
            let mut tags = group.dense.keys_vals.split(|&number| number == 0);
            for id in ids(&group.dense.id) {
                for pair in tags.next().unwrap_or_default().as_chunks::<2>().0 {
                    let [key, value] = pair.map(|number| text(usize::try_from(number).unwrap_or_default()));
                    self.tag(id, key, value);
                }
            }
        }
    }

    fn tag(&mut self, node: i64, key: &str, value: &str) {
        if let Some(Limit::At(most)) = LimitKind::of_tag(key).map(|kind| kind.read(value)) {
            self.by_node.entry(node).or_default().push((group(key), most));
        }
    }

    /// Whether one of these nodes has a limit.
    pub(super) fn any_on(&self, nodes: &[i64]) -> bool {
        !self.by_node.is_empty() && nodes.iter().any(|node| self.by_node.contains_key(node))
    }

    /// The strictest limits of these nodes, each key once.
    pub(super) fn on(&self, nodes: &[i64]) -> Vec<NodeLimit> {
        let mut out: Vec<NodeLimit> = Vec::new();
        for (key, most) in nodes.iter().filter_map(|node| self.by_node.get(node)).flatten() {
            match out.iter_mut().find(|(known, _)| known == key) {
                Some((_, least)) => *least = least.min(*most),
                None => out.push((key.clone(), *most)),
            }
        }
        out
    }
}

/// The tags of a road with its limits as numbers. Limits of its nodes bound them. A tag that changes is kept under `netcert:was:…`.
pub(super) fn with_limits(tags: Vec<Tag>, of_nodes: &[NodeLimit]) -> Vec<Tag> {
    let of_node = |group: &str| of_nodes.iter().find(|(key, _)| key == group).map(|(_, most)| *most);
    let mut out: Vec<Tag> = Vec::with_capacity(tags.len() + of_nodes.len());
    // What holds in both directions, by group: readers take one of its keys.
    let mut both: Vec<NodeLimit> = of_nodes.to_vec();
    for (key, value) in tags {
        let (Some(name), Some(text)) = (std::str::from_utf8(&key).ok(), std::str::from_utf8(&value).ok()) else {
            out.push((key, value));
            continue;
        };
        let Some((kind, limit)) = limit_of(name, text) else {
            out.push((key, value));
            continue;
        };
        let (group, own) = (group(name), if let Limit::At(most) = limit { Some(most) } else { None });
        let bound = of_node(&group).filter(|_| limit != Limit::Unreadable);
        let least = own.into_iter().chain(bound).reduce(f32::min);
        if let (Some(least), true, Some((_, both))) =
            (least, !directed(name), both.iter_mut().find(|(key, _)| *key == group))
        {
            *both = both.min(least);
        }
        match least.and_then(number) {
            // A number in metres or tonnes stays as it was typed, if it is the limit.
            Some(_) if least == own && is_bare(text) => out.push((key, value)),
            Some(number) => {
                debug_assert!(matches!(kind.read(&number), Limit::At(_)), "{number}");
                out.push(([b"netcert:was:", key.as_slice()].concat(), value));
                out.push((key, number.into_bytes()));
            }
            None => out.push((key, value)),
        }
    }
    for (group, most) in both {
        if let Some(number) = number(most).filter(|_| !out.iter().any(|(key, _)| *key == group.as_bytes())) {
            out.push((group.into_bytes(), number.into_bytes()));
        }
    }
    out
}

fn limit_of(key: &str, value: &str) -> Option<(LimitKind, Limit)> {
    if key.starts_with("netcert") {
        return None;
    }
    let kind = LimitKind::of_tag(key).or_else(|| WIDTHS.contains(&key).then_some(LimitKind::Width))?;
    Some((kind, kind.read(value)))
}

fn directed(key: &str) -> bool {
    key.split(':').any(|part| matches!(part, "forward" | "backward"))
}

/// A key without direction and without words that change nothing of what it bounds.
fn group(key: &str) -> String {
    let says_more = |part: &&str| !matches!(*part, "forward" | "backward" | "physical" | "legal" | "signed");
    key.split(':').filter(says_more).collect::<Vec<_>>().join(":")
}

fn is_bare(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit()) && text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
}

/// A limit to the nearest millimetre or kilogram, which is the tolerance with which netcert compares. `None` if nothing is left of it.
fn number(most: f32) -> Option<String> {
    let rounded = (f64::from(most) * 1000.0).round() / 1000.0;
    (rounded > 0.0).then(|| rounded.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(before: &str, of_nodes: &[(&str, f32)]) -> String {
        let tag =
            |tag: &str| tag.split_once('=').map(|(key, value)| (key.as_bytes().to_vec(), value.as_bytes().to_vec()));
        let of_nodes: Vec<NodeLimit> = of_nodes.iter().map(|(key, most)| ((*key).to_owned(), *most)).collect();
        let tags = with_limits(before.split(", ").filter_map(tag).collect(), &of_nodes);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        tags.iter().map(|(key, value)| format!("{}={}", text(key), text(value))).collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn limits_with_units_become_numbers_and_what_stood_there_is_kept() {
        for (before, after) in [
            ("maxheight=12 ft", "netcert:was:maxheight=12 ft, maxheight=3.658"),
            ("maxheight=12'6\"", "netcert:was:maxheight=12'6\", maxheight=3.81"),
            ("maxheight=380 cm", "netcert:was:maxheight=380 cm, maxheight=3.8"),
            ("maxheight:forward=3,8 m", "netcert:was:maxheight:forward=3,8 m, maxheight:forward=3.8"),
            ("maxweight=20000 lbs", "netcert:was:maxweight=20000 lbs, maxweight=9.072"),
            ("maxweight=7,5", "netcert:was:maxweight=7,5, maxweight=7.5"),
            ("hgv:maxweight=7500 kg", "netcert:was:hgv:maxweight=7500 kg, hgv:maxweight=7.5"),
            ("maxweight:hgv=10 st", "netcert:was:maxweight:hgv=10 st, maxweight:hgv=9.072"),
            ("maxlength=12;7.5", "netcert:was:maxlength=12;7.5, maxlength=7.5"),
            ("maxaxleload=11.5 t", "netcert:was:maxaxleload=11.5 t, maxaxleload=11.5"),
            ("width=20 ft", "netcert:was:width=20 ft, width=6.096"),
        ] {
            assert_eq!(written(before, &[]), after);
        }
        for same in [
            "maxheight=3.8",
            "maxheight=3.80",
            "maxheight=none",
            "maxheight=below_default",
            "maxweight=20 tons",
            "maxweight=7500",
            "maxweight:conditional=7500 kg @ (22:00-06:00)",
            "maxheight:lanes=380 cm|4",
            "source:maxheight=12 ft",
            "netcert:was:maxheight=12 ft",
            "name=12 ft",
        ] {
            assert_eq!(written(same, &[]), same);
        }
    }

    #[test]
    fn limits_of_nodes_only_tighten_those_of_the_way() {
        let node = [("maxheight", 3.5)];
        assert_eq!(written("highway=x", &node), "highway=x, maxheight=3.5");
        assert_eq!(written("maxheight=3", &node), "maxheight=3");
        assert_eq!(written("maxheight=4", &node), "netcert:was:maxheight=4, maxheight=3.5");
        assert_eq!(written("maxheight=default", &node), "netcert:was:maxheight=default, maxheight=3.5");
        assert_eq!(written("maxheight=low", &node), "maxheight=low");
        // OSRM takes `maxheight:physical` first, Valhalla `maxheight`.
        assert_eq!(written("maxheight:physical=3", &node), "maxheight:physical=3, maxheight=3");
        assert_eq!(
            written("maxheight:physical=4", &node),
            "netcert:was:maxheight:physical=4, maxheight:physical=3.5, maxheight=3.5"
        );
        assert_eq!(
            written("maxheight:forward=4, maxheight:backward=3", &node),
            "netcert:was:maxheight:forward=4, maxheight:forward=3.5, maxheight:backward=3, maxheight=3.5"
        );
        assert_eq!(written("maxweight=3", &node), "maxweight=3, maxheight=3.5");
    }

    #[test]
    fn nodes_of_both_forms_have_their_limits() {
        use osmpbfreader::osmformat::{DenseNodes, Node, PrimitiveGroup};
        let mut block = PrimitiveBlock::new();
        let texts = ["", "maxheight", "12 ft", "maxweight:forward", "5 t", "name", "maxweight", "none"];
        block.stringtable.mut_or_insert_default().s = texts.iter().map(|text| text.as_bytes().to_vec()).collect();
        let mut node = Node::new();
        node.set_id(4);
        (node.keys, node.vals) = (vec![5, 3], vec![2, 4]);
        let mut dense = DenseNodes::new();
        (dense.id, dense.keys_vals) = (vec![7, 1, 1], vec![0, 1, 2, 3, 4, 0, 6, 7, 0]);
        block.primitivegroup.push(PrimitiveGroup { nodes: vec![node], ..PrimitiveGroup::new() });
        block.primitivegroup.push(PrimitiveGroup { dense: Some(dense).into(), ..PrimitiveGroup::new() });
        let mut limits = NodeLimits::default();
        limits.take(&block);
        assert_eq!(limits.on(&[4]), [("maxweight".to_owned(), 5.0)]);
        assert_eq!(limits.on(&[7, 9]), []);
        assert_eq!(limits.on(&[8, 4]), [("maxheight".to_owned(), 3.6576), ("maxweight".to_owned(), 5.0)]);
        assert!(limits.any_on(&[1, 8]) && !limits.any_on(&[7, 9]));
    }
}
