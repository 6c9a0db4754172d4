//! A serial HART line: drives the link layer with the bytes, the carrier and the time of a port.

use super::super::alarm::Alarm;
use super::super::master::Stream;
use super::super::tap::{Keyed, Tap};
use crate::clock::Clock;
use crate::config::hart::Keying;
use shared::capture::Micros;
use shared::hart::link::{Done, Link, Next, Request, Setup};
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, ReadBuf};
use tokio::time::timeout;
use tokio_serial::{SerialPort, SerialStream};

/// How long a port may take beyond the time of the characters.
const PATIENCE: Duration = Duration::from_secs(2);

/// What carries the bytes of a line.
#[derive(Debug)]
pub enum Port {
    /// A serial port, whose RTS switches the carrier of the modem.
    Serial(SerialStream),
    /// Anything else.
    Other(Box<dyn Stream>),
}

impl Keyed for Port {
    /// Switches the carrier. Ports without modem lines, as pseudo terminals, do without.
    fn key(&mut self, on: bool) {
        if let Self::Serial(port) = self
            && let Err(error) = port.write_request_to_send(on)
        {
            tracing::debug!("RTS: {error}");
        }
    }
}

impl Port {
    fn inner(&mut self) -> Pin<&mut dyn Stream> {
        match self {
            Self::Serial(port) => Pin::new(port),
            Self::Other(stream) => Pin::new(stream.as_mut()),
        }
    }
}

impl AsyncRead for Port {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.inner().poll_read(cx, into)
    }
}

impl AsyncWrite for Port {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.inner().poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.inner().poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.inner().poll_shutdown(cx)
    }
}

/// A master on a serial line.
#[derive(Debug)]
pub struct SerialLine {
    tap: Tap<Port>,
    link: Link,
    keying: Keying,
    clock: Clock,
    alarm: Alarm,
    /// When the last bit of what we send is out.
    sending: Option<Micros>,
    /// When bytes last came of which the record does not know yet whether a silence followed.
    heard: Option<Micros>,
}

impl SerialLine {
    /// A master of a line that was just opened.
    #[must_use]
    pub fn new(
        mut tap: Tap<Port>,
        setup: Setup,
        keying: Keying,
        clock: Clock,
        alarm: Alarm,
    ) -> Self {
        tap.key(false);
        Self {
            tap,
            link: Link::new(setup, clock.now()),
            keying,
            clock,
            alarm,
            sending: None,
            heard: None,
        }
    }

    /// Who else is on the line, and how its traffic goes.
    #[must_use]
    pub const fn link(&self) -> &Link {
        &self.link
    }

    /// Listens while there is nothing to ask, until something was heard. Safe to cancel.
    ///
    /// # Errors
    /// If the line is lost.
    pub async fn listen(&mut self) -> io::Result<()> {
        loop {
            let before = self.link.stats().to_owned();
            self.step().await?;
            if *self.link.stats() != before {
                return Ok(());
            }
        }
    }

    /// Sends a request and waits for its outcome.
    ///
    /// # Errors
    /// If the line is lost, or if the request may not be sent.
    pub async fn exchange(&mut self, request: Request) -> io::Result<Done> {
        if self.link.ask(request, self.clock.now()).is_err() {
            return Err(io::Error::other("the line is busy with another request"));
        }
        loop {
            if let Some(done) = self.link.done() {
                return Ok(done);
            }
            self.step().await?;
        }
    }

    /// Does what is due, or waits until something is. Safe to cancel while nothing is asked.
    async fn step(&mut self) -> io::Result<()> {
        while self.link.event().is_some() {}
        let now = self.clock.now();
        let quiet_at = self.heard.map(|at| at.plus(self.link.setup().timing.gap));
        if quiet_at.is_some_and(|at| at <= now) {
            self.heard = None;
            self.tap.recorder().silence();
            return Ok(());
        }
        let wake = match self.sending {
            Some(until) if until <= now => {
                self.sending = None;
                self.tap.key(false);
                self.link.sent(until);
                return Ok(());
            }
            Some(until) => Some(until),
            None => match self.link.next(now) {
                Next::Transmit(bytes) => return self.transmit(&bytes).await,
                Next::Wait(at) if at <= now => return Ok(()),
                Next::Wait(at) => Some(at),
                Next::Idle if self.link.is_busy() => return Ok(()),
                Next::Idle => None,
            },
        };
        let wake = [wake, quiet_at].into_iter().flatten().min();
        // Without anything to wait for, a day is as good as for ever.
        let wake = wake.unwrap_or_else(|| now.plus(86_400_000_000));
        let mut bytes = [0; 512];
        let read = tokio::select! {
            biased;
            read = self.tap.read(&mut bytes) => read?,
            () = self.alarm.until(self.clock.moment(wake)) => return Ok(()),
        };
        if read == 0 {
            return Err(io::Error::from(io::ErrorKind::UnexpectedEof));
        }
        let now = self.clock.now();
        self.heard = Some(now);
        self.link.heard(bytes.get(..read).unwrap_or(&[]), now);
        Ok(())
    }

    async fn transmit(&mut self, bytes: &[u8]) -> io::Result<()> {
        let timing = self.link.setup().timing;
        let sending = Duration::from_micros(timing.characters(bytes.len()));
        self.tap.key(true);
        if !self.keying.lead.is_zero() {
            tokio::time::sleep(self.keying.lead).await;
        }
        // No flush: it would block until the last bit is out.
        match timeout(sending + PATIENCE, self.tap.write_all(bytes)).await {
            Ok(written) => written?,
            Err(_) => return Err(io::ErrorKind::TimedOut.into()),
        }
        let out = self.clock.now().plus(timing.characters(bytes.len()));
        let tail = u64::try_from(self.keying.tail.as_micros()).unwrap_or(0);
        self.sending = Some(out.plus(tail));
        Ok(())
    }
}

impl Drop for SerialLine {
    /// Nobody else could speak while our carrier is on.
    fn drop(&mut self) {
        self.tap.key(false);
    }
}
