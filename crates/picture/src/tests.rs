//! Tests of the basic parts: numbers, escaping, true scale, round ticks.

#![allow(clippy::unwrap_used)]

use super::palette::{self, Colour};
use super::*;

#[test]
fn numbers_have_two_decimals_and_no_negative_zero() {
    let cases = [(0.0, "0.00"), (-0.001, "0.00"), (-0.005, "-0.01"), (1.005, "1.00"), (12.3, "12.30")];
    for (value, text) in cases {
        assert_eq!(number(value), text);
    }
    assert_eq!(number(f64::NAN), "0.00");
    assert_eq!(number(f64::NEG_INFINITY), "0.00");
}

#[test]
fn text_cannot_break_the_document() {
    assert_eq!(escaped("A&B <\"x'>\u{1}\n"), "A&amp;B &lt;&quot;x&#39;&gt;\u{fffd} ");
    let mut picture = Picture::new(10.0, 10.0, "</title><script>", "&");
    picture.text([1.0, 1.0], "<b>", TextStyle::size(3.0));
    let svg = picture.finish();
    assert!(!svg.contains("<script>") && !svg.contains("<b>"));
}

#[test]
fn a_metre_is_as_long_up_as_across_and_north_is_up() {
    let bounds = BoundingBox::of(&[[0.0, 0.0], [100.0, 10.0]]);
    let view = View::fit(&bounds, PageFrame { x: 10.0, y: 10.0, width: 200.0, height: 200.0 });
    assert_eq!(view.scale, 2.0);
    assert_eq!(view.at([50.0, 5.0]), [110.0, 110.0]);
    assert_eq!(view.at([51.0, 6.0]), [112.0, 108.0]);
    let turned = View::turned(
        &[[0.0, 0.0], [0.0, 100.0]],
        -std::f64::consts::FRAC_PI_2,
        PageFrame { x: 0.0, y: 0.0, width: 200.0, height: 20.0 },
    );
    let (a, b) = (turned.at([0.0, 0.0]), turned.at([0.0, 100.0]));
    assert!((b[0] - a[0] - 200.0).abs() < 1e-9 && (b[1] - a[1]).abs() < 1e-9, "north to the right: {a:?} {b:?}");
}

#[test]
fn places_that_are_no_numbers_are_left_out() {
    let mut picture = Picture::new(10.0, 10.0, "", "");
    picture.polyline(&[[0.0, 0.0], [f64::NAN, 1.0], [2.0, 2.0]], Style::line(palette::INK, 1.0));
    picture.polyline(&[[0.0, 0.0], [f64::INFINITY, 1.0]], Style::line(palette::INK, 1.0));
    let svg = picture.finish();
    assert!(svg.contains(r#"points="0.00,0.00 2.00,2.00""#));
    assert_eq!(svg.matches("<polyline").count(), 1);
}

#[test]
fn scales_end_in_their_last_colours_and_text_reads_on_paper() {
    assert_eq!(palette::diverging(-7.0), Colour(0xd7, 0x30, 0x27));
    assert_eq!(palette::diverging(0.0), Colour(0xff, 0xff, 0xbf));
    assert_eq!(palette::sequential(2.0), Colour(0xfd, 0xe7, 0x25));
    assert_eq!(palette::sequential(f64::NAN), Colour(0x44, 0x01, 0x54));
    let contrast = |c| (palette::luminance(palette::PAPER) + 0.05) / (palette::luminance(c) + 0.05);
    assert!(contrast(palette::INK) > 15.0 && contrast(palette::GREY) > 5.5);
    let steps: Vec<f64> = (0..=8).map(|i| palette::luminance(palette::sequential(f64::from(i) / 8.0))).collect();
    assert!(steps.windows(2).all(|w| w[1] > w[0]), "viridis grows lighter all along");
}

#[test]
fn a_chart_has_round_ticks_and_values_where_they_belong() {
    let frame = PageFrame { x: 60.0, y: 0.0, width: 100.0, height: 50.0 };
    let chart = Chart { frame, x: Scale::new(0.0, 10.0, "s, m"), y: Scale::new(-1.0, 1.0, "leeway, m") };
    assert_eq!(chart.at(5.0, 0.0), [110.0, 25.0]);
    let mut picture = Picture::new(200.0, 100.0, "", "");
    chart.axes(&mut picture);
    let svg = picture.finish();
    for tick in [">2<", ">10<", ">\u{2212}0.5<", ">0.0<"] {
        assert!(svg.contains(tick), "{tick} in {svg}");
    }
}

#[test]
fn a_scale_bar_is_as_long_as_it_says() {
    let view = View::fit(
        &BoundingBox::of(&[[0.0, 0.0], [70.0, 1.0]]),
        PageFrame { x: 0.0, y: 0.0, width: 700.0, height: 99.0 },
    );
    let mut picture = Picture::new(700.0, 99.0, "", "");
    scale_bar(&mut picture, &view, [10.0, 90.0], 260.0);
    let svg = picture.finish();
    assert!(svg.contains(">20 m<") && svg.contains(r#"width="200.00""#), "{svg}");
}
