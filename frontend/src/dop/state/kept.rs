//! The registers of an object as they were read, and how that went.

use std::sync::Arc;

use shared::dop::{ObjectRead, Profile, Request};

/// How long a handshake took and what came in between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// From the request to the last register, in microseconds.
    pub took_us: u64,
    /// From the request until the device was ready.
    pub busy_us: u64,
    /// How often the status was read.
    pub polls: u32,
    /// How often the handshake was begun anew.
    pub retries: u32,
    /// How often another master's request was seen in between.
    pub foreign: u32,
}

/// Registers of an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// What was asked for.
    pub request: Request,
    /// The registers as received.
    pub words: Vec<u16>,
    /// True if the status was Error, so that the first register is a code.
    pub error: bool,
    /// When they were read, in milliseconds since 1970; `None` if nothing tells.
    pub wall_ms: Option<u64>,
    /// How the read went.
    pub course: Option<Course>,
    /// Where they are from, in words.
    pub origin: String,
    /// What is remarkable about how they were read.
    pub remarks: Vec<String>,
}

impl Kept {
    /// Registers without a history.
    #[must_use]
    pub fn new(request: Request, words: Vec<u16>, origin: &str) -> Self {
        Self {
            request,
            words,
            error: false,
            wall_ms: None,
            course: None,
            origin: origin.to_owned(),
            remarks: Vec::new(),
        }
    }

    /// What they mean.
    #[must_use]
    pub fn read(&self, profile: &Profile) -> ObjectRead {
        if self.error {
            ObjectRead::error(self.request, &self.words, profile)
        } else {
            ObjectRead::read(self.request, &self.words, profile)
        }
    }
}

/// Registers with what they mean; equal if registers and settings are.
#[derive(Clone, Debug)]
pub struct Decoded {
    /// The registers.
    pub kept: Kept,
    /// The settings.
    pub profile: Arc<Profile>,
    /// What the registers mean by the settings.
    pub read: Arc<ObjectRead>,
}

impl Decoded {
    /// Decodes registers.
    #[must_use]
    pub fn new(kept: Kept, profile: &Arc<Profile>) -> Self {
        let read = Arc::new(kept.read(profile));
        Self {
            kept,
            profile: Arc::clone(profile),
            read,
        }
    }
}

impl PartialEq for Decoded {
    fn eq(&self, other: &Self) -> bool {
        self.kept == other.kept && self.profile == other.profile
    }
}

/// Registers from hexadecimal, four digits each; `None` if that is not what it is.
#[must_use]
pub fn words_of(hex: &str) -> Option<Vec<u16>> {
    if !hex.len().is_multiple_of(4) || !hex.is_ascii() {
        return None;
    }
    let words = hex.as_bytes().chunks(4);
    words
        .map(|digits| u16::from_str_radix(core::str::from_utf8(digits).ok()?, 16).ok())
        .collect()
}

/// Registers as hexadecimal, four digits each.
#[must_use]
pub fn hex_of(words: &[u16]) -> String {
    words.iter().map(|word| format!("{word:04X}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_travel_as_digits() {
        assert_eq!(words_of("9ECB60260001"), Some(vec![0x9ECB, 0x6026, 1]));
        assert_eq!(words_of(""), Some(Vec::new()));
        assert_eq!(words_of("9EC"), None);
        assert_eq!(words_of("9ECG"), None);
        assert_eq!(hex_of(&[0x9ECB, 1]), "9ECB0001");
    }

    #[test]
    fn an_error_is_decoded_as_one() {
        let mut kept = Kept::new(Request::from_word(1005), vec![3], "pasted");
        kept.error = true;
        let decoded = Decoded::new(kept.clone(), &Arc::new(Profile::default()));
        assert_eq!(decoded.read.error, Some(3));
        let again = Decoded::new(kept, &Arc::new(Profile::default()));
        assert!(decoded == again);
    }
}
