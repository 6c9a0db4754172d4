//! Trends: hourly values, of which longer points take the most, the least or the average.

use super::put::Put;
use super::unit::{Unit, noise, wave};

/// Hours in a point of a trend, and points at most: hours, days, months, years.
const SCALES: [(i64, usize); 4] = [(1, 24), (24, 30), (730, 12), (8_766, 10)];

/// What a point makes of its hours.
#[derive(Clone, Copy)]
pub(super) enum Join {
    Most,
    Least,
    Average,
}

/// An hourly value, and how hours become a point.
pub(super) type Line = fn(&Unit, i64) -> (i64, Join);

pub(super) fn vibration_max(unit: &Unit, hour: i64) -> (i64, Join) {
    let rough = noise(unit.seed, hour, 140).saturating_add(wave(hour, 24, 90));
    (rough.saturating_add(320), Join::Most)
}

pub(super) fn vibration_avg(unit: &Unit, hour: i64) -> (i64, Join) {
    (
        noise(unit.seed, hour.saturating_add(3), 30).saturating_add(85),
        Join::Average,
    )
}

/// Thousandths of a turn off the reference; the seat wears slowly.
pub(super) fn seat(unit: &Unit, hour: i64, shift: i64) -> i64 {
    let wear = hour
        .saturating_sub(unit.commissioned().checked_div(3_600).unwrap_or(0))
        .checked_div(400)
        .unwrap_or(0);
    noise(unit.seed, hour.saturating_add(shift), 9)
        .saturating_add(wear)
        .saturating_sub(12)
}

pub(super) fn seat_max(unit: &Unit, hour: i64) -> (i64, Join) {
    (seat(unit, hour, 1).saturating_add(14), Join::Most)
}

pub(super) fn seat_min(unit: &Unit, hour: i64) -> (i64, Join) {
    (seat(unit, hour, 1).saturating_sub(11), Join::Least)
}

pub(super) fn seat_avg(unit: &Unit, hour: i64) -> (i64, Join) {
    (seat(unit, hour, 1), Join::Average)
}

pub(super) fn close_max(unit: &Unit, hour: i64) -> (i64, Join) {
    (seat(unit, hour, 2).saturating_add(6), Join::Most)
}

pub(super) fn close_min(unit: &Unit, hour: i64) -> (i64, Join) {
    (seat(unit, hour, 2).saturating_sub(19), Join::Least)
}

pub(super) fn close_avg(unit: &Unit, hour: i64) -> (i64, Join) {
    (seat(unit, hour, 2).saturating_sub(4), Join::Average)
}

pub(super) fn motor_max(unit: &Unit, hour: i64) -> (i64, Join) {
    let warm = unit.motor_temperature(hour.saturating_mul(3_600));
    (warm.saturating_add(95), Join::Most)
}

pub(super) fn motor_min(unit: &Unit, hour: i64) -> (i64, Join) {
    (
        unit.motor_temperature(hour.saturating_mul(3_600)),
        Join::Least,
    )
}

pub(super) fn motor_avg(unit: &Unit, hour: i64) -> (i64, Join) {
    let warm = unit.motor_temperature(hour.saturating_mul(3_600));
    (warm.saturating_add(31), Join::Average)
}

pub(super) fn inside_max(unit: &Unit, hour: i64) -> (i64, Join) {
    let warm = unit.internal_temperature(hour.saturating_mul(3_600));
    (warm.saturating_add(18), Join::Most)
}

pub(super) fn inside_min(unit: &Unit, hour: i64) -> (i64, Join) {
    let warm = unit.internal_temperature(hour.saturating_mul(3_600));
    (warm.saturating_sub(15), Join::Least)
}

pub(super) fn inside_avg(unit: &Unit, hour: i64) -> (i64, Join) {
    (
        unit.internal_temperature(hour.saturating_mul(3_600)),
        Join::Average,
    )
}

/// The value of one point: so many hours from an hour on.
pub(super) fn point(unit: &Unit, line: Line, first: i64, hours: i64) -> i64 {
    let mut sum = 0_i64;
    let mut most = i64::MIN;
    let mut least = i64::MAX;
    let mut how = Join::Average;
    for hour in first..first.saturating_add(hours) {
        let (value, join) = line(unit, hour);
        how = join;
        sum = sum.saturating_add(value);
        most = most.max(value);
        least = least.min(value);
    }
    match how {
        Join::Most => most,
        Join::Least => least,
        Join::Average => sum.checked_div(hours.max(1)).unwrap_or(0),
    }
}

pub(super) fn trend(unit: &Unit, out: &mut Put, option: u8, seats: bool, lines: &[Line]) {
    let (hours, size) = SCALES.get(usize::from(option)).copied().unwrap_or((1, 24));
    let this = unit.wall.checked_div(3_600).unwrap_or(0);
    let first = unit.commissioned().checked_div(3_600).unwrap_or(0);
    // The newest point ends with this hour; points from before the commissioning do not exist.
    let starts: Vec<i64> = (1_i64..)
        .take(size)
        .map(|back| {
            this.saturating_sub(back.saturating_mul(hours))
                .saturating_add(1)
        })
        .take_while(|start| start.saturating_add(hours) > first)
        .collect();
    out.u16(i64::try_from(starts.len()).unwrap_or(0));
    for line in lines {
        out.array(
            size,
            starts.iter().map(|s| point(unit, *line, *s, hours)),
            Put::s32,
        );
    }
    let oldest = starts.last().copied().unwrap_or(this).max(first);
    out.time(oldest.saturating_mul(3_600));
    out.time(unit.wall);
    if seats {
        let span = this.saturating_sub(oldest).saturating_add(1);
        out.u32(span.saturating_mul(2));
    }
}
