//! Pasted response registers to words: hexadecimal in any usual writing, decimal, a table with a
//! column of values, bytes, or the responses of a bus as they are.
//!
//! Which of these it was is said, and can be chosen instead. What is no register is a problem with
//! its line and column, and the rest is read all the same.

mod bytes;
mod table;

use crate::frame::ascii::hex_digit;

/// What a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Form {
    /// Registers in hexadecimal: `1001 0x0012 FFFFh`.
    Hex,
    /// Registers in decimal, also negative ones: `18, -5, 65535`.
    Decimal,
    /// Bytes in hexadecimal, the high byte of a register first.
    Bytes,
    /// Responses to reads of registers, in the frames of Modbus RTU or TCP.
    Frames,
    /// A table, of which one column has the values.
    Table,
}

impl Form {
    /// All forms.
    pub const ALL: [Self; 5] = [
        Self::Hex,
        Self::Decimal,
        Self::Bytes,
        Self::Frames,
        Self::Table,
    ];

    /// The word used on the command line and in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Hex => "hex",
            Self::Decimal => "decimal",
            Self::Bytes => "bytes",
            Self::Frames => "frames",
            Self::Table => "table",
        }
    }

    /// What people read.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Hex => "hexadecimal registers",
            Self::Decimal => "decimal registers",
            Self::Bytes => "hexadecimal bytes, high byte first",
            Self::Frames => "responses of a bus",
            Self::Table => "a table",
        }
    }
}

/// Something in a text that is no register.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputProblem {
    /// Line, counted from 1.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// How many registers had been read when it was met.
    pub at: usize,
    /// What is wrong, and what to do.
    pub text: String,
}

/// A text as registers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// The registers, in the order of the text.
    pub words: Vec<u16>,
    /// What the text was taken for.
    pub form: Form,
    /// The same in words, with what decided.
    pub said: String,
    /// What is no register.
    pub problems: Vec<InputProblem>,
}

/// A word of the text with its place.
#[derive(Clone, Copy, Debug)]
struct Token<'a> {
    text: &'a str,
    line: u32,
    column: u32,
}

impl Token<'_> {
    fn problem(&self, at: usize, text: impl Into<String>) -> InputProblem {
        InputProblem {
            line: self.line,
            column: self.column,
            at,
            text: text.into(),
        }
    }
}

/// Reads a text. `form` is the choice of the user, `None` to detect.
#[must_use]
pub fn read(text: &str, form: Option<Form>) -> Input {
    let mut input = read_all(text, form);
    let more = input.problems.len().saturating_sub(MOST);
    input.problems.truncate(MOST);
    if let (Some(last), true) = (input.problems.last_mut(), more > 0) {
        last.text = format!("{} And {more} more.", last.text);
    }
    input
}

/// Places that are told of one text.
const MOST: usize = 100;

fn read_all(text: &str, form: Option<Form>) -> Input {
    if matches!(form, None | Some(Form::Table))
        && let Some(input) = table::read(text, form.is_some())
    {
        return input;
    }
    let mut problems = Vec::new();
    let tokens = tokens(text);
    let (form, why) = match form {
        Some(Form::Table) => (Form::Decimal, "no table was found".to_owned()),
        Some(form) => (form, "as chosen".to_owned()),
        None => detect(&tokens),
    };
    let words = match form {
        Form::Bytes | Form::Frames => {
            let (stream, places) = byte_stream(&tokens, &mut problems);
            return bytes::read(&stream, &places, form, why, problems);
        }
        Form::Decimal => numbers(&tokens, &mut problems, decimal),
        Form::Hex | Form::Table => hex_words(&tokens, &mut problems),
    };
    if tokens.is_empty() {
        problems.push(nothing());
    }
    Input {
        said: format!("Read as {} ({why}).", form.label()),
        words,
        form,
        problems,
    }
}

fn nothing() -> InputProblem {
    InputProblem {
        line: 1,
        column: 1,
        at: 0,
        text: "There are no registers here. Paste those of the response, such as 0x0018 0x0012, \
               18 65535, or a table with a column of values."
            .to_owned(),
    }
}

/// The words of a text: what stands between blanks, commas, semicolons and brackets, without
/// comments and without the labels that tools print before a value.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    for (line, content) in (1_u32..).zip(text.lines()) {
        let code = ["#", "//"]
            .iter()
            .filter_map(|mark| content.find(mark))
            .min()
            .and_then(|at| content.get(..at))
            .unwrap_or(content);
        let first = tokens.len();
        let mut start = None;
        let inside =
            |c: char| !(c.is_whitespace() || matches!(c, ',' | ';' | '|' | '{' | '}' | '"' | '\''));
        for (at, c) in code.char_indices().chain([(code.len(), ' ')]) {
            match (inside(c), start) {
                (true, None) => start = Some(at),
                (false, Some(from)) => {
                    tokens.push(Token {
                        text: code.get(from..at).unwrap_or_default(),
                        line,
                        column: u32::try_from(from).unwrap_or(u32::MAX).saturating_add(1),
                    });
                    start = None;
                }
                _ => {}
            }
        }
        label_off(&mut tokens, first);
    }
    tokens
}

/// Takes off `[12]:`, `40013:` and `R12 =` at the start of a line, and the `(-1)` that some tools
/// print behind a value. The line begins with the token `first`.
fn label_off(tokens: &mut Vec<Token<'_>>, first: usize) {
    let line = tokens.split_off(first.min(tokens.len()));
    let marked = |text: &str| text.ends_with(':') || text.starts_with('[') || text.ends_with('=');
    let cut = match line.as_slice() {
        [one, _, ..] if marked(one.text) => 1,
        [_, equal, _, ..] if matches!(equal.text, "=" | ":") => 2,
        _ => 0,
    };
    let repeated = |text: &str| text.starts_with('(') && text.ends_with(')');
    tokens.extend(line.into_iter().skip(cut).filter(|t| !repeated(t.text)));
}

/// The digits of a hexadecimal word, and whether it is marked as one.
fn hex_digits(text: &str) -> Option<(&str, bool)> {
    let (digits, marked) = match text.as_bytes() {
        [b'0', b'x' | b'X', ..] => (text.get(2..)?, true),
        [b'$', ..] => (text.get(1..)?, true),
        [.., b'h' | b'H'] => (text.get(..text.len().checked_sub(1)?)?, true),
        _ => (text, false),
    };
    let good = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_hexdigit());
    good.then_some((digits, marked))
}

fn decimal(text: &str) -> Option<u16> {
    let number: i32 = text.parse().ok()?;
    match u16::try_from(number) {
        Ok(word) => Some(word),
        Err(_) => Some(i16::try_from(number).ok()?.cast_unsigned()),
    }
}

/// Tells the form from all words together, and says what decided.
fn detect(tokens: &[Token<'_>]) -> (Form, String) {
    let words: Vec<&str> = tokens.iter().map(|token| token.text).collect();
    let digits: Vec<(&str, bool)> = words.iter().filter_map(|word| hex_digits(word)).collect();
    let said = |form, why: &str| (form, why.to_owned());
    if digits.iter().any(|(_, marked)| *marked) {
        return said(Form::Hex, "words are marked as hexadecimal");
    }
    if words.iter().any(|word| word.starts_with('-')) {
        return said(Form::Decimal, "there are negative numbers");
    }
    let all = |len: usize| !digits.is_empty() && digits.iter().all(|(word, _)| word.len() == len);
    if all(2) {
        return said(Form::Bytes, "every word has two digits");
    }
    if all(4) {
        return said(Form::Hex, "every word has four digits");
    }
    let run = |word: &str| word.len() > 5 && word.len().is_multiple_of(2);
    if digits.iter().any(|(word, _)| run(word)) {
        return if digits.iter().all(|(word, _)| word.len().is_multiple_of(4)) {
            said(Form::Hex, "digits stand together in groups of four")
        } else {
            said(Form::Bytes, "digits stand together in pairs")
        };
    }
    let letters = |word: &str| word.bytes().any(|b| b.is_ascii_alphabetic());
    if digits.iter().any(|(word, _)| letters(word)) {
        return said(Form::Hex, "there are digits A to F");
    }
    said(Form::Decimal, "there are only decimal digits")
}

fn numbers(
    tokens: &[Token<'_>],
    problems: &mut Vec<InputProblem>,
    parse: impl Fn(&str) -> Option<u16>,
) -> Vec<u16> {
    let mut words = Vec::with_capacity(tokens.len());
    for token in tokens {
        match parse(token.text) {
            Some(word) => words.push(word),
            None => problems.push(token.problem(
                words.len(),
                format!(
                    "{} is no register in decimal, -32768 to 65535; it is left out.",
                    quoted(token.text)
                ),
            )),
        }
    }
    words
}

fn hex_words(tokens: &[Token<'_>], problems: &mut Vec<InputProblem>) -> Vec<u16> {
    let mut words = Vec::with_capacity(tokens.len());
    for token in tokens {
        let digits = hex_digits(token.text).map(|(digits, _)| digits);
        match digits {
            Some(digits) if digits.len() <= 4 => words.push(word(digits.as_bytes())),
            // A run without blanks.
            Some(digits) if digits.len().is_multiple_of(4) => {
                words.extend(digits.as_bytes().chunks_exact(4).map(word));
            }
            _ => problems.push(token.problem(
                words.len(),
                format!(
                    "{} is no register of up to four hexadecimal digits; it is left out.",
                    quoted(token.text)
                ),
            )),
        }
    }
    words
}

fn word(digits: &[u8]) -> u16 {
    digits.iter().fold(0, |word, digit| {
        (word << 4) | u16::from(hex_digit(*digit).unwrap_or(0))
    })
}

/// The bytes of all words, and for each the index of its token.
fn byte_stream<'a>(
    tokens: &[Token<'a>],
    problems: &mut Vec<InputProblem>,
) -> (Vec<u8>, Vec<Token<'a>>) {
    let (mut bytes, mut places) = (Vec::new(), Vec::new());
    for token in tokens {
        let digits = hex_digits(token.text).map(|(digits, _)| digits);
        match digits {
            Some(digits) if digits.len() == 1 || digits.len().is_multiple_of(2) => {
                let padded = if digits.len() == 1 {
                    format!("0{digits}")
                } else {
                    digits.to_owned()
                };
                for pair in padded.as_bytes().chunks_exact(2) {
                    bytes.extend(crate::frame::ascii::hex_pair(pair));
                    places.push(*token);
                }
            }
            _ => problems.push(token.problem(
                bytes.len() / 2,
                format!(
                    "{} is no run of hexadecimal bytes; it is left out.",
                    quoted(token.text)
                ),
            )),
        }
    }
    (bytes, places)
}

/// A word as it is shown in a sentence, shortened if it is long.
fn quoted(text: &str) -> String {
    let short: String = text.chars().take(20).collect();
    if short.len() < text.len() {
        format!("{short:?}…")
    } else {
        format!("{short:?}")
    }
}
