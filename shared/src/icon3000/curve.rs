//! Torque signatures: curves of registers and of files alike, what can be measured on them, and how
//! far one has moved from its reference.
//!
//! The manual says how a curve is stored, but neither where break-away ends nor what drift is too
//! much. The zones and thresholds below are **ours**: what stands here is a first judgement to look
//! at, not a limit of the manufacturer.

use super::model::File;
use super::read::{Log, value as record_value};
use super::records::Records;
use crate::map::row::{Kind, Row, Source};
use crate::value::Value;

/// Samples of a curve: one at each whole percent of travel.
pub const SAMPLES: usize = 101;
/// Break-away: the largest torque in the first so many percent of travel (ours).
pub const BREAK_AWAY_ZONE: u16 = 10;
/// Seating: the largest torque in the last so many percent of travel (ours).
pub const SEATING_ZONE: u16 = 10;
/// Running: the mean torque between so many percent of travel and as many before the end (ours).
pub const RUNNING_FROM: u16 = 20;
/// Drift of a measure against the reference, in points of percent, from which a look pays (ours).
pub const DRIFT_WATCH: i32 = 10;
/// Drift from which something should be done (ours).
pub const DRIFT_ACT: i32 = 20;
/// Distance of the peak from the torque setting, in points of percent, below which a look pays
/// (ours).
pub const MARGIN_WATCH: i32 = 10;

/// Which way the valve went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// From 0 % to 100 %.
    Open,
    /// From 100 % to 0 %.
    Close,
}

impl Direction {
    /// `open` or `close`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Close => "close",
        }
    }

    /// Position of a percent of travel, counted from the start of the stroke.
    #[must_use]
    pub const fn position(self, travel: u16) -> u16 {
        match self {
            Self::Open => travel,
            Self::Close => 100_u16.saturating_sub(travel),
        }
    }
}

/// Which curve of its kind it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Which {
    /// The one that others are compared with.
    Reference,
    /// The latest is 1, the oldest up to 100.
    Stored(u16),
}

/// Where a curve came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// 64 registers.
    Register(&'static Row),
    /// A file of function 20.
    File(u16),
}

impl core::fmt::Display for Origin {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Register(row) => write!(f, "{} {}", row.table.label(), row.address),
            Self::File(number) => write!(f, "File {number}"),
        }
    }
}

/// A torque curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Which way.
    pub direction: Direction,
    /// Reference, latest, or an older one.
    pub which: Which,
    /// Where it came from.
    pub origin: Origin,
    /// Where that is described.
    pub source: Source,
    /// Torque in percent at 0 % to 100 % of position; `None` where it was not read.
    pub samples: Vec<Option<i16>>,
    /// When it was recorded, by the clock of the device: `2026-01-15 09:41:07`; `None` if not
    /// known.
    pub when: Option<String>,
    /// Temperatures of electronics, terminal board and motor in °C.
    pub temperatures: [Option<i16>; 3],
    /// Voltage in V.
    pub voltage: Option<u16>,
    /// Time of the stroke in s.
    pub stroke_time: Option<u16>,
}

impl Curve {
    /// A curve from its file (1000 to 1100 open, 2000 to 2100 close; reading E74). `None` if it is
    /// no such file.
    #[must_use]
    pub fn of_file(number: u16, records: &Records) -> Option<Self> {
        let file = File::of(number)?;
        let direction = match file.key {
            "open_curves" => Direction::Open,
            "close_curves" => Direction::Close,
            _ => return None,
        };
        let log = Log::read(number, records)?;
        let small = |key: &str| -> Option<i64> { log.get(key)?.number() };
        let word = |key: &str| small(key).and_then(|n| u16::try_from(n).ok());
        let degrees = |key: &str| small(key).and_then(|n| i16::try_from(n).ok());
        let field = file.layout?.head_field("torque")?;
        let samples = log.run("torque").into_iter().map(|item| {
            let item = item?;
            match record_value(field, &item.words).value {
                Value::Number { raw, .. } => i16::try_from(raw).ok(),
                _ => None,
            }
        });
        Some(Self {
            direction,
            which: match number.saturating_sub(file.first) {
                0 => Which::Reference,
                n => Which::Stored(n),
            },
            origin: Origin::File(number),
            source: file.source,
            samples: samples.collect(),
            when: log.get("time").map(super::read::Item::text),
            temperatures: [
                degrees("electronics_temperature"),
                degrees("terminal_board_temperature"),
                degrees("motor_temperature"),
            ],
            voltage: word("voltage"),
            stroke_time: word("stroke_time"),
        })
    }

    /// A curve from its 64 registers (reading E34: 101 unsigned samples, BCD date and time, three
    /// temperatures, voltage, time). `None` if the row is no curve, or nothing is stored there.
    #[must_use]
    pub fn of_registers(row: &'static Row, bytes: &[u8]) -> Option<Self> {
        if row.kind != Kind::Curve || bytes.len() < 128 {
            return None;
        }
        let direction = if row.key.contains("open") {
            Direction::Open
        } else {
            Direction::Close
        };
        let (samples, rest) = bytes.split_at_checked(SAMPLES)?;
        let (when, rest) = rest.split_first_chunk::<6>()?;
        let (temperatures, rest) = rest.split_first_chunk::<3>()?;
        let (voltage, rest) = rest.split_first_chunk::<2>()?;
        let time = rest.first_chunk::<2>()?;
        if *when == [0; 6] && samples.iter().all(|s| *s == 0) {
            return None;
        }
        let bcd = |b: u8| (b >> 4 < 10 && b & 15 < 10).then(|| format!("{b:02X}"));
        let [day, month, year, second, minute, hour] = *when;
        let when = (|| {
            Some(format!(
                "20{}-{}-{} {}:{}:{}",
                bcd(year)?,
                bcd(month)?,
                bcd(day)?,
                bcd(hour)?,
                bcd(minute)?,
                bcd(second)?
            ))
        })();
        Some(Self {
            direction,
            which: if row.key.starts_with("reference") {
                Which::Reference
            } else {
                Which::Stored(1)
            },
            origin: Origin::Register(row),
            source: row.source,
            samples: samples.iter().map(|s| Some(i16::from(*s))).collect(),
            when,
            temperatures: temperatures.map(|t| Some(i16::from(i8::from_be_bytes([t])))),
            voltage: Some(u16::from_be_bytes(*voltage)),
            stroke_time: Some(u16::from_be_bytes(*time)),
        })
    }

    /// True if every sample was read.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.samples.len() == SAMPLES && self.samples.iter().all(Option::is_some)
    }

    /// Torque at a position.
    #[must_use]
    pub fn at(&self, position: u16) -> Option<i16> {
        self.samples.get(usize::from(position)).copied().flatten()
    }

    /// Position and torque by travel, from the start of the stroke; what was not read is left out.
    fn along(&self, from: u16, to: u16) -> impl Iterator<Item = (u16, i16)> {
        (from..=to).filter_map(|travel| {
            let position = self.direction.position(travel);
            Some((position, self.at(position)?))
        })
    }

    /// The largest torque of a stretch of travel, by its size without sign.
    fn largest(&self, from: u16, to: u16) -> Option<Peak> {
        let mut found: Option<Peak> = None;
        for (position, torque) in self.along(from, to) {
            if found.is_none_or(|f| torque.unsigned_abs() > f.torque.unsigned_abs()) {
                found = Some(Peak { position, torque });
            }
        }
        found
    }

    /// What can be measured on it.
    #[must_use]
    pub fn signature(&self) -> Signature {
        let end = 100_u16.saturating_sub(RUNNING_FROM);
        let mut sum = 0_i32;
        let mut count = 0_i32;
        for (_, torque) in self.along(RUNNING_FROM, end) {
            sum = sum.saturating_add(i32::from(torque));
            count = count.saturating_add(1);
        }
        Signature {
            break_away: self.largest(0, BREAK_AWAY_ZONE),
            running_tenths: sum.saturating_mul(10).checked_div(count),
            seating: self.largest(100_u16.saturating_sub(SEATING_ZONE), 100),
            peak: self.largest(0, 100),
        }
    }
}

/// A torque at a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peak {
    /// Percent of position.
    pub position: u16,
    /// Percent of torque.
    pub torque: i16,
}

/// What can be measured on a curve; `None` where no sample of the zone was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signature {
    /// Largest torque at the start of the travel.
    pub break_away: Option<Peak>,
    /// Mean torque of the middle, in tenths of a percent.
    pub running_tenths: Option<i32>,
    /// Largest torque at the end of the travel.
    pub seating: Option<Peak>,
    /// Largest torque anywhere.
    pub peak: Option<Peak>,
}

/// How far a curve has moved from its reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drift {
    /// Change of the break-away torque in points of percent.
    pub break_away: Option<i32>,
    /// Change of the mean running torque in tenths of a point.
    pub running_tenths: Option<i32>,
    /// Change of the seating torque in points of percent.
    pub seating: Option<i32>,
    /// Largest change at one position, and where.
    pub largest: Option<(u16, i32)>,
    /// Mean of the changes without sign, in tenths of a point.
    pub mean_tenths: Option<i32>,
}

/// What a curve says of its valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Nothing can be said: no reference, or too little was read.
    Unknown,
    /// As it was.
    Steady,
    /// A look pays.
    Watch,
    /// Something should be done.
    Act,
}

impl Verdict {
    /// What people read.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Unknown => "cannot be judged",
            Self::Steady => "as the reference",
            Self::Watch => "has changed; keep an eye on it",
            Self::Act => "has changed a lot; inspect the valve",
        }
    }
}

/// Compares a curve with its reference of the same direction; `None` if the directions differ.
#[must_use]
pub fn drift(reference: &Curve, curve: &Curve) -> Option<Drift> {
    if reference.direction != curve.direction {
        return None;
    }
    let size = |peak: Peak| i32::from(peak.torque.unsigned_abs());
    let change = |was: Option<Peak>, now: Option<Peak>| Some(size(now?).saturating_sub(size(was?)));
    let (was, now) = (reference.signature(), curve.signature());
    let mut largest: Option<(u16, i32)> = None;
    let (mut sum, mut count) = (0_i32, 0_i32);
    for position in 0..=100_u16 {
        let (Some(was), Some(now)) = (reference.at(position), curve.at(position)) else {
            continue;
        };
        let by = i32::from(now.unsigned_abs()).saturating_sub(was.unsigned_abs().into());
        if largest.is_none_or(|(_, most)| by.abs() > most.abs()) {
            largest = Some((position, by));
        }
        sum = sum.saturating_add(by.abs());
        count = count.saturating_add(1);
    }
    let running = |s: Signature| s.running_tenths.map(i32::abs);
    Some(Drift {
        break_away: change(was.break_away, now.break_away),
        running_tenths: running(now)
            .zip(running(was))
            .map(|(now, was)| now.saturating_sub(was)),
        seating: change(was.seating, now.seating),
        largest,
        mean_tenths: sum.saturating_mul(10).checked_div(count),
    })
}

/// Judges a drift: by the measure that changed most, in either direction, since a torque that fell
/// may be a stem that turns in nothing.
#[must_use]
pub fn judge(drift: &Drift) -> Verdict {
    let measures = [
        drift.break_away,
        drift.running_tenths.map(|t| t / 10),
        drift.seating,
    ];
    let known: Vec<i32> = measures.into_iter().flatten().map(i32::abs).collect();
    match known.iter().max() {
        _ if known.len() < measures.len() => Verdict::Unknown,
        None => Verdict::Unknown,
        Some(most) if *most >= DRIFT_ACT => Verdict::Act,
        Some(most) if *most >= DRIFT_WATCH => Verdict::Watch,
        Some(_) => Verdict::Steady,
    }
}

/// Judges the peak against the torque setting of the direction (HR 3670 open, 3671 close), both in
/// percent: at or above the setting the motor stops.
#[must_use]
pub fn margin(peak: Peak, setting: u16) -> (i32, Verdict) {
    let left = i32::from(setting).saturating_sub(peak.torque.unsigned_abs().into());
    let verdict = if left <= 0 {
        Verdict::Act
    } else if left < MARGIN_WATCH {
        Verdict::Watch
    } else {
        Verdict::Steady
    };
    (left, verdict)
}

/// Points of a trend: seconds since 2000 and raw value, the oldest first. The log has the latest
/// first. Samples of which time or value was not read are left out.
#[must_use]
pub fn trend(log: &Log, key: &str) -> Vec<(u32, i64)> {
    let points = log
        .entries
        .iter()
        .filter_map(|e| Some((e.time()?, e.get(key)?.number()?)));
    let mut points: Vec<_> = points.collect();
    points.reverse();
    points
}
