use super::*;
use shared::ddc100::scaling::Scaling;

fn parse(text: &str) -> Result<Config, String> {
    Config::parse(Path::new("plant.toml"), text).map_err(|e| e.to_string())
}

/// A bus with the lines given, and a device on it.
fn with(bus: &str, device: &str) -> Result<Config, String> {
    parse(&format!(
        "[[bus]]\nname = \"a\"\n{bus}\n[[device]]\ntag = \"x\"\n{device}\n"
    ))
}

const RTU: &str = "kind = \"rtu\"\nport = \"/dev/ttyUSB0\"";
const ICON: &str = "kind = \"icon3000\"\nbus = \"a\"\nunit = 1";

#[test]
fn the_example_is_valid() {
    let config = parse(EXAMPLE).unwrap();
    assert!(config.buses.len() >= 5 && config.devices.len() >= 5);
    let kinds: Vec<_> = config.buses.iter().map(|b| b.line.framing()).collect();
    for framing in Framing::MODBUS {
        assert!(kinds.contains(&framing));
    }
}

#[test]
fn defaults_are_those_of_the_standard() {
    let config = with(RTU, ICON).unwrap();
    assert_eq!(config.listen, LISTEN);
    assert_eq!(config.buses[0].line.to_string(), "/dev/ttyUSB0 9600 8E1");
    let ascii = with("kind = \"ascii\"\nport = \"p\"", ICON).unwrap();
    assert_eq!(ascii.buses[0].line.to_string(), "p 9600 7E1");
    let tcp = with("kind = \"tcp\"\nhost = \"plc\"", ICON).unwrap();
    assert_eq!(tcp.buses[0].line.to_string(), "plc:502");
    let six = with("kind = \"tcp\"\nhost = \"fe80::1\"", ICON).unwrap();
    assert_eq!(six.buses[0].line.to_string(), "[fe80::1]:502");
    assert!(parse("").unwrap().buses.is_empty());
}

#[test]
fn refusals_name_the_line_and_what_to_do() {
    let check = |text: Result<Config, String>, line: usize, words: &[&str]| {
        let text = text.unwrap_err();
        assert!(
            text.starts_with(&format!("plant.toml, line {line}: ")),
            "{text}"
        );
        for word in words {
            assert!(text.contains(word), "{text} lacks {word}");
        }
    };
    check(
        with(&format!("{RTU}\nbaud = 9601"), ICON),
        5,
        &["9601", "9600, 19200"],
    );
    check(
        with(&format!("{RTU}\nmode = \"7E1\""), ICON),
        5,
        &["7E1", "8E1"],
    );
    check(
        with(&format!("{RTU}\nhost = \"a\""), ICON),
        5,
        &["host", "remove"],
    );
    check(
        with(&format!("{RTU}\nbuad = 9600"), ICON),
        5,
        &["buad", "baud"],
    );
    check(with("kind = \"rtu\"", ICON), 2, &["port", "/dev/ttyUSB0"]);
    check(with("kind = \"udp\"", ICON), 3, &["udp", "rtu-over-tcp"]);
    check(
        with("kind = \"tcp\"\nhost = \"a b\"", ICON),
        4,
        &["a b", "502"],
    );
    check(with("kind = \"tcp\"\nhost = \"a:0\"", ICON), 4, &["a:0"]);
    let device = |text: &str| with(RTU, text);
    check(
        device("kind = \"icon\"\nbus = \"a\"\nunit = 1"),
        7,
        &["icon3000v2"],
    );
    check(
        device("kind = \"none\"\nbus = \"b\"\nunit = 1"),
        8,
        &["\"b\"", "write \"a\""],
    );
    check(
        device("kind = \"none\"\nbus = \"a\"\nunit = 0"),
        9,
        &["all devices", "1 to 247"],
    );
    check(
        device("kind = \"none\"\nbus = \"a\"\nunit = 248"),
        9,
        &["248", "1 to 247"],
    );
    check(
        device("kind = \"ddc100-mx\"\nbus = \"a\"\nunit = 251"),
        9,
        &["251", "1 to 250"],
    );
    check(
        device("kind = \"none\"\nbus = \"a\"\nunit = \"1\""),
        9,
        &["`unit`", "whole number"],
    );
    check(
        device("kind = \"none\"\nbus = \"a\""),
        5,
        &["`unit`", "add it"],
    );
    let again = "[[device]]\ntag = \"x\"\nkind = \"none\"\nbus = \"a\"\nunit = 2";
    check(with(RTU, &format!("{ICON}\n{again}")), 11, &["already"]);
    let again = "[[device]]\ntag = \"y\"\nkind = \"none\"\nbus = \"a\"\nunit = 1";
    check(
        with(RTU, &format!("{ICON}\n{again}")),
        14,
        &["\"x\" already"],
    );
    check(
        with(
            "kind = \"simulator\"",
            "kind = \"none\"\nbus = \"a\"\nunit = 1",
        ),
        6,
        &["icon3000v2"],
    );
    check(parse("[server]\nlisten = \"8080\""), 2, &["127.0.0.1:8080"]);
    check(
        parse("[[bus]]\nname = \"a\"\n\nname = \"b\""),
        4,
        &["duplicate"],
    );
}

/// A directory with a profile in it; the configuration names it.
fn with_profile(name: &str, text: &str, device: &str) -> Result<Config, String> {
    let directory =
        std::env::temp_dir().join(format!("valvescope-config-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    std::fs::write(directory.join("site.json"), text).unwrap();
    let toml = format!("[[bus]]\nname = \"a\"\n{RTU}\n[[device]]\ntag = \"x\"\n{device}\n");
    let config = Config::parse(&directory.join("plant.toml"), &toml);
    std::fs::remove_dir_all(&directory).unwrap();
    config.map_err(|e| e.to_string())
}

const DOP: &str = "kind = \"dop\"\nbus = \"a\"\nunit = 1";

#[test]
fn a_dop_device_has_the_profile_of_its_site() {
    let named = format!("{DOP}\nprofile = \"site.json\"");
    let config = with_profile("good", r#"{"registers":{"request":17}}"#, &named).unwrap();
    let profile = config.devices[0].profile.as_ref().unwrap();
    assert_eq!(profile.registers.request, Some(17));
    assert_eq!(config.devices[0].device, Device::Dop);
    // None is named: nothing is known of the site.
    let config = with(RTU, DOP).unwrap();
    assert_eq!(
        config.devices[0].profile.as_deref(),
        Some(&Profile::default())
    );
    // On the simulator the addresses are its own.
    let config = with("kind = \"simulator\"", DOP).unwrap();
    let profile = config.devices[0].profile.as_ref().unwrap();
    assert_eq!(profile.registers.request, Some(4000));
    assert_eq!(with(RTU, ICON).unwrap().devices[0].profile, None);
}

#[test]
fn mistakes_in_a_profile_name_file_line_and_key() {
    let check = |result: Result<Config, String>, words: &[&str]| {
        let text = result.unwrap_err();
        assert!(text.contains("plant.toml, line 10: "), "{text}");
        for word in words {
            assert!(text.contains(word), "{text} lacks {word}");
        }
    };
    let named = format!("{DOP}\nprofile = \"site.json\"");
    let wrong = "{\n\"registers\": {\n\"requst\": 1\n}\n}";
    check(
        with_profile("key", wrong, &named),
        &["site.json", "line 3", "registers.requst"],
    );
    check(
        with_profile("json", "{\n", &named),
        &["site.json", "line 2"],
    );
    check(
        with_profile("table", r#"{"table":"coil"}"#, &named),
        &["line 1", "table"],
    );
    let other = format!("{DOP}\nprofile = \"none.json\"");
    check(
        with_profile("gone", "{}", &other),
        &["none.json", "can't read"],
    );
    let icon = format!("{ICON}\nprofile = \"site.json\"");
    check(
        with_profile("icon", "{}", &icon),
        &["icon3000", "no `profile`", "remove"],
    );
}

#[test]
fn the_default_plant_is_simulated() {
    let config = Config::simulated();
    assert_eq!(config.devices[0].tag, "XV-101");
    assert_eq!(config.devices[0].device, Device::Icon3000v2);
    assert!(config.buses.iter().all(|b| b.line.is_simulated()));
}

#[test]
fn modes_have_their_bits() {
    for (text, bits) in [
        ("8N1", 10),
        ("8E1", 11),
        ("8N2", 11),
        ("7E1", 10),
        ("7N2", 10),
    ] {
        assert_eq!(Mode::parse(text).map(Mode::bits), Some(bits), "{text}");
    }
    assert_eq!(Mode::parse("9N1"), None);
}

const LOOP: &str =
    "kind = \"ddc100\"\nshape = \"loop\"\nport = \"/dev/ttyUSB0\"\nport2 = \"/dev/ttyUSB1\"";
const MX: &str = "kind = \"ddc100-mx\"\nbus = \"a\"\nunit = 250";

#[test]
fn a_network_has_the_defaults_of_its_guide() {
    let config = with(LOOP, MX).unwrap();
    let bus = &config.buses[0];
    let ddc = bus.line.ddc().unwrap();
    // LMAIM4019-00: table 3.1, section 4.3, section 3.2.3.
    assert_eq!(bus.line.to_string(), "/dev/ttyUSB0, /dev/ttyUSB1 9600 8N1");
    assert_eq!(ddc.framing, Framing::Rtu);
    assert_eq!((ddc.start, ddc.count), (7, 9), "registers 8 to 16");
    assert_eq!(ddc.paths(), ["/dev/ttyUSB0", "/dev/ttyUSB1"]);
    assert!(bus.turnaround > Duration::from_millis(20));
    assert!(bus.timeout > Duration::from_millis(200) && bus.retries <= 3);
    let all = format!(
        "{LOOP}\nframing = \"ascii\"\nbaud = 1200\nmode = \"8E1\"\nregisters = \"1-56\"\nturn_ms = 49\n\
         timeout_ms = 201\nretries = 0\nretry_faulty = true"
    );
    let config = with(&all, MX).unwrap();
    let ddc = config.buses[0].line.ddc().unwrap();
    assert_eq!((ddc.framing, ddc.baud), (Framing::Ascii, 1200));
    assert_eq!((ddc.start, ddc.count), (0, 56));
    assert!(ddc.retry_faulty);
    let single = "kind = \"ddc100\"\nshape = \"single-ended\"\nport = \"p\"";
    let config = with(single, MX).unwrap();
    assert_eq!(config.buses[0].line.ddc().unwrap().paths(), ["p"]);
    let simulated = "kind = \"ddc100-simulator\"\nshape = \"loop\"\nfaults = [\"break-1\", \"off-250 from 5 to 9 every 20\"]";
    let config = with(simulated, MX).unwrap();
    assert!(config.buses[0].line.is_simulated());
    assert_eq!(config.buses[0].line.ddc().unwrap().paths().len(), 2);
}

#[test]
fn refusals_about_networks_name_the_line_and_what_to_do() {
    let check = |bus: &str, device: &str, line: usize, words: &[&str]| {
        let text = with(bus, device).unwrap_err();
        assert!(
            text.starts_with(&format!("plant.toml, line {line}: ")),
            "{text}"
        );
        for word in words {
            assert!(text.contains(word), "{text} lacks {word}");
        }
    };
    let wrong = |key: &str, words: &[&str]| check(&format!("{LOOP}\n{key}"), MX, 7, words);
    wrong("baud = 38400", &["38400", "1200, 2400, 4800, 9600, 19200"]);
    wrong("mode = \"7E1\"", &["7E1", "8N1"]);
    wrong("framing = \"tcp\"", &["tcp", "\"rtu\" or \"ascii\""]);
    wrong("turn_ms = 20", &["20", "21 to 49"]);
    wrong("turn_ms = 50", &["50", "21 to 49"]);
    wrong("timeout_ms = 200", &["200", "201 to"]);
    wrong("retries = 4", &["4", "0 to 3"]);
    wrong("turnaround_ms = 25", &["turnaround_ms", "turn_ms"]);
    wrong("host = \"plc\"", &["host", "remove"]);
    wrong("faults = [\"off-1\"]", &["faults", "remove"]);
    for registers in ["9", "0-13", "9-57", "13-8", "a-b", "9-"] {
        wrong(
            &format!("registers = \"{registers}\""),
            &[registers, "8-16"],
        );
    }
    wrong("registers = \"10-13\"", &["at least 9", "10"]);
    wrong("registers = \"1-9\"", &["at least 9", "10"]);
    let network = "kind = \"ddc100\"\nport = \"p\"";
    check(network, MX, 2, &["shape", "single-ended"]);
    check(
        &format!("{network}\nshape = \"ring\""),
        MX,
        5,
        &["ring", "multi-drop"],
    );
    check(
        &format!("{network}\nshape = \"loop\""),
        MX,
        2,
        &["port2", "single-ended"],
    );
    let twice = format!("{network}\nshape = \"loop\"\nport2 = \"p\"");
    check(&twice, MX, 6, &["same as `port`"]);
    let drop = format!("{network}\nshape = \"multi-drop\"\nport2 = \"q\"");
    check(&drop, MX, 6, &["remove `port2`", "loop"]);
    check(
        "kind = \"ddc100\"\nshape = \"loop\"",
        MX,
        2,
        &["host port 1"],
    );
    let icon = "kind = \"icon3000\"\nbus = \"a\"\nunit = 1";
    check(
        LOOP,
        icon,
        9,
        &["icon3000", "\"ddc100-mx\"", "\"ddc100-io\""],
    );
    check(RTU, &MX.replace("250", "251"), 9, &["1 to 250"]);
    let rtu = "shape = \"loop\"";
    check(&format!("{RTU}\n{rtu}"), ICON, 5, &["shape", "remove"]);
    check("kind = \"simulator\"", MX, 6, &["ddc100-simulator"]);
    let empty = parse(&format!("[[bus]]\nname = \"a\"\n{LOOP}")).unwrap_err();
    assert!(
        empty.contains("line 2") && empty.contains("no units"),
        "{empty}"
    );
    let simulated = |faults: &str| {
        format!("kind = \"ddc100-simulator\"\nshape = \"loop\"\nfaults = [\n{faults}]")
    };
    check(&simulated("\"melt-3\""), MX, 6, &["melt-3", "break-N"]);
    check(
        &simulated("\"break-1\",\n\"off-7\""),
        MX,
        7,
        &["off-7", "no place or unit"],
    );
    check(&simulated("\"break-2\""), MX, 6, &["break-2", "1 units"]);
}

#[test]
fn the_plant_without_a_configuration_has_a_network_that_can_be() {
    let config = Config::simulated();
    let bus = config
        .buses
        .iter()
        .find(|b| b.line.ddc().is_some())
        .unwrap();
    let ddc = bus.line.ddc().unwrap();
    let units: Vec<_> = config.on(bus).cloned().collect();
    assert_eq!(units.len(), 12);
    let setup = crate::bus::ddc::setup(bus, ddc, &units).unwrap();
    assert_eq!(setup.problems(), []);
    let DdcPorts::Simulated(faults) = &ddc.ports else {
        panic!("it is simulated");
    };
    let clock = crate::clock::Clock::start();
    assert!(crate::sim::ddc::Network::new(ddc.shape, &units, faults, clock).is_ok());
}

// ---- HART

const HART: &str = "kind = \"hart\"\nport = \"/dev/ttyUSB0\"";
const IQ: &str = "kind = \"rotork-iq\"\nbus = \"a\"\npoll = 0";

#[test]
fn hart_lines_have_the_values_of_the_standard() {
    use super::hart::{HartWay, Keying};
    use shared::hart::link::Target;
    let config = with(HART, IQ).unwrap();
    let bus = &config.buses[0];
    assert_eq!(
        bus.line.to_string(),
        "/dev/ttyUSB0 1200 8O1, primary master"
    );
    assert_eq!((bus.line.framing(), bus.retries), (Framing::Hart, 3));
    assert_eq!(config.devices[0].target, Some(Target::Polling(0)));
    let all = "master = \"secondary\"\nbaud = 1200\nmode = \"8O1\"\nretries = 1\npreambles = 8\n\
               gap_ms = 60\nrts_lead_ms = 10\nrts_tail_ms = 0";
    let config = with(&format!("{HART}\n{all}"), IQ).unwrap();
    let hart = config.buses[0].line.hart().unwrap();
    assert!(!hart.primary);
    assert_eq!((hart.preambles, config.buses[0].retries), (Some(8), 1));
    let HartWay::Serial { keying, .. } = &hart.way else {
        panic!("{hart:?}");
    };
    let ms = Duration::from_millis;
    let (lead, tail) = (ms(10), ms(0));
    assert_eq!(*keying, Keying { lead, tail });
    assert_eq!(hart.setup(1).timing.gap, 60_000);
    let ip = with(
        "kind = \"hart-ip\"\nhost = \"gateway\"\ntransport = \"udp\"",
        IQ,
    )
    .unwrap();
    let line = &ip.buses[0].line;
    assert_eq!(
        line.to_string(),
        "gateway:5094, HART-IP over UDP, primary master"
    );
    assert_eq!(line.framing(), Framing::HartIp);
    let simulated = with("kind = \"simulator\"", IQ).unwrap();
    let line = &simulated.buses[0].line;
    assert!(line.is_simulated() && line.framing() == Framing::Hart);
    for (way, target) in [
        (
            "address = \"AEDD012345\"",
            Target::Unique(0x2EDD, 0x01_2345),
        ),
        ("hart_tag = \"fv-401\"", Target::tag("FV-401").unwrap()),
        (
            "long_tag = \"Kühlwasser\"",
            Target::long_tag("Kühlwasser").unwrap(),
        ),
    ] {
        let device = format!("kind = \"rotork-cva\"\nbus = \"a\"\n{way}");
        let config = with(HART, &device).unwrap();
        assert_eq!(config.devices[0].target, Some(target), "{way}");
    }
}

#[test]
fn refusals_of_hart_lines_say_what_to_do() {
    let refused = |bus: &str, device: &str, line: usize, words: &[&str]| {
        let text = with(bus, device).unwrap_err();
        let start = format!("plant.toml, line {line}: ");
        assert!(text.starts_with(&start), "{text}");
        for word in words {
            assert!(text.contains(word), "{text} lacks {word}");
        }
    };
    refused("kind = \"hart\"", IQ, 2, &["port", "/dev/ttyUSB0"]);
    refused(&format!("{HART}\nbaud = 9601"), IQ, 5, &["9601", "1200"]);
    refused(&format!("{HART}\nmode = \"8E1\""), IQ, 5, &["8E1", "8O1"]);
    refused(
        &format!("{HART}\nmaster = \"first\""),
        IQ,
        5,
        &["first", "secondary"],
    );
    refused(&format!("{HART}\npreambles = 4"), IQ, 5, &["4", "5 to 20"]);
    refused(&format!("{HART}\ngap_ms = 5"), IQ, 5, &["10 to 500"]);
    refused(
        &format!("{HART}\nhost = \"x\""),
        IQ,
        5,
        &["no `host`", "remove"],
    );
    refused(
        &format!("{HART}\nturnaround_ms = 5"),
        IQ,
        5,
        &["no `turnaround_ms`", "remove"],
    );
    refused("kind = \"hart-ip\"", IQ, 2, &["host", "5094"]);
    let ip = "kind = \"hart-ip\"\nhost = \"x\"";
    refused(
        &format!("{ip}\ntransport = \"tls\""),
        IQ,
        5,
        &["tls", "tcp", "udp"],
    );
    refused(&format!("{ip}\nport = \"x\""), IQ, 5, &["no `port`"]);
    refused(RTU, IQ, 8, &["no HART line", "hart-ip"]);
    refused(HART, ICON, 7, &["icon3000", "rotork-iq"]);
    let iq = "kind = \"rotork-iq\"\nbus = \"a\"";
    refused(HART, iq, 5, &["poll", "address", "long_tag"]);
    refused(HART, &format!("{iq}\nunit = 1"), 5, &["poll"]);
    refused(HART, &format!("{iq}\npoll = 64"), 9, &["64", "0 to 63"]);
    refused(
        HART,
        &format!("{iq}\npoll = 1\nunit = 1"),
        10,
        &["no `unit`", "poll"],
    );
    refused(
        HART,
        &format!("{iq}\npoll = 1\naddress = \"x\""),
        10,
        &["only one"],
    );
    refused(
        HART,
        &format!("{iq}\naddress = \"AEDD\""),
        9,
        &["ten hexadecimal"],
    );
    refused(
        HART,
        &format!("{iq}\nhart_tag = \"NINE SIGNS\""),
        9,
        &["8 characters"],
    );
    refused(
        HART,
        &format!("{iq}\nlong_tag = \"\""),
        9,
        &["32 characters"],
    );
    refused(
        RTU,
        "kind = \"none\"\nbus = \"a\"\nunit = 1\npoll = 1",
        10,
        &["no `poll`", "unit"],
    );
    let simulator = "kind = \"simulator\"";
    refused(
        simulator,
        &format!("{iq}\nhart_tag = \"A\""),
        5,
        &["polling address"],
    );
    let second = format!("{IQ}\n[[device]]\ntag = \"y\"\n{ICON}");
    refused(simulator, &second, 12, &["speaks HART", "of their own"]);
    let second = format!("{ICON}\n[[device]]\ntag = \"y\"\n{IQ}");
    refused(simulator, &second, 12, &["speaks Modbus", "of their own"]);
    let second = format!("{IQ}\n[[device]]\ntag = \"y\"\n{IQ}");
    refused(HART, &second, 11, &["same way"]);
}

/// A network with this tag list beside its configuration, and the devices given.
fn with_tags(name: &str, csv: &str, devices: &str) -> Result<Config, String> {
    let directory =
        std::env::temp_dir().join(format!("valvescope-tags-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    std::fs::write(directory.join("units.csv"), csv).unwrap();
    let toml = format!("[[bus]]\nname = \"a\"\n{LOOP}\ntags = \"units.csv\"\n{devices}");
    let config = Config::parse(&directory.join("plant.toml"), &toml);
    std::fs::remove_dir_all(&directory).unwrap();
    config.map_err(|e| e.to_string())
}

#[test]
fn a_tag_list_names_the_units_of_a_network() {
    // In the style of table 6.1: points of units, and lines that name the units themselves.
    let list = "Tag name,Description,Unit,Type,Register\n\
                80-HS-4141A,Open actuator,7,,40001\n\
                MOV-4141,Inlet,7,ddc100-uec,\n\
                80-POS-4142,Position,3,ddc100-mx,40008\n";
    let after = "[[device]]\ntag = \"x\"\nkind = \"ddc100-io\"\nbus = \"a\"\nunit = 1\n";
    let config = with_tags("good", list, after).unwrap();
    let units: Vec<_> = config
        .devices
        .iter()
        .map(|d| (d.unit, d.device, d.tag.as_str(), d.description.as_str()))
        .collect();
    assert_eq!(
        units,
        [
            (7, Device::Ddc100Uec, "MOV-4141", "Inlet"),
            (3, Device::Ddc100Mx, "80-POS-4142", "Position"),
            (1, Device::Ddc100Io, "x", ""),
        ]
    );
    assert!(config.buses[0].line.ddc().unwrap().scalings.is_empty());
    // The scaling of register 8 counts before another one of the unit, wherever it stands.
    let list = "Tag name,Unit,Type,Register,Scaling\n\
                a,7,ddc100-uec,40007,0-255\n\
                b,7,,40008,0-4095\n\
                c,3,ddc100-mx,,raw\n\
                d,4,ddc100-mx,40008,\n";
    let config = with_tags("scaling", list, "").unwrap();
    let scalings = &config.buses[0].line.ddc().unwrap().scalings;
    let want = [(3, Scaling::Raw), (7, Scaling::TwelveBits)];
    assert_eq!(
        scalings.iter().map(|(u, s)| (*u, *s)).collect::<Vec<_>>(),
        want
    );
    let head = "Tag name,Unit,Type\n";
    let many: String = (1..=250)
        .map(|n| format!("M-{n},{n},ddc100-mx\n"))
        .collect();
    let config = with_tags("many", &format!("{head}{many}"), "").unwrap();
    assert_eq!(config.devices.len(), 250);
    let check = |name: &str, csv: &str, line: usize, words: &[&str]| {
        let text = with_tags(name, &format!("{head}{csv}"), after).unwrap_err();
        assert!(
            text.contains(&format!("plant.toml, line {line}: ")),
            "{text}"
        );
        for word in words {
            assert!(text.contains(word), "{text} lacks {word}");
        }
    };
    check("type", "M-1,4,\n", 7, &["units.csv", "unit 4", "ddc100-mx"]);
    check(
        "unit",
        "M-1,251,ddc100-mx\n",
        7,
        &["units.csv", "251", "line 2"],
    );
    check("empty", "", 7, &["units.csv"]);
    check(
        "unit-twice",
        "M-1,1,ddc100-mx\n",
        12,
        &["unit 1", "already"],
    );
    check("tag-twice", "x,4,ddc100-mx\n", 9, &["\"x\" already"]);
    let missing = with(&format!("{LOOP}\ntags = \"nowhere.csv\""), MX).unwrap_err();
    assert!(
        missing.contains("line 7") && missing.contains("nowhere.csv"),
        "{missing}"
    );
    let stray = with(&format!("{RTU}\ntags = \"units.csv\""), ICON).unwrap_err();
    assert!(
        stray.contains("line 5") && stray.contains("remove"),
        "{stray}"
    );
}

#[test]
fn a_simulated_icon_may_have_faults() {
    use shared::sim::Fault;
    let icon = |faults: &str| format!("{ICON}\nfaults = [{faults}]");
    let config = with(
        "kind = \"simulator\"",
        &icon("\"lost-phase\", \"pst-return\""),
    )
    .unwrap();
    assert_eq!(
        config.devices[0].faults,
        [Fault::LostPhase, Fault::PstReturn]
    );
    let wrong = |bus: &str, faults: &str| with(bus, &icon(faults)).unwrap_err();
    let hunger = wrong("kind = \"simulator\"", "\"hunger\"");
    assert!(
        hunger.contains("hunger") && hunger.contains("thermostat, "),
        "{hunger}"
    );
    let real = wrong(RTU, "\"lost-phase\"");
    assert!(real.contains("simulated"), "{real}");
    // Reading E37: of an ICON2000v4 no stroke test is stated.
    let old = |fault: &str| {
        let device = icon(fault).replace("icon3000", "icon2000v4");
        with("kind = \"simulator\"", &device)
    };
    assert!(old("\"lost-phase\"").is_ok());
    let none = old("\"pst-return\"").unwrap_err();
    assert!(
        none.contains("pst-return") && none.contains("stroke tests"),
        "{none}"
    );
}
