//! An input to frames, piece by piece, so that the page stays alive whatever its size.

use shared::capture::Capture;
use shared::frame::{Framing, detect, is_hart};
use shared::session::Session;
use shared::text::{Form, HexReader, TextProblem, form_for};

/// How much of an input is looked at to tell its form.
const HEAD: usize = 64 * 1024;

/// How many bytes are looked at to tell the framing.
const SAMPLE: usize = 16 * 1024;

/// Text problems kept; more say nothing new.
const MOST: usize = 500;

/// Reads an input and finds its frames.
#[derive(Debug)]
pub struct Loader {
    chosen: Option<Framing>,
    form: Option<Form>,
    head: Vec<u8>,
    reader: HexReader,
    bytes: Vec<u8>,
    session: Option<Session>,
    problems: Vec<TextProblem>,
    more_problems: usize,
    foreign: bool,
}

/// What became of an input.
#[derive(Debug)]
pub struct Loaded {
    /// What it was.
    pub form: Form,
    /// Its frames and bytes.
    pub session: Session,
    /// What in the text is no byte.
    pub problems: Vec<TextProblem>,
    /// How many more there were.
    pub more_problems: usize,
}

impl Loader {
    /// A loader at the start of an input; `chosen` is the framing that the user wants.
    #[must_use]
    pub fn new(chosen: Option<Framing>) -> Self {
        Self {
            chosen,
            form: None,
            head: Vec::new(),
            reader: HexReader::new(),
            bytes: Vec::new(),
            session: None,
            problems: Vec::new(),
            more_problems: 0,
            foreign: false,
        }
    }

    /// True once it turned out that the input is HART, which this program does not decode.
    #[must_use]
    pub const fn is_foreign(&self) -> bool {
        self.foreign
    }

    /// Takes a piece in.
    pub fn push(&mut self, piece: &[u8]) {
        if self.foreign {
            return;
        }
        if self.form.is_some() {
            self.read(piece);
        } else {
            self.head.extend_from_slice(piece);
            if self.head.len() >= HEAD {
                self.begin();
            }
        }
    }

    /// Number of frames found so far.
    #[must_use]
    pub fn frames(&self) -> u32 {
        self.session.as_ref().map_or(0, Session::len)
    }

    /// The input is at its end; nothing more is pushed.
    pub fn end(&mut self) {
        if self.form.is_none() {
            self.begin();
        }
        if self.form == Some(Form::Hex) {
            self.reader.finish(&mut self.bytes, &mut self.problems);
        }
        self.scan(true);
        self.cut_problems();
    }

    /// What was found up to here.
    #[must_use]
    pub fn finish(self) -> Loaded {
        let form = self.form.unwrap_or(Form::Hex);
        Loaded {
            form,
            session: self.session.unwrap_or_else(|| Session::new(Framing::Rtu)),
            problems: self.problems,
            more_problems: self.more_problems,
        }
    }

    fn begin(&mut self) {
        self.form = Some(form_for(&self.head, self.chosen));
        let head = core::mem::take(&mut self.head);
        self.read(&head);
    }

    fn read(&mut self, piece: &[u8]) {
        match self.form {
            Some(Form::Hex) => {
                self.reader.push(piece, &mut self.bytes, &mut self.problems);
                self.cut_problems();
            }
            _ => self.bytes.extend_from_slice(piece),
        }
        self.scan(false);
    }

    fn cut_problems(&mut self) {
        self.more_problems += self.problems.len().saturating_sub(MOST);
        self.problems.truncate(MOST);
    }

    fn scan(&mut self, at_end: bool) {
        if self.session.is_none() && !at_end && self.bytes.len() < SAMPLE {
            return;
        }
        let here = !cfg!(feature = "hart") && self.session.is_none() && self.chosen.is_none();
        if self.foreign || here && is_hart(&self.bytes) {
            self.foreign = true;
            return;
        }
        let session = self.session.get_or_insert_with(|| {
            let framing = self.chosen.unwrap_or_else(|| match self.form {
                Some(Form::AsciiLines) => Framing::Ascii,
                _ => detect(&self.bytes),
            });
            Session::new(framing)
        });
        if !self.bytes.is_empty() {
            session.push(&Capture::of(&self.bytes));
            self.bytes.clear();
        }
        if at_end {
            session.finish();
        }
    }
}

/// Loads an input that is in memory at once.
#[must_use]
pub fn load(input: &[u8], chosen: Option<Framing>) -> Loaded {
    let mut loader = Loader::new(chosen);
    loader.push(input);
    loader.end();
    loader.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    const POLL: &[u8] = b"7D 03 00 07 00 03 BF F6\n7D 03 06 00 3D 08 44 00 00 3E 07\n";

    fn shape(session: &Session) -> Vec<(u64, u32)> {
        (0..session.len())
            .filter_map(|i| session.frame(i))
            .map(|f| (f.offset, f.len))
            .collect()
    }

    #[test]
    fn text_binary_and_ascii_are_told_apart() {
        let hex = load(POLL, None);
        assert_eq!((hex.form, hex.session.len()), (Form::Hex, 2));
        let binary = load(&[0x7D, 3, 0, 7, 0, 3, 0xBF, 0xF6], None);
        assert_eq!((binary.form, binary.session.len()), (Form::Binary, 1));
        let ascii = load(b":01030000000AF2\r\n", None);
        assert_eq!(ascii.form, Form::AsciiLines);
        assert_eq!(ascii.session.framing(), Framing::Ascii);
    }

    #[test]
    fn pieces_do_not_matter() {
        let text = POLL.repeat(5000);
        let whole = load(&text, None);
        for size in [1000, 65_537] {
            let mut loader = Loader::new(None);
            for piece in text.chunks(size) {
                loader.push(piece);
            }
            loader.end();
            let cut = loader.finish();
            assert_eq!(shape(&cut.session), shape(&whole.session));
        }
        assert_eq!(whole.session.len(), 10_000);
    }

    #[test]
    fn nothing_is_nothing() {
        let none = load(b"", None);
        assert_eq!(none.session.len(), 0);
        assert!(!load(b"01 0", None).problems.is_empty());
    }
}
