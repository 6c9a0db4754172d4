use super::*;
use shared::encode::frame;

/// Every function code in every framing, each as a complete request.
#[test]
fn only_reads_pass() {
    let allowed = [1, 2, 3, 4, 7, 8, 11, 12, 17, 20, 24, 43];
    for framing in Framing::MODBUS {
        for pdu in every_function() {
            let passed = Gate::default()
                .admit(framing, &frame(framing, 1, 1, &pdu))
                .is_ok();
            assert_eq!(passed, allowed.contains(&pdu[0]), "{framing:?} {pdu:?}");
        }
    }
}

/// No HART command leaves, not even one that only reads: there is no HART line yet.
#[test]
fn no_hart_frame_passes() {
    for framing in [Framing::Hart, Framing::HartIp] {
        for command in 0..=255 {
            let bytes = frame(framing, 1, 1, &[command, 0, 0, 0, 1]);
            assert!(Gate::default().admit(framing, &bytes).is_err(), "{command}");
        }
    }
}

#[test]
fn nothing_hides_behind_a_read() {
    for framing in Framing::MODBUS {
        let read = frame(framing, 1, 1, &[3, 0, 0, 0, 1]);
        let write = frame(framing, 1, 1, &[6, 0, 0, 0, 1]);
        assert!(Gate::default().admit(framing, &read).is_ok());
        assert!(
            Gate::default()
                .admit(framing, &[read, write].concat())
                .is_err()
        );
    }
}

#[test]
fn sub_functions_count() {
    let passes = |pdu: &[u8]| {
        Gate::default()
            .admit(Framing::Rtu, &frame(Framing::Rtu, 0, 1, pdu))
            .is_ok()
    };
    for sub in 0..=300_u16 {
        let [high, low] = sub.to_be_bytes();
        // The echo, the diagnostic register and the counters: Modbus V1.1b3, section 6.8.
        let reads = [0, 2, 11, 12, 13, 14, 15, 16, 17, 18].contains(&sub);
        assert_eq!(passes(&[8, high, low, 0, 0]), reads, "{sub}");
        assert_eq!(passes(&[8, high, low, 0, 1]), sub == 0, "{sub}");
    }
    assert!(passes(&[43, 14, 1, 0]));
    assert!(!passes(&[43, 13, 0, 0]));
    assert!(!passes(&[43]));
}

#[test]
fn fragments_do_not_pass() {
    for framing in Framing::MODBUS {
        for bytes in [
            &b""[..],
            &[1],
            &[1, 3],
            b":",
            b":01",
            &[0, 1, 0, 0, 0, 6, 1],
        ] {
            assert!(
                Gate::default().admit(framing, bytes).is_err(),
                "{framing:?} {bytes:?}"
            );
        }
    }
}

// ---- the one write

/// A device with its request register at 4000.
fn device(unit: u8, kind: Device, profile: Option<&str>) -> DeviceConfig {
    DeviceConfig {
        tag: format!("u{unit}"),
        device: kind,
        bus: 0,
        unit,
        description: String::new(),
        faults: Vec::new(),
        profile: profile.map(|json| Arc::new(Profile::from_json(json).unwrap())),
        target: None,
    }
}

const AT_4000: &str =
    r#"{"registers":{"request":4000,"status":4014,"count":4015,"response":4100}}"#;
const WITH_16: &str = r#"{"registers":{"request":4000},"request_function":16}"#;

/// Units: 4 and 5 as DOP (5 writes with function 16), 6 as DOP without addresses, 7 and 8 others.
fn plant() -> Gate {
    Gate::of(&[
        device(4, Device::Dop, Some(AT_4000)),
        device(5, Device::Dop, Some(WITH_16)),
        device(6, Device::Dop, Some("{}")),
        // A profile does not make a DOP of another device.
        device(7, Device::Icon3000v2, Some(AT_4000)),
        device(8, Device::None, None),
    ])
}

fn passes(gate: &Gate, unit: u8, pdu: &[u8]) -> bool {
    let all = Framing::MODBUS.map(|f| gate.admit(f, &frame(f, 7, unit, pdu)).is_ok());
    assert!(all[0] == all[1] && all[1] == all[2], "{unit} {pdu:02X?}");
    all[0]
}

fn fc6(address: u16, word: u16) -> Vec<u8> {
    let ([a, b], [c, d]) = (address.to_be_bytes(), word.to_be_bytes());
    vec![6, a, b, c, d]
}

fn fc16(address: u16, word: u16) -> Vec<u8> {
    let ([a, b], [c, d]) = (address.to_be_bytes(), word.to_be_bytes());
    vec![16, a, b, 0, 1, 2, c, d]
}

/// Of all words only those of the objects and options of the manual pass, to their register only,
/// with their function only, on their unit only.
#[test]
fn the_one_write_is_the_request_for_a_known_object() {
    let gate = plant();
    let mut passed = Vec::new();
    for word in 0..=u16::MAX {
        if gate
            .admit(Framing::Rtu, &frame(Framing::Rtu, 0, 4, &fc6(4000, word)))
            .is_ok()
        {
            passed.push(word);
        }
        assert!(
            gate.admit(Framing::Rtu, &frame(Framing::Rtu, 0, 4, &fc16(4000, word)))
                .is_err()
        );
    }
    // By hand: 1, 203, 204, 401, 601 and 604 with four options, 3, 4 and 7 with three, 202 with
    // two, the two logs with five, and the twenty others with one.
    assert_eq!(passed.len(), 6 * 4 + 3 * 3 + 2 + 2 * 5 + 20);
    for word in [0x0001, 0x3001, 0x2007, 0x10CA, 0x04B2, 0x44B3, 0x03EF] {
        assert!(passed.contains(&word), "{word:04X}");
    }
    for word in [
        0x0000, 0x4001, 0x0801, 0x3007, 0x10CD, 0x54B2, 0x0008, 0xFFFF,
    ] {
        assert!(!passed.contains(&word), "{word:04X}");
    }
    for address in 0..=u16::MAX {
        let f = Framing::Tcp;
        let one = gate.admit(f, &frame(f, 0, 4, &fc6(address, 1))).is_ok();
        let other = gate.admit(f, &frame(f, 0, 5, &fc16(address, 1))).is_ok();
        assert_eq!(
            (one, other),
            (address == 4000, address == 4000),
            "{address}"
        );
    }
    for unit in 0..=255 {
        assert_eq!(passes(&gate, unit, &fc6(4000, 1)), unit == 4, "{unit}");
        assert_eq!(passes(&gate, unit, &fc16(4000, 1)), unit == 5, "{unit}");
    }
}

/// Every function code with the address and the word of a request in it, and near misses.
#[test]
fn no_other_function_can_carry_it() {
    let gate = plant();
    for unit in [4, 5, 6, 7, 8] {
        for pdu in every_function() {
            let read = [1, 2, 3, 4, 7, 8, 11, 12, 17, 20, 24, 43].contains(&pdu[0]);
            assert_eq!(passes(&gate, unit, &pdu), read, "{unit} {pdu:?}");
            // The same function with the request's address and word behind it.
            let mut pdu = pdu;
            for (slot, byte) in pdu.iter_mut().skip(1).zip([0x0F, 0xA0, 0x00, 0x01]) {
                *slot = byte;
            }
            // What is in it then is request 0x0001, for 16 as for 6.
            let one = (unit, pdu[0]) == (4, 6) || (unit, pdu[0]) == (5, 16);
            let other = [8, 43].contains(&pdu[0]);
            let length = request(&pdu) == Length::Exact(pdu.len());
            let want = (read && !other && length) || one;
            assert_eq!(passes(&gate, unit, &pdu), want, "{unit} {pdu:?}");
        }
    }
    for pdu in [
        // Two registers, a count that lies, a byte too much, a byte too few.
        &[16, 0x0F, 0xA0, 0, 2, 4, 0, 1, 0, 1][..],
        &[16, 0x0F, 0xA0, 0, 1, 4, 0, 1, 0, 1],
        &[16, 0x0F, 0xA0, 0, 1, 2, 0, 1, 0],
        &[16, 0x0F, 0xA0, 0, 1, 2, 0],
        &[6, 0x0F, 0xA0, 0, 1, 0],
        &[6, 0x0F, 0xA0, 0],
        &[22, 0x0F, 0xA0, 0, 0, 0, 1],
        &[23, 0, 0, 0, 1, 0x0F, 0xA0, 0, 1, 2, 0, 1],
        &[5, 0x0F, 0xA0, 0xFF, 0],
    ] {
        assert!(!passes(&gate, 4, pdu) && !passes(&gate, 5, pdu), "{pdu:?}");
    }
}

#[test]
fn two_frames_are_not_one() {
    let gate = plant();
    let read = [3, 0, 0, 0, 1];
    for framing in Framing::MODBUS {
        let good = frame(framing, 1, 4, &fc6(4000, 1));
        let bad = frame(framing, 1, 4, &fc6(4001, 1));
        let read = frame(framing, 1, 4, &read);
        assert!(gate.admit(framing, &good).is_ok());
        for pair in [[&good, &bad], [&good, &good], [&read, &bad], [&good, &read]] {
            assert!(
                gate.admit(framing, &[pair[0].as_slice(), pair[1]].concat())
                    .is_err()
            );
        }
        for at in 0..good.len() {
            assert!(gate.admit(framing, &good[..at]).is_err());
        }
    }
}

#[test]
fn permits_are_for_configured_devices_and_known_words() {
    let gate = plant();
    let ask = |unit, word| {
        gate.permit(unit, Request::from_word(word))
            .map(|p| p.pdu().to_vec())
    };
    assert_eq!(ask(4, 0x1001), Ok(vec![6, 0x0F, 0xA0, 0x10, 0x01]));
    assert_eq!(
        ask(5, 0x1001),
        Ok(vec![16, 0x0F, 0xA0, 0, 1, 2, 0x10, 0x01])
    );
    assert_eq!(ask(4, 0x4001), Err(Denied::Unknown(0x4001)));
    assert_eq!(ask(4, 0x0801), Err(Denied::Unknown(0x0801)));
    for unit in [0, 1, 6, 7, 8, 255] {
        assert_eq!(ask(unit, 1), Err(Denied::NoTarget(unit)));
    }
}

/// The commands of the logs are those of the profile (reading M5); others do not pass.
#[test]
fn log_commands_follow_the_profile() {
    let json = r#"{"registers":{"request":1},"log":{"newest":5,"oldest":6,"older":7,"newer":8,"present":9}}"#;
    let gate = Gate::of(&[device(4, Device::Dop, Some(json))]);
    let known = |option: u16| passes(&gate, 4, &fc6(1, option << 12 | 1202));
    let options: Vec<u16> = (0..16).filter(|o| known(*o)).collect();
    assert_eq!(options, [5, 6, 7, 8, 9]);
}

/// Field units of a DDC-100 network are read and nothing else: no command (function 05 and 06 on
/// coils 1 to 9 and register 1, with every value), no preset, no reset, whatever their type.
#[test]
fn nothing_moves_a_field_unit() {
    let kinds = Device::ALL.into_iter().filter(|d| d.is_ddc());
    // Not even a profile opens a way.
    let devices: Vec<_> = (1..)
        .zip(kinds)
        .map(|(unit, kind)| device(unit, kind, Some(AT_4000)))
        .collect();
    assert_eq!(devices.len(), 5);
    let gate = Gate::of(&devices);
    let allowed = [1, 2, 3, 4, 7, 8, 11, 12, 17, 20, 24, 43];
    for unit in 0..=5 {
        for pdu in every_function() {
            assert_eq!(
                passes(&gate, unit, &pdu),
                allowed.contains(&pdu[0]),
                "{pdu:?}"
            );
        }
        for coil in 0..9 {
            for value in [0x0000, 0xFF00] {
                let mut pdu = fc6(coil, value);
                pdu[0] = 5;
                assert!(!passes(&gate, unit, &pdu), "{pdu:?}");
            }
        }
    }
    for value in 0..=u16::MAX {
        for pdu in [fc6(0, value), fc16(0, value), fc6(4000, value)] {
            let bytes = frame(Framing::Rtu, 0, 1, &pdu);
            assert!(gate.admit(Framing::Rtu, &bytes).is_err(), "{pdu:?}");
        }
    }
    // Clearing counters and restarting are functions 08; reading counters is not.
    for sub in 1..=300_u16 {
        let [high, low] = sub.to_be_bytes();
        let reads = [2, 11, 12, 13, 14, 15, 16, 17, 18].contains(&sub);
        assert_eq!(passes(&gate, 1, &[8, high, low, 0, 0]), reads, "{sub}");
    }
}
