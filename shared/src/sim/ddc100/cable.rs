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

    /// True if a signal goes from the port to the unit at this place in the order of the cable,
    /// counted from 0, and back. Units repeat the signal or, without power, pass it on, so only the
    /// cable counts. On a multi-drop line a short anywhere silences everybody (section 4.2.3).
    pub(super) fn reaches(&self, port: HostPort, place: usize) -> bool {
        let [one, two] = self.dead;
        let cut = |places: &[bool]| places.iter().any(|p| *p);
        let way = |all: &[bool]| match port {
            HostPort::One => all.get(..=place).is_none_or(cut),
            HostPort::Two => all.get(place.saturating_add(1)..).is_none_or(cut),
        };
        let shorted = match self.shape {
            DdcShape::MultiDrop => cut(&self.shorts),
            _ => way(&self.shorts),
        };
        let dead = match port {
            HostPort::One => one,
            HostPort::Two => two || self.shape != DdcShape::Loop,
        };
        !dead && !shorted && !way(&self.breaks)
    }
}
