//! Function codes: what is asked, what is refused, what is answered (VCIOM-16345-EN, section 8).
//!
//! The manual does not say in which order the checks are made (reading E81); this is the order of
//! the Modbus Application Protocol V1.1b3: function, quantity or value, address.

use super::store::{HOLDING, HOLDING_2000, HOLDING_V2, INPUTS, at};
use super::{Icon3000, count};
use crate::map::row::Model;

/// Exception codes (table 50).
pub(super) const ILLEGAL_FUNCTION: u8 = 1;
pub(super) const ILLEGAL_ADDRESS: u8 = 2;
pub(super) const ILLEGAL_VALUE: u8 = 3;
const FAILURE: u8 = 4;
const BUSY: u8 = 6;

/// Numbers of coils and discrete inputs.
const COILS: u16 = 11;
const DISCRETES: u16 = 32;

/// An answer without its function code, or an exception code.
pub(super) type Outcome = Result<Vec<u8>, u8>;

/// The first two words after the function code: address and quantity or value.
pub(super) fn two_words(data: &[u8]) -> Option<(u16, u16, &[u8])> {
    match data {
        [a, b, c, d, rest @ ..] => Some((
            u16::from_be_bytes([*a, *b]),
            u16::from_be_bytes([*c, *d]),
            rest,
        )),
        _ => None,
    }
}

/// Checks quantity and address; readings E53 and E56 for the addresses.
pub(super) fn range(start: u16, quantity: u16, most: u16, end: u16) -> Result<(), u8> {
    if !(1..=most).contains(&quantity) {
        return Err(ILLEGAL_VALUE);
    }
    match start.checked_add(quantity) {
        Some(past) if past <= end => Ok(()),
        _ => Err(ILLEGAL_ADDRESS),
    }
}

impl Icon3000 {
    /// The response PDU; `None` to a PDU of nothing.
    pub(super) fn respond(&mut self, pdu: &[u8]) -> Option<Vec<u8>> {
        let (function, data) = pdu.split_first()?;
        let outcome = if self.busy {
            count(&mut self.counters.busy);
            Err(BUSY)
        } else if self.failing {
            Err(FAILURE)
        } else {
            self.function(*function, data)
        };
        Some(match outcome {
            Ok(data) => {
                let mut response = vec![*function];
                response.extend(data);
                response
            }
            Err(code) => vec![function | 0x80, code],
        })
    }

    fn function(&mut self, function: u8, data: &[u8]) -> Outcome {
        match function {
            1..=4 => self.read(function, data),
            5 => self.write_coil(data),
            6 => self.write_register(data),
            8 => self.diagnostics(data),
            15 => self.write_coils(data),
            16 => self.write_registers(data),
            17 if data.is_empty() => Ok(self.report()),
            17 => Err(ILLEGAL_VALUE),
            20 if self.is_v2() => self.files(data),
            _ => Err(ILLEGAL_FUNCTION),
        }
    }

    /// One past the last holding register.
    pub(super) fn end_of_holding(&self) -> u16 {
        match self.model {
            Model::Icon2000v4 => HOLDING_2000,
            _ if self.is_v2() => HOLDING_V2,
            _ => HOLDING,
        }
    }

    fn read(&self, function: u8, data: &[u8]) -> Outcome {
        let Some((start, quantity, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let (most, end) = match function {
            1 => (COILS, COILS),
            2 => (DISCRETES, DISCRETES),
            3 => (125, self.end_of_holding()),
            _ => (125, INPUTS),
        };
        range(start, quantity, most, end)?;
        let all = start..start.saturating_add(quantity);
        let mut values = Vec::new();
        match function {
            1 | 2 => {
                let is_on = |address| {
                    if function == 1 {
                        self.coil(address)
                    } else {
                        self.discrete(address)
                    }
                };
                let all: Vec<bool> = all.map(is_on).collect();
                // The first is the lowest bit; what is left of the last byte stays 0.
                for eight in all.chunks(8) {
                    let byte = eight
                        .iter()
                        .rev()
                        .fold(0_u8, |b, on| b << 1 | u8::from(*on));
                    values.push(byte);
                }
            }
            3 => values.extend(all.flat_map(|a| self.store.get(a).to_be_bytes())),
            _ => values.extend(all.flat_map(|a| self.store.input(a).to_be_bytes())),
        }
        let mut answer = vec![u8::try_from(values.len()).map_err(|_| ILLEGAL_VALUE)?];
        answer.extend(values);
        Ok(answer)
    }

    fn diagnostics(&self, data: &[u8]) -> Outcome {
        let Some((sub, value, rest)) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let c = &self.counters;
        let counter = match sub {
            // Whatever comes goes back.
            0 => return Ok(data.to_vec()),
            11 => c.bus_messages,
            // Reading E59: the errors, not the exceptions.
            12 => c.bus_errors,
            13 => c.exceptions,
            14 => c.messages,
            17 => c.busy,
            18 => c.overruns,
            _ => return Err(ILLEGAL_FUNCTION),
        };
        if value != 0 || !rest.is_empty() {
            return Err(ILLEGAL_VALUE);
        }
        let mut answer = sub.to_be_bytes().to_vec();
        answer.extend(counter.to_be_bytes());
        Ok(answer)
    }

    /// Who this is (section 8.10). Reading E63: 82 is printed where 84 bytes follow.
    fn report(&self) -> Vec<u8> {
        let mut answer = vec![if self.full_report { 0x54 } else { 0x52 }, 0, 0];
        answer.extend(self.store.run(at::NAME, 8));
        answer.extend(self.store.run(at::SERIAL, 14));
        answer.extend(self.store.run(at::TAG, 14));
        answer.extend(self.store.run(at::BASE_VERSION, 2));
        answer.extend(b"  ");
        answer.extend(self.store.run(at::MODBUS_VERSION, 2));
        answer
    }
}
