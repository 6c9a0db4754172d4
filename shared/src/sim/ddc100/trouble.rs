//! What can go wrong, by name: for the simulator's setting and for tests.

use core::fmt;
use core::str::FromStr;

use crate::ddc100::HostPort;

/// Something that is wrong with the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trouble {
    /// `break-3`: the cable is cut behind the third unit, counted along the cable; 0 is before the
    /// first.
    Break(usize),
    /// `short-3`: the cable is shorted there.
    Short(usize),
    /// `port-2`: the host port, or its converter, is dead.
    Port(HostPort),
    /// `off-7`: something is wrong with the unit that has this address.
    Unit(u8, UnitTrouble),
}

/// Something that is wrong with a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnitTrouble {
    /// No power: its bypass relays pass the signal on.
    Off,
    /// It has power, but does not answer: a wrong address or speed.
    Deaf,
    /// Its selector stands at LOCAL.
    Local,
    /// Its selector stands at STOP.
    Stop,
    /// The torque switch trips when it opens.
    TorqueOpen,
    /// The torque switch trips when it closes.
    TorqueClose,
    /// The motor is too hot.
    Thermal,
    /// A phase is missing.
    Phase,
    /// The input of the local emergency shutdown is on.
    LocalEsd,
}

impl UnitTrouble {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Off,
        Self::Deaf,
        Self::Local,
        Self::Stop,
        Self::TorqueOpen,
        Self::TorqueClose,
        Self::Thermal,
        Self::Phase,
        Self::LocalEsd,
    ];

    /// Its name.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Deaf => "deaf",
            Self::Local => "local",
            Self::Stop => "stop",
            Self::TorqueOpen => "torque-open",
            Self::TorqueClose => "torque-close",
            Self::Thermal => "thermal",
            Self::Phase => "phase",
            Self::LocalEsd => "local-esd",
        }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Break(place) => write!(f, "break-{place}"),
            Self::Short(place) => write!(f, "short-{place}"),
            Self::Port(port) => write!(f, "port-{}", port.number()),
            Self::Unit(unit, what) => write!(f, "{}-{unit}", what.key()),
        }
    }
}

impl FromStr for Trouble {
    type Err = String;

    /// Reads a name as [`Display`](fmt::Display) writes it.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            let keys: Vec<_> = UnitTrouble::ALL.iter().map(|t| t.key()).collect();
            format!(
                "There is no trouble {text:?}: write break-N or short-N (N units before it), port-1 or port-2, or {} with the address of a unit, as in off-7.",
                keys.join(", ")
            )
        };
        let (key, number) = text.rsplit_once('-').ok_or_else(wrong)?;
        let place: usize = number.parse().map_err(|_| wrong())?;
        let small = u8::try_from(place).map_err(|_| wrong());
        match key {
            "break" => Ok(Self::Break(place)),
            "short" => Ok(Self::Short(place)),
            "port" => HostPort::from_number(small?)
                .map(Self::Port)
                .ok_or_else(wrong),
            _ => UnitTrouble::ALL
                .into_iter()
                .find(|t| t.key() == key)
                .ok_or_else(wrong)
                .and_then(|what| Ok(Self::Unit(small?, what))),
        }
    }
}
