//! A cross section with a measured or supposed width in place of the map's.
//!
//! A width says how wide a strip is, not where it lies. The strip keeps its middle and grows or shrinks on both sides alike.

use super::{CrossSection, Policy, Strip, WidthSource};

impl CrossSection {
    /// The section whose strip for `policy` has this width, metres, from this source.
    ///
    /// A carriageway's lanes keep their shares of it; a lane's share of a measured carriageway is `estimated` at best. A lane or direction
    /// leaves the strips around it as they are, except that they contain it. A strip that the map does not have lies around the line.
    #[must_use]
    pub fn with_width(&self, policy: Policy, width_m: f64, source: WidthSource) -> Self {
        let known = self.strip(policy).filter(|strip| strip.width_m() > 0.0);
        let Some(strip) = known else { return self.with_strip(policy, about(0.0, width_m, source)) };
        if policy != Policy::Carriageway {
            let middle_m = f64::midpoint(f64::from(strip.left_m), f64::from(strip.right_m));
            return self.with_strip(policy, about(middle_m, width_m, source));
        }
        let shared = |part: Strip| {
            let whole = (part.left_m, part.right_m) == (strip.left_m, strip.right_m);
            Strip {
                source: if whole { source } else { source.min(WidthSource::Estimated) },
                ..scaled(part, strip, width_m)
            }
        };
        Self {
            lane: self.lane.map(shared),
            direction: self.direction.map(shared),
            carriageway: Some(Strip { source, ..scaled(strip, strip, width_m) }),
        }
    }

    /// The section with several widths, metres, in the order of [`Policy`] (lane, direction, carriageway).
    ///
    /// A strip stays within the next wider one that has a width of its own: nothing makes that one wider.
    #[must_use]
    pub fn with_widths(&self, widths_m: [Option<f64>; 3], source: WidthSource) -> Self {
        let mut made = *self;
        let mut outer: Option<Policy> = None;
        for policy in [Policy::Carriageway, Policy::Direction, Policy::Lane] {
            let Some(width_m) = widths_m[policy as usize] else { continue };
            let around = made;
            made = made.with_width(policy, width_m, source);
            if let Some(outer) = outer {
                made = made.kept_within(outer, &around);
            }
            outer = Some(policy);
        }
        made
    }

    /// The section with the strip for `outer` and those around it as `around` has them, and the others cut to it.
    fn kept_within(&self, outer: Policy, around: &Self) -> Self {
        let Some(limit) = around.strip(outer) else { return *self };
        let cut = |part: Option<Strip>| {
            let part = part?;
            let cut = Strip {
                left_m: part.left_m.min(limit.left_m),
                right_m: part.right_m.max(limit.right_m),
                source: part.source,
            };
            Some(cut).filter(|cut| cut.width_m() > 0.0)
        };
        let direction = if outer == Policy::Direction { around.direction } else { cut(self.direction) };
        Self { lane: cut(self.lane), direction, carriageway: around.carriageway }
    }

    /// The section whose strip for `policy` is nowhere narrower than this width, metres. The source of the width stays. A strip that the
    /// map does not have stays unknown.
    #[must_use]
    pub fn at_least(&self, policy: Policy, width_m: f64) -> Self {
        match self.strip(policy) {
            Some(strip) if f64::from(strip.width_m()) < width_m => self.with_width(policy, width_m, strip.source),
            _ => *self,
        }
    }

    /// Puts a strip into the section. Narrower policies stay within it, wider ones contain it.
    fn with_strip(&self, policy: Policy, strip: Strip) -> Self {
        let within = |part: Strip| Strip {
            left_m: part.left_m.min(strip.left_m),
            right_m: part.right_m.max(strip.right_m),
            ..part
        };
        let around = |part: Strip| Strip {
            left_m: part.left_m.max(strip.left_m),
            right_m: part.right_m.min(strip.right_m),
            ..part
        };
        let usable = |part: &Strip| part.width_m() > 0.0;
        match policy {
            Policy::Lane => Self {
                lane: Some(strip),
                direction: self.direction.map(around),
                carriageway: self.carriageway.map(around),
            },
            Policy::Direction => Self {
                lane: self.lane.map(within).filter(usable),
                direction: Some(strip),
                carriageway: self.carriageway.map(around),
            },
            Policy::Carriageway => Self { carriageway: Some(strip), ..*self },
        }
    }
}

/// A strip around a middle.
fn about(middle_m: f64, width_m: f64, source: WidthSource) -> Strip {
    no_wider(
        Strip { left_m: (middle_m + 0.5 * width_m) as f32, right_m: (middle_m - 0.5 * width_m) as f32, source },
        width_m,
    )
}

/// A part of the carriageway `whole`, with the same share of a carriageway of this width.
fn scaled(part: Strip, whole: Strip, width_m: f64) -> Strip {
    let (left_m, right_m) = (f64::from(whole.left_m), f64::from(whole.right_m));
    let (middle_m, share) = (f64::midpoint(left_m, right_m), width_m / (left_m - right_m));
    let at = |edge_m: f32| middle_m + (f64::from(edge_m) - middle_m) * share;
    let (left_m, right_m) = (at(part.left_m), at(part.right_m));
    no_wider(Strip { left_m: left_m as f32, right_m: right_m as f32, source: part.source }, left_m - right_m)
}

/// Single precision may round a width up. A strip is no wider than what was measured.
///
/// The edge farther from 0 moves inwards. A step takes at least half of that edge's spacing, and rounding both edges added at most one
/// spacing: three steps suffice. Near 0 the numbers lie so close together that steps of the other edge would never end.
fn no_wider(mut strip: Strip, width_m: f64) -> Strip {
    for _ in 0..MOST_STEPS {
        if f64::from(strip.left_m) - f64::from(strip.right_m) <= width_m {
            break;
        }
        if strip.left_m.abs() >= strip.right_m.abs() {
            strip.left_m = strip.left_m.next_down();
        } else {
            strip.right_m = strip.right_m.next_up();
        }
    }
    strip
}

/// Steps of [`no_wider`]: three suffice, one more is for the rounding of the width itself.
const MOST_STEPS: u32 = 4;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn strip(left_m: f32, right_m: f32) -> Strip {
        Strip { left_m, right_m, source: WidthSource::Assumed }
    }

    /// Two lanes of 3 m, traffic on the right, travel along the line.
    fn road() -> CrossSection {
        CrossSection {
            lane: Some(strip(0.0, -3.0)),
            direction: Some(strip(0.0, -3.0)),
            carriageway: Some(strip(3.0, -3.0)),
        }
    }

    #[test]
    fn lanes_keep_their_shares_of_a_measured_carriageway() {
        let wide = road().with_width(Policy::Carriageway, 7.0, WidthSource::Surveyed);
        assert_eq!(wide.carriageway.unwrap(), Strip { left_m: 3.5, right_m: -3.5, source: WidthSource::Surveyed });
        assert_eq!(wide.lane.unwrap(), Strip { left_m: 0.0, right_m: -3.5, source: WidthSource::Estimated });
    }

    #[test]
    fn a_measured_lane_grows_on_both_sides_and_the_carriageway_contains_it() {
        let wide = road().with_width(Policy::Lane, 3.5, WidthSource::Surveyed);
        assert_eq!(wide.lane.unwrap(), Strip { left_m: 0.25, right_m: -3.25, source: WidthSource::Surveyed });
        assert_eq!(wide.carriageway.unwrap(), strip(3.0, -3.25));
        let narrow = road().with_width(Policy::Direction, 2.0, WidthSource::Surveyed);
        assert_eq!(narrow.lane.unwrap(), strip(-0.5, -2.5));
        assert_eq!(narrow.carriageway.unwrap(), strip(3.0, -3.0));
    }

    #[test]
    fn a_measured_lane_does_not_widen_a_measured_carriageway() {
        let made = road().with_widths([Some(3.5), None, Some(6.4)], WidthSource::Surveyed);
        assert!((made.carriageway.unwrap().width_m() - 6.4).abs() < 1e-6);
        let (lane, carriageway) = (made.lane.unwrap(), made.carriageway.unwrap());
        assert!(lane.right_m >= carriageway.right_m && lane.width_m() <= 3.5 && lane.width_m() > 3.3);
        let alone = road().with_widths([Some(3.5), None, None], WidthSource::Surveyed);
        assert_eq!(alone, road().with_width(Policy::Lane, 3.5, WidthSource::Surveyed));
        assert_eq!(road().with_widths([None; 3], WidthSource::Surveyed), road());
    }

    #[test]
    fn nothing_is_narrowed_by_a_least_width_and_nothing_invented() {
        assert_eq!(road().at_least(Policy::Lane, 2.5), road());
        let none = CrossSection { lane: None, direction: None, carriageway: None };
        assert_eq!(none.at_least(Policy::Lane, 2.5), none);
        assert!((none.with_width(Policy::Lane, 2.5, WidthSource::Surveyed).lane.unwrap().width_m() - 2.5).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn no_strip_is_wider_than_what_was_measured(width_m in 1.0..30.0_f64, left in -2.0..4.0_f32, own in 0.5..9.0_f32) {
            let around = CrossSection { carriageway: Some(strip(left, left - own)), ..road() };
            for &policy in <Policy as crate::words::Named>::ALL {
                let made = around.with_width(policy, width_m, WidthSource::Surveyed).strip(policy).unwrap();
                let made_m = f64::from(made.left_m) - f64::from(made.right_m);
                prop_assert!(made_m <= width_m && made_m > width_m - 1e-5);
            }
        }

        #[test]
        fn strips_that_begin_at_or_near_0_take_few_steps(centimetres in 1..3000_u32, scale in -45..9_i32, minus: bool, left: bool, off in 0..400_u32) {
            let near = 10.0_f64.powi(scale) * if minus { -1.0 } else { 1.0 };
            let width_m = f64::from(centimetres) / 100.0;
            for at_m in [0.0, near, f64::from(off) / 100.0, -1e-40, 1e-8] {
                let middle_m = if left { at_m - 0.5 * width_m } else { at_m + 0.5 * width_m };
                let rounded = |middle_m: f64| Strip {
                    left_m: (middle_m + 0.5 * width_m) as f32,
                    right_m: (middle_m - 0.5 * width_m) as f32,
                    source: WidthSource::Surveyed,
                };
                let made = about(middle_m, width_m, WidthSource::Surveyed);
                let made_m = f64::from(made.left_m) - f64::from(made.right_m);
                prop_assert!(made_m <= width_m, "{made:?} is wider than {width_m}");
                // What was taken away, in steps of the greater edge.
                let spacing = |x: f32| f64::from(x.abs()) - f64::from(x.abs().next_down());
                let before = rounded(middle_m);
                let greatest = before.left_m.abs().max(before.right_m.abs());
                let taken = f64::from(before.left_m) - f64::from(before.right_m) - made_m;
                prop_assert!(taken <= f64::from(MOST_STEPS) * 2.0 * spacing(greatest), "{taken} of {before:?}");
            }
        }

        #[test]
        fn own_lanes_of_a_two_lane_road_take_any_width(own in 100..400_u32, centimetres in 1..3000_u32) {
            let own_m = own as f32 / 100.0;
            let around = CrossSection {
                lane: Some(strip(0.0, -own_m)),
                direction: Some(strip(0.0, -own_m)),
                carriageway: Some(strip(own_m, -own_m)),
            };
            let width_m = f64::from(centimetres) / 100.0;
            for &policy in <Policy as crate::words::Named>::ALL {
                let made = around.with_width(policy, width_m, WidthSource::Surveyed).strip(policy).unwrap();
                let made_m = f64::from(made.left_m) - f64::from(made.right_m);
                prop_assert!(made_m <= width_m && made_m > width_m - 1e-5);
            }
        }
    }
}
