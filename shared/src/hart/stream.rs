//! HART frames in a stream: the preamble marks the start, the count the end, the check byte proves.

use super::cause::{Verdict, eaten, judge};
use super::frame::{
    Address, Delimiter, Head, LONGEST, MOST_FILL, SYNC, Type, check, extended, preamble,
};
use crate::frame::{Found, Marks, Role, View};

/// A frame with its preamble is at most so long.
const REACH: usize = MOST_FILL + LONGEST;

/// The frame or noise at the start of the view, and how many bytes from there are known not to
/// start a good frame.
pub(crate) fn next(view: &View<'_>) -> (Found, usize) {
    let fill = preamble(view.bytes);
    if fill > MOST_FILL {
        // The end of a very long preamble may still begin a frame.
        let certain = fill == view.bytes.len() && !view.at_end;
        let keep = if certain { REACH } else { MOST_FILL };
        return (Found::noise(fill.saturating_sub(keep).max(1)), 0);
    }
    let rest = view.bytes.get(fill..).unwrap_or(&[]);
    if let Some(head) = sound(rest)
        && (view.aligned
            || fill >= SYNC
            || stands_alone(view, &head, fill.saturating_add(head.total())))
    {
        return (found(&head, fill, head.total(), Marks::default()), 0);
    }
    let (gap, next) = search(view);
    let end = view.at_end && gap == view.bytes.len();
    let barren = if next || end {
        gap
    } else {
        gap.max(view.barren)
    };
    let damaged = (view.aligned || fill >= SYNC)
        .then(|| damaged(view, fill, gap, next || end))
        .flatten();
    (damaged.unwrap_or_else(|| Found::noise(gap)), barren)
}

/// The head of a frame that is complete, possible and whose check byte holds.
fn sound(bytes: &[u8]) -> Option<Head> {
    let head = Head::of(bytes)?;
    let frame = bytes.get(..head.total())?;
    (head.is_possible() && check(frame) == 0).then_some(head)
}

/// Without preamble, after noise: a long address, and a stream that goes on well or ends.
fn stands_alone(view: &View<'_>, head: &Head, end: usize) -> bool {
    let rest = view.bytes.get(end..).unwrap_or(&[]);
    head.delimiter.is_long() && (rest.is_empty() || preamble(rest) >= SYNC || sound(rest).is_some())
}

fn role(delimiter: Delimiter) -> Role {
    match delimiter.kind() {
        Type::Stx => Role::Request,
        Type::Ack => Role::Response,
        Type::Back => Role::Burst,
    }
}

fn found(head: &Head, fill: usize, len: usize, marks: Marks) -> Found {
    let unit = match head.address {
        Address::Short(polling) => polling,
        Address::Long(_, id) => u8::try_from(id & 0xFF).unwrap_or(0),
    };
    Found {
        len: fill.saturating_add(len),
        unit,
        function: head.command,
        role: role(head.delimiter),
        marks,
        transaction: 0,
    }
}

/// How far it is to the next good frame, and whether there is one. Without one: as far as is
/// certain.
fn search(view: &View<'_>) -> (usize, bool) {
    let all = view.bytes.len();
    let limit = if view.at_end {
        all
    } else {
        all.saturating_sub(REACH)
    };
    let mut at = view.barren.max(1);
    while at < limit {
        let rest = view.bytes.get(at..).unwrap_or(&[]);
        let fill = preamble(rest);
        // Of a run of preamble bytes, the last ones that count begin the frame.
        let skip = fill.saturating_sub(MOST_FILL);
        let start = at.saturating_add(skip);
        if let Some(head) = rest.get(fill..).and_then(sound)
            && start < limit
        {
            let end = at.saturating_add(fill).saturating_add(head.total());
            if fill >= SYNC || stands_alone(view, &head, end) {
                return (start, true);
            }
        }
        at = at.saturating_add(fill.max(1));
    }
    (limit.max(1).min(all), false)
}

/// Decides whether the bytes before the next good frame are a damaged one rather than noise.
fn damaged(view: &View<'_>, fill: usize, gap: usize, bounded: bool) -> Option<Found> {
    let rest = view.bytes.get(fill..)?;
    let room = gap.checked_sub(fill).filter(|room| *room > 0)?;
    if let Some(found) = start_eaten(rest, fill, room) {
        return Some(found);
    }
    let Some(head) = Head::of(rest) else {
        return cut_head(rest, fill, room, bounded);
    };
    if !head.is_possible() && !bounded {
        return None;
    }
    if bounded && room <= LONGEST {
        let frame = rest.get(..room)?;
        let marks = match judge(frame) {
            Verdict::Count { .. } => Some(Marks::MALFORMED),
            Verdict::CheckMissing { .. } | Verdict::Cut { .. } => Some(Marks::TRUNCATED),
            Verdict::Check { .. } => Some(Marks::BAD_CHECK),
            _ => None,
        };
        if let Some(marks) = marks {
            return Some(found(&head, fill, room, marks));
        }
    }
    // A damaged frame, and noise behind it.
    (head.is_possible() && head.total() <= room)
        .then(|| found(&head, fill, head.total(), Marks::BAD_CHECK))
}

fn start_eaten(rest: &[u8], fill: usize, room: usize) -> Option<Found> {
    let (_, head) = eaten(rest)?;
    (fill == 0 && head.total() <= room).then(|| found(&head, 0, head.total(), Marks::MALFORMED))
}

/// A frame that ends within its head.
fn cut_head(rest: &[u8], fill: usize, room: usize, bounded: bool) -> Option<Found> {
    let delimiter = Delimiter::new(*rest.first()?)?;
    (bounded && fill >= SYNC && room < 11).then(|| Found {
        len: fill.saturating_add(room),
        unit: 0,
        function: 0,
        role: role(delimiter),
        marks: Marks::TRUNCATED,
        transaction: 0,
    })
}

/// A request that waits for its answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Open {
    address: Address,
    primary: bool,
    command: u8,
    extended: Option<u16>,
    index: u32,
}

/// What a line remembers: the request that waits, and what the last frame looked like.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    open: Option<Open>,
    last: Option<u64>,
}

impl Line {
    pub(crate) const fn new() -> Self {
        Self {
            open: None,
            last: None,
        }
    }

    /// Notes a sound request, or finds the request of a response. The second is true if the frame
    /// before it was the same request.
    pub(crate) fn settle(&mut self, bytes: &[u8], index: u32) -> (Option<u32>, bool) {
        let frame = bytes.get(preamble(bytes)..).unwrap_or(&[]);
        let Some(head) = Head::of(frame) else {
            return (None, false);
        };
        let look = Some(fingerprint(frame));
        let again = self.last == look && head.delimiter.kind() == Type::Stx;
        self.last = look;
        let number = extended(&head, frame);
        match head.delimiter.kind() {
            Type::Stx => {
                self.open = Some(Open {
                    address: head.address,
                    primary: head.primary,
                    command: head.command,
                    extended: number,
                    index,
                });
                (None, again)
            }
            Type::Ack => {
                let answers = |o: &Open| {
                    // Whoever answers a broadcast has an address of its own.
                    let same = o.address == head.address || o.address == Address::BROADCAST;
                    // A refusal may leave the extended number out.
                    let number = number.is_none() || o.extended == number;
                    same && number && o.primary == head.primary && o.command == head.command
                };
                let open = self.open.take_if(|o| answers(o));
                (open.map(|o| o.index), false)
            }
            Type::Back => (None, false),
        }
    }
}

/// A number that differs for different frames, for all practical purposes (FNV-1a, 64 bits).
fn fingerprint(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}
