//! Where the registers are and how patient to be: from the profile of the site.

use super::MAX_COUNT;
use super::status::{Position, Shift};
use crate::address::Table;
use crate::dop::profile::Profile;
use core::fmt;

/// What a handshake needs to know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Address of the request register.
    pub request: u16,
    /// Address of the status register.
    pub status: u16,
    /// Address of the register with the number of response registers.
    pub count: u16,
    /// Address of the first response register.
    pub response: u16,
    /// Table of the registers that are read.
    pub table: Table,
    /// Function code that writes the request: 6 or 16.
    pub function: u8,
    /// Registers that one request may read.
    pub max_registers: u16,
    /// Microseconds from one look at the status to the next; the first three come sooner.
    pub poll: u64,
    /// Microseconds from the request to "ready" before it is given up.
    pub timeout: u64,
    /// How often a request is begun anew.
    pub retries: u8,
    /// Where the status bits stand, as far as is known.
    pub position: Position,
    /// The object that was read on this device before. Its "ready" may still stand there. If none
    /// was, the status is looked at first.
    pub previous: Option<u16>,
}

/// A setting without which nothing can be read (reading M7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The key in the profile.
    pub key: &'static str,
    /// It is there, but the response would go beyond address 65535.
    beyond: bool,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = self.key;
        if self.beyond {
            return write!(
                f,
                "{key} leaves no room for {MAX_COUNT} registers up to address 65535; correct it"
            );
        }
        write!(
            f,
            "the profile does not say where {key} is, and the manual names no address; take it \
             from the manual of the network board and set it"
        )
    }
}

impl Setup {
    /// The setup that a profile gives.
    ///
    /// # Errors
    /// If an address is not configured.
    pub fn of(profile: &Profile) -> Result<Self, Missing> {
        let need = |address: Option<u16>, key| address.ok_or(Missing { key, beyond: false });
        let registers = &profile.registers;
        let response = need(registers.response, "registers.response")?;
        if response.checked_add(MAX_COUNT.saturating_sub(1)).is_none() {
            return Err(Missing {
                key: "registers.response",
                beyond: true,
            });
        }
        let shift = profile.status.shift.and_then(Shift::new);
        Ok(Self {
            request: need(registers.request, "registers.request")?,
            status: need(registers.status, "registers.status")?,
            count: need(registers.count, "registers.count")?,
            response,
            table: profile.table(),
            function: profile.request_function(),
            max_registers: profile.max_registers(),
            poll: u64::from(profile.poll_ms()).saturating_mul(1000),
            timeout: u64::from(profile.timeout_ms()).saturating_mul(1000),
            retries: u8::try_from(profile.retries()).unwrap_or(u8::MAX),
            position: shift.map_or(Position::Unknown, Position::Configured),
            previous: None,
        })
    }
}
