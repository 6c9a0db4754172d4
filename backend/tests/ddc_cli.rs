//! The command line about DDC-100: maps of each type, and the estimate of a scan, as they are printed.
//!
//! What is expected is that of LMAIM4019-00 (9/04): tables 3.3 to 3.7, 4.1 and 4.2.

use serde_json::Value;
use std::process::Command;

const PROGRAM: &str = env!("CARGO_BIN_EXE_valvescope");

fn run(arguments: &[&str]) -> String {
    let output = Command::new(PROGRAM).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn maps(device: &str, format: &str) -> String {
    run(&["maps", "--device", device, "--format", format])
}

/// The line with all of these words.
fn line<'a>(text: &'a str, words: &[&str]) -> &'a str {
    let mut all = text.lines();
    all.find(|l| words.iter().all(|w| l.contains(w)))
        .unwrap_or_else(|| panic!("no line with {words:?} in\n{text}"))
}

const DEVICES: [&str; 4] = ["ddc100-mx", "ddc100-uec", "ddc100-clamshell", "ddc100-io"];

/// Table 3.3 (coils), 3.4 (inputs, none of an MX), 3.5 (bits) and 3.7 with section 3.2.6 (commands).
#[test]
fn maps_as_text() {
    // Coil 3; status input 129; bit 13 of register 10; command 2304; one-step move-to.
    let expected = [
        ("AS-1", "", "Local stop", "Engage AS-1"),
        (
            "Lockout or Relay 3",
            "Opened",
            "Wrong rotation",
            "Engage relay 1 (do not use)",
        ),
        (
            "Lockout or Relay 3",
            "Opened",
            "Wrong rotation",
            "Engage relay 1 (do not use)",
        ),
        ("Relay 3", "", "", "Engage relay K2"),
    ];
    for (device, (coil, input, bit, engage)) in DEVICES.into_iter().zip(expected) {
        let text = maps(device, "text");
        let section = |name: &str| {
            let from = text.find(name).unwrap_or_else(|| panic!("no {name}"));
            let rest = &text[from..];
            &rest[..rest.find("\n\n").unwrap_or(rest.len())]
        };
        line(section(", coils"), &["3", coil]);
        match device {
            // Note of table 3.2: no function 02, hence no inputs.
            "ddc100-mx" => assert!(!text.contains(", discrete inputs") && !text.contains("100129")),
            _ => {
                line(section(", discrete inputs"), &["100129", input]);
                line(section(", discrete inputs"), &["100208"]);
            }
        }
        let holding = section(", holding registers");
        if !bit.is_empty() {
            line(holding, &["13", bit]);
        }
        line(holding, &["2304", engage]);
        line(holding, &["512", "Stop"]);
        // Section 3.2.6: the move-to in one step, of those that move.
        match device {
            "ddc100-io" => assert!(!holding.contains("19200")),
            _ => {
                line(holding, &["19200-19300", "Move to"]);
            }
        }
        // Functions 15 and 16 depend on the firmware; the note names MX/DDC and UEC-3-DDC.
        let functions = section(", functions");
        let firmware = match device {
            "ddc100-mx" => "From firmware 02/01.00",
            "ddc100-uec" => "From Modbus firmware 2.00",
            _ => "Not certain",
        };
        for code in ["15", "16"] {
            line(functions, &[code, "multiple", firmware]);
        }
    }
}

#[test]
fn maps_as_json_and_csv() {
    for device in DEVICES {
        let text = maps(device, "json");
        let rows: Vec<Value> = text
            .lines()
            .map(|l| serde_json::from_str(l).unwrap())
            .collect();
        let row = |table: &str, number: u64| {
            rows.iter()
                .find(|r| r["table"] == table && r["address"] == number - 1)
        };
        assert!(row("coil", 9).is_some(), "{device}");
        let input = row("discrete", 129);
        assert_eq!(input.is_none(), device == "ddc100-mx", "{device}");
        let faults = row("holding", 10).unwrap().to_string();
        let bit = match device {
            "ddc100-mx" => "Local stop",
            "ddc100-io" => "not used",
            _ => "Wrong rotation",
        };
        assert!(faults.contains(bit), "{device}: {faults}");
        let commands = row("holding", 1).unwrap().to_string();
        for value in ["2304", "256", "6656"] {
            assert!(commands.contains(value), "{device}: {commands}");
        }
        let moves = commands.contains("19200") && commands.contains("19300");
        assert_eq!(moves, device != "ddc100-io", "{device}: {commands}");
        // As many lines as rows, and a head.
        let csv = maps(device, "csv");
        assert_eq!(csv.lines().count(), rows.len() + 1, "{device}");
        line(&csv, &["coil", "LMAIM4019-00"]);
    }
}

/// Tables 4.1 and 4.2 beside the estimate; what contradicts is marked (reading D23).
#[test]
fn scan_times_as_text() {
    let text = run(&["ddc100", "scan-time"]);
    line(
        &text,
        &["LMAIM4019-00, tables 4.1 and 4.2", "* below", "D23"],
    );
    let types: Vec<&str> = text.split("\n\n").skip(1).collect();
    assert_eq!(types.len(), 2);
    // Table 4.2, by the number of registers: units, and what is printed.
    let mx = [
        [".40", ".80", "1.6", "2.3", "4.6", "9.2", "11.5"],
        [".50", ".98 *", "2.0", "2.9", "6", "10", "12"],
        [".61 *", "1.3", "2.5", "3.8", "6.5", "13", "16"],
    ];
    let uec = [
        [".94", "1.9", "3.9", "5.0", "11", "24", "32"],
        ["1.4", "2.8", "5.6", "7", "15", "32", "42"],
        ["1.9", "3.8", "7.6", "9.6", "20", "43", "56"],
    ];
    let each = [["40.0", "50.0", "62.0"], ["71.0", "109.0", "162.0"]];
    for (((text, printed), each), name) in types
        .into_iter()
        .zip([mx, uec])
        .zip(each)
        .zip(["DDC-100 MX", "DDC-100 UEC"])
    {
        assert!(text.contains(name), "{text}");
        let blocks: Vec<&str> = text.split(" register").skip(1).collect();
        for ((block, printed), each) in blocks.iter().zip(printed).zip(each) {
            assert!(
                block.contains(&format!(": {each} ms a unit (table 4.1)")),
                "{block}"
            );
            let rows: Vec<&str> = block.lines().skip(2).take(7).collect();
            for ((row, printed), units) in rows
                .iter()
                .zip(printed)
                .zip([10, 20, 40, 50, 100, 200, 250])
            {
                let cells: Vec<&str> = row.split_whitespace().collect();
                assert_eq!(cells[0], units.to_string(), "{row}");
                let star = if cells.get(4) == Some(&"*") { " *" } else { "" };
                assert_eq!(format!("{}{star}", cells[3]), printed, "{row}");
            }
        }
    }
    // Section 4.3: 20 MX/DDC with 5 registers, 0.98 s as printed, 1.00 s by table 4.1, and 20 turns.
    let one = run(&[
        "ddc100",
        "scan-time",
        "--units",
        "20",
        "--registers",
        "5",
        "--device",
        "ddc100-mx",
    ]);
    let row = one.lines().last().unwrap();
    let cells: Vec<&str> = row.split_whitespace().collect();
    assert_eq!(cells, ["20", "1.42", "1.00", ".98", "*", "0.63"]);
    // No other line than that of the tables has a print.
    let slow = run(&["ddc100", "scan-time", "--units", "20", "--baud", "1200"]);
    assert!(
        !slow.contains(" * ") || slow.matches('*').count() == 1,
        "{slow}"
    );
    let last = slow.lines().last().unwrap();
    assert_eq!(last.split_whitespace().nth(3), Some("-"), "{slow}");
}
