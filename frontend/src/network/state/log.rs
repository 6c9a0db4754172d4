//! What was found on a network lately: what breaks and heals between two looks at the page leaves a
//! trace here. The page keeps it while the network is shown.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use shared::ddc100::diagnosis::{Diagnosis, Finding};
use shared::ddc100::scaling::Scaling;
use shared::ddc100::view::View;
use shared::ddc100::words::register;
use shared::device::Device;
use shared::image::Image;
use shared::map::row::Row;
use shared::proto::LineState;

use super::table::quoted;
use super::unit::{REPORTS, place};

/// Events that are kept; the oldest go first.
pub const MOST: usize = 200;
/// The same happening to several units within this time is one event.
const TOGETHER_MS: u64 = 60_000;

/// Something that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// When it was found first, in milliseconds since 1970.
    pub at_ms: u64,
    /// The units that it is about; none if it is about the network.
    units: Vec<u8>,
    /// What it is.
    says: String,
}

impl Event {
    /// In words: `unit 3: no answer on port 1`.
    #[must_use]
    pub fn text(&self) -> String {
        let list: Vec<String> = self.units.iter().map(u8::to_string).collect();
        match list.as_slice() {
            [] => self.says.clone(),
            [one] => format!("unit {one}: {}", self.says),
            [before @ .., last] => {
                format!("units {} and {last}: {}", before.join(", "), self.says)
            }
        }
    }
}

/// The events, and what must be known to tell a new one.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// Now, in milliseconds since 1970; whoever hears the news sets it.
    pub now_ms: u64,
    /// The newest first.
    pub events: VecDeque<Event>,
    silent: BTreeSet<(u8, usize)>,
    down: BTreeSet<u8>,
    found: Vec<String>,
    words: BTreeMap<u8, [Option<u16>; 4]>,
    /// Fault bits that are set, by unit, and whether they are mere reports.
    set: BTreeMap<(u8, String), bool>,
    offline: bool,
}

impl Log {
    fn push(&mut self, units: &[u8], says: String) {
        let now = self.now_ms;
        let joins = |e: &&mut Event| {
            e.says == says && !e.units.is_empty() && now.saturating_sub(e.at_ms) <= TOGETHER_MS
        };
        if let [unit] = units
            && let Some(event) = self.events.iter_mut().take(4).find(joins)
            && !event.units.contains(unit)
        {
            event.units.push(*unit);
            return;
        }
        self.events.push_front(Event {
            at_ms: now,
            units: units.to_vec(),
            says,
        });
        self.events.truncate(MOST);
    }

    /// Whether the ports reach a unit.
    pub(super) fn reach(&mut self, unit: u8, faults: [Option<bool>; 2]) {
        for (port, fault) in (1..).zip(faults) {
            match fault {
                Some(true) if self.silent.insert((unit, port)) => {
                    self.push(&[unit], format!("no answer on port {port}"));
                }
                Some(false) if self.silent.remove(&(unit, port)) => {
                    self.push(&[unit], format!("answers on port {port} again"));
                }
                _ => {}
            }
        }
    }

    /// The state of a host port.
    pub(super) fn port(&mut self, port: u8, state: LineState, text: &str) {
        match state {
            LineState::Down if self.down.insert(port) => {
                self.push(&[], format!("Host port {port} is lost: {text}"));
            }
            LineState::Up if self.down.remove(&port) => {
                self.push(&[], format!("Host port {port} is back."));
            }
            _ => {}
        }
    }

    /// What the pattern of faults means, once every poll bears it out.
    pub(super) fn findings(&mut self, diagnosis: &Diagnosis) {
        // That a port is lost was told when it was.
        let told = |f: &&Finding| {
            !matches!(
                f,
                Finding::NoFault | Finding::Untried(_) | Finding::PortDown(_)
            )
        };
        let all = diagnosis.findings.iter().filter(told);
        let now: Vec<String> = all.map(Finding::to_string).collect();
        let before = core::mem::replace(&mut self.found, now.clone());
        for gone in before.iter().filter(|text| !now.contains(text)) {
            let short = gone.split([':', ';']).next().unwrap_or(gone);
            let short = short.trim_end_matches('.');
            self.push(&[], format!("No longer: {short}."));
        }
        for text in now {
            if !before.contains(&text) {
                self.push(&[], text);
            }
        }
    }

    /// The fault bits of a unit, after some of its registers were read.
    pub(super) fn bits(&mut self, unit: u8, kind: Device, image: &Image) {
        let words = [9, 10, 14, 15].map(|number| register(image, number).map(|cell| cell.word));
        if self.words.insert(unit, words) == Some(words) {
            return;
        }
        let view = View::of(kind, image, |_: &Row| Scaling::default());
        let now: Vec<(String, bool)> = view
            .faults
            .iter()
            .map(|bit| {
                let text = format!("{} ({})", bit.member.label, place(bit));
                (text, REPORTS.contains(&bit.member.key))
            })
            .collect();
        for (text, report) in &now {
            if self.set.insert((unit, text.clone()), *report).is_none() {
                self.push(&[unit], text.clone());
            }
        }
        let of_unit = self.set.keys().filter(|(of, _)| *of == unit);
        let ended = of_unit.filter(|(_, text)| !now.iter().any(|(n, _)| n == text));
        let ended: Vec<_> = ended.cloned().collect();
        for key in ended {
            // A report ends with the next poll; that is no news.
            if self.set.remove(&key) == Some(false) {
                self.push(&[unit], format!("no longer: {}", key.1));
            }
        }
    }

    /// The connection to the backend is lost: nothing is heard until it is back.
    pub(super) fn lost(&mut self) {
        if !core::mem::replace(&mut self.offline, true) {
            let text = "The connection to the bridge is lost: what happens now is not seen here.";
            self.push(&[], text.to_owned());
        }
    }

    /// The network is told of anew.
    pub(super) fn connected(&mut self) {
        if core::mem::take(&mut self.offline) {
            self.push(&[], "The connection to the bridge is back.".to_owned());
        }
    }

    /// All events as text for spreadsheets, the newest first. `time` writes a moment, `named` puts
    /// tags to units.
    #[must_use]
    pub fn as_text(
        &self,
        time: &dyn Fn(u64) -> String,
        named: &dyn Fn(&str) -> String,
        comma: char,
    ) -> String {
        let mut out = format!("time{comma}found\n");
        for event in &self.events {
            quoted(&mut out, &time(event.at_ms), comma);
            out.push(comma);
            quoted(&mut out, &named(&event.text()), comma);
            out.push('\n');
        }
        out
    }
}

#[cfg(test)]
mod tests;
