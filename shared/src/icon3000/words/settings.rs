//! Positioner, fail-safe, modes and interlocks.

use super::look::Agreed;
use super::look::On::{self, Bit, Word};
use super::{Look, Statement, section};
use crate::image::Image;
use crate::map::row::Model;

/// The positioner in words (section 9.2).
#[must_use]
pub fn positioner(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let text = format!(
        "The valve moves when request and position differ by more than {}; the motor starts again \
         not before {} have passed.",
        look.text(3017),
        look.text(3018)
    );
    let limits = [Word(3017), Word(3018)];
    let mut said = vec![look.say("positioner", text, &limits, section("section 9.2, p. 78"))];
    let text = match look.bit(3002, 6) {
        Some(true) => format!("It is positioning now; the request is {}.", look.text(3007)),
        Some(false) => "It is not positioning now.".to_owned(),
        None => not_known(&look, "it is positioning", Bit(3002, 6)),
    };
    let on = [Bit(3002, 6), Word(3007)];
    said.push(look.say("positioner_mode", text, &on, section("table 5, HR 3002")));
    if model >= Model::Icon3000v2 {
        let text = format!(
            "The function is {}; the request comes from {}, {}; 4 to 20 mA go from {} to {}.",
            look.text(3938),
            look.text(3936),
            look.text(3660),
            look.text(3661),
            look.text(3662)
        );
        let on = [3938, 3936, 3660, 3661, 3662].map(Word);
        let source = section("table 5, HR 3660 to 3662, 3936, 3938");
        said.push(look.say("positioner_request", text, &on, source).inferred());
    }
    said
}

/// `Whether it is positioning is not known: HR 3002 was not read.`
fn not_known(look: &Look<'_>, what: &str, on: On) -> String {
    let place = look.place_name(on);
    format!("Whether {what} is not known: {place} was not read.")
}

/// What the actuator does when the bus falls silent (section 9.3, reading E45).
#[must_use]
pub fn fail_safe(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let place = |register: u16| look.place_name(Word(register));
    let delay = look.word(3020);
    let seconds = delay.map(|d| u32::from(d).saturating_add(10));
    let after = seconds.zip(delay).map_or_else(
        || format!("after 10 s and a delay that was not read ({})", place(3020)),
        |(all, set)| format!("after {all} s (10 s and the {set} s that are set)"),
    );
    let what = match look.word(3019) {
        Some(0) => None,
        Some(1) => Some("closes".to_owned()),
        Some(2) => Some("opens".to_owned()),
        Some(3) => Some("stays where it is".to_owned()),
        Some(4) => Some(match look.word(3021) {
            Some(percent) => format!("goes to {percent} %"),
            None => format!("goes to a position that was not read ({})", place(3021)),
        }),
        Some(other) => Some(format!("does something that has no name (code {other})")),
        None => Some(format!(
            "does something that was not read ({})",
            place(3019)
        )),
    };
    let text = match what {
        None => "Nothing happens when the bus falls silent: the action is Off.".to_owned(),
        Some(what) => format!(
            "When the bus falls silent the valve {what} {after}, only if the selector is in REMOTE \
             and the bus was working. Hardwired ESD and interlocks come first."
        ),
    };
    let on = [3019, 3020, 3021].map(Word);
    let mut said = vec![look.say("fail_safe", text, &on, section("section 9.3, p. 79"))];
    if model >= Model::Icon3000v2 {
        let enabled = look.word(3940).map(|w| w == 1);
        let text = match enabled {
            Some(true) => "The function is enabled (HR 3940).",
            Some(false) => "The function is disabled (HR 3940): nothing of this happens.",
            None => "Whether it is enabled is not known: HR 3940 was not read.",
        };
        let source = section("table 5, HR 3940");
        said.push(
            look.say("fail_safe_enabled", text.to_owned(), &[Word(3940)], source)
                .holding(Look::truth(enabled))
                .inferred(),
        );
    }
    let text = match look.bit(3002, 0) {
        Some(true) => "The fail-safe action is on now.".to_owned(),
        Some(false) => "The fail-safe action is not on now.".to_owned(),
        None => not_known(&look, "it is on", Bit(3002, 0)),
    };
    let source = section("table 5, HR 3002");
    said.push(look.say("fail_safe_now", text, &[Bit(3002, 0)], source));
    said
}

/// Who commands the valve now.
#[must_use]
pub fn modes(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let selector = [Bit(3002, 3), Bit(3001, 4), Bit(3001, 5)];
    let text = match (look.bit(3002, 3), look.bit(3001, 4), look.bit(3001, 5)) {
        (Some(true), ..) => "The selector is in OFF: nobody moves the valve by command.".to_owned(),
        (_, Some(true), _) => {
            "The selector is in LOCAL: only the knobs on the actuator command.".to_owned()
        }
        (_, _, Some(true)) => {
            "The selector is in REMOTE: bus or hardwired inputs command.".to_owned()
        }
        (Some(false), Some(false), Some(false)) => "The selector is in no position.".to_owned(),
        (off, ..) => {
            let missing = if off.is_none() {
                Bit(3002, 3)
            } else {
                Bit(3001, 4)
            };
            not_known(&look, "the selector is in OFF, LOCAL or REMOTE", missing)
        }
    };
    let mut said = vec![look.say(
        "selector",
        text,
        &selector,
        section("table 5, HR 3001, 3002"),
    )];
    for (register, bit, key, text) in [
        (
            3002,
            5,
            "hardwired",
            "The hardwired inputs command, not the bus.",
        ),
        (3002, 7, "inhibited", "The motor is inhibited."),
        (3002, 14, "esd", "An emergency shutdown is in progress."),
        (
            3002,
            15,
            "pst_running",
            "A partial stroke test is in progress.",
        ),
        (
            3003,
            14,
            "configuring",
            "Somebody configures the actuator on the spot.",
        ),
        (3003, 15, "handwheel", "The handwheel is engaged."),
        (
            3030,
            0,
            "maintenance",
            "The actuator is in maintenance operation.",
        ),
    ] {
        if look.bit(register, bit) == Some(true) {
            let source = section("table 5, HR 3002, 3003, 3030");
            said.push(look.say(key, text.to_owned(), &[Bit(register, bit)], source));
        }
    }
    said
}

/// The interlocks in words.
#[must_use]
pub fn interlocks(model: Model, image: &Image) -> Vec<Statement> {
    let look = Look { model, image };
    let mut said = Vec::new();
    // An ICON2000v4 has no register for it.
    if model >= Model::Icon3000 {
        let two = [3027, 3920];
        let text = match look.agreed(two) {
            Agreed::Differ => look.differ("Interlock mode", two),
            Agreed::Says(register) => format!("Interlock mode: {}.", look.text(register)),
        };
        let source = section("table 5, HR 3027, 3920");
        said.push(look.say("interlock_mode", text, &look.both(two), source));
    }
    for (bit, key, way) in [
        (14, "interlock_open", "Opening"),
        (15, "interlock_close", "Closing"),
    ] {
        let text = match look.bit(3001, bit) {
            Some(true) => format!("{way} is interlocked now."),
            Some(false) => format!("{way} is not interlocked."),
            None => {
                let what = format!("{} is interlocked", way.to_ascii_lowercase());
                not_known(&look, &what, Bit(3001, bit))
            }
        };
        let source = section("table 5, HR 3001");
        said.push(look.say(key, text, &[Bit(3001, bit)], source));
    }
    if model >= Model::Icon3000v2 {
        let signal = |register: u16, way: &str| match look.word(register) {
            // Off is no state of a signal.
            Some(2) => format!("The {way} interlock is set to Off."),
            _ => format!(
                "The {way} interlock acts when its signal is {}.",
                look.text(register)
            ),
        };
        let text = format!("{} {}", signal(3563, "opening"), signal(3564, "closing"));
        let on = [Word(3563), Word(3564)];
        let source = section("table 5, HR 3563, 3564");
        said.push(look.say("interlock_signal", text, &on, source).inferred());
    }
    said
}
