//! Position, starts and strokes: objects 201, 202 and 205 to 209.

use super::objects::{ago, stroke};
use super::put::Put;
use super::trends::seat;
use super::unit::{Unit, Way, side};

pub(super) fn on_time(unit: &Unit, out: &mut Put) {
    for bins in &unit.on_ms {
        let seconds = bins.iter().map(|ms| ms.checked_div(1000).unwrap_or(0));
        out.array(10, seconds, Put::u32);
    }
    for times in &unit.on_at {
        out.array(10, times.iter().copied(), Put::time);
    }
}

pub(super) fn starts(unit: &Unit, out: &mut Put, most: bool) {
    let ways = [Way::Open, Way::Close];
    for way in ways {
        let counts = (0..10).map(
            |bin| match unit.most.get(side(way)).and_then(|m| m.get(bin)) {
                Some((count, _)) if most => *count,
                _ => unit.starts_in(way, bin),
            },
        );
        out.array(10, counts, Put::u16);
    }
    for way in ways {
        let times = (0..10).map(|bin| {
            let last = unit.starts.iter().rev().find(|s| s.1 == way && s.2 == bin);
            match unit.most.get(side(way)).and_then(|m| m.get(bin)) {
                Some((_, time)) if most => *time,
                _ => last.map_or(0, |s| s.0),
            }
        });
        out.array(10, times, Put::time);
    }
}

pub(super) fn last_seat(unit: &Unit, out: &mut Put) {
    let hour = unit.wall.checked_div(3_600).unwrap_or(0);
    for (way, seats) in [(Way::Open, unit.opens), (Way::Close, unit.closes)] {
        let run = stroke(unit, way, false);
        let off = seat(unit, hour, 1).saturating_mul(10);
        out.time(run.end);
        out.s32(off);
        out.s32(off.saturating_sub(7));
        out.s16(if way == Way::Open { 5_412 } else { -5_388 });
        let end = if way == Way::Open { 99 } else { 0 };
        out.u16(run.torque(unit.seed, end));
        out.s16(unit.motor_temperature(run.end));
        out.u16(unit.volts());
        out.u32(seats);
        out.s32(off.saturating_sub(3));
        out.s32(off.saturating_add(140));
        out.s32(off.saturating_sub(155));
    }
}

pub(super) fn indicators(unit: &Unit, out: &mut Put, object: u16) {
    match object {
        206 => {
            out.time(ago(unit, 250_000));
            out.u32(3);
            out.s32(2_150);
            // Never on closing.
            out.time(0);
            out.u32(0);
            out.s32(-85);
        }
        207 => {
            out.time(ago(unit, 700_000));
            out.u32(5);
            out.u32(48);
            out.time(ago(unit, 5_100_000));
            out.u16(66);
            out.time(0);
            out.u32(0);
            out.u32(0);
            out.time(0);
            out.u16(0);
        }
        208 => {
            out.time(ago(unit, 1_900_000));
            out.u32(1);
            out.time(0);
            out.u32(0);
            out.time(0);
            out.u32(0);
            out.time(ago(unit, 900_000));
            out.u16(1);
            out.u32(31_536_000_i64.saturating_sub(unit.age_ms.checked_div(1000).unwrap_or(0)));
            out.time(ago(unit, 88_000));
            out.u32(17);
            out.u32(4_320);
        }
        _ => {
            out.u32(11);
            out.time(ago(unit, 1_209_600));
            out.u32(2);
            out.time(ago(unit, 9_000_000));
            out.u16(20);
            out.u32(9);
            out.time(ago(unit, 1_296_000));
            out.u32(0);
            out.time(0);
            out.u16(0);
        }
    }
}
