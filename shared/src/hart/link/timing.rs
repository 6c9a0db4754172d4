//! Times of the link at a bit rate, from the table of timers.

use crate::hart::TIMERS;

/// Bits of a character on the line: start, eight data bits, odd parity, stop.
const BITS: u64 = 11;
/// The bit rate of the standard.
pub const BAUD: u32 = 1200;
/// Silence of a port that hands bytes over in batches, until a frame counts as broken off
/// (reading G18: 20 to 100 ms).
pub const BATCHED_GAP: u64 = 25_000;

/// Silence that a busy computer may make within a frame without breaking it off.
pub const PATIENT_GAP: u64 = 100_000;

/// Times of a link in microseconds. At 1200 bit/s and without batches they are those of the table;
/// another rate scales them, and a port that delivers late makes those longer that would otherwise
/// end before it can have delivered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// One character.
    pub character: u64,
    /// STO: from the end of a request to the start of its reply, at most.
    pub slave_time_out: u64,
    /// HOLD: how long a master that may send has to begin.
    pub hold: u64,
    /// RT2: what a master leaves free after its own exchange.
    pub link_grant: u64,
    /// RT1 of a primary master.
    pub quiet_primary: u64,
    /// RT1 of a secondary master: one RT2 more, so that a primary goes first.
    pub quiet_secondary: u64,
    /// Longest silence between two characters of a frame.
    pub gap: u64,
    /// How much later than on the line bytes may be heard.
    pub lag: u64,
}

impl Timing {
    /// Times at a bit rate. `gap` is for ports that deliver in batches; `None` is a line that is
    /// heard character by character.
    #[must_use]
    pub fn new(baud: u32, gap: Option<u64>) -> Self {
        let time = |characters: u64| {
            let bits = characters.saturating_mul(BITS).saturating_mul(1_000_000);
            bits.checked_div(u64::from(baud)).unwrap_or(0)
        };
        let of = |key: &str| {
            let timer = TIMERS.iter().find(|t| t.key == key);
            time(timer.map_or(0, |t| u64::from(t.characters)))
        };
        let character = time(1);
        let (slave_time_out, hold) = (of("slave_time_out"), of("hold"));
        let gap = gap.unwrap_or(0).max(of("gap"));
        let lag = gap.saturating_sub(of("gap"));
        // Whoever took the turn is heard one character later, and up to `lag` after that.
        let link_grant = of("link_grant").max(
            hold.saturating_add(character)
                .saturating_add(lag.saturating_mul(2)),
        );
        let heard = slave_time_out.saturating_add(time(2)).saturating_add(lag);
        let quiet_primary = of("link_quiet_primary").max(heard);
        Self {
            character,
            slave_time_out,
            hold,
            link_grant,
            quiet_primary,
            quiet_secondary: of("link_quiet_secondary")
                .max(quiet_primary.saturating_add(link_grant)),
            gap,
            lag,
        }
    }

    /// The same, with a longer silence until a frame counts as broken off. Whose turn it is does not
    /// change: bytes are late only now and then.
    #[must_use]
    pub fn patient(mut self, gap: u64) -> Self {
        self.gap = self.gap.max(gap);
        self
    }

    /// RT1 of a master.
    #[must_use]
    pub const fn quiet(&self, primary: bool) -> u64 {
        if primary {
            self.quiet_primary
        } else {
            self.quiet_secondary
        }
    }

    /// So many characters.
    #[must_use]
    pub fn characters(&self, count: usize) -> u64 {
        let count = u64::try_from(count).unwrap_or(u64::MAX);
        self.character.saturating_mul(count)
    }

    /// How long a master that may send has to begin; longer where the port is late itself.
    pub(super) fn window(&self) -> u64 {
        self.hold.max(self.lag)
    }

    /// From the end of a frame to the start of ours: carriers need a little to go.
    pub(super) const fn turn(&self) -> u64 {
        self.character / 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: readings/hart.md, section 2: exact values in milliseconds.
    #[test]
    fn at_1200_bits_they_are_those_of_the_table() {
        let t = Timing::new(BAUD, None);
        let tenths = |micros: u64| (micros + 50) / 100;
        assert_eq!(t.character, 9166);
        assert_eq!(tenths(t.slave_time_out), 2567);
        assert_eq!(tenths(t.hold), 183);
        assert_eq!(tenths(t.link_grant), 733);
        assert_eq!(tenths(t.quiet_primary), 3025);
        assert_eq!(tenths(t.quiet_secondary), 3758);
        assert_eq!((t.gap, t.lag), (9166, 0));
        // 41 characters are 33 and the 8 of RT2.
        assert_eq!(tenths(t.quiet_primary + t.link_grant), 3758);
    }

    #[test]
    fn a_port_that_delivers_late_gets_more_time_only_where_it_needs_it() {
        let (plain, late) = (
            Timing::new(BAUD, None),
            Timing::new(BAUD, Some(BATCHED_GAP)),
        );
        assert_eq!(late.gap, 25_000);
        // The answer of a device that begins with the last character of STO is heard in time.
        assert_eq!(late.link_grant, plain.link_grant);
        assert_eq!(late.quiet_primary, plain.quiet_primary);
        let slow = Timing::new(BAUD, Some(100_000));
        assert!(slow.quiet_primary >= slow.slave_time_out + slow.character + slow.lag);
        assert!(slow.link_grant > slow.hold + slow.lag);
        assert_eq!(slow.quiet_secondary, slow.quiet_primary + slow.link_grant);
        // Patience changes nothing else.
        let patient = late.patient(PATIENT_GAP);
        assert_eq!((patient.gap, patient.lag), (100_000, late.lag));
        assert_eq!(patient.link_grant, plain.link_grant);
        // A gap below that of the standard is none.
        assert_eq!(Timing::new(BAUD, Some(1)), plain);
    }

    #[test]
    fn another_rate_scales_them() {
        let (slow, fast) = (Timing::new(BAUD, None), Timing::new(12_000, None));
        assert_eq!(fast.quiet_primary, slow.quiet_primary / 10);
        assert_eq!(fast.hold, slow.hold / 10);
        assert_eq!(Timing::new(0, None).character, 0);
    }
}
