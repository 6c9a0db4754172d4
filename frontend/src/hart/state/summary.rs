//! A HART frame in one line, and in its head.

use shared::frame::{Frame, Marks};
use shared::hart::model::Kind;
use shared::hart::problem::Hart;
use shared::problem::{Finding, Problem, Severity};
use shared::tree::{Decoded, Field, Name};
use shared::value::Value;

use crate::state::summary::Summary;

/// Values spelled out in a line.
const VALUES: usize = 4;

/// Sums a decoded frame up.
#[must_use]
pub fn of(frame: Frame, decoded: &Decoded) -> Summary {
    let worst = decoded.problems().iter().map(Problem::severity).max();
    let (code, function) = command(decoded);
    Summary {
        frame,
        unit: address(decoded).unwrap_or_default(),
        code,
        function,
        detail: if frame.is_noise() {
            String::new()
        } else {
            detail(&frame, decoded)
        },
        worst,
    }
}

/// The first field of the protocol with this key.
fn field<'d>(decoded: &'d Decoded, key: &str) -> Option<&'d Field> {
    let is = |f: &&Field| matches!(f.name, Name::Def(def) if def.key == key);
    decoded.fields().iter().find(is)
}

/// Number and name of the command; of a message of HART-IP without one, the message.
fn command(decoded: &Decoded) -> (String, &'static str) {
    let own = field(decoded, "command").map(|f| f.value);
    let Some(Value::Named(number, label)) = own else {
        let message = field(decoded, "message_id").map(|f| f.value);
        return match message {
            Some(Value::Named(_, Some(label))) => (String::new(), label),
            _ if decoded.problems().iter().any(is_noise) => (String::new(), "Noise"),
            _ => (String::new(), "Cut short"),
        };
    };
    let carried = decoded
        .fields()
        .iter()
        .find_map(|f| match (f.name, f.value) {
            (Name::Hart(item, ..), Value::Number { raw, .. }) if item.key == "extended_number" => {
                u16::try_from(raw).ok()
            }
            _ => None,
        });
    match carried {
        Some(number) => {
            let known = shared::hart::command(number).map(|c| c.label);
            (number.to_string(), known.unwrap_or("Unknown command"))
        }
        None => (number.to_string(), label.unwrap_or("Unknown command")),
    }
}

const fn is_noise(problem: &Problem) -> bool {
    matches!(problem.finding, Finding::Noise { .. })
}

/// The address: a polling address, or type and device id as ten digits.
#[must_use]
pub fn address(decoded: &Decoded) -> Option<String> {
    let bytes = decoded.payload(field(decoded, "address")?);
    Some(match *bytes {
        [short] => (short & 0x3F).to_string(),
        [first, kind, a, b, c] => {
            let kind = u16::from_be_bytes([first & 0x3F, kind]);
            let id = u32::from_be_bytes([0, a, b, c]);
            if kind == 0 && id == 0 {
                "all".to_owned()
            } else {
                format!("{kind:04X} {id:06X}")
            }
        }
        _ => return None,
    })
}

/// `primary` or `secondary`: the master that asks or is answered.
#[must_use]
pub fn master(decoded: &Decoded) -> Option<&'static str> {
    let first = *decoded.payload(field(decoded, "address")?).first()?;
    Some(if first & 0x80 == 0 {
        "secondary"
    } else {
        "primary"
    })
}

fn detail(frame: &Frame, decoded: &Decoded) -> String {
    if let Some(damage) = damage(decoded) {
        return damage.to_owned();
    }
    let mut words = Vec::new();
    if frame.marks.has(Marks::AGAIN) {
        words.push("echo or repetition".to_owned());
    }
    for key in ["communication_error", "response_code", "status"] {
        if let Some(field) = field(decoded, key)
            && (key, field.value) != ("status", Value::Named(0, Some("Success")))
        {
            let text = decoded.bare_text(field);
            words.push(match (key, field.value) {
                ("communication_error", _) => format!("communication error: {text}"),
                (_, Value::Named(_, Some(label))) => label.to_owned(),
                _ => text,
            });
        }
    }
    if let Some(status) = field(decoded, "device_status").filter(|f| is_set(f)) {
        words.push(decoded.bare_text(status));
    }
    words.extend(effects(decoded).map(str::to_owned));
    words.extend(values(decoded));
    if let Some(master) = master(decoded) {
        words.push(format!("{master} master"));
    }
    words.join(" · ")
}

const fn is_set(field: &Field) -> bool {
    matches!(field.value, Value::Flags { raw, .. } if raw != 0)
}

/// What recomputation proved, in a few words.
fn damage(decoded: &Decoded) -> Option<&'static str> {
    let errors = decoded.problems().iter();
    let mut errors = errors.filter(|p| p.severity() == Severity::Error);
    errors.find_map(|p| match p.finding {
        Finding::Hart(Hart::Check { .. }) => Some("check byte wrong"),
        Finding::Hart(Hart::CheckMissing { .. }) => Some("check byte missing"),
        Finding::Hart(Hart::Count { .. }) => Some("byte count wrong"),
        Finding::Hart(Hart::Start { .. }) => Some("preamble and delimiter lost"),
        Finding::Truncated { .. } => Some("ends too early"),
        _ => None,
    })
}

/// What a request does besides reading.
fn effects(decoded: &Decoded) -> impl Iterator<Item = &'static str> {
    decoded.problems().iter().filter_map(|p| match p.finding {
        Finding::Hart(Hart::Does { effect }) => Some(effect.label()),
        _ => None,
    })
}

/// The first values of the data, spelled out.
fn values(decoded: &Decoded) -> impl Iterator<Item = String> {
    let told = |f: &&Field| match f.name {
        Name::Hart(item, ..) => {
            f.value != Value::Group
                && !matches!(item.kind, Kind::Unit | Kind::Nibbles(_) | Kind::Raw(_))
                && (is_set(f) || !matches!(f.value, Value::Flags { .. }))
                && item.expected.is_none()
                && item.key != "extended_number"
        }
        _ => false,
    };
    decoded
        .fields()
        .iter()
        .filter(told)
        .take(VALUES)
        .map(|f| format!("{} {}", f.name.label(), decoded.text(f)))
}

/// Whom a frame is about: `2EDD 012345 · primary master · command 3`.
#[must_use]
pub fn who(decoded: &Decoded) -> String {
    let (code, _) = command(decoded);
    let mut words = Vec::new();
    if let Some(address) = address(decoded) {
        words.push(format!("address {address}"));
    }
    if let Some(master) = master(decoded) {
        words.push(format!("{master} master"));
    }
    if !code.is_empty() {
        words.push(format!("command {code}"));
    }
    words.join(" · ")
}

/// The name of the command.
#[must_use]
pub fn title(decoded: &Decoded) -> &'static str {
    command(decoded).1
}

#[cfg(test)]
mod tests {
    use crate::state::load::load;
    use crate::state::samples::by_key;
    use crate::state::summary::summary;
    use shared::decode::Context;
    use shared::device::{Device, Family};
    use shared::tree::Decoded;

    fn lines(key: &str) -> Vec<String> {
        let loaded = load(by_key(key).unwrap().content, None);
        let context = Context {
            framing: loaded.session.framing(),
            device: Device::Rotork(Family::Iq),
        };
        let mut scratch = Decoded::default();
        (0..loaded.session.len())
            .filter_map(|i| summary(&loaded.session, i, &context, &mut scratch))
            .map(|s| format!("{} | {} {} | {}", s.unit, s.code, s.function, s.detail))
            .collect()
    }

    /// What a technician sees of a handheld's session.
    #[test]
    fn rows_name_command_address_and_response_code() {
        let lines = lines("hart-handheld");
        assert_eq!(lines[0], "0 | 0 Read unique identifier | secondary master");
        assert!(
            lines[16].starts_with("2EDD 012345 | 3 Read dynamic variables"),
            "{}",
            lines[16]
        );
        assert_eq!(
            lines[17],
            "2EDD 012345 | 3 Read dynamic variables and loop current | \
             Success · More status available, Configuration changed · Loop current 12 mA · \
             Primary variable 50 % · Secondary variable 49.5 % · Tertiary variable 12.5 % · \
             secondary master"
        );
        let refused = &lines[25];
        assert!(refused.contains("Command not implemented"), "{refused}");
        assert!(lines[23].contains("523 Read condensed status mapping array"));
    }

    #[test]
    fn damage_is_said_in_its_place() {
        let lines = lines("hart-damaged");
        for (at, words) in [
            (1, "echo or repetition"),
            (4, "preamble and delimiter lost"),
            (5, "Noise"),
            (7, "check byte wrong"),
            (9, "ends too early"),
            (11, "communication error"),
            (13, "changes the configuration · may move the valve"),
            (14, "byte count wrong"),
            (16, "check byte missing"),
        ] {
            assert!(lines[at].contains(words), "{at}: {}", lines[at]);
        }
    }

    #[test]
    fn messages_of_a_gateway_are_named() {
        let lines = lines("hart-ip");
        assert!(lines[0].contains("Session initiate"), "{}", lines[0]);
        assert!(lines[5].contains("2EDD 012345 | 3 "), "{}", lines[5]);
        assert!(
            lines[9].contains("1 Read primary variable | Success · Cold start"),
            "{}",
            lines[9]
        );
    }
}
