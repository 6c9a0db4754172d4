//! Values of the map as text, with their unit.

use crate::image::Image;
use crate::map::decode::{Judged, value};
use crate::map::row::{Kind, Row};
use crate::render::{Spaced, text_of};
use crate::value::{ON_OFF, Value};

/// The value of a row in words with its unit; `None` if a word of it was not read.
#[must_use]
pub fn row(image: &Image, row: &'static Row) -> Option<String> {
    let bytes = image.bytes(row)?;
    Some(bytes_of(row, &bytes))
}

/// The value of a row from its bytes, in words with its unit.
#[must_use]
pub fn bytes_of(row: &'static Row, bytes: &[u8]) -> String {
    if row.table.is_bits() {
        let (off, on) = ON_OFF;
        let is_on = bytes.iter().any(|b| *b != 0);
        return if is_on { on } else { off }.to_owned();
    }
    let Judged { value, .. } = value(row, bytes);
    match value {
        Value::Text => text_of(text(row, bytes)),
        Value::Amount { unit } => {
            let amount = text_of(bytes.get(1..).unwrap_or(&[]));
            match unit {
                Some(unit) => format!("{amount} {unit}"),
                None => format!("{amount} (unit unknown)"),
            }
        }
        Value::Samples | Value::Group if row.kind == Kind::Curve => {
            let samples = bytes.get(..101).unwrap_or(bytes);
            let peak = samples.iter().max().copied().unwrap_or(0);
            format!("{} samples, peak {peak}", samples.len())
        }
        Value::Raw | Value::Samples | Value::Group => Spaced(bytes).to_string(),
        Value::Hex(raw) => {
            let width = bytes.len().saturating_mul(2);
            format!("0x{raw:0width$X}")
        }
        Value::Number { .. } if !row.unit.is_empty() => format!("{value} {}", row.unit),
        value => value.to_string(),
    }
}

/// Reading E18: of seven characters in four words the last byte is padding, unless the seventh is
/// empty.
fn text<'a>(row: &Row, bytes: &'a [u8]) -> &'a [u8] {
    if row.kind == Kind::Ascii7
        && let Some((_, body)) = bytes.split_last()
        && body.last().is_some_and(|b| !matches!(b, 0 | b' '))
    {
        return body;
    }
    bytes
}
