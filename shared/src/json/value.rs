//! The little of JSON that the page and the files of snapshots need: whole numbers, texts, lists and
//! objects.
//!
//! The page's own messages are few and flat. A general serializer, with its floating point and its
//! error texts, would be a twentieth of the first load.

use core::fmt::Write as _;
use std::borrow::Cow;

/// Values deeper than this are not read. The protocol needs four levels.
const DEEPEST: u8 = 32;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Json<'a> {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A whole number from 0.
    Number(u64),
    /// A whole number below 0.
    Negative(i64),
    /// Any other number, or a whole one that is too large.
    Other,
    /// A text.
    Text(Cow<'a, str>),
    /// A list.
    List(Vec<Self>),
    /// An object, its members in the order in which they came.
    Object(Vec<(Cow<'a, str>, Self)>),
}

impl<'a> Json<'a> {
    /// Reads a text that holds one value; `None` if it is no JSON.
    #[must_use]
    pub fn parse(text: &'a str) -> Option<Self> {
        Self::read(text).ok()
    }

    /// The same, with the place from which on it is no JSON.
    ///
    /// # Errors
    /// The offset in the text, in bytes.
    pub fn read(text: &'a str) -> Result<Self, usize> {
        let mut reader = Reader { text, at: 0 };
        let value = reader.value(DEEPEST);
        reader.blanks();
        match value {
            Some(value) if reader.at == text.len() => Ok(value),
            _ => Err(reader.at.min(text.len())),
        }
    }

    /// A member of an object. Where a name comes twice, the last one counts.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Self> {
        let Self::Object(members) = self else {
            return None;
        };
        let (_, value) = members.iter().rev().find(|(key, _)| key == name)?;
        Some(value)
    }

    /// The member of an object that has exactly one.
    #[must_use]
    pub fn only(&self) -> Option<(&str, &Self)> {
        match self {
            Self::Object(members) => match members.as_slice() {
                [(name, value)] => Some((name, value)),
                _ => None,
            },
            _ => None,
        }
    }

    /// The members of an object.
    #[must_use]
    pub fn members(&self) -> Option<&[(Cow<'a, str>, Self)]> {
        match self {
            Self::Object(members) => Some(members),
            _ => None,
        }
    }

    /// A text.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// A whole number.
    #[must_use]
    pub const fn number(&self) -> Option<u64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// A whole number that may be below 0.
    #[must_use]
    pub fn signed(&self) -> Option<i64> {
        match self {
            Self::Number(number) => i64::try_from(*number).ok(),
            Self::Negative(number) => Some(*number),
            _ => None,
        }
    }

    /// The elements of a list.
    #[must_use]
    pub fn list(&self) -> Option<&[Self]> {
        match self {
            Self::List(list) => Some(list),
            _ => None,
        }
    }
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    const fn skip(&mut self, bytes: usize) {
        self.at = self.at.saturating_add(bytes);
    }

    fn blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.skip(1);
        }
    }

    /// Takes a sign if it is the next one after blanks.
    fn take(&mut self, sign: u8) -> bool {
        self.blanks();
        let is = self.peek() == Some(sign);
        self.skip(usize::from(is));
        is
    }

    fn word(&mut self, word: &str, value: Json<'a>) -> Option<Json<'a>> {
        self.text.get(self.at..)?.starts_with(word).then(|| {
            self.skip(word.len());
            value
        })
    }

    fn value(&mut self, deep: u8) -> Option<Json<'a>> {
        let deep = deep.checked_sub(1)?;
        self.blanks();
        match self.peek()? {
            b'n' => self.word("null", Json::Null),
            b't' => self.word("true", Json::Bool(true)),
            b'f' => self.word("false", Json::Bool(false)),
            b'"' => self.string().map(Json::Text),
            b'[' => {
                let mut list = Vec::new();
                self.several(b']', |reader| {
                    list.push(reader.value(deep)?);
                    Some(())
                })?;
                Some(Json::List(list))
            }
            b'{' => {
                let mut members = Vec::new();
                self.several(b'}', |reader| {
                    reader.blanks();
                    let key = reader.string()?;
                    if !reader.take(b':') {
                        return None;
                    }
                    members.push((key, reader.value(deep)?));
                    Some(())
                })?;
                Some(Json::Object(members))
            }
            b'-' | b'0'..=b'9' => self.number(),
            _ => None,
        }
    }

    /// What stands between brackets, separated by commas.
    fn several(&mut self, end: u8, mut one: impl FnMut(&mut Self) -> Option<()>) -> Option<()> {
        self.skip(1);
        if self.take(end) {
            return Some(());
        }
        loop {
            one(self)?;
            if self.take(end) {
                return Some(());
            }
            if !self.take(b',') {
                return None;
            }
        }
    }

    fn number(&mut self) -> Option<Json<'a>> {
        let start = self.at;
        while matches!(
            self.peek(),
            Some(b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9')
        ) {
            self.skip(1);
        }
        let digits = self.text.get(start..self.at)?;
        // What is no number at all is taken for one that the page can't use.
        Some(match (digits.parse(), digits.parse()) {
            (Ok(number), _) if !digits.starts_with('+') => Json::Number(number),
            (_, Ok(number)) if digits.starts_with('-') => Json::Negative(number),
            _ => Json::Other,
        })
    }

    fn string(&mut self) -> Option<Cow<'a, str>> {
        if self.peek() != Some(b'"') {
            return None;
        }
        self.skip(1);
        let mut text = Cow::Borrowed("");
        loop {
            let rest = self.text.get(self.at..)?;
            let end = rest.find(['"', '\\'])?;
            let part = rest.get(..end)?;
            if text.is_empty() {
                text = Cow::Borrowed(part);
            } else {
                text.to_mut().push_str(part);
            }
            self.skip(end.saturating_add(1));
            if rest.as_bytes().get(end) == Some(&b'"') {
                return Some(text);
            }
            let c = self.escaped()?;
            text.to_mut().push(c);
        }
    }

    fn escaped(&mut self) -> Option<char> {
        let sign = self.peek()?;
        self.skip(1);
        Some(match sign {
            b'"' | b'\\' | b'/' => char::from(sign),
            b'n' => '\n',
            b't' => '\t',
            b'r' => '\r',
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'u' => {
                let high = self.hex()?;
                if !(0xD800..0xDC00).contains(&high) {
                    return char::from_u32(high);
                }
                // The second half of a pair.
                self.word("\\u", Json::Null)?;
                let low = self.hex()?.checked_sub(0xDC00)?;
                let high = high.checked_sub(0xD800)?.checked_mul(0x400)?;
                char::from_u32(high.checked_add(low)?.checked_add(0x1_0000)?)?
            }
            _ => return None,
        })
    }

    fn hex(&mut self) -> Option<u32> {
        let digits = self.text.get(self.at..self.at.saturating_add(4))?;
        self.skip(4);
        u32::from_str_radix(digits, 16).ok()
    }
}

/// Appends a text as JSON.
pub fn quoted(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            c if c < ' ' => {
                // Writing to a string does not fail.
                let _infallible = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back() {
        for text in ["", "a", "\"\\/", "\n\t\u{1}", "é€𝄞", "a\"b\"c"] {
            let mut json = String::new();
            quoted(&mut json, text);
            assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
            assert_eq!(Json::parse(&json).unwrap().text(), Some(text));
            let theirs = serde_json::to_string(text).unwrap();
            assert_eq!(Json::parse(&theirs).unwrap().text(), Some(text));
        }
        assert_eq!(
            Json::parse(r#""\u00e9\ud834\udd1e\/\b\f""#).unwrap().text(),
            Some("é𝄞/\u{8}\u{c}")
        );
    }

    #[test]
    fn values_are_told_apart() {
        let json = Json::parse(
            " {\"a\" : [ 1 , true,false,null,\"x\", -1, 1.5, 18446744073709551615, 18446744073709551616] ,\"b\":{},\"c\":[]} ",
        )
        .unwrap();
        assert_eq!(
            json.get("a").unwrap().list().unwrap(),
            [
                Json::Number(1),
                Json::Bool(true),
                Json::Bool(false),
                Json::Null,
                Json::Text("x".into()),
                Json::Negative(-1),
                Json::Other,
                Json::Number(u64::MAX),
                Json::Other,
            ]
        );
        let signed = |text: &str| Json::parse(text).and_then(|json| json.signed());
        assert_eq!(signed("-9223372036854775808"), Some(i64::MIN));
        assert_eq!(signed("7"), Some(7));
        assert_eq!(signed("9223372036854775808"), None);
        assert_eq!(signed("-9223372036854775809"), None);
        assert_eq!(json.get("b"), Some(&Json::Object(Vec::new())));
        assert_eq!(json.get("c"), Some(&Json::List(Vec::new())));
        assert_eq!(json.get("d"), None);
        assert_eq!(
            Json::parse(r#"{"a":1,"a":2}"#).unwrap().get("a").unwrap(),
            &Json::Number(2)
        );
    }

    #[test]
    fn what_is_no_json_is_refused() {
        for text in [
            "",
            " ",
            "{",
            "[",
            "[1",
            "[1,",
            "[,]",
            "{\"a\"}",
            "{\"a\":}",
            "{a:1}",
            "\"",
            "\"\\",
            "\"\\u12",
            "\"\\ud834\"",
            "\"\\ud834\\u0041\"",
            "nul",
            "1 2",
            "}",
            "é",
            "\"\\u{12}\"",
            "[1}",
        ] {
            assert_eq!(Json::parse(text), None, "{text}");
        }
        assert_eq!(Json::parse(&"[".repeat(100_000)), None);
        let deep = |n: usize| format!("{}{}", "[".repeat(n), "]".repeat(n));
        assert!(Json::parse(&deep(32)).is_some());
        assert_eq!(Json::parse(&deep(33)), None);
    }
}
