//! What was on a line: every byte with its direction and time, the last of it kept.
//!
//! The ring is also the queue of every client: each remembers how far it has come and takes what
//! follows. A client that is too slow finds that what it wanted is gone, and is told how much.

use crate::clock::Clock;
use axum::extract::ws::Utf8Bytes;
use shared::capture::Micros;
use shared::proto::{ToPage, Way};
use shared::render::hex;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// Captures that are kept.
const MAX_KEPT: usize = 4096;
/// Bytes of memory that they may take.
const MAX_BYTES: usize = 1024 * 1024;
/// A run of bytes without a silence is passed on in parts of this size.
const MAX_RUN: usize = 512;

/// Records one line. Clones record the same line.
#[derive(Clone, Debug)]
pub struct Recorder {
    bus: Arc<str>,
    clock: Clock,
    ring: Arc<Mutex<Ring>>,
    activity: watch::Sender<u64>,
    whole: Option<Whole>,
}

/// The recorder of a network with several ports, and whether this port is the one that is driven.
#[derive(Clone, Debug)]
struct Whole {
    recorder: Box<Recorder>,
    driven: Arc<AtomicBool>,
}

#[derive(Debug, Default)]
struct Ring {
    /// Messages to pages, encoded once for all of them.
    kept: VecDeque<Utf8Bytes>,
    bytes: usize,
    /// Sequence number of the last capture; 0 before the first.
    last: u64,
    /// Bytes received of which it is not known yet whether a silence follows.
    pending: Vec<u8>,
    pending_at: Micros,
}

/// What a client gets next.
#[derive(Debug, Default)]
pub struct Pulled {
    /// Captures that are gone.
    pub missed: u64,
    /// Captures, ready to send.
    pub messages: Vec<Utf8Bytes>,
    /// Sequence number of the last of them; ask for what comes after it.
    pub last: u64,
}

impl Recorder {
    /// A recorder of a line of which nothing was heard yet. `activity` is told of every capture.
    #[must_use]
    pub fn new(bus: &str, clock: Clock, activity: watch::Sender<u64>) -> Self {
        Self {
            bus: bus.into(),
            clock,
            ring: Arc::default(),
            activity,
            whole: None,
        }
    }

    /// A recorder of one port of a network whose master drives one port at a time. While `driven`
    /// is true, what passes is recorded for the network as well; what only comes round the cable is
    /// not.
    #[must_use]
    pub fn of_port(&self, name: &str, driven: Arc<AtomicBool>) -> Self {
        Self {
            whole: Some(Whole {
                recorder: Box::new(self.clone()),
                driven,
            }),
            ..Self::new(name, self.clock, self.activity.clone())
        }
    }

    /// The recorder of the network, if this port is driven.
    fn whole(&self) -> Option<&Self> {
        let whole = self.whole.as_ref()?;
        whole
            .driven
            .load(Ordering::Relaxed)
            .then_some(&*whole.recorder)
    }

    /// Bytes went out. `ends` is true if they complete a frame.
    pub fn sent(&self, bytes: &[u8], ends: bool) {
        if let Some(whole) = self.whole() {
            whole.sent(bytes, ends);
        }
        let now = self.clock.now();
        let mut ring = self.lock();
        self.close(&mut ring, false);
        self.keep(&mut ring, now, Way::Tx, ends, bytes);
    }

    /// Bytes came in.
    pub fn received(&self, bytes: &[u8]) {
        if let Some(whole) = self.whole() {
            whole.received(bytes);
        }
        let now = self.clock.now();
        let mut ring = self.lock();
        ring.pending.extend_from_slice(bytes);
        ring.pending_at = now;
        while ring.pending.len() > MAX_RUN {
            let rest = ring.pending.split_off(MAX_RUN);
            self.close(&mut ring, false);
            ring.pending = rest;
        }
    }

    /// The line has been silent since the last byte.
    pub fn silence(&self) {
        if let Some(whole) = self.whole() {
            whole.silence();
        }
        let mut ring = self.lock();
        self.close(&mut ring, true);
    }

    /// Takes up to `max` captures that come after number `after`.
    #[must_use]
    pub fn after(&self, after: u64, max: usize) -> Pulled {
        let ring = self.lock();
        let first = ring.last + 1 - u64::try_from(ring.kept.len()).unwrap_or(0);
        let from = (after + 1).max(first);
        let skip = usize::try_from(from - first).unwrap_or(usize::MAX);
        let messages: Vec<_> = ring.kept.iter().skip(skip).take(max).cloned().collect();
        Pulled {
            missed: from - (after + 1),
            last: from - 1 + u64::try_from(messages.len()).unwrap_or(0),
            messages,
        }
    }

    /// Sequence number of the last capture; 0 before the first.
    #[must_use]
    pub fn last(&self) -> u64 {
        self.lock().last
    }

    fn close(&self, ring: &mut Ring, ends: bool) {
        if ring.pending.is_empty() {
            return;
        }
        let bytes = std::mem::take(&mut ring.pending);
        let at = ring.pending_at;
        self.keep(ring, at, Way::Rx, ends, &bytes);
        ring.pending = bytes;
        ring.pending.clear();
    }

    fn keep(&self, ring: &mut Ring, at: Micros, way: Way, ends: bool, bytes: &[u8]) {
        ring.last += 1;
        let message = ToPage::Capture {
            bus: self.bus.as_ref().to_owned(),
            seq: ring.last,
            at_us: at.get(),
            way,
            ends,
            hex: hex(bytes),
        };
        let text = encode(&message);
        ring.bytes += text.len();
        ring.kept.push_back(text);
        while ring.kept.len() > MAX_KEPT || ring.bytes > MAX_BYTES {
            let Some(old) = ring.kept.pop_front() else {
                break;
            };
            ring.bytes -= old.len();
        }
        self.activity
            .send_modify(|count| *count = count.wrapping_add(1));
    }

    fn lock(&self) -> MutexGuard<'_, Ring> {
        // Nothing panics while it holds the lock; if something did, the ring is still a ring.
        self.ring.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A message as JSON text.
#[must_use]
pub fn encode(message: &ToPage) -> Utf8Bytes {
    // These types always have a JSON form.
    serde_json::to_string(message).unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorder() -> Recorder {
        Recorder::new("a", Clock::start(), watch::Sender::new(0))
    }

    fn captures(pulled: &Pulled) -> Vec<(u64, Way, bool, String)> {
        let parse = |text: &Utf8Bytes| match serde_json::from_str(text).unwrap() {
            ToPage::Capture {
                seq,
                way,
                ends,
                hex,
                ..
            } => (seq, way, ends, hex),
            other => panic!("{other:?}"),
        };
        pulled.messages.iter().map(parse).collect()
    }

    #[tokio::test]
    async fn bytes_are_joined_until_a_silence() {
        let recorder = recorder();
        recorder.sent(&[1, 3], true);
        recorder.received(&[1]);
        recorder.received(&[3]);
        assert_eq!(recorder.last(), 1);
        recorder.silence();
        recorder.silence();
        recorder.received(&[9]);
        recorder.sent(&[2], true);
        let all = captures(&recorder.after(0, 100));
        let hex: Vec<_> = all.iter().map(|c| (c.0, c.1, c.2, c.3.as_str())).collect();
        assert_eq!(
            hex,
            [
                (1, Way::Tx, true, "0103"),
                (2, Way::Rx, true, "0103"),
                (3, Way::Rx, false, "09"),
                (4, Way::Tx, true, "02"),
            ]
        );
    }

    #[tokio::test]
    async fn a_slow_client_is_told_what_it_missed() {
        let recorder = recorder();
        for _ in 0..5000 {
            recorder.sent(&[1], true);
        }
        let pulled = recorder.after(0, 10);
        assert_eq!(pulled.missed, 5000 - 4096);
        assert_eq!(pulled.messages.len(), 10);
        assert_eq!(captures(&pulled)[0].0, 5000 - 4096 + 1);
        let next = recorder.after(pulled.last, 10);
        assert_eq!((next.missed, captures(&next)[0].0), (0, pulled.last + 1));
        let none = recorder.after(5000, 10);
        assert_eq!((none.missed, none.messages.len(), none.last), (0, 0, 5000));
    }

    #[tokio::test]
    async fn a_network_records_what_passes_on_the_port_that_is_driven() {
        let network = recorder();
        let driven = [
            Arc::new(AtomicBool::new(true)),
            Arc::new(AtomicBool::new(false)),
        ];
        let one = network.of_port("a, port 1", Arc::clone(&driven[0]));
        let two = network.of_port("a, port 2", Arc::clone(&driven[1]));
        one.sent(&[1], true);
        // The same bytes come out of the other end of the loop.
        two.received(&[1]);
        two.silence();
        one.received(&[2]);
        two.received(&[2]);
        two.silence();
        one.silence();
        driven[0].store(false, Ordering::Relaxed);
        driven[1].store(true, Ordering::Relaxed);
        two.sent(&[3], true);
        let seen = |recorder: &Recorder| {
            let captures = captures(&recorder.after(0, 100)).into_iter();
            captures.map(|c| (c.1, c.3)).collect::<Vec<_>>()
        };
        let of = |way, hex: &str| (way, hex.to_owned());
        assert_eq!(
            seen(&network),
            [of(Way::Tx, "01"), of(Way::Rx, "02"), of(Way::Tx, "03")]
        );
        assert_eq!(seen(&one), [of(Way::Tx, "01"), of(Way::Rx, "02")]);
        assert_eq!(
            seen(&two),
            [of(Way::Rx, "01"), of(Way::Rx, "02"), of(Way::Tx, "03")]
        );
    }

    #[tokio::test]
    async fn memory_is_bounded_by_bytes_too() {
        let recorder = recorder();
        for _ in 0..3000 {
            recorder.sent(&[0; 512], true);
        }
        let ring = recorder.lock();
        assert!(ring.bytes <= MAX_BYTES && ring.kept.len() < 3000);
    }

    #[tokio::test]
    async fn endless_noise_is_passed_on() {
        let recorder = recorder();
        recorder.received(&[0; 3 * MAX_RUN]);
        assert_eq!(recorder.last(), 2);
    }
}
