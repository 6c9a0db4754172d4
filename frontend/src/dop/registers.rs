//! Registers written by hand, for tests: the word order of section 2.1.6 of AIIOM000698-01.

/// Registers under construction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Registers(pub(crate) Vec<u16>);

impl Registers {
    /// One register each.
    pub(crate) fn u16(mut self, values: impl IntoIterator<Item = u16>) -> Self {
        self.0.extend(values);
        self
    }

    /// Two registers each, the low word first.
    pub(crate) fn i32(mut self, values: impl IntoIterator<Item = i32>) -> Self {
        for value in values {
            let value = value.cast_unsigned();
            self.0.extend([value as u16, (value >> 16) as u16]);
        }
        self
    }

    /// Four registers each, the low word first.
    pub(crate) fn i64(mut self, values: impl IntoIterator<Item = i64>) -> Self {
        for value in values {
            let value = value.cast_unsigned();
            self.0
                .extend([0, 16, 32, 48].map(|shift| (value >> shift) as u16));
        }
        self
    }

    /// Two characters a register, the first in the low byte; NULs fill the rest.
    pub(crate) fn text(mut self, text: &str, registers: usize) -> Self {
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(registers * 2, 0);
        let words = bytes
            .chunks(2)
            .map(|pair| u16::from(pair[0]) | u16::from(pair[1]) << 8);
        self.0.extend(words);
        self
    }
}
