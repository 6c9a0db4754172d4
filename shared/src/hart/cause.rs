//! What recomputation proves about a frame: sound, or damaged in which way.

use super::frame::{DELIMITERS, Delimiter, Head, check};

/// Delimiter, long address, expansion, command and count: a frame this long has its head.
const SHORTEST_HEAD: usize = 11;

/// What is known about the bytes of one frame, preamble left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Length and check byte hold.
    Sound,
    /// The length holds, the check byte does not.
    Check {
        /// As received.
        got: u8,
        /// As computed.
        want: u8,
    },
    /// All but the check byte is there.
    CheckMissing {
        /// What it would be.
        want: u8,
    },
    /// The check byte holds at another length than the count says.
    Count {
        /// As received.
        got: u8,
        /// What the bytes say.
        want: u8,
        /// True if the sender counted wrong, false if the byte changed on the way.
        sent: bool,
    },
    /// The delimiter is gone, and with it the preamble; with this one the check byte holds.
    Start {
        /// The delimiter that is missing.
        delimiter: u8,
    },
    /// The end is missing.
    Cut {
        /// Bytes that are missing at least.
        missing: u16,
    },
    /// No frame begins here.
    None,
}

/// Judges bytes that are taken for one frame without its preamble.
pub(super) fn judge(frame: &[u8]) -> Verdict {
    let head = Head::of(frame).filter(Head::is_possible);
    if head.is_some_and(|h| h.total() == frame.len()) && check(frame) == 0 {
        return Verdict::Sound;
    }
    // The first byte of an address can look like a delimiter, so this comes before the rest.
    if let Some((delimiter, whole)) = eaten(frame)
        && whole.total() == frame.len()
    {
        return Verdict::Start {
            delimiter: delimiter.get(),
        };
    }
    if let Some(verdict) = Head::of(frame).and_then(|h| recount(&h, frame)) {
        return verdict;
    }
    let Some(head) = head else {
        let begun = frame.first().is_some_and(|d| Delimiter::new(*d).is_some());
        return if begun && frame.len() < SHORTEST_HEAD {
            Verdict::Cut { missing: 1 }
        } else {
            Verdict::None
        };
    };
    let got = frame.last().copied().unwrap_or(0);
    match head.total().checked_sub(frame.len()) {
        Some(0) => Verdict::Check {
            got,
            want: got ^ check(frame),
        },
        Some(1) => Verdict::CheckMissing { want: check(frame) },
        Some(missing) => Verdict::Cut {
            missing: u16::try_from(missing).unwrap_or(u16::MAX),
        },
        // More than the frame: whoever cut it out was wrong.
        None => Verdict::None,
    }
}

/// Does the check byte hold if the count is the one that the length asks for?
fn recount(head: &Head, frame: &[u8]) -> Option<Verdict> {
    let room = frame.len().checked_sub(head.data)?.checked_sub(1)?;
    let want = u8::try_from(room).ok()?;
    if want == head.count || want < head.status_len() {
        return None;
    }
    let sum = check(frame);
    let sent = sum == 0;
    // With the right count in the place of the received one, is the sum 0?
    (sent || sum == head.count ^ want).then_some(Verdict::Count {
        got: head.count,
        want,
        sent,
    })
}

/// The delimiter with which a frame that starts at its address holds, and its head.
///
/// Only frames with a long address are tried: in a short one too few bytes speak for it.
pub(super) fn eaten(bytes: &[u8]) -> Option<(Delimiter, Head)> {
    DELIMITERS
        .into_iter()
        .filter_map(Delimiter::new)
        .filter(|d| d.is_long())
        .find_map(|delimiter| {
            let head = Head::after(delimiter, bytes, 0)?;
            let frame = bytes.get(..head.total())?;
            (head.is_possible() && check(frame) == delimiter.get()).then_some((delimiter, head))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Request of command 3 and response to it, from the worked frames R5 and R28.
    const REQUEST: [u8; 9] = [0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x03, 0x00, 0x95];
    const REPLY: [u8; 11] = [
        0x86, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x23, 0x02, 0x40, 0x40, 0xB3,
    ];

    #[test]
    fn damage_is_told_apart() {
        assert_eq!(judge(&REQUEST), Verdict::Sound);
        assert_eq!(judge(&REPLY), Verdict::Sound);
        let mut bad = REPLY;
        bad[9] = 0x41;
        assert_eq!(
            judge(&bad),
            Verdict::Check {
                got: 0xB3,
                want: 0xB2
            }
        );
        assert_eq!(judge(&REPLY[..10]), Verdict::CheckMissing { want: 0xB3 });
        assert_eq!(judge(&REPLY[..8]), Verdict::Cut { missing: 3 });
        assert_eq!(judge(&REPLY[1..]), Verdict::Start { delimiter: 0x86 });
    }

    #[test]
    fn a_wrong_count_is_proved() {
        // Changed on the way: the sum holds with the right count.
        let mut changed = REPLY;
        changed[7] = 0x06;
        let proof = Verdict::Count {
            got: 6,
            want: 2,
            sent: false,
        };
        assert_eq!(judge(&changed), proof);
        // Sent so: the sum holds with the wrong count, B3 ^ 02 ^ 06 = B7.
        changed[10] = 0xB7;
        let proof = Verdict::Count {
            got: 6,
            want: 2,
            sent: true,
        };
        assert_eq!(judge(&changed), proof);
    }
}
