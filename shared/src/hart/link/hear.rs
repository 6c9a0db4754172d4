//! What was heard: whose turn it is now, and whether it answers us.

use super::ear::{Frame, Heard};
use super::{Answer, Event, Failure, Job, Link, Phase, Turn};
use crate::capture::Micros;
use crate::hart::frame::Type;

impl Link {
    pub(super) fn consider(&mut self, heard: Heard, now: Micros) {
        match heard {
            // Carriers that come and go leave a byte or two; these decide nothing.
            Heard::Noise => self.stats.noise = self.stats.noise.saturating_add(1),
            Heard::Damaged { began } => {
                self.stats.damaged = self.stats.damaged.saturating_add(1);
                self.tell(Event::Damaged);
                let ours = self.job.as_ref().is_some_and(|j| began >= j.began);
                self.turn = Turn::Unknown;
                if ours && matches!(self.phase, Phase::Waiting { .. }) {
                    self.missed(Failure::Damaged, now);
                }
            }
            Heard::Frame(frame) => self.frame(frame, now),
        }
    }

    fn frame(&mut self, frame: Frame, now: Micros) {
        let ours = frame.head.primary == self.setup.primary;
        if !ours && frame.head.delimiter.kind() != Type::Back {
            self.other = Some(now);
        }
        match frame.head.delimiter.kind() {
            Type::Stx if ours && self.is_echo(&frame) => {
                self.stats.echoes = self.stats.echoes.saturating_add(1);
                return;
            }
            Type::Stx => {
                self.turn = Turn::Request;
                self.stats.overheard = self.stats.overheard.saturating_add(1);
                if ours {
                    self.tell(Event::Twin);
                }
            }
            Type::Ack if ours => return self.answer(frame, now),
            Type::Ack => {
                self.turn = if self.hears_bursts(now) {
                    Turn::Unknown
                } else {
                    Turn::Ours(frame.ended)
                };
                self.stats.overheard = self.stats.overheard.saturating_add(1);
            }
            Type::Back => {
                self.burst = Some(now);
                self.stats.bursts = self.stats.bursts.saturating_add(1);
                self.turn = if ours {
                    Turn::Unknown
                } else {
                    Turn::Ours(frame.ended)
                };
            }
        }
        self.tell(Event::Overheard(frame.bytes));
        // Whoever else speaks now, our device does not.
        if matches!(self.phase, Phase::Waiting { .. }) {
            self.stats.silent = self.stats.silent.saturating_add(1);
            self.missed(Failure::Silence, now);
        }
    }

    /// True if this is what we sent ourselves.
    fn is_echo(&self, frame: &Frame) -> bool {
        let sent = |job: &Job| {
            let under_way = !matches!(self.phase, Phase::Watching) && frame.began >= job.began;
            under_way && frame.bytes == job.request.frame(self.setup.primary)
        };
        self.job.as_ref().is_some_and(sent)
    }

    /// A reply to us.
    fn answer(&mut self, frame: Frame, now: Micros) {
        self.turn = Turn::Yield;
        self.active = self.active.max(frame.ended);
        let fits = |job: &&Job| {
            job.tries > 0
                && frame.began >= job.began
                && job
                    .request
                    .fits(&frame.head, &frame.bytes, self.setup.primary)
        };
        let known = self.job.as_ref().filter(fits).is_some();
        let Some(answer) = Answer::of(&frame.bytes).filter(|_| known) else {
            self.stats.strays = self.stats.strays.saturating_add(1);
            self.tell(Event::Stray(frame.bytes));
            return;
        };
        match answer.communication_error() {
            None => {
                self.stats.answered = self.stats.answered.saturating_add(1);
                self.finish(Ok(answer), now);
            }
            Some(errors) => {
                self.stats.refused = self.stats.refused.saturating_add(1);
                self.missed(Failure::Communication(errors), now);
            }
        }
    }
}
