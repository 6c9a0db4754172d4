//! Findings in words.

use core::fmt;

use super::{End, Finding};

impl Finding {
    /// What else it could be, or what can't be told and why; empty if there is nothing.
    #[must_use]
    pub fn why(&self) -> String {
        match self {
            Self::BreakAmong { silent, .. } => format!(
                "{} between: without power they pass the signal on, between two breaks they get none. Both look the same from the host.",
                units(silent)
            ),
            Self::Beyond { silent, .. } => format!(
                "One port sees the near side of a break only: {} may be cut off, without power, or some of each.",
                units(silent)
            ),
            Self::LastUnit { .. } => "No unit stands behind it whose answer would show that the cable is whole.".to_owned(),
            Self::Nothing { units: 1, .. } => "With one unit, a dead unit, a dead port and a broken cable all look the same.".to_owned(),
            Self::Nothing { port: None, .. } => "Dead ports, breaks at both ends and units without power all look the same.".to_owned(),
            Self::Nothing { .. } => "A dead port, a break before the first unit and units without power all look the same.".to_owned(),
            Self::OneSided { .. } => "The signal gets past the unit both ways, so no break explains it; noise, a changing fault or a damaged port of the unit may.".to_owned(),
            Self::Unsteady(_) => "A loose contact, noise and a supply that drops out look the same.".to_owned(),
            Self::Untried(_) => "Not every unit was tried on each port yet, since the start or since a port came back.".to_owned(),
            Self::NoFault
            | Self::PortDown(_)
            | Self::OffLine(_)
            | Self::Break { .. }
            | Self::PortLost { .. } => String::new(),
        }
    }
}

/// `unit 4`, `units 4 and 5`, `units 4, 5 and 6`, and no more than eight by name.
fn units(list: &[u8]) -> String {
    const MOST: usize = 8;
    let Some((last, before)) = list.split_last() else {
        return "no unit".to_owned();
    };
    if before.is_empty() {
        return format!("unit {last}");
    }
    let mut text = String::from("units ");
    for (at, unit) in before.iter().take(MOST).enumerate() {
        if at > 0 {
            text.push_str(", ");
        }
        text.push_str(&unit.to_string());
    }
    match before.len().checked_sub(MOST) {
        None | Some(0) => text.push_str(&format!(" and {last}")),
        Some(more) => text.push_str(&format!(", {more} more and {last}")),
    }
    text
}

impl fmt::Display for Finding {
    /// What happened and what to look at.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFault => f.write_str("No fault: every unit answers through every port."),
            Self::PortDown(port) => write!(
                f,
                "The host lost {port}: see to its cable, its converter or its settings. Nothing is known of the cable there."
            ),
            Self::Untried(1) => f.write_str("Not known yet: one poll is still to be made."),
            Self::Untried(count) => write!(f, "Not known yet: {count} polls are still to be made."),
            Self::OffLine(end) => write!(
                f,
                "{} is off-line: the signal passes it, but it does not answer. Most likely it has no power.",
                Capital(end)
            ),
            Self::Break { from, to } if matches!((from, to), (End::Port(_), _) | (_, End::Port(_))) => write!(
                f,
                "Break or short between {from} and {to}, or loss of the port: look at the cable, its terminals and the power of the converter there."
            ),
            Self::Break { from, to } => write!(
                f,
                "Break or short between {from} and {to}: look at the cable, its terminals and its termination there."
            ),
            Self::PortLost { port, next } => write!(
                f,
                "Loss of {port}: no unit answers through it. Look at the cable between it and {next}, the terminals at both, and the power of its converter."
            ),
            Self::BreakAmong { from, to, silent } => write!(
                f,
                "Break or short somewhere between {from} and {to}; {} not answer.",
                if silent.len() == 1 {
                    format!("{} does", units(silent))
                } else {
                    format!("{} do", units(silent))
                }
            ),
            Self::Beyond { from, to, .. } => write!(
                f,
                "No unit answers from {to} on: break or short between {from} and {to}, or bad terminals at either, or no power from {to} on."
            ),
            Self::LastUnit { from, unit } => write!(
                f,
                "{}, the last one, does not answer: it is off-line, or the cable between {from} and {unit} is broken or shorted.",
                Capital(unit)
            ),
            Self::Nothing {
                units: 1,
                ..
            } => f.write_str("The only unit does not answer: it is off-line, or its cable, the host port or the converter fails."),
            Self::Nothing {
                multi_drop, port, ..
            } => {
                match port {
                    Some(port) => write!(f, "No unit answers: look at {port}, its converter and its cable first")?,
                    None => f.write_str("No unit answers through either port: look at both ports, their converters and cables first")?,
                }
                if *multi_drop {
                    f.write_str("; a short anywhere on the line silences all")?;
                }
                f.write_str(".")
            }
            Self::Unsteady(list) => {
                let (are, they) = match list.len() {
                    1 => ("comes and goes", "It is"),
                    _ => ("come and go", "They are"),
                };
                let mut text = units(list);
                if let Some(first) = text.get_mut(..1) {
                    first.make_ascii_uppercase();
                }
                write!(
                    f,
                    "{text} {are}: answers began and ended several times in the last passes. {they} left out of what is said of the cable."
                )
            }
            Self::OneSided { unit, port } => write!(
                f,
                "{} does not answer through {port}, but units beyond it do.",
                Capital(unit)
            ),
        }
    }
}

/// The end at the beginning of a sentence.
struct Capital<'a>(&'a End);

impl fmt::Display for Capital<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            End::Port(port) => write!(f, "Host port {}", port.number()),
            End::Unit { unit, .. } => write!(f, "Unit {unit}"),
        }
    }
}
