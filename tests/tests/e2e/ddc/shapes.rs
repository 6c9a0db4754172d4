//! Networks of other shapes, a host port that is not there, and what can be done with the table.

use std::process::Command;

use serde_json::{Value, json};
use tests::browser::Page;
use tests::process::Process;
use tests::server::binary;

use super::{FINDING, Network, seconds};

/// Numbers of the units in the order in which the table has them.
async fn order(page: &Page) -> Vec<u64> {
    let units = page
        .eval(
            "return [...document.querySelectorAll('[data-testid=unit-row]')]
               .sort((a, b) => a.getBoundingClientRect().top - b.getBoundingClientRect().top)
               .map(row => Number(row.dataset.unit))",
        )
        .await;
    serde_json::from_value(units).expect("numbers")
}

/// Both shapes with one port: drawn, polled, found sound; a break takes all that is behind it.
#[tokio::test]
async fn networks_with_one_port_are_drawn() {
    for (shape, faults, key) in [
        ("single-ended", &["break-2"][..], "beyond"),
        ("multi-drop", &[], "no_fault"),
    ] {
        let network = Network::start(&format!("ddc-{shape}"), shape, 4, faults);
        let page = network.open("#/network/Loop%201").await;
        let found = format!("document.querySelector('{FINDING}[data-key={key}]')");
        page.wait_within(&found, seconds(30)).await;
        assert_eq!(page.count("[data-testid=node]").await, 4, "{shape}");
        assert_eq!(page.count("[data-testid=port]").await, 1, "{shape}");
        // The host has one port, so it keeps one bit of each unit, once each was tried.
        let bits = "[1, 2, 3, 4].map(unit => document.querySelector(
                      `[data-testid=unit-row][data-unit='${unit}'] [data-bit=host-a]`
                    )?.textContent)";
        page.wait_within(&format!("{bits}.every(b => /[01]/.test(b))"), seconds(30))
            .await;
        let bits = page.eval(&format!("return {bits}")).await;
        let wanted = if faults.is_empty() {
            json!(["0", "0", "0", "0"])
        } else {
            json!(["0", "0", "1", "1"])
        };
        assert_eq!(bits, wanted, "{shape}");
        page.look(&format!("ddc-{shape}")).await;
        page.assert_clean().await;
    }
}

/// The units of another process on pseudo terminals; the second port of the host has no device
/// file. The page says that the port is down, which is no fault of the cable.
#[tokio::test]
async fn a_port_that_is_not_there_is_said_to_be_down() {
    let mut units = Command::new(binary());
    units.args([
        "simulate",
        "--ddc100",
        "pty",
        "--units",
        "mx:3",
        "--at-once",
    ]);
    let (_units, port) = Process::start(&mut units, "build the binary first", |line| {
        let (_, rest) = line.split_once("port 1 on ")?;
        Some(rest.split(' ').next()?.to_owned())
    });
    let mut text = format!(
        "[[bus]]\nname = \"Loop 1\"\nkind = \"ddc100\"\nshape = \"loop\"\nbaud = 9600\n\
         port = \"{port}\"\nport2 = \"/dev/valvescope-none\"\n"
    );
    for unit in 1..=3 {
        text.push_str(&format!(
            "[[device]]\ntag = \"MOV-{unit:03}\"\nkind = \"ddc100-mx\"\nbus = \"Loop 1\"\n\
             unit = {unit}\n"
        ));
    }
    let network = Network::with("ddc-down", &text);
    let page = network.open("#/network/Loop%201").await;
    page.wait_within(
        "[...document.querySelectorAll('[data-testid=port]')]
           .some(p => /down/i.test(p.innerText) && /valvescope-none/.test(p.innerText))",
        seconds(20),
    )
    .await;
    page.wait_within(
        "document.querySelectorAll('.ring .node:not(.unknown)').length === 3",
        seconds(20),
    )
    .await;
    assert_eq!(page.count("[data-testid=break]").await, 0);
    let findings = page
        .eval(
            "return [...document.querySelectorAll('[data-testid=finding]')].map(f => f.innerText)
               .join('\\n')",
        )
        .await;
    let findings = findings.as_str().expect("a text").to_ascii_lowercase();
    assert!(findings.contains("port"), "{findings}");
    page.look("ddc-down").await;
    page.assert_clean().await;
}

/// Every column that can be is sorted by, both ways; what is wrong is picked out; what is seen is
/// what is saved.
#[tokio::test]
async fn the_table_is_sorted_and_saved() {
    let network = Network::start("ddc-table", "loop", 6, &["off-3", "phase-6"]);
    let page = network.open("#/network/Loop%201").await;
    let off = format!("document.querySelector('{FINDING}[data-key=off_line][data-certain=true]')");
    page.wait_within(&off, seconds(30)).await;
    for (column, wanted) in [
        ("unit", [1, 2, 3, 4, 5, 6]),
        ("tag", [1, 2, 3, 4, 5, 6]),
        ("place", [1, 2, 3, 4, 5, 6]),
    ] {
        let head = format!("[data-testid=sort-{column}]");
        for (turn, mark) in [(false, "ascending"), (true, "descending")] {
            page.click(&head).await;
            page.until(&head, &format!("$.dataset.order === '{mark}'"))
                .await;
            let mut wanted = wanted.to_vec();
            if turn {
                wanted.reverse();
            }
            assert_eq!(order(&page).await, wanted, "{column}, {mark}");
        }
    }
    for column in ["position", "status", "age", "response"] {
        let head = format!("[data-testid=sort-{column}]");
        page.click(&head).await;
        page.until(&head, "$.dataset.order !== 'none'").await;
        let mut units = order(&page).await;
        units.sort_unstable();
        assert_eq!(units, [1, 2, 3, 4, 5, 6], "{column}");
    }
    page.click("[data-testid=sort-worst]").await;
    page.wait_until("document.querySelector('[data-testid=unit-row]')?.dataset.unit === '3'")
        .await;
    page.click("[data-testid=only-faults]").await;
    page.wait_until(
        "[...document.querySelectorAll('[data-testid=unit-row]')]
           .map(row => row.dataset.unit).sort().join() === '3,6'",
    )
    .await;
    page.keep_saved().await;
    page.click("[data-testid=save-units]").await;
    let csv = page.saved(1).await;
    assert_eq!(csv.lines().count(), 3, "a head and two units: {csv}");
    for tag in ["MOV-003", "MOV-006"] {
        assert!(csv.contains(tag), "{csv}");
    }
    page.eval(
        "window.copied = null;
         navigator.clipboard.writeText = text => { window.copied = text; return Promise.resolve(); };",
    )
    .await;
    page.click("[data-testid=copy-units]").await;
    page.wait_until("window.copied !== null").await;
    let copied = page.eval("return window.copied").await;
    let copied = copied.as_str().expect("a text").to_owned();
    assert!(copied.contains("MOV-003\t") && copied.contains("MOV-006\t"));
    page.assert_clean().await;
}

/// A list of tags is opened as a file, too.
#[tokio::test]
async fn a_tag_list_is_opened_as_a_file() {
    let network = Network::start("ddc-file", "loop", 2, &[]);
    let page = network.open("#/network/Loop%201/tags").await;
    page.wait_for("[data-testid=tag-row][data-unit='2']").await;
    let list = "Tag name,Description,Unit,Register,Command data,Scaling\n80-MOV-9,Drain,2,,,\n";
    page.open_file("[data-testid=tags-file]", "tags.csv", list)
        .await;
    page.until(
        "[data-testid=tag-row][data-unit='2']",
        "$.innerText.includes('80-MOV-9')",
    )
    .await;
    assert_eq!(page.count("[data-testid=tag-problem]").await, 0);
    let said = page.eval("return document.body.innerText").await;
    assert_ne!(said, Value::Null);
    page.assert_clean().await;
}
