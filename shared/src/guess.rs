//! Which device a stream is about, judged by what it says of itself and by the addresses it names.

use crate::address::{Address, Table};
use crate::decode::pdu_of;
use crate::device::Device;
use crate::frame::Role;
use crate::map::row::Kind;
use crate::pdu::Asked;
use crate::session::Session;

/// How many entries are looked at.
const SAMPLE: u32 = 5000;

/// The lowest holding register of the ICON3000 family that other devices seldom have.
const TELLING: u16 = 3000;

/// A device with the reason for choosing it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Guess {
    /// What it is taken for.
    pub device: Device,
    /// Why, in words.
    pub reason: String,
}

/// Looks for an identification (FC 17), then for addresses that only one family of devices has.
#[must_use]
pub fn device(session: &Session) -> Guess {
    if !cfg!(feature = "maps") {
        return Guess::default();
    }
    let mut seen: Option<Guess> = None;
    for index in 0..session.len().min(SAMPLE) {
        let Some(frame) = session.frame(index) else {
            continue;
        };
        if frame.is_noise() || frame.marks.is_damaged() {
            continue;
        }
        let Some(pdu) = session
            .bytes(index)
            .and_then(|bytes| pdu_of(bytes, session.framing()))
        else {
            continue;
        };
        if frame.function == 17 && frame.role == Role::Response {
            if let Some(guess) = by_report(&pdu) {
                return guess;
            }
        } else if frame.role != Role::Response && frame.role != Role::Exception {
            seen = seen.or_else(|| by_address(&pdu));
        }
    }
    seen.unwrap_or_else(|| Guess {
        device: Device::None,
        reason: "no address of a known device in it".to_owned(),
    })
}

/// The ICON3000 names itself, and its interface firmware tells the model.
fn by_report(pdu: &[u8]) -> Option<Guess> {
    let has_name = pdu.windows(8).any(|part| part == b"ICON3000");
    let revision = pdu.last_chunk::<4>().filter(|_| has_name)?;
    let revision: String = revision.iter().map(|b| char::from(*b)).collect();
    let is_new = revision
        .chars()
        .find(char::is_ascii_digit)
        .is_some_and(|major| major >= '4');
    Some(Guess {
        device: if is_new {
            Device::Icon3000v2
        } else {
            Device::Icon3000
        },
        reason: format!("it reports itself, interface firmware {}", revision.trim()),
    })
}

/// A holding register from 3000 on that the map defines.
fn by_address(pdu: &[u8]) -> Option<Guess> {
    let asked = Asked::new(pdu);
    let start = match asked.function() {
        3 => asked.read()?.1,
        6 | 16 | 22 | 23 => Address::new(asked.word(1)?),
        _ => return None,
    };
    if start.get() < TELLING {
        return None;
    }
    let row = Device::Icon3000v2.map()?.row_at(Table::Holding, start)?;
    (row.kind != Kind::Reserved || start.get() == TELLING).then(|| Guess {
        device: Device::Icon3000v2,
        reason: format!("register address {start} is in its map"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Capture;
    use crate::encode::frame;
    use crate::frame::Framing;

    fn guess(pdus: &[&[u8]]) -> Device {
        let mut session = Session::new(Framing::Rtu);
        for pdu in pdus {
            session.push(&Capture::of(&frame(Framing::Rtu, 0, 9, pdu)));
        }
        session.finish();
        device(&session).device
    }

    #[test]
    fn addresses_tell() {
        assert_eq!(guess(&[&[3, 0x0B, 0xB8, 0, 31]]), Device::Icon3000v2);
        assert_eq!(guess(&[&[3, 0, 7, 0, 3]]), Device::None);
        assert_eq!(guess(&[]), Device::None);
    }

    #[test]
    fn a_report_tells_the_model() {
        let report = |revision: &[u8]| {
            let mut pdu = vec![17, 84, 0, 0xFF];
            pdu.extend_from_slice(b"Biffi ICON3000  ");
            pdu.extend_from_slice(&[b' '; 62]);
            pdu.extend_from_slice(revision);
            guess(&[&[17], &pdu])
        };
        assert_eq!(report(b"4.01"), Device::Icon3000v2);
        assert_eq!(report(b"2.03"), Device::Icon3000);
    }
}
