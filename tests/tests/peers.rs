//! Other implementations of Modbus as judges of ours.

use tests::peers;

/// Both peers are there and start.
#[test]
fn the_peers_start() {
    let version = peers::python()
        .args(["-c", "import pymodbus; print(pymodbus.__version__)"])
        .output();
    assert!(version.expect("python starts").status.success());
    let help = peers::mbpoll().arg("-V").output().expect("mbpoll starts");
    assert!(String::from_utf8_lossy(&help.stdout).contains("mbpoll"));
}
