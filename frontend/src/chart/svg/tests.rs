use super::*;
use crate::chart::Stroke;
use crate::chart::sample::{bars, line, torque};

const SIZE: Size = Size {
    width: 800.0,
    height: 300.0,
};

/// Every value of an attribute of the elements that hold `mark`.
fn all<'a>(svg: &'a str, mark: &str, name: &str) -> Vec<&'a str> {
    let elements = svg.split('<').filter(|e| e.contains(mark));
    let start = format!(" {name}=\"");
    elements
        .filter_map(|e| e.split_once(&start)?.1.split_once('"').map(|v| v.0))
        .collect()
}

fn numbers(text: &str) -> Vec<f64> {
    let words = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    words.filter_map(|w| w.parse().ok()).collect()
}

/// What a pixel means, worked out from two ticks of an axis and the places they stand at.
fn meaning(svg: &str, axis: &str) -> impl Fn(f64) -> f64 {
    let place = if axis == "x" { "x" } else { "y" };
    let mark = format!("data-tick=\"{axis}\"");
    let at: Vec<f64> = all(svg, &mark, place)
        .iter()
        .map(|t| t.parse().unwrap())
        .collect();
    let texts: Vec<f64> = svg
        .split('<')
        .filter(|e| e.contains(&mark))
        .map(|e| {
            let text = e.split_once('>').unwrap().1;
            text.replace('\u{2009}', "")
                .replace('\u{2212}', "-")
                .parse()
                .unwrap()
        })
        .collect();
    // The text stands four pixels below its line.
    let shift = if axis == "x" { 0.0 } else { 4.0 };
    let (a, b) = (at[0] - shift, at[at.len() - 1] - shift);
    let (low, high) = (texts[0], texts[texts.len() - 1]);
    move |pixel| low + (pixel - a) / (b - a) * (high - low)
}

#[test]
fn lines_stand_where_the_ticks_say() {
    let svg = draw(&torque(), SIZE, View::default(), Look::Page);
    let (x, y) = (meaning(&svg, "x"), meaning(&svg, "y"));
    let d = all(&svg, "data-series=\"recent\"", "d")[0];
    let at = numbers(d);
    assert_eq!(at.len(), 6, "{d}");
    for (pair, (wanted_x, wanted_y)) in at.chunks(2).zip([(0.0, 0.0), (50.0, 40.0), (100.0, 20.0)])
    {
        assert!((x(pair[0]) - wanted_x).abs() < 0.1, "{d}");
        assert!((y(pair[1]) - wanted_y).abs() < 0.1, "{d}");
    }
    assert!(svg.contains("class=\"series dashed\"") && svg.contains(">reference<"));
}

#[test]
fn bars_are_as_wide_and_high_as_their_bins() {
    let svg = draw(&bars(), SIZE, View::default(), Look::Page);
    let (x, y) = (meaning(&svg, "x"), meaning(&svg, "y"));
    let get = |name| -> Vec<f64> {
        let found = all(&svg, "data-series=\"time\"", name);
        found.iter().map(|t| t.parse().unwrap()).collect()
    };
    let (left, width, top, height) = (get("x"), get("width"), get("y"), get("height"));
    assert_eq!(left.len(), 3);
    for (at, (middle, value)) in [(1.0, 100.0), (3.0, 50.0), (7.0, 25.0)]
        .into_iter()
        .enumerate()
    {
        let centre = x(left[at] + width[at] / 2.0);
        assert!((centre - middle).abs() < 0.05, "{centre}");
        assert!((y(top[at]) - value).abs() < 0.5);
        assert!(y(top[at] + height[at]).abs() < 0.5, "stands on zero");
    }
    assert!(width[2] > 2.0 * width[0], "three times the bin");
}

#[test]
fn gaps_stay_gaps_and_lonely_points_are_seen() {
    let mut chart = torque();
    chart.series.truncate(1);
    let series = &mut chart.series[0];
    series.points.insert(
        1,
        Point {
            from: 50.0,
            to: 50.0,
            y: None,
            text: String::new(),
            note: String::new(),
        },
    );
    let svg = draw(&chart, SIZE, View::default(), Look::Page);
    let d = all(&svg, "data-series=\"reference\"", "d")[0];
    assert_eq!(d.matches('M').count(), 2, "{d}");
    assert_eq!(svg.matches("<circle").count(), 2);
}

#[test]
fn steps_and_their_band_are_level() {
    let mut chart = bars();
    chart.series[0].shape = Shape::Step;
    let mut high = chart.series[0].clone();
    for point in &mut high.points {
        point.y = point.y.map(|y| y * 2.0);
    }
    chart.series.push(high);
    chart.bands = vec![(0, 1)];
    let svg = draw(&chart, SIZE, View::default(), Look::Page);
    let d = all(&svg, "data-series=\"time\"", "d")[0];
    assert_eq!(
        (d.matches('M').count(), d.matches('H').count()),
        (1, 3),
        "{d}"
    );
    let band = all(&svg, "class=\"band\"", "d")[0];
    assert_eq!(band.matches('z').count(), 3, "{band}");
}

#[test]
fn a_part_fills_the_plot_and_fits_its_height() {
    let view = View {
        range: Some((2.0, 10.0)),
        ..View::default()
    };
    let frame = Frame::of(&bars(), SIZE, view);
    assert_eq!(frame.x, (2.0, 10.0));
    assert_eq!(frame.at(frame.left), 2.0);
    assert_eq!(frame.at(frame.left + frame.width), 10.0);
    assert_eq!(frame.at(-50.0), 2.0);
    // The bar of 100 ends where the part begins, so it still counts.
    assert_eq!(frame.y, (0.0, 100.0));
}

#[test]
fn a_file_carries_its_own_style() {
    let view = View {
        cursor: Some(0),
        ..View::default()
    };
    let page = draw(&torque(), SIZE, view, Look::Page);
    assert!(page.contains("class=\"cursor\"") && !page.contains("xmlns"));
    let paper = draw(&torque(), SIZE, view, Look::Paper);
    assert!(paper.starts_with("<svg ") && paper.contains("xmlns=\"http://www.w3.org/2000/svg\""));
    assert!(!paper.contains("class=") && !paper.contains("data-testid"));
    assert!(paper.contains("stroke-dasharray=\"6 4\""));
}

#[test]
fn nothing_to_draw_is_no_accident() {
    let mut chart = torque();
    chart.series.clear();
    assert!(draw(&chart, SIZE, View::default(), Look::Page).ends_with("</svg>"));
    let mut one = torque();
    one.series.truncate(1);
    one.series[0].points.truncate(1);
    let svg = draw(
        &one,
        Size {
            width: 10.0,
            height: 10.0,
        },
        View::default(),
        Look::Page,
    );
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn pixels_are_short() {
    assert_eq!(n(12.0), "12");
    assert_eq!(n(-0.04), "0");
    assert_eq!(n(-3.25), "-3.3");
    assert_eq!(exact(1_795_132_800.25), "1795132800.25");
    assert_eq!((exact(-0.5), exact(100.0)), ("-0.5".into(), "100".into()));
}

/// A limit of the x axis is a line over the whole height, and no value anywhere.
#[test]
fn rules_stand_upright() {
    let mut chart = torque();
    let mut rule = line("limit", Stroke::Dotted, &[(25.0, 0.0)]);
    rule.shape = Shape::Rule;
    rule.points[0].y = None;
    chart.series.push(rule);
    let svg = draw(&chart, SIZE, View::default(), Look::Page);
    let frame = Frame::of(&chart, SIZE, View::default());
    let d = all(&svg, "data-series=\"limit\"", "d")[0];
    let wanted = format!(
        "M{} {}V{}",
        n(frame.px(25.0)),
        n(frame.top),
        n(frame.top + frame.height)
    );
    assert_eq!(d, wanted);
    assert!(svg.contains("data-name=\"limit\""));
    assert_eq!(frame.y, Frame::of(&torque(), SIZE, View::default()).y);
    assert_eq!(crate::chart::cursor::stops(&chart).len(), 3);
    assert_eq!(crate::chart::table::head(&chart).len(), 3);
}

/// However many names stand above it, the plot can be read.
#[test]
fn names_take_no_room_from_the_plot() {
    let mut chart = torque();
    let one = chart.series[0].clone();
    chart.series = (0..27)
        .map(|n| Series {
            key: format!("s{n}"),
            label: format!("Open, {n} back"),
            ..one.clone()
        })
        .collect();
    for width in [330.0, 1000.0] {
        let size = Size::of(&chart, width);
        let frame = Frame::of(&chart, size, View::default());
        assert!(frame.height >= 180.0, "{width}: {frame:?}");
    }
    let few = Size::of(&torque(), 330.0);
    assert_eq!(few.height, 260.0);
}
