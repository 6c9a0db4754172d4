//! Text and numbers as the device writes them.

/// Text as packed ASCII of so many characters: six bits each, blanks at the end.
pub(super) fn packed<const N: usize>(text: &str, characters: usize) -> [u8; N] {
    let codes = text
        .bytes()
        .map(|c| c.to_ascii_uppercase())
        .map(|c| if (0x20..0x60).contains(&c) { c } else { b'?' })
        .chain(core::iter::repeat(b' '))
        .take(characters);
    let mut out = [0_u8; N];
    for (at, code) in codes.enumerate() {
        let first = at.saturating_mul(6);
        for bit in 0..6_usize {
            if code & (0x20 >> bit) != 0 {
                let place = first.saturating_add(bit);
                if let Some(byte) = out.get_mut(place / 8) {
                    *byte |= 0x80 >> (place % 8);
                }
            }
        }
    }
    out
}

/// Text as ISO 8859-1 of so many bytes, filled up with this.
pub(super) fn latin<const N: usize>(text: &str, fill: u8) -> [u8; N] {
    let mut out = [fill; N];
    for (slot, character) in out.iter_mut().zip(text.chars()) {
        *slot = u8::try_from(u32::from(character)).unwrap_or(b'?');
    }
    out
}

/// Three bytes of a number.
pub(super) fn three(number: u32) -> [u8; 3] {
    let [_, a, b, c] = number.to_be_bytes();
    [a, b, c]
}

/// The float that begins at this byte.
pub(super) fn float(data: &[u8], at: usize) -> Option<f32> {
    let bytes = data.get(at..)?.first_chunk::<4>()?;
    Some(f32::from_be_bytes(*bytes))
}

/// What HART sends where there is no number.
pub(super) const NO_NUMBER: [u8; 4] = [0x7F, 0xA0, 0x00, 0x00];

/// A number, or none.
pub(super) fn number(value: Option<f32>) -> [u8; 4] {
    value.map_or(NO_NUMBER, f32::to_be_bytes)
}
