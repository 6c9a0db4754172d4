//! The cable between the units: which stretches of it are known to carry the signal of which port.

use shared::proto::DdcShape;

/// A stretch of the cable, as far as the faults of the units tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stretch {
    /// The signal of every port that there is passes.
    Good,
    /// Only the signal of port 1 or 2 passes.
    One(u8),
    /// No signal passes that reaches a unit.
    Dead,
    /// Nothing is known of it yet.
    Unknown,
}

impl Stretch {
    /// Its class in the style sheet.
    #[must_use]
    pub const fn class(self) -> &'static str {
        match self {
            Self::Good => "cable good",
            Self::One(_) => "cable one",
            Self::Dead => "cable dead",
            Self::Unknown => "cable unknown",
        }
    }
}

/// The stretches of a cable: from host port 1 to the first unit, between units, and from the last
/// unit on. A unit without power passes the signal on through its bypass relays, so a stretch is
/// proved by any unit behind it that answers.
///
/// `faults` are those on port 1 and 2 in the order of the cable. On a multi-drop line the units hang
/// beside each other on the trunk, which is proved in the same way.
#[must_use]
pub fn stretches(faults: &[[Option<bool>; 2]], shape: DdcShape, ports: usize) -> Vec<Stretch> {
    let n = faults.len();
    let two = ports > 1 && shape == DdcShape::Loop;
    let tried = |fault: &[Option<bool>; 2]| fault[0].is_some() || (two && fault[1].is_some());
    if !faults.iter().any(tried) {
        return vec![Stretch::Unknown; n + 1];
    }
    // The last unit that port 1 reaches, and the first that port 2 reaches.
    let last = faults.iter().rposition(|f| f[0] == Some(false));
    let first = faults.iter().position(|f| f[1] == Some(false));
    let from_one = |stretch: usize| last.is_some_and(|last| stretch <= last);
    let from_two = |stretch: usize| first.is_some_and(|first| stretch > first);
    // Behind the last unit that answers nothing is known while some there were not tried.
    let open = |fault: &[Option<bool>; 2]| fault[0].is_none() || (two && fault[1].is_none());
    (0..=n)
        .map(|stretch| {
            let (one, second) = (from_one(stretch), two && from_two(stretch));
            // A signal that reaches a unit over the cable next to a port came through all of it.
            let end = stretch == 0 || stretch == n;
            match (one, second) {
                (true, true) => Stretch::Good,
                (true, false) | (false, true) if !two || end => Stretch::Good,
                (true, false) => Stretch::One(1),
                (false, true) => Stretch::One(2),
                (false, false) if faults.iter().any(open) => Stretch::Unknown,
                (false, false) if stretch == n && !two => Stretch::Unknown,
                (false, false) => Stretch::Dead,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Stretch::{Dead, Good, One, Unknown};

    /// `01` is a fault on port 2 only.
    fn faults(text: &str) -> Vec<[Option<bool>; 2]> {
        let bit = |c: &u8| match c {
            b'0' => Some(false),
            b'1' => Some(true),
            _ => None,
        };
        text.split(' ')
            .map(|pair| [bit(&pair.as_bytes()[0]), bit(&pair.as_bytes()[1])])
            .collect()
    }

    fn ring(text: &str) -> Vec<Stretch> {
        stretches(&faults(text), DdcShape::Loop, 2)
    }

    /// The examples of section 4.3.2, whose tables are in the reading.
    #[test]
    fn the_examples_of_the_guide() {
        assert_eq!(ring("00 00 00 00 00"), [Good; 6], "1");
        // The unit without power passes the signal on.
        assert_eq!(ring("00 00 11 00 00"), [Good; 6], "2");
        assert_eq!(
            ring("01 01 01 10 10"),
            [Good, One(1), One(1), Dead, One(2), Good],
            "3"
        );
        assert_eq!(
            ring("01 01 01 01 01"),
            [Good, One(1), One(1), One(1), One(1), Dead],
            "4"
        );
        let line = |text| stretches(&faults(text), DdcShape::SingleEnded, 1);
        assert_eq!(line("00 00 00 00 00")[..5], [Good; 5], "5");
        assert_eq!(line("00 10 00 00 00")[..5], [Good; 5], "6");
        assert_eq!(
            line("00 00 10 10 10")[..5],
            [Good, Good, Dead, Dead, Dead],
            "7"
        );
    }

    #[test]
    fn what_was_not_tried_is_not_known() {
        assert_eq!(ring("-- --"), [Unknown; 3]);
        assert_eq!(ring("0- -- --"), [Good, Unknown, Unknown, Unknown]);
        assert_eq!(stretches(&[], DdcShape::Loop, 2), [Unknown]);
        let one = stretches(&faults("0- 0-"), DdcShape::Loop, 1);
        assert_eq!(one, [Good, Good, Unknown]);
    }
}
