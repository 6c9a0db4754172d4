//! What a device was set to before anybody looks at it.

use super::device::HartDevice;
use super::signal::LINEAR;
use crate::device::Family;

impl HartDevice {
    /// The condition in which command 40 with this current leaves it, in mA; false if it would be
    /// refused: the CMA has no such command, and 3.5 to 20.5 mA can be simulated.
    pub fn set_fixed(&mut self, current: f32) -> bool {
        let can = self.setup.family != Family::Cma && self.loop_mode && LINEAR.contains(&current);
        if can {
            self.signal.fixed = Some(current);
        }
        can
    }

    /// Gives an entry of the condensed status map its category, as command 524 does; false if it has
    /// no such entry, or there is no such category.
    pub fn set_category(&mut self, index: usize, category: u8) -> bool {
        let slot = self.state.map.get_mut(index);
        let slot = slot.filter(|_| matches!(category, 0 | 1 | 3..=6));
        slot.map(|slot| *slot = category).is_some()
    }
}
