//! What asking a command may do.

/// What a device may do when it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Effect {
    /// It answers and nothing else.
    Reads,
    /// What it stores or reports changes.
    Config,
    /// The valve or a relay may move.
    Moves,
    /// It may leave the line.
    Ends,
    /// The command inside decides.
    Carries,
    /// Nothing is known.
    Unknown,
}

impl Effect {
    /// The word used in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Reads => "reads",
            Self::Config => "config",
            Self::Moves => "moves",
            Self::Ends => "ends",
            Self::Carries => "carries",
            Self::Unknown => "unknown",
        }
    }

    /// What it means for people.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Reads => "reads",
            Self::Config => "changes the configuration",
            Self::Moves => "may move the valve or a relay",
            Self::Ends => "may end communication",
            Self::Carries => "carries another command",
            Self::Unknown => "has an unknown effect",
        }
    }
}
