//! The devices that can be chosen for decoding.

use crate::map::row::{DeviceMap, Model};

/// What is at the other end, as far as decoding needs to know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Device {
    /// Not known: registers are shown by address and as raw numbers.
    #[default]
    None,
    /// Biffi ICON3000 (Modbus interface firmware before 4.00).
    Icon3000,
    /// Biffi ICON3000v2 (Modbus interface firmware 4.00 or later).
    Icon3000v2,
}

impl Device {
    /// All choices.
    pub const ALL: [Self; 3] = [Self::Icon3000v2, Self::Icon3000, Self::None];

    /// The word used on the command line, in the configuration and in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Icon3000 => "icon3000",
            Self::Icon3000v2 => "icon3000v2",
        }
    }

    /// The name shown to people.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::None => "No device map",
            Self::Icon3000 => "Biffi ICON3000",
            Self::Icon3000v2 => "Biffi ICON3000v2",
        }
    }

    /// The device with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|d| d.key() == key)
    }

    /// Its map.
    #[must_use]
    pub fn map(self) -> Option<&'static DeviceMap> {
        match self {
            Self::None => None,
            Self::Icon3000 => Some(Model::Icon3000.map()),
            Self::Icon3000v2 => Some(Model::Icon3000v2.map()),
        }
    }

    /// True for the ICON3000 family.
    #[must_use]
    pub const fn is_icon(self) -> bool {
        matches!(self, Self::Icon3000 | Self::Icon3000v2)
    }

    /// False if the manual says that the device refuses this function code.
    ///
    /// Source: VCIOM-16345-EN, table 6; FC 20 only on the ICON3000v2 (section 8.11).
    #[must_use]
    pub const fn implements(self, function: u8) -> bool {
        match self {
            Self::None => true,
            Self::Icon3000 => matches!(function, 1..=6 | 8 | 15..=17),
            Self::Icon3000v2 => matches!(function, 1..=6 | 8 | 15..=17 | 20),
        }
    }
}
