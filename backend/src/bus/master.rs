//! The master of a serial line: one request at a time, silence before each, and no answer taken
//! that could belong to another request.

use super::alarm::Alarm;
use super::answer::{Asked, find};
use super::tap::Tap;
use super::timing::Timing;
use super::{Answer, Fault};
use shared::encode;
use shared::frame::Framing;
use std::fmt::Debug;
use std::io;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::time::{Instant, timeout};

/// Any stream of bytes with a device at the other end.
pub trait Stream: AsyncRead + AsyncWrite + Send + Unpin + Debug {}
impl<T: AsyncRead + AsyncWrite + Send + Unpin + Debug> Stream for T {}

/// Bytes that may come while an answer is waited for; more is a line that is never silent.
const MAX_HEARD: usize = 2048;
/// How long a line that is never silent is waited for.
const PATIENCE: Duration = Duration::from_secs(2);

/// Modbus RTU or ASCII over a stream of bytes.
#[derive(Debug)]
pub struct Master {
    tap: Tap<Box<dyn Stream>>,
    alarm: Alarm,
    framing: Framing,
    timing: Timing,
    /// When the last byte passed, in either direction.
    last: Instant,
    /// When bytes last came that nobody waited for.
    stray: Option<Instant>,
    /// This line repeats what we send.
    echoes: bool,
    heard: Vec<u8>,
}

/// What one request was and may bring.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Unit address.
    pub unit: u8,
    /// The PDU.
    pub pdu: &'a [u8],
    /// Length of a good response PDU.
    pub response_len: usize,
}

impl Master {
    /// A master of a line that was just opened.
    #[must_use]
    pub fn new(tap: Tap<Box<dyn Stream>>, framing: Framing, timing: Timing, alarm: Alarm) -> Self {
        Self {
            tap,
            alarm,
            framing,
            timing,
            last: Instant::now(),
            stray: None,
            echoes: false,
            heard: Vec::with_capacity(512),
        }
    }

    /// When bytes last came that nobody waited for.
    #[must_use]
    pub const fn stray(&self) -> Option<Instant> {
        self.stray
    }

    /// When the last byte passed, in either direction.
    #[must_use]
    pub const fn last(&self) -> Instant {
        self.last
    }

    /// From now on devices may take so long to begin their answers.
    pub fn set_timeout(&mut self, timeout: Duration) {
        self.timing.timeout = timeout;
    }

    /// Another port of the same cable was busy until then: this one keeps the same silence.
    pub fn busy_until(&mut self, moment: Instant) {
        self.last = self.last.max(moment);
    }

    /// Listens while there is nothing to ask. Ends only if the line is lost. Safe to cancel.
    pub async fn listen(&mut self) -> io::Error {
        loop {
            let quiet_at = self.last + self.timing.gap;
            let mut bytes = [0; 256];
            let read = if Instant::now() < quiet_at {
                let Some(read) = self.read_until(quiet_at, &mut bytes).await else {
                    self.tap.recorder().silence();
                    continue;
                };
                read
            } else {
                self.tap.read(&mut bytes).await
            };
            match read {
                Ok(0) => return gone(),
                Ok(_) => self.strayed(),
                Err(error) => return error,
            }
        }
    }

    /// Sends a request and waits for its answer.
    ///
    /// # Errors
    /// If none came, if what came is not sound, or if the line is lost.
    pub async fn exchange(&mut self, request: Request<'_>) -> Result<Answer, Fault> {
        self.settle().await?;
        let frame = encode::frame(self.framing, 0, request.unit, request.pdu);
        let sending = self.timing.characters(frame.len());
        // No flush: it would block until the last bit is out.
        let write = self.tap.write_all(&frame);
        match timeout(sending + PATIENCE, write).await {
            Ok(written) => written?,
            Err(_) => return Err(io::Error::from(io::ErrorKind::TimedOut).into()),
        }
        let sent = Instant::now() + sending;
        self.last = sent;
        self.heard.clear();
        let asked = Asked {
            framing: self.framing,
            unit: request.unit,
            request: &frame,
            pdu: request.pdu,
            response_len: request.response_len,
        };
        let verdict = self.receive(&asked, sent).await;
        // Whoever asks again waits for silence anyway.
        if self.last + self.timing.gap <= Instant::now() {
            self.tap.recorder().silence();
        }
        verdict
    }

    /// Waits until the line has been silent long enough, and discards what comes meanwhile.
    async fn settle(&mut self) -> Result<(), Fault> {
        let limit = Instant::now() + PATIENCE;
        loop {
            let quiet_at = self.last + self.timing.turnaround;
            let mut bytes = [0; 256];
            // Bytes that are there already are read even if the silence is over.
            match self.read_until(quiet_at, &mut bytes).await {
                None => break,
                Some(Ok(0)) => return Err(gone().into()),
                Some(Ok(_)) => self.strayed(),
                Some(Err(error)) => return Err(error.into()),
            }
            if Instant::now() > limit {
                return Err(Fault::Damaged("the line is never silent".into()));
            }
        }
        self.tap.recorder().silence();
        Ok(())
    }

    /// Reads what comes until a moment; `None` if nothing came. What is there already is read even
    /// if the moment has passed. Safe to cancel.
    async fn read_until(&mut self, at: Instant, bytes: &mut [u8]) -> Option<io::Result<usize>> {
        tokio::select! {
            biased;
            read = self.tap.read(bytes) => Some(read),
            () = self.alarm.until(at) => None,
        }
    }

    fn strayed(&mut self) {
        let now = Instant::now();
        self.last = now;
        self.stray = Some(now);
    }

    /// Reads until the answer is there and the line is silent behind it, or until it is too late.
    async fn receive(&mut self, asked: &Asked<'_>, sent: Instant) -> Result<Answer, Fault> {
        let long = match self.framing {
            Framing::Ascii => 2 * asked.response_len + 7,
            _ => asked.response_len + 3,
        };
        let late = sent + self.timing.timeout;
        let too_late = late + self.timing.characters(long) * 2 + self.timing.stall;
        loop {
            let found = find(asked, &self.heard, self.echoes);
            self.echoes |= found.echo;
            let silence = if found.answer.is_some() || found.complete {
                Some(self.timing.gap)
            } else if found.begun {
                Some(self.timing.stall)
            } else {
                None
            };
            let until = match silence {
                // Once an answer has begun it may take its time, but not for ever.
                Some(silence) => (self.last.max(sent) + silence).min(too_late),
                None => late,
            };
            let mut bytes = [0; 512];
            match self.read_until(until, &mut bytes).await {
                Some(Ok(0)) => return Err(gone().into()),
                Some(Ok(count)) => {
                    self.last = Instant::now();
                    self.heard
                        .extend_from_slice(bytes.get(..count).unwrap_or(&[]));
                    if self.heard.len() > MAX_HEARD {
                        self.strayed();
                        return Err(Fault::Damaged("bytes came without an end".into()));
                    }
                    continue;
                }
                Some(Err(error)) => return Err(error.into()),
                None => {}
            }
            if found.strays > 0 {
                self.stray = Some(self.last);
            }
            return match found.answer {
                Some(_) if found.two => Err(Fault::Two),
                Some(pdu) => Ok(Answer {
                    pdu,
                    latency: self.last.saturating_duration_since(sent),
                }),
                None if found.begun => Err(Fault::Damaged(self.describe(asked))),
                None if self.is_silent(asked) => Err(Fault::Silence),
                None => Err(Fault::Noise(self.describe(asked))),
            };
        }
    }

    /// True if nothing came but our own request.
    fn is_silent(&self, asked: &Asked<'_>) -> bool {
        self.heard.is_empty() || (self.echoes && self.heard == asked.request)
    }

    /// What came, in words.
    fn describe(&self, asked: &Asked<'_>) -> String {
        let heard = self
            .heard
            .strip_prefix(asked.request)
            .unwrap_or(&self.heard);
        let shown = heard.get(..12).unwrap_or(heard);
        let more = if heard.len() > shown.len() {
            " …"
        } else {
            ""
        };
        format!(
            "{} bytes came that are no sound answer: {}{more}",
            heard.len(),
            shared::render::Spaced(shown)
        )
    }
}

/// The other end of the stream is gone.
fn gone() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "the line was closed")
}
