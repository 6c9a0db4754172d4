//! What an ICON3000v2 keeps in its files besides alarms and warnings: connections, events,
//! recorders, curves and the reports of its cards (section 8.11).
//!
//! Layouts are written here once more and not taken from the decoder.

use super::clock::since_2000;
use super::drive::{self, Stroke};

/// Entries that each log keeps.
const KEPT: usize = 120;
/// Curves of full strokes, and of partial and emergency ones.
const FULL_KEPT: usize = 100;
const PARTIAL_KEPT: usize = 16;
/// One day and one hour in seconds.
const DAY: u64 = 86_400;
const HOUR: u64 = 3_600;
/// Time between two samples of the recorder and of the torque recorder, in seconds.
const RECORD_EVERY: u16 = 3_600;
pub(super) const TORQUE_EVERY: u16 = 5;

/// What caused an event (table 44).
pub(super) mod source {
    pub(in crate::sim) const BUS: u16 = 1;
    pub(in crate::sim) const LOCAL: u16 = 3;
    pub(in crate::sim) const ESD: u16 = 4;
    pub(in crate::sim) const FAIL_SAFE: u16 = 7;
    pub(in crate::sim) const BUS_REQUEST: u16 = 8;
    pub(in crate::sim) const ANALOG_REQUEST: u16 = 9;
    pub(in crate::sim) const PST: u16 = 17;
    pub(in crate::sim) const POWER_UP: u16 = 21;
}

/// A stroke test or emergency stroke that is over.
#[derive(Clone, Debug, Default)]
pub(super) struct Partial {
    /// Tenths of a second from the command to each percent of travel.
    pub away: Vec<u16>,
    /// Tenths of a second from the turn to each percent, from 1.
    pub back: Vec<u16>,
    /// Code of table 39, note 1.
    pub result: u16,
    /// Bits of note 4.
    pub status: u16,
    /// Bits of note 5.
    pub reset: u32,
    /// Percent.
    pub travel: u16,
    /// Tenths of a percent beyond the travel.
    pub over: u16,
}

/// The files.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    connections: Vec<Vec<u16>>,
    events: Vec<Vec<u16>>,
    recorders: Vec<Vec<u16>>,
    torques: Vec<Vec<u16>>,
    /// The reference first, then the latest.
    opening: Vec<Vec<u16>>,
    closing: Vec<Vec<u16>>,
    partial: Vec<Vec<u16>>,
    emergency: Vec<Vec<u16>>,
    cards: Vec<Vec<u16>>,
    start: u64,
    last_record: u64,
}

/// Two words, high word first.
fn long(value: u32) -> [u16; 2] {
    let [a, b, c, d] = value.to_be_bytes();
    [u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])]
}

fn time(wall: u64) -> [u16; 2] {
    long(since_2000(wall))
}

/// Text, filled up with blanks to so many words.
fn text(words: usize, text: &str) -> Vec<u16> {
    let mut bytes: Vec<u8> = text.bytes().take(words.saturating_mul(2)).collect();
    bytes.resize(words.saturating_mul(2), b' ');
    bytes
        .chunks_exact(2)
        .filter_map(|pair| pair.first_chunk::<2>())
        .map(|pair| u16::from_be_bytes(*pair))
        .collect()
}

/// Numbers that look like chance and are always the same.
fn noise(seed: u64, below: u64) -> u64 {
    let mut x = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    x.checked_rem(below).unwrap_or(0)
}

fn small(value: u64) -> u16 {
    u16::try_from(value).unwrap_or(u16::MAX)
}

/// Puts a new entry first and drops the oldest.
fn push(list: &mut Vec<Vec<u16>>, entry: Vec<u16>, kept: usize) {
    list.insert(0, entry);
    list.truncate(kept);
}

/// A head, then all entries.
fn log(list: &[Vec<u16>], head: &[u16]) -> Vec<u16> {
    let mut words = vec![small(u64::try_from(list.len()).unwrap_or(0))];
    words.extend(head);
    words.extend(list.iter().flatten());
    words
}

/// A torque curve: 101 samples, time, three temperatures, voltage, stroke time (tables 37, 38).
fn full(samples: &[u8; 101], wall: u64, seconds: u16, seed: u64) -> Vec<u16> {
    let mut words: Vec<u16> = samples.iter().map(|s| u16::from(*s)).collect();
    words.extend(time(wall));
    let warm = small(noise(seed, 9));
    words.extend([
        warm.saturating_add(26),
        warm.saturating_add(23),
        warm.saturating_add(39),
        small(noise(seed.wrapping_add(1), 12)).saturating_add(394),
        seconds,
    ]);
    words
}

/// The torque of a valve whose seat and packing grow stiffer with its age.
fn aged(opening: bool, percent: u32, stiffer: u8) -> u8 {
    let load = drive::torque(opening, percent.saturating_mul(1000), false);
    // The seat gains more than the rest of the way.
    let more = if percent < 6 {
        stiffer
    } else {
        stiffer.checked_div(3).unwrap_or(0)
    };
    load.saturating_sub(4).saturating_add(more).clamp(1, 100)
}

fn samples(opening: bool, stiffer: u8) -> [u8; 101] {
    core::array::from_fn(|percent| aged(opening, u32::try_from(percent).unwrap_or(0), stiffer))
}

/// A partial stroke as its file has it: 51 and 50 times, time, four temperatures, voltage, and what
/// came of it (table 39). Positions that were not reached hold 0 (reading E78).
fn partial(test: &Partial, wall: u64) -> Vec<u16> {
    let mut words = test.away.clone();
    words.resize(51, 0);
    let mut back = test.back.clone();
    back.resize(50, 0);
    words.extend(back);
    words.extend(time(wall));
    words.extend([30, 27, 44, 29, 400]);
    let last = |times: &[u16]| times.iter().copied().max().unwrap_or(0);
    // The time to the travel that was set; what came behind is over-travel.
    let there = test.away.get(usize::from(test.travel)).copied();
    words.extend([
        test.result,
        // Close PST: it starts from 100 %.
        0,
        there.unwrap_or_else(|| last(&test.away)),
        last(&test.back),
        test.over,
        test.travel,
        // Manual.
        2,
        test.status,
    ]);
    words.extend(long(test.reset));
    words
}

/// An earlier test: steady travel of a percent in so many tenths.
fn earlier(travel: u16, each: u16, result: u16, status: u16) -> Partial {
    let run = |from: u16, delay: u16| -> Vec<u16> {
        (from..=travel)
            .map(|percent| delay.saturating_add(percent.saturating_mul(each)))
            .collect()
    };
    // The way back begins at the far end.
    let mut back = run(1, 2);
    back.reverse();
    Partial {
        away: run(0, 4),
        back,
        result,
        status,
        reset: 0,
        travel,
        over: 4,
    }
}

impl History {
    /// What happened before the actuator was switched on at `wall`.
    pub(super) fn new(wall: u64) -> Self {
        let start = wall.saturating_sub(DAY.saturating_mul(400));
        let mut history = Self {
            start,
            last_record: wall,
            ..Self::default()
        };
        let ago = |days: u64| wall.saturating_sub(DAY.saturating_mul(days));
        for (days, level, device, who) in [
            (390, 3, 0, "COMMISSIONING"),
            (388, 2, 0, "A. Bianchi"),
            (211, 2, 1, "SERVICE 2"),
            (96, 1, 0, "Operator"),
            (41, 0, 0, "Operator"),
            (12, 2, 0, "A. Bianchi"),
        ] {
            let mut entry = vec![level];
            entry.extend(text(
                12,
                if device == 0 {
                    "ICON PDA 07"
                } else {
                    "LAPTOP-114"
                },
            ));
            entry.extend(text(12, who));
            entry.extend([0; 4]);
            entry.push(device);
            entry.extend(time(ago(days)));
            push(&mut history.connections, entry, KEPT);
        }
        for step in (0..60_u64).rev() {
            let at = wall.saturating_sub(step.saturating_mul(HOUR.saturating_mul(5)));
            let code = if step.is_multiple_of(2) { 1 } else { 2 };
            let source = if step.is_multiple_of(11) {
                source::LOCAL
            } else {
                source::BUS
            };
            history.event(at.saturating_sub(400), code, source);
        }
        for step in (1..=72_u64).rev() {
            let at = wall.saturating_sub(step.saturating_mul(u64::from(RECORD_EVERY)));
            history.record(at);
        }
        for step in (0..40_u64).rev() {
            let at = wall
                .saturating_sub(DAY)
                .saturating_sub(step.saturating_mul(u64::from(TORQUE_EVERY)));
            let load = small(noise(step, 9)).saturating_add(22);
            history.torque(at, load);
        }
        // A curve a month; a year ago the valve ran as it did when it was new.
        for opening in [true, false] {
            let list = if opening {
                &mut history.opening
            } else {
                &mut history.closing
            };
            let seconds = if opening { 24 } else { 26 };
            for month in (0..12_u64).rev() {
                let stiffer = u8::try_from(12_u64.saturating_sub(month)).unwrap_or(0);
                let at = ago(month.saturating_mul(30).saturating_add(3));
                let curve = full(&samples(opening, stiffer), at, seconds, month);
                push(list, curve, FULL_KEPT);
            }
            let reference = full(&samples(opening, 0), ago(385), seconds, 99);
            list.insert(0, reference);
        }
        for (days, each, result, status) in
            [(270, 3, 1, 1), (180, 3, 1, 1), (90, 5, 5, 4), (30, 4, 1, 1)]
        {
            let test = earlier(15, each, result, status);
            push(
                &mut history.partial,
                partial(&test, ago(days)),
                PARTIAL_KEPT,
            );
        }
        let reference = partial(&earlier(15, 3, 1, 1), ago(384));
        history.partial.insert(0, reference);
        for (days, each) in [(200_u64, 2_u16), (20, 2), (385, 2)] {
            let mut words: Vec<u16> = (0..=100_u16)
                .map(|percent| percent.saturating_mul(each).saturating_add(3))
                .collect();
            words.extend(time(ago(days)));
            words.extend([29, 26, 41, 30, 401, 0, 0]);
            history.emergency.insert(0, words);
        }
        for (code, revision) in [
            ("494BC32000", "HW02FW0902"),
            ("494AI10000", "HW01FW0105"),
            ("494TB12000", "HW03FW0201"),
            ("494EFS1000", "HW01FW0110"),
            ("494MOD3200", "HW01FW0401"),
        ] {
            let number = history.cards.len().saturating_add(4_711);
            let mut words = text(5, code);
            words.push(0);
            words.extend(text(1, "07"));
            words.extend(text(1, "23"));
            words.extend(text(3, &format!("{number:06}")));
            words.extend(text(5, revision));
            words.extend(text(16, "Simulated card"));
            history.cards.push(words);
        }
        history
    }

    /// How many curves there are besides the reference: opening, closing, partial, emergency.
    pub(super) fn stored(&self) -> [u16; 4] {
        [&self.opening, &self.closing, &self.partial, &self.emergency].map(|list| {
            let count = list.len().saturating_sub(1);
            u16::try_from(count).unwrap_or(u16::MAX)
        })
    }

    /// Notes that the motor was told to do something (tables 43 and 44).
    pub(super) fn event(&mut self, wall: u64, code: u16, source: u16) {
        let mut entry = time(wall).to_vec();
        entry.extend([code, source, 0]);
        push(&mut self.events, entry, KEPT);
    }

    fn record(&mut self, wall: u64) {
        // Cooler at night.
        let hour = wall.checked_div(HOUR).unwrap_or(0);
        let day = noise(hour, 3).saturating_add(hour.checked_rem(12).unwrap_or(0));
        let warm = small(day);
        let mut entry = time(wall).to_vec();
        entry.extend([
            warm.saturating_add(24),
            warm.saturating_add(36),
            small(noise(hour.wrapping_add(7), 14)).saturating_add(392),
            0,
        ]);
        push(&mut self.recorders, entry, KEPT);
    }

    /// Takes a sample of the recorder if one is due.
    pub(super) fn tick(&mut self, wall: u64) {
        let due = self.last_record.saturating_add(u64::from(RECORD_EVERY));
        if wall >= due {
            self.last_record = wall;
            self.record(wall);
        }
    }

    /// A sample of the torque recorder, in percent.
    pub(super) fn torque(&mut self, wall: u64, load: u16) {
        let mut entry = time(wall).to_vec();
        entry.extend([load, 44, 400, 0]);
        push(&mut self.torques, entry, KEPT);
    }

    /// Keeps a full stroke.
    pub(super) fn stroke(&mut self, stroke: &Stroke, wall: u64) {
        let seconds = u16::try_from(stroke.millis.saturating_add(500) / 1000).unwrap_or(u16::MAX);
        let curve = full(&stroke.samples, wall, seconds, wall);
        let list = if stroke.opening {
            &mut self.opening
        } else {
            &mut self.closing
        };
        // Behind the reference.
        list.insert(1.min(list.len()), curve);
        list.truncate(FULL_KEPT.saturating_add(1));
    }

    /// T-PST and T-RET of the reference of partial strokes, and its travel in percent.
    pub(super) fn reference_times(&self) -> ([u16; 2], u16) {
        let word = |at: usize| {
            let reference = self.partial.first();
            reference
                .and_then(|words| words.get(at))
                .copied()
                .unwrap_or(0)
        };
        ([word(110), word(111)], word(113))
    }

    /// Keeps an emergency stroke: 101 times, behind the reference.
    pub(super) fn emergency(&mut self, times: &[u16], opening: bool, wall: u64) {
        let mut words: Vec<u16> = times.to_vec();
        words.resize(101, 0);
        words.extend(time(wall));
        words.extend([31, 28, 46, 30, 400, 0, u16::from(opening)]);
        self.emergency.insert(1.min(self.emergency.len()), words);
        self.emergency.truncate(PARTIAL_KEPT.saturating_add(1));
    }

    /// Keeps a partial stroke.
    pub(super) fn test(&mut self, test: &Partial, wall: u64, baseline: bool) {
        let curve = partial(test, wall);
        if baseline && let Some(reference) = self.partial.first_mut() {
            reference.clone_from(&curve);
        }
        self.partial.insert(1.min(self.partial.len()), curve);
        self.partial.truncate(PARTIAL_KEPT.saturating_add(1));
    }

    /// The words of a file; `None` if there is none with this number.
    pub(super) fn file(&self, number: u16) -> Option<Vec<u16>> {
        let curve = |list: &[Vec<u16>], first: u16| {
            list.get(usize::from(number.saturating_sub(first))).cloned()
        };
        let [s0, s1] = time(self.start);
        match number {
            4 => Some(log(&self.connections, &[])),
            // Nobody knows what it holds (reading E69).
            5 => Some((0..64_u16).collect()),
            1000..=1100 => curve(&self.opening, 1000),
            2000..=2100 => curve(&self.closing, 2000),
            3000..=3016 => curve(&self.partial, 3000),
            3500..=3516 => curve(&self.emergency, 3500),
            5000 => Some(log(&self.events, &[s0, s1, 0])),
            5100 => Some(log(&self.recorders, &[s0, s1, 0, RECORD_EVERY])),
            5200 => Some(log(&self.torques, &[s0, s1, 0, TORQUE_EVERY])),
            5300..=5304 => curve(&self.cards, 5300),
            _ => None,
        }
    }
}
