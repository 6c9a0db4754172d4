//! What the settings say in words: stroke test, positioner, fail-safe, modes, interlocks, inputs
//! and relays.
//!
//! Every statement names the registers that it rests on. What was not read is said to be unknown.

mod contacts;
mod stroke;

pub use contacts::{Contact, inputs, relays};
pub use stroke::{Pst, pst};

use super::say;
use crate::address::{Address, Table};
use crate::image::Image;
use crate::map::row::{Model, Row, Source};

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

/// Reads values for sentences.
struct Look<'a> {
    model: Model,
    image: &'a Image,
}

impl Look<'_> {
    fn word(&self, address: u16) -> Option<u16> {
        self.image
            .cell(Table::Holding, Address::new(address))
            .map(|c| c.word)
    }

    /// The word of the first of several mirrors that was read (reading E44).
    fn any(&self, addresses: &[u16]) -> Option<u16> {
        addresses.iter().find_map(|a| self.word(*a))
    }

    fn bit(&self, address: u16, bit: u8) -> Option<bool> {
        Some(self.word(address)?.wrapping_shr(bit.into()) & 1 != 0)
    }

    fn row(&self, address: u16) -> Option<&'static Row> {
        self.model
            .map()
            .row_at(Table::Holding, Address::new(address))
    }

    /// The value in words, or that it was not read.
    fn text(&self, address: u16) -> String {
        self.row(address)
            .and_then(|row| say::row(self.image, row))
            .unwrap_or_else(|| format!("unknown (HR {address} was not read)"))
    }

    fn truth(holds: Option<bool>) -> Truth {
        match holds {
            Some(true) => Truth::Yes,
            Some(false) => Truth::No,
            None => Truth::Unknown,
        }
    }
}

/// The positioner in words (section 9.2).
#[must_use]
pub fn positioner(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let source = section("section 9.2, p. 78");
    let mut said = vec![Statement {
        key: "positioner",
        text: format!(
            "The valve moves when request and position differ by more than {}; the motor starts \
             again not before {} have passed.",
            look.text(3017),
            look.text(3018)
        ),
        holds: None,
        registers: vec![3017, 3018],
        source,
        inferred: false,
    }];
    let on = look.bit(3002, 6);
    said.push(Statement {
        key: "positioner_mode",
        text: match on {
            Some(true) => format!("It is positioning now; the request is {}.", look.text(3007)),
            Some(false) => "It is not positioning now.".to_owned(),
            None => "Whether it is positioning is not known: HR 3002 was not read.".to_owned(),
        },
        holds: None,
        registers: vec![3002, 3007],
        source: section("table 5, HR 3002"),
        inferred: false,
    });
    if model >= Model::Icon3000v2 {
        said.push(Statement {
            key: "positioner_request",
            text: format!(
                "The function is {}; the request comes from {}, {}; 4 to 20 mA go from {} to {}.",
                look.text(3938),
                look.text(3936),
                look.text(3660),
                look.text(3661),
                look.text(3662)
            ),
            holds: None,
            registers: vec![3938, 3936, 3660, 3661, 3662],
            source: section("table 5, HR 3660 to 3662, 3936, 3938"),
            inferred: true,
        });
    }
    said
}

/// What the actuator does when the bus falls silent (section 9.3, reading E45).
#[must_use]
pub fn fail_safe(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let source = section("section 9.3, p. 79");
    let action = look.any(&[3019, 7]);
    let registers = vec![3019, 3020, 3021];
    let delay = look.any(&[3020, 8]);
    let seconds = delay.map(|d| u32::from(d).saturating_add(10));
    let after = seconds.zip(delay).map_or_else(
        || "after 10 s and a delay that was not read (HR 3020)".to_owned(),
        |(all, set)| format!("after {all} s (10 s and the {set} s that are set)"),
    );
    let what = match action {
        Some(0) => None,
        Some(1) => Some("closes".to_owned()),
        Some(2) => Some("opens".to_owned()),
        Some(3) => Some("stays where it is".to_owned()),
        Some(4) => Some(match look.any(&[3021, 9]) {
            Some(percent) => format!("goes to {percent} %"),
            None => "goes to a position that was not read (HR 3021)".to_owned(),
        }),
        Some(other) => Some(format!("does something that has no name (code {other})")),
        None => Some("does something that was not read (HR 3019)".to_owned()),
    };
    let mut said = vec![Statement {
        key: "fail_safe",
        text: match what {
            None => "Nothing happens when the bus falls silent: the action is Off.".to_owned(),
            Some(what) => format!(
                "When the bus falls silent the valve {what} {after}, only if the selector is in \
                 REMOTE and the bus was working. Hardwired ESD and interlocks come first."
            ),
        },
        holds: None,
        registers,
        source,
        inferred: false,
    }];
    if model >= Model::Icon3000v2 {
        let enabled = look.word(3940).map(|w| w == 1);
        said.push(Statement {
            key: "fail_safe_enabled",
            text: match enabled {
                Some(true) => "The function is enabled (HR 3940).".to_owned(),
                Some(false) => {
                    "The function is disabled (HR 3940): nothing of this happens.".to_owned()
                }
                None => "Whether it is enabled is not known: HR 3940 was not read.".to_owned(),
            },
            holds: Some(Look::truth(enabled)),
            registers: vec![3940],
            source: section("table 5, HR 3940"),
            inferred: true,
        });
    }
    said.push(Statement {
        key: "fail_safe_now",
        text: match look.bit(3002, 0) {
            Some(true) => "The fail-safe action is on now.".to_owned(),
            Some(false) => "The fail-safe action is not on now.".to_owned(),
            None => "Whether it is on is not known: HR 3002 was not read.".to_owned(),
        },
        holds: None,
        registers: vec![3002],
        source: section("table 5, HR 3002"),
        inferred: false,
    });
    said
}

/// Who commands the valve now.
#[must_use]
pub fn modes(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let place = match (look.bit(3002, 3), look.bit(3001, 4), look.bit(3001, 5)) {
        (Some(true), ..) => "The selector is in OFF: nobody moves the valve by command.",
        (_, Some(true), _) => "The selector is in LOCAL: only the knobs on the actuator command.",
        (_, _, Some(true)) => "The selector is in REMOTE: bus or hardwired inputs command.",
        (Some(false), Some(false), Some(false)) => "The selector is in no position.",
        _ => "Where the selector is is not known: HR 3001 or 3002 was not read.",
    };
    let mut said = vec![Statement {
        key: "selector",
        text: place.to_owned(),
        holds: None,
        registers: vec![3001, 3002],
        source: section("table 5, HR 3001, 3002"),
        inferred: false,
    }];
    for (register, bit, key, text) in [
        (
            3002,
            5,
            "hardwired",
            "The hardwired inputs command, not the bus.",
        ),
        (3002, 7, "inhibited", "The motor is inhibited."),
        (3002, 14, "esd", "An emergency shutdown is in progress."),
        (
            3002,
            15,
            "pst_running",
            "A partial stroke test is in progress.",
        ),
        (
            3003,
            14,
            "configuring",
            "Somebody configures the actuator on the spot.",
        ),
        (3003, 15, "handwheel", "The handwheel is engaged."),
        (
            3030,
            0,
            "maintenance",
            "The actuator is in maintenance operation.",
        ),
    ] {
        if look.bit(register, bit) == Some(true) {
            said.push(Statement {
                key,
                text: text.to_owned(),
                holds: None,
                registers: vec![register],
                source: section("table 5, HR 3002, 3003, 3030"),
                inferred: false,
            });
        }
    }
    said
}

/// The interlocks in words.
#[must_use]
pub fn interlocks(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let mut said = Vec::new();
    let mode = if look.word(3027).is_some() {
        3027
    } else {
        3920
    };
    said.push(Statement {
        key: "interlock_mode",
        text: format!("Interlock mode: {}.", look.text(mode)),
        holds: None,
        registers: vec![3027, 3920],
        source: section("table 5, HR 3027, 3920"),
        inferred: false,
    });
    for (bit, key, way) in [
        (14, "interlock_open", "Opening"),
        (15, "interlock_close", "Closing"),
    ] {
        said.push(Statement {
            key,
            text: match look.bit(3001, bit) {
                Some(true) => format!("{way} is interlocked now."),
                Some(false) => format!("{way} is not interlocked."),
                None => format!(
                    "Whether {} is interlocked is not known.",
                    way.to_ascii_lowercase()
                ),
            },
            holds: None,
            registers: vec![3001],
            source: section("table 5, HR 3001"),
            inferred: false,
        });
    }
    if model >= Model::Icon3000v2 {
        said.push(Statement {
            key: "interlock_signal",
            text: format!(
                "The opening interlock acts when its signal is {}, the closing one when it is {}.",
                look.text(3563),
                look.text(3564)
            ),
            holds: None,
            registers: vec![3563, 3564],
            source: section("table 5, HR 3563, 3564"),
            inferred: true,
        });
    }
    said
}
