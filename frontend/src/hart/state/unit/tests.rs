//! A device that hears made-up exchanges.

use super::*;
use crate::state::absorb::bytes_of;

/// The worked exchange R5, R6: 12 mA, demand 50 %, position 49.5 %, torque 12.5 %, no fourth.
pub(crate) const POLL: (&str, &str) = (
    "82AEDD012345030095",
    "86AEDD012345031A0000414000003942480000394246000039414800003 97FA0000052",
);
/// The worked exchange R9, R10 of command 48.
pub(crate) const STATUS: (&str, &str) = (
    "82AEDD0123453000A6",
    "86AEDD012345300B009002000200A440080000D5",
);

pub(crate) fn hex(text: &str) -> Vec<u8> {
    bytes_of(&text.replace(' ', ""))
}

pub(crate) fn unit(exchanges: &[(u16, &str, &str)]) -> Unit {
    let mut unit = Unit::new("FV-1".into(), Some(Family::Iq), "loop".into());
    for (command, request, response) in exchanges {
        let (request, response) = (hex(request), hex(response));
        unit.take(&request, &response, *command, (Outcome::Ok, ""), (7, 2, 1));
    }
    unit
}

#[test]
fn values_come_from_the_bytes() {
    let unit = unit(&[(3, POLL.0, POLL.1), (48, STATUS.0, STATUS.1)]);
    assert_eq!(unit.text(3, "pv").as_deref(), Some("50 %"));
    assert_eq!(unit.text(3, "sv").as_deref(), Some("49.5 %"));
    assert_eq!(unit.text(3, "loop_current").as_deref(), Some("12 mA"));
    assert_eq!(unit.raw(48, "byte_4"), Some(0xA4));
    assert_eq!(unit.status, Some((0x90, 7)));
    let moment = &unit.trend[0];
    assert_eq!(moment.values[2], Some((49.5, "49.5".into())));
    assert_eq!(unit.reading(&plain(13)), None, "not read is not there");
    assert!(unit.has(133) && !unit.has(129) && !unit.has(33));
}

/// A frame of the device with its check byte.
pub(crate) fn answer(command: u8, status: u8, data: &[u8]) -> Vec<u8> {
    let data = [&[0, status], data].concat();
    shared::hart::frame::seal(0x86, &[0xAE, 0xDD, 1, 0x23, 0x45], command, &data)
}

/// A request to it.
pub(crate) fn request(command: u8, data: &[u8]) -> Vec<u8> {
    shared::hart::frame::seal(0x82, &[0xAE, 0xDD, 1, 0x23, 0x45], command, data)
}

/// Takes an answer in that came at a second.
pub(crate) fn hear(unit: &mut Unit, command: u8, status: u8, data: &[u8], second: u64) {
    let (asked, answer) = (request(command, &[]), answer(command, status, data));
    let ok = (Outcome::Ok, "");
    let at = (second * 1_000_000, 2, 1);
    unit.take(&asked, &answer, command.into(), ok, at);
}

/// Loop current 12 mA, and this primary variable in percent; no others.
pub(crate) fn poll(pv: f32) -> Vec<u8> {
    let [a, b, c, d] = pv.to_be_bytes();
    vec![0x41, 0x40, 0, 0, 57, a, b, c, d]
}

/// Command 0 by its lengths: HART 5 answers 12 bytes, HART 6 17 and HART 7 22; the counter is
/// bytes 14 and 15.
pub(crate) fn identity_of(revision: u8, counter: u8) -> Vec<u8> {
    let mut data = vec![254, 0x6E, 0xDD, 7, revision, 2, 1, 8, 0, 1, 0x23, 0x45];
    match revision {
        6 => data.extend([5, 5, 0, counter, 0]),
        7 => data.extend([5, 4, 0, counter, 0, 0, 0x6E, 0, 0x6E, 1]),
        _ => {}
    }
    data
}

#[test]
fn devices_of_every_revision_have_their_long_address() {
    for revision in 5..=7 {
        let mut unit = unit(&[]);
        assert_eq!(unit.address(), None);
        hear(&mut unit, 0, 0, &identity_of(revision, 1), 1);
        assert_eq!(unit.address(), Some(Address::Long(0x2EDD, 0x01_2345)));
    }
}

#[test]
fn answers_grow_old() {
    let mut unit = unit(&[]);
    assert!(!unit.is_fresh(48, 0));
    hear(&mut unit, 48, 0, &[0; 9], 1);
    assert!(unit.is_fresh(48, 16_000_000) && !unit.is_fresh(48, 16_000_001));
    unit.lost();
    assert!(!unit.is_fresh(48, 1_000_000));
    hear(&mut unit, 3, 0, &poll(1.0), 2);
    assert!(unit.is_fresh(48, 2_000_000));
    let silence = (Outcome::Silence, "no answer");
    unit.take(&request(48, &[]), &[], 48, silence, (3_000_000, 1, 4));
    assert!(!unit.is_fresh(48, 3_000_000));
}

#[test]
fn what_moves_is_noted() {
    let mut unit = unit(&[]);
    hear(&mut unit, 3, 0, &poll(50.0), 1);
    hear(&mut unit, 3, 0, &poll(51.0), 2);
    assert_eq!((unit.moded_us, unit.configured_us), (0, 0));
    hear(&mut unit, 3, 0, &poll(f32::NAN), 3);
    assert_eq!(unit.moded_us, 3_000_000, "no demand any more");
    hear(&mut unit, 3, 8, &poll(f32::NAN), 4);
    assert_eq!(unit.moded_us, 4_000_000, "loop current fixed");
    assert_eq!(unit.configured_us, 0);
    hear(&mut unit, 3, 0x48, &poll(f32::NAN), 5);
    assert_eq!(unit.configured_us, 5_000_000, "configuration changed");
    hear(&mut unit, 0, 0x48, &identity_of(7, 1), 6);
    hear(&mut unit, 0, 0x48, &identity_of(7, 1), 7);
    assert_eq!(unit.configured_us, 5_000_000);
    hear(&mut unit, 0, 0x48, &identity_of(7, 2), 8);
    assert_eq!(unit.configured_us, 8_000_000, "the counter went on");
}

#[test]
fn a_refusal_keeps_the_last_value_and_says_why() {
    // The worked answer R28: command 35, code 64.
    let mut unit = unit(&[(3, POLL.0, POLL.1)]);
    let refused = hex("86AEDD012345230240 40B3");
    unit.take(
        &hex("82AEDD0123452300B5"),
        &refused,
        35,
        (Outcome::Ok, ""),
        (9, 1, 1),
    );
    let reading = unit.reading(&plain(35)).unwrap();
    assert!(reading.good.is_none());
    let why = &reading.bad.as_ref().unwrap().text;
    assert!(why.contains("Command not implemented"), "{why}");
    let poll = hex(POLL.0);
    unit.take(&poll, &[], 3, (Outcome::Silence, "no answer"), (11, 1, 4));
    let reading = unit.reading(&plain(3)).unwrap();
    assert!(reading.good.is_some(), "the last value stays");
    assert_eq!(reading.bad.as_ref().unwrap().outcome, Outcome::Silence);
    assert_eq!(unit.answered_us, Some(9));
}

#[test]
fn what_never_went_out_is_known_as_asked() {
    let mut unit = unit(&[]);
    let key = (523, "0040".to_owned());
    unit.ask(core::slice::from_ref(&key));
    unit.take(&[], &[], 523, (Outcome::Down, "no line"), (1, 0, 0));
    let bad = unit.reading(&key).unwrap().bad.as_ref().unwrap();
    assert_eq!(bad.text, "no line");
}

#[test]
fn extended_commands_are_told_apart_by_their_data() {
    let unit = unit(&[(
        523,
        "82AEDD0123451F04020B0040C4",
        "86AEDD0123451F260000020B0040 00000000304000510405000005030000000000000000000000000000000000 00C4",
    )]);
    let key = (523, "0040".to_owned());
    let reading = unit.reading(&key).unwrap();
    assert!(reading.good.is_some(), "{:?}", unit.readings.keys());
}
