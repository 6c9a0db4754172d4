//! The objects, register by register, as the tables of AIIOM000698-01 print them.

use super::position::{indicators, last_seat, on_time, starts};
use super::put::Put;
use super::torque::{curve, profile, torque_indicators, torque_most};
use super::trends::{
    close_avg, close_max, close_min, inside_avg, inside_max, inside_min, motor_avg, motor_max,
    motor_min, seat_avg, seat_max, seat_min, trend, vibration_avg, vibration_max,
};
use super::unit::{Stroke, TURNS, Unit, Way, noise};
use super::vibration::{by_position, elapsed, exceeded, historical, present};

/// Error codes (AIIOM000698-01, section 2.1.3).
const UNHANDLED: u16 = 1;
const BAD_OPTION: u16 = 3;
/// The registers of an object, or the error code.
pub(super) fn respond(unit: &Unit, object: u16, option: u8) -> Result<Vec<u16>, u16> {
    let mut out = Put::default();
    let last = match object {
        1 | 202 | 203 | 204 | 601 | 604 | 401 => 3,
        3 | 4 | 7 => 2,
        _ => 0,
    };
    let last = if object == 202 { 1 } else { last };
    let known = matches!(
        object,
        1..=7 | 201..=209 | 401..=405 | 601 | 602 | 604 | 605 | 1003..=1007
    );
    if !known {
        return Err(UNHANDLED);
    }
    if option > last {
        return Err(BAD_OPTION);
    }
    match object {
        1 => trend(
            unit,
            &mut out,
            option,
            false,
            &[vibration_max, vibration_avg],
        ),
        2 => elapsed(unit, &mut out),
        3 => by_position(unit, &mut out, Way::Open, option),
        4 => by_position(unit, &mut out, Way::Close, option),
        5 => present(unit, &mut out),
        6 => historical(unit, &mut out),
        7 => exceeded(unit, &mut out, option),
        201 => on_time(unit, &mut out),
        202 => starts(unit, &mut out, option == 1),
        203 => trend(
            unit,
            &mut out,
            option,
            true,
            &[seat_max, seat_min, seat_avg],
        ),
        204 => trend(
            unit,
            &mut out,
            option,
            true,
            &[close_max, close_min, close_avg],
        ),
        205 => last_seat(unit, &mut out),
        206..=209 => indicators(unit, &mut out, object),
        401 => curve(unit, &mut out, option),
        402 => profile(unit, &mut out),
        403 | 404 => torque_indicators(unit, &mut out, object),
        405 => torque_most(unit, &mut out),
        601 => trend(
            unit,
            &mut out,
            option,
            false,
            &[motor_max, motor_min, motor_avg],
        ),
        602 => motor(unit, &mut out),
        604 => trend(
            unit,
            &mut out,
            option,
            false,
            &[inside_max, inside_min, inside_avg],
        ),
        605 => inside(unit, &mut out),
        1003 => supply(unit, &mut out),
        1004 => operation(unit, &mut out),
        1005 => alarms(unit, &mut out),
        1006 => super::identity::put(unit, &mut out),
        _ => clock(unit, &mut out),
    }
    Ok(out.0)
}

pub(super) fn ago(unit: &Unit, seconds: i64) -> i64 {
    unit.wall.saturating_sub(seconds)
}

/// A recent or a reference stroke.
pub(super) fn stroke(unit: &Unit, way: Way, reference: bool) -> &Stroke {
    let all = if reference {
        &unit.reference
    } else {
        &unit.recent
    };
    let [open, close] = all;
    match way {
        Way::Open => open,
        Way::Close => close,
    }
}

// ---- environment

fn motor(unit: &Unit, out: &mut Put) {
    out.s16(unit.motor_temperature(unit.wall).saturating_add(31));
    out.time(ago(unit, 9_500_000));
    out.s16(874);
    out.time(ago(unit, 26_000_000));
    out.s16(-121);
    out.time(0);
    out.u32(0);
    out.time(ago(unit, 9_500_100));
    out.u32(2);
}

fn inside(unit: &Unit, out: &mut Put) {
    out.time(ago(unit, 9_500_000));
    out.s16(611);
    out.time(ago(unit, 26_000_000));
    out.s16(-98);
}

// ---- operation

fn supply(unit: &Unit, out: &mut Put) {
    for (back, value) in [
        (800_000, 428),
        (1_600_000, 351),
        (420_000, 504),
        (2_400_000, 495),
    ] {
        out.time(ago(unit, back));
        out.u16(value);
    }
    out.u16(unit.volts());
    out.u16(noise(unit.seed, unit.wall, 3).saturating_add(499));
}

fn operation(unit: &Unit, out: &mut Put) {
    out.u16(13);
    let strokes = unit.opens.saturating_add(unit.closes);
    out.u32(strokes.saturating_mul(TURNS));
    out.u32(unit.opens);
    out.u32(unit.closes);
    out.u32(unit.runtime());
    out.u32(5);
    out.u32(1);
    out.u32(6);
    out.time(ago(unit, 15_000_000));
    out.u32(unit.wall.saturating_sub(unit.commissioned()));
    out.u32(14);
}

fn alarms(unit: &Unit, out: &mut Put) {
    out.u32(i64::from(unit.phase_lost()).saturating_mul(4));
    // Bits 6 and 17.
    out.u32(0x0002_0040);
}

fn clock(unit: &Unit, out: &mut Put) {
    out.time(unit.wall);
    out.u16(2_987);
    out.u16(2);
}
