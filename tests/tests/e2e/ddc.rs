//! DDC-100 networks end to end: a simulated loop with a break that comes, a unit, a tag list, and the
//! fault table and scan time without a network, as a person sees them.

mod shapes;
mod unit;

use std::path::PathBuf;
use std::time::Duration;

use serde_json::Value;
use tests::browser::{Page, Scheme};
use tests::server::Server;

/// The simulated network of these tests.
struct Network {
    server: Server,
    folder: PathBuf,
}

impl Network {
    /// Starts one with so many units of mixed types. `faults` are those of the simulator.
    fn start(name: &str, shape: &str, units: usize, faults: &[&str]) -> Self {
        let quoted: Vec<String> = faults.iter().map(|f| format!("\"{f}\"")).collect();
        let mut text = format!(
            "[[bus]]\nname = \"Loop 1\"\nkind = \"ddc100-simulator\"\nshape = \"{shape}\"\n\
             baud = 19200\nfaults = [{}]\n",
            quoted.join(", ")
        );
        let kinds = ["mx", "uec", "mx", "clamshell", "io", "uec"];
        for (unit, kind) in (1..=units).zip(kinds.iter().cycle()) {
            text.push_str(&format!(
                "[[device]]\ntag = \"MOV-{unit:03}\"\nkind = \"ddc100-{kind}\"\n\
                 bus = \"Loop 1\"\nunit = {unit}\n"
            ));
        }
        Self::with(name, &text)
    }

    /// Starts one with this configuration.
    fn with(name: &str, text: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("valvescope-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the configuration");
        let file = folder.join("valvescope.toml");
        std::fs::write(&file, text).expect("a folder that can be written to");
        let server = Server::start(&["--config", file.to_str().expect("a plain path")]);
        Self { server, folder }
    }

    async fn open(&self, hash: &str) -> Page {
        let page = Page::open(&self.server.url(&format!("/{hash}"))).await;
        page.show(1440, 900, Scheme::Light).await;
        page
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        // Only a leftover in a folder for leftovers if it fails.
        let _leftover = std::fs::remove_dir_all(&self.folder);
    }
}

/// A break has its time, and passes take theirs.
const fn seconds(count: u64) -> Duration {
    Duration::from_secs(count)
}

const FINDING: &str = "[data-testid=finding]";

/// All units good at first; then the cable breaks behind the third unit, and the page says so, draws
/// it there, and shows which port reaches whom.
#[tokio::test]
async fn a_break_is_named_where_it_is() {
    let network = Network::start(
        "ddc-break",
        "loop",
        6,
        &["break-3 from 25 to 3600 every 3600"],
    );
    let page = network.open("#/devices").await;
    page.click("[data-testid=nav-network]").await;
    let good = format!("document.querySelector('{FINDING}[data-key=no_fault][data-certain=true]')");
    page.wait_within(&good, seconds(20)).await;
    assert_eq!(page.count("[data-testid=node]").await, 6);
    assert_eq!(page.count("[data-testid=break]").await, 0);
    assert_eq!(page.count(".ring .sign-f").await, 0, "grey is normal");
    page.wait_until("document.querySelectorAll('[data-testid=unit-row]').length === 6")
        .await;
    // The poll moves on, and passes are measured beside what is expected.
    page.wait_for("[data-testid=poll]").await;
    page.wait_within(
        "/\\d\\.\\d\\d s/.test(document.querySelector('[data-testid=passes]').innerText)",
        seconds(10),
    )
    .await;
    // Arrow keys walk along the cable; the drawing tells where they are.
    page.eval("document.querySelector('[data-testid=ring]').focus()")
        .await;
    for _ in 0..2 {
        page.eval(
            "document.activeElement.dispatchEvent(
               new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true }))",
        )
        .await;
    }
    page.wait_until(
        "document.querySelector('[data-testid=chosen-unit]')?.dataset.unit === '2'
         && document.querySelector('[data-testid=ring]')
              .getAttribute('aria-activedescendant') === 'node-1'",
    )
    .await;
    page.look("ddc-good").await;

    let broken = format!("document.querySelector('{FINDING}[data-key=break][data-certain=true]')");
    page.wait_within(&broken, seconds(45)).await;
    let words = page.text(&format!("{FINDING}[data-key=break]")).await;
    assert!(words.contains("between unit 3 and unit 4"), "{words}");
    page.wait_for("[data-testid=break][data-kind=certain][data-from='3'][data-to='3']")
        .await;
    // 1 is a fault: up to unit 3 on port 2, from unit 4 on port 1.
    let faults = page
        .eval(
            "return [1, 2, 3, 4, 5, 6].map(unit => ['host-a', 'host-b'].map(bit =>
               document.querySelector(
                 `[data-testid=unit-row][data-unit='${unit}'] [data-bit=${bit}]`
               ).textContent).join('')).join(' ')",
        )
        .await;
    assert_eq!(faults, Value::String("01 01 01 10 10 10".into()));
    page.look("ddc-break").await;
    page.show(390, 844, Scheme::Light).await;
    // As a list, the break stands between the third and the fourth unit.
    page.wait_until(
        "(() => {
           const list = document.querySelector('[data-testid=cable-list]')?.innerText ?? '';
           const at = word => list.indexOf(word);
           return at('MOV-003') >= 0 && at('MOV-003') < at('Break') && at('Break') < at('MOV-004');
         })()",
    )
    .await;
    page.assert_clean().await;
}

/// The table is sorted, searched and narrowed; a unit opens from it and from the devices.
#[tokio::test]
async fn a_unit_says_what_it_does() {
    let network = Network::start("ddc-unit", "loop", 6, &["off-3", "phase-6", "local-4"]);
    let page = network.open("#/network/Loop%201").await;
    let off = format!("document.querySelector('{FINDING}[data-key=off_line][data-certain=true]')");
    page.wait_within(&off, seconds(30)).await;
    let words = page.text(FINDING).await;
    assert!(words.contains("Unit 3 is off-line"), "{words}");
    // The worst first.
    page.wait_until("document.querySelector('[data-testid=unit-row]')?.dataset.unit === '3'")
        .await;
    page.click("[data-testid=sort-unit]").await;
    page.wait_until("document.querySelector('[data-testid=unit-row]')?.dataset.unit === '1'")
        .await;
    page.enter("[data-testid=unit-search]", "mov-006").await;
    page.wait_until("document.querySelectorAll('[data-testid=unit-row]').length === 1")
        .await;
    page.click("[data-testid=unit-row][data-unit='6']").await;
    page.wait_for("[data-testid=unit]").await;
    page.wait_for("[data-testid=unit-fault]").await;
    assert_eq!(
        page.eval("return location.hash").await,
        Value::String("#/device/MOV-006".into())
    );

    // A valve that was just switched on: closed, at REMOTE, no fault.
    page.eval("location.hash = '#/device/MOV-002'").await;
    page.wait_until(
        "document.querySelector('[data-testid=unit-state]')?.innerText.includes('Closed · Remote')
         && document.querySelector('[data-testid=unit-position]').innerText === '0 %'",
    )
    .await;
    let bit = |name: &str| format!("[data-testid=unit] [data-bit={name}]");
    assert_eq!(page.text(&bit("host-a")).await, "0");
    assert_eq!(
        page.text(&bit("own-b")).await,
        "1",
        "a UEC without channel B"
    );
    // Could it be opened? Yes. Closed? It is closed already.
    page.wait_until("document.querySelector('[data-testid=verdict]')?.dataset.verdict === 'pass'")
        .await;
    page.enter("[data-testid=wish]", "close").await;
    page.wait_until("document.querySelector('[data-testid=verdict]').dataset.verdict === 'fail'")
        .await;
    page.wait_for("[data-testid=check-item][data-key=position][data-verdict=fail]")
        .await;
    // All registers, read between two polls.
    page.click("[data-testid=read-registers]").await;
    page.wait_within(
        "document.querySelector('[data-testid=read-state]').innerText.includes('read: 1 to 56')",
        seconds(15),
    )
    .await;
    page.wait_until("document.querySelectorAll('[data-testid=registers] tbody tr').length === 56")
        .await;
    // Counters of function 08, read when they are asked for: every poll is a message (table 3.8).
    let counter = |sub: u8| {
        format!(
            "document.querySelector(\"[data-testid=counter][data-sub='{sub}'] td.num:not(.quiet)\")?.innerText"
        )
    };
    page.wait_until(
        "document.querySelector('[data-testid=counters]').innerText.includes('not read')",
    )
    .await;
    page.click("[data-testid=read-counters]").await;
    for sub in [2, 11, 12, 13, 14] {
        page.wait_within(&format!("/\\d/.test({})", counter(sub)), seconds(15))
            .await;
    }
    let messages = page.eval(&format!("return Number({})", counter(11))).await;
    assert!(messages.as_f64() > Some(0.0), "{messages}");
    page.wait_until("!document.querySelector('[data-testid=read-counters]').disabled")
        .await;
    page.click("[data-testid=read-counters]").await;
    page.wait_within(
        &format!("Number({}) > {messages}", counter(11)),
        seconds(15),
    )
    .await;
    page.look("ddc-unit").await;
    // The scale is remembered.
    page.enter("[data-testid=scaling]", "0-4095").await;
    page.wait_until("document.querySelector('[data-testid=unit-position]').innerText === '0.0 %'")
        .await;
    page.client.refresh().await.expect("the page loads again");
    page.wait_until("document.querySelector('[data-testid=unit-position]')?.innerText === '0.0 %'")
        .await;
    // The other tabs are still there.
    page.click("[data-testid=tab-values]").await;
    page.wait_for("[data-testid=register-list]").await;

    // At LOCAL no command should go; what the unit says is kept apart from what the host found.
    page.eval("location.hash = '#/device/MOV-004'").await;
    page.wait_until(
        "document.querySelector('[data-testid=check-item][data-key=remote]')
           ?.dataset.verdict === 'fail'",
    )
    .await;
    page.eval("location.hash = '#/device/MOV-003'").await;
    page.wait_until(
        "document.querySelector('[data-testid=check-item][data-key=communication]')
           ?.dataset.verdict === 'fail'",
    )
    .await;
    page.click("[data-testid=to-network]").await;
    page.wait_for("[data-testid=ring]").await;
    page.assert_clean().await;
}

/// A list with a mistake says where; what is exported can be imported again, and is the same.
#[tokio::test]
async fn a_tag_list_goes_round() {
    let network = Network::start("ddc-tags", "loop", 3, &[]);
    let page = network.open("#/network/Loop%201/tags").await;
    page.wait_for("[data-testid=tag-row][data-unit='3']").await;
    let list = "Tag name,Description,Unit,Register,Command data,Scaling\n\
                80-MOV-4141,\"Feed, left\",1,,,\n\
                80-POS-4141,Position feedback,1,40008,,0-255\n\
                80-MOV-4142,Feed right,777,,,\n";
    page.enter("[data-testid=tags-paste]", list).await;
    page.wait_for("[data-testid=tag-problem][data-line='4'][data-column='24']")
        .await;
    let row = page.text("[data-testid=tag-row][data-unit='1']").await;
    for part in ["80-MOV-4141", "Feed, left", "0-255", "80-POS-4141", "40008"] {
        assert!(row.contains(part), "{part}: {row}");
    }
    page.look("ddc-tags").await;
    page.keep_saved().await;
    page.click("[data-testid=export-tags]").await;
    let saved = page.saved(1).await;
    assert!(saved.contains("80-MOV-4141,\"Feed, left\",1"), "{saved}");
    assert!(
        saved.contains("MOV-002,") && saved.contains(",40009,"),
        "{saved}"
    );
    page.click("[data-testid=forget-tags]").await;
    page.wait_until(
        "document.querySelector(\"[data-testid=tag-row][data-unit='1']\").innerText.includes('MOV-001')",
    )
    .await;
    page.enter("[data-testid=tags-paste]", &saved).await;
    page.wait_until(
        "document.querySelector(\"[data-testid=tag-row][data-unit='1']\").innerText.includes('80-MOV-4141')",
    )
    .await;
    assert_eq!(page.count("[data-testid=tag-problem]").await, 0);
    page.click("[data-testid=export-tags]").await;
    assert_eq!(page.saved(2).await, saved);
    // The tag stands in the table of the network, too.
    page.click("[data-testid=net-tab][data-tab=main]").await;
    page.wait_until(
        "document.querySelector(\"[data-testid=unit-row][data-unit='1']\")?.innerText.includes('80-MOV-4141')",
    )
    .await;
    page.assert_clean().await;
}

/// Without a network: the examples of section 4.3.2, bits by hand, bits pasted, and the scan time of
/// the example in section 4.3.
#[tokio::test]
async fn a_pattern_is_worked_out_by_hand() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.click("[data-testid=network-link]").await;
    page.wait_for("[data-testid=fault-table]").await;
    for (example, key) in [
        ("1", "no_fault"),
        ("2", "off_line"),
        ("3", "break"),
        ("4", "port_lost"),
        ("5", "no_fault"),
        ("6", "off_line"),
        ("7", "beyond"),
    ] {
        page.enter("[data-testid=typed-example]", example).await;
        page.wait_for(&format!("{FINDING}[data-key={key}]")).await;
    }
    page.enter("[data-testid=typed-example]", "3").await;
    page.wait_for("[data-testid=break][data-from='3']").await;
    page.look("ddc-typed").await;
    // The break moves behind unit 2 when unit 3 turns round.
    page.click("[data-testid=typed-bit][data-at='2'][data-port='0']")
        .await;
    page.click("[data-testid=typed-bit][data-at='2'][data-port='1']")
        .await;
    page.wait_for("[data-testid=break][data-from='2'][data-kind=certain]")
        .await;
    page.enter("[data-testid=typed-paste]", "7 0 1\n9 1 1\n3 1 0\n")
        .await;
    page.wait_for(&format!(
        "{FINDING}[data-key=break_among][data-certain=false]"
    ))
    .await;
    let why = page.text(FINDING).await;
    assert!(why.contains("between unit 7 and unit 3"), "{why}");
    page.enter("[data-testid=typed-paste]", "7 0 1\n9 x y\n")
        .await;
    let problem = page.text("[data-testid=typed-problem]").await;
    assert!(problem.contains("Line 2"), "{problem}");

    page.click("[data-testid=net-tab][data-tab=scan]").await;
    page.wait_until("document.querySelector('[data-testid=scan-time]')?.innerText === '1.42 s'")
        .await;
    page.enter("[data-testid=scan-units]", "250").await;
    page.enter("[data-testid=scan-turn]", "30").await;
    // 250 times 50 and 30 ms.
    page.wait_until("document.querySelector('[data-testid=scan-time]').innerText === '20.00 s'")
        .await;
    page.look("ddc-scan").await;
    page.assert_clean().await;
}

/// 250 units: every one in the drawing, none off the screen, and the page stays quick.
#[tokio::test]
async fn as_many_units_as_there_can_be() {
    let network = Network::start("ddc-many", "loop", 250, &[]);
    let page = network.open("#/network/Loop%201").await;
    page.wait_until("document.querySelectorAll('[data-testid=node]').length === 250")
        .await;
    page.wait_within(
        "document.querySelectorAll('.ring .node:not(.unknown)').length >= 20",
        seconds(20),
    )
    .await;
    let drawn = page.count("[data-testid=unit-row]").await;
    assert!((5..60).contains(&drawn), "only what is in view: {drawn}");
    page.look("ddc-many").await;
    // A whole pass: each of them is known.
    page.wait_within(
        "document.querySelectorAll('.ring .node.unknown').length === 0",
        seconds(90),
    )
    .await;
    page.click("[data-testid=sort-unit]").await;
    page.wait_until("document.querySelector('[data-testid=unit-row]')?.dataset.unit === '1'")
        .await;
    page.until("[data-testid=unit-count]", "$.innerText === '250 of 250'")
        .await;
    page.look("ddc-many-whole").await;
    page.assert_clean().await;
}
