use super::*;
use crate::chart::{Kind, Shape as Joined};
use crate::dop::registers::Registers;
use shared::dop::{Profile, Request};

/// 2021-02-12 15:29:15 UTC.
const THEN: i64 = 0x6026_9ECB;

fn read(request: u16, registers: &Registers) -> ObjectRead {
    ObjectRead::read(
        Request::from_word(request),
        &registers.0,
        &Profile::default(),
    )
}

fn only(request: u16, registers: &Registers) -> Chart {
    let mut charts = charts(&read(request, registers));
    assert_eq!(charts.len(), 1);
    charts.remove(0)
}

fn values(chart: &Chart, key: &str) -> Vec<f64> {
    let series = chart.series.iter().find(|s| s.key == key).expect(key);
    series.points.iter().map(|p| p.y.unwrap()).collect()
}

/// Object 604, 10 years: three valid points, the newest first.
fn temperatures() -> Registers {
    let points = |newest_first: [i32; 3]| {
        let mut all = [0; 10];
        all[..3].copy_from_slice(&newest_first);
        all
    };
    Registers::default()
        .u16([3])
        .i32(points([300, 250, -40]))
        .i32(points([100, 50, -200]))
        .i32(points([200, 150, -105]))
        .i64([THEN, THEN + 3 * 31_536_000])
}

#[test]
fn a_trend_runs_from_start_to_end() {
    let chart = only(0x325C, &temperatures());
    assert_eq!(chart.key, "dop-325c");
    assert_eq!(chart.x.kind, Kind::Time);
    assert_eq!(
        (chart.y.unit.as_str(), chart.bands.as_slice()),
        ("°C", &[(0, 1)][..])
    );
    // Tenths of a degree, the oldest at the left.
    assert_eq!(values(&chart, "average"), [-10.5, 15.0, 20.0]);
    assert_eq!(values(&chart, "max"), [-4.0, 25.0, 30.0]);
    assert_eq!(values(&chart, "min"), [-20.0, 5.0, 10.0]);
    let points = &chart.series[2].points;
    assert_eq!(points[0].text, "-10.5");
    assert_eq!(points[0].from, THEN as f64);
    assert_eq!(points[0].to, points[1].from);
    assert_eq!(points[2].to, (THEN + 3 * 31_536_000) as f64);
    assert!(
        chart
            .notes
            .iter()
            .any(|n| n == "3 of at most 10 points are valid.")
    );
}

#[test]
fn a_trend_without_dates_counts_back() {
    let mut registers = temperatures();
    let end = registers.0.len() - 8;
    registers.0[end..].fill(0);
    let chart = only(0x325C, &registers);
    assert_eq!(
        (chart.x.kind, chart.x.unit.as_str()),
        (Kind::Number, "years")
    );
    let points = &chart.series[2].points;
    assert_eq!((points[0].from, points[2].to), (-3.0, 0.0));
    assert!(chart.notes[0].contains("no span of time"));
}

#[test]
fn bins_have_two_widths_and_their_times() {
    let registers = Registers::default()
        .u16([15])
        .i32([
            900, 800, 700, 600, 500, 400, 300, 200, 100, 50, 5, 4, 3, 2, 1,
        ])
        .i64((0..15).map(|at| if at == 14 { 0 } else { THEN + at }));
    let chart = only(2, &registers);
    let points = &chart.series[0].points;
    assert_eq!((chart.series.len(), points.len()), (1, 15));
    assert_eq!(chart.series[0].shape, Joined::Bar);
    assert_eq!((chart.x.unit.as_str(), chart.y.unit.as_str()), ("G", "s"));
    let bounds = |at: usize| {
        (
            (points[at].from * 10.0).round(),
            (points[at].to * 10.0).round(),
        )
    };
    assert_eq!((bounds(0), bounds(9)), ((0.0, 4.0), (36.0, 40.0)));
    assert_eq!((bounds(10), bounds(14)), ((40.0, 72.0), (168.0, 200.0)));
    assert_eq!((points[0].y, points[14].y), (Some(900.0), Some(1.0)));
    assert_eq!(points[1].note, "2021-02-12 15:29:16 UTC");
    assert_eq!(points[14].note, "never");
    assert_eq!(chart.notes.len(), 1);
}

#[test]
fn open_and_close_stand_beside_each_other() {
    let registers = Registers::default()
        .i32((0..10).map(|at| at * 10))
        .i32((0..10).map(|at| at * 20))
        .i64([THEN; 10])
        .i64([0; 10]);
    let chart = only(201, &registers);
    let keys: Vec<_> = chart.series.iter().map(|s| s.key.as_str()).collect();
    assert_eq!(keys, ["open", "close"]);
    assert_eq!(values(&chart, "close")[9], 180.0);
    let last = &chart.series[1].points[9];
    assert_eq!(
        (last.from, last.to, last.note.as_str()),
        (90.0, 100.0, "never")
    );
    assert_eq!(chart.x.unit, "% open");
}

#[test]
fn vibration_over_position_is_a_band_of_steps() {
    let registers = Registers::default()
        .i32([500; 10])
        .i32([-100; 10])
        .i32([40; 10])
        .i64([THEN; 10]);
    let chart = only(3, &registers);
    assert_eq!(chart.bands, [(0, 1)]);
    assert_eq!(values(&chart, "min"), [-100.0; 10]);
    assert!(chart.series.iter().all(|s| s.shape == Joined::Step));
    let max = &chart.series[1];
    assert_eq!(max.points[0].note, "2021-02-12 15:29:15 UTC");
    assert!(chart.series[2].points[0].note.is_empty());
}

/// A stroke of 410 registers: every value is that of `torque` for its percent.
fn stroke(torque: fn(u16) -> u16) -> Registers {
    Registers::default()
        .u16((0..100).map(|at| torque(at) + 50))
        .u16((0..100).map(|at| torque(at) - 50))
        .u16((0..100).map(torque))
        .u16((0..100).map(|at| torque(at) + 10))
        .i64([THEN, THEN + 30])
        .u16([0, 1000])
}

#[test]
fn a_stroke_has_a_point_for_each_percent() {
    let chart = only(0x0191, &stroke(|at| 200 + at));
    let average = values(&chart, "average");
    assert_eq!((average.len(), average[0], average[99]), (100, 20.0, 29.9));
    assert_eq!(values(&chart, "max")[99], 34.9);
    assert_eq!(values(&chart, "long-term")[0], 21.0);
    assert_eq!(chart.series.last().unwrap().stroke, Stroke::Solid);
    let long = chart.series.iter().find(|s| s.key == "long-term").unwrap();
    assert_eq!(long.stroke, Stroke::Dotted);
}

#[test]
fn strokes_lie_over_each_other_with_the_reference_dashed() {
    let recent = read(0x0191, &stroke(|at| 200 + at));
    let reference = read(0x1191, &stroke(|_| 150));
    let close = read(0x2191, &stroke(|_| 300));
    let chart = overlay(&[&recent, &reference, &close], "avg").unwrap();
    let told: Vec<_> = chart
        .series
        .iter()
        .map(|s| (s.key.as_str(), s.stroke))
        .collect();
    assert_eq!(
        told,
        [
            ("option-1", Stroke::Dashed),
            ("option-2", Stroke::Thin),
            ("option-0", Stroke::Solid)
        ]
    );
    assert_eq!(values(&chart, "option-1"), [15.0; 100]);
    assert!(overlay(&[&recent], "avg").is_none());
    assert!(overlay(&[&recent, &reference], "nothing").is_none());
}

#[test]
fn axes_have_levels_and_a_spectrum() {
    let minus = |value: i16| value.cast_unsigned();
    let registers = Registers::default()
        .u16([100, 200, 300])
        .i32([374])
        .u16([minus(-5), 6, 7])
        .u16([501, 602, 703])
        .u16([900, 800, minus(-700)]);
    let charts = charts(&read(5, &registers));
    assert_eq!(charts.len(), 2);
    let keys: Vec<_> = charts[0].series.iter().map(|s| s.key.as_str()).collect();
    assert_eq!(keys, ["rms", "avg", "peak"]);
    assert_eq!(values(&charts[0], "avg"), [-5.0, 6.0, 7.0]);
    assert_eq!(values(&charts[0], "peak")[2], -700.0);
    assert_eq!(charts[1].y.unit, "Hz");
    assert_eq!(values(&charts[1], "frequency"), [50.1, 60.2, 70.3]);
    assert_eq!(
        charts[1].x.kind,
        Kind::Names(vec!["X".into(), "Y".into(), "Z".into()])
    );
}

#[test]
fn an_earlier_read_is_dashed_below() {
    let now = read(0x0191, &stroke(|_| 200));
    let then = read(0x0191, &stroke(|_| 100));
    let chart = compared(&now, &then).remove(0);
    let told: Vec<_> = chart
        .series
        .iter()
        .map(|s| (s.label.as_str(), s.stroke))
        .collect();
    assert_eq!(
        told,
        [
            ("Average, earlier", Stroke::Dashed),
            ("Average", Stroke::Solid)
        ]
    );
    assert_eq!(values(&chart, "earlier-average"), [10.0; 100]);
    assert!(chart.bands.is_empty() && chart.key.ends_with("-compared"));
}

#[test]
fn the_number_of_registers_decides_about_the_picture() {
    // 602 asked, 601 answered: the 69 registers of a trend of ten years (reading B1a).
    assert_eq!(temperatures().0.len(), 69);
    let chart = only(602, &temperatures());
    assert_eq!(values(&chart, "average"), [-10.5, 15.0, 20.0]);
    // 601 asked, statistics answered: no picture.
    let statistics = Registers(vec![0; 23]);
    assert!(charts(&read(0x0259, &statistics)).is_empty());
    assert!(charts(&read(0x0259, &Registers(vec![3]))).is_empty());
}
