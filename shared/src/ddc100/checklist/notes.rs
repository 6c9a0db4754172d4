//! What the guide says beside the checklist.

use super::Wish;
use crate::ddc100::tables;
use crate::device::Device;

/// A sentence and where it is from.
type Note = (&'static str, &'static str);

/// What to know when a command is sent.
pub(super) fn notes(kind: Device, wish: Wish) -> Vec<Note> {
    let mut notes: Vec<Note> = vec![
        (
            "It goes between two polls, after an answer, through the port of the pass; through the other one if the unit has a fault there. Polling goes on after the acknowledge.",
            "sections 4.3.2 and 6.2, item 1",
        ),
        (
            "It is sent once, and again only if no acknowledge came: repeating it can stop the valve.",
            "section 6.2, item 6",
        ),
    ];
    match wish {
        Wish::Open | Wish::Close => {
            notes.push(("By function 05 or 06.", "section 6.2, item 4"));
            notes.push((
                "The unit stops by itself at the end of travel: no Stop is needed there.",
                "section 6.2, item 7",
            ));
            notes.push((
                "No Stop is needed before turning round: the unit stops first, then runs the other way.",
                "section 6.2, item 9",
            ));
        }
        Wish::MoveTo(_) => {
            notes.push((
                "By function 06, or 16 (reading D22); only for actuators that are set up for position control, which no register tells.",
                "section 6.2, item 4",
            ));
            notes.push(firmware(kind));
        }
        Wish::Stop => {
            notes.push((
                "A stop works in REMOTE and in LOCAL.",
                "section 6.2, item 10",
            ));
            notes.push((
                "In mid-travel, bit 2 of register 9 (stopped) is 1 once the valve stands.",
                "section 6.2, item 8",
            ));
        }
        Wish::Engage(number) | Wish::Disengage(number) => {
            notes.push(if number <= 6 {
                ("By function 05 or 06.", "section 6.2, item 4")
            } else {
                (
                    "By function 06; the guide names 05 or 06 for relays 1 to 6 only.",
                    "section 6.2, item 4",
                )
            });
            notes.push((
                "Where two relays work one device, the first is disengaged before the second is engaged.",
                "section 6.2, item 3",
            ));
        }
        Wish::StartEsd | Wish::StopEsd => notes.push((
            "What the unit does then is a setting of it, which may be to ignore it; no register tells.",
            "section 6.1, item 5",
        )),
    }
    notes
}

/// From which firmware on a type takes the move-to in one step. No register is said to tell it.
const fn firmware(kind: Device) -> Note {
    let text = match kind {
        Device::Ddc100Uec => {
            "In one step only from Modbus firmware 2.00 on, which no register is said to tell; older ones take two: register 2, then 6656."
        }
        _ if tables::is_fast(kind) => {
            "In one step only from firmware 02/01.00 on, which no register is said to tell; older ones take two: register 2, then 6656."
        }
        _ => {
            "The guide names firmware for one step on UEC-3-DDC and MX-DDC only; this type may want two: register 2, then 6656."
        }
    };
    (text, "section 3.2.6")
}
