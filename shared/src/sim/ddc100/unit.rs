//! A simulated field unit: its troubles and its network watchdog.

use super::drive::{Drive, OPEN};
use super::trouble::UnitTrouble::{self, *};
use crate::capture::Micros;
use crate::ddc100::setup::Member;
use crate::ddc100::{HostPort, Pair};
use crate::device::Device;

/// Default of the network watchdog (section 4.3), in seconds.
const WATCHDOG_S: u16 = 60;
const SECOND: u64 = 1_000_000;
/// UART resets before that of the processor.
const UART_RESETS: u8 = 3;

/// What the network watchdog of a UEC-3-DDC does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Watch {
    /// Waits for a poll until then; so many resets are over.
    Waiting { until: Micros, resets: u8 },
    /// Resets, the UART or at last the processor, and hears nothing until then.
    Resetting { until: Micros, resets: u8 },
    /// All is done; it waits for a poll without an end.
    Resting,
}

/// Counters of the diagnostics (table 3.8).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counters {
    /// Requests on the bus, for whomever. Answers of others, which pass it too, are not counted.
    pub bus: u16,
    /// Frames whose check did not hold.
    pub damaged: u16,
    /// Its answers that were exceptions.
    pub exceptions: u16,
    /// Requests for itself or for all that it carried out.
    pub own: u16,
}

/// Bits of register 10 of a UEC-3-DDC: from where to where it was moved by hand.
const MID_TO_OPEN: u32 = 6;
const OPEN_TO_MID: u32 = 7;
const MID_TO_CLOSE: u32 = 8;
const CLOSE_TO_MID: u32 = 9;

/// Somebody turns the handwheel: from an end half way, from half way to the nearer end.
fn by_hand(drive: &mut Drive) -> u32 {
    let half = OPEN / 2;
    let (to, bit) = if drive.is_open() {
        (half, OPEN_TO_MID)
    } else if drive.is_closed() {
        (half, CLOSE_TO_MID)
    } else if drive.percent() >= 50 {
        (OPEN, MID_TO_OPEN)
    } else {
        (0, MID_TO_CLOSE)
    };
    drive.put(to);
    bit
}

/// A field unit.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub(super) member: Member,
    pub(super) drive: Drive,
    troubles: Vec<UnitTrouble>,
    /// How it was moved by hand: a bit of register 10 of a UEC-3-DDC.
    pub(super) moved: u32,
    /// Its inputs change with time.
    pub(super) lively: bool,
    pub(super) network_esd: bool,
    /// Relays as the bits of register 11.
    pub(super) relays: u16,
    pub(super) argument: u16,
    /// Register 112.
    pub(super) watchdog_s: u16,
    pub(super) counters: Counters,
    /// Set by a reset, cleared by the next poll of register 10.
    pub(super) was_reset: bool,
    pub(super) listens_only: bool,
    /// When it was last polled through each of its channels; `None` before the first time.
    pub(super) heard: Pair<Option<Micros>>,
    watch: Watch,
    pub(super) now: Micros,
}

impl Unit {
    pub(super) fn new(member: Member) -> Self {
        // Valves take 30 to 90 s (section 4.3), each its own time.
        let stroke = u64::from(member.unit)
            .saturating_mul(7)
            .checked_rem(61)
            .unwrap_or(0)
            .saturating_add(30);
        Self {
            member,
            drive: Drive::new(stroke.saturating_mul(SECOND)),
            troubles: Vec::new(),
            moved: MID_TO_OPEN,
            lively: false,
            network_esd: false,
            relays: 0,
            argument: 0,
            watchdog_s: WATCHDOG_S,
            counters: Counters::default(),
            was_reset: true,
            listens_only: false,
            heard: Pair::default(),
            watch: Watch::Waiting {
                until: Micros::new(SECOND.saturating_mul(WATCHDOG_S.into())),
                resets: 0,
            },
            now: Micros::new(0),
        }
    }

    pub(super) const fn address(&self) -> u8 {
        self.member.unit
    }

    pub(super) const fn is_mx(&self) -> bool {
        matches!(self.member.kind, Device::Ddc100Mx | Device::Ddc100MxB)
    }

    pub(super) const fn is_io(&self) -> bool {
        matches!(self.member.kind, Device::Ddc100Io)
    }

    /// True if it takes in what comes: it has power, the right address, and is in no reset.
    pub(super) fn hears(&self) -> bool {
        !self.has(Off) && !self.has(Deaf) && !matches!(self.watch, Watch::Resetting { .. })
    }

    /// True while a trouble is there.
    pub(super) fn has(&self, trouble: UnitTrouble) -> bool {
        self.troubles.contains(&trouble)
    }

    pub(super) fn is_local(&self) -> bool {
        [Local, LocalOpen, LocalClose]
            .into_iter()
            .any(|t| self.has(t))
    }

    pub(super) fn is_remote(&self) -> bool {
        !self.is_local() && !self.has(Stop)
    }

    /// The local emergency shutdown, which is user input 0 by default (section 6.1, item 4).
    pub(super) fn local_esd(&self) -> bool {
        !self.is_io() && (self.has(LocalEsd) || self.has(Input(0)))
    }

    /// True if its motor can't run.
    pub(super) fn is_stuck(&self) -> bool {
        [Thermal, Phase, Sequence].into_iter().any(|t| self.has(t))
    }

    pub(super) const fn set_lively(&mut self) {
        self.lively = true;
    }

    /// A request for whomever.
    pub(super) const fn noticed(&mut self) {
        self.counters.bus = self.counters.bus.wrapping_add(1);
    }

    /// A damaged frame.
    pub(super) const fn damaged(&mut self) {
        self.counters.damaged = self.counters.damaged.wrapping_add(1);
    }

    /// True if table 3.5 has something for the trouble in the column of its type.
    pub(super) const fn knows(&self, trouble: UnitTrouble) -> bool {
        let (mx, io) = (self.is_mx(), self.is_io());
        match trouble {
            Off | Deaf => true,
            Local | LocalOpen | LocalClose | Stop | TorqueOpen | TorqueClose | Thermal | Phase
            | Sequence | LocalEsd | Manual => !io,
            Rotation | Energized | VerifyOpen | VerifyClose | VerifyOpenStays
            | VerifyCloseStays => !io && !mx,
            ChannelB | UserFault(_) | Timer(_) | State(_) => !mx,
            AnalogLost(n) => n <= 2 || !mx,
            Input(n) => n <= 8 || (n == 9 && !mx) || io,
        }
    }

    /// A trouble begins or ends.
    pub(super) fn set(&mut self, trouble: UnitTrouble, on: bool) {
        self.troubles.retain(|t| *t != trouble);
        if on {
            self.troubles.push(trouble);
        }
        match trouble {
            Off => {
                self.drive.stop();
                self.relays = 0;
                self.network_esd = false;
                self.was_reset = true;
                self.listens_only = false;
                self.counters = Counters::default();
                self.heard = Pair::default();
                self.restart_watch();
            }
            Stop | Thermal | Phase | Sequence => self.drive.stop(),
            TorqueOpen => {
                self.drive.trips_opening = on;
                self.drive.open_torque &= on;
            }
            TorqueClose => {
                self.drive.trips_closing = on;
                self.drive.close_torque &= on;
            }
            LocalOpen if on => self.drive.go(OPEN),
            // The default of the emergency shutdown is to close (section 6.1, item 4).
            LocalClose | LocalEsd if on => self.drive.go(0),
            Input(0) if on && !self.is_io() => self.drive.go(0),
            LocalOpen | LocalClose | LocalEsd | Input(0) => self.drive.stop(),
            Manual if on => self.moved = by_hand(&mut self.drive),
            _ => {}
        }
    }

    /// A poll came in through a port of the host.
    pub(super) fn polled(&mut self, port: HostPort, now: Micros) {
        // On an MX channel A is connection A1, towards host port 1, and B is A2. On the others A is
        // both, and B the optional ports, which nothing is connected to (section 4.3.1).
        let channel = if self.is_mx() { port } else { HostPort::One };
        self.heard.set(channel, Some(now));
        self.restart_watch();
    }

    fn restart_watch(&mut self) {
        self.watch = Watch::Waiting {
            until: self.now.plus(self.wait_us()),
            resets: 0,
        };
    }

    pub(super) fn wait_us(&self) -> u64 {
        SECOND.saturating_mul(self.watchdog_s.into())
    }

    /// How long a reset takes: 10 to 15 s (section 4.3, note), each unit its own time.
    fn reset_us(&self) -> u64 {
        let extra = u64::from(self.address()).checked_rem(6).unwrap_or(0);
        SECOND.saturating_mul(extra.saturating_add(10))
    }

    pub(super) fn advance(&mut self, now: Micros) {
        let passed = now.since(self.now);
        self.now = self.now.max(now);
        if self.has(Off) {
            return;
        }
        if !self.is_stuck() {
            self.drive.advance(passed);
        }
        if !self.is_mx() {
            self.watch(now);
        }
    }

    /// Section 4.3: after each of three waits the UART is reset, then the processor; then it rests.
    fn watch(&mut self, now: Micros) {
        loop {
            match self.watch {
                Watch::Waiting { until, resets } if now >= until => {
                    self.watch = Watch::Resetting {
                        until: until.plus(self.reset_us()),
                        resets: resets.saturating_add(1),
                    };
                }
                Watch::Resetting { until, resets } if now >= until => {
                    self.watch = if resets < UART_RESETS {
                        Watch::Waiting {
                            until: until.plus(self.wait_us()),
                            resets,
                        }
                    } else if resets == UART_RESETS {
                        self.was_reset = true;
                        self.listens_only = false;
                        Watch::Resetting {
                            until: until.plus(self.reset_us()),
                            resets: resets.saturating_add(1),
                        }
                    } else {
                        Watch::Resting
                    };
                }
                _ => return,
            }
        }
    }
}
