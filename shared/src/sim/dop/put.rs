//! Values as response registers, in the orders that AIIOM000698-01, section 2.1.6, gives.

/// Registers that are being filled.
#[derive(Clone, Debug, Default)]
pub(super) struct Put(pub Vec<u16>);

impl Put {
    pub fn u16(&mut self, value: i64) {
        self.0
            .push(u16::try_from(value.clamp(0, 0xFFFF)).unwrap_or(0));
    }

    pub fn s16(&mut self, value: i64) {
        let value = i16::try_from(value.clamp(-0x8000, 0x7FFF)).unwrap_or(0);
        self.0.push(u16::from_be_bytes(value.to_be_bytes()));
    }

    /// Low word first.
    pub fn u32(&mut self, value: i64) {
        let [a, b, c, d] = u32::try_from(value.clamp(0, 0xFFFF_FFFF))
            .unwrap_or(0)
            .to_be_bytes();
        self.0.push(u16::from_be_bytes([c, d]));
        self.0.push(u16::from_be_bytes([a, b]));
    }

    /// Low word first.
    pub fn s32(&mut self, value: i64) {
        let value = i32::try_from(value.clamp(-0x8000_0000, 0x7FFF_FFFF)).unwrap_or(0);
        let [a, b, c, d] = value.to_be_bytes();
        self.0.push(u16::from_be_bytes([c, d]));
        self.0.push(u16::from_be_bytes([a, b]));
    }

    /// Lowest word first; seconds since 1970, 0 for never.
    pub fn time(&mut self, value: i64) {
        let [a, b, c, d, e, f, g, h] = value.to_be_bytes();
        for pair in [[g, h], [e, f], [c, d], [a, b]] {
            self.0.push(u16::from_be_bytes(pair));
        }
    }

    /// So many registers; the first of two characters in the low byte, the rest NUL.
    pub fn text(&mut self, text: &str, registers: usize) {
        let mut bytes = text.bytes().chain(core::iter::repeat(0));
        for _ in 0..registers {
            let low = bytes.next().unwrap_or(0);
            let high = bytes.next().unwrap_or(0);
            self.0.push(u16::from_be_bytes([high, low]));
        }
    }

    /// An array of `size`, of which the values fill the first places.
    pub fn array(
        &mut self,
        size: usize,
        values: impl IntoIterator<Item = i64>,
        put: fn(&mut Self, i64),
    ) {
        let values = values.into_iter().chain(core::iter::repeat(0));
        for value in values.take(size) {
            put(self, value);
        }
    }
}
