//! Registers into the decode tree, by the fields of a layout.

use super::ERROR_CODES;
use super::object::{Field, Layout, Part, Record, Request};
use super::profile::{Profile, Temperature};
use super::values::{self, Judged};
use super::words::straight;
use crate::map::row::Source;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::tree::{Decoded, FieldDef, FieldId, Name};
use crate::value::{ACTIVE, Quality, Value};

/// Why a point after the last valid one has no value (reading C19).
const BEYOND: &str = "beyond the number of points";

/// Registers that a tree can hold.
const MOST: usize = 32_767;

const DOC: &str = "AIIOM000698-01";

/// The code in place of data, section 2.1.3.
static ERROR: FieldDef = FieldDef {
    key: "dop.error",
    label: "Error code",
    unit: "",
    source: Source {
        doc: DOC,
        part: "section 2.1.3, p. 5",
    },
};

/// One record of a log, section 8.
static RECORD: [FieldDef; 2] = [
    FieldDef {
        key: "dop.1202.record",
        label: "Event",
        unit: "",
        source: Source {
            doc: DOC,
            part: "section 8.1, p. 26",
        },
    },
    FieldDef {
        key: "dop.1203.record",
        label: "Movement",
        unit: "",
        source: Source {
            doc: DOC,
            part: "section 8.2, p. 27",
        },
    },
];

/// Writes the registers of one response into a tree.
pub(super) struct Writer<'a> {
    out: &'a mut Decoded,
    object: u16,
    words: &'a [u16],
    profile: &'a Profile,
    /// Valid points of arrays, if the layout counts them.
    points: Option<u16>,
}

impl<'a> Writer<'a> {
    pub(super) fn new(
        out: &'a mut Decoded,
        request: Request,
        words: &'a [u16],
        profile: &'a Profile,
    ) -> Self {
        out.clear();
        // Places have 16 bits; a response has at most 512 registers.
        let words = words.get(..MOST).unwrap_or(words);
        out.bytes
            .extend(words.iter().flat_map(|word| word.to_be_bytes()));
        Self {
            out,
            object: request.object(),
            words,
            profile,
            points: None,
        }
    }

    /// An error: a code, and registers that mean nothing.
    pub(super) fn error(&mut self) {
        let Some(word) = self.words.first() else {
            return self.size(1);
        };
        let code = straight(*word, self.profile);
        let name = super::error_name(code);
        let place = place(0, 1);
        let value = Value::Code {
            raw: u32::from(code),
            set: &ERROR_CODES,
        };
        let id = self.out.push(None, Name::Def(&ERROR), value, place);
        if name.is_none() {
            self.out.mark(id, Quality::Invalid);
        }
        self.problem(Finding::DopError { code }, place);
        self.raw(1, self.words.len(), None);
    }

    /// Registers of which nothing is known.
    pub(super) fn unknown(&mut self) {
        self.problem(Finding::NoLayout, place(0, self.words.len()));
        self.raw(0, self.words.len(), None);
    }

    /// The registers of a layout.
    pub(super) fn layout(&mut self, layout: &'static Layout) {
        if self.words.is_empty() {
            // A log without records still has their number.
            return self.size(layout.record.map_or(layout.words, |_| 1));
        }
        let len = self.words.len();
        let mut end = usize::from(layout.words).min(len);
        if let Some(record) = layout.record {
            end = self.log(layout, record);
        } else {
            self.count_points(layout);
            for field in layout.fields {
                self.field(field, 0, 0, None);
            }
            if len != usize::from(layout.words) {
                self.size(layout.words);
            }
        }
        self.raw(end, len, None);
    }

    /// Says that the number of registers is not that of the layout.
    fn size(&mut self, want: u16) {
        let got = u16::try_from(self.words.len()).unwrap_or(u16::MAX);
        let len = self.words.len();
        let extra = place(usize::from(want).min(len), len);
        self.problem(Finding::Registers { got, want }, extra);
    }

    /// How many points are valid: none more than arrays have room for.
    fn count_points(&mut self, layout: &'static Layout) {
        let Some(counter) = layout.fields.iter().find(|f| f.part == Part::Points) else {
            return;
        };
        let Some(word) = self.words.get(usize::from(counter.at)) else {
            return;
        };
        let points = straight(*word, self.profile);
        let room = |field: &Field| Some(field.limit?.saturating_add(field.count));
        let max = layout.fields.iter().filter_map(room).max().unwrap_or(0);
        if points > max {
            let at = usize::from(counter.at);
            let finding = Finding::Range {
                got: i64::from(points),
                min: 0,
                max: i32::from(max),
            };
            self.problem(finding, place(at, at.saturating_add(1)));
        }
        self.points = Some(points);
    }

    /// The records of a log; returns the first register after them.
    fn log(&mut self, layout: &'static Layout, record: Record) -> usize {
        let (len, stride) = (self.words.len(), usize::from(record.stride));
        let (records, heads): (Vec<&'static Field>, Vec<_>) =
            layout.fields.iter().partition(|field| field.record);
        for field in heads {
            self.field(field, 0, 0, None);
        }
        let first = records.first().map_or(1, |field| usize::from(field.at));
        let says = self.words.first().map_or(0, |w| straight(*w, self.profile));
        let body = len.saturating_sub(first);
        let whole = u16::try_from(body.checked_div(stride).unwrap_or(0)).unwrap_or(u16::MAX);
        let part = !body.is_multiple_of(stride);
        if says > record.max {
            let finding = Finding::Range {
                got: i64::from(says),
                min: 0,
                max: i32::from(record.max),
            };
            self.problem(finding, place(0, 1));
        }
        if says != whole || part {
            let finding = Finding::Records {
                got: says,
                want: whole,
            };
            self.problem(finding, place(0, 1));
        }
        // A record that was begun is shown as far as it goes.
        let begun = whole.saturating_add(u16::from(part));
        let shown = says.min(begun).min(record.max);
        let def = RECORD.get(usize::from(self.object == 1203));
        for index in 0..shown {
            let base = usize::from(index).saturating_mul(stride);
            let from = base.saturating_add(first).min(len);
            let to = from.saturating_add(stride).min(len);
            let group = def.map(|def| {
                let name = Name::Item(def, index);
                self.out.push(None, name, Value::Group, place(from, to))
            });
            for field in &records {
                self.field(field, base, index, group);
            }
        }
        usize::from(shown)
            .saturating_mul(stride)
            .saturating_add(first)
            .min(len)
    }

    /// A field with all its elements, as far as there are registers.
    fn field(&mut self, field: &'static Field, base: usize, record: u16, parent: Option<FieldId>) {
        let field = match self.profile.temperature() {
            Temperature::DegF => field.fahrenheit.unwrap_or(field),
            Temperature::DegC => field,
        };
        let start = base.saturating_add(usize::from(field.at));
        let end = base.saturating_add(usize::from(field.end()));
        if start >= self.words.len() {
            return;
        }
        if field.count == 1 {
            return self.item(field, start, record, parent, true);
        }
        let all = place(start, end.min(self.words.len()));
        let group = self
            .out
            .push(parent, Name::DopArray(field), Value::Group, all);
        let step = usize::from(field.kind.words());
        for (index, at) in (0..field.count).zip((start..end).step_by(step.max(1))) {
            let point = field.limit.map(|first| first.saturating_add(index));
            let valid = match (self.points, point) {
                (Some(points), Some(point)) => point < points,
                _ => true,
            };
            self.item(field, at, index, Some(group), valid);
        }
    }

    /// One value.
    fn item(
        &mut self,
        field: &'static Field,
        at: usize,
        index: u16,
        parent: Option<FieldId>,
        valid: bool,
    ) {
        let end = at.saturating_add(usize::from(field.kind.words()));
        let Some(words) = self.words.get(at..end) else {
            return self.raw(at.min(self.words.len()), self.words.len(), parent);
        };
        let judged = if valid {
            values::judge(self.profile, field, words)
        } else {
            Judged::good(Value::Unavailable(BEYOND))
        };
        let place = place(at, end);
        let name = Name::Dop(field, index);
        let id = self.out.push(parent, name, judged.value, place);
        self.out.mark(id, judged.quality);
        if let Some(said) = judged.said {
            self.out.say(id, said);
        }
        if let Some(finding) = judged.finding {
            self.problem(finding, place);
        }
        if let Value::Flags { raw, .. } = judged.value {
            self.bits(field, id, raw, at);
        }
    }

    /// The bits of a word, each at the byte that holds it.
    fn bits(&mut self, field: &'static Field, parent: FieldId, raw: u32, at: usize) {
        let words = usize::from(field.kind.words());
        for member in field.set.map_or(&[][..], |set| set.members) {
            let bit = usize::from(member.value);
            let word = bit >> 4;
            let word = if self.profile.low_word_first() {
                word
            } else {
                words.saturating_sub(1).saturating_sub(word)
            };
            // The high byte of a register is the first of its two bytes.
            let high = (bit & 8 != 0) != self.profile.byte_swap();
            let byte = at
                .saturating_add(word)
                .saturating_mul(2)
                .saturating_add(usize::from(!high));
            let on = raw.wrapping_shr(u32::from(member.value)) & 1 != 0;
            let states = member.states.as_ref().unwrap_or(&ACTIVE);
            let value = Value::Bit { on, words: states };
            let name = Name::DopBit(field, member);
            let id = self
                .out
                .push(Some(parent), name, value, Place::new(byte, 1));
            if let (Some(word), Ok(bit)) = (values::bit_word(field), u8::try_from(member.value)) {
                let label = self.profile.bit(word, bit);
                if !label.assumed {
                    let state = if on { states.1 } else { states.0 };
                    self.out.say(id, format!("{}: {state}", label.name));
                }
            }
        }
    }

    /// Registers about which nothing is said, one field each.
    fn raw(&mut self, from: usize, to: usize, parent: Option<FieldId>) {
        for at in from..to {
            let index = u16::try_from(at).unwrap_or(u16::MAX);
            let name = Name::DopWord(self.object, index);
            let end = at.saturating_add(1);
            self.out.push(parent, name, Value::Raw, place(at, end));
        }
    }

    fn problem(&mut self, finding: Finding, place: Place) {
        self.out.problem(Problem::new(finding, place));
    }
}

/// The bytes of the registers `from..to`.
fn place(from: usize, to: usize) -> Place {
    Place::new(
        from.saturating_mul(2),
        to.saturating_sub(from).saturating_mul(2),
    )
}
