//! The procedures that a list of frames goes through: which frame is which step of which run.

use shared::hart::procedure::{Procedures, Step};
use shared::problem::Severity;
use shared::session::Session;

/// Frames looked at; more would keep the page waiting.
const MOST: u32 = 200_000;

/// A step with the frame that made it.
#[derive(Clone, Debug, PartialEq)]
pub struct At {
    /// Index of the frame.
    pub frame: u32,
    /// The step.
    pub step: Step,
}

/// The procedures of a capture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steps {
    /// All steps, in the order of the frames.
    pub all: Vec<At>,
    /// What was begun and not ended: the frame that began it, and the warning.
    pub open: Vec<(u32, String)>,
}

impl Steps {
    /// Follows the sound frames of a session.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let mut procedures = Procedures::new();
        let mut all = Vec::new();
        let end = session.len().min(session.first().saturating_add(MOST));
        for frame in session.first()..end {
            let sound = session
                .frame(frame)
                .is_some_and(|f| !f.is_noise() && !f.marks.is_damaged());
            let Some(bytes) = session.bytes(frame).filter(|_| sound) else {
                continue;
            };
            if let Some(step) = procedures.frame(session.framing(), bytes, frame) {
                all.push(At { frame, step });
            }
        }
        let open = procedures.open().into_iter();
        Self {
            all,
            open: open.map(|o| (o.since, o.to_string())).collect(),
        }
    }

    /// The runs in the order in which they began, each with its steps.
    #[must_use]
    pub fn runs(&self) -> Vec<(u32, Vec<&At>)> {
        let mut runs: Vec<(u32, Vec<&At>)> = Vec::new();
        for at in &self.all {
            match runs.iter_mut().find(|(run, _)| *run == at.step.run) {
                Some((_, steps)) => steps.push(at),
                None => runs.push((at.step.run, vec![at])),
            }
        }
        runs
    }

    /// True if something in it deserves a look.
    #[must_use]
    pub fn warns(&self) -> bool {
        let doubts = self.all.iter().flat_map(|a| &a.step.doubts);
        !self.open.is_empty()
            || doubts
                .into_iter()
                .any(|d| d.severity() >= Severity::Warning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;

    /// Command 40 fixes 4 mA and the device agrees; the list ends before it is left.
    #[test]
    fn what_was_not_ended_is_said() {
        let text = "FF FF 82 AE DD 01 23 45 28 04 40 80 00 00 7A\n\
                    FF FF 86 AE DD 01 23 45 28 06 00 08 40 80 00 00 74";
        let steps = Steps::of(&load(text.as_bytes(), None).session);
        assert_eq!(steps.all.len(), 2);
        assert_eq!(steps.runs().len(), 1);
        assert_eq!(steps.open.len(), 1);
        assert!(steps.warns());
        assert_eq!(Steps::of(&load(b"", None).session), Steps::default());
    }
}
