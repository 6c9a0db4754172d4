//! The newest state of every line and device. Only the newest is kept: a client that is slow sees
//! fewer steps, never an old one.

use super::recorder::encode;
use axum::extract::ws::Utf8Bytes;
use shared::proto::ToPage;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::watch;

/// Where states are posted. Clones are the same board.
#[derive(Clone, Debug)]
pub struct Board {
    state: Arc<Mutex<State>>,
    activity: watch::Sender<u64>,
}

#[derive(Debug, Default)]
struct State {
    version: u64,
    slots: Vec<Slot>,
}

#[derive(Clone, Debug, Default)]
struct Slot {
    /// Version at which it was written; 0 if never.
    version: u64,
    text: Utf8Bytes,
}

impl Board {
    /// An empty board; `activity` is told of every change.
    #[must_use]
    pub fn new(activity: watch::Sender<u64>) -> Self {
        Self {
            state: Arc::default(),
            activity,
        }
    }

    /// A new place on the board.
    #[must_use]
    pub fn slot(&self) -> usize {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.slots.push(Slot::default());
        state.slots.len() - 1
    }

    /// Writes a state; the one before is gone.
    pub fn post(&self, slot: usize, message: &ToPage) {
        self.post_text(slot, encode(message));
    }

    /// The same for a message that is encoded already.
    pub fn post_text(&self, slot: usize, text: Utf8Bytes) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.version += 1;
        let version = state.version;
        if let Some(slot) = state.slots.get_mut(slot) {
            *slot = Slot { version, text };
        }
        drop(state);
        self.activity
            .send_modify(|count| *count = count.wrapping_add(1));
    }

    /// What changed after a version, and the version now.
    #[must_use]
    pub fn news(&self, after: u64) -> (Vec<Utf8Bytes>, u64) {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let mut new: Vec<&Slot> = state.slots.iter().filter(|s| s.version > after).collect();
        new.sort_unstable_by_key(|s| s.version);
        let texts = new.into_iter().map(|s| s.text.clone()).collect();
        (texts, state.version)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_newest_state_is_seen() {
        let board = Board::new(watch::Sender::new(0));
        let (a, b) = (board.slot(), board.slot());
        let tick = |now_us| ToPage::Tick { now_us };
        board.post(a, &tick(1));
        board.post(b, &tick(2));
        board.post(a, &tick(3));
        let (news, version) = board.news(0);
        let news: Vec<&str> = news.iter().map(Utf8Bytes::as_str).collect();
        assert_eq!(
            news,
            [r#"{"tick":{"now_us":2}}"#, r#"{"tick":{"now_us":3}}"#]
        );
        assert!(board.news(version).0.is_empty());
    }
}
