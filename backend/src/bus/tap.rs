//! The bottom of every line: checks what goes out, records what goes either way.

use super::gate::{Gate, NotARead};
use super::recorder::Recorder;
use shared::frame::Framing;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

/// A stream whose sender is switched on before it sends.
pub trait Keyed {
    /// Switches it.
    fn key(&mut self, on: bool);
}

/// A stream between us and the devices. Each frame must be handed over as a whole.
#[derive(Debug)]
pub struct Tap<T> {
    inner: T,
    framing: Framing,
    gate: Gate,
    recorder: Recorder,
    /// Bytes of an admitted frame that the line has not taken yet.
    admitted: usize,
}

impl<T> Tap<T> {
    /// Puts the tap on a stream.
    pub const fn new(inner: T, framing: Framing, gate: Gate, recorder: Recorder) -> Self {
        Self {
            inner,
            framing,
            gate,
            recorder,
            admitted: 0,
        }
    }

    /// Switches the carrier of a modem.
    pub fn key(&mut self, on: bool)
    where
        T: Keyed,
    {
        self.inner.key(on);
    }

    /// What records this line.
    pub const fn recorder(&self) -> &Recorder {
        &self.recorder
    }
}

impl<T: AsyncWrite + Unpin> AsyncWrite for Tap<T> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        if self.admitted == 0 {
            self.gate.admit(self.framing, bytes).map_err(refused)?;
            self.admitted = bytes.len();
        }
        let bytes = bytes.get(..self.admitted).unwrap_or(bytes);
        let written = ready!(Pin::new(&mut self.inner).poll_write(cx, bytes))?;
        self.admitted = self.admitted.saturating_sub(written);
        let sent = bytes.get(..written).unwrap_or(bytes);
        self.recorder.sent(sent, self.admitted == 0);
        Poll::Ready(Ok(written))
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.inner).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.inner).poll_shutdown(cx)
    }
}

impl<T: AsyncRead + Unpin> AsyncRead for Tap<T> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = into.filled().len();
        ready!(Pin::new(&mut self.inner).poll_read(cx, into))?;
        if let Some(new) = into.filled().get(before..)
            && !new.is_empty()
        {
            self.recorder.received(new);
        }
        Poll::Ready(Ok(()))
    }
}

fn refused(why: NotARead) -> io::Error {
    io::Error::new(io::ErrorKind::PermissionDenied, why)
}

#[cfg(test)]
mod tests {
    use super::super::gate;
    use super::*;
    use crate::clock::Clock;
    use crate::config::DeviceConfig;
    use shared::device::Device;
    use shared::dop::Profile;
    use shared::encode::frame;
    use tokio::io::{AsyncReadExt, AsyncWriteExt, duplex};
    use tokio::sync::watch;

    fn tap(framing: Framing) -> (Tap<tokio::io::DuplexStream>, tokio::io::DuplexStream) {
        let (near, far) = duplex(1 << 16);
        let recorder = Recorder::new("a", Clock::start(), watch::Sender::new(0));
        (Tap::new(near, framing, Gate::default(), recorder), far)
    }

    /// Counts bytes on the line for all 256 function codes: nothing of a write gets out.
    #[tokio::test]
    async fn nothing_but_reads_reaches_the_line() {
        for framing in Framing::MODBUS {
            let (mut tap, mut far) = tap(framing);
            let mut expected = Vec::new();
            for pdu in gate::every_function() {
                let bytes = frame(framing, 7, 1, &pdu);
                let read = matches!(pdu[0], 1..=4 | 7 | 8 | 11 | 12 | 17 | 20 | 24 | 43);
                assert_eq!(tap.write_all(&bytes).await.is_ok(), read, "{pdu:?}");
                if read {
                    expected.extend_from_slice(&bytes);
                }
            }
            let captures = tap.recorder().last();
            drop(tap);
            let mut seen = Vec::new();
            far.read_to_end(&mut seen).await.unwrap();
            assert_eq!(seen, expected, "{framing:?}");
            assert_eq!(captures, 12);
        }
    }

    /// Counts bytes on the line of a DOP device: all function codes, all words to its request
    /// register, all addresses, other units. Only the 65 requests of the manual get out.
    #[tokio::test]
    async fn of_all_writes_only_known_requests_reach_the_line() {
        let profile = Profile::from_json(r#"{"registers":{"request":4000}}"#).unwrap();
        let device = DeviceConfig {
            tag: "MX-1".into(),
            device: Device::Dop,
            bus: 0,
            unit: 4,
            description: String::new(),
            faults: Vec::new(),
            profile: Some(profile.into()),
            target: None,
        };
        let write = |address: u16, word: u16| {
            let ([a, b], [c, d]) = (address.to_be_bytes(), word.to_be_bytes());
            [
                vec![6, a, b, c, d],
                vec![16, a, b, 0, 1, 2, c, d],
                vec![22, a, b, c, d, c, d],
            ]
        };
        for framing in Framing::MODBUS {
            let (mut tap, mut far) = tap(framing);
            tap.gate = Gate::of(std::slice::from_ref(&device));
            let words = (0..=u16::MAX).flat_map(|word| write(4000, word));
            let addresses = (0..=u16::MAX).flat_map(|address| write(address, 0x1001));
            let writes = words
                .map(|pdu| (4, pdu))
                .chain(addresses.map(|pdu| (4, pdu)))
                .chain((0..=255).flat_map(|unit| write(4000, 1).map(|pdu| (unit, pdu))))
                .chain(gate::every_function().map(|pdu| (4, pdu)));
            let mut sent = Vec::new();
            for (unit, pdu) in writes {
                let is_read = gate::is_read(&pdu);
                let bytes = frame(framing, 7, unit, &pdu);
                if tap.write_all(&bytes).await.is_ok() && !is_read {
                    sent.push((unit, pdu));
                }
            }
            drop(tap);
            let mut seen = Vec::new();
            far.read_to_end(&mut seen).await.unwrap();
            // 65 words, and once more each as the address 4000 and as the unit 4; all of function 6.
            assert_eq!(sent.len(), 67, "{framing:?}");
            assert!(
                sent.iter()
                    .all(|(unit, pdu)| *unit == 4 && pdu[..3] == [6, 0x0F, 0xA0])
            );
            // Besides these there are the twelve reads among all functions, and nothing else.
            let reads = gate::every_function().filter(|pdu| gate::is_read(pdu));
            let length: usize = sent
                .iter()
                .map(|(_, pdu)| pdu.clone())
                .chain(reads)
                .map(|pdu| frame(framing, 7, 4, &pdu).len())
                .sum();
            assert_eq!(seen.len(), length, "{framing:?}");
        }
    }

    /// Counts bytes on a HART line and towards a gateway for all 65,536 command numbers, each plain
    /// where it fits into a byte and inside command 31, with many lengths of data.
    #[tokio::test]
    async fn of_hart_only_reads_reach_the_line() {
        use shared::hart::frame::seal;
        let address = [0xAE, 0xDD, 0x01, 0x23, 0x45];
        for framing in [Framing::Hart, Framing::HartIp] {
            let (mut tap, mut far) = tap(framing);
            tap.gate = Gate::hart();
            let mut expected = Vec::new();
            for number in 0..=u16::MAX {
                for len in [0, 1, 2, 3, 4, 5, 8, 9, 25, 253] {
                    let data = vec![1; len];
                    let inside = [&number.to_be_bytes(), &data[..]].concat();
                    let plain = u8::try_from(number)
                        .ok()
                        .map(|n| seal(0x82, &address, n, &data));
                    let carried = seal(0x82, &address, 31, &inside);
                    for (frame, extended) in plain
                        .into_iter()
                        .map(|f| (f, false))
                        .chain([(carried, true)])
                    {
                        let bytes = match framing {
                            Framing::Hart => [&[0xFF; 5], &frame[..]].concat(),
                            _ => {
                                let len = u16::try_from(8 + frame.len()).unwrap().to_be_bytes();
                                [&[1, 0, 3, 0, 0, 9, len[0], len[1]], &frame[..]].concat()
                            }
                        };
                        // By hand, from tables 12 to 14 and the sources of the other commands.
                        let read = match (number, len) {
                            (0..=3 | 7 | 8 | 12..=16 | 20 | 48 | 95 | 128 | 131 | 133, 0) => {
                                !extended
                            }
                            (9, 1..=8) | (33, 1..=4) | (54, 1) | (129, 3) => !extended,
                            (523, 2) => extended,
                            _ => false,
                        };
                        let sent = tap.write_all(&bytes).await.is_ok();
                        assert_eq!(sent, read, "{number} {len} {extended}");
                        if read {
                            expected.extend(bytes);
                        }
                    }
                }
            }
            drop(tap);
            let mut seen = Vec::new();
            far.read_to_end(&mut seen).await.unwrap();
            assert_eq!(seen, expected, "{framing:?}");
        }
    }

    /// A write can't hide behind a read.
    #[tokio::test]
    async fn one_frame_at_a_time() {
        let read = frame(Framing::Tcp, 1, 1, &[3, 0, 0, 0, 1]);
        let write = frame(Framing::Tcp, 2, 1, &[6, 0, 0, 0, 1]);
        let (mut tap, mut far) = tap(Framing::Tcp);
        assert!(tap.write_all(&[read, write].concat()).await.is_err());
        drop(tap);
        let mut seen = Vec::new();
        far.read_to_end(&mut seen).await.unwrap();
        assert!(seen.is_empty());
    }

    #[tokio::test]
    async fn a_line_that_takes_little_at_a_time_gets_the_whole_frame() {
        let (near, mut far) = duplex(3);
        let recorder = Recorder::new("a", Clock::start(), watch::Sender::new(0));
        let mut tap = Tap::new(near, Framing::Rtu, Gate::default(), recorder);
        let bytes = frame(Framing::Rtu, 0, 1, &[3, 0, 0, 0, 1]);
        let expected = bytes.clone();
        let write = tokio::spawn(async move { tap.write_all(&bytes).await });
        let mut seen = vec![0; expected.len()];
        far.read_exact(&mut seen).await.unwrap();
        assert_eq!(seen, expected);
        write.await.unwrap().unwrap();
    }
}
