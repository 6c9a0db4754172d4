//! The screens of devices on a line: the simulated loop, a pseudo terminal with a device of another
//! process at its other end, a gateway.

use std::process::Command;
use std::time::Duration;

use tests::browser::{Page, Scheme};
use tests::process::Process;
use tests::server::{Server, binary};

use super::gateway;

/// What a line of 1200 bit/s may take.
const SLOW: Duration = Duration::from_secs(40);

/// The line of the built-in plant, and its devices: an IQ at polling address 0, a CVA at 1.
const LOOP: &str = "Simulated%20HART%20loop";

/// Opens a tab of a device of the simulated loop.
async fn open_device(server: &Server, tag: &str, tab: &str) -> Page {
    let page = Page::open(&server.url(&format!("/#/device/{tag}/{tab}"))).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=program][data-state=open]")
        .await;
    page
}

/// Waits until a value of a device is there, and gives it as it stands.
async fn value(page: &Page, key: &str) -> String {
    let css = format!("[data-testid=hart-value][data-key='{key}'] .value-said b");
    page.text(&css).await
}

/// Holds that a value is the float that the frame under it has, so many bytes behind the status
/// bytes; gives it.
async fn assert_float(page: &Page, key: &str, at: usize) -> f32 {
    let css = format!("[data-testid=hart-value][data-key='{key}']");
    page.click(&format!("{css} .value-name")).await;
    let facts = format!("{css} [data-testid=value-facts] p.mono");
    page.wait_for(&facts).await;
    // Together: the next answer may be another.
    let seen = page
        .eval(&format!(
            "return [{:?}, {facts:?}].map(css => document.querySelector(css).innerText)",
            format!("{css} .value-said b")
        ))
        .await;
    let [shown, facts]: [String; 2] = serde_json::from_value(seen).expect("two texts");
    let hex = facts.rsplit(": ").next().unwrap_or_default();
    let bytes: Vec<u8> = hex
        .split_whitespace()
        .map(|b| u8::from_str_radix(b, 16).expect("a byte"))
        .collect();
    // Delimiter, five bytes of address, command, count, two of status.
    let from = 10 + at;
    let word = bytes[from..from + 4].try_into().expect("four bytes");
    let sent = f32::from_be_bytes(word);
    let shown: f32 = shown.parse().expect("a number");
    assert!(
        (shown - sent).abs() <= sent.abs() / 1000.0,
        "{key}: {shown}, {sent} was sent"
    );
    sent
}

/// The overview of a simulated IQ: what it shows is what its frames say.
#[tokio::test]
async fn a_device_is_shown_live() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-401", "overview").await;
    page.wait_for("[data-testid=hart-position] .unit").await;
    // Zero is 4 mA and 100 % is 20 mA: the frame's own current, read by hand, is the shown one.
    let current = value(&page, "3.loop_current").await;
    let shown: f32 = current.parse().expect("a number");
    assert!((3.5..=20.5).contains(&shown), "{current}");
    page.click("[data-testid=hart-read]").await;
    page.wait_for("[data-testid=hart-value][data-key='133.mode'] .value-said b")
        .await;
    let mode = value(&page, "133.mode").await;
    assert!(mode.contains("Analogue input"), "{mode}");
    // Demand, position: unit byte 4, float from 5 on; unit 9, float from 10 on.
    let demand = assert_float(&page, "3.pv", 5).await;
    let position = assert_float(&page, "3.sv", 10).await;
    for percent in [demand, position] {
        assert!((0.0..=100.0).contains(&percent), "{percent}");
    }
    page.wait_for("[data-testid=hart-trend] [data-testid=chart-svg]")
        .await;
    page.until(
        "[data-testid=hart-ne107]",
        "!/not read/.test($.textContent)",
    )
    .await;
    page.look("hart-overview").await;
    page.assert_clean().await;
}

/// Everything of the set-up is read or said to be refused; nothing stays "not read".
#[tokio::test]
async fn the_set_up_is_read() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-401", "setup").await;
    page.wait_for("[data-testid=hart-unavailable]").await;
    page.until_within(
        "[data-testid=hart-setup]",
        "!/not read/.test($.textContent)",
        SLOW,
    )
    .await;
    assert_float(&page, "131.zero", 0).await;
    assert_float(&page, "131.span", 4).await;
    let maker = value(&page, "0.manufacturer").await;
    assert!(maker.contains("Rotork"), "{maker}");
    page.look("hart-setup").await;
    page.click("[data-testid=hart-tab][data-tab=variables]")
        .await;
    page.wait_for("[data-testid=hart-variables] [data-key='3.pv'] b")
        .await;
    page.until_within(
        "[data-testid=hart-variables] [data-key='9.slot[2].status']",
        "!/not read/.test($.textContent)",
        SLOW,
    )
    .await;
    page.look("hart-variables").await;
    page.assert_clean().await;
}

/// Status by bit, for an IQ and a CVA; the map of the device.
#[tokio::test]
async fn status_and_map_are_those_of_the_family() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-401", "status").await;
    page.wait_for("[data-testid=hart-bit]").await;
    // Appendix 1: 39 bits of the IQ; 8 of the device status, 6 extended.
    assert!(page.count("[data-testid=hart-bit]").await >= 39 + 8 + 6);
    page.look("hart-status").await;
    page.click("[data-testid=hart-tab][data-tab=map]").await;
    page.wait_for("[data-testid=hart-map]").await;
    page.wait_for("[data-testid=hart-result]").await;
    page.look("hart-device-map").await;
    let page = open_device(&server, "FV-402", "status").await;
    // Table 15: the status word of the CVA, command 129.
    page.until_within(
        "[data-testid=hart-status]",
        "/command 129/.test($.textContent) && /Relay/.test($.textContent)",
        SLOW,
    )
    .await;
    page.assert_clean().await;
}

/// A CMA of the plant has an alarm and a map that gives it a category: the sign of NAMUR NE 107 on its
/// overview, and the bit that it comes from.
#[tokio::test]
async fn a_mapped_alarm_has_its_category() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-403", "overview").await;
    page.until_within(
        "[data-testid=hart-ne107]",
        "$.querySelector('[role=img]') && !/not read|no category/i.test($.innerText)",
        SLOW,
    )
    .await;
    page.look("hart-mapped").await;
    page.click("[data-testid=hart-tab][data-tab=status]").await;
    page.wait_for("[data-testid=hart-bit][data-on='1']").await;
    page.wait_for("[data-testid=hart-ne107]").await;
    page.look("hart-mapped-status").await;
    page.assert_clean().await;
    for tag in ["FV-404", "FV-405"] {
        let page = open_device(&server, tag, "overview").await;
        page.until_within(
            "[data-testid=hart-position]",
            "/\\d/.test($.innerText)",
            SLOW,
        )
        .await;
        page.look(&format!("hart-{}", tag.to_ascii_lowercase()))
            .await;
        page.assert_clean().await;
    }
}

/// A HART line: its frames are shown by the program, the line says who is on it, and a scan finds
/// the devices. The list of devices tells their state.
#[tokio::test]
async fn a_line_shows_its_frames_and_is_searched() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/devices")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.until_within(
        "[data-testid=device-row][data-tag=FV-401]",
        "/poll 0/.test($.textContent) && !/never/.test($.textContent)",
        SLOW,
    )
    .await;
    // Its position comes from command 3, which the list polls.
    page.until_within(
        "[data-testid=device-row][data-tag=FV-401]",
        "/\\d+\\.\\d\\s*%/.test($.innerText)",
        SLOW,
    )
    .await;
    page.look("hart-devices").await;
    let page = Page::open(&server.url(&format!("/#/traffic/{LOOP}"))).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=hart-link]").await;
    page.click("[data-testid=hart-scan]").await;
    page.wait_for("[data-testid=hart-found]").await;
    page.wait_within(
        "[...document.querySelectorAll('[data-testid=frame-row]')]
           .some(row => /Read unique identifier/.test(row.textContent))",
        SLOW,
    )
    .await;
    page.look("hart-line").await;
    page.click("[data-testid=hart-bus] [data-testid=hart-cancel]")
        .await;
    // By tag and by long tag (commands 11 and 21): one device answers, and it is the right one. The
    // second of the plant has the id 012346.
    for (tag, button) in [("fv-402", "hart-find"), ("FV-402", "hart-find-long")] {
        page.until_within("[data-testid=hart-scan]", "!$.disabled", SLOW)
            .await;
        page.enter("[data-testid=hart-tag]", tag).await;
        page.click(&format!("[data-testid={button}]")).await;
        page.until_within(
            "[data-testid=hart-devices], [data-testid=hart-bus]",
            "document.querySelectorAll('[data-testid=hart-found]').length === 1
             && !document.querySelector('[data-testid=hart-scan]').disabled",
            SLOW,
        )
        .await;
        let found = page.text("[data-testid=hart-found]").await;
        assert!(found.contains("Rotork"), "{button}: {found}");
        assert!(found.contains(SECOND), "{button}: {found}");
    }
    page.enter("[data-testid=hart-tag]", "NOBODY").await;
    page.click("[data-testid=hart-find]").await;
    page.until_within(
        "[data-testid=hart-search]",
        "/no device|nobody|no answer/i.test($.innerText)",
        SLOW,
    )
    .await;
    assert_eq!(page.count("[data-testid=hart-found]").await, 0);
    page.assert_clean().await;
}

/// Address of the second device of the plant.
const SECOND: &str = "2EDD012346";

/// A configuration that serves one line.
struct Plant {
    server: Server,
    folder: std::path::PathBuf,
}

impl Plant {
    fn start(name: &str, text: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("valvescope-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the configuration");
        let file = folder.join("valvescope.toml");
        std::fs::write(&file, text).expect("a folder that can be written to");
        let server = Server::start(&["--config", file.to_str().expect("a plain path")]);
        Self { server, folder }
    }
}

impl Drop for Plant {
    fn drop(&mut self) {
        // Only a leftover in a folder for leftovers if it fails.
        let _leftover = std::fs::remove_dir_all(&self.folder);
    }
}

/// A device of another process, on a pseudo terminal, that a master has put under digital control:
/// nobody can miss that it does not follow its loop, and its demand is said to be none (table 17).
#[tokio::test]
async fn a_forced_mode_is_unmistakable() {
    let mut device = Command::new(binary());
    device.args(["simulate", "--hart", "pty", "--device", "rotork-iq"]);
    device.args(["--tag", "FV-77", "--digital", "40"]);
    let (_device, port) = Process::start(&mut device, "build the binary first", |line| {
        let (_, rest) = line.split_once("serving on ")?;
        Some(rest.split(' ').next()?.to_owned())
    });
    let plant = Plant::start(
        "forced",
        &format!(
            "[[bus]]\nname = \"Modem\"\nkind = \"hart\"\nport = \"{port}\"\n\
             [[device]]\ntag = \"FV-77\"\nkind = \"rotork-iq\"\nbus = \"Modem\"\npoll = 0\n"
        ),
    );
    let page = open_device(&plant.server, "FV-77", "overview").await;
    page.until_within(
        "[data-testid=hart-forced]",
        "/digital/i.test($.innerText) && /does not follow the loop current/.test($.innerText)",
        SLOW,
    )
    .await;
    let none = "[data-testid=hart-value][data-key='3.pv']";
    page.until_within(none, "/not a number/.test($.innerText)", SLOW)
        .await;
    page.look("hart-forced").await;
    for tab in ["setup", "variables", "traffic"] {
        page.click(&format!("[data-testid=hart-tab][data-tab={tab}]"))
            .await;
        page.until("[data-testid=hart-forced]", "/digital/i.test($.innerText)")
            .await;
    }
    page.click("[data-testid=hart-tab][data-tab=overview]")
        .await;

    // A page that nobody looks at asks for nothing: the last answer grows old. Then it goes on.
    let age = "Number((/([\\d.]+) s ago/.exec($.innerText) ?? [])[1])";
    let answered = "[data-testid=hart-answered]";
    page.until_within(answered, &format!("{age} < 2"), SLOW)
        .await;
    let hide = |hidden: bool| {
        format!(
            "Object.defineProperty(document, 'hidden', {{ value: {hidden}, configurable: true }});
             document.dispatchEvent(new Event('visibilitychange'))"
        )
    };
    page.eval(&hide(true)).await;
    page.until_within(answered, &format!("{age} > 5"), SLOW)
        .await;
    page.eval(&hide(false)).await;
    page.until_within(answered, &format!("{age} < 2"), SLOW)
        .await;
    page.assert_clean().await;
}

/// A gateway that answers with published and worked frames: what it says of command 3 is on the
/// screen, and what it does not implement is said to be that.
#[tokio::test]
async fn a_gateway_is_read() {
    let gateway = gateway::start();
    let plant = Plant::start(
        "gateway",
        &format!(
            "[[bus]]\nname = \"Gateway\"\nkind = \"hart-ip\"\nhost = \"{gateway}\"\n\
             [[device]]\ntag = \"FV-88\"\nkind = \"rotork-iq\"\nbus = \"Gateway\"\npoll = 0\n"
        ),
    );
    let page = open_device(&plant.server, "FV-88", "overview").await;
    page.until_within(
        "[data-testid=hart-position]",
        "$.innerText.trim() === '49.5 %'",
        SLOW,
    )
    .await;
    for (key, wanted) in [("3.pv", "50"), ("3.loop_current", "12")] {
        assert_eq!(value(&page, key).await, wanted, "{key}");
    }
    // Frame R10: local control fault; the device says failure.
    page.until_within(
        "[data-testid=hart-overview]",
        "/Local control fault/.test($.innerText) && /Failure/.test($.innerText)",
        SLOW,
    )
    .await;
    page.look("hart-gateway").await;
    // It does not implement command 523, and that is what the screen of the map says.
    page.click("[data-testid=hart-tab][data-tab=map]").await;
    page.until_within(
        "[data-testid=hart-map-page], [data-testid=hart-map-view]",
        "/not implemented/i.test($.innerText)",
        SLOW,
    )
    .await;
    let bus = Page::open(&plant.server.url("/#/traffic/Gateway")).await;
    bus.show(1440, 900, Scheme::Light).await;
    bus.until(
        "[data-testid=hart-link]",
        "/gateway is the master/i.test($.innerText)",
    )
    .await;
    bus.until(
        "[data-testid=frame-row]",
        "/HART-IP|Read|Session/.test($.innerText)",
    )
    .await;
    bus.look("hart-gateway-line").await;
    bus.assert_clean().await;
    page.assert_clean().await;
}
