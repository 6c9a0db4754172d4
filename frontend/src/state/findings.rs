//! The problems of all frames of a capture, collected in steps.

use shared::decode::Context;
use shared::problem::{Problem, Severity};
use shared::session::Session;
use shared::tree::Decoded;

/// Problems listed at most; the counts go on.
const MOST: usize = 2000;

/// Longest run of noise that is decoded as a whole; its problem is known anyway.
pub const CLIP: usize = 4096;

/// One problem with its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Index of the frame.
    pub frame: u32,
    /// What is wrong.
    pub problem: Problem,
}

/// What was found so far.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    next: u32,
    scratch: Decoded,
    /// Errors and warnings, in order, at most [`MOST`].
    pub items: Vec<Item>,
    /// Notes, kept apart: they are many and nothing is wrong.
    pub notes: Vec<Item>,
    /// How many of each severity: notes, warnings, errors.
    pub counts: [u32; 3],
}

impl Findings {
    /// Looks at up to `budget` more entries. True when all were looked at.
    pub fn step(&mut self, session: &Session, context: &Context, budget: u32) -> bool {
        let end = session.len().min(self.next.saturating_add(budget));
        while self.next < end {
            let index = self.next;
            self.next += 1;
            if !decode_clipped(session, index, context, &mut self.scratch) {
                continue;
            }
            for problem in self.scratch.problems() {
                let (list, slot) = match problem.severity() {
                    Severity::Note => (&mut self.notes, 0),
                    Severity::Warning => (&mut self.items, 1),
                    Severity::Error => (&mut self.items, 2),
                };
                self.counts[slot] = self.counts[slot].saturating_add(1);
                if list.len() < MOST {
                    list.push(Item {
                        frame: index,
                        problem: *problem,
                    });
                }
            }
        }
        self.next >= session.len()
    }

    /// How far it is, in parts of 1.
    #[must_use]
    pub fn progress(&self, session: &Session) -> f64 {
        f64::from(self.next) / f64::from(session.len().max(1))
    }

    /// Number of errors and warnings.
    #[must_use]
    pub const fn serious(&self) -> u32 {
        self.counts[1].saturating_add(self.counts[2])
    }
}

/// Decodes an entry; of a long run of noise only the beginning.
pub fn decode_clipped(session: &Session, index: u32, context: &Context, out: &mut Decoded) -> bool {
    let Some(frame) = session.frame(index) else {
        return false;
    };
    match session.bytes(index) {
        Some(bytes) if bytes.len() > CLIP => {
            let clipped = bytes.get(..CLIP).unwrap_or(bytes);
            shared::decode::decode_into(frame, clipped, None, context, out);
            true
        }
        _ => session.decode(index, context, out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use shared::encode::frame;
    use shared::frame::Framing;

    #[test]
    fn problems_are_counted_and_capped() {
        // Unit 250 is reserved: a warning each.
        let one = frame(Framing::Rtu, 0, 250, &[3, 0, 0, 0, 1]);
        let loaded = load(&one.repeat(3000), Some(Framing::Rtu));
        let context = Context::default();
        let mut findings = Findings::default();
        let mut steps = 0;
        while !findings.step(&loaded.session, &context, 700) {
            steps += 1;
        }
        assert!(steps >= 4, "{steps}");
        assert!(findings.counts[1] >= 3000, "{:?}", findings.counts);
        assert_eq!(findings.items.len(), MOST);
        assert!((findings.progress(&loaded.session) - 1.0).abs() < 1e-9);
    }
}
