//! Whether a partial stroke test could run now, and why not.

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

/// Whether a partial stroke test could run now, and why not (section 12 and table 39, note 5).
#[must_use]
pub fn pst(model: Model, image: &Image) -> Pst {
    let look = Look { model, image };
    let mut reasons = Vec::new();
    if model < Model::Icon3000v2 {
        return Pst {
            could_run: Truth::No,
            text: "No: only an ICON3000v2 has stroke tests that the bus can start.".to_owned(),
            reasons,
        };
    }
    let needs = [
        (
            "efs_input_mode",
            [3028, 3610],
            0,
            "EFS input mode must be PST-EFS",
        ),
        (
            "interlock_mode",
            [3027, 3920],
            1,
            "Interlock mode must be Advanced",
        ),
    ];
    for (key, registers, want, text) in needs {
        let is = look.any(&registers);
        let now = registers
            .iter()
            .find(|a| look.word(**a).is_some())
            .map_or_else(|| "not read".to_owned(), |a| look.text(*a));
        reasons.push(Statement {
            key,
            text: format!("{text}; it is {now}."),
            holds: Some(Look::truth(is.map(|w| w == want))),
            registers: registers.to_vec(),
            source: section("section 12"),
            inferred: false,
        });
    }
    for (register, bit, text) in RESETS {
        let active = look.bit(register, bit);
        if active == Some(false) {
            continue;
        }
        let text = match active {
            None => format!("It is not known whether {text}: HR {register} was not read."),
            _ => format!("A test would be reset: {text}."),
        };
        let known = reasons
            .iter()
            .any(|r: &Statement| active.is_none() && r.key == "reset" && r.registers == [register]);
        if known {
            continue;
        }
        reasons.push(Statement {
            key: "reset",
            text,
            holds: Some(Look::truth(active.map(|on| !on))),
            registers: vec![register],
            source: section("section 8.11.6, table 39, note 5"),
            inferred: true,
        });
    }
    let has = |truth: Truth| reasons.iter().find(|r| r.holds == Some(truth));
    let (could_run, text) = match (has(Truth::No), has(Truth::Unknown)) {
        (Some(why), _) => (Truth::No, format!("No. {}", why.text)),
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
