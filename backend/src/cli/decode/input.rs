//! A file or pipe to bytes, piece by piece, whatever form they are written in.

use shared::frame::{Framing, detect};
use shared::text::{Form, HexReader, TextProblem, form};
use std::io::{self, ErrorKind, Read};

/// How much is read to tell the form, and at a time.
const CHUNK: usize = 64 * 1024;

/// A piece of the input.
#[derive(Debug, Default)]
pub(super) struct Piece {
    /// The bytes that it holds or writes.
    pub bytes: Vec<u8>,
    /// What in it is no byte.
    pub problems: Vec<TextProblem>,
}

/// Reads an input to its end.
pub(super) struct Input<R> {
    source: R,
    /// What was read and not handed out yet.
    chunk: Vec<u8>,
    /// What turns text into bytes; `None` if the input is bytes.
    hex: Option<HexReader>,
    /// The first piece was decoded to tell the framing.
    first: Option<Piece>,
    ended: bool,
}

impl<R: Read> Input<R> {
    /// Looks at the beginning and tells what form and framing it has.
    pub(super) fn open(source: R, asked: Option<Framing>) -> io::Result<(Self, Framing)> {
        let mut input = Self {
            source,
            chunk: Vec::with_capacity(CHUNK),
            hex: None,
            first: None,
            ended: false,
        };
        input.fill(CHUNK)?;
        let form = form(&input.chunk);
        let raw = match form {
            Form::Binary => true,
            Form::AsciiLines => matches!(asked, None | Some(Framing::Ascii)),
            Form::Hex => false,
        };
        input.hex = (!raw).then(HexReader::new);
        let mut first = Piece::default();
        input.take(&mut first);
        let framing = asked.unwrap_or_else(|| match form {
            Form::AsciiLines => Framing::Ascii,
            Form::Binary | Form::Hex => detect(&first.bytes),
        });
        input.first = Some(first);
        Ok((input, framing))
    }

    /// The next piece, in memory that is used again; false at the end.
    pub(super) fn next(&mut self, piece: &mut Piece) -> io::Result<bool> {
        if let Some(first) = self.first.take() {
            *piece = first;
            return Ok(true);
        }
        if self.ended && self.chunk.is_empty() {
            return Ok(false);
        }
        piece.bytes.clear();
        piece.problems.clear();
        if self.chunk.is_empty() {
            self.fill(1)?;
        }
        self.take(piece);
        Ok(true)
    }

    /// Reads until there are at least `wanted` bytes, or the end.
    fn fill(&mut self, wanted: usize) -> io::Result<()> {
        let mut have = self.chunk.len();
        self.chunk.resize(CHUNK, 0);
        while have < wanted && !self.ended {
            match self.source.read(&mut self.chunk[have..]) {
                Ok(0) => self.ended = true,
                Ok(read) => have += read,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.chunk.truncate(have);
        Ok(())
    }

    /// Moves what was read into a piece.
    fn take(&mut self, piece: &mut Piece) {
        let Piece { bytes, problems } = piece;
        match &mut self.hex {
            None => bytes.extend_from_slice(&self.chunk),
            Some(hex) => {
                hex.push(&self.chunk, bytes, problems);
                if self.ended {
                    hex.finish(bytes, problems);
                }
            }
        }
        self.chunk.clear();
    }
}
