//! Torque: objects 401 to 405.

use super::objects::{ago, stroke};
use super::put::Put;
use super::unit::{Stroke, Unit, Way};

/// The stroke that an option of object 401 means.
pub(super) fn chosen(unit: &Unit, option: u8) -> &Stroke {
    let way = if option < 2 { Way::Open } else { Way::Close };
    stroke(unit, way, option & 1 == 1)
}

pub(super) fn curve(unit: &Unit, out: &mut Put, option: u8) {
    let run = chosen(unit, option);
    let usual = Stroke {
        number: 0,
        ..run.clone()
    };
    for off in [17, -14, 0] {
        let samples = (0..100).map(|p| run.torque(unit.seed, p).saturating_add(off));
        out.array(100, samples, Put::u16);
    }
    out.array(100, (0..100).map(|p| usual.torque(unit.seed, p)), Put::u16);
    out.time(run.start);
    out.time(run.end);
    let (from, to) = if run.way == Way::Open {
        (0, 1000)
    } else {
        (1000, 0)
    };
    out.u16(from);
    out.u16(to);
}

/// The most in a part of a stroke, and where, in tenths of a percent.
pub(super) fn peak(unit: &Unit, run: &Stroke, from: i64, to: i64) -> (i64, i64) {
    let points = (from..to).map(|p| (run.torque(unit.seed, p).saturating_add(17), p));
    let (most, at) = points.max_by_key(|(torque, _)| *torque).unwrap_or_default();
    (most, at.saturating_mul(10))
}

pub(super) fn profile(unit: &Unit, out: &mut Put) {
    for way in [Way::Open, Way::Close] {
        for reference in [false, true] {
            let run = stroke(unit, way, reference);
            let (start, stop) = if way == Way::Open {
                (0, 1000)
            } else {
                (1000, 0)
            };
            out.time(run.start);
            out.u16(start);
            out.s16(unit.motor_temperature(run.start));
            out.time(run.end);
            out.u16(stop);
            out.s16(unit.motor_temperature(run.end).saturating_add(22));
            out.u32(1_250);
            let all = (0..100).map(|p| run.torque(unit.seed, p));
            let sum = all.fold(0_i64, i64::saturating_add);
            out.u16(sum.checked_div(100).unwrap_or(0));
            let last = if way == Way::Open { 99 } else { 0 };
            out.u16(run.torque(unit.seed, last));
            let (low, high) = (peak(unit, run, 0, 10), peak(unit, run, 90, 100));
            let (breakout, ending) = if way == Way::Open {
                (low, high)
            } else {
                (high, low)
            };
            for (torque, at) in [breakout, peak(unit, run, 10, 90), ending] {
                out.u16(torque);
                out.u16(at);
            }
        }
    }
}

pub(super) fn torque_indicators(unit: &Unit, out: &mut Put, object: u16) {
    if object == 403 {
        for (back, count, at, value, points) in [
            (86_400, 4, 580, 46, 9),
            (172_800, 2, 600, 38, 5),
            (0, 0, 0, 0, 0),
            (3_000_000, 1, 590, -12, 1),
        ] {
            out.time(if count == 0 { 0 } else { ago(unit, back) });
            out.u32(count);
            out.u16(at);
            out.s16(value);
            out.u16(points);
        }
        return;
    }
    for (back, count) in [(86_400, 12), (2_600_000, 1), (90_000, 3), (0, 0)] {
        out.time(if count == 0 { 0 } else { ago(unit, back) });
        out.u32(count);
    }
}

pub(super) fn torque_most(unit: &Unit, out: &mut Put) {
    out.time(ago(unit, 2_600_000));
    out.u16(812);
    out.time(ago(unit, 5_200_000));
    out.u16(934);
}
