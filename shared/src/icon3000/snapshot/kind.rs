//! What sort of value a register holds: the ones people set, or the ones that change by themselves.

use crate::address::Table;
use crate::map::row::{Access, Row};

/// What a change is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sort {
    /// What somebody set: the reason to compare.
    Configuration,
    /// Who the device is.
    Identity,
    /// Logs of alarms, warnings, events and connections.
    Log,
    /// Torque curves, stroke tests and recorders.
    Curve,
    /// Positions, states and measurements at the time of the read, and commands.
    State,
    /// What only counts up.
    Counter,
    /// Date and time.
    Clock,
}

impl Sort {
    /// The word used in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Configuration => "configuration",
            Self::Identity => "identity",
            Self::Log => "log",
            Self::Curve => "curve",
            Self::State => "state",
            Self::Counter => "counter",
            Self::Clock => "clock",
        }
    }

    /// What people read.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Configuration => "Configuration",
            Self::Identity => "Identity",
            Self::Log => "Logs",
            Self::Curve => "Curves",
            Self::State => "State and measurements",
            Self::Counter => "Counters",
            Self::Clock => "Clock",
        }
    }

    /// True for what changes without anybody changing the device.
    #[must_use]
    pub const fn is_passing(self) -> bool {
        matches!(self, Self::State | Self::Counter | Self::Clock)
    }

    /// The sort of a value of the map.
    #[must_use]
    pub fn of(row: &Row) -> Self {
        let writable = matches!(row.access, Access::Write | Access::WriteGuarded);
        // Commands and the login are asked of the device, not set in it.
        let passing = ["Commands", "Security"].contains(&row.group)
            || row.key.ends_with("position_request")
            || row.table == Table::Coil;
        match row.group {
            "Clock" => Self::Clock,
            "Statistics" | "Temperatures" if !writable => Self::Counter,
            "Logs" => Self::Log,
            "Torque" | "Torque curves" if !writable => Self::Curve,
            "Identity" => Self::Identity,
            _ if row.key.contains("counter") && !writable => Self::Counter,
            _ if row.key.ends_with("_stored") => Self::Counter,
            _ if writable && !passing => Self::Configuration,
            _ => Self::State,
        }
    }
}
