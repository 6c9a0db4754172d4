//! Whether a partial stroke test could run now, and why not.

use super::look::Agreed;
use super::look::On::{Bit, Word};
use super::{Look, Statement, Truth, section};
use crate::image::Image;
use crate::map::row::Model;

/// Whether a partial stroke test could run now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pst {
    /// The answer: no if one requirement is not met, unknown if one was not read.
    pub could_run: Truth,
    /// In one sentence.
    pub text: String,
    /// What it rests on: the two requirements of section 12, then the conditions of table 39,
    /// note 5, each of which resets a test.
    pub reasons: Vec<Statement>,
}

/// Conditions that reset a test (table 39, note 5): register, bit, words.
const RESETS: [(u16, u8, &str); 19] = [
    (3002, 3, "the selector is in OFF"),
    (3030, 1, "remote STOP is on"),
    (3002, 14, "an ESD is in progress"),
    (3002, 0, "the fail-safe action is on"),
    (3010, 11, "there is a configuration alarm"),
    (3010, 6, "there is a position sensor alarm"),
    (3010, 0, "the motor thermostat has opened"),
    (3010, 8, "the mains voltage is out of limits"),
    (3010, 14, "a phase of the supply is missing"),
    (3010, 5, "the temperature is too high"),
    (3011, 1, "the valve is jammed in closing direction"),
    (3011, 2, "the valve is jammed in opening direction"),
    (3010, 1, "there is a torque alarm in opening direction"),
    (3010, 2, "there is a torque alarm in closing direction"),
    (3010, 7, "there is a speed sensor alarm"),
    (3010, 9, "there is an alarm of contactor K1"),
    (3010, 10, "there is an alarm of contactor K2"),
    (3010, 12, "there is a hardware alarm"),
    (3016, 0, "the emergency stroke did not reach its end"),
];

/// Function of an input bit or relay that shows the local STOP (HR 3580).
const LOCAL_STOP: u16 = 11;

/// Whether a partial stroke test could run now, and why not (section 12 and table 39, note 5).
///
/// Readings E37: before the ICON3000v2, coil 3 is ESD/PST; which of the two it starts on an ICON3000
/// is not stated, and of an ICON2000v4 nothing is stated at all.
#[must_use]
pub fn pst(model: Model, image: &Image) -> Pst {
    let look = Look { model, image };
    if model < Model::Icon3000 {
        return Pst {
            could_run: Truth::Unknown,
            text: "Not known. Coil 3 is ESD/PST; what a test needs is not stated.".to_owned(),
            reasons: Vec::new(),
        };
    }
    let mut reasons = running(&look);
    for (key, registers, want, name, setting) in [
        (
            "efs_input_mode",
            [3028, 3610],
            0,
            "EFS input mode",
            "PST-EFS",
        ),
        (
            "interlock_mode",
            [3027, 3920],
            1,
            "Interlock mode",
            "Advanced",
        ),
    ] {
        let (text, holds) = match look.agreed(registers) {
            Agreed::Differ => (look.differ(name, registers), None),
            Agreed::Says(register) => (
                format!("{name} must be {setting}; it is {}.", look.text(register)),
                look.word(register).map(|word| word == want),
            ),
        };
        let on = look.both(registers);
        reasons.push(
            look.say(key, text, &on, section("section 12"))
                .holding(Look::truth(holds)),
        );
    }
    reasons.extend(resets(&look));
    reasons.push(local_stop(&look));
    if model < Model::Icon3000v2 {
        let text = "Coil 3 may start an ESD or a test; which of the two is not stated. Bit 5 of HR \
                    3006 and value 5 of HR 3008 start a test.";
        let on = [Word(3006), Word(3008)];
        reasons.push(
            look.say("coil_3", text.to_owned(), &on, section("tables 2 and 5"))
                .inferred(),
        );
    }
    let has = |truth: Truth| reasons.iter().find(|r| r.holds == Some(truth));
    // What can be read comes before what cannot.
    let (could_run, text) = match (has(Truth::No), has(Truth::Unknown)) {
        (Some(why), _) => (Truth::No, format!("No. {}", why.text)),
        (None, Some(why)) if why.key == "local_stop" => (
            Truth::Unknown,
            format!("Nothing that was read speaks against it. {}", why.text),
        ),
        (None, Some(why)) => (Truth::Unknown, format!("Not known. {}", why.text)),
        (None, None) => (
            Truth::Yes,
            "Yes: both requirements of section 12 are met, and nothing that resets a test is \
             present."
                .to_owned(),
        ),
    };
    Pst {
        could_run,
        text,
        reasons,
    }
}

/// A test that runs already can't be begun.
fn running(look: &Look<'_>) -> Vec<Statement> {
    let on = Bit(3002, 15);
    // That HR 3002 was not read is said with the resets.
    if look.bit(3002, 15) != Some(true) {
        return Vec::new();
    }
    let text = "A test is running already.".to_owned();
    let said = look.say("running", text, &[on], section("table 5, HR 3002"));
    vec![said.holding(Truth::No)]
}

/// What would reset a test, or may: one statement for each register that was not read.
fn resets(look: &Look<'_>) -> Vec<Statement> {
    let mut reasons: Vec<Statement> = Vec::new();
    for (register, bit, text) in RESETS {
        let active = look.bit(register, bit);
        let said = |r: &Statement| r.holds == Some(Truth::Unknown) && r.registers == [register];
        if active == Some(false) || (active.is_none() && reasons.iter().any(said)) {
            continue;
        }
        let on = Bit(register, bit);
        let text = match active {
            None => {
                let place = look.place_name(on);
                format!("It is not known whether {text}: {place} was not read.")
            }
            _ => format!("A test would be reset: {text}."),
        };
        let source = section("section 8.11.6, table 39, note 5");
        reasons.push(
            look.say("reset", text, &[on], source)
                .holding(Look::truth(active.map(|on| !on)))
                .inferred(),
        );
    }
    reasons
}

/// The local STOP resets a test too (bit 1 of the note), but no register shows it. An input bit or a
/// relay does where it is set to (function 11 of HR 3580).
fn local_stop(look: &Look<'_>) -> Statement {
    let source = section("section 8.11.6, table 39, note 5, bit 1");
    let is_v2 = look.model >= Model::Icon3000v2;
    let pressed = |n: u16| {
        let at = u8::try_from(n).ok()?;
        let input = || {
            let function = 3622_u16.checked_add(n).filter(|_| n < 6)?;
            let on = Bit(3001, at.checked_add(8)?);
            (look.word(function) == Some(LOCAL_STOP)).then_some(())?;
            Some((
                look.bit(3001, at.checked_add(8)?)?,
                vec![Word(function), on],
            ))
        };
        let relay = || {
            let (function, contact) = (3580_u16.checked_add(n)?, 3588_u16.checked_add(n)?);
            (look.word(function) == Some(LOCAL_STOP)).then_some(())?;
            // A contact that makes is closed while its function holds, one that breaks is open.
            let pressed = look.bit(3500, at)? == (look.word(contact)? == 1);
            Some((pressed, vec![Word(function), Word(contact), Bit(3500, at)]))
        };
        input().or_else(relay)
    };
    match (0..8_u16).filter(|_| is_v2).find_map(pressed) {
        Some((true, on)) => {
            let text = "A test would be reset: the local STOP is pressed.";
            look.say("local_stop", text.to_owned(), &on, source)
                .holding(Truth::No)
        }
        Some((false, on)) => {
            let text = "The local STOP is not pressed.";
            look.say("local_stop", text.to_owned(), &on, source)
                .holding(Truth::Yes)
        }
        None => {
            let text = "The local STOP, which resets a test, cannot be read: no input bit or relay is \
                        known to show it.";
            look.say("local_stop", text.to_owned(), &[], source)
                .holding(Truth::Unknown)
        }
    }
}
