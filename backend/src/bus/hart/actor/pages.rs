//! What pages want of a HART line, and what they are told of it.

use super::super::job::{Ask, Job, Kind};
use super::super::open::Line;
use super::super::{Wish, gate};
use super::{Actor, MAX_JOBS, TELL};
use crate::bus::{Command, Report};
use shared::hart::link::{Scan, Target};
use shared::proto::{HartAsk, HartCommand, MIN_PERIOD_MS, Outcome};
use std::time::Duration;
use tokio::time::Instant;

impl Actor {
    /// Does what it is told, or notes it.
    pub(super) fn obey(&mut self, command: Command) {
        match command {
            Command::Hart(wish) => self.wish(wish),
            Command::Leave { client } => {
                self.units.iter_mut().for_each(|u| u.leave(client));
                self.listeners.retain(|(c, ..)| *c != client);
                let theirs = |j: &&mut Job| j.client == client;
                self.jobs.iter_mut().filter(theirs).for_each(Job::cancel);
            }
            Command::Read { reply, .. } => {
                let text = "HART devices have no registers".to_owned();
                reply(Report::failed(Outcome::Refused, text));
            }
            // What other lines have.
            _ => {}
        }
    }

    fn wish(&mut self, wish: Wish) {
        let Wish {
            client,
            device,
            ask,
            out,
        } = wish;
        let (id, kind) = match ask {
            HartAsk::Cancel { id } => {
                let mine = |j: &&mut Job| j.is(client, id);
                self.jobs.iter_mut().filter(mine).for_each(Job::cancel);
                return;
            }
            HartAsk::Link { .. } => {
                self.listeners.retain(|(c, ..)| *c != client);
                self.listeners.push((client, out, None));
                return;
            }
            HartAsk::Watch {
                commands,
                period_ms,
                ..
            } => {
                if let Some(unit) = device.and_then(|at| self.units.get_mut(at)) {
                    let asks = commands.iter().filter_map(asked).collect();
                    let period = Duration::from_millis(period_ms.max(MIN_PERIOD_MS).into());
                    unit.watch(client, asks, period, out, Instant::now());
                }
                return;
            }
            HartAsk::Read { id, commands, .. } => {
                let asks = commands.iter().filter_map(asked).collect();
                (id, Kind::Read(device.unwrap_or(usize::MAX), asks))
            }
            HartAsk::Scan {
                id, first, last, ..
            } => (id, Kind::Scan(Box::new(Scan::new(first, last)))),
            HartAsk::Find { id, tag, long, .. } => {
                let target = if long {
                    Target::long_tag(&tag)
                } else {
                    Target::tag(&tag)
                };
                (id, Kind::Find(target))
            }
        };
        let mut job = Job::new(client, id, out, kind);
        if self.jobs.len() >= MAX_JOBS {
            job.down("too much is waiting for this line; try again later");
            return;
        }
        self.jobs.push_back(job);
    }

    /// Tells pages of the line what is new; says when there is something to tell later.
    pub(super) fn tell(&mut self, line: &Line) -> Option<Instant> {
        if self.listeners.is_empty() {
            return None;
        }
        let now = Instant::now();
        let fresh = self.listeners.iter().any(|(_, _, known)| known.is_none());
        if !fresh && now < self.told + TELL {
            return Some(self.told + TELL);
        }
        self.told = now;
        let news = line.news(&self.bus.name, self.clock.now());
        for (_, out, known) in &mut self.listeners {
            if known.as_ref() != Some(&news) && out.has_room() {
                out.send(news.clone());
                *known = Some(news.clone());
            }
        }
        None
    }
}

/// A command that may be sent, with its data.
fn asked(command: &HartCommand) -> Option<Ask> {
    gate::command(command).ok().map(|data| Ask {
        number: command.number,
        data,
    })
}
