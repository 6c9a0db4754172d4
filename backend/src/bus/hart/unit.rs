//! One HART device on a line, as its actor knows it: how it is found, and who watches what.

use super::super::{ClientId, Outlet};
use super::job::Ask;
use shared::capture::Micros;
use shared::hart::link::Device;
use shared::proto::{HartNews, Outcome};
use std::collections::VecDeque;
use std::time::Duration;
use tokio::time::Instant;

/// A device that does not answer is tried again after this time, then twice that, and so on.
const HOLD: Duration = Duration::from_secs(2);
/// But at least this often.
const LONGEST_HOLD: Duration = Duration::from_secs(30);

/// What a page watches.
#[derive(Debug)]
pub struct Watch {
    client: ClientId,
    asks: Vec<Ask>,
    period: Duration,
    out: Outlet,
    /// The next command of the round.
    at: usize,
    /// When the next round begins.
    due: Instant,
    began: Instant,
    /// News that the page had no room for; of each command only the newest.
    waiting: VecDeque<(Ask, HartNews)>,
}

/// One device.
#[derive(Debug)]
pub struct Unit {
    /// Its tag in the configuration.
    pub tag: String,
    /// Where its state is posted.
    pub slot: usize,
    /// How it is found, and who it is.
    pub device: Device,
    watches: Vec<Watch>,
    /// The watch that was served last.
    turn: usize,
    /// Not asked for watches before this moment, because it does not answer.
    hold: Option<Instant>,
    silences: u32,
    /// How the last command ended.
    pub outcome: Option<Outcome>,
    /// When its state was posted last.
    pub posted: Option<Instant>,
    /// When it last answered.
    pub last_ok: Option<Micros>,
    /// How long that took, in microseconds.
    pub latency_us: Option<u64>,
}

impl Unit {
    /// A device of which nothing is known.
    #[must_use]
    pub fn new(tag: String, slot: usize, device: Device) -> Self {
        Self {
            tag,
            slot,
            device,
            watches: Vec::new(),
            turn: 0,
            hold: None,
            silences: 0,
            outcome: None,
            posted: None,
            last_ok: None,
            latency_us: None,
        }
    }

    /// Replaces what a client watches.
    pub fn watch(
        &mut self,
        client: ClientId,
        asks: Vec<Ask>,
        period: Duration,
        out: Outlet,
        now: Instant,
    ) {
        self.leave(client);
        if asks.is_empty() {
            return;
        }
        self.watches.push(Watch {
            client,
            asks,
            period,
            out,
            at: 0,
            due: now,
            began: now,
            waiting: VecDeque::new(),
        });
        // Somebody looks: then it is tried at once.
        self.hold = None;
    }

    /// A client is gone.
    pub fn leave(&mut self, client: ClientId) {
        self.watches.retain(|w| w.client != client);
    }

    /// True if somebody watches it.
    #[must_use]
    pub const fn is_watched(&self) -> bool {
        !self.watches.is_empty()
    }

    /// When the next command of a watch is due.
    #[must_use]
    pub fn due(&self) -> Option<Instant> {
        let due = self.watches.iter().map(|w| w.due).min()?;
        Some(self.hold.map_or(due, |hold| hold.max(due)))
    }

    /// The next command of a watch that is due. Two pages that watch the same command are served
    /// by one exchange.
    #[must_use]
    pub fn next(&mut self, now: Instant) -> Option<Ask> {
        let count = self.watches.len();
        let at = (1..=count)
            .map(|step| (self.turn + step) % count)
            .find(|at| self.watches.get(*at).is_some_and(|w| w.due <= now))?;
        self.turn = at;
        let watch = self.watches.get(at)?;
        watch.asks.get(watch.at).cloned()
    }

    /// A command was done: all whose turn it was with it get the news.
    pub fn done(&mut self, ask: &Ask, news: &HartNews, now: Instant) {
        for watch in &mut self.watches {
            // The same command may come more than once in a round.
            if watch.due > now || watch.asks.get(watch.at) != Some(ask) {
                continue;
            }
            watch.tell(ask, news.clone());
            watch.step(now);
        }
    }

    /// Nothing of a round can be had: the next one begins later.
    pub fn skip(&mut self, now: Instant) {
        for watch in &mut self.watches {
            if watch.due <= now {
                watch.at = 0;
                watch.due = now + watch.period;
                watch.began = watch.due;
            }
        }
    }

    /// Gives pages what waits for them; something if more still does.
    pub fn flush(&mut self) -> Option<()> {
        let more = self.watches.iter_mut().filter_map(Watch::flush).count();
        (more > 0).then_some(())
    }

    /// Notes how a command ended.
    pub fn ended(&mut self, outcome: Outcome, now: Instant) {
        if outcome == Outcome::Silence {
            let wait = HOLD.saturating_mul(1 << self.silences.min(8));
            self.hold = Some(now + wait.min(LONGEST_HOLD));
            self.silences = self.silences.saturating_add(1);
            // Another device may stand there by now.
            self.device.forget();
        } else {
            self.hold = None;
            self.silences = 0;
        }
    }

    /// The line was opened anew.
    pub fn reset(&mut self) {
        self.device.forget();
        self.hold = None;
        self.silences = 0;
    }
}

impl Watch {
    fn tell(&mut self, ask: &Ask, news: HartNews) {
        self.waiting.retain(|(a, _)| a != ask);
        self.waiting.push_back((ask.clone(), news));
        self.flush();
    }

    /// Gives the page what it has room for; something if more waits.
    fn flush(&mut self) -> Option<()> {
        while self.out.has_room()
            && let Some((_, news)) = self.waiting.pop_front()
        {
            self.out.send(news);
        }
        (!self.waiting.is_empty()).then_some(())
    }

    /// On to the next command; behind the last one the round is over.
    fn step(&mut self, now: Instant) {
        self.at += 1;
        if self.at < self.asks.len() {
            return;
        }
        self.at = 0;
        // A round that took longer than its period is followed by the next at once.
        self.due = (self.began + self.period).max(now);
        self.began = self.due;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::hart::link::Target;
    use tokio::sync::mpsc;

    /// Dynamic variables twice, then status: each in its turn, and round again.
    #[tokio::test(start_paused = true)]
    async fn a_round_may_ask_the_same_again() {
        let ask = |number| Ask {
            number,
            data: Vec::new(),
        };
        let news = |command| HartNews::Exchange {
            id: None,
            device: "FV-1".into(),
            command,
            request: String::new(),
            response: String::new(),
            outcome: Outcome::Ok,
            text: String::new(),
            at_us: 0,
            took_us: 0,
            tries: 1,
        };
        let (sender, _heard) = mpsc::channel(Outlet::SIZE);
        let mut unit = Unit::new("FV-1".into(), 0, Device::new(Target::Polling(0)));
        let round = vec![ask(3), ask(3), ask(48)];
        let (period, now) = (Duration::from_secs(1), Instant::now());
        unit.watch(ClientId(1), round, period, Outlet::new(sender), now);
        let mut asked = Vec::new();
        for _ in 0..3 {
            let ask = unit.next(now).unwrap();
            asked.push(ask.number);
            unit.done(&ask, &news(ask.number), now);
        }
        assert_eq!(asked, [3, 3, 48]);
        assert!(unit.next(now).is_none(), "the round is over");
        assert_eq!(unit.next(now + period).unwrap().number, 3);
    }
}
