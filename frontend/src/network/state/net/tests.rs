use super::*;
use shared::device::Device;
use shared::proto::DdcUnit;

/// A loop of so many units of the UEC-3-DDC, nothing tried yet.
pub(crate) fn network(units: u8, shape: DdcShape, ports: usize) -> Net {
    let mut net = Net::default();
    let unit = |unit: u8| DdcUnit {
        unit,
        kind: "ddc100-uec".into(),
        tag: format!("MOV-{unit:03}"),
        description: String::new(),
    };
    let lines = ["/dev/ttyS0", "/dev/ttyS1"];
    net.hear(DdcNews::Network {
        bus: "Loop".into(),
        shape,
        framing: "modbus-rtu".into(),
        baud: 9600,
        ports: lines.iter().take(ports).map(|l| (*l).to_owned()).collect(),
        start: 7,
        count: 9,
        turn_ms: 30,
        timeout_ms: 250,
        retries: 3,
        units: (1..=units).map(unit).collect(),
    });
    net
}

/// What a poll of a unit brought: its faults, and the registers from 8 on if it answered.
pub(crate) fn poll(net: &mut Net, unit: u8, fault: [Option<bool>; 2], words: &[u16]) {
    let count = u8::try_from(words.len()).unwrap();
    let mut response = format!("03{:02x}", count * 2);
    for word in words {
        response.push_str(&format!("{word:04x}"));
    }
    let good = !words.is_empty();
    net.hear(DdcNews::Unit {
        bus: "Loop".into(),
        unit,
        port: 1,
        outcome: if good { Outcome::Ok } else { Outcome::Silence },
        text: if good {
            String::new()
        } else {
            "no answer within 250 ms".into()
        },
        fault_a: fault[0],
        fault_b: fault[1],
        request: format!("030007{count:04x}"),
        response: if good { response } else { String::new() },
        at_us: good.then_some(5_000_000),
        took_us: good.then_some(71_000),
    });
}

#[test]
fn a_network_is_built_up_from_news() {
    let mut net = network(3, DdcShape::Loop, 2);
    assert_eq!(net.units.len(), 3);
    assert_eq!(net.units[0].device, Device::Ddc100Uec);
    assert_eq!(net.units[0].reach(2), Reach::Unknown);
    poll(&mut net, 2, [Some(false), Some(false)], &[61, 0x0801]);
    let unit = &net.units[1];
    assert_eq!((unit.at, unit.took), (Some(5_000_000), Some(71_000)));
    assert_eq!(unit.image.len(), 2);
    assert_eq!(unit.reach(2), Reach::Full);
    // A fault does not take the last values away.
    poll(&mut net, 2, [Some(true), Some(true)], &[]);
    assert_eq!(net.units[1].image.len(), 2);
    assert_eq!(net.units[1].reach(2), Reach::Lost);
    // Nothing of another network.
    poll(&mut net, 9, [Some(true), None], &[]);
    net.hear(DdcNews::Pass {
        bus: "Loop".into(),
        port: 2,
        number: 8,
        took_us: 400_000,
        expected_us: 390_000,
    });
    assert_eq!(net.passes, 8);
    assert_eq!(net.ports[1].pass, Some((400_000, 390_000)));
    net.hear(DdcNews::Port {
        bus: "Loop".into(),
        port: 3,
        state: LineState::Down,
        text: String::new(),
    });
    assert!(net.ports.iter().all(|p| p.state == LineState::Starting));
}

#[test]
fn faults_say_which_port_reaches() {
    use Reach::{Full, Half, Lost, Only, Unknown};
    let (no, yes) = (Some(false), Some(true));
    for (fault, two, one) in [
        ([None, None], Unknown, Unknown),
        ([no, no], Full, Full),
        ([no, yes], Only(1), Full),
        ([yes, no], Only(2), Lost),
        ([yes, yes], Lost, Lost),
        ([no, None], Half(1, true), Full),
        ([yes, None], Half(1, false), Lost),
        ([None, no], Half(2, true), Unknown),
        ([None, yes], Half(2, false), Unknown),
    ] {
        assert_eq!((reach(fault, 2), reach(fault, 1)), (two, one), "{fault:?}");
    }
}

/// Example 3 of section 4.3.2: preliminary until a pass on each port bore it out.
#[test]
fn passes_bear_a_diagnosis_out() {
    let mut net = network(5, DdcShape::Loop, 2);
    for unit in 1..=5 {
        let fault = [Some(unit > 3), Some(unit <= 3)];
        poll(&mut net, unit, fault, &[61, 0x0801, 0, 0, 0, 0, 0, 0, 0]);
    }
    let unsettled = |net: &Net| net.diagnosis().unwrap().unsettled;
    assert_eq!(net.diagnosis().unwrap().findings[0].key(), "break");
    assert!(unsettled(&net) > 0);
    let pass = |net: &mut Net, port| {
        net.hear(DdcNews::Pass {
            bus: "Loop".into(),
            port,
            number: 1,
            took_us: 1,
            expected_us: 1,
        });
    };
    // The pass in which it changed proves nothing.
    pass(&mut net, 1);
    assert!(unsettled(&net) > 0);
    pass(&mut net, 2);
    pass(&mut net, 1);
    assert_eq!(unsettled(&net), 0);
    // One unit changes: everything has to be looked at again.
    poll(&mut net, 2, [Some(true), Some(true)], &[]);
    assert!(unsettled(&net) > 0);
}

#[test]
fn a_read_that_was_asked_ends_once() {
    let mut net = network(2, DdcShape::SingleEnded, 1);
    net.ask(7, 2);
    let read = |id| DdcNews::Read {
        id,
        bus: "Loop".into(),
        unit: 2,
        outcome: Outcome::Ok,
        text: String::new(),
        request: "0300000002".into(),
        response: "030400010002".into(),
        at_us: 9,
    };
    net.hear(read(6));
    assert_eq!(net.asked.as_ref().unwrap().end, None);
    net.hear(read(7));
    assert_eq!(
        net.asked.as_ref().unwrap().end,
        Some((Outcome::Ok, String::new()))
    );
    net.lost();
    assert_eq!(net.asked.unwrap().end.unwrap().0, Outcome::Ok);
    let mut net = network(2, DdcShape::SingleEnded, 1);
    net.ask(8, 1);
    net.lost();
    assert_eq!(net.asked.unwrap().end.unwrap().0, Outcome::Down);
}
