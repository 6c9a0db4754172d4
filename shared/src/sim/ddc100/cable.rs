//! The cable: which units a port reaches.

use crate::ddc100::HostPort;
use crate::proto::DdcShape;

/// The cable. Place 0 is between host port 1 and the first unit, place `n` behind the last one: in a
/// loop on the way to host port 2.
#[derive(Clone, Debug)]
pub(super) struct Cable {
    shape: DdcShape,
    breaks: Vec<bool>,
    shorts: Vec<bool>,
    dead: [bool; 2],
}

impl Cable {
    pub(super) fn new(shape: DdcShape, units: usize) -> Self {
        let places = units.saturating_add(1);
        Self {
            shape,
            breaks: vec![false; places],
            shorts: vec![false; places],
            dead: [false; 2],
        }
    }

    pub(super) fn set_break(&mut self, place: usize, on: bool) -> bool {
        self.breaks.get_mut(place).map(|p| *p = on).is_some()
    }

    pub(super) fn set_short(&mut self, place: usize, on: bool) -> bool {
        self.shorts.get_mut(place).map(|p| *p = on).is_some()
    }

    pub(super) const fn set_dead(&mut self, port: HostPort, on: bool) {
        let [one, two] = &mut self.dead;
        match port {
            HostPort::One => *one = on,
            HostPort::Two => *two = on,
        }
    }

    /// The places of the units, counted from 0 in the order of the cable, to which a signal goes from
    /// the port and back. Units repeat the signal or, without power, pass it on, so only the cable
    /// counts. On a multi-drop line a short anywhere silences everybody (section 4.2.3).
    pub(super) fn reached(&self, port: HostPort) -> core::ops::Range<usize> {
        let [one, two] = self.dead;
        let dead = match port {
            HostPort::One => one,
            HostPort::Two => two || self.shape != DdcShape::Loop,
        };
        let shorted = self.shape == DdcShape::MultiDrop && self.shorts.contains(&true);
        if dead || shorted {
            return 0..0;
        }
        let units = self.breaks.len().saturating_sub(1);
        let mut cuts = self.breaks.iter().zip(&self.shorts).map(|(b, s)| *b || *s);
        match port {
            // A cut at a place is before the unit of that number.
            HostPort::One => 0..cuts.position(|cut| cut).unwrap_or(units).min(units),
            HostPort::Two => cuts.rposition(|cut| cut).unwrap_or(0)..units,
        }
    }
}
