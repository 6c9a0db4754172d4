//! The condensed status map: where it comes from, and as a file.

use shared::device::Family;
use shared::hart::link::Answer;
use shared::hart::model::{Bit, Mapped, Preset};
use shared::hart::ne107::{ALARM_BYTES, ENTRIES, Map, Report, report};
use shared::hart::{CONDENSED_STATUS, DEVICE_STATUS, PRESETS, additional};
use shared::session::Session;

use super::plan;
use super::site::body;
use super::unit::{Good, Key, Unit, find, raw_of};

/// The first line of a file.
const HEAD: &str = "index,status,bit,name,category";

/// A map as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Known([Option<u8>; ENTRIES]);

impl Known {
    /// A map of which nothing is known.
    pub const NONE: Self = Self([None; ENTRIES]);

    /// All of a map.
    #[must_use]
    pub fn all(map: &Map) -> Self {
        Self(core::array::from_fn(|index| Some(map.get(index))))
    }

    /// The category of an index; `None` if it was not read.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<u8> {
        self.0.get(index).copied().flatten()
    }

    /// The map, if all of it is known.
    #[must_use]
    pub fn whole(&self) -> Option<Map> {
        let mut map = Map::default();
        for (index, entry) in self.0.iter().enumerate() {
            map.set(index, (*entry)?);
        }
        Some(map)
    }

    /// What a device of this family makes of its status; `None` if that depends on an entry that is
    /// not known.
    #[must_use]
    pub fn report(&self, family: Family, status: &[u8]) -> Option<Report> {
        let mut map = Map::default();
        for (index, entry) in self.0.iter().enumerate() {
            let is_set = Map::bit(index).is_some_and(|(byte, bit)| {
                let raw = status.get(usize::from(byte)).filter(|_| byte < ALARM_BYTES);
                raw.is_some_and(|raw| raw >> bit & 1 != 0)
            });
            match entry {
                Some(code) => map.set(index, *code),
                // The CVA looks at no category.
                None if is_set && family != Family::Cva => return None,
                None => {}
            }
        }
        Some(report(family, status, &map))
    }

    /// Takes an answer to command 523 in: as many entries as it says that it has.
    fn take(&mut self, good: &Good) -> Option<()> {
        let number = |key| usize::try_from(raw_of(&good.shown, key)?).ok();
        let (start, count) = (number("start")?, number("count")?);
        let (_, field) = find(&good.shown, "entry")?;
        let bytes = good.shown.decoded.payload(field);
        let codes = bytes.iter().flat_map(|b| [b & 0x0F, b >> 4]);
        for (entry, code) in self.0.iter_mut().skip(start).zip(codes.take(count)) {
            *entry = Some(code);
        }
        Some(())
    }
}

/// The map that a device sent, as far as it was read.
#[must_use]
pub fn of_device(unit: &Unit) -> Option<Known> {
    let answers = unit.readings.iter().filter(|(key, _)| key.0 == 523);
    let mut answers: Vec<&Good> = answers.filter_map(|(_, r)| r.good.as_ref()).collect();
    // The newest has the last word.
    answers.sort_by_key(|good| good.at_us);
    let mut map = Known::NONE;
    for good in answers {
        map.take(good);
    }
    (map != Known::NONE).then_some(map)
}

/// What to ask for what an answer left out.
#[must_use]
pub fn rest(unit: &Unit) -> Option<Key> {
    let map = of_device(unit)?;
    let first = map.0.iter().position(Option::is_none)?;
    let start = u8::try_from(first & !1).ok()?;
    Some(plan::entries(start, 64_u8.saturating_sub(start))).filter(|key| *key != plan::map())
}

/// Why there is no map of a device, or why it may be old.
#[must_use]
pub fn refused(unit: &Unit) -> Option<&str> {
    let bad = unit.reading(&plan::map())?.bad.as_ref()?;
    Some(&bad.text)
}

/// The own status of a device in a capture: that of the frame that is selected, if it is an answer
/// to command 48, else of the last one.
#[must_use]
pub fn status_in(session: &Session, selected: Option<u32>) -> Option<Vec<u8>> {
    let mut frames = selected
        .into_iter()
        .chain((session.first()..session.len()).rev());
    frames.find_map(|index| {
        let answer = Answer::of(body(session.framing(), session.bytes(index)?))?;
        let is = answer.number() == 48 && answer.code() == Some(0);
        answer.data().get(..6).filter(|_| is).map(<[u8]>::to_vec)
    })
}

/// Status bytes as somebody typed them: at least those of the alarms.
#[must_use]
pub fn typed(text: &str) -> Option<Vec<u8>> {
    let digits: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let good = digits.len().is_multiple_of(2) && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let bytes = crate::state::absorb::bytes_of(&digits);
    let fits = (usize::from(ALARM_BYTES)..=25).contains(&bytes.len());
    (good && fits).then_some(bytes)
}

/// The example with this key.
#[must_use]
pub fn preset(key: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|p| p.key == key)
}

/// Table of the manual that an example is from: `table 20`.
#[must_use]
pub fn table(preset: &Preset) -> String {
    let part = preset.bits.first().map_or("", |b| b.source.part);
    part.split(',').next().unwrap_or(part).to_owned()
}

/// Where an index stands: `device status` or the byte of command 48, and the bit.
#[must_use]
pub fn place(index: usize) -> (String, u8) {
    match Map::bit(index) {
        Some((byte, bit)) => (format!("byte {byte}"), bit),
        None => (
            "device status".to_owned(),
            u8::try_from(index % 8).unwrap_or(0),
        ),
    }
}

/// What is known of the bit of an index.
#[must_use]
pub fn bit(family: Option<Family>, index: usize) -> Option<&'static Bit> {
    let (bits, bit) = match Map::bit(index) {
        Some((byte, bit)) => (additional(family?, byte)?, bit),
        None => (&DEVICE_STATUS, place(index).1),
    };
    bits.bits.iter().find(|b| b.bit == bit)
}

/// The indexes that a map of this family is about: those of the alarm bytes, with the bits that have
/// a name; without a family, or with no such bit, all of them. An entry that has a category is
/// always among them.
#[must_use]
pub fn rows(family: Option<Family>, map: &Known) -> Vec<usize> {
    let alarms = Map::index(0, 0)..Map::index(ALARM_BYTES, 0);
    let named = |index: &usize| family.is_none() || bit(family, *index).is_some();
    (0..ENTRIES)
        .filter(|i| map.get(*i).unwrap_or(0) != 0 || (alarms.contains(i) && named(i)))
        .collect()
}

/// The name of a category.
#[must_use]
pub fn category(code: u8) -> &'static str {
    CONDENSED_STATUS.name(u32::from(code)).unwrap_or("Reserved")
}

/// The bit of an example that has this index.
#[must_use]
pub fn mapped(preset: &'static Preset, index: usize) -> Option<&'static Mapped> {
    let at = Map::bit(index);
    preset.bits.iter().find(|m| at == Some((m.byte, m.bit)))
}

/// The map as a file: one line an entry.
#[must_use]
pub fn to_csv(family: Option<Family>, map: &Map) -> String {
    let mut text = format!("{HEAD}\n");
    for index in 0..ENTRIES {
        let (status, number) = place(index);
        let name = bit(family, index).map_or("", |b| b.label);
        let name = name.replace('"', "\"\"");
        let code = map.get(index);
        text.push_str(&format!("{index},{status},{number},\"{name}\",{code}\n"));
    }
    text
}

/// Reads a file that [`to_csv`] wrote.
///
/// # Errors
///
/// What is wrong in which line, and what is expected.
pub fn from_csv(text: &str) -> Result<Map, String> {
    let mut map = Known::NONE;
    let mut lines = (1..).zip(text.lines());
    if lines.next().map(|(_, line)| line.trim()) != Some(HEAD) {
        return Err(format!(
            "This is no map: the first line of a saved one is `{HEAD}`."
        ));
    }
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let index: Option<usize> = line.split(',').next().and_then(|i| i.trim().parse().ok());
        let code = line.rsplit(',').next().and_then(|c| c.trim().parse().ok());
        let entry = index.and_then(|index| map.0.get_mut(index));
        match (entry, code) {
            (Some(entry @ None), Some(code @ 0..=15)) => *entry = Some(code),
            (Some(Some(_)), _) => {
                return Err(format!(
                    "Line {number}: this index was there before: `{line}`."
                ));
            }
            _ => {
                return Err(format!(
                    "Line {number}: an entry has an index of 0 to 63 first and a category of 0 to \
                     15 last; it is `{line}`."
                ));
            }
        }
    }
    map.whole().ok_or_else(|| {
        let missing = map.0.iter().filter(|e| e.is_none()).count();
        format!("The file ends too early: {missing} of the indexes 0 to 63 are missing.")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{answer, hex, request, unit};
    use shared::frame::Framing;
    use shared::hart::frame::seal;
    use shared::proto::Outcome;

    /// The worked exchange R22, R23: the example of table 20.
    const MAP: (&str, &str) = (
        "82AEDD0123451F04020B0040C4",
        "86AEDD0123451F260000020B0040 00000000304000510405000005030000000000000000000000000000000000 00C4",
    );

    #[test]
    fn the_map_of_a_device_is_that_of_table_20() {
        let unit = unit(&[(523, MAP.0, MAP.1)]);
        let map = of_device(&unit).unwrap().whole().unwrap();
        assert_eq!(Some(&map), Map::example(Family::Iq).as_ref());
        // Local control fault is a failure, reading it by hand from the table.
        assert_eq!(map.get(Map::index(0, 1)), 3);
        assert_eq!(bit(Some(Family::Iq), 9).unwrap().key, "local_control_fault");
        assert_eq!(rest(&unit), None);
        assert_eq!(of_device(&super::super::unit::tests::unit(&[])), None);
    }

    /// Takes an answer to command 523 in: number, start and count, then entries.
    fn hear(unit: &mut Unit, start: u8, asked: u8, count: u8, entries: &[u8]) {
        let data = [&[2, 11, start, count], entries].concat();
        let request = request(31, &[2, 11, start, asked]);
        let ok = (Outcome::Ok, "");
        unit.take(&request, &answer(31, 0, &data), 523, ok, (7, 2, 1));
    }

    /// A device that answers 17 entries, then the rest, by hand: 16 is the low half of byte 8.
    #[test]
    fn what_an_answer_leaves_out_is_unknown_and_asked_for() {
        let mut unit = unit(&[]);
        hear(&mut unit, 0, 64, 17, &[0, 0, 0, 0, 0x30, 0, 0, 0, 0x54]);
        let map = of_device(&unit).unwrap();
        assert_eq!(
            (map.get(8), map.get(9), map.get(16)),
            (Some(0), Some(3), Some(4))
        );
        assert_eq!(
            (map.get(17), map.whole()),
            (None, None),
            "5 is beyond the count"
        );
        assert_eq!(rest(&unit), Some((523, "1030".to_owned())));
        assert!(plan::due("map", &unit, 8).contains(&plan::entries(16, 48)));
        // Bit 1 of byte 0 is known, bit 1 of byte 1 is not.
        let report = map.report(Family::Iq, &[2, 0, 0, 0]).unwrap();
        assert!(report.malfunction);
        assert_eq!(map.report(Family::Iq, &[0, 2, 0, 0]), None);
        assert!(map.report(Family::Cva, &[0, 2, 0, 0]).unwrap().more_status);
        hear(&mut unit, 16, 48, 48, &[0x14; 24]);
        let map = of_device(&unit).unwrap();
        assert_eq!((map.get(16), map.get(17)), (Some(4), Some(1)));
        assert!(map.whole().is_some() && rest(&unit).is_none());
    }

    #[test]
    fn an_answer_without_more_is_not_asked_for_again() {
        let mut unit = unit(&[]);
        hear(&mut unit, 0, 64, 16, &[0; 8]);
        let key = rest(&unit).unwrap();
        assert_eq!(key, plan::entries(16, 48));
        hear(&mut unit, 16, 48, 0, &[]);
        assert!(!plan::due("map", &unit, 8).contains(&key));
    }

    /// The worked refusal R28 has code 64; the same for command 31.
    #[test]
    fn a_refusal_is_told() {
        let mut unit = unit(&[]);
        let refusal = seal(0x86, &[0xAE, 0xDD, 1, 0x23, 0x45], 31, &[64, 0x40]);
        let asked = request(31, &[2, 11, 0, 64]);
        let ok = (Outcome::Ok, "");
        unit.take(&asked, &refusal, 523, ok, (7, 2, 1));
        assert!(of_device(&unit).is_none());
        assert!(refused(&unit).unwrap().contains("not implemented"));
    }

    #[test]
    fn status_bytes_come_from_a_capture_or_a_person() {
        use crate::hart::state::unit::tests::STATUS;
        let later = answer(48, 0, &[1, 0, 0, 0, 0, 0, 0, 0, 0]);
        let mut session = Session::new(Framing::Hart);
        for frame in [hex(STATUS.0), hex(STATUS.1), later] {
            session.push(&shared::capture::Capture::of(&frame));
        }
        session.finish();
        let status = [2, 0, 2, 0, 0xA4, 0x40];
        let last = [1, 0, 0, 0, 0, 0];
        assert_eq!(status_in(&session, None).as_deref(), Some(&last[..]));
        assert_eq!(status_in(&session, Some(0)).as_deref(), Some(&last[..]));
        assert_eq!(status_in(&session, Some(1)).as_deref(), Some(&status[..]));
        assert_eq!(status_in(&Session::new(Framing::Hart), None), None);
        assert_eq!(typed("02 00 02 00").as_deref(), Some(&status[..4]));
        for bad in ["", "02 00 02", "02 00 02 0", "02 00 02 0x"] {
            assert_eq!(typed(bad), None, "{bad}");
        }
    }

    #[test]
    fn files_come_back_and_say_what_is_wrong() {
        for preset in &PRESETS {
            let map = Map::of(preset);
            let text = to_csv(Some(preset.family), &map);
            assert_eq!(text.lines().count(), 65);
            assert_eq!(from_csv(&text), Ok(map));
        }
        assert!(from_csv("").unwrap_err().contains("no map"));
        let bad = format!("{HEAD}\n64,x,0,\"\",3\n");
        assert!(from_csv(&bad).unwrap_err().starts_with("Line 2:"));
        let bad = format!("{HEAD}\n8,x,0,\"\",16\n");
        assert!(from_csv(&bad).is_err());
        let whole = to_csv(None, &Map::default());
        let cut = whole.lines().take(64).collect::<Vec<_>>().join("\n");
        assert!(from_csv(&cut).unwrap_err().contains("1 of the indexes"));
        let twice = format!("{whole}8,x,0,\"\",3\n");
        assert!(from_csv(&twice).unwrap_err().starts_with("Line 66:"));
    }

    #[test]
    fn examples_name_their_table() {
        let tables: Vec<_> = PRESETS.iter().map(table).collect();
        assert_eq!(tables, ["table 20", "table 23", "table 25"]);
        assert_eq!(category(3), "Failure");
        assert_eq!(category(9), "Reserved");
        let none = Known::all(&Map::default());
        assert!(rows(Some(Family::Iq), &none).len() > 20);
        // SI has no alarms.
        assert_eq!(rows(Some(Family::Si), &none), Vec::<usize>::new());
        assert_eq!(mapped(&PRESETS[0], 16).unwrap().printed, "Valve Obstructed");
        assert!(mapped(&PRESETS[0], 8).is_none());
    }
}
