//! What a valve does, from the words of its actuator.

use shared::address::{Address, Table};
use shared::device::Device;
use shared::image::{Image, Seen};
use shared::map::row::{DeviceMap, Member, Row};
use shared::proto::{Block, TableName};
use shared::scale::Scale;
use shared::value::Value;

use super::values::{Item, cell};

/// Which way the valve goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Travel {
    /// It stands.
    #[default]
    Stopped,
    /// It opens.
    Opening,
    /// It closes.
    Closing,
}

/// A number with its text.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// For drawing.
    pub value: f64,
    /// As shown, without unit.
    pub text: String,
    /// Its unit.
    pub unit: &'static str,
    /// When it was read, in microseconds.
    pub at: u64,
    /// A word if it can't be relied on.
    pub quality: Option<&'static str>,
}

impl Figure {
    /// The position of a HART device: the second variable of an answer to command 3, which came at
    /// a time; `None` if the device has no value, or one that is no percentage.
    ///
    /// Shape: status of two bytes, loop current, then unit code and number for each variable.
    /// Source: PUB092-003-00, table 3: SV is the position.
    #[must_use]
    pub fn of_hart(answer: &[u8], at: u64) -> Option<Self> {
        // The address is long or short, and up to three bytes of expansion follow it.
        let first = *answer.first()?;
        let address = if first & 0x80 == 0 { 1 } else { 5 };
        let skip = 1 + address + usize::from(first >> 5 & 3) + COMMAND_TO_SECOND;
        let second = answer.get(skip..)?;
        // The check byte follows.
        let &[unit, a, b, c, d, _] = second.first_chunk()?;
        let value = f32::from_be_bytes([a, b, c, d]);
        if unit != PERCENT || value.abs() > 1000.0 || value.is_nan() {
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "at most ten thousand in each direction"
        )]
        let tenths = (value * 10.0).round() as i32;
        let sign = if tenths < 0 { "-" } else { "" };
        let (whole, part) = (tenths.abs() / 10, tenths.abs() % 10);
        Some(Self {
            value: f64::from(value),
            text: match part {
                0 => format!("{sign}{whole}"),
                part => format!("{sign}{whole}.{part}"),
            },
            unit: "%",
            at,
            quality: None,
        })
    }
}

/// A bit that is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Active {
    /// The word that holds it.
    pub row: &'static Row,
    /// The bit.
    pub member: &'static Member,
}

/// What a device says about itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overview {
    /// True once its status was read.
    pub known: bool,
    /// Position, 100 is open.
    pub position: Option<Figure>,
    /// Torque, negative towards open.
    pub torque: Option<Figure>,
    /// Torque limits towards open and close, in the unit of the torque.
    pub torque_limits: (Option<Figure>, Option<Figure>),
    /// Which way it goes.
    pub travel: Travel,
    /// Closed by its limit.
    pub close_limit: bool,
    /// Open by its limit.
    pub open_limit: bool,
    /// What happens, in words.
    pub state: String,
    /// Who may operate it: `Local`, `Remote`, `Off`.
    pub mode: &'static str,
    /// Status bits that are set, those of position and mode left out.
    pub status: Vec<Active>,
    /// Alarm bits that are set.
    pub alarms: Vec<Active>,
    /// Warning bits that are set.
    pub warnings: Vec<Active>,
    /// Other facts: label and text.
    pub facts: Vec<(&'static str, String)>,
}

/// Command, count, status, loop current and the first variable.
const COMMAND_TO_SECOND: usize = 2 + 2 + 4 + 5;
/// The code of percent among the units of HART.
const PERCENT: u8 = 57;

/// Status bits that are said in other words.
const SAID: [&str; 13] = [
    "close_limit",
    "open_limit",
    "actuator_moving",
    "opening",
    "closing",
    "selector_in_local",
    "selector_in_remote",
    "selector_in_off",
    "alarm",
    "warning",
    "channel_1_active",
    "channel_2_active",
    "motor_thermostat_closed",
];

/// Rows that are shown as they are: key and label.
const FACTS: [(&str, &str); 8] = [
    ("valve_tag_name", "Tag in the actuator"),
    ("actuator_serial_number", "Serial number"),
    ("actuator_identifier", "Identifier"),
    ("nominal_torque_thrust", "Nominal torque or thrust"),
    ("modbus_interface_sw_version", "Interface firmware"),
    ("user_level_logged", "User level"),
    ("current_date", "Date in the actuator"),
    ("current_time", "Time in the actuator"),
];

/// Looks rows up in the holding registers of a map.
#[derive(Clone, Copy, Debug)]
struct Lookup<'a> {
    map: &'static DeviceMap,
    image: &'a Image,
}

impl Lookup<'_> {
    fn row(self, key: &str) -> Option<&'static Row> {
        self.map.by_key(Table::Holding, key)
    }

    fn seen(self, key: &str) -> Option<(&'static Row, Seen)> {
        let row = self.row(key)?;
        Some((row, self.image.row(row)?))
    }

    fn figure(self, key: &str) -> Option<Figure> {
        let (row, seen) = self.seen(key)?;
        let Value::Number { raw, scale } = seen.judged.value else {
            return None;
        };
        Some(Figure {
            value: Scale::to_f64(scale, raw),
            text: scale.apply(raw).to_string(),
            unit: row.unit,
            at: seen.at.get(),
            quality: match seen.judged.quality {
                shared::value::Quality::Good => None,
                quality => Some(quality.label()),
            },
        })
    }

    fn active(self, key: &str) -> Vec<Active> {
        let Some((row, seen)) = self.seen(key) else {
            return Vec::new();
        };
        let Value::Flags { raw, set } = seen.judged.value else {
            return Vec::new();
        };
        set.members
            .iter()
            .filter(|m| raw.wrapping_shr(u32::from(m.value)) & 1 == 1)
            .map(|member| Active { row, member })
            .collect()
    }

    /// A unit of a DDC-100 network, from its status register.
    fn field_unit(self) -> Overview {
        let mut seen = Overview {
            known: self.seen("status").is_some(),
            // Beyond 100 it counts in another scale, which is known on the unit's own page only.
            position: self.figure("position").filter(|p| p.quality.is_none()),
            ..Overview::default()
        };
        for bit in self.active("status") {
            match bit.member.value {
                0..=4 => {
                    if !seen.state.is_empty() {
                        seen.state.push_str(", ");
                    }
                    seen.state.push_str(bit.member.label);
                }
                6 => seen.mode = "Local",
                // The channels: the page of the network weighs them.
                10 | 11 => {}
                5 | 7..=9 | 15 => seen.alarms.push(bit),
                _ => seen.warnings.push(bit),
            }
        }
        seen
    }

    fn all(self, keys: &[&str]) -> Vec<Active> {
        keys.iter().flat_map(|key| self.active(key)).collect()
    }
}

impl Overview {
    /// Reads what is known of a device.
    #[must_use]
    pub fn of(device: Device, image: &Image) -> Self {
        let Some(map) = device.map() else {
            return Self::default();
        };
        if device == Device::Icon2000v4 {
            let mut seen = Self::of(Device::Icon3000, &as_later(image));
            let bits = seen.status.iter_mut().chain(&mut seen.alarms);
            for bit in bits.chain(&mut seen.warnings) {
                let at = bit.row.address.get();
                let (table, own) = match at {
                    3009.. => (Table::Input, at - 3007),
                    _ => (Table::Discrete, (at - 3001) * 16 + bit.member.value),
                };
                bit.row = map.row_at(table, Address::new(own)).unwrap_or(bit.row);
            }
            return seen;
        }
        let look = Lookup { map, image };
        if !device.is_icon() {
            return look.field_unit();
        }
        let bits = look.all(&[
            "actuator_status_1",
            "actuator_status_2",
            "actuator_status_3",
            "actuator_status_4",
        ]);
        let has = |key: &str| bits.iter().any(|b| b.member.key == key);
        let known = look.seen("actuator_status_1").is_some();
        let travel = match (has("opening"), has("closing")) {
            (true, false) => Travel::Opening,
            (false, true) => Travel::Closing,
            _ => Travel::Stopped,
        };
        let mode = if has("selector_in_remote") {
            "Remote"
        } else if has("selector_in_local") {
            "Local"
        } else if has("selector_in_off") {
            "Off"
        } else {
            ""
        };
        let position = look.figure("actuator_position");
        let mut overview = Self {
            known,
            torque: look.figure("output_torque"),
            torque_limits: (
                look.figure("standard_opening_torque"),
                look.figure("standard_closing_torque"),
            ),
            travel,
            close_limit: has("close_limit"),
            open_limit: has("open_limit"),
            mode,
            alarms: look.all(&["alarms_1", "alarms_2", "alarms_3"]),
            warnings: look.active("warnings"),
            facts: facts(look),
            state: String::new(),
            position,
            status: Vec::new(),
        };
        overview.state = overview.words(has("actuator_moving"));
        overview.status = bits
            .into_iter()
            .filter(|b| !SAID.contains(&b.member.key))
            .collect();
        overview
    }

    fn words(&self, moving: bool) -> String {
        if !self.known {
            return "Not read yet".to_owned();
        }
        match (self.travel, self.open_limit, self.close_limit) {
            (Travel::Opening, ..) => "Opening",
            (Travel::Closing, ..) => "Closing",
            (Travel::Stopped, true, true) => "Both limits reported",
            (Travel::Stopped, true, false) => "Open",
            (Travel::Stopped, false, true) => "Closed",
            (Travel::Stopped, false, false) if moving => "Moving",
            (Travel::Stopped, false, false) => "Stopped between the limits",
        }
        .to_owned()
    }
}

/// The inputs of an ICON2000v4 at the addresses where later models have them: position, torque,
/// warnings and alarms, and bits of status (readings E41, E44).
fn as_later(image: &Image) -> Image {
    let mut later = Image::new();
    for (table, address, cell) in image.iter() {
        let at = address.get();
        let (home, word) = match (table, at) {
            (Table::Input, 0..5) => ([3004, 3005, 3009, 3010, 3011][usize::from(at)], cell.word),
            (Table::Discrete, 0..29) => {
                let home = Address::new(3001 + at / 16);
                let known = later.cell(Table::Holding, home).map_or(0, |c| c.word);
                (home.get(), known | cell.word << (at % 16))
            }
            _ => continue,
        };
        later.set(Table::Holding, Address::new(home), word, cell.at);
    }
    later
}

fn facts(look: Lookup<'_>) -> Vec<(&'static str, String)> {
    FACTS
        .iter()
        .filter_map(|(key, label)| {
            let cell = cell(Item::Row(look.row(key)?), look.image)?;
            Some((*label, cell.text))
        })
        .collect()
}

fn holding(start: u16, count: u16) -> Block {
    Block {
        table: TableName::Holding,
        start,
        count,
    }
}

/// The blocks that tell what a valve does: status, position, torque, alarms, clock.
///
/// Source: VCIOM-16345-EN, section 7.4: holding registers 3000 to 3030; of an ICON2000v4, discrete
/// inputs 0 to 28 and input registers 0 to 4.
#[must_use]
pub fn watched(device: Device) -> Vec<Block> {
    let inputs = |table, count| Block {
        table,
        start: 0,
        count,
    };
    match device {
        Device::Icon2000v4 => vec![inputs(TableName::Discrete, 29), inputs(TableName::Input, 5)],
        _ if device.is_icon() => vec![holding(3000, 31)],
        _ => Vec::new(),
    }
}

/// Blocks that seldom change, read once when the page of a device is opened: identity, and on the
/// ICON3000v2 the user level and the torque limits.
#[must_use]
pub fn read_once(device: Device) -> Vec<Block> {
    match device {
        Device::Icon3000 => vec![holding(3034, 44)],
        Device::Icon3000v2 => vec![holding(3034, 44), holding(3480, 1), holding(3670, 2)],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::capture::Micros;

    fn image(words: &[(u16, u16)]) -> Image {
        let mut image = Image::new();
        for (address, word) in words {
            let [a, b] = address.to_be_bytes();
            let [c, d] = word.to_be_bytes();
            image
                .absorb(&[3, a, b, 0, 1], &[3, 2, c, d], Micros::new(9))
                .unwrap();
        }
        image
    }

    #[test]
    fn a_moving_valve_is_told_in_words() {
        let image = image(&[
            (3001, 0x00A4),
            (3002, 0x0002),
            (3004, 452),
            (3005, 0xFFE9),
            (3009, 4),
            (3010, 1),
        ]);
        let seen = Overview::of(Device::Icon3000v2, &image);
        assert_eq!(seen.state, "Opening");
        assert_eq!(seen.mode, "Remote");
        assert_eq!(seen.travel, Travel::Opening);
        assert_eq!(seen.position.unwrap().text, "45.2");
        assert_eq!(seen.torque.unwrap().text, "-23");
        assert_eq!(seen.alarms.len(), 1);
        assert_eq!(seen.alarms[0].member.key, "motor_thermostat");
        assert_eq!(seen.warnings[0].member.key, "hi_temperature");
        assert!(seen.status.iter().all(|a| !SAID.contains(&a.member.key)));
    }

    /// Discrete inputs 0 (closed), 5 (REMOTE), 18 (closing); IR 0 to 4: 24.0 %, -12 %, warning 2, no
    /// alarms 1, alarms 2 bit 1 (tables 2 and 3).
    #[test]
    fn an_older_model_is_told_by_its_inputs() {
        let mut image = Image::new();
        let bits = [2, 4, 0b0010_0001, 0, 0b0000_0100, 0];
        image
            .absorb(&[2, 0, 0, 0, 29], &bits, Micros::new(9))
            .unwrap();
        let words = [4, 10, 0, 240, 0xFF, 0xF4, 0, 4, 0, 0, 0, 2];
        image
            .absorb(&[4, 0, 0, 0, 5], &words, Micros::new(9))
            .unwrap();
        let seen = Overview::of(Device::Icon2000v4, &image);
        assert_eq!((seen.state.as_str(), seen.mode), ("Closing", "Remote"));
        assert!(seen.known && seen.close_limit && !seen.open_limit);
        assert_eq!(seen.position.unwrap().text, "24.0");
        assert_eq!(seen.torque.unwrap().text, "-12");
        let place = |bit: &Active| (bit.row.table, bit.row.address.get(), bit.member.value);
        let places: Vec<_> = seen
            .warnings
            .iter()
            .chain(&seen.alarms)
            .map(place)
            .collect();
        assert_eq!(places, [(Table::Input, 2, 2), (Table::Input, 4, 1)]);
        image.set(Table::Discrete, Address::new(21), 1, Micros::new(9));
        let seen = Overview::of(Device::Icon2000v4, &image);
        let places: Vec<_> = seen.status.iter().map(place).collect();
        assert_eq!(places, [(Table::Discrete, 21, 5)], "hardwired remote mode");
        // The same as the data say of it.
        for mirror in &shared::icon3000::model::MIRRORS {
            let at = mirror.address;
            let mut one = Image::new();
            one.set(mirror.table, at, 1, Micros::new(1));
            let later = as_later(&one);
            if let Some((_, home, cell)) = later.iter().next() {
                let bit = mirror.bit.unwrap_or(0);
                assert_eq!((home, cell.word), (mirror.home, 1 << bit), "{at}");
            }
        }
    }

    /// Section 3.2.3 of the guide, and a unit whose position counts to 4095.
    #[test]
    fn a_field_unit_is_told_in_words() {
        let read = |position: u16, status: u16| {
            let image = image(&[(7, position), (8, status)]);
            Overview::of(Device::Ddc100Uec, &image)
        };
        let seen = read(61, 0x0801);
        assert_eq!((seen.known, seen.state.as_str()), (true, "Opened"));
        assert_eq!(seen.position.unwrap().text, "61");
        assert!(seen.alarms.is_empty() && seen.warnings.is_empty());
        let seen = read(2048, 0x90CC);
        assert_eq!(seen.state, "Stopped, Opening");
        assert_eq!((seen.position, seen.mode), (None, "Local"));
        let names: Vec<_> = seen.alarms.iter().map(|a| a.member.label).collect();
        assert_eq!(names, ["Combined fault", "Phase error"]);
        assert_eq!(seen.warnings.len(), 1);
    }

    #[test]
    fn limits_and_silence() {
        let closed = Overview::of(Device::Icon3000, &image(&[(3001, 1)]));
        assert_eq!(closed.state, "Closed");
        let none = Overview::of(Device::Icon3000, &Image::new());
        assert_eq!(none.state, "Not read yet");
        assert_eq!(
            Overview::of(Device::None, &Image::new()),
            Overview::default()
        );
    }

    /// The worked answer R6: position 49.5 %, and no fourth variable.
    #[test]
    fn a_hart_device_tells_its_position() {
        let hex = "86AEDD012345031A000041400000394248000039424600003941480000397FA0000052";
        let frame = crate::state::absorb::bytes_of(hex);
        let figure = Figure::of_hart(&frame, 7).unwrap();
        assert_eq!(
            (figure.text.as_str(), figure.unit, figure.at),
            ("49.5", "%", 7)
        );
        // Unit and number of the second variable are bytes 19 to 23: none, and no percentage.
        for (at, byte) in [(19, 39), (20, 0x7F)] {
            let mut other = frame.clone();
            other[at] = byte;
            if at == 20 {
                other[21] = 0xA0;
            }
            assert_eq!(Figure::of_hart(&other, 7), None, "{at}");
        }
        // A refusal has no data.
        let refusal = crate::state::absorb::bytes_of("86AEDD0123450302404093");
        assert_eq!(Figure::of_hart(&refusal, 7), None);
        assert_eq!(Figure::of_hart(&[], 7), None);
    }

    #[test]
    fn the_blocks_are_in_the_map() {
        for device in [Device::Icon2000v4, Device::Icon3000, Device::Icon3000v2] {
            let map = device.map().unwrap();
            for block in watched(device).into_iter().chain(read_once(device)) {
                let read = block.read().unwrap();
                let rows = map.rows_in(read.table, read.start, read.count());
                assert!(rows.count() > 0);
            }
        }
    }
}
