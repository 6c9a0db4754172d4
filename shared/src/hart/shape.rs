//! Sizes of fields and forms, and where things stand in them.

use super::model::{Form, Item, Kind};

/// Bytes of a field of fixed size.
pub(super) fn width(item: &Item) -> usize {
    match item.kind {
        Kind::Unsigned(n)
        | Kind::Packed(n)
        | Kind::Latin(n)
        | Kind::Raw(n)
        | Kind::Named(n, _)
        | Kind::Bits(n, _) => usize::from(n),
        Kind::Float | Kind::Time => 4,
        Kind::Date => 3,
        Kind::Unit | Kind::Variable | Kind::Additional(_) | Kind::Split(_) => 1,
        Kind::Nibbles(_) | Kind::Repeat(..) => 0,
    }
}

/// The length of a form that is nearest to the one there is.
pub(super) fn nearest(forms: &'static [Form], got: u16) -> u16 {
    forms
        .iter()
        .flat_map(|f| f.lengths)
        .copied()
        .min_by_key(|l| l.abs_diff(got))
        .unwrap_or(0)
}

/// The form with the most bytes.
pub(super) fn longest(forms: &'static [Form]) -> Option<&'static Form> {
    forms.iter().max_by_key(|f| f.lengths.first())
}

/// The classification that stands behind its unit, as in command 54; 0 if there is none.
pub(super) fn class_ahead(items: &'static [Item], bytes: &[u8]) -> u8 {
    let at = items.iter().position(is_class);
    let offset = at.map(|at| items.iter().take(at).map(width).sum());
    let class = offset.and_then(|offset: usize| bytes.get(offset));
    class.copied().unwrap_or(0)
}

/// True for a classification.
pub(super) fn is_class(item: &Item) -> bool {
    matches!(item.kind, Kind::Named(_, names) if core::ptr::eq(names, &super::CLASSIFICATION))
}
