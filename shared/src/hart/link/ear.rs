//! Frames among what is heard, as it comes, with the times that arbitration needs.

use super::timing::Timing;
use crate::capture::Micros;
use crate::hart::frame::{Delimiter, FILL, Head, MOST_FILL, SYNC, check, preamble};

/// A frame that was heard, or what was none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// A sound frame.
    Frame(Frame),
    /// A frame began, and did not end well.
    Damaged {
        /// When its first byte was delivered.
        began: Micros,
    },
    /// Bytes that belong to no frame.
    Noise,
}

/// A sound frame from delimiter to check byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    pub bytes: Vec<u8>,
    pub head: Head,
    /// When the first byte of its preamble was delivered.
    pub began: Micros,
    /// When its check byte ended on the line, as far as can be told.
    pub ended: Micros,
}

/// What was delivered and is not settled yet.
#[derive(Clone, Debug)]
pub(super) struct Ear {
    timing: Timing,
    bytes: Vec<u8>,
    /// When each of them was delivered, and how many came behind it in the same batch.
    times: Vec<(Micros, usize)>,
    last: Option<Micros>,
}

impl Ear {
    pub fn new(timing: Timing) -> Self {
        Self {
            timing,
            bytes: Vec::new(),
            times: Vec::new(),
            last: None,
        }
    }

    /// True while something stands open that may become a frame.
    pub const fn is_open(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// When what stands open is over if nothing more comes.
    pub fn quiet_at(&self) -> Option<Micros> {
        let last = self.last.filter(|_| self.is_open())?;
        Some(last.plus(self.timing.gap).plus(self.timing.character))
    }

    /// Bytes were delivered, the last of them now.
    pub fn hear(&mut self, bytes: &[u8], now: Micros, out: &mut Vec<Heard>) {
        if let Some(last) = self.last.replace(now) {
            let silent = now
                .since(last)
                .saturating_sub(self.timing.characters(bytes.len()));
            if silent > self.timing.gap {
                self.settle(true, out);
            }
        }
        let behind = (0..bytes.len()).rev();
        self.times.extend(behind.map(|count| (now, count)));
        self.bytes.extend_from_slice(bytes);
        self.settle(false, out);
    }

    /// Ends what stands open once the silence is long enough.
    pub fn listen(&mut self, now: Micros, out: &mut Vec<Heard>) {
        if self.quiet_at().is_some_and(|at| at <= now) {
            self.settle(true, out);
        }
    }

    /// Takes frames from the front; `over` if nothing more belongs to them.
    fn settle(&mut self, over: bool, out: &mut Vec<Heard>) {
        while let Some(step) = self.step(over) {
            let (count, heard) = step;
            self.bytes.drain(..count.min(self.bytes.len()));
            self.times.drain(..count.min(self.times.len()));
            out.extend(heard);
        }
    }

    /// How many bytes are settled, and what they are; `None` if more have to come.
    fn step(&self, over: bool) -> Option<(usize, Option<Heard>)> {
        let bytes = self.bytes.as_slice();
        if bytes.is_empty() {
            return None;
        }
        let start = sync(bytes);
        if start > 0 {
            let last = bytes.last() == Some(&FILL) && start == bytes.len();
            // The last byte may be the first of a preamble.
            let keep = usize::from(last && !over);
            let count = start.saturating_sub(keep);
            return (count > 0).then_some((count, Some(Heard::Noise)));
        }
        let fill = preamble(bytes);
        if fill > MOST_FILL {
            return Some((fill.saturating_sub(MOST_FILL), None));
        }
        let rest = bytes.get(fill..).unwrap_or(&[]);
        let began = self.times.first().map_or(Micros::new(0), |t| t.0);
        let Some(first) = rest.first() else {
            return over.then_some((fill, Some(Heard::Damaged { began })));
        };
        if Delimiter::new(*first).is_none() {
            return Some((fill.saturating_add(1), Some(Heard::Damaged { began })));
        }
        let whole = Head::of(rest).and_then(|head| Some((head, rest.get(..head.total())?)));
        let Some((head, frame)) = whole else {
            let hopeless = Head::of(rest).is_some_and(|h| !h.is_possible());
            let bad = Heard::Damaged { began };
            return (over || hopeless).then(|| (self.next_sync(fill, bytes.len()), Some(bad)));
        };
        let end = fill.saturating_add(frame.len());
        if check(frame) != 0 || !head.is_possible() {
            return Some((self.next_sync(fill, end), Some(Heard::Damaged { began })));
        }
        let (delivered, behind) = self
            .times
            .get(end.saturating_sub(1))
            .copied()
            .unwrap_or((began, 0));
        let ended = delivered
            .get()
            .saturating_sub(self.timing.characters(behind));
        let heard = Heard::Frame(Frame {
            bytes: frame.to_vec(),
            head,
            began,
            ended: Micros::new(ended),
        });
        Some((end, Some(heard)))
    }

    /// Where the next preamble begins within a damaged frame, else where the frame ends.
    fn next_sync(&self, fill: usize, end: usize) -> usize {
        let inner = self.bytes.get(fill..end).unwrap_or(&[]);
        fill.saturating_add(sync(inner)).max(1)
    }
}

/// Where two preamble bytes stand side by side, else the length.
fn sync(bytes: &[u8]) -> usize {
    bytes
        .windows(SYNC)
        .position(|pair| pair.iter().all(|b| *b == FILL))
        .unwrap_or(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::super::timing::BAUD;
    use super::*;

    const REQUEST: [u8; 9] = [0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x03, 0x00, 0x95];
    const REPLY: [u8; 12] = [
        0x86, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x23, 0x02, 0x40, 0x40, 0xB3, 0x00,
    ];

    fn with(fill: usize, frame: &[u8]) -> Vec<u8> {
        [vec![FILL; fill], frame.to_vec()].concat()
    }

    /// Hears bytes one by one at line speed from a moment, then a silence.
    fn hear(ear: &mut Ear, bytes: &[u8], from: u64) -> (Vec<Heard>, u64) {
        let (mut out, mut now) = (Vec::new(), from);
        for byte in bytes {
            now += ear.timing.character;
            ear.hear(&[*byte], Micros::new(now), &mut out);
        }
        ear.listen(Micros::new(now + 30_000), &mut out);
        (out, now)
    }

    fn frames<'a>(heard: &'a [Heard]) -> Vec<&'a [u8]> {
        let frame = |h: &'a Heard| match h {
            Heard::Frame(f) => Some(f.bytes.as_slice()),
            _ => None,
        };
        heard.iter().filter_map(frame).collect()
    }

    #[test]
    fn a_frame_is_heard_with_its_times() {
        let mut ear = Ear::new(Timing::new(BAUD, None));
        let (heard, end) = hear(&mut ear, &with(5, &REQUEST), 1000);
        let [Heard::Frame(frame)] = heard.as_slice() else {
            panic!("{heard:?}");
        };
        assert_eq!(frame.bytes, REQUEST);
        assert_eq!(frame.began, Micros::new(1000 + ear.timing.character));
        assert_eq!(frame.ended, Micros::new(end));
        assert!(!ear.is_open());
    }

    #[test]
    fn frames_of_one_batch_end_one_after_the_other() {
        let mut ear = Ear::new(Timing::new(BAUD, Some(50_000)));
        let mut out = Vec::new();
        let both = [with(5, &REQUEST), with(5, &REPLY[..11])].concat();
        ear.hear(&both, Micros::new(1_000_000), &mut out);
        let [Heard::Frame(one), Heard::Frame(two)] = out.as_slice() else {
            panic!("{out:?}");
        };
        assert_eq!(two.ended, Micros::new(1_000_000));
        assert_eq!(two.ended.since(one.ended), ear.timing.characters(16));
    }

    #[test]
    fn preambles_may_be_eaten_or_be_very_long() {
        for fill in [2, 3, 20, 40, 300] {
            let mut ear = Ear::new(Timing::new(BAUD, None));
            let (heard, _) = hear(&mut ear, &with(fill, &REQUEST), 0);
            assert_eq!(frames(&heard), [&REQUEST[..]], "{fill}");
        }
        let mut ear = Ear::new(Timing::new(BAUD, None));
        let (heard, _) = hear(&mut ear, &with(1, &REQUEST), 0);
        assert!(frames(&heard).is_empty());
    }

    #[test]
    fn noise_before_and_behind_does_not_hide_a_frame() {
        for noise in [
            &[0x00][..],
            &[0xFF],
            &[0x55, 0xFF, 0x00],
            &[0xFF, 0xFF, 0x33],
        ] {
            let mut ear = Ear::new(Timing::new(BAUD, None));
            let bytes = [noise, &with(5, &REQUEST), noise].concat();
            let (heard, _) = hear(&mut ear, &bytes, 0);
            assert_eq!(frames(&heard), [&REQUEST[..]], "{noise:?}");
            assert!(!ear.is_open(), "{noise:?}");
        }
    }

    #[test]
    fn a_damaged_frame_does_not_hide_the_next() {
        for at in 0..REQUEST.len() {
            for bit in 0..8 {
                let mut bad = REQUEST;
                bad[at] ^= 1 << bit;
                let bytes = [with(5, &bad), with(5, &REPLY[..11])].concat();
                let mut ear = Ear::new(Timing::new(BAUD, None));
                let (heard, _) = hear(&mut ear, &bytes, 0);
                // A count that grew may swallow what follows; then nothing false comes of it.
                let swallowed = at == 7 || (at == 0 && bit >= 5);
                let frames = frames(&heard);
                assert!(frames.iter().all(|f| *f == &REPLY[..11]), "{at} {bit}");
                assert!(frames.len() == 1 || swallowed, "{at} {bit} {heard:?}");
                assert!(heard.iter().any(|h| matches!(h, Heard::Damaged { .. })));
            }
        }
    }

    #[test]
    fn a_gap_breaks_a_frame_off() {
        let mut ear = Ear::new(Timing::new(BAUD, None));
        let bytes = with(5, &REQUEST);
        let (character, mut out) = (ear.timing.character, Vec::new());
        for (count, byte) in (1_u64..).zip(&bytes) {
            let late = if count > 8 { character * 2 } else { 0 };
            ear.hear(&[*byte], Micros::new(character * count + late), &mut out);
        }
        ear.listen(Micros::new(1_000_000), &mut out);
        assert!(frames(&out).is_empty(), "{out:?}");
        // A port that delivers in batches may pause.
        let mut ear = Ear::new(Timing::new(BAUD, Some(25_000)));
        let mut out = Vec::new();
        ear.hear(&bytes[..8], Micros::new(100_000), &mut out);
        ear.hear(
            &bytes[8..],
            Micros::new(100_000 + character * 6 + 20_000),
            &mut out,
        );
        assert_eq!(frames(&out).len(), 1);
    }
}
