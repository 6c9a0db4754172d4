//! What is said about a network: to every page on the board, and to those that follow it.

use super::{Actor, STALE};
use crate::bus::words;
use shared::capture::Micros;
use shared::ddc100::poller::Pass;
use shared::proto::{DdcNews, LineState, Outcome, ToPage};
use std::time::Duration;
use tokio::time::Instant;

impl Actor {
    /// Posts how a unit is: as its poll went, or as it is as a whole if only one port failed.
    pub(super) fn judge(&mut self, at: usize, outcome: Outcome, text: String) {
        let good = matches!(outcome, Outcome::Ok | Outcome::Exception);
        let Some(unit) = self.units.get(at) else {
            return;
        };
        if !good && !unit.is_off(self.poller.faults()) {
            // The other port reaches it, or is still to be tried.
            return;
        }
        let (outcome, text) = match &unit.trouble {
            Some(trouble) if outcome == Outcome::Ok => trouble.clone(),
            _ if outcome == Outcome::Ok => {
                let took = unit.latency_us.unwrap_or(0);
                (outcome, words::good(Duration::from_micros(took)))
            }
            _ => (outcome, text),
        };
        self.state(at, outcome, text);
    }

    /// Posts the state of a unit, if it is new or was not posted for a while.
    pub(super) fn state(&mut self, at: usize, outcome: Outcome, text: String) {
        let now = Instant::now();
        let Some(unit) = self.units.get_mut(at) else {
            return;
        };
        let same = unit
            .posted
            .is_some_and(|(before, when)| before == outcome && now < when + STALE);
        if same {
            return;
        }
        unit.posted = Some((outcome, now));
        let message = ToPage::Device {
            tag: unit.tag.clone(),
            outcome,
            text,
            last_ok_us: unit.last_ok.map(Micros::get),
            latency_us: unit.latency_us,
        };
        self.board.post(unit.slot, &message);
    }

    /// Tells pages of a unit.
    pub(super) fn tell_unit(&self, at: usize) {
        let unit = self.units.get(at);
        if let Some(news) = unit.and_then(|u| u.news(&self.name, self.poller.faults())) {
            self.desk.say(news, at);
        }
    }

    /// Tells pages of all units, because a port came or went; and those without any port.
    pub(super) fn tell_all(&mut self) {
        for at in 0..self.units.len() {
            self.tell_unit(at);
        }
        if self.ports.iter().any(|p| p.state != LineState::Down) {
            return;
        }
        let text = self.ports.first().map(|p| p.text.clone());
        for at in 0..self.units.len() {
            self.state(at, Outcome::Down, text.clone().unwrap_or_default());
        }
    }

    pub(super) fn tell_pass(&self, pass: Pass) {
        let news = DdcNews::Pass {
            bus: self.name.clone(),
            port: pass.port.number(),
            number: pass.number,
            took_us: pass.took_us,
            expected_us: pass.expected_us,
        };
        self.desk.say(news, 0);
    }

    /// Tells everybody how a port is, and how the network is as a whole.
    pub(super) fn tell_port(&self, at: usize) {
        let Some(port) = self.ports.get(at) else {
            return;
        };
        let news = DdcNews::Port {
            bus: self.name.clone(),
            port: port.number.number(),
            state: port.state,
            text: port.text.clone(),
        };
        self.desk.say(news, 0);
        let since_us = self.clock.now().get();
        if let Some(slot) = port.slot {
            let message = ToPage::Line {
                bus: port.bus.name.clone(),
                state: port.state,
                text: port.text.clone(),
                since_us,
            };
            self.board.post(slot, &message);
        }
        let (state, text) = self.whole();
        let message = ToPage::Line {
            bus: self.name.clone(),
            state,
            text,
            since_us,
        };
        self.board.post(self.slot, &message);
    }

    /// State of the network: it is up as long as one port is.
    pub(super) fn whole(&self) -> (LineState, String) {
        let of = |state| self.ports.iter().any(|p| p.state == state);
        let state = if of(LineState::Up) {
            LineState::Up
        } else if of(LineState::Starting) {
            LineState::Starting
        } else {
            LineState::Down
        };
        let single = self.ports.len() == 1;
        let texts: Vec<String> = self
            .ports
            .iter()
            .filter(|p| single || state != LineState::Up || p.state != LineState::Up)
            .map(|p| match single {
                true => p.text.clone(),
                false => format!("port {}: {}", p.number.number(), p.text),
            })
            .collect();
        match texts.is_empty() {
            true => (state, "open".into()),
            false => (state, texts.join("; ")),
        }
    }
}
