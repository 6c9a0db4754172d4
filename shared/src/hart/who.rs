//! Who a frame is about: address, master and command.

use core::fmt::{self, Write};

use super::decode::begin;
use super::frame::{Head, extended, preamble};
use super::{command, ip};
use crate::frame::Framing;

/// The head of a frame with its preamble, and the command: that of command 31 where it is there.
pub(super) fn identity(bytes: &[u8]) -> Option<(Head, u16)> {
    let body = bytes.get(preamble(bytes)..)?;
    let head = begin(body).1?;
    let number = extended(&head, body).unwrap_or(u16::from(head.command));
    Some((head, number))
}

/// Address, master and command as keys of a JSON object.
pub(crate) fn write_who(out: &mut impl Write, bytes: &[u8]) -> fmt::Result {
    write_head(out, identity(bytes))
}

/// The same of a head that is known.
pub(super) fn write_head(out: &mut impl Write, head: Option<(Head, u16)>) -> fmt::Result {
    match head {
        Some((head, number)) => {
            let master = if head.primary { "primary" } else { "secondary" };
            write!(
                out,
                r#","address":"{}","master":"{master}","command":{number}"#,
                head.address
            )
        }
        None => out.write_str(r#","address":null,"master":null,"command":null"#),
    }
}

/// A frame in a few words: `2EDD012345, primary master, command 3 Read dynamic variables`.
#[must_use]
pub fn who(framing: Framing, frame: &[u8]) -> String {
    if framing == Framing::HartIp {
        return ip::who(frame);
    }
    let Some((head, number)) = identity(frame) else {
        return "HART, cut short".to_owned();
    };
    let master = if head.primary { "primary" } else { "secondary" };
    let label = command(number).map_or("unknown command", |c| c.label);
    format!(
        "{}, {master} master, command {number} {label}",
        head.address
    )
}
