//! The diagnostics of function 08 (table 3.8): what can be read, and what the answers say.
//!
//! Sub-functions 1, 4 and 10 change the unit (restart, listen only, clear); they are not here.

use crate::device::Device;
use crate::map::row::Function;

/// Sub-functions that only read: the diagnostic register and the counters.
pub const READS: [u16; 5] = [2, 11, 12, 13, 14];

/// The request PDU of a sub-function that only reads; `None` for any other.
#[must_use]
pub fn request(sub: u16) -> Option<[u8; 5]> {
    let [high, low] = sub.to_be_bytes();
    READS.contains(&sub).then_some([8, high, low, 0, 0])
}

/// A counter or register that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counter {
    /// Sub-function.
    pub sub: u16,
    /// Its value.
    pub value: u16,
}

/// Reads an answer to a [`request`]; `None` if it is none.
#[must_use]
pub fn answer(request: &[u8], response: &[u8]) -> Option<Counter> {
    let (asked, answered) = (request.get(..3)?, response.get(..3)?);
    let [8, high, low] = *asked else { return None };
    let sub = u16::from_be_bytes([high, low]);
    let value = *response.get(3..5)?.first_chunk::<2>()?;
    let sound = asked == answered && response.len() == 5 && READS.contains(&sub);
    sound.then(|| Counter {
        sub,
        value: u16::from_be_bytes(value),
    })
}

impl Counter {
    /// The line of table 3.8 for it.
    #[must_use]
    pub fn function(&self, kind: Device) -> Option<&'static Function> {
        let all = kind.map()?.functions;
        all.iter().find(|f| f.sub == Some(self.sub)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_are_read_and_nothing_else() {
        assert_eq!(request(11), Some([8, 0, 11, 0, 0]));
        for sub in [0, 1, 3, 4, 10, 15] {
            assert_eq!(request(sub), None, "{sub}");
        }
        let counter = answer(&[8, 0, 11, 0, 0], &[8, 0, 11, 1, 4]).unwrap();
        assert_eq!(counter.value, 260);
        assert!(
            counter
                .function(Device::Ddc100Mx)
                .unwrap()
                .label
                .contains("message")
        );
        for wrong in [
            &[8, 0, 12, 0, 0][..],
            &[0x88, 1],
            &[8, 0, 11, 0],
            &[8, 0, 11, 0, 0, 0],
        ] {
            assert_eq!(answer(&[8, 0, 11, 0, 0], wrong), None);
        }
    }
}
