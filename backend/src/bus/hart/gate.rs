//! What may go out on a HART line: complete, sound requests of commands that change nothing.
//!
//! This looks at the bytes themselves. A command reads or does not read by the table of commands,
//! and for some by the length of the data as well: command 48 with data clears a flag. What the
//! table does not know is not sent.

use shared::frame::ascii::hex_pair;
use shared::hart::frame::{Address, FILL, Head, PREAMBLE, Type, check, extended, preamble};
use shared::hart::ip::HEADER;
use shared::hart::link::reads;
use shared::hart::model::Reach;
use shared::proto::HartCommand;

/// A frame that may not be sent: its command, if it could be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused(pub Option<u16>);

/// The data of a command that a page asks for.
///
/// # Errors
/// If it may not be sent, in words.
pub fn command(ask: &HartCommand) -> Result<Vec<u8>, String> {
    let number = ask.number;
    let Some(data) = unhex(&ask.data) else {
        return Err(format!(
            "The data of command {number} are \"{}\"; write two hexadecimal digits for each byte.",
            ask.data
        ));
    };
    let known = shared::hart::command(number);
    let Some(known) = known else {
        return Err(format!(
            "Command {number} is not known, so it is not known to read only; it was not sent."
        ));
    };
    if known.reach == Reach::Broadcast {
        return Err(format!(
            "Command {number} looks for a device; search for the tag instead."
        ));
    }
    if reads(number, &data) {
        return Ok(data);
    }
    Err(
        if known.is_read() || known.reads_with(0) && !data.is_empty() {
            format!(
                "Command {number} with {} bytes of data is no read; it was not sent.",
                data.len()
            )
        } else {
            let effects: Vec<&str> = known.effects.iter().map(|e| e.label()).collect();
            format!(
                "Command {number}, {}, {}; it was not sent, since this program only reads.",
                known.label.to_lowercase(),
                effects.join(" and ")
            )
        },
    )
}

/// Two digits a byte.
fn unhex(text: &str) -> Option<Vec<u8>> {
    let digits = text.as_bytes();
    if digits.len() > 512 {
        return None;
    }
    let pair = |pair: &[u8]| {
        let [high, low] = pair else { return None };
        hex_pair(&[*high, *low])
    };
    digits.chunks(2).map(pair).collect()
}

/// Checks the bytes of a serial line: a preamble, one request that reads, and nothing else.
///
/// # Errors
/// If they are anything else.
pub fn admit(bytes: &[u8]) -> Result<(), Refused> {
    let fill = preamble(bytes);
    let frame = bytes.get(fill..).unwrap_or(&[]);
    self::frame(frame)?;
    if PREAMBLE.contains(&fill) && bytes.first() == Some(&FILL) {
        Ok(())
    } else {
        Err(Refused(None))
    }
}

/// Checks a frame from its delimiter to its check byte.
fn frame(frame: &[u8]) -> Result<(), Refused> {
    let head = Head::of(frame).ok_or(Refused(None))?;
    let number = extended(&head, frame).unwrap_or(u16::from(head.command));
    let refused = Err(Refused(Some(number)));
    let delimiter = head.delimiter;
    let plain = delimiter.kind() == Type::Stx
        && delimiter.expansion() == 0
        && !delimiter.is_synchronous()
        && !head.burst;
    let whole = head.total() == frame.len() && check(frame) == 0;
    if !plain || !whole {
        return refused;
    }
    let data = frame.get(head.data..frame.len() - 1).unwrap_or(&[]);
    let data = match head.command {
        // What fits into one byte does not travel inside.
        31 if number < 256 => return refused,
        31 => data.get(2..).unwrap_or(&[]),
        _ => data,
    };
    let broadcast = head.address == Address::BROADCAST;
    let wanted = shared::hart::command(number).is_some_and(|c| c.reach == Reach::Broadcast);
    if reads(number, data) && broadcast == wanted {
        Ok(())
    } else {
        refused
    }
}

/// Checks one message of HART-IP: session initiate, session close, keep alive, or a token-passing
/// PDU with one request that reads.
///
/// # Errors
/// If it is anything else.
pub fn admit_ip(message: &[u8]) -> Result<(), Refused> {
    let Some((header, body)) = message.split_first_chunk::<{ HEADER }>() else {
        return Err(Refused(None));
    };
    let &[version, kind, id, status, _, _, l0, l1] = header;
    let len = usize::from(u16::from_be_bytes([l0, l1]));
    if (version, kind, status) != (1, 0, 0) || len != message.len() {
        return Err(Refused(None));
    }
    match (id, body) {
        // Session initiate: master type and inactivity close time.
        (0, [0 | 1, _, _, _, _]) | (1 | 2, []) => Ok(()),
        (3, body) => frame(body),
        _ => Err(Refused(None)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::hart::frame::seal;
    use shared::hart::link::Request;

    const LONG: [u8; 5] = [0xAE, 0xDD, 0x01, 0x23, 0x45];

    fn serial(frame: &[u8]) -> Vec<u8> {
        [vec![FILL; 5], frame.to_vec()].concat()
    }

    fn ip(id: u8, body: &[u8]) -> Vec<u8> {
        let len = u16::try_from(8 + body.len()).unwrap().to_be_bytes();
        [&[1, 0, id, 0, 0, 7, len[0], len[1]], body].concat()
    }

    /// The same frame on both kinds of line.
    fn passes(frame: &[u8]) -> bool {
        let one = admit(&serial(frame)).is_ok();
        assert_eq!(one, admit_ip(&ip(3, frame)).is_ok(), "{frame:02X?}");
        one
    }

    /// Commands that read, by hand from tables 12 to 14 of the manual and readings/hart.md, with
    /// the lengths of their data.
    fn by_hand(number: u16, len: usize) -> bool {
        match number {
            0..=3 | 7 | 8 | 12..=16 | 20 | 48 | 95 | 128 | 131 | 133 => len == 0,
            9 => (1..=8).contains(&len),
            33 => (1..=4).contains(&len),
            54 => len == 1,
            129 => len == 3,
            523 => len == 2,
            _ => false,
        }
    }

    /// All 65,536 command numbers with every length of data that fits: only reads pass, and
    /// never a byte of anything else.
    #[test]
    fn of_all_commands_only_reads_pass() {
        let few = [0, 1, 2, 3, 4, 6, 8, 25, 32, 253, 255];
        let all: Vec<usize> = (0..=255).collect();
        let mut passed = 0;
        for number in 0..=u16::MAX {
            // All lengths where anything may pass, its neighbours, and here and there.
            let near = number <= 300 || (500..=550).contains(&number) || number % 1024 == 0;
            let lengths = if near { &all[..] } else { &few[..] };
            for len in lengths.iter().copied() {
                let data = vec![0x01; len];
                // As the number itself, where it fits into a byte, and inside command 31.
                let inside = [&number.to_be_bytes(), &data[..]].concat();
                let long = (inside.len() <= 255).then(|| passes(&seal(0x82, &LONG, 31, &inside)));
                let carried = by_hand(number, len) && number >= 256;
                assert!(long.is_none_or(|p| p == carried), "{number} {len}");
                passed += u32::from(long == Some(true));
                if let Ok(byte) = u8::try_from(number)
                    && byte != 31
                {
                    let plain = passes(&seal(0x82, &LONG, byte, &data));
                    assert_eq!(plain, by_hand(number, len), "{number} {len}");
                    passed += u32::from(plain);
                }
            }
        }
        // 17 without data, 8 and 4 lengths of 9 and 33, and one each of 54, 129 and 523.
        assert_eq!(passed, 17 + 8 + 4 + 3);
    }

    /// Commands 11 and 21 go to everybody, and nothing else does.
    #[test]
    fn only_the_search_by_tag_goes_to_everybody() {
        let all = [0x80, 0, 0, 0, 0];
        for (number, len) in [(11, 6), (21, 32)] {
            assert!(passes(&seal(0x82, &all, number, &vec![0x41; len])));
            assert!(passes(&seal(0x82, &[0; 5], number, &vec![0x41; len])));
            assert!(!passes(&seal(0x82, &LONG, number, &vec![0x41; len])));
            assert!(!passes(&seal(0x82, &all, number, &vec![0x41; len - 1])));
        }
        for number in 0..=255 {
            let passed = passes(&seal(0x82, &all, number, &[]));
            assert!(!passed, "{number}");
        }
    }

    #[test]
    fn what_changes_something_by_its_data_does_not_pass() {
        assert!(passes(&seal(0x82, &LONG, 48, &[])));
        for len in 1..=25 {
            assert!(!passes(&seal(0x82, &LONG, 48, &vec![0; len])), "{len}");
        }
        // Readings, section 5.2: R14 fixes a device variable, R17 closes the valve.
        for frame in [
            &[
                0x82, 0xAE, 0xDD, 1, 0x23, 0x45, 0x4F, 8, 1, 1, 0x39, 0x41, 0xC8, 0, 0, 0, 0x61,
            ][..],
            &[0x82, 0xAE, 0xDD, 1, 0x23, 0x45, 0x84, 1, 0x22, 0x31],
        ] {
            assert_eq!(check(frame), 0);
            assert!(!passes(frame));
        }
        // Command 31 within command 31.
        assert!(!passes(&seal(0x82, &LONG, 31, &[0, 31, 2, 0x0B, 0, 64])));
        assert!(!passes(&seal(0x82, &LONG, 31, &[0])));
    }

    #[test]
    fn only_whole_requests_pass() {
        let good = Request::new(Address::Long(0x2EDD, 0x01_2345), 3, &[]).frame(true);
        assert!(passes(&good));
        for at in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                assert!(!passes(&bad), "{at} {bit}");
            }
        }
        for len in 0..good.len() {
            assert!(!passes(&good[..len]), "{len}");
        }
        // Nothing may hide behind it, and nothing before it.
        let write = seal(0x82, &LONG, 132, &[0x22]);
        assert!(!passes(&[good.clone(), serial(&write)].concat()));
        assert!(!passes(&[good.clone(), write.clone()].concat()));
        assert!(admit(&[write, serial(&good)].concat()).is_err());
        // Replies, bursts, expansion bytes, the synchronous layer, the burst bit.
        for (delimiter, address) in [(0x86, LONG), (0x81, LONG), (0x8A, LONG)] {
            assert!(!passes(&seal(delimiter, &address, 3, &[])));
        }
        assert!(!passes(&seal(
            0xA2,
            &[0xAE, 0xDD, 1, 0x23, 0x45, 9],
            3,
            &[]
        )));
        assert!(!passes(&seal(0x82, &[0xEE, 0xDD, 1, 0x23, 0x45], 3, &[])));
        // Preambles: 5 to 20.
        for fill in 0..40 {
            let bytes = [vec![FILL; fill], good.clone()].concat();
            assert_eq!(admit(&bytes).is_ok(), (5..=20).contains(&fill), "{fill}");
        }
    }

    #[test]
    fn of_hart_ip_only_sessions_and_reads_pass() {
        let read = Request::new(Address::Short(0), 0, &[]).frame(true);
        for id in 0..=255 {
            for len in 0..=16 {
                let open = id == 0 && len == 5;
                let empty = matches!(id, 1 | 2) && len == 0;
                let passed = admit_ip(&ip(id, &vec![1; len])).is_ok();
                assert_eq!(passed, open || empty, "{id} {len}");
            }
            assert_eq!(
                admit_ip(&ip(id, &read)).is_ok(),
                id == 3 || (id == 0 && read.len() == 5 && read[0] < 2)
            );
        }
        // A direct PDU, an answer, a publish message, a count that lies, something behind.
        assert!(admit_ip(&ip(4, &[0, 0, 0, 3, 0])).is_err());
        let good = ip(3, &read);
        for at in 0..8 {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                // The sequence number may be any.
                assert_eq!(admit_ip(&bad).is_ok(), matches!(at, 4 | 5), "{at} {bit}");
            }
        }
        assert!(admit_ip(&[good.clone(), good].concat()).is_err());
        assert!(admit_ip(&[]).is_err());
    }
}
