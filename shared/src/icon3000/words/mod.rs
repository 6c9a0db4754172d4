//! What the settings say in words: stroke test, positioner, fail-safe, modes, interlocks, inputs
//! and relays.
//!
//! Every statement names the registers that it rests on, and where each was read: an older copy of a
//! register (reading E44) counts where the register itself was not read. What was not read at all is
//! said to be unknown.

mod contacts;
mod look;
mod settings;
mod stroke;

pub use contacts::{Contact, inputs, relays};
pub use settings::{fail_safe, interlocks, modes, positioner};
pub use stroke::{Pst, pst};

use crate::map::row::Source;
use look::Look;

/// Whether something holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// It does.
    Yes,
    /// It does not.
    No,
    /// What it rests on was not read.
    Unknown,
}

/// One statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// Frozen identifier.
    pub key: &'static str,
    /// In words.
    pub text: String,
    /// Whether it is as it should be, where that can be said.
    pub holds: Option<Truth>,
    /// Holding registers that it rests on.
    pub registers: Vec<u16>,
    /// Where each of them was read, or would have to be: `HR 3019`, `HR 7`, `DI 19`.
    pub from: Vec<String>,
    /// Where the manual says so.
    pub source: Source,
    /// True if the manual does not say it in so many words.
    pub inferred: bool,
}

const fn section(part: &'static str) -> Source {
    Source {
        doc: "VCIOM-16345-EN",
        part,
    }
}

impl Statement {
    fn holding(self, holds: Truth) -> Self {
        Self {
            holds: Some(holds),
            ..self
        }
    }

    fn inferred(self) -> Self {
        Self {
            inferred: true,
            ..self
        }
    }
}
