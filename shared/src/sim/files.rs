//! FC 20: logs and curves as files (section 8.11). Layout by Modbus Application Protocol V1.1b3, section
//! 6.14; the manual prints neither the response nor its exceptions (reading E66).

use super::Icon3000;
use super::answer::{ILLEGAL_ADDRESS, ILLEGAL_VALUE, Outcome};

/// Most data bytes of a response.
const MOST: usize = 245;

/// Reference type of every sub-request.
const REFERENCE: u8 = 6;

impl Icon3000 {
    pub(super) fn files(&self, data: &[u8]) -> Outcome {
        let Some((count, requests)) = data.split_first() else {
            return Err(ILLEGAL_VALUE);
        };
        let sound = (7..=MOST).contains(&usize::from(*count))
            && usize::from(*count) == requests.len()
            && requests.len().is_multiple_of(7);
        if !sound {
            return Err(ILLEGAL_VALUE);
        }
        let mut answer = vec![0];
        for request in requests.chunks_exact(7) {
            let &[reference, f0, f1, r0, r1, l0, l1] = request else {
                return Err(ILLEGAL_VALUE);
            };
            let number = |high, low| usize::from(u16::from_be_bytes([high, low]));
            let file = match number(f0, f1) {
                2 => self.alarms.file(),
                3 => self.warnings.file(),
                number => {
                    let number = u16::try_from(number).map_err(|_| ILLEGAL_ADDRESS)?;
                    self.history.file(number).ok_or(ILLEGAL_ADDRESS)?
                }
            };
            let (first, len) = (number(r0, r1), number(l0, l1));
            if reference != REFERENCE || len == 0 {
                return Err(ILLEGAL_ADDRESS);
            }
            let records = file.get(first..first.saturating_add(len));
            let records = records.ok_or(ILLEGAL_ADDRESS)?;
            let bytes = records.len().saturating_mul(2).saturating_add(1);
            answer.push(u8::try_from(bytes).map_err(|_| ILLEGAL_VALUE)?);
            answer.push(REFERENCE);
            answer.extend(records.iter().flat_map(|r| r.to_be_bytes()));
        }
        let total = answer.len().saturating_sub(1);
        if total > MOST {
            return Err(ILLEGAL_VALUE);
        }
        if let Some(first) = answer.first_mut() {
            *first = u8::try_from(total).unwrap_or(u8::MAX);
        }
        Ok(answer)
    }
}
