//! Modbus TCP: tokio-modbus speaks, this module keeps it from trouble.
//!
//! A connection on which anything went wrong is closed and opened again, so that an answer that
//! comes late meets nobody. What the other side sends is checked before the library sees it.

use super::gate::{DopPermit, Gate};
use super::query::Query;
use super::recorder::Recorder;
use super::tap::Tap;
use super::{Answer, Fault};
use shared::address::Table;
use shared::encode::Read;
use shared::frame::Framing;
use shared::pdu::length::{self, Length};
use std::borrow::Cow;
use std::fmt;
use std::io;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, ready};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Instant, timeout};
use tokio_modbus::client::{Client, Context as Modbus, tcp};
use tokio_modbus::slave::{Slave, SlaveContext};
use tokio_modbus::{Request, Response};

/// How long a connection may take to come about.
const CONNECT: Duration = Duration::from_secs(3);

/// A device or gateway that is reached over TCP.
pub struct Remote {
    host: String,
    timeout: Duration,
    gate: Gate,
    recorder: Recorder,
    /// The answer that came last, as it came.
    last: Last,
    modbus: Option<Modbus>,
}

/// The bytes of the answer to the last request, for functions that the library does not know.
#[derive(Clone, Debug, Default)]
struct Last(Arc<Mutex<Option<Vec<u8>>>>);

impl Last {
    fn set(&self, pdu: Option<Vec<u8>>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = pdu;
    }

    fn take(&self) -> Option<Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl fmt::Debug for Remote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Remote")
            .field("host", &self.host)
            .field("connected", &self.modbus.is_some())
            .finish_non_exhaustive()
    }
}

impl Remote {
    /// Connects.
    ///
    /// # Errors
    /// If the other side can't be reached.
    pub async fn connect(
        host: &str,
        timeout: Duration,
        gate: Gate,
        recorder: Recorder,
    ) -> Result<Self, io::Error> {
        let mut remote = Self {
            host: host.to_owned(),
            timeout,
            gate,
            recorder,
            last: Last::default(),
            modbus: None,
        };
        remote.modbus = Some(remote.attached().await?);
        Ok(remote)
    }

    /// Reads once.
    ///
    /// # Errors
    /// If no answer came, if it was not sound, or if the connection is lost.
    pub async fn read(&mut self, unit: u8, query: &Query) -> Result<Answer, Fault> {
        let Query::Read(read) = *query else {
            return self.read_other(unit, query).await;
        };
        let (start, count) = (read.start.get(), read.count());
        let request = match read.table {
            Table::Coil => Request::ReadCoils(start, count),
            Table::Discrete => Request::ReadDiscreteInputs(start, count),
            Table::Input => Request::ReadInputRegisters(start, count),
            Table::Holding => Request::ReadHoldingRegisters(start, count),
        };
        let function = read.table.read_function();
        self.exchange(unit, function, request, |response| pdu(response, read))
            .await
    }

    /// Functions of which the library knows nothing, or less than devices say. Their answer is taken
    /// as it came, from below the library; where it took offence, the connection is opened anew.
    async fn read_other(&mut self, unit: u8, query: &Query) -> Result<Answer, Fault> {
        let mut modbus = self.attached().await?;
        modbus.set_slave(Slave(unit));
        let bytes = query.pdu();
        let (function, data) = bytes.split_first().map_or((0, &[][..]), |(f, d)| (*f, d));
        let sent = Instant::now();
        let call = modbus.call(Request::Custom(function, Cow::Borrowed(data)));
        let outcome = timeout(self.timeout, call).await;
        self.recorder.silence();
        let latency = sent.elapsed();
        let came = self.last.take();
        let pdu = match (outcome, came) {
            (Ok(Err(tokio_modbus::Error::Transport(error))), _)
                if error.kind() == io::ErrorKind::PermissionDenied =>
            {
                return Err(error.into());
            }
            (Ok(outcome), Some(pdu)) => {
                if outcome.is_ok() {
                    self.modbus = Some(modbus);
                }
                pdu
            }
            (Ok(Err(tokio_modbus::Error::Transport(error))), None) => match error.kind() {
                io::ErrorKind::InvalidData => return Err(Fault::Damaged(error.to_string())),
                _ => return Err(Fault::Closed),
            },
            (Ok(_), None) => {
                return Err(Fault::Damaged("another request was answered".into()));
            }
            (Err(_), _) => return Err(Fault::Silence),
        };
        let refused = pdu.len() == 2 && pdu.first() == Some(&(function | 0x80));
        if refused || query.is_answered_by(&pdu) {
            return Ok(Answer { pdu, latency });
        }
        self.modbus = None;
        let text = format!("{} bytes came that do not answer the request", pdu.len());
        Err(Fault::Damaged(text))
    }

    /// The connection, opened if it is not.
    async fn attached(&mut self) -> io::Result<Modbus> {
        match self.modbus.take() {
            Some(modbus) => Ok(modbus),
            None => attach(&self.host, &self.gate, &self.recorder, &self.last).await,
        }
    }

    /// Writes the request for a diagnostic object.
    ///
    /// # Errors
    /// As for a read.
    pub async fn write(&mut self, permit: &DopPermit) -> Result<Answer, Fault> {
        let (address, word) = (permit.address(), permit.request().word());
        let request = match permit.function() {
            16 => Request::WriteMultipleRegisters(address, Cow::Owned(vec![word])),
            _ => Request::WriteSingleRegister(address, word),
        };
        let good = permit.pdu().get(..5).unwrap_or_default().to_vec();
        let check = |response: &Response| match response {
            Response::WriteSingleRegister(at, value) if (*at, *value) == (address, word) => {
                Ok(good.clone())
            }
            Response::WriteMultipleRegisters(at, 1) if *at == address => Ok(good.clone()),
            _ => Err(Fault::Damaged("another write was acknowledged".into())),
        };
        self.exchange(permit.unit(), permit.function(), request, check)
            .await
    }

    async fn exchange(
        &mut self,
        unit: u8,
        function: u8,
        request: Request<'_>,
        check: impl Fn(&Response) -> Result<Vec<u8>, Fault>,
    ) -> Result<Answer, Fault> {
        let mut modbus = self.attached().await?;
        modbus.set_slave(Slave(unit));
        let sent = Instant::now();
        let outcome = timeout(self.timeout, modbus.call(request)).await;
        self.recorder.silence();
        let latency = sent.elapsed();
        let answer = |pdu| Answer { pdu, latency };
        // Only after a sound answer the connection is kept: what else comes is not ours then.
        match outcome {
            Ok(Ok(Ok(response))) => {
                let pdu = check(&response)?;
                self.modbus = Some(modbus);
                Ok(answer(pdu))
            }
            Ok(Ok(Err(exception))) => {
                self.modbus = Some(modbus);
                Ok(answer(vec![function | 0x80, exception.into()]))
            }
            Ok(Err(tokio_modbus::Error::Transport(error))) => match error.kind() {
                io::ErrorKind::InvalidData => Err(Fault::Damaged(error.to_string())),
                io::ErrorKind::PermissionDenied => Err(error.into()),
                _ => Err(Fault::Closed),
            },
            Ok(Err(tokio_modbus::Error::Protocol(error))) => Err(Fault::Damaged(error.to_string())),
            Err(_) => Err(Fault::Silence),
        }
    }
}

/// Opens a connection that is recorded and checked.
async fn attach(host: &str, gate: &Gate, recorder: &Recorder, last: &Last) -> io::Result<Modbus> {
    let stream = connect(host).await?;
    let tap = Tap::new(stream, Framing::Tcp, gate.clone(), recorder.clone());
    Ok(tcp::attach(Checked::new(tap, last.clone())))
}

/// Opens a connection without delay for small frames.
pub async fn connect(host: &str) -> io::Result<TcpStream> {
    let stream = timeout(CONNECT, TcpStream::connect(host))
        .await
        .map_err(|_| io::Error::from(io::ErrorKind::TimedOut))??;
    stream.set_nodelay(true)?;
    Ok(stream)
}

/// The response PDU, if it holds as much as was asked for.
fn pdu(response: &Response, read: Read) -> Result<Vec<u8>, Fault> {
    let mut pdu = vec![read.table.read_function(), 0];
    match response {
        Response::ReadCoils(bits) | Response::ReadDiscreteInputs(bits) => {
            for eight in bits.chunks(8) {
                let byte = eight
                    .iter()
                    .rev()
                    .fold(0_u8, |b, on| b << 1 | u8::from(*on));
                pdu.push(byte);
            }
        }
        Response::ReadInputRegisters(words) | Response::ReadHoldingRegisters(words) => {
            pdu.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        }
        _ => {}
    }
    if pdu.len() != read.response_len() {
        let text = format!(
            "{} bytes of data came where {} were asked for",
            pdu.len() - 2,
            read.response_len() - 2
        );
        return Err(Fault::Damaged(text));
    }
    if let Some(count) = pdu.get_mut(1) {
        *count = u8::try_from(read.response_len() - 2).unwrap_or(0);
    }
    Ok(pdu)
}

/// Hands on whole frames that are sound responses; anything else ends the connection.
///
/// tokio-modbus indexes into a response by the counts in it and panics if they lie.
#[derive(Debug)]
struct Checked<T> {
    inner: T,
    /// A frame that is not complete or not checked yet.
    frame: Vec<u8>,
    /// A checked frame, and how much of it was handed on.
    good: Vec<u8>,
    given: usize,
    /// Transaction and unit of the last request.
    asked: [u8; 3],
    last: Last,
}

impl<T> Checked<T> {
    const fn new(inner: T, last: Last) -> Self {
        Self {
            inner,
            frame: Vec::new(),
            good: Vec::new(),
            given: 0,
            asked: [0; 3],
            last,
        }
    }

    /// Moves a complete frame to `good`. False if more bytes are needed.
    fn check(&mut self) -> io::Result<bool> {
        let bad = |what: &str| {
            let text = format!("the other side sent {what}");
            Err(io::Error::new(io::ErrorKind::InvalidData, text))
        };
        let Some(header) = self.frame.first_chunk::<7>() else {
            return Ok(false);
        };
        let &[t0, t1, p0, p1, l0, l1, unit] = header;
        if (p0, p1) != (0, 0) {
            return bad("a frame that is not Modbus: its protocol number is not 0");
        }
        let stated = usize::from(u16::from_be_bytes([l0, l1]));
        if !(2..=254).contains(&stated) {
            return bad("a frame of an impossible length");
        }
        let len = stated + 6;
        let Some(pdu) = self.frame.get(7..len) else {
            return Ok(false);
        };
        let long = length::report(pdu) == Some(pdu.len());
        if !long && length::response(pdu) != Length::Exact(pdu.len()) {
            return bad("a response whose length and content do not agree");
        }
        if self.asked == [t0, t1, unit] {
            self.last.set(Some(pdu.to_vec()));
        }
        let rest = self.frame.split_off(len);
        self.good = std::mem::replace(&mut self.frame, rest);
        self.given = 0;
        Ok(true)
    }
}

impl<T: AsyncRead + Unpin> AsyncRead for Checked<T> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        loop {
            let this = &mut *self;
            if let Some(left) = this.good.get(this.given..).filter(|l| !l.is_empty()) {
                let count = left.len().min(into.remaining());
                into.put_slice(left.get(..count).unwrap_or(left));
                this.given += count;
                return Poll::Ready(Ok(()));
            }
            if this.check()? {
                continue;
            }
            let mut bytes = [0; 512];
            let mut buffer = ReadBuf::new(&mut bytes);
            ready!(Pin::new(&mut this.inner).poll_read(cx, &mut buffer))?;
            if buffer.filled().is_empty() {
                return Poll::Ready(Ok(()));
            }
            this.frame.extend_from_slice(buffer.filled());
        }
    }
}

impl<T: AsyncWrite + Unpin> AsyncWrite for Checked<T> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        // What an earlier request left behind answers nothing.
        self.frame.clear();
        self.good.clear();
        // The library hands over whole frames.
        if let &[t0, t1, 0, 0, _, _, unit, ..] = bytes {
            self.asked = [t0, t1, unit];
            self.last.set(None);
        }
        Pin::new(&mut self.inner).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.inner).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.inner).poll_shutdown(cx)
    }
}
