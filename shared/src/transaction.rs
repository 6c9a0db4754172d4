//! Pairing of requests and responses. A register response carries no addresses, so values exist
//! per transaction only.

use crate::frame::{Found, Framing, Role};

/// A request that waits for its answer.
#[derive(Clone, Copy, Debug)]
struct Open {
    transaction: u16,
    unit: u8,
    function: u8,
    index: u32,
}

/// How many requests may be under way at once on Modbus TCP. On a serial line there is one.
const DEPTH: usize = 16;

/// The requests that wait for an answer.
///
/// Serial: one; a new request means that the one before was not answered. TCP: several, told
/// apart by their transaction identifier.
#[derive(Clone, Debug)]
pub struct Pairing {
    serial: Option<Open>,
    tcp: [Option<Open>; DEPTH],
    next: usize,
}

impl Pairing {
    pub(crate) const fn new() -> Self {
        Self {
            serial: None,
            tcp: [None; DEPTH],
            next: 0,
        }
    }

    /// On Modbus TCP: true if an answer to this request is due.
    pub(crate) fn expects(&self, transaction: u16, unit: u8, function: u8) -> bool {
        self.tcp
            .iter()
            .flatten()
            .any(|o| o.matches(transaction, unit, function))
    }

    /// On a serial line: true if an answer to this function of this unit is due.
    #[inline]
    pub(crate) fn expects_serial(&self, unit: u8, function: u8) -> bool {
        self.serial
            .as_ref()
            .is_some_and(|o| o.matches(0, unit, function))
    }

    /// Notes a request, or finds the request of a response.
    #[inline]
    pub(crate) fn settle(&mut self, found: &Found, framing: Framing, index: u32) -> Option<u32> {
        match found.role {
            Role::Request => {
                let open = Open {
                    transaction: found.transaction,
                    unit: found.unit,
                    function: found.function,
                    index,
                };
                if framing == Framing::Tcp {
                    self.note_tcp(open);
                } else {
                    // Nobody answers a broadcast.
                    self.serial = (found.unit != 0).then_some(open);
                }
                None
            }
            Role::Response | Role::Exception => {
                let slot = if framing == Framing::Tcp {
                    self.tcp
                        .iter_mut()
                        .find(|o| o.is_some_and(|o| o.answers(found)))?
                } else {
                    Some(&mut self.serial).filter(|o| o.is_some_and(|o| o.answers(found)))?
                };
                slot.take().map(|o| o.index)
            }
            Role::Burst | Role::Unknown | Role::Noise => None,
        }
    }

    /// The oldest of sixteen requests without an answer makes room.
    fn note_tcp(&mut self, open: Open) {
        if let Some(slot) = self.tcp.get_mut(self.next) {
            *slot = Some(open);
        }
        self.next = self.next.wrapping_add(1).checked_rem(DEPTH).unwrap_or(0);
    }
}

impl Open {
    const fn answers(&self, found: &Found) -> bool {
        self.matches(found.transaction, found.unit, found.function)
    }

    const fn matches(&self, transaction: u16, unit: u8, function: u8) -> bool {
        self.transaction == transaction && self.unit == unit && self.function == function & 0x7F
    }
}
