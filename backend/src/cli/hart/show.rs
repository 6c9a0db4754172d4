//! What was read, as people or programs want it: by the decoder of `valvescope decode`.

use super::super::decode::{Format, text};
use super::describe;
use crate::bus::hart::Exchange;
use shared::capture::{Capture, Direction};
use shared::decode::Context;
use shared::device::Device;
use shared::frame::Framing;
use shared::hart::frame::{FILL, PREAMBLE};
use shared::hart::link::Identity;
use shared::json;
use shared::session::Session;
use shared::tree::Decoded;
use std::io::{self, IsTerminal, Write};

/// Writes what is read.
pub(super) struct Show {
    format: Format,
    colour: bool,
    context: Context,
    session: Session,
    decoded: Decoded,
    /// Entries that were written.
    shown: u32,
}

impl Show {
    pub fn new(format: Format, device: Device) -> Self {
        Self {
            format,
            colour: format == Format::Text && io::stdout().is_terminal(),
            context: Context {
                framing: Framing::Hart,
                device,
            },
            session: Session::new(Framing::Hart),
            decoded: Decoded::default(),
            shown: 0,
        }
    }

    /// Something that passes by: only where somebody looks.
    pub fn progress(&self, text: &str) {
        if io::stderr().is_terminal() {
            eprint!("\r{text}   ");
        }
    }

    /// Something worth knowing beside what was read.
    pub fn remark(&self, text: &str) {
        eprintln!("valvescope: {text}");
    }

    /// A device of a scan.
    pub fn found(
        &mut self,
        polling: u8,
        identity: &Identity,
        exchange: &Exchange,
    ) -> io::Result<()> {
        match self.format {
            Format::Text => self.line(&format!("{polling:>2}  {}", describe(identity))),
            Format::Json => self.frames(exchange),
        }
    }

    /// A command: for people how it went and what the answer holds, for programs request and answer.
    pub fn exchange(&mut self, number: u16, exchange: &Exchange, words: &str) -> io::Result<()> {
        if self.format == Format::Json {
            if exchange.outcome.is_err() {
                self.remark(&format!("command {number}: {words}"));
            }
            return self.frames(exchange);
        }
        let label = shared::hart::command(number).map_or("unknown command", |c| c.label);
        self.line(&format!("command {number} {label}: {words}"))?;
        self.frames(exchange)
    }

    /// The last line, for people only.
    pub fn total(&self, text: &str) -> io::Result<()> {
        match self.format {
            Format::Text => self.line(text),
            Format::Json => Ok(()),
        }
    }

    fn line(&self, text: &str) -> io::Result<()> {
        if io::stderr().is_terminal() {
            eprint!("\r");
        }
        let mut out = io::stdout().lock();
        writeln!(out, "{text}")?;
        out.flush()
    }

    /// Request and answer through the decoder. Preambles are those of the standard: how many there
    /// were is an affair of the modem.
    fn frames(&mut self, exchange: &Exchange) -> io::Result<()> {
        self.push(&exchange.request, Direction::ToDevice);
        if let Ok(answer) = &exchange.outcome {
            self.push(&answer.frame, Direction::FromDevice);
        }
        let mut written = String::new();
        while self.shown < self.session.len() {
            let index = self.shown;
            self.shown = index.saturating_add(1);
            let Some(frame) = self.session.frame(index).copied() else {
                continue;
            };
            if !self.session.decode(index, &self.context, &mut self.decoded) {
                continue;
            }
            let framing = self.context.framing;
            let done = match self.format {
                Format::Json => {
                    json::write_frame(&mut written, index, &frame, framing, &self.decoded)
                }
                // People know what they asked.
                Format::Text if frame.role == shared::frame::Role::Request => continue,
                Format::Text => text::write_frame(
                    &mut written,
                    self.colour,
                    index,
                    &frame,
                    framing,
                    &self.decoded,
                    None,
                ),
            };
            done.map_err(io::Error::other)?;
            written.push('\n');
        }
        let mut out = io::stdout().lock();
        out.write_all(written.as_bytes())?;
        out.flush()
    }

    fn push(&mut self, frame: &[u8], direction: Direction) {
        let bytes = [vec![FILL; *PREAMBLE.start()], frame.to_vec()].concat();
        self.session.push(&Capture {
            bytes: &bytes,
            at: None,
            direction,
            ends: true,
        });
    }
}
