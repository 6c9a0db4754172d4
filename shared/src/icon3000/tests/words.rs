//! What the settings say in words, by hand from sections 9 and 12, tables 1, 5 and 39.

use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::icon3000::words::{
    Pst, Statement, Truth, fail_safe, inputs, interlocks, modes, positioner, pst, relays,
};
use crate::image::Image;
use crate::map::row::Model;

const V2: Model = Model::Icon3000v2;

fn put(image: &mut Image, table: Table, words: &[(u16, u16)]) {
    for (address, word) in words {
        image.set(table, Address::new(*address), *word, Micros::default());
    }
}

fn image(words: &[(u16, u16)]) -> Image {
    let mut image = Image::new();
    put(&mut image, Table::Holding, words);
    image
}

/// Everything that a test needs is as it must be, and DIN1 is set to local STOP, which is off.
fn ready() -> Vec<(u16, u16)> {
    let mut words: Vec<(u16, u16)> = vec![(3027, 1), (3028, 0), (3622, 11)];
    words.extend([3001, 3002, 3010, 3011, 3016, 3030].map(|a| (a, 0)));
    words
}

/// The same with some words changed or added.
fn with(changes: &[(u16, u16)]) -> Image {
    let mut image = image(&ready());
    put(&mut image, Table::Holding, changes);
    image
}

fn reason<'a>(pst: &'a Pst, key: &str) -> &'a Statement {
    pst.reasons.iter().find(|r| r.key == key).unwrap()
}

#[test]
fn whether_a_test_could_run() {
    let can = |changes: &[(u16, u16)]| pst(V2, &with(changes));
    let yes = can(&[]);
    assert_eq!(yes.could_run, Truth::Yes, "{yes:?}");
    let no = can(&[(3027, 0)]);
    assert_eq!(no.could_run, Truth::No);
    assert_eq!(
        no.text,
        "No. Interlock mode must be Advanced; it is Standard (0)."
    );
    // The mirror counts where the register itself was not read.
    let mut mirror = ready();
    mirror[0] = (3920, 1);
    assert_eq!(pst(V2, &image(&mirror)).could_run, Truth::Yes);
    let mains = can(&[(3010, 1 << 8)]);
    assert_eq!(mains.could_run, Truth::No);
    assert!(
        mains.text.contains("the mains voltage is out of limits"),
        "{}",
        mains.text
    );
    assert_eq!(pst(V2, &Image::new()).could_run, Truth::Unknown);
}

/// Table 5, HR 3002 b15.
#[test]
fn a_test_that_runs_cannot_be_begun() {
    let running = pst(V2, &with(&[(3002, 1 << 15)]));
    assert_eq!(running.could_run, Truth::No);
    assert_eq!(running.text, "No. A test is running already.");
}

/// Section 12 names both registers; when they differ, neither is believed (reading E44).
#[test]
fn registers_that_disagree_are_said() {
    let two = pst(V2, &with(&[(3610, 1)]));
    assert_eq!(two.could_run, Truth::Unknown);
    let said = reason(&two, "efs_input_mode");
    assert_eq!(said.holds, Some(Truth::Unknown));
    assert!(
        said.text.contains("HR 3028 says") && said.text.contains("HR 3610 says"),
        "{}",
        said.text
    );
    assert_eq!(said.registers, [3028, 3610]);
    let set = with(&[(3920, 0)]);
    assert_eq!(pst(V2, &set).could_run, Truth::Unknown);
    assert!(interlocks(V2, &set)[0].text.contains("is disputed"));
}

/// Table 39, note 5, bit 1 has no register; function 11 of HR 3580 shows it where it is chosen.
#[test]
fn the_local_stop_is_known_by_an_input_or_relay_only() {
    let unknown = pst(V2, &with(&[(3622, 0)]));
    assert_eq!(unknown.could_run, Truth::Unknown);
    assert!(
        unknown
            .text
            .starts_with("Nothing that was read speaks against it.")
            && unknown.text.contains("local STOP"),
        "{}",
        unknown.text
    );
    // DIN1 is bit 8 of HR 3001.
    assert_eq!(pst(V2, &with(&[(3001, 1 << 8)])).could_run, Truth::No);
    // DIN6: HR 3627, bit 13.
    let sixth = |on: u16| pst(V2, &with(&[(3622, 0), (3627, 11), (3001, on << 13)])).could_run;
    assert_eq!([sixth(0), sixth(1)], [Truth::Yes, Truth::No]);
    // Relay AS3: HR 3582 function, 3590 contact (1 makes), bit 2 of HR 3500.
    let relay = |contact: u16, closed: u16| {
        let set = [(3622, 0), (3582, 11), (3590, contact), (3500, closed << 2)];
        pst(V2, &with(&set)).could_run
    };
    assert_eq!([relay(1, 0), relay(1, 1)], [Truth::Yes, Truth::No]);
    assert_eq!([relay(0, 0), relay(0, 1)], [Truth::No, Truth::Yes]);
    // A relay whose contact was not read tells nothing.
    let part = with(&[(3622, 0), (3582, 11)]);
    assert_eq!(pst(V2, &part).could_run, Truth::Unknown);
}

/// Reading E37. The ICON3000 block of table 5 has the commands, the modes of section 12 and the
/// alarms; coil 3 is ESD/PST, and of the ICON2000v4 nothing more is said.
#[test]
fn older_models_have_tests_too() {
    let of = |changes: &[(u16, u16)]| pst(Model::Icon3000, &with(changes));
    let no = of(&[(3028, 1)]);
    assert_eq!(no.could_run, Truth::No);
    assert!(
        no.text.contains("EFS input mode must be PST-EFS"),
        "{}",
        no.text
    );
    assert_eq!(of(&[(3027, 0)]).could_run, Truth::No);
    assert_eq!(of(&[(3011, 1 << 2)]).could_run, Truth::No);
    // It has no input function that would show the local STOP.
    let good = of(&[]);
    assert_eq!(good.could_run, Truth::Unknown);
    assert!(
        good.text
            .starts_with("Nothing that was read speaks against it.")
    );
    assert!(reason(&good, "coil_3").text.contains("an ESD or a test"));
    assert!(
        !pst(V2, &with(&[]))
            .reasons
            .iter()
            .any(|r| r.key == "coil_3")
    );
    let old = pst(Model::Icon2000v4, &Image::new());
    assert_eq!(old.could_run, Truth::Unknown);
    assert_eq!(
        old.text,
        "Not known. Coil 3 is ESD/PST; what a test needs is not stated."
    );
}

#[test]
fn settings_in_sentences() {
    let set = image(&[
        (3001, 1 << 5 | 1 << 8 | 1 << 14),
        (3002, 1 << 6),
        (3007, 345),
        (3017, 10),
        (3018, 2),
        (3019, 0),
        (3500, 1 << 2),
        (3582, 2),
        (3590, 1),
        (3598, 75),
        (3622, 3),
        (3628, 20),
        (3027, 1),
        (3003, 0),
        (3030, 0),
        (3563, 2),
        (3564, 1),
    ]);
    let said = positioner(V2, &set);
    assert!(said[0].text.contains("more than 1.0 %") && said[0].text.contains("2 s have"));
    assert!(said[1].text.contains("the request is 34.5 %"));
    assert!(said[2].text.contains("unknown (HR 3938 was not read)"));
    assert!(fail_safe(V2, &set)[0].text.starts_with("Nothing happens"));
    assert!(modes(V2, &set)[0].text.contains("REMOTE"));
    let said = interlocks(V2, &set);
    assert!(said[1].text.contains("Opening is interlocked now"));
    // Table 5, HR 3563: 2 is Off, which is no state of a signal.
    assert_eq!(
        said[3].text,
        "The opening interlock is set to Off. The closing interlock acts when its signal is \
         Present (1)."
    );
    let din = &inputs(V2, &set)[0];
    assert_eq!(
        (din.name.as_str(), din.function.as_str(), din.is_on),
        ("DIN1", "Position <= % (3): 20 %", Some(true))
    );
    let relay = &relays(V2, &set)[2];
    assert_eq!(relay.function, "Position >= % (2): 75 %");
    assert_eq!(relay.contact.as_deref(), Some("Make (1)"));
    assert_eq!(relay.is_on, Some(true));
    assert!(relays(V2, &set)[7].function.contains("was not read"));
}

/// Readings E41 and E44: HR 1, 2, 3, 7 to 9 and discrete inputs 0 to 28 show the same on an
/// ICON2000v4, which has no others; each statement names the place that was read.
#[test]
fn an_icon2000v4_speaks_by_its_own_registers() {
    const OLD: Model = Model::Icon2000v4;
    let mut seen = image(&[(1, 500), (2, 15), (3, 4), (7, 4), (8, 20), (9, 30)]);
    let mut inputs: Vec<(u16, u16)> = (0..29).map(|at| (at, 0)).collect();
    for on in [5, 15, 16, 22, 23] {
        inputs[on].1 = 1;
    }
    put(&mut seen, Table::Discrete, &inputs);
    let said = positioner(OLD, &seen);
    assert!(said[0].text.contains("more than 1.5 %") && said[0].text.contains("4 s have"));
    assert_eq!(said[0].from, ["HR 2", "HR 3"]);
    assert!(
        said[1].text.contains("the request is 50.0 %"),
        "{}",
        said[1].text
    );
    assert_eq!(said[1].from, ["DI 22", "HR 1"]);
    let said = fail_safe(OLD, &seen);
    assert!(
        said[0]
            .text
            .contains("goes to 30 % after 30 s (10 s and the 20 s")
    );
    assert_eq!(said[0].from, ["HR 7", "HR 8", "HR 9"]);
    assert_eq!(said[1].text, "The fail-safe action is on now.");
    assert_eq!(said[1].from, ["DI 16"]);
    let said = modes(OLD, &seen);
    assert!(said[0].text.contains("REMOTE"));
    assert_eq!(said[0].from, ["DI 19", "DI 4", "DI 5"]);
    let inhibited: Vec<_> = said.iter().skip(1).map(|s| s.key).collect();
    assert_eq!(inhibited, ["inhibited"]);
    let said = interlocks(OLD, &seen);
    let texts: Vec<_> = said.iter().map(|s| s.text.as_str()).collect();
    assert_eq!(
        texts,
        ["Opening is not interlocked.", "Closing is interlocked now."]
    );
    // Nothing read: what is missing is named by its own addresses.
    let none = Image::new();
    assert!(positioner(OLD, &none)[0].text.contains("HR 2 was not read"));
    assert!(
        positioner(OLD, &none)[1]
            .text
            .contains("DI 22 was not read")
    );
    assert!(modes(OLD, &none)[0].text.contains("DI 19 was not read"));
    assert!(fail_safe(OLD, &none)[0].text.contains("(HR 7)"));
    // On a newer model the register itself comes first, its copy where that is all there is.
    let mut both = image(&[(2, 15), (3017, 10), (3018, 2), (7, 1)]);
    put(&mut both, Table::Discrete, &[(22, 0)]);
    let said = positioner(V2, &both);
    assert!(said[0].text.contains("more than 1.0 %"));
    assert_eq!(said[0].from, ["HR 3017", "HR 3018"]);
    assert_eq!(said[1].text, "It is not positioning now.");
    let said = fail_safe(V2, &both);
    assert!(said[0].text.contains("closes"));
    assert_eq!(said[0].from, ["HR 7", "HR 3020", "HR 3021"]);
}
