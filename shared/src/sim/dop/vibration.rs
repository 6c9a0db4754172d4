//! Vibration: objects 2 to 7.

use super::objects::{ago, stroke};
use super::put::Put;
use super::unit::{Unit, Way, noise};

pub(super) fn elapsed(unit: &Unit, out: &mut Put) {
    let bins = [2_210, 840, 311, 120, 54, 31, 12, 7, 3, 2, 1, 0, 0, 0, 0_i64];
    out.u16(15);
    // What the motor ran beyond its past belongs to the two lowest bins.
    let more = unit.age_ms.checked_div(5_000).unwrap_or(0);
    let times = bins.iter().enumerate().map(|(at, base)| match at {
        0 => base.saturating_add(more),
        1 => base.saturating_add(more.checked_div(3).unwrap_or(0)),
        _ => *base,
    });
    out.array(15, times, Put::s32);
    let when = (0_i64..).zip(bins).map(|(at, base)| match (at, base) {
        (_, 0) => 0,
        (0 | 1, _) => unit.wall,
        _ => ago(unit, at.saturating_mul(40_000)),
    });
    out.array(15, when, Put::time);
}

pub(super) fn by_position(unit: &Unit, out: &mut Put, way: Way, option: u8) {
    let run = stroke(unit, way, option == 2);
    // The summary of all runs is a little more and a little less than the last.
    let wider = if option == 1 { 35 } else { 0 };
    let cells: Vec<[i64; 3]> = (0..10).map(|bin| run.vibration(unit.seed, bin)).collect();
    let column = |at: usize| cells.iter().map(move |c| c.get(at).copied().unwrap_or(0));
    out.array(10, column(0).map(|v| v.saturating_add(wider)), Put::s32);
    out.array(10, column(1).map(|v| v.saturating_sub(wider)), Put::s32);
    out.array(10, column(2), Put::s32);
    out.array(10, (0..10).map(|bin| run.time_in(bin)), Put::time);
}

/// Length of a vector.
pub(super) fn vector(axes: [i64; 3]) -> i64 {
    let square = |v: i64| v.saturating_mul(v);
    let sum = axes
        .iter()
        .fold(0_i64, |sum, v| sum.saturating_add(square(*v)));
    sum.isqrt()
}

pub(super) fn axes(unit: &Unit) -> [i64; 3] {
    let tick = unit.age_ms.checked_div(1000).unwrap_or(0);
    let running = if unit.moving.is_some() { 180 } else { 0 };
    [11_i64, 7, 14].map(|base| {
        noise(unit.seed, tick.saturating_mul(base), 20)
            .saturating_add(base)
            .saturating_add(running)
    })
}

pub(super) fn present(unit: &Unit, out: &mut Put) {
    let rms = axes(unit);
    rms.iter().for_each(|v| out.s16(*v));
    out.s32(vector(rms));
    for (value, sign) in rms.iter().zip([1, -1, 1]) {
        out.s16(value.checked_div(3).unwrap_or(0).saturating_mul(sign));
    }
    let hertz = if unit.moving.is_some() {
        [296, 592, 1_184]
    } else {
        [0; 3]
    };
    hertz.iter().for_each(|v| out.u16(*v));
    for (value, sign) in rms.iter().zip([2, -2, 3]) {
        out.s16(value.saturating_mul(sign));
    }
}

pub(super) fn historical(unit: &Unit, out: &mut Put) {
    for (back, rms, lta) in [
        (8_640_000, [2_140, 1_310, 2_905], 96),
        (432_000, [612, 488, 803], 91),
    ] {
        out.time(ago(unit, back));
        rms.iter().for_each(|v| out.s16(*v));
        out.s32(vector(rms));
        [297, 594, 1_188].iter().for_each(|v| out.u16(*v));
        out.s32(lta);
    }
}

pub(super) fn exceeded(unit: &Unit, out: &mut Put, option: u8) {
    let (back, count, most, level) = match option {
        0 => (8_640_000, 1, 3_842, 3_000),
        1 => (432_000, 6, 1_121, 900),
        _ => {
            // The deviation indicator never tripped.
            out.time(0);
            out.time(0);
            out.0.resize(29, 0);
            return;
        }
    };
    out.time(ago(unit, back));
    out.time(ago(unit, i64::saturating_sub(back, 9)));
    out.u32(count);
    out.s32(most);
    out.u32(level);
    out.u16(624);
    out.s16(271);
    out.s16(-5_400);
    out.s16(unit.motor_temperature(ago(unit, back)));
    let peak = [1_020, -811, 1_433];
    peak.iter().for_each(|v| out.s16(*v));
    out.s32(vector(peak));
    [612, 488, 803].iter().for_each(|v| out.s16(*v));
    [297, 594, 1_188].iter().for_each(|v| out.u16(*v));
}
