//! Registers to one value: what they say, and how far to rely on it.

use super::object::{Field, FieldKind};
use super::profile::{BitWord, Profile};
use super::words::{Stamp, characters, signed, unsigned};
use crate::map::row::{Set, Settled};
use crate::problem::Finding;
use crate::value::{Quality, Value};

/// Why a time has no date.
pub(super) const NEVER: &str = "never";
/// What one value says.
pub(super) struct Judged {
    pub value: Value,
    pub quality: Quality,
    pub finding: Option<Finding>,
    /// Its words, where they do not follow from value and bytes.
    pub said: Option<String>,
}

impl Judged {
    pub(super) const fn good(value: Value) -> Self {
        Self {
            value,
            quality: Quality::Good,
            finding: None,
            said: None,
        }
    }
}

/// One value of a field from exactly its registers.
pub(super) fn judge(profile: &Profile, field: &'static Field, words: &[u16]) -> Judged {
    let mut judged = match field.kind {
        FieldKind::U16 | FieldKind::U32 => {
            number(profile, field, i64::try_from(unsigned(words, profile)))
        }
        FieldKind::S16 | FieldKind::S32 => number(profile, field, Ok(signed(words, profile))),
        FieldKind::Time => time(profile, signed(words, profile)),
        FieldKind::Text(_) => text(profile, words),
    };
    let open = field.readings().any(|r| r.settled == Settled::No);
    let assumed = field.setting.is_none_or(|s| profile.is_assumed(s));
    // Of bits only the names are open, and those say so themselves.
    let number = matches!(judged.value, Value::Number { .. });
    if open && assumed && number {
        judged.quality = Quality::Disputed;
    }
    judged
}

fn number(
    profile: &Profile,
    field: &'static Field,
    raw: Result<i64, core::num::TryFromIntError>,
) -> Judged {
    let raw = raw.unwrap_or(i64::MAX);
    let Some(set) = field.set else {
        let scale = field.setting.and_then(|s| profile.scale(s));
        return Judged::good(Value::Number {
            raw,
            scale: scale.unwrap_or(field.scale),
        });
    };
    let raw = u32::try_from(raw).unwrap_or(u32::MAX);
    if set.bits {
        return flags(profile, field, set, raw);
    }
    let mut judged = Judged::good(Value::Code { raw, set });
    if set.get(raw).is_none() {
        judged.quality = Quality::Invalid;
        judged.finding = Some(Finding::NoName { code: raw });
    }
    judged
}

fn flags(profile: &Profile, field: &'static Field, set: &'static Set, raw: u32) -> Judged {
    let mut judged = Judged::good(Value::Flags { raw, set });
    if let Some(word) = bit_word(field)
        && raw != 0
    {
        let names = profile.active(word, u64::from(raw));
        let names: Vec<String> = names.into_iter().map(|label| label.name).collect();
        judged.said = Some(names.join(", "));
    }
    let unused = raw & !set.mask;
    if unused != 0 {
        judged.finding = Some(Finding::UnusedBits { bits: unused });
    }
    judged
}

fn time(profile: &Profile, raw: i64) -> Judged {
    match Stamp::from_raw(raw, profile) {
        Stamp::Never => {
            let mut judged = Judged::good(Value::Unavailable(NEVER));
            judged.said = Some(if raw == 0 {
                NEVER.to_owned()
            } else {
                format!("{NEVER} ({raw})")
            });
            judged
        }
        stamp @ (Stamp::At(seconds) | Stamp::Odd(seconds)) => {
            let mut judged = Judged::good(Value::Stamp(seconds));
            if !stamp.is_plausible() {
                judged.quality = Quality::OutOfRange;
                judged.finding = Some(Finding::OddTime);
            }
            judged
        }
    }
}

fn text(profile: &Profile, words: &[u16]) -> Judged {
    let bytes = characters(words, profile);
    let text = crate::render::text_of(&bytes);
    if text.is_empty() {
        return Judged::good(Value::Unavailable("empty"));
    }
    let mut judged = Judged::good(Value::Text);
    judged.said = Some(text);
    if !bytes.iter().all(|b| matches!(b, 0x20..=0x7E | 0xA0..)) {
        judged.quality = Quality::Invalid;
        judged.finding = Some(Finding::BadDigits {
            what: "printable characters",
        });
    }
    judged
}

/// The names that a site may give to the bits of a field.
pub(super) fn bit_word(field: &Field) -> Option<BitWord> {
    match (field.object, field.key) {
        (1005, "alarms") => Some(BitWord::Alarms),
        (1005, "warnings") => Some(BitWord::Warnings),
        _ => None,
    }
}
