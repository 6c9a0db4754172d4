//! Days of simulated polling with random troubles: a certain finding is never wrong, an ambiguous
//! one names what happened, and whatever lasts is found.
//!
//! So are those of a page that follows by news of which it gets the newest only, now and then.
//!
//! The truth comes from what was injected, not from the diagnosis' own picture of the cable.

use shared::capture::Micros;
use shared::ddc100::follow::Follower;
use shared::ddc100::setup::Member;
use shared::ddc100::{Diagnosis, End, Finding, HostPort, Setup, diagnose};
use shared::device::Device;
use shared::proto::{DdcNews, DdcShape};
use shared::sim::ddc100::{Trouble, UnitTrouble};
use std::collections::BTreeMap;
use tests::ddc100::{Bench, pass_news, registers, unit_news};

const MINUTE: u64 = 60_000_000;

/// Numbers that look random and are the same each time.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, below: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % below
    }
}

/// What was wrong with the cable from some time on.
#[derive(Clone)]
struct Truth {
    from: Micros,
    troubles: Vec<Trouble>,
    /// A short anywhere silences all (section 4.2.3).
    multi_drop: bool,
}

impl Truth {
    /// True if the cable is cut at this place, or at an end the port behind it is dead.
    fn is_cut(&self, place: usize, units: usize) -> bool {
        self.troubles.iter().any(|t| match *t {
            Trouble::Short(_) if self.multi_drop => place == 0,
            Trouble::Break(at) | Trouble::Short(at) => at == place,
            Trouble::Port(HostPort::One) => place == 0,
            Trouble::Port(HostPort::Two) => place == units,
            Trouble::Unit(..) => false,
        })
    }

    /// True if every unit could be reached by all ports: none off or deaf, and no cut up to the last
    /// unit, nor behind it if a port is there.
    fn is_whole(&self, shape: DdcShape, units: usize) -> bool {
        let places = match shape {
            DdcShape::Loop => units + 1,
            _ => units,
        };
        let silent = |t: &Trouble| matches!(t, Trouble::Unit(..));
        !self.troubles.iter().any(silent) && !(0..places).any(|p| self.is_cut(p, units))
    }
}

/// What a page gets: the newest of each unit and of the passes, when it comes to it.
struct Page {
    follower: Follower,
    /// News that wait, by their place: that of a unit, or 0 for passes; with their number.
    waiting: BTreeMap<u8, (u64, DdcNews)>,
    posted: u64,
    /// It looks once in so many polls.
    slow: u64,
}

impl Page {
    fn post(&mut self, place: u8, news: DdcNews) {
        self.posted += 1;
        self.waiting.insert(place, (self.posted, news));
    }

    /// Takes in all that waits, in the order in which it was posted.
    fn look(&mut self) {
        let mut all: Vec<_> = std::mem::take(&mut self.waiting).into_values().collect();
        all.sort_by_key(|(number, _)| *number);
        all.iter().for_each(|(_, news)| self.follower.hear(news));
    }
}

struct Soak {
    bench: Bench,
    shape: DdcShape,
    units: usize,
    dice: Dice,
    history: Vec<Truth>,
    /// For each unit when a poll last found it deaf, and when it last found it listening.
    deaf: Vec<Option<Micros>>,
    heard: Vec<Option<Micros>>,
    passes: Vec<Micros>,
    /// For each unit whether it could be reached through each port at its last poll, and after how
    /// many passes that changed.
    reach: Vec<[Option<bool>; 2]>,
    turns: Vec<Vec<usize>>,
    page: Page,
    count: Count,
}

#[derive(Debug, Default)]
struct Count {
    polls: u64,
    troubles: u64,
    judged: u64,
    certain: u64,
    ambiguous: u64,
    preliminary: u64,
    /// Looks of the page, and what was certain then.
    looks: u64,
    certain_there: u64,
}

/// Passes that a diagnosis may look back at: two on each port to see a change, and two to bear it
/// out.
const WINDOW: usize = 5;

impl Soak {
    fn new(shape: DdcShape, units: u8, seed: u64) -> Self {
        let kinds = [
            Device::Ddc100Mx,
            Device::Ddc100Uec,
            Device::Ddc100Clamshell,
            Device::Ddc100Io,
        ];
        let members = (1..=units).map(|unit| Member {
            unit,
            kind: kinds[usize::from(unit) % 4],
        });
        let second = shape == DdcShape::Loop;
        let setup = Setup::new(shape, second, members.collect(), registers(8, 9));
        let page = Page {
            follower: Follower::new(1..=units, second),
            waiting: BTreeMap::new(),
            posted: 0,
            slow: 1,
        };
        let units = usize::from(units);
        Self {
            bench: Bench::new(setup),
            shape,
            units,
            dice: Dice(seed),
            history: vec![Truth {
                from: Micros::new(0),
                troubles: vec![],
                multi_drop: shape == DdcShape::MultiDrop,
            }],
            deaf: vec![None; units],
            heard: vec![None; units],
            passes: vec![Micros::new(0)],
            reach: vec![[None; 2]; units],
            turns: vec![Vec::new(); units],
            page,
            count: Count::default(),
        }
    }

    /// Something breaks or is mended.
    fn event(&mut self) {
        let now = self.bench.now;
        let there = self.bench.network.troubles().to_vec();
        let heal = there.len() >= 4 || (!there.is_empty() && self.dice.roll(2) == 0);
        if heal {
            let which = self.dice.roll(there.len() as u64) as usize;
            assert!(self.bench.network.heal(there[which]));
        } else {
            let place = self.dice.roll(self.units as u64 + 1) as usize;
            let unit = self.dice.roll(self.units as u64) as u8 + 1;
            let trouble = match self.dice.roll(8) {
                0 | 1 => Trouble::Break(place),
                2 => Trouble::Short(place),
                3 => Trouble::Port(HostPort::One),
                4 => Trouble::Port(HostPort::Two),
                5 => Trouble::Unit(unit, UnitTrouble::Deaf),
                _ => Trouble::Unit(unit, UnitTrouble::Off),
            };
            self.count.troubles += u64::from(self.bench.network.inject(trouble));
        }
        // A page may be in the background, or its line slow.
        let units = self.units as u64;
        let paces = [1, 4, units, 3 * units];
        self.page.slow = paces[self.dice.roll(4) as usize].max(1);
        self.history.push(Truth {
            from: now,
            troubles: self.bench.network.troubles().to_vec(),
            multi_drop: self.shape == DdcShape::MultiDrop,
        });
    }

    /// Polls for so long.
    fn run(&mut self, hours: u64) {
        let end = self.bench.now.plus(hours * 60 * MINUTE);
        let mut next = self.bench.now.plus(10 * MINUTE);
        while self.bench.now < end {
            if self.bench.now >= next {
                self.event();
                // Mostly minutes, now and then seconds: faults that come and go while a pass runs.
                let wait = match self.dice.roll(4) {
                    0 => self.dice.roll(MINUTE),
                    _ => self.dice.roll(40 * MINUTE),
                };
                next = self.bench.now.plus(wait);
            }
            let before = self.bench.log.len();
            let pass = self.bench.step();
            if self.bench.log.len() > before {
                let (unit, port, _) = self.bench.log[before];
                self.count.polls += 1;
                let at = usize::from(unit) - 1;
                self.turn(at);
                let faults = self.bench.poller.faults();
                self.page.post(unit, unit_news(faults, unit, port));
                let listens = self.bench.network.listens(unit);
                let seen = if listens {
                    &mut self.heard
                } else {
                    &mut self.deaf
                };
                seen[at] = Some(self.bench.now);
                if self.bench.log.len() > 10_000 {
                    self.bench.log.clear();
                }
            }
            if let Some(pass) = pass {
                self.passes.push(self.bench.now);
                self.page.post(0, pass_news(pass));
            }
            if self.dice.roll(self.page.slow) == 0 {
                self.page.look();
                self.judge_page();
            }
            if pass.is_some() || self.dice.roll(50) == 0 {
                self.judge();
            }
        }
    }

    /// Notes if the reach of a unit is another than at its last poll.
    fn turn(&mut self, at: usize) {
        let truth = self.history.last().expect("the beginning");
        let listens = self.bench.network.listens(at as u8 + 1);
        let clear =
            |mut places: std::ops::Range<usize>| !places.any(|p| truth.is_cut(p, self.units));
        let now = [clear(0..at + 1), clear(at + 1..self.units + 1)].map(|c| Some(c && listens));
        let before = std::mem::replace(&mut self.reach[at], now);
        let turned = before
            .iter()
            .zip(now)
            .filter(|(b, n)| b.is_some() && **b != *n);
        let pass = self.passes.len();
        self.turns[at].extend(turned.map(|_| pass));
    }

    /// The beginning of the last passes, and what was wrong since then.
    fn window(&self) -> (Micros, Vec<&Truth>) {
        let window = self.passes[self.passes.len().saturating_sub(WINDOW + 1)];
        let later = self
            .history
            .iter()
            .rev()
            .take_while(|t| t.from > window)
            .count();
        let first = self.history.len().saturating_sub(later + 1);
        (window, self.history[first..].iter().collect())
    }

    /// What a page says after it looked is right too.
    fn judge_page(&mut self) {
        let found = diagnose(self.shape, self.page.follower.table());
        self.count.looks += 1;
        if found.unsettled > 0 {
            return;
        }
        let (window, states) = self.window();
        for finding in &found.findings {
            self.check(finding, &states, window, "page");
        }
        let certain = found.findings.iter().filter(|f| found.is_certain(f));
        self.count.certain_there += certain.count() as u64;
    }

    fn check(&self, finding: &Finding, states: &[&Truth], window: Micros, who: &str) {
        let troubles = || -> Vec<_> { states.iter().map(|s| (s.from, &s.troubles)).collect() };
        assert!(
            self.is_right(finding, states, window),
            "{who}: {finding:?} at {}, since {window}: {:?}",
            self.bench.now,
            troubles()
        );
    }

    fn judge(&mut self) {
        let found = diagnose(self.shape, self.bench.poller.faults());
        self.count.judged += 1;
        let (window, states) = self.window();
        let states: Vec<Truth> = states.into_iter().cloned().collect();
        let states: Vec<&Truth> = states.iter().collect();
        if found.unsettled > 0 {
            self.count.preliminary += 1;
        } else {
            for finding in &found.findings {
                self.check(finding, &states, window, "host");
                if found.is_certain(finding) {
                    self.count.certain += 1;
                } else {
                    self.count.ambiguous += 1;
                }
            }
        }
        let lasts = states.len() == 1 && self.passes.len() > WINDOW;
        if lasts {
            self.is_complete(&found, states[0], window);
        }
    }

    fn was_deaf(&self, place: usize, window: Micros) -> bool {
        self.deaf[place].is_some_and(|at| at >= window)
    }

    fn place(&self, end: End) -> usize {
        match end {
            End::Port(HostPort::One) => 0,
            End::Port(HostPort::Two) => self.units + 1,
            End::Unit { place, .. } => place + 1,
        }
    }

    /// True if what a finding says was so at some time in the window.
    fn is_right(&self, finding: &Finding, states: &[&Truth], window: Micros) -> bool {
        let cut = |from: usize, to: usize| {
            let any = |s: &&&Truth| (from..to).any(|p| s.is_cut(p, self.units));
            states.iter().find(any).is_some()
        };
        let between = |from: End, to: End| cut(self.place(from), self.place(to));
        match finding {
            // And each unit was heard, whatever its watchdog did to it.
            Finding::NoFault => {
                let heard = |at: &Option<Micros>| at.is_some_and(|at| at >= window);
                self.heard.iter().all(heard)
                    && states.iter().any(|s| s.is_whole(self.shape, self.units))
            }
            Finding::OffLine(End::Unit { place, .. }) => self.was_deaf(*place, window),
            Finding::Break { from, to } => between(*from, *to),
            Finding::PortLost { port, .. } => match port {
                HostPort::One => cut(0, 1),
                HostPort::Two => cut(self.units, self.units + 1),
            },
            Finding::BreakAmong { from, to, .. } => between(*from, *to),
            // Each silent unit is deaf, or cut off.
            Finding::Beyond { from, silent, .. } => silent.iter().all(|unit| {
                let place = usize::from(*unit) - 1;
                self.was_deaf(place, window) || cut(self.place(*from), place + 1)
            }),
            Finding::LastUnit {
                from,
                unit: End::Unit { place, .. },
            } => {
                self.was_deaf(*place, window)
                    || between(
                        *from,
                        End::Unit {
                            place: *place,
                            unit: 0,
                        },
                    )
            }
            Finding::Nothing { .. } => (0..self.units).all(|place| {
                let here = |s: &&&Truth| {
                    let near = (0..=place).any(|p| s.is_cut(p, self.units));
                    let far = (place + 1..=self.units).any(|p| s.is_cut(p, self.units));
                    near && (far || self.shape != DdcShape::Loop)
                };
                self.was_deaf(place, window) || states.iter().any(|s| here(&s))
            }),
            // Three times and more in the passes that count for it, each of those named.
            Finding::Unsteady(units) => units.iter().all(|unit| {
                let ports = if self.shape == DdcShape::Loop { 2 } else { 1 };
                let first = self.passes.len().saturating_sub(16 * ports + WINDOW);
                let turns = &self.turns[usize::from(*unit) - 1];
                turns.iter().filter(|pass| **pass >= first).count() >= 3
            }),
            // It only says that the picture does not fit: something changed, or a unit came and
            // went.
            Finding::OneSided {
                unit: End::Unit { place, .. },
                ..
            } => states.len() > 1 || self.was_deaf(*place, window),
            _ => false,
        }
    }

    /// What lasted for the whole window is in the findings.
    fn is_complete(&self, found: &Diagnosis, truth: &Truth, window: Micros) {
        let stretches: Vec<(usize, usize)> = found
            .findings
            .iter()
            .filter_map(|f| {
                let (from, to) = f.stretch()?;
                // A break may hide behind units without power.
                let to = match f {
                    Finding::Beyond { .. } => End::Port(HostPort::Two),
                    _ => to,
                };
                Some((self.place(from), self.place(to)))
            })
            .collect();
        let nothing = found
            .findings
            .iter()
            .any(|f| matches!(f, Finding::Nothing { .. } | Finding::Unsteady(_)));
        let places = if self.shape == DdcShape::Loop {
            self.units + 1
        } else {
            self.units
        };
        let cuts: Vec<usize> = (0..places)
            .filter(|p| truth.is_cut(*p, self.units))
            .collect();
        for cut in &cuts {
            // One port sees the first cut only; two see the first and the last.
            let hidden = match self.shape {
                DdcShape::Loop => cuts.first() != Some(cut) && cuts.last() != Some(cut),
                _ => cuts.first() != Some(cut),
            };
            let inside = stretches.iter().any(|(from, to)| (from..to).contains(&cut));
            assert!(
                hidden || inside || nothing,
                "cut {cut} is missing in {found:?}"
            );
        }
        // A unit that was deaf all the time, and none that was not.
        for place in 0..self.units {
            let was_deaf = self.was_deaf(place, window);
            let was_heard = self.heard[place].is_some_and(|at| at >= window);
            let named = found.findings.iter().any(|f| match f {
                Finding::Unsteady(units) => units.contains(&(place as u8 + 1)),
                Finding::OffLine(End::Unit { place: at, .. })
                | Finding::LastUnit {
                    unit: End::Unit { place: at, .. },
                    ..
                } => *at == place,
                Finding::BreakAmong { silent, .. } | Finding::Beyond { silent, .. } => {
                    silent.contains(&(place as u8 + 1))
                }
                Finding::Nothing { .. } => true,
                _ => false,
            });
            if was_deaf && !was_heard {
                assert!(named, "unit {} is missing in {found:?}", place + 1);
            }
        }
        if cuts.is_empty() && truth.troubles.is_empty() && found.unsettled == 0 {
            let calm = (0..self.units).all(|p| !self.was_deaf(p, window));
            // Units that came and went before are still named for a while.
            let none = |f: &Finding| matches!(f, Finding::NoFault | Finding::Unsteady(_));
            assert!(!calm || found.findings.iter().all(none), "{found:?}");
        }
    }
}

fn soak(shape: DdcShape, units: u8, hours: u64, seed: u64) {
    let mut soak = Soak::new(shape, units, seed);
    soak.run(hours);
    println!(
        "{shape:?}, {units} units, {hours} h, seed {seed}: {:?}",
        soak.count
    );
    assert!(soak.count.certain > 0 && soak.count.troubles > 0);
    assert!(soak.count.certain_there > 0);
}

/// Set `DDC100_SOAK_HOURS=24` (and `--nocapture`) for the whole run with 250 units, or
/// `DDC100_SOAK_SEEDS=200` for more short ones.
#[test]
fn the_diagnosis_is_right_or_says_that_it_can_not_tell() {
    let hours = std::env::var("DDC100_SOAK_HOURS").ok();
    let hours: Option<u64> = hours.and_then(|h| h.parse().ok());
    match hours {
        Some(hours) => {
            for seed in 1..=3 {
                soak(DdcShape::Loop, 250, hours, seed);
                soak(DdcShape::SingleEnded, 250, hours, seed);
                soak(DdcShape::MultiDrop, 28, hours, seed);
            }
        }
        None => {
            let seeds = std::env::var("DDC100_SOAK_SEEDS").ok();
            for seed in 1..=seeds.and_then(|s| s.parse().ok()).unwrap_or(8) {
                soak(DdcShape::Loop, 6, 4, seed);
                soak(DdcShape::SingleEnded, 6, 2, seed);
            }
            soak(DdcShape::Loop, 1, 2, 1);
            soak(DdcShape::Loop, 2, 4, 1);
            soak(DdcShape::Loop, 250, 1, 1);
            soak(DdcShape::MultiDrop, 5, 2, 1);
        }
    }
}
