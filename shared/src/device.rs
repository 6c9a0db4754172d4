//! The devices that can be chosen for decoding.

use crate::map::row::{DeviceMap, Model};

/// Rotork actuators that take a HART field unit; their status bits differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// CVA range: CVL linear, CVQ quarter-turn.
    Cva,
    /// IQ3 and IQ3 Pro, multi-turn and part-turn.
    Iq,
    /// CMA range: linear, quarter-turn, rotary.
    Cma,
    /// CK range with Atronik or Centronik controls.
    Ck,
    /// SI3 and SI4, fluid power.
    Si,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 5] = [Self::Cva, Self::Iq, Self::Cma, Self::Ck, Self::Si];

    /// The word used on the command line and in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Cva => "rotork-cva",
            Self::Iq => "rotork-iq",
            Self::Cma => "rotork-cma",
            Self::Ck => "rotork-ck",
            Self::Si => "rotork-si",
        }
    }

    /// The name shown to people.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Cva => "Rotork CVA",
            Self::Iq => "Rotork IQ",
            Self::Cma => "Rotork CMA",
            Self::Ck => "Rotork CK",
            Self::Si => "Rotork SI",
        }
    }
}

/// What is at the other end, as far as decoding needs to know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Device {
    /// Not known: registers are shown by address and as raw numbers.
    #[default]
    None,
    /// Biffi ICON2000v4: inputs, and holding registers 0 to 21.
    Icon2000v4,
    /// Biffi ICON3000 (Modbus interface firmware before 4.00).
    Icon3000,
    /// Biffi ICON3000v2 (Modbus interface firmware 4.00 or later).
    Icon3000v2,
    /// Limitorque MX or QX, series B, with the diagnostics object protocol (DOP). Which registers
    /// serve it is in the profile of the site; its other registers are shown as raw numbers.
    Dop,
    /// Limitorque MX/DDC: the field unit of an actuator, DDC-100 network.
    Ddc100Mx,
    /// Limitorque MX or QX, series B, on a DDC-100 network: as [`Ddc100Mx`](Self::Ddc100Mx), with a
    /// bit for the user indicators.
    Ddc100MxB,
    /// Limitorque UEC-3-DDC: the field unit of an actuator, DDC-100 network.
    Ddc100Uec,
    /// Limitorque DDC-100 clamshell field unit.
    Ddc100Clamshell,
    /// Limitorque DDC-100 I/O module in non-valve service.
    Ddc100Io,
    /// A Rotork actuator with a HART field unit.
    Rotork(Family),
}

impl Device {
    /// All choices on a Modbus line.
    pub const ALL: [Self; 10] = [
        Self::Icon3000v2,
        Self::Icon3000,
        Self::Icon2000v4,
        Self::Ddc100Mx,
        Self::Ddc100MxB,
        Self::Ddc100Uec,
        Self::Ddc100Clamshell,
        Self::Ddc100Io,
        Self::Dop,
        Self::None,
    ];

    /// The word used on the command line, in the configuration and in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Icon2000v4 => "icon2000v4",
            Self::Icon3000 => "icon3000",
            Self::Icon3000v2 => "icon3000v2",
            Self::Dop => "dop",
            Self::Rotork(family) => family.key(),
            Self::Ddc100Mx => "ddc100-mx",
            Self::Ddc100MxB => "ddc100-mx-b",
            Self::Ddc100Uec => "ddc100-uec",
            Self::Ddc100Clamshell => "ddc100-clamshell",
            Self::Ddc100Io => "ddc100-io",
        }
    }

    /// The name shown to people.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::None => "No device map",
            Self::Icon2000v4 => "Biffi ICON2000v4",
            Self::Icon3000 => "Biffi ICON3000",
            Self::Icon3000v2 => "Biffi ICON3000v2",
            Self::Dop => "Limitorque DOP",
            Self::Rotork(family) => family.label(),
            Self::Ddc100Mx => "Limitorque DDC-100 MX",
            Self::Ddc100MxB => "Limitorque DDC-100 MX series B",
            Self::Ddc100Uec => "Limitorque DDC-100 UEC-3",
            Self::Ddc100Clamshell => "Limitorque DDC-100 Clamshell",
            Self::Ddc100Io => "Limitorque DDC-100 I/O Module",
        }
    }

    /// The device with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        let rotork = Family::ALL.into_iter().map(Self::Rotork);
        Self::ALL.into_iter().chain(rotork).find(|d| d.key() == key)
    }

    /// Its map; `None` in a program that was compiled without maps.
    #[must_use]
    pub fn map(self) -> Option<&'static DeviceMap> {
        if !cfg!(feature = "maps") {
            return None;
        }
        match self {
            Self::None | Self::Dop | Self::Rotork(_) => None,
            Self::Icon2000v4 => Some(Model::Icon2000v4.map()),
            Self::Icon3000 => Some(Model::Icon3000.map()),
            Self::Icon3000v2 => Some(Model::Icon3000v2.map()),
            Self::Ddc100Mx => Some(Model::Ddc100Mx.map()),
            Self::Ddc100MxB => Some(Model::Ddc100MxB.map()),
            Self::Ddc100Uec => Some(Model::Ddc100Uec.map()),
            Self::Ddc100Clamshell => Some(Model::Ddc100Clamshell.map()),
            Self::Ddc100Io => Some(Model::Ddc100Io.map()),
        }
    }

    /// The highest unit address that it can be given: that of the standard, unless its manual goes
    /// beyond.
    #[must_use]
    pub fn last_unit(self) -> u8 {
        self.map().map_or(247, |map| map.last_unit)
    }

    /// True for a device with diagnostic objects.
    #[must_use]
    pub const fn is_dop(self) -> bool {
        matches!(self, Self::Dop)
    }

    /// The family of a Rotork actuator.
    #[must_use]
    pub const fn family(self) -> Option<Family> {
        match self {
            Self::Rotork(family) => Some(family),
            _ => None,
        }
    }

    /// True for a field unit of a DDC-100 network.
    #[must_use]
    pub const fn is_ddc(self) -> bool {
        matches!(
            self,
            Self::Ddc100Mx
                | Self::Ddc100MxB
                | Self::Ddc100Uec
                | Self::Ddc100Clamshell
                | Self::Ddc100Io
        )
    }

    /// True for the ICON3000 family.
    #[must_use]
    pub const fn is_icon(self) -> bool {
        matches!(self, Self::Icon2000v4 | Self::Icon3000 | Self::Icon3000v2)
    }

    /// False if the manual says that the device refuses this function code.
    #[must_use]
    pub fn implements(self, function: u8) -> bool {
        self.map().is_none_or(|map| map.implements(function))
    }
}
