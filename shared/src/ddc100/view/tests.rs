use super::super::checklist::tests::image;
use super::*;

const MX: Device = Device::Ddc100Mx;
const UEC: Device = Device::Ddc100Uec;
const IO: Device = Device::Ddc100Io;

fn view(kind: Device, words: &[(u16, u16)]) -> View {
    View::of(kind, &image(words), |_| Scaling::Percent)
}

fn labels(bits: &[Bit]) -> Vec<&'static str> {
    bits.iter().map(|b| b.member.label).collect()
}

/// The example of section 3.2.3 (reading D5): registers 8 to 10 are 003D, 0844 and 0000.
#[test]
fn the_example_of_the_guide() {
    let seen = view(UEC, &[(8, 0x003D), (9, 0x0844), (10, 0)]);
    assert_eq!(seen.state, "Stopped between the ends");
    assert_eq!(seen.mode, Mode::LocalOrStop);
    assert_eq!(seen.position.unwrap().to_string(), "61 %");
    assert_eq!((seen.own.one, seen.own.two), (Own::Good, Own::NotFitted));
    assert_eq!(labels(&seen.faults), [] as [&str; 0]);
}

#[test]
fn a_unit_in_words() {
    let seen = view(UEC, &[(8, 61), (9, 0x0808), (12, 0x0801)]);
    assert_eq!(seen.state, "Opening");
    assert_eq!(seen.mode, Mode::Remote);
    assert_eq!(seen.position.unwrap().to_string(), "61 %");
    // Channel B without its board is no fault.
    assert_eq!(seen.own.two, Own::NotFitted);
    assert_eq!(labels(&seen.faults), [] as [&str; 0]);
    assert!(!seen.combined_disputed);
    let mx = view(MX, &[(9, 0x0808)]);
    assert_eq!((mx.own.one, mx.own.two), (Own::Good, Own::Fault));
    assert_eq!(mx.mode, Mode::NotLocal);
}

/// Reading D9: neither remote nor local is STOP on an MX; of the others the guide does not say it.
#[test]
fn d9_neither_remote_nor_local() {
    let words = [(9, 0x0004), (12, 0x0800)];
    assert_eq!(view(MX, &words).mode, Mode::Stop);
    assert_eq!(view(Device::Ddc100MxB, &words).mode, Mode::Stop);
    assert_eq!(view(UEC, &words).mode, Mode::LocalOrStop);
    assert_eq!(
        view(Device::Ddc100Clamshell, &words).mode,
        Mode::LocalOrStop
    );
}

/// Section 4.3.1: bit 11 is set without the granddaughter board. Once it was clear, the board is
/// there, and the bit is a fault.
#[test]
fn a_channel_b_that_was_good_can_fail() {
    let mut image = image(&[(9, 0x0802)]);
    assert_eq!(own(UEC, &image).two, Own::NotFitted);
    let mut set = |word, at| {
        let address = Address::new(STATUS - 1);
        image.set(Table::Holding, address, word, Micros::new(at));
        own(UEC, &image).two
    };
    assert_eq!(set(0x0002, 50), Own::Good);
    assert_eq!(set(0x0802, 60), Own::Fault);
    assert_eq!(set(0x0802, 70), Own::Fault);
    assert_eq!(set(0x0002, 80), Own::Good);
    assert!(Own::NotFitted.label().contains("or a fault"));
}

#[test]
fn states() {
    for (word, text) in [
        (0x0001, "Open"),
        (0x0002, "Closed"),
        (0x0003, "Open and closed reported at once"),
        (0x0004, "Stopped between the ends"),
        (0x0008, "Opening"),
        (0x0030, "Closing, valve jammed"),
        (0x0018, "Opening and closing reported at once"),
        (0x0000, "No position reported"),
    ] {
        assert_eq!(view(MX, &[(9, word)]).state, text);
    }
    assert_eq!(view(MX, &[]).state, "Not read yet");
    assert_eq!(view(IO, &[(9, 0xFFFF)]).state, "I/O module");
    assert_eq!(view(MX, &[]).own, Pair::both(Own::Unknown));
}

/// Reading D8: the formula, and where the unit says something else.
#[test]
fn d8_combined_fault() {
    for (word, expected) in [
        (1 << 5, true),
        (1 << 8, true),
        (1 << 9, true),
        (1 << 15, true),
        (3 << 10, true),
        (1 << 10, false),
        (1 << 11, false),
        (1 << 12 | 1 << 13 | 1 << 14, false),
    ] {
        assert_eq!(combined(word), expected, "{word:04X}");
        assert_eq!(view(UEC, &[(9, word)]).combined_disputed, expected);
        let said = word | 1 << 7;
        assert_eq!(view(UEC, &[(9, said)]).combined_disputed, !expected);
    }
    assert!(!view(IO, &[(9, 3 << 10)]).combined_disputed);
}

#[test]
fn faults_and_groups() {
    let seen = view(
        UEC,
        &[
            (9, 0x1184),
            (10, 0x1010),
            (11, 0x2A24),
            (12, 0x0001),
            (14, 0x1001),
            (15, 0x0200),
        ],
    );
    assert_eq!(
        labels(&seen.faults),
        [
            "Combined fault",
            "Over-temperature fault",
            "Open torque switch fault",
            "One or more phases missing",
            "Microprocessor reset since the last poll",
            "Analog channel 1 low",
            "User fault 9"
        ],
        "the time-out of an absent channel B is left out"
    );
    assert_eq!(seen.software, Some(0x2A), "reading D14");
    assert_eq!(seen.outputs.len(), 8);
    assert!(
        seen.outputs
            .iter()
            .any(|b| b.on && b.member.label == "User relay 6")
    );
    assert_eq!((seen.timers.len(), seen.user_faults.len()), (16, 10));
    // Reading D32: user input 3 is inverted; 0 is active.
    let input = |seen: &View| {
        seen.inputs
            .iter()
            .find(|b| b.member.key == "user_input_3")
            .copied()
    };
    let bit = input(&seen).unwrap();
    assert!(bit.is_active() && !bit.on);
    assert_eq!(bit.text(), "active");
    let off = input(&view(UEC, &[(12, 0x0800)])).unwrap();
    assert!(!off.is_active() && off.text() == "not active");
    // The module's is not.
    assert!(!input(&view(IO, &[(12, 0)])).unwrap().is_active());
    // Bit 6 of register 9 has words of its own on an MX, but is no inverted bit.
    let mx = view(MX, &[(9, 0x0040)]);
    assert!(
        mx.status
            .iter()
            .any(|b| b.member.key == "local_mode" && b.is_active())
    );
}

#[test]
fn analog_values() {
    let words = [(3, 10), (4, 20), (5, 480), (6, 30), (7, 40), (8, 50)];
    let texts = |kind, scaling: fn(&Row) -> Scaling| -> Vec<String> {
        let seen = View::of(kind, &image(&words), scaling);
        seen.analog
            .iter()
            .map(|a| format!("{}: {a}", a.row.label))
            .collect()
    };
    assert_eq!(
        texts(MX, |_| Scaling::Percent),
        [
            "APT scaled output value: 10 %",
            "ATT scaled output value: 20 %",
            "Main power value: 480 V",
            "Analog input 1: 30 %",
            "Analog input 2: 40 %",
            "Valve position: 50 %"
        ]
    );
    let uec = texts(UEC, |row| match row.key {
        "position" => Scaling::Byte,
        _ => Scaling::Raw,
    });
    assert_eq!(
        uec[0], "Average torque: 20 counts",
        "register 3 is not used"
    );
    assert_eq!(uec[1], "Analog input 4: 480 counts");
    assert_eq!(uec[4], "Valve position or analog input 1: 19.6 %");
    assert_eq!(view(IO, &words).position, None);
    assert_eq!(view(IO, &words).analog.len(), 5);
    assert_eq!(view(MX, &words).at, Some(Micros::new(30)));
}

/// Registers 14 and 15 were read once and the unit cleared them since; polls bring 8 to 13 only.
#[test]
fn read_once_and_cleared_at_the_unit_later() {
    let mut image = image(&[(9, 0x0804), (14, 0x0001), (15, 0x0004)]);
    let later = Micros::new(60_000_000);
    image.absorb(&[3, 0, 8, 0, 2], &[3, 4, 0x10, 0x04, 0, 0], later);
    let mut seen = View::of(UEC, &image, |_| Scaling::Percent);
    assert_eq!(
        labels(&seen.faults),
        [
            "Open torque switch fault",
            "Analog channel 1 low",
            "User fault 2"
        ]
    );
    seen.set_aside(Micros::new(45_000_000));
    assert_eq!(labels(&seen.faults), ["Open torque switch fault"]);
    assert_eq!(
        labels(&seen.old_faults),
        ["Analog channel 1 low", "User fault 2"]
    );
    assert_eq!(seen.old_faults[0].at, Micros::new(140));
}

/// Table 3.5: register 15 of an MX/DDC is not used (D10); the software version is in register 11 of
/// the others (D14).
#[test]
fn what_a_type_has_at_all() {
    for kind in [MX, UEC, IO] {
        assert!(has_bits(kind, 9) && has_bits(kind, 11) && has_bits(kind, 12));
    }
    assert!(has_bits(UEC, 15) && !has_bits(MX, 15));
    assert!(has_software(UEC) && has_software(IO) && !has_software(MX));
}
