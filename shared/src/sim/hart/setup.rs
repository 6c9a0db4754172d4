//! How a simulated device is made up.

use crate::device::Family;
use crate::sim::Programme;

/// How a CK switches (note 4 of the manual).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CkSwitch {
    /// Digital: torque and position are numbers.
    Digital,
    /// Mechanical: torque is none or tripped, position closed, open or between.
    Mechanical,
    /// Mechanical with potentiometer: the position is a number.
    Potentiometer,
}

/// Where the selector of the actuator stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HartSelector {
    /// The network and the analogue signal command the valve ("run" on the CVA).
    Remote,
    /// Nothing moves.
    Stop,
    /// Only the local controls move it ("test" on the CVA).
    Local,
}

/// What the actuator does when its signal is lost (section 4.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HartLoss {
    /// Stays where it is.
    Stay,
    /// Closes.
    Close,
    /// Opens.
    Open,
}

/// What a device is and how it behaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HartSetup {
    /// Which family it is.
    pub family: Family,
    /// Its device id, 24 bits.
    pub device_id: u32,
    /// Polling address, 0 to 63.
    pub polling: u8,
    /// Bits per second of the line: 1200, or more for a line in fast motion.
    pub baud: u32,
    /// From the end of a request to the start of the answer, in characters; below 28 (STO).
    pub turn: u8,
    /// Preamble bytes that it wants in requests.
    pub wanted: u8,
    /// Preamble bytes in its answers.
    pub preambles: u8,
    /// Characters at the start of a transmission that its modem misses.
    pub missed: u8,
    /// A longer silence inside a frame ends it, in microseconds.
    pub gap_us: u32,
    /// Bytes that command 48 answers, 9 to 25.
    pub status_len: u8,
    /// What the signal does by itself.
    pub programme: Programme,
    /// The signal when nothing drives it, in mA.
    pub signal: f32,
    /// From closed to open, in milliseconds.
    pub stroke_ms: u32,
    /// Percent of the factory stroke where the user's 0 % and 100 % are.
    pub limits: (f32, f32),
    /// Relays that are fitted and set to digital control; bit 0 is relay 1.
    pub relays: u16,
    /// How a CK switches.
    pub switch: CkSwitch,
    /// What a lost signal does, and after how many milliseconds.
    pub loss: (HartLoss, u32),
    /// Commands 22 and 42 take so long and answer with 33 and 34 until then; 0: at once.
    pub delayed_ms: u32,
    /// How long it is away after a reset, in milliseconds.
    pub reset_ms: u32,
}

impl HartSetup {
    /// A device as it would be met: address 0, 1200 bit/s, closed valve, 4 mA.
    #[must_use]
    pub const fn of(family: Family) -> Self {
        Self {
            family,
            device_id: 0x01_2345,
            polling: 0,
            baud: 1200,
            turn: 4,
            wanted: 5,
            preambles: 5,
            missed: 2,
            gap_us: 20_000,
            status_len: 9,
            programme: Programme::Idle,
            signal: 4.0,
            stroke_ms: 24_000,
            limits: (5.0, 95.0),
            relays: match family {
                // Relays 1 to 4 are standard on the IQ, 1 and 2 on the CMA; all options fitted.
                Family::Iq => 0x0FFF,
                Family::Cma => 0x00F3,
                Family::Cva | Family::Ck | Family::Si => 0,
            },
            switch: CkSwitch::Digital,
            loss: (HartLoss::Stay, 5_000),
            delayed_ms: 0,
            reset_ms: 1_500,
        }
    }
}
