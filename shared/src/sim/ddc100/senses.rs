//! What a simulated unit senses, as its registers say it (table 3.5).

use super::drive::Motion;
use super::trouble::UnitTrouble::{self, *};
use super::unit::Unit;
use crate::ddc100::HostPort;

/// What an analog input that nothing is connected to says, as in the example of section 3.2.4.
const NO_SIGNAL: u16 = 0xFFFF;

impl Unit {
    /// True if nothing came through a channel for as long as the watchdog waits.
    fn timed_out(&self, channel: HostPort) -> bool {
        if channel == HostPort::Two && !self.is_mx() {
            return !self.has(ChannelB);
        }
        let heard = self.heard.get(channel);
        heard.is_none_or(|at| self.now.since(at) >= self.wait_us())
    }

    fn is_phase_wrong(&self) -> bool {
        self.has(Phase) || self.has(Sequence)
    }

    /// Register 9.
    fn status(&self) -> u16 {
        let (a, b) = (self.timed_out(HostPort::One), self.timed_out(HostPort::Two));
        let channels = bits(&[(10, a), (11, b)]);
        if self.is_io() {
            return channels;
        }
        let d = &self.drive;
        let moving = d.motion != Motion::Still;
        let hot = self.has(Thermal);
        let stays = self.has(Energized);
        let combined = d.is_jammed() || hot || stays || self.is_phase_wrong() || (a && b);
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
                (9, stays),
                (12, d.open_torque),
                (13, d.close_torque),
                (14, self.has(Manual)),
                (15, self.is_phase_wrong()),
            ])
    }

    /// Register 10.
    fn faults(&self) -> u16 {
        if self.is_io() {
            return 0;
        }
        let motion = |way| self.is_local() && self.drive.motion == way;
        let both = bits(&[
            (4, self.has(Phase)),
            (5, self.has(Sequence)),
            (10, self.network_esd),
            (11, self.local_esd()),
            (12, self.was_reset),
            (14, motion(Motion::Opening)),
            (15, motion(Motion::Closing)),
        ]);
        if self.is_mx() {
            return both | bits(&[(13, self.has(Stop))]);
        }
        both | bits(&[
            (0, self.has(VerifyOpen)),
            (1, self.has(VerifyClose)),
            (2, self.has(VerifyOpenStays)),
            (3, self.has(VerifyCloseStays)),
            (self.moved, self.has(Manual)),
            (13, self.has(Rotation)),
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
    fn inputs_1(&self) -> u16 {
        // Inputs 0 to 7 of every type.
        let users = self.numbered(Input, 0, 8).wrapping_shl(8);
        if self.is_io() {
            return users | self.numbered(Input, 8, 8);
        }
        let d = &self.drive;
        let own = bits(&[
            (0, self.is_remote()),
            (1, self.has(Thermal)),
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
            (8, self.local_esd()),
        ]);
        // Input 3 is inverted by default: 1 is not active (reading D32).
        (users | own) ^ 1 << 11
    }

    /// Register 13.
    fn inputs_2(&self) -> u16 {
        let both = self.timed_out(HostPort::One) && self.timed_out(HostPort::Two);
        let lost = self.numbered(AnalogLost, 1, 4);
        let phases = [(12, self.has(Phase)), (13, self.has(Sequence))];
        if self.is_mx() {
            let option = (6..=8).any(|n| self.has(Input(n)));
            let own = [(4, both), (6, true), (7, option), (14, self.has(Input(8)))];
            return lost.wrapping_shl(2) | bits(&phases) | bits(&own);
        }
        if self.is_io() {
            // Not in their order (reading D17).
            let inputs = [(12, 18), (13, 19), (14, 16), (15, 17)];
            return lost | bits(&[(4, both)]) | bits(&inputs.map(|(b, n)| (b, self.has(Input(n)))));
        }
        let inputs = [(14, self.has(Input(8))), (15, self.has(Input(9)))];
        lost | bits(&[(4, both)]) | bits(&phases) | bits(&inputs)
    }

    /// Troubles of a kind from a number on, as so many bits.
    fn numbered(&self, make: fn(u8) -> UnitTrouble, first: u8, count: u8) -> u16 {
        (0..count).rev().fold(0, |word, n| {
            word.wrapping_shl(1) | u16::from(self.has(make(first.saturating_add(n))))
        })
    }

    /// Register 14, of all but an MX.
    fn timers(&self) -> u16 {
        let channels = bits(&[
            (11, self.timed_out(HostPort::One)),
            (12, self.timed_out(HostPort::Two)),
        ]);
        channels | self.numbered(Timer, 0, 16)
    }

    /// An analog input of an I/O module, in percent: at rest, or slowly up and down.
    fn analog(&self, input: u8) -> u16 {
        const MINUTE: u64 = 60_000_000;
        if self.has(AnalogLost(input)) {
            return 0;
        }
        let rest = u16::from(input).saturating_mul(20).saturating_add(20);
        if !self.lively {
            return rest;
        }
        // Up in a minute and down in another, from where it is at rest.
        let begin = u64::from(rest).saturating_mul(MINUTE / 100);
        let at = self.now.get().saturating_add(begin);
        let at = at.checked_rem(MINUTE.saturating_mul(2)).unwrap_or(0);
        let way = at.min(MINUTE.saturating_mul(2).saturating_sub(at));
        u16::try_from(way.checked_div(MINUTE / 100).unwrap_or(0)).unwrap_or(100)
    }

    /// A holding register by its number, 1 to 56; input registers 5 to 16 are the same.
    pub(super) fn register(&self, number: u16) -> u16 {
        let (mx, io) = (self.is_mx(), self.is_io());
        match number {
            2 => self.argument,
            3 if mx => self.drive.percent(),
            4 if mx && self.drive.motion != Motion::Still => 42,
            5 if mx => 480,
            5 | 6 if !mx => NO_SIGNAL,
            7 if io => self.analog(2),
            8 if io => self.analog(1),
            8 => self.drive.percent(),
            9 => self.status(),
            10 => self.faults(),
            11 => self.outputs(),
            12 => self.inputs_1(),
            13 => self.inputs_2(),
            14 if !mx => self.timers(),
            15 if !mx => self.numbered(UserFault, 0, 10),
            16 if !mx => self.numbered(State, 0, 6),
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
