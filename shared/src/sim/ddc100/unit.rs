//! A simulated field unit: what it senses, what its registers say, and its network watchdog.

use super::drive::{Drive, Motion};
use super::trouble::UnitTrouble;
use crate::capture::Micros;
use crate::ddc100::setup::Member;
use crate::ddc100::{HostPort, Pair};
use crate::device::Device;

/// Default of the network watchdog (section 4.3), in seconds.
const WATCHDOG_S: u16 = 60;
const SECOND: u64 = 1_000_000;
/// UART resets before that of the processor.
const UART_RESETS: u8 = 3;

/// Troubles of a unit that are there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wrong {
    pub off: bool,
    pub deaf: bool,
    pub local: bool,
    pub stop: bool,
    pub thermal: bool,
    pub phase: bool,
    pub local_esd: bool,
}

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
    pub messages: u16,
    pub exceptions: u16,
    pub unanswered: u16,
}

/// A field unit.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub(super) member: Member,
    pub(super) drive: Drive,
    pub(super) wrong: Wrong,
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
    heard: Pair<Option<Micros>>,
    watch: Watch,
    now: Micros,
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
            wrong: Wrong::default(),
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
    pub(super) const fn hears(&self) -> bool {
        !self.wrong.off && !self.wrong.deaf && !matches!(self.watch, Watch::Resetting { .. })
    }

    pub(super) fn is_remote(&self) -> bool {
        !self.wrong.local && !self.wrong.stop
    }

    /// A trouble begins or ends.
    pub(super) fn set(&mut self, trouble: UnitTrouble, on: bool) {
        let wrong = &mut self.wrong;
        match trouble {
            UnitTrouble::Off => {
                wrong.off = on;
                self.drive.stop();
                self.relays = 0;
                self.network_esd = false;
                self.was_reset = true;
                self.listens_only = false;
                self.heard = Pair::default();
                self.restart_watch();
            }
            UnitTrouble::Deaf => wrong.deaf = on,
            UnitTrouble::Local => wrong.local = on,
            UnitTrouble::Stop => {
                wrong.stop = on;
                self.drive.stop();
            }
            UnitTrouble::TorqueOpen => {
                self.drive.trips_opening = on;
                self.drive.open_torque &= on;
            }
            UnitTrouble::TorqueClose => {
                self.drive.trips_closing = on;
                self.drive.close_torque &= on;
            }
            UnitTrouble::Thermal => {
                wrong.thermal = on;
                self.drive.stop();
            }
            UnitTrouble::Phase => {
                wrong.phase = on;
                self.drive.stop();
            }
            UnitTrouble::LocalEsd => {
                wrong.local_esd = on;
                // The default of the emergency shutdown is to close (section 6.1, item 4).
                if on {
                    self.drive.go(0);
                } else {
                    self.drive.stop();
                }
            }
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

    fn wait_us(&self) -> u64 {
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
        if self.wrong.off {
            return;
        }
        if !self.wrong.thermal && !self.wrong.phase {
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

    /// True if nothing came through a channel for as long as the watchdog waits.
    fn timed_out(&self, channel: HostPort) -> bool {
        let heard = self.heard.get(channel);
        heard.is_none_or(|at| self.now.since(at) >= self.wait_us())
    }

    /// Register 9 (table 3.5).
    pub(super) fn status(&self) -> u16 {
        let (a, b) = (self.timed_out(HostPort::One), self.timed_out(HostPort::Two));
        let channels = bits(&[(10, a), (11, b)]);
        if self.is_io() {
            return channels;
        }
        let d = &self.drive;
        let moving = d.motion != Motion::Still;
        let hot = self.wrong.thermal;
        let combined = d.is_jammed() || hot || self.wrong.phase || (a && b);
        // Without channel B the pair comes down to A; here that is the same, as B is set (D8).
        channels
            | bits(&[
                (0, d.is_open()),
                (1, d.is_closed()),
                (2, !moving && !d.is_open() && !d.is_closed()),
                (3, d.motion == Motion::Opening),
                (4, d.motion == Motion::Closing),
                (5, d.is_jammed()),
                (6, !self.is_remote()),
                (7, combined),
                (8, hot),
                (12, d.open_torque),
                (13, d.close_torque),
                (15, self.wrong.phase),
            ])
    }

    /// Register 10.
    pub(super) fn faults(&self) -> u16 {
        if self.is_io() {
            return 0;
        }
        bits(&[
            (4, self.wrong.phase),
            (10, self.network_esd),
            (11, self.wrong.local_esd),
            (12, self.was_reset),
            (13, self.is_mx() && self.wrong.stop),
        ])
    }

    /// Register 11.
    pub(super) fn outputs(&self) -> u16 {
        let contactors = bits(&[
            (0, self.drive.motion == Motion::Closing),
            (1, self.drive.motion == Motion::Opening),
        ]);
        let fixed = if self.is_mx() {
            // The network relay.
            1 << 9
        } else {
            // Software version.
            0x2000
        };
        self.relays | contactors | fixed
    }

    /// Register 12.
    pub(super) fn inputs_1(&self) -> u16 {
        if self.is_io() {
            return 0;
        }
        let d = &self.drive;
        bits(&[
            (0, self.is_remote()),
            (1, self.wrong.thermal),
            (
                2,
                d.open_torque || (d.is_jammed() && d.motion == Motion::Opening),
            ),
            (3, d.is_open()),
            (
                4,
                d.close_torque || (d.is_jammed() && d.motion == Motion::Closing),
            ),
            (5, d.is_closed()),
            (8, self.wrong.local_esd),
            // Inverted by default: 1 is not active.
            (11, true),
        ])
    }

    /// Register 13.
    pub(super) fn inputs_2(&self) -> u16 {
        let both = self.timed_out(HostPort::One) && self.timed_out(HostPort::Two);
        if self.is_mx() {
            bits(&[(4, both), (6, true), (12, self.wrong.phase)])
        } else {
            bits(&[(4, both)])
        }
    }

    /// A holding register by its number, 1 to 56; input registers 5 to 16 are the same.
    pub(super) fn register(&self, number: u16) -> u16 {
        let mx = self.is_mx();
        match number {
            2 => self.argument,
            3 if mx => self.drive.percent(),
            4 if mx && self.drive.motion != Motion::Still => 42,
            5 if mx => 480,
            5 | 6 if !mx => 0xFFFF,
            8 if !self.is_io() => self.drive.percent(),
            9 => self.status(),
            10 => self.faults(),
            11 => self.outputs(),
            12 => self.inputs_1(),
            13 => self.inputs_2(),
            14 if !mx => bits(&[
                (11, self.timed_out(HostPort::One)),
                (12, self.timed_out(HostPort::Two)),
            ]),
            _ => 0,
        }
    }
}

/// A word of bits.
fn bits(set: &[(u32, bool)]) -> u16 {
    set.iter().fold(0, |word, (bit, on)| {
        word | u16::from(*on).wrapping_shl(*bit)
    })
}
