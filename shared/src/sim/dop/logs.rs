//! The two logs, a page at a time. The device remembers where it was.

use super::put::Put;
use super::unit::{Event, Move, Unit};

/// Records in a page: so many fit into 512 registers.
const PAGE: usize = 18;
/// Error "command option invalid".
const BAD_OPTION: u16 = 3;

/// Commands of a log. The manual names them and does not number them (reading M5).
mod command {
    pub(super) const NEWEST: u8 = 0;
    pub(super) const OLDEST: u8 = 1;
    pub(super) const OLDER: u8 = 2;
    pub(super) const NEWER: u8 = 3;
    pub(super) const PRESENT: u8 = 4;
}

/// The place in a log up to which it was read: indices of the records that were sent last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mark {
    oldest: usize,
    newest: usize,
    valid: bool,
}

/// A page of a log.
pub(super) fn page(unit: &Unit, object: u16, option: u8, mark: &mut Mark) -> Result<Vec<u16>, u16> {
    let len = if object == 1202 {
        unit.events.len()
    } else {
        unit.moves.len()
    };
    let mut out = Put::default();
    // Indices of the records to send, in their order.
    let chosen: Vec<usize> = match option {
        command::NEWEST => (0..len).rev().take(PAGE).collect(),
        command::OLDEST => (0..len).take(PAGE).collect(),
        command::OLDER if mark.valid => (0..mark.oldest.min(len)).rev().take(PAGE).collect(),
        command::NEWER if mark.valid => (mark.newest.saturating_add(1)..len).take(PAGE).collect(),
        command::OLDER | command::NEWER => Vec::new(),
        command::PRESENT => {
            out.u16(i64::from(len > 0));
            return Ok(out.0);
        }
        _ => return Err(BAD_OPTION),
    };
    if let (Some(oldest), Some(newest)) = (chosen.iter().min(), chosen.iter().max()) {
        *mark = Mark {
            oldest: *oldest,
            newest: *newest,
            valid: true,
        };
    }
    out.u16(i64::try_from(chosen.len()).unwrap_or(0));
    for at in chosen {
        if object == 1202 {
            if let Some(event) = unit.events.get(at) {
                put_event(event, &mut out);
            }
        } else if let Some(movement) = unit.moves.get(at) {
            put_move(movement, &mut out);
        }
    }
    Ok(out.0)
}

fn put_event(event: &Event, out: &mut Put) {
    out.u32(event.id);
    out.time(event.time);
    out.u16(event.category);
    out.text(event.text, 20);
}

fn put_move(movement: &Move, out: &mut Put) {
    out.u16(movement.id);
    out.time(movement.time);
    out.u16(movement.position);
    out.s16(movement.rpm);
    out.u16(movement.torque);
    out.s16(movement.temperature);
    out.u16(movement.demand);
    out.u16(10);
    out.u16(55);
    out.text(movement.text, 16);
}
