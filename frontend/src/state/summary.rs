//! A frame in one line.

use shared::decode::{Context, pdu_of};
#[cfg(feature = "hart")]
use shared::frame::Framing;
use shared::frame::{Frame, Marks, Role};
use shared::pdu::{Asked, names};
use shared::problem::{Finding, Problem, Severity};
use shared::session::Session;
use shared::tree::{Decoded, Name};
use shared::value::Value;

use super::findings::decode_clipped;

/// What a row of a list of frames says.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Its entry of the index.
    pub frame: Frame,
    /// Whom it is about: the unit address; empty for noise.
    pub unit: String,
    /// The function code; empty for noise.
    pub code: String,
    /// Name of the function.
    pub function: &'static str,
    /// What it is about.
    pub detail: String,
    /// The worst problem.
    pub worst: Option<Severity>,
}

/// Sums an entry up; `scratch` is used to decode it.
#[must_use]
pub fn summary(
    session: &Session,
    index: u32,
    context: &Context,
    scratch: &mut Decoded,
) -> Option<Summary> {
    let frame = *session.frame(index)?;
    if !decode_clipped(session, index, context, scratch) {
        return None;
    }
    #[cfg(feature = "hart")]
    if !Framing::MODBUS.contains(&context.framing) {
        return Some(crate::hart::state::summary::of(frame, scratch));
    }
    if !cfg!(feature = "maps") {
        return None;
    }
    let worst = scratch.problems().iter().map(Problem::severity).max();
    let (unit, code) = if frame.is_noise() {
        Default::default()
    } else {
        (frame.unit.to_string(), format!("{:02X}", frame.function))
    };
    Some(Summary {
        frame,
        unit,
        code,
        function: function(&frame),
        detail: detail(session, &frame, index, scratch),
        worst,
    })
}

/// Name of a frame's function.
#[must_use]
pub fn function(frame: &Frame) -> &'static str {
    if frame.is_noise() {
        "Noise"
    } else {
        names::function(frame.function & 0x7F).unwrap_or("Unknown function")
    }
}

fn detail(session: &Session, frame: &Frame, index: u32, decoded: &Decoded) -> String {
    if frame.is_noise() {
        return String::new();
    }
    if frame.marks.has(Marks::TRUNCATED) {
        return "ends too early".to_owned();
    }
    if frame.marks.is_damaged() {
        return "check value wrong".to_owned();
    }
    if frame.role == Role::Exception {
        return exception(decoded);
    }
    let values = values(decoded);
    if !values.is_empty() {
        return values;
    }
    let request = if frame.role == Role::Response {
        frame.pair()
    } else {
        Some(index)
    };
    let asked = request
        .and_then(|r| session.bytes(r))
        .and_then(|bytes| pdu_of(bytes, session.framing()));
    match asked.as_deref().map(Asked::new).and_then(|a| a.read()) {
        Some((_, start, count)) if count > 0 => {
            let last = start.get().saturating_add(count - 1);
            let items = crate::format::count(u64::from(count), "item");
            if count == 1 {
                format!("{start}")
            } else {
                format!("{start} to {last}, {items}")
            }
        }
        _ => String::new(),
    }
}

fn exception(decoded: &Decoded) -> String {
    let code = decoded.problems().iter().find_map(|p| match p.finding {
        Finding::Exception { code } => Some(code),
        _ => None,
    });
    code.map_or_else(String::new, |code| {
        let name = names::exception(code).map_or("unknown code", |e| e.0);
        format!("{code:02}: {name}")
    })
}

/// Up to two values of a device, spelled out.
fn values(decoded: &Decoded) -> String {
    let rows = || {
        decoded
            .fields()
            .iter()
            .filter(|f| matches!(f.name, Name::Row(_) | Name::Register(..)))
            .filter(|f| f.value != Value::Group)
    };
    if rows().count() > 2 {
        return String::new();
    }
    rows()
        .map(|f| format!("{} = {}", f.name.label(), decoded.text(f)))
        .collect::<Vec<_>>()
        .join(" · ")
}

/// The word for a role.
#[must_use]
pub const fn role(role: Role) -> &'static str {
    match role {
        Role::Request => "request",
        Role::Response => "response",
        Role::Exception => "exception",
        Role::Burst => "burst",
        Role::Unknown => "request or response",
        Role::Noise => "noise",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use shared::device::Device;
    use shared::encode::frame;
    #[cfg(not(feature = "hart"))]
    use shared::frame::Framing;
    use shared::render::hex;

    fn lines(pdus: &[&[u8]]) -> Vec<String> {
        let text: Vec<String> = pdus
            .iter()
            .map(|pdu| hex(&frame(Framing::Rtu, 0, 9, pdu)))
            .collect();
        let loaded = load(text.join(" ").as_bytes(), Some(Framing::Rtu));
        let context = Context {
            framing: Framing::Rtu,
            device: Device::Icon3000v2,
        };
        let mut scratch = Decoded::default();
        (0..loaded.session.len())
            .filter_map(|i| summary(&loaded.session, i, &context, &mut scratch))
            .map(|s| format!("{} | {}", s.function, s.detail))
            .collect()
    }

    #[test]
    fn frames_in_a_line() {
        assert_eq!(
            lines(&[
                &[3, 0x0B, 0xB9, 0, 4],
                &[3, 8, 0, 0x21, 0, 0, 0, 0, 0x01, 0xC2],
                &[3, 0x0B, 0xBC, 0, 1],
                &[3, 2, 0x01, 0xC2],
                &[4, 0xFF, 0x00, 0, 1],
                &[0x84, 2],
            ]),
            [
                "Read holding registers | 3001 to 3004, 4 items",
                "Read holding registers | 3001 to 3004, 4 items",
                "Read holding registers | 3004",
                "Read holding registers | Actuator Position = 45.0 %",
                "Read input registers | 65280",
                "Read input registers | 02: Illegal data address",
            ]
        );
    }
}
