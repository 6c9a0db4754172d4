//! What a pattern of faults means, in words.
//!
//! The guide prints seven patterns (section 4.3.2). They all follow from one picture, which also
//! answers for the patterns that it does not print: the cable is a row of stretches from host port
//! 1 through the units to host port 2; a stretch is whole or not; a unit answers or not, and one
//! that does not still passes the signal on.
//!
//! - A unit that answers through a port proves that all stretches between them are whole.
//! - A unit that does not answer although the signal passes it is off-line.
//! - Two neighbours of which each answers through its own port only have a break between them.
//! - Units that do not answer on the far side of a break may be off-line or cut off: that can't be
//!   told apart, and the finding says so.
//!
//! **Invariant:** a finding that is not [ambiguous](Finding::is_ambiguous) follows from the pattern;
//! it is wrong only if the pattern is old. [`Diagnosis::unsettled`] says whether it may be. What
//! changes twice within two passes on each port may escape that, as it may escape every master that
//! asks one unit after the other.

mod pattern;
mod words;

use core::fmt;

use super::HostPort;

pub use pattern::diagnose;

/// An end of a stretch of cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// A port of the host, or its converter.
    Port(HostPort),
    /// A unit.
    Unit {
        /// Its place in the order of the cable, from 0.
        place: usize,
        /// Its address.
        unit: u8,
    },
}

impl End {
    /// Its place along the cable: that of a unit from 1, 0 for host port 1.
    const fn rank(self) -> usize {
        match self {
            Self::Port(HostPort::One) => 0,
            Self::Port(HostPort::Two) => usize::MAX,
            Self::Unit { place, .. } => place.saturating_add(1),
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(port) => port.fmt(f),
            Self::Unit { unit, .. } => write!(f, "unit {unit}"),
        }
    }
}

/// One thing that the pattern says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// All units answer through all ports (examples 1 and 5).
    NoFault,
    /// The host itself lost the port: nothing can be told about the cable there.
    PortDown(HostPort),
    /// So many pairs of unit and port were not tried yet.
    Untried(usize),
    /// The unit does not answer, although the signal passes it (examples 2 and 6).
    OffLine(End),
    /// A break or short between two neighbours (example 3); only unsteady units may stand between.
    Break {
        /// The end towards host port 1.
        from: End,
        /// The end towards host port 2.
        to: End,
    },
    /// No unit answers through this port, but all others do through the other one: the port, its
    /// converter, or the cable to the first unit (example 4 and its mirror).
    PortLost {
        /// The port.
        port: HostPort,
        /// The unit next to it.
        next: End,
    },
    /// A break or short somewhere between two ends with silent units between them: they may be
    /// off-line, or cut off by a second break. Ambiguous.
    BreakAmong {
        /// The end towards host port 1.
        from: End,
        /// The end towards host port 2.
        to: End,
        /// The silent units.
        silent: Vec<u8>,
    },
    /// With one port: nothing answers from here on (example 7): a break or short before the first
    /// of them, or none of them has power, or some of both. Ambiguous.
    Beyond {
        /// The last that answers, or the port.
        from: End,
        /// The first that does not.
        to: End,
        /// All that do not answer, in the order of the cable.
        silent: Vec<u8>,
    },
    /// With one port: the last unit does not answer: off-line, or a break before it. Ambiguous.
    LastUnit {
        /// The one before it, or the port.
        from: End,
        /// The last unit.
        unit: End,
    },
    /// No unit answers through any port. Ambiguous.
    Nothing {
        /// Number of units.
        units: usize,
        /// Whether a short anywhere would silence them all: a multi-drop line.
        multi_drop: bool,
        /// The port, if the host has or uses just one.
        port: Option<HostPort>,
    },
    /// These units come and go, and are left out of the rest. Ambiguous.
    Unsteady(Vec<u8>),
    /// The unit answers through one port only, although units beyond it answer through the other:
    /// no state of the cable explains it. Ambiguous.
    OneSided {
        /// The unit.
        unit: End,
        /// The port through which it does not answer.
        port: HostPort,
    },
}

/// What a table of faults means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnosis {
    /// What it says: from host port 1 to host port 2, never empty.
    pub findings: Vec<Finding>,
    /// How many polls must still bear it out. Until it is 0 the table may be a mixture of before
    /// and after a change, and the findings are preliminary.
    pub unsettled: usize,
}

impl Diagnosis {
    /// True if a finding is more than a guess: every poll since the last change bears it out, no
    /// unit contradicts the picture, and the pattern has one meaning only.
    #[must_use]
    pub fn is_certain(&self, finding: &Finding) -> bool {
        let doubt = |f: &Finding| matches!(f, Finding::OneSided { .. } | Finding::Untried(_));
        self.unsettled == 0 && !finding.is_ambiguous() && !self.findings.iter().any(doubt)
    }

    /// What is to be said of its certainty; empty if there is nothing.
    #[must_use]
    pub fn caution(&self) -> String {
        match self.unsettled {
            0 => String::new(),
            1 => "Preliminary: one poll must still bear it out.".to_owned(),
            n => format!("Preliminary: {n} polls must still bear it out."),
        }
    }
}

impl Finding {
    /// A word for programs.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::NoFault => "no_fault",
            Self::PortDown(_) => "port_down",
            Self::Untried(_) => "untried",
            Self::OffLine(_) => "off_line",
            Self::Break { .. } => "break",
            Self::PortLost { .. } => "port_lost",
            Self::BreakAmong { .. } => "break_among",
            Self::Beyond { .. } => "beyond",
            Self::LastUnit { .. } => "last_unit",
            Self::Nothing { .. } => "nothing",
            Self::Unsteady(_) => "unsteady",
            Self::OneSided { .. } => "one_sided",
        }
    }

    /// True if more than one state of the network gives this pattern; [`why`](Self::why) says which.
    #[must_use]
    pub const fn is_ambiguous(&self) -> bool {
        matches!(
            self,
            Self::BreakAmong { .. }
                | Self::Beyond { .. }
                | Self::LastUnit { .. }
                | Self::Nothing { .. }
                | Self::Unsteady(_)
                | Self::OneSided { .. }
                | Self::Untried(_)
        )
    }

    /// Where the cable is or may be broken: the ends of the stretch, the one towards host port 1
    /// first.
    #[must_use]
    pub fn stretch(&self) -> Option<(End, End)> {
        let (one, two) = match self {
            Self::Break { from, to }
            | Self::BreakAmong { from, to, .. }
            | Self::Beyond { from, to, .. } => (*from, *to),
            Self::LastUnit { from, unit } => (*from, *unit),
            Self::PortLost { port, next } => (End::Port(*port), *next),
            _ => return None,
        };
        Some(if one.rank() <= two.rank() {
            (one, two)
        } else {
            (two, one)
        })
    }
}

#[cfg(test)]
mod tests;
