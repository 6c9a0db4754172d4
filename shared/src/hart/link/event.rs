//! What a master hears besides its answers.

/// Something that was heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A frame of another master, of a device to another master, or a burst: from the delimiter to
    /// the check byte.
    Overheard(Vec<u8>),
    /// A reply to us that answers nothing we wait for.
    Stray(Vec<u8>),
    /// A request with our master bit that we did not send: a second master of our kind.
    Twin,
    /// A frame began and did not end well.
    Damaged,
}

/// How the traffic of a line went, counted since the link began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Requests that we sent, retries included.
    pub sent: u64,
    /// Good answers to them, whatever the response code.
    pub answered: u64,
    /// Requests sent again.
    pub retried: u64,
    /// Requests that nobody answered.
    pub silent: u64,
    /// Requests that a device received with errors.
    pub refused: u64,
    /// Damaged frames.
    pub damaged: u64,
    /// Replies to us that answered nothing.
    pub strays: u64,
    /// Frames between others.
    pub overheard: u64,
    /// Bursts.
    pub bursts: u64,
    /// Our own requests, heard back.
    pub echoes: u64,
    /// Runs of bytes that belong to no frame.
    pub noise: u64,
}
