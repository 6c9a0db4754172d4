//! A fault table typed or pasted by hand.

use shared::proto::DdcShape;

/// Units that a table may have.
pub const MOST: usize = 250;

/// Faults of a unit on port 1 and 2; `None` where it was not tried.
pub type Faults = [Option<bool>; 2];

/// The table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Typed {
    /// How the cable runs.
    pub shape: DdcShape,
    /// Host ports, 1 or 2.
    pub ports: usize,
    /// The units in the order of the cable.
    pub units: Vec<(u8, Faults)>,
}

impl Default for Typed {
    fn default() -> Self {
        Self::new(DdcShape::Loop, 5)
    }
}

/// The examples of section 4.3.2: number, shape, and the faults on A and B of units 1 to 5.
pub const EXAMPLES: [(&str, DdcShape, [&str; 5]); 7] = [
    ("1", DdcShape::Loop, ["00", "00", "00", "00", "00"]),
    ("2", DdcShape::Loop, ["00", "00", "11", "00", "00"]),
    ("3", DdcShape::Loop, ["01", "01", "01", "10", "10"]),
    ("4", DdcShape::Loop, ["01", "01", "01", "01", "01"]),
    ("5", DdcShape::SingleEnded, ["0", "0", "0", "0", "0"]),
    ("6", DdcShape::SingleEnded, ["0", "1", "0", "0", "0"]),
    ("7", DdcShape::SingleEnded, ["0", "0", "1", "1", "1"]),
];

/// Key and words of the shapes.
pub const SHAPES: [(&str, &str, DdcShape); 3] = [
    ("loop", "Redundant loop, two ports", DdcShape::Loop),
    ("single_ended", "Single-ended loop", DdcShape::SingleEnded),
    ("multi_drop", "Multi-drop line", DdcShape::MultiDrop),
];

impl Typed {
    /// A table of so many units without a fault.
    #[must_use]
    pub fn new(shape: DdcShape, units: usize) -> Self {
        let ports = if shape == DdcShape::Loop { 2 } else { 1 };
        let mut typed = Self {
            shape,
            ports,
            units: Vec::new(),
        };
        typed.resize(units);
        typed
    }

    /// An example of the guide.
    #[must_use]
    pub fn example(key: &str) -> Option<Self> {
        let (_, shape, bits) = EXAMPLES.iter().find(|(k, ..)| *k == key)?;
        let mut typed = Self::new(*shape, bits.len());
        for ((_, faults), bits) in typed.units.iter_mut().zip(bits) {
            for (fault, bit) in faults.iter_mut().zip(bits.chars()) {
                *fault = Some(bit == '1');
            }
        }
        Some(typed)
    }

    /// The word of its shape.
    #[must_use]
    pub fn shape_key(&self) -> &'static str {
        SHAPES
            .iter()
            .find(|(.., shape)| *shape == self.shape)
            .map_or("", |(key, ..)| key)
    }

    /// Another shape, and with it other ports.
    pub fn set_shape(&mut self, shape: DdcShape) {
        let again = Self::new(shape, 0);
        self.shape = shape;
        self.ports = again.ports;
        let two = self.ports > 1;
        for (_, faults) in &mut self.units {
            faults[1] = two.then(|| faults[1].unwrap_or(false));
        }
    }

    /// More or fewer units at the end of the cable.
    pub fn resize(&mut self, units: usize) {
        let units = units.clamp(1, MOST);
        self.units.truncate(units);
        while self.units.len() < units {
            let next = self.units.iter().map(|(unit, _)| *unit).max();
            let fresh = next.unwrap_or(0).checked_add(1).filter(|unit| *unit <= 250);
            let free = || (1..=250).find(|u| self.units.iter().all(|(unit, _)| unit != u));
            let Some(unit) = fresh.or_else(free) else {
                return;
            };
            let faults = [Some(false), (self.ports > 1).then_some(false)];
            self.units.push((unit, faults));
        }
    }

    /// Turns a bit of the unit at a place round.
    pub fn toggle(&mut self, at: usize, port: usize) {
        let fault = self.units.get_mut(at).and_then(|(_, f)| f.get_mut(port));
        if let Some(fault) = fault {
            *fault = Some(!fault.unwrap_or(false));
        }
    }

    /// Reads pasted bits over the present table: a line for each unit, its address if there are
    /// three columns (two with one port), then A and B; 1 is a fault, and a dash or question mark
    /// was not tried.
    ///
    /// # Errors
    ///
    /// What could not be read, and in which line.
    pub fn paste(&self, text: &str) -> Result<Self, String> {
        let mut read: Vec<(u8, Faults)> = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let cells: Vec<&str> = line
                .split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '|'))
                .filter(|cell| !cell.is_empty())
                .collect();
            // `01` stands for two bits.
            let bits: Vec<&str> = match cells.as_slice() {
                [] => continue,
                [both] if self.ports > 1 && both.len() == 2 && both.is_ascii() => {
                    vec![&both[..1], &both[1..]]
                }
                all => all.to_vec(),
            };
            // The head of a table.
            if read.is_empty()
                && number == 1
                && bits
                    .iter()
                    .all(|b| bit(b).is_none() && b.parse::<u8>().is_err())
            {
                continue;
            }
            let (unit, bits) = if bits.len() > self.ports {
                let unit = bits[0].parse::<u8>().ok().filter(|u| (1..=250).contains(u));
                let unit = unit.ok_or_else(|| {
                    format!(
                        "Line {number}: \"{}\" is no unit address, 1 to 250.",
                        bits[0]
                    )
                })?;
                (unit, &bits[1..])
            } else {
                let next = u8::try_from(read.len() + 1).unwrap_or(u8::MAX);
                (next, &bits[..])
            };
            if bits.len() != self.ports {
                return Err(format!(
                    "Line {number} has {} bits instead of {}: write the unit, then {}.",
                    bits.len(),
                    self.ports,
                    if self.ports > 1 { "A and B" } else { "A" }
                ));
            }
            let mut faults = [None; 2];
            for (fault, text) in faults.iter_mut().zip(bits) {
                *fault = bit(text).ok_or_else(|| {
                    format!("Line {number}: \"{text}\" is no bit; 1 is a fault, 0 is none, - was not tried.")
                })?;
            }
            if read.iter().any(|(other, _)| *other == unit) {
                return Err(format!("Line {number}: unit {unit} is there already."));
            }
            if read.len() >= MOST {
                return Err(format!("Line {number}: more than {MOST} units."));
            }
            read.push((unit, faults));
        }
        if read.is_empty() {
            return Err(
                "No bits in this. Write a line for each unit: its address, A and B.".into(),
            );
        }
        Ok(Self {
            units: read,
            ..self.clone()
        })
    }
}

/// A bit as people write it; `None` if it is none.
fn bit(text: &str) -> Option<Option<bool>> {
    match text.to_ascii_lowercase().as_str() {
        "1" | "fault" | "x" => Some(Some(true)),
        "0" | "ok" | "." => Some(Some(false)),
        "-" | "?" | "\u{2013}" => Some(None),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::findings::{findings, table};

    const NO: Option<bool> = Some(false);
    const YES: Option<bool> = Some(true);

    /// What the reading says to the examples of section 4.3.2.
    #[test]
    fn the_examples_of_the_guide() {
        let said = |key: &str| {
            let typed = Typed::example(key).unwrap();
            let diagnosis = findings(typed.shape, &table(&typed.units, typed.ports)).unwrap();
            let first = &diagnosis.findings[0];
            (first.key(), diagnosis.is_certain(first))
        };
        assert_eq!(said("1"), ("no_fault", true));
        assert_eq!(said("2"), ("off_line", true));
        assert_eq!(said("3"), ("break", true));
        assert_eq!(said("4"), ("port_lost", true));
        assert_eq!(said("5"), ("no_fault", true));
        assert_eq!(said("6"), ("off_line", true));
        assert_eq!(said("7").0, "beyond");
        assert_eq!(Typed::example("8"), None);
    }

    #[test]
    fn bits_are_pasted_as_people_write_them() {
        let ring = Typed::default();
        let pasted = ring.paste("Unit A B\n7 0 1\n3;1;0\n\n9\t-\t?\n").unwrap();
        assert_eq!(
            pasted.units,
            [(7, [NO, YES]), (3, [YES, NO]), (9, [None, None])]
        );
        let short = ring.paste("01\n0 1\n10").unwrap();
        assert_eq!(
            short.units,
            [(1, [NO, YES]), (2, [NO, YES]), (3, [YES, NO])]
        );
        let line = Typed::new(DdcShape::SingleEnded, 1).paste("0\n1").unwrap();
        assert_eq!(line.units, [(1, [NO, None]), (2, [YES, None])]);
    }

    #[test]
    fn what_is_no_table_is_refused_in_words() {
        let ring = Typed::default();
        for (text, part) in [
            ("", "No bits"),
            ("1 0 0\n1 1 1", "Line 2: unit 1 is there already"),
            ("0 0\n2", "Line 2 has 1 bits instead of 2"),
            ("0 0\n300 0 0", "Line 2: \"300\" is no unit address"),
            ("0 0\n0 7", "Line 2: \"7\" is no bit"),
        ] {
            let error = ring.paste(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
        let many: String = (0..251).map(|_| "0 0\n").collect();
        assert!(ring.paste(&many).is_err());
    }

    #[test]
    fn a_table_grows_shrinks_and_turns() {
        let mut typed = Typed::default();
        typed.toggle(2, 1);
        assert_eq!(typed.units[2], (3, [NO, YES]));
        typed.toggle(99, 0);
        typed.resize(3);
        typed.resize(4);
        assert_eq!(typed.units.len(), 4);
        assert_eq!(typed.units[2].1, [NO, YES]);
        typed.set_shape(DdcShape::SingleEnded);
        assert_eq!((typed.ports, typed.units[2].1), (1, [NO, None]));
        assert_eq!(typed.shape_key(), "single_ended");
        typed.resize(0);
        assert_eq!(typed.units.len(), 1);
        typed.resize(999);
        assert_eq!(typed.units.len(), 250);
    }
}
