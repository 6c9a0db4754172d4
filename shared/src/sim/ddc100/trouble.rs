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

/// Something that is wrong with a unit, or that it reports. Those with a number are written with it:
/// `user-fault-3-7` is user fault 3 of unit 7, and `user-fault-7` the first of that unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnitTrouble {
    /// No power: its bypass relays pass the signal on.
    Off,
    /// It has power, but does not answer: a wrong address or speed.
    Deaf,
    /// Its selector stands at LOCAL.
    Local,
    /// So it does, and somebody opens the valve there.
    LocalOpen,
    /// And closes it.
    LocalClose,
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
    /// The phases are in reverse order.
    Sequence,
    /// The motor turns the wrong way.
    Rotation,
    /// The contactors do not let go.
    Energized,
    /// The input of the local emergency shutdown is on.
    LocalEsd,
    /// The valve is moved by hand: from an end half way, from half way to the nearer end.
    Manual,
    /// The input "open verify" does not come after an open command.
    VerifyOpen,
    /// The input "close verify" does not come.
    VerifyClose,
    /// "Open verify" stays after the command.
    VerifyOpenStays,
    /// "Close verify" stays.
    VerifyCloseStays,
    /// The optional channel B is fitted, and another host polls through it. When this ends, that one
    /// has fallen silent.
    ChannelB,
    /// A user fault, 0 to 9.
    UserFault(u8),
    /// An analog input is lost, 1 to 4.
    AnalogLost(u8),
    /// A bit of register 14, 0 to 15: analog channels, timers; 13 is user timer 1.
    Timer(u8),
    /// A user input is active, by its number; 0 is the local emergency shutdown.
    Input(u8),
    /// A bit of register 16, 0 to 5.
    State(u8),
}

/// How a trouble with a number is made, the number that is left out, and the last one.
type Numbered = (fn(u8) -> UnitTrouble, u8, u8);

use UnitTrouble::{AnalogLost, Input, State, Timer, UserFault};

impl UnitTrouble {
    /// All that have no number.
    pub const PLAIN: [Self; 20] = [
        Self::Off,
        Self::Deaf,
        Self::Local,
        Self::LocalOpen,
        Self::LocalClose,
        Self::Stop,
        Self::TorqueOpen,
        Self::TorqueClose,
        Self::Thermal,
        Self::Phase,
        Self::Sequence,
        Self::Rotation,
        Self::Energized,
        Self::LocalEsd,
        Self::Manual,
        Self::VerifyOpen,
        Self::VerifyClose,
        Self::VerifyOpenStays,
        Self::VerifyCloseStays,
        Self::ChannelB,
    ];

    /// Those with a number.
    const NUMBERED: [Numbered; 5] = [
        (UserFault, 0, 9),
        (AnalogLost, 1, 4),
        (Timer, 13, 15),
        (Input, 1, 19),
        (State, 5, 5),
    ];

    /// Every trouble, with every number.
    pub fn all() -> impl Iterator<Item = Self> {
        let numbered = Self::NUMBERED.into_iter();
        let numbered = numbered.flat_map(|(make, _, last)| (0..=last).map(make));
        let legal = numbered.filter(|t| *t != AnalogLost(0));
        Self::PLAIN.into_iter().chain(legal)
    }

    /// Its name, without its number.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Deaf => "deaf",
            Self::Local => "local",
            Self::LocalOpen => "local-open",
            Self::LocalClose => "local-close",
            Self::Stop => "stop",
            Self::TorqueOpen => "torque-open",
            Self::TorqueClose => "torque-close",
            Self::Thermal => "thermal",
            Self::Phase => "phase",
            Self::Sequence => "sequence",
            Self::Rotation => "rotation",
            Self::Energized => "energized",
            Self::LocalEsd => "local-esd",
            Self::Manual => "manual",
            Self::VerifyOpen => "verify-open",
            Self::VerifyClose => "verify-close",
            Self::VerifyOpenStays => "verify-open-stays",
            Self::VerifyCloseStays => "verify-close-stays",
            Self::ChannelB => "channel-b",
            UserFault(_) => "user-fault",
            AnalogLost(_) => "analog-lost",
            Timer(_) => "timer",
            Input(_) => "input",
            State(_) => "state",
        }
    }

    const fn number(self) -> Option<u8> {
        match self {
            UserFault(n) | AnalogLost(n) | Timer(n) | Input(n) | State(n) => Some(n),
            _ => None,
        }
    }

    /// The number that is meant if none is written.
    fn usual(self) -> Option<u8> {
        let mut all = Self::NUMBERED.into_iter();
        all.find(|(make, usual, _)| make(*usual).key() == self.key())
            .map(|(_, usual, _)| usual)
    }

    /// Reads a name, with or without a number.
    fn read(text: &str) -> Option<Self> {
        let (key, number) = match text.rsplit_once('-') {
            Some((key, number)) if number.bytes().all(|b| b.is_ascii_digit()) => {
                (key, Some(number.parse().ok()?))
            }
            _ => (text, None),
        };
        Self::all().find(|t| t.key() == key && t.number() == number.or(t.usual()))
    }

    /// All names, for people.
    #[must_use]
    pub fn names() -> String {
        let mut names: Vec<String> = Self::PLAIN.iter().map(|t| t.key().to_owned()).collect();
        names.extend(Self::NUMBERED.into_iter().map(|(make, usual, last)| {
            let first = u8::from(make(0) == AnalogLost(0));
            format!("{}[-{first}..{last}]", make(usual).key())
        }));
        names.join(", ")
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Break(place) => write!(f, "break-{place}"),
            Self::Short(place) => write!(f, "short-{place}"),
            Self::Port(port) => write!(f, "port-{}", port.number()),
            Self::Unit(unit, what) => {
                f.write_str(what.key())?;
                if let Some(number) = what.number().filter(|_| what.number() != what.usual()) {
                    write!(f, "-{number}")?;
                }
                write!(f, "-{unit}")
            }
        }
    }
}

impl FromStr for Trouble {
    type Err = String;

    /// Reads a name as [`Display`](fmt::Display) writes it.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "There is no trouble {text:?}: write break-N or short-N (N units before it), port-1 or port-2, or {} with the address of a unit, as in off-7, or user-fault-3-7 for user fault 3 of unit 7.",
                UnitTrouble::names()
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
            _ => UnitTrouble::read(key)
                .ok_or_else(wrong)
                .and_then(|what| Ok(Self::Unit(small?, what))),
        }
    }
}
