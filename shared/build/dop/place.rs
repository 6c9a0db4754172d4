//! What follows from the order of the fields: offsets, counts, readings.

use super::data::{Count, Data, Field, Layout, Object};

/// A type: its word in the file, its registers, its name in `dop::FieldKind`.
pub const KINDS: [(&str, u16, &str); 6] = [
    ("U16", 1, "U16"),
    ("S16", 1, "S16"),
    ("U32", 2, "U32"),
    ("S32", 2, "S32"),
    ("time", 4, "Time"),
    ("text", 0, "Text"),
];

/// A field of one variant of a layout with its place.
pub struct Placed<'a> {
    pub field: &'a Field,
    /// Byte of the file at which it is written.
    pub offset: usize,
    pub at: u16,
    pub count: u16,
    /// Registers of one value.
    pub words: u16,
}

impl Placed<'_> {
    pub fn end(&self) -> u16 {
        self.at + self.words * self.count
    }

    /// The offset as the manual would print it.
    pub fn printed(&self) -> String {
        if self.count == 1 {
            return self.at.to_string();
        }
        let last = self.at + (self.count - 1) * self.words;
        format!("{}-{last}", self.at)
    }
}

/// The fields of a variant, each behind the one before.
pub fn place(layout: &Layout, variant: usize) -> Vec<Placed<'_>> {
    let points = layout.points.get(variant).copied().unwrap_or(1);
    let mut at = 0;
    let mut placed = Vec::new();
    for field in &layout.fields {
        let (offset, field) = (field.span().start, field.get_ref());
        let words = match field.text {
            Some(bytes) => bytes / 2,
            None => KINDS
                .iter()
                .find(|k| k.0 == field.kind)
                .map_or(1, |k| k.1.max(1)),
        };
        let count = match &field.count {
            None => 1,
            Some(Count::Of(count)) => *count,
            Some(Count::Points(_)) => points,
        };
        let next = Placed {
            field,
            offset,
            at,
            count,
            words,
        };
        at = next.end();
        placed.push(next);
    }
    placed
}

/// The readings of a field: its own, then those of its kind.
pub fn readings<'a>(data: &'a Data, field: &'a Field) -> Vec<&'a str> {
    let defaults = &data.defaults;
    let kinds = [
        (field.kind == "time", &defaults.time),
        (field.kind == "text", &defaults.text),
        (field.unit == "°C", &defaults.temperature),
        (field.first.is_some(), &defaults.points),
    ];
    let mut ids: Vec<&str> = field.readings.iter().map(String::as_str).collect();
    for id in kinds
        .iter()
        .filter(|(applies, _)| *applies)
        .flat_map(|(_, ids)| ids.iter())
    {
        if !ids.contains(&id.as_str()) {
            ids.push(id);
        }
    }
    ids
}

/// The layout of this name.
pub fn layout<'a>(data: &'a Data, key: &str) -> Option<&'a Layout> {
    let found = data.layouts.iter().find(|l| l.get_ref().key == key);
    found.map(toml::Spanned::get_ref)
}

/// Number of variants of a layout.
pub fn variants(layout: &Layout) -> usize {
    layout.points.len().max(1)
}

/// Which variant has so many points.
pub fn variant(layout: &Layout, points: Option<u16>) -> Option<usize> {
    match points {
        None => layout.points.is_empty().then_some(0),
        Some(points) => layout.points.iter().position(|p| *p == points),
    }
}

/// Every layout that a response of an object can have, with its variant, in order of first use.
pub fn used<'a>(data: &'a Data, object: &Object) -> Vec<(&'a Layout, usize)> {
    let mut used: Vec<(&Layout, usize)> = Vec::new();
    let mut add = |layout: &'a Layout, variant: usize| {
        if !used
            .iter()
            .any(|(l, v)| l.key == layout.key && *v == variant)
        {
            used.push((layout, variant));
        }
    };
    for choice in object.options.iter().map(toml::Spanned::get_ref) {
        if let Some(layout) = layout(data, &choice.layout)
            && let Some(variant) = variant(layout, choice.points)
        {
            add(layout, variant);
        }
    }
    for choice in object.options.iter().map(toml::Spanned::get_ref) {
        for layout in choice.others.iter().filter_map(|key| layout(data, key)) {
            for variant in 0..variants(layout) {
                add(layout, variant);
            }
        }
    }
    used
}

/// The key of a variant: `vibration_trend_24`.
pub fn key(layout: &Layout, variant: usize) -> String {
    match layout.points.get(variant) {
        Some(points) => format!("{}_{points}", layout.key),
        None => layout.key.clone(),
    }
}
