//! What is open on the decode page.

use std::sync::Arc;

use shared::decode::Context;
use shared::device::Device;
use shared::frame::{Frame, Framing};
use shared::guess::{self, Guess};
use shared::session::Session;
use shared::text::{Form, TextProblem};
use shared::tree::Decoded;

use super::findings::{CLIP, decode_clipped};
use super::load::Loaded;

/// A decoded frame as components show it. Cheap to copy.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Its number in the list.
    pub index: u32,
    /// Its entry of the index.
    pub frame: Frame,
    /// What it was decoded with.
    pub context: Context,
    /// Bytes, fields, problems.
    pub decoded: Arc<Decoded>,
}

impl PartialEq for Shown {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
            && self.frame == other.frame
            && self.context == other.context
            && self.decoded.bytes() == other.decoded.bytes()
    }
}

impl Shown {
    /// Decodes an entry of a session.
    #[must_use]
    pub fn of(session: &Session, index: u32, device: Device) -> Option<Self> {
        let context = Context {
            framing: session.framing(),
            device,
        };
        let mut decoded = Decoded::default();
        decode_clipped(session, index, &context, &mut decoded).then_some(())?;
        Some(Self {
            index,
            frame: *session.frame(index)?,
            context,
            decoded: Arc::new(decoded),
        })
    }

    /// How many bytes of a long run of noise are not shown.
    #[must_use]
    pub fn hidden(&self) -> u64 {
        let shown = u64::try_from(CLIP).unwrap_or(0);
        u64::from(self.frame.len).saturating_sub(shown)
    }

    /// The frame as one JSON object.
    #[must_use]
    pub fn json(&self) -> String {
        let mut text = String::new();
        // Writing to a String does not fail.
        let _infallible = shared::json::write_frame(
            &mut text,
            self.index,
            &self.frame,
            self.context.framing,
            &self.decoded,
        );
        text
    }

    /// The frame as lines of text: bytes, fields, problems.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "Frame {} · offset {} · {}\n{}\n",
            self.index,
            self.frame.offset,
            self.context.framing.label(),
            shared::render::Spaced(self.decoded.bytes())
        );
        for (id, field) in self.decoded.iter() {
            let indent = "  ".repeat(self.decoded.depth(id));
            text.push_str(&format!(
                "{indent}{}: {}  [{}]\n",
                field.name.label(),
                self.decoded.text(field),
                self.decoded.raw(field)
            ));
        }
        for problem in self.decoded.problems() {
            text.push_str(&format!("{}: {problem}\n", problem.severity().key()));
        }
        text
    }
}

/// An input with its frames.
#[derive(Debug)]
pub struct Work {
    /// Where it came from: `pasted text`, a file name, the title of a sample.
    pub name: String,
    /// What it was.
    pub form: Form,
    /// Frames and bytes.
    pub session: Session,
    /// What in the text is no byte.
    pub text_problems: Vec<TextProblem>,
    /// How many more text problems there were.
    pub more_text_problems: usize,
    /// The device by its traces.
    pub guess: Guess,
    /// True if reading was stopped before the end.
    pub partial: bool,
}

impl Work {
    /// What a loader found.
    #[must_use]
    pub fn new(name: String, loaded: Loaded, partial: bool) -> Self {
        let guess = guess::device(&loaded.session);
        Self {
            name,
            form: loaded.form,
            session: loaded.session,
            text_problems: loaded.problems,
            more_text_problems: loaded.more_problems,
            guess,
            partial,
        }
    }

    /// The device to decode with: the choice of the user, else the guess.
    #[must_use]
    pub fn device(&self, chosen: Option<Device>) -> Device {
        chosen.unwrap_or(self.guess.device)
    }

    /// Context to decode with.
    #[must_use]
    pub fn context(&self, chosen: Option<Device>) -> Context {
        Context {
            framing: self.session.framing(),
            device: self.device(chosen),
        }
    }
}

/// The words for a form.
#[must_use]
pub const fn form_label(form: Form) -> &'static str {
    match form {
        Form::Binary => "binary",
        Form::AsciiLines => "Modbus ASCII lines",
        Form::Hex => "hex text",
    }
}

/// The framing of a choice in a list: empty for automatic.
#[must_use]
pub fn chosen_framing(key: &str) -> Option<Framing> {
    Framing::from_key(key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;

    fn shown() -> Shown {
        let loaded = load(b"7D0300070003BFF6 7D0306003D084400003E07", None);
        let work = Work::new("test".into(), loaded, false);
        Shown::of(&work.session, 1, work.device(None)).unwrap()
    }

    #[test]
    fn a_frame_copies_as_json_and_text() {
        let shown = shown();
        assert!(shown.json().starts_with(r#"{"kind":"frame","index":1"#));
        let text = shown.text();
        assert!(text.contains("7D 03 06 00 3D"), "{text}");
        assert!(text.contains("Byte count: 6"), "{text}");
    }

    #[test]
    fn equal_frames_are_equal() {
        assert_eq!(shown(), shown());
    }
}
