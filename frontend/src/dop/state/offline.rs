//! What a pasted text is: the registers of one object, a capture of a whole session, or a file of
//! saved reads.

use std::sync::Arc;

use shared::capture::Capture;
use shared::dop::handshake::Position;
use shared::dop::object::{Choice, Object};
use shared::dop::recognise::{Areas, Exchange, FoundRead, recognise};
use shared::dop::{ObjectRead, Profile, Request, input};
use shared::frame::Framing;
use shared::session::Session;
use shared::text::{Form, HexReader};

use super::kept::{Course, Decoded, Kept};
use super::saved::Saved;
use crate::chart::ticks::ordered;
use crate::state::load::load;

/// A request that fits the registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The word.
    pub request: Request,
    /// The object.
    pub object: &'static Object,
    /// Its option.
    pub choice: &'static Choice,
    /// Times that are possible for such a unit, and all times.
    pub times: (usize, usize),
}

/// A read that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The registers and what they mean.
    pub decoded: Decoded,
    /// Unit address, in a capture.
    pub unit: Option<u8>,
    /// True if something of it is missing.
    pub incomplete: bool,
}

/// What a text is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Offline {
    /// What it was taken for, in words.
    pub said: String,
    /// What in it could not be used.
    pub problems: Vec<String>,
    /// The reads.
    pub items: Vec<Item>,
    /// Requests whose answer has so many registers, the likeliest first; only if nobody said which.
    pub fits: Vec<Fit>,
    /// True if the registers are those of one object.
    pub registers: bool,
}

impl Offline {
    /// Reads a text. `request` is what the user says was asked for.
    #[must_use]
    pub fn open(text: &str, request: Option<Request>, profile: &Arc<Profile>) -> Self {
        if text.trim().is_empty() {
            return Self::default();
        }
        if text.trim_start().starts_with('{') && text.contains("valvescope-dop-reads") {
            return Self::saved(text, profile);
        }
        // A capture proves itself by its check values and by the course of a read; few registers
        // would pass for one.
        if request.is_none()
            && let Some(found) = Self::capture(text, profile)
        {
            return found;
        }
        Self::registers(text, request, profile)
    }

    fn saved(text: &str, profile: &Arc<Profile>) -> Self {
        match Saved::from_json(text) {
            Ok(saved) => Self {
                said: format!("Saved reads of {}.", named(&saved.device)),
                items: saved
                    .reads
                    .into_iter()
                    .map(|kept| Item::plain(kept, profile))
                    .collect(),
                ..Self::default()
            },
            Err(problem) => Self {
                problems: vec![problem],
                ..Self::default()
            },
        }
    }

    fn capture(text: &str, profile: &Arc<Profile>) -> Option<Self> {
        let loaded = load(text.as_bytes(), None);
        let timed = timed(text, loaded.session.framing());
        let session = timed.as_ref().unwrap_or(&loaded.session);
        let found = recognise(&Exchange::all(session), profile);
        if found.reads.is_empty() {
            return None;
        }
        let areas = found
            .areas
            .map_or_else(String::new, |a| place(&a, found.inferred));
        let reads =
            crate::format::count(u64::try_from(found.reads.len()).unwrap_or(0), "object read");
        let framing = loaded.session.framing().label();
        Some(Self {
            said: format!("{framing} capture with {reads}. {areas}"),
            items: found
                .reads
                .into_iter()
                .map(|read| Item::found(read, profile))
                .collect(),
            ..Self::default()
        })
    }

    fn registers(text: &str, request: Option<Request>, profile: &Arc<Profile>) -> Self {
        let input = input::read(text, None);
        let problems = input
            .problems
            .iter()
            .take(20)
            .map(|p| format!("line {}, column {}: {}", p.line, p.column, p.text));
        let mut offline = Self {
            said: input.said.clone(),
            problems: problems.collect(),
            registers: true,
            ..Self::default()
        };
        if input.words.is_empty() {
            return offline;
        }
        if request.is_none() {
            offline.fits = fits(&input.words, profile);
        }
        let chosen = request.or_else(|| offline.fits.first().map(|fit| fit.request));
        // Object 0 is none: the registers are shown as they are.
        let kept = Kept::new(chosen.unwrap_or_default(), input.words, "pasted");
        offline.items.push(Item::plain(kept, profile));
        offline
    }
}

/// The session of a text whose lines begin with times; `None` if none does.
fn timed(text: &str, framing: Framing) -> Option<Session> {
    if shared::text::form_for(text.as_bytes(), Some(framing)) != Form::Hex {
        return None;
    }
    let (mut bytes, mut problems) = (Vec::new(), Vec::new());
    let mut reader = HexReader::with_stamps();
    reader.push(text.as_bytes(), &mut bytes, &mut problems);
    reader.finish(&mut bytes, &mut problems);
    let (first, _) = reader.stamps().first()?;
    let place = |offset: u64| usize::try_from(offset).unwrap_or(bytes.len());
    let mut session = Session::new(framing);
    session.push(&Capture::of(&bytes[..place(*first)]));
    for (index, (from, at)) in reader.stamps().iter().enumerate() {
        let next = reader.stamps().get(index + 1);
        let end = next.map_or(bytes.len(), |(offset, _)| place(*offset));
        session.push(&Capture {
            at: Some(*at),
            ..Capture::of(&bytes[place(*from)..end])
        });
    }
    session.finish();
    Some(session)
}

/// Requests whose answer has so many registers, the likeliest first.
fn fits(words: &[u16], profile: &Arc<Profile>) -> Vec<Fit> {
    let fits: Vec<Fit> = ObjectRead::candidates(words.len())
        .map(|c| Fit {
            request: c.request,
            object: c.object,
            choice: c.choice,
            times: ObjectRead::read(c.request, words, profile).plausible_times(),
        })
        .collect();
    // Equals stay in the order of the manual.
    let doubts = |at: usize| fits[at].times.1 - fits[at].times.0;
    let order = ordered(fits.len(), &|a, b| doubts(a) < doubts(b));
    order.into_iter().map(|at| fits[at]).collect()
}

fn named(device: &str) -> &str {
    if device.is_empty() {
        "a device"
    } else {
        device
    }
}

/// Where the areas are.
fn place(areas: &Areas, inferred: bool) -> String {
    let how = if inferred {
        "Their addresses were inferred from the pattern"
    } else {
        "Their addresses are those of the profile"
    };
    format!(
        "{how}: request {}, status {}, count {}, response {}.",
        areas.request, areas.status, areas.count, areas.response
    )
}

impl Item {
    fn plain(kept: Kept, profile: &Arc<Profile>) -> Self {
        Self {
            decoded: Decoded::new(kept, profile),
            unit: None,
            incomplete: false,
        }
    }

    fn found(read: FoundRead, profile: &Arc<Profile>) -> Self {
        let course = read.took().map(|took_us| Course {
            took_us,
            busy_us: read.busy().unwrap_or(0),
            polls: read.polls,
            ..Course::default()
        });
        let mut problems = read.problems;
        if let Position::Learned(shift) | Position::Likely(shift) = read.position {
            let sure = if matches!(read.position, Position::Learned(_)) {
                "learned from this exchange"
            } else {
                "likely, by this exchange"
            };
            problems.push(format!("Status bits from bit {} on: {sure}.", shift.bit()));
        }
        let mut kept = Kept::new(read.request, read.words, "capture");
        kept.course = course;
        kept.error = read.error.is_some();
        kept.remarks = problems;
        Self {
            decoded: Decoded::new(kept, profile),
            unit: Some(read.unit),
            incomplete: !read.complete && read.error.is_none(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(text: &str, request: Option<u16>) -> Offline {
        let profile = Arc::new(Profile::default());
        Offline::open(text, request.map(Request::from_word), &profile)
    }

    /// Object 405: open torque 42.5 % at 2021-02-12 15:29:15, close torque 31.0 %, never.
    const TORQUE: &str = "9ECB 6026 0000 0000 01A9 0000 0000 0000 0000 0136";

    #[test]
    fn registers_find_their_object_by_number_and_times() {
        let offline = open(TORQUE, None);
        assert!(offline.registers);
        let fits: Vec<_> = offline.fits.iter().map(|f| f.request.word()).collect();
        // Ten registers: 405 and 605.
        assert_eq!(fits, [405, 605]);
        assert_eq!(offline.items.len(), 1);
        let read = &offline.items[0].decoded.read;
        assert_eq!(
            read.number("open")
                .or(read.number("open_max"))
                .map(|n| n.raw),
            Some(425)
        );
    }

    #[test]
    fn the_user_knows_better() {
        let offline = open(TORQUE, Some(605));
        assert!(offline.fits.is_empty());
        assert_eq!(
            offline.items[0].decoded.read.object.map(|o| o.id),
            Some(605)
        );
    }

    #[test]
    fn what_fits_nothing_is_shown_raw() {
        let offline = open("0001 0002 0003", None);
        assert!(offline.fits.is_empty());
        let read = &offline.items[0].decoded.read;
        assert!(read.object.is_none());
        assert_eq!(read.words, [1, 2, 3]);
        assert_eq!(open("  ", None), Offline::default());
        assert!(!open("what is this", None).problems.is_empty());
    }

    #[test]
    fn saved_reads_are_opened() {
        let file = Saved {
            device: "MX-301".into(),
            reads: vec![Kept::new(Request::from_word(405), vec![0; 10], "")],
        };
        let offline = open(&file.to_json(), None);
        assert_eq!(offline.said, "Saved reads of MX-301.");
        assert_eq!(offline.items.len(), 1);
        assert!(
            open("{\"format\":\"valvescope-dop-reads\"}", None)
                .problems
                .len()
                == 1
        );
    }

    /// The lines of the sample are 60 ms apart. By hand: the request is in the first, the status is
    /// ready in the sixth, the registers are in the tenth; it is read three times, once afterwards.
    #[test]
    fn a_session_has_its_timing() {
        let text = include_str!("../../../../static/samples/dop-session.txt");
        let offline = open(text, None);
        assert!(offline.items.len() >= 2);
        let course = offline.items[0].decoded.kept.course.as_ref().unwrap();
        assert_eq!((course.took_us, course.busy_us), (540_000, 300_000));
        assert_eq!(course.polls, 3);
        // The same without times.
        let bare: String = text
            .lines()
            .map(|l| format!("{}\n", l.split_once(' ').map_or("", |(_, bytes)| bytes)))
            .collect();
        let bare = open(&bare, None);
        assert_eq!(bare.items.len(), offline.items.len());
        assert_eq!(
            bare.items[0].decoded.read.words,
            offline.items[0].decoded.read.words
        );
        assert!(bare.items[0].decoded.kept.course.is_none());
    }
}
