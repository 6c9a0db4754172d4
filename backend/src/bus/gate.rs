//! The last thing that stands before a line: reads pass, and one write.
//!
//! The one write is the request for a diagnostic object: one register, at the address that the
//! profile of a device declared as DOP gives, with a word that names a known object and option of
//! it. Nothing else that writes can be said above this; and this looks at the bytes themselves, so
//! that it holds even if somebody adds something.

use shared::decode::pdu_of;
use shared::device::Device;
use shared::dop::{Profile, Request};
use shared::encode;
use shared::frame::Framing;
use shared::frame::ascii::hex_pair;
use shared::pdu::length::{Length, request};
use std::sync::Arc;

use super::hart;
use super::query::is_counter;
use crate::config::DeviceConfig;

/// A frame that may not be sent. It never leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotARead {
    /// A Modbus frame, and what it would have asked for.
    #[error(
        "function code {0:02} is neither a read nor the request for a diagnostic object and was \
         not sent; this program only reads"
    )]
    Function(u8),
    /// A HART command.
    #[error(
        "HART command {0} with these data is no read and was not sent; this program only reads"
    )]
    Command(u16),
    /// Bytes that are no request.
    #[error(
        "these bytes are no HART request that reads and were not sent; this program only reads"
    )]
    Bytes,
}

/// Why there is no permit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Denied {
    /// The unit is not declared as DOP, or its profile has no request register.
    #[error("unit {0} has no request register in the configuration")]
    NoTarget(u8),
    /// The word names no object and option that are known.
    #[error("0x{0:04X} names no known object and option, and was not sent")]
    Unknown(u16),
}

/// What may be written on one line: the request registers of its DOP devices. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Gate {
    targets: Arc<[Target]>,
    /// This is a HART line: only HART passes, and only what reads.
    hart: bool,
}

/// The request register of one device.
#[derive(Debug)]
struct Target {
    unit: u8,
    address: u16,
    function: u8,
    profile: Arc<Profile>,
}

impl Target {
    fn pdu(&self, request: Request) -> Vec<u8> {
        let [a, b] = self.address.to_be_bytes();
        let [c, d] = request.word().to_be_bytes();
        match self.function {
            16 => vec![16, a, b, 0, 1, 2, c, d],
            _ => vec![6, a, b, c, d],
        }
    }
}

/// Leave to write one request for a diagnostic object. Only a [`Gate`] makes them.
#[derive(Debug)]
pub struct DopPermit {
    unit: u8,
    address: u16,
    function: u8,
    request: Request,
    pdu: Vec<u8>,
}

impl DopPermit {
    /// The unit that is asked.
    #[must_use]
    pub const fn unit(&self) -> u8 {
        self.unit
    }

    /// The address of its request register.
    #[must_use]
    pub const fn address(&self) -> u16 {
        self.address
    }

    /// The function code: 6, or 16 with one register.
    #[must_use]
    pub const fn function(&self) -> u8 {
        self.function
    }

    /// What is asked for.
    #[must_use]
    pub const fn request(&self) -> Request {
        self.request
    }

    /// The request PDU.
    #[must_use]
    pub fn pdu(&self) -> &[u8] {
        &self.pdu
    }

    /// Length of a good response PDU, which is the same for both functions.
    #[must_use]
    pub const fn response_len(&self) -> usize {
        5
    }
}

impl Gate {
    /// The gate of a line with these devices. Whatever is not declared as DOP, or has no address
    /// for the request, can't be written to at all.
    #[must_use]
    pub fn of(devices: &[DeviceConfig]) -> Self {
        let target = |device: &DeviceConfig| {
            let profile = device.profile.as_ref()?;
            (device.device == Device::Dop).then_some(())?;
            Some(Target {
                unit: device.unit,
                address: profile.registers.request?,
                function: match profile.request_function() {
                    16 => 16,
                    _ => 6,
                },
                profile: Arc::clone(profile),
            })
        };
        Self {
            targets: devices.iter().filter_map(target).collect(),
            hart: false,
        }
    }

    /// The gate of a HART line: nothing that writes passes, whatever the configuration says.
    #[must_use]
    pub fn hart() -> Self {
        Self {
            targets: Arc::default(),
            hart: true,
        }
    }

    /// Leave to ask a unit for a diagnostic object.
    ///
    /// # Errors
    /// If the unit has no request register, or nobody knows what is asked for.
    pub fn permit(&self, unit: u8, request: Request) -> Result<DopPermit, Denied> {
        let target = self.targets.iter().find(|t| t.unit == unit);
        let target = target.ok_or(Denied::NoTarget(unit))?;
        if !request.is_known(&target.profile) {
            return Err(Denied::Unknown(request.word()));
        }
        Ok(DopPermit {
            unit,
            address: target.address,
            function: target.function,
            request,
            pdu: target.pdu(request),
        })
    }

    /// True if this PDU is the request for a diagnostic object of this unit, to the byte.
    fn is_request(&self, unit: u8, pdu: &[u8]) -> bool {
        let word = match pdu {
            [6, _, _, high, low] | [16, _, _, 0, 1, 2, high, low] => {
                u16::from_be_bytes([*high, *low])
            }
            _ => return false,
        };
        self.permit(unit, Request::from_word(word))
            .is_ok_and(|permit| permit.pdu == pdu)
    }

    /// Checks a whole frame before its first byte is sent: it must be one read, or one permitted
    /// request for a diagnostic object, complete, and nothing else.
    ///
    /// # Errors
    /// If the bytes are anything else.
    pub fn admit(&self, framing: Framing, frame: &[u8]) -> Result<(), NotARead> {
        if self.hart {
            let admitted = match framing {
                Framing::Hart => hart::gate::admit(frame),
                Framing::HartIp => hart::gate::admit_ip(frame),
                Framing::Rtu | Framing::Ascii | Framing::Tcp => Err(hart::gate::Refused(None)),
            };
            let why = |why: hart::gate::Refused| why.0.map_or(NotARead::Bytes, NotARead::Command);
            return admitted.map_err(why);
        }
        let pdu = pdu_of(frame, framing).unwrap_or_default();
        let unit = match framing {
            Framing::Rtu => frame.first().copied(),
            Framing::Ascii => frame.get(1..3).and_then(hex_pair),
            Framing::Tcp => frame.get(6).copied(),
            // No HART command leaves through the gate of another line.
            Framing::Hart | Framing::HartIp => None,
        };
        let transaction = match (framing, frame) {
            (Framing::Tcp, [high, low, ..]) => u16::from_be_bytes([*high, *low]),
            _ => 0,
        };
        let complete = request(&pdu) == Length::Exact(pdu.len());
        // Nothing may hide behind it: the frame made from this PDU has to be this frame.
        let whole = |unit| encode::frame(framing, transaction, unit, &pdu) == frame;
        let allowed = |unit| is_read(&pdu) || self.is_request(unit, &pdu);
        match unit {
            Some(unit) if complete && whole(unit) && allowed(unit) => Ok(()),
            _ => Err(NotARead::Function(pdu.first().copied().unwrap_or(0))),
        }
    }
}

/// True for PDUs that change nothing in a device.
///
/// Source: Modbus Application Protocol V1.1b3, section 6. Of the diagnostics (08) the echo and the
/// counters are let through: others clear counters or silence a device. Of the encapsulated
/// interface (43) only the device identification: what CANopen devices make of the other is their
/// own affair.
#[must_use]
pub fn is_read(pdu: &[u8]) -> bool {
    match pdu {
        [1..=4 | 7 | 11 | 12 | 17 | 20 | 24, ..] | [8, 0, 0, ..] | [43, 0x0E, ..] => true,
        [8, high, low, 0, 0] => is_counter(u16::from_be_bytes([*high, *low])),
        _ => false,
    }
}

/// A complete request of every function code: with the length that the standard gives it, and
/// where it gives none, with four bytes of data.
#[cfg(test)]
pub(super) fn every_function() -> impl Iterator<Item = Vec<u8>> {
    (0..=255_u8).map(|function| {
        let mut pdu = match function {
            15 | 16 => vec![function, 0, 0, 0, 1, 2, 0, 1],
            20 | 21 => vec![function, 9, 6, 0, 2, 0, 0, 0, 1, 0, 1],
            23 => vec![function, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 1],
            43 => vec![function, 14, 1, 0],
            _ => vec![function, 0, 0, 0, 1, 0, 0, 0, 0],
        };
        match function {
            20 => pdu = vec![20, 7, 6, 0, 2, 0, 0, 0, 1],
            _ => {
                if let Length::Exact(len) = request(&pdu) {
                    pdu.truncate(len);
                }
            }
        }
        pdu
    })
}

#[cfg(test)]
mod tests;
