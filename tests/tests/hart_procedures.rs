//! What takes several HART frames: each frame knows its procedure and its step, and what was not
//! ended is said (issue of the HART decoding; sections 8.1, 9.4 and 10.1 of PUB092-003-00).

use shared::decode::{Context, decode_frame};
use shared::device::{Device, Family};
use shared::frame::{Framing, Role, scan};
use shared::hart::frame::{FILL, long_address, seal};
use shared::hart::procedure::{Doubt, Procedure, Procedures, Step};
use shared::json;

const ID: u32 = 0x01_2345;

/// A list of frames, as they would be on a line.
#[derive(Default)]
struct List {
    procedures: Procedures,
    index: u32,
    id: u32,
    secondary: bool,
}

impl List {
    fn new() -> Self {
        Self {
            id: ID,
            ..Self::default()
        }
    }

    fn frame(&mut self, bytes: &[u8]) -> Option<Step> {
        let step = self.procedures.frame(Framing::Hart, bytes, self.index);
        self.index += 1;
        step
    }

    fn send(&mut self, delimiter: u8, command: u16, front: &[u8], data: &[u8]) -> Option<Step> {
        let address = long_address(0x6EDD, self.id, !self.secondary);
        let (own, inner) = match command {
            0..=255 => (command as u8, vec![]),
            _ => (31, command.to_be_bytes().to_vec()),
        };
        let body = [front, &inner, data].concat();
        let frame = seal(delimiter, &address, own, &body);
        self.frame(&[vec![FILL; 5], frame].concat())
    }

    fn ask(&mut self, command: u16, data: &[u8]) -> Option<Step> {
        self.send(0x82, command, &[], data)
    }

    fn answer(&mut self, command: u16, code: u8, data: &[u8]) -> Option<Step> {
        self.send(0x86, command, &[code, 0], data)
    }

    /// A request and the answer that repeats it.
    fn does(&mut self, command: u16, data: &[u8]) -> (Step, Step) {
        let asks = self.ask(command, data).unwrap();
        (asks, self.answer(command, 0, data).unwrap())
    }
}

fn milliampere(current: f32) -> [u8; 4] {
    current.to_be_bytes()
}

#[test]
fn an_identification_goes_from_command_0_to_the_tags() {
    let mut list = List::new();
    // Frame P1 of the readings, and R2 without its cold start.
    let asks = list.frame(&[0x02, 0x80, 0, 0, 0x82]).unwrap();
    assert_eq!((asks.procedure, asks.key), (Procedure::Identify, "find"));
    let identity = [
        0, 0, 0xFE, 0x6E, 0xDD, 5, 7, 2, 1, 8, 0, 1, 0x23, 0x45, 5, 5, 0, 7, 0, 0, 0x6E, 0, 0x6E, 1,
    ];
    let found = list.frame(&seal(0x06, &[0x80], 0, &identity)).unwrap();
    assert_eq!(found.run, asks.run);
    for command in [20, 13, 12, 7] {
        let step = list.ask(command, &[]).unwrap();
        assert_eq!(
            (step.procedure, step.run, step.key),
            (Procedure::Identify, asks.run, "read-about"),
            "{command}"
        );
        let step = list.answer(command, 0, &[0; 32]).unwrap();
        assert_eq!(step.run, asks.run);
    }
    // Values end it: what is read about the device later is not part of it.
    assert_eq!(list.ask(3, &[]), None);
    assert_eq!(list.answer(3, 0, &[0; 24]), None);
    assert_eq!(list.ask(20, &[]), None);
    assert!(list.procedures.open().is_empty());
}

#[test]
fn a_trim_fixes_trims_and_leaves() {
    let mut list = List::new();
    let (fix, fixed) = list.does(40, &milliampere(4.0));
    assert_eq!(fix.procedure, Procedure::Trim);
    assert_eq!((fix.key, fix.run, fixed.run), ("fix-current", 1, 1));
    let (zero, _) = list.does(45, &milliampere(4.02));
    assert_eq!(
        (zero.key, zero.run, &zero.doubts[..]),
        ("trim-zero", 1, &[][..])
    );
    assert!(zero.text.contains("4.02 mA"), "{}", zero.text);
    assert_eq!(
        list.procedures.open()[0].to_string(),
        "Fixed current mode was not left again: the valve may still follow a simulated signal (device 2EDD012345, since frame 1)."
    );
    let (gain, _) = list.does(46, &milliampere(19.9));
    assert_eq!(gain.doubts, [Doubt::OtherEnd(4.0, 20.0)]);
    list.does(40, &milliampere(20.0));
    let (gain, trimmed) = list.does(46, &milliampere(19.9));
    assert_eq!(
        (gain.key, gain.doubts.len(), trimmed.run),
        ("trim-gain", 0, 1)
    );
    let (leave, left) = list.does(40, &milliampere(0.0));
    assert_eq!((leave.key, left.run), ("end-fixed-current", 1));
    assert!(list.procedures.open().is_empty());
    // The next one is another run; a trim without fixed current is said.
    let (alone, _) = list.does(45, &milliampere(4.0));
    assert_eq!((alone.run, &alone.doubts[..]), (2, &[Doubt::NotFixed][..]));
}

#[test]
fn a_mode_stands_only_if_the_device_agreed() {
    let mut list = List::new();
    let step = list.ask(40, &milliampere(12.0)).unwrap();
    assert!(list.procedures.open().is_empty(), "only asked");
    let refused = list.answer(40, 11, &[]).unwrap();
    assert_eq!(
        (refused.run, &refused.doubts[..]),
        (step.run, &[Doubt::Refused(11)][..])
    );
    assert!(list.procedures.open().is_empty());
    // A communication error: nothing was done.
    list.ask(40, &milliampere(12.0));
    let damaged = list.answer(40, 0x88, &[]).unwrap();
    assert_eq!(damaged.doubts, [Doubt::Damaged]);
    assert!(list.procedures.open().is_empty());
    // No answer at all: it is not known. The same request again is a repetition.
    list.ask(40, &milliampere(12.0));
    assert_eq!(list.ask(40, &milliampere(12.0)).unwrap().doubts, []);
    let next = list.ask(45, &milliampere(4.0)).unwrap();
    assert!(next.doubts.contains(&Doubt::Unanswered(40)), "{next:?}");
}

#[test]
fn the_map_is_read_in_pages() {
    let mut list = List::new();
    let page =
        |first: u8, count: u8| [vec![first, count], vec![0; usize::from(count) / 2]].concat();
    for first in [0, 32] {
        let asks = list.ask(523, &[first, 32]).unwrap();
        assert_eq!(
            (asks.procedure, asks.run, &asks.doubts[..]),
            (Procedure::StatusMap, 1, &[][..])
        );
        let reads = list.answer(523, 0, &page(first, 32)).unwrap();
        assert_eq!(
            reads.text,
            format!("Entries {first} to {} of the map.", first + 31)
        );
    }
    let (write, _) = list.does(524, &[8, 2, 0x31]);
    assert_eq!((write.key, write.run), ("write-map", 1));
    let (reset, _) = list.does(525, &[]);
    assert_eq!(reset.key, "reset-map");
    // A page that leaves entries out.
    list.does(526, &[0]);
    list.ask(523, &[0, 8]);
    list.answer(523, 0, &page(0, 8));
    let next = list.ask(523, &[16, 8]).unwrap();
    assert_eq!(next.doubts, [Doubt::Skipped(8, 15)]);
    assert_eq!(
        next.doubts[0].to_string(),
        "Entries 8 to 15 of the map were left out."
    );
}

#[test]
fn simulation_goes_on_and_off() {
    let mut list = List::new();
    let early = list.ask(527, &[9, 1]).unwrap();
    assert_eq!(early.doubts, [Doubt::NotSimulated]);
    list.answer(527, 16, &[]);
    let (on, _) = list.does(526, &[1]);
    let (bit, _) = list.does(527, &[9, 1]);
    assert_eq!(
        (bit.key, bit.run, &bit.doubts[..]),
        ("simulate-bit", on.run, &[][..])
    );
    let open = list.procedures.open();
    assert_eq!(
        (open.len(), open[0].procedure),
        (1, Procedure::StatusSimulation)
    );
    list.does(526, &[0]);
    assert!(list.procedures.open().is_empty());
}

#[test]
fn forced_modes_are_given_back_or_said() {
    let mut list = List::new();
    // Frames R14 and R15: the demand at 25 %.
    let (_, forced) = list.does(79, &[1, 1, 57, 0x41, 0xC8, 0, 0, 0]);
    assert_eq!(
        forced.text,
        "Device variable 1 is forced to 25 %; the signal does not count."
    );
    // Frames R17 and R18: 22h closes; 00h returns, and ends what command 79 forced.
    let (close, _) = list.does(132, &[0x22]);
    assert_eq!(close.text, "Asks for digital control: close.");
    let open: Vec<Procedure> = list.procedures.open().iter().map(|o| o.procedure).collect();
    assert_eq!(open, [Procedure::ForcedVariable, Procedure::DigitalControl]);
    list.does(132, &[0x00]);
    assert!(list.procedures.open().is_empty());
    list.does(79, &[4, 1, 57, 0x41, 0xC8, 0, 0, 0]);
    list.does(79, &[4, 0, 57, 0, 0, 0, 0, 0]);
    assert!(list.procedures.open().is_empty());
    // A reset ends all (section 8.1).
    list.does(40, &milliampere(12.0));
    list.does(526, &[1]);
    let (_, reset) = list.does(42, &[]);
    assert_eq!(reset.doubts, [Doubt::Reset]);
    assert!(list.procedures.open().is_empty());
}

#[test]
fn devices_and_masters_are_told_apart() {
    let mut list = List::new();
    list.does(40, &milliampere(12.0));
    list.id = 0x99;
    let (other, _) = list.does(40, &milliampere(8.0));
    assert_eq!(other.run, 2);
    list.does(40, &milliampere(0.0));
    list.id = ID;
    assert_eq!(list.procedures.open().len(), 1);
    // The other master ends it.
    list.secondary = true;
    let (end, _) = list.does(40, &milliampere(0.0));
    assert_eq!((end.run, &end.doubts[..]), (1, &[Doubt::OtherMaster][..]));
    assert!(list.procedures.open().is_empty());
}

#[test]
fn delayed_answers_are_followed() {
    let mut list = List::new();
    let tag = [b'A'; 32];
    assert_eq!(list.ask(22, &tag), None);
    let begun = list.answer(22, 33, &[]).unwrap();
    assert_eq!((begun.procedure, begun.key), (Procedure::Delayed, "begun"));
    assert_eq!(list.ask(22, &tag).unwrap().run, begun.run);
    assert_eq!(list.answer(22, 34, &[]).unwrap().key, "running");
    assert_eq!(list.procedures.open().len(), 1);
    list.ask(22, &tag);
    assert_eq!(list.answer(22, 0, &tag).unwrap().key, "done");
    assert!(list.procedures.open().is_empty());
    assert_eq!(list.ask(22, &tag), None, "a new one");
}

/// An answer belongs to the request of the same master; bursts and the other master's exchanges
/// between do not change that, and nobody's answer is paired with a stranger's request.
#[test]
fn pairs_hold_beside_bursts_and_a_second_master() {
    let long = |id, primary| long_address(0x6EDD, id, primary);
    let burst = seal(
        0x81,
        &[0xE6, 0x4E, 0x0B, 0, 1],
        3,
        &[0, 0, 0x41, 0x33, 0x33, 0x33, 32, 0x41, 0xBC, 0, 0],
    );
    let frames = [
        seal(0x82, &long(1, true), 3, &[]),
        burst.clone(),
        seal(0x86, &long(1, true), 3, &[0; 26]),
        burst,
        seal(0x82, &long(2, false), 3, &[]),
        // The secondary gives up and the primary asks the same device.
        seal(0x82, &long(2, true), 3, &[]),
        // An answer to the secondary is none to the primary.
        seal(0x86, &long(2, false), 3, &[0; 26]),
        seal(0x86, &long(2, true), 3, &[0; 26]),
        // Another command, and another device: no pair.
        seal(0x82, &long(1, true), 1, &[]),
        seal(0x86, &long(1, true), 2, &[0; 10]),
        seal(0x86, &long(3, true), 1, &[0; 7]),
        seal(0x86, &long(1, true), 1, &[0; 7]),
        // Extended commands are told apart by the number inside.
        seal(0x82, &long(1, true), 31, &[2, 0x0B, 0, 8]),
        seal(0x86, &long(1, true), 31, &[0, 0, 2, 0x0C, 8, 2, 0]),
        seal(0x86, &long(1, true), 31, &[0, 0, 2, 0x0B, 0, 8, 0, 0, 0, 0]),
    ];
    let bytes: Vec<u8> = frames
        .iter()
        .flat_map(|f| [vec![FILL; 5], f.clone()].concat())
        .collect();
    let found = scan(&bytes, Framing::Hart);
    assert_eq!(found.len(), frames.len());
    let pairs: Vec<Option<u32>> = found.iter().map(shared::frame::Frame::pair).collect();
    let expected = [
        Some(2),
        None,
        Some(0),
        None,
        None,
        Some(7),
        None,
        Some(5),
        Some(11),
        None,
        None,
        Some(8),
        Some(14),
        None,
        Some(12),
    ];
    assert_eq!(pairs, expected);
    assert_eq!(found[1].role, Role::Burst);
}

/// The key that the README documents.
#[test]
fn json_has_the_step() {
    let bytes = seal(0x82, &long_address(0x6EDD, ID, true), 40, &milliampere(4.0));
    let frame = scan(&bytes, Framing::Hart)[0];
    let context = Context {
        framing: Framing::Hart,
        device: Device::Rotork(Family::Iq),
    };
    let tree = decode_frame(&frame, &bytes, None, &context);
    let mut procedures = Procedures::new();
    let step = procedures.frame(Framing::Hart, &bytes, 0);
    let mut line = String::new();
    json::write_hart_frame(&mut line, 0, &frame, Framing::Hart, &tree, step.as_ref()).unwrap();
    let line: serde_json::Value = serde_json::from_str(&line).unwrap();
    assert_eq!(line["procedure"]["name"], "trim");
    assert_eq!(line["procedure"]["step"], "fix-current");
    assert_eq!(line["procedure"]["run"], 1);
    assert!(line["procedure"]["warnings"].as_array().unwrap().is_empty());
    // Without a step nothing changes.
    let (mut with, mut without) = (String::new(), String::new());
    json::write_hart_frame(&mut with, 0, &frame, Framing::Hart, &tree, None).unwrap();
    json::write_frame(&mut without, 0, &frame, Framing::Hart, &tree).unwrap();
    assert_eq!(with, without);
    // HART-IP carries the same frame behind its header.
    let mut message = vec![1, 0, 3, 0, 0, 1, 0, 8 + bytes.len() as u8];
    message.extend(&bytes);
    let over_ip = Procedures::new().frame(Framing::HartIp, &message, 0);
    assert_eq!(over_ip, step);
}
