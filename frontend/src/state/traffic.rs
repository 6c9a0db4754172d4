//! Which frames of a bus are listed, and the frames as a file.

use shared::capture::Micros;
use shared::frame::Role;
use shared::render::Spaced;
use shared::session::Session;

/// What the list is narrowed to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Only this unit.
    pub unit: Option<u8>,
    /// Only this function.
    pub function: Option<u8>,
    /// Only noise, damaged frames and exceptions.
    pub problems: bool,
    /// Only frames from this number on.
    pub from: u32,
}

/// The numbers of the frames that pass, in order.
#[must_use]
pub fn listed(session: &Session, filter: &Filter) -> Vec<u32> {
    (session.first().max(filter.from)..session.len())
        .filter(|index| {
            session.frame(*index).is_some_and(|f| {
                let bad = f.is_noise() || f.marks.is_damaged() || f.role == Role::Exception;
                filter.unit.is_none_or(|u| u == f.unit && !f.is_noise())
                    && filter
                        .function
                        .is_none_or(|code| code == f.function & 0x7F && !f.is_noise())
                    && (!filter.problems || bad)
            })
        })
        .collect()
}

/// Frames as hexadecimal text, one a line, with the time since the start of the backend where it is
/// known; to be kept or decoded again.
#[must_use]
pub fn export(session: &Session, frames: &[u32]) -> String {
    let mut text = String::new();
    for index in frames {
        let Some(bytes) = session.bytes(*index) else {
            continue;
        };
        if let Some(at) = session.at(*index) {
            text.push_str(&clock(at));
        }
        text.push_str(&format!("{}\n", Spaced(bytes)));
    }
    text
}

/// `01:02:03.000456 `; days are left out.
fn clock(at: Micros) -> String {
    let (seconds, part) = (at.get() / 1_000_000, at.get() % 1_000_000);
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{hour:02}:{minute:02}:{second:02}.{part:06} ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use shared::encode::frame;
    use shared::frame::Framing;

    fn session() -> Session {
        let mut bytes = Vec::new();
        for (unit, pdu) in [
            (9, &[3, 0, 0, 0, 1][..]),
            (9, &[3, 2, 0, 0]),
            (7, &[4, 0, 0, 0, 1]),
            (7, &[0x84, 2]),
        ] {
            bytes.extend(frame(Framing::Rtu, 0, unit, pdu));
        }
        load(&bytes, Some(Framing::Rtu)).session
    }

    #[test]
    fn filters_narrow() {
        let session = session();
        let all = Filter::default();
        assert_eq!(listed(&session, &all), [0, 1, 2, 3]);
        let unit = Filter {
            unit: Some(7),
            ..all.clone()
        };
        assert_eq!(listed(&session, &unit), [2, 3]);
        let function = Filter {
            function: Some(4),
            ..all.clone()
        };
        assert_eq!(listed(&session, &function), [2, 3]);
        let problems = Filter {
            problems: true,
            ..all.clone()
        };
        assert_eq!(listed(&session, &problems), [3]);
        let late = Filter { from: 3, ..all };
        assert_eq!(listed(&session, &late), [3]);
    }

    #[test]
    fn an_export_is_decoded_again() {
        let session = session();
        let text = export(&session, &[0, 1]);
        assert_eq!(load(text.as_bytes(), None).session.len(), 2);
    }

    /// By hand: 25 h 1 min 2.5 s leave one hour of a day.
    #[test]
    fn an_export_has_times() {
        assert_eq!(clock(Micros::new(90_062_500_000)), "01:01:02.500000 ");
        let mut session = Session::new(Framing::Rtu);
        let bytes = frame(Framing::Rtu, 0, 9, &[3, 0, 0, 0, 1]);
        session.push(&shared::capture::Capture {
            at: Some(Micros::new(1_000_002)),
            ..shared::capture::Capture::of(&bytes)
        });
        session.finish();
        let text = export(&session, &[0]);
        assert!(text.starts_with("00:00:01.000002 09 03 00 00"), "{text}");
        assert_eq!(
            load(text.as_bytes(), None).session.bytes(0),
            Some(&bytes[..])
        );
    }
}
