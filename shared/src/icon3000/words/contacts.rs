//! What input bits and relays are set to show, and whether they do now.

use super::Look;
use crate::image::Image;
use crate::map::row::Model;

/// An input bit or a relay: what it shows, and whether it does now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contact {
    /// `DIN1`, `AS8`.
    pub name: String,
    /// What it shows, with its position where it has one: `Position <= % (3): 20 %`.
    pub function: String,
    /// Of a relay: whether the contact makes or breaks then.
    pub contact: Option<String>,
    /// The bit or contact as last read.
    pub is_on: Option<bool>,
    /// Registers that it rests on: function, position, state.
    pub registers: [u16; 3],
}

/// Functions that compare the position with a register of their own.
const BY_POSITION: [u16; 2] = [2, 3];

/// What DIN1 to DIN6 show (HR 3622 to 3633, bits 8 to 13 of HR 3001; reading E14).
#[must_use]
pub fn inputs(model: Model, image: &Image) -> Vec<Contact> {
    let look = Look { model, image };
    if model < Model::Icon3000v2 {
        return Vec::new();
    }
    (0..6_u16)
        .map(|at| {
            let (function, position) = (3622_u16.saturating_add(at), 3628_u16.saturating_add(at));
            let bit = u8::try_from(at).unwrap_or(0).saturating_add(8);
            Contact {
                name: format!("DIN{}", at.saturating_add(1)),
                function: look.function(function, position),
                contact: None,
                is_on: look.bit(3001, bit),
                registers: [function, position, 3001],
            }
        })
        .collect()
}

/// What the relays AS1 to AS8 show (HR 3580 to 3603, HR 3500; reading E14).
#[must_use]
pub fn relays(model: Model, image: &Image) -> Vec<Contact> {
    let look = Look { model, image };
    if model < Model::Icon3000v2 {
        return Vec::new();
    }
    (0..8_u16)
        .map(|at| {
            let (function, position) = (3580_u16.saturating_add(at), 3596_u16.saturating_add(at));
            Contact {
                name: format!("AS{}", at.saturating_add(1)),
                function: look.function(function, position),
                contact: Some(look.text(3588_u16.saturating_add(at))),
                is_on: look.bit(3500, u8::try_from(at).unwrap_or(0)),
                registers: [function, position, 3500],
            }
        })
        .collect()
}

impl Look<'_> {
    fn function(&self, function: u16, position: u16) -> String {
        let text = self.text(function);
        match self.word(function) {
            Some(code) if BY_POSITION.contains(&code) => {
                format!("{text}: {}", self.text(position))
            }
            _ => text,
        }
    }
}
