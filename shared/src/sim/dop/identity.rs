//! Object 1006: what is built in.

use super::put::Put;
use super::unit::Unit;

pub(super) fn put(unit: &Unit, out: &mut Put) {
    let serial = format!("L{:08}", unit.seed);
    let texts: [(&str, usize); 21] = [
        (&unit.tag, 9),
        ("QA-PASS-7", 5),
        ("14:05:31", 6),
        ("2025-03-18", 5),
        (&serial, 5),
        ("SO-2211894", 6),
        ("QA-PASS-9", 5),
        ("HCB 1.04", 6),
        ("HCA 3.12", 5),
        ("UIB 1.02", 6),
        ("UIA 2.08", 5),
        ("00:1B:63:84:45:E6", 10),
        ("Limitorque simulated unit", 17),
        ("BT 5.1.3", 6),
        ("SIM-NO-FCC-ID", 8),
        ("1.1", 3),
        // No second output board.
        ("", 3),
        ("2.00", 3),
        ("NET-MB 1.07", 7),
        ("MC 4.20", 5),
        ("E 1.3", 3),
    ];
    for (text, registers) in texts {
        out.text(text, registers);
    }
}
