//! A Modbus TCP device that says what a test wants it to say.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;

/// Registers by address; those that nobody set are 0.
type Words = Arc<Mutex<BTreeMap<u16, u16>>>;

/// A device on a free port of loopback that answers reads of any unit until the test is over.
#[derive(Debug)]
pub struct Registers {
    address: SocketAddr,
    words: Words,
}

impl Registers {
    /// Starts the device.
    ///
    /// # Panics
    ///
    /// If no port is free.
    #[must_use]
    pub fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener
            .local_addr()
            .expect("a bound socket has an address");
        let words = Words::default();
        let shared = Arc::clone(&words);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let words = Arc::clone(&shared);
                thread::spawn(move || serve(stream, &words));
            }
        });
        Self { address, words }
    }

    /// Where it listens.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Sets a holding register.
    pub fn set(&self, address: u16, word: u16) {
        lock(&self.words).insert(address, word);
    }
}

fn lock(words: &Words) -> MutexGuard<'_, BTreeMap<u16, u16>> {
    words
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Answers until the other side goes away.
fn serve(mut stream: TcpStream, words: &Words) {
    let mut header = [0; 7];
    while stream.read_exact(&mut header).is_ok() {
        let length = usize::from(u16::from_be_bytes([header[4], header[5]]));
        let mut pdu = vec![0; length.saturating_sub(1)];
        if stream.read_exact(&mut pdu).is_err() {
            return;
        }
        let answer = answer(&pdu, words);
        let length = u16::try_from(answer.len() + 1)
            .unwrap_or(u16::MAX)
            .to_be_bytes();
        let mut frame = vec![header[0], header[1], 0, 0, length[0], length[1], header[6]];
        frame.extend_from_slice(&answer);
        if stream.write_all(&frame).is_err() {
            return;
        }
    }
}

/// Reads of holding registers are answered; anything else is not implemented (exception 1).
fn answer(pdu: &[u8], words: &Words) -> Vec<u8> {
    let &[3, s0, s1, c0, c1] = pdu else {
        return vec![pdu.first().copied().unwrap_or(0) | 0x80, 1];
    };
    let start = u16::from_be_bytes([s0, s1]);
    let count = u16::from_be_bytes([c0, c1]).min(125);
    let mut answer = vec![3, u8::try_from(count * 2).unwrap_or(0)];
    let words = lock(words);
    for at in 0..count {
        let word = words.get(&start.wrapping_add(at)).copied().unwrap_or(0);
        answer.extend_from_slice(&word.to_be_bytes());
    }
    answer
}
