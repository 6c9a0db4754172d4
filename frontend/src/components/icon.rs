//! The icons of the page, drawn for it: 20 units square, stroke 1.5, no fill.

use leptos::prelude::*;

/// What an icon says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Glyph {
    /// Bytes under a lens.
    Decode,
    /// A valve.
    Devices,
    /// Frames going both ways.
    Traffic,
    /// Sliders.
    Settings,
    /// To a device.
    Right,
    /// From a device.
    Left,
    /// Open or closed.
    Chevron,
    /// A cross.
    Close,
    /// Two sheets.
    Copy,
    /// Into a tray.
    Save,
    /// A sheet.
    File,
    /// A loop.
    Poll,
    /// Two bars.
    Pause,
    /// A triangle.
    Play,
    /// A bin.
    Clear,
    /// A lens.
    Search,
    /// A link of a chain.
    Link,
    /// A circle with an i.
    Note,
    /// A padlock.
    Lock,
    /// An arrow up, for travel.
    Up,
    /// An arrow down, for travel.
    Down,
    /// A broken line.
    NoLine,
}

impl Glyph {
    /// Its lines, in a square of 20 units.
    #[must_use]
    pub const fn path(self) -> &'static str {
        match self {
            Self::Decode => {
                "M3 4h4v4H3zM3 12h4v4H3zM13 4h4M11 4h.01M11 8h6M11 12h3M17 12h.01M11 16h6"
            }
            Self::Devices => "M3 9.5v7l7-3.5 7 3.5v-7L10 13zM10 13V5M6.5 5h7M7.5 2.5h5",
            Self::Traffic => "M3 7h12l-3-3M17 13H5l3 3",
            Self::Settings => "M3 6h7M14 6h3M3 14h3M10 14h7M12 4v4M8 12v4",
            Self::Right => "M4 10h12l-4-4M16 10l-4 4",
            Self::Left => "M16 10H4l4-4M4 10l4 4",
            Self::Chevron => "M8 6l4 4-4 4",
            Self::Close => "M5 5l10 10M15 5L5 15",
            Self::Copy => "M7 7h9v9H7zM13 7V4H4v9h3",
            Self::Save => "M10 3v9M6.5 8.5L10 12l3.5-3.5M4 14v3h12v-3",
            Self::File => "M5 3h7l3 3v11H5zM12 3v3h3",
            Self::Poll => "M16 10a6 6 0 1 1-2-4.5M16 3v3.5h-3.5",
            Self::Pause => "M7 4.5v11M13 4.5v11",
            Self::Play => "M7 4.5v11l8.5-5.5z",
            Self::Clear => "M4 6h12M8 6V4h4v2M6 6l.7 10.5h6.6L14 6",
            Self::Search => "M8.5 3.5a5 5 0 1 0 .01 0M12.5 12.5l4 4",
            Self::Link => {
                "M8.5 11.5l3-3M7 9l-2 2a2.8 2.8 0 0 0 4 4l2-2M13 11l2-2a2.8 2.8 0 0 0-4-4L9 7"
            }
            Self::Note => "M10 3a7 7 0 1 0 .01 0M10 9v4.5M10 6.3v.2",
            Self::Lock => "M5 9h10v8H5zM7 9V6.5a3 3 0 0 1 6 0V9",
            Self::Up => "M10 16V4M5.5 8.5L10 4l4.5 4.5",
            Self::Down => "M10 4v12M5.5 11.5L10 16l4.5-4.5",
            Self::NoLine => "M2 10h5M13 10h5M8 6l4 8",
        }
    }
}

/// An icon beside a text that says the same.
#[component]
pub fn Icon(
    /// Which one.
    glyph: Glyph,
    /// Size in pixels.
    #[prop(default = 16)]
    size: u8,
) -> impl IntoView {
    view! {
        <svg
            class="icon"
            width=size
            height=size
            viewBox="0 0 20 20"
            fill="none"
            stroke="currentColor"
            stroke-width="1.5"
            stroke-linecap="round"
            stroke-linejoin="round"
            aria-hidden="true"
        >
            <path d=glyph.path()></path>
        </svg>
    }
}
