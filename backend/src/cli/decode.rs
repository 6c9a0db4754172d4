//! `valvescope decode`: bytes or text to frames, in one pass and bounded memory.

mod input;
pub(super) mod text;

use super::{DeviceArg, MISUSE, path_or_stdin, refuse};
use clap::ValueEnum;
use input::{Input, Piece};
use shared::capture::Capture;
use shared::decode::Context;
use shared::frame::Framing;
use shared::hart::procedure::{Open, Procedures, Step};
use shared::json;
use shared::place::Place;
use shared::problem::{Finding, Problem, Severity};
use shared::session::Session;
use shared::text::TextProblem;
use shared::tree::Decoded;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal, Read, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// A request is printed once its answer is known, or so many entries later.
const HELD_BACK: u32 = 64;

/// A run of noise is printed in parts of this size, so that memory stays bounded.
const LONGEST_NOISE: u32 = 64 * 1024;

/// Output is handed on in pieces of about this size.
const FLUSH: usize = 64 * 1024;

/// Decode frames.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What to decode; `-` or nothing means standard input.
    ///
    /// A binary capture, Modbus ASCII lines, or text with hexadecimal bytes in any usual writing.
    file: Option<PathBuf>,
    /// How frames are marked off.
    #[arg(long = "as", value_enum, default_value_t = FramingArg::Auto)]
    framing: FramingArg,
    /// Whose registers these are.
    #[arg(long, value_enum, default_value_t = DeviceArg::None)]
    device: DeviceArg,
    /// What to print: readable text, or one JSON object a line.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Framings that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FramingArg {
    /// Whichever explains most of the bytes.
    Auto,
    /// Modbus RTU.
    ModbusRtu,
    /// Modbus ASCII.
    ModbusAscii,
    /// Modbus TCP.
    ModbusTcp,
    /// HART.
    Hart,
    /// HART-IP.
    HartIp,
}

impl FramingArg {
    fn framing(self) -> Option<Framing> {
        match self {
            Self::Auto => None,
            Self::ModbusRtu => Some(Framing::Rtu),
            Self::ModbusAscii => Some(Framing::Ascii),
            Self::ModbusTcp => Some(Framing::Tcp),
            Self::Hart => Some(Framing::Hart),
            Self::HartIp => Some(Framing::HartIp),
        }
    }
}

/// Forms of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Decodes what the arguments name. 0: all sound; 1: errors found; 2: could not be read.
pub(super) fn run(args: &Args) -> ExitCode {
    let source: Box<dyn Read> = match path_or_stdin(args.file.as_ref()) {
        None => Box::new(io::stdin().lock()),
        Some(path) => match File::open(path) {
            Ok(file) => Box::new(file),
            Err(error) => {
                return refuse(format_args!("can't open {}: {error}", path.display()));
            }
        },
    };
    let colour = args.format == Format::Text && io::stdout().is_terminal();
    let mut printer = Printer {
        format: args.format,
        colour,
        buffer: String::with_capacity(FLUSH.saturating_mul(2)),
        out: io::stdout().lock(),
        tally: Tally::default(),
    };
    let outcome = decode(source, args, &mut printer).and_then(|()| printer.finish());
    match outcome {
        Ok(()) => {}
        // Whoever read our output has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        Err(error) => {
            eprintln!("valvescope: can't decode to the end: {error}");
            return ExitCode::from(MISUSE);
        }
    }
    ExitCode::from(u8::from(printer.tally.errors > 0))
}

fn decode(source: impl Read, args: &Args, printer: &mut Printer<impl Write>) -> io::Result<()> {
    let (mut input, framing) = Input::open(source, args.framing.framing())?;
    let context = Context {
        framing,
        device: args.device.into(),
    };
    let mut stream = Stream {
        session: Session::new(framing),
        context,
        decoded: Decoded::default(),
        next: 0,
        problems: VecDeque::new(),
        procedures: Procedures::new(),
    };
    let mut empty = true;
    let mut piece = Piece::default();
    while input.next(&mut piece)? {
        stream.problems.extend(piece.problems.drain(..));
        empty &= piece.bytes.is_empty();
        stream.session.push(&Capture::of(&piece.bytes));
        stream.print(HELD_BACK, printer)?;
    }
    stream.session.finish();
    stream.print(0, printer)?;
    for open in stream.procedures.open() {
        printer.open_procedure(&open)?;
    }
    if empty && printer.tally.errors == 0 {
        printer.text_problem(
            0,
            &TextProblem {
                finding: Finding::Empty,
                line: 1,
                column: 1,
                offset: 0,
            },
        )?;
    }
    Ok(())
}

/// The frames found and not yet printed.
struct Stream {
    session: Session,
    context: Context,
    decoded: Decoded,
    /// Index of the next entry to print.
    next: u32,
    problems: VecDeque<TextProblem>,
    /// Procedures of HART that go on.
    procedures: Procedures,
}

impl Stream {
    /// Prints all entries but the last `held_back`, each after the problems of the text before it.
    fn print(&mut self, held_back: u32, printer: &mut Printer<impl Write>) -> io::Result<()> {
        let len = self.session.len();
        let last = len.checked_sub(1).and_then(|i| self.session.frame(i));
        // A long run of noise would be kept in memory to its end.
        let long = last.is_some_and(|f| f.is_noise() && f.len >= LONGEST_NOISE);
        let until = if long {
            len
        } else {
            len.saturating_sub(held_back)
        };
        while self.next < until {
            let Some(frame) = self.session.frame(self.next).copied() else {
                break;
            };
            self.print_problems(frame.end(), printer)?;
            if self
                .session
                .decode(self.next, &self.context, &mut self.decoded)
            {
                let step = self.step(&frame);
                printer.frame(
                    self.next,
                    &frame,
                    &self.context,
                    &self.decoded,
                    step.as_ref(),
                )?;
            }
            self.next = self.next.saturating_add(1);
        }
        if held_back == 0 {
            self.print_problems(u64::MAX, printer)?;
        }
        // Requests are needed until their answers are printed.
        let keep = if long { 0 } else { HELD_BACK };
        self.session.forget_before(self.next.saturating_sub(keep));
        Ok(())
    }

    /// What the entry that is printed next does in a procedure of HART.
    fn step(&mut self, frame: &shared::frame::Frame) -> Option<Step> {
        let framing = self.context.framing;
        let hart = matches!(framing, Framing::Hart | Framing::HartIp);
        if !hart || frame.is_noise() || frame.marks.is_damaged() {
            return None;
        }
        self.procedures
            .frame(framing, self.decoded.bytes(), self.next)
    }

    /// Prints the problems of the text that stand before the byte at `offset`.
    fn print_problems(&mut self, offset: u64, printer: &mut Printer<impl Write>) -> io::Result<()> {
        while self.problems.front().is_some_and(|p| p.offset < offset) {
            if let Some(problem) = self.problems.pop_front() {
                printer.text_problem(self.next, &problem)?;
            }
        }
        Ok(())
    }
}

/// What was found.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    frames: u64,
    noise: u64,
    errors: u64,
}

/// Writes entries in the chosen form.
struct Printer<W> {
    format: Format,
    colour: bool,
    buffer: String,
    out: W,
    tally: Tally,
}

impl<W: Write> Printer<W> {
    fn frame(
        &mut self,
        index: u32,
        frame: &shared::frame::Frame,
        context: &Context,
        decoded: &Decoded,
        step: Option<&Step>,
    ) -> io::Result<()> {
        if frame.is_noise() {
            self.tally.noise += u64::from(frame.len);
        } else {
            self.tally.frames += 1;
        }
        self.tally.errors += u64::from(!decoded.is_ok());
        let written = match self.format {
            Format::Json => json::write_hart_frame(
                &mut self.buffer,
                index,
                frame,
                context.framing,
                decoded,
                step,
            ),
            Format::Text => text::write_frame(
                &mut self.buffer,
                self.colour,
                index,
                frame,
                context.framing,
                decoded,
                step,
            ),
        };
        self.pass_on(written)
    }

    /// Something that was begun and not ended.
    fn open_procedure(&mut self, open: &Open) -> io::Result<()> {
        let written = match self.format {
            Format::Json => open.write_json(&mut self.buffer),
            Format::Text => text::write_open(&mut self.buffer, self.colour, open),
        };
        self.pass_on(written)
    }

    fn text_problem(&mut self, index: u32, problem: &TextProblem) -> io::Result<()> {
        let found = Problem::new(problem.finding, Place::default());
        self.tally.errors += u64::from(found.severity() == Severity::Error);
        let written = match self.format {
            Format::Json => json::write_text_problem(&mut self.buffer, index, problem),
            Format::Text => text::write_text_problem(&mut self.buffer, self.colour, problem),
        };
        self.pass_on(written)
    }

    /// Ends the line and hands the buffer on once it is worth it.
    fn pass_on(&mut self, written: std::fmt::Result) -> io::Result<()> {
        written.map_err(io::Error::other)?;
        self.buffer.push('\n');
        if self.buffer.len() >= FLUSH {
            self.flush()?;
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        let text = std::mem::take(&mut self.buffer);
        let outcome = self.out.write_all(text.as_bytes());
        self.buffer = text;
        self.buffer.clear();
        // One very long entry must not keep its memory for ever.
        self.buffer.shrink_to(FLUSH * 4);
        outcome
    }

    fn finish(&mut self) -> io::Result<()> {
        if self.format == Format::Text {
            text::write_tally(&mut self.buffer, &self.tally).map_err(io::Error::other)?;
        }
        self.flush()?;
        self.out.flush()
    }
}

#[cfg(test)]
mod tests;
