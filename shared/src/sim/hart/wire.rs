//! The receiver: characters to requests.

use super::medium::Character;
use crate::capture::Micros;

/// A preamble of so many bytes begins a message.
const SYNC: usize = 2;
/// Bits of the first status byte of an answer to a request that came in damaged.
const ERROR: u8 = 0x80;
const PARITY: u8 = 0x40;
const CHECK: u8 = 0x08;

/// Something that was received.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    /// The delimiter.
    pub delimiter: u8,
    /// One byte or five.
    pub address: Vec<u8>,
    pub command: u8,
    pub data: Vec<u8>,
    /// 0, or how it was damaged.
    pub damage: u8,
}

impl Message {
    /// True for a request of a master.
    pub fn is_request(&self) -> bool {
        self.delimiter & 0x07 == 2
    }

    /// True for an answer of a device.
    pub fn is_answer(&self) -> bool {
        self.delimiter & 0x07 == 6
    }

    /// True if it is from the primary master or for it.
    pub fn is_primary(&self) -> bool {
        self.address.first().is_some_and(|a| a & 0x80 != 0)
    }

    /// The address without master and burst bit.
    pub fn plain_address(&self) -> Vec<u8> {
        let mut address = self.address.clone();
        if let Some(first) = address.first_mut() {
            *first &= 0x3F;
        }
        address
    }
}

/// Finds messages among characters.
#[derive(Clone, Debug, Default)]
pub(super) struct Receiver {
    fill: usize,
    /// The message from its delimiter on; empty while there is none.
    bytes: Vec<u8>,
    /// True once a character of the data was damaged.
    damaged: bool,
    last: Option<Micros>,
}

impl Receiver {
    /// The line went quiet: what was begun is cut.
    pub fn reset(&mut self) {
        self.fill = 0;
        self.bytes.clear();
        self.damaged = false;
        self.last = None;
    }

    /// A character; the message, if it completes one.
    pub fn take(&mut self, character: Character, at: Micros, gap_us: u64) -> Option<Message> {
        if self.last.is_some_and(|last| at.since(last) > gap_us) {
            self.reset();
        }
        self.last = Some(at);
        if self.bytes.is_empty() {
            self.begin(character);
            return None;
        }
        self.bytes.push(character.byte);
        let head = self.head();
        if !character.sound {
            match head {
                // Past the byte count it is still known whose message this is and where it ends.
                Some((data, _)) if self.bytes.len() > data => self.damaged = true,
                _ => {
                    self.reset();
                    return None;
                }
            }
        }
        let (data, total) = head?;
        if self.bytes.len() < total {
            return None;
        }
        let message = self.message(data);
        self.reset();
        message
    }

    fn begin(&mut self, character: Character) {
        if !character.sound {
            self.fill = 0;
        } else if character.byte == 0xFF {
            self.fill = self.fill.saturating_add(1);
        } else {
            let known = matches!(character.byte & 0x1F, 1 | 2 | 6);
            if known && self.fill >= SYNC {
                self.bytes.push(character.byte);
            }
            self.fill = 0;
        }
    }

    /// Where the data begin, and the length of the whole, once the byte count is there.
    fn head(&self) -> Option<(usize, usize)> {
        let delimiter = *self.bytes.first()?;
        let address: usize = if delimiter & 0x80 != 0 { 5 } else { 1 };
        let expansion = usize::from(delimiter >> 5 & 3);
        let count = address.saturating_add(expansion).saturating_add(2);
        let data = count.saturating_add(1);
        let len = usize::from(*self.bytes.get(count)?);
        Some((data, data.saturating_add(len).saturating_add(1)))
    }

    fn message(&self, data: usize) -> Option<Message> {
        let delimiter = *self.bytes.first()?;
        let end = if delimiter & 0x80 != 0 { 6 } else { 2 };
        let sum = self.bytes.iter().fold(0, |sum, b| sum ^ b);
        let mut damage = 0;
        if self.damaged {
            damage |= ERROR | PARITY;
        }
        if sum != 0 {
            damage |= ERROR | CHECK;
        }
        let (_, body) = self.bytes.split_at_checked(data)?;
        let (_, body) = body.split_last()?;
        Some(Message {
            delimiter,
            address: self.bytes.get(1..end)?.to_vec(),
            command: *self.bytes.get(data.checked_sub(2)?)?,
            data: body.to_vec(),
            damage,
        })
    }
}

/// A message as characters, its preamble in front.
pub(super) fn message(
    preambles: u8,
    delimiter: u8,
    address: &[u8],
    command: u8,
    data: &[u8],
) -> Vec<u8> {
    let mut body = vec![delimiter];
    body.extend_from_slice(address);
    body.push(command);
    body.push(u8::try_from(data.len()).unwrap_or(u8::MAX));
    body.extend(data.iter().take(255));
    let check = body.iter().fold(0, |sum, b| sum ^ b);
    body.push(check);
    let mut all = vec![0xFF; usize::from(preambles)];
    all.append(&mut body);
    all
}
