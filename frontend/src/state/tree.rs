//! The field tree as lines: what is open, what is nested how deep, what a field says.

use shared::map::row::{Reading, Source, Trust};
use shared::tree::{Decoded, Field, FieldId};
use shared::value::{Quality, Value};

/// One line of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Its field.
    pub id: FieldId,
    /// How deep it is nested.
    pub depth: usize,
    /// True if nothing lies below it.
    pub leaf: bool,
    /// True if what lies below it is shown.
    pub open: bool,
    /// The field around it.
    pub parent: Option<FieldId>,
}

/// Words of bits begin closed: the names of the set bits stand in their line.
fn open_at_first(field: &Field) -> bool {
    !matches!(field.value, Value::Flags { .. })
}

/// The lines to show; `toggled` are the fields that the user opened or closed.
#[must_use]
pub fn lines(decoded: &Decoded, toggled: &[u32]) -> Vec<Line> {
    let mut lines = Vec::with_capacity(decoded.fields().len());
    // Fields around the current one, with whether they are open.
    let mut around: Vec<(FieldId, bool)> = Vec::new();
    for (id, field) in decoded.iter() {
        while around
            .last()
            .is_some_and(|(above, _)| Some(*above) != field.parent)
        {
            around.pop();
        }
        let leaf = decoded.is_leaf(id);
        let open = !leaf && (open_at_first(field) != toggled.contains(&id.get()));
        if around.iter().all(|(_, open)| *open) {
            lines.push(Line {
                id,
                depth: around.len(),
                leaf,
                open,
                parent: field.parent,
            });
        }
        if !leaf {
            around.push((id, open));
        }
    }
    lines
}

/// What must be toggled so that everything is open.
#[must_use]
pub fn all_open(decoded: &Decoded) -> Vec<u32> {
    decoded
        .iter()
        .filter(|(id, field)| !decoded.is_leaf(*id) && !open_at_first(field))
        .map(|(id, _)| id.get())
        .collect()
}

/// What must be toggled besides so that a field is shown.
pub fn reveal(decoded: &Decoded, toggled: &mut Vec<u32>, id: FieldId) {
    let mut above = decoded.field(id).and_then(|f| f.parent);
    while let Some(parent) = above {
        let Some(field) = decoded.field(parent) else {
            return;
        };
        toggled.retain(|id| *id != parent.get());
        if !open_at_first(field) {
            toggled.push(parent.get());
        }
        above = field.parent;
    }
}

/// What a key does in the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The field becomes the selected one.
    To(FieldId),
    /// The field is opened or closed.
    Toggle(FieldId),
    /// The key means nothing here.
    Nothing,
}

/// What a key does, with the selected line at `at`.
#[must_use]
pub fn step(key: &str, lines: &[Line], at: Option<usize>) -> Step {
    let to = |line: Option<&Line>| line.map_or(Step::Nothing, |l| Step::To(l.id));
    let Some((at, line)) = at.and_then(|at| Some((at, lines.get(at)?))) else {
        return match key {
            "ArrowDown" | "Home" => to(lines.first()),
            "ArrowUp" | "End" => to(lines.last()),
            _ => Step::Nothing,
        };
    };
    match key {
        "ArrowDown" => to(lines.get(at + 1)),
        "ArrowUp" => to(at.checked_sub(1).and_then(|at| lines.get(at))),
        "Home" => to(lines.first()),
        "End" => to(lines.last()),
        "ArrowRight" if !line.leaf && !line.open => Step::Toggle(line.id),
        "ArrowRight" if !line.leaf => to(lines.get(at + 1)),
        "ArrowLeft" if line.open => Step::Toggle(line.id),
        "ArrowLeft" => line.parent.map_or(Step::Nothing, Step::To),
        "Enter" | " " if !line.leaf => Step::Toggle(line.id),
        _ => Step::Nothing,
    }
}

/// All that is known of a field, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// Its path: `holding.3001.close_limit`.
    pub path: String,
    /// What it is.
    pub label: String,
    /// What it says, without unit.
    pub value: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its bytes.
    pub raw: String,
    /// The payload as a number: decimal and binary, for up to four bytes.
    pub number: Option<(u32, usize)>,
    /// True for numbers, which are aligned right.
    pub numeric: bool,
    /// First and last byte.
    pub bytes: (u16, u16),
    /// Where it is described.
    pub source: Option<Source>,
    /// How far the description can be trusted.
    pub trust: Trust,
    /// Why it differs from the print.
    pub reading: Option<&'static Reading>,
    /// How far the value can be relied on.
    pub quality: Quality,
}

/// Longest raw text in a line; the rest is in the bytes.
const RAW: usize = 24;

impl Facts {
    /// The facts of a field.
    #[must_use]
    pub fn of(decoded: &Decoded, id: FieldId) -> Option<Self> {
        let field = decoded.field(id)?;
        let payload = decoded.payload(field);
        let number = (1..=4).contains(&payload.len()).then(|| {
            let value = payload.iter().fold(0, |n, b| (n << 8) | u32::from(*b));
            (value, payload.len())
        });
        Some(Self {
            path: decoded.path(id),
            label: field.name.label(),
            value: decoded.bare_text(field),
            unit: match field.value {
                Value::Number { .. } => field.name.unit(),
                _ => "",
            },
            raw: decoded.raw(field),
            number,
            numeric: matches!(field.value, Value::Number { .. }),
            bytes: (field.place.start, field.place.end().saturating_sub(1)),
            source: field.name.source(),
            trust: field.name.trust(),
            reading: field.name.reading(),
            quality: field.quality,
        })
    }

    /// The raw bytes, cut to what fits in a line.
    #[must_use]
    pub fn short_raw(&self) -> String {
        let mut text = String::with_capacity(RAW + RAW / 2);
        for (at, c) in self.raw.chars().take(RAW).enumerate() {
            if at > 0 && at % 2 == 0 {
                text.push(' ');
            }
            text.push(c);
        }
        if self.raw.len() > RAW {
            text.push('…');
        }
        text
    }
}

/// A word in binary, in groups of four.
#[must_use]
pub fn binary(value: u32, bytes: usize) -> String {
    let bits = bytes.clamp(1, 4) * 8;
    let mut text = String::new();
    for at in (0..bits).rev() {
        text.push(if value >> at & 1 == 1 { '1' } else { '0' });
        if at > 0 && at % 4 == 0 {
            text.push(' ');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use crate::state::work::Shown;
    use shared::device::Device;
    use shared::encode::frame;
    use shared::frame::Framing;
    use shared::render::hex;

    /// A read of the first status word of an ICON3000v2, with its answer.
    fn status() -> Shown {
        let pdu = |pdu: &[u8]| hex(&frame(Framing::Rtu, 0, 9, pdu));
        let text = format!(
            "{} {}",
            pdu(&[3, 0x0B, 0xB9, 0, 1]),
            pdu(&[3, 2, 0x00, 0x21])
        );
        let loaded = load(text.as_bytes(), None);
        Shown::of(&loaded.session, 1, Device::Icon3000v2).unwrap()
    }

    #[test]
    fn bits_begin_closed_and_open_on_demand() {
        let shown = status();
        let decoded = &shown.decoded;
        let closed = lines(decoded, &[]);
        let open = lines(decoded, &all_open(decoded));
        assert_eq!(open.len(), decoded.fields().len());
        assert!(open.len() > closed.len() + 10);
        let bit = open.iter().find(|l| l.depth > 0).unwrap();
        let mut toggled = Vec::new();
        reveal(decoded, &mut toggled, bit.id);
        assert!(lines(decoded, &toggled).iter().any(|l| l.id == bit.id));
    }

    #[test]
    fn keys_walk_open_and_close() {
        let shown = status();
        let lines = lines(&shown.decoded, &[]);
        let at = lines.iter().position(|l| !l.leaf && !l.open).unwrap();
        assert_eq!(step("ArrowDown", &lines, None), Step::To(lines[0].id));
        assert_eq!(
            step("ArrowRight", &lines, Some(at)),
            Step::Toggle(lines[at].id)
        );
        assert_eq!(
            step("ArrowUp", &lines, Some(at)),
            Step::To(lines[at - 1].id)
        );
        assert_eq!(step("x", &lines, Some(at)), Step::Nothing);
        assert_eq!(
            step("End", &lines, Some(at)),
            Step::To(lines[lines.len() - 1].id)
        );
    }

    #[test]
    fn facts_name_value_raw_and_source() {
        let shown = status();
        let (id, _) = shown
            .decoded
            .iter()
            .find(|(id, _)| shown.decoded.path(*id) == "holding.3001")
            .unwrap();
        let facts = Facts::of(&shown.decoded, id).unwrap();
        assert_eq!(facts.value, "Close Limit, Selector in REMOTE");
        assert_eq!(facts.short_raw(), "00 21");
        assert_eq!(facts.number, Some((0x21, 2)));
        assert!(facts.source.is_some());
        assert_eq!(binary(0x21, 1), "0010 0001");
    }
}
