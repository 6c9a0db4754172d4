//! A network as it is drawn: made from what the backend tells, or from a fault table typed by hand.

use shared::proto::{DdcShape, LineState};

use super::cable::{Stretch, stretches};
use super::net::{Net, Reach, Unit, reach};
use super::tags::Tags;
use super::unit::{Health, Judged};

/// A unit of the drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// Its address.
    pub unit: u8,
    /// Its tag; may be empty.
    pub tag: String,
    /// Which ports reach it.
    pub reach: Reach,
    /// How it is.
    pub health: Health,
    /// What its valve does and what is wrong with it, in words; empty if nobody knows.
    pub words: String,
}

/// A place where the cable is, or may be, broken: stretches `from` to `to`, counted from host port
/// 1, where 0 leads to the first unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// The first stretch.
    pub from: usize,
    /// The last one.
    pub to: usize,
    /// False if it may be something else.
    pub certain: bool,
}

impl Mark {
    /// The stretch that carries the sign.
    #[must_use]
    pub const fn at(self) -> usize {
        usize::midpoint(self.from, self.to)
    }

    /// True if it covers a stretch.
    #[must_use]
    pub const fn covers(self, stretch: usize) -> bool {
        self.from <= stretch && stretch <= self.to
    }
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// How the cable runs.
    pub shape: DdcShape,
    /// State of each host port; `None` offline.
    pub ports: Vec<Option<LineState>>,
    /// The units in the order of the cable.
    pub nodes: Vec<Node>,
    /// What is known of each stretch of the cable.
    pub stretches: Vec<Stretch>,
    /// Breaks.
    pub marks: Vec<Mark>,
}

impl Picture {
    /// The picture of a network on the line. `judged` are all its units.
    #[must_use]
    pub fn of(net: &Net, judged: &[Judged], tags: &Tags, marks: Vec<Mark>) -> Self {
        let shape = net.shape.unwrap_or(DdcShape::Loop);
        let ports = net.ports.len();
        let node = |(unit, judged): (&Unit, &Judged)| {
            let mut words = Vec::new();
            if judged.known {
                words.push(judged.view.state.clone());
            }
            words.push(judged.fault_words(2));
            words.push(judged.local().to_owned());
            words.retain(|w| !w.is_empty());
            Node {
                unit: unit.info.unit,
                tag: tags.tag(unit).to_owned(),
                reach: unit.reach(ports),
                health: judged.health,
                words: words.join("; "),
            }
        };
        let faults: Vec<_> = net.units.iter().map(|u| u.fault).collect();
        Self {
            shape,
            ports: net.ports.iter().map(|p| Some(p.state)).collect(),
            nodes: net.units.iter().zip(judged).map(node).collect(),
            stretches: stretches(&faults, shape, ports),
            marks,
        }
    }

    /// The picture of a fault table without a network.
    #[must_use]
    pub fn of_faults(
        units: &[(u8, [Option<bool>; 2])],
        shape: DdcShape,
        ports: usize,
        marks: Vec<Mark>,
    ) -> Self {
        let node = |(unit, fault): &(u8, [Option<bool>; 2])| {
            let reach = reach(*fault, ports);
            Node {
                unit: *unit,
                tag: String::new(),
                reach,
                health: match reach {
                    Reach::Lost => Health::Lost,
                    Reach::Only(_) => Health::OnePort,
                    Reach::Full => Health::Good,
                    Reach::Half(..) | Reach::Unknown => Health::Unknown,
                },
                words: String::new(),
            }
        };
        let faults: Vec<_> = units.iter().map(|(_, fault)| *fault).collect();
        Self {
            shape,
            ports: vec![None; ports],
            nodes: units.iter().map(node).collect(),
            stretches: stretches(&faults, shape, ports),
            marks,
        }
    }

    /// A unit by name for those who do not see the drawing.
    #[must_use]
    pub fn name(&self, at: usize) -> String {
        let Some(node) = self.nodes.get(at) else {
            return String::new();
        };
        let mut name = format!("Unit {}", node.unit);
        if !node.tag.is_empty() {
            name.push_str(&format!(", {}", node.tag));
        }
        name.push_str(&format!(": {}", node.reach.words(self.ports.len())));
        if !node.words.is_empty() {
            name.push_str(&format!(", {}", node.words));
        }
        for mark in &self.marks {
            let kind = if mark.certain {
                "break"
            } else {
                "possible break"
            };
            if mark.covers(at) && mark.from == at {
                name.push_str(&format!(", {kind} before it"));
            }
            if mark.covers(at + 1) && mark.to == at + 1 {
                name.push_str(&format!(", {kind} after it"));
            }
        }
        name
    }

    /// The units in runs along the cable: neighbours that have nothing of their own to say stand
    /// together. Each run is the places of its units, from and to; a break ends a run.
    #[must_use]
    pub fn runs(&self, least: usize) -> Vec<(usize, usize)> {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        let plain = |node: &Node| node.health.sign().is_none();
        for (at, node) in self.nodes.iter().enumerate() {
            let cut = self.marks.iter().any(|m| m.covers(at));
            let joins = runs.last().is_some_and(|(_, last)| {
                self.nodes
                    .get(*last)
                    .is_some_and(|l| plain(l) && plain(node) && l.reach == node.reach)
            });
            match runs.last_mut().filter(|_| joins && !cut) {
                Some((_, to)) => *to = at,
                None => runs.push((at, at)),
            }
        }
        // A short run says more unit by unit.
        runs.into_iter()
            .flat_map(|(from, to)| {
                if to - from + 1 >= least {
                    vec![(from, to)]
                } else {
                    (from..=to).map(|at| (at, at)).collect()
                }
            })
            .collect()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::net::tests::{network, poll};
    use super::*;

    /// Units 1 to 5 with a break between 3 and 4, example 3 of the guide; unit 2 has a fault.
    pub(crate) fn broken() -> Picture {
        let mut net = network(5, DdcShape::Loop, 2);
        for unit in 1..=5_u8 {
            let far = unit > 3;
            let status = if unit == 2 { 0x8084 } else { 0x0801 };
            poll(
                &mut net,
                unit,
                [Some(far), Some(!far)],
                &[61, status, 0, 0, 0, 0, 0, 0, 0],
            );
        }
        let mark = Mark {
            from: 3,
            to: 3,
            certain: true,
        };
        let tags = Tags::default();
        Picture::of(&net, &Judged::all(&net, &tags), &tags, vec![mark])
    }

    #[test]
    fn units_have_names() {
        let picture = broken();
        assert_eq!(
            picture.name(1),
            "Unit 2, MOV-002: answers on port 1 only, Stopped between the ends; Combined fault, Phase error; Local or stop"
        );
        assert_eq!(
            picture.name(2),
            "Unit 3, MOV-003: answers on port 1 only, Open; Local or stop, break after it"
        );
        assert_eq!(
            picture.name(3),
            "Unit 4, MOV-004: answers on port 2 only, Open; Local or stop, break before it"
        );
        assert_eq!(picture.name(9), "");
    }

    #[test]
    fn neighbours_stand_together() {
        let picture = broken();
        // Unit 2 has a fault of its own; the break is between 3 and 4.
        assert_eq!(picture.runs(2), [(0, 0), (1, 1), (2, 2), (3, 4)]);
        assert_eq!(picture.runs(3), [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)]);
        let faults: Vec<_> = (1..=250).map(|u| (u, [Some(false), Some(false)])).collect();
        let good = Picture::of_faults(&faults, DdcShape::Loop, 2, Vec::new());
        assert_eq!(good.runs(6), [(0, 249)]);
    }
}
