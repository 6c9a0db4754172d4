//! The frame that a command would be, and what its bytes say. Nothing here sends one.
//!
//! Source: sections 3.2.6 and 3.2.7 and table 3.7 of the guide: a command is a value in register 1.

use super::checklist::Wish;
use crate::address::{Address, Table};
use crate::device::Device;
use crate::encode::frame;
use crate::frame::Framing;
use crate::render::hex;

/// The register of commands, zero-based.
const COMMAND: u16 = 0;

/// Bytes of a frame and what they say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The bytes in hexadecimal, or the characters of an ASCII frame.
    pub bytes: String,
    /// What they say.
    pub text: String,
}

/// The PDU that writes a command with function 06; `None` if there is none.
#[must_use]
pub fn pdu(wish: Wish) -> Option<[u8; 5]> {
    let [r0, r1] = COMMAND.to_be_bytes();
    let [v0, v1] = wish.command()?.to_be_bytes();
    Some([6, r0, r1, v0, v1])
}

/// What a written value means on a type: `Open`; `None` if the type does not know it.
#[must_use]
pub fn meaning(kind: Device, value: u16) -> Option<String> {
    let row = kind.map()?.row_at(Table::Holding, Address::new(COMMAND))?;
    let member = row.set?.get(value.into())?;
    Some(member.name(value.into()).into_owned())
}

/// The whole frame as it would go out, piece by piece; empty if there is no such command. What the
/// pieces say is read back from their bytes.
#[must_use]
pub fn parts(kind: Device, framing: Framing, unit: u8, wish: Wish) -> Vec<Part> {
    let Some(pdu) = pdu(wish) else {
        return Vec::new();
    };
    let bytes = frame(framing, 0, unit, &pdu);
    let ascii = framing == Framing::Ascii;
    // An ASCII frame has a colon before, and two characters for each byte.
    let piece = |at: usize, len: usize| {
        if ascii {
            let from = at.saturating_mul(2).saturating_add(1);
            let to = from.saturating_add(len.saturating_mul(2));
            let characters = bytes.get(from..to).unwrap_or_default();
            String::from_utf8_lossy(characters).into_owned()
        } else {
            let to = at.saturating_add(len);
            hex(bytes.get(at..to).unwrap_or_default())
        }
    };
    let number = |text: &str| u16::from_str_radix(text, 16).unwrap_or(0);
    let (register, value) = (piece(2, 2), piece(4, 2));
    let (at, written) = (number(&register), number(&value));
    let register_text = format!("register {}", u32::from(at).saturating_add(40_001));
    let says = meaning(kind, written).unwrap_or_else(|| "not a command of this type".to_owned());
    let mut parts = vec![
        (piece(0, 1), format!("unit {unit}")),
        (piece(1, 1), "function 06, write one register".to_owned()),
        (register, register_text),
        (value, format!("{written}, {says}")),
    ];
    if ascii {
        parts.insert(0, (":".to_owned(), "start".to_owned()));
        parts.push((piece(6, 1), "LRC".to_owned()));
        parts.push(("CR LF".to_owned(), "end".to_owned()));
    } else {
        parts.push((piece(6, 2), "CRC".to_owned()));
    }
    let part = |(bytes, text)| Part { bytes, text };
    parts.into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(kind: Device, framing: Framing, unit: u8, wish: Wish) -> (String, Vec<String>) {
        let parts = parts(kind, framing, unit, wish);
        let bytes = parts.iter().map(|p| p.bytes.as_str()).collect();
        (bytes, parts.into_iter().map(|p| p.text).collect())
    }

    /// Section 3.2.6: open unit 179, and move unit 1 to 50 % in one step, as printed with their CRC.
    #[test]
    fn the_examples_of_the_guide() {
        let (bytes, texts) = joined(Device::Ddc100Mx, Framing::Rtu, 179, Wish::Open);
        assert_eq!(bytes, "B306000001009388");
        assert_eq!(
            texts,
            [
                "unit 179",
                "function 06, write one register",
                "register 40001",
                "256, Open",
                "CRC"
            ]
        );
        let (bytes, texts) = joined(Device::Ddc100Uec, Framing::Rtu, 1, Wish::MoveTo(50));
        assert_eq!(bytes, "010600004B323EEF");
        assert_eq!(texts[3], "19250, Move to 50 %");
    }

    /// LRC by hand: 01 + 06 + 05 = 0C, so F4.
    #[test]
    fn an_ascii_frame_in_its_characters() {
        let (bytes, texts) = joined(Device::Ddc100Uec, Framing::Ascii, 1, Wish::StartEsd);
        assert_eq!(bytes, ":010600000500F4CR LF");
        assert_eq!(texts[4], "1280, Start network ESD");
    }

    /// Table 3.7: a module must not be sent it.
    #[test]
    fn what_a_type_does_not_know_is_said() {
        let (_, texts) = joined(Device::Ddc100Io, Framing::Rtu, 1, Wish::Open);
        assert!(texts[3].ends_with("(do not use)"), "{texts:?}");
        assert!(parts(Device::Ddc100Io, Framing::Rtu, 1, Wish::MoveTo(101)).is_empty());
    }
}
