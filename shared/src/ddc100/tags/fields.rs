//! Single cells of a list.

use super::{Column, Data, Tag, quoted};
use crate::ddc100::scaling::Scaling;
use crate::ddc100::setup::LAST_UNIT;
use crate::device::Device;

impl Tag {
    pub(super) fn set(&mut self, column: Column, text: &str) -> Result<(), String> {
        if text.is_empty() {
            return Ok(());
        }
        match column {
            Column::Tag => text.clone_into(&mut self.tag),
            Column::Description => text.clone_into(&mut self.description),
            Column::Comments => text.clone_into(&mut self.comments),
            Column::Unit => {
                let unit = text.parse().ok();
                let unit = unit.filter(|u| (1..=LAST_UNIT).contains(u));
                self.unit = unit.ok_or_else(|| {
                    format!(
                        "{} is no unit address: write 1 to {LAST_UNIT}.",
                        quoted(text)
                    )
                })?;
            }
            Column::Type => {
                let kind = Device::from_key(&text.to_ascii_lowercase());
                let kind = kind.filter(|k| k.key().starts_with("ddc100-"));
                self.kind = Some(kind.ok_or_else(|| {
                    let kinds = Device::ALL.map(Device::key);
                    let kinds: Vec<_> = kinds
                        .into_iter()
                        .filter(|k| k.starts_with("ddc100-"))
                        .collect();
                    format!("{} is no type: write {}.", quoted(text), kinds.join(", "))
                })?);
            }
            Column::Register => {
                self.register = register(text).ok_or_else(|| {
                    format!(
                        "{} is no holding register: write 40001 to 40112, or 1 to 112.",
                        quoted(text)
                    )
                })?;
            }
            Column::Data => {
                self.data = data(text).ok_or_else(|| {
                    format!(
                        "{} is no command data: write a number of 16 bits, a range like 0-100, or n/a.",
                        quoted(text)
                    )
                })?;
            }
            Column::Scaling => {
                let scaling = Scaling::from_key(&text.to_ascii_lowercase());
                self.scaling = Some(scaling.ok_or_else(|| {
                    let keys = Scaling::ALL.map(Scaling::key);
                    format!("{} is no scaling: write {}.", quoted(text), keys.join(", "))
                })?);
            }
        }
        Ok(())
    }

    pub(super) fn get(&self, column: Column) -> String {
        match column {
            Column::Tag => self.tag.clone(),
            Column::Description => self.description.clone(),
            Column::Comments => self.comments.clone(),
            Column::Unit => self.unit.to_string(),
            Column::Type => self.kind.map_or("", Device::key).to_owned(),
            Column::Register => self.register.map_or_else(String::new, |number| {
                u32::from(number).saturating_add(40_000).to_string()
            }),
            Column::Data => self.data.map_or_else(String::new, |d| d.to_string()),
            Column::Scaling => self.scaling.map_or("", Scaling::key).to_owned(),
        }
    }
}

/// `40008` or `8`; `n/a` is none.
fn register(text: &str) -> Option<Option<u16>> {
    if is_none(text) {
        return Some(None);
    }
    let number: u32 = text.parse().ok()?;
    let number = number.checked_sub(40_000).unwrap_or(number);
    let number = u16::try_from(number).ok()?;
    (1..=112).contains(&number).then_some(Some(number))
}

/// `256`, `256 (Dec)`, `0x100`, `0-100 (Dec)`; `n/a` is none.
fn data(text: &str) -> Option<Option<Data>> {
    if is_none(text) {
        return Some(None);
    }
    let (number, base) = text.split_once('(').unwrap_or((text, ""));
    let base = base.trim().trim_end_matches(')').trim();
    let hex = match base {
        "" => false,
        _ if base.eq_ignore_ascii_case("dec") => false,
        _ if base.eq_ignore_ascii_case("hex") => true,
        _ => return None,
    };
    let word = |text: &str| {
        let text = text.trim();
        match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
            Some(digits) => hex_word(digits),
            None if hex => hex_word(text),
            None => text.parse().ok(),
        }
    };
    let data = match number.split_once('-') {
        Some((from, to)) => {
            let (from, to) = (word(from)?, word(to)?);
            (from <= to).then_some(Data::Range(from, to))?
        }
        None => Data::Value(word(number)?),
    };
    Some(Some(data))
}

fn hex_word(digits: &str) -> Option<u16> {
    let plain = digits.bytes().all(|b| b.is_ascii_hexdigit());
    plain.then(|| u16::from_str_radix(digits, 16).ok())?
}

fn is_none(text: &str) -> bool {
    text.eq_ignore_ascii_case("n/a") || text == "-"
}
