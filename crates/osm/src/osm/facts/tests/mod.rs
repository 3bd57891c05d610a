//! Tags in, strips and limits out, through the public functions only.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod legal;
mod lists;
mod narrow;
mod properties;
mod sections;
mod supposed;
mod ways;

use crate::osm::facts::*;

const RIGHT: Jurisdiction = Jurisdiction { country: *b"ZZ", left_hand_traffic: false };
const LEFT: Jurisdiction = Jurisdiction { country: *b"ZZ", left_hand_traffic: true };

/// Parses `highway=primary width=7` into tags.
fn tags(text: &str) -> Vec<(&str, &str)> {
    text.split_whitespace().map(|tag| tag.split_once('=').expect("key=value")).collect()
}

fn draft(text: &str) -> WayDraft<'_> {
    way_facts(&tags(text)).expect("a road")
}

fn sections(text: &str, jurisdiction: &Jurisdiction) -> [CrossSection; 2] {
    cross_sections(&draft(text).facts, jurisdiction, None, &Rules::builtin().unwrap())
}

/// Left and right edge in centimetres, and the evidence.
fn show(strip: Option<Strip>) -> String {
    strip.map_or("-".to_owned(), |s| {
        format!("{:.0}..{:.0} {:?}", s.left_m * 100.0 + 0.0, s.right_m * 100.0 + 0.0, s.source).replace("-0.", "0.")
    })
}

/// `forward lane | backward lane | forward direction | carriageway`, traffic on the right.
fn check(text: &str, expected: &str) {
    check_at(text, &RIGHT, expected);
}

fn check_at(text: &str, jurisdiction: &Jurisdiction, expected: &str) {
    let [forward, backward] = sections(text, jurisdiction);
    let carriageway = forward.carriageway.or(backward.carriageway);
    let got = [forward.lane, backward.lane, forward.direction, carriageway].map(show).join(" | ");
    assert_eq!(got, expected, "{text}");
}
