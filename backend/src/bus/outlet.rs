//! The way from an actor to a page, for the news of a program that the page hosts.

use axum::extract::ws::Utf8Bytes;
use shared::proto::News;
use tokio::sync::mpsc;

/// Room that a page must have before the next thing is read for it: what comes of it, and the end
/// of the job.
const ROOM: usize = 8;

/// The way to a page. It holds so much and no more; who takes nothing is waited for.
#[derive(Clone, Debug)]
pub struct Outlet(mpsc::Sender<Utf8Bytes>);

impl Outlet {
    /// Messages that wait for one page.
    pub const SIZE: usize = 64;

    /// The way to a page.
    #[must_use]
    pub const fn new(sender: mpsc::Sender<Utf8Bytes>) -> Self {
        Self(sender)
    }

    /// Sends what must not be lost. There is room, for it was asked for before; if the page is
    /// gone, nobody needs it.
    pub fn send(&self, news: impl News) {
        let _gone = self.0.try_send(news.into_text().into());
    }

    /// Sends what will be said again soon, if there is room.
    pub fn say(&self, news: impl News) {
        if self.has_room() {
            self.send(news);
        }
    }

    /// True if there is room for all that comes of one thing, or if nobody listens any more.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.0.is_closed() || self.0.capacity() >= ROOM
    }
}
