//! What a master sends, and what comes of it.

use crate::capture::Micros;
use crate::hart::frame::{Address, FILL, Head, Type, check, extended, long_address, seal};
use core::fmt;

/// The command that carries another one.
const CARRIER: u8 = 31;

/// A request of a master.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Who is asked.
    pub address: Address,
    /// The command byte.
    pub command: u8,
    /// Its data; those of command 31 begin with the number of the command inside.
    pub data: Vec<u8>,
    /// Bytes of preamble.
    pub preambles: u8,
}

impl Request {
    /// Preambles at the first contact: what every device hears.
    pub const FIRST_CONTACT: u8 = 20;

    /// A request for a command; from number 256 on it travels in command 31.
    #[must_use]
    pub fn new(address: Address, number: u16, data: &[u8]) -> Self {
        let (command, data) = match u8::try_from(number) {
            Ok(command) => (command, data.to_vec()),
            Err(_) => (CARRIER, [&number.to_be_bytes(), data].concat()),
        };
        Self {
            address,
            command,
            data,
            preambles: Self::FIRST_CONTACT,
        }
    }

    /// The same with another number of preambles: 5 to 20.
    #[must_use]
    pub fn with_preambles(mut self, preambles: u8) -> Self {
        self.preambles = preambles.clamp(5, Self::FIRST_CONTACT);
        self
    }

    /// The number of the command, that of command 31 if it is inside.
    #[must_use]
    pub fn number(&self) -> u16 {
        match (self.command, self.data.first_chunk::<2>()) {
            (CARRIER, Some(number)) => u16::from_be_bytes(*number),
            _ => u16::from(self.command),
        }
    }

    /// The frame of a master of this kind, without preamble.
    #[must_use]
    pub fn frame(&self, primary: bool) -> Vec<u8> {
        match self.address {
            Address::Short(polling) => {
                let master = if primary { 0x80 } else { 0 };
                seal(0x02, &[polling & 0x3F | master], self.command, &self.data)
            }
            Address::Long(kind, id) => {
                let address = long_address(kind, id, primary);
                seal(0x82, &address, self.command, &self.data)
            }
        }
    }

    /// The bytes that go on the line.
    pub(super) fn bytes(&self, primary: bool) -> Vec<u8> {
        let mut bytes = vec![FILL; usize::from(self.preambles)];
        bytes.extend(self.frame(primary));
        bytes
    }

    /// The reply in this frame, from the delimiter to the check byte, if it is sound and answers
    /// this request of a master of this kind.
    #[must_use]
    pub fn answer(&self, frame: &[u8], primary: bool) -> Option<Answer> {
        let answer = Answer::of(frame)?;
        let whole = answer.head.total() == frame.len() && check(frame) == 0;
        let kind = answer.head.delimiter.kind() == Type::Ack;
        (whole && kind && self.fits(&answer.head, frame, primary)).then_some(answer)
    }

    /// True if a reply with this head answers it.
    pub(super) fn fits(&self, head: &Head, frame: &[u8], primary: bool) -> bool {
        let address = match self.address {
            // Whoever answers a broadcast has an address of its own.
            Address::BROADCAST => head.delimiter.is_long() && head.address != Address::BROADCAST,
            own => own == head.address,
        };
        // A refusal may leave the number of an extended command out.
        let number = match extended(head, frame) {
            Some(number) => number == self.number(),
            None => true,
        };
        address && number && head.primary == primary && head.command == self.command
    }
}

/// A sound reply to a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// From the delimiter to the check byte.
    pub frame: Vec<u8>,
    /// Its parts.
    pub head: Head,
}

impl Answer {
    /// The reply in this frame, which begins with the delimiter; `None` if it is none.
    #[must_use]
    pub fn of(frame: &[u8]) -> Option<Self> {
        let head = Head::of(frame)?;
        (head.is_possible() && head.status_len() == 2).then(|| Self {
            frame: frame.to_vec(),
            head,
        })
    }

    fn status(&self) -> [u8; 2] {
        let from = self.frame.get(self.head.data..);
        from.and_then(|f| f.first_chunk::<2>())
            .copied()
            .unwrap_or_default()
    }

    /// The response code; `None` if the device reports an error of the line instead.
    #[must_use]
    pub fn code(&self) -> Option<u8> {
        let [first, _] = self.status();
        (first & 0x80 == 0).then_some(first)
    }

    /// The errors of the line that the device reports instead of a response code.
    #[must_use]
    pub fn communication_error(&self) -> Option<u8> {
        let [first, _] = self.status();
        (first & 0x80 != 0).then_some(first)
    }

    /// The number of the command, that of command 31 if it is inside.
    #[must_use]
    pub fn number(&self) -> u16 {
        extended(&self.head, &self.frame).unwrap_or(u16::from(self.head.command))
    }

    /// The device status.
    #[must_use]
    pub fn device_status(&self) -> u8 {
        self.status()[1]
    }

    /// The data behind the status, and behind the number of an extended command.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        let number = if self.head.command == CARRIER { 2 } else { 0 };
        let from = self.head.data.saturating_add(2).saturating_add(number);
        let end = self.head.data.saturating_add(usize::from(self.head.count));
        self.frame.get(from..end).unwrap_or(&[])
    }
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Nothing came.
    Silence,
    /// Bytes came that are no sound reply.
    Damaged,
    /// The device did not understand the request: it reports these errors of the line.
    Communication(u8),
    /// The line was never free.
    Crowded,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silence => f.write_str("no answer"),
            Self::Damaged => f.write_str("the answer was damaged"),
            Self::Communication(errors) => write!(
                f,
                "the device received the request with errors (communication error 0x{errors:02X})"
            ),
            Self::Crowded => f.write_str("the line was never free"),
        }
    }
}

/// How a request ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Done {
    /// The request, from the delimiter to the check byte.
    pub request: Vec<u8>,
    /// The answer, whatever its response code, or why there is none.
    pub outcome: Result<Answer, Failure>,
    /// How often it was sent.
    pub tries: u8,
    /// When the first byte of the last try went out.
    pub began: Micros,
    /// When the last byte of the answer came, or when it was given up.
    pub ended: Micros,
}
