//! A stream of captures to frames: one session per bus, in the browser, the backend and the
//! command line alike.
//!
//! The session keeps the bytes of what it found until told to forget, so that memory stays bounded
//! however long the stream is.

use std::collections::VecDeque;

use crate::capture::{Capture, Direction, Micros};
use crate::decode::{Context, decode_into};
use crate::frame::{Frame, Framing, Scanner};
use crate::tree::Decoded;

/// When and which way the bytes from an offset on went.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: u64,
    at: Option<Micros>,
    direction: Direction,
}

/// Finds, keeps and decodes the frames of one stream.
#[derive(Clone, Debug)]
pub struct Session {
    scanner: Scanner,
    /// Bytes from stream offset `base` on.
    store: Vec<u8>,
    base: u64,
    /// How far the scanner has come.
    done: u64,
    frames: VecDeque<Frame>,
    /// Index of the first frame kept.
    first: u32,
    stretches: VecDeque<Stretch>,
    direction: Direction,
}

impl Session {
    /// A session at the start of a stream.
    #[must_use]
    pub fn new(framing: Framing) -> Self {
        Self {
            scanner: Scanner::new(framing),
            store: Vec::new(),
            base: 0,
            done: 0,
            frames: VecDeque::new(),
            first: 0,
            stretches: VecDeque::new(),
            direction: Direction::Unknown,
        }
    }

    /// The framing that is looked for.
    #[must_use]
    pub const fn framing(&self) -> Framing {
        self.scanner.framing()
    }

    /// Takes bytes in. Frames that are certain by now are found; the rest waits for more bytes, a
    /// silence, a change of direction, or [`finish`](Self::finish).
    pub fn push(&mut self, capture: &Capture<'_>) {
        if capture.direction != self.direction {
            self.silence();
            self.direction = capture.direction;
        }
        self.stretches.push_back(Stretch {
            from: self.end(),
            at: capture.at,
            direction: capture.direction,
        });
        self.store.extend_from_slice(capture.bytes);
        self.find(capture.ends);
        if capture.ends {
            self.scanner.silence();
        }
    }

    /// The line was silent: no frame goes on from here.
    pub fn silence(&mut self) {
        self.find(true);
        self.scanner.silence();
    }

    /// The stream is at its end.
    pub fn finish(&mut self) {
        self.find(true);
    }

    fn find(&mut self, at_end: bool) {
        loop {
            let at = usize::try_from(self.done.saturating_sub(self.base)).unwrap_or(usize::MAX);
            let rest = self.store.get(at..).unwrap_or(&[]);
            let Some(frame) = self.scanner.next(rest, self.done, at_end, self.direction) else {
                return;
            };
            self.done = frame.end();
            self.append(frame);
        }
    }

    fn append(&mut self, frame: Frame) {
        if let (true, Some(last)) = (frame.is_noise(), self.frames.back_mut())
            && last.is_noise()
        {
            last.len = last.len.saturating_add(frame.len);
            self.scanner.uncount();
            return;
        }
        let index = self.len();
        if let Some(request) = frame.pair().and_then(|r| self.slot(r)) {
            request.set_pair(index);
        }
        self.frames.push_back(frame);
    }

    /// Number of entries found so far, forgotten ones included: the next one gets this index.
    #[must_use]
    pub fn len(&self) -> u32 {
        self.first
            .saturating_add(u32::try_from(self.frames.len()).unwrap_or(u32::MAX))
    }

    /// True if nothing was found yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Index of the first entry that is still kept.
    #[must_use]
    pub const fn first(&self) -> u32 {
        self.first
    }

    /// Stream offset behind the last byte taken in.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.base
            .saturating_add(u64::try_from(self.store.len()).unwrap_or(u64::MAX))
    }

    /// One entry of the index.
    #[must_use]
    pub fn frame(&self, index: u32) -> Option<&Frame> {
        self.frames
            .get(usize::try_from(index.checked_sub(self.first)?).ok()?)
    }

    fn slot(&mut self, index: u32) -> Option<&mut Frame> {
        self.frames
            .get_mut(usize::try_from(index.checked_sub(self.first)?).ok()?)
    }

    /// The bytes of an entry.
    #[must_use]
    pub fn bytes(&self, index: u32) -> Option<&[u8]> {
        let frame = self.frame(index)?;
        self.bytes_from(frame.offset)?
            .get(..usize::try_from(frame.len).ok()?)
    }

    fn bytes_from(&self, offset: u64) -> Option<&[u8]> {
        self.store
            .get(usize::try_from(offset.checked_sub(self.base)?).ok()?..)
    }

    /// When the capture with the first byte of an entry arrived.
    #[must_use]
    pub fn at(&self, index: u32) -> Option<Micros> {
        self.stretch(index)?.at
    }

    /// Which way an entry went.
    #[must_use]
    pub fn direction(&self, index: u32) -> Direction {
        self.stretch(index)
            .map_or(Direction::Unknown, |s| s.direction)
    }

    fn stretch(&self, index: u32) -> Option<&Stretch> {
        let offset = self.frame(index)?.offset;
        let after = self.stretches.partition_point(|s| s.from <= offset);
        self.stretches.get(after.checked_sub(1)?)
    }

    /// Decodes an entry with its request, if that is known, into `out`. False if there is no such
    /// entry (any more).
    pub fn decode(&self, index: u32, context: &Context, out: &mut Decoded) -> bool {
        let (Some(frame), Some(bytes)) = (self.frame(index), self.bytes(index)) else {
            return false;
        };
        let request = frame
            .pair()
            .filter(|r| *r < index)
            .and_then(|r| self.bytes(r));
        decode_into(frame, bytes, request, context, out);
        true
    }

    /// Drops the entries before `index` and their bytes. Their indices stay taken.
    pub fn forget_before(&mut self, index: u32) {
        while self.first < index && self.frames.pop_front().is_some() {
            self.first = self.first.saturating_add(1);
        }
        let keep = self.frames.front().map_or(self.done, |f| f.offset);
        let drop = usize::try_from(keep.saturating_sub(self.base)).unwrap_or(0);
        // Moving the rest costs; wait until it is worth it.
        if drop.saturating_mul(2) >= self.store.len() {
            self.store.drain(..drop.min(self.store.len()));
            self.base = keep;
            while self.stretches.get(1).is_some_and(|s| s.from <= keep) {
                self.stretches.pop_front();
            }
        }
    }
}
