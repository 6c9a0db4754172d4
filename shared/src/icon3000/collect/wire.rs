//! What the wire carried while a device was read, and how long that takes at least.

/// What the wire carried, for the theoretical time of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wire {
    /// Exchanges.
    pub exchanges: u32,
    /// Bytes of all request frames, address and CRC included.
    pub request_bytes: u32,
    /// Bytes of all response frames, address and CRC included.
    pub response_bytes: u32,
}

impl Wire {
    pub(super) fn add(&mut self, request: usize, response: usize) {
        // Address and CRC.
        let frame = |pdu: usize| u32::try_from(pdu.saturating_add(3)).unwrap_or(u32::MAX);
        self.exchanges = self.exchanges.saturating_add(1);
        self.request_bytes = self.request_bytes.saturating_add(frame(request));
        self.response_bytes = self.response_bytes.saturating_add(frame(response));
    }

    /// Theoretical time on a Modbus RTU line, in microseconds: all characters, and a silence of 3.5
    /// characters (1.75 ms above 19200 baud) after each frame. `bits` of a character are 11 with
    /// parity or two stop bits, else 10.
    ///
    /// Source: Modbus over Serial Line V1.02, section 2.5.1.1.
    #[must_use]
    pub fn micros(&self, baud: u32, bits: u32) -> u64 {
        let bytes = u64::from(self.request_bytes).saturating_add(self.response_bytes.into());
        // In bits, so that nothing is rounded before the end; the silence counts in half characters.
        let time = |bits: u64| bits.saturating_mul(1_000_000).checked_div(baud.into());
        let characters = time(bytes.saturating_mul(bits.into())).unwrap_or(0);
        let frames = u64::from(self.exchanges).saturating_mul(2);
        let silence = if baud > 19_200 {
            frames.saturating_mul(1750)
        } else {
            let halves = frames.saturating_mul(7).saturating_mul(bits.into());
            time(halves).unwrap_or(0) / 2
        };
        characters.saturating_add(silence)
    }
}
