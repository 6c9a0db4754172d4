//! The actuator behind the objects: it strokes, warms up, vibrates, counts and keeps logs.

pub(super) use super::noise::{noise, wave};
pub(super) use super::stroke::Stroke;
use std::collections::VecDeque;

/// Time is simulated in steps of this length.
pub(super) const STEP_MS: i64 = 100;
/// From one opening to the next.
const CYCLE_MS: i64 = 60_000;
/// The closing begins so much later than the opening.
const CLOSE_AT_MS: i64 = 30_000;
/// Thousandths of the travel in one step: a stroke takes 12.5 s.
const TRAVEL: i64 = 8;
/// Seconds since commissioning when the simulation begins: fourteen months.
const AGE: i64 = 14 * 30 * 86_400;
/// Strokes in each direction before the simulation begins.
const STROKES: i64 = 1840;
/// Turns of the drive sleeve in one stroke.
pub(super) const TURNS: i64 = 18;
/// Time that a stroke spends in each tenth of the travel, in milliseconds.
pub(super) const BIN_MS: i64 = 1_250;
/// Records kept of each log.
const KEPT: usize = 4_096;
/// The movement log has 16-bit ids that come round; it begins shortly before.
const FIRST_MOVE: i64 = 65_400;

/// A direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Open,
    Close,
}

/// A record of the event log.
#[derive(Clone, Debug)]
pub(super) struct Event {
    pub id: i64,
    pub time: i64,
    pub category: i64,
    pub text: &'static str,
}

/// A record of the movement log.
#[derive(Clone, Debug)]
pub(super) struct Move {
    pub id: i64,
    pub time: i64,
    /// Percent.
    pub position: i64,
    pub rpm: i64,
    /// Percent of the rating.
    pub torque: i64,
    /// Tenths of a degree.
    pub temperature: i64,
    /// Tenths of a percent.
    pub demand: i64,
    pub text: &'static str,
}

/// The actuator.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub tag: String,
    pub seed: i64,
    pub moves_itself: bool,
    /// Seconds since 1970 when the simulation began, and now.
    pub born: i64,
    pub wall: i64,
    /// Milliseconds since it began.
    pub age_ms: i64,
    /// Thousandths of the travel; 1000 is open.
    pub position: i64,
    pub moving: Option<Way>,
    pub opens: i64,
    pub closes: i64,
    /// Milliseconds of running in each tenth of the travel, and when that was last.
    pub on_ms: [[i64; 10]; 2],
    pub on_at: [[i64; 10]; 2],
    /// Starts of the last hour: when, which way and in which tenth.
    pub starts: VecDeque<(i64, Way, usize)>,
    /// Most starts in an hour seen, per tenth, and when.
    pub most: [[(i64, i64); 10]; 2],
    pub recent: [Stroke; 2],
    pub reference: [Stroke; 2],
    pub events: VecDeque<Event>,
    pub moves: VecDeque<Move>,
}

/// 0 for opening, 1 for closing.
pub(super) const fn side(way: Way) -> usize {
    match way {
        Way::Open => 0,
        Way::Close => 1,
    }
}

/// What the event log may say: NE 107 category and text (AIIOM000698-01, section 8.1).
const EVENTS: [(i64, &str); 12] = [
    (0, "Service interval reached"),
    (1, "Vibration HI"),
    (2, "Partial stroke test, open: passed"),
    (3, "Phase lost"),
    (1, "Torque HI, open"),
    (0, "Battery low"),
    (2, "Selector moved to LOCAL"),
    (2, "Selector moved to REMOTE"),
    (3, "Motor over temperature"),
    (1, "Open final position deviation"),
    (4, "Link board restarted"),
    (0, "Drive sleeve turns above the set amount"),
];

impl Unit {
    pub fn new(tag: &str, events: usize, moves_itself: bool) -> Self {
        let seed = tag.bytes().fold(7_i64, |sum, b| {
            sum.wrapping_mul(31).wrapping_add(i64::from(b)) & 0xFFFF
        });
        let stroke = |way, reference| Stroke {
            start: 0,
            end: 0,
            number: STROKES,
            reference,
            way,
        };
        let bins = [STROKES.saturating_mul(BIN_MS); 10];
        Self {
            tag: tag.to_owned(),
            seed,
            moves_itself,
            born: 0,
            wall: 0,
            age_ms: 0,
            position: 0,
            moving: None,
            opens: STROKES,
            closes: STROKES,
            on_ms: [bins, bins],
            on_at: [[0; 10]; 2],
            starts: VecDeque::new(),
            most: [[(0, 0); 10]; 2],
            recent: [stroke(Way::Open, false), stroke(Way::Close, false)],
            reference: [stroke(Way::Open, true), stroke(Way::Close, true)],
            events: VecDeque::with_capacity(events.min(KEPT)),
            moves: VecDeque::new(),
        }
    }

    /// The clock is known: what happened before gets its dates.
    pub fn begin(&mut self, wall: i64, events: usize) {
        self.born = wall;
        self.wall = wall;
        let ago = |seconds: i64| wall.saturating_sub(seconds);
        self.on_at = [[ago(3_600); 10], [ago(1_800); 10]];
        self.most = [[(4, ago(700_000)); 10], [(3, ago(690_000)); 10]];
        for (at, way) in [(0, Way::Open), (1, Way::Close)] {
            let start = ago(if way == Way::Open { 3_612 } else { 1_812 });
            if let Some(stroke) = self.recent.get_mut(at) {
                stroke.start = start;
                stroke.end = start.saturating_add(12);
            }
            if let Some(stroke) = self.reference.get_mut(at) {
                stroke.start = ago(AGE).saturating_add(86_400);
                stroke.end = ago(AGE).saturating_add(86_412);
            }
        }
        let count = i64::try_from(events.min(KEPT)).unwrap_or(0);
        for number in 0..count {
            let back = count.saturating_sub(number).saturating_mul(32_400);
            let time = ago(back).saturating_sub(noise(self.seed, number, 7_200));
            let which = usize::try_from(noise(self.seed, number.saturating_add(9_000), 12));
            self.event(which.unwrap_or(0), time);
        }
        let strokes = 130_i64;
        for number in 0..strokes {
            let time = ago(strokes.saturating_sub(number).saturating_mul(10_800));
            let way = if number & 1 == 0 {
                Way::Open
            } else {
                Way::Close
            };
            self.record(way, true, time);
            self.record(way, false, time.saturating_add(12));
        }
    }

    /// When the unit was taken into service.
    pub fn commissioned(&self) -> i64 {
        self.born.saturating_sub(AGE)
    }

    pub fn event(&mut self, which: usize, time: i64) {
        let Some((category, text)) = EVENTS.get(which) else {
            return;
        };
        let id = self.events.back().map_or(1_001, |e| e.id.saturating_add(1));
        self.events.push_back(Event {
            id,
            time,
            category: *category,
            text,
        });
        if self.events.len() > KEPT {
            self.events.pop_front();
        }
    }

    /// Notes the start or the end of a stroke.
    fn record(&mut self, way: Way, start: bool, time: i64) {
        let id = self
            .moves
            .back()
            .map_or(FIRST_MOVE, |m| m.id.saturating_add(1) & 0xFFFF);
        let opened = (way == Way::Open) != start;
        let (demand, text) = match (way, start) {
            (Way::Open, true) => (1_000, "Network open command"),
            (Way::Close, true) => (0, "Network close command"),
            (Way::Open, false) => (1_000, "Stopped: open limit"),
            (Way::Close, false) => (0, "Stopped: close torque"),
        };
        let rpm = match (way, start) {
            (_, false) => 0,
            (Way::Open, true) => 54,
            (Way::Close, true) => -54,
        };
        let position = if opened { 100 } else { 0 };
        let torque = match (way, start) {
            (Way::Open, true) => 41,
            (Way::Open, false) => 28,
            (Way::Close, true) => 22,
            (Way::Close, false) => 58,
        };
        let record = Move {
            id,
            time,
            position,
            rpm,
            torque,
            temperature: self.motor_temperature(time),
            demand,
            text,
        };
        self.moves.push_back(record);
        if self.moves.len() > KEPT {
            self.moves.pop_front();
        }
    }

    /// One step of time.
    pub fn step(&mut self) {
        let before = self.age_ms;
        self.age_ms = before.saturating_add(STEP_MS);
        self.wall = self
            .born
            .saturating_add(self.age_ms.checked_div(1000).unwrap_or(0));
        if self.moves_itself && self.moving.is_none() {
            let phase = before.checked_rem_euclid(CYCLE_MS).unwrap_or(0);
            if phase < STEP_MS && self.position == 0 {
                self.start(Way::Open);
            } else if (CLOSE_AT_MS..CLOSE_AT_MS.saturating_add(STEP_MS)).contains(&phase)
                && self.position == 1000
            {
                self.start(Way::Close);
            }
        }
        if let Some(way) = self.moving {
            self.travel(way);
        }
        let hour = self.wall.saturating_sub(3_600);
        while self.starts.front().is_some_and(|s| s.0 < hour) {
            self.starts.pop_front();
        }
    }

    /// Begins a stroke.
    pub fn start(&mut self, way: Way) {
        self.moving = Some(way);
        let counter = match way {
            Way::Open => &mut self.opens,
            Way::Close => &mut self.closes,
        };
        *counter = counter.saturating_add(1);
        let number = *counter;
        let bin = self.bin();
        self.starts.push_back((self.wall, way, bin));
        let now = self.starts_in(way, bin);
        if let Some(most) = self.most.get_mut(side(way)).and_then(|m| m.get_mut(bin))
            && now > most.0
        {
            *most = (now, self.wall);
        }
        if let Some(stroke) = self.recent.get_mut(side(way)) {
            *stroke = Stroke {
                start: self.wall,
                end: 0,
                number,
                reference: false,
                way,
            };
        }
        self.record(way, true, self.wall);
    }

    /// Starts of the last hour in a tenth of the travel.
    pub fn starts_in(&self, way: Way, bin: usize) -> i64 {
        let of = |s: &&(i64, Way, usize)| s.1 == way && s.2 == bin;
        i64::try_from(self.starts.iter().filter(of).count()).unwrap_or(0)
    }

    /// The tenth of the travel where the valve is.
    fn bin(&self) -> usize {
        let bin = self.position.checked_div(100).unwrap_or(0).clamp(0, 9);
        usize::try_from(bin).unwrap_or(0)
    }

    fn travel(&mut self, way: Way) {
        let by = match way {
            Way::Open => TRAVEL,
            Way::Close => TRAVEL.saturating_neg(),
        };
        // The tenth in which the middle of this step lies.
        let middle = self.position.saturating_add(by >> 1).clamp(0, 999);
        let bin = usize::try_from(middle.checked_div(100).unwrap_or(0)).unwrap_or(0);
        let at = side(way);
        if let Some(ms) = self.on_ms.get_mut(at).and_then(|b| b.get_mut(bin)) {
            *ms = ms.saturating_add(STEP_MS);
        }
        if let Some(time) = self.on_at.get_mut(at).and_then(|b| b.get_mut(bin)) {
            *time = self.wall;
        }
        self.position = self.position.saturating_add(by).clamp(0, 1000);
        let arrived = match way {
            Way::Open => self.position == 1000,
            Way::Close => self.position == 0,
        };
        if arrived {
            self.moving = None;
            if let Some(stroke) = self.recent.get_mut(at) {
                stroke.end = self.wall;
            }
            self.record(way, false, self.wall);
        }
    }

    /// Seconds that the motor ran.
    pub fn runtime(&self) -> i64 {
        let ms = self
            .on_ms
            .iter()
            .flatten()
            .fold(0_i64, |sum, ms| sum.saturating_add(*ms));
        ms.checked_div(1000).unwrap_or(0)
    }

    /// Tenths of a degree Celsius: a day, a year, and a little noise.
    pub fn motor_temperature(&self, time: i64) -> i64 {
        let hour = time.checked_div(3_600).unwrap_or(0);
        wave(hour, 24, 90)
            .saturating_add(wave(hour, 8_766, 220))
            .saturating_add(noise(self.seed, hour, 12))
            .saturating_sub(35)
    }

    /// Tenths of a degree Celsius inside the housing.
    pub fn internal_temperature(&self, time: i64) -> i64 {
        let hour = time.checked_div(3_600).unwrap_or(0);
        wave(hour, 24, 60)
            .saturating_add(wave(hour, 8_766, 200))
            .saturating_add(noise(self.seed, hour.saturating_add(77), 8))
    }

    /// Volts now.
    pub fn volts(&self) -> i64 {
        noise(self.seed, self.wall, 7).saturating_add(397)
    }

    /// True if a phase is missing: half a minute in each quarter of an hour.
    pub fn phase_lost(&self) -> bool {
        let quarter = self.age_ms.checked_rem_euclid(900_000).unwrap_or(0);
        self.moves_itself && (600_000..630_000).contains(&quarter)
    }
}
