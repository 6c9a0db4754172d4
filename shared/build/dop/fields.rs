//! The rules about single fields. See `rules.rs` for the list.

use super::data::{Count, Field};
use super::place::{self, KINDS};
use super::rules::{PARTS, Rules, SETTINGS, UNITS, bins};

impl Rules<'_> {
    /// R23 to R25, R30, R32, R33.
    pub fn field(&mut self, offset: usize, points: &[u16], field: &Field) {
        self.text(offset, &field.label, true);
        self.text(offset, &field.note, false);
        let kinds = KINDS.map(|k| k.0);
        self.word(offset, &kinds, &field.kind);
        self.word(offset, &PARTS, field.part.as_deref().unwrap_or("other"));
        if let Some(setting) = &field.setting {
            self.word(offset, &SETTINGS, setting);
        }
        let text = field.kind == "text";
        let bytes = field.text.is_some_and(|bytes| bytes > 0 && bytes % 2 == 0);
        self.unless(text == bytes, "R23", offset, "a text has an even length");
        let number = matches!(field.kind.as_str(), "U16" | "S16" | "U32" | "S32");
        self.unless(
            UNITS.contains(&field.unit.as_str()),
            "R24",
            offset,
            format!("unknown unit {:?}", field.unit),
        );
        let plain = field.unit.is_empty() && field.scale.is_none();
        self.unless(number || plain, "R24", offset, "unit or scale on no number");
        let decimal = |text: &String| {
            text.strip_prefix("0.")
                .and_then(|tail| tail.strip_suffix('1'))
                .is_some_and(|zeros| zeros.bytes().all(|b| b == b'0'))
        };
        let exact = field.scale.as_ref().is_none_or(decimal);
        self.unless(exact, "R24", offset, format!("scale {:?}", field.scale));
        let set = self
            .data
            .sets
            .iter()
            .find(|s| s.get_ref().name == field.set);
        let suits =
            field.set.is_empty() || (set.is_some() && matches!(field.kind.as_str(), "U16" | "U32"));
        self.unless(suits, "R25", offset, format!("set {:?}", field.set));
        let array = match &field.count {
            Some(Count::Points(word)) => {
                self.word(offset, &["points"], word);
                self.unless(
                    !points.is_empty(),
                    "R32",
                    offset,
                    "the layout has no points",
                );
                true
            }
            count => count.is_some(),
        };
        let axis = match field.axis.as_deref() {
            None => !array,
            Some("xyz" | "ago") => array,
            Some(text) => array && bins(text).is_some(),
        };
        self.unless(axis, "R32", offset, format!("axis {:?}", field.axis));
        let trust = field.trust.as_deref();
        let kept = match trust {
            None => true,
            Some(word) => word == "inferred" && place::readings(self.data, field).is_empty(),
        };
        self.unless(kept, "R33", offset, format!("trust {trust:?}"));
    }
}
