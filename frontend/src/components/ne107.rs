//! The signs of NAMUR NE 107: colour, shape and letter, never colour alone. Drawn by
//! [`crate::markup::device::sign`].

/// A state with a sign of its own. Good has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sign {
    /// Maintenance required: blue diamond with an oil can.
    Maintenance,
    /// Out of specification: yellow triangle with a question mark.
    OutOfSpecification,
    /// Function check: orange triangle with a tool.
    FunctionCheck,
    /// Failure: red circle with a cross.
    Failure,
    /// A warning whose category is not told: a neutral triangle.
    Warning,
}

impl Sign {
    /// Its letter; a warning has none.
    #[must_use]
    pub const fn letter(self) -> &'static str {
        match self {
            Self::Failure => "F",
            Self::FunctionCheck => "C",
            Self::OutOfSpecification => "S",
            Self::Maintenance => "M",
            Self::Warning => "",
        }
    }

    /// Its name.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Failure => "Failure",
            Self::FunctionCheck => "Function check",
            Self::OutOfSpecification => "Out of specification",
            Self::Maintenance => "Maintenance required",
            Self::Warning => "Warning",
        }
    }

    /// Its class in the style sheet.
    #[must_use]
    pub const fn class(self) -> &'static str {
        match self {
            Self::Failure => "sign sign-f",
            Self::FunctionCheck => "sign sign-c",
            Self::OutOfSpecification => "sign sign-s",
            Self::Maintenance => "sign sign-m",
            Self::Warning => "sign sign-w",
        }
    }

    /// Outline and inner mark, in a square of 20 units.
    #[must_use]
    pub const fn paths(self) -> (&'static str, &'static str) {
        match self {
            Self::Failure => ("M10 1.5a8.5 8.5 0 1 0 .01 0z", "M6.5 6.5l7 7M13.5 6.5l-7 7"),
            Self::FunctionCheck => (
                "M10 1.5l9 16.5H1z",
                "M8 15l3.2-4.2M10.4 8.2a2 2 0 1 0 2.6 2.4l-1.6.2-.8-1z",
            ),
            Self::OutOfSpecification => (
                "M10 1.5l9 16.5H1z",
                "M8.2 9.2a1.9 1.9 0 1 1 2.6 1.9c-.6.2-.8.6-.8 1.3M10 15v.2",
            ),
            Self::Maintenance => (
                "M10 .8l9.2 9.2-9.2 9.2L.8 10z",
                "M5.5 9.5h6l2.5-2M6.5 9.5v4h5v-4M14 7.5l1 2.2",
            ),
            Self::Warning => ("M10 1.5l9 16.5H1z", "M10 8v4.2M10 15v.2"),
        }
    }
}
