//! The decode tree: a flat arena of fields in byte order.
//!
//! **Invariant**: the leaves tile the frame. Every byte belongs to exactly one leaf, if need be to
//! one that says "unknown".

use crate::address::{Address, Table};
use crate::dop::object;
#[cfg(feature = "hart")]
use crate::hart::model as hart;
#[cfg(feature = "icon")]
use crate::icon3000::model as icon;
use crate::map::row::{Member, Row, Source};
use crate::place::Place;
use crate::problem::Problem;
use crate::reader::Layout;
use crate::value::{Quality, Value};

/// What is known of a protocol field before any byte arrives.
#[derive(Debug, PartialEq, Eq)]
pub struct FieldDef {
    /// Part of the path: `byte_count`.
    pub key: &'static str,
    /// What people read: `Byte count`.
    pub label: &'static str,
    /// Unit of the value, empty if it has none.
    pub unit: &'static str,
    /// Where the standard or manual describes it.
    pub source: Source,
}

/// Which field this is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Name {
    /// A field of the protocol.
    Def(&'static FieldDef),
    /// One of several equal fields of the protocol, counted from 0.
    Item(&'static FieldDef, u16),
    /// A coil, input or register about which no map says anything.
    Register(Table, Address),
    /// A value of a device map.
    Row(&'static Row),
    /// A value of a device map of which only some words are in the frame; the first address seen.
    Part(&'static Row, Address),
    /// One bit of a device map's bit field.
    Bit(&'static Row, &'static Member),
    /// A part of a device map's value, such as the date of a torque curve.
    Within(&'static Row, &'static FieldDef),
    /// A value of a diagnostic object: the element of an array, or the record of a log, from 0.
    Dop(&'static object::Field, u16),
    /// All values of an array of a diagnostic object.
    DopArray(&'static object::Field),
    /// One bit of a value of a diagnostic object.
    DopBit(&'static object::Field, &'static Member),
    /// A register of a diagnostic object about which no layout says anything.
    DopWord(u16, u16),
    /// The data of a HART command.
    #[cfg(feature = "hart")]
    HartCommand(&'static hart::Command),
    /// A value in the data of a HART command: its unit where a code names it, and which of several
    /// it is (`u16::MAX` for the only one).
    #[cfg(feature = "hart")]
    Hart(&'static hart::Item, Option<&'static hart::Unit>, u16),
    /// A part of a byte of a HART command, with an index where it has one.
    #[cfg(feature = "hart")]
    HartPart(&'static hart::Item, u16),
    /// One bit of a HART status.
    #[cfg(feature = "hart")]
    HartBit(&'static hart::Bit),
    /// The records of a file of an ICON3000v2, and the number of the file.
    #[cfg(feature = "icon")]
    File(&'static icon::File, u16),
    /// One entry of a log, from 1.
    #[cfg(feature = "icon")]
    Entry(&'static icon::File, u16),
    /// A value of a file, and which of a run, from 0.
    #[cfg(feature = "icon")]
    Record(&'static icon::Field, u16),
    /// A value of a file of which only some records are in the frame.
    #[cfg(feature = "icon")]
    RecordPart(&'static icon::Field, u16),
    /// One bit of a value of a file.
    #[cfg(feature = "icon")]
    RecordBit(&'static icon::Field, &'static Member),
}

impl Name {
    /// True for bits and parts of a byte: the field around them owns the byte.
    #[must_use]
    pub const fn shares_bytes(&self) -> bool {
        match self {
            Self::Bit(..) | Self::DopBit(..) => true,
            #[cfg(feature = "hart")]
            Self::HartBit(_) | Self::HartPart(..) => true,
            #[cfg(feature = "icon")]
            Self::RecordBit(..) => true,
            _ => false,
        }
    }
}

/// Index of a field in its [`Decoded`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FieldId(u32);

impl FieldId {
    /// The index as a number, stable for the same bytes and context.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// The field with this number; looking it up fails if the tree has no such field.
    #[must_use]
    pub const fn new(index: u32) -> Self {
        Self(index)
    }
}

/// One decoded item: what it is, what it says, where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// The field around it, `None` for those directly in the frame.
    pub parent: Option<FieldId>,
    /// Which field it is; label, unit and source follow from it.
    pub name: Name,
    /// What it says.
    pub value: Value,
    /// Its bytes, counted from the start of the frame as received.
    pub place: Place,
    /// How much the value can be relied on.
    pub quality: Quality,
}

/// A decoded frame: its bytes, its fields and what is wrong with it.
///
/// Reuse one for many frames: clearing keeps the memory.
#[derive(Clone, Debug, Default)]
pub struct Decoded {
    pub(crate) bytes: Vec<u8>,
    pub(crate) layout: Layout,
    pub(crate) fields: Vec<Field>,
    pub(crate) problems: Vec<Problem>,
    /// Words of values that do not follow from value and bytes, by field.
    pub(crate) said: Vec<(FieldId, String)>,
}

impl Decoded {
    /// The frame as received.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// How payload bytes lie in the frame.
    #[must_use]
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// All fields, parents before children, in byte order.
    #[must_use]
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// One field.
    #[must_use]
    pub fn field(&self, id: FieldId) -> Option<&Field> {
        self.fields.get(usize::try_from(id.0).ok()?)
    }

    /// All fields with their ids.
    pub fn iter(&self) -> impl Iterator<Item = (FieldId, &Field)> {
        (0_u32..).map(FieldId).zip(&self.fields)
    }

    /// What is wrong or noteworthy, in byte order as found.
    #[must_use]
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// True if nothing worse than a warning was found.
    #[must_use]
    pub fn is_ok(&self) -> bool {
        self.problems
            .iter()
            .all(|p| p.severity() != crate::problem::Severity::Error)
    }

    /// True if no other field has this one as its parent.
    #[must_use]
    pub fn is_leaf(&self, id: FieldId) -> bool {
        // Children follow their parent directly.
        self.field(FieldId(id.0.saturating_add(1)))
            .is_none_or(|f| f.parent != Some(id))
    }

    /// How deep a field is nested, 0 for those directly in the frame.
    #[must_use]
    pub fn depth(&self, id: FieldId) -> usize {
        core::iter::successors(self.field(id).and_then(|f| f.parent), |p| {
            self.field(*p).and_then(|f| f.parent)
        })
        .count()
    }

    /// The innermost field that owns the byte at `offset`. Of several bits that share a byte, the
    /// field around them.
    #[must_use]
    pub fn owner(&self, offset: u16) -> Option<FieldId> {
        let mut found: Option<(FieldId, Place)> = None;
        for (id, field) in self.iter() {
            if !field.place.contains(offset) || field.name.shares_bytes() {
                continue;
            }
            // Later and smaller wins: children follow their parents.
            if found.is_none_or(|(_, place)| field.place.len <= place.len && field.place != place) {
                found = Some((id, field.place));
            }
        }
        found.map(|(id, _)| id)
    }

    pub(crate) fn clear(&mut self) {
        self.bytes.clear();
        self.fields.clear();
        self.problems.clear();
        self.said.clear();
        self.layout = Layout::Plain;
    }

    pub(crate) fn push(
        &mut self,
        parent: Option<FieldId>,
        name: Name,
        value: Value,
        place: Place,
    ) -> FieldId {
        let id = FieldId(u32::try_from(self.fields.len()).unwrap_or(u32::MAX));
        self.fields.push(Field {
            parent,
            name,
            value,
            place,
            quality: Quality::Good,
        });
        id
    }

    pub(crate) fn mark(&mut self, id: FieldId, quality: Quality) {
        if let Some(field) = usize::try_from(id.0)
            .ok()
            .and_then(|at| self.fields.get_mut(at))
        {
            field.quality = quality;
        }
    }

    /// Cuts a field, the last one if nothing is below it, to what was understood of it.
    #[cfg(feature = "hart")]
    pub(crate) fn shrink(&mut self, id: FieldId, len: u16) {
        let at = usize::try_from(id.0).unwrap_or(usize::MAX);
        if len == 0 && self.fields.len() == at.saturating_add(1) {
            self.fields.pop();
        } else if let Some(field) = self.fields.get_mut(at) {
            field.place.len = len;
        }
    }

    /// Sets the words of a value. Fields are said in their order.
    pub(crate) fn say(&mut self, id: FieldId, words: String) {
        self.said.push((id, words));
    }

    pub(crate) fn problem(&mut self, problem: Problem) {
        self.problems.push(problem);
    }
}
