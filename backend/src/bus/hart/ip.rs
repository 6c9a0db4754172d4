//! A HART-IP client: one session with a gateway, over TCP or UDP.
//!
//! The gateway is the master of its lines; we hand it requests from delimiter to check byte and it
//! hands back replies. The sequence number of a message says which request a response answers, so a
//! late one meets nobody.

use super::super::gate::Gate;
use super::super::recorder::Recorder;
use super::super::tap::Tap;
use super::super::tcp;
use super::{Exchange, Fault};
use crate::clock::Clock;
use shared::frame::Framing;
use shared::hart::HART_IP_STATUS;
use shared::hart::ip::HEADER;
use shared::hart::link::{Failure, Request, Stats};
use std::io;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpStream, UdpSocket, lookup_host};
use tokio::time::{Instant, timeout_at};

/// A session in which nothing is said for so long may be closed by the gateway.
const INACTIVITY_MS: u32 = 60_000;
/// So often we say that we are still there.
const KEEP_ALIVE: Duration = Duration::from_secs(20);
/// Longest message that is taken.
const LONGEST: usize = 2048;
/// How long a gateway may take to open a session.
const OPENING: Duration = Duration::from_secs(5);

/// Message ids.
const INITIATE: u8 = 0;
const CLOSE: u8 = 1;
const ALIVE: u8 = 2;
const TOKEN_PASSING: u8 = 3;

/// How messages travel.
#[derive(Debug)]
enum Wire {
    Tcp(Tap<TcpStream>),
    Udp {
        socket: UdpSocket,
        gate: Gate,
        recorder: Recorder,
    },
}

/// A message of the gateway.
#[derive(Debug)]
struct Message {
    kind: u8,
    id: u8,
    status: u8,
    sequence: u16,
    body: Vec<u8>,
}

/// A session with a gateway.
#[derive(Debug)]
pub struct IpLine {
    wire: Wire,
    clock: Clock,
    retries: u8,
    timeout: Duration,
    primary: bool,
    sequence: u16,
    /// Bytes that are no whole message yet.
    heard: Vec<u8>,
    /// When we last said something.
    said: Instant,
    stats: Stats,
}

/// Where a gateway is and how it is spoken to.
#[derive(Clone, Copy, Debug)]
pub struct Gateway<'a> {
    /// Name or address with port.
    pub host: &'a str,
    /// UDP instead of TCP.
    pub udp: bool,
    /// As primary or secondary master.
    pub primary: bool,
    /// How long an answer may take.
    pub timeout: Duration,
    /// Tries beyond the first.
    pub retries: u8,
}

impl IpLine {
    /// Connects and opens a session.
    ///
    /// # Errors
    /// If the gateway can't be reached or refuses the session.
    pub async fn open(
        gateway: Gateway<'_>,
        gate: Gate,
        recorder: Recorder,
        clock: Clock,
    ) -> io::Result<Self> {
        let wire = if gateway.udp {
            Wire::Udp {
                socket: socket(gateway.host).await?,
                gate,
                recorder,
            }
        } else {
            let stream = tcp::connect(gateway.host).await?;
            Wire::Tcp(Tap::new(stream, Framing::HartIp, gate, recorder))
        };
        let mut line = Self {
            wire,
            clock,
            retries: gateway.retries,
            timeout: gateway.timeout,
            primary: gateway.primary,
            sequence: 0,
            heard: Vec::new(),
            said: Instant::now(),
            stats: Stats::default(),
        };
        let [a, b, c, d] = INACTIVITY_MS.to_be_bytes();
        let body = [u8::from(gateway.primary), a, b, c, d];
        // A datagram may be lost.
        for _ in 0..=gateway.retries {
            let sequence = line.say(INITIATE, &body).await?;
            let until = Instant::now() + OPENING.min(gateway.timeout);
            if let Some(message) = line.answer(INITIATE, sequence, until).await? {
                return match refusal(&message) {
                    Some(why) => Err(io::Error::other(format!("no session: {why}"))),
                    None => Ok(line),
                };
            }
        }
        let text = "it opens no HART-IP session; is it a HART-IP server?";
        Err(io::Error::other(text))
    }

    /// How the traffic goes.
    #[must_use]
    pub const fn stats(&self) -> &Stats {
        &self.stats
    }

    /// True if the gateway speaks for us as a primary master.
    #[must_use]
    pub const fn primary(&self) -> bool {
        self.primary
    }

    /// When a keep alive is due.
    #[must_use]
    pub fn due(&self) -> Instant {
        self.said + KEEP_ALIVE
    }

    /// Says that we are still there, if it is time to.
    ///
    /// # Errors
    /// If the connection is lost.
    pub async fn tend(&mut self) -> io::Result<()> {
        if self.due() <= Instant::now() {
            self.say(ALIVE, &[]).await?;
        }
        Ok(())
    }

    /// Ends the session, as well as that goes.
    pub async fn close(&mut self) {
        let _gone = self.say(CLOSE, &[]).await;
    }

    /// Takes what the gateway says unasked, until something was said or a keep alive is due. Safe to
    /// cancel.
    ///
    /// # Errors
    /// If the connection is lost.
    pub async fn listen(&mut self) -> io::Result<()> {
        if let Some(message) = self.message(self.due()).await? {
            self.overheard(&message)?;
        }
        Ok(())
    }

    /// Hands a request to the gateway and waits for what comes of it.
    ///
    /// # Errors
    /// If the connection is lost.
    pub async fn exchange(&mut self, request: &Request) -> io::Result<Exchange> {
        let frame = request.frame(self.primary);
        let mut tries = 0;
        loop {
            tries += 1;
            self.stats.sent += 1;
            self.stats.retried += u64::from(tries > 1);
            let began = self.clock.now();
            let sequence = self.say(TOKEN_PASSING, &frame).await?;
            let until = Instant::now() + self.timeout;
            let message = self.answer(TOKEN_PASSING, sequence, until).await?;
            let outcome = self.judge(request, message.as_ref());
            let again = matches!(outcome, Err(Fault::Link(_))) && tries <= self.retries;
            if !again {
                return Ok(Exchange {
                    request: frame,
                    outcome,
                    tries,
                    began,
                    ended: self.clock.now(),
                });
            }
        }
    }

    /// What a response says about a request.
    fn judge(
        &mut self,
        request: &Request,
        message: Option<&Message>,
    ) -> Result<shared::hart::link::Answer, Fault> {
        let Some(message) = message else {
            self.stats.silent += 1;
            return Err(Fault::Link(Failure::Silence));
        };
        if let Some(why) = refusal(message) {
            self.stats.refused += 1;
            return Err(Fault::Gateway(why));
        }
        let Some(answer) = request.answer(&message.body, self.primary) else {
            self.stats.damaged += 1;
            return Err(Fault::Link(Failure::Damaged));
        };
        match answer.communication_error() {
            None => {
                self.stats.answered += 1;
                Ok(answer)
            }
            Some(errors) => {
                self.stats.refused += 1;
                Err(Fault::Link(Failure::Communication(errors)))
            }
        }
    }

    /// The response to a message; `None` if none comes in time.
    async fn answer(
        &mut self,
        id: u8,
        sequence: u16,
        until: Instant,
    ) -> io::Result<Option<Message>> {
        loop {
            let Some(message) = self.message(until).await? else {
                return Ok(None);
            };
            let ours = matches!(message.kind, 1 | 15) && message.sequence == sequence;
            if ours && (message.id == id || message.kind == 15) {
                return Ok(Some(message));
            }
            self.overheard(&message)?;
        }
    }

    /// Something that answers nothing we wait for.
    fn overheard(&mut self, message: &Message) -> io::Result<()> {
        match (message.kind, message.id) {
            // Devices that burst.
            (2, _) => self.stats.bursts += 1,
            (_, CLOSE) => {
                return Err(io::Error::new(
                    io::ErrorKind::ConnectionReset,
                    "the gateway closed the session",
                ));
            }
            (1, ALIVE) => {}
            _ => self.stats.strays += 1,
        }
        Ok(())
    }

    /// Sends a message; gives its sequence number.
    async fn say(&mut self, id: u8, body: &[u8]) -> io::Result<u16> {
        self.sequence = self.sequence.wrapping_add(1);
        let [s0, s1] = self.sequence.to_be_bytes();
        let len = u16::try_from(HEADER + body.len()).unwrap_or(u16::MAX);
        let [l0, l1] = len.to_be_bytes();
        let message = [&[1, 0, id, 0, s0, s1, l0, l1], body].concat();
        self.said = Instant::now();
        match &mut self.wire {
            Wire::Tcp(tap) => tap.write_all(&message).await?,
            Wire::Udp {
                socket,
                gate,
                recorder,
            } => {
                gate.admit(Framing::HartIp, &message)
                    .map_err(|why| io::Error::new(io::ErrorKind::PermissionDenied, why))?;
                recorder.sent(&message, true);
                socket.send(&message).await?;
            }
        }
        Ok(self.sequence)
    }

    /// The next message, whatever it is; `None` if none comes in time. Safe to cancel.
    async fn message(&mut self, until: Instant) -> io::Result<Option<Message>> {
        loop {
            if let Some(message) = self.take()? {
                return Ok(Some(message));
            }
            let mut bytes = [0; LONGEST];
            let read = async {
                match &mut self.wire {
                    Wire::Tcp(tap) => tap.read(&mut bytes).await,
                    Wire::Udp { socket, .. } => socket.recv(&mut bytes).await,
                }
            };
            let Ok(read) = timeout_at(until, read).await else {
                return Ok(None);
            };
            let count = read?;
            let new = bytes.get(..count).unwrap_or(&[]);
            match &self.wire {
                Wire::Tcp(_) if count == 0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                Wire::Tcp(_) => self.heard.extend_from_slice(new),
                Wire::Udp { recorder, .. } => {
                    recorder.received(new);
                    recorder.silence();
                    // One datagram is one message.
                    self.heard = new.to_vec();
                }
            }
        }
    }

    /// Takes a whole message from what was heard.
    fn take(&mut self) -> io::Result<Option<Message>> {
        let datagrams = matches!(self.wire, Wire::Udp { .. });
        let Some(header) = self.heard.first_chunk::<{ HEADER }>() else {
            if datagrams {
                self.heard.clear();
            }
            return Ok(None);
        };
        let &[version, kind, id, status, s0, s1, l0, l1] = header;
        let len = usize::from(u16::from_be_bytes([l0, l1]));
        let sound = matches!(version, 1 | 2) && (HEADER..=LONGEST).contains(&len);
        if !sound && !datagrams {
            let text = "the other side does not speak HART-IP";
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        let Some(body) = self.heard.get(HEADER..len).filter(|_| sound) else {
            if datagrams {
                self.heard.clear();
            }
            return Ok(None);
        };
        let message = Message {
            kind: kind & 0x0F,
            id,
            status,
            sequence: u16::from_be_bytes([s0, s1]),
            body: body.to_vec(),
        };
        self.heard.drain(..len);
        if let Wire::Tcp(tap) = &self.wire
            && self.heard.is_empty()
        {
            tap.recorder().silence();
        }
        Ok(Some(message))
    }
}

/// Why a gateway does not do what it was asked; `None` if it did.
fn refusal(message: &Message) -> Option<String> {
    // Warnings: set to nearest value, version, an insecure session exists.
    let fine = matches!(message.status, 0 | 8 | 14 | 30);
    if fine && message.kind == 1 {
        return None;
    }
    let name = HART_IP_STATUS.name(u32::from(message.status));
    Some(match name {
        Some(name) => format!("the gateway says \"{name}\" (status {})", message.status),
        None => format!("the gateway refuses with status {}", message.status),
    })
}

/// A socket that speaks to one gateway only.
async fn socket(host: &str) -> io::Result<UdpSocket> {
    let mut last = io::Error::from(io::ErrorKind::NotFound);
    for address in lookup_host(host).await? {
        let any = if address.is_ipv4() {
            "0.0.0.0:0"
        } else {
            "[::]:0"
        };
        let socket = UdpSocket::bind(any).await?;
        match socket.connect(address).await {
            Ok(()) => return Ok(socket),
            Err(error) => last = error,
        }
    }
    Err(last)
}
